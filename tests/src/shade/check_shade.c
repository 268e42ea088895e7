/* check_shade.c - tests of src/shade: materials against closed forms
 *
 * Most scenes are one square in the plane z = 0, seen from above, with a glow
 * of radiance 1 above it or below: then what comes back is a reflectance or a
 * transmittance. */
#include "config.h"

#include "suns.h"
#include "tests/world_fixture.h"
#include "base/rng.h"

#include <stdio.h>
#include <stdlib.h>

FIXTURE(NULL, world_tear_down)

#define ABOVE "void glow white 0 0 4 1 1 1 0 white source sky 0 0 4 0 0 1 180\n"
#define BELOW                                                                  \
    "void glow white 0 0 4 1 1 1 0 white source sky 0 0 4 0 0 -1 180\n"
#define SQUARE " polygon s 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"

/* no ambient light, every part of a material followed to its end */
#define PLAIN "-av 0 0 0 -st 0 -lw 0 -lr 30 -ss 0"

/* Fresnel's reflectances from Snell's angles, the formulas with sines and
 * tangents that the code does not use. */
static void
fresnel(double n, double deg, double *rs, double *rp)
{
    double i = deg * M_PI / 180, t = asin(sin(i) / n);

    if (i == 0) {
        *rs = *rp = pow((n - 1) / (n + 1), 2);
        return;
    }
    *rs = pow(sin(i - t) / sin(i + t), 2);
    *rp = pow(tan(i - t) / tan(i + t), 2);
}

static const double angles[] = { 0, 10, 30, 45, 56.659, 70, 80, 89 };

/* Radiance's manual: T = (1-r)^2 t / (1-r^2 t^2), mean of polarizations, with
 * t = tn^(1/cos of the angle inside). */
LOOP_TEST(glass_transmits_as_the_manual_says, N_ELEM(angles))
{
    double rs, rp, t, T, deg = angles[_i];

    world_open(&w, BELOW "void glass m 0 0 3 .96 .5 1\n m" SQUARE, PLAIN);
    fresnel(1.52, deg, &rs, &rp);
    t = pow(.5, 1 / sqrt(1 - pow(sin(deg * M_PI / 180) / 1.52, 2)));
    T = .5 * pow(1 - rs, 2) * t / (1 - rs * rs * t * t) +
        .5 * pow(1 - rp, 2) * t / (1 - rp * rp * t * t);
    ck_assert_double_eq_tol(world_tilted(&w, deg).g, T, 1e-6);
    ck_assert_double_eq_tol(world_tilted(&w, -deg).g, T, 1e-6);
}

/* Clear glass loses nothing. */
LOOP_TEST(clear_glass_reflects_what_it_does_not_transmit, N_ELEM(angles))
{
    struct world a = { 0 }, b = { 0 };

    world_open(&a, ABOVE "void glass m 0 0 4 1 1 1 1.8\n m" SQUARE, PLAIN);
    world_open(&b, BELOW "void glass m 0 0 4 1 1 1 1.8\n m" SQUARE, PLAIN);
    ck_assert_double_eq_tol(world_tilted(&a, angles[_i]).r +
                                world_tilted(&b, angles[_i]).r,
                            1, 1e-6);
    world_close(&a);
    world_close(&b);
}

/* The transmissivity that the manual gives for 88 % transmittance. */
TEST(glass_of_96_percent_is_the_88_percent_pane)
{
    world_open(&w, BELOW "void glass m 0 0 3 .96 .96 .96\n m" SQUARE, PLAIN);
    ck_assert_double_eq_tol(world_tilted(&w, 0).r, .88, .0016);
}

LOOP_TEST(dielectric_reflects_by_fresnel, N_ELEM(angles))
{
    double rs, rp, deg = angles[_i];

    world_open(&w, ABOVE "void dielectric m 0 0 5 1 1 1 1.5 0\n m" SQUARE,
               PLAIN);
    fresnel(1.5, deg, &rs, &rp);
    ck_assert_double_eq_tol(world_tilted(&w, deg).g, .5 * (rs + rp), 1e-6);
}

