/* check_ambient.c - irradiance of hemispheres, and the cache of it */
#include "config.h"

#include "base/rng.h"
#include "base/vec.h"
#include "light/indirect/ambient.h"
#include "light/indirect/ambient_impl.h"
#include "tests/lambert.h"
#include "tests/world_fixture.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

FIXTURE(NULL, world_tear_down)

/* --- irradiance by sampling --- */

static struct rad_rgb
irradiance_up(struct world *in, double x, double y, double z)
{
    static const double up[3] = { 0, 0, 1 };
    double p[3] = { x, y, z };
    struct rad_ray r;

    rad_ray_irradiance(&in->ctx, &r, p, up,
                       rad_key_branch((uint64_t)(int64_t)(1000 * x),
                                      (uint64_t)(int64_t)(y * 7)));
    return r.L;
}

#define SKY     "void glow blue 0 0 4 1 2 3 0\nblue source sky 0 0 4 0 0 1 180\n"
#define PLASTIC "void plastic white 0 0 5 .5 .5 .5 0 0\n"
/* faces of the cube from -1 to 1 in all axes, seen from inside */
#define CUBE                                                                   \
    "white polygon z0 0 0 12 -1 -1 -1 1 -1 -1 1 1 -1 -1 1 -1\n"                \
    "white polygon z1 0 0 12 -1 -1 1 -1 1 1 1 1 1 1 -1 1\n"                    \
    "white polygon y0 0 0 12 -1 -1 -1 -1 -1 1 1 -1 1 1 -1 -1\n"                \
    "white polygon y1 0 0 12 -1 1 -1 1 1 -1 1 1 1 -1 1 1\n"                    \
    "white polygon x0 0 0 12 -1 -1 -1 -1 1 -1 -1 1 1 -1 -1 1\n"                \
    "white polygon x1 0 0 12 1 -1 -1 1 -1 1 1 1 1 1 1 -1\n"

/* An even sky gives pi L however it is sampled; with nothing in the way, a
 * plane under it is one record. */
LOOP_TEST(even_sky_gives_pi_times_its_radiance, 5)
{
    static const char *const options[] = {
        "-ab 1 -aa 0 -ad 64 -as 0",           "-ab 1 -aa 0 -ad 1 -as 0",
        "-ab 3 -aa .2 -ad 256 -as 0",         "-ab 1 -aa .2 -ad 256 -as 128",
        "-ab 1 -aa 0 -ad 64 -lr -4 -lw 1e-3",
    };

    world_open(&w, SKY, options[_i]);
    for (int k = 0; k < 10; k++) {
        struct rad_rgb E = irradiance_up(&w, .01 * k, -.02 * k, 0);

        ck_assert_double_eq_tol(E.r, M_PI, 1e-5);
        ck_assert_double_eq_tol(E.g, 2 * M_PI, 1e-5);
        ck_assert_double_eq_tol(E.b, 3 * M_PI, 1e-5);
    }
}

/* A texture that leans the normal by 45 degrees toward the bright side of a sky
 * of 1 + x has sin 45 times the integral of x^2 / pi more; of fewer cells than
 * seven a side it has no part in indirect light, as in rpict. */
static const struct {
    const char *material;
    double z; /* of the eye */
    int ambdiv;
    double L;
} leaning[] = {
    { "plastic p 0 0 5 1 1 1 0 0", 1, 42, 1 },
    { "plastic p 0 0 5 1 1 1 0 0", 1, 49, 1 + M_SQRT1_2 * 2 / 3 },
    { "trans p 0 0 7 1 1 1 0 0 1 0", -1, 49, 1 + M_SQRT1_2 * 2 / 3 },
    { "plastic2 p 4 1 0 0 . 0 6 1 1 1 0 .1 .1", 1, 49, 1 + M_SQRT1_2 * 2 / 3 },
    { "trans2 p 4 1 0 0 . 0 8 1 1 1 0 .1 .1 1 0", -1, 49,
      1 + M_SQRT1_2 * 2 / 3 },
    { "plasfunc p 2 sqrt . 0 4 1 1 1 0", 1, 49, 1 + M_SQRT1_2 * 2 / 3 },
    { "transfunc p 2 sqrt . 0 6 1 1 1 0 1 0", -1, 49, 1 + M_SQRT1_2 * 2 / 3 },
    { "BRTDfunc p 10 0 0 0 0 0 0 0 0 0 . 0 9 1 1 1 0 0 0 0 0 0", 1, 49,
      1 + M_SQRT1_2 * 2 / 3 },
    { "BRTDfunc p 10 0 0 0 0 0 0 0 0 0 . 0 9 0 0 0 0 0 0 1 1 1", -1, 49,
      1 + M_SQRT1_2 * 2 / 3 },
    { "WGMDfunc p 13 void 0 0 0 void 0 0 0 void 1 0 0 . 0 9 1 1 1 0 0 0 0 0 0",
      1, 49, 1 + M_SQRT1_2 * 2 / 3 },
    { "WGMDfunc p 13 void 0 0 0 void 0 0 0 t 1 0 0 . 0 9 0 0 0 0 0 0 1 1 1", -1,
      49, 1 + M_SQRT1_2 * 2 / 3 },
};

LOOP_TEST(textures_lean_where_cells_are_many, N_ELEM(leaning))
{
    char scene[512], options[64];
    double sum = 0;

    snprintf(scene, sizeof scene,
             "void brightfunc f 2 1+Dx . 0 0\nf glow g 0 0 4 1 1 1 0\n"
             "g source sky 0 0 4 0 0 1 180\nvoid texfunc t 4 1 0 0 . 0 0\n"
             "t %s\np ring r 0 0 8 0 0 0 0 0 1 0 9\n",
             leaning[_i].material);
    snprintf(options, sizeof options, "-ab 1 -aa 0 -ad %d -as 0 -lw 1e-6",
             leaning[_i].ambdiv);
    world_open(&w, scene, options);
    for (int i = 0; i < 400; i++) {
        struct rad_ray r;

        world_ray(&w, &r, 0, 0, leaning[_i].z, 0, 0, -leaning[_i].z);
        r.key = rad_key_branch(1, (uint64_t)i);
        rad_ray_trace(&w.ctx, &r);
        sum += (double)r.L.g / 400;
    }
    ck_assert_double_eq_tol(sum, leaning[_i].L, .03);
}

/* The same of a record at its own place, which a frozen cache does not keep. */
static const struct {
    const char *texture, *bright;
} leaned[] = {
    { ".5 0 0", "1+Dx" },
    { "-.5 0 0", "1-Dx" },
    { "0 .5 0", "1+Dy" },
    { "0 -.5 0", "1-Dy" },
};

