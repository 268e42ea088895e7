/* check_ray.c - tests of src/trace/ray.c: what starts a ray and ends it */
#include "config.h"

#include "tests/world_fixture.h"
#include "base/rng.h"

#include <stdio.h>
#include <stdlib.h>

FIXTURE(NULL, world_tear_down)

#define SKY    "void glow white 0 0 4 1 1 1 0 white source sky 0 0 4 0 0 1 360\n"
#define SQUARE " polygon s 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"

/* A parent that has met something one unit away. */
static void
met(struct rad_ray *r, float weight, int level)
{
    world_ray(&w, r, 0, 0, 1, 0, 0, -1);
    rad_ray_clear(r);
    r->hit.t = 1;
    r->hit.obj = 0;
    r->weight = weight;
    r->level = (int16_t)level;
}

static const struct {
    const char *options;
    enum rad_raykind kind;
    float weight, coef;
    int level;
    bool lives;
} limit[] = {
    { "-lw .1 -lr 3", RAD_RAY_REFLECTED, 1, .2f, 0, true },
    { "-lw .1 -lr 3", RAD_RAY_REFLECTED, .4f, .2f, 0, false }, /* weight */
    { "-lw .1 -lr 3", RAD_RAY_REFLECTED, 1, .2f, 2, true },
    { "-lw .1 -lr 3", RAD_RAY_REFLECTED, 1, .2f, 3, false }, /* level */
    { "-lw .1 -lr 3", RAD_RAY_REFRACTED, 1, .2f, 3, true },  /* none */
    { "-lw .1 -lr 3", RAD_RAY_TRANS, 1, .2f, 3, true },
    { "-lw .1 -lr 3", RAD_RAY_RSHADOW, .1f, .1f, 9, true }, /* goes through */
    { "-lw .1 -lr 3", RAD_RAY_REFLECTED, 1, 0, 0, false },
    { "-lw .1 -lr -3", RAD_RAY_REFLECTED, 1, .2f, 3, false },
    { "-lw .1 -lr -3", RAD_RAY_REFLECTED, 1, .2f, 2, true },
    { "-lw .1 -lr 0", RAD_RAY_REFLECTED, 1, .2f, 500, true },
};

LOOP_TEST(limits_end_rays, N_ELEM(limit))
{
    struct rad_rgb coef = rad_rgb(0, limit[_i].coef, limit[_i].coef / 2);
    struct rad_ray parent, r;

    world_open(&w, SKY, limit[_i].options);
    met(&parent, limit[_i].weight, limit[_i].level);
    ck_assert_int_eq(
        rad_ray_spawn(&w.ctx, &r, limit[_i].kind, &parent, &coef, 1),
        limit[_i].lives);
    if (limit[_i].lives) {
        ck_assert_float_eq_tol(r.weight, limit[_i].weight * limit[_i].coef,
                               1e-6);
        ck_assert_int_eq(r.level,
                         limit[_i].level + !!(limit[_i].kind & RAD_RAY_REFL));
    }
}

enum { BRANCHES = 100000 };

/* Spawn so many branches of a tree that has so many rays, with that coefficient
 * in red and half of it in green; those that live have that weight.  Returns
 * the share that lives, and *mean: of the coefficient, 0 where a branch dies.
 */
static double
share_alive(uint32_t tree, float coef, float weight, double *mean)
{
    struct rad_rgb both = rad_rgb(coef, coef / 2, 0);
    struct rad_ray parent, r;
    int lived = 0;

    met(&parent, 1, 0);
    w.ctx.tree = tree;
    *mean = 0;
    for (int i = 0; i < BRANCHES; i++) {
        parent.key = rad_key_pixel(0, 0, (uint32_t)i, 0);
        if (!rad_ray_spawn(&w.ctx, &r, RAD_RAY_REFLECTED, &parent, &both, 1))
            continue;
        lived++;
        *mean += (double)r.coef.r / BRANCHES;
        ck_assert_float_eq_tol(r.coef.g, r.coef.r / 2, 1e-6);
        ck_assert_float_eq_tol(r.weight, weight, 1e-6);
    }
    return (double)lived / BRANCHES;
}

