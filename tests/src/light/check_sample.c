/* check_sample.c - tests of src/light: shapes of light sources, and where on
 * them to look */
#include "config.h"

#include "base/rng.h"
#include "base/vec.h"
#include "light/sample/polytree.h"
#include "light/sample/sample.h"
#include "tests/lambert.h"
#include "tests/unit.h"

#include <stdio.h>
#include <string.h>

/* --- sources from bare arguments --- */

static struct rad_arena arena;

static void
setup(void)
{
    rad_arena_init(&arena);
}

static void
teardown(void)
{
    rad_arena_release(&arena);
}

FIXTURE(setup, teardown)

static struct rad_source src; /* the light of the test */

static void
make_light(enum rad_otype type, const double *reals, int nreals)
{
    struct rad_object o = { .type = type,
                            .modifier = RAD_VOID,
                            .file = -1,
                            .name = "lamp",
                            .nreals = nreals,
                            .reals = reals };

    memset(&src, 0, sizeof src);
    ck_assert_int_eq(rad_light_shape(&src, &o, &arena), 0);
}

/* Irradiance per radiance on the surface at view->p with normal n. */
struct meter {
    double n[3], E;
    int samples;
};

static void
measure(void *arg, const struct rad_light_sample *s)
{
    struct meter *m = arg;

    m->E += fmax(0, rad_dot(s->dir, m->n)) * s->omega;
    m->samples++;
    if (fabs(rad_dot(s->aim, s->aim) - 1) > 1e-12 ||
        fabs(rad_dot(s->dir, s->dir) - 1) > 1e-12)
        ck_abort_msg("a direction is not of unit length");
}

static double
irradiance(const double p[3], const double n[3], double ds, int *samples)
{
    struct rad_light_view view = { .sizerat = ds };
    struct meter m = { .E = 0 };

    rad_copy(view.p, p);
    rad_copy(m.n, n);
    rad_light_samples(&src, &view, measure, &m);
    if (samples)
        *samples = m.samples;
    return m.E;
}

/* Mean of many jittered lookings. */
static double
irradiance_jittered(const double p[3], const double n[3], double ds, int times)
{
    struct rad_light_view view = { .sizerat = ds, .jitter = 1 };
    struct meter m = { .E = 0 };

    rad_copy(view.p, p);
    rad_copy(m.n, n);
    for (int i = 0; i < times; i++) {
        view.key = rad_key_branch(1, (uint64_t)i);
        rad_light_samples(&src, &view, measure, &m);
    }
    return m.E / times;
}

static const double up[3] = { 0, 0, 1 };

/* Lights of every polygon kind, all facing down from z = 2. */
static const double square[] = { -1, -1, 2, -1, 1, 2, 1, 1, 2, 1, -1, 2 };
static const double oblong[] = { -2, -.1, 2, -2, .1, 2, 2, .1, 2, 2, -.1, 2 };
static const double triangle[] = { 0, 0, 2, 0, 1.5, 2, 2, 0, 2 };
static const double sliver[] = { -2, 0, 2, 0, .2, 2, 2, 0, 2 };
static const double trapezoid[] = { -1, 0, 2, -.3, 1, 2, .3, 1, 2, 1, 0, 2 };
static const double arrow[] = {
    0, 0, 2, -1, -1, 2, 0, 1.5, 2, 1, -1, 2, 0, 0, 2
};
/* a square with a square hole, joined by a seam */
static const double frame[] = { -1, -1, 2,  -1, 1,   2,   1,   1,   2,   1,
                                -1, 2,  -1, -1, 2,   -.5, -.5, 2,   .5,  -.5,
                                2,  .5, .5, 2,  -.5, .5,  2,   -.5, -.5, 2 };

static const struct {
    const char *name;
    const double *v;
    int n;
    double area;
} polygon[] = {
    { "square", square, 4, 4 },         { "oblong", oblong, 4, .8 },
    { "triangle", triangle, 3, 1.5 },   { "sliver", sliver, 3, .4 },
    { "trapezoid", trapezoid, 4, 1.3 }, { "arrow", arrow, 5, 1.5 },
    { "frame", frame, 10, 3 },
};