LOOP_TEST(textures_lean_the_light_of_records, N_ELEM(leaned))
{
    char scene[512];
    double sum = 0;

    snprintf(scene, sizeof scene,
             "void brightfunc f 2 %s . 0 0\nf glow g 0 0 4 1 1 1 0\n"
             "g source sky 0 0 4 0 0 1 180\nvoid texfunc t 4 %s . 0 0\n"
             "t plastic p 0 0 5 1 1 1 0 0\np ring r 0 0 8 0 0 0 0 0 1 0 9\n",
             leaned[_i].bright, leaned[_i].texture);
    world_open(&w, scene, "-ab 1 -aa .2 -ad 256 -as 0 -lw 1e-6");
    rad_ambient_freeze(w.job->ambient);
    for (int i = 0; i < 400; i++) {
        struct rad_ray r;

        world_ray(&w, &r, 0, 0, 1, 0, 0, -1);
        r.key = rad_key_branch(1, (uint64_t)i);
        rad_ray_trace(&w.ctx, &r);
        sum += (double)r.L.g / 400;
    }
    ck_assert_double_eq_tol(sum, 1 + .5 / sqrt(1.25) * 2 / 3, .03);
}

/* In a closed box, -av after n bounces has been reflected n times, also where
 * records of fewer bounces are at hand. */
LOOP_TEST(furnace_loses_the_reflectance_at_each_bounce, 2)
{
    static const char *const cache[] = { "-aa 0 -ad 16", "-aa .2 -ad 64" };
    char options[128];

    for (int bounces = 0; bounces <= 4; bounces++) {
        snprintf(options, sizeof options,
                 "-as 0 -av 8 8 8 -lw 0 -lr 9 -ab %d %s", bounces, cache[_i]);
        world_open(&w, PLASTIC CUBE, options);
        ck_assert_double_eq_tol(irradiance_up(&w, .1, .2, -.9).g,
                                8 * M_PI * pow(.5, bounces), 1e-5);
    }
}

/* A hemisphere whose rays have all died is black: their light is in those of
 * other hemispheres that survived. */
TEST(roulette_leaves_the_mean_alone)
{
    double sum = 0, truth = 8 * M_PI * pow(.5, 3);
    int n = 4000;

    world_open(&w, PLASTIC CUBE,
               "-as 0 -av 8 8 8 -lw .2 -lr -9 -ab 3 -aa 0 -ad 16");
    for (int i = 0; i < n; i++)
        sum += irradiance_up(&w, i / 4000. - .5, .2, -.9).g;
    ck_assert_double_eq_tol(sum / n, truth, .03 * truth);
}

/* What -ae names, or -ai does not, gets -av without a bounce. */
static const struct {
    const char *options;
    double a, b; /* radiance of the two floors over -av */
} listed[] = {
    { "", .25, .25 },           { "-ae a", .5, .25 },
    { "-ai a", .25, .5 },       { "-ae a -ae b", .5, .5 },
    { "-ai a -ae b", .25, .5 }, { "-ae c", .25, .25 },
};

LOOP_TEST(lists_say_which_surfaces_get_ambient_light, 2 * N_ELEM(listed))
{
    char options[128];

    snprintf(options, sizeof options,
             "-ab 1 -aa %s -ad 64 -as 0 -av 8 8 8 -lw 0 %s",
             _i % 2 ? "0" : ".2", listed[_i / 2].options);
    world_open(&w,
               "void plastic a 0 0 5 .5 .5 .5 0 0\n"
               "void plastic b 0 0 5 .5 .5 .5 0 0\n"
               "void plastic lid 0 0 5 .5 .5 .5 0 0\n"
               "a polygon l 0 0 12 -1 -1 0 0 -1 0 0 1 0 -1 1 0\n"
               "b polygon r 0 0 12 0 -1 0 1 -1 0 1 1 0 0 1 0\n"
               "lid sphere s 0 0 4 0 0 0 5\n",
               options);
    ck_assert_double_eq_tol(world_see(&w, -.5, 0, 1, 0, 0, -1).r,
                            8 * listed[_i / 2].a, 1e-5);
    ck_assert_double_eq_tol(world_see(&w, .5, 0, 1, 0, 0, -1).r,
                            8 * listed[_i / 2].b, 1e-5);
}

/* A glow that fills a quarter of the hemisphere's projection: the mean of many
 * samplings is right, with and without extra samples, in the dark half and at
 * the edge, for these must not depend on what they find. */
LOOP_TEST(super_samples_leave_the_mean_alone, 3)
{
    static const char scene[] =
        "void glow g 0 0 4 1 1 1 0\n"
        "g polygon p 0 0 12 0 0 1 0 50 1 50 50 1 50 0 1\n";
    static const struct {
        const char *options;
        uint64_t least, most; /* rays a hemisphere */
    } row[] = {
        { "-ab 1 -aa 0 -ad 64 -as 0", 64, 64 },
        { "-ab 1 -aa 0 -ad 64 -as 200", 250, 280 },
        { "-ab 1 -aa 0 -ad 49 -as 200", 49, 49 }, /* too coarse for more */
    };
    uint64_t rays;
    double sum = 0, want;
    double v[] = { 0, 0, 1, 50, 0, 1, 50, 50, 1, 0, 50, 1 };
    const double p[3] = { .1, .2, 0 }, n[3] = { 0, 0, 1 };
    enum { TIMES = 2000 };

    want = -lambert(v, 4, p, n);
    world_open(&w, scene, row[_i].options);
    for (uint64_t k = 0; k < TIMES; k++) {
        struct rad_ray r;

        rad_ray_irradiance(&w.ctx, &r, p, n, rad_key_branch(9, k));
        sum += r.L.g / TIMES;
    }
    ck_assert_msg(fabs(sum - want) < 2e-3 * want, "%g, not %g", sum, want);
    rays = w.ctx.counts.ambient_rays;
    ck_assert_uint_ge(rays, row[_i].least * TIMES);
    ck_assert_uint_le(rays, row[_i].most * TIMES);
}

/* --- the cache --- */

#define CACHED "-ab 2 -aa .2 -ar 64 -ad 64 -as 0"

static struct rad_ambrec
record(double x, double y, double z, float E, int level)
{
    struct rad_ambrec rec = { .p = { x, y, z },
                              .n = { 0, 0, 1 },
                              .u = { 1, 0, 0 },
                              .radius = { .1f, .2f },
                              .E = { E, 2 * E, 3 * E },
                              .weight = 1,
                              .level = (uint16_t)level };

    return rec;
}

static double
find(double x, double y, double z, int level, double weight, struct rad_rgb *E)
{
    struct rad_ambplace at = { .p = { x, y, z },
                               .n = { 0, 0, 1 },
                               .pn = { 0, 0, 1 },
                               .level = level,
                               .weight = weight };
    struct rad_geom_counts counts = { 0, 0 };
    uint64_t rays = 0;

    return rad_ambient_find(w.job->ambient, &at, E, &counts, &rays);
}