TEST(dielectric_at_brewsters_angle_reflects_one_polarization)
{
    double n = 1.5, rs = pow((1 - n * n) / (1 + n * n), 2);

    world_open(&w, ABOVE "void dielectric m 0 0 5 1 1 1 1.5 0\n m" SQUARE,
               PLAIN);
    ck_assert_double_eq_tol(world_tilted(&w, atan(n) * 180 / M_PI).r, rs / 2,
                            1e-7);
}

/* Seen from within, the surface is a mirror beyond the critical angle, 41.8
 * degrees, and none before. */
TEST(dielectric_reflects_totally_from_within)
{
    double rs, rp;

    world_open(&w, BELOW "void dielectric m 0 0 5 1 1 1 1.5 0\n m" SQUARE,
               PLAIN);
    ck_assert_double_eq_tol(world_see(&w, 0, 0, -1, sin(.74), 0, cos(.74)).r, 1,
                            1e-6);
    fresnel(1.5, asin(1.5 * sin(.6)) * 180 / M_PI, &rs, &rp);
    ck_assert_double_eq_tol(world_see(&w, 0, 0, -1, sin(.6), 0, cos(.6)).r,
                            .5 * (rs + rp), 1e-6);
}

/* A small sun where Snell's law sends the ray, and one a degree off. */
TEST(dielectric_refracts_by_snell)
{
    double i = M_PI / 4, t = asin(sin(i) / 1.5), rs, rp;
    char text[512];

    for (int off = 0; off < 2; off++) {
        double a = t + off * M_PI / 180;

        snprintf(text, sizeof text,
                 "void light sun 0 0 3 9 9 9 sun source sun 0 0 4 %.12g 0 "
                 "%.12g .2 void dielectric m 0 0 5 1 1 1 1.5 0 m" SQUARE,
                 sin(a), -cos(a));
        world_open(&w, text, PLAIN);
        fresnel(1.5, 45, &rs, &rp);
        ck_assert_double_eq_tol(
            world_tilted(&w, 45).r,
            off ? 0 : 9 * (1 - .5 * (rs + rp)) / (1.5 * 1.5), 1e-6);
    }
}

/* A slab of two faces: the gain by the index is gone, what is absorbed on the
 * way is the transmission per length to the power of its thickness. */
static const struct {
    const char *dielectric;
    double r, g, b; /* transmission per length */
} slab[] = {
    { "void dielectric m 0 0 5 .5 1 .25 1.5 0", .5, 1, .25 },
    { "void colorfunc p 4 .5 1 1 . 0 0 p dielectric m 0 0 5 1 1 .9 1.5 0", .5,
      1, .9 },
    { "void colorfunc p 4 1 .5 1 . 0 0 p dielectric m 0 0 5 1 1 .9 1.5 0", 1,
      .5, .9 },
    { "void colorfunc p 4 1 1 .5 . 0 0 p dielectric m 0 0 5 1 .9 1 1.5 0", 1,
      .9, .5 },
};

/* The slab's, for a transmittance t of its inside. */
static double
slab_passes(double t)
{
    double r = .04;

    return (1 - r) * (1 - r) * t / (1 - r * r * t * t);
}

LOOP_TEST(dielectric_slab_absorbs_by_length, N_ELEM(slab))
{
    char scene[1024];
    struct rad_rgb L;

    snprintf(scene, sizeof scene,
             BELOW "%s\n m" SQUARE
                   " m polygon b 0 0 12 -9 -9 -2 -9 9 -2 9 9 -2 9 -9 -2",
             slab[_i].dielectric);
    world_open(&w, scene, PLAIN " -lr 40");
    L = world_tilted(&w, 0);
    ck_assert_double_eq_tol(L.r, slab_passes(pow(slab[_i].r, 2)), 1e-6);
    ck_assert_double_eq_tol(L.g, slab_passes(pow(slab[_i].g, 2)), 1e-6);
    ck_assert_double_eq_tol(L.b, slab_passes(pow(slab[_i].b, 2)), 1e-6);
}

