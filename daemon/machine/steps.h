/* steps.h - states, their names, and which may follow which
 *
 * An enum of states from 0 on has one of these tables beside the drawing of its
 * states; a state is changed by steps_take() alone.
 * Thread: any. */
#ifndef DAEMON_STEPS_H
#define DAEMON_STEPS_H

#include <stdbool.h>

#define STEPS_STATES 8

struct steps {
    unsigned n; /* states */
    struct {
        const char *name;
        unsigned next; /* STEP() of each that may follow */
    } state[STEPS_STATES];
};
#define STEP(state) (1U << (state))

bool steps_permit(const struct steps *s, unsigned from, unsigned to);

/* Return state `to`; asserts that it is permitted after state `from`. */
unsigned steps_take(const struct steps *s, unsigned from, unsigned to);

#endif