TEST(record_serves_its_zone_and_no_more)
{
    struct rad_ambrec rec = record(.1, .2, -.5, 2, 0);
    struct rad_rgb E = { 0, 0, 0 };

    world_open(&w, PLASTIC CUBE, CACHED);
    ck_assert(!rad_ambient_covers(w.job->ambient, &rec));
    ck_assert(rad_ambient_insert(w.job->ambient, &rec));
    ck_assert(rad_ambient_covers(w.job->ambient, &rec));
    ck_assert_double_eq_tol(find(.1, .2, -.5, 0, 1, &E), 1, 1e-12);
    ck_assert_double_eq(E.r, 2);
    ck_assert_double_eq(E.b, 6);
    /* the ellipse: .2 * .1 along x, .2 * .2 along y */
    ck_assert(find(.119, .2, -.5, 0, 1, &E) > 0);
    ck_assert(find(.121, .2, -.5, 0, 1, &E) == 0);
    ck_assert(find(.1, .239, -.5, 0, 1, &E) > 0);
    ck_assert(find(.1, .241, -.5, 0, 1, &E) == 0);
    ck_assert(find(.1, .2, -.521, 0, 1, &E) == 0);
    /* lighter rays take it; deeper ones do not, for which fewer bounces are
     * left; heavier ones do not either */
    ck_assert(find(.1, .2, -.5, 0, .3, &E) > 0);
    ck_assert(find(.1, .2, -.5, 1, .3, &E) == 0);
    rec.p[0] = -.5;
    rec.level = 1;
    rec.weight = .5;
    ck_assert(rad_ambient_insert(w.job->ambient, &rec));
    ck_assert(find(-.5, .2, -.5, 0, .5, &E) == 0);
    ck_assert(find(-.5, .2, -.5, 1, .5, &E) > 0);
    ck_assert(find(-.5, .2, -.5, 1, 1, &E) == 0);
    ck_assert_uint_eq(rad_ambient_count(w.job->ambient), 2);
}

/* Where one record serves, others that do not quite reach are averaged in, but
 * where deeper rays end. */
TEST(near_records_are_averaged_in)
{
    world_open(&w, PLASTIC CUBE, CACHED);
    for (int level = 0; level < 2; level++) {
        struct rad_ambrec rec = record(.14, .2, -.5, 4, level);
        struct rad_rgb E = { 0, 0, 0 };

        /* zones of .2 * .1 along x, asked for up to .3 * .1 */
        ck_assert(rad_ambient_insert(w.job->ambient, &rec));
        ck_assert(find(.115, .2, -.5, level, 1, &E) == 0);
        rec = record(.1, .2, -.5, 2, level);
        ck_assert(rad_ambient_insert(w.job->ambient, &rec));
        ck_assert(find(.115, .2, -.5, level, 1, &E) > 0);
        ck_assert_double_eq_tol(E.r, level == 0 ? 2.5 : 2, 1e-5);
        ck_assert(find(.1105, .2, -.5, level, 1, &E) > 0);
        ck_assert_double_eq_tol(E.r, level == 0 ? 2.05 : 2, 1e-5);
    }
}

/* Over a frozen cache they count by what weight is lacking to .05. */
TEST(frozen_records_that_do_not_quite_reach_fill_gaps)
{
    static const struct {
        double x, E;
    } row[] = { { .1105, 2 }, { .115, 2 }, { .1195, 2.883721 } };
    struct rad_ambrec rec[2] = { record(.1, .2, -.5, 2, 0),
                                 record(.14, .2, -.5, 4, 0) };

    world_open(&w, PLASTIC CUBE, CACHED);
    rad_ambient_freeze(w.job->ambient);
    for (int i = 0; i < 2; i++)
        ck_assert(rad_ambient_insert(w.job->ambient, &rec[i]));
    ck_assert(rad_ambient_settle(w.job->ambient));
    for (size_t i = 0; i < N_ELEM(row); i++) {
        struct rad_rgb E = { 0, 0, 0 };

        ck_assert(find(row[i].x, .2, -.5, 0, 1, &E) > 0);
        ck_assert_double_eq_tol(E.r, row[i].E, 1e-4);
    }
}

/* Records that have noise, of a light that falls from 4 to 1: a fit of them has
 * its slope, but beyond the last E is not below what any of them measured. */
TEST(frozen_records_do_not_fall_below_what_was_measured)
{
    struct rad_rgb E = { 0, 0, 0 };

    world_open(&w, PLASTIC CUBE, CACHED);
    rad_ambient_freeze(w.job->ambient);
    for (int i = 0; i < 49; i++) {
        double x = .02 * (i % 7), y = .02 * (i / 7 - 3);
        struct rad_ambrec rec = record(x, y, -.5, (float)(4 - 25 * x), 0);

        rec.var = 1e-3f;
        ck_assert(rad_ambient_insert(w.job->ambient, &rec));
    }
    ck_assert(rad_ambient_settle(w.job->ambient));
    rad_ambient_smooth(w.job->ambient);
    ck_assert(find(.066, 0, -.5, 0, 1, &E) > 0);
    ck_assert_double_eq_tol(E.r, 4 - 25 * .066, .01);
    ck_assert(find(.138, 0, -.5, 0, 1, &E) > 0);
    ck_assert_double_eq_tol(E.r, 1, .01);
}

/* At the edge of a small zone within a large one E goes from one to the other
 * record's in small steps. */
LOOP_TEST(E_does_not_jump_where_a_small_zone_ends, 2)
{
    enum { STEPS = 400 };
    struct rad_ambrec rec[2] = { record(.1, .2, -.5, 2, 0),
                                 record(.1, .2, -.5, 4, 0) };
    struct rad_rgb E = { 2, 0, 0 };
    float last = 2, most = 0;

    world_open(&w, PLASTIC CUBE, "-ab 2 -aa .2 -ar 0 -ad 64 -as 0");
    if (_i == 1)
        rad_ambient_freeze(w.job->ambient);
    rec[0].radius[0] = rec[0].radius[1] = .02f;
    rec[1].radius[0] = rec[1].radius[1] = .4f;
    for (int i = 0; i < 2; i++)
        ck_assert(rad_ambient_insert(w.job->ambient, &rec[i]));
    ck_assert(_i == 0 || rad_ambient_settle(w.job->ambient));
    for (int k = 0; k < 2 * STEPS; k++, last = E.r) {
        ck_assert(find(.1 + .2 * .02 * k / STEPS, .2, -.5, 0, 1, &E) > 0);
        most = fmaxf(most, fabsf(E.r - last));
    }
    ck_assert_double_eq_tol(E.r, 4, 1e-5);
    ck_assert_msg(most < .05f, "E jumps by %g", (double)most);
}

/* A tile's own record counts as one of the frozen cache with as small a zone,
 * however well that serves. */
