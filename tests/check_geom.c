/* check_geom.c - where rays meet surfaces: known answers and hard cases */
#include "config.h"

#include "geom/geom.h"
#include "geom_scene.h"
#include "unit.h"

#include <math.h>

/* clang-format off */
/* One surface, one ray, and where it must be met. */
static const struct {
    const char *what;
    enum rad_otype type;
    int nreals;
    double reals[16];
    double ray[6]; /* origin, direction (any length) */
    double t;      /* 0: a miss */
    double n[3];
} closed[] = {
    { "square", RAD_POLYGON, 12, { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
      { .25, .5, 2, 0, 0, -1 }, 2, { 0, 0, 1 } },
    { "square from behind", RAD_POLYGON, 12,
      { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
      { .25, .5, -3, 0, 0, 1 }, 3, { 0, 0, 1 } },
    { "beside the square", RAD_POLYGON, 12,
      { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
      { 1.25, .5, 2, 0, 0, -1 }, 0, { 0 } },
    { "along the square", RAD_POLYGON, 12,
      { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
      { -1, .5, 0, 1, 0, 0 }, 0, { 0 } },
    { "away from the square", RAD_POLYGON, 12,
      { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
      { .25, .5, 2, 0, 0, 1 }, 0, { 0 } },
    { "triangle", RAD_POLYGON, 9, { 0, 0, 0, 0, 4, 0, 0, 0, 4 },
      { -1, 1, 1, 1, 0, 0 }, 1, { 1, 0, 0 } },
    { "notch of a concave face", RAD_POLYGON, 15,
      { 0, 0, 0, 4, 0, 0, 4, 4, 0, 2, 1, 0, 0, 4, 0 },
      { 2, 2, 1, 0, 0, -1 }, 0, { 0 } },
    { "arm of a concave face", RAD_POLYGON, 15,
      { 0, 0, 0, 4, 0, 0, 4, 4, 0, 2, 1, 0, 0, 4, 0 },
      { 3.5, 2, 1, 0, 0, -1 }, 1, { 0, 0, 1 } },
    { "sphere", RAD_SPHERE, 4, { 1, 2, 3, 2 }, { 1, 2, 10, 0, 0, -1 }, 5,
      { 0, 0, 1 } },
    { "sphere from inside", RAD_SPHERE, 4, { 1, 2, 3, 2 },
      { 1, 2, 3, 0, 1, 0 }, 2, { 0, 1, 0 } },
    { "bubble", RAD_BUBBLE, 4, { 1, 2, 3, 2 }, { 1, 2, 10, 0, 0, -1 }, 5,
      { 0, 0, -1 } },
    { "sphere of negative radius", RAD_SPHERE, 4, { 1, 2, 3, -2 },
      { 1, 2, 10, 0, 0, -1 }, 5, { 0, 0, -1 } },
    { "beside the sphere", RAD_SPHERE, 4, { 1, 2, 3, 2 },
      { 3.01, 2, 10, 0, 0, -1 }, 0, { 0 } },
    { "cylinder", RAD_CYLINDER, 7, { 0, 0, 0, 0, 0, 4, 1.5 },
      { 5, 0, 2, -1, 0, 0 }, 3.5, { 1, 0, 0 } },
    { "tube", RAD_TUBE, 7, { 0, 0, 0, 0, 0, 4, 1.5 },
      { 5, 0, 2, -1, 0, 0 }, 3.5, { -1, 0, 0 } },
    { "down a cylinder", RAD_CYLINDER, 7, { 0, 0, 0, 0, 0, 4, 1.5 },
      { 0, 0, 9, 0, 0, -1 }, 0, { 0 } },
    { "through an open end", RAD_CYLINDER, 7, { 0, 0, 0, 0, 0, 4, 1 },
      { 0, -2, 6, 0, 1, -1 }, 3 * 1.4142135623730951, { 0, 1, 0 } },
    { "cone", RAD_CONE, 8, { 0, 0, 0, 0, 0, 2, 0, 2 },
      { 5, 0, 1, -1, 0, 0 }, 4,
      { .7071067811865476, 0, -.7071067811865476 } },
    { "cone with the ends swapped", RAD_CONE, 8, { 0, 0, 2, 0, 0, 0, 2, 0 },
      { 5, 0, 1, -1, 0, 0 }, 4,
      { .7071067811865476, 0, -.7071067811865476 } },
    { "cup", RAD_CUP, 8, { 0, 0, 0, 0, 0, 2, 0, 2 }, { 5, 0, 1, -1, 0, 0 }, 4,
      { -.7071067811865476, 0, .7071067811865476 } },
    { "other nappe", RAD_CONE, 8, { 0, 0, 0, 0, 0, 2, 0, 2 },
      { 5, 0, -1, -1, 0, 0 }, 0, { 0 } },
    { "along a cone's side", RAD_CONE, 8, { 0, 0, 0, 0, 0, 2, 0, 2 },
      { 0, 1, .5, 1, 0, 1 }, 1.0606601717798212,
      { .4242640687119285, .565685424949238, -.7071067811865476 } },
    { "cone of equal radii", RAD_CONE, 8, { 0, 0, 0, 0, 0, 4, 1.5, 1.5 },
      { 5, 0, 2, -1, 0, 0 }, 3.5, { 1, 0, 0 } },
    { "ring", RAD_RING, 8, { 0, 0, 1, 0, 0, 2, 1, 2 },
      { 1.5, 0, 3, 0, 0, -1 }, 2, { 0, 0, 1 } },
    { "hole of a ring", RAD_RING, 8, { 0, 0, 1, 0, 0, 2, 1, 2 },
      { .5, 0, 3, 0, 0, -1 }, 0, { 0 } },
    { "outside a ring", RAD_RING, 8, { 0, 0, 1, 0, 0, 2, 1, 2 },
      { 2.5, 0, 3, 0, 0, -1 }, 0, { 0 } },
    { "disk", RAD_RING, 8, { 0, 0, 1, 0, 0, 2, 0, 2 },
      { .5, 0, 3, 0, 0, -1 }, 2, { 0, 0, 1 } },
};

/* clang-format on */
/* Each at the origin and as it is, and blown up with everything around it. */
static const double scales[] = { 1e-6, 1, 1e9 };

START_TEST(surface_is_met_where_geometry_says)
{
    int row = _i / N_ELEM(scales);
    double s = scales[_i % N_ELEM(scales)], reals[16];
    const double *ray = closed[row].ray;
    struct rad_span span =
        geom_span(s * ray[0], s * ray[1], s * ray[2], ray[3], ray[4], ray[5]);
    struct rad_geom_counts counts = { 0 };
    struct geom_scene g;
    struct rad_geom *geom;
    struct rad_hit hit;

    for (int i = 0; i < closed[row].nreals; i++)
        reals[i] = s * closed[row].reals[i];
    geom_scene_init(&g, 1, 16);
    geom_scene_add(&g, closed[row].type, RAD_VOID, RAD_SURF_OPAQUE, reals,
                   closed[row].nreals);
    geom = geom_scene_compile(&g);
    bool met = rad_geom_nearest(geom, &span, &hit, &counts);

    ck_assert_msg(met == (closed[row].t > 0), "%s", closed[row].what);
    ck_assert_int_eq(hit.obj, met ? 0 : RAD_VOID);
    ck_assert_int_eq(met,
                     rad_geom_occluded(geom, &span, RAD_VOID, NULL, &counts));
    if (met) {
        double p[3];

        rad_madd(p, span.org, hit.t, span.dir);
        ck_assert_msg(fabs(hit.t - s * closed[row].t) < 1e-14 * hit.t,
                      "%s: %.17g", closed[row].what, hit.t / s);
        ck_assert_msg(rad_dist2(hit.n, closed[row].n) < 1e-28, "%s: %g %g %g",
                      closed[row].what, hit.n[0], hit.n[1], hit.n[2]);
        ck_assert(rad_dist2(p, hit.p) < 1e-28 * s * s * 100);
        ck_assert(hit.err > 0 && hit.err < 1e-13 * s);
    }
    rad_geom_free(geom);
    geom_scene_release(&g);
}
END_TEST

START_TEST(empty_scene_is_never_met)
{
    struct rad_span span = geom_span(1, 2, 3, 1, 1, 1);
    struct rad_geom_counts counts = { 0 };
    double lo[3], hi[3];
    struct geom_scene g;
    struct rad_geom *geom;
    struct rad_hit hit;

    geom_scene_init(&g, 1, 1);
    geom = geom_scene_compile(&g);
    ck_assert(!rad_geom_nearest(geom, &span, &hit, &counts));
    ck_assert(!rad_geom_occluded(geom, &span, RAD_VOID, NULL, &counts));
    ck_assert(!rad_geom_hit_object(geom, 0, &span, &hit, &counts));
    rad_geom_bounds(geom, lo, hi);
    for (int a = 0; a < 3; a++)
        ck_assert(lo[a] == 0 && hi[a] == 0);
    rad_geom_free(geom);
    geom_scene_release(&g);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("geom");
    TCase *tc = tcase_create("geom");

    tcase_add_loop_test(tc, surface_is_met_where_geometry_says, 0,
                        N_ELEM(closed) * N_ELEM(scales));
    tcase_add_test(tc, empty_scene_is_never_met);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