static const double place[][3] = {
    { 0, 0, 0 }, { .7, -.4, 0 }, { 3, 1, 0 }, { 0, 0, -8 }, { -1, 5, 1 },
};

LOOP_TEST(divided_polygon_gives_the_closed_form, N_ELEM(polygon))
{
    make_light(RAD_POLYGON, polygon[_i].v, 3 * polygon[_i].n);
    ck_assert_double_eq_tol(src.size, polygon[_i].area, 1e-12);
    ck_assert_double_eq_tol(src.root.area, polygon[_i].area, 1e-12);
    for (int k = 0; k < N_ELEM(place); k++) {
        double want = lambert(polygon[_i].v, polygon[_i].n, place[k], up);
        double got = irradiance(place[k], up, .2, NULL);
        double tol = src.tree ? 1e-5 : 1e-3; /* the outline's, or moments' */

        ck_assert_msg(fabs(got - want) <= tol * want, "%s at %d: %g, not %g",
                      polygon[_i].name, k, got, want);
    }
}

LOOP_TEST(jittered_polygon_gives_the_closed_form_in_the_mean, N_ELEM(polygon))
{
    make_light(RAD_POLYGON, polygon[_i].v, 3 * polygon[_i].n);
    for (int k = 0; k < N_ELEM(place); k++) {
        double want = lambert(polygon[_i].v, polygon[_i].n, place[k], up);
        double got = irradiance_jittered(place[k], up, .5, 20000);

        ck_assert_msg(fabs(got - want) <= 1e-2 * want, "%s at %d: %g, not %g",
                      polygon[_i].name, k, got, want);
    }
}

/* Undivided, a polygon counts as a small one at its middle, as in rpict. */
TEST(undivided_polygon_is_one_sample_at_its_middle)
{
    int samples;

    make_light(RAD_POLYGON, square, 12);
    ck_assert_double_eq_tol(irradiance(place[0], up, 0, &samples), 1, 1e-12);
    ck_assert_int_eq(samples, 1);
    double x = 3, d2 = x * x + 1 + 4;

    ck_assert_double_eq_tol(irradiance(place[2], up, 0, &samples),
                            4 * 4 / (d2 * d2), 1e-12);
}

TEST(aims_are_on_the_light)
{
    const struct rad_polytree *t;

    for (int i = 0; i < N_ELEM(polygon); i++) {
        make_light(RAD_POLYGON, polygon[i].v, 3 * polygon[i].n);
        t = src.tree;
        if (!t)
            continue;
        ck_assert_msg(rad_polytree_has(t, src.root.aim, src.normal), "%s",
                      polygon[i].name);
        for (int k = 0; k < 2 && t->kid[k]; k++)
            ck_assert(
                rad_polytree_has(t->kid[k], t->kid[k]->m.aim, src.normal));
    }
}

/* Edges that two triangles share cancel in the flux, and would take as long as
 * the others. */
TEST(an_outline_has_the_polygons_edges_alone)
{
    for (int i = 0; i < N_ELEM(polygon); i++) {
        make_light(RAD_POLYGON, polygon[i].v, 3 * polygon[i].n);
        if (src.tree)
            ck_assert_int_le(src.tree->nedges, polygon[i].n);
    }
    make_light(RAD_POLYGON, frame, 3 * 10);
    ck_assert_int_eq(src.tree->nedges, 10);
    for (int k = 0; k < 2; k++)
        ck_assert_int_lt(src.tree->kid[k]->nedges, 3 * 4);
}

/* Rings about the z axis that face down at height h, seen from (x, 0, 0) with
 * the normal up. */
static const struct {
    double r0, r1, x, h;
} ring[] = {
    { 0, 1, 0, 2 },     { 0, 1, 1.5, 2 }, { 0, 1, 4, 1 },   { .5, 1, 0, 2 },
    { .9, 1, .3, 1.5 }, { .5, 1, 2, 1 },  { 0, .01, 1, 5 }, { 0, 1, 0, 1 },
};

