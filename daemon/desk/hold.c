/* hold.c - who has what
 *
 * A worker's go at a unit, from when it goes out to it until it is done or
 * lost, and what of that its threads are at. */
#include "config.h"

#include "sched/sched.h"

/* Lines that a holder is at. */
static uint32_t
lines_of(const struct job *job, uint32_t unit, const struct job_go *go)
{
    uint32_t first, last;

    partition_unit_lines(job->partition, unit, &first, &last);
    return go->lender ? 1 : last - first;
}

static void
more_in_flight(struct job *job, uint32_t unit, struct job_go *go)
{
    struct job_worker *jw = &job->workers[go->worker];

    go->lines = lines_of(job, unit, go);
    jw->lines += go->lines;
    if (jw->in_flight++ == 0)
        job->payer->threads += jw->held = jw->threads;
    if (jw->worker->in_flight++ == 0 ||
        job->spec.priority > jw->worker->priority)
        jw->worker->priority = job->spec.priority;
}

static void
less_in_flight(const struct coord *c, struct job *job, struct job_worker *jw,
               const struct job_go *go)
{
    jw->lines -= go->lines;
    if (--jw->in_flight == 0)
        job->payer->threads -= jw->held;
    jw->worker->in_flight--;
    if (jw->in_flight == 0)
        yield_rate(c, jw->worker);
    if (jw->worker->in_flight > 0)
        return;
    jw->worker->alone = false;
    jw->worker->free_ms = c->now_ms;
}

void
hold_shrunk(struct job *job, uint32_t unit, struct job_go *go)
{
    struct job_worker *jw = &job->workers[go->worker];

    if (!job_go_works(go))
        return;
    jw->lines -= go->lines;
    go->lines = lines_of(job, unit, go);
    jw->lines += go->lines;
}

struct job_go *
hold_add(struct coord *c, struct job *job, uint32_t index, uint32_t unit,
         uint32_t attempt)
{
    struct job_worker *jw = &job->workers[index];
    struct job_go *go = job_go_add(job, unit);

    if (!go)
        return NULL;
    speed_touch(c, jw);
    go->worker = index;
    go->attempt = attempt;
    go->out_ms = c->now_ms;
    go->line_left = -1;
    more_in_flight(job, unit, go);
    return go;
}

void
hold_release(struct coord *c, struct job *job, uint32_t unit, struct job_go *go)
{
    struct job_worker *jw = &job->workers[go->worker];

    speed_touch(c, jw);
    if (go->lender)
        lending_ended(c, job, unit, go);
    if (go->delivered) {
        jw->worker->delivered--;
    } else if (go->parked) {
        jw->parked--;
        jw->worker->parked--;
    } else {
        less_in_flight(c, job, jw, go);
    }
    c->stirred = true;
    if (job->shared)
        handoff_top_made(c, job, unit, go);
    job_go_remove(job, unit, go);
}

void
hold_park(struct coord *c, struct job *job, struct job_go *go)
{
    struct job_worker *jw = &job->workers[go->worker];

    speed_touch(c, jw);
    go->parked = true;
    go->parked_ms = c->now_ms;
    jw->parked++;
    jw->worker->parked++;
    less_in_flight(c, job, jw, go);
    c->stirred = true;
}

void
hold_delivered(struct coord *c, struct job *job, struct job_go *go)
{
    struct job_worker *jw = &job->workers[go->worker];

    speed_touch(c, jw);
    if (go->parked) {
        jw->parked--;
        jw->worker->parked--;
    } else {
        less_in_flight(c, job, jw, go);
    }
    go->parked = false;
    go->delivered = true;
    jw->worker->delivered++;
    c->stirred = true;
}

void
hold_unpark(struct coord *c, struct job *job, uint32_t unit, struct job_go *go)
{
    struct job_worker *jw = &job->workers[go->worker];

    if (go->yielded)
        return;
    speed_touch(c, jw);
    go->parked = false;
    jw->parked--;
    jw->worker->parked--;
    more_in_flight(job, unit, go);
}

void
hold_forget_rows(struct job *job, uint32_t unit)
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
