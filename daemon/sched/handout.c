/* handout.c - see handout.h */
#include "config.h"

#include "sched/handout.h"

#include "desk/desk.h"
#include "desk/holding.h"
#include "lines/handoff.h"

/* Where a worker begins its lines: another end for each attempt at a unit. */
static uint8_t
choose_end(const struct job_unit *u)
{
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
send_unit(struct coord *c, struct job *job, struct job_go *go)
{
    bool strict = partition_is_strict(job->partition);
    struct partition_area a;
    struct msg m = { .type = MSG_UNIT };

    partition_area(job->partition, go->unit, &a);
    m.unit = (struct msg_unit){ .job = job->id,
                                .unit = go->unit,
                                .attempt = go->attempt,
                                .frame = a.frame,
                                .x = a.x,
                                .y = a.y,
                                .width = a.width,
                                .height = a.height };
    if (strict) {
        m.unit.mode = MSG_MODE_STRICT;
        m.unit.end = go->end;
        m.unit.flags = handoff_flags(job, go);
    }
    if (strict)
        handoff_out(c, job, go);
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
                desk_send_attempt(c, job, MSG_TWIN, &u->go[i]);
        }
}

void
handout_unit(struct coord *c, struct job *job, uint32_t index, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];
    struct job_go *go = holding_begin(c, job, index, unit, u->attempt + 1);

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
    desk_log_unit(c, job, go, "unit out");
    if (u->ngos == 1) {
        holding_forget_rows(job, unit);
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
    go->end = choose_end(u);
    if (job->first_ms == 0)
        job->first_ms = c->now_ms;
    if (job->state == JOB_WAITING)
        job->state = JOB_RUNNING;
    if (u->ngos > 1 && job->shared)
        tell_twins(c, job, unit);
    send_unit(c, job, go);
}
