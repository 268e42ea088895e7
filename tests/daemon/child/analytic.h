/* analytic.h - pictures by formula, for tests of the sampler without a scene
 *
 * Each kind is one trait of rendered pictures that decides what is sampled:
 * flat areas, gradients, edges, thin lines, small things, noise; and an
 * interior that has them all, as an office does.  A pixel is a function of
 * (kind, seed, x, y). */
#ifndef RADD_TESTS_ANALYTIC_H
#define RADD_TESTS_ANALYTIC_H

#include "base/rng.h"
#include "picture/quincunx.h"

#include <math.h>

enum analytic_kind {
    ANALYTIC_FLAT,
    ANALYTIC_GRADIENT,
    ANALYTIC_EDGES,
    ANALYTIC_LINES,
    ANALYTIC_DISCS,
    ANALYTIC_NOISE,
    ANALYTIC_INTERIOR,
    ANALYTIC_KINDS
};

static const char *const analytic_name[] = { "flat",    "gradient", "edges",
                                             "lines",   "discs",    "noise",
                                             "interior" };

struct analytic {
    enum analytic_kind kind;
    uint64_t seed;
};

/* Random number i of the picture. */
static inline double
analytic_random(const struct analytic *a, uint32_t i)
{
    return rad_rand(rad_mix64(a->seed + 1), i);
}

/* On which side of a random line through the picture? */
static inline double
analytic_side(const struct analytic *a, uint32_t i, double x, double y)
{
    double angle = 6.283185307179586 * analytic_random(a, 3 * i);
    double px = 200 * analytic_random(a, 3 * i + 1);
    double py = 150 * analytic_random(a, 3 * i + 2);

    return cos(angle) * (x - px) + sin(angle) * (y - py);
}

static inline double
analytic_edges(const struct analytic *a, int n, double x, double y)
{
    double v = 1;

    for (int i = 0; i < n; i++)
        if (analytic_side(a, (uint32_t)i, x, y) > 0)
            v *= i % 2 ? 1.6 : .55;
    return v;
}

static inline double
analytic_lines(const struct analytic *a, int n, double x, double y)
{
    double v = .5;

    for (int i = 0; i < n; i++)
        if (fabs(analytic_side(a, (uint32_t)i, x, y)) <
            .4 + analytic_random(a, 1000 + (uint32_t)i))
            v = 2;
    return v;
}

static inline double
analytic_discs(const struct analytic *a, int n, double x, double y)
{
    double v = .4;

    for (int i = 0; i < n; i++) {
        uint32_t k = 2000 + 3 * (uint32_t)i;
        double dx = x - 200 * analytic_random(a, k);
        double dy = y - 150 * analytic_random(a, k + 1);
        double r = 1 + 5 * analytic_random(a, k + 2);

        if (dx * dx + dy * dy < r * r)
            v = 1 + .3 * (i % 3);
    }
    return v;
}

static inline double
analytic_noise(const struct analytic *a, int x, int y)
{
    return rad_rand(rad_key_pixel(a->seed, 0, (uint32_t)x, (uint32_t)y), 0);
}

/* Walls, a window, furniture with edges, rails, soft shadows, and a rug and a
 * penumbra that are sampled at random. */
static inline double
analytic_interior(const struct analytic *a, int x, int y)
{
    double v =
        .6 + .002 * x + .25 * exp(-.0004 * ((x - 60) * (x - 60) + y * y));

    v *= analytic_edges(a, 5, x, y);
    if (analytic_lines(a, 3, x, y) > 1)
        v *= 1.5;
    if (analytic_discs(a, 12, x, y) >= 1)
        v *= .5;
    if (analytic_side(a, 100, x, y) > 60)
        v *= 1 + .3 * (analytic_noise(a, x, y) - .5);
    if (fabs(analytic_side(a, 101, x, y)) < 6)
        v *= 1 + .15 * floor(4 * analytic_noise(a, x, y));
    return v;
}

static inline double
analytic_grey(const struct analytic *a, int x, int y)
{
    switch (a->kind) {
    case ANALYTIC_GRADIENT:
        return .2 + .01 * x + .015 * y +
               .1 * sin(.07 * x * (1 + analytic_random(a, 9)));
    case ANALYTIC_EDGES:
        return analytic_edges(a, 12, x, y);
    case ANALYTIC_LINES:
        return analytic_lines(a, 14, x, y);
    case ANALYTIC_DISCS:
        return analytic_discs(a, 60, x, y);
    case ANALYTIC_NOISE:
        return analytic_noise(a, x, y);
    case ANALYTIC_INTERIOR:
        return analytic_interior(a, x, y);
    default:
        return .3;
    }
}

/* False: the view shows nothing there, as in the corners of a fisheye's. */
static inline bool
analytic_pixel(const struct analytic *a, bool depth, int x, int y,
               struct rad_pixel *out)
{
    double v = analytic_grey(a, x, y);

    out->L = rad_grey(0);
    out->z = 0;
    if (a->seed % 5 == 0 && analytic_side(a, 200, x, y) > 90)
        return false;
    out->L = rad_rgb((float)v, (float)(.8 * v), (float)(.5 * v + .1));
    if (depth)
        out->z = analytic_side(a, 300, x, y) > 0 ? 3 : 4 + .01f * (float)x;
    return true;
}

/* What is painted after sampling, as small sources are: two bright dots on
 * some rows. */
static inline void
analytic_paint(const struct analytic *a, int x0, int x1, int y,
               struct rad_pixel *row)
{
    for (int i = 0; i < 2; i++) {
        int x = (int)(200 *
                      analytic_random(a, 400 + 2 * (uint32_t)y + (uint32_t)i));

        if (y % 3 != 1 && x >= x0 && x < x1)
            row[x - x0].L = rad_grey(30);
    }
}

#endif
