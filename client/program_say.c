/* program_say.c - messages to the user; see program_say.h */
#include "config.h"

#include "program_say.h"

#include "common/figure.h"
#include "common/tell.h"
#include "compile/warning.h"
#include "show/picfile.h"

#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <string.h>
#include <sysexits.h>

void
program_say(void *arg, const char *text)
{
    struct program *p = arg;

    program_loop_free_for_message(&p->loop);
    progress_clear(&p->progress);
    tell(stderr, "radsubmit: %s", text);
    program_loop_catch_signals(&p->loop);
}

void
program_news(struct program *p, const char *text)
{
    const struct submit_options *o = &p->o;

    if (!o->rpict_status || o->report_s > 0 || o->progress == PROGRESS_ALWAYS)
        program_say(p, text);
}

void
program_warn(struct program *p, const char *text)
{
    if (!p->o.quiet)
        program_say(p, text);
}

/* rpict's: 1 for what the user can correct, 2 for the system's errors, 3 after
 * a signal. */
int
program_status(const struct program *p, int rc)
{
    int status = rad_exit_status(rc);

    if (!p->o.rpict_status)
        return status;
    if (p->loop.interrupts > 0)
        return 3;
    return status == EX_USAGE || status == EX_DATAERR ? 1 : 2;
}

/* Warn of a -ps that the sampler cannot take, unless it is 0, which is often
 * used for 1. */
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
    program_warn(p, text);
}

void
program_warn_of_options(struct program *p)
{
    warn_of_psample(p);
    if (p->o.names_dropped)
        program_warn(p, "warning: -ai and -ae exclude each other, and the last "
                        "one holds");
    if (p->o.params.motion > 0 && !p->o.first_frame && !p->o.points.file)
        program_warn(p, "warning: -pm without -S: one view has no motion");
}

void
program_warn_of_rest(struct program *p)
{
    const struct submit_options *o = &p->o;

    if (p->frames.n > 0 && p->frames.seen > p->frames.n && o->output &&
        picfile_is_png(o->output, (enum picfile_format)o->format) &&
        show_waits(&o->show))
        program_warn(p, o->show.false_colour
                            ? "warning: the scale of colours is that of the "
                              "first frame rendered now, not of the frames "
                              "that are there: --false-colour=SCALE sets it"
                            : "warning: the exposure is that of the first "
                              "frame rendered now, not of the frames that are "
                              "there: --exposure=FACTOR sets it");
}

void
program_warn_of_rif(struct program *p)
{
    for (; p->said.notes < p->rif.nnotes; p->said.notes++)
        program_warn(p, p->rif.notes[p->said.notes]);
}

/* Warn of an -ar too coarse for what is shown. */
static void
warn_of_blur(struct program *p)
{
    const struct surroundings *s = &p->surroundings;
    int ar = p->o.params.ambres, times = surroundings_times(s);
    char text[300], better[80];

    if (!surroundings_blur(s, ar))
        return;
    if (p->o.ambient)
        snprintf(better, sizeof better, "--surroundings=%d", times);
    else
        snprintf(better, sizeof better, "-ar %d%s",
                 surroundings_ambres(times, ar), p->rif.is ? ", or ZONE," : "");
    snprintf(
        text, sizeof text,
        "warning: ambient values are only as fine as %.3g units (-ar %d in "
        "a scene of %.3g), but a view shows what is %.3g large: %s suits "
        "that",
        s->cube / ar, ar, s->cube, s->shown, better);
    program_warn(p, text);
}

void
program_warn_of_scene(struct program *p)
{
    char text[WARNING_SIZE];

    for (int i = 0; warning_of(&p->scene, i, text); i++)
        program_warn(p, text);
    if (warning_dark(&p->scene, p->o.params.ambounce > 0, text))
        program_warn(p, text);
    warn_of_blur(p);
}

/* Tell when the job is held for want of room on the disk, and when it goes on.
 */
static void
say_held(struct program *p, bool held)
{
    if (held && !p->said.held)
        program_say(p, "the job is held: the coordinator's disk is full");
    else if (!held && p->said.held)
        program_say(p,
                    "the coordinator's disk has room again: the job goes on");
    p->said.held = held;
}

/* Tell when the job is paused, for somebody has to resume it, and when it goes
 * on. */
static void
say_paused(struct program *p, bool paused)
{
    char text[100], hex[MSG_JOB_HEX];

    msg_job_format(p->job.id, hex);
    snprintf(text, sizeof text, "the job is paused: radctl resume %s", hex);
    if (paused && !p->said.paused)
        program_say(p, text);
    else if (!paused && p->said.paused)
        program_say(p, "the job goes on");
    p->said.paused = paused;
}

/* Tell once that no worker has begun; not for --local, whose workers will soon
 * come.  With --launch the workers have come, and the user cannot ask their
 * coordinator. */
