/* program_loop.c - see program_loop.h */
#include "config.h"

#include "program_loop.h"

#include "base/output.h"
#include "link/link.h"

#include <poll.h>
#include <signal.h>
#include <unistd.h>

/* An interrupt counts once.  A signal that ends a terminal's programs counts
 * twice, so that a job at a coordinator goes on. */
static void
on_signal(uv_signal_t *h, int signum)
{
    struct program_loop *l = h->data;

    l->interrupts += signum == SIGINT ? 1 : 2;
    uv_stop(&l->uv);
}

/* Are hang-ups ignored, by whoever started the program, such as nohup? */
static bool
hang_ups_ignored(void)
{
    struct sigaction now;

    return sigaction(SIGHUP, NULL, &now) == 0 && now.sa_handler == SIG_IGN;
}

int
program_loop_init(struct program_loop *l, struct rad_error *err)
{
    static const int which[] = { SIGINT, SIGTERM, SIGHUP };
    int rc = link_loop_init(&l->uv, &l->first_work, err);

    if (rc < 0)
        return rc;
    l->watched = true;
    signal(SIGPIPE, SIG_IGN);
    signal(SIGCHLD, SIG_DFL); /* ended processes must be waited for */
    for (int i = 0; i < 3; i++) {
        uv_signal_init(&l->uv, &l->signals[i]);
        l->signals[i].data = l;
        if (which[i] == SIGHUP && hang_ups_ignored())
            continue;
        uv_signal_start(&l->signals[i], on_signal, which[i]);
        uv_unref((uv_handle_t *)&l->signals[i]);
    }
    return 0;
}

void
program_loop_release(struct program_loop *l)
{
    for (int i = 0; i < 3; i++)
        uv_close((uv_handle_t *)&l->signals[i], NULL);
    while (uv_loop_close(&l->uv) == UV_EBUSY)
        uv_run(&l->uv, UV_RUN_ONCE);
}

/* Writing to a pipe may wait for a reader for ever, and the event loop stands
 * still meanwhile: let signals do what they do to any program, end it. */
static void
free_signals(struct program_loop *l, bool waits)
{
    waits &= l->watched;
    for (int i = 0; i < 3; i++) {
        uv_signal_t *s = &l->signals[i];

        l->freed[i] = waits && uv_is_active((uv_handle_t *)s) ? s->signum : 0;
        if (l->freed[i])
            uv_signal_stop(s);
    }
}

void
program_loop_free_signals(struct program_loop *l, const char *path)
{
    free_signals(l, rad_output_in_place(path));
}

void
program_loop_free_for_message(struct program_loop *l)
{
    struct pollfd to = { .fd = STDERR_FILENO, .events = POLLOUT };

    free_signals(l, poll(&to, 1, 0) == 0);
}

void
program_loop_catch_signals(struct program_loop *l)
{
    for (int i = 0; i < 3; i++) {
        uv_signal_t *s = &l->signals[i];

        if (l->freed[i])
            uv_signal_start(s, s->signal_cb, l->freed[i]);
    }
}
