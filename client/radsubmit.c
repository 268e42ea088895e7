/* radsubmit.c - render a Radiance scene on a cluster; see radsubmit(1)
 *
 * The course of a run: the command line (submit_options), the pictures that it
 * asks for (frames), the scene's files (compile, cargo), the job's
 * specification (jobspec), a cluster of its own if none is named (local), the
 * conversation with the coordinator (submit).
 * The scene is compiled on a thread of libuv's pool, so that a signal can end
 * the program meanwhile. */
#include "config.h"

#include "program.h"

#include "job/apart.h"
#include "job/submit_parse.h"
#include "job/submit_table.h"
#include "compile/command.h"
#include "trial/dryrun.h"
#include "link/launch.h"
#include "link/local.h"
#include "link/programs.h"
#include "base/output.h"
#include "link/submit.h"
#include "common/tell.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

/* --- our own cluster, and callbacks of the job --- */

/* How many workers our own cluster is to have. */
static int
workers_wanted(const struct submit_options *o)
{
    return o->workers ? o->workers : 1;
}

static void
on_records(void *arg, const struct msg_records *m)
{
    struct program *p = arg;

    records_take(&p->records, m);
}

static int
on_alive(void *arg, struct rad_error *err)
{
    struct program *p = arg;

    if (p->cluster.launch)
        return launch_alive(p->cluster.launch, err);
    if (local_alive(p->cluster.local))
        return 0;
    return rad_fail(err, RAD_EINTERNAL,
                    "the cluster on this machine has ended");
}

/* Have the workers of our own cluster come?  Those of --local will be there
 * soon. */
static int
on_gathered(void *arg, int n, const char *names, struct rad_error *err)
{
    struct program *p = arg;
    char text[500], of[24];
    bool news;
    int rc;

    if (!p->cluster.launch)
        return n >= local_workers(p->cluster.local) ||
               (double)(uv_now(&p->loop.uv) - p->cluster.began_ms) >=
                   1000 * p->o.wait_s;
    rc = launch_gathered(p->cluster.launch, n, names, &news, err);
    snprintf(of, sizeof of, " of %d", workers_wanted(&p->o));
    snprintf(text, sizeof text, "%d%s workers there%s%s", n,
             n > workers_wanted(&p->o) ? "" : of, n > 0 ? ": " : "", names);
    if (news)
        program_news(p, text);
    return rc;
}

static void
on_progress(void *arg, const struct msg_progress *m)
{
    struct program *p = arg;

    if (p->cluster.launch)
        launch_note_workers(p->cluster.launch, (int)m->workers);
    program_on_progress(p, m);
}

/* --- signals --- */

/* An interrupt counts once.  A signal that ends a terminal's programs counts
 * twice, so that a job at a coordinator goes on. */
static void
on_signal(uv_signal_t *h, int signum)
{
    struct program_loop *l = h->data;

    l->interrupts += signum == SIGINT ? 1 : 2;
    uv_stop(&l->uv);
}

/* Are hang-ups ignored, by whoever started the program, such as nohup? */
static bool
hang_ups_ignored(void)
{
    struct sigaction now;

    return sigaction(SIGHUP, NULL, &now) == 0 && now.sa_handler == SIG_IGN;
}

static int
watch_signals(struct program_loop *l, struct rad_error *err)
{
    static const int which[] = { SIGINT, SIGTERM, SIGHUP };

    if (uv_loop_init(&l->uv) != 0)
        return rad_fail_memory(err);
    l->watched = true;
    signal(SIGPIPE, SIG_IGN);
    signal(SIGCHLD, SIG_DFL); /* ended processes must be waited for */
    for (int i = 0; i < 3; i++) {
        uv_signal_init(&l->uv, &l->signals[i]);
        l->signals[i].data = l;
        if (which[i] == SIGHUP && hang_ups_ignored())
            continue;
        uv_signal_start(&l->signals[i], on_signal, which[i]);
        uv_unref((uv_handle_t *)&l->signals[i]);
    }
    return 0;
}

