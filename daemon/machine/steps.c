/* steps.c - see steps.h */
#include "config.h"

#include "machine/steps.h"

#include <assert.h>

bool
steps_permit(const struct steps *s, unsigned from, unsigned to)
{
    return from < s->n && to < s->n &&
           (s->state[from].next & STEP(to)) != 0;
}

unsigned
steps_take(const struct steps *s, unsigned from, unsigned to)
{
    assert(steps_permit(s, from, to));
    return to;
}
