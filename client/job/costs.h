/* costs.h - the costs of a picture's lines, from a former job
 *
 * They are read from its statistics (radsubmit --stats), whatever its
 * partition: from the time of its lines (line_s), where the extra time of each
 * worker's first line, which lacked ambient records, is spread over all lines;
 * or, without line_s, from the costs of its units, spread evenly over their
 * rows.  The cost is processor time, or rays if any unit has no time.
 * A line is a base line of the sampler with the bar above it, as in a strict
 * partition (proto/msg_sharing.h).
 * Thread: one. */
#ifndef RADD_CLIENT_COSTS_H
#define RADD_CLIENT_COSTS_H

#include "job/frames.h"

struct costs {
    uint32_t nframes;
    struct costs_frame {
        uint32_t width, height;
        double *row; /* cost of each row, from the top */
        /* its units, if any is narrower than the frame */
        struct costs_window {
            uint32_t x, y, width, height;
            double cost;
        } * window;
        uint32_t nwindows;
    } * frames;
    int ystep; /* rows from one base line to the next */
};

/* Read a file.  RAD_ENOINPUT; RAD_EDATA: it has no statistics, or those of a
 * job that was not done; RAD_ENOMEM.  *c can be released in any case. */
int costs_read(struct costs *c, const char *path, struct rad_error *err);

/* The same from a text. */
int costs_parse(struct costs *c, const char *text, size_t len,
                struct rad_error *err);
void costs_release(struct costs *c);

/* The cost of each line of each frame, as in msg_spec.costs: *bytes, to be
 * freed, has *n floats as on the wire.  RAD_EDATA: the former job had other
 * frames, sizes or base lines; RAD_EUSAGE: more than MSG_MAX_COSTS lines. */
int costs_of_lines(const struct costs *c, const struct frames *frames,
                   int psample, uint8_t **bytes, uint32_t *n,
                   struct rad_error *err);

#endif
