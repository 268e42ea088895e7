/* calcsame.c - calls that are made more than once for a ray
 *
 * A pattern's red, green and blue call the same function of the same values, a
 * texture's three slopes do, and so on.  What such a call gives depends on what
 * the ray is alone, as a variable does, if there is no parameter in it; so its
 * value is kept as a variable's is, until the next rad_calc_begin().  Those of
 * expressions alone: a definition is a variable's, which is kept itself, or is
 * full of parameters.
 * Faults are as if it was called each time: a value is kept where the call was
 * sound, and serves where nothing was wrong before it.  */
#include "config.h"

#include "scene/calc/calcimpl.h"

#include <string.h>

#define MOST_NODES 16 /* of a call */

/* Nodes of a tree; more than MOST_NODES where its value is not the ray's. */
static int
size_of(const struct node *n)
{
    int size = n->type == N_PARAM || n->type == N_VALUE || n->by_param
                   ? MOST_NODES + 1
                   : 1;

    for (const struct node *kid = n->kid; kid && size <= MOST_NODES;
         kid = kid->next)
        size += size_of(kid);
    return size;
}

/* No tree is higher than MOST_NODES. */
static bool
is_same(const struct node *a, const struct node *b)
{
    const struct node *x = a->kid, *y = b->kid;

    if (a->type != b->type || a->ref != b->ref || a->nkids != b->nkids ||
        (a->type == N_NUMBER &&
         memcmp(&a->number, &b->number, sizeof a->number) != 0) ||
        (a->type == N_BINARY && a->op != b->op))
        return false;
    for (; x && y; x = x->next, y = y->next)
        if (!is_same(x, y))
            return false;
    return !x && !y;
}

int32_t
rad_calc_same(struct rad_calc *c, const struct node *call)
{
    if (size_of(call) > MOST_NODES)
        return -1;
    for (int32_t i = 0; i < c->nsame; i++)
        if (is_same(c->same[i], call))
            return i;
    if (c->nsame == RAD_CALC_MOST_SAME)
        return -1;
    c->same[c->nsame] = rad_calc_copy(c, call);
    return c->same[c->nsame] ? c->nsame++ : -1;
}
