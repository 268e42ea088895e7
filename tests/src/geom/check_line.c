/* check_line.c - what a ray meets on its way to a place */
#include "config.h"

#include "geom/geom.h"
#include "tests/blocked.h"
#include "tests/unit.h"
#include "geom_scene.h"

FIXTURE(NULL, geom_tear_down)

/* From anywhere in the unit cube, in any direction. */
static struct rad_span
span_through_cube(uint64_t key)
{
    return geom_span(rad_rand(key, 0), rad_rand(key, 1), rad_rand(key, 2),
                     rad_rand(key, 3) - .5, rad_rand(key, 4) - .5,
                     rad_rand(key, 5) - .5);
}

TEST(sight_finds_the_first_veil)
{
    struct rad_geom_counts counts = { 0 };
    int veiled = 0, tied = 0;

    geom_scene_init(&g, 40, 300);
    for (uint32_t i = 0; i < 40; i++) { /* some of them twice */
        uint64_t key = rad_key_pixel(5, 0, i - i % 8 / 7, 0);
        double a[8] = { rad_rand(key, 0),
                        rad_rand(key, 1),
                        rad_rand(key, 2),
                        rad_rand(key, 3),
                        rad_rand(key, 4),
                        1,
                        0,
                        .2 };

        geom_scene_add(&g, i % 3 ? RAD_RING : RAD_SPHERE, RAD_VOID,
                       i % 5 ? RAD_SURF_TRANSPARENT : RAD_SURF_OPAQUE,
                       i % 3 ? a : (double[]){ a[0], a[1], a[2], .1 },
                       i % 3 ? 8 : 4);
    }
    geom = geom_scene_compile(&g);
    for (uint32_t i = 0; i < 4000; i++) {
        uint64_t key = rad_key_pixel(6, 0, i, 0);
        struct rad_span s = span_through_cube(key);
        struct rad_hit first, hit;
        struct rad_line line;
        bool stopped = is_blocked(geom, &s, RAD_VOID, NULL, &counts);
        bool met = rad_geom_nearest(geom, &s, &hit, &counts);

        switch (
            rad_geom_sight(geom, &s, RAD_VOID, NULL, &first, &line, &counts)) {
        case RAD_SIGHT_BLOCKED:
            ck_assert(stopped);
            break;
        case RAD_SIGHT_CLEAR:
            ck_assert(!met);
            break;
        case RAD_SIGHT_VEILED:
            ck_assert(!stopped && met);
            ck_assert_int_eq(first.obj, hit.obj);
            ck_assert_double_eq(first.t, hit.t);
            ck_assert_double_eq(first.err, hit.err);
            ck_assert_mem_eq(first.p, hit.p, sizeof hit.p);
            ck_assert_mem_eq(first.n, hit.n, sizeof hit.n);
            veiled++;
            tied += hit.obj % 8 == 7;
            break;
        }
    }
    ck_assert_int_gt(veiled, 500);
    ck_assert_int_gt(tied, 20);
}

/* Surfaces of every family about the origin, most of them passed, some of them
 * twice. */
static void
add_passed(uint32_t i)
{
    static const enum rad_otype types[] = { RAD_RING, RAD_SPHERE, RAD_CONE,
                                            RAD_POLYGON };
    static const int nreals[] = { 8, 4, 8, 9 };
    static const uint8_t surf[] = { RAD_SURF_PASSED, RAD_SURF_PASSED,
                                    RAD_SURF_PASSED, RAD_SURF_ONESIDED,
                                    RAD_SURF_OPAQUE };
    uint64_t key = rad_key_pixel(7, 0, i - i % 16 / 15, 0);
    int kind = (int)((i - i % 16 / 15) % 4);
    double a[9];

    for (uint32_t k = 0; k < 9; k++)
        a[k] = rad_rand(key, k);
    if (kind == 1)
        a[3] = .05 + a[3] / 5;
    if (kind == 0 || kind == 2) {
        a[6] /= 4;
        a[7] = a[6] + .05 + a[7] / 4;
    }
    geom_scene_add(&g, types[kind], RAD_VOID, surf[i % 5], a, nreals[kind]);
}

