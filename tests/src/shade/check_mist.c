/* check_mist.c - tests of src/shade/mist.c: media that scatter light */
#include "config.h"

#include "base/rng.h"
#include "tests/world_fixture.h"

#include <stdio.h>
#include <string.h>

FIXTURE(NULL, world_tear_down)

/* A wall at z = 0 of radiance 7 that is seen as it is. */
#define WALL                                                                   \
    "void glow bright 0 0 4 7 7 7 0\nbright ring wall 0 0 8 0 0 0 0 0 1 0 "    \
    "99\n"
/* A layer from z = lo to hi, of modifier `name`. */
#define LAYER(name, lo, hi)                                                    \
    name " ring top_" name " 0 0 8 0 0 " hi " 0 0 1 0 99\n" name               \
         " ring bottom_" name " 0 0 8 0 0 " lo " 0 0 -1 0 99\n"

static void
alike(double a, double b)
{
    ck_assert_msg(a == b || fabs(a - b) < 2e-6 * b, "%.9g and %.9g", a, b);
}

static double
down(double x, double z)
{
    return world_see(&w, x, 0, z, 0, 0, -1).r;
}

/* Mean over the random numbers of n rays that start at o in direction d. */
static double
mean_of(const double o[3], const double d[3], int n)
{
    double sum = 0;
    struct rad_ray r;

    for (int i = 0; i < n; i++) {
        world_ray(&w, &r, o[0], o[1], o[2], d[0], d[1], d[2]);
        r.key = rad_mix64((uint64_t)i);
        rad_ray_trace(&w.ctx, &r);
        sum += r.L.r;
    }
    return sum / n;
}

TEST(layer_dims_by_its_optical_depth)
{
    struct rad_rgb L;

    world_open(&w, WALL "void mist fog 0 0 3 .1 .2 .3\n" LAYER("fog", "1", "3"),
               "-me .01 0 0");
    L = world_see(&w, 0, 0, 5, 0, 0, -1);
    near(L.r, 7 * exp(-.1 * 2 - .01 * 5));
    near(L.g, 7 * exp(-.2 * 2));
    near(L.b, 7 * exp(-.3 * 2));
    near(down(0, 1), 7 * exp(-.01)); /* below it */
}

TEST(pattern_scales_the_extinction)
{
    world_open(&w,
               WALL "void brightfunc half 2 .5 . 0 0\n"
                    "half mist fog 0 0 3 .2 .2 .2\n" LAYER("fog", "1", "3"),
               "");
    near(down(0, 5), 7 * exp(-.1 * 2));
}

/* A ray that goes straight on has no weight of its own to play for. */
static const char *const roulette[] = { "-lr 0 -lw .001", "-lr 0 -lw .5",
                                        "-lr -3 -lw .5" };

#define MIRROR                                                                 \
    "void mirror m 0 0 3 .8 .8 .8\nm ring above 0 0 8 0 0 9 0 0 -1 0 5\n"

LOOP_TEST(roulette_ends_no_ray_in_a_layer, N_ELEM(roulette))
{
    static const char scene[] =
        WALL MIRROR "void mist fog 0 0 3 .5 .5 .5\n" LAYER("fog", "1", "3")
            "void antimatter clear 1 void 0 0\n" LAYER("clear", "4", "5");

    world_open(&w, scene, roulette[_i]);
    near(world_see(&w, 0, 0, 6, 0, 0, 1).r, .8 * 7 * exp(-.5 * 2));
}

/* What is scattered of the ambient value replaces what is lost: with an albedo
 * of 1 in an even surrounding nothing shows. */
TEST(ambient_value_is_scattered_in)
{
    world_open(&w, WALL, "-me .2 .2 .2 -ma .5 1 0 -av 7 7 7");
    struct rad_rgb L = world_see(&w, 0, 0, 5, 0, 0, -1);

    near(L.r, 7 * (exp(-1) + .5 * (1 - exp(-1))));
    near(L.g, 7);
    near(L.b, 7 * exp(-1));
    near(world_see(&w, 0, 0, 5, 0, 0, 1).g, 7); /* up to nowhere */
}

