/* calceval.c - the machine that runs compiled functions
 *
 * Values are on a stack.  A frame holds the arguments of a call: where their
 * code is, and the values of those that have been used.  A third stack holds
 * the places to return to.  An argument's value is kept in its frame, a
 * variable's until the next rad_calc_begin().  Nothing is allocated, and C's
 * stack does not grow with the depth of calls. */
#include "config.h"

#include "scene/calc/calcimpl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "arith/elementary.h"

#define MAX_VALUES    (4 * RAD_MAX_CALC_DEPTH)
#define MAX_RETURNS   (4 * RAD_MAX_CALC_DEPTH)
#define LARGEST_WHOLE 16 /* largest power computed by multiplying */
#define MAX_KEPT      (8 * RAD_MAX_CALC_DEPTH) /* arguments of all frames */

struct frame {
    const struct ins *call; /* the call's code */
    struct frame *parent;   /* in which its arguments are evaluated, or NULL */
    double *kept;           /* the values of its arguments */
    uint32_t known;         /* bit i: argument i has been evaluated */
};

enum { BACK_END, BACK_CALL, BACK_PARAM, BACK_VARIABLE };

struct back {
    const struct ins *at;
    struct frame *frame;
    int32_t what; /* parameter or symbol that gets the value */
    int32_t kind; /* BACK_* */
};

struct rad_calc_env {
    struct rad_calc_input in;
    const double *call_value;   /* arguments of rad_calc_call() */
    enum rad_calc_fault before; /* with which the next evaluation begins */
    struct prism_rays prism;
    uint64_t clock;
    struct value {
        uint64_t clock;
        double value;
    } * known;                             /* by symbol */
    struct value same[RAD_CALC_MOST_SAME]; /* by class of equal calls */
    int32_t nknown;
    int32_t nframes, nkept;
    double value[MAX_VALUES];
    struct frame frame[RAD_MAX_CALC_DEPTH];
    struct back back[MAX_RETURNS];
    double kept[MAX_KEPT];
};

/* State of a run.  It is local to rad_calc_run(), and all functions that use it
 * are inlined, so that it can stay in registers. */
struct machine {
    const struct rad_calc *c;
    struct rad_calc_env *e;
    double *top;          /* after the last value */
    const struct ins *at; /* the next instruction */
    struct back *back;    /* after the last place to return to */
    struct frame *frame;  /* whose parameters OP_PARAM reads, or NULL */
    enum rad_calc_fault fault;
};

/* The next instruction after a fault that ends the run. */
static const struct ins halt = { OP_HALT, 0, 0 };

#define PART static inline __attribute__((always_inline))

