/* report.h - what radctl is told, as JSON
 *
 * Pure: reads the coordinator's state and changes nothing.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_REPORT_H
#define DAEMON_REPORT_H

#include "desk/desk.h"

#include <jansson.h>

/* The answer to a QUERY as malloc'd text, NULL when memory is out; *status is
 * 0, or of sysexits.h with the text a plain message. */
char *report_query(const struct coord *c, enum msg_topic what, const char *text,
                   int *status);

/* A row of a list; NULL when memory is out.  label: bytes of the job's name
 * that there is room for. */
json_t *report_gone(const struct coord *c, const struct saved_gone *g);
json_t *report_job(const struct coord *c, const struct job *job, size_t label);

/* What a worker does for all jobs that are not over, taken together. */
struct report_share {
    bool lacks_room; /* for the files of one of these jobs */
    bool prepares;   /* makes tiles of a pass, or estimates: work without
                      * units */
    uint64_t rays;
    uint64_t redundant; /* ambient records that it got and had made, too */
    uint64_t cache;     /* ambient records that it holds */
    uint64_t memory;    /* [bytes] of its processes, the most that each took */
};

/* The shares of all workers, by their id; malloc'd, NULL when memory is out.
 * Walks all jobs: once for a list. */
struct report_share *report_shares(const struct coord *c);
/* The word for what a worker does: "working", "loading", "idle", "gone"... */
const char *report_worker_state(const struct coord_worker *w,
                                const struct report_share *shares);
json_t *report_worker(const struct coord *c, const struct coord_worker *w,
                      const struct report_share *shares);

#endif
