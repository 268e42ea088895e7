/* program_planes.c - a job for each plane of -cs, and their pictures put
 * together; see program.h
 *
 * All jobs are submitted before the first is waited for, so that they go on
 * whatever becomes of radsubmit, and workers have the next plane at hand when
 * one is nearly done.  The scene's files are sent once.  Pictures come plane by
 * plane, all of a plane first: until the last plane's they lie in files, coded
 * as they came. */
#include "config.h"

#include "program.h"

#include "base/files.h"
#include "base/output.h"
#include "link/local.h"
#include "link/order.h"
#include "show/spectra.h"

#include <inttypes.h>
#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct planes {
    struct program *program;
    uint8_t id[RAD_MAX_PLANES][MSG_JOB];
    json_t *stats; /* of each plane; NULL: not wanted */
};

/* So that people tell the jobs of a picture, or of a stream of points, apart,
 * in lists that cut long names short, too. */
static void
name_part(struct program *p)
{
    char which[80] = "";
    int n = 0;

    if (p->streams)
        n = snprintf(which, sizeof which, "batch %" PRIu64 ": ", p->batch);
    if (p->nplanes > 1)
        n += snprintf(which + n, sizeof which - (size_t)n,
                      "plane %d of %d: ", p->plane + 1, p->nplanes);
    if (n == 0)
        return;
    snprintf(p->part_name, sizeof p->part_name, "%s%.*s", which,
             MSG_MAX_LABEL - n, p->job.spec.name);
    p->job.spec.name = p->part_name;
}

void
program_fill_spec(struct program *p)
{
    struct submit_options o = p->o;

    if (p->nplanes > 1) { /* which know of no colour */
        o.params.bands.plane = p->plane;
        o.params.primaries = RAD_PRIM_RGB;
    }
    jobspec_fill(&p->job, &o, &p->frames, &p->scene, &p->cargo);
    name_part(p);
    p->job.spec.compile_s = p->compile_s;
    if (p->records.keep)
        p->job.spec.flags |= MSG_JOB_RECORDS;
    if (p->job.spec.flags & MSG_JOB_PASSES && p->o.params.ambounce > 0)
        progress_expect_passes(&p->progress);
}

/* Of a plane what is not its picture: distances, or values of points.  Of
 * distances the first plane's are kept, for all have the same. */
enum kept { PICTURE, DEPTH };

static void
name_kept(const struct planes *s, enum kept what, int plane, uint32_t frame,
          char path[PATH_MAX])
{
    snprintf(path, PATH_MAX, "%s/plane-%d-%d-%" PRIu32,
             local_folder(s->program->local), (int)what, plane, frame);
}

static int
keep(const struct planes *s, enum kept what, uint32_t frame, const uint8_t *p,
     size_t n, struct rad_error *err)
{
    char path[PATH_MAX];

    name_kept(s, what, s->program->plane, frame, path);
    return rad_output_write(path, p, n, false, err);
}

/* The bytes, to be freed, and the file is gone; NULL with *err set. */
static uint8_t *
take_kept(const struct planes *s, enum kept what, int plane, uint32_t frame,
          size_t *n, struct rad_error *err)
{
    char path[PATH_MAX];
    uint8_t *bytes;

    name_kept(s, what, plane, frame, path);
    bytes = rad_file_read(path, SIZE_MAX / 2, n, err);
    unlink(path);
    return bytes;
}

/* --- the last plane of a frame is there ----------------------------------- */

static int
deliver_picture(struct planes *s, uint32_t frame, bool has_depth,
                struct rad_error *err)
{
    struct program *p = s->program;
    struct spectra_order order = { p->o.params.bands,
                                   submit_options_spectra(&p->o),
                                   p->o.params.primaries };
    struct spectra_plane plane[RAD_MAX_PLANES] = { { NULL, 0 } };
    uint8_t *whole = NULL, *depth = NULL, *hdr[RAD_MAX_PLANES] = { NULL };
    size_t n = 0, depth_len = 0;
    int rc = 0;

