/* calcparse.c - parsing definitions and expressions
 *
 *     file  = { [ name [ (param, ...) ] (= | :) sum ] ; }
 *     sum   = term { (+ | -) term }        term  = power { (* | /) power }
 *     power = sign [ ^ power ]             sign  = [ + | - ] atom
 *     atom  = (sum) | $n | number | name [ (sum, ...) ]
 * so -2^2 is 4 and 2^3^2 is 512.  Comments are in braces, which nest. */
#include "config.h"

#include "scene/calc/calcimpl.h"
#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_HEIGHT 4000 /* of an expression's tree: many terms in a row */
#define MAX_NAME   127  /* longer names are cut, as in Radiance */

struct parser {
    struct rad_calc *c;
    const char *context;
    const char *p, *end;
    int line; /* 0: an expression, without lines */
    int depth;
    const char *param[RAD_MAX_CALC_ARGS];
    int nparams;
    struct rad_arena arena; /* of nodes */
    struct rad_error *err;
    bool failed;
};

/* Report an error; returns NULL, for callers that make a node. */
static struct node *
fail(struct parser *ps, int code, const char *what)
{
    if (!ps->failed)
        rad_fail(ps->err, code, "%s", what);
    ps->failed = true;
    return NULL;
}

static struct node *
fail_at(struct parser *ps, const char *what)
{
    if (ps->failed)
        return NULL;
    ps->failed = true;
    if (ps->p >= ps->end)
        rad_fail(ps->err, RAD_EDATA, "%s, got the end", what);
    else
        rad_fail(ps->err, RAD_EDATA, "%s, got '%c'", what, *ps->p);
    return NULL;
}

/* The next byte, or 0 at the end. */
static int
peek(const struct parser *ps)
{
    return ps->p < ps->end && !ps->failed ? (unsigned char)*ps->p : 0;
}

static void
skip_blanks(struct parser *ps)
{
    int depth = 0;

    for (; ps->p < ps->end; ps->p++) {
        if (*ps->p == '\n' && ps->line)
            ps->line++;
        else if (*ps->p == '{')
            depth++;
        else if (*ps->p == '}' && depth)
            depth--;
        else if (depth == 0 && !isspace((unsigned char)*ps->p))
            return;
    }
    if (depth)
        fail(ps, RAD_EDATA, "comment without an end");
}

static bool
accept(struct parser *ps, int c)
{
    if (peek(ps) != c)
        return false;
    ps->p++;
    skip_blanks(ps);
    return true;
}

static void
expect(struct parser *ps, int c, const char *what)
{
    if (!accept(ps, c))
        fail_at(ps, what);
}

static bool
is_name_byte(int c)
{
    return isalnum(c) || c == '_' || c == '.' || c == '`';
}

static bool
at_name(const struct parser *ps)
{
    return isalpha(peek(ps)) || peek(ps) == '`';
}

static void
read_name(struct parser *ps, char name[MAX_NAME + 1])
{
    size_t n = 0;

    for (; is_name_byte(peek(ps)); ps->p++)
        if (n < MAX_NAME)
            name[n++] = *ps->p;
    name[n] = '\0';
    skip_blanks(ps);
}

static struct node *
new_node(struct parser *ps, int type)
{
    struct node *n;

    if (ps->failed)
        return NULL;
    n = rad_arena_calloc(&ps->arena, 1, sizeof *n);
    if (!n)
        return fail(ps, RAD_ENOMEM, "out of memory for a function");
    n->type = type;
    return n;
}

static struct node *sum(struct parser *ps);

static const char *
digits(const char *p, const char *end)
{
    while (p < end && isdigit((unsigned char)*p))
        p++;
    return p;
}

