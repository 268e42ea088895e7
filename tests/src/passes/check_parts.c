/* check_parts.c - a cloud of points cut into compact parts of any shares */
#include "config.h"

#include "passes/parts.h"
#include "base/rng.h"

#include "tests/unit.h"

#include <math.h>

enum { POINTS = 3000, SHARES = 8 };

static void
draw_points(double (*p)[3])
{
    for (uint32_t i = 0; i < POINTS; i++)
        for (uint32_t k = 0; k < 3; k++)
            p[i][k] = rad_rand(5, 3 * i + k) * (k == 1 ? 2 : 1);
}

TEST(equal_shares_hold_as_many_points)
{
    static double p[POINTS][3];
    struct rad_parts *parts;
    int n[SHARES] = { 0 };

    draw_points(p);
    parts = rad_parts_new(p, POINTS);
    ck_assert(parts != NULL);
    for (int i = 0; i < POINTS; i++) {
        double place = rad_parts_place(parts, p[i]);

        ck_assert(place >= 0 && place < 1);
        /* to a leaf of 512 */
        ck_assert_double_eq_tol(place, (i + .5) / POINTS, 2. / 512);
        n[(int)(place * SHARES)]++;
    }
    for (int i = 0; i < SHARES; i++)
        ck_assert_int_le(abs(n[i] - POINTS / SHARES), 8);
    rad_parts_free(parts);
}

/* An eighth of a box of sides 1, 2 and 1 has sides of a half and once of one,
 * or of a half: not a slice. */
TEST(shares_are_compact)
{
    static double p[POINTS][3];
    double lo[SHARES][3], hi[SHARES][3];
    struct rad_parts *parts;

    draw_points(p);
    parts = rad_parts_new(p, POINTS);
    for (int i = 0; i < SHARES; i++)
        for (int k = 0; k < 3; k++) {
            lo[i][k] = INFINITY;
            hi[i][k] = -INFINITY;
        }
    for (int i = 0; i < POINTS; i++) {
        int s = (int)(rad_parts_place(parts, p[i]) * SHARES);

        for (int k = 0; k < 3; k++) {
            lo[s][k] = fmin(lo[s][k], p[i][k]);
            hi[s][k] = fmax(hi[s][k], p[i][k]);
        }
    }
    for (int s = 0; s < SHARES; s++) {
        double v = 1;

        for (int k = 0; k < 3; k++) {
            ck_assert_double_lt(hi[s][k] - lo[s][k], 1.1);
            v *= hi[s][k] - lo[s][k];
        }
        ck_assert_double_lt(v, .3);
    }
    rad_parts_free(parts);
}

TEST(points_at_one_place_and_single_ones_have_a_place)
{
    static double same[100][3];
    double one[1][3] = { { 1, 2, 3 } };
    struct rad_parts *parts = rad_parts_new(same, 100);
    double place = rad_parts_place(parts, same[0]);

    ck_assert(place >= 0 && place < 1);
    rad_parts_free(parts);
    parts = rad_parts_new(one, 1);
    ck_assert_double_eq(rad_parts_place(parts, one[0]), .5);
    rad_parts_free(parts);
}
