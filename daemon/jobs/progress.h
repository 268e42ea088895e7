/* progress.h - how far a job is, and how far its pixels may be off
 *
 * Thread: one. */
#ifndef DAEMON_PROGRESS_H
#define DAEMON_PROGRESS_H

#include "picture/doubt.h"

#include <stdint.h>

struct job;
struct msg_progress;

/* The part of a job that comes before its units: its passes. */
struct progress_lead {
    double part; /* of all work of the job; 0: there is none */
    double done; /* share of it that is done; it never shrinks */
};

/* Bring rays_seen and pixels_seen up to date: a unit is done, or a worker has
 * told what it has traced. */
void progress_see(struct job *job);

/* How far the units that are done may be off. */
struct rad_error_estimate progress_error(const struct job *job);

/* What a PROGRESS says of the job. */
void progress_tell(const struct job *job, uint64_t now_ms,
                   struct msg_progress *p);

#endif