/* What lights a floor at the bottom of a layer 2 deep, and the length of its
 * way in the layer. */
static const struct {
    const char *text;
    double way;
} above[] = {
    { "sun source s 0 0 4 0 0 1 .5\n", 2 },
    { "void brightfunc half 2 .5 . 0 0\n"
      "half light dim 0 0 3 1e4 1e4 1e4\ndim source s 0 0 4 0 0 1 .5\n",
      2 },
    { "sun ring r 0 0 8 0 0 4 0 0 -1 0 .001\n", 2 },
    { "sun ring r 0 0 8 0 0 1 0 0 -1 0 .001\n", 1 },
    { "void brightfunc half 2 .5 . 0 0\n"
      "half light dim 0 0 3 1e4 1e4 1e4\n"
      "dim ring r 0 0 8 0 0 1 0 0 -1 0 .001\n",
      1 },
    { "sun source s 0 0 4 1 0 1 1e-4\nvoid mirror m 0 0 3 1 1 1\n"
      "m polygon p 0 0 12 -1 -1 0 -1 1 0 -1 1 1.9 -1 -1 1.9\n",
      2 * M_SQRT2 },
};

LOOP_TEST(lights_reach_into_a_cloud, N_ELEM(above))
{
    static const char *const options[] = { "-dt 0", "-dt .5 -dj .5" };
    char scene[1024];

    for (int k = 0; k < 2; k++) {
        double clear;

        snprintf(scene, sizeof scene,
                 "void plastic p 0 0 5 .5 .5 .5 0 0\n"
                 "p ring floor 0 0 8 0 0 0 0 0 1 0 9\n"
                 "void light sun 0 0 3 1e4 1e4 1e4\n%s",
                 above[_i].text);
        world_open(&w, scene, options[k]);
        clear = world_see(&w, 5, 0, 5, -1, 0, -1).r;
        strcat(scene, "void mist fog 0 0 7 .3 .3 .3 .4 .4 .4 0\n" LAYER(
                          "fog", "-1", "2"));
        world_open(&w, scene, options[k]);
        ck_assert_double_gt(clear, 0);
        ck_assert_double_eq_tol(
            world_see(&w, 5, 0, 5, -1, 0, -1).r / clear,
            exp(-.3 * 2 * M_SQRT2 - .3 * .6 * above[_i].way), 1e-5);
    }
}

/* -me does not dim what is in a mist of its own, so that -dt must not take far
 * lamps for dark: few near lamps would be tested, and the rest be lost. */
TEST(far_lamps_in_a_cloud_are_tested)
{
    static const char *const dt[] = { "-dt 0", "-dt .02" };
    char scene[4096] =
        "void plastic p 0 0 5 .5 .5 .5 0 0\n"
        "p ring floor 0 0 8 0 0 0 0 0 1 0 99\n"
        "void light lamp 0 0 3 1 1 1\n"
        "void mist fog 0 0 7 1e-6 1e-6 1e-6 1 1 1 0\n" LAYER("fog", "-1", "90");
    char options[80];
    double seen[2];

    for (int i = 0; i < 23; i++) {
        char *end = scene + strlen(scene);

        snprintf(end, sizeof scene - (size_t)(end - scene),
                 i < 3 ? "lamp sphere s 0 0 4 %d -6 6 .3\n"
                       : "lamp sphere s 0 0 4 %d 20 60 3\n",
                 i < 3 ? 4 * i - 4 : 7 * i - 91);
    }
    for (int k = 0; k < 2; k++) {
        snprintf(options, sizeof options, "-me .1 .1 .1 -ma 0 0 0 -dj 0 %s",
                 dt[k]);
        world_open(&w, scene, options);
        seen[k] = world_see(&w, 3, 0, 91, -.03, 0, -1).r;
    }
    ck_assert_double_gt(seen[0], 0);
    ck_assert_double_eq_tol(seen[1] / seen[0], 1, .02);
}

/* Layers that overlap, one left before the other or inside it; what is outside
 * at the end is as clear as before. */