LOOP_TEST(divided_ring_gives_the_closed_form, N_ELEM(ring))
{
    double h = ring[_i].h, p[3] = { ring[_i].x, 0, 2 - h };
    double a[8] = { 0, 0, 2, 0, 0, -3, ring[_i].r0, ring[_i].r1 };
    double want = lambert_disk(ring[_i].r1, ring[_i].x, h) -
                  lambert_disk(ring[_i].r0, ring[_i].x, h);

    make_light(RAD_RING, a, 8);
    double got = irradiance(p, up, .2, NULL);

    ck_assert_msg(fabs(got - want) <= 1e-5 * want, "%g, not %g", got, want);
    got = irradiance_jittered(p, up, .5, 100000);
    ck_assert_msg(fabs(got - want) <= 3e-3 * want, "%g, not %g", got, want);
}

/* A ring's radii, and the place that it is seen from. */
struct on_ring {
    double p[3], r0, r1;
    int samples;
};

static void
aim_is_on_ring(void *arg, const struct rad_light_sample *s)
{
    struct on_ring *m = arg;
    double t = (2 - m->p[2]) / s->aim[2], q[3];

    rad_madd(q, m->p, t, s->aim);
    ck_assert_double_ge(hypot(q[0], q[1]), m->r0);
    ck_assert_double_le(hypot(q[0], q[1]), m->r1);
    m->samples++;
}

/* The middle of a part may be in the ring's hole. */
LOOP_TEST(parts_of_a_ring_are_aimed_at, N_ELEM(ring))
{
    double a[8] = { 0, 0, 2, 0, 0, -3, ring[_i].r0, ring[_i].r1 };
    struct on_ring m = { { ring[_i].x, 0, 2 - ring[_i].h }, a[6], a[7], 0 };
    struct rad_light_view view = { .p = { m.p[0], 0, m.p[2] } };

    make_light(RAD_RING, a, 8);
    for (view.sizerat = 1; view.sizerat > .1; view.sizerat *= .8)
        rad_light_samples(&src, &view, aim_is_on_ring, &m);
    ck_assert_int_gt(m.samples, 10);
}

/* A sphere above the horizon gives pi r^2/d^2 cos, exactly (a disk seen from
 * outside is as good); with and without jitter, and at any -ds. */
TEST(sphere_gives_the_closed_form)
{
    static const double a[] = { 1, 0, 3, 1.5 };
    const double p[3] = { 0, 0, 0 };
    double want = M_PI * 2.25 / 10 * 3 / sqrt(10);

    make_light(RAD_SPHERE, a, 4);
    ck_assert_double_eq_tol(irradiance(p, up, 0, NULL), want, 1e-12);
    ck_assert_double_eq_tol(irradiance(p, up, .2, NULL), want, 1e-12);
    ck_assert_double_eq_tol(irradiance_jittered(p, up, 0, 100000), want,
                            2e-3 * want);
    ck_assert_double_eq(irradiance(a, up, 0, NULL), 0);
}

/* A thin cylinder along x at height h, centred above the point: the integral
 * of 2 r h^2 / d^4 over its length. */
TEST(cylinder_gives_the_closed_form)
{
    double L = 3, r = 5e-4, h = 2;
    double a[7] = { -L, 0, h, L, 0, h, r };
    const double p[3] = { 0, 0, 0 };
    double want = 2 * r * (L / (h * h + L * L) + atan(L / h) / h);

    make_light(RAD_CYLINDER, a, 7);
    double got = irradiance(p, up, .2, NULL);

    ck_assert_msg(fabs(got - want) <= 2e-3 * want, "%g, not %g", got, want);
    got = irradiance_jittered(p, up, .5, 20000);
    ck_assert_msg(fabs(got - want) <= 3e-3 * want, "%g, not %g", got, want);
}

/* A thick cylinder, from beside it and from beyond its end: what it sends to a
 * floor below, by the midpoint rule over its surface. */
static const double thick[][3] = {
    { 0, 0, 0 },    { .5, 1.5, .3 }, { 3, 0, .9 },
    { 6, -2, -1 },  { 0, .2, 1.39 }, { 1.3, 0, 1.3 },
};

