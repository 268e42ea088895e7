/* task.h - work that may wait for the disk, off the loop and in order
 *
 * One queue, one thread of libuv's pool at a time: tasks run in the order in
 * which they were pushed, so a file's bytes are written before it is read, and
 * no two tasks meet.
 *
 * Tasks that must last are not done when they have run, but when `settle` has:
 * one settling serves all that ran since the last.  It comes TASK_GATHER_MS
 * after the last, or when there are TASK_GATHER of them; what came while the
 * disk was busy is settled together, up to TASK_MOST, so a slow disk settles
 * less often and not less.
 *
 * Where the disk is full (RAD_EFULL), a task that writes is held, and so is all
 * that writes after it, in order; they run again each TASK_RETRY_MS until there
 * is room.  Meanwhile others run.  So a task that writes must be one that may
 * run twice.  `fullness` tells when this begins and ends.
 *
 * Where a task that writes fails otherwise for the disk's or memory's sake, or
 * settling does, the queue is broken: nothing that writes runs or is done any
 * more, and `broken` tells, once.
 * Thread: all calls on the loop's; run and settle on a pool thread. */
#ifndef RADD_DAEMON_TASK_H
#define RADD_DAEMON_TASK_H

#include "base/error.h"

#include <stdbool.h>
#include <uv.h>

enum {
    TASK_GATHER_MS = 20,
    TASK_GATHER = 100,
    TASK_MOST = 4096,
    TASK_RETRY_MS = 1000
};

/* Embedded first in what a task needs; allocated by the caller. */
struct task {
    int (*run)(struct task *t);   /* pool thread: 0.. or negative, err set */
    void (*done)(struct task *t); /* loop: looks at code, frees t */
    bool writes;                  /* may be held; breaks the queue */
    bool lasts;                   /* done when settled */
    int code;
    struct rad_error err;
    struct task *next;
};

struct task_list {
    struct task *first, **last;
    unsigned n;
};

/* What a queue may do besides; all may be NULL. */
struct task_ops {
    int (*settle)(void *arg, struct rad_error *err); /* pool */
    /* Without it a full disk is a failure as others are. */
    void (*fullness)(void *arg, bool full, const char *text); /* loop */
    /* Without it, too. */
    void (*broken)(void *arg, const struct rad_error *err); /* loop */
};

struct task_queue {
    uv_loop_t *loop;
    uv_work_t work;
    uv_timer_t timer;
    const struct task_ops *ops;
    void *arg;
    bool gather;                 /* [fixed] settle but now and then */
    bool busy;                   /* [loop] a pool thread has the fields below */
    bool closed;                 /* [loop] the timer is */
    bool told_full, told_broken; /* [loop] */
    bool ends;                   /* [loop] it was told to */
    bool retry, ending;          /* [loop] while not busy, else [pool] */
    struct task_list waiting;    /* [loop] */
    struct task_list running;    /* likewise, and so are the rest */
    struct task_list unsettled;  /* they have run */
    struct task_list held;
    struct task_list finished;
    uint64_t settled_ns; /* when settling began last */
    bool full;
    struct rad_error why; /* it is full; or broken: code is set */
    bool is_broken;
};

void task_queue_init(struct task_queue *q, uv_loop_t *loop,
                     const struct task_ops *ops, void *arg);

/* Takes t, until its done() is called. */
void task_push(struct task_queue *q, struct task *t);

/* Nothing waits and nothing runs. */
bool task_queue_idle(const struct task_queue *q);

/* Come to an end soon: what waits for room fails. */
void task_queue_end(struct task_queue *q);

/* Only when idle; may run the loop. */
void task_queue_release(struct task_queue *q);

#endif
