/* check_mirror.c - tests of src/shade/mirror.c and src/light/direct/image.c:
 * what mirrors show, and the light that they relay
 *
 * A ball of radius R and radiance L at distance d gives E = pi L (R/d)^2 cos,
 * and so does its image, times the mirror's colour. */
#include "config.h"

#include "light/direct/sources.h"
#include "tests/world_fixture.h"

#include <stdio.h>

FIXTURE(NULL, world_tear_down)

#define LAMP "void light lit 0 0 3 100 100 100\n"
/* R = .01 at height 2 */
#define BALL      LAMP "lit sphere ball 0 0 4 0 0 2 .01\n"
#define BALL_FLUX (M_PI * 100 * 1e-4)

/* Walls at x = 1 and x = -1 that face each other. */
#define EAST "polygon east 0 0 12 1 -99 -99 1 -99 99 1 99 99 1 99 -99\n"
#define WEST "polygon west 0 0 12 -1 99 -99 -1 99 99 -1 -99 99 -1 -99 -99\n"
#define GOLD "void mirror gold 0 0 3 .8 .4 .2\n"
#define GREY "void mirror grey 0 0 3 .5 .5 .5\n"

/* A mirror where the light that reaches the origin meets it. */
#define SMALL "polygon small 0 0 12 1 -1 .5 1 -1 1.5 1 1 1.5 1 1 .5\n"

static const double origin[3] = { 0, 0, 0 }, up[3] = { 0, 0, 1 };

static struct rad_rgb
irradiance(const double p[3], const double n[3])
{
    struct rad_ray r;

    rad_ray_irradiance(&w.ctx, &r, p, n, 1);
    return r.L;
}

/* At the origin, looking up. */
static double
light_of(const char *scene, const char *options)
{
    world_open(&w, scene, options);
    return irradiance(origin, up).r;
}

static int32_t
images_of(const char *scene, const char *options)
{
    world_open(&w, scene, options);
    return w.job->sources->nvirtuals;
}

/* Of the ball or its image, x to the side of the origin. */
static double
from_ball(double x)
{
    double d2 = x * x + 4;

    return BALL_FLUX / d2 * 2 / sqrt(d2);
}

static const char *const pretest[] = { "-dp 0", "-dp 512" };

LOOP_TEST(wall_doubles_a_lamp_in_its_colour, N_ELEM(pretest))
{
    struct rad_rgb E;

    world_open(&w, BALL GOLD "gold " EAST, pretest[_i]);
    E = irradiance(origin, up);
    near(E.r, from_ball(0) + .8 * from_ball(2));
    near(E.g, from_ball(0) + .4 * from_ball(2));
    near(E.b, from_ball(0) + .2 * from_ball(2));
}

/* As where a scene includes a luminaire with its reflector twice. */
LOOP_TEST(mirrors_in_one_place_relay_as_one, 2)
{
    const char *scene = BALL GOLD "gold " EAST "gold " EAST "gold " EAST;

    near(light_of(scene, pretest[_i]), from_ball(0) + .8 * from_ball(2));
    ck_assert_int_eq(images_of(scene, pretest[_i]), 1);
}

/* A wall in the mirror's place, from another corner on; and facing away. */
LOOP_TEST(what_covers_a_mirror_ends_its_image, 2)
{
    const char *over =
        BALL GOLD "void plastic wall 0 0 5 .5 .5 .5 0 0\n"
                  "gold " EAST "wall polygon over 0 0 12 1 99 99 1 99 -99 "
                  "1 -99 -99 1 -99 99\n";
    const char *back =
        BALL GOLD "void plastic wall 0 0 5 .5 .5 .5 0 0\n"
                  "gold " EAST "wall polygon back 0 0 12 1 99 -99 1 99 99 "
                  "1 -99 99 1 -99 -99\n";

    near(light_of(over, pretest[_i]), from_ball(0));
    near(light_of(back, pretest[_i]), from_ball(0) + .8 * from_ball(2));
}