static void
say_waiting(struct program *p, double alone_s)
{
    enum { PATIENCE_S = 2 };

    if (p->said.waiting || (p->cluster.embedded && !p->cluster.launch) ||
        alone_s < PATIENCE_S)
        return;
    p->said.waiting = true;
    program_say(p, p->cluster.embedded
                       ? "no worker has begun yet"
                       : "no worker has begun yet; radctl workers says "
                         "what they do");
}

/* Tell when all workers have left a job that was begun.  There may be workers
 * that --same-bits does not take. */
static void
say_left(struct program *p, double alone_s)
{
    enum { PATIENCE_S = 5 }; /* a worker may come back */

    if (p->said.left || alone_s < PATIENCE_S)
        return;
    p->said.left = true;
    program_say(p,
                "no worker is at the job any more; radctl workers says who is "
                "there");
    if (p->o.same_bits)
        program_say(
            p, "--same-bits takes none but such as that of the first worker: "
               "bring one of these back, or cancel the job and submit it "
               "without");
}

/* Tell when the job lacks workers, and when it has one again.  A worker may
 * have begun the job and left between two reports.  After a restart of the
 * coordinator a job that was begun waits as a new job does. */
static void
say_alone(struct program *p, const struct progress_report *r,
          const struct msg_progress *m)
{
    bool waiting = m->state == MSG_STATE_WAITING;
    bool running = m->state == MSG_STATE_RUNNING;
    double alone_s = progress_alone(&p->said.alone, r, waiting || running);

    p->said.begun |= running || m->workers > 0 || msg_progress_share(m) > 0;
    if (alone_s == 0) {
        if (p->said.left && r->workers > 0)
            program_say(p, "a worker is at the job again");
        p->said.left = false;
    }
    if (p->said.begun)
        say_left(p, alone_s);
    else if (waiting)
        say_waiting(p, alone_s);
}

/* Tell when a stage of --error or --time has ended; not for batches of points,
 * which would have too many. */
static void
say_stage(struct program *p, const struct msg_progress *m)
{
    char text[160], got[FIGURE_TEXT], s[FIGURE_TEXT];
    int stages = m->stage + m->ended;

    if (!submit_options_goal(&p->o) || p->stream.is || stages <= p->said.stages)
        return;
    p->said.stages = stages;
    snprintf(text, sizeof text, "stage %d: error about %s %% after %s s, %s",
             stages, figure(got, 100 * m->goal_error, 2),
             figure(s, m->elapsed_s, 2),
             !m->ended          ? "now a finer one"
             : p->o.points.file ? "now the values"
                                : "now the picture");
    program_news(p, text);
}

/* Note whether the coordinator is to be asked why no worker is at the job. */
static void
note_wonder(struct program *p, const struct msg_progress *m)
{
    p->said.wonders =
        (p->said.waiting && m->state == MSG_STATE_WAITING && m->workers == 0) ||
        p->said.left || m->state == MSG_STATE_HELD;
    if (!p->said.wonders)
        p->said.reason[0] = '\0'; /* it may come again, and be news */
}

/* The seconds until the last job is done, if each of several planes takes as
 * long as the current one; 0: not known. */
static double
time_left(const struct program *p, const struct msg_progress *m)
{
    int further = program_jobs(p) - p->planes.at - 1;

    return m->left_s > 0 ? m->left_s + further * (m->elapsed_s + m->left_s) : 0;
}

void
program_on_progress(void *arg, const struct msg_progress *m)
{
    bool lost = m->state == MSG_STATE_CANCELLED || m->state == MSG_STATE_FAILED;
    struct program *p = arg;
    struct progress_report r = {
        .elapsed_s = m->elapsed_s,
        .done = (p->planes.at + msg_progress_share(m)) / program_jobs(p),
        .rays = m->rays,
        .workers = (int)m->workers,
        .left_s = time_left(p, m)
    };

    if (!lost) { /* else the job does not go on */
        say_held(p, m->state == MSG_STATE_HELD);
        say_paused(p, m->state == MSG_STATE_PAUSED);
    }
    say_alone(p, &r, m);
    say_stage(p, m);
    note_wonder(p, m);
    if (!lost) { /* else its end is told by another line */
        program_loop_free_for_message(&p->loop);
        progress_update(&p->progress, &r);
        program_loop_catch_signals(&p->loop);
    }
    outcome_note(&p->result.job, m);
}

/* Warn of bad pixels; the first one is named so that it can be looked into. */
static void
warn_of_nan(struct program *p)
{
    const struct msg_nan *n = &p->result.job.nan;
    char text[160];

    if (n->pixels == 0)
        return;
    if (p->o.points.file) {
        snprintf(text, sizeof text,
                 "warning: %" PRIu64 " sensor point%s light that is negative "
                 "or no number, which is black; first: point %" PRIu64,
                 n->pixels, n->pixels == 1 ? " has" : "s have",
                 pointjob_number(&p->points, n->x, n->y));
        program_warn(p, text);
        return;
    }
    snprintf(text, sizeof text,
             "warning: %" PRIu64 " pixel%s radiance that is negative or no "
             "number, which is black; "
             "first: frame %" PRIu32 ", column %" PRIu32 ", row %" PRIu32,
             n->pixels, n->pixels == 1 ? " has" : "s have", n->frame, n->x,
             n->y);
    program_warn(p, text);
}

