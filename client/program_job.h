/* program_job.h - radsubmit's job, once all has been checked */
#ifndef RADD_CLIENT_PROGRAM_JOB_H
#define RADD_CLIENT_PROGRAM_JOB_H

#include "program.h"

/* Compile the scene, start our own cluster if there is to be one, submit the
 * job and write its pictures. */
int program_run_job(struct program *p);

/* --dry-run: compile the scene and print what the job will take. */
int program_run_dry(struct program *p);

#endif
