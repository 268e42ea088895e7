/* msg_job.c - the codec of the messages about a job as a whole: what it is, its
 * progress, its end; its id as text
 *
 * See msg_job.h. */
#include "config.h"

#include "proto/codec.h"

#include "base/hex.h"

#include <float.h>

static bool
size_fits(uint32_t width, uint32_t height)
{
    return width >= 1 && width <= MSG_MAX_SIDE && height >= 1 &&
           height <= MSG_MAX_SIDE;
}

/* Is a frame of that size large enough to be filtered to at least one pixel
 * (rad_filter_side())? */
static bool
size_is_left(uint32_t width, uint32_t height, const struct msg_spec *b)
{
    return 2 * width >= b->oversample && 2 * height >= b->oversample;
}

static bool
sizes_fit(const struct msg_spec *b)
{
    if (b->flags & MSG_JOB_VIEWS && !b->frames)
        return size_is_left(b->width, b->height, b);
    for (uint32_t i = 0; i < b->nframes; i++)
        if (!size_is_left(b->frames[i].width, b->frames[i].height, b))
            return false;
    return true;
}

/* The frames, one after another. */
static void
code_frame_list(struct codec *c, struct msg_spec *b)
{
    struct msg_frame *f = code_list(c, b->frames, &b->nframes, MSG_FRAME_BYTES,
                                    MSG_MAX_FRAMES, sizeof *f);

    code_must(c, b->nframes >= 1);
    for (uint32_t i = 0; i < b->nframes; i++) {
        code_u32(c, &f[i].number);
        code_u32(c, &f[i].width);
        code_u32(c, &f[i].height);
        code_str(c, &f[i].view, MSG_MAX_VIEW);
        code_must(c, size_fits(f[i].width, f[i].height));
    }
    b->frames = f;
}

/* The frames, or with MSG_JOB_VIEWS the hash of the file that holds them. */
static void
code_frames(struct codec *c, struct msg_spec *b)
{
    if (!(b->flags & MSG_JOB_VIEWS)) {
        code_must(c, c->in || b->frames);
        if (!code_bad(c))
            code_frame_list(c, b);
        if (c->in) {
            b->views = NULL;
            b->width = b->height = 0;
        }
        return;
    }
    if (c->in)
        b->frames = NULL;
    code_u32(c, &b->nframes);
    code_must(c, b->nframes >= 1 && b->nframes <= MSG_MAX_FRAMES);
    code_hash(c, &b->views);
    code_u32(c, &b->width);
    code_u32(c, &b->height);
    code_must(c, size_fits(b->width, b->height));
}

/* Are all costs finite and at least 0? */
static bool
costs_fit(const struct msg_spec *b)
{
    for (uint32_t i = 0; i < b->ncosts; i++) {
        float cost;

        wire_floats_get(&cost, b->costs + (size_t)i * 4, 1);
        if (!(cost >= 0 && cost <= FLT_MAX))
            return false;
    }
    return true;
}

static void
code_costs(struct codec *c, struct msg_spec *b)
{
    code_count(c, &b->ncosts, 4, MSG_MAX_COSTS);
    code_view(c, &b->costs, (size_t)b->ncosts * 4);
    code_must(c, code_bad(c) || costs_fit(b));
}

/* May these lines stand in a picture's header: are they printable, and none
 * empty, for an empty line ends the header? */
static bool
origin_fits(const char *origin)
{
    char before = '\n', c;

    for (; (c = *origin) != '\0'; before = c, origin++)
        if (c == '\n' ? before == '\n' : (unsigned char)c < ' ' || c == 127)
            return false;
    return before == '\n';
}

static void
code_origin(struct codec *c, struct msg_spec *b)
{
    if (!b->origin)
        b->origin = "";
    code_str(c, &b->origin, MSG_MAX_ORIGIN);
    code_must(c, code_bad(c) || origin_fits(b->origin));
}

/* How the picture is filtered. */
static void
code_filter(struct codec *c, struct msg_spec *b)
{
    code_u8(c, &b->oversample);
    code_amount(c, &b->clamp);
    code_read_must(c, b->oversample <= MSG_MAX_OVERSAMPLE);
    code_read_must(c, b->clamp == 0 ||
                          (b->oversample >= 2 && b->clamp >= MSG_MIN_CLAMP &&
                           b->clamp <= MSG_MAX_CLAMP));
}

