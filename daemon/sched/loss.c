/* loss.c - see loss.h */
#include "config.h"

#include "sched/loss.h"

#include "desk/desk.h"
#include "desk/feeding.h"
#include "desk/holding.h"
#include "desk/linking.h"
#include "desk/speed.h"
#include "desk/verdict.h"
#include "filling/tiles.h"
#include "jobs/attempt.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/unit.h"
#include "sched/survey.h"

#include "base/text.h"

#include <stdio.h>
#include <sysexits.h>

/* How long units wait for a worker whose connection broke; it dials again after
 * at most .75 s. */
#define REDIAL_MS 2000

/* Units are kept for the worker that lost them at most so many times in a row.
 * Else a worker that dies of a unit and is started again would keep it for
 * ever.
 */
#define MOST_LOSSES 2

/* The leading attempt is over: another may lead.  End the attempts whose rows
 * were dropped, for they cannot. */
static void
new_lead(struct coord *c, struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];

    holding_forget_rows(job, unit);
    u->lead = 0;
    for (uint8_t i = u->nattempts; i-- > 0;)
        if (u->attempts[i].rows != ATTEMPT_MAY_LEAD) {
            desk_send_attempt(c, job, MSG_REVOKE, &u->attempts[i]);
            holding_end(c, job, &u->attempts[i]);
        }
}

/* The facts of such a loan serve the worker that gets the line. */
void
loss_end_loans(struct coord *c, struct job *job, uint32_t unit, uint32_t lender)
{
    struct job_unit *u = &job->units[unit];

    for (uint8_t i = u->nattempts; i-- > 0;)
        if (u->attempts[i].lending.lender == lender) {
            desk_send_attempt(c, job, MSG_YIELD, &u->attempts[i]);
            holding_end(c, job, &u->attempts[i]);
        }
}

/* End the attempt, and choose what comes of the unit. */
static void
lose(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    uint32_t unit = attempt->unit, number = attempt->number;
    struct job_unit *u = &job->units[unit];
    bool led = number == u->lead || u->lead == 0;

    holding_end(c, job, attempt);
    loss_end_loans(c, job, unit, number);
    if (u->nattempts > 0 && led)
        new_lead(c, job, unit);
    if (u->nattempts == 0)
        unit_wait(job, unit);
}

void
loss_of(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    struct partition_area a;

    partition_area(job->partition, attempt->unit, &a);
    job->frames[a.frame].untold = true;
    lose(c, job, attempt);
}

/* If no worker has the unit, let rows of it that are on their way not count. */
static void
close_rows(struct job_unit *u)
{
    if (u->nattempts == 0)
        u->lead = 0;
}

void
loss_taken(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    struct job_unit *u = &job->units[attempt->unit];

    desk_send_attempt(c, job, MSG_REVOKE, attempt);
    loss_of(c, job, attempt);
    close_rows(u);
}

void
loss_given_back(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    struct job_unit *u = &job->units[attempt->unit];

    lose(c, job, attempt);
    close_rows(u);
    u->given_back = u->nattempts == 0;
}

/* End all that the worker does for the job. */
static void
take_all_back(struct coord *c, struct job *job, uint32_t index)
{
    survey_lost(job, index);
    tiles_lost(job, index);
    for (uint32_t i = job->nout; i-- > 0;) {
        uint32_t unit = job->out[i];
        struct job_attempt *attempt = attempt_of_part(job, unit, index);

        if (!attempt)
            continue;
        if (job->units[unit].losses < UINT8_MAX)
            job->units[unit].losses++;
        loss_of(c, job, attempt);
    }
}

void
loss_keep(const struct coord *c, struct job *job, uint32_t index, uint64_t ms)
{
    for (uint32_t i = 0; job->partition && i < job->nunits; i++) {
        const struct job_unit *u = &job->units[i];

        if (u->state != UNIT_DONE && u->nattempts == 0 && u->lead != 0 &&
            u->part == index && u->losses <= MOST_LOSSES)
            partition_keep(job->partition, i, index);
    }
    job->parts[index].keep_ms = c->now_ms + ms;
}

void
loss_tick(struct coord *c, struct job *job)
{
    for (uint32_t i = 0; i < job->nparts; i++) {
        struct job_part *part = &job->parts[i];

        if (part->keep_ms == 0 || c->now_ms < part->keep_ms)
            continue;
        part->keep_ms = 0;
        partition_keep_none(job->partition, i);
        c->stirred = true;
    }
}

