/* turns.h - how long the turns of a loop take
 *
 * A turn is all that the loop does between two waits; all peers of the daemon
 * wait for its end.  A turn of TURNS_LONG_MS or more of the thread's own
 * processor time, or TURNS_STALLED_MS by the clock (the host was busy, or the
 * disk slow), is counted and logged with the part that took longest.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_TURNS_H
#define RADD_DAEMON_TURNS_H

#include "net/log.h"

#include <stdint.h>
#include <uv.h>

#define TURNS_LONG_MS    10
#define TURNS_STALLED_MS 100

struct turns_seen {
    uint64_t slow;         /* turns, since the start */
    double longest_ms;     /* by the clock */
    double longest_cpu_ms; /* of processor time */
};

struct turns {
    uv_prepare_t before;               /* the loop waits: the turn is over */
    uint64_t wall_ns, idle_ns, cpu_ns; /* at the end of the previous turn */
    const char *what;                  /* longest part of the present turn, */
    uint64_t what_ns;                  /* and its length */
    struct turns_seen seen;
    struct log_limit limit;
};

/* Begin to measure; call before the loop runs. */
void turns_start(struct turns *t, uv_loop_t *loop);
void turns_stop(struct turns *t);

/* Note a part of the present turn, named `what` (a constant), that took ns. */
void turns_note(struct turns *t, const char *what, uint64_t ns);

#endif
