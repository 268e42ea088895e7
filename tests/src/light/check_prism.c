/* check_prism.c - tests of src/shade/prism.c, and of the images that
 * src/light/direct/image.c makes of light sources in prisms
 *
 * A ball of radius R and radiance L at distance d gives E = pi L (R/d)^2 cos,
 * and so does its image, times the prism's coefficient. */
#include "config.h"

#include "light/direct/sources.h"
#include "tests/world_fixture.h"

#include <stdio.h>
#include <stdlib.h>

FIXTURE(NULL, world_tear_down)

#define LAMP "void light lit 0 0 3 100 100 100\n"
/* R = .01 at height 2 */
#define BALL      LAMP "lit sphere ball 0 0 4 0 0 2 .01\n"
#define BALL_FLUX (M_PI * 100 * 1e-4)
#define LEVEL     "p polygon pane 0 0 12 -3 -3 1 3 -3 1 3 3 1 -3 3 1\n"
#define SKY                                                                    \
    "void brightfunc up 2 2+Dx . 0 0\nup glow white 0 0 4 1 1 1 0\n"           \
    "white source sky 0 0 4 0 0 1 360\n"

/* The sideways part by which light is bent is the argument. */
static const char functions[] =
    "{ a ray that goes to a lamp goes to it, another is bent }\n"
    "aimed = DxA*DxA + DyA*DyA + DzA*DzA;\n"
    "x = if(aimed, DxA, Dx + A1); y = if(aimed, DyA, Dy);\n"
    "z = if(aimed, DzA, Dz);\n"
    "x2 = if(aimed, DxA, Dx - A1); zback = if(aimed, DzA, -Dz);\n";

static struct world_file texts[] = { { "f.cal", functions }, { 0 } };
static const struct rad_files files = { .read = world_file_read, .arg = texts };

static void
open_world(const char *scene, const char *options)
{
    int rc = world_try(&w, scene, options, &files);

    ck_assert_msg(rc == 0, "%s: %s", w.err.where, w.err.what);
}

/* Irradiance at (x, 0, z) on a level surface that looks up, or down. */
static double
light_at(const char *scene, const char *options, double x, double z, double up)
{
    double p[3] = { x, 0, z }, n[3] = { 0, 0, up };
    struct rad_ray r;

    open_world(scene, options);
    rad_ray_irradiance(&w.ctx, &r, p, n, 1);
    ck_assert_uint_eq(w.ctx.counts.unsound_rays, 0);
    return r.L.r;
}

static int32_t
images_of(const char *scene, const char *options)
{
    open_world(scene, options);
    return w.job->sources->nvirtuals;
}

static const char *const pretest[] = { "-dp 0 ", "-dp 32 ", "-dp 512 " };

static const char *
with(int i, const char *more)
{
    static char options[100];

    snprintf(options, sizeof options, "%s%s", pretest[i], more);
    return options;
}

#define DIRECT "-av 0 0 0 -dj 0 -dt 0 -ds 0 -dr 1"

/* --- what is seen --------------------------------------------------------- */

/* A sky whose radiance is 2 plus its direction's x. */
LOOP_TEST(rays_go_on_as_the_functions_say, 11)
{
    static const struct {
        const char *prism;
        double expect;
    } seen[] = {
        { "void prism1 p 5 .5 x y z f.cal 0 1 .75\n", .5 * (2 + .6) },
        { "void prism1 p 5 .5 3*x 3*y 3*z f.cal 0 1 .75\n", .5 * (2 + .6) },
        { "void prism1 p 5 T x y z f.cal 0 1 0\n", 2. },
        { "void prism1 p 7 .5 x y z f.cal -rz 180 0 1 .75\n", .5 * (2 - .6) },
        { "void prism1 p 5 1 x y zback f.cal 0 1 .75\n", 2 + .6 },
        { "void prism1 p 5 sqrt(-T) x y z f.cal 0 1 .75\n", 0 },
        { "void prism1 p 5 1 x 1/(T-1) z f.cal 0 1 .75\n", 0 },
        { "void prism1 p 5 -1 x y z f.cal 0 1 .75\n", 0 },
        { "void prism1 p 5 1 0 0 0 . 0 0\n", 0 },
        { "void prism2 p 9 .5 x y z .25 x2 y z f.cal 0 1 .75\n",
          .5 * (2 + .6) + .25 * (2 - .6) },
        { "void prism2 p 9 -1 x y z .25 x2 y z f.cal 0 1 .75\n",
          .25 * (2 - .6) },
    };
    struct rad_rgb L;
    char scene[1024];

    snprintf(scene, sizeof scene, "%s" LEVEL SKY, seen[_i].prism);
    open_world(scene, DIRECT);
    L = world_see(&w, 0, 0, 2, 0, 0, -1);
    ck_assert_double_eq_tol(L.g, seen[_i].expect, 1e-6);
}

