/* turns.h - how long the turns of a loop take
 *
 * A turn is all that the loop does between two waits: everybody who wants
 * something of the daemon waits for it.  One that takes more than TURNS_LONG_MS
 * of the thread's own processor time, or TURNS_STALLED_MS by the clock (the
 * host was busy, or the disk slow), is counted and logged, with what took most
 * of it.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_TURNS_H
#define RADD_DAEMON_TURNS_H

#include "net/log.h"

#include <stdint.h>
#include <uv.h>

#define TURNS_LONG_MS    10
#define TURNS_STALLED_MS 100

struct turns_seen {
    uint64_t turns, slow;  /* since the start */
    double longest_ms;     /* by the clock */
    double longest_cpu_ms; /* of processor time */
    char what[32];         /* what took most of that one */
};

struct turns {
    uv_prepare_t before;               /* the loop waits: the turn is over */
    uint64_t wall_ns, idle_ns, cpu_ns; /* at the end of the last */
    const char *what;                  /* of this turn the longest part */
    uint64_t what_ns;
    struct turns_seen seen;
    struct log_limit limit;
};

/* Before the loop runs. */
void turns_start(struct turns *t, uv_loop_t *loop);
void turns_stop(struct turns *t);

/* A part of this turn, of that name (a constant), took so long. */
void turns_note(struct turns *t, const char *what, uint64_t ns);

#endif
