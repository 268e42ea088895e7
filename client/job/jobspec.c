/* jobspec.c - see jobspec.h */
#include "config.h"

#include "job/jobspec.h"

#include "base/text.h"
#include "job/costs.h"
#include "show/origin.h"
#include "show/picfile.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>
#include <unistd.h>

int
jobspec_name(struct jobspec *j, struct rad_error *err)
{
    if (getrandom(j->id, sizeof j->id, 0) == (ssize_t)sizeof j->id)
        return 0;
    return rad_fail(err, RAD_EINTERNAL, "no random numbers: %s",
                    strerror(errno));
}

/* List the object types that the scene uses, separated by blanks. */
static void
list_needs(struct jobspec *j, const struct rad_scene *scene)
{
    bool needs[RAD_NOTYPES] = { false };
    size_t used = 0;

    rad_scene_needs(scene, needs);
    for (int t = 0; t < RAD_NOTYPES; t++)
        if (needs[t] && used < sizeof j->needs)
            used += (size_t)snprintf(j->needs + used, sizeof j->needs - used,
                                     "%s%s", used ? " " : "",
                                     rad_otype_name((enum rad_otype)t));
}

static uint8_t
choose_partition(const struct submit_options *o)
{
    bool windows = o->windows > 0 || o->order != ORDER_NONE;

    if (o->partition == PARTITION_NONE)
        return windows ? MSG_PART_WINDOW : MSG_PART_AUTO;
    return (uint8_t)o->partition;
}

int
jobspec_read_costs(struct jobspec *j, const struct submit_options *o,
                   const struct frames *frames, struct rad_error *err)
{
    struct costs c;
    int rc;

    if (!o->costs)
        return 0;
    rc = costs_read(&c, o->costs, err);
    if (rc < 0)
        return rc;
    rc = costs_of_lines(&c, frames, o->params.psample, &j->costs, &j->ncosts,
                        err);
    if (rc < 0)
        rad_error_where(err, "%s", o->costs);
    costs_release(&c);
    return rc;
}

/* Note the largest width and height of all frames. */
static void
note_sizes(struct msg_spec *s, const struct frames *frames)
{
    for (uint32_t i = 0; i < frames->n; i++) {
        const struct msg_frame *f = &frames->list[i];

        s->width = f->width > s->width ? f->width : s->width;
        s->height = f->height > s->height ? f->height : s->height;
    }
}

int
jobspec_add_frames(struct jobspec *j, const struct frames *frames,
                   struct compiled *scene, const char *folder,
                   struct rad_error *err)
{
    const struct msg_spec list = { .nframes = frames->n,
                                   .frames = frames->list,
                                   .ncosts = j->ncosts,
                                   .costs = j->costs };
    const struct rad_bundle *b = &scene->bundle;
    struct wire_out out;
    int rc;

    if (frames->n == 1)
        return 0;
    wire_out_init(&out, MSG_MAX_VIEWS);
    rc = msg_views_pack(&out, &list);
    if (rc == RAD_ENOMEM)
        rad_fail(err, rc, "out of memory");
    else if (rc < 0)
        rc = rad_fail(err, RAD_EUSAGE, "the views take more than %u MiB",
                      MSG_MAX_VIEWS >> 20);
    else
        rc =
            compile_add(scene, RAD_BUNDLE_VIEWS, out.buf, out.len, folder, err);
    wire_out_release(&out);
    if (rc < 0)
        return rc;
    rad_sha_from_hex(
        rad_bundle_find(b, RAD_BUNDLE_FILE, RAD_BUNDLE_VIEWS)->hash, j->views);
    j->spec.views = j->views;
    note_sizes(&j->spec, frames);
    return 0;
}

/* Write the lines for the pictures' headers; with --stamp also the day, the
 * host and the job. */
static void
tell_origin(struct jobspec *j, const struct submit_options *o)
{
    char host[256] = "";
    struct origin_stamp stamp = { time(NULL), host, j->id };

    if (o->stamp)
        gethostname(host, sizeof host - 1);
    origin_text(j->origin, (const char *const *)o->scenes, o->nscenes,
                o->stamp ? &stamp : NULL);
}

/* Most frames of a job with a goal: its stages go over all frames before the
 * first picture is made, so with more frames that would come too late. */
#define MOST_AT_ONCE 32

bool
jobspec_passes(const struct submit_options *o)
{
    if (submit_options_goal(o) || o->reuse)
        return true;
    if (o->ambient_way == AMBIENT_NONE)
        return !o->no_share && !o->fresh_frames;
    return o->ambient_way == AMBIENT_PASSES;
}

static uint32_t
ambient_flags(const struct submit_options *o)
{
    if (jobspec_passes(o))
        return MSG_JOB_PASSES;
    return o->no_share ? 0 : MSG_JOB_SHARE;
}

