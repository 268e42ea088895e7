/* progress.h - how far a job is, and how far its pixels may be off
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_PROGRESS_H
#define DAEMON_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct job;
struct msg_counts;
struct msg_progress;
struct rad_error_estimate;

/* How much of the ambient cache is filled: work before the units. */
struct progress_filled {
    double share; /* the passes' share of all work of the job; 0: no passes */
    double done;  /* share of the passes' work that is done; never shrinks */
};

struct progress_look {
    double share;  /* of the job that was done */
    double work_s; /* seconds of workers since the first look: two workers at
                    * once count twice */
};

/* How fast workers get on with a job in this life of the coordinator. */
struct progress_pace {
    struct progress_look look[32]; /* the first, some between, the last */
    uint32_t nlooks;
    uint64_t look_ms; /* the last; 0: none yet */
    uint32_t workers; /* that were at the job then */
    bool steady;      /* early and late work were about as dear, so the
                       * time that is left is told from then on */
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

/* Look at the job's pace, by which PROGRESS tells the time that is left;
 * workers: so many are at the job.  Called every tick. */
void progress_pace(struct job *job, uint64_t now_ms, uint32_t workers);

#endif
