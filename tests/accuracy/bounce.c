/* bounce.c - closed forms of indirect light, with the cache at work
 *
 * Points and rays are strewn over each scene, so that most values are
 * interpolated.  What is measured is the root mean square of the error in
 * units of the mean truth, the error of a mean, or what leaks.
 * Tolerances: sampled forms may be off by the noise of their hemispheres: up to
 * twice what is measured, and above a floor what rtrace is off by with the same
 * options and points.  Where every sample has the same value the rounding of
 * floats is all that may be left, and light that leaks has no tolerance, but
 * for what a crack lets in. */
#include "config.h"

#include "hard.h"
#include "stage.h"
#include "base/rng.h"
#include "base/vec.h"
#include "trace/ray.h"
#include "tests/lambert.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Nothing is cut short. */
#define EXACT "-lw 0 -lr 20 -dt 0 -dj 0 -st 0 "

static const double up[3] = { 0, 0, 1 };

/* --- errors --- */

struct errors {
    double sum, square, truth; /* of the differences; of what they are from */
    int n;
};

static void
note(struct errors *e, double found, double truth)
{
    e->sum += found - truth;
    e->square += (found - truth) * (found - truth);
    e->truth += truth;
    e->n++;
}

static double
rms(const struct errors *e)
{
    return sqrt(e->square / e->n) / (e->truth / e->n);
}

static double
bias(const struct errors *e)
{
    return fabs(e->sum / e->truth);
}

/* Irradiance at p on the side of n, with random numbers of its own. */
static double
irradiance(struct stage *s, const double p[3], const double n[3], int i)
{
    struct rad_ray r;

    rad_ray_irradiance(&s->ctx, &r, p, n, rad_key_branch(77, (uint64_t)i));
    return r.L.r;
}

static double
radiance(struct stage *s, const double from[3], const double way[3], int i)
{
    return stage_radiance(s, from, way, rad_key_branch(78, (uint64_t)i));
}

/* Places to look at, where each may need a record. */
static int
few(int effort)
{
    return effort > 1 ? 1000 : 200;
}

/* A random direction. */
static void
random_way(int i, double way[3])
{
    uint64_t key = rad_key_branch(79, (uint64_t)i);
    double z = 2 * rad_rand(key, 0) - 1, t = 2 * M_PI * rad_rand(key, 1);
    double r = sqrt(fmax(0, 1 - z * z));

    way[0] = r * cos(t);
    way[1] = r * sin(t);
    way[2] = z;
}

/* --- furnaces --- */

/* White things in a uniform glow, and -av for what is beyond the last bounce:
 * no place may differ from the glow, whatever it sees and however many bounces
 * there are (a[0]). */
static double
white_furnace(struct stage *s, const double *a)
{
    char options[160];
    struct errors e = { 0 };

    snprintf(options, sizeof options,
             EXACT "-ab %d -aa .2 -ar 64 -ad 1024 -as 64 -av 2 2 2", (int)a[0]);
    stage_open(s, options,
               "void glow g 0 0 4 2 2 2 0\ng source sky 0 0 4 0 0 1 360\n"
               "void plastic p 0 0 5 1 1 1 0 0\n"
               "p ring floor 0 0 8 0 0 0 0 0 1 0 3\n"
               "p polygon wall 0 0 12 -1 1 0 1 1 0 1 1 2 -1 1 2\n"
               "p polygon side 0 0 12 1 1 0 1 -1 0 1 -1 2 1 1 2\n"
               "p sphere ball 0 0 4 0 0 .5 .5\n"
               "p cup pot 0 0 8 -1 -1 0 -1 -1 .8 .2 .5\n"
               "p tube pipe 0 0 7 0 0 1.2 2 .5 1.5 .1\n");
    for (int i = 0; i < 1000 * (s->effort > 1 ? 4 : 1); i++) {
        double from[3] = { -2, -2, 2.5 }, to[3];
        uint64_t key = rad_key_branch(80, (uint64_t)i);

        for (uint32_t k = 0; k < 3; k++)
            to[k] = 3 * rad_rand(key, k) - (k < 2 ? 1.5 : .5) - from[k];
        note(&e, radiance(s, from, to, i), 2);
    }
    return rms(&e);
}