static struct node *
number(struct parser *ps)
{
    struct node *n = new_node(ps, N_NUMBER);
    const char *start = ps->p, *p = digits(start, ps->end), *e;
    char buf[512];

    if (p < ps->end && *p == '.')
        p = digits(p + 1, ps->end);
    if (p == start + 1 && *start == '.')
        return fail(ps, RAD_EDATA, "badly formed number");
    if (p < ps->end && (*p == 'e' || *p == 'E')) {
        e = p + 1;
        if (e < ps->end && (*e == '-' || *e == '+'))
            e++;
        p = digits(e, ps->end);
        if (p == e)
            return fail(ps, RAD_EDATA, "number lacks its exponent");
    }
    if ((size_t)(p - start) >= sizeof buf)
        return fail(ps, RAD_EDATA, "number of too many digits");
    memcpy(buf, start, (size_t)(p - start));
    buf[p - start] = '\0';
    ps->p = p;
    skip_blanks(ps);
    if (n) {
        n->number = strtod(buf, NULL); /* may be infinite, as in Radiance */
        n->literal = true;
    }
    return n;
}

static struct node *
channel(struct parser *ps)
{
    struct node *n = new_node(ps, N_CHANNEL);
    int which = 0;

    for (ps->p++; isdigit(peek(ps)); ps->p++)
        which = which < 1000 ? which * 10 + (*ps->p - '0') : which;
    skip_blanks(ps);
    if (which < 1 || which > (ps->c->standard ? (int)RAD_CALC_NCHANNELS
                                              : (int)RAD_CALC_NPUBLIC))
        return fail(ps, RAD_EDATA, "no such channel");
    if (n)
        n->ref = which - 1;
    return n;
}

static void
parse_arguments(struct parser *ps, struct node *call)
{
    struct node **tail = &call->kid;

    do {
        *tail = sum(ps);
        if (!*tail)
            return;
        if (call->height <= (*tail)->height)
            call->height = (*tail)->height + 1;
        tail = &(*tail)->next;
        if (++call->nkids > UINT16_MAX)
            fail(ps, RAD_EDATA, "call with too many arguments");
    } while (accept(ps, ','));
    expect(ps, ')', "expected ')'");
}

/* Replace a name by its value if it is a constant, or by its channel if it is a
 * standard variable for one. */
static void
inline_variable(const struct rad_calc *c, const struct symbol *s,
                struct node *n)
{
    const struct ins *code;

    if (s->kind != SYM_VARIABLE)
        return;
    code = &c->code[s->code];
    if (code[1].op != OP_END)
        return;
    if (s->constant && code->op == OP_NUMBER) {
        n->type = N_NUMBER;
        n->number = c->number[code->a];
        n->literal = true;
    } else if (code->op == OP_CHANNEL && code->a < RAD_CALC_NPUBLIC &&
               !strchr(s->name, '`')) {
        n->type = N_CHANNEL;
        n->ref = code->a;
    }
}

static void
resolve(struct parser *ps, struct node *n, const char *name)
{
    for (int i = 0; i < ps->nparams; i++)
        if (strcmp(ps->param[i], name) == 0) {
            n->type = N_PARAM;
            n->ref = i;
            return;
        }
    n->ref = rad_calc_symbol(ps->c, ps->context, name, false, ps->err);
    if (n->ref < 0) {
        ps->failed = true;
        return;
    }
    if (peek(ps) != '(')
        inline_variable(ps->c, &ps->c->symbol[n->ref], n);
}

/* A call, or the expression that it is inlined to. */
static struct node *
in_place(struct parser *ps, struct node *n)
{
    struct node *body =
        n->type == N_CALL ? rad_calc_inlined(ps->c, n, &ps->arena) : NULL;

    if (!body)
        return n;
    /* not counted as nesting, so that the functions in an expression do not
     * make it too deep: calls are limited themselves, and so are inlined
     * bodies */
    body->height = n->height;
    body->literal = false; /* in Radiance it is still a call */
    return body;
}

