/* progress.h - the line that shows a job's progress
 *
 *     42 %  1.25 M rays/s  1:05 left  3 workers
 *
 * Values that are not known are left out; so are the time left and the workers
 * at 100 %.  On a terminal the line is overwritten by the next one, and cut at
 * the terminal's width; elsewhere nothing is shown, but with PROGRESS_ALWAYS
 * each report is a line.  Rays per second are a mean with a time
 * constant of some seconds.  The time left is the coordinator's estimate.
 * Thread: one. */
#ifndef RADD_CLIENT_PROGRESS_H
#define RADD_CLIENT_PROGRESS_H

#include "job/submit_options.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

struct progress_report {
    double elapsed_s; /* since the job began */
    double done;      /* share of the estimated cost, 0..1 */
    uint64_t rays;    /* so far; 0: not known yet */
    int workers;      /* at the job now */
    double left_s;    /* until it is done; 0: not known */
};

struct progress {
    FILE *to; /* NULL: nothing is shown */
    bool terminal;
    int shown;      /* columns of the line that is shown on the terminal */
    double every_s; /* least time between two lines; 0: a line for each report,
                     * in place on a terminal */
    double said_s;  /* elapsed_s of the last line; < 0: none */
    double last_s;  /* elapsed_s of the last report; < 0: none */
    uint64_t last_rays;
    double rate; /* rays a second, smoothed */
};

void progress_init(struct progress *p, FILE *to, enum submit_progress when);

/* Show a new line every every_s seconds, unless nothing is to be shown at all.
 */
void progress_every(struct progress *p, FILE *to, double every_s);

/* Take a report and show it. */
void progress_update(struct progress *p, const struct progress_report *r);

/* Remove the line from the terminal, before other output. */
void progress_clear(struct progress *p);

/* How long no worker has been at a job.  Begins zeroed. */
struct progress_alone {
    double for_s;
    double last_s; /* elapsed_s of the last report */
};

/* Take a report; working: a worker should be at the job.  Returns for how long
 * [s] none was.  Between two reports at most a second counts: if they are
 * further apart the coordinator was away, and no worker could come back to it.
 */
double progress_alone(struct progress_alone *a, const struct progress_report *r,
                      bool working);

/* Format the line, without a newline and always terminated. */
void progress_format(char *buf, size_t size, const struct progress_report *r,
                     double rays_per_s);

#endif
