/* worker_coord.c - messages of the coordinator to a worker
 *
 * coord_handlers[] has the handler of each message; relay.c has those of shared
 * lines and of passes. */
#include "config.h"

#include "worker/worker_says.h"

#include "worker/gather.h"
#include "worker/link.h"
#include "worker/relay.h"
#include "worker/state.h"
#include "worker/wjob.h"
#include "worker/worker_files.h"

#include <string.h>
#include <sysexits.h>

/* Another life of the coordinator introduces the peers that it wants linked. It
 * may not know of the others that their keys were retired. */
static void
note_epoch(struct worker *w, uint64_t epoch)
{
    if (epoch != w->epoch)
        for (struct wjob *job = w->jobs; job; job = job->next)
            link_release_job(w, job);
    w->epoch = epoch;
}

static void
on_welcome(struct worker *w, const struct msg *m)
{
    unsigned version = m->welcome.version;

    if (msg_common_version(version, version) == 0) {
        actions_log(&w->actions, ACT_ERR,
                    "the coordinator speaks protocol version %u, not %u to %u",
                    version, MSG_VERSION_MIN, MSG_VERSION);
        worker_stop(w, EX_PROTOCOL, "the coordinator speaks another version");
        return;
    }
    w->coord_state = COORD_WELCOME;
    w->welcome_ms = w->now_ms;
    actions_session(&w->actions, w->coord, MSG_AT_WORKER, version);
    actions_log(&w->actions, ACT_INFO,
                "welcome program=%s epoch=%llu protocol=%u", m->welcome.program,
                (unsigned long long)m->welcome.epoch, version);
    note_epoch(w, m->welcome.epoch);
    /* of a job that ended meanwhile the coordinator answers TALLY by JOB_END */
    for (struct wjob *job = w->jobs; job; job = job->next)
        worker_send_tally(w, job);
    if (w->away)
        worker_send_drain(w);
}

/* The worker stops when it is refused, unless the status says to try later.  A
 * status that is not of sysexits.h breaks the protocol. */
static void
on_refuse(struct worker *w, const struct msg *m)
{
    int status = m->refuse.status;

    w->coord_state = COORD_PARTED;
    actions_log(&w->actions, ACT_ERR, "refused by the coordinator why=%s",
                m->refuse.text);
    if (status < EX__BASE || status > EX__MAX)
        status = EX_PROTOCOL;
    if (status != EX_TEMPFAIL)
        worker_stop(w, status, m->refuse.text);
}

static void
on_bye(struct worker *w, const struct msg *m)
{
    bool wished = w->draining || w->away;

    w->coord_state = COORD_PARTED;
    actions_log(&w->actions, wished ? ACT_INFO : ACT_WARN,
                "let go by the coordinator why=%s", m->bye.text);
    if (w->draining)
        worker_stop(w, 0, "");
}

static void
on_chunk(struct worker *w, const struct msg *m)
{
    struct action *a;

    if (!worker_take_chunk(w, &m->chunk))
        return;
    a = actions_add(&w->actions, ACT_PUT_CHUNK, w->coord);
    if (a)
        a->chunk = m->chunk;
    for (struct wjob *job = w->jobs; job; job = job->next)
        if (job->state == WJOB_FETCHING && files_need(job, m->chunk.hash))
            job->bytes_in += m->chunk.len;
}

/* Give up borrowed columns: when the connection broke their lender took them
 * back. */
static void
drop_loans(struct worker *w, struct wjob *job)
{
    for (size_t i = job->nattempts; i-- > 0;)
        if (job->attempts[i].loan)
            wjob_revoke_attempt(w, job, job->attempts[i].unit,
                                job->attempts[i].number);
}

/* Name the attempts that the child has. */
static void
say_still(struct worker *w, const struct wjob *job)
{
    for (size_t i = 0; i < job->nattempts; i++) {
        const struct wattempt *a = &job->attempts[i];
        struct msg still = { .type = MSG_STILL,
                             .still = { job->id, a->unit, a->number,
                                        a->height } };
        struct msg parked = { .type = MSG_PARKED,
                              .parked = { job->id, a->unit, a->number } };

        worker_send_coord(w, &still);
        if (a->parked)
            worker_send_coord(w, &parked);
    }
}