static const struct {
    const char *a, *b;
    double depth;
} layers[] = {
    { LAYER("a", "1", "4"), LAYER("b", "2", "3"), .1 * 3 + .3 * 1 },
    { LAYER("a", "1", "3"), LAYER("b", "2", "4"), .1 * 2 + .3 * 2 },
    { LAYER("a", "2", "4"), LAYER("b", "1", "3"), .1 * 2 + .3 * 2 },
    { LAYER("a", "1", "2"), LAYER("b", "3", "4"), .1 * 1 + .3 * 1 },
};

LOOP_TEST(overlapping_layers_add_up, N_ELEM(layers))
{
    char scene[1024];
    struct rad_rgb up;

    snprintf(scene, sizeof scene,
             "%svoid mist a 0 0 3 .1 .1 .1\nvoid mist b 0 0 3 .3 .3 .3\n%s%s"
             "void glow sky 0 0 4 5 5 5 0\nsky source s 0 0 4 0 0 1 180\n",
             WALL, layers[_i].a, layers[_i].b);
    world_open(&w, scene, "");
    near(down(0, 5), 7 * exp(-layers[_i].depth));
    /* no rest of extinction on the endless way to the sky */
    up = world_see(&w, 0, 0, .5, 0, 0, 1);
    near(up.r, 5 * exp(-layers[_i].depth));
}

/* An inner mist with an albedo of its own gives way to the outer one's where
 * it ends. */
TEST(albedo_comes_back_when_the_inner_mist_ends)
{
    double e = exp(-.2);

    world_open(&w,
               "void mist a 0 0 7 .2 .2 .2 1 1 1 0\n"
               "void mist b 0 0 7 0 0 0 0 0 0 0\n" LAYER("a", "1", "4")
                   LAYER("b", "2", "3"),
               "-av 1 1 1");
    /* a's three units lose e each, and the outer two scatter in */
    near(down(0, 5), (1 - e) + e * e * (1 - e));
}

/* In front of, in, and behind a ball of index 1, which absorbs. */
TEST(mist_is_back_behind_a_dielectric)
{
    world_open(&w,
               WALL "void mist fog 0 0 6 .1 .1 .1 0 0 0\n" LAYER(
                   "fog", "1", "9") "void dielectric ball 0 0 5 .5 .5 .5 1 0\n"
                                    "ball sphere s 0 0 4 0 0 5 1\n",
               "-me .02 .02 .02 -ma .3 .3 .3");
    near(down(0, 10), 7 * exp(-.02 * 8 - .1 * 6) * .25);
}

/* The irradiance of a lamp through mist: what scatters out of the way to it
 * scatters in as well, so absorption alone dims it. */
TEST(shadow_rays_lose_what_is_absorbed)
{
    static const double p[3] = { 0, 0, 0 }, n[3] = { 0, 0, 1 };
    struct rad_ray r;

    world_open(&w,
               "void light l 0 0 3 100 100 100\nl sphere s 0 0 4 0 0 10 .01\n"
               "void mist fog 0 0 6 .1 .1 .1 .8 0 1\n" LAYER("fog", "1", "5"),
               "");
    rad_ray_irradiance(&w.ctx, &r, p, n, 1);
    double E = M_PI * 100 * 1e-6;

    near(r.L.r, E * exp(-.1 * .2 * 4));
    near(r.L.g, E * exp(-.1 * 4));
    near(r.L.b, E);
}

/* Single scattering of a small lamp beside a ray, by the midpoint rule over
 * its way. */
static double
scattered(const double lamp[3], double z0, double z1, double z_eye, double ext,
          double albedo, double g)
{
    int n = 100000;
    double sum = 0, dz = (z1 - z0) / n;

    for (int i = 0; i < n; i++) {
        double z = z0 + (i + .5) * dz, d[3] = { lamp[0], lamp[1], lamp[2] - z };
        double d2 = rad_dot(d, d), cosine = -d[2] / sqrt(d2);
        double q = 1 + g * g - 2 * g * cosine;
        double phase = (1 - g * g) / (4 * M_PI * q * sqrt(q));
        double absorbed = exp(-ext * (1 - albedo) * sqrt(d2));

        sum += albedo * ext * exp(-ext * (z_eye - z)) * phase * absorbed / d2;
    }
    return sum * dz;
}

