/* desk.c - see desk.h */
#include "config.h"

#include "desk/desk.h"

#include "desk/order.h"
#include "jobs/job.h"
#include "jobs/part.h"

#include "base/list.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The shell counts ids up; tests/sim puts the host's number into the upper
 * bits. */
size_t
desk_slot(uint64_t id)
{
    return (size_t)(id ^ id >> 16) % COORD_CONNS;
}

struct coord_conn *
desk_find_conn(const struct coord *c, uint64_t id)
{
    struct coord_conn *conn = c->by_id[desk_slot(id)];

    while (conn && conn->id != id)
        conn = conn->chain;
    return conn;
}

void
desk_reply_failed(struct coord *c, const struct coord_conn *conn,
                  uint32_t request, const uint8_t *job, int status,
                  const char *text)
{
    struct msg m = { .type = MSG_FAILED,
                     .request = request,
                     .failed = { job, (uint16_t)status, text } };

    actions_send(&c->actions, conn->id, &m);
}

struct coord_worker *
desk_find_worker(const struct coord *c, const char *name)
{
    struct coord_worker *w = c->workers;

    while (w && strcmp(w->name, name) != 0)
        w = w->next;
    return w;
}

struct coord_owner *
desk_owner(struct coord *c, const char *name)
{
    struct coord_owner *o = c->owners;

    while (o && strcmp(o->name, name) != 0)
        o = o->next;
    if (o)
        return o;
    o = calloc(1, sizeof *o);
    if (!o)
        return NULL;
    snprintf(o->name, sizeof o->name, "%s", name);
    o->next = c->owners;
    return c->owners = o;
}

uint32_t
desk_index(const struct job *job, const struct coord_worker *w)
{
    return w->id < job->nindex ? job->index[w->id] : JOB_NOBODY;
}

uint32_t
desk_add_part(struct coord *c, struct job *job, struct coord_worker *w)
{
    while (job->nindex <= w->id) {
        if (!rad_list_grow(&job->index, job->nindex, sizeof *job->index))
            return JOB_NOBODY;
        job->index[job->nindex++] = JOB_NOBODY;
    }
    if (job->index[w->id] == JOB_NOBODY) {
        uint32_t i = part_add(job, w->name);

        job->index[w->id] = i;
        if (i != JOB_NOBODY)
            job->parts[i].worker = w;
        if (i == 0) /* the first */
            order_move(c, job);
    }
    return job->index[w->id];
}

bool
desk_takes_units(const struct coord_worker *w)
{
    return w->conn != 0 && !w->drained && !w->leaving;
}

bool
desk_is_ready(const struct job *job, uint32_t index)
{
    const struct job_part *part = &job->parts[index];

    return part->state == PART_READY && part->worker->conn != 0;
}

bool
desk_may_take_part(const struct job *job, uint32_t index)
{
    const struct job_part *part = &job->parts[index];

    return part_is_here(part) && !part->late && desk_takes_units(part->worker);
}

void
desk_late(struct job *job, uint32_t index, bool late)
{
    if (job->parts[index].late == late)
        return;
    job->parts[index].late = late;
    if (job->partition)
        partition_set_absent(job->partition, index,
                             !desk_may_take_part(job, index));
}

void
desk_send_job_end(struct coord *c, uint64_t conn, const uint8_t *job)
{
    struct msg m = { .type = MSG_JOB_END, .job_end = { job } };

    actions_send(&c->actions, conn, &m);
}

void
desk_send_records(struct coord *c, const struct job *job,
                  const struct msg_records *r)
{
    struct msg m = { .type = MSG_RECORDS, .records = *r };

    for (const struct coord_conn *to = c->conns; to; to = to->next)
        if (to->watch == job) {
            m.request = to->watch_request;
            actions_send(&c->actions, to->id, &m);
        }
}

struct job *
desk_job_of(struct coord *c, const struct coord_worker *w, const uint8_t *id,
            uint32_t *index)
{
    struct job *job = desk_find_job(c, id);

    *index = job && !job_over(job) ? desk_index(job, w) : JOB_NOBODY;
    if (*index != JOB_NOBODY) {
        desk_late(job, *index, false);
        return job;
    }
    desk_send_job_end(c, w->conn, id);
    return NULL;
}

void
desk_send_ack(struct coord *c, uint64_t conn, const struct msg_ack *ack)
{
    struct msg m = { .type = MSG_ACK, .ack = *ack };

    actions_send(&c->actions, conn, &m);
}

void
desk_send_attempt(struct coord *c, const struct job *job, uint16_t type,
                  const struct job_attempt *attempt)
{
    const struct coord_worker *w = job->parts[attempt->part].worker;
    struct msg m = { .type = type,
                     .revoke = { job->id, attempt->unit, attempt->number } };

    if (w->conn != 0)
        actions_send(&c->actions, w->conn, &m);
}

