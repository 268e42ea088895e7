/* calcargs.c - what every evaluation of an expression needs
 *
 * Code is followed in the order in which the machine (calceval.c) runs it.
 * What the machine may leave out is skipped: both sides of if(), the choices of
 * select(), dividends, and arguments of functions until they are used.  So all
 * code that is passed is always evaluated. */
#include "config.h"

#include "scene/calc/calcimpl.h"

#include <stdlib.h>

#define MOST_STEPS 100000 /* the search ends after so many */
#define MOST_DEPTH 200    /* of nested calls and variables */

/* A call whose function is followed. */
struct frame {
    int32_t at; /* its code */
    const struct frame *parent;
};

struct search {
    const struct rad_calc *c;
    uint8_t *seen; /* by symbol: it is followed once */
    int32_t steps;
    int depth;
    struct rad_calc_need *need;
};

static void follow(struct search *s, int32_t pc, const struct frame *f);

static void
follow_symbol(struct search *s, int32_t sym, const struct frame *f)
{
    const struct symbol *to = &s->c->symbol[sym];

    if (s->seen[sym] || to->code < 0)
        return;
    s->seen[sym] = 1;
    follow(s, to->code, f);
}

/* An argument is evaluated in the frame of its call.  If the call does not have
 * it, note the function. */
static void
follow_param(struct search *s, int32_t i, const struct frame *f)
{
    const struct ins *call;

    if (!f)
        return;
    call = &s->c->code[f->at];
    if (i < call->n)
        follow(s, call[1 + i].a, f->parent);
    else if (!s->need->function && call->op == OP_CALL)
        s->need->function = s->c->symbol[call->a].name;
}

/* Note arg(n), if n is a number. */
static void
note_real(struct search *s, const struct ins *in)
{
    double which;

    if (in->a != LIB_ARG || in[-1].op != OP_NUMBER)
        return;
    which = s->c->number[in[-1].a] + .5;
    if (which >= s->need->reals + 1.0 && which < INT16_MAX)
        s->need->reals = (int)which;
}

/* Follow one instruction at pc; returns where to go on. */
static int32_t
pass(struct search *s, int32_t pc, const struct frame *f)
{
    const struct ins *code = s->c->code, *in = &code[pc];
    struct frame inner = { pc, f };

    switch (in->op) {
    case OP_VARIABLE:
        follow_symbol(s, in->a, NULL);
        break;
    case OP_PARAM:
        follow_param(s, in->a, f);
        break;
    case OP_LIBRARY:
        note_real(s, in);
        break;
    case OP_UNLESS: /* the jump behind both sides is before the second one */
        return code[in->a - 1].a;
    case OP_DIVISOR:
    case OP_JUMP:
    case OP_SELECT:
        return in->a;
    case OP_CALL:
        follow_symbol(s, in->a, &inner);
        return code[pc + 1 + in->n].a;
    case OP_CALL_PARAM:
        return code[pc + 1 + in->n].a;
    default:
        break;
    }
    return pc + 1;
}

static void
follow(struct search *s, int32_t pc, const struct frame *f)
{
    if (s->depth == MOST_DEPTH)
        return;
    s->depth++;
    while (s->c->code[pc].op != OP_END && s->steps++ < MOST_STEPS)
        pc = pass(s, pc, f);
    s->depth--;
}

void
rad_calc_needs(const struct rad_calc *c, int expression,
               struct rad_calc_need *need)
{
    struct search s = { .c = c, .need = need };

    *need = (struct rad_calc_need){ 0, NULL };
    s.seen = calloc((size_t)c->nsymbol + 1, 1);
    if (s.seen)
        follow(&s, expression, NULL);
    free(s.seen);
}
