/* check_source.c - tests of src/light: what a point sees of light sources, in
 * whole scenes */
#include "config.h"

#include "base/rng.h"
#include "base/vec.h"
#include "tests/lambert.h"
#include "tests/world_fixture.h"

#include <stdio.h>
#include <string.h>

FIXTURE(NULL, world_tear_down)

static const double origin[3] = { 0, 0, 0 }, up[3] = { 0, 0, 1 };

#define LAMP    "void light bright 0 0 3 1 1 1\n"
#define PLASTIC "void plastic white 0 0 5 .5 .5 .5 0 0\n"
/* 2 x 2 facing down at z = 2 */
#define SQUARE_LAMP                                                            \
    LAMP "bright polygon lamp 0 0 12 -1 -1 2 -1 1 2 1 1 2 1 -1 2\n"
/* The same, of a radiance that is a function of direction. */
#define SHAPED_LAMP                                                            \
    "void brightfunc f 2 if(Dz,1,.5) . 0 0\nf light bright 0 0 3 1 1 1\n"      \
    "bright polygon lamp 0 0 12 -1 -1 2 -1 1 2 1 1 2 1 -1 2\n"
static const double square[] = { -1, -1, 2, -1, 1, 2, 1, 1, 2, 1, -1, 2 };
#define DIRECT "-ab 0 -av 0 0 0 -dj 0 -dt 0 "

static double
irradiance_at(struct world *in, double x, double y, double z)
{
    double p[3] = { x, y, z };
    struct rad_ray r;

    rad_ray_irradiance(&in->ctx, &r, p, up, 1);
    return r.L.g;
}

static double
irradiance_of(const char *text, const char *options, double x, double y,
              double z)
{
    world_open(&w, text, options);
    return irradiance_at(&w, x, y, z);
}

TEST(lamp_lights_and_counts_its_rays)
{
    world_open(&w, SQUARE_LAMP, DIRECT "-ds .2");
    ck_assert_double_eq_tol(irradiance_at(&w, 0, 0, 0),
                            lambert(square, 4, origin, up), 1e-3);
    ck_assert_uint_gt(w.ctx.counts.shadow_rays, 16);
    ck_assert_uint_ge(w.ctx.counts.rays, w.ctx.counts.shadow_rays);
}

/* What is in the way: name, text, what passes. */
static const struct {
    const char *name, *text;
    double passes;
} blocker[] = {
    { "nothing", "", 1 },
    { "a plate",
      PLASTIC "white polygon plate 0 0 12 -1 -1 1 1 -1 1 1 1 1 "
              "-1 1 1\n",
      0 },
    { "a plate from behind",
      PLASTIC "white polygon plate 0 0 12 -1 1 1 1 1 1 1 -1 1 -1 -1 1\n", 0 },
    { "the plane that the lamp is set in",
      PLASTIC "white polygon ceiling 0 0 12 -9 -9 2 -9 9 2 9 9 2 9 -9 2\n", 1 },
    { "that plane, turned round",
      PLASTIC "white polygon ceiling 0 0 12 9 -9 2 9 9 2 -9 9 2 -9 -9 2\n", 1 },
    { "that plane, behind a dielectric",
      "void dielectric air 0 0 5 1 1 1 1 0\n"
      "air polygon plate 0 0 12 -9 -9 1 9 -9 1 9 9 1 -9 9 1\n" PLASTIC
      "white polygon ceiling 0 0 12 -9 -9 2 -9 9 2 9 9 2 9 -9 2\n",
      1 },
    { "a plate beyond the lamp",
      PLASTIC "white polygon plate 0 0 12 -9 -9 2.001 9 -9 2.001 9 9 2.001 "
              "-9 9 2.001\n",
      1 },
    { "another lamp, from behind",
      "void light dim 0 0 3 1e-9 1e-9 1e-9\n"
      "dim polygon plate 0 0 12 -1 1 1 1 1 1 1 -1 1 -1 -1 1\n",
      0 },
    { "clear glass, straight through",
      "void glass pane 0 0 3 .96 .96 .96\n"
      "pane polygon plate 0 0 12 -1 -1 1 1 -1 1 1 1 1 -1 1 1\n",
      .88 },
    { "a plate behind clear glass",
      PLASTIC "void glass pane 0 0 3 .96 .96 .96\n"
              "pane polygon plate 0 0 12 -1 -1 .5 1 -1 .5 1 1 .5 -1 1 .5\n"
              "white polygon plate 0 0 12 -1 -1 1 1 -1 1 1 1 1 -1 1 1\n",
      0 },
};

