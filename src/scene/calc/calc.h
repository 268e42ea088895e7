/* calc.h - the function language of .cal files
 *
 * A program holds definitions: variables (x = ...), functions (f(a,b) = ...)
 * and constants (with : for =).  Each belongs to a context, which is named
 * after the file that it was read from.  A name is looked for in the context
 * where it is used, then globally; `name is always the context's own, name` the
 * global one.  rad_calc_new() makes the global definitions: those that
 * Radiance's renderers have before any file is read (Dx, Px, T, A1, PI, noise3,
 * hermite, ...).  Definitions are compiled as they are read, into code for a
 * small stack machine.  Arguments of functions are evaluated at most once, and
 * only if used.
 *
 * Arithmetic that goes wrong (log(0), 1/0, sqrt(-1)) gives 0 and marks the
 * evaluation as faulty.  The mark is kept and dropped as in Radiance: a call of
 * a library function or a power drops marks from before it, and is 0 itself if
 * its arguments were faulty.
 * Limits: RAD_MAX_CALC_* below.  A file beyond one is an error when it is read;
 * an evaluation beyond one ends with 0.
 * Thread: a program is read-only once all files are read, and serves any number
 * of threads, each with a rad_calc_env of its own.
 * Source: Radiance's reference manual, "Function files". */
#ifndef RAD_SCENE_CALC_H
#define RAD_SCENE_CALC_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RAD_MAX_CALC_FILE    (1 << 24) /* bytes of one file */
#define RAD_MAX_CALC_CODE    (1 << 22) /* instructions of a program */
#define RAD_MAX_CALC_NESTING 2000      /* of brackets, signs and calls */
#define RAD_MAX_CALC_ARGS    32        /* of a function that a file defines */
#define RAD_MAX_CALC_DEPTH   4096      /* of calls under way */
#define RAD_MAX_CALC_STEPS   10000000  /* of one evaluation */

/* Channels, the values that a ray gives to functions.  Files may name $1 to
 * $27; the others are only reached by variables of some materials (enum
 * rad_calc_offer). */
enum {
    RAD_CALC_NPUBLIC = 27,
    RAD_CALC_NORMAL = RAD_CALC_NPUBLIC,   /* NxP NyP NzP RdotP */
    RAD_CALC_COLOR = RAD_CALC_NORMAL + 4, /* CrP CgP CbP */
    RAD_CALC_AIM = RAD_CALC_COLOR + 3,    /* DxA DyA DzA */
    RAD_CALC_NCHANNELS = RAD_CALC_AIM + 3
};

/* Groups of variables that only some materials have. */
enum rad_calc_offer {
    RAD_CALC_OFFER_NORMAL = 1,
    RAD_CALC_OFFER_COLOR = 2,
    RAD_CALC_OFFER_AIM = 4
};

struct rad_calc;
struct rad_calc_env;

/* What went wrong in an evaluation, from mild to severe. */
enum rad_calc_fault {
    RAD_CALC_SOUND,
    RAD_CALC_MATH,       /* domain or range error, division by zero */
    RAD_CALC_NO_ARG,     /* arg(n) or a parameter that was not given */
    RAD_CALC_NO_CHANNEL, /* a variable of the ray where there is no ray */
    RAD_CALC_NAME,       /* a function as a variable, or the reverse */
    RAD_CALC_DEPTH,
    RAD_CALC_STEPS
};

/* Inputs of an evaluation. */
struct rad_calc_input {
    const double *channel; /* $1 at [0]; RAD_CALC_NCHANNELS, or NULL */
    const double *args;    /* arg(1) at [0] */
    int nargs;
};

struct rad_calc *rad_calc_new(struct rad_error *err);
void rad_calc_free(struct rad_calc *c);

/* The context of a file: its name without .cal, with _ for each character that
 * a name may not have; "" for ".".  Returns its index >= 0, or a code. */
int rad_calc_context(struct rad_calc *c, const char *file,
                     struct rad_error *err);

