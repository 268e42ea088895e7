/* program_planes.h - jobs of planes, for more than three bands */
#ifndef RADD_CLIENT_PROGRAM_PLANES_H
#define RADD_CLIENT_PROGRAM_PLANES_H

#include "program.h"

/* Fill in the specification of the job, or of the job of the current plane. */
void program_fill_spec(struct program *p);

/* As submit_run(), for the jobs of all planes. */
int program_run_planes(struct program *p, const struct submit_job *job,
                       const struct submit_callbacks *cb);

#endif