/* --- spheres --- */

/* A patch of a sphere, a glowing disk in its mouth of radius .5, lights every
 * other place alike, pi (1 - z) / 2 with the mouth at height z: an integrating
 * sphere's wall sees equal patches alike (Sumpner 1892).  So all gradients are
 * zero, and interpolation can do no harm.  a[0]: mean instead. */
static double
patch_in_sphere(struct stage *s, const double *a)
{
    static const double in[3] = { .2, .1, -.3 };
    double z = sqrt(.75);
    struct errors e = { 0 };

    stage_open(s, EXACT "-ab 1 -aa .1 -ar 64 -ad 2048 -as 0",
               "void glow g 0 0 4 1 1 1 0\n"
               "g ring d 0 0 8 0 0 %.17g 0 0 -1 0 .5\n"
               "void plastic p 0 0 5 .5 .5 .5 0 0\n"
               "p bubble wall 0 0 4 0 0 0 1\n",
               z);
    for (int i = 0; i < few(s->effort); i++) {
        double way[3];

        random_way(i, way);
        way[2] = -fabs(way[2]);
        note(&e, radiance(s, in, way, i), .5 * (1 - z) / 2);
    }
    return a[0] != 0 ? bias(&e) : rms(&e);
}

/* A glowing sphere that reflects nothing, in the middle of one twice as large
 * of reflectance a[0]: a quarter of what any place of the wall sees is the
 * inner sphere, by the cosine, the rest is wall (Howell 2010, C-129), a[1]
 * times over.  A record of few bounces may not serve where more are asked for,
 * but one of more does where few would do: reflectances are such that what the
 * next bounce would add is below the tolerance.  a[2]: mean instead. */
static double
sphere_in_sphere(struct stage *s, const double *a)
{
    double L = 0;
    char options[160];
    struct errors e = { 0 };

    snprintf(options, sizeof options,
             EXACT "-ab %d -aa .2 -ar 64 -ad 512 -as 0", (int)a[1]);
    stage_open(s, options,
               "void glow g 0 0 4 1 1 1 0\ng sphere inner 0 0 4 0 0 0 1\n"
               "void plastic p 0 0 5 %.17g %.17g %.17g 0 0\n"
               "p bubble wall 0 0 4 0 0 0 2\n",
               a[0], a[0], a[0]);
    for (int k = 0; k < (int)a[1]; k++)
        L = a[0] * (.25 + .75 * L);
    for (int i = 0; i < few(s->effort); i++) {
        double from[3], way[3];

        random_way(i, from);
        rad_scale(from, 1.2, from);
        rad_copy(way, from);
        note(&e, radiance(s, from, way, i), L);
    }
    return a[2] != 0 ? bias(&e) : rms(&e);
}

/* --- rectangles --- */

/* From a rectangle of radiance 1 at height z that looks down. */
static double
ceiling_light(const double p[3], double x0, double y0, double x1, double y1,
              double z)
{
    double v[12] = { x0, y0, z, x0, y1, z, x1, y1, z, x1, y0, z };

    return lambert(v, 4, p, up);
}

/* A uniform patch above a black floor, at 60 x 60 points (Lambert 1760), with
 * -ad a[0] and -aa a[1].  a[2]: mean instead. */
