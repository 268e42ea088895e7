/* apart.h - radsubmit's outputs take away neither each other nor what it reads
 *
 * Thread: one. */
#ifndef RADD_CLIENT_APART_H
#define RADD_CLIENT_APART_H

#include "job/frames.h"
#include "common/inputs.h"
#include "job/submit_options.h"

/* Note the files that the options name and that are read; those that the
 * parser read itself are in *in. */
int apart_note(struct inputs *in, const struct submit_options *o,
               struct rad_error *err);

/* RAD_EUSAGE if two outputs are one file. */
int apart_outputs(const struct submit_options *o, struct rad_error *err);

/* RAD_EUSAGE if an output, or that of a frame (NULL: they are not known yet),
 * is one of the files that are read. */
int apart_inputs(const struct submit_options *o, const struct frames *frames,
                 const struct inputs *in, struct rad_error *err);

#endif
