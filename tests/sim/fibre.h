/* fibre.h - a function that can stop in the middle and go on later
 *
 * So a pass of the sampler can take virtual time, in which messages come.
 * Thread: one. */
#ifndef SIM_FIBRE_H
#define SIM_FIBRE_H

#include <stdbool.h>

struct fibre;

/* The fibre does not run yet.  NULL: memory is out. */
struct fibre *fibre_new(void (*fn)(void *arg), void *arg);

/* Only before the first fibre_run(), or when the fibre has ended. */
void fibre_free(struct fibre *f);

/* Run the fibre until it yields (true) or ends (false). */
bool fibre_run(struct fibre *f);

/* Called by the fibre itself: stop until the next fibre_run(). */
void fibre_yield(struct fibre *f);

#endif