LOOP_TEST(shadow_ray_meets, N_ELEM(blocker))
{
    char text[1024];

    snprintf(text, sizeof text, SQUARE_LAMP "%s", blocker[_i].text);
    double E = irradiance_of(text, DIRECT "-ds 0", 0, 0, 0);

    /* one small patch of 4 at distance 2 */
    ck_assert_msg(fabs(E - blocker[_i].passes) < 2e-3, "%s: %g, not %g",
                  blocker[_i].name, E, blocker[_i].passes);
}

/* Where a lamp's ceiling is: with it, or as far below it as a frozen octree or
 * twelve digits may put it. */
static const struct {
    const char *lamp;
    double z;
} flush_with[] = {
    { SQUARE_LAMP, 2 },
    { SQUARE_LAMP, 2 - 0x1p-29 },
    { SQUARE_LAMP, 2 - 1e-11 },
    { SHAPED_LAMP, 2 - 0x1p-29 },
};

LOOP_TEST(ceiling_flush_with_its_lamp_changes_nothing_anywhere,
          N_ELEM(flush_with))
{
    struct world bare = { 0 }, flush = { 0 };
    double c = flush_with[_i].z;
    char text[1024];

    snprintf(text, sizeof text,
             "%s" PLASTIC "white polygon c 0 0 12 -9 -9 %.17g -9 9 %.17g "
             "9 9 %.17g 9 -9 %.17g\n",
             flush_with[_i].lamp, c, c, c, c);
    world_open(&bare, flush_with[_i].lamp, DIRECT "-ds .2");
    world_open(&flush, text, DIRECT "-ds .2");
    ck_assert_double_gt(irradiance_at(&bare, 0, 0, 0), 0);
    for (int i = 0; i < 200; i++) {
        double x = 16 * rad_rand(7, (uint32_t)(3 * i)) - 8;
        double y = 16 * rad_rand(7, (uint32_t)(3 * i + 1)) - 8;
        double z = 1.99 * rad_rand(7, (uint32_t)(3 * i + 2));

        ck_assert_double_eq(irradiance_at(&bare, x, y, z),
                            irradiance_at(&flush, x, y, z));
    }
    world_close(&bare);
    world_close(&flush);
}

/* The lamp's place, the same from another corner on, and facing up. */
#define SAME_PLACE "0 0 12 -1 -1 2 -1 1 2 1 1 2 1 -1 2\n"
#define SAME_TURNED "0 0 12 1 1 2 1 -1 2 -1 -1 2 -1 1 2\n"
#define SAME_UPWARD "0 0 12 1 -1 2 1 1 2 -1 1 2 -1 -1 2\n"

/* What else is where the lamp is, and how many times as bright as the lamp it
 * looks then. */
static const struct {
    const char *text;
    double times;
} double_lamp[] = {
    { "bright polygon again " SAME_PLACE, 1 },
    { "bright polygon again " SAME_PLACE "bright polygon thrice " SAME_PLACE,
      1 },
    { "void light later 0 0 3 .5 .5 .5\nlater polygon p " SAME_PLACE, .5 },
    { "void glow later 0 0 4 3 3 3 9\nlater polygon p " SAME_PLACE, 3 },
    { "bright polygon again " SAME_TURNED, 1 },
    { "void light later 0 0 3 .5 .5 .5\nlater polygon p " SAME_TURNED, .5 },
    { "void light later 0 0 3 .5 .5 .5\nlater polygon p " SAME_UPWARD, 1 },
    { PLASTIC "white polygon p " SAME_PLACE, 0 },
    { PLASTIC "white polygon p " SAME_TURNED, 0 },
    { PLASTIC "white polygon p " SAME_UPWARD, 1 },
    { PLASTIC "white polygon p " SAME_PLACE
              "void light later 0 0 3 .5 .5 .5\nlater polygon q " SAME_TURNED,
      .5 },
    { PLASTIC "void light later 0 0 3 .5 .5 .5\nlater polygon q " SAME_TURNED
              "white polygon p " SAME_PLACE,
      .5 },
    { "void polygon p " SAME_PLACE, 1 },
    { "void glass pane 0 0 3 .9 .9 .9\npane polygon p " SAME_PLACE, 1 },
    { "void trans sheet 0 0 7 .9 .9 .9 0 0 .5 .5\nsheet polygon p " SAME_PLACE,
      1 },
};