TEST(no_relay_no_image)
{
    near(light_of(BALL GOLD "gold " EAST, "-dr 0"), from_ball(0));
    ck_assert_int_eq(images_of(BALL GOLD "gold " EAST, "-dr 0"), 0);
    ck_assert_int_eq(
        images_of(BALL "void metal m 0 0 5 1 1 1 1 0 m " EAST, "-dr 9"), 0);
}

/* Images stand at x = 2, 4, 6, ... on both sides. */
LOOP_TEST(facing_mirrors_relay_as_often_as_told, N_ELEM(pretest))
{
    const char *scene = BALL GOLD GREY "gold " EAST "grey " WEST;
    double truth = from_ball(0), gold = 1, grey = 1;
    char options[64];

    for (int n = 0; n <= 4; n++) {
        if (n > 0) { /* the last mirror on the way is on the image's side */
            gold *= n % 2 ? .8 : .5;
            grey *= n % 2 ? .5 : .8;
            truth += (gold + grey) * from_ball(2. * n);
        }
        snprintf(options, sizeof options, "-dr %d %s", n, pretest[_i]);
        near(light_of(scene, options), truth);
        ck_assert_int_eq(images_of(scene, options), 2 * n);
    }
}

/* Each blocker, beside the straight way down, and what is left of the image. */
static const struct {
    const char *what;
    double share;
} blocker[] = {
    /* between the floor and the mirror, which the light leaves at z = 1 */
    { "void plastic p 0 0 5 .5 .5 .5 0 0\np sphere s 0 0 4 .5 0 .5 .1", 0 },
    /* between the mirror and the lamp */
    { "void plastic p 0 0 5 .5 .5 .5 0 0\np sphere s 0 0 4 .5 0 1.5 .1", 0 },
    { "void light p 0 0 3 0 0 0\np sphere s 0 0 4 .5 0 1.5 .1", 0 },
    /* beyond both */
    { "void plastic p 0 0 5 .5 .5 .5 0 0\np sphere s 0 0 4 .5 0 2.5 .1", 1 },
    { "void plastic p 0 0 5 .5 .5 .5 0 0\np sphere s 0 0 4 1.5 0 .5 .1", 1 },
    /* what lets light through, in each place */
    { "void antimatter p 1 void 0 0\np sphere s 0 0 4 .5 0 .5 .1", 1 },
    { "void antimatter p 1 void 0 0\np sphere s 0 0 4 .5 0 1.5 .1", 1 },
    { "void antimatter p 1 void 0 0\np sphere s 0 0 4 1 0 1 .3", 1 },
    /* half of the light straight on, twice */
    { "void trans p 0 0 7 1 1 1 0 0 .5 1\np sphere s 0 0 4 .5 0 .5 .1", .25 },
    { "void trans p 0 0 7 1 1 1 0 0 .5 1\np sphere s 0 0 4 .5 0 1.5 .1", .25 },
};

LOOP_TEST(image_is_shaded_on_each_stretch, N_ELEM(blocker))
{
    char scene[1024];

    snprintf(scene, sizeof scene, "%s%s\n", BALL GOLD "gold " SMALL,
             blocker[_i].what);
    for (int i = 0; i < N_ELEM(pretest); i++)
        near(light_of(scene, pretest[i]),
             from_ball(0) + .8 * blocker[_i].share * from_ball(2));
}

/* Upright panes at x, and one that lies at z, over what matters. */
#define PANE(x)                                                                \
    "pane polygon p 0 0 12 " x " -9 -9 " x " 9 -9 " x " 9 9 " x " -9 9\n"
#define FLOOR(z)                                                               \
    "pane polygon q 0 0 12 -9 -9 " z " 9 -9 " z " 9 9 " z " -9 9 " z "\n"
#define SUN "lit source sun 0 0 4 -1 0 1 .5\n"

