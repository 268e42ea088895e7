/* check_eta.c - the time that is left, by reports that jobs made, and what a
 * trial foresees
 *
 * Reports of real jobs on two processors that others used as well, with what a
 * short trial had foreseen. */
#include "config.h"

#include "trial/eta.h"
#include "trial/trial.h"
#include "tests/unit.h"

#include <math.h>

struct report {
    double s, done, Mrays;
};

/* A room full of books in the sun: -ab 3, one worker. */
static const struct report books[] = {
    { 0.16, 0, 0 },         { 3.20, .0184, 3.34 },  { 6.21, .0921, 5.63 },
    { 9.24, .1553, 7.95 },  { 12.27, .2000, 10.4 }, { 15.30, .2395, 12.7 },
    { 18.32, .2842, 15.2 }, { 21.35, .3105, 17.6 }, { 24.36, .3342, 19.2 },
    { 27.38, .3579, 21.9 }, { 30.41, .3947, 24.2 }, { 33.43, .4184, 26.6 },
    { 36.44, .4500, 28.7 }, { 39.46, .4763, 31.5 }, { 42.47, .5026, 33.4 },
    { 45.48, .5316, 35.7 }, { 48.51, .5553, 38.3 }, { 51.52, .5816, 40.4 },
    { 54.53, .6053, 42.6 }, { 57.54, .6237, 44.5 }, { 60.58, .6579, 46.3 },
    { 63.59, .6763, 48.1 }, { 66.62, .7237, 49.9 }, { 69.63, .7737, 52.0 },
    { 72.64, .8237, 54.1 }, { 75.65, .9184, 56.5 }, { 76.19, 1, 57.0 },
};

/* It, with --quality=high. */
static const struct report fine[] = {
    { 0.07, 0, 0 },         { 1.58, 0, 1.45 },      { 3.08, .0099, 2.94 },
    { 4.58, .0691, 4.40 },  { 6.10, .1283, 5.54 },  { 7.61, .1842, 6.72 },
    { 9.13, .2007, 7.58 },  { 10.64, .2401, 8.82 }, { 12.15, .2796, 10.3 },
    { 13.65, .3125, 12.2 }, { 15.16, .3388, 13.4 }, { 16.66, .3520, 15.1 },
    { 18.18, .3914, 16.3 }, { 19.69, .4145, 18.3 }, { 21.20, .4375, 19.5 },
    { 22.70, .4770, 21.1 }, { 24.21, .5033, 22.7 }, { 25.72, .5230, 24.2 },
    { 27.22, .5757, 26.7 }, { 28.73, .6151, 29.1 }, { 30.25, .6678, 31.3 },
    { 31.75, .7467, 33.5 }, { 33.27, .8257, 35.5 }, { 34.42, 1, 37.9 },
};

/* An office at night, --quality=high, two workers: what both did counts twice
 * until one of them has taken over from the other. */
static const struct report office[] = {
    { 0.07, 0, 0 },         { 0.56, 0, 1.52 },      { 1.57, 0, 3.67 },
    { 2.57, 0, 5.86 },      { 3.57, 0, 8.01 },      { 4.07, .0064, 8.96 },
    { 4.57, .0148, 9.65 },  { 5.57, .0466, 11.5 },  { 6.58, .0953, 13.6 },
    { 7.60, .1483, 15.8 },  { 8.60, .1949, 18.0 },  { 9.60, .2331, 20.1 },
    { 10.60, .2733, 22.0 }, { 11.60, .3220, 24.0 }, { 12.60, .3708, 26.0 },
    { 13.62, .4343, 28.0 }, { 14.62, .5021, 30.0 }, { 15.62, .5699, 31.9 },
    { 16.62, .6504, 34.0 }, { 17.62, .7225, 35.8 }, { 18.63, .7860, 37.5 },
    { 19.63, .8729, 39.4 }, { 20.23, 1, 34.3 },
};

/* Passes: an office by day at -ab 3, and a box at -ab 2, one worker each. */
static const struct report day[] = {
    { 0.09, 0.0309, 0.16 },  { 1.59, 0.1473, 3.03 },  { 3.10, 0.194, 5.23 },
    { 4.61, 0.2583, 7.53 },  { 6.11, 0.3011, 8.8 },   { 7.61, 0.3683, 10.1 },
    { 9.12, 0.432, 11.3 },   { 10.62, 0.5316, 12.5 }, { 12.13, 0.6129, 14 },
    { 13.64, 0.7061, 15.1 }, { 15.14, 0.7922, 16.1 }, { 16.64, 0.852, 17.1 },
    { 18.15, 0.9334, 18.3 }, { 19.19, 1, 19.1 },      { 19.19, 1, 19.1 },
};

static const struct report box[] = {
    { 0.06, 0.0015, 0.02 },  { 2.56, 0.1369, 3.72 },  { 5.07, 0.2194, 6.44 },
    { 7.58, 0.2685, 8.04 },  { 10.09, 0.315, 9.88 },  { 12.61, 0.3489, 11.6 },
    { 15.13, 0.4143, 13.2 }, { 17.66, 0.4458, 15 },   { 20.23, 0.5379, 17 },
    { 22.75, 0.5629, 18.4 }, { 25.29, 0.6146, 20.1 }, { 27.82, 0.7679, 22.2 },
    { 30.32, 0.8143, 23.9 }, { 32.86, 0.8607, 26.4 }, { 34.43, 1, 27.8 },
};