/* What dies and what is raised for it must balance: the mean coefficient is
 * what it was.  100000 draws: four standard errors are 1.2 %. */
TEST(roulette_keeps_the_mean)
{
    double mean;

    world_open(&w, SKY, "-lw .3 -lr -8");
    ck_assert_double_eq_tol(share_alive(1, .06f, .3f, &mean), .2, .012);
    ck_assert_double_eq_tol(mean, .06, .012 * .06 * 2);
}

/* The same of a branch of a tree that is four times as large as it may be. */
TEST(roulette_of_a_large_tree_keeps_the_mean)
{
    double mean;

    world_open(&w, SKY, "-lw 0 -lr 7");
    ck_assert_double_eq_tol(share_alive(4 * RAD_MAX_TREE, .6f, .6f, &mean), .25,
                            .0055);
    ck_assert_double_eq_tol(mean, .6, .022 * .6);
}

TEST(aft_plane_hides_what_lies_beyond)
{
    struct rad_ray r;

    /* a void surface and a pane on the way do not move the plane */
    world_open(&w,
               SKY "void polygon v 0 0 12 -9 -9 5 9 -9 5 9 9 5 -9 9 5\n"
                   "void glow m 0 0 4 3 3 3 0 m" SQUARE,
               "");
    world_ray(&w, &r, 0, 0, 10, 0, 0, -1);
    r.tmax = 10.5;
    rad_ray_trace(&w.ctx, &r);
    ck_assert_double_eq_tol(r.L.r, 3, 1e-6);
    world_ray(&w, &r, 0, 0, 10, 0, 0, -1);
    r.tmax = 9.5;
    rad_ray_trace(&w.ctx, &r);
    ck_assert_double_eq(r.L.r, 0);
    world_ray(&w, &r, 0, 0, 10, 0, 0, 1);
    r.tmax = 1e6;
    rad_ray_trace(&w.ctx, &r);
    ck_assert_double_eq(r.L.r, 0);
}

/* Distances that -z gives: through a pane, in a mirror, nothing. */
static const struct {
    const char *material;
    double dist;
} depth[] = {
    { "plastic m 0 0 5 .5 .5 .5 0 0", 2 },
    { "glass m 0 0 3 .9 .9 .9", 5 },
    { "trans m 0 0 7 1 1 1 0 0 1 1", 5 },
    { "trans m 0 0 7 1 1 1 0 0 .9 .8", 5 },
    { "trans m 0 0 7 1 1 1 0 0 .9 .1", 2 },
    { "metal m 0 0 5 .9 .9 .9 1 0", 2 }, /* a mirror is seen, not its image */
    { "metal n 0 0 5 .9 .9 .9 1 0 void plastic k 0 0 5 0 0 0 0 0 "
      "void mixfunc m 4 k n .2 . 0 0",
      2 },
    { "metal n 0 0 5 .9 .9 .9 1 0 void plastic k 0 0 5 0 0 0 0 0 "
      "void mixfunc m 4 n k 1 . 0 0",
      2 },
    { "glass n 0 0 3 .9 .9 .9 void plastic k 0 0 5 .5 .5 .5 0 0 "
      "void mixfunc m 4 k n .9 . 0 0", /* the brighter part's */
      2 },
    { "glass n 0 0 3 .9 .9 .9 void plastic k 0 0 5 .5 .5 .5 0 0 "
      "void mixfunc m 4 k n .1 . 0 0",
      5 },
    { "dielectric m 0 0 5 1 1 1 1.5 0", 5 },
    { "illum m 0 0 3 1 1 1", 5 },
};

LOOP_TEST(distance_is_of_what_is_seen, N_ELEM(depth))
{
    char text[1024];
    struct rad_ray r;

    snprintf(text, sizeof text,
             SKY "void plastic g 0 0 5 .5 .5 .5 0 0 g polygon q 0 0 12 -9 -9 "
                 "-3 9 -9 -3 9 9 -3 -9 9 -3 void %s m" SQUARE,
             depth[_i].material);
    world_open(&w, text, "-av 1 1 1");
    world_ray(&w, &r, 0, 0, 2, 0, 0, -1);
    rad_ray_trace(&w.ctx, &r);
    ck_assert_double_eq_tol(rad_ray_distance(&r), depth[_i].dist, 1e-9);
    world_ray(&w, &r, 0, 0, 2, 0, 0, 1);
    rad_ray_trace(&w.ctx, &r);
    ck_assert_double_eq(rad_ray_distance(&r), 1e10);
}

