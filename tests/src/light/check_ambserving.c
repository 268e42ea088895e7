/* check_ambserving.c - what pixels' errors have in common, by the records that
 * serve in them */
#include "config.h"

#include "light/indirect/ambserving.h"

#include "tests/unit.h"

#include <math.h>

static const int records[3 * RAD_AMBSERVING_MOST];

/* A pixel in which n records from number `first` on serve alike. */
static struct rad_ambserving
served(int first, int n)
{
    struct rad_ambserving s = { .n = 0 };

    for (int i = first; i < first + n; i++)
        rad_ambserving_add(&s, &records[i], 7);
    rad_ambserving_scale(&s, 1);
    return s;
}

TEST(pixels_share_what_serves_in_both)
{
    for (int n = 1; n <= 16; n++)
        for (int apart = 0; apart <= 20; apart++) {
            struct rad_ambserving a = served(0, n), b = served(apart, n);
            double both = fmax(n - apart, 0) / n;

            ck_assert_double_eq_tol(rad_ambserving_common(&a, &b), both, 1e-12);
            ck_assert_double_eq_tol(rad_ambserving_common(&b, &a), both, 1e-12);
        }
}

/* Two surfaces in a pixel, behind glass: each has its part of the light. */
TEST(shares_go_by_light)
{
    struct rad_ambserving a = served(0, 2), b = served(1, 1);

    rad_ambserving_add(&a, &records[5], .01);
    rad_ambserving_scale(&a, 3);
    ck_assert_int_eq(a.n, 3);
    ck_assert_double_eq_tol(a.v[0].share, .5, 1e-12);
    ck_assert_double_eq_tol(a.v[2].share, 3, 1e-12);
    ck_assert_double_eq_tol(rad_ambserving_common(&a, &b), .5 / sqrt(9.5),
                            1e-12);
}

/* A hemisphere's noise is that of its pixel alone, and what nothing lights has
 * none. */
TEST(hemispheres_are_not_shared)
{
    struct rad_ambserving a = { .n = 0 }, b = { .n = 0 }, dark = served(0, 1);

    rad_ambserving_scale(&a, 1);
    rad_ambserving_scale(&b, 1);
    ck_assert_int_eq(a.n, 1);
    ck_assert_double_eq(rad_ambserving_common(&a, &b), 0);
    ck_assert_double_eq_tol(rad_ambserving_common(&a, &a), 1, 1e-12);
    dark.v[0].share = 0;
    ck_assert_double_eq(rad_ambserving_common(&dark, &dark), 0);
}

TEST(what_has_no_room_is_left_out)
{
    struct rad_ambserving a = served(0, 2 * RAD_AMBSERVING_MOST), b;

    ck_assert_int_eq(a.n, RAD_AMBSERVING_MOST);
    rad_ambserving_scale(&a, 1);
    ck_assert_int_eq(a.n, RAD_AMBSERVING_MOST);
    b = served(0, RAD_AMBSERVING_MOST);
    ck_assert_double_eq_tol(rad_ambserving_common(&a, &b), 1, 1e-12);
}