static struct node *
reference(struct parser *ps)
{
    struct node *n = new_node(ps, N_NAME);
    char name[MAX_NAME + 1];

    if (!n)
        return NULL;
    read_name(ps, name);
    resolve(ps, n, name);
    if (!accept(ps, '('))
        return ps->failed ? NULL : n;
    n->by_param = n->type == N_PARAM;
    n->type = N_CALL;
    parse_arguments(ps, n);
    if (ps->failed)
        return NULL;
    rad_calc_fold(ps->c, n);
    return in_place(ps, n);
}

static struct node *
atom(struct parser *ps)
{
    struct node *n;
    int c = peek(ps);

    if (++ps->depth > RAD_MAX_CALC_NESTING)
        return fail(ps, RAD_EDATA, "expression nested too deeply");
    if (accept(ps, '(')) {
        n = sum(ps);
        expect(ps, ')', "expected ')'");
    } else if (c == '$') {
        n = channel(ps);
    } else if (at_name(ps)) {
        n = reference(ps);
    } else if (isdigit(c) || c == '.') {
        n = number(ps);
    } else {
        n = fail_at(ps, "expected a value");
    }
    ps->depth--;
    return ps->failed ? NULL : n;
}

static struct node *
sign(struct parser *ps)
{
    struct node *n, *kid;

    if (!accept(ps, '-')) {
        accept(ps, '+');
        return atom(ps);
    }
    kid = atom(ps);
    n = new_node(ps, N_NEGATE);
    if (!kid || !n)
        return NULL;
    n->kid = kid;
    n->nkids = 1;
    n->height = kid->height + 1;
    rad_calc_fold(ps->c, n);
    return n;
}

static bool
is_literally(const struct node *n, double number)
{
    return n->literal && n->number == number;
}

/* The side that decides the value of a product, quotient or power, whatever the
 * other side is; NULL: none does.  Radiance sees this when it reads the
 * expression, and drops the other side with its faults, undefined names and
 * missing arguments. */
static struct node *
deciding_side(int op, struct node *a, struct node *b)
{
    if (a->literal && b->literal)
        return NULL;
    if (is_literally(a, 0) && strchr("*/^", op))
        return a;
    if (is_literally(b, 0) && op == '*')
        return b;
    if (op != '^')
        return NULL;
    if (is_literally(b, 0))
        b->number = 1;
    else if (is_literally(b, 1))
        return a;
    return is_literally(b, 1) ? b : is_literally(a, 1) ? a : NULL;
}

static struct node *
binary(struct parser *ps, int op, struct node *a, struct node *b)
{
    struct node *n = new_node(ps, N_BINARY), *alone;

    if (!n || !a || !b)
        return NULL;
    alone = deciding_side(op, a, b);
    if (alone)
        return alone;
    n->op = (char)op;
    n->height = 1 + (a->height > b->height ? a->height : b->height);
    if (n->height > MAX_HEIGHT)
        return fail(ps, RAD_EDATA, "expression of too many terms");
    n->kid = a;
    a->next = b;
    n->nkids = 2;
    rad_calc_fold(ps->c, n);
    return n;
}

static struct node *
power(struct parser *ps)
{
    struct node *n = sign(ps);

    if (peek(ps) != '^')
        return n;
    if (++ps->depth > RAD_MAX_CALC_NESTING)
        return fail(ps, RAD_EDATA, "expression nested too deeply");
    accept(ps, '^');
    n = binary(ps, '^', n, power(ps));
    ps->depth--;
    return n;
}

static struct node *
term(struct parser *ps)
{
    struct node *n = power(ps);
    int op;

    while ((op = peek(ps)) == '*' || op == '/') {
        accept(ps, op);
        n = binary(ps, op, n, power(ps));
    }
    return n;
}

static struct node *
sum(struct parser *ps)
{
    struct node *n = term(ps);
    int op;

    while ((op = peek(ps)) == '+' || op == '-') {
        accept(ps, op);
        n = binary(ps, op, n, term(ps));
    }
    return n;
}