/* Go along the line that begins with *hit, met by *s, and by walks of its own
 * from surface to surface; returns how many the line knew, and counts where it
 * knew no more. */
static int
follow(const struct rad_line *line, const struct rad_span *s,
       struct rad_hit hit, int *unknown)
{
    struct rad_geom_counts counts = { 0 };
    struct rad_span on = *s;

    for (int i = 1;; i++) {
        struct rad_hit next, want;
        enum rad_beyond what;
        bool met;

        rad_geom_leave(&hit, s->dir, on.org);
        met = rad_geom_nearest(geom, &on, &want, &counts);
        what = rad_geom_beyond(geom, line, i, &hit, on.org, on.dir, &next);
        if (what == RAD_BEYOND_UNKNOWN) {
            (*unknown)++;
            return i;
        }
        ck_assert_int_eq(what == RAD_BEYOND_MET, met);
        if (!met)
            return i;
        ck_assert_int_eq(next.obj, want.obj);
        ck_assert_double_eq_tol(next.t, want.t, 1e-12);
        ck_assert(rad_dist2(next.p, want.p) < 1e-24);
        ck_assert(rad_dist2(next.n, want.n) < 1e-20);
        hit = next;
    }
}

TEST(line_holds_what_walks_meet)
{
    struct rad_geom_counts counts = { 0 };
    int known = 0, unknown = 0, sights = 0;

    geom_scene_init(&g, 60, 600);
    for (uint32_t i = 0; i < 60; i++)
        add_passed(i);
    geom = geom_scene_compile(&g);
    ck_assert(rad_geom_passes(geom));
    for (uint32_t i = 0; i < 4000; i++) {
        uint64_t key = rad_key_pixel(8, 0, i, 0);
        struct rad_span s = span_through_cube(key);
        struct rad_hit hit, want;
        struct rad_line line;

        if (!rad_geom_nearest(geom, &s, &want, &counts))
            continue;
        ck_assert(rad_geom_first(geom, &s, &hit, &line, &counts));
        ck_assert_int_eq(hit.obj, want.obj);
        ck_assert(memcmp(&hit.t, &want.t, sizeof hit.t) == 0);
        ck_assert_mem_eq(hit.p, want.p, sizeof hit.p);
        known += follow(&line, &s, hit, &unknown);
        if (rad_geom_sight(geom, &s, RAD_VOID, NULL, &hit, &line, &counts) ==
            RAD_SIGHT_VEILED)
            sights += follow(&line, &s, hit, &unknown);
    }
    ck_assert_int_gt(known, 4000);
    ck_assert_int_gt(sights, 1000);
    ck_assert_int_gt(unknown, 100);
}

/* A shadow ray's line ends with what it is aimed at, once. */
TEST(line_of_sight_leads_to_the_target)
{
    const double pane[9] = { -9, -9, 0, 9, -9, 0, 0, 9, 0 };
    const double lamp[4] = { 0, 0, 3, 1 };
    struct rad_span s = geom_span(0, 0, -1, 0, 0, 1);
    struct rad_geom_counts counts = { 0 };
    struct rad_line line;
    struct rad_hit hit, next;

    geom_scene_init(&g, 2, 20);
    geom_scene_add(&g, RAD_POLYGON, RAD_VOID, RAD_SURF_PASSED, pane, 9);
    geom_scene_add(&g, RAD_SPHERE, RAD_VOID, RAD_SURF_OPAQUE, lamp, 4);
    geom = geom_scene_compile(&g);
    s.tmax = 2.5;
    ck_assert_int_eq(rad_geom_sight(geom, &s, 1, NULL, &hit, &line, &counts),
                     RAD_SIGHT_VEILED);
    ck_assert_int_eq(hit.obj, 0);
    ck_assert_int_eq(rad_geom_beyond(geom, &line, 1, &hit, hit.p, s.dir, &next),
                     RAD_BEYOND_MET);
    ck_assert_int_eq(next.obj, 1);
    ck_assert_double_eq_tol(next.t, 2, 1e-14);
    ck_assert_int_eq(
        rad_geom_beyond(geom, &line, 2, &next, next.p, s.dir, &hit),
        RAD_BEYOND_UNKNOWN);
}
