/* frame.h - one frame of a job, as the coordinator knows it
 *
 *     OPEN -> WRITING -> WRITTEN -> FETCHED
 *       '-----------------^-----------^       recovered after a restart
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_FRAME_H
#define DAEMON_FRAME_H

#include <stdbool.h>
#include <stdint.h>

struct job;
struct msg_line_costs;
struct steps;

enum frame_state {
    FRAME_OPEN,    /* some of its units are not done */
    FRAME_WRITING, /* all its rows are kept, and its picture is being written */
    FRAME_WRITTEN, /* the picture is on the disk */
    FRAME_FETCHED  /* the job's owner has the picture */
};
#define FRAME_STATES 4

struct job_frame {
    enum frame_state state; /* changed by frame_step() alone */
    uint64_t pixels_left;   /* pixels of units that are not done */
    uint64_t rows_pixels;   /* pixels of rows that are on the disk */
    bool has_colours; /* a pass whose tiles tell colours of the frame was closed
                       * while the job was watched, in this life of the
                       * coordinator (filling/colours.h) */
    double *line_s;  /* processor time spent on each line in this life of the
                      * coordinator; NULL: nothing is known */
    uint32_t nlines; /* length of line_s */
    bool untold;     /* line_s lacks the time of an attempt that was lost */
};

/* Which state may follow which, as drawn above. */
extern const struct steps frame_steps;
/* Change the frame's state; the step must be in frame_steps. */
void frame_step(struct job_frame *f, enum frame_state to);

/* Is the frame's picture on the disk, fetched or not? */
bool frame_is_written(const struct job_frame *f);

/* Bring job->frames_ready up to date: frames are delivered in order, so only
 * those before the first that is not written count. */
void frame_count_ready(struct job *job);

/* Add the processor time that a worker reports for lines to line_s.  Ignored if
 * the job's lines are not shared or memory is out. */
void frame_add_costs(struct job *job, const struct msg_line_costs *m);

#endif