/* An interface of equal sides is not there, but for what it absorbs. */
TEST(interface_of_equal_indices_lets_all_pass)
{
    world_open(&w,
               BELOW "void interface m 0 0 8 1 1 1 1.4 1 1 .5 1.4\n m" SQUARE,
               PLAIN);
    ck_assert_double_eq_tol(world_tilted(&w, 60).r, 1, 1e-6);
    /* outside is the second medium: 2 units to the square at 60 degrees */
    ck_assert_double_eq_tol(
        world_see(&w, -2 * sin(1), 0, 2 * cos(1), sin(1), 0, -cos(1)).b, .25,
        1e-6);
}

/* A smooth surface: part that is reflected toward a white sky. */
static const struct {
    const char *material;
    double deg, r, g;
} mirror[] = {
    { "plastic m 0 0 5 0 0 0 .05 0", 0, .05, .05 },
    { "plastic m 0 0 5 0 0 0 .05 0", 60, .05 + .95 * .050782, .098243 },
    { "plastic m 0 0 5 0 0 0 .05 0", 85, .05 + .95 * .597699, .617814 },
    { "plastic m 0 0 5 0 0 0 .015 0", 85, .015, .015 }, /* too dull for it */
    { "plastic m 0 0 5 0 0 0 .05 .001", 85, .617814, .617814 },
    { "metal m 0 0 5 .5 .9 0 .8 0", 0, .4, .72 },
    { "metal m 0 0 5 .5 .9 0 .8 0", 60, .4 + .6 * .050782,
      .72 + .28 * .050782 },
    { "trans m 0 0 7 0 0 0 .05 0 .5 .5", 0, .05, .05 },
    { "glass m 0 0 4 1 1 1 .5", 45, 1, 1 }, /* totally, beyond 30 degrees */
};

LOOP_TEST(mirror_brightens_toward_grazing, N_ELEM(mirror))
{
    char text[512];

    snprintf(text, sizeof text, ABOVE "void %s m" SQUARE, mirror[_i].material);
    world_open(&w, text, PLAIN);
    ck_assert_double_eq_tol(world_tilted(&w, mirror[_i].deg).r, mirror[_i].r,
                            1e-5);
    ck_assert_double_eq_tol(world_tilted(&w, mirror[_i].deg).g, mirror[_i].g,
                            1e-5);
}

TEST(clear_trans_passes_its_specular_part)
{
    world_open(&w, BELOW "void trans m 0 0 7 .5 1 0 .01 0 .6 .7\n m" SQUARE,
               PLAIN);
    ck_assert_double_eq_tol(world_tilted(&w, 30).r, .5 * .99 * .6 * .7, 1e-6);
    ck_assert_double_eq_tol(world_tilted(&w, 30).g, .99 * .6 * .7, 1e-6);
}

/* Ambient light alone: each part of the material takes its share, gloss below
 * the threshold too. */
static const struct {
    const char *material, *options;
    double L;
} shares[] = {
    { "plastic m 0 0 5 .5 .5 .5 0 0", "-st 0", .5 },
    { "plastic m 0 0 5 .5 .5 .5 .1 .2", "-st 0", .5 * .9 },
    { "plastic m 0 0 5 .5 .5 .5 .1 .2", "-st .2", .5 * .9 + .1 },
    { "metal m 0 0 5 .5 .5 .5 .4 .2", "-st .5", .5 * .6 + .5 * .4 },
    { "trans m 0 0 7 .5 .5 .5 0 .1 .6 .5", "-st 0", .5 * .4 + .5 * .3 },
    { "trans m 0 0 7 .5 .5 .5 0 .1 .6 .5", "-st .4", .5 * .4 + .5 * .6 },
};

LOOP_TEST(ambient_light_is_shared_out, N_ELEM(shares))
{
    char text[512], options[64];

    snprintf(text, sizeof text, "void %s m" SQUARE, shares[_i].material);
    snprintf(options, sizeof options, "-av 1 1 1 %s", shares[_i].options);
    world_open(&w, text, options);
    ck_assert_double_eq_tol(world_tilted(&w, 20).r, shares[_i].L, 1e-6);
}