static const struct {
    const char *glass, *scene, *options;
} panes[] = {
    { "3 .9 .8 .7", BALL FLOOR("1.5"), "" },
    { "3 .9 .8 .7", BALL FLOOR("1.5") FLOOR("1"), "" },
    { "3 .9 .8 .7", BALL GOLD "gold " SMALL FLOOR("1.5"), "" },
    { "3 .9 .9 .9", BALL GOLD "gold " SMALL FLOOR(".5"), "" },
    { "4 .9 .9 .9 1.8", BALL GOLD "gold " SMALL PANE(".5"), "" },
    { "3 .9 .9 .9", BALL GOLD "gold " EAST "gold " WEST PANE(".5"), "-dr 3" },
    { "3 0 .5 0", BALL GOLD "gold " EAST PANE(".5") FLOOR("1"), "" },
    { "3 0 0 0", BALL GOLD "gold " EAST PANE(".5") FLOOR("1"), "" },
    { "3 .9 .8 .7", BALL GOLD "gold " SMALL PANE(".5"), "-bv-" },
    { "3 .9 .8 .7", LAMP SUN GOLD "gold " EAST PANE(".5"), "" },
    { "3 .9 .8 .7", LAMP SUN GOLD "gold " EAST FLOOR("1.5"), "" },
    { "3 .9 .8 .7",
      BALL GOLD "gold " SMALL FLOOR("1") "void plastic b 0 0 5 1 1 1 0 0\n"
                                         "b sphere s 0 0 4 .5 0 1.5 .1\n",
      "" },
    { "3 .9 .8 .7",
      BALL GOLD "gold " SMALL FLOOR(
          "1") "void dielectric b 0 0 5 .9 .9 .9 1.5 0\n"
               "b polygon s 0 0 12 -9 -9 .4 9 -9 .4 9 9 .4 -9 9 .4\n",
      "" },
    { "3 .9 .8 .7",
      BALL GOLD "gold " SMALL FLOOR(
          "1") "void antimatter b 1 void 0 0\nb sphere s 0 0 4 .5 0 1.5 .1\n",
      "" },
    { "3 .9 .8 .7", BALL GOLD "gold " SMALL FLOOR(".5"), "-me 1 1 1" },
};

/* A pattern that is 1 changes nothing, but rays are made where it is. */
LOOP_TEST(plain_panes_dim_as_those_that_take_rays,
          N_ELEM(panes) * N_ELEM(pretest))
{
    int row = _i / N_ELEM(pretest);
    char scene[2048], options[64];
    struct rad_rgb E[2];
    uint64_t rays[2];

    for (int i = 0; i < 2; i++) {
        snprintf(scene, sizeof scene,
                 "void brightfunc one 2 1 . 0 0\n%s glass pane 0 0 %s\n%s",
                 i ? "one" : "void", panes[row].glass, panes[row].scene);
        snprintf(options, sizeof options, "%s %s",
                 pretest[_i % N_ELEM(pretest)], panes[row].options);
        world_open(&w, scene, options);
        E[i] = irradiance(origin, up);
        rays[i] = w.ctx.counts.rays + w.ctx.counts.shadow_rays;
    }
    ck_assert_uint_eq(rays[0], rays[1]);
    ck_assert_double_eq_tol(E[0].r, E[1].r, 1e-6 * (double)E[1].r + 1e-30);
    ck_assert_double_eq_tol(E[0].g, E[1].g, 1e-6 * (double)E[1].g + 1e-30);
    ck_assert_double_eq_tol(E[0].b, E[1].b, 1e-6 * (double)E[1].b + 1e-30);
    ck_assert_int_eq(E[0].g > 0, strcmp(panes[row].glass, "3 0 0 0") != 0);
}

/* A box about the lamp, open below. */
TEST(pretest_drops_what_never_arrives)
{
    const char *scene =
        BALL GOLD "gold " SMALL "void plastic p 0 0 5 .5 .5 .5 0 0\n"
                  "p tube shade 0 0 7 0 0 1.5 0 0 3 .1\n";

    ck_assert_int_eq(images_of(scene, "-dp 512"), 0);
    ck_assert_int_eq(images_of(scene, "-dp 0"), 1);
    near(light_of(scene, "-dp 512"), from_ball(0));
    near(light_of(scene, "-dp 0"), from_ball(0));
}

/* Where all of the image was found in view, only the stretch to the mirror is
 * tested. */
/* Geometry leaves it out, so no ray of a test would meet it. */
TEST(what_is_nowhere_shows_nothing)
{
    ck_assert_int_eq(images_of(LAMP SUN GOLD
                               "gold polygon vast 0 0 9 1 .2 .5 1 -.2 -1e307 "
                               "1 -.2 1.5\n"
                               "gold sphere there 0 0 4 0 0 0 .5\n",
                               ""),
                     0);
}