LOOP_TEST(a_lamp_and_what_covers_it_light_as_they_look, N_ELEM(double_lamp))
{
    struct world one = { 0 };
    char text[512];

    snprintf(text, sizeof text, SQUARE_LAMP "%s", double_lamp[_i].text);
    world_open(&one, SQUARE_LAMP, DIRECT "-ds .2");
    world_open(&w, text, DIRECT "-ds .2");
    ck_assert_double_eq_tol(
        irradiance_at(&w, .3, .2, 0),
        double_lamp[_i].times * irradiance_at(&one, .3, .2, 0), 1e-6);
    ck_assert_double_eq(world_see(&w, .3, .2, 0, 0, 0, 1).g,
                        double_lamp[_i].times);
    world_close(&one);
}

/* Half of the lamp is hidden: so is half of the light, near enough. */
TEST(half_a_lamp_gives_a_penumbra)
{
    static const char text[] = SQUARE_LAMP PLASTIC
        "white polygon plate 0 0 12 0 -9 1 9 -9 1 9 9 1 0 9 1\n";
    double all = lambert(square, 4, origin, up);

    ck_assert_double_eq_tol(irradiance_of(text, DIRECT "-ds .1", 0, 0, 0),
                            all / 2, .02 * all);
}

/* A sun of half a degree and an even sky: the sun is sampled, the sky seen. */
TEST(distant_lights_are_sampled_and_glows_are_seen)
{
    static const char text[] =
        "void light sun 0 0 3 1e5 1e5 1e5\nsun source s 0 0 4 0 1 1 .5\n"
        "void glow blue 0 0 4 1 2 3 0\nblue source sky 0 0 4 0 0 1 180\n";
    double omega = 2 * M_PI * (1 - cos(M_PI / 720));

    world_open(&w, text, DIRECT "-ds 0");
    ck_assert_double_eq_tol(irradiance_at(&w, 0, 0, 0), 1e5 * omega * sqrt(.5),
                            1e-3);
    /* looked at: the sun before the sky, the sky, nothing below */
    ck_assert_double_eq(world_see(&w, 0, 0, 0, 0, 1, 1).b, 1e5);
    ck_assert_double_eq(world_see(&w, 0, 0, 0, 1, 0, 1).b, 3);
    ck_assert_double_eq(world_see(&w, 0, 0, 0, 1, 0, -1).b, 0);
    ck_assert_double_eq(world_see(&w, 0, 0, 0, 1, 0, 0).b, 3);
    /* the order in the scene does not matter: a light comes before a glow */
    world_open(&w,
               "void glow blue 0 0 4 1 2 3 0\nblue source sky 0 0 4 0 0 1 180\n"
               "void light sun 0 0 3 9 9 9\nsun source s 0 0 4 0 1 1 .5\n",
               DIRECT);
    ck_assert_double_eq(world_see(&w, 0, 0, 0, 0, 1, 1).b, 9);
}

/* Degrees; of stars 1 - cos of half of that has few digits, or none. */
static const double suns[] = { .5, 1e-3, 1e-5, 1e-6, 1e-7, 1e-9 };

LOOP_TEST(small_suns_are_as_bright_as_large_ones, N_ELEM(suns))
{
    double radius = M_PI / 360 * suns[_i], omega = M_PI * radius * radius;
    char text[120];

    snprintf(text, sizeof text,
             "void light sun 0 0 3 %g %g %g\nsun source s 0 0 4 3 2 10 %g\n",
             1 / omega, 1 / omega, 1 / omega, suns[_i]);
    for (int x = 0; x < 5; x++)
        ck_assert_double_eq_tol(
            irradiance_of(text, "-ab 0 -av 0 0 0 -dj 1", x, 0, 0),
            10 / sqrt(113), 2e-3);
}

TEST(glow_reaches_as_far_as_it_says)
{
    static const char text[] =
        "void glow g 0 0 4 1 1 1 3\n"
        "g polygon p 0 0 12 -.1 -.1 2 -.1 .1 2 .1 .1 2 .1 -.1 2\n";
    double near = irradiance_of(text, DIRECT, 0, 0, 0);

    ck_assert_double_eq_tol(near, .04 / 4, 1e-4);
    ck_assert_double_eq(irradiance_of(text, DIRECT, 0, 0, -1.5), 0);
    ck_assert_double_eq(irradiance_of("void glow g 0 0 4 1 1 1 0\n"
                                      "g sphere p 0 0 4 0 0 2 1\n",
                                      DIRECT, 0, 0, 0),
                        0);
}

/* A light, and a glow within its reach, is looked at by shadow rays, a glow
 * beyond is met by indirect ones: none by both.  A negative reach keeps a glow
 * from both. */
static const struct {
    const char *emitter;
    double part; /* of the square's light that arrives */
} counted[] = {
    { "light g 0 0 3 1 1 1", 1 },   { "glow g 0 0 4 1 1 1 9", 1 },
    { "glow g 0 0 4 1 1 1 0", 1 },  { "glow g 0 0 4 1 1 1 1.9", 1 },
    { "glow g 0 0 4 1 1 1 -1", 0 },
};

