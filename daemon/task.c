/* task.c - see task.h */
#include "config.h"

#include "task.h"

#include <assert.h>
#include <string.h>

static void start(struct task_queue *q);

static void
run_all(uv_work_t *work)
{
    struct task_queue *q = work->data;
    struct rad_error err = { 0 };
    int rc = 0;

    for (struct task *t = q->running; t; t = t->next)
        t->code = t->run(t);
    if (q->settle)
        rc = q->settle(q->arg, &err);
    if (rc >= 0)
        return;
    /* what was written may not last: none of it counts as done */
    for (struct task *t = q->running; t; t = t->next)
        if (t->code >= 0) {
            t->code = rc;
            t->err = err;
        }
}

static void
finish_all(uv_work_t *work, int status)
{
    struct task_queue *q = work->data;
    struct task *t = q->running, *next;

    (void)status; /* never cancelled */
    q->running = NULL;
    q->busy = false;
    for (; t; t = next) {
        next = t->next;
        t->done(t);
    }
    if (q->first && !q->busy)
        start(q);
    if (!q->busy && q->drained)
        q->drained(q->arg);
}

static void
start(struct task_queue *q)
{
    int rc;

    q->running = q->first;
    q->first = NULL;
    q->last = &q->first;
    q->busy = true;
    rc = uv_queue_work(q->loop, &q->work, run_all, finish_all);
    assert(rc == 0); /* it fails only without a callback */
    (void)rc;
}

void
task_queue_init(struct task_queue *q, uv_loop_t *loop)
{
    memset(q, 0, sizeof *q);
    q->loop = loop;
    q->last = &q->first;
    q->work.data = q;
}

void
task_push(struct task_queue *q, struct task *t)
{
    t->next = NULL;
    t->code = 0;
    memset(&t->err, 0, sizeof t->err);
    *q->last = t;
    q->last = &t->next;
    if (!q->busy)
        start(q);
}

bool
task_queue_idle(const struct task_queue *q)
{
    return !q->busy && !q->first;
}