void
loss_at_ready(struct coord *c, struct job *job, uint32_t index)
{
    for (uint32_t i = job->nout; i-- > 0;) {
        uint32_t unit = job->out[i];
        struct job_attempt *attempt = attempt_of_part(job, unit, index);
        struct partition_area a;

        if (!attempt || attempt->origin == ATTEMPT_RESUMED)
            continue;
        partition_area(job->partition, unit, &a);
        if (job->units[unit].next_row < a.height)
            loss_of(c, job, attempt);
    }
    /* the units that it lost go to it now, if it takes units at all */
    loss_keep(c, job, index,
              desk_takes_units(job->parts[index].worker) ? REDIAL_MS : 0);
}

/* The attempt that the worker names by STILL, begun again if need be; NULL: the
 * unit went to another worker, or is done. */
static struct job_attempt *
find_or_revive(struct coord *c, struct job *job, uint32_t index,
               const struct msg_gave *m)
{
    const struct job_unit *u = &job->units[m->unit];
    struct job_attempt *attempt = attempt_find(job, m->unit, index, m->attempt);

    if (!attempt && u->state != UNIT_DONE && u->nattempts == 0 &&
        u->lead != 0 && u->lead == m->attempt && u->part == index &&
        holding_revive(c, job, index, m->unit))
        attempt = attempt_find(job, m->unit, index, m->attempt);
    return attempt;
}

static bool
resume(struct coord *c, struct job *job, uint32_t index,
       const struct msg_gave *m)
{
    struct partition_area a;
    struct job_attempt *attempt;

    if (!job->partition || m->unit >= job->nunits)
        return false;
    partition_area(job->partition, m->unit, &a);
    attempt = m->height <= a.height ? find_or_revive(c, job, index, m) : NULL;
    if (!attempt)
        return false;
    attempt->origin = ATTEMPT_RESUMED;
    job->units[m->unit].losses = 0;
    desk_log_unit(c, job, attempt, "unit still");
    if (m->height == a.height || holding_shrink(c, job, attempt, m->height))
        return true;
    loss_of(c, job, attempt);
    return false;
}

void
loss_still(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_gave *m = &msg->still;
    uint32_t index;
    struct job *job = desk_job_of(c, w, m->job, &index);
    struct msg no = { .type = MSG_REVOKE,
                      .revoke = { m->job, m->unit, m->attempt } };

    if (job &&
        (job->parts[index].state != PART_LOADING || !resume(c, job, index, m)))
        actions_send(&c->actions, w->conn, &no);
}

void
loss_all(struct coord *c, struct job *job, uint32_t index, enum part_state to)
{
    take_all_back(c, job, index);
    if (part_is_here(&job->parts[index]))
        part_step(&job->parts[index], to);
    linking_left(c, job, index);
    feeding_left(c, job, index);
    if (job->partition)
        partition_set_absent(job->partition, index, true);
    speed_measure(c, job);
}

/* How long units are kept for a worker that is gone: not if it was leaving.  If
 * it was not ready yet, no longer than they would have been. */
static uint64_t
keep_time_ms(const struct coord *c, const struct job_part *part)
{
    if (part->worker->leaving)
        return 0;
    if (part->state == PART_READY)
        return REDIAL_MS;
    return part->keep_ms > c->now_ms ? part->keep_ms - c->now_ms : 0;
}

void
loss_worker_gone(struct coord *c, struct coord_worker *w)
{
    w->loading = NULL;
    for (size_t i = 0; i < c->nbegun; i++) {
        struct job *job = c->jobs[i];
        uint32_t index = desk_index(job, w);
        uint64_t ms;

        /* when it comes back its disk may have room */
        if (index != JOB_NOBODY && job->parts[index].state == PART_NO_ROOM)
            part_step(&job->parts[index], PART_GONE);
        if (index == JOB_NOBODY || !part_is_here(&job->parts[index]))
            continue;
        ms = keep_time_ms(c, &job->parts[index]);
        loss_all(c, job, index, PART_GONE);
        if (!job_over(job))
            loss_keep(c, job, index, ms);
    }
}

/* A child died while it worked on the unit; false: the job has failed. */
static bool
note_crash(struct coord *c, struct job *job, uint32_t index, uint32_t unit,
           const char *why)
{
    struct job_unit *u = &job->units[unit];
    struct partition_area a;
    char text[MSG_MAX_TEXT + 1];
    bool again = unit_crashed(&u->crashes, index);

    loss_of(c, job, attempt_of_part(job, unit, index));
    if (again)
        return true;
    partition_area(job->partition, unit, &a);
    snprintf(text, sizeof text,
             "unit %u (frame %u, %ux%u pixels at x %u, y %u) brought the "
             "renderer down %u times: %.200s",
             unit, job->spec.frames[a.frame].number, a.width, a.height, a.x,
             a.y, u->crashes.n, why);
    verdict_job(c, job, JOB_FAILED, EX_SOFTWARE, text);
    return false;
}

