/* wake.c - see wake.h */
#include "config.h"

#include "pool/wake.h"

#include <errno.h>
#include <sys/eventfd.h>
#include <unistd.h>

static void
on_readable(uv_poll_t *poll, int status, int events)
{
    struct wake *w = (struct wake *)poll;
    eventfd_t sent;

    (void)status; /* an eventfd has no errors */
    (void)events;
    if (eventfd_read(w->fd, &sent) == 0)
        w->fn(poll->data);
}

int
wake_init(struct wake *w, uv_loop_t *loop, wake_fn *fn, void *arg)
{
    int rc;

    w->fn = fn;
    w->fd = eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    if (w->fd < 0)
        return uv_translate_sys_error(errno);
    rc = uv_poll_init(loop, &w->poll, w->fd);
    if (rc < 0) {
        close(w->fd);
        return rc;
    }
    w->poll.data = arg;
    uv_poll_start(&w->poll, UV_READABLE, on_readable);
    return 0;
}

void
wake_send(struct wake *w)
{
    eventfd_write(w->fd, 1);
}

void
wake_close(struct wake *w, uv_close_cb closed)
{
    uv_close((uv_handle_t *)&w->poll, closed);
    close(w->fd);
}