static double
patch_above_floor(struct stage *s, const double *a)
{
    char options[160];
    struct errors e = { 0 };

    snprintf(options, sizeof options, EXACT "-ab 1 -aa %g -ar 0 -ad %d -as 0",
             a[1], (int)a[0]);
    stage_open(s, options,
               "void glow g 0 0 4 1 1 1 0\n"
               "g polygon patch 0 0 12 -1 -1 1 -1 1 1 1 1 1 1 -1 1\n"
               "void plastic p 0 0 5 0 0 0 0 0\n"
               "p polygon floor 0 0 12 -2 -2 0 2 -2 0 2 2 0 -2 2 0\n");
    for (int i = 0; i < 3600; i++) {
        /* points are asked for in no order */
        int k = i * 1103 % 3600;
        double p[3] = { -2 + (k % 60 + .5) / 15., -2 + (k / 60 + .5) / 15., 0 };

        note(&e, irradiance(s, p, up, i), ceiling_light(p, -1, -1, 1, 1, 1));
    }
    return a[2] != 0 ? bias(&e) : rms(&e);
}

/* The floor of a cube whose ceiling glows and that reflects nothing else, at
 * Gauss's points: pointwise by Lambert, and with a[0] the form factor between
 * opposite faces (Howell 2010, C-11), with a[0] = 2 between adjacent ones. */
static double
cube_enclosure(struct stage *s, const double *a)
{
    static const double side[3] = { 1, 0, 0 };
    double x[STAGE_GAUSS], w[STAGE_GAUSS], q = sqrt(2), F, sum = 0;
    struct errors e = { 0 };

    stage_open(s, EXACT "-ab 1 -aa .1 -ar 64 -ad 1024 -as 0",
               "void glow g 0 0 4 1 1 1 0\n"
               "g polygon t 0 0 12 0 0 1 0 1 1 1 1 1 1 0 1\n"
               "void plastic p 0 0 5 0 0 0 0 0\n"
               "p polygon f 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n"
               "p polygon a 0 0 12 0 0 0 0 1 0 0 1 1 0 0 1\n"
               "p polygon b 0 0 12 1 0 0 1 0 1 1 1 1 1 1 0\n"
               "p polygon c 0 0 12 0 0 0 0 0 1 1 0 1 1 0 0\n"
               "p polygon d 0 0 12 0 1 0 1 1 0 1 1 1 0 1 1\n");
    stage_gauss(24, x, w);
    for (int i = 0; i < 24 * 24; i++) {
        double u = x[i / 24], v = x[i % 24];
        double floor[3] = { u, v, 0 }, wall[3] = { 0, u, v };
        double E = a[0] == 2 ? irradiance(s, wall, side, i)
                             : irradiance(s, floor, up, i);

        if (a[0] == 0)
            note(&e, E, ceiling_light(floor, 0, 0, 1, 1, 1));
        sum += w[i / 24] * w[i % 24] * E / M_PI;
    }
    F = 2 / M_PI * (log(2 / sqrt(3)) + 2 * q * atan(1 / q) - M_PI / 2);
    if (a[0] == 2)
        F = (1 - F) / 4;
    return a[0] == 0 ? rms(&e) : fabs(sum / F - 1);
}

/* A floor before a glowing wall, a[0] from the corner that they make, where
 * the irradiance is close to pi / 2 and falls with the distance (Howell 2010,
 * B-4: a wall 4 wide and 1 high, seen from before its middle). */
static double
inside_corner(struct stage *s, const double *a)
{
    struct errors e = { 0 };

    stage_open(s, EXACT "-ab 1 -aa .1 -ar 128 -ad 1024 -as 0",
               "void glow g 0 0 4 1 1 1 0\n"
               "g polygon wall 0 0 12 0 -2 0 0 2 0 0 2 1 0 -2 1\n"
               "void plastic p 0 0 5 0 0 0 0 0\n"
               "p polygon floor 0 0 12 0 -2 0 2 -2 0 2 2 0 0 2 0\n");
    for (int i = 0; i < 400; i++) {
        uint64_t key = rad_key_branch(82, (uint64_t)i);
        double p[3] = { a[0] * (.5 + rad_rand(key, 0)),
                        2 * rad_rand(key, 1) - 1, 0 };
        double r = hypot(1, p[0]), E = 0;

        for (int k = -1; k <= 1; k += 2) {
            double b = 2 - k * p[1];

            E += (atan(b / p[0]) - p[0] / r * atan(b / r)) / 2;
        }
        note(&e, irradiance(s, p, up, i), E);
    }
    return rms(&e);
}

