/* check_bright.c - bright places, and samples by them */
#include "config.h"

#include "light/hemisphere/bright.h"
#include "base/rng.h"

#include "tests/lambert.h"
#include "tests/world_fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

FIXTURE(NULL, world_tear_down)

/* A small disk of radiance 100 two units above the plane, off the zenith. */
#define HEIGHT 2.0
#define ASIDE  1.5
#define RADIUS .15
static const char disk_scene[] = "void glow g 0 0 4 100 100 100 0\n"
                                 "g ring disk 0 0 8 1.5 0 2  0 0 -1  0 .15\n";

static const double origin[3] = { 0, 0, 0 }, up[3] = { 0, 0, 1 };

static double
disk_irradiance(void)
{
    return 100 * lambert_disk(RADIUS, ASIDE, HEIGHT);
}

static struct rad_glint
glint_at(double x, double y, double z, float lum)
{
    return (struct rad_glint){ { (float)x, (float)y, (float)z }, lum };
}

static void
gather(struct rad_bright *b, const struct rad_glint *glint, size_t n)
{
    const double org[3] = { -5, -5, -5 };

    ck_assert(rad_bright_gather(b, glint, n, org, 10));
}

/* One of 64 glints of the disk, but moved along x. */
static struct rad_glint
disk_glint(int i, double dx)
{
    double r = RADIUS * sqrt((i + .5) / 64);

    return glint_at(ASIDE + r * cos(2.4 * i) + dx, r * sin(2.4 * i), HEIGHT,
                    100);
}

/* Places where records saw the disk, but moved along x. */
static void
see_disk_at(struct rad_bright *b, double dx)
{
    struct rad_glint glint[64];

    for (int i = 0; i < 64; i++)
        glint[i] = disk_glint(i, dx);
    gather(b, glint, 64);
    ck_assert_uint_gt(b->n, 0);
}

static void
see_disk(struct rad_bright *b)
{
    see_disk_at(b, 0);
}

struct found {
    double mean, sd, said; /* of E; sd by what the samplings say */
};

static struct found
sample_many(const struct rad_bright *b)
{
    struct found f = { 0, 0, 0 };
    enum { TIMES = 4000 };

    for (uint64_t k = 0; k < TIMES; k++) {
        struct rad_arena_mark mark = rad_arena_mark(&w.ctx.scratch);
        struct rad_hemi_plan plan = { .normal = { 0, 0, 1 },
                                      .coef = { .5f, .5f, .5f },
                                      .weight = 1,
                                      .store = true,
                                      .side = 7,
                                      .bright = b,
                                      .far = 100 };
        struct rad_hemi h;
        struct rad_ray r;
        double E;

        rad_ray_irradiance(&w.ctx, &r, origin, up, rad_key_branch(5, k));
        ck_assert(rad_hemi_sample(&w.ctx, &r, &plan, &h));
        ck_assert(h.complete);
        E = (double)rad_rgb_lum(h.E);
        f.mean += E / TIMES;
        f.sd += E * E / TIMES;
        f.said += h.var * E * E / TIMES;
        rad_arena_rewind(&w.ctx.scratch, mark);
    }
    f.sd = sqrt(f.sd - f.mean * f.mean);
    f.said = sqrt(f.said);
    return f;
}

#define SIDE 9
#define SIZE ((SIDE + 2) * (SIDE + 2))

static double
share_of(const struct rad_contrast *cell, int k)
{
    return cell[rad_contrast_at(k, SIDE)].share;
}

static void
set_cells(struct rad_contrast *cell, int changed, double times)
{
    ck_assert_int_eq(rad_contrast_size(SIDE), SIZE);
    memset(cell, 0, SIZE * sizeof *cell);
    for (int k = 0; k < SIDE * SIDE; k++) {
        struct rad_contrast *c = &cell[rad_contrast_at(k, SIDE)];
        double x = rad_rand(7, (uint32_t)k);

        c->lum = (x < .1 ? 100 : x) * (k == changed ? times : 1);
        c->square = k % 11 == 5 ? 50 : 0;
    }
    rad_contrast_share(cell, SIDE);
}