static void
parse_params(struct parser *ps)
{
    char name[MAX_NAME + 1];

    do {
        if (!isalpha(peek(ps))) {
            fail_at(ps, "expected a parameter's name");
            return;
        }
        read_name(ps, name);
        if (strchr(name, '`')) {
            fail(ps, RAD_EDATA, "parameter's name holds '`'");
            return;
        }
        if (ps->nparams == RAD_MAX_CALC_ARGS) {
            fail(ps, RAD_EDATA, "function of too many parameters");
            return;
        }
        ps->param[ps->nparams] =
            rad_arena_strndup(&ps->arena, name, strlen(name));
        if (!ps->param[ps->nparams++]) {
            fail(ps, RAD_ENOMEM, "out of memory for a function");
            return;
        }
    } while (accept(ps, ','));
    expect(ps, ')', "expected ')'");
}

/* Let a name stand for this definition from now on. */
static void
define(struct parser *ps, const char *name, const char *file, int line,
       bool constant, const struct node *body)
{
    struct rad_calc *c = ps->c;
    int32_t code = rad_calc_emit(c, body, ps->err), i;

    i = code < 0 ? code : rad_calc_symbol(c, ps->context, name, true, ps->err);
    if (i < 0) {
        ps->failed = true;
        return;
    }
    c->symbol[i].kind = ps->nparams ? SYM_FUNCTION : SYM_VARIABLE;
    c->symbol[i].constant = constant;
    c->symbol[i].checked = 0;
    c->symbol[i].code = code;
    c->symbol[i].end = c->ncode;
    c->symbol[i].nparams = ps->nparams;
    c->symbol[i].channel =
        ps->nparams == 0 && body->type == N_CHANNEL ? body->ref : -1;
    c->symbol[i].real = ps->nparams ? 0 : rad_calc_real(c, body);
    c->symbol[i].body =
        c->standard && ps->nparams ? rad_calc_keep(c, body) : NULL;
    c->symbol[i].line = line;
    c->symbol[i].file = file;
}

static void
parse_definition(struct parser *ps, const char *file)
{
    char name[MAX_NAME + 1];
    struct node *body;
    int line = ps->line;
    bool constant;
    double value;

    if (!at_name(ps)) {
        fail_at(ps, "expected a name to define");
        return;
    }
    read_name(ps, name);
    ps->nparams = 0;
    if (accept(ps, '('))
        parse_params(ps);
    constant = accept(ps, ':');
    if (!constant)
        expect(ps, '=', "expected '=' or ':'");
    body = sum(ps);
    if (!body || ps->failed)
        return;
    if (peek(ps) && peek(ps) != ';') {
        fail_at(ps, "expected ';'");
        return;
    }
    if (constant && ps->nparams == 0 && rad_calc_reduce(ps->c, body, &value))
        *body = (struct node){ .type = N_NUMBER, .number = value };
    define(ps, name, file, line, constant, body);
}

int
rad_calc_read(struct rad_calc *c, int context, const char *name,
              const char *text, size_t len, struct rad_error *err)
{
    struct rad_error why = { 0 };
    struct parser ps = { .c = c,
                         .context = c->context[context].name,
                         .p = text + rad_text_mark(text, len),
                         .end = text + len,
                         .line = 1,
                         .err = &why };
    const char *file;

    if (len > RAD_MAX_CALC_FILE)
        return rad_fail(err, RAD_EDATA, "more than %d bytes of functions",
                        RAD_MAX_CALC_FILE);
    file = rad_arena_strndup(&c->arena, name, strlen(name));
    if (!file)
        return rad_fail(err, RAD_ENOMEM, "out of memory for functions");
    rad_calc_forget(c);
    rad_arena_init(&ps.arena);
    skip_blanks(&ps);
    while (!ps.failed && ps.p < ps.end) {
        struct rad_arena_mark mark = rad_arena_mark(&ps.arena);

        if (!accept(&ps, ';'))
            parse_definition(&ps, file);
        rad_arena_rewind(&ps.arena, mark);
    }
    rad_arena_release(&ps.arena);
    c->context[context].loaded = true;
    if (!ps.failed)
        return 0;
    rad_error_where(&why, "%s:%d", name, ps.line);
    rad_fail(err, why.code, "%s", why.what);
    rad_error_where(err, "%s", why.where);
    return why.code;
}