/* --- closed boxes --- */

/* Where all that a lamp sends stays in a box of reflectance a[0], a bounce
 * falls on its walls with a[0] times the flux of the one before, whatever the
 * form factors: 4 pi^2 r^2 (1 + a[0] + ...), a[1] bounces (conservation of
 * energy). */
static double
box_flux(struct stage *s, const double *a)
{
    static const double size[3] = { 2, 1.5, 1 };
    double x[STAGE_GAUSS], w[STAGE_GAUSS], sum = 0, share = 0;
    char options[160];

    snprintf(options, sizeof options,
             EXACT "-ab %d -aa .15 -ar 32 -ad 256 -as 64", (int)a[1]);
    stage_open(s, options,
               "void light l 0 0 3 1 1 1\nl sphere b 0 0 4 .9 .7 .6 .004\n"
               "void plastic p 0 0 5 %.17g %.17g %.17g 0 0\n"
               "p polygon f 0 0 12 0 0 0 2 0 0 2 1.5 0 0 1.5 0\n"
               "p polygon t 0 0 12 0 0 1 0 1.5 1 2 1.5 1 2 0 1\n"
               "p polygon a 0 0 12 0 0 0 0 1.5 0 0 1.5 1 0 0 1\n"
               "p polygon b 0 0 12 2 0 0 2 0 1 2 1.5 1 2 1.5 0\n"
               "p polygon c 0 0 12 0 0 0 0 0 1 2 0 1 2 0 0\n"
               "p polygon d 0 0 12 0 1.5 0 2 1.5 0 2 1.5 1 0 1.5 1\n",
               a[0], a[0], a[0]);
    stage_gauss(16, x, w);
    for (int i = 0; i < 6 * 256; i++) {
        int f = i / 256, k = f / 2, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        int u = i / 16 % 16, v = i % 16;
        double p[3], n[3] = { 0, 0, 0 };

        p[k] = f % 2 ? size[k] : 0;
        p[k1] = size[k1] * x[u];
        p[k2] = size[k2] * x[v];
        n[k] = f % 2 ? -1 : 1;
        sum += size[k1] * size[k2] * w[u] * w[v] * irradiance(s, p, n, i);
    }
    for (int k = 0; k <= (int)a[1]; k++)
        share += pow(a[0], k);
    return fabs(sum / (4 * M_PI * M_PI * 1.6e-5 * share) - 1);
}

/* A shaft of four mirrors of reflectance a[0] with a glow on top: its images in
 * them light the floor as rectangles do that lie side by side, each as often
 * dimmed as mirrors lie between. */
static double
shaft_of_mirrors(struct stage *s, const double *a)
{
    struct errors e = { 0 };

    stage_open(s,
               "-lw 0 -lr 40 -dt 0 -dj 0 -st 0 "
               "-ab 1 -aa .1 -ar 64 -ad 1024 -as 0",
               "void glow g 0 0 4 1 1 1 0\n"
               "g polygon t 0 0 12 0 0 1 0 1 1 1 1 1 1 0 1\n"
               "void plastic p 0 0 5 0 0 0 0 0\n"
               "p polygon f 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n"
               "void mirror m 0 0 3 %.17g %.17g %.17g\n"
               "m polygon a 0 0 12 0 0 0 0 1 0 0 1 1 0 0 1\n"
               "m polygon b 0 0 12 1 0 0 1 0 1 1 1 1 1 1 0\n"
               "m polygon c 0 0 12 0 0 0 0 0 1 1 0 1 1 0 0\n"
               "m polygon d 0 0 12 0 1 0 1 1 0 1 1 1 0 1 1\n",
               a[0], a[0], a[0]);
    for (int i = 0; i < 300; i++) {
        uint64_t key = rad_key_branch(83, (uint64_t)i);
        double p[3] = { rad_rand(key, 0), rad_rand(key, 1), 0 }, E = 0;

        for (int u = -30; u <= 30; u++)
            for (int v = -30; v <= 30; v++)
                E += pow(a[0], abs(u) + abs(v)) *
                     ceiling_light(p, u, v, u + 1, v + 1, 1);
        note(&e, irradiance(s, p, up, i), E);
    }
    return rms(&e);
}

