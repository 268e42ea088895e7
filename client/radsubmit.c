/* radsubmit.c - render a Radiance scene on a cluster; see radsubmit(1)
 *
 * Puts the parts together: the command line (submit_options), the pictures
 * that it asks for (frames), the scene's files (compile, cargo), what the job
 * is (jobspec), a cluster of its own where none is named (local), the
 * conversation (submit).
 * The scene is compiled on a thread of libuv's pool, so that the loop can end
 * the program meanwhile. */
#include "config.h"

#include "apart.h"
#include "command.h"
#include "compile.h"
#include "dryrun.h"
#include "expose.h"
#include "figure.h"
#include "foresee.h"
#include "frames.h"
#include "jobspec.h"
#include "local.h"
#include "outname.h"
#include "output.h"
#include "picfile.h"
#include "progress.h"
#include "records.h"
#include "rescue.h"
#include "rifjob.h"
#include "submit.h"
#include "submit_options.h"
#include "tell.h"
#include "warning.h"

#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

struct program {
    struct submit_options o;
    struct words words;
    struct frames frames;
    int nsaid;         /* of the notes in */
    struct rifjob rif; /* where the scene is a file of rad's variables */
    struct compiled scene;
    struct records records; /* -af */
    struct cargo cargo;
    struct jobspec job;
    struct prediction prediction; /* --dry-run */
    struct local *local;          /* its folder holds the scene's files too */
    bool embedded;
    bool unwritten; /* a picture came and could not be written, */
    char *rescued, *rescued_depth; /* but here; NULL: or nowhere */
    struct target target;
    struct progress progress;
    struct foresee *foresee; /* NULL: no trial was begun */
    bool held, paused, waiting, left; /* were said */
    bool wonders;     /* nobody is at the job, and it is not said why */
    char reason[300]; /* the last that the coordinator gave; "": none */
    struct progress_alone alone;
    double elapsed_s, error; /* as last told */
    struct msg_nan nan;
    struct msg_fault faults[MSG_FAULTS];
    uv_loop_t loop;
    uv_signal_t signals[3];
    int interrupts;
    bool watched; /* signals, on the loop */
    bool compiled;
    int compile_rc;
    double compile_s;
    struct show_last last; /* preview */
    bool preview_warned;
    struct rad_error preview; /* why the last one was not written */
    struct rad_error *err;
};

/* --- what is said --- */

static void
say(void *arg, const char *text)
{
    struct program *p = arg;

    progress_clear(&p->progress);
    tell(stderr, "radsubmit: %s", text);
}

/* -w- */
static void
warn(struct program *p, const char *text)
{
    if (!p->o.quiet)
        say(p, text);
}

/* -ps is brought to what the sampler does; 0 is a usual way to say 1. */
static void
warn_of_psample(struct program *p)
{
    int asked = p->o.psample_asked, taken = p->o.params.psample;
    char text[80];

    if (asked == 0 || asked == taken)
        return;
    snprintf(text, sizeof text,
             "warning: -ps %d is not within 1 to 16: taken as %d", asked,
             taken);
    warn(p, text);
}

/* What rad would do and this does not; each is said once. */
static void
warn_of_rif(struct program *p)
{
    for (; p->nsaid < p->rif.nnotes; p->nsaid++)
        warn(p, p->rif.notes[p->nsaid]);
}

static void
warn_of_scene(struct program *p)
{
    char text[WARNING_SIZE];

    for (int i = 0; warning_of(&p->scene, i, text); i++)
        warn(p, text);
    if (warning_dark(&p->scene, text))
        warn(p, text);
}

/* By estimated cost, which counts whole units; by the rows that have come in
 * while units are so large that it lags behind. */
static double
share_done(const struct msg_progress *m)
{
    double cost = m->cost_total > 0 ? m->cost_done / m->cost_total : 0;
    double rows = m->pixels_total > 0
                      ? (double)m->pixels_done / (double)m->pixels_total
                      : 0;

    return cost > rows ? cost : rows;
}

/* The coordinator cannot go on, and now it can. */
static void
say_held(struct program *p, bool held)
{
    if (held && !p->held)
        say(p, "the job is held: the coordinator's disk is full");
    else if (!held && p->held)
        say(p, "the coordinator's disk has room again: the job goes on");
    p->held = held;
}