static const struct {
    const char *material;
    double deg, diffuse, tol; /* tol: of the spiral's sum over the lobe */
} gloss[] = {
    { "plastic m 0 0 5 .5 .5 .5 .2 .3", 0, .4, .004 },
    { "plastic m 0 0 5 .5 .5 .5 .2 .3", 45, .4, .004 },
    { "plastic m 0 0 5 .5 .5 .5 .2 .3", 75, .4, .004 },
    { "plastic m 0 0 5 .5 .5 .5 .5 .15", 30, .25, .008 },
    { "plastic m 0 0 5 0 0 0 1 .5", 80, 0, .01 },
    { "metal m 0 0 5 .8 .8 .8 .9 .2", 0, .08, .008 },
    { "metal m 0 0 5 .8 .8 .8 .9 .2", 60, .08, .008 },
};

/* The light of many suns by rad_direct() is the integral of the BRDF; a white
 * sky by sampled rays is the lobe's albedo. */
LOOP_TEST(gloss_drawn_in_samples_is_the_integral_of_the_brdf, N_ELEM(gloss))
{
    static char text[400000];
    double direct, sampled;

    snprintf(text, sizeof text, "void %s m" SQUARE, gloss[_i].material);
    add_suns(text, sizeof text, 1);
    world_open(&w, text, "-av 0 0 0 -st 1 -dj 0 -dt 0");
    direct = world_tilted(&w, gloss[_i].deg).r;
    snprintf(text, sizeof text, ABOVE "void %s m" SQUARE, gloss[_i].material);
    world_open(&w, text, PLAIN " -ss 9000");
    sampled = world_tilted(&w, gloss[_i].deg).r;
    ck_assert_double_le(direct, 1 + gloss[_i].tol);
    ck_assert_double_gt(sampled, 0);
    ck_assert_double_eq_tol(direct, gloss[_i].diffuse + sampled, gloss[_i].tol);
}

/* One sample, and the one that -ss 0 sends the mirror's way, weigh in full. */
LOOP_TEST(single_gloss_sample_has_the_weight_of_the_lobe, 2)
{
    world_open(&w, ABOVE "void plastic m 0 0 5 0 0 0 .2 .3\n m" SQUARE,
               _i ? PLAIN " -ss 1" : PLAIN);
    for (int deg = 0; deg < 60; deg += 10)
        ck_assert_double_eq_tol(world_tilted(&w, deg).r, .2, 1e-6);
}

/* Share of the facets drawn (Ward's distribution, those that reflect below the
 * surface left out) that reflect to within half the angle `cone` of dir, by the
 * midpoint rule. */
static double
lobe_share(double alpha, const double in[3], const double dir[3], double cone)
{
    enum { N = 1000 };
    double all = 0, inside = 0;

    for (int i = 0; i < N * N; i++) {
        double t = alpha * sqrt(-log((i / N + .5) / N)), s[3], c;
        double phi = 2 * M_PI * (i % N + .5) / N;
        double h[3] = { t * cos(phi), t * sin(phi), 1 };

        c = -2 * rad_dot(h, in) / (1 + t * t);
        rad_madd(s, in, c, h);
        all += s[2] > 0;
        inside += s[2] > 0 && rad_dot(s, dir) > cos(cone * M_PI / 360);
    }
    return inside / all;
}

/* Single samples, one a ray: where the lobe is cut off by the surface the
 * trials that replace failed ones must not lean anywhere.  Four standard errors
 * of 200000 draws are .0045. */
static const struct {
    double deg, alpha, cone;
} lobe[] = { { 10, .2, 30 }, { 45, .3, 40 }, { 75, .4, 60 }, { 85, .3, 20 } };

