/* confine.h - rights that radweb gives up when it listens
 *
 * radweb parses requests of browsers.  So when it has begun to listen it cannot
 * start a program or a process, trace a process, make or change a file, or gain
 * a right.
 * Thread: main's; holds for all threads. */
#ifndef RADD_WEB_CONFINE_H
#define RADD_WEB_CONFINE_H

#include "base/error.h"

/* Give up the rights.  If the kernel has no seccomp that is logged, and 0
 * returned.  RAD_EPERM: the kernel refuses; RAD_ENOMEM. */
int confine_begin(struct rad_error *err);

#endif
