/* threads.c - see threads.h */
#include "config.h"

#include "ground/threads.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sysexits.h>
#include <unistd.h>

#define SIZE "UV_THREADPOOL_SIZE"

/* abort() has raised it in this thread, so nothing else is under way here. */
static void
say_lack(int signum)
{
    (void)signum;
    fprintf(stderr, "%s: cannot start a thread: the system allows no more\n",
            program_invocation_short_name);
    _exit(EX_TEMPFAIL);
}

static void
do_nothing(uv_work_t *work)
{
    (void)work;
}

void
threads_start(uv_loop_t *loop, uv_work_t *first, bool lone)
{
    void (*before)(int) = signal(SIGABRT, say_lack);

    lone = lone && !getenv(SIZE);
    if (lone)
        setenv(SIZE, "1", 1);
    uv_queue_work(loop, first, do_nothing, NULL);
    if (lone)
        unsetenv(SIZE); /* programs that we start have their own */
    signal(SIGABRT, before);
}
