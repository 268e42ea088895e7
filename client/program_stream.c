/* program_stream.c - sensor points that come on a pipe; see program_stream.h
 *
 * A batch of points is a job on the same scene; only its points and its ambient
 * records are sent anew.  With an ambient cache each batch begins with the
 * records of all batches before it, which radsubmit keeps as for -af; so the
 * cluster need not keep caches.  A batch's values are written before the next
 * batch is submitted, so they are in the order of the input.  Points are read
 * all the while (pointstream.h). */
#include "config.h"

#include "program_stream.h"

#include "link/local.h"
#include "link/order.h"
#include "program_files.h"
#include "program_planes.h"
#include "program_say.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

/* Sums of all batches. */
struct batches {
    json_t *stats; /* of each batch; NULL: not wanted */
    uint64_t points;
};

int
program_check_stream(struct program *p)
{
    const char *name = p->o.time_s > 0 ? "--time"
                       : p->o.costs    ? "--estimate=FILE"
                       : p->o.detach   ? "--detach"
                       : p->o.job      ? "--job"
                                       : NULL;

    if (name)
        return rad_fail(p->err, RAD_EUSAGE,
                        "%s is for one job, and points on a pipe make many: "
                        "write them to a file",
                        name);
    return frames_init_points(&p->frames, 1, 1, p->err);
}

static int
on_stats(void *arg, const uint8_t *json, size_t len, struct rad_error *err)
{
    struct program *p = arg;
    json_t *one = json_loadb((const char *)json, len, 0, NULL);

    if (!one)
        return rad_fail(err, RAD_EPROTO, "the statistics are no JSON");
    if (submit_options_goal(&p->o))
        program_note_goal(&p->result.goal, json, len);
    json_array_append_new(p->stream.sums->stats, one);
    return 0;
}

static int
write_stats(struct program *p)
{
    json_t *all = json_pack("{sO}", "batches", p->stream.sums->stats);
    char *text = json_dumps(all, JSON_INDENT(1));

    json_decref(all);
    return program_write_stats(p, text);
}

/* --- a batch -------------------------------------------------------------- */

/* Lay out the points of the next batch, as a job without a name.  At the end it
 * has no points. */
static int
take_batch(struct program *p)
{
    int rc;

    pointjob_release(&p->points);
    p->points.spec = &p->o.points;
    p->points.first = p->stream.input.in.taken;
    rc = pointstream_take(&p->stream.input, &p->points.in, p->err);
    if (rc < 0 || p->points.in.n == 0)
        return rc;
    if ((rc = pointjob_lay(&p->points, p->err)) < 0)
        return rc;
    frames_release(&p->frames);
    return frames_init_points(&p->frames, p->points.width, p->points.height,
                              p->err);
}

static int
load_cargo(struct program *p)
{
    const char *folder = local_folder(p->cluster.local);
    int rc = pointjob_add(&p->points, &p->scene, folder, p->err);

    if (rc == 0 && p->records.keep)
        rc = records_add(&p->records, &p->scene, folder, p->err);
    cargo_release(&p->cargo);
    return rc < 0 ? rc
                  : cargo_init(&p->cargo, &p->scene.bundle, folder, p->err);
}

static void
unload_cargo(struct program *p)
{
    const char *folder = local_folder(p->cluster.local);

    compile_drop(&p->scene, RAD_BUNDLE_POINTS, folder);
    compile_drop(&p->scene, RAD_BUNDLE_RECORDS, folder);
}

static int
render(struct program *p, struct submit_job *job,
       const struct submit_callbacks *cb)
{
    int rc = jobspec_name(&p->job, p->err);

    if (rc < 0 || (rc = load_cargo(p)) < 0)
        return rc;
    program_fill_spec(p);
    rc = p->planes.n > 0
             ? program_run_planes(p, job, cb)
             : submit_run(job, &p->loop.uv, &p->loop.interrupts, cb, p->err);
    unload_cargo(p);
    if (p->planes.n == 0)
        program_end_job(p);
    outcome_next(&p->result.sum);
    if (rc == 0 && p->planes.n == 0) /* it is of no use any more */
        order_delete(&job->to, &p->loop.uv, p->job.id);
    return rc;
}

/* --- all batches ---------------------------------------------------------- */

static int
run_batches(struct program *p, struct submit_job *job,
            struct submit_callbacks *cb)
{
    static const struct pointwriter_light dark = { .n = 0 };
    int rc;

    for (;;) {
        pointstream_wait(&p->stream.input, &p->loop.interrupts);
        if (p->loop.interrupts > 0)
            return rad_fail(p->err, RAD_ETEMPFAIL, "interrupted");
        if ((rc = take_batch(p)) < 0 || p->points.in.n == 0)
            return rc;
        p->stream.batch++;
        rc = pointspec_lit(&p->o.points)
                 ? render(p, job, cb)
                 : program_write_points(p, &dark, p->err);
        if (rc < 0)
            return rc;
        p->stream.sums->points += p->points.in.n;
        progress_clear(&p->progress);
        cb->accepted = NULL; /* only the first job's id is told */
        cb->reuse = NULL;
        p->job.spec.reuse = NULL; /* our records have them now */
    }
}

/* Fail if something was wrong after the last point, or if there was no point:
 * but rtrace answers nothing with nothing. */
static int
judge_end(struct program *p)
{
    if (p->stream.input.end.code != 0) {
        *p->err = p->stream.input.end;
        return p->err->code;
    }
    if (p->stream.batch == 0 && !p->o.rpict_status)
        return rad_fail(p->err, RAD_EDATA, "no sensor points in 'stdin'");
    if (pointjob_is_short(&p->points))
        program_warn(p, "warning: fewer points than -x and -y say");
    return 0;
}

int
program_run_stream(struct program *p, const struct submit_job *ask,
                   const struct submit_callbacks *own)
{
    struct batches s = { .stats = own->stats ? json_array() : NULL };
    struct submit_callbacks cb = *own;
    struct submit_job job = *ask;
    int rc, end;

    p->stream.sums = &s;
    cb.stats = own->stats ? on_stats : NULL;
    program_fill_text(p);
    rc = pointwriter_open(&p->stream.writer, &p->o.points, &p->text,
                          p->o.output, !p->cluster.embedded, p->err);
    if (rc == 0)
        rc = run_batches(p, &job, &cb);
    if (rc == 0)
        rc = judge_end(p);
    /* keep the values that were written before something failed */
    end = pointwriter_close(p->stream.writer, rc == 0 || s.points > 0,
                            rc < 0 ? NULL : p->err);
    rc = rc < 0 ? rc : end;
    if (rc == 0 && p->o.stats)
        rc = pointspec_lit(&p->o.points) ? write_stats(p)
                                         : program_write_stats_of_none(p);
    p->stream.sums = NULL;
    json_decref(s.stats);
    return rc;
}