/* --- light ---------------------------------------------------------------- */

/* Straight down from the ball to the pane's middle, then aside by .75 for each
 * 1 down: the image is as high as the ball, .75 to the other side. */
LOOP_TEST(lamp_is_seen_where_its_light_seems_to_come_from, N_ELEM(pretest))
{
    static const char *scene =
        BALL "void prism1 p 5 .6 x y z f.cal 0 1 .75\n" LEVEL;

    for (double x = -1; x <= 1; x += .5) {
        double dx = x + .75, d2 = dx * dx + 4;

        ck_assert_double_eq_tol(light_at(scene, with(_i, DIRECT), x, 0, 1),
                                .6 * BALL_FLUX / d2 * 2 / sqrt(d2), 1e-8);
    }
    ck_assert_int_eq(images_of(scene, with(_i, DIRECT)), 1);
    /* above the pane there is the ball alone */
    ck_assert_double_eq_tol(light_at(scene, with(_i, DIRECT), 0, 1.5, 1),
                            BALL_FLUX / .25, 1e-6);
    ck_assert_double_eq(light_at(scene, with(_i, DIRECT), 0, 1.5, -1), 0);
    ck_assert_double_eq(light_at(scene, with(_i, DIRECT " -dr 0"), 0, 0, 1), 0);
}

/* A screen over half of the pane, between it and the ball, hides the ball where
 * the light comes by way of that half, x below .73, or lets half through. */
LOOP_TEST(what_stands_before_the_lamp_dims_its_image, N_ELEM(pretest))
{
    static const struct {
        const char *screen;
        double left;
    } before[] = {
        { "void plastic s 0 0 5 .5 .5 .5 0 0\n", 0 },
        { "void trans s 0 0 7 .5 .5 .5 0 0 1 1\n", .5 },
    };
    char scene[600];

    for (size_t k = 0; k < N_ELEM(before); k++)
        for (double x = -1.25; x <= 1; x += 1) {
            double dx = x + .75, d2 = dx * dx + 4;
            double left = x < .73 ? before[k].left : 1;

            snprintf(scene, sizeof scene,
                     BALL "void prism1 p 5 .6 x y z f.cal 0 1 .75\n" LEVEL
                          "%ss polygon screen 0 0 12 -3 -3 1.5 -.01 -3 1.5 "
                          "-.01 3 1.5 -3 3 1.5\n",
                     before[k].screen);
            ck_assert_double_eq_tol(light_at(scene, with(_i, DIRECT), x, 0, 1),
                                    left * .6 * BALL_FLUX / d2 * 2 / sqrt(d2),
                                    1e-8);
        }
}

/* Rays to the sun have one direction, but the pane's coefficient is .5 at one
 * place and .6 at another. */
LOOP_TEST(each_place_of_a_pane_has_its_own_light, N_ELEM(pretest))
{
    static const double up[3] = { 0, 0, 1 };
    double first = 0;

    open_world("void light lit 0 0 3 1e4 1e4 1e4\n"
               "lit source sun 0 0 4 0 0 1 1\n"
               "void prism1 p 5 .5+.1*Px Dx Dy Dz . 0 0\n" LEVEL,
               with(_i, DIRECT));
    for (int i = 0; i < 3; i++) {
        double p[3] = { i % 2, 0, 0 };
        struct rad_ray r;

        rad_ray_irradiance(&w.ctx, &r, p, up, 1);
        first = i == 0 ? r.L.r : first;
        ck_assert_double_gt(first, 1);
        ck_assert_double_eq_tol(r.L.r / first, i % 2 ? 1.2 : 1, 1e-5);
    }
}

/* Rays to the lamp go straight on, each dimmed by its own direction. */
LOOP_TEST(each_direction_has_its_own_light, N_ELEM(pretest))
{
    static const double up[3] = { 0, 0, 1 };

    open_world(BALL "void prism1 p 5 .5+.1*Dx Dx Dy Dz . 0 0\n" LEVEL,
               with(_i, DIRECT));
    for (double x = -1; x <= 1; x += .5) {
        double p[3] = { x, 0, 0 }, d2 = x * x + 4, d = sqrt(d2);
        struct rad_ray r;

        rad_ray_irradiance(&w.ctx, &r, p, up, 1);
        ck_assert_double_eq_tol(
            r.L.r, (.5 - .1 * x / d) * BALL_FLUX / d2 * 2 / d, 1e-8);
    }
}