int
jobspec_set_scene(struct jobspec *j, const struct submit_options *o,
                  const struct compiled *scene, struct rad_error *err)
{
    char hex[RAD_SHA_HEX + 1];
    int rc;

    if (o->reuse && !submit_options_cache(o))
        return rad_fail(err, RAD_EUSAGE,
                        "--reuse is for ambient values: -ab, -aa and -ad must "
                        "not be 0");
    if (!submit_options_cache(o))
        return 0;
    rc = compile_name(scene, hex, err);
    if (rc < 0)
        return rc;
    rad_sha_from_hex(hex, j->scene);
    j->spec.scene = j->scene;
    if (o->reuse && strcmp(o->reuse, "last") != 0)
        msg_job_parse(o->reuse, j->reuse);
    if (o->reuse)
        j->spec.reuse = j->reuse;
    return 0;
}

/* Flags of jobs that may leave their cache to others, or begin with another's.
 */
static uint32_t
reuse_flags(const struct msg_spec *s)
{
    if (!(s->flags & MSG_JOB_PASSES) || !s->scene)
        return 0;
    return MSG_JOB_SCENE | (s->reuse ? MSG_JOB_REUSE : 0);
}

int
jobspec_check_goal(const struct submit_options *o, uint32_t nframes,
                   struct rad_error *err)
{
    if (submit_options_goal(o) && nframes > MOST_AT_ONCE)
        return rad_fail(err, RAD_EUSAGE,
                        "%s looks at all frames before the first is made: at "
                        "most %d frames, and there are %" PRIu32,
                        o->error > 0 ? "--error" : "--time", MOST_AT_ONCE,
                        nframes);
    return 0;
}

int
jobspec_check_windows(const struct submit_options *o,
                      const struct frames *frames, struct rad_error *err)
{
    uint64_t all = 0;

    for (uint32_t i = 0; i < frames->n; i++) {
        const struct msg_frame *f = &frames->list[i];
        uint64_t pixels = (uint64_t)f->width * f->height;

        /* a window has a pixel at least */
        all += pixels < (uint64_t)o->windows ? pixels : (uint64_t)o->windows;
    }
    if (all > MSG_MAX_WINDOWS)
        return rad_fail(err, RAD_EUSAGE,
                        "option '--windows': all frames together have %" PRIu64
                        ", and a job at most %d",
                        all, MSG_MAX_WINDOWS);
    return 0;
}

/* May a picture of the job be shown on a screen, as colours? */
static bool
is_shown(const struct submit_options *o)
{
    return o->preview || o->detach ||
           picfile_is_png(o->output, (enum picfile_format)o->format);
}

/* Of several planes each would part the samples of a pixel otherwise: their
 * edges cannot be joined. */
static uint32_t
edge_flags(const struct submit_options *o)
{
    return o->oversample > 1 && is_shown(o) && !o->points.file &&
                   submit_options_planes(o) == 0 && !o->false_colour
               ? MSG_JOB_EDGES
               : 0;
}

void
jobspec_fill(struct jobspec *j, const struct submit_options *o,
             const struct frames *frames, const struct compiled *scene,
             const struct cargo *cargo)
{
    struct msg_spec *s = &j->spec;

    rad_params_format(&o->params, j->params, sizeof j->params);
    rad_filter_options(&o->params, o->oversample, o->clamp, j->options);
    list_needs(j, scene->scene);
    tell_origin(j, o);
    /* a scene that is a command may be long */
    rad_text_print(j->name, sizeof j->name, "%s",
                   o->name ? o->name : o->scenes[0]);
    s->job = j->id;
    s->manifest = cargo->hashes;
    s->name = j->name;
    s->params = j->params;
    s->origin = j->origin;
    s->needs = j->needs;
    s->estimate = o->estimate ? o->estimate : "uniform";
    s->costs = j->costs;
    s->ncosts = j->ncosts;
    s->seed = o->params.seed;
    s->priority = o->priority;
    s->memory_mib = (uint32_t)o->memory_mib;
    s->oversample = (uint8_t)o->oversample;
    s->clamp = o->clamp;
    s->error_ppm = (uint32_t)lround(o->error * 1e4);
    s->time_ms = (uint32_t)lround(o->time_s * 1e3);
    s->flags = (o->points.file ? MSG_JOB_DEPTH | MSG_JOB_POINTS
                : o->depth     ? MSG_JOB_DEPTH
                               : 0) |
               ambient_flags(o) | (o->no_balance ? MSG_JOB_NO_BALANCE : 0) |
               (o->fresh_frames ? MSG_JOB_FRESH_FRAMES : 0) |
               (o->same_bits ? MSG_JOB_SAME_BITS : 0) |
               (s->views ? MSG_JOB_VIEWS : 0) | edge_flags(o);
    s->partition = choose_partition(o);
    /* both enums have the same order */
    s->order = o->order == ORDER_NONE ? MSG_ORDER_COST : (uint8_t)o->order;
    s->windows = (uint32_t)o->windows;
    s->objects = (uint32_t)scene->scene->nobjects;
    s->bundle_bytes = rad_bundle_bytes(&scene->bundle) + cargo->manifest_len;
    s->files.n = cargo->n;
    s->files.hash = cargo->hashes;
    s->nframes = frames->n;
    s->frames = frames->list;
    s->flags |= reuse_flags(s);
}

void
jobspec_release(struct jobspec *j)
{
    free(j->costs);
    j->costs = NULL;
}