LOOP_TEST(thick_cylinder_is_exact, N_ELEM(thick))
{
    double a[7] = { -1, 0, 2, 1, 0, 2, .6 }, E = 0;
    const double *p = thick[_i];
    int n = 1000, samples;

    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++) {
            double phi = 2 * M_PI * (i + .5) / n, x = -1 + 2 * (k + .5) / n;
            double m[3] = { 0, cos(phi), sin(phi) };
            double d[3] = { x - p[0], .6 * m[1] - p[1], 2 + .6 * m[2] - p[2] };
            double d2 = rad_dot(d, d), facing = -rad_dot(d, m);

            if (facing > 0)
                E += d[2] * facing / (d2 * d2);
        }
    E *= 2. / n * 2 * M_PI * .6 / n;
    make_light(RAD_CYLINDER, a, 7);
    ck_assert_double_eq_tol(irradiance(p, up, .2, &samples), E, 2e-4 * E);
    ck_assert_int_le(samples, 64);
    ck_assert_double_eq_tol(irradiance_jittered(p, up, .5, 50000), E, 1e-2 * E);
}

/* The ray meets the wall of the cylinder of thick_cylinder_is_exact from
 * outside, between its open ends. */
static void
aim_is_on_wall(void *arg, const struct rad_light_sample *s)
{
    const double *p = arg, *d = s->aim;
    double y = p[1], z = p[2] - 2, a = d[1] * d[1] + d[2] * d[2];
    double b = y * d[1] + z * d[2], c = y * y + z * z - .6 * .6;
    double x = p[0] - (b + sqrt(b * b - a * c)) / a * d[0];

    ck_assert_double_le(fabs(x), 1);
}

LOOP_TEST(parts_of_a_cylinder_are_aimed_at, N_ELEM(thick))
{
    double a[7] = { -1, 0, 2, 1, 0, 2, .6 };
    double p[3] = { thick[_i][0], thick[_i][1], thick[_i][2] };
    struct rad_light_view view = { .p = { p[0], p[1], p[2] } };

    make_light(RAD_CYLINDER, a, 7);
    for (view.sizerat = 1; view.sizerat > .1; view.sizerat *= .8)
        rad_light_samples(&src, &view, aim_is_on_wall, p);
}

/* Jittered aims, seen from straight below, are even about the middle of the
 * light whatever -dj, and reach about as far as -dj says. */
static const struct {
    enum rad_otype type;
    double a[12];
    int n;
    double jitter, spread; /* mean squared distance from the middle */
} jittered[] = {
    { RAD_RING, { 0, 0, 2, 0, 0, -1, 0, .1 }, 8, 1, .005 },
    /* as rpict's bent square: 2/3 .9^2 - 1/9 .9^4 */
    { RAD_RING, { 0, 0, 2, 0, 0, -1, 0, .1 }, 8, .9, .00467 },
    { RAD_RING, { 0, 0, 2, 0, 0, -1, 0, .1 }, 8, .5, .001597 },
    { RAD_RING, { 0, 0, 2, 0, 0, -1, .05, .1 }, 8, .9, .00625 },
    { RAD_POLYGON,
      { -.1, -.1, 2, -.1, .1, 2, .1, .1, 2, .1, -.1, 2 },
      12,
      .9,
      .81 * .02 / 3 },
    { RAD_SPHERE, { 0, 0, 2, .1 }, 4, .9, .81 * .005 },
};

static void
sum_place(void *arg, const struct rad_light_sample *s)
{
    double *sum = arg, x = 2 * s->aim[0] / s->aim[2];
    double y = 2 * s->aim[1] / s->aim[2];

    sum[0] += x;
    sum[1] += y;
    sum[2] += x * x + y * y;
    sum[3]++;
}

LOOP_TEST(jitter_is_even_about_the_middle, N_ELEM(jittered))
{
    struct rad_light_view view = { .jitter = jittered[_i].jitter };
    double sum[4] = { 0 };

    make_light(jittered[_i].type, jittered[_i].a, jittered[_i].n);
    for (int i = 0; i < 20000; i++) {
        view.key = rad_key_branch(1, (uint64_t)i);
        rad_light_samples(&src, &view, sum_place, sum);
    }
    ck_assert_double_le(fabs(sum[0] / sum[3]), .002);
    ck_assert_double_le(fabs(sum[1] / sum[3]), .002);
    ck_assert_double_eq_tol(sum[2] / sum[3], jittered[_i].spread,
                            .02 * jittered[_i].spread);
}

