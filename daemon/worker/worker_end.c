/* worker_end.c - the end of a job at a worker */
#include "config.h"

#include "worker/worker_says.h"

#include "worker/gather.h"
#include "worker/link.h"
#include "worker/relay.h"
#include "worker/wjob.h"
#include "worker/worker_files.h"

void
worker_end_job(struct worker *w, struct wjob *job)
{
    struct wjob **link = &w->jobs;

    while (*link != job)
        link = &(*link)->next;
    *link = job->next;
    wjob_kill_child(w, job);
    link_release_job(w, job);
    gather_release(job);
    relay_release(job);
    files_lapse(w); /* also if the job fetches no more: the coordinator may not
                     * have known that yet */
    if (w->env.leave)
        w->env.leave(w->env.arg, job->id);
    wjob_free(job);
}
