/* calcinline.c - calls of small standard functions, inlined
 *
 * and(), bound(), clip() and the like are a line each, and expressions are full
 * of them.  Each call would make a frame, with jumps to its arguments and its
 * body and back.  So a call is replaced by the body, with arguments for the
 * parameters, where values and faults stay the same.
 * An argument that is used once may be any expression, since it is evaluated
 * where it would have been.  One that is used more often must be cheap, and
 * must have no faults of its own; a variable in it shows a fault only when it
 * is first evaluated, as an argument does.  One that is not used disappears
 * with all its errors: red(1, nope, 1) is 1 in Radiance, too, which evaluates
 * an argument only when it is used. */
#include "config.h"

#include "scene/calc/calcimpl.h"

#define MOST_NODES 16 /* of a body that is inlined */
#define MOST_CHEAP 5  /* of an argument that may be evaluated twice */

/* The number of nodes of a body; above MOST_NODES if it cannot be inlined. */
static int
body_size(const struct node *n)
{
    int size = n->type == N_NAME || n->by_param ? MOST_NODES + 1 : 1;

    for (const struct node *kid = n->kid; kid && size <= MOST_NODES;
         kid = kid->next)
        size += body_size(kid);
    return size;
}

/* Does the node keep faults of its operands?  Library calls and powers drop
 * faults, so they must not be folded into numbers here. */
static bool
drops_no_fault(const struct node *n)
{
    return n->type == N_NEGATE || (n->type == N_BINARY && n->op != '^');
}

/* Copy a tree.  If arg is not NULL, parameters are replaced by the arguments
 * that begin there.  The nodes below an argument are shared, not copied, since
 * nobody changes a node that has a parent; otherwise each level of nested calls
 * would copy them again.  NULL: memory is out. */
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

/* The number of nodes of an argument; above MOST_CHEAP if it may not be
 * evaluated twice. */
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
