/* program_job.c - a job from its scene to its last picture; see program_job.h
 */
#include "config.h"

#include "program_job.h"

#include "common/tell.h"
#include "link/launch.h"
#include "link/local.h"
#include "trial/dryrun.h"
#include "program_cluster.h"
#include "program_files.h"
#include "program_planes.h"
#include "program_say.h"
#include "program_scene.h"
#include "program_stream.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --- what the conversation tells (submit.h) --- */

static void
on_records(void *arg, const struct msg_records *m)
{
    struct program *p = arg;

    records_take(&p->records, m);
}

static void
on_progress(void *arg, const struct msg_progress *m)
{
    struct program *p = arg;

    if (p->cluster.launch)
        launch_note_workers(p->cluster.launch, (int)m->workers);
    program_on_progress(p, m);
}

/* Tell the job's id, by which the user can find the job, when the coordinator
 * has it. */
static void
on_accepted(void *arg)
{
    struct program *p = arg;
    char hex[MSG_JOB_HEX], text[60];

    msg_job_format(p->job.id, hex);
    snprintf(text, sizeof text, "job %s", hex);
    program_news(p, text);
}

static void
on_reuse(void *arg, const uint8_t *from)
{
    char hex[MSG_JOB_HEX], text[120];

    if (!from) {
        program_news(arg, "no former job has ambient values that fit: the job "
                          "begins without");
        return;
    }
    msg_job_format(from, hex);
    snprintf(text, sizeof text, "begins with the ambient values of job %s",
             hex);
    program_news(arg, text);
}

static bool
on_wonders(void *arg)
{
    return ((struct program *)arg)->said.wonders;
}

/* Tell the coordinator's reason why no worker is at the job, each reason once.
 */
static void
on_reason(void *arg, const char *why)
{
    struct program *p = arg;
    char text[sizeof p->said.reason + 40];

    if (why[0] == '\0' ||
        strncmp(why, p->said.reason, sizeof p->said.reason - 1) == 0)
        return;
    snprintf(p->said.reason, sizeof p->said.reason, "%s", why);
    snprintf(text, sizeof text, "the coordinator says: %s", p->said.reason);
    program_say(p, text);
}

/* --- the job --- */

/* A job's layout depends on the workers that are there when it comes; the first
 * one counts as there. */
static bool
gathers(const struct program *p)
{
    return p->cluster.launch ||
           (p->cluster.embedded && program_cluster_workers(&p->o) > 1);
}

static struct submit_callbacks
callbacks_of(struct program *p)
{
    bool embedded = p->cluster.embedded;
    bool asks_stats = p->o.stats || submit_options_goal(&p->o);

    return (struct submit_callbacks){
        .say = program_say,
        .accepted = on_accepted,
        .progress = on_progress,
        .wonders = on_wonders,
        .frame = program_on_frame,
        .preview = p->o.preview ? program_on_preview : NULL,
        .reuse = p->o.reuse ? on_reuse : NULL,
        .stats = asks_stats ? program_on_stats : NULL,
        .records = p->records.keep ? on_records : NULL,
        .reason = !embedded || p->cluster.launch ? on_reason : NULL,
        .alive = embedded ? program_cluster_alive : NULL,
        .gathered = gathers(p) ? program_cluster_gathered : NULL,
        .arg = p
    };
}

static int
converse(struct program *p)
{
    struct submit_callbacks cb = callbacks_of(p);
    struct submit_job job = { .spec = &p->job.spec,
                              .cargo = &p->cargo,
                              .to = p->cluster.target,
                              .wait_s = p->o.wait_s,
                              .with = program_lone_plane(p),
                              .detach = p->o.detach };
    int rc;

    if (p->stream.is) {
        rc = program_run_stream(p, &job, &cb);
    } else if (p->planes.n > 0) {
        rc = program_run_planes(p, &job, &cb);
    } else {
        rc = submit_run(&job, &p->loop.uv, &p->loop.interrupts, &cb, p->err);
        program_end_job(p);
    }
    if (rc == 0)
        rc = records_write(&p->records, !p->cluster.embedded, p->err);
    if (rc == 0 && p->preview.why.code != 0) {
        *p->err = p->preview.why;
        rc = p->preview.why.code;
    }
    progress_clear(&p->progress);
    program_warn_of_dark(p);
    program_warn_of_faults(p);
    if (rc == 0 && !p->o.detach)
        program_say_done(p);
    return rc;
}

