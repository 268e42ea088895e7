/* report.h - the JSON that radctl gets
 *
 * Pure: reads the coordinator's state and changes nothing.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_REPORT_H
#define DAEMON_REPORT_H

#include "desk/desk.h"

#include <jansson.h>

/* The answer to a QUERY as malloc'd text; NULL: memory is out.  *status is 0,
 * or of sysexits.h, and then the text is a plain message. */
char *report_query(const struct coord *c, enum msg_topic what, const char *text,
                   int *status);

/* A row of a list: a forgotten job; a job, of whose name `label` bytes are
 * shown at most.  NULL: memory is out. */
json_t *report_gone(const struct saved_gone *g);
json_t *report_job(const struct coord *c, const struct job *job, size_t label);

/* What a worker does for all jobs that are not over, together. */
struct report_share {
    bool lacks_room; /* the worker has no room for the files of such a job */
    bool prepares;   /* the worker makes tiles of a pass, or estimates */
    uint64_t rays;
    uint64_t redundant; /* ambient records that came although the worker had
                         * made them, too */
    uint64_t cache;     /* ambient records that the worker holds */
    uint64_t memory;    /* sum over its children of the most that each took
                         * [bytes] */
};

/* The shares of all workers, by their ids, malloc'd; NULL: memory is out.
 * Walks all jobs, so call it once for a list. */
struct report_share *report_shares(const struct coord *c);
/* The word for a worker's state: "working", "loading", "idle", "gone"... */
const char *report_worker_state(const struct coord_worker *w,
                                const struct report_share *shares);
/* A worker as a row of a list; NULL: memory is out. */
json_t *report_worker(const struct coord *c, const struct coord_worker *w,
                      const struct report_share *shares);

#endif
