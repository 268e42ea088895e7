/* submit_ends.c - what the user is told of a job that ends early; see
 * submit_impl.h */
#include "config.h"

#include "link/submit_impl.h"

#include "common/figure.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* How the user gets the job's results.  Values of sensor points are useless
 * without the points, so those need the same submission again. */
static void
format_way(const struct submit *s, char *buf, size_t n)
{
    uint32_t flags = s->job->spec->flags;

    if (!(flags & MSG_JOB_POINTS))
        snprintf(buf, n, "radctl fetch %s%s -o FILE%s", s->id,
                 s->job->with ? s->job->with : "",
                 s->job->spec->nframes > 1 ? "%d" : "");
    else
        snprintf(buf, n, "submit again with --job=%s", s->id);
}

/* An error that says that the job, or what it made, stays with the coordinator,
 * and what to do. */
static int
left_behind(struct submit *s)
{
    char way[160];

    format_way(s, way, sizeof way);
    if (submit_is_done(s))
        return rad_fail(s->err, RAD_ETEMPFAIL,
                        "interrupted; the job is done: %s", way);
    if (s->last.state == MSG_STATE_PAUSED)
        return rad_fail(s->err, RAD_ETEMPFAIL,
                        "interrupted; the job stays, paused: radctl resume %s, "
                        "then %s",
                        s->id, way);
    if (s->last.state == MSG_STATE_HELD)
        return rad_fail(s->err, RAD_ETEMPFAIL,
                        "interrupted; the job stays, and goes on when the "
                        "coordinator's disk has room: %s",
                        way);
    return rad_fail(s->err, RAD_ETEMPFAIL, "interrupted; the job goes on: %s",
                    way);
}

int
submit_interrupted(struct submit *s)
{
    if (s->ending == ENDING_CANCEL || s->ending == ENDING_OVER ||
        s->cb->alive || s->stage < STAGE_ASKED)
        return rad_fail(s->err, RAD_ETEMPFAIL, "interrupted");
    if (s->stage >= STAGE_KNOWN)
        return left_behind(s);
    return rad_fail(s->err, RAD_ETEMPFAIL,
                    "interrupted; the coordinator may have the job: radctl "
                    "job %s",
                    s->id);
}

int
submit_not_settled(struct submit *s)
{
    *s->err = (struct rad_error){ 0 }; /* why the connection failed */
    return rad_fail(s->err, RAD_ETEMPFAIL,
                    "the coordinator has not said that the job is cancelled: "
                    "radctl cancel %s",
                    s->id);
}

void
submit_say_what_it_got(struct submit *s)
{
    const struct msg_progress *p = &s->last;
    uint32_t nframes = s->job->spec->nframes;
    char text[200], seconds[FIGURE_TEXT], written[60] = "no picture is written";

    if (!s->met_worker) {
        s->cb->say(s->cb->arg, "cancelled: nothing was rendered yet");
        return;
    }
    if (nframes > 1)
        snprintf(written, sizeof written,
                 "%" PRIu32 " of %" PRIu32 " pictures are written",
                 s->delivered, nframes);
    snprintf(text, sizeof text,
             "cancelled: %.0f %% of the pixels were rendered in %s s; %s",
             p->pixels_total ? floor(100. * (double)p->pixels_done /
                                     (double)p->pixels_total)
                             : 0,
             figure(seconds, p->elapsed_s, 3), written);
    s->cb->say(s->cb->arg, text);
}