/* What a cell drew changes others' shares, and not its own. */
TEST(a_cell_has_no_say_in_its_share)
{
    struct rad_contrast a[SIZE], b[SIZE];
    double sum = 0;
    int others = 0;

    set_cells(a, -1, 1);
    for (int k = 0; k < SIDE * SIDE; k++) {
        double own = share_of(a, k);

        sum += own;
        set_cells(b, k, 30);
        ck_assert_double_eq_tol(share_of(b, k), own, 1e-9 * own);
        for (int i = 0; i < SIDE * SIDE; i++)
            others +=
                fabs(share_of(b, i) - share_of(a, i)) > 1e-3 * share_of(a, i);
    }
    ck_assert_int_gt(others, SIDE * SIDE);
    ck_assert_double_gt(sum, 1);
    ck_assert_double_lt(sum, 1.2);
}

/* Where the samples are all the same, and nothing is known, nothing is shared
 * out. */
TEST(even_cells_have_no_share)
{
    struct rad_contrast cell[SIZE] = { { 0 } };

    for (int k = 0; k < SIDE * SIDE; k++)
        cell[rad_contrast_at(k, SIDE)].lum = 2;
    rad_contrast_share(cell, SIDE);
    for (int k = 0; k < SIDE * SIDE; k++)
        ck_assert(share_of(cell, k) == 0);
}

/* The same of the disk with those options, and how many rays that took. */
static struct found
sample_disk(const char *options, const struct rad_bright *b, uint64_t *rays)
{
    struct found f;

    world_open(&w, disk_scene, options);
    f = sample_many(b);
    *rays = w.ctx.counts.ambient_rays;
    return f;
}

/* With places and without, the mean of many samplings is the closed form: what
 * a cell draws has no say in how many rays it gets.  With them there is a third
 * of the noise, for the same rays; and the noise that is said is that found. */
TEST(rays_to_bright_places_leave_the_mean_alone)
{
    double E = disk_irradiance();
    struct found blind, guided;
    uint64_t rays[2];
    struct rad_bright b;

    see_disk(&b);
    blind = sample_disk("-ab 0 -ad 324 -as 0 -lw 0", NULL, &rays[0]);
    guided = sample_disk("-ab 0 -ad 144 -as 144 -lw 0", &b, &rays[1]);
    ck_assert_double_eq_tol(blind.mean, E, 4 * blind.sd / sqrt(4000));
    ck_assert_double_eq_tol(guided.mean, E, 4 * guided.sd / sqrt(4000));
    ck_assert_double_lt(guided.sd, blind.sd / 3);
    ck_assert_uint_le(rays[1], rays[0]);
    ck_assert_double_gt(blind.said, .7 * blind.sd);
    ck_assert_double_lt(blind.said, 1.5 * blind.sd);
}

/* So it is where all that records saw is in one cell of the grid. */
TEST(one_place_is_looked_at_too)
{
    const double org[3] = { -29, -29.5, -30 };
    struct rad_glint glint[64];
    struct found blind, guided;
    struct rad_bright b;
    uint64_t rays;

    for (int i = 0; i < 64; i++)
        glint[i] = disk_glint(i, 0);
    ck_assert(rad_bright_gather(&b, glint, 64, org, 60));
    ck_assert_uint_eq(b.n, 1);
    blind = sample_disk("-ab 0 -ad 324 -as 0 -lw 0", NULL, &rays);
    guided = sample_disk("-ab 0 -ad 144 -as 144 -lw 0", &b, &rays);
    ck_assert_double_eq_tol(guided.mean, disk_irradiance(),
                            4 * guided.sd / sqrt(4000));
    ck_assert_double_lt(guided.sd, blind.sd / 3);
}