TEST(records_of_a_tile_count_as_frozen_ones)
{
    struct rad_ambrec rec[3] = { record(.1, .2, -.5, 2, 0),
                                 record(.1, .2, -.5, 2, 0),
                                 record(.1, .2, -.5, 4, 0) };
    struct rad_ambplace at = { .p = { .1, .2, -.5 }, .weight = 1 };
    struct rad_geom_counts counts = { 0, 0 };
    uint64_t rays = 0;
    struct rad_ambtile tile;
    struct rad_ambasker asker = { .tile = &tile,
                                  .counts = &counts,
                                  .rays = &rays };
    struct rad_ambsaid said;

    world_open(&w, PLASTIC CUBE, "-ab 2 -aa .2 -ar 0 -ad 64 -as 0");
    rad_ambient_freeze(w.job->ambient);
    for (int i = 0; i < 3; i++)
        rec[i].radius[0] = rec[i].radius[1] = i == 1 ? .4f : .02f;
    for (int i = 0; i < 2; i++)
        ck_assert(rad_ambient_insert(w.job->ambient, &rec[i]));
    ck_assert(rad_ambient_settle(w.job->ambient));
    rad_ambtile_begin(&tile, &w.ctx, 0, NULL);
    ck_assert(rad_ambient_keep(&w.ctx, &rec[2]));
    at.n[2] = at.pn[2] = 1;
    rad_ambient_ask(w.job->ambient, &at, &asker, &said);
    rad_ambtile_end(&tile, &w.ctx);
    ck_assert_double_eq_tol(said.E.r, 3, 1e-5);
}

/* In whatever order tiles made them: deep records of one size all serve, and of
 * those that a wall may part from the place the nearest. */
LOOP_TEST(the_order_of_deep_records_does_not_matter, 4)
{
    bool last = _i & 1, doubtful = _i & 2;
    struct rad_ambrec rec[2] = { record(.1, .2, -.5, 2, 1),
                                 record(.126, .2, -.5, 4, 1) };
    struct rad_rgb E = { 0, 0, 0 };

    world_open(&w, PLASTIC CUBE, CACHED);
    rad_ambient_freeze(w.job->ambient);
    for (int i = 0; i < 2; i++) {
        rec[i].corral = doubtful ? UINT32_MAX : 0;
        rec[i].radius[1] = rec[i].radius[0];
    }
    for (int i = 0; i < 2; i++)
        ck_assert(rad_ambient_insert(w.job->ambient, &rec[last ? 1 - i : i]));
    ck_assert(rad_ambient_settle(w.job->ambient));
    ck_assert(find(.112, .2, -.5, 1, 1, &E) > .1);
    /* distances .12 and .14 of a reach of .25 */
    ck_assert_double_eq_tol(E.r, doubtful ? 2 : (2 * .13 + 4 * .11) / .24,
                            1e-4);
}

/* Where the least radius is .04, and most records have .4: places behind a
 * record by less than a step, by a step, and by as much where the surface
 * bends. */
TEST(record_does_not_serve_behind_a_step)
{
    static const struct {
        double height, lean, radius;
        int level;
        bool serves;
    } row[] = {
        { 0, 0, .4, 0, true },      { -.001, 0, .4, 0, true },
        { -.006, 0, .4, 0, false }, { -.006, .3, .4, 0, true },
        { -.006, 0, .4, 1, true }, /* in hemispheres it averages out */
        { -.006, 0, .05, 0, true },
    };
    struct rad_geom_counts counts = { 0, 0 };
    uint64_t rays = 0;

    world_open(&w, PLASTIC CUBE, "-ab 2 -aa .2 -ar 50 -ad 64 -as 0");
    for (size_t i = 0; i < N_ELEM(row); i++) {
        struct rad_ambrec rec = record(-.8 + .3 * i, .2, -.5, 2, row[i].level);
        struct rad_ambplace at = { .level = row[i].level, .weight = 1 };
        struct rad_rgb E;

        rec.radius[0] = rec.radius[1] = (float)row[i].radius;
        ck_assert(rad_ambient_insert(w.job->ambient, &rec));
        rad_copy(at.p, rec.p);
        at.p[0] += .1 * row[i].radius;
        at.p[2] += row[i].height;
        at.n[0] = at.pn[0] = sin(row[i].lean);
        at.n[2] = at.pn[2] = cos(row[i].lean);
        ck_assert_msg((rad_ambient_find(w.job->ambient, &at, &E, &counts,
                                        &rays) > 0) == row[i].serves,
                      "row %zu", i);
    }
}

TEST(other_side_is_not_served)
{
    struct rad_ambrec rec = record(.1, .2, -.5, 2, 0);
    struct rad_rgb E = { 7, 7, 7 };

    world_open(&w, PLASTIC CUBE, CACHED);
    rec.n[2] = -1;
    ck_assert(rad_ambient_insert(w.job->ambient, &rec));
    ck_assert(find(.1, .2, -.5, 0, 1, &E) == 0);
    ck_assert_double_eq(E.r, 7); /* untouched */
}

TEST(gradients_extrapolate_and_are_bounded)
{
    struct rad_ambrec rec = record(0, 0, -.5, 1, 0);
    struct rad_rgb E;

    world_open(&w, PLASTIC CUBE, CACHED);
    rec.gpos[0] = 5;   /* per unit along x */
    rec.gpos[1] = -60; /* along y: below nothing within the zone */
    ck_assert(rad_ambient_insert(w.job->ambient, &rec));
    ck_assert(find(.01, 0, -.5, 0, 1, &E) > 0);
    ck_assert_double_eq_tol(E.r, 1.05, 1e-6);
    ck_assert(find(0, .03, -.5, 0, 1, &E) == 0);
    ck_assert(find(0, -.03, -.5, 0, 1, &E) > 0);
    ck_assert_double_eq_tol(E.r, 2.8, 1e-5);
}

/* What a broken or hostile worker might send; each row spoils one thing. */
LOOP_TEST(implausible_record_is_refused, 23)
{
    struct rad_ambrec rec = record(.1, .2, -.5, 2, 0);

    world_open(&w, PLASTIC CUBE, CACHED);
    /* clang-format off */
    switch (_i) {
    case 0: rec.p[1] = NAN; break;
    case 1: rec.p[2] = 1e3; break;
    case 2: rec.n[2] = 2; break;
    case 3: rec.n[0] = NAN; break;
    case 4: rec.u[2] = 1; break;
    case 5: rec.u[0] = 0; rec.u[2] = 1; break; /* along the normal */
    case 6: rec.radius[0] = 0; break;
    case 7: rec.radius[1] = .05f; break; /* less than the smaller one */
    case 8: rec.radius[1] = 1e6f; break;
    case 9: rec.E.g = INFINITY; break;
    case 10: rec.E.b = -1; break;
    case 11: rec.gpos[1] = NAN; break;
    case 12: rec.gdir[0] = -INFINITY; break;
    case 13: rec.weight = 0; break;
    case 14: rec.weight = NAN; break;
    case 15: rec.level = 2; break; /* -ab 2 has levels 0 and 1 */
    case 16: rec.var = NAN; break;
    case 17: rec.glint.p[2] = INFINITY; break;
    case 18: rec.glint.lum = -1; break;
    /* RAD_AMBREC_UNSURE is the only one below 0 */
    case 19: rec.var = -.5f; break;
    case 20: rec.var = 1e30f; break;
    case 21: rec.glint = (struct rad_glint){ { 1e30f, 0, 0 }, 1 }; break;
    case 22: rec.glint = (struct rad_glint){ { 0, 0, -3e38f }, 1e-30f }; break;
    }
    /* clang-format on */
    ck_assert(!rad_ambient_insert(w.job->ambient, &rec));
    ck_assert(!rad_ambient_covers(w.job->ambient, &rec));
    ck_assert_uint_eq(rad_ambient_count(w.job->ambient), 0);
}

