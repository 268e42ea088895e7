/* check_wgmd.c - tests of src/shade/gloss/wgmd.c: WGMDfunc
 *
 * A square in the plane z = 0 is seen at the origin, in the plane y = 0 from
 * the side of negative x, under one sun that gives 1 W/m^2 across its rays, or
 * under a sky. */
#include "config.h"

#include "square.h"

#include <stdlib.h>

/* a sky whose radiance is 2 plus its direction's x */
#define SLOPE                                                                  \
    "void brightfunc up 2 2+Dx . 0 0\nup glow white 0 0 4 1 1 1 0\n"           \
    "white source sky 0 0 4 0 0 1 360\n"
#define NOTHING "void 0 0 0 "

/* Rough parts are those of the simple types, whose colours are multiplied
 * out. */
static const struct {
    const char *wgmd, *simple;
} same[] = {
    { "13 void .2 .1 .4 " NOTHING "void 1 2 0 . "
      "0 9 .4 .32 .24 0 0 0 0 0 0",
      "plastic2 m 4 1 2 0 . 0 6 .5 .4 .3 .2 .1 .4" },
    { "15 void .1 .2 .3 void .9*A10*.5 .2 .3 void 0 1 0 . -rz 20 "
      "0 10 .36 .36 .36 0 0 0 .27 .27 .27 .6",
      "trans2 m 6 0 1 0 . -rz 20 0 8 1 1 1 .1 .2 .3 .6 .5" },
    { "13 void .2 .3 .3 " NOTHING "void 0 0 1 . 0 9 .4 .32 .24 0 0 0 0 0 0",
      "plastic m 0 0 5 .5 .4 .3 .2 .3" },
    { "13 void .2 .1 .7 " NOTHING "void 0 0 1 . 0 9 .4 .32 .24 0 0 0 0 0 0",
      "plastic m 0 0 5 .5 .4 .3 .2 .5" },
};

static const struct {
    const char *options, *sky;
    double side; /* of the sun */
} shown[] = {
    { DIRECT, "", 1 },   { DIRECT, "", -1 },   { "-av .3 .2 .1 -st 1", "", 1 },
    { PLAIN, ABOVE, 1 }, { PLAIN, BELOW, -1 },
};

LOOP_TEST(rough_parts_are_those_of_simple_types, N_ELEM(same))
{
    for (int k = 0; k < N_ELEM(shown); k++) {
        struct rad_rgb L[2];

        for (int simple = 0; simple < 2; simple++) {
            char scene[1024];
            double sun[3];

            direction(sun, 40, 30);
            sun[2] *= shown[k].side;
            snprintf(scene, sizeof scene, "void %s%s\n" SQUARE "%s",
                     simple ? "" : "WGMDfunc m ",
                     simple ? same[_i].simple : same[_i].wgmd, shown[k].sky);
            add_sun(scene, sizeof scene, sun, 1);
            L[simple] = see(scene, shown[k].options, 35);
        }
        ck_assert_double_eq_tol(L[0].r, L[1].r, 1e-6 * (1 + L[1].r));
        ck_assert_double_eq_tol(L[0].b, L[1].b, 1e-6 * (1 + L[1].b));
    }
}

/* A mirror of more than .018 gains by exp(-5.85 cos) - .00203 of what it lacks,
 * and all else loses as much; a weaker one does not. */