LOOP_TEST(single_gloss_samples_fill_the_lobe, N_ELEM(lobe))
{
    enum { N = 200000 };
    double a = lobe[_i].deg * M_PI / 180;
    double in[3] = { sin(a), 0, -cos(a) }, dir[3] = { sin(a), 0, cos(a) };
    char text[512];
    struct rad_ray r;
    int hits = 0;

    snprintf(text, sizeof text,
             "void glow g 0 0 4 1 1 1 0 g source s 0 0 4 %.12g 0 %.12g %g\n"
             "void plastic m 0 0 5 0 0 0 .9 %g m" SQUARE,
             dir[0], dir[2], lobe[_i].cone, lobe[_i].alpha);
    world_open(&w, text, PLAIN " -ss 1");
    for (int i = 0; i < N; i++) {
        world_ray(&w, &r, -in[0], 0, -in[2], in[0], 0, in[2]);
        r.key = rad_key_pixel(1, 0, (uint32_t)i, 0);
        rad_ray_trace(&w.ctx, &r);
        hits += r.L.r > 0;
    }
    ck_assert_double_eq_tol((double)hits / N,
                            lobe_share(lobe[_i].alpha, in, dir, lobe[_i].cone),
                            .0045);
}

TEST(rough_trans_keeps_its_energy)
{
    static char text[800000];
    double direct, sampled;

    snprintf(text, sizeof text,
             "void trans m 0 0 7 1 1 1 .1 .25 .8 .5\n m" SQUARE);
    add_suns(text, sizeof text, -1);
    world_open(&w, text, "-av 0 0 0 -st 1 -dj 0 -dt 0");
    direct = world_tilted(&w, 0).r;
    world_open(&w, BELOW "void trans m 0 0 7 1 1 1 .1 .25 .8 .5\n m" SQUARE,
               PLAIN " -ss 5000");
    sampled = world_tilted(&w, 0).r;
    ck_assert_double_eq_tol(sampled, .9 * .8 * .5, 1e-5);
    /* Ward's transmitted lobe is normalized for small roughness only */
    ck_assert_double_eq_tol(direct, .9 * .8, .03);
}

/* What rays of each path see of emitters.  The square faces up; from below its
 * back is seen, and a grey sky through it where it is not there. */
#define GREY_BELOW                                                             \
    "void glow grey 0 0 4 .25 .25 .25 0 grey source sky 0 0 4 0 0 -1 180\n"    \
    "void glow dim 0 0 4 .5 .5 .5 0 dim source sky 0 0 4 0 0 1 180\n"          \
    "void plastic mirror 0 0 5 0 0 0 1 0\n"

enum { AMB = RAD_RAY_RAMBIENT, SPEC = RAD_RAY_RSPECULAR };

static const struct {
    const char *material, *options;
    double z; /* where the ray comes from: the front if positive */
    unsigned path;
    double L;
} emitter[] = {
    { "light m 0 0 3 2 2 2", "", 1, 0, 2 },
    { "light m 0 0 3 2 2 2", "", -1, 0, 0 },
    { "light m 0 0 3 2 2 2", "-bv-", -1, 0, .5 },
    { "light m 0 0 3 2 2 2", "-dv-", 1, 0, 0 },
    { "light m 0 0 3 2 2 2", "", 1, RAD_RAY_REFLECTED, 2 },
    { "light m 0 0 3 2 2 2", "", 1, AMB, 0 },
    { "light m 0 0 3 2 2 2", "", 1, SPEC, 0 },
    { "light m 0 0 3 2 2 2", "", 1, AMB | RAD_RAY_TRANS, 0 },
    /* the hit is one unit away */
    { "glow m 0 0 4 2 2 2 0", "", 1, AMB, 2 },
    { "glow m 0 0 4 2 2 2 .9", "", 1, AMB, 2 },
    { "glow m 0 0 4 2 2 2 1.1", "", 1, AMB, 0 },
    { "glow m 0 0 4 2 2 2 -1", "", 1, AMB, 0 },
    { "glow m 0 0 4 2 2 2 -1", "", 1, 0, 2 },
    { "glow m 0 0 4 2 2 2 .9", "-dv-", 1, 0, 2 },
    { "glow m 0 0 4 2 2 2 1.1", "-dv-", 1, 0, 0 },
    { "glow m 0 0 4 2 2 2 -1", "-dv-", 1, 0, 0 },
    { "illum m 0 0 3 2 2 2", "", 1, 0, .25 },
    { "illum m 1 void 0 3 2 2 2", "", 1, 0, .25 },
    { "illum m 1 mirror 0 3 2 2 2", "", 1, 0, .5 },
    { "illum m 1 mirror 0 3 2 2 2", "", 1, AMB, 0 },
    { "illum m 1 mirror 0 3 2 2 2", "", 1, SPEC, 0 },
    { "spotlight m 0 0 7 2 2 2 40 0 0 1", "", 1, 0, 2 },
    { "spotlight m 0 0 7 2 2 2 40 1 0 1", "", 1, 0, 0 },
    { "spotlight m 0 0 7 2 2 2 100 1 0 1", "", 1, 0, 2 },
};

