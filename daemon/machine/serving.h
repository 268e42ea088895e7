/* serving.h - jobs in the order in which the coordinator serves them
 *
 * Thread: any. */
#ifndef DAEMON_SERVING_H
#define DAEMON_SERVING_H

#include <jansson.h>

/* Rows of jobs as the coordinator lists them, the newest first, in another
 * array: by priority, then the oldest first.  Empty when memory is out. */
json_t *serving_order(const json_t *rows);

#endif
