/* confine.h - what radweb gives up once it listens
 *
 * It parses what browsers send, so it can start no program and no process, look
 * at none, make or change no file, and get no right that it has not.
 * Thread: main's; holds for all threads. */
#ifndef RADD_WEB_CONFINE_H
#define RADD_WEB_CONFINE_H

#include "base/error.h"

/* A kernel without seccomp is said once in the log.  RAD_EPERM where the kernel
 * has it and refuses. */
int confine_begin(struct rad_error *err);

#endif
