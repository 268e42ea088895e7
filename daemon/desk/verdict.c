/* verdict.c - see verdict.h */
#include "config.h"

#include "desk/verdict.h"

#include "desk/desk.h"
#include "jobs/job.h"

#include "base/text.h"

static void
note_conn(struct coord *c, uint64_t id, enum coord_verdict verdict,
          const char *why)
{
    struct coord_conn *conn = desk_find_conn(c, id);

    if (!conn || conn->verdict != CONN_STAYS)
        return;
    conn->verdict = verdict;
    conn->why = actions_keep_text(&c->actions, why);
    if (!conn->why)
        conn->why = "out of memory";
    c->verdicts++;
}

void
verdict_break(struct coord *c, uint64_t conn, const char *why)
{
    note_conn(c, conn, CONN_BREAKS, why);
}

void
verdict_part(struct coord *c, uint64_t conn, const char *why)
{
    note_conn(c, conn, CONN_PARTS, why);
}

void
verdict_job(struct coord *c, struct job *job, enum job_state state, int status,
            const char *text)
{
    if (job_over(job))
        return;
    life_step(job, state);
    job->status = status;
    job->end_ms = c->now_ms;
    job->over_ms = desk_date_ms(c);
    job->ending = true;
    rad_text_print(job->text, sizeof job->text, "%s", text ? text : "");
    wire_clean(job->text); /* JSON wants UTF-8 */
    c->verdicts++;
}