LOOP_TEST(emitter_shows_each_ray_what_it_may_count, N_ELEM(emitter))
{
    char text[1024];
    struct rad_ray r;

    snprintf(text, sizeof text, GREY_BELOW "void %s m" SQUARE,
             emitter[_i].material);
    world_open(&w, text, emitter[_i].options);
    world_ray(&w, &r, 0, 0, emitter[_i].z, 0, 0, -emitter[_i].z);
    r.path |= (uint16_t)emitter[_i].path;
    rad_ray_trace(&w.ctx, &r);
    ck_assert_double_eq_tol(r.L.g, emitter[_i].L, 1e-6);
}

/* A surface in the sun, with something between them. */
LOOP_TEST(shadow_ray_is_dimmed_by_glass_and_trans, 5)
{
    static const char sun[] =
        "void light sun 0 0 3 1e6 1e6 1e6 sun source s 0 0 4 0 0 1 .5\n"
        "void plastic m 0 0 5 .5 .5 .5 0 0 m" SQUARE;
    static const char *const pane[] = {
        "void glass g 0 0 3 .96 .96 .96 g",
        "void trans g 0 0 7 .8 .8 .8 0 0 .5 .5 g",
        "void plastic g 0 0 5 .8 .8 .8 0 0 g",
        "void",
        "void illum g 0 0 3 1 1 1 g",
    };
    /* of the sun, at normal incidence on the pane */
    static const double share[] = { .8815, .8 * .25, 0, 1, 1 };
    struct world open = { 0 }, shut = { 0 };
    char text[1024];

    world_open(&open, sun, PLAIN);
    snprintf(text, sizeof text,
             "%s %s polygon p 0 0 12 -9 -9 2 9 -9 2 9 9 2 -9 9 2", sun,
             pane[_i]);
    world_open(&shut, text, PLAIN);
    ck_assert_double_gt(world_tilted(&open, 20).r, 1);
    ck_assert_double_eq_tol(
        world_tilted(&shut, 20).r / world_tilted(&open, 20).r, share[_i], 1e-4);
    world_close(&open);
    world_close(&shut);
}

#define GLASS_R 0.042579994960 /* ((1.52 - 1) / (1.52 + 1))^2 */

/* E = L omega cos. */
TEST(irradiance_of_a_sun_follows_the_cosine)
{
    static const char sun[] =
        "void light sun 0 0 3 1e4 1e4 1e4 sun source s 0 0 4 0 0 1 .5\n"
        "void glass g 0 0 3 1 1 1 g polygon p 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 "
        "9 0 void metal m 0 0 5 .1 .1 .1 .9 0\n"
        "m polygon q 0 0 12 -9 -9 -2 9 -9 -2 9 9 -2 -9 9 -2";
    double E = 1e4 * 2 * M_PI * (1 - cos(.25 * M_PI / 180));
    double p[3] = { 0, 0, 5 };
    struct rad_ray r;

    world_open(&w, sun, PLAIN);
    for (double a = 0; a < 1.5; a += .25) {
        double n[3] = { sin(a), 0, cos(a) };

        rad_ray_irradiance(&w.ctx, &r, p, n, 1);
        ck_assert_double_eq_tol(r.L.r, E * cos(a), 1e-4 * E);
    }
    /* -i: what the eye sees through the pane, whatever its material */
    world_open(&w, sun, PLAIN " -i+");
    ck_assert_double_eq_tol(world_see(&w, 0, 0, 1, 0, 0, -1).r,
                            E * (1 - GLASS_R) / (1 + GLASS_R), 1e-4 * E);
}