/* The disk is a small part of a cell.  With a few rays of a guide the mean is
 * the closed form, and the noise that is said is that found, wherever the guide
 * has the disk: where it is, half aside, or where it is not.  Where it is there
 * is a quarter of the noise. */
static const double moved[] = { 0, RADIUS, 3 * RADIUS };

LOOP_TEST(a_guide_leaves_the_mean_of_few_cells_alone, N_ELEM(moved))
{
    struct found blind, guided;
    uint64_t rays[2];
    struct rad_bright b;

    see_disk_at(&b, moved[_i]);
    blind = sample_disk("-ab 0 -ad 64 -as 0 -lw 0", NULL, &rays[0]);
    guided = sample_disk("-ab 0 -ad 49 -as 9 -lw 0", &b, &rays[1]);
    ck_assert_double_eq_tol(guided.mean, disk_irradiance(),
                            4 * guided.sd / sqrt(4000));
    ck_assert_uint_le(rays[1], rays[0]);
    if (_i == 0)
        ck_assert_double_lt(guided.sd, blind.sd / 4);
    ck_assert_double_gt(guided.said, .7 * guided.sd);
    ck_assert_double_lt(guided.said, 1.5 * guided.sd);
}

/* Nothing is there any more where records saw something: rays are lost, and
 * the mean is as it was. */
TEST(places_that_are_not_seen_do_no_harm)
{
    struct rad_glint glint[64];
    struct found f;
    struct rad_bright b;

    for (int i = 0; i < 64; i++)
        glint[i] = glint_at(-2 + .2 * (i % 8), -1 + .2 * (i / 8.), 1, 1e4f);
    gather(&b, glint, 64);
    ck_assert_uint_gt(b.n, 30);
    world_open(&w, disk_scene, "-ab 0 -ad 144 -as 144 -lw 0");
    f = sample_many(&b);
    ck_assert_double_eq_tol(f.mean, disk_irradiance(), 4 * f.sd / sqrt(4000));
}

/* The sun in a ceiling of rough metal: what each hemisphere finds of a glint
 * that is smaller than its cells is near the mean, and the mean is that of a
 * mirror. */
TEST(glints_are_no_smaller_than_cells)
{
    static const char scene[] = "void light sun 0 0 3 1e5 1e5 1e5\n"
                                "sun source s 0 0 4 .3 0 -1 .5\n"
                                "void metal m 0 0 5 .8 .8 .8 1 .02\n"
                                "m ring ceiling 0 0 8 0 0 2  0 0 -1  0 50\n";
    double half = .25 / 180 * M_PI, cos_sun = 1 / sqrt(1.09);
    double E = .8 * 1e5 * M_PI * sin(half) * sin(half) * cos_sun;
    struct found f;

    world_open(&w, scene, "-ab 0 -ad 49 -as 0 -lw 0");
    f = sample_many(NULL);
    ck_assert_double_lt(f.sd, .6 * E);
    ck_assert_double_eq_tol(f.mean, E, .04 * E);
}

static const struct {
    const char *material;
    double deg; /* of the sun, from the zenith */
} tilted[] = {
    { "metal m 0 0 5 .8 .8 .8 1 .02", 45 },
    { "metal m 0 0 5 .8 .8 .8 1 .02", 60 },
    { "metal2 m 4 1 0 0 . 0 6 .8 .8 .8 1 .02 .03", 60 },
    { "ashik2 m 4 1 0 0 . 0 8 0 0 0 .8 .8 .8 5000 5000", 0 },
    { "WGMDfunc m 13 void .8 .02 .02 void 0 0 0 . 1 0 0 . 0 9 0 0 0 0 0 0 0 0 "
      "0",
      60 },
};

