/* handout.c - see handout.h */
#include "config.h"

#include "sched/handout.h"

#include "desk/desk.h"
#include "desk/attempt.h"
#include "lines/handoff.h"

#define APART 8 /* units of a worker that are begun apart, with scanbar */

/* Shall the worker begin its lines at an end of its own?  If all workers went
 * from left to right they would see the same things at the same time, and each
 * make the same ambient records.  With scanbar only its first units: pieces of
 * a later base line should come as they are made.  Not with several threads,
 * which follow each other down the lines; nor at the top of a frame, where the
 * unit's rows are true from the start and need no facts. */
static bool
begins_apart(const struct job *job, const struct job_worker *jw, uint32_t unit)
{
    uint32_t first, last;

    partition_unit_lines(job->partition, unit, &first, &last);
    if (jw->threads > 1 || !(job->spec.flags & MSG_JOB_SHARE) || first == 0)
        return false;
    return partition_kind(job->partition) != MSG_PART_SCANBAR ||
           jw->given < APART;
}

/* Where a worker begins its lines: another end for each attempt at a unit. */
static uint8_t
choose_end(struct job *job, uint32_t index, uint32_t unit)
{
    const struct job_unit *u = &job->units[unit];

    if (u->ngos == 1 && begins_apart(job, &job->workers[index], unit)) {
        job->workers[index].given++;
        return (uint8_t)(index % MSG_NEND);
    }
    for (uint8_t end = 0; end < MSG_NEND; end++) {
        bool taken = false;

        for (uint8_t i = 0; i + 1 < u->ngos; i++)
            taken |= u->go[i].end == end;
        if (!taken)
            return end;
    }
    return 0;
}

static void
send_unit(struct coord *c, struct job *job, uint32_t unit, struct job_go *go)
{
    bool strict = partition_is_strict(job->partition);
    struct partition_area a;
    struct msg m = { .type = MSG_UNIT };

    partition_area(job->partition, unit, &a);
    m.unit = (struct msg_unit){ .job = job->id,
                                .unit = unit,
                                .attempt = go->attempt,
                                .frame = a.frame,
                                .x = a.x,
                                .y = a.y,
                                .width = a.width,
                                .height = a.height };
    if (strict) {
        m.unit.mode = MSG_MODE_STRICT;
        m.unit.end = go->end;
        m.unit.flags = handoff_flags(job, unit, go);
    }
    if (strict)
        handoff_out(c, job, unit, go);
    actions_send(&c->actions, job->workers[go->worker].worker->conn, &m);
}

/* Tell the workers of the unit's attempts that it has twins now. */
static void
tell_twins(struct coord *c, const struct job *job, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];

    for (uint8_t i = 0; i < u->ngos; i++)
        if (!u->go[i].twin) {
            u->go[i].twin = true;
            if (i + 1 < u->ngos) /* the newest learns it from its UNIT */
                desk_send_attempt(c, job, MSG_TWIN, unit, &u->go[i]);
        }
}

void
handout_unit(struct coord *c, struct job *job, uint32_t index, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];
    struct job_go *go = attempt_add(c, job, index, unit, u->attempt + 1);

    if (!go) {
        c->actions.failed = true;
        return;
    }
    job->workers[index].passed = 0;
    u->attempt++;
    u->tries++;
    if (u->tries > 1 && u->ngos == 1 && !u->given_back)
        job->units_redone++; /* a twin is no redoing */
    u->given_back = false;
    desk_log_unit(c, job, unit, &u->go[u->ngos - 1], "unit out");
    if (u->ngos == 1) {
        attempt_forget_rows(job, unit);
        u->lead = u->attempt;
        if (u->worker != index)
            u->losses = 0;
        u->worker = index;
        u->out_ms = go->out_ms;
    } else if (u->next_row == 0) {
        u->lead = 0; /* the attempt whose rows come first will lead */
    }
    if (u->ngos == 1)
        desk_keep_unit(c, job, unit);
    go->end = choose_end(job, index, unit);
    if (job->first_ms == 0)
        job->first_ms = c->now_ms;
    if (job->state == JOB_WAITING)
        job->state = JOB_RUNNING;
    if (u->ngos > 1 && job->shared)
        tell_twins(c, job, unit);
    send_unit(c, job, unit, &u->go[u->ngos - 1]);
}
