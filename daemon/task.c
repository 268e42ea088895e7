/* task.c - see task.h */
#include "config.h"

#include "task.h"

#include <assert.h>
#include <string.h>

#define NS_A_MS UINT64_C(1000000)

static void start(struct task_queue *q);

/* --- lists --- */

static void
list_init(struct task_list *l)
{
    l->first = NULL;
    l->last = &l->first;
    l->n = 0;
}

static void
list_add(struct task_list *l, struct task *t)
{
    t->next = NULL;
    *l->last = t;
    l->last = &t->next;
    l->n++;
}

static struct task *
list_take(struct task_list *l)
{
    struct task *t = l->first;

    if (!t)
        return NULL;
    l->first = t->next;
    if (!l->first)
        l->last = &l->first;
    l->n--;
    return t;
}

/* All of `from` goes behind what is in `to`. */
static void
list_move(struct task_list *to, struct task_list *from)
{
    struct task *t;

    while ((t = list_take(from)) != NULL)
        list_add(to, t);
}

/* All of `from` goes in front of what is in `to`. */
static void
list_move_front(struct task_list *to, struct task_list *from)
{
    list_move(from, to);
    list_move(to, from);
}

/* --- on a pool thread --- */

/* It failed; as the disk is full it will be tried again, if it may. */
static bool
is_held(struct task_queue *q, const struct rad_error *err)
{
    if (err->code != RAD_EFULL || !q->ops->fullness || q->ending)
        return false;
    q->full = true;
    q->why = *err;
    return true;
}

static void
break_down(struct task_queue *q, const struct rad_error *err)
{
    if (!q->ops->broken || q->is_broken || q->ending)
        return;
    q->is_broken = true;
    q->why = *err;
}

static bool
is_the_disk(int code)
{
    return code == RAD_EIO || code == RAD_EFULL || code == RAD_ENOMEM;
}

static void
run_one(struct task_queue *q, struct task *t)
{
    if (q->is_broken && t->writes) {
        t->code = q->why.code;
        t->err = q->why;
    } else {
        memset(&t->err, 0, sizeof t->err);
        t->code = t->run(t);
    }
    if (t->code < 0 && t->writes && is_held(q, &t->err)) {
        list_add(&q->held, t);
        return;
    }
    if (t->writes && is_the_disk(t->code))
        break_down(q, &t->err);
    list_add(t->code >= 0 && t->lasts ? &q->unsettled : &q->finished, t);
}

static bool
is_time_to_settle(const struct task_queue *q)
{
    return q->unsettled.n > 0 &&
           (!q->gather || q->ending || q->unsettled.n >= TASK_GATHER ||
            uv_hrtime() - q->settled_ns >= TASK_GATHER_MS * NS_A_MS);
}

static void
settle(struct task_queue *q)
{
    struct rad_error err = { 0 };
    int rc = 0;

    q->settled_ns = uv_hrtime();
    if (q->ops->settle && !q->is_broken)
        rc = q->ops->settle(q->arg, &err);
    if (rc < 0 && is_held(q, &err)) { /* it all runs again */
        list_move_front(&q->held, &q->unsettled);
        return;
    }
    if (rc < 0)
        break_down(q, &err);
    if (q->is_broken) {
        rc = q->why.code;
        err = q->why;
    }
    /* what was written may not last: none of it counts as done */
    for (struct task *t = q->unsettled.first; t && rc < 0; t = t->next) {
        t->code = rc;
        t->err = err;
    }
    list_move(&q->finished, &q->unsettled);
}

static void
run_all(uv_work_t *work)
{
    struct task_queue *q = work->data;
    struct task *t;

    if (q->retry || q->ending) {
        q->full = false;
        list_move_front(&q->running, &q->held);
    }
    q->retry = false;
    while ((t = list_take(&q->running)) != NULL) {
        if (q->full && t->writes)
            list_add(&q->held, t);
        else
            run_one(q, t);
        if (q->unsettled.n >= TASK_MOST)
            settle(q);
    }
    if (is_time_to_settle(q))
        settle(q);
}

/* --- on the loop --- */

static void
on_timer(uv_timer_t *timer)
{
    struct task_queue *q = timer->data;

    if (q->busy)
        return; /* when that ends it is looked at again */
    q->retry = q->held.n > 0;
    start(q);
}

/* What is left to do after a while. */
static void
arm(struct task_queue *q)
{
    uint64_t gone_ms = (uv_hrtime() - q->settled_ns) / NS_A_MS;

    if (q->unsettled.n > 0)
        uv_timer_start(&q->timer, on_timer,
                       gone_ms < TASK_GATHER_MS ? TASK_GATHER_MS - gone_ms : 0,
                       0);
    else if (q->held.n > 0 && !uv_is_active((uv_handle_t *)&q->timer))
        uv_timer_start(&q->timer, on_timer, TASK_RETRY_MS, 0);
}

static void
tell(struct task_queue *q)
{
    if (q->is_broken && !q->told_broken) {
        q->told_broken = true;
        q->ops->broken(q->arg, &q->why);
    }
    if (q->full != q->told_full) {
        q->told_full = q->full;
        q->ops->fullness(q->arg, q->full, q->why.what);
    }
}

static void
finish_all(uv_work_t *work, int status)
{
    struct task_queue *q = work->data;
    struct task_list done;
    struct task *t;

    (void)status; /* never cancelled */
    list_init(&done);
    list_move(&done, &q->finished);
    tell(q);
    q->busy = false;
    while ((t = list_take(&done)) != NULL)
        t->done(t);
    if (q->busy)
        return;
    if (q->waiting.n > 0 || (q->ends && q->held.n + q->unsettled.n > 0))
        start(q);
    else
        arm(q);
}

static void
start(struct task_queue *q)
{
    int rc;

    list_move(&q->running, &q->waiting);
    q->ending = q->ends;
    q->busy = true;
    rc = uv_queue_work(q->loop, &q->work, run_all, finish_all);
    assert(rc == 0); /* it fails only without a callback */
    (void)rc;
}

void
task_queue_init(struct task_queue *q, uv_loop_t *loop,
                const struct task_ops *ops, void *arg)
{
    memset(q, 0, sizeof *q);
    q->loop = loop;
    q->ops = ops;
    q->arg = arg;
    list_init(&q->waiting);
    list_init(&q->running);
    list_init(&q->unsettled);
    list_init(&q->held);
    list_init(&q->finished);
    q->work.data = q;
    uv_timer_init(loop, &q->timer);
    q->timer.data = q;
}

void
task_push(struct task_queue *q, struct task *t)
{
    t->code = 0;
    list_add(&q->waiting, t);
    if (!q->busy)
        start(q);
}

bool
task_queue_idle(const struct task_queue *q)
{
    return !q->busy && q->waiting.n + q->unsettled.n + q->held.n == 0;
}

void
task_queue_end(struct task_queue *q)
{
    q->ends = true;
    if (!q->busy && !task_queue_idle(q))
        start(q);
}

static void
on_closed(uv_handle_t *h)
{
    struct task_queue *q = h->data;

    q->closed = true;
}

void
task_queue_release(struct task_queue *q)
{
    assert(task_queue_idle(q));
    uv_close((uv_handle_t *)&q->timer, on_closed);
    while (!q->closed)
        uv_run(q->loop, UV_RUN_NOWAIT);
}
