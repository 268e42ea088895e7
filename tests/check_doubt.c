/* check_doubt.c - how far a picture may be off, from sums over its pixels */
#include "config.h"

#include "base/rng.h"
#include "picture/doubt.h"
#include "unit.h"

#include <math.h>

enum { WIDTH = 4000 };

/* A row whose pixels have independent values about 1. */
static void
noisy_row(struct rad_pixel row[WIDTH], double deviation)
{
    for (int x = 0; x < WIDTH; x++) {
        double u = rad_rand(rad_mix64(7), (uint32_t)x) - .5;

        row[x].L = rad_grey((float)(1 + deviation * sqrt(12) * u));
        row[x].z = 0;
    }
}

START_TEST(noise_of_a_base_line_is_found)
{
    static struct rad_pixel row[WIDTH];
    struct rad_rough r = { 0, 0 };

    noisy_row(row, .04);
    rad_rough_row(&r, row, WIDTH, 0, 1);
    ck_assert_double_gt(r.n, WIDTH / 2);
    ck_assert_double_eq_tol(sqrt(r.sum / r.n), .04, .002);
    /* with -ps 4 every sixth pixel of every third row */
    r = (struct rad_rough){ 0, 0 };
    rad_rough_row(&r, row, WIDTH, 1, 4);
    ck_assert_double_eq(r.n, 0);
    rad_rough_row(&r, row, WIDTH, 3, 4);
    ck_assert_double_eq_tol(r.n, WIDTH / 6, 3);
    ck_assert_double_eq_tol(sqrt(r.sum / r.n), .04, .006);
}
END_TEST

START_TEST(slopes_and_black_are_no_noise)
{
    static struct rad_pixel row[WIDTH];
    struct rad_rough r = { 0, 0 };

    for (int x = 0; x < WIDTH; x++)
        row[x].L = rad_grey(1 + .001f * (float)x);
    rad_rough_row(&r, row, WIDTH, 0, 4);
    ck_assert_double_lt(r.sum / r.n, 1e-10);
    r = (struct rad_rough){ 0, 0 };
    for (int x = 0; x < WIDTH; x++)
        row[x].L = rad_grey(0);
    rad_rough_row(&r, row, WIDTH, 0, 4);
    ck_assert_double_eq(r.n, 0);
    /* an edge counts, but not for more than noise could be */
    row[WIDTH / 2].L = rad_grey(1e6f);
    rad_rough_row(&r, row, WIDTH, 0, 1);
    ck_assert_double_eq(r.n, 3);
    ck_assert_double_le(r.sum, .75);
}
END_TEST

START_TEST(parts_add_by_their_squares)
{
    const struct rad_doubt d = { 100, .5, 20, 40 };
    const struct rad_rough r = { 9, 900 };
    const struct rad_doubt no_light = { 0, 0, 0, 0 };
    const struct rad_rough no_rows = { 0, 0 };
    struct rad_error_estimate both = rad_doubt_error(&d, &r, 4), one;

    ck_assert_double_eq_tol(hypot(both.ambient, both.sampling), both.all,
                            1e-12);
    one = rad_doubt_error(&d, &no_rows, 4);
    ck_assert_double_eq_tol(one.all, both.ambient, 1e-12);
    /* what nothing is known of is taken to be as what is known */
    ck_assert_double_eq_tol(one.all, .87 * .1, 1e-9);
    one = rad_doubt_error(&no_light, &r, 4);
    ck_assert_double_eq_tol(one.all, both.sampling, 1e-12);
    ck_assert_double_lt(rad_doubt_error(&no_light, &r, 1).all, one.all);
    ck_assert_double_eq(rad_doubt_error(&no_light, &no_rows, 1).all, 0);
}
END_TEST

/* Another says these sums, and statistics have no infinity. */
START_TEST(an_error_is_a_number)
{
    const struct rad_doubt far = { 1e-300, 1e99, 1e-300, 1e99 };
    const struct rad_doubt none = { 1e-300, 1e99, 1, 0 };
    const struct rad_rough rough = { 1e99, 1e-300 };
    struct rad_error_estimate e = rad_doubt_error(&far, &rough, 4);

    ck_assert(e.ambient > 1e5 && e.ambient <= 1e6);
    ck_assert_double_eq(e.sampling, 1e6);
    ck_assert_double_eq(e.all, 1e6);
    e = rad_doubt_error(&none, &rough, 4);
    ck_assert(isfinite(e.ambient) && isfinite(e.all));
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("doubt");
    TCase *tc = tcase_create("doubt");

    tcase_add_test(tc, noise_of_a_base_line_is_found);
    tcase_add_test(tc, slopes_and_black_are_no_noise);
    tcase_add_test(tc, parts_add_by_their_squares);
    tcase_add_test(tc, an_error_is_a_number);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
