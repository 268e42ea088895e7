/* report.h - what radctl is told, as JSON
 *
 * Pure: reads the coordinator's state and changes nothing.
 * Thread: one. */
#ifndef DAEMON_REPORT_H
#define DAEMON_REPORT_H

#include "sched.h"

/* The answer to a QUERY as malloc'd text, NULL when memory is out; *status is
 * 0, or of sysexits.h with the text a plain message. */
char *report_query(const struct coord *c, enum msg_topic what, const char *text,
                   int *status);

#endif
