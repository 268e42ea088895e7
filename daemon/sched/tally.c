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
note_unpaid(struct job_part *part, const struct msg_counts *paid)
{
    struct msg_counts lost;

    msg_counts_lack(&lost, paid, &part->paid);
    msg_counts_add(&part->paid, &lost);
    if (part->tallied)
        msg_counts_add(&part->past.dropped, &lost);
    part->tallied = true;
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
    struct job_part *part;

    if (index == JOB_NOBODY || job_over(job))
        desk_send_job_end(c, w->conn, m->job);
    if (index == JOB_NOBODY)
        return;
    desk_late(job, index, false);
    part = &job->parts[index];
    if (part->state == PART_LOADING && !part->took_part)
        return;
    if (m->busy_s < part->tally.busy_s) { /* a new child counts from zero */
        part->past = part_tally(part);
        memset(&part->tally, 0, sizeof part->tally);
        memset(&part->paid, 0, sizeof part->paid);
    }
    note_unpaid(part, &m->paid);
    part->tally = *m;
    part->tally.job = NULL;
    progress_see(job);
}
