/* costs.h - what the lines of a picture cost in a former job
 *
 * From its statistics (radsubmit --stats), whatever its partition: what its
 * lines took (line_s), with what a worker's first line took for want of ambient
 * records spread over all; where that is not known, what its units cost, spread
 * evenly over their rows.  The cost is processor time, or rays where a unit has
 * none.
 * A line is a base line of the sampler with the bar above it, as in a strict
 * partition (proto/msg_sharing.h).
 * Thread: one. */
#ifndef RADD_CLIENT_COSTS_H
#define RADD_CLIENT_COSTS_H

#include "proto/message.h"

struct costs {
    uint32_t nframes;
    struct costs_frame {
        uint32_t width, height;
        double *row; /* what each cost, from the top */
        /* its units, as long as one of them is not as wide as the frame */
        struct costs_window {
            uint32_t x, y, width, height;
            double cost;
        } * window;
        uint32_t nwindows;
    } * frames;
    int ystep; /* base lines are so many rows apart */
};

/* Read a file; RAD_ENOINPUT, RAD_EDATA for what is no statistics or not of a
 * whole job, RAD_ENOMEM.  *c can be released in any case. */
int costs_read(struct costs *c, const char *path, struct rad_error *err);

/* The same from text that is there already. */
int costs_parse(struct costs *c, const char *text, size_t len,
                struct rad_error *err);
void costs_release(struct costs *c);

/* The cost of each line of each frame, as in msg_spec.costs: *bytes, to be
 * freed, is *n floats on the wire.  RAD_EDATA: the former job's frames, sizes
 * or ystep were others; RAD_EUSAGE: more than MSG_MAX_COSTS lines. */
int costs_of_lines(const struct costs *c, const struct msg_frame *frames,
                   uint32_t nframes, int psample, uint8_t **bytes, uint32_t *n,
                   struct rad_error *err);

#endif