LOOP_TEST(light_counts_once, N_ELEM(counted))
{
    double want = counted[_i].part * lambert(square, 4, origin, up);
    char text[256];

    snprintf(text, sizeof text,
             "void %s\ng polygon p 0 0 12 -1 -1 2 -1 1 2 1 1 2 1 -1 2\n",
             counted[_i].emitter);
    ck_assert_double_eq_tol(irradiance_of(text,
                                          "-ab 1 -aa 0 -ad 16384 -as 0 -lw 0 "
                                          "-av 0 0 0 -dj 0 -dt 0 -ds .1",
                                          0, 0, 0),
                            want, .01);
}

TEST(spotlight_falls_off_from_its_focus)
{
    static const char text[] = "void spotlight s 0 0 7 9 9 9 40 0 0 -3\n"
                               "s ring r 0 0 8 0 0 2 0 0 -1 0 .1\n";
    double area = M_PI * .01;

    ck_assert_double_eq_tol(irradiance_of(text, DIRECT "-ds 0", 0, 0, 0),
                            9 * area / 25, 1e-6);
    ck_assert_double_eq(irradiance_of(text, DIRECT, 1, 0, 0), 0);
}

/* A disk that faces down, with an axis 6 degrees up: half of a wide cone leaves
 * its front. */
TEST(spotlight_lights_what_of_its_cone_leaves_its_front)
{
    static const char text[] = "void spotlight s 0 0 7 9 9 9 160 1e-4 0 1e-5\n"
                               "s ring r 0 0 8 0 0 2 0 0 -1 0 .1\n";
    double area = M_PI * .01, cosine = 2 / sqrt(13);

    ck_assert_double_eq_tol(irradiance_of(text, DIRECT "-ds 0", 3, 0, 0),
                            9 * area * cosine * cosine / 13, 1e-4);
    ck_assert_double_eq(irradiance_of(text, DIRECT, -3, 0, 0), 0);
}

/* With -dt, the weak ones of a hundred lamps are not tested, but estimated by
 * the visible share of those that were: here, all or nothing. */
TEST(untested_lamps_count_as_the_tested_ones_are_seen)
{
    char text[16384] = LAMP;
    size_t len = strlen(text);
    double all;

    for (int i = 0; i < 100; i++)
        len += (size_t)snprintf(text + len, sizeof text - len,
                                "bright sphere s%d 0 0 4 %d %d %g .01\n", i,
                                i % 10, i / 10, i == 55 ? 1. : 3.);
    all = irradiance_of(text, DIRECT, 5.1, 5.1, 0);
    world_open(&w, text, "-ab 0 -dj 0 -dt .2 -dc .5");
    ck_assert_double_eq_tol(irradiance_at(&w, 5.1, 5.1, 0), all, 1e-6 * all);
    ck_assert_uint_lt(w.ctx.counts.shadow_rays, 60);
    ck_assert_uint_ge(w.ctx.counts.shadow_rays, 2);
    snprintf(text + len, sizeof text - len,
             PLASTIC "white ring cover 0 0 8 5 5 .5 0 0 1 0 99\n");
    ck_assert_double_eq(
        irradiance_of(text, "-ab 0 -dj 0 -dt .2 -dc .5", 5.1, 5.1, 0), 0);
}

/* In a mirror that halves light, half as much is worth a test: -dt .2 tests as
 * many lamps for what is seen there as -dt .4 for what is seen itself. */
TEST(dim_rays_test_fewer_lamps)
{
    char text[16384] =
        LAMP PLASTIC "white polygon floor 0 0 12 0 0 0 9 0 0 9 9 0 0 9 0\n"
                     "void metal half 0 0 5 .5 .5 .5 1 0\n"
                     "half polygon m 0 0 12 5 5 1.1 5 5.2 1.1 5.2 5.2 .9 "
                     "5.2 5 .9\n";
    size_t len = strlen(text);
    uint64_t tests[2][2];

    for (int i = 0; i < 100; i++)
        len += (size_t)snprintf(text + len, sizeof text - len,
                                "bright sphere s%d 0 0 4 %d %d %g .01\n", i,
                                i % 10, i / 10, 2 + .05 * (i % 31));
    for (int coarse = 0; coarse < 2; coarse++)
        for (int mirrored = 0; mirrored < 2; mirrored++) {
            world_open(&w, text,
                       coarse ? "-ab 0 -dj 0 -dt .4 -dc .5"
                              : "-ab 0 -dj 0 -dt .2 -dc .5");
            if (mirrored)
                world_see(&w, 3, 5.1, 1, 1, 0, 0);
            else
                world_see(&w, 5.1, 5.1, .5, 0, 0, -1);
            tests[coarse][mirrored] = w.ctx.counts.shadow_rays;
        }
    ck_assert_uint_eq(tests[0][1], tests[1][0]);
    ck_assert_uint_lt(tests[0][1], tests[0][0]);
}

