/* check_outcome.c - what several jobs of one command come to */
#include "config.h"

#include "trial/outcome.h"
#include "tests/unit.h"

#include <math.h>

static const struct outcome first = { .elapsed_s = 3,
                                      .error = .03,
                                      .left_out = .1,
                                      .nan = { .pixels = 2, .x = 5, .y = 1 },
                                      .faults = { { 4, 10 }, { 7, 1 } } };
static const struct outcome second = { .elapsed_s = 2,
                                       .error = .04,
                                       .left_out = .2,
                                       .nan = { .pixels = 1, .x = 8, .y = 0 },
                                       .faults = { { 2, 5 }, { 4, 20 } } };

TEST(faults_and_bad_pixels_of_all_jobs_count)
{
    struct outcome_sum s = { 0 };

    outcome_add(&s, &first, 1);
    outcome_add(&s, &second, 1);
    ck_assert_uint_eq(s.all.nan.pixels, 3);
    ck_assert_uint_eq(s.all.nan.x, 8);
    ck_assert_uint_eq(s.all.faults[0].object, 2);
    ck_assert_uint_eq(s.all.faults[0].count, 5);
    ck_assert_uint_eq(s.all.faults[1].object, 4);
    ck_assert_uint_eq(s.all.faults[1].count, 30);
    ck_assert_uint_eq(s.all.faults[2].object, 7);
    ck_assert_uint_eq(s.all.faults[3].count, 0);
}

TEST(errors_have_the_root_of_their_mean_square)
{
    struct outcome unknown = { .elapsed_s = 1 };
    struct outcome_sum s = { 0 };

    outcome_add(&s, &unknown, 100);
    ck_assert_double_eq(s.all.error, 0);
    outcome_add(&s, &first, 7);
    ck_assert_double_eq_tol(s.all.error, .03, 1e-15);
    outcome_add(&s, &second, 9);
    ck_assert_double_eq_tol(16 * s.all.error * s.all.error,
                            7 * .0009 + 9 * .0016, 1e-15);
    ck_assert_double_eq_tol(16 * s.all.left_out, 7 * .1 + 9 * .2, 1e-14);
}

TEST(light_left_out_counts_where_nothing_is_found_wrong)
{
    struct outcome right = { .left_out = .3 };
    struct outcome_sum s = { 0 };

    outcome_add(&s, &right, 1);
    ck_assert_double_eq(s.all.left_out, .3);
    outcome_add(&s, &first, 1);
    ck_assert_double_eq_tol(s.all.left_out, .2, 1e-15);
    ck_assert_double_eq_tol(s.all.error, .03 / sqrt(2), 1e-15);
}

TEST(times_add_up_unless_jobs_run_side_by_side)
{
    struct outcome_sum s = { 0 };

    outcome_add(&s, &first, 1);
    outcome_add(&s, &second, 1);
    ck_assert_double_eq(s.all.elapsed_s, 3);
    outcome_next(&s);
    outcome_add(&s, &second, 1);
    ck_assert_double_eq(s.all.elapsed_s, 5);
}
