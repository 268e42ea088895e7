/* idle.h - does somebody use this machine?
 *
 * Two signs are looked at: a terminal that was typed at or written to, and
 * processor time that others than us take.  Our own processes give way
 * (nice(2)), and Linux counts their time apart, so all time of programs that do
 * not give way is somebody's.  The machine is idle again once neither was seen
 * for IDLE_QUIET_S.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_IDLE_H
#define RADD_DAEMON_IDLE_H

#include <stdbool.h>
#include <stdint.h>

#define IDLE_QUIET_S 300
#define IDLE_LOOK_MS 5000 /* how often idle_look() is worth its while */
/* of one processor: a desktop at rest takes less, somebody at work more */
#define IDLE_LOAD .5

struct idle {
    uint64_t looked_ms; /* 0: never */
    double used_s;      /* by programs that do not give way, since boot */
    uint64_t last_ms;   /* when somebody was there last; 0: never seen */
};

/* Seconds of user and system time from the text of /proc/stat, without what
 * gave way; negative: that is no such text.  ticks: of the clock, a second. */
double idle_used(const char *stat, long ticks);

/* What was found at that time: tells whether somebody is there.  terminal_s:
 * since when nobody was at a terminal. */
bool idle_judge(struct idle *i, uint64_t now_ms, double used_s,
                double terminal_s);

/* Look at the machine, and the same. */
bool idle_look(struct idle *i, uint64_t now_ms);

#endif
