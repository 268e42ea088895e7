/* program_planes.c - a job for each plane of -cs; joins their pictures; see
 * program_planes.h
 *
 * All jobs are submitted before the first is awaited.  So they go on if
 * radsubmit ends, and workers can begin the next plane when one is nearly done.
 * The scene's files are sent once.  All pictures of a plane come before those
 * of the next; they are kept in files, as they came, until those of the last
 * plane come. */
#include "config.h"

#include "program_planes.h"

#include "base/files.h"
#include "base/output.h"
#include "base/text.h"
#include "link/local.h"
#include "link/order.h"
#include "show/spectra.h"
#include "program_files.h"
#include "program_say.h"

#include <inttypes.h>
#include <jansson.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct planes {
    struct program *program;
    const struct submit_callbacks *own; /* the caller's */
    uint8_t id[RAD_MAX_PLANES][MSG_JOB];
    json_t *stats; /* of each plane; NULL: not wanted */
};

/* Begin the job's name with its batch and plane, so that a user can tell such
 * jobs apart even in lists that cut long names. */
static void
name_part(struct program *p)
{
    char which[80] = "";
    int n = 0;

    if (p->stream.is)
        n = snprintf(which, sizeof which, "batch %" PRIu64 ": ",
                     p->stream.batch);
    if (p->planes.n > 1)
        n += snprintf(which + n, sizeof which - (size_t)n,
                      "plane %d of %d: ", p->planes.at + 1, p->planes.n);
    if (n == 0)
        return;
    rad_text_print(p->part_name, sizeof p->part_name, "%s%s", which,
                   p->job.spec.name);
    p->job.spec.name = p->part_name;
}

void
program_fill_spec(struct program *p)
{
    struct submit_options o = p->o;

    if (p->planes.n > 1)
        o.params.bands.plane = p->planes.at;
    if (p->planes.n > 0) /* channels of a plane have no primaries */
        o.params.primaries = RAD_PRIM_RGB;
    jobspec_fill(&p->job, &o, &p->frames, &p->scene, &p->cargo);
    name_part(p);
    p->job.spec.compile_s = p->compile_s;
    if (p->records.keep)
        p->job.spec.flags |= MSG_JOB_RECORDS;
}

/* What is kept of a plane: pictures, and distances or points' values (DEPTH).
 * Distances are kept of the first plane only, for all planes have the same. */
enum kept { PICTURE, DEPTH };

static void
name_kept(const struct planes *s, enum kept what, int plane, uint32_t frame,
          char path[PATH_MAX])
{
    snprintf(path, PATH_MAX, "%s/plane-%d-%d-%" PRIu32,
             local_folder(s->program->cluster.local), (int)what, plane, frame);
}

static int
keep(const struct planes *s, enum kept what, uint32_t frame,
     const struct rad_memory_out *f, struct rad_error *err)
{
    char path[PATH_MAX];

    name_kept(s, what, s->program->planes.at, frame, path);
    return rad_output_write(path, f->bytes, f->len, false, err);
}

/* Read a kept file and remove it; the caller frees f->bytes. */
static int
take_kept(const struct planes *s, enum kept what, int plane, uint32_t frame,
          struct rad_memory_out *f, struct rad_error *err)
{
    char path[PATH_MAX];

    name_kept(s, what, plane, frame, path);
    f->bytes = rad_file_read(path, SIZE_MAX / 2, &f->len, err);
    unlink(path);
    return f->bytes ? 0 : err->code;
}

/* --- the last plane of a frame has come ----------------------------------- */

static int
deliver_picture(struct planes *s, uint32_t frame, bool has_depth,
                struct rad_error *err)
{
    struct program *p = s->program;
    struct spectra_order order = { p->o.params.bands,
                                   submit_options_spectra(&p->o),
                                   p->o.params.primaries };
    struct spectra_plane plane[RAD_MAX_PLANES] = { { NULL, 0 } };
    struct rad_memory_out whole = { 0 }, depth = { 0 };
    struct rad_memory_out hdr[RAD_MAX_PLANES] = { { 0 } };
    int rc = 0;