void
program_end_job(struct program *p)
{
    warn_of_nan(p);
    outcome_add(&p->result.sum, &p->result.job,
                p->o.points.file ? p->points.in.n : 1);
    memset(&p->result.job, 0, sizeof p->result.job);
    p->said.begun = p->said.left = false; /* of the next plane or batch */
}

void
program_warn_of_dark(struct program *p)
{
    if (p->result.light == LIGHT_NONE && p->result.sum.all.nan.pixels == 0)
        program_warn(p, p->frames.n > 1
                            ? "warning: all pictures are black"
                            : "warning: the picture is black: does the view "
                              "see a surface, from its visible side (-bv), "
                              "and does light reach it?");
}

void
program_note_goal(struct program_goal *g, const uint8_t *json, size_t len)
{
    json_t *root = json_loadb((const char *)json, len, 0, NULL);
    const json_t *goal = json_object_get(root, "goal");

    g->estimate = json_number_value(json_object_get(goal, "estimate"));
    g->mean_estimate =
        json_number_value(json_object_get(goal, "mean_estimate"));
    g->stages = (int)json_integer_value(json_object_get(goal, "stages"));
    g->time_up = json_is_true(json_object_get(goal, "time_up"));
    g->rays_up = json_is_true(json_object_get(goal, "rays_up"));
    g->stages_up = json_is_true(json_object_get(goal, "stages_up"));
    g->by_clock = json_is_true(json_object_get(goal, "by_clock"));
    json_decref(root);
}

/* An error of more than FAR times the one that was asked for is told. */
#define FAR 1.3

/* Tell what --error or --time have reached. */
static void
say_goal(struct program *p)
{
    const struct program_goal *g = &p->result.goal;
    char text[300], got[FIGURE_TEXT], asked[FIGURE_TEXT], wanted[60] = "";
    char of_mean[FIGURE_TEXT], mean[60] = "";
    bool far;

    if (p->o.error > 0)
        snprintf(wanted, sizeof wanted, ", %s %% were asked for",
                 figure(asked, p->o.error, 3));
    if (p->o.points.file && g->mean_estimate > 0)
        snprintf(mean, sizeof mean, ", that of the mean %s %%",
                 figure(of_mean, 100 * g->mean_estimate, 2));
    far = 100 * g->estimate > FAR * p->o.error; /* error 0: as good as may be */
    snprintf(text, sizeof text, "estimated error %s %%%s%s; %d stage%s%s",
             figure(got, 100 * g->estimate, 2), wanted, mean, g->stages,
             g->stages == 1 ? "" : "s",
             g->time_up     ? ", and no time for another"
             : g->rays_up   ? ", and another would take too long without --time"
             : !far         ? ""
             : g->stages_up ? ", which is as many as a job may have"
             : p->o.error > 0 ? ", and there is no other that comes much nearer"
                              : ", and there is no other that is much better");
    program_news(p, text);
    if (g->by_clock)
        program_news(p, p->o.points.file
                            ? "chosen by the clock: another run may choose "
                              "other options"
                            : "chosen by the clock: another run may choose "
                              "other options, which the header names");
}

/* The last line. */
void
program_say_done(struct program *p)
{
    const struct outcome *all = &p->result.sum.all;
    char text[200], error[60] = "", left_out[80] = "";
    char s[FIGURE_TEXT], percent[FIGURE_TEXT];

    if (p->result.goal.stages > 0)
        say_goal(p);
    else if (all->error > 0)
        snprintf(error, sizeof error, ", relative error about %s %%",
                 figure(percent, 100 * all->error, 2));
    if (all->left_out >= MSG_LEFT_OUT_TOLD)
        snprintf(left_out, sizeof left_out,
                 "; -ab %d leaves out about %s %% of the light",
                 p->o.params.ambounce, figure(percent, 100 * all->left_out, 2));
    snprintf(text, sizeof text, "done in %s s%s%s",
             figure(s, all->elapsed_s, 3), error, left_out);
    program_news(p, text);
}

void
program_warn_of_faults(struct program *p)
{
    const struct msg_fault *f = p->result.sum.all.faults;
    char text[WARNING_SIZE];

    for (int i = 0; i < MSG_FAULTS && f[i].count > 0; i++)
        if (p->scene.scene &&
            warning_fault(p->scene.scene, f[i].object, f[i].count, text))
            program_warn(p, text);
}