static const struct {
    const char *mist, *options;
    double ext, albedo, g;
} scattering[] = {
    { "1 b 0 7 .1 .1 .1 .9 .9 .9 0", "", .1, .9, 0 },
    { "1 b 0 7 .1 .1 .1 .9 .9 .9 .6", "-ms .5", .1, .9, .6 },
    /* what the scene's own medium leaves to be said */
    { "1 b 0 0", "-me .2 .2 .2 -ma .5 .5 .5 -mg .3 -ms 2", .2, .5, .3 },
    /* as in Radiance, below 0 is even, and 1 scatters nothing aside */
    { "1 b 0 7 .1 .1 .1 .9 .9 .9 -.5", "-ms 1", .1, .9, 0 },
};

LOOP_TEST(source_is_scattered_into_the_ray, N_ELEM(scattering))
{
    static const double lamp[3] = { 2, 0, 4 }, eye[3] = { 0, 0, 20 },
                        dir[3] = { 0, 0, -1 };
    char scene[512];
    int n = 40000;

    snprintf(scene, sizeof scene,
             "void light l 0 0 3 1e6 1e6 1e6\nl sphere b 0 0 4 2 0 4 1e-3\n"
             "void mist fog %s\n%s%s",
             scattering[_i].mist, "fog sphere s 0 0 4 0 0 4 8\n",
             "void plastic floor 0 0 5 0 0 0 0 0\n"
             "floor ring f 0 0 8 0 0 0 0 0 1 0 1\n");
    world_open(&w, scene, scattering[_i].options);
    double truth = M_PI * scattered(lamp, 0, 12, 12, scattering[_i].ext,
                                    scattering[_i].albedo, scattering[_i].g);
    double me = w.params.cextinction.r;

    truth *= exp(-me * 8); /* from the mist's top to the eye */
    double L = mean_of(eye, dir, n);

    ck_assert_double_eq_tol(L, truth, .01 * truth);
}

/* Rays that start in the mist, and leave it, know of its sources. */
TEST(eye_in_a_mist_with_sources_sees_them)
{
    static const double lamp[3] = { 2, 0, 4 }, eye[3] = { 0, 0, 8 },
                        down_[3] = { 0, 0, -1 };

    world_open(&w,
               "void light l 0 0 3 1e6 1e6 1e6\nl sphere b 0 0 4 2 0 4 1e-3\n"
               "void mist fog 1 b 0 7 .1 .1 .1 .9 .9 .9 0\n"
               "fog sphere s 0 0 4 0 0 4 8\n",
               "-ms .5");
    double truth = M_PI * scattered(lamp, -4, 8, 8, .1, .9, 0);

    ck_assert_double_eq_tol(mean_of(eye, down_, 20000), truth, .01 * truth);
}

/* Its boundary is another surface as well, first or second in a mixture: of
 * either part the medium of the scene takes what it takes once, and the mist
 * that of its own. */
LOOP_TEST(mixture_is_left_from_inside_by_parts, 2)
{
    char scene[512];

    snprintf(scene, sizeof scene,
             "void light l 0 0 3 1e-9 1e-9 1e-9\nl sphere b 0 0 4 2 0 4 .1\n"
             "void glow bright 0 0 4 7 7 7 0\n"
             "bright ring wall 0 0 8 0 0 -20 0 0 1 0 99\n"
             "void mist fog 1 b 0 3 .1 .1 .1\n"
             "void plastic paint 0 0 5 .5 .5 .5 0 0\n"
             "void mixfunc both 4 %s . 0 0\nboth sphere s 0 0 4 0 0 4 8\n",
             _i == 0 ? "fog paint .25" : "paint fog .75");
    world_open(&w, scene, "-me .01 .01 .01 -av 1 1 1");
    near(down(0, 8),
         .25 * 7 * exp(-.01 * 28 - .1 * 12) + .75 * .5 * exp(-.01 * 12));
}

