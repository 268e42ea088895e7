/* frame.h - one frame of a job, as the coordinator knows it
 *
 *     OPEN -> WRITING -> WRITTEN -> FETCHED
 *       '-----------------^-----------^       recovered after a restart
 *
 * Thread: one. */
#ifndef DAEMON_FRAME_H
#define DAEMON_FRAME_H

#include <stdbool.h>
#include <stdint.h>

struct job;
struct msg_line_costs;
struct steps;

enum frame_state {
    FRAME_OPEN,    /* units of it are not done */
    FRAME_WRITING, /* all its rows are kept, and its picture is being written */
    FRAME_WRITTEN,
    FRAME_FETCHED /* its owner has it */
};
#define FRAME_STATES 4

struct job_frame {
    enum frame_state state; /* by frame_step() alone */
    uint64_t pixels_left;   /* in units that are not done */
    uint64_t rows_pixels;   /* pixels kept so far */
    bool shown;             /* tiles told its colours in this life */
    double *line_s;  /* processor time that was spent on each line in this life
                      * of the coordinator; NULL: nothing is known */
    uint32_t nlines; /* in line_s */
    bool untold;     /* not all of line_s is said: a worker lost a unit that it
                      * had spent something on */
};

/* Which state may follow which; see the head of frame.c. */
extern const struct steps frame_steps;
/* The frame is in another state from here on, which must be permitted. */
void frame_step(struct job_frame *f, enum frame_state to);

/* Is its picture there, fetched or not? */
bool frame_is_written(const struct job_frame *f);

/* Frames are delivered in order: count the first ones without a gap. */
void frame_count_ready(struct job *job);

/* Add what was spent on lines, if the job has these.  Without memory the
 * statistics go without. */
void frame_add_costs(struct job *job, const struct msg_line_costs *m);

#endif