/* Is this variable in a group that is not on offer? */
static bool
is_missing(const struct rad_calc *c, const struct symbol *s)
{
    const struct ins *in = s->kind == SYM_VARIABLE ? &c->code[s->code] : NULL;
    unsigned offer;

    if (!in || in->op != OP_CHANNEL || in->a < RAD_CALC_NPUBLIC)
        return false;
    offer = in->a < RAD_CALC_COLOR ? RAD_CALC_OFFER_NORMAL
            : in->a < RAD_CALC_AIM ? RAD_CALC_OFFER_COLOR
                                   : RAD_CALC_OFFER_AIM;
    return !(c->offer & offer);
}

/* Is everything defined that the code uses?  Symbols that it refers to are put
 * on the stack, each once. */
static int
check_code(struct rad_calc *c, int32_t from, int32_t to, int32_t *stack,
           int32_t *n, struct rad_error *err)
{
    for (int32_t pc = from; pc < to; pc++) {
        const struct ins *in = &c->code[pc];
        struct symbol *s;

        if (in->op == OP_LIBRARY && rad_calc_library[in->a].offer & ~c->offer)
            return rad_fail(err, RAD_EDATA, "undefined function '%s'",
                            rad_calc_library[in->a].name);
        if (in->op != OP_VARIABLE && in->op != OP_CALL)
            continue;
        s = &c->symbol[in->a];
        if (s->kind == SYM_UNDEFINED || is_missing(c, s) ||
            (s->kind == SYM_VARIABLE && in->op == OP_CALL))
            return rad_fail(err, RAD_EDATA, "undefined %s '%.*s'",
                            in->op == OP_CALL ? "function" : "variable",
                            (int)strcspn(s->name, "`"), s->name);
        if (s->kind != SYM_LIBRARY &&
            (!s->checked || s->checked & ~(CHECKED | c->offer))) {
            s->checked = CHECKED | c->offer;
            stack[(*n)++] = in->a;
        }
    }
    return 0;
}

static int
check_names(struct rad_calc *c, int32_t from, int32_t to, struct rad_error *err)
{
    int32_t *stack = malloc(((size_t)c->nsymbol + 1) * sizeof *stack);
    int32_t n = 0;
    int rc;

    if (!stack)
        return rad_fail(err, RAD_ENOMEM, "out of memory for functions");
    rc = check_code(c, from, to, stack, &n, err);
    while (rc == 0 && n > 0) {
        const struct symbol *s = &c->symbol[stack[--n]];

        rc = check_code(c, s->code, s->end, stack, &n, err);
        if (rc)
            rad_error_where(err, "%s:%d", s->file, s->line);
    }
    free(stack);
    return rc;
}

/* Return the code at pc if it compiled and all that it uses is defined. */
static int
accept_code(struct rad_calc *c, int32_t pc, struct rad_error *why,
            struct rad_error *err)
{
    if (pc >= 0 && check_names(c, pc, c->ncode, why) == 0)
        return pc;
    rad_fail(err, why->code, "%s", why->what);
    if (why->where[0])
        rad_error_where(err, "%s", why->where);
    return why->code;
}

bool
rad_calc_number(const struct rad_calc *c, int at, double *value)
{
    if (c->code[at].op != OP_NUMBER || c->code[at + 1].op != OP_END)
        return false;
    *value = c->number[c->code[at].a];
    return true;
}

/* The channels that the code reads itself.  Symbols that it refers to are put
 * on the stack, each once. */
