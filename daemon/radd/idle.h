/* idle.h - does somebody use this machine?
 *
 * Two signs are looked at: a terminal that was typed at or written to, and
 * processor time of other people's programs.  Our processes run at a lower
 * priority (nice(2)), and Linux counts the time of such processes apart; so all
 * time at normal priority counts as other people's.  The machine is idle again
 * when neither sign was seen for IDLE_QUIET_S.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_IDLE_H
#define RADD_DAEMON_IDLE_H

#include <stdbool.h>
#include <stdint.h>

#define IDLE_QUIET_S 300
#define IDLE_LOOK_MS 5000 /* least time between two calls of idle_look() */
/* The machine is in use if other people's programs take this many processors: a
 * desktop at rest takes less, somebody at work more. */
#define IDLE_LOAD .5

struct idle {
    uint64_t looked_ms; /* 0: never */
    double used_s;      /* processor time of programs at normal priority, since
                         * the machine started */
    uint64_t last_ms;   /* when a sign of use was last seen; 0: never */
};

/* User and system time [s] of programs at normal priority, from the text of
 * /proc/stat; negative: malformed.  ticks: of the kernel's clock, per second.
 */
double idle_used(const char *stat, long ticks);

/* Take in the signs seen at now_ms: used_s, and terminal_s, the seconds since a
 * terminal was last used.  Returns whether somebody uses the machine. */
bool idle_judge(struct idle *i, uint64_t now_ms, double used_s,
                double terminal_s);

/* Look at the machine for both signs, and return whether somebody uses it. */
bool idle_look(struct idle *i, uint64_t now_ms);

#endif