/* Read the -af file; a batch of points begins with the records of earlier
 * batches. */
static int
begin_records(struct program *p)
{
    int rc;

    if (p->stream.is && !p->o.ambient)
        p->records.keep = p->job.spec.scene && p->planes.n <= 1 &&
                          !submit_options_goal(&p->o);
    if (!p->o.ambient && !p->records.keep)
        return 0;
    rc = records_begin(&p->records, p->o.ambient, p->records.keep, &p->o.params,
                       &p->scene, p->err);
    return rc < 0 || p->stream.is
               ? rc
               : records_add(&p->records, &p->scene,
                             local_folder(p->cluster.local), p->err);
}

static int
add_points(struct program *p)
{
    if (!p->o.points.file || p->stream.is)
        return 0;
    return pointjob_add(&p->points, &p->scene, local_folder(p->cluster.local),
                        p->err);
}

int
program_run_job(struct program *p)
{
    static const struct pointwriter_light dark = { .n = 0 };
    char hex[MSG_JOB_HEX];
    int rc;

    if ((rc = program_compile(p)) < 0 ||
        (rc = jobspec_set_scene(&p->job, &p->o, &p->scene, p->err)) < 0 ||
        (rc = begin_records(p)) < 0 ||
        (rc = jobspec_add_frames(&p->job, &p->frames, &p->scene,
                                 local_folder(p->cluster.local), p->err)) < 0 ||
        (rc = add_points(p)) < 0 ||
        (rc = cargo_init(&p->cargo, &p->scene.bundle,
                         local_folder(p->cluster.local), p->err)) < 0)
        return rc;
    program_warn_of_scene(p);
    program_fill_spec(p);
    if (p->o.points.file && !p->stream.is && !pointspec_lit(&p->o.points)) {
        rc = program_write_points(p, &dark, p->err);
        return rc < 0 ? rc : program_write_stats_of_none(p);
    }
    if (p->cluster.embedded && (!p->stream.is || pointspec_lit(&p->o.points)) &&
        (rc = program_cluster_start(p)) < 0)
        return rc;
    rc = converse(p);
    if (rc == 0 && p->o.detach && p->planes.n == 0) {
        msg_job_format(p->job.id, hex);
        puts(hex);
    }
    return rc;
}

/* The trial begins without values, and the job that it predicts may not. */
static void
say_of_former_values(const struct submit_options *o)
{
    if (o->ambient && access(o->ambient, R_OK) == 0)
        puts("reuse    without the ambient values that the job begins with");
}

int
program_run_dry(struct program *p)
{
    struct dryrun_cluster c = { .embedded = p->cluster.embedded };
    struct link_where where = { &p->loop.uv, &p->loop.interrupts };
    int rc;

    c.workers = program_cluster_workers(&p->o);
    c.threads = c.workers * local_threads(c.workers, p->o.threads);
    if (!p->cluster.embedded &&
        (rc = dryrun_ask(&c, &where, &p->cluster.target, p->err)) < 0)
        return rc;
    if ((rc = program_compile(p)) < 0 ||
        (rc = cargo_init(&p->cargo, &p->scene.bundle, NULL, p->err)) < 0)
        return rc;
    program_warn_of_scene(p);
    program_fill_spec(p);
    program_loop_free_signals(&p->loop, NULL);
    dryrun_print(&p->job.spec, &p->prediction,
                 p->o.quality_whole ? p->o.quality : -1, &c);
    say_of_former_values(&p->o);
    rc = tell_printed(
        p->err); /* before --stats, which may go to the same pipe */
    program_loop_catch_signals(&p->loop);
    if (rc < 0 || !p->o.stats)
        return rc;
    return program_write_stats(
        p, dryrun_json(&p->job.spec, p->job.options, &p->prediction, &c));
}
