/* bygone.h - how long jobs that are over are remembered
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_BYGONE_H
#define DAEMON_BYGONE_H

#include "desk/desk.h"

/* Forget jobs that are over and need not be remembered any more; drop ambient
 * caches above their limit. */
void bygone_forget_old(struct coord *c);
/* Forget a job that is over, with its pictures. */
void bygone_forget(struct coord *c, struct job *job, enum gone_why why);
/* The record of the last forgotten job whose id begins with these digits; NULL:
 * there is none. */
const struct saved_gone *bygone_find(const struct coord *c, const char *hex);
/* There is a job of that id again: drop the record of the forgotten job. */
void bygone_drop(struct coord *c, const uint8_t job[MSG_JOB]);
/* When and why the job was forgotten, as text. */
void bygone_text(const struct saved_gone *g, char text[MSG_MAX_TEXT + 1]);
/* The time as "2026-11-22 23:41 UTC". */
#define BYGONE_TIME 32
void bygone_time_text(uint64_t ms, char text[BYGONE_TIME]);

/* A file of the job is about to be sent over the connection: if that belongs to
 * the job's owner the job is not forgotten now. */
void bygone_fetching(const struct coord *c, const struct coord_conn *conn,
                     struct job *job);
/* A file of the job was sent whole over a connection.  The frame counts as
 * fetched if the file is its picture, or has the values of its sensor points,
 * and the connection belongs to the job's owner and is not an observer's. */
void bygone_fetched(struct coord *c, uint64_t now_ms, uint64_t conn,
                    const uint8_t job[MSG_JOB], uint32_t frame,
                    enum msg_what what);
/* Take up the record of a job that an earlier life of the coordinator forgot;
 * called before recover_job(). */
void bygone_recall(struct coord *c, const struct saved_gone *g);

#endif
