/* check_trial.c - what is predicted from the measurements of a trial */
#include "config.h"

#include "trial/trial.h"
#include "tests/unit.h"

#include <math.h>

/* A trial of 256 strewn pixels and 1000 of windows, of a picture of 100 000: a
 * pixel takes 5 rays and a record 100. */
static struct trial
tried(double r64, double r128, double r256)
{
    struct trial t = { .step = { { .pixels = 64, .records = r64 },
                                 { .pixels = 128, .records = r128 },
                                 { .pixels = 256, .records = r256 } },
                       .nsteps = 3,
                       .pixels = 1000,
                       .primary = 1000,
                       .usual_pixels = 1000,
                       .usual_primary = 1000,
                       .records = 100,
                       .rays = 15000,
                       .cpu_s = .15,
                       .again_primary = 1000,
                       .again_rays = 5000,
                       .again_cpu_s = .05 };

    for (int i = 0; i < t.nsteps; i++) {
        t.step[i].rays = 5 * t.step[i].pixels + 100 * t.step[i].records;
        t.step[i].cpu_s = t.step[i].rays * 1e-5;
    }
    return t;
}

TEST(records_grow_with_each_doubling)
{
    struct trial t = tried(1000, 1100, 1200);
    struct prediction p;

    trial_predict(&t, 1e5, &p);
    ck_assert_double_eq_tol(p.primary_rays, 1e5, 1e-6);
    ck_assert_double_eq_tol(p.ambient_values,
                            1.2 * (1200 + 100 * log2(1e5 / 256)), 1);
    ck_assert_double_eq_tol(p.rays, 5e5 + 100 * p.ambient_values, 200);
    ck_assert_double_eq_tol(p.cpu_s, p.rays * 1e-5, 1e-2);
}

/* Windows that met no place without a record leave the price to the strewn
 * pixels. */
TEST(records_have_a_price_without_windows)
{
    struct trial t = tried(1000, 1100, 1200);
    struct prediction p;

    t.records = 0;
    t.rays = 5000;
    t.cpu_s = .05;
    trial_predict(&t, 1e5, &p);
    ck_assert_double_eq_tol(p.rays, 5e5 + 100 * p.ambient_values, 200);
}

/* A record of the windows' takes ten times as long as one of the strewn pixels,
 * and a pixel as long as when windows are traced again. */
TEST(further_records_cost_what_they_do_in_windows)
{
    struct trial t = tried(1000, 1100, 1200);
    struct prediction p;

    t.rays = 105000;
    trial_predict(&t, 1e5, &p);
    ck_assert_double_eq_tol(
        p.rays, 5e5 + 1.2 * (1200 * 100 + 100 * log2(1e5 / 256) * 1000), 200);
}

/* The upper halves of windows are sampled more densely than the picture is. */
TEST(pixels_are_as_dense_as_in_lower_halves_of_windows)
{
    struct trial t = tried(1000, 1100, 1200);
    struct prediction p;

    t.usual_pixels = 500;
    t.usual_primary = 100;
    trial_predict(&t, 1e5, &p);
    ck_assert_double_eq_tol(p.primary_rays, 2e4, 1e-6);
    ck_assert_double_eq_tol(p.rays, 1e5 + 100 * p.ambient_values, 200);
}

TEST(a_cache_that_is_far_from_full_is_as_dense_as_in_windows)
{
    struct trial t = tried(64, 128, 256);
    struct prediction p;

    trial_predict(&t, 1e5, &p);
    ck_assert_double_eq_tol(p.ambient_values, 1.2 * 1e5 / 10, 1);
    ck_assert_double_eq_tol(p.rays, 5e5 + 120 * 1e4, 1e4);
}