/* Of no known variance, of one that a single ray rules, of the sky's glint. */
TEST(plausible_records_are_taken)
{
    struct rad_ambrec rec = record(.1, .2, -.5, 2, 0);

    world_open(&w, PLASTIC CUBE, CACHED);
    rec.var = RAD_AMBREC_UNSURE;
    ck_assert(rad_ambient_insert(w.job->ambient, &rec));
    rec.var = 3;
    ck_assert(rad_ambient_insert(w.job->ambient, &rec));
    rec.glint = (struct rad_glint){ { 20, -20, 20 }, 1e6f };
    ck_assert(rad_ambient_insert(w.job->ambient, &rec));
    ck_assert_uint_eq(rad_ambient_count(w.job->ambient), 3);
}

/* The log has all records in order, the drain those made here; the others come
 * one by one, or together, where those that are refused leave no gap. */
LOOP_TEST(log_gives_each_record_once, 2)
{
    enum { N = 1000 };
    static struct rad_ambrec out[N], in[2 * N];
    uint64_t cursor = 0;
    size_t got = 0, all = 0, n;

    world_open(&w, PLASTIC CUBE, CACHED);
    ck_assert_uint_eq(rad_ambient_list(w.job->ambient, &cursor, out, N), 0);
    irradiance_up(&w, .1, .2, -.5);
    uint64_t made = w.ctx.counts.ambient_values;

    ck_assert_uint_gt(made, 0);
    for (int i = 0; i < N - (int)made; i++) {
        struct rad_ambrec rec =
            record(1.9 * rad_rand(1, (uint32_t)i) - .95, 0, 0, (float)i, 0);

        in[all++] = rec;
        if (i % 7 == 0) {
            in[all] = rec;
            in[all++].radius[0] = 0;
        }
        if (_i == 0)
            ck_assert(rad_ambient_insert(w.job->ambient, &rec));
    }
    if (_i == 1)
        rad_ambient_insert_all(w.job->ambient, in, all);
    while ((n = rad_ambient_list(w.job->ambient, &cursor, out + got, 77)) > 0)
        got += n;
    ck_assert_uint_eq(got, N);
    for (size_t i = made; i < N; i++)
        ck_assert_double_eq(out[i].E.r, (double)(i - made));
    ck_assert_uint_eq(rad_ambient_drain(w.job->ambient, out, 1), 1);
    ck_assert_uint_eq(rad_ambient_drain(w.job->ambient, out, N), made - 1);
    ck_assert_uint_eq(rad_ambient_drain(w.job->ambient, out, N), 0);
}

/* The light that a glow in the ceiling sends, interpolated, against the same
 * sampled anew with many rays. */
#define ROOM                                                                   \
    "void glow g 0 0 4 9 9 9 0\n"                                              \
    "g polygon p 0 0 12 -.3 -.3 .9 -.3 .3 .9 .3 .3 .9 .3 -.3 .9\n" PLASTIC     \
        CUBE

/* -ar bounds the radius of a zone, but where light bends within that it may be
 * down to half as long. */
TEST(bent_light_gets_zones_below_the_bound)
{
    struct rad_ambrec rec;
    uint64_t cursor = 0;
    double bound = 2. / 4; /* side of the cube over -ar */

    world_open(&w, ROOM, "-ab 1 -aa .5 -ar 4 -ad 1024 -as 0 -av 0 0 0");
    irradiance_up(&w, .3, 0, .75); /* below the edge of the glow */
    ck_assert_uint_eq(rad_ambient_list(w.job->ambient, &cursor, &rec, 1), 1);
    ck_assert_double_lt(rec.radius[0], .95 * bound);
    ck_assert_double_ge(rec.radius[0], .4999 * bound);
    world_open(&w, ROOM, "-ab 1 -aa .1 -ar 4 -ad 1024 -as 0 -av 0 0 0");
    cursor = 0;
    irradiance_up(&w, .3, 0, -.5);
    ck_assert_uint_eq(rad_ambient_list(w.job->ambient, &cursor, &rec, 1), 1);
    ck_assert_double_ge(rec.radius[0], .9999 * bound);
}

/* below the glow's edge; on the floor; in a corner */
static const double sampled_at[][3] = { { .3, 0, .75 },
                                        { .3, 0, -.5 },
                                        { .8, .9, -.9 } };

/* A room in a scene 1024 times as large has the zones that it has alone. */
LOOP_TEST(surroundings_leave_zones_alone, N_ELEM(sampled_at))
{
    static const char *const far[] = {
        "", "white polygon a 0 0 9 1024 1024 1024 1024 1023 1024 1024 1024 "
            "1023\n"
            "white polygon b 0 0 9 -1024 -1024 -1024 -1024 -1023 -1024 -1024 "
            "-1024 -1023\n"
    };
    static const char *const size[] = { "-ar 16",
                                        "-ar 16384 --surroundings=1024" };
    struct rad_ambrec rec[2];

    for (int i = 0; i < 2; i++) {
        char scene[2000], options[200];
        uint64_t cursor = 0;

        snprintf(scene, sizeof scene, ROOM "%s", far[i]);
        snprintf(options, sizeof options,
                 "-ab 1 -aa .5 -ad 1024 -as 0 -av 0 0 0 %s", size[i]);
        world_open(&w, scene, options);
        irradiance_up(&w, sampled_at[_i][0], sampled_at[_i][1],
                      sampled_at[_i][2]);
        ck_assert_uint_eq(rad_ambient_list(w.job->ambient, &cursor, &rec[i], 1),
                          1);
    }
    for (int k = 0; k < 2; k++)
        ck_assert_float_eq_tol(rec[1].radius[k], rec[0].radius[k],
                               1e-4f * rec[0].radius[k]);
}

static const struct {
    const char *shown;
    double x, most; /* the largest radius there */
} far_places[] = {
    { "", 102, .4 },
    { "--shown 0 0 0 2", 0, .4 },
    { "--shown 0 0 0 2", 3.9, .4 },
    { "--shown 0 0 0 2", 102, 20 },
    { "--shown -102 0 0 2", 0, 20 },
    { "--shown -2000 0 0 2", 1000, .2 * 2048 },
};

