/* holding.c - see holding.h
 *
 * Begins and ends attempts, and counts each worker's attempts by their states
 * (attempt.c), in each job and in all jobs together. */
#include "config.h"

#include "desk/holding.h"

#include "desk/desk.h"
#include "desk/duplicate.h"
#include "desk/speed.h"
#include "jobs/attempt.h"
#include "jobs/part.h"
#include "jobs/unit.h"

bool
holding_has_any(const struct job *job, const struct coord_worker *w)
{
    uint32_t index = desk_index(job, w);

    return index != JOB_NOBODY && job->parts[index].in_flight > 0;
}

uint32_t
holding_workers(const struct job *job)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < job->nparts; i++) {
        const struct job_part *part = &job->parts[i];
        const struct coord_worker *w = part->worker;
        bool away = !desk_takes_units(w) || w->priority > job->spec.priority ||
                    (w->fills && w->fills->spec.priority > job->spec.priority);

        n += part_is_here(part) && (part->counted_threads > 0 || !away);
    }
    return n;
}

void
holding_rate(const struct coord *c, struct coord_worker *w)
{
    w->priority = INT64_MIN;
    for (size_t i = 0; w->in_flight > 0 && i < c->nbegun; i++) {
        uint32_t index = desk_index(c->jobs[i], w);

        if (index == JOB_NOBODY || c->jobs[i]->parts[index].in_flight == 0)
            continue;
        w->priority = c->jobs[i]->spec.priority;
        return;
    }
}

/* Count the worker's threads for the job's payer while it has attempts in
 * flight of the job, makes its tiles, or estimates its areas. */
static void
count_threads(struct job *job, struct job_part *part)
{
    bool works = part->in_flight > 0 || part->worker->fills == job;

    if (works == (part->counted_threads > 0))
        return;
    job->payer->threads -= part->counted_threads;
    part->counted_threads = works ? part->threads : 0;
    job->payer->threads += part->counted_threads;
}

void
holding_fill(struct coord_worker *w, struct job *job)
{
    struct job *old = w->fills;

    w->fills = job;
    if (old && old != job)
        count_threads(old, &old->parts[desk_index(old, w)]);
    if (job)
        count_threads(job, &job->parts[desk_index(job, w)]);
}

void
holding_survey(struct job *job, uint32_t index, uint32_t chunk)
{
    struct coord_worker *w = job->parts[index].worker;

    job->parts[index].surveying = chunk;
    if (chunk > 0)
        holding_fill(w, job);
    else if (w->fills == job)
        holding_fill(w, NULL);
}

static void
more_in_flight(struct job *job, struct job_attempt *attempt)
{
    struct job_part *part = &job->parts[attempt->part];

    part->in_flight++;
    count_threads(job, part);
    holding_fill(part->worker, NULL);
    if (part->worker->in_flight++ == 0 ||
        job->spec.priority > part->worker->priority)
        part->worker->priority = job->spec.priority;
}

static void
less_in_flight(const struct coord *c, struct job *job, struct job_part *part)
{
    part->in_flight--;
    count_threads(job, part);
    part->worker->in_flight--;
    if (part->in_flight == 0)
        holding_rate(c, part->worker);
    if (part->worker->in_flight > 0)
        return;
    part->worker->alone = false;
    part->worker->free_ms = c->now_ms;
}

void
holding_step(struct coord *c, struct job *job, struct job_attempt *attempt,
             enum attempt_state to)
{
    struct job_part *part = &job->parts[attempt->part];
    enum attempt_state from = attempt->state;
    bool waited = attempt_waits(attempt), waits;

    speed_touch(c, part);
    attempt_step(attempt, to);
    waits = attempt_waits(attempt);
    if (waited && waits)
        return;
    part->parked += waits - waited;
    part->worker->parked += waits - waited;
    part->worker->delivered +=
        (to == ATTEMPT_DELIVERED) - (from == ATTEMPT_DELIVERED);
    if (from == ATTEMPT_WORKING)
        less_in_flight(c, job, part);
    if (to == ATTEMPT_WORKING)
        more_in_flight(job, attempt);
    else
        c->stirred = true;
    if (waits)
        attempt->parked_ms = c->now_ms;
}

struct job_attempt *
holding_begin(struct coord *c, struct job *job, uint32_t index, uint32_t unit,
              uint32_t number)
{
    struct job_attempt *attempt = attempt_add(job, unit);

    if (!attempt)
        return NULL;
    attempt->part = index;
    attempt->number = number;
    attempt->out_ms = c->now_ms;
    holding_step(c, job, attempt, ATTEMPT_WORKING);
    return attempt;
}

void
holding_top_made(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    struct partition_area a;
    uint32_t first, last;

    if (!attempt->handoff.makes_top)
        return;
    partition_area(job->partition, attempt->unit, &a);
    partition_unit_lines(job->partition, attempt->unit, &first, &last);
    attempt->handoff.makes_top = false;
    partition_keep_line(job->partition, a.frame, first - 1, false);
    c->stirred = true;
}

void
holding_send_back(struct coord *c, const struct coord_worker *to,
                  const struct msg_back *back)
{
    struct msg m = { .type = MSG_BACK, .back = *back };

    if (to->conn != 0)
        actions_send(&c->actions, to->conn, &m);
}

static void
end_loan(struct coord *c, struct job *job, const struct job_attempt *loan)
{
    struct job_attempt *to =
        attempt_of_number(job, loan->unit, loan->lending.lender);
    uint32_t first, last;

    if (!to)
        return;
    to->lending.loans--;
    if (to->state == ATTEMPT_DELIVERED)
        return;
    partition_unit_lines(job->partition, loan->unit, &first, &last);
    holding_send_back(c, job->parts[to->part].worker,
                      &(struct msg_back){ job->id, loan->unit, to->number,
                                          last - 1, loan->lending.x,
                                          loan->lending.n });
    if (to->state == ATTEMPT_BLOCKED)
        holding_step(c, job, to, ATTEMPT_WORKING);
}

void
holding_end(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    if (attempt->origin == ATTEMPT_LOAN)
        end_loan(c, job, attempt);
    holding_step(c, job, attempt, ATTEMPT_OVER);
    if (job->shared)
        holding_top_made(c, job, attempt);
    attempt_remove(job, attempt);
}

void
holding_forget_rows(struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];
    struct partition_area a;
    uint64_t pixels;

    partition_area(job->partition, unit, &a);
    pixels = (uint64_t)u->stored_rows * a.width;
    job->pixels_done -= pixels;
    job->frames[a.frame].rows_pixels -= pixels;
    u->next_row = u->stored_rows = 0;
    duplicate_forget(u);
}

bool
holding_shrink(struct coord *c, struct job *job, struct job_attempt *attempt,
               uint32_t height)
{
    uint32_t given = height >= job->units[attempt->unit].next_row
                         ? partition_give(job->partition, attempt->unit, height)
                         : PARTITION_NONE;

    if (given == PARTITION_NONE)
        return false;
    if (!unit_grow(job))
        c->actions.failed = true;
    desk_keep_unit(c, job, attempt->unit);
    desk_keep_unit(c, job, given);
    return true;
}

bool
holding_revive(struct coord *c, struct job *job, uint32_t index, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];
    struct job_attempt *attempt;

    unit_take(job, unit);
    attempt = holding_begin(c, job, index, unit, u->lead);
    if (!attempt) {
        c->actions.failed = true;
        return false;
    }
    if (u->out_ms != 0)
        attempt->out_ms = u->out_ms; /* so its lease does not begin anew */
    return true;
}
