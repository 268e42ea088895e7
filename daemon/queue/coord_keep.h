/* coord_keep.h - how long jobs that are over are remembered
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_COORD_KEEP_H
#define DAEMON_COORD_KEEP_H

#include "desk/desk.h"

/* Forget what need not be kept of jobs that are over. */
void coord_forget_old(struct coord *c);
/* Forget a job that is over, with its pictures. */
void coord_forget_job(struct coord *c, const struct job *job,
                      enum gone_why why);
/* The job that was forgotten last of those whose id begins with these digits;
 * NULL: there is none. */
const struct saved_gone *coord_find_gone(const struct coord *c,
                                         const char *hex);
/* When and why the job was forgotten. */
void coord_gone_text(const struct saved_gone *g, char text[MSG_MAX_TEXT + 1]);
/* "2026-11-22 23:41 UTC" */
#define COORD_TIME 32
void coord_time_text(uint64_t ms, char text[COORD_TIME]);

/* All of a frame's picture was sent to that connection: it is fetched if the
 * job's owner is there, and not to look only. */
void coord_fetched(struct coord *c, uint64_t now_ms, uint64_t conn,
                   const uint8_t job[MSG_JOB], uint32_t frame);
/* A job that an earlier life has forgotten; before those of recover.h. */
void coord_recall_gone(struct coord *c, const struct saved_gone *g);

#endif
