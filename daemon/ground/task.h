/* task.h - work that may wait for the disk, off the loop and in order
 *
 *   waiting --> running --done--------------------> finished --> done()
 *                ^  |  '--ran, and `lasts`--> unsettled --settled--^
 *                |  '--a lack that may pass--> held
 *                '-------------retry------------'
 *
 * A queue has at most one thread of libuv's pool at a time, which runs tasks in
 * the order in which they were pushed.  So a file's bytes are written before
 * they are read, and no two tasks of a queue meet.
 *
 * A task that `lasts` is finished only when `settle` was called after it ran:
 * one call serves all unsettled tasks.  A queue that gathers settles when
 * TASK_GATHER_MS have passed since it last began to, when TASK_GATHER tasks are
 * unsettled, or when one of these is `awaited`; tasks that came while the disk
 * was busy are settled together, up to TASK_MOST.  So a slow disk settles less
 * often, but no fewer tasks.
 *
 * A lack may pass: the disk is full (RAD_EFULL), or descriptors or memory are
 * short (RAD_ESHORT, RAD_ENOMEM).  A held task that writes holds all later
 * tasks that write; others run.  Held tasks are tried again each TASK_RETRY_MS,
 * or each TASK_SHORT_MS where means are short; so run() may be called twice.
 * `lacks` tells when tasks that write begin and cease to be held.  A task with
 * `waits` asks for very much room: on a full disk it is held alone, and waits()
 * is called once.  If settling fails for a lack, the unsettled tasks are held
 * in front, and run again.
 *
 * If a task that writes, or settling, fails for the disk in another way, the
 * queue is broken: no task that writes runs any more, unsettled and later ones
 * fail, and broken() is called once.  A lack that has not passed when the queue
 * ends breaks it, too, but without that call: later tasks may stand on the task
 * that failed.
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

/* What held tasks that write wait for: room on the disk; descriptors or memory.
 */
enum task_lack { TASK_LACKS_NOTHING, TASK_LACKS_ROOM, TASK_LACKS_MEANS };

/* What a pool thread does when it is started. */
enum task_order {
    TASK_RUN,   /* run the waiting tasks */
    TASK_RETRY, /* and held tasks again */
    TASK_END    /* the same; what lacks anything fails */
};

/* Embedded first in what a task needs; allocated by the caller. */
struct task {
    int (*run)(struct task *t);    /* pool thread: 0 or more, or negative with
                                    * err set */
    void (*done)(struct task *t);  /* loop: looks at code, frees t */
    bool writes;                   /* a lack holds it, its error may break the
                                    * queue */
    bool lasts;                    /* finished only when settled */
    bool awaited;                  /* and settled at once: somebody waits */
    void (*waits)(struct task *t); /* loop: the disk is full, and the task held
                                    * alone; NULL: hold it as others.  run()
                                    * may change it */
    bool told;                     /* [loop] while held: waits() was called */
    void *owner;                   /* for run(), done() and waits() */
    int code;
    struct rad_error err;
    struct task *next;
};

struct task_list {
    struct task *first, **last;
    unsigned n;
};

/* Functions of a queue; settle and broken may be NULL. */
struct task_ops {
    int (*settle)(void *arg, struct rad_error *err);                 /* pool */
    void (*lacks)(void *arg, enum task_lack what, const char *text); /* loop */
    /* NULL: a full disk, or an error of the disk, only fails its task. */
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
                                 * done() of finished tasks is still called */
    enum task_lack told_lack;   /* [loop] */
    bool told_broken;           /* [loop] */
    bool ends;                  /* [loop] task_queue_end() was called */
    struct task_list waiting;   /* [loop] */
    /* [loop] while not busy, else [pool]: */
    enum task_order order;
    struct task_list running;
    struct task_list unsettled; /* ran, and are to last */
    struct task_list held;
    struct task_list finished;
    struct task_list telling; /* [loop] finished, done() is to be called */
    bool awaited;             /* an unsettled task is */
    uint64_t settled_ns;      /* when settling began last */
    uint64_t retried_ns;      /* when held tasks were tried last */
    bool soon;                /* held tasks lack means: retry soon */
    enum task_lack lack;      /* for which tasks that write are held */
    struct rad_error why;     /* the lack, or what broke the queue */
    bool is_broken;
};

void task_queue_init(struct task_queue *q, uv_loop_t *loop,
                     const struct task_ops *ops, void *arg);

/* Queue a task, which belongs to the queue until done() is called. */
void task_push(struct task_queue *q, struct task *t);

/* Does no task wait, run, or wait for done(); is none unsettled or held? */
bool task_queue_idle(const struct task_queue *q);

/* End soon: held tasks run once more, and fail if the lack has not passed. */
void task_queue_end(struct task_queue *q);

/* Close the timer of an idle queue; runs the loop. */
void task_queue_release(struct task_queue *q);

#endif