static const struct {
    const struct report *at;
    int n;
    double foreseen; /* millions of rays */
    double foreseen_s;
    double until; /* share of the time in which a factor of two is asked for */
} jobs[] = {
    { books, N_ELEM(books), 67.3, 3, .8 },
    { fine, N_ELEM(fine), 32.4, 3, .8 },
    { office, N_ELEM(office), 43.0, 2.5, .8 },
    /* trials that were off by a quarter */
    { books, N_ELEM(books), 57 * 1.25, 3, .6 },
    { fine, N_ELEM(fine), 37.9 / 1.25, 3, .6 },
    { office, N_ELEM(office), 40.4 / 1.25, 2.5, .6 },
    /* passes: no trial */
    { day, N_ELEM(day), 0, INFINITY, .8 },
    { box, N_ELEM(box), 0, INFINITY, .65 },
};

/* Millions do as well as units. */
static double
take(struct eta *e, const struct report *r)
{
    struct eta_look look = { r->s, r->done, r->Mrays, true };

    return eta_take(e, &look);
}

/* Within a factor of two while much is left; then within three tenths of the
 * whole. */
LOOP_TEST(time_left_is_within_a_factor_of_two, N_ELEM(jobs))
{
    const struct report *r = jobs[_i].at, *end = r + jobs[_i].n - 1;
    struct eta e = { 0 };
    int said = 0;

    for (; r < end; r++) {
        double left, real = end->s - r->s;

        if (r->s >= jobs[_i].foreseen_s)
            eta_foresee(&e, jobs[_i].foreseen);
        left = take(&e, r);
        if (left < 0)
            continue;
        said++;
        if (r->s < jobs[_i].until * end->s)
            ck_assert_msg(left < 2 * real && real < 2 * left,
                          "at %g s: %g s are left, not %g", r->s, real, left);
        else
            ck_assert_double_eq_tol(left, real, .3 * end->s);
    }
    ck_assert_int_gt(said, jobs[_i].n - 6); /* and it was told early */
    ck_assert_double_eq(take(&e, end), 0);
}

TEST(nothing_is_said_before_something_is_known)
{
    struct eta e = { 0 };
    struct eta_look look = { 1, 0, 0, true };

    ck_assert_double_lt(eta_take(&e, &look), 0);
    look = (struct eta_look){ 2, .05, 100, true };
    ck_assert_double_lt(eta_take(&e, &look), 0);
    look = (struct eta_look){ 2.5, .25, 200, true }; /* it may be sky */
    ck_assert_double_lt(eta_take(&e, &look), 0);
    /* without a trial the share tells, late */
    look = (struct eta_look){ 4, .25, 300, true };
    ck_assert_double_eq_tol(eta_take(&e, &look), 9, 1e-9);
    eta_foresee(&e, 0); /* one is under way that will know better */
    look = (struct eta_look){ 4, .25, 300, true };
    ck_assert_double_lt(eta_take(&e, &look), 0);
    look = (struct eta_look){ 4, .4, 300, false }; /* paused */
    ck_assert_double_lt(eta_take(&e, &look), 0);
}

TEST(time_that_nobody_works_is_left_out)
{
    struct eta e = { 0 };
    struct eta_look look = { 0, 0, 0, true };

    eta_foresee(&e, 1000);
    for (int s = 0; s <= 10; s++) {
        look.elapsed_s = s;
        look.rays = 10 * s;
        eta_take(&e, &look);
    }
    look.working = false;
    look.elapsed_s = 1000;
    ck_assert_double_lt(eta_take(&e, &look), 0);
    look.working = true;
    look.elapsed_s = 1001;
    look.rays = 110;
    ck_assert_double_eq_tol(eta_take(&e, &look), 89, 1e-6);
}

TEST(more_workers_are_seen)
{
    struct eta e = { 0 };
    struct eta_look look = { 0, 0, 0, true };
    double left = 0;

    eta_foresee(&e, 100000);
    for (int s = 0; s <= 120; s++) {
        look.elapsed_s = s;
        look.rays += s > 60 ? 400 : 100;
        left = eta_take(&e, &look);
    }
    /* 70 thousand are left, at 400 a second */
    ck_assert_double_gt(left, 150);
    ck_assert_double_lt(left, 260);
}

/* A coordinator may lose what was under way. */
TEST(a_job_may_begin_again)
{
    struct eta e = { 0 };
    struct eta_look look = { 10, 0, 500, true };

    eta_foresee(&e, 1000);
    ck_assert_double_eq_tol(eta_take(&e, &look), 10, 1e-9);
    look = (struct eta_look){ 5, 0, 100, true };
    ck_assert_double_eq_tol(eta_take(&e, &look), 45, 1e-9);
}

/* Twice as many rays came as were foreseen, and a third of the picture is
 * there. */
TEST(a_trial_that_foresaw_too_little_is_no_end)
{
    struct eta e = { 0 };
    struct eta_look look = { 100, 1. / 3, 2000, true };
    double left;

    eta_foresee(&e, 1000);
    left = eta_take(&e, &look);
    ck_assert_double_gt(left, 15);
    ck_assert_double_lt(left, 200);
    ck_assert(isfinite(eta_by_share(&e, .5)));
    ck_assert(isinf(eta_by_share(&e, 0)));
}

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