/* The goal: how good the picture is to be, or by when. */
static void
code_target(struct codec *c, struct msg_spec *b)
{
    code_u32(c, &b->error_ppm);
    code_u32(c, &b->time_ms);
    code_read_must(c, b->error_ppm <= 1000000);
    code_read_must(c, (b->error_ppm == 0 && b->time_ms == 0) ||
                          b->flags & MSG_JOB_PASSES);
}

/* Fields of jobs whose ambient cache may serve another job, or comes from one.
 */
static void
code_reuse(struct codec *c, struct msg_spec *b)
{
    if (b->flags & MSG_JOB_SCENE)
        code_hash(c, &b->scene);
    if (b->flags & MSG_JOB_REUSE)
        code_job(c, &b->reuse);
    code_read_must(c, !(b->flags & MSG_JOB_SCENE) || b->flags & MSG_JOB_PASSES);
    code_read_must(c, !(b->flags & MSG_JOB_REUSE) || b->flags & MSG_JOB_SCENE);
    if (c->in && !(b->flags & MSG_JOB_SCENE))
        b->scene = NULL;
    if (c->in && !(b->flags & MSG_JOB_REUSE))
        b->reuse = NULL;
}

void
msg_code_spec(struct codec *c, struct msg_spec *b)
{
    if (c->out && b->flags & MSG_JOB_VIEWS)
        b->ncosts = 0;
    code_job(c, &b->job);
    code_hash(c, &b->manifest);
    code_str(c, &b->name, MSG_MAX_LABEL);
    code_str(c, &b->params, MSG_MAX_PARAMS);
    code_str(c, &b->needs, MSG_MAX_NEEDS);
    code_str(c, &b->estimate, MSG_MAX_NAME);
    code_costs(c, b);
    code_u64(c, &b->seed);
    code_i32(c, &b->priority);
    code_u32(c, &b->flags);
    code_below(c, &b->partition, MSG_NPART);
    code_below(c, &b->order, MSG_NORDER);
    code_u32(c, &b->windows);
    code_u32(c, &b->objects);
    code_u64(c, &b->bundle_bytes);
    code_read_must(c, b->bundle_bytes <= MSG_MAX_BYTES);
    code_amount(c, &b->compile_s);
    code_u32(c, &b->memory_mib);
    code_must(c, (b->flags & ~MSG_JOB_FLAGS) == 0);
    code_read_must(c, !(b->flags & MSG_JOB_PASSES) ||
                          !(b->flags & (MSG_JOB_SHARE | MSG_JOB_FRESH_FRAMES)));
    code_must(c, b->ncosts == 0 || !(b->flags & MSG_JOB_VIEWS));
    code_read_must(
        c, !(b->flags & MSG_JOB_POINTS) ||
               (b->flags & MSG_JOB_DEPTH && !(b->flags & MSG_JOB_VIEWS)));
    msg_code_hashes(c, &b->files);
    code_frames(c, b);
    code_origin(c, b);
    code_filter(c, b);
    code_target(c, b);
    code_must(c, code_bad(c) || sizes_fit(b));
    code_read_must(c, !(b->flags & MSG_JOB_POINTS) ||
                          (b->nframes == 1 && b->oversample <= 1));
    code_reuse(c, b);
}

/* --- the file of frames --- */

#define VIEWS_MAGIC  0x52564557u /* "RVEW" */
#define VIEWS_LAYOUT 1

static void
code_views(struct codec *c, struct msg_spec *b)
{
    uint32_t magic = VIEWS_MAGIC, layout = VIEWS_LAYOUT;

    code_u32(c, &magic);
    code_u32(c, &layout);
    code_must(c, magic == VIEWS_MAGIC && layout == VIEWS_LAYOUT);
    code_costs(c, b);
    code_frame_list(c, b);
}

int
msg_views_pack(struct wire_out *out, const struct msg_spec *spec)
{
    struct codec c = { .out = out, .version = MSG_VERSION };
    struct msg_spec copy = *spec;

    code_views(&c, &copy);
    return out->nomem ? RAD_ENOMEM : out->bad ? RAD_EPROTO : 0;
}

