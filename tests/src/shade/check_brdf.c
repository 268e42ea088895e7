/* check_brdf.c - tests of src/shade/gloss/brdf.c: gloss by functions
 *
 * A square in the plane z = 0 is seen at the origin, in the plane y = 0 from
 * the side of negative x, under one sun that gives 1 W/m^2 across its rays, or
 * under a sky.  Functions are those of the only file that there is. */
#include "config.h"

#include "square.h"

#include <stdlib.h>

static const char functions[] =
    "half(x,y,z,omega) = .5; lx(x,y,z) = x; ly(x,y) = y; lz(x,y,z) = z;\n"
    "size(x,y,z,omega) = omega * 1e7; none(x) = sqrt(-2 - x); minus(x) = -1;\n"
    "tilt(x) = NxP * 10 + NzP; seen(x) = RdotP; tint(x) = CrP*100+CgP*10+CbP;\n"
    "mine(x) = A5 * A6; way(x) = T; facing(x,y,z) = x*NxP + y*NyP + z*NzP;\n"
    "localx(x,y,z) = Ldx(x,y,z); localy(x,y,z) = Ldy(x,y,z);\n"
    "localz(x,y,z) = Ldz(x,y,z); fromx(x) = Idx; fromz(x) = Idz;\n"
    "before(x,y,z) = noneg(x*NxP + y*NyP + z*NzP);\n"
    "first(v) = v; third(v,x,y) = y; fifth(v,x,y,z,omega) = omega * 1e7;\n"
    "retro(x,y,z) = 1 - noneg(-x*Dx - y*Dy - z*Dz);\n";

/* Rises by 2 with the first place, by 30 with the second. */
static const char plane[] = "2 0 1 3  0 0 2 -1 1  -30 30  -29 31  -28 32";

static struct world_file texts[] = { { "f.cal", functions },
                                     { "plane.dat", plane },
                                     { 0 } };
static const struct rad_files files = { .read = world_file_read, .arg = texts };

static struct rad_rgb
see_by(const char *scene, const char *options, double deg)
{
    return see_with(scene, options, &files, deg);
}

/* Seen from 60 degrees, 2 away; the sun is 30 degrees from the normal, above
 * +y. */
/* 2 pi (1 - cos) of half the sun's angle, by the cosine's series: a constant
 * for every compiler */
#define SUN_HALF  (SUN_DEG * M_PI / 360)
#define SUN_OMEGA (M_PI * SUN_HALF * SUN_HALF * (1 - SUN_HALF * SUN_HALF / 12))

static const struct {
    const char *function; /* and the transform */
    double value;
} lit[] = {
    { "2 half f.cal", .5 },
    { "2 lx f.cal", 0 },
    { "2 ly f.cal", .5 },
    { "2 lz f.cal", 0.86602540378443865 },
    { "4 ly f.cal -s 3", .5 },
    { "4 lx f.cal -rz 90", .5 }, /* +y was +x */
    { "4 lz f.cal -rx 90", -.5 },
    { "2 size f.cal", SUN_OMEGA * 1e7 },
    { "2 none f.cal", 0 },
    { "2 minus f.cal", 0 }, /* takes nothing away */
    { "2 tilt f.cal", 1 },
    { "2 seen f.cal", .5 },
    { "2 tint f.cal", 84.2 },
    { "2 mine f.cal", 6 },
    { "2 facing f.cal", 0.86602540378443865 },
    { "2 localx f.cal", 0 },
    { "2 localy f.cal", .5 }, /* y is (-2, 0, 0) x normal */
    { "2 localz f.cal", 0.86602540378443865 },
    { "2 fromx f.cal", 0.86602540378443865 },
    { "2 fromz f.cal", .5 },
    { "2 retro f.cal", 1 - .5 * 0.86602540378443865 },
};

/* The last three arguments are the vector that Ldx() and its like call up. */
LOOP_TEST(function_scatters_the_suns_light, N_ELEM(lit))
{
    double sun[3], cosine = cos(RADIANS(30)), f = fmax(lit[_i].value, 0);
    struct rad_rgb L;
    char scene[1024];

    direction(sun, 30, 90);
    snprintf(scene, sizeof scene,
             "void plasfunc m %s 0 9 .8 .4 .2 .3 2 3 -2 0 0\n" SQUARE,
             lit[_i].function);
    add_sun(scene, sizeof scene, sun, 1);
    L = see_by(scene, DIRECT, 60);
    ck_assert_double_eq_tol(L.r, (.3 * f + .7 * .8 / M_PI) * cosine, 1e-5);
    ck_assert_double_eq_tol(L.b, (.3 * f + .7 * .2 / M_PI) * cosine, 1e-5);
    memcpy(strstr(scene, "plasfunc"), "metfunc ", 8);
    L = see_by(scene, DIRECT, 60);
    ck_assert_double_eq_tol(L.g, .4 * (.3 * f + .7 / M_PI) * cosine, 1e-5);
}

