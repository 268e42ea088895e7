/* wake.h - render threads wake the loop
 *
 * In place of uv_async_t: when the loop finds that a sender has been put aside
 * within uv_async_send() it spins, then yields its processor until the sender
 * has gone on (libuv 1.44).  With a render thread on each processor this
 * happens at every second tile, and since Linux 6.18 a yield costs a whole
 * slice of time, in which the threads run out of tiles. */
#ifndef RADD_DAEMON_WAKE_H
#define RADD_DAEMON_WAKE_H

#include <uv.h>

typedef void wake_fn(void *arg);

struct wake {
    uv_poll_t poll; /* its data is the user's arg */
    int fd;         /* an eventfd */
    wake_fn *fn;
};

/* Call fn(arg) on the loop's thread after calls of wake_send(), once for
 * several.  Returns 0; or a uv error, and then the wake need not be closed. */
int wake_init(struct wake *w, uv_loop_t *loop, wake_fn *fn, void *arg);

/* Any thread, until wake_close(). */
void wake_send(struct wake *w);

/* The loop calls closed() with a handle whose data is wake_init()'s arg. */
void wake_close(struct wake *w, uv_close_cb closed);

#endif