/* Which lamp lights the mist, by its colour. */
static const struct {
    const char *names, *options;
    bool red, green, relayed;
} named[] = {
    { "1 r", "", true, false, false },
    { "2 g r", "", true, true, false },
    { "3 nobody r r", "", true, false, false },
    { "1 twin", "", false, true, false }, /* the last of that name */
    { "1 m>r", "-dp 0", true, false, true },
    { "1 m>r", "-dr 0", false, false, false },
    { "1 m", "-dp 0", false, false, false },
    { "0", "", false, false, false },
};

LOOP_TEST(names_say_which_sources_light_it, N_ELEM(named))
{
    static const double eye[3] = { 0, 0, 9 }, dir[3] = { 0, 0, -1 };
    char scene[1024];
    struct rad_ray r;

    snprintf(scene, sizeof scene,
             "void light red 0 0 3 1e6 0 0\nvoid light green 0 0 3 0 1e6 0\n"
             "red sphere twin 0 0 4 2 1 3 1e-3\nred sphere r 0 0 4 2 0 4 1e-3\n"
             "green sphere g 0 0 4 -2 0 4 1e-3\n"
             "green sphere twin 0 0 4 -2 1 3 1e-3\n"
             "void mirror glass 0 0 3 1 1 1\n"
             "glass polygon m 0 0 12 -5 -9 0 -5 9 0 -5 9 9 -5 -9 9\n"
             "void mist fog %s 0 6 .1 .1 .1 .9 .9 .9\n"
             "fog ring top 0 0 8 0 0 8 0 0 1 0 1\n"
             "fog ring low 0 0 8 0 0 1 0 0 -1 0 1\n"
             "void plastic floor 0 0 5 0 0 0 0 0\n"
             "floor ring f 0 0 8 0 0 0 0 0 1 0 1\n",
             named[_i].names);
    world_open(&w, scene, named[_i].options);
    world_ray(&w, &r, eye[0], eye[1], eye[2], dir[0], dir[1], dir[2]);
    rad_ray_trace(&w.ctx, &r);
    ck_assert_int_eq(r.L.r > 0, named[_i].red);
    ck_assert_int_eq(r.L.g > 0, named[_i].green);
    if (named[_i].relayed) /* from 12 away, by way of the mirror */
        ck_assert_double_lt(r.L.r, M_PI * .09 * 7 / (4 * M_PI) / 100);
}

/* -ms says how many rays go to a source: as many as fit, 1 to 16, in any unit.
 */
static const struct {
    const char *options;
    int rays;
} spacing[] = { { "-ms 0", 1 },   { "-ms 7", 1 },   { "-ms 2.1", 3 },
                { "-ms .5", 14 }, { "-ms .1", 16 }, { "-ms 1e-9", 16 } };

LOOP_TEST(samples_are_as_far_apart_as_asked, N_ELEM(spacing))
{
    world_open(&w,
               "void light l 0 0 3 1 1 1\nl sphere b 0 0 4 2 0 4 1e-3\n"
               "void mist fog 1 b 0 6 .1 .1 .1 .9 .9 .9\n"
               "fog ring top 0 0 8 0 0 8 0 0 1 0 1\n"
               "fog ring low 0 0 8 0 0 1 0 0 -1 0 1\n",
               spacing[_i].options);
    down(0, 9);
    ck_assert_uint_eq(w.ctx.counts.shadow_rays, (uint64_t)spacing[_i].rays);
}

TEST(same_key_gives_the_same_value)
{
    static const double eye[3] = { 0, 0, 9 }, dir[3] = { 0, 0, -1 };
    double L[2];

    for (int i = 0; i < 2; i++) {
        world_open(&w,
                   "void light l 0 0 3 1 1 1\nl sphere b 0 0 4 2 0 4 1e-3\n"
                   "void mist fog 1 b 0 6 .1 .1 .1 .9 .9 .9\n"
                   "fog ring top 0 0 8 0 0 8 0 0 1 0 1\n"
                   "fog ring low 0 0 8 0 0 1 0 0 -1 0 1\n",
                   "-ms 1");
        if (i == 1) /* history does not matter */
            mean_of(eye, dir, 10);
        L[i] = mean_of(eye, dir, 1);
    }
    ck_assert_double_eq(L[0], L[1]);
    ck_assert_double_gt(L[0], 0);
}

