/* calc.h - the function language of .cal files
 *
 * A program holds definitions: variables (x = ...), functions (f(a,b) = ...),
 * constants (with : for =), each in a context, which is named after the file
 * that it was read from.  A name is looked for in the context where it is used,
 * then globally; `name is the context's own, name` the global one.  The global
 * definitions are those that Radiance's renderers have before any file is read
 * (Dx, Px, T, A1, PI, noise3, hermite, ...): rad_calc_new() makes them.
 * Everything is compiled as it is read, into code for a small stack machine;
 * arguments of functions are evaluated at most once, and only if used.
 *
 * Arithmetic that goes wrong (log(0), 1/0, sqrt(-1)) counts as 0, and marks the
 * evaluation as faulty; the mark is carried and dropped as in Radiance: a call
 * of a library function or a power drops what came before it, and is itself 0
 * if its arguments were faulty.
 * Limits: RAD_MAX_CALC_* below; what is beyond one is an error when read, and
 * ends the evaluation with 0 when run.
 * Thread: a program is read-only once all is read, and serves any number of
 * threads; each has a rad_calc_env.
 * Source: Radiance's reference manual, "Function files". */
#ifndef RAD_SCENE_CALC_H
#define RAD_SCENE_CALC_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RAD_MAX_CALC_FILE    (1 << 24) /* bytes of one file */
#define RAD_MAX_CALC_CODE    (1 << 22) /* instructions of a program */
#define RAD_MAX_CALC_NESTING 200       /* of brackets, signs and calls */
#define RAD_MAX_CALC_ARGS    32        /* of a function that a file defines */
#define RAD_MAX_CALC_DEPTH   4096      /* of calls under way */
#define RAD_MAX_CALC_STEPS   10000000  /* of one evaluation */

/* Channels that a file may name, $1 to $27, and those behind them, which only
 * the variables of materials stand for (enum rad_calc_offer). */
enum {
    RAD_CALC_NPUBLIC = 27,
    RAD_CALC_NORMAL = RAD_CALC_NPUBLIC,   /* NxP NyP NzP RdotP */
    RAD_CALC_COLOR = RAD_CALC_NORMAL + 4, /* CrP CgP CbP */
    RAD_CALC_AIM = RAD_CALC_COLOR + 3,    /* DxA DyA DzA */
    RAD_CALC_NCHANNELS = RAD_CALC_AIM + 3
};

/* Variables that not everything has which holds expressions. */
enum rad_calc_offer {
    RAD_CALC_OFFER_NORMAL = 1,
    RAD_CALC_OFFER_COLOR = 2,
    RAD_CALC_OFFER_AIM = 4
};

struct rad_calc;
struct rad_calc_env;

/* What went wrong in an evaluation, the mildest first. */
enum rad_calc_fault {
    RAD_CALC_SOUND,
    RAD_CALC_MATH,       /* domain or range error, division by zero */
    RAD_CALC_NO_ARG,     /* arg(n) or a parameter that was not given */
    RAD_CALC_NO_CHANNEL, /* a variable of the ray where there is no ray */
    RAD_CALC_NAME,       /* a function as a variable, or the reverse */
    RAD_CALC_DEPTH,
    RAD_CALC_STEPS
};

/* What an evaluation takes from outside. */
struct rad_calc_input {
    const double *channel; /* $1 at [0]; RAD_CALC_NCHANNELS, or NULL */
    const double *args;    /* arg(1) at [0] */
    int nargs;
};

struct rad_calc *rad_calc_new(struct rad_error *err);
void rad_calc_free(struct rad_calc *c);

/* The context of a file: its name without .cal, and _ for what a name may not
 * hold; "" for ".".  Returns an index >= 0 that stands for it, or a code. */
int rad_calc_context(struct rad_calc *c, const char *file,
                     struct rad_error *err);

/* Has a file been read into it?  rad_calc_read() sets this. */
int rad_calc_loaded(const struct rad_calc *c, int context);

/* Read the definitions of a file; name is for messages.  RAD_EDATA with
 * err->where "name:line". */
int rad_calc_read(struct rad_calc *c, int context, const char *name,
                  const char *text, size_t len, struct rad_error *err);

/* What the expressions and calls compiled from here on may use:
 * RAD_CALC_OFFER_* together.  To others these variables are not defined. */
void rad_calc_offer(struct rad_calc *c, unsigned offer);

/* Compile an expression.  Everything that it can reach must be defined by now:
 * err->where is the place of a definition that lacks something, or empty.
 * Returns its index >= 0 or a negative code. */
int rad_calc_expression(struct rad_calc *c, int context, const char *text,
                        struct rad_error *err);

/* How many parameters the function of that name has where it is used in this
 * context; 0 if there is no such function, or a code. */
int rad_calc_params(struct rad_calc *c, int context, const char *name,
                    struct rad_error *err);

/* Compile a call of the function of that name with n values that will be given
 * to rad_calc_call(), up to RAD_MAX_CALC_ARGS; those beyond its parameters are
 * not used.  As rad_calc_expression(). */
int rad_calc_function(struct rad_calc *c, int context, const char *name, int n,
                      struct rad_error *err);

/* Is the expression a number?  Sets *value if so. */
bool rad_calc_number(const struct rad_calc *c, int expression, double *value);

/* Which channels may what was compiled last read?  Bit 0 for $1. */
uint64_t rad_calc_channels(const struct rad_calc *c, int expression);

/* What an expression needs whatever the ray is: beyond what if(), select() and
 * a divisor of 0 may leave out.  Where nothing is known (no memory, too long to
 * look through) it needs nothing. */
struct rad_calc_need {
    int reals;            /* arg(reals) is asked for, and none beyond it */
    const char *function; /* one that asks for an argument it is not given */
};
void rad_calc_needs(const struct rad_calc *c, int expression,
                    struct rad_calc_need *need);

/* All of that of an expression. */
struct rad_calc_compiled {
    int code; /* its index */
    bool is_number;
    double number;
    uint64_t channels;
    struct rad_calc_need need;
};

/* rad_calc_expression(), and what the three above say of it; an expression that
 * was compiled before, in the same context and with the same on offer, is not
 * compiled again. */
int rad_calc_compile(struct rad_calc *c, int context, const char *text,
                     struct rad_calc_compiled *out, struct rad_error *err);

/* An evaluator for programs of this size; NULL: out of memory. */
struct rad_calc_env *rad_calc_env_new(const struct rad_calc *c);
void rad_calc_env_free(struct rad_calc_env *env);

/* Start anew: variables will be evaluated again.  in is kept. */
void rad_calc_begin(struct rad_calc_env *env, const struct rad_calc_input *in);

/* Is that what was last begun with, with these channels? */
bool rad_calc_is_begun(const struct rad_calc_env *env,
                       const struct rad_calc_input *in);

/* The value of an expression.  *fault is set to what is still wrong at its
 * end; the value is 0 then for all but RAD_CALC_MATH. */
double rad_calc_eval(const struct rad_calc *c, int expression,
                     struct rad_calc_env *env, enum rad_calc_fault *fault);

/* The value of a function for as many values as it was compiled for; what
 * rad_calc_begin() started with holds. */
double rad_calc_call(const struct rad_calc *c, int function,
                     const double value[], struct rad_calc_env *env,
                     enum rad_calc_fault *fault);

#endif