/* Somebody paused it, and somebody has to resume it. */
static void
say_paused(struct program *p, bool paused)
{
    char text[100], hex[MSG_JOB_HEX];

    msg_job_format(p->job.id, hex);
    snprintf(text, sizeof text, "the job is paused: radctl resume %s", hex);
    if (paused && !p->paused)
        say(p, text);
    else if (!paused && p->paused)
        say(p, "the job goes on");
    p->paused = paused;
}

/* Nothing happens, and nobody knows why: say it once, not to who has a cluster
 * of his own, whose workers are on their way. */
static void
say_waiting(struct program *p, const struct msg_progress *m)
{
    enum { PATIENCE_S = 2 };

    if (p->waiting || p->embedded || m->state != MSG_STATE_WAITING ||
        m->workers > 0 || m->elapsed_s < PATIENCE_S)
        return;
    p->waiting = true;
    say(p, "no worker has begun yet; radctl workers says what they do");
}

/* All workers left a job that had begun.  Others may be there that --same-bits
 * does not take. */
static void
say_left(struct program *p, const struct progress_report *r, bool running)
{
    enum { PATIENCE_S = 5 }; /* they may come back */
    double alone_s = progress_alone(&p->alone, r, running);

    if (alone_s == 0) {
        if (p->left && r->workers > 0)
            say(p, "a worker is at the job again");
        p->left = false;
    }
    if (p->left || alone_s < PATIENCE_S)
        return;
    p->left = true;
    say(p, "no worker is at the job any more; radctl workers says who is "
           "there");
    if (p->o.same_bits)
        say(p, "--same-bits takes none but such as that of the first worker: "
               "bring one of these back, or cancel the job and submit it "
               "without");
}

/* After "no worker": the coordinator may know more. */
static void
note_wonder(struct program *p, const struct msg_progress *m)
{
    p->wonders = (p->waiting && m->state == MSG_STATE_WAITING &&
                  m->workers == 0) ||
                 p->left || m->state == MSG_STATE_HELD;
    if (!p->wonders)
        p->reason[0] = '\0'; /* the next time it may be the same */
}

/* How many rays will it take?  Records that there are already would have to be
 * tried, too, and a scene that is ready to trace takes room. */
static void
foresee(struct program *p)
{
    enum { MOST_BYTES = 100000000 };
    struct foresee_job job = { .scene = p->scene.scene,
                               .files = compile_files(&p->scene),
                               .params = &p->o.params,
                               .frames = p->frames.list,
                               .nframes = p->frames.n };

    if (p->foresee)
        progress_foresee(&p->progress, foresee_rays(p->foresee));
    else if (p->scene.scene && !p->o.ambient &&
             p->job.spec.bundle_bytes <= MOST_BYTES &&
             progress_is_long(&p->progress))
        p->foresee = foresee_begin(&job);
}

static void
on_progress(void *arg, const struct msg_progress *m)
{
    bool lost =
        m->state == MSG_STATE_CANCELLED || m->state == MSG_STATE_FAILED;
    struct program *p = arg;
    struct progress_report r = { .elapsed_s = m->elapsed_s,
                                 .done = share_done(m),
                                 .rays = m->rays,
                                 .workers = (int)m->workers,
                                 .working = m->state == MSG_STATE_RUNNING &&
                                            m->workers > 0 };

    if (!lost) { /* then it does not go on */
        say_held(p, m->state == MSG_STATE_HELD);
        say_paused(p, m->state == MSG_STATE_PAUSED);
    }
    say_waiting(p, m);
    say_left(p, &r, m->state == MSG_STATE_RUNNING);
    note_wonder(p, m);
    foresee(p);
    if (!lost) /* how far it got is said anyway */
        progress_update(&p->progress, &r);
    p->elapsed_s = m->elapsed_s;
    p->error = m->error;
    p->nan = m->nan;
    memcpy(p->faults, m->faults, sizeof p->faults);
}

/* At the end: a pixel that reproduces what is wrong. */
static void
warn_of_nan(struct program *p)
{
    const struct msg_nan *n = &p->nan;
    char text[160];

    if (n->pixels == 0)
        return;
    snprintf(text, sizeof text,
             "warning: %" PRIu64 " pixel%s radiance that is negative or no "
             "number, which is black; "
             "first: frame %" PRIu32 ", column %" PRIu32 ", row %" PRIu32,
             n->pixels, n->pixels == 1 ? " has" : "s have", n->frame, n->x,
             n->y);
    warn(p, text);
}