/* Zones far from what is shown may be as wide as they look small from there. */
LOOP_TEST(zones_are_wider_far_from_what_is_shown, N_ELEM(far_places))
{
    double x = far_places[_i].x, most = far_places[_i].most;
    struct rad_ambrec rec;
    uint64_t cursor = 0;
    char options[200];

    snprintf(options, sizeof options,
             "-ab 1 -aa .5 -ad 64 -ar 16384 --surroundings=1024 %s",
             far_places[_i].shown);
    world_open(&w, SKY PLASTIC "white ring ground 0 0 8 0 0 0 0 0 1 0 1024\n",
               options);
    irradiance_up(&w, x, 0, 0);
    ck_assert_uint_eq(rad_ambient_list(w.job->ambient, &cursor, &rec, 1), 1);
    ck_assert_double_eq_tol(rec.radius[0], most, 1e-4 * most);
}

/* A record of a job that showed another part of the scene serves no farther
 * than this job's own. */
LOOP_TEST(wide_zones_are_narrowed_near_what_is_shown, 2)
{
    bool frozen = _i;
    uint64_t cursor = 0;
    struct rad_ambrec rec;

    world_open(&w, PLASTIC "white ring ground 0 0 8 0 0 0 0 0 1 0 1024\n",
               CACHED " -ar 16384 --surroundings=1024 --shown 0 0 0 2");
    if (frozen)
        rad_ambient_freeze(w.job->ambient);
    for (int i = 0; i < 2; i++) {
        rec = record(102 * i, 0, 0, 1, 0);
        rec.radius[0] = i ? 15 : .125f;
        rec.radius[1] = 30;
        rad_ambient_insert_all(w.job->ambient, &rec, 1);
    }
    ck_assert_uint_eq(rad_ambient_count(w.job->ambient), 2);
    ck_assert_uint_eq(rad_ambient_list(w.job->ambient, &cursor, &rec, 1), 1);
    ck_assert_float_eq(rec.radius[0], .125f);
    ck_assert_float_eq(rec.radius[1], .4f);
    ck_assert_uint_eq(rad_ambient_list(w.job->ambient, &cursor, &rec, 1), 1);
    ck_assert_float_eq(rec.radius[0], 15);
    ck_assert_float_eq(rec.radius[1], 20);
}

/* Two lamps in a room are two bright places, though the scene's grid has them
 * in one cell, and some records lie far away. */
TEST(surroundings_leave_bright_places_apart)
{
    static const float lamp[2][3] = { { 900.5f, 700.5f, 2 },
                                      { 901.5f, 700.5f, 2 } };

    world_open(&w,
               PLASTIC "white ring ground 0 0 8 0 0 0 0 0 1 0 1024\n"
                       "white sphere mast 0 0 4 0 0 1024 .1\n",
               CACHED " --surroundings=256");
    rad_ambient_freeze(w.job->ambient);
    for (int i = 0; i < 100; i++) {
        struct rad_ambrec rec = record(900 + .02 * i, 700, 0, 1, 0);

        if (i % 10 == 0)
            rec.p[0] = -1000;
        memcpy(rec.glint.p, lamp[i % 2], sizeof lamp[0]);
        rec.glint.lum = 9;
        ck_assert(rad_ambient_insert(w.job->ambient, &rec));
    }
    ck_assert(rad_ambient_settle(w.job->ambient));
    ck_assert_uint_eq(rad_ambient_view(w.job->ambient, 1)->bright.n, 2);
}

/* A view's records, bright places and sums stay; those of a settling without
 * records are the same. */
TEST(a_view_is_what_its_records_told)
{
    static const size_t records[] = { 0, 1, 1, 2 };

    world_open(&w, PLASTIC CUBE, CACHED);
    rad_ambient_freeze(w.job->ambient);
    for (int i = 1; i < 4; i++) {
        struct rad_ambrec rec = record(.5 * i - 1, 0, -.5, (float)i, 0);

        rec.glint.p[i % 3] = .9f;
        rec.glint.lum = 9;
        ck_assert(i == 2 || rad_ambient_insert(w.job->ambient, &rec));
        ck_assert(rad_ambient_settle(w.job->ambient));
    }
    for (uint32_t i = 0; i < 4; i++) {
        const struct rad_ambview *v = rad_ambient_view(w.job->ambient, i);

        ck_assert_uint_eq(v->n, records[i]);
        ck_assert_uint_eq(v->bright.n, records[i]);
        ck_assert_int_eq(v->log_count, (int64_t)records[i]);
    }
    ck_assert_int_ne(rad_ambient_view(w.job->ambient, 1)->log_sum, 0);
    ck_assert_int_eq(rad_ambient_view(w.job->ambient, 2)->log_sum,
                     rad_ambient_view(w.job->ambient, 1)->log_sum);
}

TEST(interpolation_is_close_to_sampling)
{
    struct world cached = { 0 }, sampled = { 0 };
    double sum2 = 0;
    int n = 0;

    world_open(&cached, ROOM, "-ab 1 -aa .1 -ar 64 -ad 1024 -as 512 -av 0 0 0");
    world_open(&sampled, ROOM, "-ab 1 -aa 0 -ad 10000 -as 0 -lw 0 -av 0 0 0");
    /* once over, so that nearly all is interpolated when it counts */
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < 12; i++)
            for (int j = 0; j < 12; j++) {
                double x = .01 * i - .4, y = .01 * j + .1;
                double E = irradiance_up(&cached, x, y, -.9).g;

                if (pass == 0)
                    continue;
                double d = log(E / irradiance_up(&sampled, x, y, -.9).g);

                sum2 += d * d;
                n++;
            }
    ck_assert_msg(sqrt(sum2 / n) < .025, "rms %g", sqrt(sum2 / n));
    ck_assert_uint_lt(rad_ambient_count(cached.job->ambient), 144);
    world_close(&cached);
    world_close(&sampled);
}

/* A bounce takes three quarters of the samples, and no record is made for a
 * place that one serves. */
TEST(deep_records_take_fewer_samples)
{
    enum { MOST = 4096 };
    static struct rad_ambrec out[MOST];
    uint64_t cursor = 0, rays = 0;
    size_t n;

    world_open(&w, ROOM, "-ab 3 -aa .3 -ar 16 -ad 1024 -as 0 -av 0 0 0");
    irradiance_up(&w, .1, .2, -.9);
    irradiance_up(&w, -.4, .2, -.9);
    n = rad_ambient_list(w.job->ambient, &cursor, out, MOST);
    ck_assert(n > 10 && n < MOST);
    for (size_t i = 0; i < n; i++) {
        rays += out[i].level == 0 ? 1024 : out[i].level == 1 ? 256 : 64;
        /* at least a 16th of the scene, in area doubled by each bounce */
        ck_assert(out[i].radius[0] > (out[i].level == 0   ? .1249f
                                      : out[i].level == 1 ? .1767f
                                                          : .2499f));
    }
    ck_assert_uint_eq(rays, w.ctx.counts.ambient_rays);
}