/* Rays to a sun of 60 degrees have one aim and many directions: the pane lets
 * all of what leans to one side through, and a tenth of the rest. */
LOOP_TEST(each_part_of_the_sun_has_its_own_light, N_ELEM(pretest))
{
    static const char *const share[] = { "1", ".5+if(Dx,.5,-.4)" };
    static const double up[3] = { 0, 0, 1 }, p[3] = { 0, 0, 0 };
    double sum[2] = { 0 };
    char scene[400];

    for (int k = 0; k < 2; k++) {
        snprintf(scene, sizeof scene,
                 "void light s 0 0 3 1 1 1 s source sun 0 0 4 0 0 1 60\n"
                 "void prism1 p 5 %s Dx Dy Dz . 0 0\n" LEVEL,
                 share[k]);
        open_world(scene, with(_i, "-av 0 0 0 -dj 1 -dt 0 -ds 0 -dr 1"));
        for (uint64_t key = 0; key < 400; key++) {
            struct rad_ray r;

            rad_ray_irradiance(&w.ctx, &r, p, up, key);
            sum[k] += r.L.r;
        }
    }
    ck_assert_double_eq_tol(sum[1] / sum[0], .55, .1);
}

/* Seen in mist all light is dimmed alike, that of an image, too. */
LOOP_TEST(mist_veils_an_image, N_ELEM(pretest))
{
    static const char *const pane[] = {
        "", "void prism1 p 5 .6 Dx Dy Dz . 0 0\n" LEVEL
    };
    double L[2];
    char scene[600];

    for (int k = 0; k < 2; k++) {
        snprintf(scene, sizeof scene,
                 BALL "void mist fog 0 0 7 .2 .2 .2 0 0 0 0\n"
                      "fog sphere air 0 0 4 0 0 0 5\n"
                      "void plastic f 0 0 5 .5 .5 .5 0 0\n"
                      "f ring floor 0 0 8 0 0 0 0 0 1 0 .2\n%s",
                 pane[k]);
        open_world(scene, with(_i, DIRECT));
        L[k] = world_see(&w, 8, 0, .5, -8, 0, -.5).g;
    }
    ck_assert_double_gt(L[0], 0);
    ck_assert_double_eq_tol(L[1] / L[0], .6, 1e-4);
}

/* A glow has its reach from the image, not from the unbent place,
 * (x - .75, 0, 0). */
LOOP_TEST(glow_reaches_along_the_bent_way, N_ELEM(pretest))
{
    char scene[400];

    for (double x = -1; x <= 1; x += .25)
        for (double reach = 1.95; reach < 3; reach += .125) {
            double dx = x + .75, d2 = dx * dx + 4, expect;

            snprintf(scene, sizeof scene,
                     "void glow lit 0 0 4 100 100 100 %g\n"
                     "lit sphere ball 0 0 4 0 0 2 .01\n"
                     "void prism1 p 5 .6 x y z f.cal 0 1 .75\n" LEVEL,
                     reach);
            expect = sqrt(d2) <= reach ? .6 * BALL_FLUX / d2 * 2 / sqrt(d2) : 0;
            if (fabs(sqrt(d2) - reach) > .01)
                ck_assert_double_eq_tol(
                    light_at(scene, with(_i, DIRECT), x, 0, 1), expect, 1e-8);
        }
}

/* The ray that meets the lamp tells what of a spotlight's cone it is in.  Its
 * way is not that by which the image was found: at x = 1 it meets the lamp 16
 * degrees off the axis, where the image's map says 19. */
LOOP_TEST(spotlight_shines_where_rays_see_it, N_ELEM(pretest))
{
    char scene[400];
    int lit = 0;

    for (double x = -1.5; x <= 1.5; x += .25)
        for (int angle = 15; angle <= 95; angle += 5) {
            double dx = -.3 - x, d2 = dx * dx + 4, E;

            snprintf(scene, sizeof scene,
                     "void spotlight lit 0 0 7 100 100 100 %d 0 0 -1e-9\n"
                     "lit sphere ball 0 0 4 0 0 2 .1\n"
                     "void prism1 p 5 .6 Dx+.3 Dy Dz . 0 0\n" LEVEL,
                     angle);
            E = light_at(scene, with(_i, DIRECT), x, 0, 1);
            ck_assert_double_eq_tol(E,
                                    world_see(&w, x, 0, 0, dx, 0, 2).g * M_PI *
                                        .01 / d2 * 2 / sqrt(d2),
                                    1e-4);
            lit += E > 0;
        }
    ck_assert_int_gt(lit, 50);
}