struct rad_calc_env *
rad_calc_env_new(const struct rad_calc *c)
{
    struct rad_calc_env *e = malloc(sizeof *e);

    if (!e)
        return NULL;
    e->nknown = c->nsymbol;
    e->known = calloc((size_t)c->nsymbol + 1, sizeof *e->known);
    e->clock = 1;
    memset(e->same, 0, sizeof e->same);
    e->in = (struct rad_calc_input){ 0 };
    e->call_value = NULL;
    e->before = RAD_CALC_SOUND;
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

PART void
stop(struct machine *m, enum rad_calc_fault fault)
{
    m->fault = fault;
    m->at = &halt;
}

PART void
push(struct machine *m, double v)
{
    if (m->top == m->e->value + MAX_VALUES)
        stop(m, RAD_CALC_DEPTH);
    else
        *m->top++ = v;
}

/* Code never pops more than it pushed. */
PART double
pop(struct machine *m)
{
    return *--m->top;
}

/* Run the code at pc in a frame, and then return to here. */
PART void
enter(struct machine *m, int32_t pc, struct frame *frame, int kind,
      int32_t what)
{
    if (m->back == m->e->back + MAX_RETURNS) {
        stop(m, RAD_CALC_DEPTH);
        return;
    }
    *m->back++ = (struct back){ m->at, m->frame, what, kind };
    m->at = &m->c->code[pc];
    m->frame = frame;
}

PART void
push_channel(struct machine *m, int32_t i)
{
    if (m->e->in.channel)
        push(m, m->e->in.channel[i]);
    else
        stop(m, RAD_CALC_NO_CHANNEL);
}

PART void
push_value(struct machine *m, int32_t i)
{
    if (m->e->call_value)
        push(m, m->e->call_value[i]);
    else
        stop(m, RAD_CALC_NO_ARG);
}

/* Push arg(n), with the effects of OP_CLEAR and OP_CHECK; false: these would
 * find a fault. */
PART bool
get_real(struct machine *m, int32_t n)
{
    const struct rad_calc_input *in = &m->e->in;

    if (!in->args || n > in->nargs || !isfinite(in->args[n - 1]))
        return false;
    m->fault = RAD_CALC_SOUND;
    push(m, in->args[n - 1]);
    return true;
}

/* Keep a variable's value: it is evaluated once. */
PART void
keep(struct machine *m, int32_t sym, double v)
{
    if (sym < m->e->nknown)
        m->e->known[sym] = (struct value){ m->e->clock, v };
}

/* Most variables are another name of a channel or a real argument, and need no
 * code to be run. */
PART void
get_variable(struct machine *m, int32_t sym)
{
    const struct symbol *s = &m->c->symbol[sym];

    if (sym < m->e->nknown && m->e->known[sym].clock == m->e->clock)
        push(m, m->e->known[sym].value);
    else if (s->channel >= 0)
        push_channel(m, s->channel);
    else if (s->real > 0 && get_real(m, s->real))
        keep(m, sym, m->e->in.args[s->real - 1]);
    else if (s->kind == SYM_VARIABLE)
        enter(m, s->code, NULL, BACK_VARIABLE, sym);
    else
        stop(m, RAD_CALC_NAME);
}

/* Use the value of an equal call, if it was sound and nothing is wrong now. */
PART void
get_shared(struct machine *m, const struct ins *in)
{
    const struct value *v = &m->e->same[in->a];

    if (v->clock == m->e->clock && m->fault == RAD_CALC_SOUND) {
        m->at = m->c->code + in[1].a;
        push(m, v->value); /* the last: it may end the run */
    } else {
        m->at = in + 2;
    }
}

/* arg(n) has faults as the call that follows finds them. */
PART void
get_own_real(struct machine *m, const struct ins *in)
{
    m->at = m->c->code + in[1].a;
    if (!get_real(m, in->a))
        m->at = in + 2;
}

PART void
share(struct machine *m, int32_t i)
{
    if (m->fault == RAD_CALC_SOUND)
        m->e->same[i] = (struct value){ m->e->clock, m->top[-1] };
}

/* The code of argument i of a frame, or -1. */
PART int32_t
argument(const struct frame *f, int32_t i)
{
    return i < f->call->n ? f->call[1 + i].a : -1;
}

/* Push argument i of f if it is a single number, channel, value or parameter,
 * which needs no code to be run and no value kept; false: it is more. */
PART bool
get_plain(struct machine *m, const struct frame *f, int32_t i)
{
    for (;;) {
        int32_t pc = argument(f, i);
        const struct ins *in = &m->c->code[pc < 0 ? 0 : pc];

        if (pc < 0 || in[1].op != OP_END)
            return false;
        if (in->op == OP_NUMBER) {
            push(m, m->c->number[in->a]);
            return true;
        }
        if (in->op == OP_CHANNEL) {
            push_channel(m, in->a);
            return true;
        }
        if (in->op == OP_VALUE) {
            push_value(m, in->a);
            return true;
        }
        if (in->op != OP_PARAM || !f->parent)
            return false;
        f = f->parent;
        i = in->a;
        if (f->known >> i & 1) {
            push(m, f->kept[i]);
            return true;
        }
    }
}

PART void
get_param(struct machine *m, int32_t i)
{
    struct frame *f = m->frame;
    int32_t pc;

    if (!f) {
        stop(m, RAD_CALC_NAME);
        return;
    }
    if (f->known >> i & 1) {
        push(m, f->kept[i]);
        return;
    }
    if (get_plain(m, f, i))
        return;
    pc = argument(f, i);
    if (pc < 0)
        stop(m, RAD_CALC_NO_ARG);
    else
        enter(m, pc, f->parent, BACK_PARAM, i);
}

/* The symbol of the function that a parameter names: its argument is a bare
 * name, or a bare parameter of the parent frame, and so on. */
PART int32_t
named_function(const struct machine *m, int32_t param)
{
    for (const struct frame *f = m->frame; f; f = f->parent) {
        int32_t pc = argument(f, param);
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

/* Call symbol sym, of any kind but a variable. */
PART void
call(struct machine *m, const struct ins *in, int32_t sym)
{
    struct rad_calc_env *e = m->e;
    int32_t n = in->n;
    const struct symbol *s;
    struct frame *f;

    if (sym < 0 || m->c->symbol[sym].code < 0 ||
        m->c->symbol[sym].kind == SYM_VARIABLE) {
        stop(m, RAD_CALC_NAME);
        return;
    }
    s = &m->c->symbol[sym];
    if (e->nframes == RAD_MAX_CALC_DEPTH || e->nkept + n > MAX_KEPT) {
        stop(m, RAD_CALC_DEPTH);
        return;
    }
    f = &e->frame[e->nframes++];
    *f = (struct frame){ in, m->frame, e->kept + e->nkept, 0 };
    e->nkept += n;
    m->at = m->c->code + in[1 + n].a; /* of RESUME */
    enter(m, s->code, f, BACK_CALL, 0);
}

/* Return from code whose value is on the stack.  False: the run ends. */
PART bool
leave(struct machine *m)
{
    struct rad_calc_env *e = m->e;
    const struct back *b = --m->back;
    double v = m->top[-1];

    m->at = b->at;
    m->frame = b->frame;
    switch (b->kind) {
    case BACK_CALL:
        e->nkept = (int32_t)(e->frame[--e->nframes].kept - e->kept);
        return true;
    case BACK_PARAM:
        b->frame->known |= UINT32_C(1) << b->what;
        b->frame->kept[b->what] = v;
        return true;
    case BACK_VARIABLE:
        keep(m, b->what, v);
        return true;
    default:
        return false;
    }
}

PART void
spoil(struct machine *m)
{
    m->top[-1] = 0;
    if (m->fault == RAD_CALC_SOUND)
        m->fault = RAD_CALC_MATH;
}

/* Function files for skies have many small whole powers.  A few products are
 * faster than a logarithm and an exponential, and as exact, but for some units
 * in the last place. */
static double
power(double a, double b)
{
    int n = b >= -LARGEST_WHOLE && b <= LARGEST_WHOLE ? (int)b : 0;
    double product = 1;

    if (n == 0 || n != b)
        return rad_pow(a, b);
    for (int k = n < 0 ? -n : n; k > 0; k >>= 1, a *= a)
        if (k & 1)
            product *= a;
    return n < 0 ? 1 / product : product;
}

/* select(): the stack's top is the choice; 0 asks for the number of choices. */
PART void
choose(struct machine *m, const struct ins *in)
{
    double which = pop(m);

    if (!(which >= -.5 && which + .5 < in->n + 1.0)) {
        push(m, 0);
        spoil(m);
        m->at = m->c->code + in->a;
    } else if ((int)(which + .5) == 0) {
        push(m, in->n);
        m->at = m->c->code + in->a;
    } else {
        m->at = m->c->code + in[(int)(which + .5)].a;
    }
}

PART void
library(struct machine *m, const struct ins *in)
{
    struct rad_calc_env *e = m->e;
    enum rad_calc_fault fault = m->fault; /* a copy: taking m's address would
                                           * keep it out of registers */
    double *v = m->top - in->n;

    v[0] = in->a == LIB_PRISM
               ? rad_calc_prism(v, &e->in, e->clock, &e->prism, &fault)
               : rad_calc_library_value(in->a, v, &e->in, &fault);
    m->top = v + 1;
    if (fault > RAD_CALC_MATH)
        stop(m, fault);
    else
        m->fault = fault;
}

/* Replace the top two values by one. */
#define TWO(m, op) ((m)->top--, (m)->top[-1] op(m)->top[0])
/* Replace the top value by its result with the instruction's number. */
#define ONE(m, op) ((m)->top[-1] op(m)->c->number[in->a])

/* Run an instruction that may change what is next; false: the run ends. */
PART bool
go_on(struct machine *m, const struct ins *in, enum op op)
{
    switch (op) {
    case OP_DIVISOR:
        if (m->top[-1] != 0)
            break;
        spoil(m);
        m->at = m->c->code + in->a;
        break;
    case OP_UNLESS:
        if (!(pop(m) > 0))
            m->at = m->c->code + in->a;
        break;
    case OP_JUMP:
        m->at = m->c->code + in->a;
        break;
    case OP_SELECT:
        choose(m, in);
        break;
    case OP_LIBRARY:
        library(m, in);
        break;
    case OP_CALL:
    case OP_CALL_PARAM:
        call(m, in, op == OP_CALL ? in->a : named_function(m, in->a));
        break;
    case OP_SHARED:
        get_shared(m, in);
        break;
    case OP_SHARE:
        share(m, in->a);
        break;
    case OP_REAL:
        get_own_real(m, in);
        break;
    case OP_END:
        return leave(m);
    default: /* OP_HALT; ARG_AT and RESUME are data of calls, and are not run */
        return false;
    }
    return true;
}

/* Run one instruction, whose op is known when this is compiled; false: the run
 * ends. */
PART bool
step(struct machine *m, const struct ins *in, enum op op)
{
    switch (op) {
    case OP_NUMBER:
        push(m, m->c->number[in->a]);
        break;
    case OP_CHANNEL:
        push_channel(m, in->a);
        break;
    case OP_VARIABLE:
        get_variable(m, in->a);
        break;
    case OP_PARAM:
        get_param(m, in->a);
        break;
    case OP_VALUE:
        push_value(m, in->a);
        break;
    case OP_NEGATE:
        m->top[-1] = -m->top[-1];
        break;
    case OP_ADD:
        TWO(m, +=);
        break;
    case OP_SUBTRACT:
        TWO(m, -=);
        break;
    case OP_MULTIPLY:
        TWO(m, *=);
        break;
    case OP_ADD_NUMBER:
        ONE(m, +=);
        break;
    case OP_SUBTRACT_NUMBER:
        ONE(m, -=);
        break;
    case OP_MULTIPLY_NUMBER:
        ONE(m, *=);
        break;
    case OP_DIVIDE:
        m->top--;
        m->top[-1] = m->top[0] / m->top[-1];
        break;
    case OP_POWER:
        m->top--;
        m->top[-1] = power(m->top[0], m->top[-1]);
        break;
    case OP_CLEAR:
        m->fault = RAD_CALC_SOUND;
        break;
    case OP_CHECK:
        if (m->fault || !isfinite(m->top[-1]))
            spoil(m);
        break;
    default:
        return go_on(m, in, op);
    }
    return true;
}

/* All instructions that are run. */
#define EACH_OP(DO)                                                            \
    DO(END)                                                                    \
    DO(NUMBER)                                                                 \
    DO(CHANNEL)                                                                \
    DO(VARIABLE)                                                               \
    DO(PARAM)                                                                  \
    DO(VALUE)                                                                  \
    DO(NEGATE)                                                                 \
    DO(ADD)                                                                    \
    DO(SUBTRACT)                                                               \
    DO(MULTIPLY)                                                               \
    DO(ADD_NUMBER)                                                             \
    DO(SUBTRACT_NUMBER)                                                        \
    DO(MULTIPLY_NUMBER)                                                        \
    DO(DIVISOR)                                                                \
    DO(DIVIDE)                                                                 \
    DO(POWER)                                                                  \
    DO(CLEAR)                                                                  \
    DO(CHECK)                                                                  \
    DO(UNLESS)                                                                 \
    DO(JUMP)                                                                   \
    DO(SELECT)                                                                 \
    DO(LIBRARY)                                                                \
    DO(CALL)                                                                   \
    DO(CALL_PARAM)                                                             \
    DO(SHARED)                                                                 \
    DO(SHARE)                                                                  \
    DO(REAL)                                                                   \
    DO(HALT)

#define ONE_OP(op) +1
/* OP_ARG_AT and OP_RESUME are words behind other instructions. */
_Static_assert(0 EACH_OP(ONE_OP) == OP_HALT + 1 - 2,
               "an instruction without a label");

#define LABEL(op) [OP_##op] = &&do_##op,
/* Each instruction goes to the next one by a jump of its own: that is fewer
 * instructions than a loop about a switch, and the jumps can be predicted. */
#define NEXT()                                                                 \
    do {                                                                       \
        if (--left < 0)                                                        \
            goto too_long;                                                     \
        in = m.at++;                                                           \
        goto *does[in->op];                                                    \
    } while (0)
#define DO_OP(op)                                                              \
    do_##op : if (!step(&m, in, OP_##op)) goto done;                           \
    NEXT();

double
rad_calc_run(const struct rad_calc *c, int32_t pc, int32_t limit,
             struct rad_calc_env *e, enum rad_calc_fault *fault)
{
    static const void *const does[] = { EACH_OP(LABEL) };
    struct machine m = {
        .c = c, .e = e, .top = e->value, .back = e->back, .fault = e->before
    };
    int32_t left = limit + 1;
    const struct ins *in;

    e->before = RAD_CALC_SOUND;
    e->nframes = e->nkept = 0;
    enter(&m, pc, NULL, BACK_END, 0);
    NEXT();
    /* clang-format off */
    EACH_OP(DO_OP)
too_long:
    /* clang-format on */
    m.fault = RAD_CALC_STEPS;
done:
    *fault = m.fault;
    return m.fault > RAD_CALC_MATH ? 0 : e->value[0];
}

void
rad_calc_go_on(struct rad_calc_env *e, enum rad_calc_fault fault)
{
    e->before = fault;
}

double
rad_calc_eval(const struct rad_calc *c, int expression, struct rad_calc_env *e,
              enum rad_calc_fault *fault)
{
    return rad_calc_run(c, expression, RAD_MAX_CALC_STEPS, e, fault);
}

/* Is this code max(value, 0), as that of red(), green() and blue() is? */
static bool
is_noneg(const struct rad_calc *c, const struct ins *in)
{
    return in[0].op == OP_CLEAR && in[1].op == OP_VALUE &&
           in[2].op == OP_NUMBER && c->number[in[2].a] == 0 &&
           in[3].op == OP_LIBRARY && in[3].a == LIB_MAX &&
           in[4].op == OP_CHECK && in[5].op == OP_END;
}

/* The same without the machine, which takes ten times as long to start. */
static double
noneg(double v, struct rad_calc_env *e, enum rad_calc_fault *fault)
{
    v = v < 0 ? 0 : v;
    e->before = RAD_CALC_SOUND;
    *fault = isfinite(v) ? RAD_CALC_SOUND : RAD_CALC_MATH;
    return isfinite(v) ? v : 0;
}

double
rad_calc_call(const struct rad_calc *c, int function, const double value[],
              struct rad_calc_env *e, enum rad_calc_fault *fault)
{
    const struct ins *code = &c->code[function];
    double v;

    if (is_noneg(c, code))
        return noneg(value[code[1].a], e, fault);
    e->call_value = value;
    v = rad_calc_run(c, function, RAD_MAX_CALC_STEPS, e, fault);
    e->call_value = NULL;
    return v;
}
