/* progress.h - how far a job is, and how far its pixels may be off
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_PROGRESS_H
#define DAEMON_PROGRESS_H

#include "picture/doubt.h"

#include <stdint.h>

struct job;
struct msg_counts;
struct msg_progress;

/* The passes, which come before the units, as a part of the job's work. */
struct progress_lead {
    double part; /* the passes' share of all work of the job; 0: no passes */
    double done; /* share of the passes' work that is done; it never shrinks */
};

/* Bring job.rays_seen and job.pixels_seen up to date; called when a unit is
 * done and when a TALLY tells how much a worker has traced. */
void progress_see(struct job *job);

/* Count what the job's tiles traced: in job.tiled and job.rays. */
void progress_count_tiles(struct job *job, const struct msg_counts *counts);

/* The estimated error of the pixels in units that are done. */
struct rad_error_estimate progress_error(const struct job *job);

/* The share of their light that -ab leaves out; 0: not known. */
double progress_left_out(const struct job *job);

/* Fill in the PROGRESS message of the job, but for its workers: 0. */
void progress_tell(const struct job *job, uint64_t now_ms,
                   struct msg_progress *p);

#endif