/* Two ways, two images. */
LOOP_TEST(prism2_has_two_images, N_ELEM(pretest))
{
    static const char *scene =
        BALL "void prism2 p 9 .5 x y z .25 x2 y z f.cal 0 1 .75\n" LEVEL;
    double a = 1.75 * 1.75 + 4, b = .25 * .25 + 4;

    ck_assert_double_eq_tol(
        light_at(scene, with(_i, DIRECT), 1, 0, 1),
        2 * BALL_FLUX * (.5 * pow(a, -1.5) + .25 * pow(b, -1.5)), 1e-8);
}

/* What comes back lights the lamp's own side: the image is below the pane. */
LOOP_TEST(light_may_come_back, N_ELEM(pretest))
{
    static const char *scene =
        BALL "void prism1 p 5 .6 x y zback f.cal 0 1 .75\n" LEVEL;
    double d2 = .75 * .75 + 1.5 * 1.5;

    ck_assert_double_eq_tol(light_at(scene, with(_i, DIRECT), 0, 1.5, -1),
                            .6 * BALL_FLUX / d2 * 1.5 / sqrt(d2), 1e-8);
    ck_assert_double_eq(light_at(scene, with(_i, DIRECT), 0, .5, 1), 0);
}

/* A sun of .5 degrees: its image has its size, in the bent direction. */
LOOP_TEST(sun_is_bent, N_ELEM(pretest))
{
    static const char *scene =
        "void light s 0 0 3 1e4 1e4 1e4 s source sun 0 0 4 0 0 1 .5\n"
        "void prism1 p 5 .6 x y z f.cal 0 1 .75\n" LEVEL;
    double E = 1e4 * 2 * M_PI * (1 - cos(.25 * M_PI / 180));

    ck_assert_double_eq_tol(light_at(scene, with(_i, DIRECT), .5, 0, 1),
                            .6 * E / sqrt(1 + .75 * .75), 1e-6 * E);
}

/* A pane that turns nothing lets light through, dimmed. */
LOOP_TEST(straight_prism_dims_alone, N_ELEM(pretest))
{
    static const char *scene = BALL "void prism1 p 5 .6 Dx Dy Dz . 0 0\n" LEVEL;

    for (double x = -1; x <= 1; x += .5) {
        double d2 = x * x + 4;

        ck_assert_double_eq_tol(light_at(scene, with(_i, DIRECT), x, 0, 1),
                                .6 * BALL_FLUX / d2 * 2 / sqrt(d2), 1e-8);
    }
}

/* A lamp that looks down, .02 wide: its area counts by its bent normal, which
 * is that of the direction (.75, 0, -1), and by the distance of the image. */
LOOP_TEST(flat_lamp_keeps_its_area, N_ELEM(pretest))
{
    static const char *scene =
        LAMP "lit polygon panel 0 0 12 -.01 -.01 2 -.01 .01 2 .01 .01 2 "
             ".01 -.01 2\n"
             "void prism1 p 5 .6 x y z f.cal 0 1 .75\n" LEVEL;
    double x = .25, dx = x + .75, d2 = dx * dx + 4;
    double cos_lamp = (.75 * dx + 2) / sqrt((.75 * .75 + 1) * d2);

    ck_assert_double_eq_tol(light_at(scene, with(_i, DIRECT), x, 0, 1),
                            .6 * 100 * 4e-4 / d2 * cos_lamp * 2 / sqrt(d2),
                            1e-8);
}

/* A lamp that looks down, on both sides of the plane of an upright prism below
 * it; farther from that plane the lamp has an image. */
LOOP_TEST(lamp_across_the_plane_of_a_prism_has_no_image, N_ELEM(pretest))
{
    static const double y[] = { .02, .6 };
    char scene[1024];

    for (int i = 0; i < 2; i++) {
        snprintf(scene, sizeof scene,
                 LAMP "lit polygon panel 0 0 12 1 %g 2 1 %g 2 2 %g 2 2 %g 2\n"
                      "void prism1 p 5 .6 x y z f.cal 0 1 .2\n"
                      "p polygon pane 0 0 12 -2 .02 0 2 .02 0 2 -.2 1.9 "
                      "-2 -.2 1.9\n",
                 y[i] - .3, y[i] + .3, y[i] + .3, y[i] - .3);
        ck_assert_int_eq(images_of(scene, with(_i, DIRECT)) > 0, i);
        world_tear_down();
    }
}