static struct world_file texts[] = {
    { "box.fnt", "65 4 50 50 200 50 200 200 50 200 32 0" },
    { "two.txt", "A\n A" },
    { 0 }
};
static const struct rad_files files = { .read = world_file_read, .arg = texts };

/* Cells are 1 by 1, the anchor is the origin, lines go toward -y; a box covers
 * 50/255 to 200/255 of its cell. */
static const struct {
    const char *text;
    double x, y;
    bool fore;
} cell[] = {
    { "3 box.fnt . A_A", .5, -.5, true },
    { "3 box.fnt . A_A", .1, -.5, false },
    { "3 box.fnt . A_A", .5, -.1, false },
    { "3 box.fnt . A_A", 1.5, -.5, true },  /* '_' has no glyph, no room */
    { "4 box.fnt . A A", 1.5, -.5, false }, /* a space has */
    { "4 box.fnt . A A", 2.5, -.5, true },
    { "4 box.fnt . A A", 3.5, -.5, false },
    { "4 box.fnt . A A", -.5, -.5, false },
    { "4 box.fnt . A A", .5, .5, false },
    { "4 box.fnt . A A", .5, -1.5, false },
    { "2 box.fnt two.txt", .5, -.5, true },
    { "2 box.fnt two.txt", .5, -1.5, false },
    { "2 box.fnt two.txt", 1.5, -1.5, true },
};

LOOP_TEST(text_colours_its_cells, N_ELEM(cell))
{
    char text[1024];

    snprintf(text, sizeof text,
             "void colortext t %s 0 15 0 0 0 1 0 0 0 -1 0 .1 .2 .3 .4 .5 .6\n"
             "t plastic m 0 0 5 .5 .5 .5 0 0 m" SQUARE,
             cell[_i].text);
    ck_assert_int_eq(world_try(&w, text, "-av 1 1 1", &files), 0);
    ck_assert_double_eq_tol(
        world_see(&w, cell[_i].x, cell[_i].y, 3, 0, 0, -1).b,
        .5 * (cell[_i].fore ? .3 : .6), 1e-6);
}

static const struct {
    const char *text, *message;
} bad[] = {
    { "void plastic a 0 0 5 1 1 1 0 0 a plastic b 0 0 5 1 1 1 0 0 b" SQUARE,
      "another material, 'a'" },
    { "void illum a 1 nowhere 0 3 1 1 1 a" SQUARE,
      "undefined modifier 'nowhere'" },
    { "void brighttext t 2 none.fnt none.txt 0 11 0 0 0 1 0 0 0 1 0 1 1 "
      "t plastic a 0 0 5 1 1 1 0 0 a" SQUARE,
      "no file 'none.fnt'" },
    { "void brighttext t 2 box.fnt none.txt 0 11 0 0 0 1 0 0 0 1 0 1 1 "
      "t plastic a 0 0 5 1 1 1 0 0 a" SQUARE,
      "no file 'none.txt'" },
    { "void brighttext t 2 box.fnt two.txt 0 11 0 0 0 1 0 0 2 0 0 1 1 "
      "t plastic a 0 0 5 1 1 1 0 0 a" SQUARE,
      "parallel" },
    { "void spotlight a 0 0 7 1 1 1 0 0 0 1 a" SQUARE, "spotlight" },
    { "void glass a 0 0 4 1 1 1 0 a" SQUARE, "index" },
};

LOOP_TEST(bad_material_is_refused_by_name, N_ELEM(bad))
{
    world_refused(bad[_i].text, "", &files, bad[_i].message);
}

TEST(missing_font_is_told_with_the_scenes_line)
{
    ck_assert_int_eq(
        world_try(&w,
                  "\n\nvoid brighttext t 3 none.fnt . A 0 11 0 0 0 "
                  "1 0 0 0 1 0 1 1\nt light m 0 0 3 1 1 1 m" SQUARE,
                  "", &files),
        RAD_ENOINPUT);
    ck_assert_str_eq(w.err.where, "test.rad:3");
    ck_assert_str_eq(w.err.what, "brighttext 't': no file 'none.fnt'");
}