/* Send the rows that were not acknowledged. */
static void
repeat_rows(struct worker *w, const struct wjob *job)
{
    /* before the rows: a unit is not complete without its bottom */
    if ((job->kept || job->nattempts > 0) && w->coord_state == COORD_WELCOME)
        relay_repeat(w, job);
    for (const struct wkept *k = job->kept; k; k = k->next)
        actions_send_bytes(&w->actions, w->coord, k->bytes, k->len);
}

/* The coordinator is back and starts a job that this worker is ready for. */
static void
resume_job(struct worker *w, struct wjob *job)
{
    struct msg ready = { .type = MSG_READY, .ready = job->ready };

    drop_loans(w, job);
    repeat_rows(w, job);
    say_still(w, job);
    worker_send_coord(w, &ready);
}

static void
on_job_start(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->job_start.job);
    bool back;

    if (job && !wjob_is_same(w, job, m)) {
        actions_log(&w->actions, ACT_INFO,
                    "job end job=%s why=another job has its id", job->hex);
        worker_end_job(w, job);
        job = NULL;
    }
    if (!job)
        job = wjob_new(w, m);
    if (!job) {
        w->actions.failed = true;
        return;
    }
    back = !job->started;
    job->started = true;
    gather_turn(job);
    if (job->state == WJOB_READY) {
        resume_job(w, job);
        return;
    }
    if (back) /* rows of a child that died meanwhile */
        repeat_rows(w, job);
    if (job->state != WJOB_LOADING)
        files_look(w, job);
}

static void
on_job_end(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->job_end.job);

    if (!job)
        return;
    actions_log(&w->actions, ACT_INFO, "job end job=%s", job->hex);
    worker_end_job(w, job);
}

static void
on_unit(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->unit.job);

    if (!job || job->state != WJOB_READY)
        return; /* the coordinator is about to hear that the child is gone */
    if (!wjob_add_attempt(job, m->unit.unit, m->unit.attempt)) {
        w->actions.failed = true;
        return;
    }
    job->attempts[job->nattempts - 1].height = m->unit.height;
    w->progress++;
    worker_send_child(w, job, m);
}

static void
on_revoke(struct worker *w, const struct msg *m)
{
    const struct msg_attempt *r = &m->revoke;
    struct wjob *job = worker_find_job(w, r->job);

    if (job && wjob_has_attempt(job, r->unit, r->attempt))
        wjob_revoke_attempt(w, job, r->unit, r->attempt);
}

static void
on_ack(struct worker *w, const struct msg *m)
{
    const struct msg_ack *a = &m->ack;
    struct wjob *job = worker_find_job(w, a->job);

    if (!job)
        return;
    for (struct wkept **link = &job->kept; *link; link = &(*link)->next)
        if ((*link)->unit == a->unit && (*link)->attempt == a->attempt &&
            (*link)->row == a->row) {
            wjob_drop_kept(job, link);
            return;
        }
}

static void
on_job_peers(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->job_peers.job);

    if (job)
        link_introduce(w, job, &m->job_peers);
}

static const struct {
    enum msg_type type;
    void (*handle)(struct worker *w, const struct msg *m);
} coord_handlers[] = {
    { MSG_UNIT, on_unit },
    { MSG_ACK, on_ack },
    { MSG_WELCOME, on_welcome },
    { MSG_REFUSE, on_refuse },
    { MSG_BYE, on_bye },
    { MSG_CHUNK, on_chunk },
    { MSG_JOB_START, on_job_start },
    { MSG_JOB_END, on_job_end },
    { MSG_REVOKE, on_revoke },
    { MSG_JOB_PEERS, on_job_peers },
};

void
worker_from_coord(struct worker *w, const struct msg *m)
{
    for (size_t i = 0; i < sizeof coord_handlers / sizeof coord_handlers[0];
         i++)
        if (coord_handlers[i].type == m->type) {
            coord_handlers[i].handle(w, m);
            return;
        }
    relay_down(w, m);
}