/* Mists in mists, two of which name lamps, before a wall; more of a mist than
 * a ray's line holds. */
#define MAZE                                                                   \
    "void spotlight a 0 0 7 900 500 300 60 -2 0 -2\n"                          \
    "a ring lamp 0 0 8 2 0 2 -2 0 -2 0 .1\n"                                   \
    "void light b 0 0 3 20 20 40\n"                                            \
    "b polygon pane 0 0 12 -1 -1 3  -1 1 3  1 1 3  1 -1 3\n"                   \
    "void plastic grey 0 0 5 .5 .5 .5 0 0\n"                                   \
    "grey ring wall 0 0 8 0 0 -4 0 0 1 0 9\n"                                  \
    "void mist smoke 0 0 7 .1 .2 .3 .9 .8 .7 .3\n"                             \
    "smoke sphere s1 0 0 4 0 0 0 2.5\nsmoke sphere s2 0 0 4 0 0 -2 1\n"        \
    "void mist beam 1 lamp 0 0\n"                                              \
    "beam cone c 0 0 8 1.9 0 1.9 -1.5 0 -1.5 .1 2\n"                           \
    "beam ring d 0 0 8 -1.5 0 -1.5 -2 0 -2 0 2\n"                              \
    "beam ring e 0 0 8 1.9 0 1.9 2 0 2 0 .1\n"                                 \
    "void mist light 2 lamp pane 0 4 .05 .05 .1 .5\n"                          \
    "light sphere l1 0 0 4 0 .3 0 .7\nlight sphere l2 0 0 4 .5 0 .5 .4\n"      \
    "light sphere l3 0 0 4 -.5 0 -.5 .4\n"

/* Antimatter anywhere makes each boundary a ray's end. */
#define ELSEWHERE                                                              \
    "void antimatter hole 1 grey 0 0\nhole sphere far 0 0 4 0 0 90 1\n"

static const char *const maze[] = {
    "-ds .2 -dj 0", "-ds 0 -ms .3 -dj .9 -dt .1",       "-lw .5",
    "-lr 0 -lw .4", "-me .1 .1 .1 -ma .5 .5 .5 -mg .2", "-me .3 .2 .1",
};

LOOP_TEST(boundaries_passed_at_once_are_what_they_are_one_by_one, N_ELEM(maze))
{
    struct world worlds[2] = { 0 };
    struct rad_ray r[2];

    world_open(&worlds[0], MAZE, maze[_i]);
    world_open(&worlds[1], MAZE ELSEWHERE, maze[_i]);
    for (int i = 0; i < 2000; i++) {
        uint64_t key = rad_key_branch(7, (uint64_t)i);
        double d[3], o[3];

        for (int k = 0; k < 3; k++) { /* some begin inside */
            o[k] = 4 * rad_rand(key, k) - 2 + (k == 2 ? 2 : 0);
            d[k] = 2 * rad_rand(key, 3 + k) - 1 - o[k];
        }
        rad_normalize(d);
        for (int k = 0; k < 2; k++) {
            world_ray(&worlds[k], &r[k], o[0], o[1], o[2], d[0], d[1], d[2]);
            r[k].key = key;
            rad_ray_trace(&worlds[k].ctx, &r[k]);
        }
        alike(r[0].L.r, r[1].L.r);
        alike(r[0].L.b, r[1].L.b);
        alike(r[0].dist, r[1].dist);
    }
    ck_assert_uint_eq(worlds[0].ctx.counts.rays, worlds[1].ctx.counts.rays);
    world_close(&worlds[0]);
    world_close(&worlds[1]);
}

TEST(irradiance_of_the_eye_sees_no_mist)
{
    world_open(&w,
               "void plastic p 0 0 5 .5 .5 .5 0 0\n"
               "p ring f 0 0 8 0 0 0 0 0 1 0 9\n"
               "void mist fog 0 0 3 .1 .1 .1\n" LAYER("fog", "1", "3"),
               "-i -av 1 1 1");
    near(down(0, 5), M_PI);
}
