/* lists.h - lists as JSON, the same in daemons and clients
 *
 * The arrays are the caller's.
 * Thread: any. */
#ifndef DAEMON_LISTS_H
#define DAEMON_LISTS_H

#include <jansson.h>
#include <stdbool.h>

/* Make an array of rows of jobs that come in the coordinator's order, the
 * newest first: now the highest priority first, then the oldest.  Empty: memory
 * is out. */
json_t *lists_served(const json_t *rows);

/* Is the job of a row over: done, failed or cancelled? */
bool lists_is_over(const json_t *job);

/* The words of a text, with blanks between them, as an array of strings; NULL
 * when memory is out. */
json_t *lists_words(const char *text);

#endif
