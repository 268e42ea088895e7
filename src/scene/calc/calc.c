/* calc.c - programs of functions: the code of definitions */
#include "config.h"

#include "scene/calc/calcimpl.h"
#include "base/list.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_FOLDING 10000 /* steps to find a constant's value */

static int
no_memory(struct rad_error *err)
{
    return rad_fail(err, RAD_ENOMEM, "out of memory for functions");
}

struct emitter {
    struct rad_calc *c;
    struct rad_error *err;
    int rc;
    bool shares; /* calls share their values with equal calls */
};

/* Append an instruction; returns its index, or 0 after a failure, which is in
 * m->rc. */
static int32_t
put(struct emitter *m, enum op op, int n, int32_t a)
{
    struct rad_calc *c = m->c;

    if (m->rc)
        return 0;
    if (c->ncode >= RAD_MAX_CALC_CODE)
        m->rc = rad_fail(m->err, RAD_EDATA, "functions too long");
    else if (!rad_list_grow(&c->code, (size_t)c->ncode, sizeof *c->code))
        m->rc = no_memory(m->err);
    if (m->rc)
        return 0;
    c->code[c->ncode] = (struct ins){ (uint16_t)op, (uint16_t)n, a };
    return c->ncode++;
}

/* Let the instruction at pc point to the next one to be put. */
static void
land(struct emitter *m, int32_t pc)
{
    if (!m->rc)
        m->c->code[pc].a = m->c->ncode;
}

static void
put_number(struct emitter *m, enum op op, double v)
{
    struct rad_calc *c = m->c;

    if (m->rc)
        return;
    if (!rad_list_grow(&c->number, (size_t)c->nnumber, sizeof v)) {
        m->rc = no_memory(m->err);
        return;
    }
    c->number[c->nnumber] = v;
    put(m, op, 0, c->nnumber++);
}

static void put_node(struct emitter *m, const struct node *n);

static void
put_if(struct emitter *m, const struct node *cond)
{
    const struct node *yes = cond->next, *no = yes->next;
    int32_t unless, jump;

    put_node(m, cond);
    unless = put(m, OP_UNLESS, 0, 0);
    put_node(m, yes);
    jump = put(m, OP_JUMP, 0, 0);
    land(m, unless);
    put_node(m, no);
    land(m, jump);
}

/* The jumps at the ends of the choices are chained until the end is known. */
static void
put_select(struct emitter *m, const struct node *which, int n)
{
    const struct node *kid = which->next;
    int32_t select, last = -1;

    put_node(m, which);
    select = put(m, OP_SELECT, n, 0);
    for (int i = 0; i < n; i++)
        put(m, OP_ARG_AT, 0, 0);
    for (int i = 0; i < n && !m->rc; i++, kid = kid->next) {
        land(m, select + 1 + i);
        put_node(m, kid);
        last = put(m, OP_JUMP, 0, last);
    }
    while (!m->rc && last >= 0) {
        int32_t before = m->c->code[last].a;

        land(m, last);
        last = before;
    }
    land(m, select);
}

/* Evaluate the first argument, then the others from the last one down, so that
 * the same faults are dropped as in Radiance. */
static void
put_extreme(struct emitter *m, int id, const struct node *call)
{
    put_node(m, call->kid);
    for (int i = call->nkids - 1; i > 0; i--) {
        const struct node *kid = call->kid;

        for (int k = 0; k < i; k++)
            kid = kid->next;
        put_node(m, kid);
        put(m, OP_LIBRARY, 2, id);
    }
}

int32_t
rad_calc_real(const struct rad_calc *c, const struct node *n)
{
    const struct node *which = n->kid;

    if (n->type != N_CALL || n->by_param ||
        c->symbol[n->ref].kind != SYM_LIBRARY ||
        c->symbol[n->ref].library != LIB_ARG || which->type != N_NUMBER ||
        !(which->number >= 1 && which->number <= INT16_MAX) ||
        which->number != (int32_t)which->number)
        return 0;
    return (int32_t)which->number;
}

