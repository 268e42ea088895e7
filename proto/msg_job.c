/* msg_job.c - the codec of the messages about a job as a whole: what it is, how
 * far it is, how it ended; its id as text
 *
 * See "jobs" in message.h. */
#include "config.h"

#include "codec.h"

#include "base/hex.h"

#include <float.h>

#define FRAME_MIN 15 /* bytes of a frame with an empty view */

static bool
frame_fits(const struct msg_frame *f)
{
    return f->width >= 1 && f->width <= MSG_MAX_SIDE && f->height >= 1 &&
           f->height <= MSG_MAX_SIDE;
}

static void
put_frames(struct wire_out *o, const struct msg_spec *b)
{
    msg_put_must(o, b->nframes >= 1 && b->nframes <= MSG_MAX_FRAMES);
    wire_put_u32(o, b->nframes);
    for (uint32_t i = 0; i < b->nframes && !o->bad; i++) {
        const struct msg_frame *f = &b->frames[i];

        msg_put_must(o, frame_fits(f));
        wire_put_u32(o, f->number);
        wire_put_u32(o, f->width);
        wire_put_u32(o, f->height);
        wire_put_str(o, f->view, MSG_MAX_VIEW);
    }
}

static void
get_frames(struct wire_in *in, struct msg_spec *b, struct msg *m)
{
    struct msg_frame *f;

    b->nframes = wire_get_count(in, FRAME_MIN, MSG_MAX_FRAMES);
    msg_must(in, b->nframes >= 1);
    b->frames = f = msg_list_room(m, in, b->nframes, sizeof *f);
    if (!f)
        b->nframes = 0;
    for (uint32_t i = 0; i < b->nframes; i++) {
        f[i].number = wire_get_u32(in);
        f[i].width = wire_get_u32(in);
        f[i].height = wire_get_u32(in);
        f[i].view = wire_get_str(in, MSG_MAX_VIEW);
        msg_must(in, frame_fits(&f[i]));
    }
}

/* The flags that a version has. */
static uint32_t
job_flags(unsigned version)
{
    return version < 2 ? MSG_JOB_FLAGS_1 : MSG_JOB_FLAGS;
}

static bool
spec_fits(const struct msg_spec *b, uint32_t flags)
{
    return (b->flags & ~flags) == 0 && b->partition < MSG_NPART &&
           b->order < MSG_NORDER;
}

/* Each a number, and not below 0. */
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
put_costs(struct wire_out *o, const struct msg_spec *b)
{
    msg_put_must(o, b->ncosts <= MSG_MAX_COSTS && costs_fit(b));
    if (o->bad)
        return;
    wire_put_u32(o, b->ncosts);
    wire_put_bytes(o, b->costs, (size_t)b->ncosts * 4);
}

static void
get_costs(struct wire_in *in, struct msg_spec *b)
{
    b->ncosts = wire_get_count(in, 4, MSG_MAX_COSTS);
    b->costs = wire_get_view(in, (size_t)b->ncosts * 4);
    msg_must(in, in->bad || costs_fit(b));
}

void
msg_pack_spec(struct wire_out *o, const struct msg_spec *b)
{
    msg_put_must(o, spec_fits(b, MSG_JOB_FLAGS));
    /* who cannot code rows cannot work on that job */
    msg_put_must(o, o->version >= 2 || !(b->flags & MSG_JOB_CODED));
    msg_put_job(o, b->job);
    msg_put_hash(o, b->manifest);
    wire_put_str(o, b->name, MSG_MAX_NAME);
    wire_put_str(o, b->params, MSG_MAX_PARAMS);
    wire_put_str(o, b->needs, MSG_MAX_NEEDS);
    wire_put_str(o, b->estimate, MSG_MAX_NAME);
    put_costs(o, b);
    wire_put_u64(o, b->seed);
    wire_put_i32(o, b->priority);
    wire_put_u32(o, b->flags & job_flags(o->version));
    wire_put_u8(o, b->partition);
    wire_put_u8(o, b->order);
    wire_put_u32(o, b->windows);
    wire_put_u32(o, b->objects);
    wire_put_u64(o, b->bundle_bytes);
    wire_put_f64(o, b->compile_s);
    if (o->version >= 2)
        wire_put_u32(o, b->memory_mib);
    msg_pack_hashes(o, &b->files);
    put_frames(o, b);
}