/* The last line. */
static void
say_done(struct program *p)
{
    char text[120], s[FIGURE_TEXT], percent[FIGURE_TEXT];

    figure(s, p->elapsed_s, 3);
    if (p->error > 0)
        snprintf(text, sizeof text, "done in %s s, relative error about %s %%",
                 s, figure(percent, 100 * p->error, 2));
    else
        snprintf(text, sizeof text, "done in %s s", s);
    say(p, text);
}

static void
warn_of_faults(struct program *p)
{
    const struct msg_fault *f = p->faults;
    char text[WARNING_SIZE];

    for (int i = 0; i < MSG_FAULTS && f[i].count > 0; i++)
        if (p->scene.scene &&
            warning_fault(p->scene.scene, f[i].object, f[i].count, text))
            warn(p, text);
}

/* --- what is written --- */

static int
write_picture(struct program *p, uint32_t frame, const uint8_t *picture,
              size_t len, struct rad_error *err)
{
    char *name = NULL;
    uint8_t *exposed = NULL;
    int rc = 0;

    if (p->o.output)
        rc = frames_name(&p->frames, &p->o, p->o.output, frame, &name, err);
    if (rc == 0 && p->rif.exposure > 0 && p->rif.exposure != 1 &&
        !picfile_is_png(name, (enum picfile_format)p->o.format)) {
        rc = expose(picture, len, p->rif.exposure, &exposed, &len, err);
        picture = exposed;
    }
    if (rc == 0)
        rc = picfile_write(name, (enum picfile_format)p->o.format, picture, len,
                           !p->embedded, &p->o.show, err);
    free(exposed);
    free(name);
    return rc;
}

static int
write_depth(struct program *p, uint32_t frame, const uint8_t *depth, size_t len,
            struct rad_error *err)
{
    char *name = NULL;
    int rc = frames_name(&p->frames, &p->o, p->o.depth, frame, &name, err);

    if (rc == 0)
        rc = output_write(name, depth, len, !p->embedded, err);
    free(name);
    return rc;
}

/* One that cannot be written holds up no picture: a warning tells of the first,
 * and the exit status of the last. */
static void
note_preview(struct program *p, const struct rad_error *why)
{
    bool warned = p->preview_warned;
    char text[sizeof *why + 80];
    int n;

    p->preview = *why;
    p->preview_warned |= why->code != 0;
    if (why->code == 0 || warned)
        return;
    n = snprintf(text, sizeof text,
                 "warning: no preview, but the job goes on: ");
    rad_error_format(why, text + n, sizeof text - (size_t)n);
    warn(p, text);
}

static int
on_preview(void *arg, const uint8_t *picture, size_t len, struct rad_error *err)
{
    struct program *p = arg;
    struct rad_error why = { 0 };

    (void)err;
    picfile_preview(p->o.preview, picture, len, &p->o.show, &p->last, &why);
    note_preview(p, &why);
    return 0;
}

/* Of a frame that is whole: as its picture is, or would be as PNG. */
static void
last_preview(struct program *p, const uint8_t *picture, size_t len)
{
    struct rad_error why = { 0 };

    picfile_write(p->o.preview, PICFILE_PNG, picture, len, false, &p->o.show,
                  &why);
    note_preview(p, &why);
    memset(&p->last, 0, sizeof p->last);
}

/* The cluster ends with us.  NULL: that is written, or was not asked for. */
static void
rescue(struct program *p, uint32_t frame, const uint8_t *picture,
       size_t picture_len, const uint8_t *depth, size_t depth_len)
{
    if (picture)
        p->rescued =
            rescue_write(p->job.id, frame, ".hdr", picture, picture_len);
    if (depth)
        p->rescued_depth =
            rescue_write(p->job.id, frame, ".zbf", depth, depth_len);
}

static int
on_frame(void *arg, uint32_t frame, const uint8_t *picture, size_t picture_len,
         const uint8_t *depth, size_t depth_len, struct rad_error *err)
{
    struct program *p = arg;
    bool there; /* the picture is written */
    int rc;

    progress_clear(&p->progress); /* it may share the terminal with stdout */
    rc = write_picture(p, frame, picture, picture_len, err);
    there = rc == 0;
    if (rc == 0 && depth)
        rc = write_depth(p, frame, depth, depth_len, err);
    p->unwritten = rc < 0;
    if (p->unwritten && p->embedded)
        rescue(p, frame, there ? NULL : picture, picture_len, depth, depth_len);
    if (rc == 0 && p->o.preview)
        last_preview(p, picture, picture_len);
    return rc;
}