/* Has a file been read into the context by rad_calc_read()? */
int rad_calc_loaded(const struct rad_calc *c, int context);

/* Read the definitions of a file; name is for messages.  RAD_EDATA with
 * err->where "name:line". */
int rad_calc_read(struct rad_calc *c, int context, const char *name,
                  const char *text, size_t len, struct rad_error *err);

/* Set which groups of variables (RAD_CALC_OFFER_*, or'ed) the expressions and
 * calls compiled from now on may use.  Other groups are undefined for them. */
void rad_calc_offer(struct rad_calc *c, unsigned offer);

/* Compile an expression.  All that it can reach must be defined by now; if not,
 * err->where is the place of the definition that lacks something, or empty.
 * Returns its index >= 0 or a negative code. */
int rad_calc_expression(struct rad_calc *c, int context, const char *text,
                        struct rad_error *err);

/* The number of parameters of the function of that name, if used in this
 * context; 0 if there is no such function, or a code. */
int rad_calc_params(struct rad_calc *c, int context, const char *name,
                    struct rad_error *err);

/* Compile a call of the function of that name with n arguments, up to
 * RAD_MAX_CALC_ARGS, which rad_calc_call() gets later; those beyond its
 * parameters are not used.  Returns as rad_calc_expression(). */
int rad_calc_function(struct rad_calc *c, int context, const char *name, int n,
                      struct rad_error *err);

/* Is the expression just a number?  Sets *value if so. */
bool rad_calc_number(const struct rad_calc *c, int expression, double *value);

/* The channels that the expression compiled last may read; bit 0 is $1. */
uint64_t rad_calc_channels(const struct rad_calc *c, int expression);

/* What every evaluation of an expression needs, whatever the ray: code that
 * if(), select() or a divisor of 0 may leave out does not count.  If memory is
 * out or the code is too long to follow, no need is found. */
struct rad_calc_need {
    int reals;            /* the highest n for which arg(n) is asked for */
    const char *function; /* one that asks for an argument that its call does
                           * not have; NULL: none */
};
void rad_calc_needs(const struct rad_calc *c, int expression,
                    struct rad_calc_need *need);

/* An expression and what is known of it. */
struct rad_calc_compiled {
    int code; /* its index */
    bool is_number;
    double number;
    uint64_t channels;
    struct rad_calc_need need;
};

/* Compile an expression, and find what the three functions above tell.  An
 * expression that was compiled before, in the same context and with the same
 * groups on offer, is not compiled again. */
int rad_calc_compile(struct rad_calc *c, int context, const char *text,
                     struct rad_calc_compiled *out, struct rad_error *err);

/* An evaluator for programs of this size; NULL: memory is out. */
struct rad_calc_env *rad_calc_env_new(const struct rad_calc *c);
void rad_calc_env_free(struct rad_calc_env *env);

/* Begin with new inputs: variables will be evaluated again.  *in is copied, the
 * arrays that it points to are not. */
void rad_calc_begin(struct rad_calc_env *env, const struct rad_calc_input *in);

/* Was the evaluator last begun with these arrays? */
bool rad_calc_is_begun(const struct rad_calc_env *env,
                       const struct rad_calc_input *in);

/* The next evaluation goes on with the fault that the one before has left, as
 * if both were in one expression: its library functions drop it. */
void rad_calc_go_on(struct rad_calc_env *env, enum rad_calc_fault fault);

/* The value of an expression.  *fault is the fault that is left at its end; for
 * all but RAD_CALC_MATH the value is 0 then. */
double rad_calc_eval(const struct rad_calc *c, int expression,
                     struct rad_calc_env *env, enum rad_calc_fault *fault);

/* The value of a function for as many arguments as it was compiled for, with
 * the inputs of rad_calc_begin(). */
double rad_calc_call(const struct rad_calc *c, int function,
                     const double value[], struct rad_calc_env *env,
                     enum rad_calc_fault *fault);

#endif