/* Data are looked up where functions of the sun's direction point; the first
 * function gets what is there, and the direction behind it. */
static const struct {
    const char *strings;
    double value;
} found[] = {
    { "5 first plane.dat f.cal ly lz", 2 * .5 + 30 * 0.86602540378443865 },
    { "5 first plane.dat f.cal lz ly", 2 * 0.86602540378443865 + 30 * .5 },
    { "7 first plane.dat f.cal ly lx -rz 90", 30 * .5 },
    { "5 third plane.dat f.cal ly lz", .5 },
    { "5 fifth plane.dat f.cal ly lz", SUN_OMEGA * 1e7 },
    { "5 first plane.dat f.cal none lz", 0 },
};

LOOP_TEST(data_are_found_by_functions, N_ELEM(found))
{
    double sun[3], cosine = cos(RADIANS(30)), f = found[_i].value;
    struct rad_rgb L;
    char scene[1024];

    direction(sun, 30, 90);
    for (int k = 0; k < 3; k++) {
        static const char *const type[] = { "plasdata", "metdata",
                                            "transdata" };
        double side = k < 2 ? 1 : -1;

        snprintf(scene, sizeof scene, "void %s m %s 0 %s\n" SQUARE, type[k],
                 found[_i].strings,
                 k < 2 ? "4 .8 .4 .2 .3" : "6 .8 .4 .2 0 1 .3");
        sun[2] = side * fabs(sun[2]);
        if (k == 2 && strstr(found[_i].strings, "lz"))
            break; /* other places */
        add_sun(scene, sizeof scene, sun, 1);
        L = see_by(scene, DIRECT, 60);
        ck_assert_double_eq_tol(
            L.g, (.3 * f * (k ? .4 : 1) + .7 * .4 / M_PI) * cosine,
            1e-5 * fmax(1, L.g));
    }
}

/* A texture tilts what the function sees as the normal, a pattern colours it:
 * the slope of .1 along x shows in NxP, and in the sun's cosine. */
TEST(function_sees_textures_and_patterns)
{
    double n = 1 / sqrt(1.01), sun[3] = { 0, 0, 1 };
    char scene[1024] = "void texfunc t 4 A1 0 0 . 0 1 .1\n"
                       "t plasfunc m 2 tilt f.cal 0 5 0 0 0 1 0\n" SQUARE;

    add_sun(scene, sizeof scene, sun, 1);
    ck_assert_double_eq_tol(see_by(scene, DIRECT, 20).g, (1 + .1 * 10) * n * n,
                            1e-5);
    strcpy(scene, "void colorfunc t 4 .5 .25 .125 . 0 0\n"
                  "t plasfunc m 2 tint f.cal 0 4 .8 .4 .2 1\n" SQUARE);
    add_sun(scene, sizeof scene, sun, 1);
    ck_assert_double_eq_tol(see_by(scene, DIRECT, 20).g,
                            80 * .5 + 4 * .25 + .2 * .125, 1e-4);
}

/* trans is .9 of what is not reflected, .4 of that specular. */
TEST(transfunc_passes_light_of_its_colour)
{
    double sun[3], cosine = cos(RADIANS(30));
    char scene[1024] =
        "void transfunc m 2 half f.cal 0 6 .8 .4 .2 .3 .9 .4\n" SQUARE;

    direction(sun, 30, 90);
    sun[2] = -sun[2];
    add_sun(scene, sizeof scene, sun, 1);
    ck_assert_double_eq_tol(see_by(scene, DIRECT, 60).g,
                            .4 * .7 * .9 * (.4 * .5 + .6 / M_PI) * cosine,
                            1e-5);
    sun[2] = -sun[2];
    strcpy(scene,
           "void transfunc m 2 half f.cal 0 6 .8 .4 .2 .3 .9 .4\n" SQUARE);
    add_sun(scene, sizeof scene, sun, 1);
    ck_assert_double_eq_tol(see_by(scene, DIRECT, 60).g,
                            (.3 * .5 + .4 * .7 * .1 / M_PI) * cosine, 1e-5);
}

