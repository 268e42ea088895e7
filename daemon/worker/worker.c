/* worker.c - see worker.h
 *
 * A job goes from fetching its files to loading (its child was started) to
 * ready.  Its units are listed in the order in which they came; if the child
 * dies the first of them, one for each thread, are named as suspects.
 *
 * When the coordinator is lost the children go on, and their results are kept.
 * When it is back, perhaps in another life, and starts the job again, the
 * worker first sends the rows that were not acknowledged, then names its
 * unfinished units (STILL), then says READY.  The coordinator revokes units
 * that other workers got meanwhile.  New rows are kept until then, for they
 * would overtake the old ones. */
#include "config.h"

#include "worker/worker.h"

#include "worker/link.h"
#include "worker/peer.h"
#include "worker/relay.h"
#include "worker/state.h"
#include "worker/wjob.h"
#include "worker/worker_files.h"
#include "worker/worker_says.h"

#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define FIRST_REDIAL_MS 500  /* before dialling again, doubled each time */
#define LONG_TICK_MS    1000 /* ticks further apart: the process was stopped */

static struct wjob *
find_child(const struct worker *w, uint64_t conn)
{
    struct wjob *job = w->jobs;

    while (job && job->child != conn)
        job = job->next;
    return conn ? job : NULL;
}

/* --- the connection to the coordinator --- */

static void
dial(struct worker *w)
{
    struct action *a;

    w->coord = worker_new_conn(w);
    w->coord_state = COORD_DIALLING;
    w->welcome_ms = 0;
    a = actions_add(&w->actions, ACT_DIAL, w->coord);
    if (a)
        a->text = "";
}

static void
dial_later(struct worker *w)
{
    if (w->delay_ms == 0 ||
        (w->welcome_ms && w->now_ms - w->welcome_ms >= WORKER_STEADY_MS))
        w->delay_ms = FIRST_REDIAL_MS;
    w->dial_ms = worker_redial_ms(w, &w->delay_ms);
}

/* The machine may not be used now, and no coordinator is there to take the work
 * back: end all jobs, and their children. */
static void
end_jobs(struct worker *w)
{
    while (w->jobs)
        worker_end_job(w, w->jobs);
}

/* The connection to the coordinator is gone; log that, unless the coordinator
 * said BYE or REFUSE. */
static void
lost_coord(struct worker *w, const char *why)
{
    if (w->coord_state != COORD_PARTED)
        actions_log(&w->actions, ACT_WARN, "coordinator %s at=%s why=%s",
                    w->coord_state == COORD_WELCOME ? "lost" : "not reached",
                    w->env.coordinator, why);
    dial_later(w);
    w->coord = 0;
    w->coord_state = COORD_NONE;
    w->nasked = 0;
    for (struct wjob *job = w->jobs; job; job = job->next)
        job->started = false;
    relay_cut(w);
    if (w->away)
        end_jobs(w);
    if (w->draining)
        worker_stop(w, 0, "");
}

static void
say_hello(struct worker *w)
{
    struct msg m = { .type = MSG_HELLO,
                     .hello = { .min = MSG_VERSION_MIN,
                                .max = MSG_VERSION,
                                .role = MSG_ROLE_WORKER,
                                .name = w->env.name,
                                .program = w->env.program,
                                .address = w->env.address,
                                .threads = (uint16_t)w->env.threads } };

    actions_session(&w->actions, w->coord, MSG_AT_DIALLER, MSG_VERSION);
    actions_send(&w->actions, w->coord, &m);
}

/* --- public --- */

struct worker *
worker_new(const struct worker_env *env)
{
    struct worker *w = calloc(1, sizeof *w);

    if (!w)
        return NULL;
    w->env = *env;
    actions_init(&w->actions);
    return w;
}

void
worker_free(struct worker *w)
{
    if (!w)
        return;
    w->env.leave = NULL; /* no job needs room in the cache now */
    while (w->jobs)
        worker_end_job(w, w->jobs);
    link_release_callers(w);
    free(w->asked);
    actions_release(&w->actions);
    free(w);
}

struct action_list *
worker_actions(struct worker *w)
{
    return &w->actions;
}

void
worker_start(struct worker *w, uint64_t now_ms)
{
    w->now_ms = now_ms;
    if (!w->away)
        dial(w);
}

void
worker_opened(struct worker *w, uint64_t now_ms, uint64_t conn)
{
    w->now_ms = now_ms;
    if (conn == w->coord)
        say_hello(w);
    else
        link_opened(w, conn);
}

