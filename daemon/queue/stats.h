/* stats.h - the statistics of a job as JSON
 *
 * The names are those of radsubmit(1), --stats; a job that is not over gives
 * what is known so far.
 * Pure; thread: one. */
#ifndef DAEMON_STATS_H
#define DAEMON_STATS_H

#include "jobs/job.h"

/* malloc'd text, NULL when memory is out. */
char *stats_json(const struct job *job, uint64_t now_ms);

/* The same in pieces, for a job may have very many units: its beginning, as
 * things are now; then so many units and lines at a time.  1: all is there, and
 * stats_take() gives it and frees the rest; 0: there is more; or RAD_ENOMEM. */
#define STATS_PIECE 500 /* some milliseconds */
struct stats_text;
struct stats_text *stats_begin(const struct job *job, uint64_t now_ms);
int stats_more(struct stats_text *t, const struct job *job, uint32_t most);
char *stats_take(struct stats_text *t);
void stats_free(struct stats_text *t);

#endif
