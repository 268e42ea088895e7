/* outcome.h - what is told of jobs at their end
 *
 * One command may make many jobs on one scene: a plane of -cs is one, and so is
 * a batch of sensor points.  Some of what the user is told is of each of them,
 * the rest of all together.
 * Pure. */
#ifndef RADD_CLIENT_OUTCOME_H
#define RADD_CLIENT_OUTCOME_H

#include "proto/message.h"

struct outcome { /* zeroed: of a job that has not begun */
    double elapsed_s;
    /* Both are of one estimate: if one is known, a 0 of the other is none. */
    double error;    /* estimated, relative; 0: not known */
    double left_out; /* share of the light that comes by more bounces than -ab;
                      * 0: not known */
    struct msg_nan nan;
    struct msg_fault faults[MSG_FAULTS];
};

/* Take what the job's latest report tells. */
void outcome_note(struct outcome *o, const struct msg_progress *m);

struct outcome_sum {    /* zeroed: of no job */
    struct outcome all; /* error: the root of the mean of squares; left_out: the
                         * mean */
    double squares, left_out, weight, before_s;
};

/* Add a job.  weight: how much its error counts beside that of others; a job of
 * an unknown error does not count in the mean.  Jobs run side by side: the
 * longest one sets the time. */
void outcome_add(struct outcome_sum *s, const struct outcome *job,
                 double weight);

/* Jobs that are added from here on begin when those before have ended. */
void outcome_next(struct outcome_sum *s);

#endif
