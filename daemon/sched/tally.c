/* tally.c - see tally.h */
#include "config.h"

#include "sched/tally.h"

#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/progress.h"

#include <string.h>

/* Count what earlier PAIDs of this worker told and never came: they were lost
 * with a connection, for messages keep their order.  Such cost is in no unit,
 * so it counts as dropped; but before the first TALLY in this life of the
 * coordinator, PAIDs that an earlier life got are missing, too, and these are
 * in units. */
static void
note_unpaid(struct job_worker *jw, const struct msg_counts *paid)
{
    struct msg_counts lost;

    msg_counts_lack(&lost, paid, &jw->paid);
    msg_counts_add(&jw->paid, &lost);
    if (jw->tallied)
        msg_counts_add(&jw->past.dropped, &lost);
    jw->tallied = true;
}

/* A TALLY counts even after the job's end: the last twins are taken back then.
 * One that comes before the first READY may be of an earlier job of this id;
 * the worker sends its sums again. */
void
tally_came(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_tally *m = &msg->tally;
    struct job *job = desk_find_job(c, m->job);
    uint32_t index = job ? desk_index(job, w) : JOB_NOBODY;
    struct job_worker *jw;

    if (index == JOB_NOBODY || job_over(job))
        desk_send_job_end(c, w->conn, m->job);
    if (index == JOB_NOBODY)
        return;
    desk_late(job, index, false);
    jw = &job->workers[index];
    if (jw->state == PART_LOADING && !jw->took_part)
        return;
    if (m->busy_s < jw->tally.busy_s) { /* a new child counts from zero */
        jw->past = part_tally(jw);
        memset(&jw->tally, 0, sizeof jw->tally);
        memset(&jw->paid, 0, sizeof jw->paid);
    }
    note_unpaid(jw, &m->paid);
    jw->tally = *m;
    jw->tally.job = NULL;
    progress_see(job);
}
