/* worker_files.h - files that a worker's jobs need
 *
 * Thread: one. */
#ifndef DAEMON_WORKER_FILES_H
#define DAEMON_WORKER_FILES_H

#include "worker/wjob.h"

/* Fetch the job's missing files, then start the child.  It may take a while to
 * find out which are missing. */
void files_look(struct worker *w, struct wjob *job);
bool files_need(const struct wjob *job, const uint8_t *hash);
/* Look for room again, for jobs that had none, when it is time. */
void files_watch_room(struct worker *w);
/* Is this piece of a file to be kept? */
bool worker_take_chunk(struct worker *w, const struct msg_chunk *chunk);
/* A job that fetched is over: the files that it asked for may never come. */
void files_lapse(struct worker *w);

#endif
