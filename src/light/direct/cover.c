/* cover.c - see cover.h */
#include "config.h"

#include "light/direct/cover.h"

#include <stdlib.h>
#include <string.h>

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

/* Sort the surfaces, and note those that are covered by their numbers. */
static void
mark(struct surface *v, int32_t n, bool *covered)
{
    qsort(v, (size_t)n, sizeof *v, by_place);
    for (int32_t i = 1; i < n; i++)
        covered[v[i].number] =
            v[i].o->type != RAD_SOURCE && compare(v[i].o, v[i - 1].o) == 0;
}

bool
rad_drop_covered(const struct rad_object *objects, void *list, int32_t *n,
                 size_t size, size_t at)
{
    struct surface *v = malloc((size_t)*n * sizeof *v + 1);
    bool *covered = calloc((size_t)*n + 1, sizeof *covered);
    char *from = list, *to = list, *end = from + (size_t)*n * size;
    bool done = v && covered;

    for (int32_t i = 0, obj; done && i < *n; i++) {
        memcpy(&obj, from + (size_t)i * size + at, sizeof obj);
        v[i] = (struct surface){ &objects[obj], i };
    }
    if (done)
        mark(v, *n, covered);
    for (const bool *c = covered; done && from < end; c++, from += size) {
        *n -= *c;
        memmove(to, from, size);
        to += *c ? 0 : size;
    }
    free(v);
    free(covered);
    return done;
}