void
worker_accepted(struct worker *w, uint64_t now_ms, uint64_t conn)
{
    w->now_ms = now_ms;
    link_accepted(w, conn);
}

void
worker_closed(struct worker *w, uint64_t now_ms, uint64_t conn, const char *why)
{
    w->now_ms = now_ms;
    if (conn == w->coord)
        lost_coord(w, why);
    else
        link_closed(w, conn, why);
}

void
worker_message(struct worker *w, uint64_t now_ms, uint64_t conn,
               const struct msg *m)
{
    struct wjob *job;

    w->now_ms = now_ms;
    if (conn == w->coord) {
        worker_from_coord(w, m);
        return;
    }
    job = find_child(w, conn);
    if (job)
        worker_from_child(w, job, m);
    else
        link_message(w, conn, m);
}

void
worker_child_ended(struct worker *w, uint64_t now_ms, uint64_t conn, int status,
                   const char *text)
{
    struct wjob *job = find_child(w, conn);
    struct msg failed = { .type = MSG_FAILED,
                          .failed = { NULL, (uint16_t)status, text } };

    w->now_ms = now_ms;
    if (!job)
        return;
    job->child = 0;
    lossy_release(&job->to_child);
    if (status == EX_DATAERR) {
        worker_from_child(w, job, &failed);
        return;
    }
    actions_log(&w->actions, ACT_WARN, "child lost job=%s why=%s", job->hex,
                text);
    wjob_send_lost(w, job, status, text);
}

void
worker_set_limits(struct worker *w, unsigned load_s)
{
    w->env.load_s = load_s;
}

void
worker_written(struct worker *w, uint64_t now_ms, uint64_t conn, size_t n)
{
    struct wjob *job = find_child(w, conn);

    w->now_ms = now_ms;
    if (job) {
        lossy_written(&job->to_child, n);
        peer_pump(w, job->child, &job->to_child);
    } else {
        link_written(w, conn, n);
    }
}

void
worker_drain(struct worker *w, uint64_t now_ms)
{
    w->now_ms = now_ms;
    if (w->draining || w->coord_state != COORD_WELCOME) {
        worker_stop(w, 0, "");
        return;
    }
    w->draining = true;
    worker_send_drain(w);
}

/* Tell the coordinator another reason, once: on the connection that there still
 * is, or on a new one, which it ends at once. */
static void
say_away(struct worker *w)
{
    if (w->coord_state == COORD_WELCOME && !w->draining)
        worker_send_drain(w);
    else if (w->coord_state == COORD_NONE && !w->stopped)
        dial(w);
}

void
worker_allow(struct worker *w, uint64_t now_ms, enum msg_drain_why away)
{
    enum msg_drain_why was = w->away;

    w->now_ms = now_ms;
    w->away = away;
    if (was == away)
        return;
    if (was && away) {
        say_away(w);
        return;
    }
    actions_log(&w->actions, ACT_INFO, "%s",
                !away                      ? "work begins"
                : away == MSG_DRAIN_IN_USE ? "work ends: somebody uses the "
                                             "machine, what is left goes back"
                                           : "work ends: outside its hours, "
                                             "what is left goes back");
    if (!away)
        w->dial_ms = now_ms;
    else if (w->coord_state != COORD_WELCOME)
        end_jobs(w); /* lost_coord() may never come */
    else if (!w->draining)
        worker_send_drain(w);
}

void
worker_tick(struct worker *w, uint64_t now_ms)
{
    uint64_t ms = w->tick_ms ? now_ms - w->tick_ms : 0;

    w->awake_ms += ms < LONG_TICK_MS ? ms : LONG_TICK_MS;
    w->tick_ms = w->now_ms = now_ms;
    worker_watch_children(w);
    files_watch_room(w);
    if (w->coord_state == COORD_NONE && !w->stopped && !w->away &&
        now_ms >= w->dial_ms)
        dial(w);
    link_tick(w);
}

size_t
worker_kept(const struct worker *w, uint64_t child)
{
    const struct wjob *job = find_child(w, child);

    return job ? job->kept_bytes : 0;
}

void
worker_hold(struct worker *w, uint64_t child, bool held)
{
    struct wjob *job = find_child(w, child);

    if (job)
        job->held = held;
}

uint64_t
worker_coord(const struct worker *w)
{
    return w->coord;
}

uint64_t
worker_progress(const struct worker *w)
{
    return w->progress;
}