static void
release_loop(struct program_loop *l)
{
    for (int i = 0; i < 3; i++)
        uv_close((uv_handle_t *)&l->signals[i], NULL);
    while (uv_loop_close(&l->uv) == UV_EBUSY)
        uv_run(&l->uv, UV_RUN_ONCE);
}

/* --- the scene --- */

/* --dry-run: predict the job. */
static int
try_scene(struct program *p)
{
    struct rad_params params = p->o.params;
    struct rad_points points;
    struct dryrun_job job = { .scene = p->scene.scene,
                              .files = compile_files(&p->scene),
                              .params = &params,
                              .frames = p->frames.list,
                              .nframes = p->frames.n };
    uint8_t *bytes = NULL;
    int rc = 0;

    if (p->planes.n > 1) /* each plane takes about as much as the first */
        params.bands.plane = 0;

    if (p->o.points.file)
        rc = pointjob_pack(&p->points, &points, &bytes, p->err);
    if (bytes)
        job.points = &points;
    if (rc == 0)
        rc = dryrun_predict(&p->prediction, &job, &dryrun_effort, p->err);
    if (rc == 0)
        trial_repeat(&p->prediction, p->planes.n);
    free(bytes);
    return rc;
}

/* What compile() shares with its thread. */
struct compiling {
    struct program *p;
    bool done;
    int rc;
};

static void
compile_work(uv_work_t *w)
{
    struct compiling *c = w->data;
    struct program *p = c->p;
    uint64_t begin = uv_hrtime();

    if (!p->scene.scene) {
        c->rc = compile_scene(&p->scene, (const char *const *)p->o.scenes,
                              p->o.nscenes, p->o.commands,
                              local_folder(p->cluster.local), p->err);
        p->compile_s = (double)(uv_hrtime() - begin) * 1e-9;
    }
    if (c->rc == 0 && p->o.dry_run && p->frames.n > 0)
        c->rc = try_scene(p);
}

static void
compile_done(uv_work_t *w, int status)
{
    (void)status;
    ((struct compiling *)w->data)->done = true;
}

/* Compile the scene.  An interrupt ends the whole program, for the thread
 * cannot be stopped.  It may be writing files, so our folder is left to its
 * keeper (local.c). */
static int
compile(struct program *p)
{
    struct compiling c = { .p = p };
    uv_work_t work = { .data = &c };

    if (uv_queue_work(&p->loop.uv, &work, compile_work, compile_done) != 0)
        return rad_fail_memory(p->err);
    while (!c.done) {
        uv_run(&p->loop.uv, UV_RUN_ONCE);
        if (p->loop.interrupts > 0 && !c.done) {
            command_stop_all();
            _exit(EX_TEMPFAIL);
        }
    }
    if (c.rc < 0)
        return c.rc;
    return apart_inputs(&p->o, &p->frames, &p->scene.paths.inputs, p->err);
}

/* If the scene is a file of rad's variables compile its scene now, for options
 * and views depend on its size; then *p is as if the command line had named
 * them. */
static int
take_rif(struct program *p)
{
    int rc = rifjob_begin(&p->rif, &p->o, &p->words, p->err);

    if (rc == 0 && p->rif.is && p->o.points.file)
        rc = rad_fail(p->err, RAD_EUSAGE,
                      "--points is for a scene, not for a .rif file");
    if (rc == 0 && !p->rif.is && p->o.rif_view)
        rc = rad_fail(p->err, RAD_EUSAGE, "--view is for a .rif file");
    if (rc < 0 || !p->rif.is)
        return rc;
    if ((rc = watch_signals(&p->loop, p->err)) < 0 ||
        (rc = local_new(&p->cluster.local, p->err)) < 0 ||
        (rc = compile(p)) < 0 ||
        (rc = rifjob_finish(&p->rif, &p->o, &p->words, &p->scene.octree,
                            p->err)) < 0)
        return rc;
    return frames_init_views(&p->frames, &p->o, p->rif.views, p->rif.nviews,
                             p->err);
}

/* --- the job --- */