/* Sum of the irradiance at the origin, upwards, over so many samplings. */
static struct rad_rgb
irradiance_sum(uint64_t key, uint64_t times)
{
    struct rad_rgb sum = rad_grey(0);

    for (uint64_t i = 0; i < times; i++) {
        struct rad_ray r;

        rad_ray_irradiance(&w.ctx, &r, origin, up, rad_key_branch(key, i));
        sum = rad_rgb_add(sum, r.L);
    }
    return sum;
}

/* One lamp that the wall sees and 19 weaker ones, of which every other is
 * hidden from it: what -dt leaves untested changes the light that comes from
 * the wall by chance only.  The point itself sees none: the strong one is
 * behind a plate, the others are below it or behind the lid. */
TEST(untested_lamps_leave_the_mean_alone)
{
    static const char *const options[] = {
        "-ab 1 -aa 0 -ad 16 -as 0 -lw 0 -dt 0",
        "-ab 1 -aa 0 -ad 16 -as 0 -lw 0 -dt .05 -dc .75",
        "-ab 1 -aa 0 -ad 16 -as 0 -lw 0 -dt 1 -dc 0",
    };
    char scene[2048] = PLASTIC
        "white polygon wall 0 0 12 8 -9 0 8 -9 9 8 9 9 8 9 0\n"
        "void plastic black 0 0 5 0 0 0 0 0\n"
        "black polygon lid 0 0 12 -9 -9 9.5 9 -9 9.5 9 9 9.5 -9 9 9.5\n"
        "black polygon plate 0 0 12 -.2 -.2 3 .2 -.2 3 .2 .2 3 -.2 .2 3\n"
        "void light strong 0 0 3 1000 1000 1000\n"
        "void light weak 0 0 3 50 40 60\n"
        "strong sphere s 0 0 4 0 0 6 .1\n";
    struct rad_rgb sum[N_ELEM(options)];
    enum { TIMES = 3000 };

    for (int i = 0; i < 19; i++)
        snprintf(scene + strlen(scene), 64,
                 "weak sphere w%d 0 0 4 0 %d %d .1\n", i, i - 9,
                 i % 2 ? 10 : -1);
    for (int k = 0; k < N_ELEM(options); k++) {
        world_open(&w, scene, options[k]);
        sum[k] = irradiance_sum(9, TIMES);
        ck_assert_msg(fabs(sum[k].r / sum[0].r - 1) < .02 &&
                          fabs(sum[k].b / sum[0].b - 1) < .02,
                      "%s: %g times as bright", options[k],
                      (double)sum[k].r / sum[0].r);
    }
}

/* One strong lamp and 19 weak ones, of which every other is hidden: what -dt
 * leaves untested is right in the mean where the lamps shine, too. */
TEST(untested_lamps_are_drawn)
{
    static const char *const options[] = { "-ab 0 -dt 0", "-ab 0 -dt 1 -dc 0" };
    char scene[2048] =
        PLASTIC "void plastic black 0 0 5 0 0 0 0 0\n"
                "black polygon lid 0 0 12 -9 -9 9.5 9 -9 9.5 9 9 9.5 -9 9 9.5\n"
                "void light strong 0 0 3 1000 1000 1000\n"
                "void light weak 0 0 3 50 40 60\n"
                "strong sphere s 0 0 4 2 0 6 .1\n";
    struct rad_rgb sum[2];
    uint64_t shadow[2];
    enum { TIMES = 4000 };

    for (int i = 0; i < 19; i++)
        snprintf(scene + strlen(scene), 64,
                 "weak sphere w%d 0 0 4 0 %d %g .1\n", i, i - 9,
                 i % 2 ? 10 : 9.);
    for (int k = 0; k < 2; k++) {
        world_open(&w, scene, options[k]);
        sum[k] = irradiance_sum(7, TIMES);
        shadow[k] = w.ctx.counts.shadow_rays;
    }
    ck_assert_uint_eq(shadow[0], 20 * TIMES);
    ck_assert_uint_eq(shadow[1], 3 * TIMES);
    ck_assert_msg(fabs(sum[1].r / sum[0].r - 1) < .01 &&
                      fabs(sum[1].b / sum[0].b - 1) < .01,
                  "%g times as bright", (double)sum[1].r / sum[0].r);
}

