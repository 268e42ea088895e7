/* threads.c - see threads.h */
#include "config.h"

#include "ground/threads.h"

enum { POOL_THREADS = 4 }; /* libuv's, where UV_THREADPOOL_SIZE is not set */

static void
wait_for_end(void *end)
{
    uv_sem_wait(end);
}

static int
try_threads(struct rad_error *err)
{
    uv_thread_t threads[POOL_THREADS];
    uv_sem_t end;
    int n = 0, rc = uv_sem_init(&end, 0);

    if (rc < 0)
        return rad_fail_memory(err);
    while (rc == 0 && n < POOL_THREADS)
        if ((rc = uv_thread_create(&threads[n], wait_for_end, &end)) == 0)
            n++;
    for (int i = 0; i < n; i++)
        uv_sem_post(&end);
    for (int i = 0; i < n; i++)
        uv_thread_join(&threads[i]);
    uv_sem_destroy(&end);
    return rc == 0 ? 0
                   : rad_fail(err, RAD_ESHORT, "cannot start a thread: %s",
                              uv_strerror(rc));
}

static void
do_nothing(uv_work_t *work)
{
    (void)work;
}

int
threads_start(uv_loop_t *loop, uv_work_t *first, struct rad_error *err)
{
    int rc = try_threads(err);

    if (rc == 0)
        uv_queue_work(loop, first, do_nothing, NULL);
    return rc;
}