/* Where a frozen cache has nothing at all, a picture's place samples for itself
 * alone, and so does what each of its rays meets, by few rays. */
TEST(what_a_frozen_cache_lacks_takes_few_samples)
{
    double E;

    world_open(&w, ROOM, "-ab 3 -aa .3 -ar 16 -ad 128 -as 0 -av 0 0 0");
    rad_ambient_freeze(w.job->ambient);
    ck_assert(rad_ambient_settle(w.job->ambient));
    E = (double)irradiance_up(&w, .1, .2, -.9).g;
    ck_assert(E > 0);
    /* 49 rays, 9 of each of what they meet, and 4 of each of what these do */
    ck_assert_uint_le(w.ctx.counts.ambient_rays, 49 + 49 * 9 + 49 * 9 * 4);
    ck_assert_uint_gt(w.ctx.counts.ambient_rays, 49 + 49 * 4);
}

/* So it is where a check samples the place afresh: with a record's own rays,
 * but few for what each of these meets. */
TEST(a_check_takes_few_samples_of_what_is_lacking)
{
    world_open(&w, ROOM, "-ab 3 -aa .3 -ar 16 -ad 128 -as 0 -av 0 0 0");
    rad_ambient_freeze(w.job->ambient);
    ck_assert(rad_ambient_settle(w.job->ambient));
    w.ctx.fresh = true;
    ck_assert(irradiance_up(&w, .1, .2, -.9).g > 0);
    ck_assert_uint_le(w.ctx.counts.ambient_rays, 128 + 128 * 9 + 128 * 9 * 4);
    ck_assert_uint_gt(w.ctx.counts.ambient_rays, 100 + 100 * 4);
}

/* Two rooms that share a floor, one dark; the cache is filled in the lit one,
 * right up to the wall. */
TEST(no_light_leaks_through_a_wall)
{
    static const char scene[] =
        ROOM "white polygon wall 0 0 12 .5 -1 -1 .5 -1 1 .5 1 1 .5 1 -1\n";

    world_open(&w, scene, "-ab 1 -aa .3 -ar 16 -ad 256 -as 0 -av 0 0 0");
    for (int i = 0; i < 400; i++)
        irradiance_up(&w, .499 - .01 * (i % 20), -.9 + .09 * (i / 20), -.99);
    for (int i = 0; i < 20; i++)
        ck_assert_double_eq(
            irradiance_up(&w, .501 + .02 * (i % 4), -.9 + .09 * i, -.99).g, 0);
}

/* The same through which a thousandth of the light comes, straight on: rays of
 * the hemispheres pass it. */
static const char *const dark_pane[] = {
    "void glass pane 0 0 3 .001 .001 .001\n",
    "void trans pane 0 0 7 .5 .5 .5 0 0 .002 1\n",
};

LOOP_TEST(no_light_leaks_through_a_dark_pane, N_ELEM(dark_pane))
{
    char scene[2000];
    double lit;

    snprintf(scene, sizeof scene,
             ROOM "%spane polygon p 0 0 12 .5 -1 -1 .5 -1 1 .5 1 1 .5 1 -1\n",
             dark_pane[_i]);
    world_open(&w, scene, "-ab 1 -aa .3 -ar 16 -ad 256 -as 0 -av 0 0 0");
    for (int i = 0; i < 400; i++)
        irradiance_up(&w, .499 - .01 * (i % 20), -.9 + .09 * (i / 20), -.99);
    lit = (double)irradiance_up(&w, .45, 0, -.99).g;
    for (int i = 0; i < 20; i++) {
        double x = .501 + .02 * (i % 4), y = -.9 + .09 * i;

        ck_assert_double_lt((double)irradiance_up(&w, x, y, -.99).g, .01 * lit);
    }
}

/* The same of deep records of a frozen cache, of which those that need a ray to
 * find out what stands before them are left out where others serve. */
TEST(deep_records_need_few_tests_for_walls)
{
    static const char scene[] =
        ROOM "white polygon wall 0 0 12 .5 -1 -1 .5 -1 1 .5 1 1 .5 1 -1\n";
    static struct rad_ambrec rec[4000];
    struct rad_ambplace at = { .n = { 0, 0, 1 },
                               .pn = { 0, 0, 1 },
                               .err = 1e-9,
                               .level = 1,
                               .weight = .5 };
    uint64_t cursor = 0, rays;
    size_t n;

    world_open(&w, scene, "-ab 1 -aa .3 -ar 16 -ad 256 -as 0 -av 0 0 0");
    for (int i = 0; i < 400; i++)
        irradiance_up(&w, .499 - .01 * (i % 20), -.9 + .09 * (i / 20), -.99);
    n = rad_ambient_list(w.job->ambient, &cursor, rec, N_ELEM(rec));
    ck_assert(n > 20 && n < N_ELEM(rec));
    for (size_t i = 0; i < n; i++)
        rec[i].level = 1;
    world_open(&w, scene, "-ab 2 -aa .3 -ar 16 -ad 256 -as 0 -av 0 0 0");
    rad_ambient_freeze(w.job->ambient);
    rad_ambient_insert_all(w.job->ambient, rec, n);
    ck_assert(rad_ambient_settle(w.job->ambient));
    at.p[2] = -.99;
    rays = w.ctx.counts.rays;
    for (int i = 0; i < 400; i++) {
        at.p[0] = .499 - .01 * (i % 20);
        at.p[1] = -.9 + .09 * (i / 20);
        ck_assert(rad_ambient_serves(&w.ctx, &at));
    }
    ck_assert_uint_lt(w.ctx.counts.rays - rays, 100);
    for (int i = 0; i < 20; i++) {
        at.p[0] = .501 + .02 * (i % 4);
        at.p[1] = -.9 + .09 * i;
        ck_assert(!rad_ambient_serves(&w.ctx, &at));
    }
}

/* Too bright to be summed: black, counted, and not kept. */
TEST(infinite_irradiance_is_not_kept)
{
    world_open(&w,
               "void glow g 0 0 4 3e38 3e38 3e38 0\n"
               "g source sky 0 0 4 0 0 1 180\n",
               CACHED);
    ck_assert_double_eq(irradiance_up(&w, 0, 0, 0).g, 0);
    ck_assert_uint_gt(w.ctx.counts.unsound_rays, 0);
    ck_assert_uint_eq(rad_ambient_count(w.job->ambient), 0);
}