TEST(bright_mirror_gains_toward_grazing)
{
    static const double deg[] = { 0, 45, 80 };
    const char *pane = "13 void .3 0 0 void .4 0 0 void 1 0 0 . "
                       "0 9 .1 .1 .1 .1 .1 .1 .2 .2 .2\n" SQUARE;
    const char *weak = "13 void .01 0 0 void .4 0 0 void 1 0 0 . "
                       "0 9 .1 .1 .1 .1 .1 .1 .2 .2 .2\n" SQUARE;

    for (int i = 0; i < N_ELEM(deg); i++) {
        double rise = exp(-5.85 * cos(RADIANS(deg[i]))) - .00202943064;
        char scene[512];

        snprintf(scene, sizeof scene, "void WGMDfunc m %s" ABOVE, pane);
        ck_assert_double_eq_tol(see(scene, PLAIN, deg[i]).g, .3 + .7 * rise,
                                1e-6);
        snprintf(scene, sizeof scene, "void WGMDfunc m %s" BELOW, pane);
        ck_assert_double_eq_tol(see(scene, PLAIN, deg[i]).g, .4 * (1 - rise),
                                1e-6);
        snprintf(scene, sizeof scene, "void WGMDfunc m %s", pane);
        ck_assert_double_eq_tol(see(scene, "-av 1 1 1", deg[i]).g,
                                .3 * (1 - rise), 1e-6);
        snprintf(scene, sizeof scene, "void WGMDfunc m %s" ABOVE, weak);
        ck_assert_double_eq_tol(see(scene, PLAIN, deg[i]).g, .01, 1e-6);
        snprintf(scene, sizeof scene, "void WGMDfunc m %s" BELOW, weak);
        ck_assert_double_eq_tol(see(scene, PLAIN, deg[i]).g, .4, 1e-6);
    }
}

/* By the light's angle, too. */
TEST(bright_mirror_takes_from_diffuse_light)
{
    for (int side = 1; side >= -1; side -= 2) {
        double sun[3], loss = exp(-5.85 * cos(RADIANS(70))) - .00202943064;
        double eye = exp(-5.85 * cos(RADIANS(20))) - .00202943064;
        char scene[1024] =
            "void WGMDfunc m 13 void .3 0 0 " NOTHING
            "void 1 0 0 . 0 9 .5 .5 .5 .5 .5 .5 .2 .2 .2\n" SQUARE;

        direction(sun, 70, 30);
        sun[2] *= side;
        add_sun(scene, sizeof scene, sun, 1);
        ck_assert_double_eq_tol(see(scene, DIRECT, 20).g,
                                (side > 0 ? .5 : .2) / M_PI * cos(RADIANS(70)) *
                                    (1 - loss) * (1 - eye),
                                1e-6);
    }
}

/* Front and back reflect diffusely by numbers of their own. */
TEST(sides_differ_in_diffuse_reflection)
{
    static const char scene[] =
        "void WGMDfunc m 13 " NOTHING NOTHING "void 1 0 0 . "
        "0 9 .1 .2 .3 .4 .3 .2 .05 .1 .15\n" SQUARE;

    ck_assert_double_eq_tol(see(scene, "-av 1 1 1", 30).r, .15, 1e-6);
    ck_assert_double_eq_tol(see(scene, "-av 1 1 1", 30).b, .45, 1e-6);
    ck_assert_double_eq_tol(see(scene, "-av 1 1 1", 150).r, .45, 1e-6);
    ck_assert_double_eq_tol(see(scene, "-av 1 1 1", 150).b, .35, 1e-6);
}

/* Each part has its own pattern: the material's is .5 .25 .125, another .1 .2
 * .4; from below the same. */
static const struct {
    const char *rs, *ts, *td;
    double rs_g, ts_g, td_g;
} modified[] = {
    { "void", "void", "void", 1, 1, 1 },
    { "inherit", "void", "void", .25, 1, 1 },
    { "own", "inherit", "other", .25, .25, .2 },
    { "other", "void", "inherit", .2, 1, .25 },
    { "void", "other", "other", 1, .2, .2 },
};

