/* life.h - how far a job is: its state, for its users; its place, at the store
 *
 * Both are drawn at the head of life.c.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_LIFE_H
#define DAEMON_LIFE_H

#include <stdint.h>

struct job;
struct steps;

/* Numbers as in msg_progress. */
enum job_state {
    JOB_WAITING, /* its files are not all here, or no work went out yet */
    JOB_RUNNING,
    JOB_PAUSED,
    JOB_DONE,
    JOB_FAILED,
    JOB_CANCELLED
};
#define JOB_STATES 6

enum job_place {
    PLACE_ARRIVING, /* some of its files are yet to come */
    PLACE_OPENING,  /* the store was asked to make room for the job's rows */
    PLACE_NO_ROOM,  /* the disk has no such room yet: job.text says why */
    PLACE_OPEN,     /* files, and room for rows, are on the disk */
    PLACE_KEPT,     /* the job is over, and the store has its statistics */
    PLACE_FILED     /* only the job's end is in memory (job_lighten()); the
                     * store has the rest */
};
#define JOB_PLACES 6

/* Which may follow which. */
extern const struct steps life_states, life_places;
/* Change the job's state, or place; the step must be in the table. */
void life_step(struct job *job, enum job_state to);
void life_move(struct job *job, enum job_place to);

/* Work of the job goes out: a job that waits runs. */
void life_set_running(struct job *job);
/* A tile or unit of the job goes out: note when the first did, and run. */
void life_begin(struct job *job, uint64_t now_ms);
void life_pause(struct job *job);
/* Let a job that is paused go on. */
void life_resume(struct job *job);

#endif