/* A ceiling that a weak lamp lights, and a hundred times as strong one would if
 * there were no lid: rays of indirect light do not miss the weak one. */
TEST(strong_lamp_that_is_hidden_makes_no_noise)
{
    static const char scene[] =
        PLASTIC "void light strong 0 0 3 40000 40000 40000\n"
                "void light weak 0 0 3 100 100 100\n"
                "white polygon top 0 0 12 -9 -9 2 -9 9 2 9 9 2 9 -9 2\n"
                "white polygon lid 0 0 12 -99 -99 -6 99 -99 -6 99 99 -6 "
                "-99 99 -6\n"
                "weak sphere w 0 0 4 0 0 -4 .1\n"
                "strong sphere s 0 0 4 0 0 -10 .1\n";
    double sum = 0, sum2 = 0, exact;
    enum { TIMES = 500 };

    world_open(&w, scene, "-ab 1 -aa 0 -ad 16 -as 0 -lw 0 -dt 0");
    exact = (double)irradiance_sum(9, TIMES).r / TIMES;
    world_open(&w, scene, "-ab 1 -aa 0 -ad 16 -as 0 -lw 0 -dt .05");
    for (uint64_t i = 0; i < TIMES; i++) {
        double E = (double)irradiance_sum(100 + i, 1).r;

        sum += E / TIMES;
        sum2 += E * E / TIMES;
    }
    ck_assert_double_eq_tol(sum, exact, .01 * exact);
    ck_assert_double_lt(sqrt(sum2 - sum * sum), .15 * exact);
}

/* What blocked the last ray may make a test shorter, never different. */
TEST(memory_of_the_last_blocker_changes_nothing)
{
    static const char text[] = SQUARE_LAMP PLASTIC
        "white sphere ball 0 0 4 .3 0 1 .4\nwhite sphere b2 0 0 4 -.6 0 1 .3\n";
    struct world warm = { 0 }, cold = { 0 };

    world_open(&warm, text, DIRECT "-ds .2");
    world_open(&cold, text, DIRECT "-ds .2");
    for (int i = 0; i < 100; i++) {
        double x = 4 * rad_rand(3, (uint32_t)(2 * i)) - 2;
        double y = 4 * rad_rand(3, (uint32_t)(2 * i + 1)) - 2;

        cold.ctx.last_blocker[0] = RAD_VOID;
        ck_assert_double_eq(irradiance_at(&warm, x, y, 0),
                            irradiance_at(&cold, x, y, 0));
        ck_assert_uint_eq(warm.ctx.counts.rays, cold.ctx.counts.rays);
        ck_assert_uint_eq(warm.ctx.counts.geom.tests,
                          cold.ctx.counts.geom.tests);
    }
    ck_assert_uint_gt(warm.ctx.counts.geom.tests, 0);
    world_close(&warm);
    world_close(&cold);
}

TEST(illum_over_void_is_a_light_and_a_window)
{
    static const char text[] =
        "void illum i 0 0 3 2 2 2\n"
        "i polygon p 0 0 12 -1 -1 2 -1 1 2 1 1 2 1 -1 2\n"
        "void glow g 0 0 4 7 7 7 0\ng source sky 0 0 4 0 0 1 180\n";

    world_open(&w, text, DIRECT "-ds 0");
    ck_assert_double_eq_tol(irradiance_at(&w, 0, 0, 0), 2, 1e-6);
    ck_assert_double_eq(world_see(&w, 0, 0, 0, 0, 0, 1).g, 7);
}

/* What faces inward is none, whatever its type is called. */
static const struct {
    const char *surface, *what;
} no_lamps[] = {
    { "cone c 0 0 8 0 0 0 0 0 1 .5 .2", "a cone cannot be a light" },
    { "cone c 0 0 8 0 0 0 0 0 1 -.5 -.5", "a cone cannot be a light" },
    { "sphere c 0 0 4 0 0 0 -.5", "a sphere cannot be a light" },
    { "cylinder c 0 0 7 0 0 0 0 0 1 -.5", "a cylinder cannot be a light" },
    { "tube c 0 0 7 0 0 0 0 0 1 .5", "a tube cannot be a light" },
};

LOOP_TEST(surface_cannot_be_a_light, N_ELEM(no_lamps))
{
    char scene[256];

    snprintf(scene, sizeof scene, LAMP "bright %s\n", no_lamps[_i].surface);
    ck_assert_int_eq(world_try(&w, scene, "", NULL), RAD_EDATA);
    ck_assert_str_eq(w.err.where, "test.rad:2");
    ck_assert_ptr_nonnull(strstr(w.err.what, no_lamps[_i].what));
}