    for (int k = 0; k < p->nplanes && rc == 0; k++) {
        hdr[k] = take_kept(s, PICTURE, k, frame, &plane[k].len, err);
        plane[k].hdr = hdr[k];
        rc = hdr[k] ? 0 : err->code;
    }
    if (rc == 0 && has_depth) {
        depth = take_kept(s, DEPTH, 0, frame, &depth_len, err);
        rc = depth ? 0 : err->code;
    }
    if (rc == 0)
        rc = spectra_join(&order, plane, &whole, &n, err);
    for (int k = 0; k < p->nplanes; k++)
        free(hdr[k]);
    if (rc == 0)
        rc = program_on_frame(p, frame, whole, n, depth, depth_len, err);
    free(whole);
    free(depth);
    return rc;
}

static int
deliver_points(struct planes *s, struct rad_error *err)
{
    struct program *p = s->program;
    struct pointwriter_light light = { .n = 0 };
    uint8_t *values[RAD_MAX_PLANES] = { NULL };
    size_t n;
    int rc = 0;

    for (int k = 0; k < p->nplanes && rc == 0; k++) {
        values[k] = take_kept(s, DEPTH, k, 0, &n, err);
        rc = values[k] ? 0 : err->code;
        if (rc == 0 && k > 0 && n != light.len)
            rc = rad_fail(err, RAD_EPROTO, "planes of different sizes");
        light.plane[light.n++] = values[k];
        light.len = n;
    }
    progress_clear(&p->progress);
    if (rc == 0)
        rc = program_write_points(p, &light, err);
    for (int k = 0; k < p->nplanes; k++)
        free(values[k]);
    return rc;
}

static int
on_frame(void *arg, uint32_t frame, const uint8_t *picture, size_t len,
         const uint8_t *depth, size_t depth_len, struct rad_error *err)
{
    struct planes *s = arg;
    struct program *p = s->program;
    bool points = p->o.points.file;
    int rc = 0;

    if (picture)
        rc = keep(s, PICTURE, frame, picture, len, err);
    if (rc == 0 && depth && (points || p->plane == 0))
        rc = keep(s, DEPTH, frame, depth, depth_len, err);
    if (rc < 0 || p->plane < p->nplanes - 1)
        return rc;
    return points ? deliver_points(s, err)
                  : deliver_picture(s, frame, depth != NULL, err);
}

static int
on_stats(void *arg, const uint8_t *json, size_t len, struct rad_error *err)
{
    struct planes *s = arg;
    json_t *of_plane = json_loadb((const char *)json, len, 0, NULL), *all;
    char *text;
    int rc;

    if (!of_plane)
        return rad_fail(err, RAD_EPROTO, "the statistics are no JSON");
    json_array_append_new(s->stats, of_plane);
    if (s->program->plane < s->program->nplanes - 1)
        return 0;
    all = json_pack("{sO}", "planes", s->stats);
    text = json_dumps(all, JSON_INDENT(1));
    json_decref(all);
    rc = text ? s->program->callbacks->stats(s->program, (const uint8_t *)text,
                                             strlen(text), err)
              : rad_fail(err, RAD_ENOMEM, "out of memory");
    free(text);
    return rc;
}

/* --- callbacks that are the program's own --------------------------------- */

static void
on_say(void *arg, const char *text)
{
    program_say(((struct planes *)arg)->program, text);
}

static void
on_accepted(void *arg)
{
    struct program *p = ((struct planes *)arg)->program;
    char hex[MSG_JOB_HEX], text[120];

    msg_job_format(p->job.id, hex);
    snprintf(text, sizeof text, "job %s, plane %d of %d", hex, p->plane + 1,
             p->nplanes);
    program_say(p, text);
}

static void
on_progress(void *arg, const struct msg_progress *m)
{
    struct planes *s = arg;

    s->program->callbacks->progress(s->program, m);
}

static void
on_reuse(void *arg, const uint8_t *from)
{
    struct program *p = ((struct planes *)arg)->program;

    p->callbacks->reuse(p, from);
}

static void
on_reason(void *arg, const char *why)
{
    struct program *p = ((struct planes *)arg)->program;

    p->callbacks->reason(p, why);
}

static bool
on_wonders(void *arg)
{
    return ((struct planes *)arg)->program->wonders;
}

static int
on_alive(void *arg, struct rad_error *err)
{
    struct program *p = ((struct planes *)arg)->program;

    return p->callbacks->alive(p, err);
}