/* Of a lens the distance is that of its surface, unless it bends no ray. */
LOOP_TEST(distance_of_a_lens_is_its_own, 3)
{
    static const double index[] = { 1.5, 1, .8 }, dist[] = { 2, 6, 2 };
    char text[512];
    struct rad_ray r;

    snprintf(text, sizeof text,
             "void plastic g 0 0 5 .5 .5 .5 0 0 g polygon q 0 0 12 -9 -9 "
             "-3 9 -9 -3 9 9 -3 -9 9 -3 void dielectric m 0 0 5 1 1 1 %g 0 "
             "m sphere s 0 0 4 0 0 0 1\n",
             index[_i]);
    world_open(&w, text, "-av 1 1 1");
    world_ray(&w, &r, 0, 0, 3, 0, 0, -1);
    rad_ray_trace(&w.ctx, &r);
    ck_assert_double_eq_tol(rad_ray_distance(&r), dist[_i], 1e-9);
}

/* n square sheets of material m, one above the other. */
static char *
sheets(const char *material, int n)
{
    size_t size = 300 + 100 * (size_t)n, at;
    char *text = malloc(size);

    ck_assert_ptr_nonnull(text);
    at = (size_t)snprintf(text, size, SKY "%s\n", material);
    for (int i = 0; i < n; i++)
        at += (size_t)snprintf(
            text + at, size - at,
            "m polygon s%d 0 0 12 -1 -1 -%d 1 -1 -%d 1 1 -%d -1 1 -%d\n", i, i,
            i, i, i);
    return text;
}

LOOP_TEST(many_layers_pass_and_endless_ones_end, 3)
{
    static const int n[] = { 100, RAD_MAX_DEPTH - 10, 20000 };
    char *text = sheets("void illum m 0 0 3 0 0 0", n[_i]);

    world_open(&w, text, "-lw 0");
    ck_assert_double_eq_tol(world_see(&w, 0, 0, 1, 0, 0, -1).r,
                            n[_i] < RAD_MAX_DEPTH, 1e-6);
    free(text);
}

/* Two facing mirrors that lose nothing: only the limits end it. */
TEST(perfect_mirrors_end)
{
    world_open(&w,
               "void metal m 0 0 5 1 1 1 1 0 m" SQUARE
               "m polygon t 0 0 12 -9 -9 2 -9 9 2 9 9 2 9 -9 2",
               "-lw 0 -lr 30000");
    ck_assert_double_eq(world_see(&w, 0, 0, 1, 0, 0, -1).r, 0);
    ck_assert_uint_eq(w.ctx.counts.rays, RAD_MAX_DEPTH + 1);
}

/* Surfaces that make light, between mirrors that do: neither weight nor, with
 * these options, depth ends the tree. */
static const struct {
    const char *material, *options;
} endless[] = {
    { "void prism2 m 9 1.2 0 0 1 1.2 0 0 -1 . 0 0", "-lr 7" },
    { "void glass m 0 0 3 1.5 1.5 1.5", "-lr 60 -lw 0" },
    { "void trans m 0 0 7 1.3 1.3 1.3 .4 0 .9 .9", "-lr 0 -lw .01" },
    { "void BRTDfunc m 10 .9 .9 .9 .9 .9 .9 0 0 0 . 0 9 1 1 1 1 1 1 .5 .5 .5",
      "-lr -60 -lw .01" },
};

LOOP_TEST(trees_of_surfaces_that_make_light_end, N_ELEM(endless))
{
    char material[300], *text;

    snprintf(material, sizeof material,
             "void metal e 0 0 5 1.1 1.1 1.1 1 0\n"
             "e polygon a 0 0 12 -9 -9 2 -9 9 2 9 9 2 9 -9 2\n"
             "e polygon b 0 0 12 -9 -9 -8 9 -9 -8 9 9 -8 -9 9 -8\n%s",
             endless[_i].material);
    text = sheets(material, 8);
    world_open(&w, text, endless[_i].options);
    free(text);
    world_see(&w, 0, 0, 1, 0, 0, -1);
    ck_assert_uint_gt(w.ctx.counts.rays, RAD_MAX_TREE);
    ck_assert_uint_lt(w.ctx.counts.rays, 4 * RAD_MAX_TREE);
}