static int
choose_cluster(struct program *p)
{
    int rc = 0;

    if (!p->o.local && !p->o.launch)
        rc =
            target_find(&p->cluster.target, p->o.coordinator, p->o.key, p->err);
    if (rc < 0)
        return rc;
    p->cluster.embedded = rc == 0;
    if (p->cluster.embedded && p->o.detach)
        return rad_fail(p->err, RAD_EUSAGE,
                        "--detach needs a coordinator: a cluster of "
                        "radsubmit's own ends with it");
    if (p->cluster.embedded && p->o.job)
        return rad_fail(p->err, RAD_EUSAGE,
                        "--job needs a coordinator, which has it");
    if (p->cluster.embedded && p->o.reuse)
        return rad_fail(p->err, RAD_EUSAGE,
                        "--reuse needs a coordinator: a cluster of "
                        "radsubmit's own keeps nothing");
    if (!p->cluster.embedded && (p->o.workers || p->o.threads))
        return rad_fail(p->err, RAD_EUSAGE,
                        "--workers and --threads are for a cluster of "
                        "radsubmit's own: use --local or --launch with "
                        "them");
    return 0;
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

static int
start_local(struct program *p)
{
    struct launch_order order = { .command = p->o.launch,
                                  .address = p->o.address,
                                  .workers = workers_wanted(&p->o),
                                  .threads = p->o.threads,
                                  .wait_s = p->o.wait_s };
    struct link_where where = { &p->loop.uv, &p->loop.interrupts };
    int rc = p->o.launch ? launch_start(&p->cluster.launch, p->cluster.local,
                                        &order, &where, p->err)
                         : local_start(p->cluster.local, order.workers,
                                       order.threads, &where, p->err);

    uv_update_time(&p->loop.uv);
    p->cluster.began_ms = uv_now(&p->loop.uv);
    if (rc == 0)
        p->cluster.target = *local_target(p->cluster.local);
    return rc;
}

static int
converse(struct program *p)
{
    struct submit_callbacks cb = { .say = program_say,
                                   .accepted = on_accepted,
                                   .progress = on_progress,
                                   .wonders = on_wonders,
                                   .frame = program_on_frame,
                                   .arg = p };
    struct submit_job job = { .spec = &p->job.spec,
                              .cargo = &p->cargo,
                              .to = p->cluster.target,
                              .wait_s = p->o.wait_s,
                              .detach = p->o.detach };
    int rc;

    if (p->o.preview)
        cb.preview = program_on_preview;
    if (p->o.reuse)
        cb.reuse = on_reuse;
    if (p->o.stats || submit_options_goal(&p->o))
        cb.stats = program_on_stats;
    if (p->records.keep)
        cb.records = on_records;
    if (!p->cluster.embedded || p->cluster.launch)
        cb.reason = on_reason;
    if (p->cluster.embedded) {
        cb.alive = on_alive;
        cb.gathered = on_gathered;
    }
    rc = p->stream.is ? program_run_stream(p, &job, &cb)
         : p->planes.n > 1
             ? program_run_planes(p, &job, &cb)
             : submit_run(&job, &p->loop.uv, &p->loop.interrupts, &cb, p->err);
    if (!p->stream.is && p->planes.n == 1)
        program_end_job(p);
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

/* --dry-run: the whole run. */
static int
run_dry(struct program *p)
{
    struct dryrun_cluster c = { .embedded = p->cluster.embedded };
    struct link_where where = { &p->loop.uv, &p->loop.interrupts };
    char *json;
    int rc;

    c.workers = workers_wanted(&p->o);
    c.threads = c.workers * local_threads(c.workers, p->o.threads);
    if (!p->cluster.embedded &&
        (rc = dryrun_ask(&c, &where, &p->cluster.target, p->err)) < 0)
        return rc;
    if ((rc = compile(p)) < 0 ||
        (rc = cargo_init(&p->cargo, &p->scene.bundle, NULL, p->err)) < 0)
        return rc;
    program_warn_of_scene(p);
    program_fill_spec(p);
    dryrun_print(&p->job.spec, &p->prediction,
                 p->o.quality_whole ? p->o.quality : -1, &c);
    fflush(stdout); /* before --stats, which may go to the same pipe */
    if (!p->o.stats)
        return 0;
    json = dryrun_json(&p->job.spec, p->job.options, &p->prediction, &c);
    rc = json ? program_on_stats(p, (const uint8_t *)json, strlen(json), p->err)
              : rad_fail_memory(p->err);
    free(json);
    return rc;
}

/* Read the -af file; a batch of points begins with the records of earlier
 * batches. */
static int
begin_records(struct program *p)
{
    int rc;

    if (p->stream.is && !p->o.ambient)
        p->records.keep = p->job.spec.scene && p->planes.n == 1 &&
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

static int
run_job(struct program *p)
{
    static const struct pointwriter_light dark = { .n = 0 };
    char hex[MSG_JOB_HEX];
    int rc;

    if ((rc = compile(p)) < 0 ||
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
        (rc = start_local(p)) < 0)
        return rc;
    rc = converse(p);
    if (rc == 0 && p->o.detach && p->planes.n == 1) {
        msg_job_format(p->job.id, hex);
        puts(hex);
    }
    return rc;
}

/* -e: send standard error to a file from here on. */
static int
open_errors(struct program *p)
{
    FILE *f;

    if (!p->o.errors)
        return 0;
    p->own_stderr = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0);
    f = fopen(p->o.errors, "w");
    if (!f || dup2(fileno(f), STDERR_FILENO) < 0)
        return rad_fail(p->err, RAD_ECANTCREAT, "cannot create '%s': %s",
                        p->o.errors, strerror(errno));
    fclose(f);
    return 0;
}

/* Could all of it be written to the file of -e?  If not, go back to the real
 * standard error. */
static int
check_errors(struct program *p)
{
    if (!p->o.errors || !ferror(stderr))
        return 0;
    dup2(p->own_stderr, STDERR_FILENO);
    return rad_fail(p->err, RAD_EIO, "cannot write '%s'", p->o.errors);
}

/* Set up the pictures; or the sensor points, as a picture. */
static int
init_frames(struct program *p)
{
    int rc;

    if (!p->o.points.file)
        return frames_init(&p->frames, &p->o, p->err);
    p->stream.is = strcmp(p->o.points.file, "-") == 0 && !p->o.dry_run &&
                   pointstream_is_one();
    if (p->stream.is)
        return program_check_stream(p);
    rc = pointjob_read(&p->points, &p->o.points, p->err);
    if (rc < 0)
        return rc;
    if (pointjob_is_short(&p->points))
        program_warn(p, "warning: fewer points than -x and -y say");
    return frames_init_points(&p->frames, p->points.width, p->points.height,
                              p->err);
}

/* Check all that can be checked before the work begins. */
static int
prepare(struct program *p)
{
    struct inputs *in = &p->words.inputs;
    int rc = apart_outputs(&p->o, p->err);

    if (rc == 0)
        rc = apart_note(in, &p->o, p->err);
    if (rc == 0)
        rc = apart_inputs(&p->o, NULL, in, p->err);
    if (rc == 0)
        rc = open_errors(p);
    if (rc < 0)
        return rc;
    progress_init(&p->progress, stderr, p->o.progress == PROGRESS_ALWAYS,
                  p->o.progress == PROGRESS_NEVER || p->o.detach);
    if (p->o.report_s > 0 && p->o.progress != PROGRESS_NEVER)
        progress_every(&p->progress, stderr, p->o.report_s);
    program_warn_of_psample(p);
    program_warn_of_rif(p);
    p->planes.n = submit_options_planes(&p->o);
    if ((rc = choose_cluster(p)) < 0 ||
        (!p->rif.is && (rc = init_frames(p)) < 0) ||
        (rc = jobspec_check_goal(&p->o, p->frames.n, p->err)) < 0 ||
        (rc = jobspec_check_windows(&p->o, &p->frames, p->err)) < 0 ||
        (rc = inputs_add(in, "the key", p->cluster.target.key, p->err)) < 0 ||
        (rc = apart_inputs(&p->o, &p->frames, in, p->err)) < 0 ||
        (rc = jobspec_read_costs(&p->job, &p->o, &p->frames, p->err)) < 0 ||
        (rc = program_check_outputs(p)) < 0)
        return rc;
    return program_check_ambient(p);
}

static int
name_job(struct jobspec *job, const char *id, struct rad_error *err)
{
    if (!id)
        return jobspec_name(job, err);
    msg_job_parse(id, job->id); /* checked by submit_check() */
    return 0;
}

static int
run(struct program *p)
{
    int rc = take_rif(p);

    if (rc == 0)
        rc = prepare(p);
    if (rc == 0 && p->rif.is && !p->o.dry_run) {
        rc = rifjob_prepare(&p->rif, &p->o, p->err);
        program_warn_of_rif(p);
    }
    if (rc == 0 && !p->loop.watched)
        rc = watch_signals(&p->loop, p->err);
    if (rc == 0 && p->stream.is)
        rc = pointstream_open(&p->stream.input, &p->o.points, &p->loop.uv,
                              p->err);
    if (rc == 0 && !p->cluster.local)
        rc = local_new(&p->cluster.local, p->err);
    if (rc == 0 && p->frames.n == 0)
        program_warn(
            p, "the pictures of all frames are there: nothing is rendered");
    else if (rc == 0 && p->o.dry_run)
        rc = run_dry(p);
    else if (rc == 0 && (rc = name_job(&p->job, p->o.job, p->err)) == 0) {
        program_warn_of_rest(p);
        rc = run_job(p);
    }
    pointstream_close(&p->stream.input);
    launch_stop(p->cluster.launch);
    local_stop(p->cluster.local);
    if (!foresee_end(p->foresee, rc < 0))
        return rc;
    cargo_release(&p->cargo);
    records_release(&p->records);
    compile_release(&p->scene);
    /* after an error a resolver may still be looking for the host */
    if (p->loop.watched && rc == 0)
        release_loop(&p->loop);
    return rc;
}

static int
say_rpict_path(struct program *p)
{
    char path[PATH_MAX];

    if (!programs_rpict(path, sizeof path))
        return rad_fail(p->err, RAD_ENOINPUT,
                        "the program rpict is not there, neither beside "
                        "radsubmit nor in " RADD_LIBEXECDIR);
    puts(path);
    return 0;
}

static int
act(struct program *p, int argc, char *argv[])
{
    int rc = words_init(&p->words, argc, argv, p->err);

    if (rc == 0)
        rc = submit_parse(&p->o, &p->words, p->err);
    switch (rc) {
    case SUBMIT_RUN:
        rc = run(p);
        break;
    case SUBMIT_HELP:
        submit_table_help(stdout);
        break;
    case SUBMIT_VERSION:
        puts("radsubmit (radd) " PACKAGE_VERSION);
        break;
    case SUBMIT_RPICT:
        rc = say_rpict_path(p);
        break;
    case SUBMIT_DEFAULTS:
        submit_options_defaults(&p->o, stdout);
        break;
    }
    if (rc >= 0 && (rc = tell_printed(p->err)) == 0)
        rc = check_errors(p);
    if (rc < 0) /* main() ends the program: a trial may still use all this */
        return rc;
    jobspec_release(&p->job);
    frames_release(&p->frames);
    pointjob_release(&p->points);
    words_release(&p->words);
    rifjob_release(&p->rif);
    return rc;
}

/* rpict's exit status: 1 for what the user can correct, 2 for the system's
 * errors. */
static int
rpict_status(int rc)
{
    switch (rad_exit_status(rc)) {
    case EX_USAGE:
    case EX_DATAERR:
        return 1;
    default:
        return 2;
    }
}

int
main(int argc, char *argv[])
{
    struct rad_error err = { 0 };
    struct program p = { .err = &err };
    char text[600];
    int rc;

    rad_output_guard();
    rc = act(&p, argc, argv);
    if (rc == 0)
        return EX_OK;
    rad_error_format(&err, text, sizeof text);
    fprintf(stderr, "radsubmit: %s\n", text);
    program_say_where_it_is(&p);
    fflush(stdout);
    /* not exit(), which waits for a resolver that still looks for the host */
    _exit(p.o.rpict_status ? rpict_status(rc) : rad_exit_status(rc));
}