/* Other light knows no function: all of it is scattered evenly. */
TEST(ambient_light_is_scattered_evenly)
{
    struct rad_rgb L =
        see_by("void transfunc m 2 half f.cal 0 6 .8 .4 .2 .3 .9 .4\n" SQUARE,
               "-av 1 2 3", 60);

    ck_assert_double_eq_tol(L.r, .8, 1e-6);
    ck_assert_double_eq_tol(L.g, .8, 1e-6);
    ck_assert_double_eq_tol(L.b, .6, 1e-6);
    L = see_by("void plasfunc m 2 half f.cal 0 4 .8 .4 .2 .3\n" SQUARE,
               "-av 1 2 3", 60);
    ck_assert_double_eq_tol(L.b, .6, 1e-6);
}

/* A function of h or of the angle between the ways is the same both ways. */
TEST(reciprocal_function_gives_a_reciprocal_surface)
{
    double L[2];

    for (int way = 0; way < 2; way++) {
        char scene[1024] = "void metfunc m 2 retro f.cal 0 4 1 1 1 1\n" SQUARE;
        double sun[3];

        direction(sun, way ? 25 : 55, 0);
        add_sun(scene, sizeof scene, sun, 1);
        L[way] = see_by(scene, DIRECT, way ? 55 : 25).g /
                 cos(RADIANS(way ? 25 : 55));
    }
    ck_assert_double_gt(L[0], 0);
    ck_assert_double_eq_tol(L[0], L[1], 1e-5);
}

/* --- BRTDfunc ------------------------------------------------------------- */

TEST(brtdfunc_mirrors_and_passes_by_expressions)
{
    const char *m = "void BRTDfunc m 10 .5 Rdot 0 .1 .2 A10*.3 0 0 0 . "
                    "0 10 0 0 0 0 0 0 0 0 0 2\n" SQUARE;
    char scene[512];
    struct rad_rgb L;

    snprintf(scene, sizeof scene, "%s" ABOVE, m);
    L = see_by(scene, PLAIN, 60);
    ck_assert_double_eq_tol(L.r, .5, 1e-6);
    ck_assert_double_eq_tol(L.g, .5, 1e-6);
    ck_assert_double_eq(L.b, 0);
    L = see_by(scene, PLAIN, 120); /* from below */
    ck_assert_double_eq_tol(L.g, .2, 1e-6);
    snprintf(scene, sizeof scene, "%s" BELOW, m);
    L = see_by(scene, PLAIN, 60);
    ck_assert_double_eq_tol(L.r, .1, 1e-6);
    ck_assert_double_eq_tol(L.b, .6, 1e-6);
}

/* The two sides differ in what they reflect, not in what passes. */
TEST(brtdfunc_has_two_sides)
{
    static const char scene[] = "void BRTDfunc m 10 0 0 0 0 0 0 0 0 0 . "
                                "0 9 .1 .2 .3 .4 .3 .2 .05 .1 .15\n" SQUARE;
    struct rad_rgb L = see_by(scene, "-av 1 1 1", 30);

    ck_assert_double_eq_tol(L.r, .15, 1e-6);
    ck_assert_double_eq_tol(L.b, .45, 1e-6);
    L = see_by(scene, "-av 1 1 1", 150);
    ck_assert_double_eq_tol(L.r, .45, 1e-6);
    ck_assert_double_eq_tol(L.b, .35, 1e-6);
}

/* Before the surface and behind it each channel has its function, or none; seen
 * from below the normal is turned to the eye. */
TEST(brtdfunc_scatters_by_channel)
{
    double cosine = cos(RADIANS(30)), sun[3];

    for (int k = 0; k < 4; k++) {
        double side = k & 1 ? -1 : 1, eye = k & 2 ? 120 : 60;
        bool reflected = (side > 0) == (eye < 90);
        char scene[1024] = "void BRTDfunc m 10 0 0 0 0 0 0 half 0 before f.cal "
                           "0 9 .1 .2 .3 .4 .3 .2 .05 .1 .15\n" SQUARE;
        double base = reflected ? (side > 0 ? .1 : .4) : .05, f;
        struct rad_rgb L;

        direction(sun, 30, 90);
        sun[2] *= side;
        add_sun(scene, sizeof scene, sun, 1);
        L = see_by(scene, DIRECT, eye);
        ck_assert_double_eq_tol(L.r, (base / M_PI + .5) * cosine, 1e-5);
        base = reflected ? (side > 0 ? .2 : .3) : .1;
        ck_assert_double_eq_tol(L.g, base / M_PI * cosine, 1e-5);
        base = reflected ? (side > 0 ? .3 : .2) : .15;
        f = reflected ? cosine : 0;
        ck_assert_double_eq_tol(L.b, (base / M_PI + f) * cosine, 1e-5);
    }
}

