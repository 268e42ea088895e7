/* task.h - work that may wait for the disk, off the loop and in order
 *
 * One queue, one thread of libuv's pool at a time: tasks run in the order in
 * which they were pushed, so a file's bytes are written before it is read, and
 * no two tasks meet.  All that wait are taken together; between running them
 * and telling the loop, `settle` runs once, which is where one fdatasync
 * serves a whole group.
 * Thread: all calls on the loop's; run and settle on a pool thread. */
#ifndef RADD_DAEMON_TASK_H
#define RADD_DAEMON_TASK_H

#include "base/error.h"

#include <stdbool.h>
#include <uv.h>

/* Embedded first in what a task needs; allocated by the caller. */
struct task {
    int (*run)(struct task *t);   /* pool thread: 0.. or negative, err set */
    void (*done)(struct task *t); /* loop: looks at code, frees t */
    int code;
    struct rad_error err;
    struct task *next; /* [loop] */
};

struct task_queue {
    uv_loop_t *loop;
    uv_work_t work;
    struct task *first, **last; /* [loop] waiting */
    struct task *running;       /* [pool] while busy, else [loop] */
    bool busy;                  /* [loop] */
    int (*settle)(void *arg, struct rad_error *err); /* may be NULL */
    void *arg;
    void (*drained)(void *arg); /* [loop] called when nothing is left */
};

void task_queue_init(struct task_queue *q, uv_loop_t *loop);

/* Takes t, until its done() is called. */
void task_push(struct task_queue *q, struct task *t);

/* Nothing waits and nothing runs. */
bool task_queue_idle(const struct task_queue *q);

#endif