static void
put_library(struct emitter *m, int id, const struct node *call)
{
    const struct library *lib = &rad_calc_library[id];
    const struct node *kid = call->kid;
    int32_t real, resume = -1;

    if (call->nkids < lib->nargs) {
        m->rc = rad_fail(m->err, RAD_EDATA, "too few arguments for %s()",
                         lib->name);
        return;
    }
    real = rad_calc_real(m->c, call);
    if (real > 0) {
        put(m, OP_REAL, 0, real);
        resume = put(m, OP_RESUME, 0, 0);
    }
    put(m, OP_CLEAR, 0, 0);
    switch (id) {
    case LIB_IF:
        put_if(m, kid);
        break;
    case LIB_SELECT:
        put_select(m, kid, call->nkids - 1);
        break;
    case LIB_MIN:
    case LIB_MAX:
        put_extreme(m, id, call);
        break;
    case LIB_ATAN2: /* see put_binary() */
        put_node(m, kid->next);
        put_node(m, kid);
        put(m, OP_LIBRARY, 2, id);
        break;
    default: /* further arguments are not evaluated */
        for (int i = 0; i < lib->nargs; i++, kid = kid->next)
            put_node(m, kid);
        put(m, OP_LIBRARY, lib->nargs, id);
    }
    put(m, OP_CHECK, 0, 0);
    if (resume >= 0)
        land(m, resume);
}

static void
put_call_itself(struct emitter *m, const struct node *call)
{
    int32_t at;

    if (call->nkids > RAD_MAX_CALC_ARGS) {
        m->rc = rad_fail(m->err, RAD_EDATA, "call with too many arguments");
        return;
    }
    at = put(m, call->by_param ? OP_CALL_PARAM : OP_CALL, call->nkids,
             call->ref);
    for (int i = 0; i <= call->nkids; i++)
        put(m, i < call->nkids ? OP_ARG_AT : OP_RESUME, 0, 0);
    for (const struct node *kid = call->kid; kid; kid = kid->next) {
        land(m, ++at);
        put_node(m, kid);
        put(m, OP_END, 0, 0);
    }
    land(m, at + 1);
}

static void
put_call(struct emitter *m, const struct node *call)
{
    const struct symbol *s = call->by_param ? NULL : &m->c->symbol[call->ref];
    int32_t same, resume;

    if (s && s->kind == SYM_LIBRARY) {
        put_library(m, s->library, call);
        return;
    }
    same = m->shares ? rad_calc_same(m->c, call) : -1;
    if (same < 0) {
        put_call_itself(m, call);
        return;
    }
    put(m, OP_SHARED, 0, same);
    resume = put(m, OP_RESUME, 0, 0);
    put_call_itself(m, call);
    put(m, OP_SHARE, 0, same);
    land(m, resume);
}

/* A sum, difference or product with a number on one side; false: it is none. */
static bool
put_with_number(struct emitter *m, const struct node *n)
{
    const struct node *a = n->kid, *b = a->next;

    if (b->type != N_NUMBER && n->op != '-') {
        b = a;
        a = n->kid->next;
    }
    if (b->type != N_NUMBER || n->op == '^')
        return false;
    put_node(m, a);
    put_number(m,
               n->op == '+'   ? OP_ADD_NUMBER
               : n->op == '-' ? OP_SUBTRACT_NUMBER
                              : OP_MULTIPLY_NUMBER,
               b->number);
    return true;
}

/* The second value of a power, as of atan2(), is evaluated first, as in
 * Radiance's programs: library calls in the first value drop its faults. */
static void
put_binary(struct emitter *m, const struct node *n)
{
    const struct node *a = n->kid, *b = a->next;
    int32_t divisor;

    if (n->op == '/') { /* a dividend over 0 is not evaluated */
        put_node(m, b);
        divisor = put(m, OP_DIVISOR, 0, 0);
        put_node(m, a);
        put(m, OP_DIVIDE, 0, 0);
        land(m, divisor);
        return;
    }
    if (put_with_number(m, n))
        return;
    if (n->op == '^') {
        put(m, OP_CLEAR, 0, 0);
        put_node(m, b);
        put_node(m, a);
        put(m, OP_POWER, 0, 0);
        put(m, OP_CHECK, 0, 0);
        return;
    }
    put_node(m, a);
    put_node(m, b);
    put(m,
        n->op == '+'   ? OP_ADD
        : n->op == '-' ? OP_SUBTRACT
                       : OP_MULTIPLY,
        0, 0);
}

static void
put_node(struct emitter *m, const struct node *n)
{
    if (m->rc)
        return;
    switch (n->type) {
    case N_NUMBER:
        put_number(m, OP_NUMBER, n->number);
        break;
    case N_CHANNEL:
        put(m, OP_CHANNEL, 0, n->ref);
        break;
    case N_NAME:
        put(m, OP_VARIABLE, 0, n->ref);
        break;
    case N_PARAM:
        put(m, OP_PARAM, 0, n->ref);
        break;
    case N_VALUE:
        put(m, OP_VALUE, 0, n->ref);
        break;
    case N_NEGATE:
        put_node(m, n->kid);
        put(m, OP_NEGATE, 0, 0);
        break;
    case N_BINARY:
        put_binary(m, n);
        break;
    case N_CALL:
        put_call(m, n);
    }
}