void
msg_unpack_spec(struct wire_in *in, struct msg_spec *b, struct msg *m)
{
    b->job = wire_get_view(in, MSG_JOB);
    b->manifest = wire_get_view(in, MSG_HASH);
    b->name = wire_get_str(in, MSG_MAX_NAME);
    b->params = wire_get_str(in, MSG_MAX_PARAMS);
    b->needs = wire_get_str(in, MSG_MAX_NEEDS);
    b->estimate = wire_get_str(in, MSG_MAX_NAME);
    get_costs(in, b);
    b->seed = wire_get_u64(in);
    b->priority = wire_get_i32(in);
    b->flags = wire_get_u32(in);
    b->partition = wire_get_u8(in);
    b->order = wire_get_u8(in);
    b->windows = wire_get_u32(in);
    b->objects = wire_get_u32(in);
    b->bundle_bytes = wire_get_u64(in);
    b->compile_s = wire_get_f64(in);
    if (in->version >= 2)
        b->memory_mib = wire_get_u32(in);
    msg_must(in, spec_fits(b, job_flags(in->version)) && b->compile_s >= 0);
    msg_unpack_hashes(in, &b->files, m);
    get_frames(in, b, m);
}

void
msg_pack_accept(struct wire_out *o, const struct msg_accept *b)
{
    msg_put_job(o, b->job);
    wire_put_u8(o, b->again);
}

void
msg_unpack_accept(struct wire_in *in, struct msg_accept *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->again = msg_get_below(in, 2);
}

/* A disk that is full is no state of version 1: the job waits. */
static uint8_t
state_as(unsigned version, uint8_t state)
{
    return version < 2 && state == MSG_STATE_HELD ? 0 : state;
}

void
msg_pack_progress(struct wire_out *o, const struct msg_progress *b)
{
    msg_put_job(o, b->job);
    wire_put_u8(o, state_as(o->version, b->state));
    wire_put_u64(o, b->pixels_done);
    wire_put_u64(o, b->pixels_total);
    wire_put_u32(o, b->units_done);
    wire_put_u32(o, b->units_total);
    wire_put_u32(o, b->units_redone);
    wire_put_f64(o, b->cost_done);
    wire_put_f64(o, b->cost_total);
    wire_put_u64(o, b->rays);
    wire_put_u32(o, b->workers);
    wire_put_u32(o, b->frames_ready);
    wire_put_f64(o, b->elapsed_s);
    wire_put_u64(o, b->nan.pixels);
    wire_put_u32(o, b->nan.frame);
    wire_put_u32(o, b->nan.x);
    wire_put_u32(o, b->nan.y);
    msg_put_faults(o, b->faults);
    if (o->version >= 2)
        wire_put_f64(o, b->error);
}

void
msg_unpack_progress(struct wire_in *in, struct msg_progress *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->state = wire_get_u8(in);
    b->pixels_done = wire_get_u64(in);
    b->pixels_total = wire_get_u64(in);
    b->units_done = wire_get_u32(in);
    b->units_total = wire_get_u32(in);
    b->units_redone = wire_get_u32(in);
    b->cost_done = wire_get_f64(in);
    b->cost_total = wire_get_f64(in);
    b->rays = wire_get_u64(in);
    b->workers = wire_get_u32(in);
    b->frames_ready = wire_get_u32(in);
    b->elapsed_s = wire_get_f64(in);
    b->nan.pixels = wire_get_u64(in);
    b->nan.frame = wire_get_u32(in);
    b->nan.x = wire_get_u32(in);
    b->nan.y = wire_get_u32(in);
    msg_get_faults(in, b->faults);
    if (in->version >= 2)
        b->error = wire_get_f64(in);
}

void
msg_pack_done(struct wire_out *o, const struct msg_done *b)
{
    msg_put_job(o, b->job);
    wire_put_u32(o, b->frames);
}

void
msg_unpack_done(struct wire_in *in, struct msg_done *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->frames = wire_get_u32(in);
}

void
msg_pack_failed(struct wire_out *o, const struct msg_failed *b)
{
    msg_put_job(o, b->job);
    wire_put_u16(o, b->status);
    wire_put_str(o, b->text, MSG_MAX_TEXT);
}

void
msg_unpack_failed(struct wire_in *in, struct msg_failed *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
    b->status = wire_get_u16(in);
    b->text = wire_get_str(in, MSG_MAX_TEXT);
}

void
msg_pack_jobid(struct wire_out *o, const struct msg_jobid *b)
{
    msg_put_job(o, b->job);
}

void
msg_unpack_jobid(struct wire_in *in, struct msg_jobid *b, struct msg *m)
{
    (void)m;
    b->job = wire_get_view(in, MSG_JOB);
}

/* --- its id --- */

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