/* Equal radii make a cone a cylinder, and negative ones turn a cup, a tube and
 * a bubble inside out: lamps of these are the lamps that they are then. */
static const struct {
    const char *lamp, *like;
} meant[] = {
    { "cone c 0 0 8 -1 0 2 1 0 2 .1 .1", "cylinder c 0 0 7 -1 0 2 1 0 2 .1" },
    { "cup c 0 0 8 -1 0 2 1 0 2 -.1 -.1", "cylinder c 0 0 7 -1 0 2 1 0 2 .1" },
    { "tube c 0 0 7 -1 0 2 1 0 2 -.1", "cylinder c 0 0 7 -1 0 2 1 0 2 .1" },
    { "bubble c 0 0 4 0 0 2 -.1", "sphere c 0 0 4 0 0 2 .1" },
};

LOOP_TEST(lamp_is_what_its_radii_make_it, N_ELEM(meant))
{
    char a[256], b[256];

    snprintf(a, sizeof a, LAMP "bright %s\n", meant[_i].lamp);
    snprintf(b, sizeof b, LAMP "bright %s\n", meant[_i].like);
    ck_assert_double_gt(irradiance_of(b, DIRECT "-ds .2", 0, 0, 0), 0);
    ck_assert_double_eq(irradiance_of(a, DIRECT "-ds .2", 0, 0, 0),
                        irradiance_of(b, DIRECT "-ds .2", 0, 0, 0));
}

/* -0 is the same place as 0: xform writes it. */
TEST(a_lamp_at_minus_zero_is_not_another)
{
    const char *one = LAMP "bright ring a 0 0 8 0 0 2 0 0 -1 0 .5\n";
    const char *two = LAMP "bright ring a 0 0 8 0 0 2 0 0 -1 0 .5\n"
                           "bright ring b 0 0 8 -0 0 2 0 -0 -1 -0 .5\n";

    ck_assert_double_gt(irradiance_of(one, DIRECT, 0, 0, 0), 0);
    ck_assert_double_eq(irradiance_of(two, DIRECT, 0, 0, 0),
                        irradiance_of(one, DIRECT, 0, 0, 0));
}

/* The parts of a lamp with a hole, whose seam begins at a corner that is there
 * twice. */
#define RIM  "-1 1 2 1 1 2 1 -1 2 -1 -1 2 "
#define HOLE "-.9 -.9 2 -.5 -.9 2 -.5 -.5 2 -.9 -.5 2 -.9 -.9 2 -1 -1 2 "

TEST(a_lamp_with_a_hole_is_the_same_from_either_end_of_its_seam)
{
    const char *one = LAMP "bright polygon a 0 0 30 " RIM HOLE "\n";
    const char *two = LAMP "bright polygon a 0 0 30 " RIM HOLE "\n"
                           "bright polygon b 0 0 30 " HOLE RIM "\n";

    ck_assert_double_gt(irradiance_of(one, DIRECT, 0, 0, 0), 0);
    ck_assert_double_eq(irradiance_of(two, DIRECT, 0, 0, 0),
                        irradiance_of(one, DIRECT, 0, 0, 0));
}

/* A sensor over or on a desk, .02 thick, at height 1 below a lamp: alone, or in
 * a scene that is far from the origin, or much larger than the room. */
#define DESK                                                                   \
    PLASTIC "void plastic grey 0 0 5 .5 .5 .5 0 0\n"                           \
            "grey polygon top 0 0 12 %.17g %.17g 1 %.17g %.17g 1 "             \
            "%.17g %.17g 1 %.17g %.17g 1\n"                                    \
            "grey polygon bottom 0 0 12 %.17g %.17g .98 %.17g %.17g .98 "      \
            "%.17g %.17g .98 %.17g %.17g .98\n"
static const struct {
    const char *more;
    double away;   /* x of the desk's middle */
    double height; /* of the sensor */
    double seen;   /* 1: it sees the lamp */
} sensor[] = {
    { "", 0, 1.5, 1 },
    { "", 0, 1, 1 },
    { "", 0, 1 - 1e-6, 1 },
    { "", 0, 1 - 5e-6, 1 }, /* on it, but for its six written digits */
    { "", 0, .99, 0 },      /* within it */
    { "", 0, .97, 0 },
    { "", 5e5, 1.5, 1 },
    { "", 5e5, 1, 1 },
    { "", 5e6, 1.5, 1 },
    { "", 5e6, 1 - 1e-6, 1 },
    { "", 5e6, .99, 0 },
    { "", 5e6, .9, 0 },
    { "white sphere forgotten 0 0 4 0 0 0 1\n", 5e6, 1, 1 },
    { "white sphere forgotten 0 0 4 0 0 0 1\n", 5e6, .9, 0 },
    { "white ring ground 0 0 8 0 0 0 0 0 1 0 1e6\n", 0, 1, 1 },
    { "white ring ground 0 0 8 0 0 0 0 0 1 0 1e6\n", 0, .9, 0 },
};

