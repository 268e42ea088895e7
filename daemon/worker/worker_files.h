/* worker_files.h - files that a worker's jobs need
 *
 * Thread: one. */
#ifndef DAEMON_WORKER_FILES_H
#define DAEMON_WORKER_FILES_H

#include "worker/wjob.h"

/* Fetch what is missing, then start the child.  Which files are here may take a
 * while to tell. */
void files_look(struct worker *w, struct wjob *job);
bool files_need(const struct wjob *job, const uint8_t *hash);
/* Look again for room, where it is time. */
void files_watch_room(struct worker *w);
/* Is a piece of a file one that is to be kept? */
bool worker_take_chunk(struct worker *w, const struct msg_chunk *chunk);
/* A job that fetched is over: what was asked for may never come. */
void files_lapse(struct worker *w);

#endif
