/* store_task.c - requests to the store as tasks of its queue */
#include "config.h"

#include "store/store_impl.h"

#include "ground/memory.h"

#include <stdlib.h>
#include <string.h>

void *
store_new_task(struct store *s, size_t size, int (*run)(struct task *t),
               void (*done)(struct task *t))
{
    struct task *t = memory_need(size);

    memset(t, 0, size);
    t->run = run;
    t->done = done;
    t->owner = s;
    return t;
}

void
store_free_task(struct task *t)
{
    free(t);
}

void
store_push_lasting(struct store *s, struct task *t)
{
    t->writes = t->lasts = true;
    task_push(&s->queue, t);
}

struct settle_task {
    struct task task;
    uint64_t conn;
    uint32_t request;
};

static int
nothing_run(struct task *t)
{
    (void)t;
    return 0;
}

static void
settle_done(struct task *t)
{
    struct settle_task *w = (struct settle_task *)t;
    struct store *s = store_of(t);

    if (!is_mute(s, t))
        s->handler->settled(s->arg, w->conn, w->request);
    free(w);
}

void
store_settle(struct store *s, uint64_t conn, uint32_t request)
{
    struct settle_task *w =
        store_new_task(s, sizeof *w, nothing_run, settle_done);

    w->conn = conn;
    w->request = request;
    w->task.awaited = true;
    store_push_lasting(s, &w->task);
}

int
store_shorten_log(struct store *s, int rc, struct rad_error *err)
{
    struct rad_error why = { 0 };

    if (s->journal && journal_give_room(s->journal, &why) < 0) {
        *err = why;
        rc = why.code;
    }
    return rc;
}