TEST(pretest_saves_rays)
{
    uint64_t rays[2];

    for (int i = 0; i < 2; i++) {
        world_open(&w, BALL GOLD "gold " EAST, pretest[i]);
        irradiance(origin, up);
        rays[i] = w.ctx.counts.shadow_rays;
    }
    ck_assert_uint_eq(rays[0], 3);
    ck_assert_uint_eq(rays[1], 2);
}

/* Behind the mirror there is no image, and before its edge it ends. */
TEST(image_is_seen_in_the_mirror_alone)
{
    static const double behind[3] = { 1.5, 0, 0 }, off[3] = { 0, 0, -1 };

    world_open(&w, BALL GOLD "gold " EAST, "-bv-");
    ck_assert_double_eq(irradiance(behind, up).r, 0);
    world_open(&w, BALL GOLD "gold " SMALL, "");
    near(irradiance(origin, up).r, from_ball(0) + .8 * from_ball(2));
    near(irradiance(off, up).r,
         BALL_FLUX / 9 + .8 * BALL_FLUX / 13 * 3 / sqrt(13));
    world_open(
        &w, BALL GOLD "gold polygon m 0 0 12 1 -1 .9 1 -1 1.1 1 1 1.1 1 1 .9\n",
        "");
    near(irradiance(origin, up).r, from_ball(0) + .8 * from_ball(2));
    near(irradiance(off, up).r, BALL_FLUX / 9); /* it would be at .5 */
}

/* The sun, 30 degrees from the zenith, off a mirror on the floor. */
LOOP_TEST(distant_light_is_relayed, N_ELEM(pretest))
{
    static const double down[3] = { 0, 0, -1 }, p[3] = { 0, 0, 3 };
    const char *scene = "void light sun 0 0 3 1e4 1e4 1e4\n"
                        "sun source s 0 0 4 0 .5 .8660254 .5\n" GOLD
                        "gold ring m 0 0 8 0 0 0 0 0 1 0 50\n";
    double omega = 2 * M_PI * (1 - cos(M_PI / 720));

    world_open(&w, scene, pretest[_i]);
    near(irradiance(p, down).r, .8 * 1e4 * omega * .8660254);
    near(irradiance(p, up).r, 1e4 * omega * .8660254);
}

/* A panel that shines at the wall alone lights the floor as its image would,
 * in as many parts, and a spotlight too. */
static const struct {
    const char *lamp, *image;
} pair[] = {
    { "polygon l 0 0 9 0 -.3 2 0 .3 2 0 0 2.9",
      "polygon l 0 0 9 2 0 2.9 2 .3 2 2 -.3 2" },
    { "polygon l 0 0 12 0 -.3 2 0 .3 2 0 .3 2.9 0 -.3 2.9",
      "polygon l 0 0 12 2 -.3 2.9 2 .3 2.9 2 .3 2 2 -.3 2" },
    { "ring l 0 0 8 0 0 2 1 0 0 0 .5", "ring l 0 0 8 2 0 2 -1 0 0 0 .5" },
    { "cylinder l 0 0 7 0 0 2 .5 0 2.2 .1",
      "cylinder l 0 0 7 2 0 2 1.5 0 2.2 .1" },
};

LOOP_TEST(image_lights_as_the_lamp_itself_would, N_ELEM(pair))
{
    static const double p[3] = { -.5, .2, 0 };
    bool flat = pair[_i].lamp[0] != 'c';
    char scene[512];
    double real, seen;

    snprintf(scene, sizeof scene, LAMP "lit %s\n", pair[_i].image);
    world_open(&w, scene, "-ds .1 -dj 0");
    real = irradiance(p, up).r;
    ck_assert_double_gt(real, 0);
    snprintf(scene, sizeof scene,
             LAMP "lit %s\nvoid mirror m 0 0 3 1 1 1\nm " EAST, pair[_i].lamp);
    world_open(&w, scene, "-ds .1 -dj 0");
    seen = irradiance(p, up).r;
    if (!flat) { /* it shines on p itself as well */
        snprintf(scene, sizeof scene, LAMP "lit %s\n", pair[_i].lamp);
        world_open(&w, scene, "-ds .1 -dj 0");
        real += irradiance(p, up).r;
    }
    near(seen, real);
}

