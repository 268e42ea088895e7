/* calceval.c - the machine that runs compiled functions
 *
 * Values lie on a stack.  A frame holds the arguments of a call: where their
 * code is, and the values of those that were needed.  What a piece of code
 * returns to lies on a third stack: an argument's value is kept in its frame,
 * a variable's until the next rad_calc_begin().  Nothing is allocated, and C's
 * own stack does not grow with the depth of calls. */
#include "config.h"

#include "scene/calcimpl.h"

#include <math.h>
#include <stdlib.h>

#define MAX_VALUES    (4 * RAD_MAX_CALC_DEPTH)
#define MAX_RETURNS   (4 * RAD_MAX_CALC_DEPTH)
#define LARGEST_WHOLE 16 /* power that is multiplied out */
#define MAX_KEPT      (8 * RAD_MAX_CALC_DEPTH) /* arguments of all frames */

struct frame {
    int32_t call;   /* the call's code */
    int32_t parent; /* frame that its arguments run in, -1: none */
    int32_t kept;   /* index of the first argument's value */
    uint32_t known; /* bit i: argument i has been evaluated */
};

enum { BACK_END, BACK_CALL, BACK_PARAM, BACK_VARIABLE };

struct back {
    int32_t pc;
    int32_t frame;
    int32_t what; /* parameter or symbol */
    int32_t kind; /* BACK_* */
};

struct rad_calc_env {
    struct rad_calc_input in;
    const double *call_value; /* of rad_calc_call() */
    struct prism_rays prism;
    uint64_t clock;
    struct known {
        uint64_t clock;
        double value;
    } * known; /* by symbol */
    int32_t nknown;
    int32_t nvalues, nframes, nbacks, nkept;
    double value[MAX_VALUES];
    struct frame frame[RAD_MAX_CALC_DEPTH];
    struct back back[MAX_RETURNS];
    double kept[MAX_KEPT];
};

struct machine {
    const struct rad_calc *c;
    struct rad_calc_env *e;
    int32_t pc;
    int32_t frame; /* whose parameters are meant, -1: none */
    enum rad_calc_fault fault;
};

const char *
rad_calc_fault_text(enum rad_calc_fault fault)
{
    static const char *const text[] = {
        "no error",
        "domain or range error, or division by zero",
        "missing argument",
        "variable of the ray used in a constant",
        "function used as a variable, or variable as a function",
        "calls nested too deeply",
        "too many steps",
    };

    return text[fault];
}

struct rad_calc_env *
rad_calc_env_new(const struct rad_calc *c)
{
    struct rad_calc_env *e = malloc(sizeof *e);

    if (!e)
        return NULL;
    e->nknown = c->nsymbol;
    e->known = calloc((size_t)c->nsymbol + 1, sizeof *e->known);
    e->clock = 1;
    e->in = (struct rad_calc_input){ 0 };
    e->call_value = NULL;
    e->prism.clock = 0;
    if (e->known)
        return e;
    free(e);
    return NULL;
}

void
rad_calc_env_free(struct rad_calc_env *e)
{
    if (!e)
        return;
    free(e->known);
    free(e);
}

void
rad_calc_begin(struct rad_calc_env *e, const struct rad_calc_input *in)
{
    e->in = *in;
    e->clock++;
}

bool
rad_calc_is_begun(const struct rad_calc_env *e, const struct rad_calc_input *in)
{
    return e->in.channel == in->channel && e->in.args == in->args;
}

static void
push(struct machine *m, double v)
{
    if (m->e->nvalues == MAX_VALUES)
        m->fault = RAD_CALC_DEPTH;
    else
        m->e->value[m->e->nvalues++] = v;
}

/* Code never takes more than it put there. */
static double
pop(struct machine *m)
{
    return m->e->value[--m->e->nvalues];
}

/* Go on at pc in a frame, and come back to where it is now. */
static void
enter(struct machine *m, int32_t pc, int32_t frame, int kind, int32_t what)
{
    struct rad_calc_env *e = m->e;

    if (e->nbacks == MAX_RETURNS) {
        m->fault = RAD_CALC_DEPTH;
        return;
    }
    e->back[e->nbacks++] = (struct back){ m->pc, m->frame, what, kind };
    m->pc = pc;
    m->frame = frame;
}