    for (int k = 0; k < p->planes.n && rc == 0; k++) {
        rc = take_kept(s, PICTURE, k, frame, &hdr[k], err);
        plane[k] = (struct spectra_plane){ hdr[k].bytes, hdr[k].len };
    }
    if (rc == 0 && has_depth)
        rc = take_kept(s, DEPTH, 0, frame, &depth, err);
    if (rc == 0)
        rc = spectra_join(&order, plane, &whole.bytes, &whole.len, err);
    for (int k = 0; k < p->planes.n; k++)
        free(hdr[k].bytes);
    if (rc == 0)
        rc = program_on_frame(p, frame, &whole, &depth, err);
    free(whole.bytes);
    free(depth.bytes);
    return rc;
}

static int
deliver_points(struct planes *s, struct rad_error *err)
{
    struct program *p = s->program;
    struct pointwriter_light light = { .n = 0 };
    struct rad_memory_out values[RAD_MAX_PLANES] = { { 0 } };
    int rc = 0;

    for (int k = 0; k < p->planes.n && rc == 0; k++) {
        rc = take_kept(s, DEPTH, k, 0, &values[k], err);
        if (rc == 0 && k > 0 && values[k].len != light.len)
            rc = rad_fail(err, RAD_EPROTO, "planes of different sizes");
        light.plane[light.n++] = values[k].bytes;
        light.len = values[k].len;
    }
    progress_clear(&p->progress);
    if (rc == 0)
        rc = program_write_points(p, &light, err);
    for (int k = 0; k < p->planes.n; k++)
        free(values[k].bytes);
    return rc;
}

/* Show the bands of a job's picture, which may not be whole, in colours. */
static int
preview(struct program *p, bool whole, const uint8_t *picture, size_t len,
        struct rad_error *err)
{
    struct spectra_order order = { p->o.params.bands, false, RAD_PRIM_RGB };
    struct spectra_plane plane = { picture, len };
    uint8_t *colours;
    size_t n;
    int rc = spectra_join(&order, &plane, &colours, &n, err);

    if (rc < 0)
        return rc;
    if (whole)
        program_show_whole(p, colours, n);
    else
        program_on_preview(p, colours, n, err);
    free(colours);
    return 0;
}

static int
on_preview(void *arg, const uint8_t *picture, size_t len, struct rad_error *err)
{
    return preview(arg, false, picture, len, err);
}

static int
on_frame(void *arg, uint32_t frame, const struct rad_memory_out *picture,
         const struct rad_memory_out *depth, struct rad_error *err)
{
    struct program *p = arg;
    struct planes *s = p->planes.jobs;
    bool points = p->o.points.file;
    int rc = 0;

    if (picture->bytes)
        rc = keep(s, PICTURE, frame, picture, err);
    if (rc == 0 && depth->bytes && (points || p->planes.at == 0))
        rc = keep(s, DEPTH, frame, depth, err);
    if (rc < 0 || p->planes.at < p->planes.n - 1)
        return rc;
    rc = points ? deliver_points(s, err)
                : deliver_picture(s, frame, depth->bytes != NULL, err);
    if (rc == 0 && p->o.preview && submit_options_spectra(&p->o))
        rc = preview(p, true, picture->bytes, picture->len, err);
    return rc;
}

static int
on_stats(void *arg, const uint8_t *json, size_t len, struct rad_error *err)
{
    struct program *p = arg;
    struct planes *s = p->planes.jobs;
    json_t *of_plane = json_loadb((const char *)json, len, 0, NULL), *all;
    char *text;
    int rc;

    if (!of_plane)
        return rad_fail(err, RAD_EPROTO, "the statistics are no JSON");
    json_array_append_new(s->stats, of_plane);
    if (p->planes.at < p->planes.n - 1)
        return 0;
    all = json_pack("{sO}", "planes", s->stats);
    text = json_dumps(all, JSON_INDENT(1));
    json_decref(all);
    rc = text ? s->own->stats(p, (const uint8_t *)text, strlen(text), err)
              : rad_fail_memory(err);
    free(text);
    return rc;
}

