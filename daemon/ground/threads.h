/* threads.h - start the threads of libuv's pool
 *
 * libuv does at the first work, and calls abort() where the system refuses:
 * pids.max of a container, `ulimit -u'.  So a program starts them before other
 * processes have their place, and where it cannot it says so and ends with 75:
 * libuv cannot be asked again.
 */
#ifndef DAEMON_THREADS_H
#define DAEMON_THREADS_H

#include <stdbool.h>
#include <uv.h>

/* *first is the loop's until that has run it.  lone: a single thread is enough,
 * unless UV_THREADPOOL_SIZE says otherwise: each more is a fifth of a
 * millisecond, and libuv waits until all of them run. */
void threads_start(uv_loop_t *loop, uv_work_t *first, bool lone);

#endif