static void
get_variable(struct machine *m, int32_t sym)
{
    const struct symbol *s = &m->c->symbol[sym];

    if (s->kind != SYM_VARIABLE)
        m->fault = RAD_CALC_NAME;
    else if (sym < m->e->nknown && m->e->known[sym].clock == m->e->clock)
        push(m, m->e->known[sym].value);
    else
        enter(m, s->code, -1, BACK_VARIABLE, sym);
}

/* Code of argument i of a frame, or -1. */
static int32_t
argument(const struct machine *m, const struct frame *f, int32_t i)
{
    const struct ins *call = &m->c->code[f->call];

    return i < call->n ? call[1 + i].a : -1;
}

static void
get_param(struct machine *m, int32_t i)
{
    struct frame *f;
    int32_t pc;

    if (m->frame < 0) {
        m->fault = RAD_CALC_NAME;
        return;
    }
    f = &m->e->frame[m->frame];
    pc = argument(m, f, i);
    if (pc < 0)
        m->fault = RAD_CALC_NO_ARG;
    else if (f->known >> i & 1)
        push(m, m->e->kept[f->kept + i]);
    else
        enter(m, pc, f->parent, BACK_PARAM, i);
}

/* The symbol that a parameter names: its argument is a bare name, or a bare
 * parameter of the frame before, and so on. */
static int32_t
named_function(struct machine *m, int32_t param)
{
    for (int32_t f = m->frame; f >= 0; f = m->e->frame[f].parent) {
        int32_t pc = argument(m, &m->e->frame[f], param);
        const struct ins *in = pc < 0 ? NULL : &m->c->code[pc];

        if (!in || in[1].op != OP_END)
            break;
        if (in->op == OP_VARIABLE)
            return in->a;
        if (in->op != OP_PARAM)
            break;
        param = in->a;
    }
    return -1;
}

/* Call symbol sym; m->pc is behind the call's instruction. */
static void
call(struct machine *m, int32_t sym)
{
    struct rad_calc_env *e = m->e;
    int32_t at = m->pc - 1, n = m->c->code[at].n;
    const struct symbol *s;

    if (sym < 0 || m->c->symbol[sym].code < 0 ||
        m->c->symbol[sym].kind == SYM_VARIABLE) {
        m->fault = RAD_CALC_NAME;
        return;
    }
    s = &m->c->symbol[sym];
    if (e->nframes == RAD_MAX_CALC_DEPTH || e->nkept + n > MAX_KEPT) {
        m->fault = RAD_CALC_DEPTH;
        return;
    }
    e->frame[e->nframes] = (struct frame){ at, m->frame, e->nkept, 0 };
    e->nkept += n;
    m->pc = m->c->code[at + 1 + n].a; /* of RESUME */
    enter(m, s->code, e->nframes++, BACK_CALL, 0);
}

/* A piece is done, its value is on the stack.  False: so is all. */
static bool
leave(struct machine *m)
{
    struct rad_calc_env *e = m->e;
    struct back b = e->back[--e->nbacks];
    double v = e->value[e->nvalues - 1];
    struct frame *f;

    m->pc = b.pc;
    m->frame = b.frame;
    switch (b.kind) {
    case BACK_CALL:
        e->nkept = e->frame[--e->nframes].kept;
        return true;
    case BACK_PARAM:
        f = &e->frame[b.frame];
        f->known |= UINT32_C(1) << b.what;
        e->kept[f->kept + b.what] = v;
        return true;
    case BACK_VARIABLE:
        if (b.what < e->nknown)
            e->known[b.what] = (struct known){ e->clock, v };
        return true;
    default:
        return false;
    }
}

static void
spoil(struct machine *m)
{
    m->e->value[m->e->nvalues - 1] = 0;
    if (m->fault == RAD_CALC_SOUND)
        m->fault = RAD_CALC_MATH;
}

/* Skies are full of small whole powers: a few products instead of a logarithm
 * and an exponential, as exact to some units in the last place. */
static double
power(double a, double b)
{
    int n = b >= -LARGEST_WHOLE && b <= LARGEST_WHOLE ? (int)b : 0;
    double product = 1;

    if (n == 0 || n != b)
        return pow(a, b);
    for (int k = n < 0 ? -n : n; k > 0; k >>= 1, a *= a)
        if (k & 1)
            product *= a;
    return n < 0 ? 1 / product : product;
}

static void
arithmetic(struct machine *m, enum op op)
{
    double b = pop(m), *a = &m->e->value[m->e->nvalues - 1];

    switch (op) {
    case OP_ADD:
        *a += b;
        break;
    case OP_SUBTRACT:
        *a -= b;
        break;
    case OP_MULTIPLY:
        *a *= b;
        break;
    case OP_DIVIDE:
        *a = b / *a;
        break;
    default:
        *a = power(*a, b);
    }
}

