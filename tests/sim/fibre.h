/* fibre.h - a function that is left and gone on with later
 *
 * So that a pass of the sampler lies in virtual time, and messages come while
 * it is under way.
 * Thread: one. */
#ifndef SIM_FIBRE_H
#define SIM_FIBRE_H

#include <stdbool.h>

struct fibre;

/* Nothing runs yet.  NULL: memory is out. */
struct fibre *fibre_new(void (*fn)(void *arg), void *arg);

/* Only one that has not begun, or has come to its end. */
void fibre_free(struct fibre *f);

/* Go on until it yields (true) or ends (false). */
bool fibre_run(struct fibre *f);

/* From within. */
void fibre_yield(struct fibre *f);

#endif