/* A small mirror shows of a large lamp, which comes near it, what a window in
 * its place shows of the lamp's image. */
TEST(small_mirror_is_a_window)
{
    static const char lamp[] =
        LAMP "lit polygon l 0 0 12 .48 .6 2.36 .48 -.6 2.36 "
             "-.48 -.6 1.64 -.48 .6 1.64\n";
    static const char *const beside[] = {
        "", /* the lamp alone */
        "void mirror m 0 0 3 1 1 1\n"
        "m polygon p 0 0 12 1 -.3 .9 1 -.3 1.5 1 .3 1.5 1 .3 .9\n",
        "lit polygon image 0 0 12 2.48 .6 1.64 2.48 -.6 1.64 1.52 -.6 2.36 "
        "1.52 .6 2.36\n"
        "void plastic black 0 0 5 0 0 0 0 0\n"
        "black polygon a 0 0 12 1 -99 -99 1 -99 99 1 -.3 99 1 -.3 -99\n"
        "black polygon b 0 0 12 1 99 -99 1 99 99 1 .3 99 1 .3 -99\n"
        "black polygon c 0 0 12 1 -.3 -99 1 -.3 .9 1 .3 .9 1 .3 -99\n"
        "black polygon d 0 0 12 1 -.3 99 1 -.3 1.5 1 .3 1.5 1 .3 99\n",
    };
    double E[3][20][11];
    int shown = 0;

    for (int k = 0; k < 3; k++) {
        char scene[1024];

        snprintf(scene, sizeof scene, "%s%s", lamp, beside[k]);
        world_open(&w, scene, "-ds .1 -dj 0 -dt 0");
        for (int i = 0; i < 20; i++)
            for (int j = 0; j < 11; j++) {
                double p[3] = { .883 - .4 * i, .4 * j - 1.987, 0 };

                E[k][i][j] = irradiance(p, up).r;
            }
    }
    for (int i = 0; i < 20; i++)
        for (int j = 0; j < 11; j++) {
            ck_assert_double_eq_tol(E[1][i][j], E[2][i][j],
                                    1e-5 * E[2][i][j] + 1e-9);
            shown += E[1][i][j] > E[0][i][j] + 1e-3;
        }
    ck_assert(shown > 40 && shown < 180);
}

/* A cone of 60 degrees toward the wall, which meets the floor from x = -1.46
 * beyond it on: the origin is in the dark, -2.5 is not, also where a ball is in
 * the cone's middle. */
LOOP_TEST(spotlight_stays_in_its_mirrored_cone, N_ELEM(pretest))
{
    const char *scene = "void spotlight spot 0 0 7 100 100 100 60 1 0 0\n"
                        "spot ring l 0 0 8 0 0 2 1 0 0 0 .01\n"
                        "void plastic p 0 0 5 .5 .5 .5 0 0\n"
                        "p sphere ball 0 0 4 .5 0 2 .1\n"
                        "void mirror m 0 0 3 1 1 1\nm " EAST;
    static const double lit[3] = { -2.5, 0, 0 };
    double d = sqrt(4.5 * 4.5 + 4), E;

    world_open(&w, scene, pretest[_i]);
    ck_assert_double_eq(irradiance(origin, up).r, 0);
    /* area cos / (d + focal length)^2, the focus 1 behind the lamp */
    E = 100 * M_PI * 1e-4 * (4.5 / d) / ((d + 1) * (d + 1)) * (2 / d);
    ck_assert_double_eq_tol(irradiance(lit, up).r, E, 1e-4 * E);
}

static const double scale[] = { 1e-6, 1, 1e6 };

