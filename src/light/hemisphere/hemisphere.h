/* hemisphere.h - the indirect light that arrives at a point, by sampling
 *
 * The hemisphere is mapped to the unit square so that equal areas carry equal
 * irradiance, and cut into n x n cells (-ad) with one ray each.  Further rays
 * (-as) go to cells whose neighbours differ, and toward bright places that the
 * cache knows (bright.h, guide.h).  The irradiance is the mean radiance times
 * pi; gradients and the radii of records follow from the positions and
 * radiances of the cells' hits (gradient.h).
 * Thread: any; the cells lie in the scratch of the thread's rad_ctx.
 * Sources: Shirley & Chiu 1997 (square to disk); Kensler 2013, Correlated
 * multi-jittered sampling.  */
#ifndef RAD_LIGHT_HEMISPHERE_H
#define RAD_LIGHT_HEMISPHERE_H

#include "trace/ray.h"

struct rad_hemicell {
    double p[3];      /* where the cell's first ray ended, relative to the
                       * point, in the hemisphere's frame */
    float lum;        /* luminance of the first ray */
    float near;       /* 1 / least distance that a ray of the cell shows
                       * [1/unit]; through a pane: that of the surface behind
                       * the pane */
    float wall;       /* 1 / distance of the nearest surface that a ray of the
                       * cell met, panes included [1/unit] */
    struct rad_rgb L; /* mean radiance of the cell */
};

struct rad_bright;

struct rad_hemi {
    int n;                   /* cells along each side */
    double u[3], v[3], w[3]; /* orthonormal frame, w the normal; the middle of
                              * cell (i, j) is ((j + .5) / n, (i + .5) / n) in
                              * the square, whose axes are u and v */
    struct rad_rgb E;        /* irradiance [W/m^2] */
    double var; /* variance of E's luminance over its square, by the noise of
                 * the samples; -1 if not complete */
    struct rad_hemicell *cell; /* n * n, row by row, in ctx->scratch */
    bool complete;             /* no cell's first ray was refused (-lw, -lr) */
};

/* How a hemisphere is to be sampled. */
struct rad_hemi_plan {
    double normal[3];    /* unit, on the side to be sampled */
    bool behind;         /* `normal` is on the far side of the surface that r
                          * hit */
    struct rad_rgb coef; /* factor of E in r's radiance: the reflectance */
    double weight;       /* scales -ad and -as, in (0, 1] */
    bool store;          /* for a record: rays have the weight of a mean
                          * reflectance, and n is at least `side` */
    int side;
    const struct rad_bright *bright; /* places that may be seen; or NULL */
    double usual;                    /* geometric mean of the luminances that
                                      * records see */
    double far; /* the largest distance of cells' positions [unit]; without
                 * `store` all distances are 1 */
};

/* Sample the hemisphere about r's hit.  False: no ray could be traced.  The
 * cells live until the caller rewinds ctx->scratch. */
bool rad_hemi_sample(struct rad_ctx *ctx, const struct rad_ray *r,
                     const struct rad_hemi_plan *plan, struct rad_hemi *h);

#endif