LOOP_TEST(each_part_has_its_modifier, N_ELEM(modified))
{
    for (int k = 0; k < 6; k++) {
        double deg = k < 3 ? 10 : 170, expect;
        struct rad_rgb L;
        char scene[1024];

        snprintf(scene, sizeof scene,
                 "void colorfunc own 4 .5 .25 .125 . 0 0\n"
                 "void colorfunc other 4 .1 .2 .4 . 0 0\n"
                 "own WGMDfunc m 13 %s .01 0 0 %s .3 0 0 %s 1 0 0 . "
                 "0 9 .4 .4 .4 .2 .2 .2 .1 .1 .1\n" SQUARE "%s",
                 modified[_i].rs, modified[_i].ts, modified[_i].td,
                 k % 3 == 0   ? k < 3 ? ABOVE : BELOW
                 : k % 3 == 1 ? k < 3 ? BELOW : ABOVE
                              : "");
        L = see(scene, k % 3 == 2 ? "-av 1 1 1" : PLAIN, deg);
        expect = k % 3 == 0 ? .01 * modified[_i].rs_g
                 : k % 3 == 1
                     ? .3 * modified[_i].ts_g
                     : .1 * modified[_i].td_g + (k < 3 ? .4 : .2) * .25;
        ck_assert_double_eq_tol(L.g, expect, 1e-6);
    }
}

/* A texture of slope .1 bends what passes, or tilts what is mirrored, if it is
 * the part's; seen from below it does so by the normal turned to the eye. */
TEST(texture_bends_its_part_alone)
{
    double tilt = atan(.1), ahead[3] = { 0, 0, -1 }, expect;
    static const char *const modifier[] = { "void", "t" };

    /* the unit normal's difference from (0, 0, 1) is taken from the way */
    ahead[0] -= sin(tilt);
    ahead[2] -= cos(tilt) - 1;
    rad_normalize(ahead);
    for (int k = 0; k < 4; k++) {
        char scene[1024];

        snprintf(scene, sizeof scene,
                 "void texfunc t 4 .1 0 0 . 0 0\n"
                 "void WGMDfunc m 13 %s %s 0 0 %s %s 0 0 void 1 0 0 . "
                 "0 9 0 0 0 0 0 0 0 0 0\n" SQUARE SLOPE,
                 modifier[k & 1], k < 2 ? ".01" : "0", modifier[!(k & 1)],
                 k < 2 ? "0" : "1");
        expect = k == 0   ? .01 * 2
                 : k == 1 ? .01 * (2 + sin(2 * tilt))
                 : k == 2 ? 2 + ahead[0]
                          : 2;
        ck_assert_double_eq_tol(see(scene, PLAIN, 0).g, expect, 1e-6);
    }
}

/* The expressions see each part's own normal, on the side of the eye. */
TEST(expressions_see_the_parts_normal)
{
    for (int k = 0; k < 4; k++) {
        double deg = k & 1 ? 150 : 30, c = cos(RADIANS(30)), s = 1 / sqrt(1.01);
        /* -dir is (-.5, 0, +-c) */
        double plain = c, side = k & 1 ? -1 : 1;
        double tilted = (c - side * .1 * .5) * s;
        char scene[1024];

        snprintf(scene, sizeof scene,
                 "void texfunc t 4 .1 0 0 . 0 0\n"
                 "t WGMDfunc m 13 %s RdotP*.01 0 0 void NzP*NzP*.5 0 0 void "
                 "1 0 0 . 0 9 0 0 0 0 0 0 0 0 0\n" SQUARE "%s",
                 k & 2 ? "inherit" : "void", k & 1 ? BELOW : ABOVE);
        ck_assert_double_eq_tol(see(scene, PLAIN, deg).g,
                                .01 * (k & 2 ? tilted : plain), 1e-6);
        strcpy(strstr(scene, "void glow"), k & 1 ? ABOVE : BELOW);
        ck_assert_double_eq_tol(see(scene, PLAIN, deg).g, .5, 1e-6);
    }
}