LOOP_TEST(sensor_on_a_desk_sees_what_is_above_it, N_ELEM(sensor))
{
    const double x = sensor[_i].away, z = sensor[_i].height;
    double corner[12], E;
    char text[2048];
    int n;

    n = snprintf(text, sizeof text, LAMP DESK "%s", x - 1, -1., x + 1, -1.,
                 x + 1, 1., x - 1, 1., x - 1, -1., x - 1, 1., x + 1, 1., x + 1,
                 -1., sensor[_i].more);
    for (int i = 0; i < 12; i++)
        corner[i] = square[i] + (i % 3 == 0) * x;
    n += snprintf(text + n, sizeof text - (size_t)n,
                  "bright polygon lamp 0 0 12");
    for (int i = 0; i < 12; i++)
        n += snprintf(text + n, sizeof text - (size_t)n, " %.17g", corner[i]);
    E = irradiance_of(text, DIRECT "-ds .1", x, 0, z);
    ck_assert_double_eq_tol(
        E, sensor[_i].seen * lambert(corner, 4, (double[]){ x, 0, z }, up),
        1e-3);
}

/* ... however far the ground goes that it looks down at. */
static const char *const wide[] = {
    "void glow shine 0 0 4 1 1 1 0\n"
    "shine ring ground 0 0 8 0 0 0 0 0 1 0 1e6\n",
    "void glow shine 0 0 4 1 1 1 0\n"
    "shine sphere ground 0 0 4 0 0 -1e6 1e6\n",
};

LOOP_TEST(sensor_over_a_wide_ground_sees_it, N_ELEM(wide))
{
    static const double down[] = { 0, 0, -1 }, p[] = { 30, 5, 1.5 };
    struct rad_ray r;

    world_open(&w, wide[_i], "-ab 1 -aa 0 -ad 64 -as 0");
    rad_ray_irradiance(&w.ctx, &r, p, down, 0);
    ck_assert_double_eq_tol((double)r.L.g, M_PI, 1e-3);
}

/* A sensor exactly on a floor, which stands askew: lamps above the floor count,
 * those below it do not. */
TEST(askew_sensor_on_a_floor_sees_nothing_below_it)
{
    static const double n[] = { .6, 0, .8 };
    struct rad_ray r;

    world_open(
        &w,
        SQUARE_LAMP
        "bright polygon below 0 0 12 4 -1 -1 6 -1 -1 6 1 -1 4 1 -1\n" PLASTIC
        "white polygon floor 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n",
        DIRECT "-ds .1");
    rad_ray_irradiance(&w.ctx, &r, origin, n, 0);
    ck_assert_double_eq_tol((double)r.L.g, lambert(square, 4, origin, n), 1e-3);
}

/* Add a square of that half-width across an axis, at that height along it,
 * which faces up the axis. */
static void
add_square(char *text, const char *name, double half, int axis, double height)
{
    sprintf(text + strlen(text), "%s 0 0 12", name);
    for (int i = 0; i < 4; i++) {
        double p[3];

        p[axis] = height;
        p[(axis + 1) % 3] = i == 0 || i == 3 ? -half : half;
        p[(axis + 2) % 3] = i < 2 ? -half : half;
        sprintf(text + strlen(text), " %.9g %.9g %.9g", p[0], p[1], p[2]);
    }
    strcat(text, "\n");
}

/* A sensor below a ceiling, .02 thick, or within it by its six written digits,
 * however the room is turned. */
LOOP_TEST(sensor_below_a_ceiling_sees_what_is_below, 3)
{
    double n[3] = { 0 }, p[3] = { 0 };
    char text[1024] = LAMP PLASTIC;
    struct rad_ray r;

    add_square(text, "bright polygon lamp", 1, _i, 0);
    add_square(text, "white polygon under", 9, _i, 2);
    add_square(text, "white polygon over", 9, _i, 2.02);
    n[_i] = -1;
    p[_i] = 2 + 4e-6;
    world_open(&w, text, DIRECT "-ds .1");
    rad_ray_irradiance(&w.ctx, &r, p, n, 0);
    ck_assert_double_eq_tol((double)r.L.g, lambert(square, 4, origin, up),
                            1e-3);
}
