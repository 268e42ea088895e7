/* expr.h - the expressions among an object's string arguments
 *
 * Materials, patterns, textures and mixtures have expressions, the name of a
 * function file for these ("." for none), and after it a transform.
 * Expressions read the ray and the surface in coordinates of their own, which
 * the transform turns into the world's (in an instance or mesh, into those of
 * its file), and the object's real arguments.
 * All expressions of a scene are in one program (job->calc), made for the first
 * of them; each thread has an evaluator (ctx->calc).  A function file is read
 * once, into a context named after it.
 * Source: Radiance's reference manual, "Function files". */
#ifndef RAD_PATTERN_EXPR_H
#define RAD_PATTERN_EXPR_H

#include "base/xform.h"
#include "scene/calc/calc.h"
#include "trace/material.h"

#define RAD_MAX_EXPRS 12 /* of one object */

struct rad_expr {
    int n;
    int code[RAD_MAX_EXPRS];
    double number[RAD_MAX_EXPRS]; /* values of expressions that are numbers; */
    unsigned numbers;             /* a bit for each such expression */
    uint64_t channels;            /* read by expressions and functions */
    struct rad_xform move; /* from the function's coordinates to the world's */
    struct rad_xform back; /* its inverse */
    const double *args;
    int nargs;
    int context;    /* of the file, in job->calc */
    int32_t object; /* that has the expressions */
};

/* Inputs of expressions, for one ray. */
struct rad_expr_scope {
    struct rad_calc_input in;
    double channel[RAD_CALC_NCHANNELS];
};

/* Compile those strings of object o whose bits are set in `which`, in order,
 * with o's function file (rad_otype_files()).  0 or a negative code. */
int rad_expr_prepare(struct rad_job *job, const struct rad_object *o,
                     const struct rad_files *files, unsigned which,
                     struct rad_expr *e, struct rad_error *err);

/* The values of expressions `first` to first + n - 1 at r's hit.  False: one
 * has no value or is not finite; value[] is undefined then. */
bool rad_expr_values(struct rad_ctx *ctx, const struct rad_expr *e,
                     const struct rad_ray *r, int first, int n, double value[]);

/* Compile a call, with n arguments, of the function that string number `which`
 * of o names.  Returns its number, at least 0, or a code. */
int rad_expr_function(struct rad_job *job, const struct rad_object *o,
                      struct rad_expr *e, int which, int n,
                      struct rad_error *err);

/* Begin evaluating for a ray.  What follows is evaluated for this ray until
 * another one is begun or rad_expr_values() is called; rad_expr_resume() goes
 * back to it.  *scope must stay in place. */
void rad_expr_begin(struct rad_ctx *ctx, const struct rad_expr *e,
                    const struct rad_ray *r, struct rad_expr_scope *scope);
void rad_expr_resume(struct rad_ctx *ctx, const struct rad_expr_scope *scope);

/* Values of expressions as above, and of a function for arg[0..n), for the ray
 * that was begun.  Failures are counted (rad_counts_fault). */
bool rad_expr_get(struct rad_ctx *ctx, const struct rad_expr *e, int first,
                  int n, double value[]);
bool rad_expr_call(struct rad_ctx *ctx, const struct rad_expr *e, int function,
                   const double arg[], double *value);

/* Values that are judged together, as of a colour's three channels.  Radiance
 * asks once, after the last one, whether a fault is left: what a library
 * function of one drops is the fault of those that were evaluated before.
 * These are as rad_expr_values() and rad_expr_get(); backward: the last is
 * evaluated first.  value[i] is 0 where there is none. */
bool rad_expr_values_all(struct rad_ctx *ctx, const struct rad_expr *e,
                         const struct rad_ray *r, int n, bool backward,
                         double value[]);
bool rad_expr_get_all(struct rad_ctx *ctx, const struct rad_expr *e, int first,
                      int n, bool backward, double value[]);

/* As rad_expr_call(), after values that left *fault, RAD_CALC_SOUND before the
 * first.  False: the rest need not be evaluated. */
bool rad_expr_call_next(struct rad_ctx *ctx, int function, const double arg[],
                        enum rad_calc_fault *fault, double *value);

/* Are values that left this fault valid?  If not, a failure is counted. */
bool rad_expr_sound(struct rad_ctx *ctx, const struct rad_expr *e,
                    enum rad_calc_fault fault);

/* After rad_expr_begin(), set variables that only some types have (see
 * rad_calc_offer):
 *   norm, cos_n  unit normal, tilted by textures, and -dir.norm
 *   color        of the material, with its patterns
 *   dir          toward a light source, NULL: none */
void rad_expr_set_normal(struct rad_ctx *ctx, struct rad_expr_scope *scope,
                         const double norm[3], double cos_n);
void rad_expr_set_color(struct rad_ctx *ctx, struct rad_expr_scope *scope,
                        struct rad_rgb color);
void rad_expr_set_aim(struct rad_ctx *ctx, struct rad_expr_scope *scope,
                      const double dir[3]);

/* Turn a direction from the world's coordinates into those of the function that
 * was begun; its length does not change. */
void rad_expr_inward(const struct rad_expr_scope *scope, const double v[3],
                     double w[3]);

/* Turn a direction from the function's coordinates into the world's; its length
 * does not change. */
void rad_expr_outward(const struct rad_expr *e, const struct rad_ray *r,
                      double v[3]);

/* The length in the world of a unit of the function's coordinates. */
double rad_expr_scale(const struct rad_expr *e, const struct rad_ray *r);

#endif
