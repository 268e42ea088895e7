/* history.h - the last hour of a cluster: rays a second, threads at work
 *
 * One point for each HISTORY_STEP_S seconds, HISTORY_POINTS of them: the mean
 * of what was noted in that time.  A point without a note has seen nothing: the
 * coordinator could not be asked then.
 * Pure; thread: a struct belongs to one thread. */
#ifndef RADD_OBSERVER_HISTORY_H
#define RADD_OBSERVER_HISTORY_H

#include <stdint.h>

#define HISTORY_STEP_S 10
#define HISTORY_POINTS 360

struct history_point {
    double rays_s;  /* rays a second */
    double at_work; /* share of threads whose worker is at work, 0 to 1 */
    uint32_t notes; /* 0: nothing is known */
};

struct history {
    struct history_point ring[HISTORY_POINTS];
    uint64_t step; /* the number of the newest point, in the caller's time */
};

/* Zeroed, nothing is known.  Note a rate and a share at now_ms, which never
 * goes back. */
void history_note(struct history *h, uint64_t now_ms, double rays_s,
                  double at_work);
/* Time has come this far, with or without notes. */
void history_advance(struct history *h, uint64_t now_ms);

/* The point that is `back` steps before the newest. */
const struct history_point *history_at(const struct history *h, unsigned back);

#endif
