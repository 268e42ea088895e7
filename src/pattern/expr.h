/* expr.h - the expressions among an object's string arguments
 *
 * Materials, patterns, textures and mixtures hold expressions, the name of a
 * function file that these may use ("." for none), and a transform behind it.
 * The expressions see the ray and the surface in the coordinates that the
 * transform moves into place, within those of the file that an instance or mesh
 * is a copy of, and the object's real arguments.
 * All expressions of a scene share one program (job->calc), made when the first
 * is met; each thread has an evaluator of it (ctx->calc).  A function file is
 * read once, into a context named after it.
 * Source: Radiance's reference manual, "Function files". */
#ifndef RAD_SHADE_EXPR_H
#define RAD_SHADE_EXPR_H

#include "base/xform.h"
#include "scene/calc/calc.h"
#include "trace/material.h"

#define RAD_MAX_EXPRS 12 /* of one object */

struct rad_expr {
    int n;
    int code[RAD_MAX_EXPRS];
    double number[RAD_MAX_EXPRS]; /* of those that are numbers: */
    unsigned numbers;             /* a bit for each */
    uint64_t channels;            /* that they and the functions read */
    struct rad_xform move; /* from the function's coordinates to the world's */
    struct rad_xform back;
    const double *args;
    int nargs;
    int context;    /* of the file, in job->calc */
    int32_t object; /* whose they are */
};

/* What expressions see of one ray, while they are evaluated. */
struct rad_expr_scope {
    struct rad_calc_input in;
    double channel[RAD_CALC_NCHANNELS];
};

/* Compile those strings of object o whose bits are set in `which`, in their
 * order; the function file is string number `file`.  0 or a negative code. */
int rad_expr_prepare(struct rad_job *job, const struct rad_object *o,
                     const struct rad_files *files, int file, unsigned which,
                     struct rad_expr *e, struct rad_error *err);

/* Values of expressions `first` to first + n - 1 at r's hit.  False: one cannot
 * be worked out, or is not finite; value[] is undefined then. */
bool rad_expr_values(struct rad_ctx *ctx, const struct rad_expr *e,
                     const struct rad_ray *r, int first, int n, double value[]);

/* A call of the function that string number `which` of o names, with n values;
 * at least 0, or a code. */
int rad_expr_function(struct rad_job *job, const struct rad_object *o,
                      struct rad_expr *e, int which, int n,
                      struct rad_error *err);

/* Start with a ray: what follows is evaluated for it, until another one is
 * begun or rad_expr_values() is called.  *scope must stay where it is;
 * rad_expr_resume() goes back to it. */
void rad_expr_begin(struct rad_ctx *ctx, const struct rad_expr *e,
                    const struct rad_ray *r, struct rad_expr_scope *scope);
void rad_expr_resume(struct rad_ctx *ctx, const struct rad_expr_scope *scope);

/* Values of expressions as above, and of a function for arg[0..n).  What fails
 * is counted (rad_counts_fault). */
bool rad_expr_get(struct rad_ctx *ctx, const struct rad_expr *e, int first,
                  int n, double value[]);
bool rad_expr_call(struct rad_ctx *ctx, const struct rad_expr *e, int function,
                   const double arg[], double *value);

/* After rad_expr_begin(), for types that have these variables (see
 * rad_calc_offer): what the ray's material makes of the hit.
 *   norm, cos_n  unit normal as textures tilt it, and -dir.norm
 *   color        of the material with its patterns
 *   dir          toward a light source, NULL: none */
void rad_expr_set_normal(struct rad_ctx *ctx, struct rad_expr_scope *scope,
                         const double norm[3], double cos_n);
void rad_expr_set_color(struct rad_ctx *ctx, struct rad_expr_scope *scope,
                        struct rad_rgb color);
void rad_expr_set_aim(struct rad_ctx *ctx, struct rad_expr_scope *scope,
                      const double dir[3]);

/* Turn a direction of the world into the coordinates of the function that was
 * begun, without a change of its length. */
void rad_expr_inward(const struct rad_expr_scope *scope, const double v[3],
                     double w[3]);

/* Turn a direction of the function's coordinates into the world's, without a
 * change of its length. */
void rad_expr_outward(const struct rad_expr *e, const struct rad_ray *r,
                      double v[3]);

/* How long a unit of the function's coordinates is in the world. */
double rad_expr_scale(const struct rad_expr *e, const struct rad_ray *r);

#endif