/* What could not be written is not lost. */
static void
say_where_it_is(const struct program *p)
{
    char hex[MSG_JOB_HEX];

    if (p->rescued)
        tell(stderr, "radsubmit: the picture is in %s", p->rescued);
    if (p->rescued_depth)
        tell(stderr, "radsubmit: its distances are in %s", p->rescued_depth);
    if (!p->unwritten || p->embedded)
        return;
    msg_job_format(p->job.id, hex);
    fprintf(stderr,
            "radsubmit: the coordinator keeps %s: radctl fetch %s -o FILE%s\n",
            p->frames.n > 1 ? "the pictures" : "the picture", hex,
            p->frames.n > 1 ? " --frame=N, from 0" : "");
}

static void
on_records(void *arg, const struct msg_records *m)
{
    struct program *p = arg;

    records_take(&p->records, m);
}

static int
on_stats(void *arg, const uint8_t *json, size_t len, struct rad_error *err)
{
    struct program *p = arg;

    return output_write(p->o.stats, json, len, !p->embedded, err);
}

static bool
on_alive(void *arg)
{
    return local_alive(((struct program *)arg)->local);
}

static int
on_expected(void *arg)
{
    return local_workers(((struct program *)arg)->local);
}

/* -af: is there a use for it, and can it be written?  What was said of rpict's
 * file holds here: without records there is none, and one that may only be read
 * is read. */
static int
check_ambient(struct program *p)
{
    const char *path = p->o.ambient;
    char text[600];

    if (!path)
        return 0;
    if (p->o.params.ambounce <= 0 || p->o.params.ambacc <= 0) {
        warn(p, "warning: -af: there are no ambient values to keep without "
                "-ab and -aa");
        p->o.ambient = NULL;
        return 0;
    }
    p->records.keep = !p->o.detach && !p->o.dry_run;
    if (p->o.detach)
        warn(p, "warning: -af: the file is read, but nobody waits to add to "
                "it");
    if (!p->records.keep || access(path, W_OK) == 0)
        return 0;
    if (errno == ENOENT)
        return output_check(path, p->err);
    if (access(path, R_OK) == 0) {
        snprintf(text, sizeof text,
                 "warning: -af: '%.400s' may only be read: it is not added to",
                 path);
        warn(p, text);
        p->records.keep = false;
    }
    return 0;
}

/* A picture that nobody can keep need not be rendered. */
static int
check_output(const struct program *p, const char *path, bool of_frame)
{
    char *name = NULL;
    int rc = 0;

    if (!path)
        return 0;
    if (of_frame && p->frames.n > 0)
        rc = frames_name(&p->frames, &p->o, path, 0, &name, p->err);
    if (rc == 0)
        rc = output_check(name ? name : path, p->err);
    free(name);
    return rc;
}

static int
check_formats(const struct program *p)
{
    const struct submit_options *o = &p->o;
    int rc = 0;

    if (o->output && o->format == PICFILE_BY_SUFFIX)
        rc = picfile_check(o->output, false, p->err);
    if (rc == 0 && o->preview)
        rc = picfile_check(o->preview, true, p->err);
    return rc;
}

static int
check_outputs(const struct program *p)
{
    int rc;

    if ((rc = check_formats(p)) < 0)
        return rc;
    if ((rc = check_output(p, p->o.output, true)) < 0 ||
        (rc = check_output(p, p->o.depth, true)) < 0 ||
        (rc = check_output(p, p->o.preview, false)) < 0 ||
        (rc = check_output(p, p->o.stats, false)) < 0)
        return rc;
    if (!p->o.output && !p->o.detach && !p->o.dry_run && isatty(1))
        return rad_fail(p->err, RAD_EUSAGE,
                        "standard output is a terminal: use -o");
    return 0;
}

/* --- signals --- */

/* An interrupt counts once; what ends a session counts as two, so that a job
 * of a real coordinator goes on. */
static void
on_signal(uv_signal_t *h, int signum)
{
    struct program *p = h->data;

    p->interrupts += signum == SIGINT ? 1 : 2;
    uv_stop(&p->loop);
}

