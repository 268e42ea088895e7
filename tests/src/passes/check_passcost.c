/* check_passcost.c - how much of a job passes are, before any is made */
#include "config.h"

#include "passes/passcost.h"

#include "machine/jobtext.h"
#include "tests/unit.h"

#include <string.h>

/* What was measured: rays of tiles of all rays, in the mean of five scenes, by
 * their odds. */
static const struct {
    const char *options;
    int side;
    double part;
} parts[] = {
    { "-ab 1 -aa .3 -ad 128 -as 32", 400, .70 },
    { "-ab 2 -aa .3 -ad 128 -as 32", 400, .79 },
    { "-ab 1 -aa .2 -ad 256 -as 64", 640, .84 },
    { "-ab 3 -aa .2 -ad 256 -as 64", 640, .88 },
    { "-ab 2 -aa .15 -ad 256 -as 64", 1024, .89 },
    { "-ab 2 -aa .3 -ad 128 -as 32", 1024, .63 },
    { "-ab 5 -aa .3 -ad 64 -as 16", 1024, .64 },
};

LOOP_TEST(the_part_of_passes_is_foreseen, N_ELEM(parts))
{
    struct rad_pass_size size = { parts[_i].side, parts[_i].side };
    struct rad_params par;
    double part;

    ck_assert_int_eq(jobtext_params(parts[_i].options, &par, NULL), 0);
    part = rad_passcost_part(&par, &size, 1, false);
    ck_assert_double_eq_tol(part, parts[_i].part, .1);
}

/* Of the office by night at -ab 1, 2 and 4, 640 wide, in hundredths of the rays
 * of all passes. */
static const struct {
    int ambounce;
    double share[32]; /* of those after the last of these: 0 */
} shares[] = {
    { 1, { 6, 8, 8, 12, 11, 30, 24 } },
    { 2, { .4, 1, 2, 5, 15, 9, 7, 11, 9, 23, 17 } },
    { 4, { .4, 1, 1, 2, 1, 2, 3, 2, 3, 5, 14, 8, 6, 10, 8, 20, 15 } },
};

LOOP_TEST(passes_are_weighed, N_ELEM(shares))
{
    struct rad_pass_size size = { 640, 431 };
    struct rad_pass pass[RAD_MOST_PASSES];
    double weight[RAD_MOST_PASSES], all = 0, part = 0, want = 0, rest = 0;
    struct rad_params par;
    uint32_t n;

    rad_params_init(&par);
    par.ambounce = shares[_i].ambounce;
    par.ambacc = .3;
    n = rad_passes_plan(&par, &size, 1, pass);
    rad_passcost_weigh(&par, pass, n, weight);
    for (uint32_t i = 0; i < n; i++)
        all += weight[i];
    for (uint32_t i = 0; i < n; i++) {
        ck_assert_double_gt(weight[i], 0);
        part += weight[i] / all;
        want += shares[_i].share[i] / 100;
        ck_assert_double_eq_tol(part, want, .12);
        rest += pass[i].scattered ? weight[i] / all : 0;
    }
    ck_assert_double_lt(rest, .03); /* in all its rounds */
}

/* Of a walk: no weight is missing, and the first frame's count most. */
TEST(passes_of_many_frames_are_weighed)
{
    enum { FRAMES = 12 };
    struct rad_pass_size size[FRAMES];
    struct rad_pass pass[RAD_MOST_PASSES];
    double weight[RAD_MOST_PASSES], all = 0, first = 0;
    struct rad_params par;
    uint32_t n;

    for (int i = 0; i < FRAMES; i++)
        size[i] = (struct rad_pass_size){ 640, 480 };
    rad_params_init(&par);
    par.ambounce = 2;
    n = rad_passes_plan(&par, size, FRAMES, pass);
    rad_passcost_weigh(&par, pass, n, weight);
    for (uint32_t i = 0; i < n; i++) {
        ck_assert_double_gt(weight[i], 0);
        all += weight[i];
        first += pass[i].level == 0 && pass[i].frame == 0 ? weight[i] : 0;
    }
    ck_assert(first > 1.9 / FRAMES * all / 2 && first < .5 * all);
}

/* The office by night, 120 wide, -ab 2: million rays of its passes.  Much of
 * the work is what lattices left out. */
TEST(scattered_passes_are_weighed)
{
    static const double took[] = { 0,   .04, .04, .07, .07, .06, .06,
                                   .18, .18, 1,   1.2, 1.2, 3.5 };
    struct rad_pass_size size = { 120, 81 };
    struct rad_pass pass[RAD_MOST_PASSES];
    double weight[RAD_MOST_PASSES], done = 0, all = 0, part = 0, sum = 0;
    struct rad_params par;
    uint32_t n;

    ck_assert_int_eq(jobtext_params("-ab 2 -aa .2 -ad 256 -as 64", &par, NULL),
                     0);
    n = rad_passes_plan(&par, &size, 1, pass);
    ck_assert_uint_eq(n, N_ELEM(took));
    rad_passcost_weigh(&par, pass, n, weight);
    for (uint32_t i = 0; i < n; i++) {
        all += took[i];
        sum += weight[i];
    }
    for (uint32_t i = 0; i < n; i++) {
        done += took[i];
        part += weight[i];
        ck_assert_double_eq_tol(part / sum, done / all, .2);
    }
}

/* A pass without tiles is no work; one that checks is some. */
TEST(passes_of_other_kinds_are_weighed)
{
    struct rad_pass_size size = { 64, 48 };
    struct rad_pass pass[RAD_MOST_PASSES];
    double weight[RAD_MOST_PASSES];
    struct rad_params par;
    uint32_t n;

    rad_params_init(&par);
    par.ambounce = 1;
    n = rad_passes_plan_on(&par, &size, 1, pass);
    pass[n++] = (struct rad_pass){
        .check = true, .stride = 1, .beyond = 1, .tiles = 3
    };
    rad_passcost_weigh(&par, pass, n, weight);
    ck_assert_double_eq(weight[0], 0);
    ck_assert_double_gt(weight[1], 0);
    ck_assert_double_gt(weight[n - 1], 0);
    par.ambounce = 0;
    ck_assert_double_eq(rad_passcost_part(&par, &size, 1, false), 0);
}