/* From the ball to a mirror in the plane x = 1, from there at (2, 0, 2) to the
 * pane's middle, bent by .5; and all of it the other way round.  A black ball
 * on the way hides that image. */
LOOP_TEST(prism_and_mirror_relay_each_other, N_ELEM(pretest))
{
    static const char *const blocker[] = { "",
                                           "k sphere b 0 0 4 .65 0 1.2 .2\n",
                                           "k sphere b 0 0 4 .5 0 1.7 .3\n" };
    char scene[600];
    /* (-2, 0, -1)/1 + (.5, 0, 0): normalized .5 is sqrt(5)/2 */
    double slope = -2 + .5 * sqrt(5), image = -slope;
    double straight = .5, x = -.5;
    double a = x - image, b = x + straight;

    for (int k = 0; k < N_ELEM(blocker); k++) {
        double expect =
            .6 * 2 * BALL_FLUX *
            ((k == 0 ? .5 : 0) * pow(a * a + 4, -1.5) + pow(b * b + 4, -1.5));

        snprintf(scene, sizeof scene,
                 BALL "void mirror m 0 0 3 .5 .5 .5\n"
                      "m polygon wall 0 0 12 1 -9 1.01 1 -9 9 1 9 9 1 9 1.01\n"
                      "void plastic k 0 0 5 0 0 0 0 0\n%s"
                      "void prism1 p 5 .6 x y z f.cal 0 1 .5\n" LEVEL,
                 blocker[k]);
        ck_assert_double_eq_tol(
            light_at(scene, with(_i, "-av 0 0 0 -dj 0 -dt 0 -ds 0 -dr 2"), x, 0,
                     1),
            expect, 1e-7);
    }
}

LOOP_TEST(what_is_in_the_way_casts_its_shadow, N_ELEM(pretest))
{
    static const char *const blocker[] = {
        "k ring above 0 0 8 0 0 1.5 0 0 1 0 9\n",
        "k ring below 0 0 8 0 0 .5 0 0 1 0 9\n",
    };
    char scene[1024];

    for (int i = 0; i < N_ELEM(blocker); i++) {
        snprintf(scene, sizeof scene,
                 BALL "void plastic k 0 0 5 0 0 0 0 0\n%s"
                      "void prism1 p 5 .6 x y z f.cal 0 1 .75\n" LEVEL,
                 blocker[i]);
        ck_assert_double_eq(light_at(scene, with(_i, DIRECT), 0, 0, 1), 0);
    }
}

/* Nothing comes of these. */
LOOP_TEST(no_light_no_image, N_ELEM(pretest))
{
    static const char *const none[] = {
        "void prism1 p 5 0 x y z f.cal 0 1 .75\n" LEVEL,
        "void prism1 p 5 1/(Px-Px) x y z f.cal 0 1 .75\n" LEVEL,
        "void prism1 p 5 1 1 0 0 . 0 0\n" LEVEL, /* along the pane */
        "void prism1 p 5 1 0 0 0 . 0 0\n" LEVEL,
        "void prism1 p 5 1 Dx Dy Dz . 0 0\np sphere s 0 0 4 0 0 0 1\n",
        "void prism1 p 5 1 Dx Dy Dz . 0 0\n" /* seen edge-on */
        "p ring r 0 0 8 1 0 2 0 0 1 0 .5\n",
    };
    char scene[1024];

    for (int i = 0; i < N_ELEM(none); i++) {
        snprintf(scene, sizeof scene, "%s%s", BALL, none[i]);
        ck_assert_int_eq(images_of(scene, with(_i, DIRECT)), 0);
    }
}

static const struct {
    const char *text, *message;
} bad[] = {
    { "void prism1 p 4 1 0 0 1 0 0\n" LEVEL, "5 string arguments" },
    { "void prism2 p 8 1 0 0 1 1 0 0 1 0 0\n" LEVEL, "9 string arguments" },
    { "void prism1 p 5 1 0 NxP 1 . 0 0\n" LEVEL, "undefined variable 'NxP'" },
    { "void prism1 p 5 1 0 0 1 g.cal 0 0\n" LEVEL, "no file 'g.cal'" },
};

LOOP_TEST(bad_arguments_are_refused, N_ELEM(bad))
{
    world_refused(bad[_i].text, "", &files, bad[_i].message);
}
