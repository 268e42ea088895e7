/* expr.h - the expressions among an object's string arguments
 *
 * Materials, patterns, textures and mixtures hold expressions, the name of a
 * function file that these may use ("." for none), and a transform behind it.
 * The expressions see the ray and the surface in the coordinates that the
 * transform moves into place, and the object's real arguments.
 * All expressions of a scene share one program (job->calc), made when the first
 * is met; each thread has an evaluator of it (ctx->calc).  A function file is
 * read once, into a context named after it.
 * Source: Radiance's reference manual, "Function files". */
#ifndef RAD_SHADE_EXPR_H
#define RAD_SHADE_EXPR_H

#include "base/xform.h"
#include "scene/calc.h"
#include "shade/material.h"

#define RAD_MAX_EXPRS 12 /* of one object */

struct rad_expr {
    int n;
    int code[RAD_MAX_EXPRS];
    struct rad_xform move; /* from the function's coordinates to the world's */
    struct rad_xform back;
    const double *args;
    int nargs;
    int context; /* of the file, in job->calc */
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

/* Turn a direction of the function's coordinates into the world's, without a
 * change of its length. */
void rad_expr_outward(const struct rad_expr *e, const struct rad_ray *r,
                      double v[3]);

#endif
