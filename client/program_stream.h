/* program_stream.h - jobs of sensor points that come on a pipe */
#ifndef RADD_CLIENT_PROGRAM_STREAM_H
#define RADD_CLIENT_PROGRAM_STREAM_H

#include "program.h"

/* RAD_EUSAGE: these options do not go with points on a pipe.  Puts a frame of
 * any size into p->frames for the first batch. */
int program_check_stream(struct program *p);

/* As submit_run(), with a job for each batch of points.  The scene must be
 * compiled and records be read. */
int program_run_stream(struct program *p, const struct submit_job *job,
                       const struct submit_callbacks *cb);

#endif
