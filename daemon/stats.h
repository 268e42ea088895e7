/* stats.h - the statistics of a job as JSON
 *
 * The names are those of radsubmit(1), --stats; a job that is not over gives
 * what is known so far.
 * Pure; thread: one. */
#ifndef DAEMON_STATS_H
#define DAEMON_STATS_H

#include "job.h"

/* malloc'd text, NULL when memory is out. */
char *stats_json(const struct job *job, uint64_t now_ms);

#endif