static int
on_gathered(void *arg, int n, const char *names, struct rad_error *err)
{
    struct program *p = ((struct planes *)arg)->program;

    return p->callbacks->gathered(p, n, names, err);
}

/* Whatever the program asks for is asked of each plane. */
static struct submit_callbacks
callbacks(struct planes *s)
{
    const struct submit_callbacks *own = s->program->callbacks;
    struct submit_callbacks cb = { .say = on_say,
                                   .progress = on_progress,
                                   .wonders = on_wonders,
                                   .frame = on_frame,
                                   .arg = s };

    cb.stats = own->stats ? on_stats : NULL;
    cb.reuse = own->reuse ? on_reuse : NULL;
    cb.reason = own->reason ? on_reason : NULL;
    cb.alive = own->alive ? on_alive : NULL;
    cb.gathered = own->gathered ? on_gathered : NULL;
    return cb;
}

/* --- jobs ----------------------------------------------------------------- */

static void
turn_to(struct planes *s, int plane)
{
    struct program *p = s->program;

    p->plane = plane;
    memcpy(p->job.id, s->id[plane], MSG_JOB);
    program_fill_spec(p);
}

/* Cancel the jobs of planes whose pictures nobody will take. */
static void
cancel_from(struct planes *s, int first, const struct submit_job *job)
{
    for (int k = first; k < s->program->nplanes; k++)
        if (order_cancel(&job->to, &s->program->loop, s->id[k]) < 0)
            return;
}

static int
submit_all(struct planes *s, struct submit_job *job)
{
    struct program *p = s->program;
    struct submit_callbacks cb = callbacks(s);
    int rc = 0;

    cb.accepted = on_accepted;
    job->detach = true;
    for (int k = 0; k < p->nplanes && rc == 0; k++) {
        turn_to(s, k);
        rc = submit_run(job, &p->loop, &p->interrupts, &cb, p->err);
    }
    job->detach = false;
    return rc;
}

static int
collect_all(struct planes *s, struct submit_job *job)
{
    struct program *p = s->program;
    struct submit_callbacks cb = callbacks(s);
    int rc = 0;

    cb.reuse = NULL; /* that was said */
    for (int k = 0; k < p->nplanes && rc == 0; k++) {
        turn_to(s, k);
        rc = submit_run(job, &p->loop, &p->interrupts, &cb, p->err);
        if (rc == 0)
            program_warn_of_nan(p);
    }
    return rc;
}

/* --detach: one a line. */
static void
print_ids(struct planes *s)
{
    char hex[MSG_JOB_HEX];

    for (int k = 0; k < s->program->nplanes; k++) {
        msg_job_format(s->id[k], hex);
        puts(hex);
    }
    json_decref(s->stats);
}

static int
begin(struct planes *s)
{
    struct program *p = s->program;
    int rc = 0;

    for (int k = 0; k < p->nplanes && rc == 0; k++) {
        rc = jobspec_name(&p->job, p->err);
        memcpy(s->id[k], p->job.id, MSG_JOB);
    }
    s->stats = json_array();
    if (rc == 0 && !s->stats)
        rc = rad_fail(p->err, RAD_ENOMEM, "out of memory");
    return rc;
}

int
program_run_planes(struct program *p, const struct submit_job *ask,
                   const struct submit_callbacks *cb)
{
    struct planes s = { .program = p };
    struct submit_job job = *ask;
    int rc = begin(&s);

    p->callbacks = cb;
    if (rc == 0)
        rc = submit_all(&s, &job);
    if (rc == 0 && ask->detach) {
        print_ids(&s);
        return 0;
    }
    if (rc == 0)
        rc = collect_all(&s, &job);
    for (int k = 0; k < p->nplanes && rc == 0 && p->streams; k++)
        order_delete(&job.to, &p->loop, s.id[k]);
    /* an interrupt that ends radsubmit at once leaves them to go on, and so
     * does a picture that cannot be written, as with one job */
    if (rc < 0 && !p->embedded && p->interrupts < 2 && !p->unwritten)
        cancel_from(&s, 0, &job);
    json_decref(s.stats);
    return rc;
}