/* The same room in other units, by powers of two: the same bits. */
TEST(units_do_not_matter)
{
    static const double scale[] = { 1, 0x1p-17, 0x1p20 };
    struct rad_rgb first[20];
    uint64_t values = 0;

    for (int k = 0; k < N_ELEM(scale); k++) {
        char text[4096], *at = text;

        at += sprintf(at, "void glow g 0 0 4 9 9 9 0\n" PLASTIC);
        for (int face = 0; face < 7; face++) {
            static const int uv[3][2] = { { 1, 2 }, { 2, 0 }, { 0, 1 } };
            int axis = face < 6 ? face / 2 : 2;

            at += sprintf(at, "%s polygon f%d 0 0 12", face < 6 ? "white" : "g",
                          face);
            for (int c = 0; c < 4; c++) {
                double q[3], side = face < 6 ? 1 : .25;

                q[axis] = face < 6 ? face % 2 * 2 - 1 : .875;
                q[uv[axis][0]] = c == 1 || c == 2 ? side : -side;
                q[uv[axis][1]] = c >= 2 ? -side : side;
                at += sprintf(at, " %.17g %.17g %.17g", q[0] * scale[k],
                              q[1] * scale[k], q[2] * scale[k]);
            }
            at += sprintf(at, "\n");
        }
        world_open(&w, text, "-ab 2 -aa .2 -ar 32 -ad 64 -as 32 -av 0 0 0");
        for (int i = 0; i < 20; i++) {
            static const double up[3] = { 0, 0, 1 };
            double p[3] = { (.09 * i - .9) * scale[k], .1 * scale[k],
                            -.5 * scale[k] };
            struct rad_ray r;

            rad_ray_irradiance(&w.ctx, &r, p, up, (uint64_t)i);
            if (k == 0)
                first[i] = r.L;
            ck_assert_double_eq_tol(r.L.g, first[i].g, 1e-5 * first[i].g);
        }
        if (k == 0)
            values = w.ctx.counts.ambient_values;
        ck_assert_uint_eq(w.ctx.counts.ambient_values, values);
    }
}

/* --- threads --- */

enum { THREADS = 8, PER_THREAD = 2000 };

struct worker {
    pthread_t thread;
    int number;
    int missed; /* own records not found at once */
    struct rad_counts counts;
};

static double
spread(int thread, int i, int axis)
{
    return 1.9 * rad_rand((uint64_t)thread, (uint32_t)(2 * i + axis)) - .95;
}

static void *
insert_and_find(void *arg)
{
    struct worker *me = arg;
    struct rad_rgb E;

    for (int i = 0; i < PER_THREAD; i++) {
        double x = spread(me->number, i, 0), y = spread(me->number, i, 1);
        struct rad_ambrec rec = record(x, y, -.5, 1, 0);

        rec.radius[0] = rec.radius[1] = .05f;
        if (!rad_ambient_insert(w.job->ambient, &rec) ||
            !(find(x, y, -.5, 0, 1, &E) > 0))
            me->missed++;
        /* what another may have put there by now */
        find(spread((me->number + 1) % THREADS, i, 0),
             spread((me->number + 1) % THREADS, i, 1), -.5, 0, 1, &E);
    }
    return NULL;
}

static void
run(struct worker *worker, void *(*body)(void *))
{
    for (int i = 0; i < THREADS; i++) {
        worker[i] = (struct worker){ .number = i };
        ck_assert_int_eq(
            pthread_create(&worker[i].thread, NULL, body, &worker[i]), 0);
    }
}

static void
join(struct worker *worker)
{
    for (int i = 0; i < THREADS; i++)
        pthread_join(worker[i].thread, NULL);
}

TEST(threads_lose_no_record)
{
    static struct rad_ambrec out[THREADS * PER_THREAD + 1];
    struct worker worker[THREADS];
    uint64_t cursor = 0;
    struct rad_rgb E;

    world_open(&w, PLASTIC CUBE, CACHED);
    run(worker, insert_and_find);
    join(worker);
    ck_assert_uint_eq(rad_ambient_count(w.job->ambient), THREADS * PER_THREAD);
    ck_assert_uint_eq(
        rad_ambient_list(w.job->ambient, &cursor, out, N_ELEM(out)),
        THREADS * PER_THREAD);
    for (int i = 0; i < THREADS; i++) {
        ck_assert_int_eq(worker[i].missed, 0);
        for (int k = 0; k < PER_THREAD; k++)
            ck_assert(find(spread(i, k, 0), spread(i, k, 1), -.5, 0, 1, &E) >
                      0);
    }
}

static void *
trace_points(void *arg)
{
    static const double up[3] = { 0, 0, 1 };
    struct worker *me = arg;
    struct rad_ctx ctx;

    if (rad_ctx_init(&ctx, w.job, NULL) < 0)
        return NULL;
    for (int i = 0; i < 300; i++) {
        double p[3] = { spread(me->number, i, 0), spread(me->number, i, 1),
                        -.99 };
        struct rad_ray r;

        rad_ray_irradiance(&ctx, &r, p, up, (uint64_t)i);
        if (!(r.L.g > 0))
            me->missed++;
    }
    me->counts = ctx.counts;
    rad_ctx_release(&ctx);
    return NULL;
}

/* Eight render threads, and this one in the loop thread's part. */
TEST(threads_share_what_they_sample)
{
    static struct rad_ambrec out[64];
    struct worker worker[THREADS];
    size_t drained = 0, n;
    uint64_t made = 0;

    world_open(&w, ROOM, "-ab 2 -aa .2 -ar 32 -ad 64 -as 32 -av 0 0 0");
    run(worker, trace_points);
    for (int i = 0; i < 1000; i++) {
        struct rad_ambrec rec =
            record(spread(99, i, 0), spread(99, i, 1), .99, 1, 1);

        rec.n[2] = -1;
        ck_assert(rad_ambient_insert(w.job->ambient, &rec));
        drained += rad_ambient_drain(w.job->ambient, out, N_ELEM(out));
    }
    join(worker);
    while ((n = rad_ambient_drain(w.job->ambient, out, N_ELEM(out))) > 0)
        drained += n;
    for (int i = 0; i < THREADS; i++) {
        ck_assert_int_eq(worker[i].missed, 0);
        made += worker[i].counts.ambient_values;
    }
    ck_assert_uint_gt(made, 0);
    ck_assert_uint_eq(drained, made);
    ck_assert_uint_eq(rad_ambient_count(w.job->ambient), made + 1000);
}

/* One thread alone always makes the same records. */
TEST(one_thread_is_deterministic)
{
    struct rad_rgb first[50];

    for (int round = 0; round < 2; round++) {
        world_open(&w, ROOM, "-ab 2 -aa .2 -ar 32 -ad 64 -as 32 -av 0 0 0");
        for (int i = 0; i < N_ELEM(first); i++) {
            struct rad_rgb E =
                irradiance_up(&w, spread(5, i, 0), spread(5, i, 1), -.9);

            if (round == 0)
                first[i] = E;
            ck_assert_mem_eq(&E, &first[i], sizeof E);
        }
    }
}