TEST(modifier_that_nothing_uses_needs_no_file_and_no_support)
{
    ck_assert_int_eq(
        world_try(
            &w,
            "void brighttext t 3 none.fnt . A 0 11 0 0 0 1 0 0 0 1 0 1 1\n"
            "t plastic unused 0 0 5 .5 .5 .5 0 0\n"
            "void specfile dye 1 x.spc 0 0\n"
            "void plastic m 0 0 5 .5 .5 .5 0 0 m" SQUARE,
            "-av 1 1 1", &files),
        0);
    ck_assert_double_eq_tol(world_tilted(&w, 0).r, .5, 1e-6);
}

/* An alias is its target, with its own pattern in front of nothing else. */
TEST(alias_takes_the_target_and_its_own_modifier)
{
    ck_assert_int_eq(
        world_try(&w,
                  "void plastic red 0 0 5 .5 0 0 0 0\n"
                  "void brighttext t 3 box.fnt . A 0 11 0 0 0 1 0 0 0 -1 0 "
                  "2 1\n t alias tred red tred" SQUARE,
                  "-av 1 1 1", &files),
        0);
    ck_assert_double_eq_tol(world_see(&w, .5, -.5, 3, 0, 0, -1).r, 1, 1e-6);
    ck_assert_double_eq_tol(world_see(&w, 2.5, -.5, 3, 0, 0, -1).r, .5, 1e-6);
}

static const struct {
    const char *pane;
    bool dim;
} panes[] = {
    { "void trans p 0 0 7 .1 .1 .1 0 0 1 .9\n", true },
    { "void trans p 0 0 7 .9 .9 .9 0 0 1 .9\n", false },
    { "void glass p 0 0 3 .05 .05 .05\n", true },
    { "void glass p 0 0 3 1 1 1\n", false },
    { "void prism1 p 5 .1 Dx Dy Dz . 0 0\n", true },
    { "void prism1 p 5 1 Dx Dy Dz . 0 0\n", false },
    { "void BRTDfunc p 10 0 0 0 .1 .1 .1 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0\n",
      true },
    { "void WGMDfunc p 13 void 0 0 0 void .1 0 0 void 0 0 1 . 0 9 0 0 0 0 0 "
      "0 0 0 0\n",
      true },
};

/* A ray meets a pane, sqrt 2 on a pane of glass and after as much again a wall
 * of radiance 1; the glass mirrors a ball of radiance 3, by .2 of the 1.2
 * that it shows.  Behind a dim pane the ball's distance counts.  (rpict's rule,
 * by its source and rtrace -ol.) */
LOOP_TEST(behind_a_dim_pane_the_mirrored_is_far, N_ELEM(panes))
{
    static const char *rest =
        "p polygon pane 0 0 12 -.1 -.1 1 .1 -.1 1 .1 .1 1 -.1 .1 1\n"
        "void glass g 0 0 3 1 1 1\n"
        "g polygon glass 0 0 12 0 -1 0 2 -1 0 2 1 0 0 1 0\n"
        "void glow w 0 0 4 1 1 1 0\n"
        "w polygon wall 0 0 12 -9 -9 -1 9 -9 -1 9 9 -1 -9 9 -1\n"
        "void glow m 0 0 4 3 3 3 0\n"
        "m sphere ball 0 0 4 3 0 2 .5\n";
    struct rad_ray r;
    char scene[1024];

    snprintf(scene, sizeof scene, "%s%s", panes[_i].pane, rest);
    world_open(&w, scene, "-ab 0 -dr 0");
    world_ray(&w, &r, -1, 0, 2, 1, 0, -1);
    rad_ray_trace(&w.ctx, &r);
    ck_assert_double_eq_tol(rad_ray_distance(&r),
                            panes[_i].dim ? 4 * sqrt(2) - .5 : 3 * sqrt(2),
                            1e-9);
}
