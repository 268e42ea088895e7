/* apart.h - check that radsubmit's outputs overwrite neither each other nor its
 * input files
 *
 * Thread: one. */
#ifndef RADD_CLIENT_APART_H
#define RADD_CLIENT_APART_H

#include "job/frames.h"
#include "common/inputs.h"
#include "job/submit_options.h"

/* Note the input files that the options name.  The parser has noted those that
 * it read itself. */
int apart_note(struct inputs *in, const struct submit_options *o,
               struct rad_error *err);

/* RAD_EUSAGE: two outputs are the same file. */
int apart_outputs(const struct submit_options *o, struct rad_error *err);

/* RAD_EUSAGE: an output is an input file.  frames NULL: they are not known yet,
 * and outputs with a file for each frame are not checked. */
int apart_inputs(const struct submit_options *o, const struct frames *frames,
                 const struct inputs *in, struct rad_error *err);

#endif
