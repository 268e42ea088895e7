/* confine.h - rights that radweb gives up when it listens
 *
 * radweb parses what browsers send.  So from then on it cannot start a program
 * or a process, trace one, make or change a file, or gain a right.
 * Thread: main's; holds for all threads. */
#ifndef RADD_WEB_CONFINE_H
#define RADD_WEB_CONFINE_H

#include "base/error.h"

/* Where the kernel has no seccomp this is logged once, and returns 0.
 * RAD_EPERM: the kernel has it and refuses. */
int confine_begin(struct rad_error *err);

#endif
