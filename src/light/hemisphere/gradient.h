/* gradient.h - how irradiance changes about a point, from one sampling of it
 *
 * The cells of a hemisphere sampling are joined to a mesh of triangles, each
 * with the radiance of its farthest corner, for that is what comes out from
 * behind the nearer ones when the point moves.  Irradiance, its gradient and
 * its Hessian are sums over the mesh's edges of the radiance difference across
 * each, so only what differs from its neighbour counts, and a point in a
 * uniform surrounding has none.
 * All results are relative to E, in the frame of the sampling; in those of the
 * mesh, and the E that they are relative to, no cell counts for much more than
 * the others.
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
};

/* From a complete sampling with positive luminance. */
void rad_hemi_gradients(const struct rad_hemi *h, struct rad_gradients *g);

/* The gradient for turning alone. */
void rad_hemi_turn(const struct rad_hemi *h, double turn[2]);

/* How the irradiance per radiance changes as the point moves in its plane. */
struct rad_slope {
    double grad[2]; /* x, y */
    double hess[3]; /* xx, xy, yy */
};

/* Add what a polygon's edge from a to b (relative to the point, the normal
 * along z) has of that, times `scale`.  Summed counter-clockwise, as seen from
 * above, over a closed polygon it is that of the polygon. */
void rad_edge_slope(const double a[3], const double b[3], double scale,
                    struct rad_slope *sum);

/* Eigenvalues of the symmetric matrix { uu, uv, vv }, the one larger in
 * magnitude first, and the unit eigenvector of that one. */
void rad_eigen2(const double m[3], double value[2], double vec[2]);

#endif
