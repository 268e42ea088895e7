/* task.c - see task.h */
#include "config.h"

#include "ground/task.h"

#include <assert.h>
#include <string.h>

#define TELL_MS 4 /* of one turn of the loop for calls of done() */

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

/* Move all of `from` behind the tasks in `to`. */
static void
list_move(struct task_list *to, struct task_list *from)
{
    struct task *t;

    while ((t = list_take(from)) != NULL)
        list_add(to, t);
}

/* Move all of `from` in front of the tasks in `to`. */
static void
list_move_front(struct task_list *to, struct task_list *from)
{
    list_move(from, to);
    list_move(to, from);
}

/* --- on a pool thread --- */

static enum task_lack
lack_of(int code)
{
    return code == RAD_EFULL                          ? TASK_LACKS_ROOM
           : code == RAD_ESHORT || code == RAD_ENOMEM ? TASK_LACKS_MEANS
                                                      : TASK_LACKS_NOTHING;
}

/* May a task or a settling that failed with this code be tried again? */
static bool
may_pass(const struct task_queue *q, int code)
{
    enum task_lack lack = lack_of(code);

    return q->order != TASK_END &&
           (lack == TASK_LACKS_MEANS ||
            (lack == TASK_LACKS_ROOM && q->ops->broken));
}

/* Hold all tasks that write, until the next retry. */
static void
hold_writers(struct task_queue *q, const struct rad_error *err)
{
    q->lack = lack_of(err->code);
    q->why = *err;
}

static void
break_down(struct task_queue *q, const struct rad_error *err)
{
    if (!q->ops->broken || q->is_broken)
        return;
    q->is_broken = true;
    q->why = *err;
}

static bool
is_the_disk(int code)
{
    return code == RAD_EIO || code == RAD_EPERM ||
           lack_of(code) != TASK_LACKS_NOTHING;
}

/* Does the task lack room that others may do without? */
static bool
is_alone(const struct task *t)
{
    return t->waits && t->code == RAD_EFULL;
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
    if (t->code < 0 && may_pass(q, t->code)) {
        if (t->writes && !is_alone(t))
            hold_writers(q, &t->err);
        q->soon |= lack_of(t->code) == TASK_LACKS_MEANS;
        list_add(&q->held, t);
        return;
    }
    if (t->writes && is_the_disk(t->code) && !is_alone(t))
        break_down(q, &t->err);
    q->awaited |= t->code >= 0 && t->awaited;
    list_add(t->code >= 0 && t->lasts ? &q->unsettled : &q->finished, t);
}

static bool
is_time_to_settle(const struct task_queue *q)
{
    if (q->lack != TASK_LACKS_NOTHING) /* may have undone unsettled tasks */
        return true;
    return q->unsettled.n > 0 &&
           (!q->gather || q->awaited || q->order == TASK_END ||
            q->unsettled.n >= TASK_GATHER ||
            uv_hrtime() - q->settled_ns >= TASK_GATHER_MS * NS_A_MS);
}

static void
settle(struct task_queue *q)
{
    struct rad_error err = { 0 };
    int rc = 0;

    q->settled_ns = uv_hrtime();
    q->awaited = false;
    if (q->ops->settle && !q->is_broken)
        rc = q->ops->settle(q->arg, &err);
    if (rc < 0 && may_pass(q, rc)) { /* the unsettled tasks run again */
        hold_writers(q, &err);
        q->soon |= q->lack == TASK_LACKS_MEANS;
        list_move_front(&q->held, &q->unsettled);
        return;
    }
    if (rc < 0)
        break_down(q, &err);
    if (q->is_broken) {
        rc = q->why.code;
        err = q->why;
    }
    /* what the tasks wrote may not last: all unsettled ones fail */
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

    if (q->order != TASK_RUN) {
        q->lack = TASK_LACKS_NOTHING;
        q->soon = false;
        q->retried_ns = uv_hrtime();
        list_move_front(&q->running, &q->held);
    }
    while ((t = list_take(&q->running)) != NULL) {
        if (q->lack != TASK_LACKS_NOTHING && t->writes)
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

static uint64_t
retry_ms(const struct task_queue *q)
{
    return q->soon ? TASK_SHORT_MS : TASK_RETRY_MS;
}

static void
on_timer(uv_timer_t *timer)
{
    struct task_queue *q = timer->data;

    if (!q->busy) /* else tell_done() starts the queue or the timer again */
        start(q);
}

/* Start the timer for the next settling, or the next retry. */
static void
arm(struct task_queue *q)
{
    uint64_t gone_ms = (uv_hrtime() - q->settled_ns) / NS_A_MS;

    if (q->unsettled.n > 0)
        uv_timer_start(&q->timer, on_timer,
                       gone_ms < TASK_GATHER_MS ? TASK_GATHER_MS - gone_ms : 0,
                       0);
    else if (q->held.n > 0 && !uv_is_active((uv_handle_t *)&q->timer))
        uv_timer_start(&q->timer, on_timer, retry_ms(q), 0);
}

static void
tell(struct task_queue *q)
{
    for (struct task *t = q->held.first; t; t = t->next)
        if (t->waits && !t->told && t->code == RAD_EFULL) {
            t->told = true;
            t->waits(t);
        }
    if (q->is_broken && !q->told_broken &&
        lack_of(q->why.code) == TASK_LACKS_NOTHING) {
        q->told_broken = true;
        q->ops->broken(q->arg, &q->why);
    }
    if (q->lack != q->told_lack) {
        q->told_lack = q->lack;
        q->ops->lacks(q->arg, q->lack, q->why.what);
    }
}

static void tell_done(struct task_queue *q);

static void
on_rest(uv_timer_t *timer)
{
    tell_done(timer->data);
}

/* Call done() of finished tasks; of very many in several turns of the loop, for
 * other work waits for it.  No task runs until all are told. */
static void
tell_done(struct task_queue *q)
{
    uint64_t until = uv_hrtime() + TELL_MS * UINT64_C(1000000);
    struct task *t;

    while ((t = list_take(&q->telling)) != NULL) {
        t->done(t);
        if (q->telling.n > 0 && uv_hrtime() >= until) {
            uv_timer_start(&q->timer, on_rest, 0, 0);
            return;
        }
    }
    q->busy = false;
    if (q->waiting.n > 0 || (q->ends && q->held.n + q->unsettled.n > 0))
        start(q);
    else
        arm(q);
}

static void
finish_all(uv_work_t *work, int status)
{
    struct task_queue *q = work->data;

    (void)status; /* never cancelled */
    list_move(&q->telling, &q->finished);
    tell(q);
    tell_done(q);
}

static void
start(struct task_queue *q)
{
    bool retry;
    int rc;

    list_move(&q->running, &q->waiting);
    /* not by the timer alone: it never fires while other tasks keep coming */
    retry =
        q->held.n > 0 && uv_hrtime() - q->retried_ns >= retry_ms(q) * NS_A_MS;
    q->order = q->ends ? TASK_END : retry ? TASK_RETRY : TASK_RUN;
    q->busy = true;
    rc = uv_queue_work(q->loop, &q->work, run_all, finish_all);
    assert(rc == 0); /* fails only without a callback */
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
    list_init(&q->telling);
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
    bool *closed = h->data;

    *closed = true;
}

void
task_queue_release(struct task_queue *q)
{
    bool closed = false;

    assert(task_queue_idle(q));
    q->timer.data = &closed;
    uv_close((uv_handle_t *)&q->timer, on_closed);
    while (!closed)
        uv_run(q->loop, UV_RUN_NOWAIT);
}