void
desk_log_unit(struct coord *c, const struct job *job,
              const struct job_attempt *attempt, const char *what)
{
    struct partition_area a;

    partition_area(job->partition, attempt->unit, &a);
    actions_log(&c->actions, ACT_DEBUG,
                "%s job=%s unit=%u attempt=%u worker=%s frame=%u x=%u y=%u "
                "width=%u height=%u",
                what, job->hex, attempt->unit, attempt->number,
                job->parts[attempt->part].name, a.frame, a.x, a.y, a.width,
                a.height);
}

void
desk_keep_unit(struct coord *c, const struct job *job, uint32_t unit)
{
    const struct job_unit *u = &job->units[unit];
    const struct job_part *part =
        u->part != JOB_NOBODY ? &job->parts[u->part] : NULL;
    struct saved_unit *s;
    struct action *a;

    if (!c->env.keeps)
        return;
    a = actions_add_job(&c->actions, ACT_KEEP_UNIT, 0, job->id);
    s = rad_arena_calloc(&c->actions.mem, 1, sizeof *s);
    if (!a || !s) {
        c->actions.failed = true;
        return;
    }
    a->unit = s;
    s->unit = unit;
    partition_area(job->partition, unit, &s->area);
    s->attempt = u->lead;
    s->tries = u->tries;
    s->stored = u->stored_rows;
    s->fingerprint = part ? part->fingerprint : 0;
    s->worker = actions_keep_text(&c->actions, part ? part->name : "");
}

bool
desk_can_balance(const struct job *job)
{
    return job->partition && partition_is_strict(job->partition) &&
           job->nout > 0 &&
           (partition_kind(job->partition) != MSG_PART_STATIC ||
            !(job->spec.flags & MSG_JOB_NO_BALANCE));
}

bool
desk_others_may(const struct coord *c, const struct job *job,
                const struct coord_worker *w, bool ever)
{
    for (const struct coord_worker *o = c->workers; o; o = o->next) {
        uint32_t i = desk_index(job, o);

        if (o != w && desk_takes_units(o) &&
            (i == JOB_NOBODY ||
             (job->parts[i].state != PART_EXCLUDED &&
              (ever ||
               (job->parts[i].state != PART_NO_ROOM && !job->parts[i].late)))))
            return true;
    }
    return false;
}

bool
desk_may_try(const struct coord *c, const struct job *job,
             const struct unit_crashes *crashes, uint32_t index)
{
    return crashes->n == 0 || crashes->worker != index ||
           !desk_others_may(c, job, job->parts[index].worker, false);
}

bool
desk_idle_job(const struct job *job)
{
    return job_over(job) || job->place == PLACE_ARRIVING ||
           job->place == PLACE_NO_ROOM || job->state == JOB_PAUSED ||
           (job->partition && job_waiting(job) == 0 && job->late == 0 &&
            !job->filling && !desk_can_balance(job));
}

bool
desk_splits(const struct job *job)
{
    return desk_can_balance(job) &&
           partition_kind(job->partition) != MSG_PART_SCANBAR;
}

bool
desk_is_idle(const struct job *job, uint32_t index)
{
    const struct job_part *part = &job->parts[index];

    return part->state == PART_READY && desk_takes_units(part->worker) &&
           !part->lags &&
           (!part->worker->fills || part->worker->fills == job ||
            part->worker->fills->spec.priority < job->spec.priority) &&
           (part->worker->in_flight == 0 ||
            part->worker->priority < job->spec.priority) &&
           !part->worker->alone;
}

bool
desk_gives_way(const struct job *job, uint32_t index)
{
    const struct coord_worker *w = job->parts[index].worker;

    return job->state == JOB_PAUSED || !desk_takes_units(w) ||
           job->spec.priority < w->rank;
}

uint64_t
desk_date_ms(const struct coord *c)
{
    return c->now_ms + (c->env.slept_ms ? c->env.slept_ms(c->env.arg) : 0);
}

uint64_t
desk_shown_ms(const struct coord *c, uint64_t date_ms)
{
    int64_t ahead_ms = c->env.ahead_ms ? c->env.ahead_ms(c->env.arg) : 0;

    return date_ms + (uint64_t)ahead_ms;
}

uint64_t
desk_age_ms(const struct coord *c, const struct job *job)
{
    uint64_t date_ms = desk_date_ms(c);

    return date_ms > job->over_ms ? date_ms - job->over_ms : 0;
}

bool
desk_unfetched(const struct coord *c, const struct job *job)
{
    return job_over(job) && job->state != JOB_CANCELLED && job->unfetched > 0 &&
           desk_age_ms(c, job) < c->keep.unfetched_ms;
}