static void
on_accepted(void *arg)
{
    struct program *p = arg;
    char hex[MSG_JOB_HEX], text[120];

    msg_job_format(p->job.id, hex);
    snprintf(text, sizeof text, "job %s, plane %d of %d", hex, p->planes.at + 1,
             p->planes.n);
    program_say(p, text); /* by these ids planes are found again */
}

/* Callbacks for the job of one plane of several: the caller's, without previews
 * and records. */
static struct submit_callbacks
callbacks(const struct planes *s)
{
    struct submit_callbacks cb = *s->own;

    cb.frame = on_frame;
    if (cb.stats)
        cb.stats = on_stats;
    cb.accepted = NULL;
    cb.preview = NULL;
    cb.records = NULL;
    return cb;
}

/* --- jobs ----------------------------------------------------------------- */

static void
turn_to(struct planes *s, int plane)
{
    struct program *p = s->program;

    p->planes.at = plane;
    memcpy(p->job.id, s->id[plane], MSG_JOB);
    program_fill_spec(p);
}

/* Cancel the jobs of all planes: nobody will get their pictures. */
static void
cancel_all(struct planes *s, const struct submit_job *job)
{
    for (int k = 0; k < s->program->planes.n; k++)
        if (order_cancel(&job->to, &s->program->loop.uv, s->id[k]) < 0)
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
    for (int k = 0; k < p->planes.n && rc == 0; k++) {
        turn_to(s, k);
        rc = submit_run(job, &p->loop.uv, &p->loop.interrupts, &cb, p->err);
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

    cb.reuse = NULL; /* the user was told when it was submitted */
    for (int k = 0; k < p->planes.n && rc == 0; k++) {
        turn_to(s, k);
        rc = submit_run(job, &p->loop.uv, &p->loop.interrupts, &cb, p->err);
        program_end_job(p);
    }
    return rc;
}

/* Have one job show all bands, as any job goes. */
static int
run_one(struct planes *s, const struct submit_job *job)
{
    struct program *p = s->program;
    struct submit_callbacks cb = *s->own;
    int rc;

    cb.frame = on_frame;
    if (cb.preview)
        cb.preview = on_preview;
    turn_to(s, 0);
    rc = submit_run(job, &p->loop.uv, &p->loop.interrupts, &cb, p->err);
    program_end_job(p);
    return rc;
}

static int
run_many(struct planes *s, const struct submit_job *ask)
{
    const struct program *p = s->program;
    struct submit_job job = *ask;
    int rc;

    job.with = " and the ids of the other planes";
    rc = submit_all(s, &job);
    if (rc == 0 && !ask->detach)
        rc = collect_all(s, &job);
    /* leave the jobs to go on, as with a single job, if an interrupt ends
     * radsubmit at once or a picture could not be written */
    if (rc < 0 && !p->cluster.embedded && p->loop.interrupts < 2 &&
        !p->rescue.needed)
        cancel_all(s, &job);
    return rc;
}

/* --detach: print each job's id on a line. */
static void
print_ids(const struct planes *s)
{
    char hex[MSG_JOB_HEX];

    for (int k = 0; k < s->program->planes.n; k++) {
        msg_job_format(s->id[k], hex);
        puts(hex);
    }
}

static int
begin(struct planes *s)
{
    struct program *p = s->program;
    int rc = 0;

    for (int k = 0; k < p->planes.n && rc == 0; k++) {
        rc = jobspec_name(&p->job, p->err);
        memcpy(s->id[k], p->job.id, MSG_JOB);
    }
    s->stats = json_array();
    if (rc == 0 && !s->stats)
        rc = rad_fail_memory(p->err);
    return rc;
}

int
program_run_planes(struct program *p, const struct submit_job *ask,
                   const struct submit_callbacks *cb)
{
    struct planes s = { .program = p, .own = cb };
    int rc = begin(&s);

    p->planes.jobs = &s;
    if (rc == 0)
        rc = p->planes.n > 1 ? run_many(&s, ask) : run_one(&s, ask);
    if (rc == 0 && ask->detach)
        print_ids(&s);
    for (int k = 0; k < p->planes.n && rc == 0 && p->stream.is; k++)
        order_delete(&ask->to, &p->loop.uv, s.id[k]);
    p->planes.jobs = NULL;
    json_decref(s.stats);
    return rc;
}