/* Shadow rays pass where what is transmitted is not rough. */
TEST(unbent_part_lets_shadow_rays_pass)
{
    static const struct {
        const char *ts, *options;
        double expect;
    } way[] = {
        { "p .5 0 0 ", "", .5 * .25 },
        { "p .5 1 0 ", "", .5 * .25 },
        { "p .5 0 1 ", "", .5 * .25 },
        { "p .5 .2 .2 ", "", 0 },
        { "p 0 0 0 ", "", 0 },
        { "p 0 0 0 ", " -bv-", 1 },
        { "p .5 .2 .2 ", " -bv-", 1 },
        { "void Px*Px 0 0 ", "", 0 },
        { "void -Rdot*.5 0 0 ", "", .5 },
    };
    static const double p[3] = { 0, 0, -1 }, up[3] = { 0, 0, 1 };

    for (int i = 0; i < N_ELEM(way); i++) {
        double sun[3] = { 0, 0, 1 };
        struct rad_ray r;
        struct world w = { 0 };
        char scene[1024], options[100] = DIRECT;

        snprintf(scene, sizeof scene,
                 "void brightfunc p 2 .25 . 0 0\n"
                 "p WGMDfunc m 13 " NOTHING "%s void 1 0 0 . "
                 "0 9 1 1 1 1 1 1 1 1 1\n" SQUARE,
                 way[i].ts);
        add_sun(scene, sizeof scene, sun, 1);
        strcat(options, way[i].options);
        world_open(&w, scene, options);
        rad_ray_irradiance(&w.ctx, &r, p, up, 1);
        ck_assert_double_eq_tol(r.L.g, way[i].expect, 1e-6);
        world_close(&w);
    }
}

/* Errors leave their part away; a missing name matters where it is used. */
TEST(part_without_a_value_is_not_there)
{
    static const char *const none[] = {
        "void sqrt(-1-Px) 0 0 ", "void 1 1/(Px-Px) 0 ", "void 1 .1 sqrt(-.5) ",
        "void -1 0 0 ",          "nobody 0 0 0 ",       "black 1 0 0 ",
    };
    char scene[512];

    for (int i = 0; i < N_ELEM(none); i++) {
        snprintf(scene, sizeof scene,
                 "void brightfunc black 2 0 . 0 0\n"
                 "void WGMDfunc m 13 %s" NOTHING "nobody 1 0 0 . "
                 "0 9 .5 .5 .5 0 0 0 0 0 0\n" SQUARE ABOVE,
                 none[i]);
        ck_assert_double_eq(see(scene, PLAIN, 20).g, 0);
        ck_assert_double_eq_tol(see(scene, "-av 1 1 1 -st 1", 20).g, .5, 1e-6);
    }
}

static const struct {
    const char *text, *message;
} bad[] = {
    { "void WGMDfunc m 12 " NOTHING NOTHING "void 1 0 0 0 9 0 0 0 0 0 0 0 0 0 ",
      "13 string arguments" },
    { "void WGMDfunc m 13 " NOTHING NOTHING "void 1 0 0 . 0 8 0 0 0 0 0 0 0 0 ",
      "9 real arguments" },
    { "void WGMDfunc m 13 nobody 1 0 0 " NOTHING
      "void 1 0 0 . 0 9 0 0 0 0 0 0 0 0 0 ",
      "undefined modifier 'nobody'" },
    { "void WGMDfunc m 13 " NOTHING "nobody Px 0 0 "
      "void 1 0 0 . 0 9 0 0 0 0 0 0 0 0 0 ",
      "undefined modifier 'nobody'" },
    { "void WGMDfunc m 13 " NOTHING NOTHING
      "nobody 1 0 0 . 0 9 0 0 0 0 0 0 0 1 0 ",
      "undefined modifier 'nobody'" },
    { "void WGMDfunc m 13 void CrP 0 0 " NOTHING
      "void 1 0 0 . 0 9 0 0 0 0 0 0 0 0 0 ",
      "undefined variable 'CrP'" },
    /* the modifiers that it names are compiled as if they were its own */
    { "void brightfunc p 2 1 none.cal 0 0\n"
      "void WGMDfunc m 13 " NOTHING "p 1 0 0 "
      "void 1 0 0 . 0 9 0 0 0 0 0 0 0 0 0 ",
      "no file 'none.cal'" },
};

LOOP_TEST(bad_arguments_are_refused, N_ELEM(bad))
{
    char scene[512];

    snprintf(scene, sizeof scene, "%s" SQUARE, bad[_i].text);
    world_refused(scene, "", NULL, bad[_i].message);
}
