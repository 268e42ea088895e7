/* aniso.h - plastic2, metal2 and trans2: anisotropic gloss
 *
 * As plastic, metal and trans, but always rough: the roughness has one value
 * along a vector u, which three expressions give, and another across it
 * (gloss.h).  No light goes straight through, and shadow rays stop.
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

/* Set u to the unit vector along the projection of `along` onto the plane
 * perpendicular to unit normal norm, and v perpendicular to both.  False:
 * `along` is parallel to norm, and u is any direction in the plane. */
bool rad_aniso_frame(double u[3], double v[3], const double norm[3],
                     const double along[3]);

/* Set `along` to the direction that the first three expressions give at r's
 * hit, in world coordinates; zero if they have no value. */
void rad_aniso_along(struct rad_ctx *ctx, const struct rad_expr *e,
                     const struct rad_ray *r, double along[3]);

/* The same of expressions first .. first + 2, after rad_expr_begin(). */
void rad_aniso_get(struct rad_ctx *ctx, const struct rad_expr *e, int first,
                   const struct rad_ray *r, double along[3]);

#endif