/* Whatever the sun's height, although gloss is blurred less near grazing. */
LOOP_TEST(blurred_glints_have_the_light_of_a_mirror, N_ELEM(tilted))
{
    double half = .25 / 180 * M_PI, a = tilted[_i].deg / 180 * M_PI, E;
    char scene[400];
    struct found f;

    snprintf(scene, sizeof scene,
             "void light sun 0 0 3 1e5 1e5 1e5\n"
             "sun source s 0 0 4 %g 0 %g .5\n"
             "void %s\nm ring ceiling 0 0 8 0 0 2  0 0 -1  0 200\n",
             sin(a), -cos(a), tilted[_i].material);
    world_open(&w, scene, "-ab 0 -ad 49 -as 0 -lw 0 -st 1");
    f = sample_many(NULL);
    E = .8 * 1e5 * M_PI * sin(half) * sin(half) * cos(a);
    ck_assert_double_eq_tol(f.mean, E, .04 * E);
}

TEST(glints_near_each_other_are_one_place)
{
    struct rad_glint glint[4] = { glint_at(1, 2, 3, 10),
                                  glint_at(1.01, 2.01, 3, 30),
                                  glint_at(-40, 0, 0, 5),
                                  glint_at(0, 0, 0, 0) };
    struct rad_bright b, again;

    gather(&b, glint, 4);
    ck_assert_uint_eq(b.n, 2); /* most glints first; no glint, no place */
    ck_assert_double_eq_tol(b.place[0].p[0], 1.005, 1e-6);
    ck_assert_double_eq_tol(b.place[0].lum, 20, 1e-6);
    ck_assert_double_eq_tol(b.place[1].p[0], -40, 1e-6);
    gather(&again, glint, 4);
    ck_assert_mem_eq(again.place, b.place, b.n * sizeof *b.place);
    gather(&b, glint + 3, 1);
    ck_assert_uint_eq(b.n, 0);
}

TEST(most_chosen_places_are_kept)
{
    enum { N = 3 * RAD_BRIGHT_MOST };
    static struct rad_glint glint[2 * N];
    struct rad_bright b;

    for (int i = 0; i < 2 * N; i++) /* every third place twice */
        glint[i] =
            glint_at(-4.5 + .3 * (i % N % 30), -4.5 + .3 * (i % N / 30 % 30),
                     -4.5 + .3 * (i % N / 900), i < N || i % 3 == 0 ? 7 : 0);
    gather(&b, glint, 2 * N);
    ck_assert_uint_eq(b.n, RAD_BRIGHT_MOST);
    for (size_t i = 0; i < b.n; i++)
        ck_assert_int_eq((int)lrint((b.place[i].p[0] + 4.5) / .3) % 3, 0);
}

/* The record of a room with a sun patch keeps a glint on it; one beneath an
 * even sky keeps none. */
LOOP_TEST(records_keep_what_is_far_above_their_mean, 2)
{
    static const char *const scene[] = {
        disk_scene, "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n"
    };
    struct rad_hemi h;
    struct rad_ray r;
    struct rad_hemi_plan plan = { .normal = { 0, 0, 1 },
                                  .coef = { .5f, .5f, .5f },
                                  .weight = 1,
                                  .store = true,
                                  .side = 7,
                                  .far = 100 };

    world_open(&w, scene[_i], "-ab 0 -ad 4096 -as 0 -lw 0");
    rad_ray_irradiance(&w.ctx, &r, origin, up, 3);
    ck_assert(rad_hemi_sample(&w.ctx, &r, &plan, &h));
    for (uint64_t k = 0; k < 50; k++) {
        struct rad_glint g = rad_bright_glint(&h, origin, k);

        if (_i == 1) {
            ck_assert_float_eq(g.lum, 0);
            continue;
        }
        ck_assert_float_eq_tol(g.lum, 100, 1e-3f);
        ck_assert_float_eq_tol(g.p[2], (float)HEIGHT, 1e-4f);
        ck_assert(hypot((double)g.p[0] - ASIDE, (double)g.p[1]) <
                  RADIUS + 1e-4);
    }
}
