/* check_passcost.c - how much of a job passes are, before any is made */
#include "config.h"

#include "passes/passcost.h"

#include "machine/jobtext.h"
#include "tests/unit.h"

#include <string.h>

/* What was measured: processor time of tiles of all, in the mean of four to six
 * scenes, by their odds.  The side is that of a square with as many pixels. */
static const struct {
    const char *options;
    int side;
    double part;
} parts[] = {
    { "-ab 1 -aa .3 -ad 128 -as 32", 340, .71 },
    { "-ab 2 -aa .3 -ad 128 -as 32", 280, .74 },
    { "-ab 2 -aa .3 -ad 128 -as 32", 900, .73 },
    { "-ab 2 -aa .2 -ad 256 -as 64", 350, .83 },
    { "-ab 5 -aa .2 -ad 256 -as 64", 350, .86 },
    { "-ab 3 -aa .2 -ad 64 -as 16", 340, .74 },
    { "-ab 5 -aa .4 -ad 96 -as 24", 1200, .67 },
    { "-ab 7 -aa .2 -ad 512 -as 128", 210, .96 },
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

/* Of the office by night, in hundredths of the processor time of all passes. */
static const struct {
    const char *options;
    struct rad_pass_size size;
    double rest;      /* scattered passes: less than this */
    double share[32]; /* of the passes before these; of those after the last of
                       * these: 0 */
} shares[] = {
    { "-ab 1 -aa .3 -ad 128 -as 32",
      { 640, 431 },
      .03,
      { 3.8, 6.4, 5.3, 11.8, 11.1, 32.5, 28.4 } },
    { "-ab 2 -aa .3 -ad 128 -as 32",
      { 640, 431 },
      .03,
      { .2, .5, 1.4, 3.5, 10.5, 10.4, 6.7, 11, 9.6, 25.1, 20.6 } },
    { "-ab 4 -aa .3 -ad 128 -as 32",
      { 640, 431 },
      .03,
      { .3, .3, .6, 1, .7, 1.2, 2.2, 1.8, 3, 5.4, 9.7, 10.8, 6.5, 9.7, 8.3,
        21.1, 16.8 } },
    /* --quality=medium */
    { "-ab 6 -aa .3 -ad 224 -as 56",
      { 400, 270 },
      .12,
      { .1, .3, .5, .7, .8, 1.2, 1.1, 1.7, 1.5, 3.5, 4.5, 7.3, 7, 6.1, 7.3, 6.9,
        22.3, 21.5 } },
};

LOOP_TEST(passes_are_weighed, N_ELEM(shares))
{
    struct rad_pass pass[RAD_MOST_PASSES];
    double weight[RAD_MOST_PASSES], all = 0, part = 0, want = 0, rest = 0;
    struct rad_params par;
    uint32_t n;

    ck_assert_int_eq(jobtext_params(shares[_i].options, &par, NULL), 0);
    n = rad_passes_plan(&par, &shares[_i].size, 1, pass);
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
    ck_assert_double_lt(rest, shares[_i].rest); /* in all its rounds */
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
