/* calcinline.c - calls of small functions that all files have, in place
 *
 * and(), bound(), clip() and their like are a line each, and expressions are
 * full of them: as calls, each is a frame, its arguments are pieces of code
 * with a way there and back, and so is its body.  In place of the call stands
 * its body with the arguments for the parameters, where that is the same in
 * value and faults:
 * an argument that is used once may be anything, for it is evaluated where it
 * would have been; one that is used more often must be cheap, and have no fault
 * of its own: a variable tells of one only when it is first evaluated, as an
 * argument does.  One that is not used at all is gone, as is whatever is wrong
 * with it: red(1, nope, 1) is 1 in Radiance, too, which evaluates no argument
 * before it is asked for. */
#include "config.h"

#include "scene/calc/calcimpl.h"

#define MOST_NODES 16 /* of a body */
#define MOST_CHEAP 4  /* of an argument that is evaluated again */

/* Nodes of a body; more than MOST_NODES where it is one to be called. */
static int
body_size(const struct node *n)
{
    int size = n->type == N_NAME || n->by_param ? MOST_NODES + 1 : 1;

    for (const struct node *kid = n->kid; kid && size <= MOST_NODES;
         kid = kid->next)
        size += body_size(kid);
    return size;
}

/* A call of a library function and a power drop what was wrong before them,
 * also where their value is always the same. */
static bool
drops_no_fault(const struct node *n)
{
    return n->type == N_NEGATE || (n->type == N_BINARY && n->op != '^');
}

/* Copy a tree; parameters are replaced by the arguments from `arg` on, if it is
 * not NULL.  What an argument is made of stays where it is, for nothing changes
 * nodes that have a parent; else calls in calls would copy it for each of them.
 * NULL: memory is out. */
static struct node *
copy(struct rad_calc *c, const struct node *n, const struct node *arg,
     struct rad_arena *arena)
{
    struct node *to = rad_arena_alloc(arena, sizeof *to), **tail;

    if (!to)
        return NULL;
    if (arg && n->type == N_PARAM) {
        for (int i = 0; i < n->ref; i++)
            arg = arg->next;
        *to = *arg;
        to->next = NULL;
        return to;
    }
    *to = *n;
    to->next = NULL;
    tail = &to->kid;
    for (const struct node *kid = n->kid; kid; kid = kid->next) {
        *tail = copy(c, kid, arg, arena);
        if (!*tail)
            return NULL;
        tail = &(*tail)->next;
    }
    if (arg && drops_no_fault(to))
        rad_calc_fold(c, to);
    return to;
}

struct node *
rad_calc_copy(struct rad_calc *c, const struct node *n)
{
    return copy(c, n, NULL, &c->arena);
}

const struct node *
rad_calc_keep(struct rad_calc *c, const struct node *body)
{
    return body_size(body) <= MOST_NODES ? copy(c, body, NULL, &c->arena)
                                         : NULL;
}

static int
uses(const struct node *n, int32_t param)
{
    int found = n->type == N_PARAM && n->ref == param;

    for (const struct node *kid = n->kid; kid; kid = kid->next)
        found += uses(kid, param);
    return found;
}

/* Nodes of an argument that may be evaluated again; more than MOST_CHEAP where
 * it may not. */
static int
cheap_size(const struct node *n)
{
    int size = 1;

    if (n->type == N_CALL ||
        (n->type == N_BINARY && n->op != '+' && n->op != '-' && n->op != '*'))
        return MOST_CHEAP + 1;
    for (const struct node *kid = n->kid; kid && size <= MOST_CHEAP;
         kid = kid->next)
        size += cheap_size(kid);
    return size;
}

struct node *
rad_calc_inlined(struct rad_calc *c, const struct node *call,
                 struct rad_arena *arena)
{
    const struct symbol *s = &c->symbol[call->ref];
    const struct node *arg = call->kid;

    if (call->by_param || s->kind != SYM_FUNCTION || !s->body ||
        call->nkids < s->nparams)
        return NULL;
    for (int32_t i = 0; i < s->nparams; i++, arg = arg->next)
        if (cheap_size(arg) > MOST_CHEAP && uses(s->body, i) > 1)
            return NULL;
    return copy(c, s->body, call->kid, arena);
}
