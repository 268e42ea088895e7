/* serving.h - jobs in the order in which the coordinator serves them
 *
 * Thread: any. */
#ifndef DAEMON_SERVING_H
#define DAEMON_SERVING_H

#include <jansson.h>

/* Make an array of rows of jobs that come in the coordinator's order, the
 * newest first: now the highest priority first, then the oldest.  The array is
 * the caller's; empty: memory is out. */
json_t *serving_order(const json_t *rows);

#endif
