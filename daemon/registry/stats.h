/* stats.h - the statistics of a job as JSON
 *
 * radd.stats(5) describes the names.  Statistics of a job that is not over tell
 * what is known so far.
 * Pure.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_STATS_H
#define DAEMON_STATS_H

#include "jobs/job.h"

/* In pieces, for a job may have very many units.  stats_begin() writes the
 * beginning, as of now; each stats_more() writes up to `most` units and lines.
 * stats_more() returns 1: all is written; 0: there is more; or RAD_ENOMEM. When
 * all is written stats_take() returns the text, malloc'd, and frees the rest.
 */
#define STATS_PIECE 500 /* units and lines: some milliseconds */
struct stats_text;
struct stats_text *stats_begin(const struct job *job, uint64_t now_ms);
int stats_more(struct stats_text *t, const struct job *job, uint32_t most);
char *stats_take(struct stats_text *t);
void stats_free(struct stats_text *t);

#endif
