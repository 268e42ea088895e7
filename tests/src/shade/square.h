/* square.h - what the tests of gloss look at: a square under suns or a sky
 *
 * The square lies in the plane z = 0 and is seen at the origin, in the plane
 * y = 0 from the side of negative x.  */
#ifndef RADD_TESTS_SQUARE_H
#define RADD_TESTS_SQUARE_H

#include "suns.h"
#include "tests/world.h"

#include <math.h>
#include <stdio.h>

/* Of a material m. */
#define SQUARE "m polygon s 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
/* Half a sky of radiance 1. */
#define ABOVE "void glow white 0 0 4 1 1 1 0 white source sky 0 0 4 0 0 1 180\n"
#define BELOW                                                                  \
    "void glow white 0 0 4 1 1 1 0 white source sky 0 0 4 0 0 -1 180\n"
/* Options under which suns alone give light, or nothing is left to chance. */
#define DIRECT "-av 0 0 0 -st 1 -dj 0 -dt 0"
#define PLAIN  "-av 0 0 0 -st 0 -lw 0 -lr 30 -ss 0"

#define RADIANS(deg) ((deg)*M_PI / 180)

/* What a view from deg degrees off the zenith sees; files: of functions and
 * data, or NULL. */
static inline struct rad_rgb
see_with(const char *scene, const char *options, const struct rad_files *files,
         double deg)
{
    struct rad_rgb L;
    struct world w = { 0 };
    int rc = world_try(&w, scene, options, files);

    ck_assert_msg(rc == 0, "%s: %s", w.err.where, w.err.what);
    L = world_tilted(&w, deg);
    world_close(&w);
    return L;
}

static inline struct rad_rgb
see(const char *scene, const char *options, double deg)
{
    return see_with(scene, options, NULL, deg);
}

/* Single samples of a square of that material, seen from straight above,
 * spread: the mean square of the axis' direction cosine, of n of them.  The sky
 * is brighter by that much the farther it is along the axis (0: x). */
static inline double
square_spread(const char *material, const char *options, int axis, int n)
{
    char scene[512];
    double sum = 0;
    struct world w = { 0 };

    snprintf(scene, sizeof scene,
             "void brightfunc p 2 2+%s . 0 0 p glow white 0 0 4 1 1 1 0\n"
             "white source sky 0 0 4 0 0 1 180\n%s\n" SQUARE,
             axis ? "Dy" : "Dx", material);
    world_open(&w, scene, options);
    for (int i = 0; i < n; i++) {
        struct rad_ray r;

        world_ray(&w, &r, 0, 0, 5, 0, 0, -1);
        r.key = (uint64_t)i + 1;
        rad_ray_trace(&w.ctx, &r);
        sum += pow(r.L.r - 2, 2) / n;
    }
    world_close(&w);
    return sum;
}

static inline void
direction(double dir[3], double theta_deg, double phi_deg)
{
    double t = RADIANS(theta_deg), p = RADIANS(phi_deg);

    dir[0] = sin(t) * cos(p);
    dir[1] = sin(t) * sin(p);
    dir[2] = cos(t);
}

#endif