/* Has who started the program, such as nohup, it ignore hang-ups? */
static bool
hang_ups_ignored(void)
{
    struct sigaction now;

    return sigaction(SIGHUP, NULL, &now) == 0 && now.sa_handler == SIG_IGN;
}

static int
watch_signals(struct program *p)
{
    static const int which[] = { SIGINT, SIGTERM, SIGHUP };

    if (uv_loop_init(&p->loop) != 0)
        return rad_fail(p->err, RAD_ENOMEM, "out of memory");
    p->watched = true;
    signal(SIGPIPE, SIG_IGN);
    for (int i = 0; i < 3; i++) {
        uv_signal_init(&p->loop, &p->signals[i]);
        p->signals[i].data = p;
        if (which[i] == SIGHUP && hang_ups_ignored())
            continue;
        uv_signal_start(&p->signals[i], on_signal, which[i]);
        uv_unref((uv_handle_t *)&p->signals[i]);
    }
    return 0;
}

static void
release_loop(struct program *p)
{
    for (int i = 0; i < 3; i++)
        uv_close((uv_handle_t *)&p->signals[i], NULL);
    while (uv_loop_close(&p->loop) == UV_EBUSY)
        uv_run(&p->loop, UV_RUN_ONCE);
}

/* --- the scene --- */

/* --dry-run */
static int
try_scene(struct program *p)
{
    struct rad_files files = compile_files(&p->scene);

    return dryrun_predict(&p->prediction, p->scene.scene, &files, &p->o.params,
                          p->frames.list, p->frames.n, &dryrun_effort, p->err);
}

static void
compile_work(uv_work_t *w)
{
    struct program *p = w->data;
    uint64_t begin = uv_hrtime();

    if (!p->scene.scene) {
        p->compile_rc = compile_scene(
            &p->scene, (const char *const *)p->o.scenes, p->o.nscenes,
            p->o.commands, local_folder(p->local), p->err);
        p->compile_s = (double)(uv_hrtime() - begin) * 1e-9;
    }
    if (p->compile_rc == 0 && p->o.dry_run && p->frames.n > 0)
        p->compile_rc = try_scene(p);
}

static void
compile_done(uv_work_t *w, int status)
{
    (void)status;
    ((struct program *)w->data)->compiled = true;
}

/* Ends the program when it is interrupted: the thread cannot be. */
static int
compile(struct program *p)
{
    uv_work_t work = { .data = p };

    p->compiled = false;
    if (uv_queue_work(&p->loop, &work, compile_work, compile_done) != 0)
        return rad_fail(p->err, RAD_ENOMEM, "out of memory");
    while (!p->compiled) {
        uv_run(&p->loop, UV_RUN_ONCE);
        if (p->interrupts > 0 && !p->compiled) {
            command_stop_all();
            local_stop(p->local);
            _exit(EX_TEMPFAIL);
        }
    }
    if (p->compile_rc < 0)
        return p->compile_rc;
    return apart_inputs(&p->o, &p->frames, &p->scene.paths.inputs, p->err);
}

/* A file of rad's variables: its scene is compiled first, since options and
 * views go by its size; then *p is as if the command line had named them. */
static int
take_rif(struct program *p)
{
    int rc = rifjob_begin(&p->rif, &p->o, &p->words, p->err);

    if (rc == 0 && !p->rif.is && p->o.rif_view)
        rc = rad_fail(p->err, RAD_EUSAGE, "--view is for a .rif file");
    if (rc < 0 || !p->rif.is)
        return rc;
    if ((rc = watch_signals(p)) < 0 ||
        (rc = local_new(&p->local, p->err)) < 0 || (rc = compile(p)) < 0 ||
        (rc = rifjob_finish(&p->rif, &p->o, &p->words, &p->scene.octree,
                            p->err)) < 0)
        return rc;
    return frames_init_views(&p->frames, &p->o, p->rif.views, p->rif.nviews,
                             p->err);
}

/* Of a cluster of our own. */
static int
workers_wanted(const struct program *p)
{
    return p->o.workers ? p->o.workers : 1;
}

/* --- the job --- */

static int
choose_cluster(struct program *p)
{
    int rc = 0;

    if (!p->o.local)
        rc = target_find(&p->target, p->o.coordinator, p->o.key, p->err);
    if (rc < 0)
        return rc;
    p->embedded = rc == 0;
    if (p->embedded && p->o.detach)
        return rad_fail(p->err, RAD_EUSAGE,
                        "--detach needs a coordinator: a cluster of "
                        "radsubmit's own ends with it");
    if (!p->embedded && (p->o.workers || p->o.threads))
        return rad_fail(p->err, RAD_EUSAGE,
                        "--workers and --threads are for a cluster of "
                        "radsubmit's own: use --local with them");
    return 0;
}