static bool
ready_worker(const struct job *job)
{
    for (uint32_t i = 0; i < job->nparts; i++)
        if (job->parts[i].state == PART_READY)
            return true;
    return false;
}

/* A child died before it was ready.  Sets *to to the next state of its worker's
 * part.  False: the job has failed. */
static bool
crashed_loading(struct coord *c, struct job *job, struct job_part *part,
                const struct msg_lost *m, enum part_state *to)
{
    uint32_t workers = 0;
    char text[MSG_MAX_TEXT + 1];
    bool again; /* the scene is not to blame yet */

    part->load_crashes++;
    for (uint32_t i = 0; i < job->nparts; i++)
        workers += job->parts[i].load_crashes > 0;
    /* two small machines say nothing of a third */
    again = workers < 2 || m->status != EX_SOFTWARE;
    if (again && part->load_crashes < JOB_MAX_CRASHES)
        return true;
    if (ready_worker(job) ||
        (again && desk_others_may(c, job, part->worker, true))) {
        *to = PART_EXCLUDED;
        return true;
    }
    snprintf(text, sizeof text,
             "no worker can load the scene; the last, %s: %.380s", part->name,
             m->text);
    verdict_job(c, job, JOB_FAILED, m->status, text);
    return false;
}

/* A child died while it had units, but not because of them.  *to and the result
 * are those of crashed_loading(). */
static bool
setback(struct coord *c, struct job *job, struct job_part *part,
        const char *why, enum part_state *to)
{
    char text[MSG_MAX_TEXT + 1];

    if (++part->setbacks < JOB_MAX_SETBACKS)
        return true;
    *to = PART_EXCLUDED;
    actions_log(&c->actions, ACT_WARN,
                "worker excluded job=%s worker=%s why=%s", job->hex, part->name,
                why);
    if (desk_others_may(c, job, part->worker, true))
        return true;
    snprintf(text, sizeof text, "no worker can keep a process for it: %.400s",
             why);
    verdict_job(c, job, JOB_FAILED, EX_UNAVAILABLE, text);
    return false;
}

/* A worker has no room for the job's files: other workers go on, or the job
 * waits until a worker has room. */
void
loss_no_room(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_room *m = &msg->room;
    uint32_t index;
    struct job *job = desk_job_of(c, w, m->job, &index);
    struct job_part *part;

    if (!job)
        return;
    part = &job->parts[index];
    if (!m->has && part->state != PART_LOADING)
        return;
    actions_log(&c->actions, m->has ? ACT_INFO : ACT_WARN,
                m->has ? "worker has room again job=%s worker=%s%s"
                       : "worker has no room job=%s worker=%s why=%s",
                job->hex, w->name, m->text);
    if (m->has) {
        if (part->state == PART_NO_ROOM)
            part_step(part, PART_GONE);
        return;
    }
    rad_text_print(w->no_room, sizeof w->no_room, "%s", m->text);
    rad_text_clean(w->no_room);
    if (w->loading == job)
        w->loading = NULL;
    loss_all(c, job, index, PART_NO_ROOM);
}

static bool
has_unit(const struct job *job, uint32_t index, uint32_t unit)
{
    return unit < job->nunits && attempt_of_part(job, unit, index);
}

void
loss_reported(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_lost *m = &msg->lost;
    enum part_state to = PART_GONE;
    struct job_part *part;
    uint32_t index, surveying;
    struct job *job = desk_job_of(c, w, m->job, &index);
    bool blamed; /* what the child was at */

    if (!job)
        return;
    actions_log(&c->actions, ACT_WARN, "child lost job=%s worker=%s why=%s",
                job->hex, w->name, m->text);
    if (w->loading == job)
        w->loading = NULL;
    part = &job->parts[index];
    if (part->state == PART_LOADING && !crashed_loading(c, job, part, m, &to))
        return;
    blamed = m->status == EX_SOFTWARE &&
             (m->nunits > 0 || part->surveying || tiles_out(part) > 0);
    if (part->state == PART_READY && !blamed &&
        !setback(c, job, part, m->text, &to))
        return;
    for (uint32_t i = 0; i < m->nunits; i++)
        if (has_unit(job, index, m->units[i]) &&
            !note_crash(c, job, index, m->units[i], m->text))
            return;
    if (blamed && tiles_out(part) > 0 && !tiles_crashed(c, job, index, m->text))
        return;
    surveying = part->surveying;
    loss_all(c, job, index, to);
    if (surveying)
        survey_crashed(c, job, surveying - 1);
}