/* Those of hemispheres have a smaller bound, for there are many. */
TEST(trees_of_hemispheres_that_make_light_end_sooner)
{
    double p[3] = { 0, 0, 1 }, n[3] = { 0, 0, -1 };
    struct rad_ray r;

    world_open(&w,
               "void metal e 0 0 5 1.1 1.1 1.1 1 0\n"
               "e bubble far 0 0 4 0 0 0 9\n"
               "void BRTDfunc m 10 .9 .9 .9 .9 .9 .9 0 0 0 . 0 9 "
               "1 1 1 1 1 1 .5 .5 .5 m" SQUARE,
               "-lr 0 -lw .01 -ab 1 -ad 32 -as 0");
    rad_ray_irradiance(&w.ctx, &r, p, n, 1);
    ck_assert_uint_gt(w.ctx.counts.rays, RAD_MAX_TREE);
    ck_assert_uint_lt(w.ctx.counts.rays, 36 * 4 * RAD_MAX_WALK);
}

/* An infinite radiance is black, a negative channel cut off; both count. */
static const struct {
    const char *text;
    struct rad_rgb L;
} unsound[] = {
    { "void light m 0 0 3 1e39 1 1 m", { 0, 0, 0 } },
    { "void brighttext t 3 f . A 0 11 0 0 0 1 0 0 0 1 0 -1 -1\n"
      "t light m 0 0 3 1 1 1 m",
      { 0, 0, 0 } },
    { "void colortext t 3 f . A 0 15 0 0 0 1 0 0 0 1 0 -1 2 3 -1 2 3\n"
      "t light m 0 0 3 1 1 1 m",
      { 0, 2, 3 } },
    { "void colortext t 3 f . A 0 15 0 0 0 1 0 0 0 1 0 -1 2 3 -1 2 3\n"
      "t light m 0 0 3 1 1e39 1 m",
      { 0, 0, 0 } },
};

static unsigned char *
empty_font(void *arg, const char *name, size_t *len, struct rad_error *err)
{
    (void)arg;
    (void)name;
    (void)err;
    *len = 0;
    return calloc(1, 1);
}

LOOP_TEST(unsound_radiance_is_cut_off_and_counted, N_ELEM(unsound))
{
    static const struct rad_files files = { .read = empty_font, .arg = NULL };
    char text[512];
    struct rad_rgb c;

    snprintf(text, sizeof text, "%s" SQUARE, unsound[_i].text);
    ck_assert_int_eq(world_try(&w, text, "", &files), 0);
    c = world_see(&w, 0, 0, 1, 0, 0, -1);
    ck_assert(c.r == unsound[_i].L.r && c.g == unsound[_i].L.g &&
              c.b == unsound[_i].L.b);
    ck_assert_uint_eq(w.ctx.counts.unsound_rays, 1);
}

/* What is negative takes from the light that another surface sends as well;
 * only of what the eye gets it is cut off. */
TEST(negative_radiance_darkens_what_reflects_it)
{
    static const struct rad_files files = { .read = empty_font, .arg = NULL };
    static const char above[] =
        "void colortext t 3 f . A 0 15 0 0 0 1 0 0 0 1 0 -1 2 3 -1 2 3\n"
        "t glow up 0 0 4 1 1 1 -1\n"
        "up polygon u 0 0 12 -9 -9 2 -9 9 2 9 9 2 9 -9 2\n";
    char text[512];
    struct rad_rgb c;

    snprintf(text, sizeof text, "%svoid metal m 0 0 5 .5 .5 .5 .5 0 m%s", above,
             SQUARE);
    ck_assert_int_eq(world_try(&w, text, "-av 2 2 2", &files), 0);
    c = world_see(&w, 0, 0, 1, 0, 0, -1);
    ck_assert_float_eq_tol(c.r, .5f - .25f, 1e-6f);
    ck_assert_float_eq_tol(c.g, .5f + .5f, 1e-6f);
    ck_assert_uint_eq(w.ctx.counts.unsound_rays, 0);
    c = world_see(&w, 0, 0, 1, 0, 0, 1);
    ck_assert_float_eq(c.r, 0);
    ck_assert_uint_eq(w.ctx.counts.unsound_rays, 1);
}

