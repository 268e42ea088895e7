/* threads.h - start as many threads as libuv's pool has, and end them
 *
 * libuv does at the first work, and ends the process by SIGABRT where the system
 * refuses: pids.max of a container, `ulimit -u'. */
#ifndef RADD_NET_THREADS_H
#define RADD_NET_THREADS_H

#include "base/error.h"

int threads_try(struct rad_error *err); /* RAD_ESHORT */

#endif
