/* calcsame.c - equal calls are evaluated once for each ray
 *
 * Red, green and blue of a pattern often call the same function with the same
 * arguments, and so do the three slopes of a texture.  A call without
 * parameters in it depends on the ray alone, like a variable.  So its value is
 * kept like a variable's, until the next rad_calc_begin().  This is done for
 * expressions only: definitions are variables, which are kept themselves, or
 * functions with parameters.
 * Faults are the same as if it were called each time: a value is kept if the
 * call was sound, and used if nothing is wrong before it.  */
#include "config.h"

#include "scene/calc/calcimpl.h"

#include <string.h>

#define MOST_NODES 16 /* of a call whose value is kept */

/* The number of nodes of a tree; above MOST_NODES if its value depends on more
 * than the ray. */
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

/* Are the calls equal?  Recursion is limited by MOST_NODES. */
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
