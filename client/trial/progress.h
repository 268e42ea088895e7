/* progress.h - the line that says how far a job is
 *
 *     42 %  1.25 M rays/s  1:05 left  3 workers
 * What is not known is left out, and at 100 % what is left and who is at it.
 * On a terminal it is one line that is written over; elsewhere it is silent,
 * unless asked for always: then each report is a line of its own.
 * Rays a second is a mean that forgets with a time constant of some seconds;
 * the time left is eta.h's, and left out while nobody knows it.
 * Thread: one.  */
#ifndef RADD_CLIENT_PROGRESS_H
#define RADD_CLIENT_PROGRESS_H

#include "trial/eta.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct progress_report {
    double elapsed_s; /* since the job began */
    double done;      /* share of the estimated cost, 0..1 */
    uint64_t rays;    /* so far; 0: none are known yet */
    int workers;      /* at it now */
    bool working;     /* it does not wait, nor is it paused or held */
};

struct progress {
    FILE *to; /* NULL: silent */
    bool terminal;
    bool shown;     /* a line stands on the terminal */
    double every_s; /* one line each time so much has gone by; 0: a line for
                     * every report, in place on a terminal */
    double said_s;  /* elapsed_s of the last line; < 0: none yet */
    double last_s;  /* elapsed_s of the last report; < 0: none yet */
    uint64_t last_rays;
    double rate; /* rays a second, smoothed */
    struct eta eta;
    double done; /* of the last report */
};

/* always: report even where `to` is no terminal; never: not even there. */
void progress_init(struct progress *p, FILE *to, bool always, bool never);

/* The job's ambient cache comes in passes. */
void progress_expect_passes(struct progress *p);

/* Show a line each every_s seconds, below each other, unless nothing is to be
 * shown at all. */
void progress_every(struct progress *p, FILE *to, double every_s);

/* Take a report and show it. */
void progress_update(struct progress *p, const struct progress_report *r);

/* Is it shown, has it gone on for some seconds, and is it far from its end, as
 * far as the share that is done tells?  Then a trial is worth its while. */
bool progress_is_long(const struct progress *p);

/* A trial says how many rays the whole job takes; 0: not yet. */
void progress_foresee(struct progress *p, double rays);

/* Take the line off the terminal, before anything else is said on it. */
void progress_clear(struct progress *p);

/* For how long nobody has been at a job.  All 0: not yet. */
struct progress_alone {
    double for_s;
    double last_s; /* elapsed_s of the last report */
};

/* Take a report; working: somebody should be at the job.  How long nobody was,
 * as far as reports said so [s]: between two of them that is a second at most.
 * If more went by there was no coordinator for workers to come back to. */
double progress_alone(struct progress_alone *a, const struct progress_report *r,
                      bool working);

/* The line without its end, always terminated.  left_s < 0: not known, and not
 * said. */
void progress_format(char *buf, size_t size, const struct progress_report *r,
                     double rays_per_s, double left_s);

#endif
