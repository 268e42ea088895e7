/* worker_files.h - files that a worker's jobs need
 *
 * Thread: radd's loop. */
#ifndef DAEMON_WORKER_FILES_H
#define DAEMON_WORKER_FILES_H

#include "worker/wjob.h"

/* Look which of the job's files are missing and whether there is room for them;
 * later fetch them and start the child. */
void files_look(struct worker *w, struct wjob *job);
/* Does the job need the file? */
bool files_need(const struct wjob *job, const uint8_t *hash);
/* Look for room again, for jobs that had none, when it is time. */
void files_watch_room(struct worker *w);
/* Shall this piece of a file be stored? */
bool worker_take_chunk(struct worker *w, const struct msg_chunk *chunk);
/* A job has ended: files that were asked for may never come. */
void files_lapse(struct worker *w);
#endif