/* The id is what a user has to find the job again: it is said when there is a
 * job to be found. */
static void
on_accepted(void *arg)
{
    struct program *p = arg;
    char hex[MSG_JOB_HEX];

    msg_job_format(p->job.id, hex);
    tell(stderr, "radsubmit: job %s", hex);
}

static bool
on_wonders(void *arg)
{
    return ((struct program *)arg)->wonders;
}

/* Why nobody is at the job, as the coordinator says; once for each reason. */
static void
on_reason(void *arg, const char *why)
{
    struct program *p = arg;
    char text[sizeof p->reason + 40];

    if (why[0] == '\0' || strncmp(why, p->reason, sizeof p->reason - 1) == 0)
        return;
    snprintf(p->reason, sizeof p->reason, "%s", why);
    snprintf(text, sizeof text, "the coordinator says: %s", p->reason);
    say(p, text);
}

static void
fill_spec(struct program *p)
{
    jobspec_fill(&p->job, &p->o, &p->frames, &p->scene, &p->cargo);
    p->job.spec.compile_s = p->compile_s;
    if (p->records.keep)
        p->job.spec.flags |= MSG_JOB_RECORDS;
}

static int
start_local(struct program *p)
{
    int rc = local_start(p->local, workers_wanted(p), p->o.threads,
                         &p->interrupts, p->err);

    if (rc == 0)
        p->target = *local_target(p->local);
    return rc;
}

static int
converse(struct program *p)
{
    struct submit_callbacks cb = {
        .say = say,
        .accepted = on_accepted,
        .progress = on_progress,
        .wonders = on_wonders,
        .frame = on_frame,
        .arg = p
    };
    struct submit_job job = { .spec = &p->job.spec,
                              .cargo = &p->cargo,
                              .to = p->target,
                              .wait_s = p->o.wait_s,
                              .detach = p->o.detach };
    int rc;

    if (p->o.preview)
        cb.preview = on_preview;
    if (p->o.stats)
        cb.stats = on_stats;
    if (p->records.keep)
        cb.records = on_records;
    if (!p->embedded)
        cb.reason = on_reason;
    if (p->embedded) {
        cb.alive = on_alive;
        cb.expected = on_expected;
    }
    rc = submit_run(&job, &p->loop, &p->interrupts, &cb, p->err);
    if (rc == 0)
        rc = records_write(&p->records, !p->embedded, p->err);
    if (rc == 0 && p->preview.code != 0) {
        *p->err = p->preview;
        rc = p->preview.code;
    }
    progress_clear(&p->progress);
    warn_of_nan(p);
    warn_of_faults(p);
    if (rc == 0 && !p->o.detach)
        say_done(p);
    return rc;
}

/* --dry-run, to its end. */
static int
run_dry(struct program *p)
{
    struct dryrun_cluster c = { .embedded = p->embedded };
    struct link_where where = { &p->loop, &p->interrupts };
    char *json;
    int rc;

    c.workers = workers_wanted(p);
    c.threads = c.workers * local_threads(c.workers, p->o.threads);
    if (!p->embedded && (rc = dryrun_ask(&c, &where, &p->target, p->err)) < 0)
        return rc;
    if ((rc = compile(p)) < 0 ||
        (rc = cargo_init(&p->cargo, &p->scene.bundle, NULL, p->err)) < 0)
        return rc;
    warn_of_scene(p);
    fill_spec(p);
    dryrun_print(&p->job.spec, &p->prediction,
                 p->o.quality_whole ? p->o.quality : -1, &c);
    if (fflush(stdout) != 0)
        return rad_fail(p->err, RAD_EIO, "cannot write: %s", strerror(errno));
    if (!p->o.stats)
        return 0;
    json = dryrun_json(&p->job.spec, p->job.options, &p->prediction, &c);
    rc = json ? on_stats(p, (const uint8_t *)json, strlen(json), p->err)
              : rad_fail(p->err, RAD_ENOMEM, "out of memory");
    free(json);
    return rc;
}

