/* threads.h - start the threads of libuv's pool
 *
 * libuv does at the first work, and ends the process by SIGABRT where the
 * system refuses: pids.max of a container, `ulimit -u'.  So as many are started
 * and ended first, and the pool's at once, before other processes have their
 * place.
 */
#ifndef DAEMON_THREADS_H
#define DAEMON_THREADS_H

#include "base/error.h"

#include <uv.h>

/* *first is the loop's until that has run it.  RAD_ESHORT; RAD_ENOMEM. */
int threads_start(uv_loop_t *loop, uv_work_t *first, struct rad_error *err);

#endif