/* The stack's top says which: 0 how many there are, else that one. */
static void
choose(struct machine *m, const struct ins *in)
{
    double which = pop(m);

    if (!(which >= -.5 && which + .5 < in->n + 1.0)) {
        push(m, 0);
        spoil(m);
        m->pc = in->a;
    } else if ((int)(which + .5) == 0) {
        push(m, in->n);
        m->pc = in->a;
    } else {
        m->pc = m->c->code[m->pc + (int)(which + .5) - 1].a;
    }
}

static void
library(struct machine *m, const struct ins *in)
{
    struct rad_calc_env *e = m->e;
    double *v = &e->value[e->nvalues - in->n];

    v[0] = in->a == LIB_PRISM
               ? rad_calc_prism(v, &e->in, e->clock, &e->prism, &m->fault)
               : rad_calc_library_value(in->a, v, &e->in, &m->fault);
    e->nvalues -= in->n - 1;
}

static void
branch(struct machine *m, const struct ins *in)
{
    switch (in->op) {
    case OP_DIVISOR:
        if (m->e->value[m->e->nvalues - 1] != 0)
            return;
        spoil(m);
        break;
    case OP_UNLESS:
        if (pop(m) > 0)
            return;
        break;
    default:
        break;
    }
    m->pc = in->a;
}

/* One instruction but OP_END. */
static void
step(struct machine *m, const struct ins *in)
{
    struct rad_calc_env *e = m->e;

    switch ((enum op)in->op) {
    case OP_NUMBER:
        push(m, m->c->number[in->a]);
        break;
    case OP_CHANNEL:
        if (e->in.channel)
            push(m, e->in.channel[in->a]);
        else
            m->fault = RAD_CALC_NO_CHANNEL;
        break;
    case OP_VARIABLE:
        get_variable(m, in->a);
        break;
    case OP_PARAM:
        get_param(m, in->a);
        break;
    case OP_VALUE:
        if (e->call_value)
            push(m, e->call_value[in->a]);
        else
            m->fault = RAD_CALC_NO_ARG;
        break;
    case OP_NEGATE:
        e->value[e->nvalues - 1] = -e->value[e->nvalues - 1];
        break;
    case OP_CLEAR:
        m->fault = RAD_CALC_SOUND;
        break;
    case OP_CHECK:
        if (m->fault || !isfinite(e->value[e->nvalues - 1]))
            spoil(m);
        break;
    case OP_DIVISOR:
    case OP_UNLESS:
    case OP_JUMP:
        branch(m, in);
        break;
    case OP_SELECT:
        choose(m, in);
        break;
    case OP_LIBRARY:
        library(m, in);
        break;
    case OP_CALL:
        call(m, in->a);
        break;
    case OP_CALL_PARAM:
        call(m, named_function(m, in->a));
        break;
    default:
        arithmetic(m, (enum op)in->op);
    }
}

double
rad_calc_run(const struct rad_calc *c, int32_t pc, int32_t limit,
             struct rad_calc_env *e, enum rad_calc_fault *fault)
{
    struct machine m = { .c = c, .e = e, .pc = pc, .frame = -1 };

    e->nvalues = e->nframes = e->nbacks = e->nkept = 0;
    enter(&m, pc, -1, BACK_END, 0);
    for (int32_t steps = 0; m.fault <= RAD_CALC_MATH; steps++) {
        const struct ins *in = &c->code[m.pc++];

        if (in->op != OP_END) {
            step(&m, in);
        } else if (!leave(&m)) {
            *fault = m.fault;
            return e->value[0];
        }
        if (steps == limit)
            m.fault = RAD_CALC_STEPS;
    }
    *fault = m.fault;
    return 0;
}

double
rad_calc_eval(const struct rad_calc *c, int expression, struct rad_calc_env *e,
              enum rad_calc_fault *fault)
{
    return rad_calc_run(c, expression, RAD_MAX_CALC_STEPS, e, fault);
}

double
rad_calc_call(const struct rad_calc *c, int function, const double value[],
              struct rad_calc_env *e, enum rad_calc_fault *fault)
{
    double v;

    e->call_value = value;
    v = rad_calc_run(c, function, RAD_MAX_CALC_STEPS, e, fault);
    e->call_value = NULL;
    return v;
}
