/* cover.c - see cover.h */
#include "config.h"

#include "light/direct/cover.h"

#include <stdlib.h>

/* A surface, to be sorted by place. */
struct surface {
    const struct rad_object *o;
    int32_t number;
};

/* Less than, equal to or greater than 0, as a's place is before b's, the same or
 * behind it.  By value: -0 is 0. */
static int
compare(const struct rad_object *a, const struct rad_object *b)
{
    if (a->type != b->type)
        return a->type < b->type ? -1 : 1;
    if (a->nreals != b->nreals)
        return a->nreals < b->nreals ? -1 : 1;
    for (int32_t i = 0; i < a->nreals; i++)
        if (a->reals[i] != b->reals[i])
            return a->reals[i] < b->reals[i] ? -1 : 1;
    return 0;
}

/* Surfaces of one place lie together, and the first is the surface that rays
 * see. */
static int
by_place(const void *p, const void *q)
{
    const struct surface *a = p, *b = q;
    int way = compare(a->o, b->o);

    if (way != 0)
        return way;
    if (a->o->modifier != b->o->modifier)
        return a->o->modifier > b->o->modifier ? -1 : 1;
    return a->o > b->o ? -1 : 1;
}

bool
rad_covered(const struct rad_object *objects, const int32_t *obj, int32_t n,
            bool *covered)
{
    struct surface *list = malloc((size_t)n * sizeof *list + 1);

    if (!list)
        return false;
    for (int32_t i = 0; i < n; i++)
        list[i] = (struct surface){ &objects[obj[i]], i };
    qsort(list, (size_t)n, sizeof *list, by_place);
    for (int32_t i = 0; i < n; i++)
        covered[list[i].number] = i > 0 && list[i].o->type != RAD_SOURCE &&
                                  compare(list[i].o, list[i - 1].o) == 0;
    free(list);
    return true;
}