/* --- leaks --- */

/* A lit room beside a dark one on a common floor, under a common ceiling.
 * Between them a wall that is a[0] thick (0: one polygon), which stops a[1]
 * above the floor.  The largest radiance of the dark room, in units of the lit
 * one's mean. */
static double
leak(struct stage *s, const double *a)
{
    double dark = 0, lit = 0;
    int n = 600 * (s->effort > 1 ? 8 : 1);

    stage_open(s, EXACT "-ab 2 -aa .2 -ad 64 -as 0 -ar 64",
               "void plastic p 0 0 5 .7 .7 .7 0 0\n"
               "void light l 0 0 3 100 100 100\nl sphere b 0 0 4 -1 0 0 .2\n"
               "p polygon w 0 0 12 0 -1 %.17g 0 1 %.17g 0 1 1 0 -1 1\n"
               "p polygon v 0 0 12 %.17g -1 %.17g %.17g -1 1 %.17g 1 1 "
               "%.17g 1 %.17g\n"
               "p polygon f 0 0 12 -2 -1 -1 2 -1 -1 2 1 -1 -2 1 -1\n"
               "p polygon c 0 0 12 -2 -1 1 -2 1 1 2 1 1 2 -1 1\n"
               "p polygon s 0 0 12 -2 -1 -1 -2 -1 1 2 -1 1 2 -1 -1\n"
               "p polygon t 0 0 12 -2 1 -1 2 1 -1 2 1 1 -2 1 1\n"
               "p polygon e 0 0 12 2 -1 -1 2 -1 1 2 1 1 2 1 -1\n"
               "p polygon d 0 0 12 -2 -1 -1 -2 1 -1 -2 1 1 -2 -1 1\n",
               a[1] - 1, a[1] - 1, a[0], a[1] - 1, a[0], a[0], a[0], a[1] - 1);
    for (int i = 0; i < n; i++) {
        uint64_t key = rad_key_branch(84, (uint64_t)i);
        /* half of the places are close to the wall's foot */
        double near = i % 4 < 2 ? .02 : 1;
        double from[3] = { -1, .3, -.5 };
        double to[3] = { -near * rad_rand(key, 0), 2 * rad_rand(key, 1) - 1,
                         -1 };

        if (i % 2) {
            from[0] = 1;
            to[0] = a[0] - to[0];
        }
        rad_sub(to, to, from);
        if (i % 2)
            dark = fmax(dark, radiance(s, from, to, i));
        else
            lit += radiance(s, from, to, i) / (n / 2);
    }
    return dark / lit;
}

/* A box with walls of one polygon each in a lit room, on its floor: the largest
 * radiance inside. */