/* Are the frames that were read as many, and as large, as the job's message
 * said? */
static bool
views_fit(const struct msg_spec *said, const struct msg_spec *read)
{
    uint32_t width = 0, height = 0;

    for (uint32_t i = 0; i < read->nframes; i++) {
        const struct msg_frame *f = &read->frames[i];

        if (!size_is_left(f->width, f->height, said))
            return false;
        width = f->width > width ? f->width : width;
        height = f->height > height ? f->height : height;
    }
    return said->nframes == read->nframes && said->width == width &&
           said->height == height;
}

int
msg_views_unpack(struct msg *m, struct msg_spec *spec, const uint8_t *bytes,
                 size_t n, struct rad_error *err)
{
    struct wire_in in;
    struct codec c = { .in = &in, .m = m, .version = MSG_VERSION };
    struct msg_spec read = { 0 };

    wire_in_init(&in, bytes, n);
    in.version = MSG_VERSION;
    code_views(&c, &read);
    if (in.nomem)
        return rad_fail_memory(err);
    if (in.bad || wire_left(&in) > 0)
        return rad_fail(err, RAD_EDATA, "the list of frames is malformed");
    if (!views_fit(spec, &read))
        return rad_fail(err, RAD_EDATA,
                        "the list of frames is not that of the job");
    spec->ncosts = read.ncosts;
    spec->costs = read.costs;
    spec->frames = read.frames;
    return 0;
}

void
msg_code_accept(struct codec *c, struct msg_accept *b)
{
    code_job(c, &b->job);
    code_below(c, &b->again, 2);
    code_job(c, &b->reuse);
}

void
msg_code_progress(struct codec *c, struct msg_progress *b)
{
    code_job(c, &b->job);
    code_u8(c, &b->state);
    code_read_must(c, b->state <= MSG_STATE_HELD);
    code_u64(c, &b->pixels_done);
    code_u64(c, &b->pixels_total);
    code_u32(c, &b->units_done);
    code_u32(c, &b->units_total);
    code_u32(c, &b->units_redone);
    code_amount(c, &b->cost_done);
    code_amount(c, &b->cost_total);
    code_u64(c, &b->rays);
    code_u32(c, &b->workers);
    code_u32(c, &b->frames_ready);
    code_amount(c, &b->elapsed_s);
    code_amount(c, &b->left_s);
    code_u64(c, &b->nan.pixels);
    code_u32(c, &b->nan.frame);
    code_u32(c, &b->nan.x);
    code_u32(c, &b->nan.y);
    code_faults(c, b->faults);
    code_amount(c, &b->error);
    code_amount(c, &b->left_out);
    code_read_must(c, b->left_out <= 1);
    code_u8(c, &b->stage);
    code_u8(c, &b->ended);
    code_read_must(c, b->ended <= 1);
    code_u8(c, &b->rungs[0]);
    code_u8(c, &b->rungs[1]);
    code_amount(c, &b->goal_error);
}

void
msg_code_done(struct codec *c, struct msg_done *b)
{
    code_job(c, &b->job);
    code_u32(c, &b->frames);
}

void
msg_code_failed(struct codec *c, struct msg_failed *b)
{
    code_job(c, &b->job);
    code_failure(c, &b->status);
    code_str(c, &b->text, MSG_MAX_TEXT);
}

void
msg_code_jobid(struct codec *c, struct msg_jobid *b)
{
    code_job(c, &b->job);
}

void
msg_code_priority(struct codec *c, struct msg_priority *b)
{
    code_job(c, &b->job);
    code_i32(c, &b->priority);
}

/* --- a job's id --- */

void
msg_job_format(const uint8_t job[MSG_JOB], char hex[MSG_JOB_HEX])
{
    rad_hex_write(job, MSG_JOB, hex);
}

bool
msg_job_parse(const char *hex, uint8_t job[MSG_JOB])
{
    return rad_hex_valid(hex, MSG_JOB) && rad_hex_read(hex, MSG_JOB, job);
}

size_t
msg_job_chain(const uint8_t job[MSG_JOB], size_t n)
{
    return (job[0] | (size_t)job[1] << 8) % n;
}