static int32_t
emit(struct emitter *m, const struct node *n)
{
    int32_t start = m->c->ncode;

    put_node(m, n);
    put(m, OP_END, 0, 0);
    return m->rc ? m->rc : start;
}

int32_t
rad_calc_emit(struct rad_calc *c, const struct node *n, struct rad_error *err)
{
    struct emitter m = { .c = c, .err = err };

    return emit(&m, n);
}

int32_t
rad_calc_emit_shared(struct rad_calc *c, const struct node *n,
                     struct rad_error *err)
{
    struct emitter m = { .c = c, .err = err, .shares = true };

    return emit(&m, n);
}

/* Does a call of this symbol depend on nothing but its arguments? */
static bool
is_constant(const struct symbol *s)
{
    if (s->kind == SYM_LIBRARY)
        return rad_calc_library[s->library].constant;
    return s->kind == SYM_FUNCTION && s->constant;
}

/* Is the kid constant, so that its parent may be a number? */
static bool
is_settled(const struct rad_calc *c, const struct node *parent,
           const struct node *kid)
{
    if (kid->type == N_NAME && parent->type == N_CALL)
        return is_constant(&c->symbol[kid->ref]);
    return kid->type == N_NUMBER;
}

bool
rad_calc_reduce(struct rad_calc *c, const struct node *n, double *value)
{
    int32_t ncode = c->ncode, nnumber = c->nnumber;
    int32_t at = rad_calc_emit(c, n, NULL);
    enum rad_calc_fault fault = RAD_CALC_NAME;

    if (at >= 0)
        *value = rad_calc_run(c, at, MAX_FOLDING, c->env, &fault);
    c->ncode = ncode;
    c->nnumber = nnumber;
    return fault == RAD_CALC_SOUND && isfinite(*value);
}

void
rad_calc_fold(struct rad_calc *c, struct node *n)
{
    bool literal = true;
    double v;

    for (const struct node *kid = n->kid; kid; kid = kid->next) {
        if (!is_settled(c, n, kid))
            return;
        literal = literal && (kid->literal || kid->type == N_NAME);
    }
    if (n->type == N_CALL && (n->by_param || !is_constant(&c->symbol[n->ref])))
        return;
    if (rad_calc_reduce(c, n, &v))
        *n = (struct node){ .type = N_NUMBER, .number = v, .literal = literal };
}

/* Give a library function code, so that a parameter can stand for it. */
static int
make_callable(struct rad_calc *c, int id, struct rad_error *err)
{
    struct node param[RAD_MAX_CALC_ARGS], call = { .type = N_CALL };
    int32_t i = rad_calc_symbol(c, "", rad_calc_library[id].name, true, err);
    int32_t code;

    if (i < 0)
        return i;
    call.ref = i;
    call.nkids = rad_calc_library[id].nargs;
    call.kid = param;
    for (int k = 0; k < call.nkids; k++)
        param[k] =
            (struct node){ .type = N_PARAM,
                           .ref = k,
                           .next = k + 1 < call.nkids ? &param[k + 1] : NULL };
    code = rad_calc_emit(c, &call, err);
    c->symbol[i].code = rad_calc_library[id].variadic ? -1 : code;
    c->symbol[i].end = c->ncode;
    return code < 0 ? code : 0;
}

static int
begin(struct rad_calc *c, struct rad_error *err)
{
    int rc = 0, global;

    c->env = rad_calc_env_new(c);
    if (!c->env)
        return no_memory(err);
    for (int id = 0; id < rad_calc_nlibrary && rc == 0; id++)
        rc = make_callable(c, id, err);
    global = rc ? rc : rad_calc_context(c, ".", err);
    if (global < 0)
        return global;
    c->standard = true;
    rc = rad_calc_read(c, global, "(standard functions)", rad_calc_standard,
                       strlen(rad_calc_standard), err);
    c->standard = false;
    return rc;
}

struct rad_calc *
rad_calc_new(struct rad_error *err)
{
    struct rad_calc *c = calloc(1, sizeof *c);

    if (!c) {
        no_memory(err);
        return NULL;
    }
    rad_arena_init(&c->arena);
    if (begin(c, err) < 0) {
        rad_calc_free(c);
        return NULL;
    }
    return c;
}

void
rad_calc_free(struct rad_calc *c)
{
    if (!c)
        return;
    rad_calc_env_free(c->env);
    rad_arena_release(&c->arena);
    free(c->code);
    free(c->number);
    free(c->symbol);
    free(c->slot);
    free(c->context);
    free(c);
}

void
rad_calc_offer(struct rad_calc *c, unsigned offer)
{
    c->offer = offer;
}
