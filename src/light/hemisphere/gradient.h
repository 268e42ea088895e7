/* gradient.h - how irradiance changes about a point, from its hemisphere
 *
 * The hits of a hemisphere's cells are joined to a mesh of triangles.  A
 * triangle has the radiance of its farthest corner: when the point moves, the
 * farther surface comes into sight from behind the nearer ones.  The gradient
 * and the Hessian of irradiance are sums over the mesh's edges, each times the
 * difference of radiance across it; so they are 0 in uniform surroundings.
 * The radiance of a bright surface that a single ray meets before a dark
 * surface is in no triangle: `overlooked` tells which part of E the mesh so
 * lacks.
 * All results are relative to E, in the frame of the hemisphere (u, v, w).  For
 * results from the mesh the luminance of bright cells is limited, in the mesh
 * and in E (gradient.c, fair_mean()).
 * Thread: any; pure functions of their arguments.
 * Sources: Lambert 1760 (irradiance from polygons); Ward & Heckbert 1992
 * (rotation); Schwarzhaupt, Jensen & Jarosz 2012, Practical Hessian-based error
 * control for irradiance caching.  */
#ifndef RAD_LIGHT_GRADIENT_H
#define RAD_LIGHT_GRADIENT_H

#include "light/hemisphere/hemisphere.h"

struct rad_gradients {
    double move[2]; /* d ln E per unit along u, v */
    double turn[2]; /* d ln E per radian about u, v */
    double hess[3]; /* second derivative uu, uv, vv over E [1/unit^2] */
    double overlooked; /* part of E that is not in the mesh, 0 to 1 */
};

/* Set *g from a complete hemisphere whose E has a positive luminance. */
void rad_hemi_gradients(const struct rad_hemi *h, struct rad_gradients *g);

/* Set turn alone, as of struct rad_gradients; it needs no mesh. */
void rad_hemi_turn(const struct rad_hemi *h, double turn[2]);

/* Derivatives of irradiance per radiance as the point moves in its plane. */
struct rad_slope {
    double grad[2]; /* x, y */
    double hess[3]; /* xx, xy, yy */
};

/* Add `scale` times the part of an edge from a to b, which are relative to the
 * point, with the normal along z.  The sum over the edges of a polygon,
 * counter-clockwise as seen from above, is the slope of its irradiance. */
void rad_edge_slope(const double a[3], const double b[3], double scale,
                    struct rad_slope *sum);

/* Eigenvalues of the symmetric matrix { uu, uv, vv }, the larger in magnitude
 * first; vec gets the unit eigenvector of the first. */
void rad_eigen2(const double m[3], double value[2], double vec[2]);

#endif
