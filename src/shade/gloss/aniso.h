/* aniso.h - plastic2, metal2 and trans2: gloss that differs by direction
 *
 * As plastic, metal and trans, but never mirrors: the roughness has one value
 * along a vector u, which three expressions give, and another across it
 * (gloss.h).  Nothing goes straight through; shadow rays stop.
 * Arguments as in Radiance's reference manual. */
#ifndef RAD_SHADE_ANISO_H
#define RAD_SHADE_ANISO_H

#include "pattern/expr.h"
#include "trace/material.h"

int rad_aniso_prepare(struct rad_job *job, int32_t index,
                      const struct rad_files *files, const void **data,
                      struct rad_error *err);
bool rad_aniso_shade(struct rad_ctx *ctx, const struct rad_material *mat,
                     struct rad_ray *r);

/* The part of direction `along` that lies in the plane across unit normal norm,
 * as unit vector u, and v across both; false: it stands on the plane, and any
 * two were taken. */
bool rad_aniso_frame(double u[3], double v[3], const double norm[3],
                     const double along[3]);

/* The direction that expressions `first` to first + 2 give at r's hit, in the
 * world's coordinates; zero where they cannot be worked out. */
void rad_aniso_along(struct rad_ctx *ctx, const struct rad_expr *e, int first,
                     const struct rad_ray *r, double along[3]);

/* The same after rad_expr_begin(). */
void rad_aniso_get(struct rad_ctx *ctx, const struct rad_expr *e, int first,
                   const struct rad_ray *r, double along[3]);

#endif