static int
begin_records(struct program *p)
{
    if (!p->o.ambient)
        return 0;
    return records_begin(&p->records, p->o.ambient, p->records.keep,
                         &p->o.params, &p->scene, local_folder(p->local),
                         p->err);
}

static int
run_job(struct program *p)
{
    char hex[MSG_JOB_HEX];
    int rc;

    if ((rc = compile(p)) < 0 || (rc = begin_records(p)) < 0 ||
        (rc = jobspec_add_frames(&p->job, &p->frames, &p->scene,
                                 local_folder(p->local), p->err)) < 0 ||
        (rc = cargo_init(&p->cargo, &p->scene.bundle, local_folder(p->local),
                         p->err)) < 0)
        return rc;
    warn_of_scene(p);
    fill_spec(p);
    if (p->embedded && (rc = start_local(p)) < 0)
        return rc;
    rc = converse(p);
    if (rc == 0 && p->o.detach) {
        msg_job_format(p->job.id, hex);
        puts(hex);
        if (fflush(stdout) != 0)
            rc = rad_fail(p->err, RAD_EIO, "cannot write: %s", strerror(errno));
    }
    return rc;
}

/* -e: what is said from here on goes there. */
static int
open_errors(const struct program *p)
{
    FILE *f;

    if (!p->o.errors)
        return 0;
    f = fopen(p->o.errors, "w");
    if (!f || dup2(fileno(f), STDERR_FILENO) < 0)
        return rad_fail(p->err, RAD_ECANTCREAT, "cannot create '%s': %s",
                        p->o.errors, strerror(errno));
    fclose(f);
    return 0;
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
    warn_of_psample(p);
    warn_of_rif(p);
    if ((rc = choose_cluster(p)) < 0 ||
        (!p->rif.is &&
         (rc = frames_init(&p->frames, &p->o, p->err)) < 0) ||
        (rc = inputs_add(in, "the key", p->target.key, p->err)) < 0 ||
        (rc = apart_inputs(&p->o, &p->frames, in, p->err)) < 0 ||
        (rc = jobspec_read_costs(&p->job, &p->o, &p->frames, p->err)) < 0 ||
        (rc = check_outputs(p)) < 0)
        return rc;
    return check_ambient(p);
}

static int
run(struct program *p)
{
    int rc = take_rif(p);

    if (rc == 0)
        rc = prepare(p);
    if (rc == 0 && p->rif.is && !p->o.dry_run) {
        rc = rifjob_prepare(&p->rif, &p->o, p->err);
        warn_of_rif(p);
    }
    if (rc == 0 && !p->watched)
        rc = watch_signals(p);
    if (rc == 0 && !p->local)
        rc = local_new(&p->local, p->err);
    if (rc == 0 && p->frames.n == 0)
        warn(p, "the pictures of all frames are there: nothing is rendered");
    else if (rc == 0 && p->o.dry_run)
        rc = run_dry(p);
    else if (rc == 0 && (rc = jobspec_name(&p->job, p->err)) == 0)
        rc = run_job(p);
    local_stop(p->local);
    if (!foresee_end(p->foresee, rc < 0))
        return rc;
    cargo_release(&p->cargo);
    records_release(&p->records);
    compile_release(&p->scene);
    if (p->watched && rc != RAD_EUNAVAIL) /* a resolver may still be at work */
        release_loop(p);
    return rc;
}

static int
say_rpict_path(struct program *p)
{
    char path[PATH_MAX];

    if (!local_rpict(path, sizeof path))
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
        rc = submit_options_parse(&p->o, &p->words, p->err);
    switch (rc) {
    case SUBMIT_RUN:
        rc = run(p);
        break;
    case SUBMIT_HELP:
        submit_options_help(stdout);
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
    if (rc < 0) /* main() ends the program, and a trial may still be at work */
        return rc;
    jobspec_release(&p->job);
    frames_release(&p->frames);
    words_release(&p->words);
    rifjob_release(&p->rif);
    return rc;
}

/* rpict's: 1 for what the user can mend, 2 for the system. */
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
    int rc = act(&p, argc, argv);

    if (rc >= 0) /* done, or an enum submit_wish that was granted */
        return EX_OK;
    rad_error_format(&err, text, sizeof text);
    fprintf(stderr, "radsubmit: %s\n", text);
    say_where_it_is(&p);
    /* exit() would wait for a resolver that still looks for the host */
    _exit(p.o.rpict_status ? rpict_status(rc) : rad_exit_status(rc));
}