static uint64_t
channels_of(const struct rad_calc *c, int32_t from, int32_t to, uint8_t *seen,
            int32_t *stack, int32_t *n)
{
    uint64_t read = 0;

    for (int32_t pc = from; pc < to; pc++) {
        const struct ins *in = &c->code[pc];

        if (in->op == OP_CHANNEL)
            read |= UINT64_C(1) << in->a;
        else if (in->op == OP_LIBRARY && in->a != LIB_ARG &&
                 !rad_calc_library[in->a].constant)
            read = UINT64_MAX; /* such a function may read any */
        else if ((in->op == OP_VARIABLE || in->op == OP_CALL) && !seen[in->a])
            seen[stack[(*n)++] = in->a] = 1;
    }
    return read;
}

uint64_t
rad_calc_channels(const struct rad_calc *c, int expression)
{
    size_t size = (size_t)c->nsymbol + 1;
    int32_t *stack = malloc(size * sizeof *stack), n = 0;
    uint8_t *seen = calloc(size, 1);
    uint64_t read = UINT64_MAX;

    if (stack && seen)
        read = channels_of(c, expression, c->ncode, seen, stack, &n);
    while (n > 0) {
        const struct symbol *s = &c->symbol[stack[--n]];

        if (s->code >= 0)
            read |= channels_of(c, s->code, s->end, seen, stack, &n);
    }
    free(stack);
    free(seen);
    return read;
}

int
rad_calc_expression(struct rad_calc *c, int context, const char *text,
                    struct rad_error *err)
{
    struct rad_error why = { 0 };
    struct parser ps = { .c = c,
                         .context = c->context[context].name,
                         .p = text,
                         .end = text + strlen(text),
                         .err = &why };
    const struct node *n;
    int32_t pc = -1;

    rad_arena_init(&ps.arena);
    skip_blanks(&ps);
    n = sum(&ps);
    if (!ps.failed && ps.p < ps.end)
        fail_at(&ps, "expected the end of the expression");
    if (n && !ps.failed)
        pc = rad_calc_emit_shared(c, n, &why);
    rad_arena_release(&ps.arena);
    return accept_code(c, pc, &why, err);
}

/* The symbol that a function's name stands for, or a code. */
static int32_t
find_name(struct rad_calc *c, int context, const char *name,
          struct rad_error *err)
{
    size_t n = 0;

    while (is_name_byte((unsigned char)name[n]))
        n++;
    if (name[n] || n > MAX_NAME ||
        !(isalpha((unsigned char)name[0]) || name[0] == '`'))
        return rad_fail(err, RAD_EDATA, "no name of a function");
    return rad_calc_symbol(c, c->context[context].name, name, false, err);
}

int
rad_calc_params(struct rad_calc *c, int context, const char *name,
                struct rad_error *err)
{
    int32_t i = find_name(c, context, name, err);

    if (i < 0)
        return i;
    if (c->symbol[i].kind == SYM_LIBRARY)
        return rad_calc_library[c->symbol[i].library].nargs;
    return c->symbol[i].kind == SYM_FUNCTION ? c->symbol[i].nparams : 0;
}

int
rad_calc_function(struct rad_calc *c, int context, const char *name, int n,
                  struct rad_error *err)
{
    struct node value[RAD_MAX_CALC_ARGS], call = { .type = N_CALL };
    const struct node *body;
    struct rad_error why = { 0 };
    struct rad_arena arena;
    int32_t pc = -1;

    call.ref = find_name(c, context, name, &why);
    call.nkids = n;
    call.kid = n > 0 ? value : NULL;
    for (int i = 0; i < n; i++)
        value[i] = (struct node){ .type = N_VALUE,
                                  .ref = i,
                                  .next = i + 1 < n ? &value[i + 1] : NULL };
    if (call.ref >= 0) {
        rad_arena_init(&arena);
        body = rad_calc_inlined(c, &call, &arena);
        pc = rad_calc_emit(c, body ? body : &call, &why);
        rad_arena_release(&arena);
    }
    return accept_code(c, pc, &why, err);
}
