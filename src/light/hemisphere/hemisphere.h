/* hemisphere.h - the indirect light that arrives at a point, by sampling
 *
 * The hemisphere is mapped to the unit square so that equal areas carry equal
 * irradiance, and cut into n x n cells (-ad) with one ray each; cells whose
 * neighbours differ get more, and so do small bright places that the cache
 * knows (-as; guide.h).  The mean radiance times pi is the
 * irradiance, and the positions and radiances of the cells are what gradients
 * and validity radii come from (gradient.h).
 * Thread: any; a sampling lies in its rad_ctx's scratch.
 * Sources: Shirley & Chiu 1997 (square to disk); Kensler 2013, Correlated
 * multi-jittered sampling.  */
#ifndef RAD_LIGHT_HEMISPHERE_H
#define RAD_LIGHT_HEMISPHERE_H

#include "trace/ray.h"

struct rad_hemicell {
    double p[3];      /* what the cell's first ray met, from the origin, in the
                       * frame of the sampling */
    float lum;        /* luminance of that */
    float near;       /* 1 / distance of the nearest thing met [1/unit] */
    float wall;       /* likewise of the nearest surface: a pane's, not of what
                       * is seen through it */
    struct rad_rgb L; /* mean radiance of the cell */
};

struct rad_bright;

struct rad_hemi {
    int n;                   /* cells along each side */
    double u[3], v[3], w[3]; /* orthonormal frame, w the normal; cell (i, j) is
                              * about ((j + .5) / n, (i + .5) / n) of the
                              * square, whose axes are u and v */
    struct rad_rgb E;        /* irradiance [W/m^2] */
    double var; /* of E's luminance over its square, by the samples' noise; of
                 * a complete sampling */
    struct rad_hemicell *cell; /* n * n, row by row, in ctx->scratch */
    bool complete;             /* no ray was refused (-lw, -lr) */
};

/* How the samples are to be taken. */
struct rad_hemi_plan {
    double normal[3];    /* unit, on the side to be sampled */
    bool behind;         /* that is the far side of the surface r hit */
    struct rad_rgb coef; /* what E is for: the surface's reflectance */
    double weight;       /* scales -ad and -as, in (0, 1] */
    bool store;          /* for a record: a ray's weight as for any reflectance,
                          * and at least `side` cells along each side */
    int side;
    const struct rad_bright *bright; /* places that may be seen; or NULL */
    double usual;                    /* luminance that records see, about */
    double far; /* stands for infinity in cell positions [unit]; without
                 * `store` they are directions */
};

/* Sample about r's hit.  False: nothing could be traced.  The cells live until
 * the caller rewinds ctx->scratch. */
bool rad_hemi_sample(struct rad_ctx *ctx, const struct rad_ray *r,
                     const struct rad_hemi_plan *plan, struct rad_hemi *h);

#endif