/* Light through it is dimmed by channel; what scatters does not let it pass. */
TEST(brtdfunc_casts_a_coloured_shadow)
{
    static const double p[3] = { 0, 0, -1 }, up[3] = { 0, 0, 1 };
    double sun[3] = { 0, 0, 1 };
    struct rad_ray r;
    struct world w = { 0 };
    char scene[1024] = "void BRTDfunc m 10 1 1 1 .1 -Rdot/4 0 half half half "
                       "f.cal 0 9 0 0 0 0 0 0 1 1 1\n" SQUARE;

    add_sun(scene, sizeof scene, sun, 1);
    ck_assert_int_eq(world_try(&w, scene, DIRECT, &files), 0);
    rad_ray_irradiance(&w.ctx, &r, p, up, 1);
    ck_assert_double_eq_tol(r.L.r, .1, 1e-6);
    ck_assert_double_eq_tol(r.L.g, .25, 1e-6);
    ck_assert_double_eq(r.L.b, 0);
    world_close(&w);
}

/* --- errors --------------------------------------------------------------- */

static const struct {
    const char *text, *message;
} bad[] = {
    { "void plasfunc m 2 (half) f.cal 0 4 1 1 1 0 ", "function" },
    { "void plasfunc m 2 nowhere f.cal 0 4 1 1 1 0 ", "'nowhere'" },
    { "void plasfunc m 2 half none.cal 0 4 1 1 1 0 ", "no file 'none.cal'" },
    { "void plasfunc m 2 half f.cal 0 3 1 1 1 ", "4 real arguments" },
    { "void transfunc m 2 half f.cal 0 5 1 1 1 0 0 ", "6 real arguments" },
    { "void BRTDfunc m 9 0 0 0 0 0 0 0 0 0 0 9 0 0 0 0 0 0 0 0 0 ",
      "10 string arguments" },
    { "void BRTDfunc m 10 0 0 0 0 0 0 0 0 0 . 0 8 0 0 0 0 0 0 0 0 ",
      "9 real arguments" },
    /* others do not have these variables */
    { "void plasdata m 4 first plane.dat f.cal lx 0 4 1 1 1 0 ",
      "2 dimensions" },
    { "void plasdata m 4 first none.dat f.cal lx 0 4 1 1 1 0 ", "none.dat" },
    { "void plasdata m 5 first f.cal f.cal lx ly 0 4 1 1 1 0 ", "f.cal" },
    { "void transdata m 5 first plane.dat f.cal lx ly 0 5 1 1 1 0 1 ",
      "6 real arguments" },
    { "void brightfunc p 2 NxP . 0 0 p glow m 0 0 4 1 1 1 0 ",
      "undefined variable 'NxP'" },
    { "void brightfunc p 2 Ldx(1,2,3) . 0 3 0 0 1 p glow m 0 0 4 1 1 1 0 ",
      "undefined variable 'N" },
    { "void brightfunc p 2 1+CrP . 0 0 p plasfunc m 2 seen f.cal 0 4 1 1 1 1 ",
      "undefined variable 'CrP'" },
    { "void plasfunc p 2 seen f.cal 0 4 1 1 1 1 p sphere s 0 0 4 0 0 0 1 "
      "void brightfunc p 2 seen(1) f.cal 0 0 p glow m 0 0 4 1 1 1 0 ",
      "undefined variable 'RdotP'" },
    { "void BRTDfunc m 10 DxA 0 0 0 0 0 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0 ",
      "undefined variable 'DxA'" },
    { "void brightfunc p 2 $28 . 0 0 p glow m 0 0 4 1 1 1 0 ",
      "no such channel" },
};

LOOP_TEST(bad_arguments_are_refused, N_ELEM(bad))
{
    char scene[512];

    snprintf(scene, sizeof scene, "%s" SQUARE, bad[_i].text);
    world_refused(scene, "", &files, bad[_i].message);
}