/* How many parts rpict makes of a parallelogram, or of a square of the same
 * area for a disk or hexagon, seen from p: halves until each side is below -ds
 * times the distance of its part, or there are 64.  A triangle is a smaller
 * square to it. */
static int
rpict_parts(const double p[3], int most, const double c[3], const double u[3],
            const double v[3], double ds)
{
    double a[2][3], mid[3], d2 = rad_dist2(p, c) * ds * ds / 4;
    double uu = rad_dot(u, u), vv = rad_dot(v, v);
    int k = uu > vv ? 0 : 1, n = 0;

    if (most < 2 || (d2 >= uu && d2 >= vv))
        return 1;
    rad_copy(a[0], u);
    rad_copy(a[1], v);
    rad_scale(a[k], .5, a[k]);
    for (int side = -1; side <= 1; side += 2) {
        rad_madd(mid, c, side, a[k]);
        n += rpict_parts(p, most / 2, mid, a[0], a[1], ds);
    }
    return n;
}

static const double hexagon[] = { 2,  0,          2, 1,  -1.7320508, 2,
                                  -1, -1.7320508, 2, -2, 0,          2,
                                  -1, 1.7320508,  2, 1,  1.7320508,  2 };

static const struct {
    enum rad_otype type;
    const double *a;
    int n;
} lamp[] = {
    { RAD_POLYGON, triangle, 9 },
    { RAD_POLYGON, sliver, 9 },
    { RAD_POLYGON, hexagon, 18 },
    { RAD_RING, (const double[]){ 0, 0, 2, 0, 0, -1, 0, 1 }, 8 },
    { RAD_RING, (const double[]){ 0, 0, 2, 0, 0, -1, .5, 1 }, 8 },
    { RAD_RING, (const double[]){ 0, 0, 2, 0, 0, -1, .9, 1 }, 8 },
};

/* From half the lamp's width to 20 times it, in all directions. */
LOOP_TEST(flux_is_exact_with_no_more_samples_than_a_square_takes, N_ELEM(lamp))
{
    double worst = 0, u[3] = { 0, 0, 0 }, v[3] = { 0, 0, 0 };

    make_light(lamp[_i].type, lamp[_i].a, lamp[_i].n);
    u[0] = v[1] = sqrt(src.size) / 2;
    for (double far = .5; far < 20; far *= 2) {
        long ours = 0, theirs = 0;

        for (int i = 0; i < 500; i++) {
            uint64_t key = rad_mix64((uint64_t)i + 1);
            double c = sqrt(rad_rand(key, 0)), s = sqrt(1 - c * c);
            double phi = 2 * M_PI * rad_rand(key, 1), want;
            double d = far * (1 + rad_rand(key, 2));
            double dir[3] = { s * cos(phi), s * sin(phi), -c }, p[3];
            int samples;

            rad_madd(p, src.centre, d, dir);
            if (lamp[_i].type == RAD_POLYGON)
                want = lambert(lamp[_i].a, lamp[_i].n / 3, p, up);
            else
                want = lambert_disk(lamp[_i].a[7], d * s, d * c) -
                       lambert_disk(lamp[_i].a[6], d * s, d * c);
            worst =
                fmax(worst, fabs(irradiance(p, up, .2, &samples) / want - 1));
            ours += samples;
            theirs += rpict_parts(p, 64, src.centre, u, v, .2);
        }
        ck_assert_msg(ours <= theirs, "%ld samples, not %ld, from %g", ours,
                      theirs, far);
    }
    ck_assert_double_le(worst, 1e-4);
}

/* Where -ds asks for few parts of a lamp that is near, or for one, they have
 * all of its flux: but for what the expansion of small ones leaves out. */
LOOP_TEST(few_parts_of_a_near_parallelogram_have_its_flux, 2)
{
    static const double near[][3] = {
        { 0, 0, 1.9 }, { .7, -.4, 1.5 }, { -.9, .9, 1.99 }, { 3, 1, 1.9 }
    };

    make_light(RAD_POLYGON, _i ? oblong : square, 12);
    for (int k = 0; k < N_ELEM(near); k++)
        for (double ds = .3; ds < 1e6; ds *= 2) {
            double want = lambert(_i ? oblong : square, 4, near[k], up);
            double got = irradiance(near[k], up, ds, NULL);

            ck_assert_msg(fabs(got - want) <= 1e-2 * want,
                          "%g, not %g, at %d by -ds %g", got, want, k, ds);
        }
}