static double
box_in_room(struct stage *s, const double *a)
{
    double dark = 0, lit = 0;
    int n = 600;

    (void)a;
    stage_open(s, EXACT "-ab 2 -aa .2 -ad 64 -as 0 -ar 64",
               "void plastic p 0 0 5 .7 .7 .7 0 0\n"
               "void light l 0 0 3 100 100 100\nl sphere b 0 0 4 0 0 3 .2\n"
               "p bubble room 0 0 4 0 0 2 4\n"
               "p polygon floor 0 0 12 -3 -3 0 3 -3 0 3 3 0 -3 3 0\n"
               "p polygon a 0 0 12 .5 -.5 0 .5 .5 0 .5 .5 1 .5 -.5 1\n"
               "p polygon b 0 0 12 -.5 -.5 0 -.5 -.5 1 -.5 .5 1 -.5 .5 0\n"
               "p polygon c 0 0 12 -.5 .5 0 -.5 .5 1 .5 .5 1 .5 .5 0\n"
               "p polygon d 0 0 12 -.5 -.5 0 .5 -.5 0 .5 -.5 1 -.5 -.5 1\n"
               "p polygon t 0 0 12 -.5 -.5 1 .5 -.5 1 .5 .5 1 -.5 .5 1\n");
    for (int i = 0; i < n; i++) {
        static const double in[3] = { .1, .1, .5 };
        uint64_t key = rad_key_branch(85, (uint64_t)i);
        double way[3], from[3] = { 1.5, 1.5, 1.5 };

        random_way(i, way);
        if (i % 2) {
            dark = fmax(dark, radiance(s, in, way, i));
            continue;
        }
        for (uint32_t k = 0; k < 2; k++)
            way[k] = 1.4 * rad_rand(key, k) - .7 - from[k];
        way[2] = 1.1 * rad_rand(key, 2) - from[2];
        lit += radiance(s, from, way, i) / (n / 2);
    }
    return dark / lit;
}

const struct hard_row bounce_rows[] = {
    /* clang-format off */
    { "white furnace, 1 bounce", white_furnace, { 1 }, 1e-6 },
    { "white furnace, 3 bounces", white_furnace, { 3 }, 1e-6 },
    { "patch in a sphere", patch_in_sphere, { 0 }, .025 },
    { "patch in a sphere: mean", patch_in_sphere, { 1 }, .005 },
    { "sphere in a sphere", sphere_in_sphere, { .2, 1, 0 }, .02 },
    { "sphere in a sphere, 4 bounces", sphere_in_sphere, { .2, 4, 0 }, .02 },
    { "sphere in a sphere, 4 bounces: mean", sphere_in_sphere, { .2, 4, 1 },
      .005 },
    { "patch above a floor, -ad 2048 -aa .1", patch_above_floor,
      { 2048, .1, 0 }, .0089 },
    { "patch above a floor, -ad 256 -aa .2", patch_above_floor,
      { 256, .2, 0 }, .041 },
    { "patch above a floor: mean", patch_above_floor, { 256, .2, 1 }, .002 },
    { "floor of a cube under a glow", cube_enclosure, { 0 }, .03 },
    { "form factor of opposite faces", cube_enclosure, { 1 }, .005 },
    { "form factor of adjacent faces", cube_enclosure, { 2 }, .005 },
    { "inside corner, at 1e-1", inside_corner, { 1e-1 }, .015 },
    { "inside corner, at 1e-3", inside_corner, { 1e-3 }, .015 },
    { "inside corner, at 1e-6", inside_corner, { 1e-6 }, .015 },
    { "flux in a closed box, 1 bounce", box_flux, { .5, 1 }, .001 },
    { "flux in a closed box, 5 bounces", box_flux, { .3, 5 }, .002 },
    { "shaft of mirrors", shaft_of_mirrors, { .5 }, .015 },
    { "shaft of mirrors of reflectance .9", shaft_of_mirrors, { .9 }, .015 },
    { "light through a wall without thickness", leak, { 0, 0 }, 0 },
    { "light through a wall 1e-6 thick", leak, { 1e-6, 0 }, 0 },
    { "light through a wall 1e-3 thick", leak, { 1e-3, 0 }, 0 },
    { "light under a wall with a crack of 1e-6", leak, { 0, 1e-6 }, 1e-4 },
    { "light into a box without thickness", box_in_room, { 0 }, 0 },
    { NULL, NULL, { 0 }, 0 }
    /* clang-format on */
};
