/* report.h - what radctl is told, as JSON
 *
 * Pure: reads the coordinator's state and changes nothing.
 * Thread: one. */
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
json_t *report_worker(const struct coord *c, const struct coord_worker *w,
                      const uint8_t *duties);

/* What workers have to do for jobs without having units, by the worker's id;
 * malloc'd, NULL when memory is out.  Walks all jobs: once for a list. */
uint8_t *report_duties(const struct coord *c);
/* "idle" */
const char *report_worker_state(const struct coord_worker *w,
                                const uint8_t *duties);

#endif
