/* store_submit.c - the frames of a job that is submitted
 *
 * A large SUBMIT has its frames in a file of the bundle (views.h).  A task
 * reads the file, behind the tasks that wrote it, and the handler gets the
 * whole message.  Each connection has at most one such task at a time, so the
 * number of tasks is bounded. */
#include "config.h"

#include "store/store_impl.h"

#include "net/log.h"
#include "proto/frame.h"
#include "files/views.h"

#include <stdlib.h>

struct submit_task {
    struct task task;
    uint64_t conn;
    struct wire_out bytes; /* the SUBMIT, packed */
    struct msg msg;        /* that SUBMIT, unpacked */
    struct views views;
    struct submit_task *next; /* [loop] next in store.submitting */
};

static void
free_submit(struct submit_task *o)
{
    wire_out_release(&o->bytes);
    msg_release(&o->msg);
    views_release(&o->views);
    free(o);
}

static int
submit_run(struct task *t)
{
    struct submit_task *o = (struct submit_task *)t;

    return views_read(&o->views, store_of(t)->blobs.dir, &o->msg.submit,
                      &t->err);
}

static void
submit_done(struct task *t)
{
    struct submit_task *o = (struct submit_task *)t;
    struct store *s = store_of(t);
    struct submit_task **at = &s->submitting;

    while (*at != o)
        at = &(*at)->next;
    *at = o->next;
    if (!s->ending)
        s->handler->submit(s->arg, o->conn, &o->msg, status_of(t), failure(t));
    free_submit(o);
}

static bool
is_reading(const struct store *s, uint64_t conn)
{
    for (const struct submit_task *o = s->submitting; o; o = o->next)
        if (o->conn == conn)
            return true;
    return false;
}

bool
store_read_submit(struct store *s, uint64_t conn, const struct msg *m)
{
    struct submit_task *o;

    if (is_reading(s, conn))
        return false;
    o = store_new_task(s, sizeof *o, submit_run, submit_done);
    o->conn = conn;
    wire_out_init(&o->bytes, MSG_FRAME_MAX);
    if (msg_pack(&o->bytes, m) != 0 ||
        msg_unpack(&o->msg, MSG_SUBMIT, m->request, o->bytes.buf + MSG_HEADER,
                   o->bytes.len - MSG_HEADER, NULL) != 0)
        log_out_of_memory();
    o->next = s->submitting;
    s->submitting = o;
    task_push(&s->queue, &o->task);
    return true;
}