/* Light that goes through what makes one channel negative still has the others,
 * though the eye finds it dark. */
TEST(negative_shadow_keeps_other_channels)
{
    static const struct rad_files files = { .read = empty_font, .arg = NULL };
    char text[512];
    struct rad_rgb c;

    snprintf(text, sizeof text,
             "void light l 0 0 3 100 100 100 l sphere s 0 0 4 0 0 3 .1\n"
             "void colortext t 3 f . A 0 15 0 0 0 1 0 0 0 1 0 .7 -.4 .5 .7 -.4 "
             ".5\n"
             "t glass pane 0 0 3 1 1 1\n"
             "pane polygon p 0 0 12 -9 -9 2 9 -9 2 9 9 2 -9 9 2\n"
             "void plastic m 0 0 5 .5 .5 .5 0 0 m%s",
             SQUARE);
    ck_assert_int_eq(world_try(&w, text, "", &files), 0);
    c = world_see(&w, 0, 0, 1, 0, 0, -1);
    ck_assert_float_gt(c.r, .01f);
    ck_assert_float_eq(c.g, 0);
    ck_assert_float_eq_tol(c.b, c.r * .5f / .7f, 1e-4f * c.r);
}

/* A pixel is a function: whatever was traced before, and in which context. */
TEST(ray_does_not_depend_on_those_before_it)
{
    static const char text[] =
        SKY "void metal m 0 0 5 .9 .8 .7 .8 .3 m" SQUARE
            "void light l 0 0 3 9 9 9 l sphere s 0 0 4 1 1 3 .2\n"
            "void glass g 0 0 3 .9 .9 .9 g sphere s 0 0 4 0 0 2 .4\n";
    struct rad_rgb first[50], again;
    struct rad_ctx fresh;
    struct rad_ray r;
    int differ = 0;

    world_open(&w, text, "-ss 3 -lr -4 -lw .2 -dj .8");
    for (int i = 0; i < 50; i++) {
        world_ray(&w, &r, 0, -1, 3, .01 * i, .5, -1);
        r.key = rad_key_pixel(0, 0, (uint32_t)i, 0);
        rad_ray_trace(&w.ctx, &r);
        first[i] = r.L;
    }
    ck_assert_int_eq(rad_ctx_init(&fresh, w.job, NULL), 0);
    for (int i = 50; i-- > 0;) {
        world_ray(&w, &r, 0, -1, 3, .01 * i, .5, -1);
        r.key = rad_key_pixel(0, 0, (uint32_t)i, 0);
        rad_ray_trace(&fresh, &r);
        again = r.L;
        ck_assert(memcmp(&again, &first[i], sizeof again) == 0);
        r.key++; /* and it does depend on its key */
        rad_ray_trace(&fresh, &r);
        differ += memcmp(&r.L, &again, sizeof again) != 0;
    }
    ck_assert_int_gt(differ, 25);
    rad_ctx_release(&fresh);
}

TEST(normal_never_turns_away_from_the_ray)
{
    struct rad_ray r = { .dir = { 0, .6, -.8 }, .n = { 0, 0, 1 } };
    double norm[3], cos_n;

    r.cos_o = .8;
    for (int i = 0; i < 1000; i++) {
        for (int k = 0; k < 3; k++)
            r.pert[k] = 4 * rad_rand(9, 3 * (uint32_t)i + (uint32_t)k) - 2;
        cos_n = rad_ray_normal(&r, norm);
        ck_assert_double_ge(cos_n, 0);
        ck_assert_double_eq_tol(-rad_dot(norm, r.dir), cos_n, 1e-12);
        ck_assert_double_eq_tol(rad_dot(norm, norm), 1, 1e-12);
    }
    r.pert[0] = r.pert[1] = 0;
    r.pert[2] = -1; /* nothing left of it: the surface's own */
    ck_assert_double_eq(rad_ray_normal(&r, norm), .8);
}