/* Next to the edge the outline's chords would be off, on either side of it. */
LOOP_TEST(disk_next_to_its_edge_has_its_flux, 2)
{
    double a[8] = { 0, 0, 2, 0, 0, -1, _i ? .5 : 0, 1 };
    struct rad_light_view view = { .sizerat = 10, .up = up };

    make_light(RAD_RING, a, 8);
    for (double q = .99; q < 1.01; q += .002) {
        struct meter m = { .n = { 0, 0, 1 } };
        double want = lambert_disk(1, q, .002);

        if (_i)
            want -= lambert_disk(.5, q, .002);
        view.p[0] = q;
        view.p[2] = 1.998;
        rad_light_samples(&src, &view, measure, &m);
        ck_assert_msg(fabs(m.E - want) <= 1e-3 * want, "%g, not %g, at %g", m.E,
                      want, q);
    }
}

/* The middle of a ring with a hole is no place to aim at. */
TEST(undivided_ring_is_aimed_at)
{
    double a[8] = { 0, 0, 2, 0, 0, -1, .5, 1 };
    const double p[3] = { 0, 0, 0 };
    struct rad_light_view view = { .p = { 0, 0, 0 } };
    double sum[4] = { 0 };
    int samples;

    make_light(RAD_RING, a, 8);
    ck_assert_double_eq_tol(irradiance(p, up, 0, &samples), M_PI * .75 / 4,
                            1e-12);
    ck_assert_int_eq(samples, 1);
    rad_light_samples(&src, &view, sum_place, sum);
    ck_assert(sum[2] > .25 && sum[2] < 1); /* its squared radius */
}

/* Parts that do not reach down to the horizon are not cut: disk, ring. */
LOOP_TEST(parts_above_the_horizon_have_all_their_flux, 2)
{
    double a[8] = { 2, 0, 3, -1, 0, 0, _i ? .5 : 0, 1 };
    const double p[3] = { 0, 0, 0 };
    struct rad_light_view view = { .sizerat = .2, .up = up };
    struct meter m = { .n = { 0, 0, 1 } };

    make_light(RAD_RING, a, 8);
    rad_light_samples(&src, &view, measure, &m);
    ck_assert_double_eq_tol(m.E, irradiance(p, up, .2, NULL), 1e-12);
}

static void
aim_is_up(void *arg, const struct rad_light_sample *s)
{
    ck_assert_double_gt(s->aim[2], 0);
    measure(arg, s);
}

/* Lamps that stand across the horizon: what is above it, by the midpoint rule
 * for a disk and a ring, and by Lambert's formula for what is above of a
 * triangle.  The aims are above it too. */
LOOP_TEST(what_is_below_the_horizon_gives_nothing, 3)
{
    struct rad_light_view view = { .sizerat = .2, .up = up };
    double r0 = _i == 1 ? .6 : 0;
    int n = 1000;

    for (double d = .5; d < 9; d *= 2)
        for (double z = -.8; z < .9; z += .4) {
            double a[8] = { d, 0, z, -1, 0, 0, r0, 1 }, E = 0;
            double t[9] = { d, -1, z - 1, d, 0, z + 1, d, 1, z - 1 };
            double s = (1 + z) / 2; /* half the width at the horizon */
            double top[9] = { d, -s, 0, d, 0, z + 1, d, s, 0 };
            struct meter m = { .n = { 0, 0, 1 } };
            const double p0[3] = { 0, 0, 0 };

            for (int i = 0; _i < 2 && i < n; i++)
                for (int k = 0; k < n; k++) {
                    double r = sqrt(r0 * r0 + (1 - r0 * r0) * (i + .5) / n);
                    double f = 2 * M_PI * (k + .5) / n;
                    double p[3] = { d, r * cos(f), z + r * sin(f) };
                    double d2 = rad_dot(p, p);

                    if (p[2] > 0)
                        E += p[2] * d / (d2 * d2);
                }
            E *= M_PI * (1 - r0 * r0) / n / n;
            if (_i == 2)
                E = lambert(top, 3, p0, up);
            make_light(_i == 2 ? RAD_POLYGON : RAD_RING, _i == 2 ? t : a,
                       _i == 2 ? 9 : 8);
            rad_light_samples(&src, &view, aim_is_up, &m);
            ck_assert_double_eq_tol(m.E, fabs(E), 1e-3 * fabs(E));
        }
}

