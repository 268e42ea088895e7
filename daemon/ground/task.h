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
 * What a task fails for may pass: the disk is full (RAD_EFULL), or descriptors
 * or memory are short (RAD_ESHORT, RAD_ENOMEM).  Then it is held, and where it
 * writes, so is all that writes after it, in order; they run again each
 * TASK_RETRY_MS until there is room, or each TASK_SHORT_MS until there is what
 * was short.  Meanwhile others run.  So a task must be one that may run twice.
 * `lacks` tells when this begins and ends for what writes.  A task with `waits`
 * wants so much room that others need not wait for it: where there is none for
 * it, it is held alone, and told so.
 *
 * Where a task that writes fails otherwise for the disk's sake, or settling
 * does, the queue is broken: nothing that writes runs or is done any more, and
 * `broken` tells, once.
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
    TASK_RETRY_MS = 1000,
    TASK_SHORT_MS = 100
};

/* What tasks that write wait for: room on the disk; descriptors or memory. */
enum task_lack { TASK_LACKS_NOTHING, TASK_LACKS_ROOM, TASK_LACKS_MEANS };

/* Embedded first in what a task needs; allocated by the caller. */
struct task {
    int (*run)(struct task *t);    /* pool thread: 0.. or negative, err set */
    void (*done)(struct task *t);  /* loop: looks at code, frees t */
    bool writes;                   /* in order; breaks the queue */
    bool lasts;                    /* done when settled */
    void (*waits)(struct task *t); /* loop: it is held alone; NULL: it is not */
    bool told;                     /* waits() was called; loop's while held */
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
    int (*settle)(void *arg, struct rad_error *err);                 /* pool */
    void (*lacks)(void *arg, enum task_lack what, const char *text); /* loop */
    /* Without it a disk that is full or fails is a failure as others are. */
    void (*broken)(void *arg, const struct rad_error *err); /* loop */
};

struct task_queue {
    uv_loop_t *loop;
    uv_work_t work;
    uv_timer_t timer;
    const struct task_ops *ops;
    void *arg;
    bool gather;                /* [fixed] settle but now and then */
    bool busy;                  /* [loop] a pool thread has the fields below, or
                                 * what it finished is still told */
    bool closed;                /* [loop] the timer is */
    enum task_lack told_lack;   /* [loop] */
    bool told_broken;           /* [loop] */
    bool ends;                  /* [loop] it was told to */
    bool retry, ending;         /* [loop] while not busy, else [pool]: try held
                                 * tasks again; `ends` as the pool knows it */
    struct task_list waiting;   /* [loop] */
    /* [loop] while not busy, else [pool]: */
    struct task_list running;
    struct task_list unsettled; /* have run, and are to last */
    struct task_list held;
    struct task_list finished;
    struct task_list telling; /* [loop] finished, done() is to be called */
    uint64_t settled_ns;      /* when settling began last */
    uint64_t retried_ns;      /* when held tasks were tried last */
    bool soon;                /* held tasks wait for means: retry soon */
    enum task_lack lack;
    struct rad_error why; /* of the lack, or of being broken */
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
