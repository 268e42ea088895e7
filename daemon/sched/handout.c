/* handout.c - see handout.h */
#include "config.h"

#include "sched/handout.h"

#include "desk/desk.h"
#include "desk/holding.h"
#include "lines/handoff.h"

static void
send_unit(struct coord *c, struct job *job, struct job_attempt *attempt)
{
    bool strict = partition_is_strict(job->partition);
    struct partition_area a;
    struct msg m = { .type = MSG_UNIT };

    partition_area(job->partition, attempt->unit, &a);
    m.unit = (struct msg_unit){ .job = job->id,
                                .unit = attempt->unit,
                                .attempt = attempt->number,
                                .frame = a.frame,
                                .x = a.x,
                                .y = a.y,
                                .width = a.width,
                                .height = a.height };
    if (strict) {
        m.unit.mode = MSG_MODE_STRICT;
        m.unit.flags = handoff_flags(job, attempt);
    }
    if (strict)
        handoff_out(c, job, attempt);
    actions_send(&c->actions, job->parts[attempt->part].worker->conn, &m);
}

void
handout_unit(struct coord *c, struct job *job, uint32_t index, uint32_t unit)
{
    struct job_unit *u = &job->units[unit];
    struct job_attempt *attempt =
        holding_begin(c, job, index, unit, u->latest + 1);

    if (!attempt) {
        c->actions.failed = true;
        return;
    }
    job->parts[index].passed = 0;
    u->latest++;
    u->tries++;
    if (u->tries > 1 && u->nattempts == 1 && !u->given_back)
        job->units_redone++; /* a twin is no redoing */
    u->given_back = false;
    desk_log_unit(c, job, attempt, "unit out");
    if (u->nattempts == 1) {
        holding_forget_rows(job, unit);
        u->lead = u->latest;
        if (u->part != index)
            u->losses = 0;
        u->part = index;
        u->out_ms = attempt->out_ms;
    } else if (u->next_row == 0) {
        u->lead = 0; /* the attempt whose rows come first will lead */
    }
    if (u->nattempts == 1)
        desk_keep_unit(c, job, unit);
    life_begin(job, c->now_ms);
    send_unit(c, job, attempt);
}