TEST(flat_light_has_a_dark_side)
{
    static const double behind[3] = { 0, 0, 3 }, in_plane[3] = { 3, 0, 2 };
    const double down[3] = { 0, 0, -1 };
    int samples;

    make_light(RAD_POLYGON, square, 12);
    irradiance(behind, down, .2, &samples);
    ck_assert_int_eq(samples, 0);
    irradiance(in_plane, down, 0, &samples);
    ck_assert_int_eq(samples, 0);
}

/* Lengths in any unit: the same numbers. */
TEST(scale_changes_nothing)
{
    static const double scale[] = { 1e-6, 1, 1e9 };
    double v[30], p[3], first = 0;

    for (int i = 0; i < N_ELEM(scale); i++) {
        for (int k = 0; k < 30; k++)
            v[k] = frame[k] * scale[i];
        rad_scale(p, scale[i], place[2]);
        make_light(RAD_POLYGON, v, 30);
        double E = irradiance(p, up, .2, NULL);

        if (i == 0)
            first = E;
        ck_assert_double_eq_tol(E, first, 1e-9 * first);
    }
}

TEST(spot_keeps_to_its_cone)
{
    /* 60 degrees about straight down, focus 2 behind */
    static const double a[7] = { 1, 1, 1, 60, 0, 0, -2 };
    const double in[3] = { 1, 0, 0 }, out[3] = { 1.3, 0, 0 };

    make_light(RAD_RING, (double[]){ 0, 0, 2, 0, 0, -1, 0, .01 }, 8);
    ck_assert(rad_spot_init(&src.spot, a));
    double bare = irradiance(in, up, 0, NULL), d = sqrt(5);

    src.flags |= RAD_LIGHT_SPOT;
    rad_light_set_apex(&src);
    ck_assert_double_eq_tol(irradiance(in, up, 0, NULL),
                            bare * d * d / ((d + 2) * (d + 2)), 1e-12);
    ck_assert_double_eq(irradiance(out, up, 0, NULL), 0);
    ck_assert(!rad_spot_init(&src.spot, (double[]){ 1, 1, 1, 0, 0, 0, 1 }));
    ck_assert(!rad_spot_init(&src.spot, (double[]){ 1, 1, 1, 9, 0, 0, 0 }));
}

TEST(what_a_cone_cannot_light_is_known_early)
{
    static const double a[7] = { 1, 1, 1, 60, .3, 0, -2 };
    int lit = 0;

    make_light(RAD_RING, (double[]){ 0, 0, 2, 0, 0, -1, 0, .5 }, 8);
    ck_assert(rad_spot_init(&src.spot, a));
    src.flags |= RAD_LIGHT_SPOT;
    for (int i = 0; i < 3000; i++) {
        double p[3] = { .002 * i - 3, .0007 * (i % 200), .0006 * i };

        src.apex = INFINITY;
        double E = irradiance(p, up, .1, NULL);

        rad_light_set_apex(&src);
        ck_assert_double_eq(irradiance(p, up, .1, NULL), E);
        lit += E > 0;
    }
    ck_assert_int_gt(lit, 500);
    ck_assert_int_lt(lit, 2500);
}

TEST(no_area_and_cones_are_no_light)
{
    struct rad_object o = { .type = RAD_POLYGON,
                            .modifier = RAD_VOID,
                            .file = -1,
                            .name = "lamp",
                            .nreals = 9,
                            .reals = (double[]){ 0, 0, 0, 1, 1, 1, 2, 2, 2 } };

    memset(&src, 0, sizeof src);
    ck_assert_int_eq(rad_light_shape(&src, &o, &arena), 1);
    o.type = RAD_CONE; /* with radii that differ, or it is a cylinder */
    o.nreals = 8;
    o.reals = (double[]){ 0, 0, 0, 0, 0, 1, 2, 1 };
    ck_assert_int_eq(rad_light_shape(&src, &o, &arena), RAD_EDATA);
}