LOOP_TEST(glow_reaches_by_way_of_mirrors, N_ELEM(scale))
{
    double s = scale[_i];
    const double reach[] = { 2.9, 2.8 }; /* the image is at 2.83 */
    char scene[512];

    for (int i = 0; i < 2; i++) {
        snprintf(scene, sizeof scene,
                 "void glow g 0 0 4 100 100 100 %.9g\n"
                 "g sphere ball 0 0 4 0 0 %.9g %.9g\n"
                 "void mirror m 0 0 3 .8 .8 .8\n"
                 "m polygon small 0 0 12 %.9g %.9g %.9g %.9g %.9g %.9g "
                 "%.9g %.9g %.9g %.9g %.9g %.9g\n",
                 reach[i] * s, 2 * s, .01 * s, s, -s, .5 * s, s, -s, 1.5 * s, s,
                 s, 1.5 * s, s, s, .5 * s);
        near(light_of(scene, ""),
             from_ball(0) + (i == 0 ? .8 * from_ball(2) : 0));
    }
}

/* What the eye sees is the other material, lit by lamp, not mirror. */
TEST(another_material_in_its_place_still_relays)
{
    struct rad_rgb L;

    world_open(&w,
               BALL "void plastic red 0 0 5 .5 0 0 0 0\n"
                    "void mirror m 1 red 0 3 .8 .8 .8\nm " EAST,
               "");
    near(irradiance(origin, up).r, from_ball(0) + .8 * from_ball(2));
    L = world_see(&w, 0, 1, 2, 1, -1, -1);
    near(L.r, .5 / M_PI * BALL_FLUX / 2 / sqrt(2));
    ck_assert_double_eq(L.g, 0);
    /* nothing in its place: one sees what is behind it */
    world_open(&w,
               BALL "void glow g 0 0 4 7 7 7 0\ng sphere far 0 0 4 9 0 0 1\n"
                    "void mirror m 1 void 0 3 .8 .8 .8\nm " EAST,
               "");
    near(irradiance(origin, up).r, from_ball(0) + .8 * from_ball(2));
    near(world_see(&w, 0, 0, 0, 1, 0, 0).r, 7);
}

TEST(illum_may_be_a_mirror)
{
    const char *scene = BALL "void mirror m 0 0 3 .8 .8 .8\n"
                             "void illum i 1 m 0 3 0 0 0\ni " EAST;

    for (int i = 0; i < N_ELEM(pretest); i++)
        near(light_of(scene, pretest[i]), from_ball(0) + .8 * from_ball(2));
}

TEST(mirror_shows_what_is_before_it)
{
    struct rad_ray r;

    world_open(&w,
               "void glow g 0 0 4 7 7 7 0\ng sphere far 0 0 4 -9 0 0 1\n" GOLD
               "gold " EAST,
               "");
    world_ray(&w, &r, 0, 0, 0, 1, 0, 0);
    rad_ray_trace(&w.ctx, &r);
    near(r.L.r, 7 * .8);
    near(r.L.b, 7 * .2);
    near(rad_ray_distance(&r), 1 + 1 + 8); /* an image is as far as its way */
    world_ray(&w, &r, 2, 0, 0, -1, 0, 0);
    rad_ray_trace(&w.ctx, &r);
    ck_assert_double_eq(r.L.r, 0); /* black behind, */
    world_open(&w,
               "void glow g 0 0 4 7 7 7 0\ng sphere far 0 0 4 -9 0 0 1\n" GOLD
               "gold " EAST,
               "-bv-");
    near(world_see(&w, 2, 0, 0, -1, 0, 0).r, 7); /* or not there */
}

LOOP_TEST(scale_changes_nothing, N_ELEM(scale))
{
    double s = scale[_i], a = 99 * s;
    char scene[512];

    snprintf(scene, sizeof scene,
             LAMP "lit sphere ball 0 0 4 0 0 %.17g %.17g\n" GOLD
                  "gold polygon m 0 0 12 %.17g %.17g %.17g %.17g %.17g %.17g "
                  "%.17g %.17g %.17g %.17g %.17g %.17g\n",
             2 * s, .01 * s, s, -a, -a, s, -a, a, s, a, a, s, a, -a);
    for (int i = 0; i < N_ELEM(pretest); i++)
        near(light_of(scene, pretest[i]), from_ball(0) + .8 * from_ball(2));
}
