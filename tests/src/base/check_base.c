/* check_base.c - tests of src/arith, whose functions are libm's to a few last
 * bits, and of the ground of src/base: errors, arenas, lists, vectors, random
 * numbers */
#include "config.h"

#include "arith/angle.h"
#include "base/arena.h"
#include "arith/elementary.h"
#include "base/error.h"
#include "arith/expf.h"
#include "base/help.h"
#include "base/list.h"
#include "base/rng.h"
#include "base/vec.h"
#include "tests/unit.h"

#include <float.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

TEST(first_failure_wins)
{
    struct rad_error err = { 0 };
    char buf[128];

    ck_assert_int_eq(rad_fail(&err, RAD_EDATA, "bad %d", 1), RAD_EDATA);
    ck_assert_int_eq(rad_fail(&err, RAD_EIO, "worse"), RAD_EIO);
    rad_error_where(&err, "a.rad:%d", 3);
    rad_error_where(&err, "b.rad:9");
    rad_error_format(&err, buf, sizeof buf);
    ck_assert_str_eq(buf, "a.rad:3: bad 1");
    ck_assert_int_eq(err.code, RAD_EDATA);
    ck_assert_int_eq(rad_exit_status(err.code), EX_DATAERR);
}

TEST(message_has_no_control_characters)
{
    struct rad_error err = { 0 };
    char buf[64];

    rad_fail(&err, RAD_EDATA, "undefined '%s'", "a\033[31m\n");
    rad_error_format(&err, buf, sizeof buf);
    ck_assert_str_eq(buf, "undefined 'a?[31m?'");
}

/* A long path leaves room for what is behind it. */
TEST(message_keeps_both_ends)
{
    char path[2048], buf[600];

    for (int shift = 0; shift < 2; shift++) { /* "ä" across each cut */
        struct rad_error err = { 0 };
        size_t n = 0;

        for (int i = 0; i < shift; i++)
            path[n++] = 'x';
        for (; n + 2 < sizeof path; n += 2)
            memcpy(path + n, "\xc3\xa4", 2);
        path[n] = '\0';
        rad_error_where(&err, "%s/a.rad:%d", path, 214);
        rad_fail(&err, RAD_EIO, "cannot read '%s': no such file", path);
        ck_assert_int_ge(strlen(err.what), sizeof err.what - 4);
        rad_error_format(&err, buf, sizeof buf);
        ck_assert_ptr_nonnull(strstr(buf, "/a.rad:214: cannot read '"));
        ck_assert_str_eq(buf + strlen(buf) - 15, "': no such file");
        ck_assert_ptr_null(strchr(buf, '?')); /* no half of a character */
    }
}

static int nlacks;

static void
count_lack(void)
{
    nlacks++;
}

TEST(arena_tells_that_memory_is_out)
{
    struct rad_arena a;

    rad_arena_init(&a);
    ck_assert_ptr_null(rad_arena_alloc(&a, SIZE_MAX));
    ck_assert(a.lacked);
    a.on_lack = count_lack;
    ck_assert_ptr_null(rad_arena_calloc(&a, SIZE_MAX / 8, 16));
    ck_assert_int_eq(nlacks, 1);
    rad_arena_release(&a);
}

TEST(arena_survives_rewind_and_large_blocks)
{
    struct rad_arena a;
    struct rad_arena_mark m;
    size_t total;
    char *s;

    rad_arena_init(&a);
    s = rad_arena_strndup(&a, "hello world", 5);
    ck_assert_str_eq(s, "hello");
    m = rad_arena_mark(&a);
    for (int round = 0; round < 3; round++) {
        for (int i = 0; i < 1000; i++) {
            char *p = rad_arena_alloc(&a, 1000);

            ck_assert_ptr_nonnull(p);
            ck_assert_uint_eq((uintptr_t)p % 16, 0);
            memset(p, i, 1000);
        }
        if (round == 0)
            total = a.total;
        ck_assert_uint_eq(a.total, total); /* spare blocks are used again */
        rad_arena_rewind(&a, m);
        ck_assert_str_eq(s, "hello");
    }
    ck_assert_ptr_null(rad_arena_calloc(&a, SIZE_MAX / 2, 4));
    ck_assert_ptr_null(rad_arena_alloc(&a, SIZE_MAX - 3));
    rad_arena_release(&a);
}

TEST(arena_frees_what_it_adopted_with_what_it_made_then)
{
    struct rad_arena a;
    struct rad_arena_mark m;
    size_t total;
    char *kept = malloc(1000);

    ck_assert_ptr_nonnull(kept);
    rad_arena_init(&a);
    ck_assert_ptr_eq(rad_arena_adopt(&a, kept, 1000), kept);
    memset(kept, 7, 1000);
    m = rad_arena_mark(&a);
    total = a.total;
    for (int i = 0; i < 3; i++) { /* a leak, if it is not freed */
        ck_assert_ptr_nonnull(rad_arena_adopt(&a, malloc(1 << 20), 1 << 20));
        ck_assert_uint_eq(a.total, total + (1 << 20));
        rad_arena_rewind(&a, m);
        ck_assert_uint_eq(a.total, total);
    }
    ck_assert_int_eq(kept[999], 7);
    rad_arena_release(&a);
}

TEST(list_keeps_what_is_in_it)
{
    uint16_t *v = NULL, *as_it_was;

    for (size_t n = 0; n < 1000; n++) {
        ck_assert(rad_list_grow(&v, n, sizeof *v));
        v[n] = (uint16_t)n;
    }
    for (size_t n = 0; n < 1000; n++)
        ck_assert_uint_eq(v[n], n);
    as_it_was = v;
    ck_assert(!rad_list_grow(&v, SIZE_MAX / 2 + 1, sizeof *v));
    ck_assert_ptr_eq(v, as_it_was);
    ck_assert(rad_list_grow(&v, 16, sizeof *v)); /* most were taken out again */
    ck_assert_uint_eq(v[15], 15);
    free(v);
}

TEST(normalize_keeps_extremes)
{
    static const double size[] = { 1e-300, 1e-6, 1, 1e9, 1e300 };

    for (int i = 0; i < N_ELEM(size); i++) {
        double v[3] = { 3 * size[i], 0, -4 * size[i] };

        ck_assert_double_eq_tol(rad_normalize(v) / size[i], 5, 1e-12);
        ck_assert_double_eq_tol(v[0], .6, 1e-15);
        ck_assert_double_eq_tol(v[2], -.8, 1e-15);
    }
    double zero[3] = { 0, 0, 0 }, nan[3] = { NAN, 1, 0 };

    ck_assert(rad_normalize(zero) == 0);
    ck_assert(rad_normalize(nan) == 0);
}

TEST(exponential_is_as_good_as_float_holds)
{
    for (double x = 0; x > -87; x -= 1.37e-3) {
        float e, again;

        ck_assert_double_eq_tol(rad_expf(x), exp(x), 0x1.01p-24 * exp(x));
        rad_expf2(x, x / 2, &e, &again);
        ck_assert(e == rad_expf(x) && again == rad_expf(x / 2));
    }
    ck_assert(rad_expf(0) == 1);
    ck_assert(rad_expf(-1e-300) == 1);
    ck_assert_float_eq(rad_expf(-100), (float)exp(-100)); /* denormal */
    ck_assert(rad_expf(-105) == 0);
    ck_assert(rad_expf(-1e300) == 0);
    ck_assert(rad_expf(-INFINITY) == 0);
    ck_assert(rad_expf(NAN) == 0);
}

TEST(frame_is_orthonormal)
{
    for (int i = 0; i < 1000; i++) {
        double u[3], v[3], w[3];
        double n[3] = { rad_rand(1, 3 * i) - .5, rad_rand(1, 3 * i + 1) - .5,
                        i % 7 ? rad_rand(1, 3 * i + 2) - .5 : -1e-12 };

        rad_normalize(n);
        rad_frame(u, v, n);
        rad_cross(w, u, v);
        ck_assert(fabs(rad_dot(u, n)) < 1e-14 && fabs(rad_dot(v, n)) < 1e-14);
        ck_assert(fabs(rad_dot(u, v)) < 1e-14);
        ck_assert(rad_dist2(w, n) < 1e-28);
    }
}

/* Chi-square of 256 cells, for each of the ways a number's place can vary;
 * 255 degrees of freedom: beyond 340 once in some 4000 draws. */
/* All around, in steps that meet neither axes nor eighths but at their ends. */
TEST(angles_are_those_of_libm)
{
    enum { STEPS = 8 * 331 };

    for (int i = 0; i <= STEPS; i++) {
        double want = M_PI * i / STEPS, r = exp2(i % 101 - 50);
        double y = r * sin(want), x = r * cos(want), turn, s, c;

        ck_assert_double_eq_tol(rad_angle(y, x), atan2(y, x),
                                0x1p-51 * atan2(y, x) + DBL_MIN);
        turn = M_PI / 2 * i / STEPS - M_PI / 4;
        rad_sin_cos(turn, &s, &c);
        ck_assert_double_eq_tol(s, sin(turn),
                                0x1p-52 * fabs(sin(turn)) + DBL_MIN);
        ck_assert_double_eq_tol(c, cos(turn), 0x1p-52);
    }
    ck_assert(rad_angle(0, 1) == 0 && rad_angle(1, 0) == M_PI / 2 &&
              rad_angle(0, -1) == M_PI && rad_angle(0, 0) == 0);
    ck_assert_double_eq_tol(rad_angle(1e-9, 1), 1e-9, 1e-24);
}

/* Units in the last place that x is off. */
static double
units_off(double x, long double truth)
{
    int e;

    if (x == (double)truth)
        return 0;
    frexp((double)truth, &e);
    e = e < DBL_MIN_EXP ? DBL_MIN_EXP : e;
    return (double)fabsl((x - truth) / ldexpl(1, e - DBL_MANT_DIG));
}

static double
third_power_of(double x)
{
    return rad_pow(x, 3.3);
}

static long double
third_power_ofl(long double x)
{
    return powl(x, 3.3);
}

static double
power_of_10000(double x)
{
    return rad_pow(x, 1e4);
}

static long double
power_of_10000l(long double x)
{
    return powl(x, 1e4L);
}

static double
angle_of(double x)
{
    return rad_atan2(x, -.3);
}

static long double
angle_ofl(long double x)
{
    return atan2l(x, (long double)-.3);
}

static double
length_of(double x)
{
    return rad_hypot(x, -.3e-160);
}

static long double
length_ofl(long double x)
{
    return hypotl(x, (long double)-.3e-160);
}

static const struct {
    double (*ours)(double);
    long double (*truth)(long double); /* has 11 bits more on x86 */
    double from, to;                   /* step by step, or by factors */
    bool by_factors;
    double units;
} elementary[] = {
    { rad_sin, sinl, -20, 20, false, 2 },
    { rad_sin, sinl, 1e-300, 1.6e6, true, 2 },
    { rad_cos, cosl, -20, 20, false, 2 },
    { rad_cos, cosl, 1e-9, 1.6e6, true, 2 },
    { rad_tan, tanl, -20, 20, false, 4 },
    { rad_asin, asinl, -1, 1, false, 4 },
    { rad_asin, asinl, 1e-300, 1, true, 4 },
    { rad_acos, acosl, -1, 1, false, 4 },
    { rad_atan, atanl, -3, 3, false, 2 },
    { rad_atan, atanl, 1e-300, 1e300, true, 2 },
    { angle_of, angle_ofl, -3, 3, false, 2 },
    { angle_of, angle_ofl, 1e-30, 1e307, true, 2 },
    { rad_exp, expl, -2, 2, false, 1 },
    { rad_exp, expl, -745, 709.7, false, 1 },
    { rad_log, logl, .5, 2, false, 1 },
    { rad_log, logl, 5e-324, 1e308, true, 1 },
    { rad_log10, log10l, 5e-324, 1e308, true, 1 },
    { third_power_of, third_power_ofl, 1e-90, 1e90, true, 1 },
    { power_of_10000, power_of_10000l, .94, 1.07, false, 1 },
    { rad_cbrt, cbrtl, -9, 9, false, 1 },
    { rad_cbrt, cbrtl, 5e-324, 1e308, true, 1 },
    { length_of, length_ofl, 1e-170, 1e-150, true, 4 },
    { length_of, length_ofl, 1e290, 1e308, true, 4 },
};

LOOP_TEST(elementary_functions_are_those_of_libm,
          sizeof elementary / sizeof *elementary)
{
    const int steps = 40009; /* a prime: no step is a round number */
    double worst = 0, at = 0;

    for (int i = 1; i < steps; i++) {
        double share = (double)i / steps;
        double from = elementary[_i].from, to = elementary[_i].to;
        double x = elementary[_i].by_factors
                       ? exp2(log2(from) + share * (log2(to) - log2(from)))
                       : from + share * (to - from);
        double off = units_off(elementary[_i].ours(x), elementary[_i].truth(x));

        if (off > worst || isnan(off)) {
            worst = off;
            at = x;
        }
    }
    ck_assert_msg(worst <= elementary[_i].units, "%g units at %.17g", worst,
                  at);
}

TEST(elementary_functions_end_as_those_of_libm)
{
    static const double odd[] = { 0,   -0., 1,       -1,       2,
                                  -2,  3,   -3,      INFINITY, -INFINITY,
                                  NAN, .5,  1.5e308, -1e308 };

    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        double x = odd[i];

        ck_assert(rad_exp(x) == exp(x) || isnan(x) ||
                  fabs(rad_exp(x) / exp(x) - 1) < 1e-15);
        ck_assert(isnan(rad_log(x)) == isnan(log(x)));
        ck_assert(isinf(rad_log(x)) == isinf(log(x)));
        ck_assert(isnan(rad_sin(x)) == isnan(sin(x)));
        ck_assert(isnan(rad_acos(x)) == isnan(acos(x)));
        ck_assert(isnan(rad_cbrt(x)) == isnan(x));
        for (size_t j = 0; j < sizeof odd / sizeof *odd; j++) {
            double want = pow(x, odd[j]), have = rad_pow(x, odd[j]);

            ck_assert_msg((isnan(want) && isnan(have)) || have == want ||
                              fabs(have - want) <= 1e-15 * fabs(want),
                          "%g to the power of %g: %g", x, odd[j], have);
            ck_assert(signbit(want) == signbit(have) || isnan(want));
            want = atan2(x, odd[j]);
            have = rad_atan2(x, odd[j]);
            ck_assert_msg((isnan(want) && isnan(have)) ||
                              (fabs(have - want) <= 1e-15 * fabs(want) &&
                               signbit(want) == signbit(have)),
                          "angle of (%g, %g): %g", odd[j], x, have);
            want = hypot(x, odd[j]);
            have = rad_hypot(x, odd[j]);
            ck_assert_msg((isnan(want) && isnan(have)) || have == want ||
                              fabs(have - want) <= 1e-15 * want,
                          "length of (%g, %g): %g", odd[j], x, have);
        }
    }
    ck_assert(rad_pow(2, 1e300) == INFINITY && rad_pow(.5, 1e300) == 0);
    ck_assert(rad_pow(1, 1.7e308) == 1 && rad_pow(1, -1.7e308) == 1);
    ck_assert(signbit(rad_sin(-0.)) && signbit(rad_tan(-0.)));
    ck_assert(rad_pow(1, 1e300) == 1 && rad_pow(-1, 1e300) == 1);
    ck_assert(rad_log(1) == 0 && rad_exp(0) == 1 && rad_log10(1000) == 3);
    ck_assert(rad_exp(710) == INFINITY && rad_exp(-746) == 0);
    ck_assert_double_eq_tol(rad_cos(M_PI / 2), 6.123233995736766e-17, 1e-31);
}

LOOP_TEST(numbers_are_even_along_every_axis, 4)
{
    enum { N = 256 * 256 };
    int cell[256] = { 0 };
    double chi = 0;

    for (uint32_t i = 0; i < N; i++) {
        uint64_t key = rad_key_pixel(0, 0, 7, 11);
        uint32_t dim = 0;

        switch (_i) {
        case 0: /* pixels */
            key = rad_key_pixel(0, 0, i & 255, i >> 8);
            break;
        case 1: /* branches */
            key = rad_key_branch(key, i);
            break;
        case 2: /* dimensions */
            dim = i;
            break;
        case 3: /* seeds */
            key = rad_key_pixel(i, 0, 7, 11);
            break;
        }
        double u = rad_rand(key, dim);

        ck_assert(u >= 0 && u < 1);
        cell[(int)(u * 256)]++;
    }
    for (int c = 0; c < 256; c++)
        chi += (cell[c] - 256.) * (cell[c] - 256.) / 256.;
    ck_assert_msg(chi < 340 && chi > 170, "chi-square %g", chi);
}

#define INDENT "                              "

static const struct {
    const char *head, *text, *rows;
} helps[] = {
    { "-o FILE", "the picture", "  -o FILE                     the picture\n" },
    { "--twenty-six-letters-long", "x", "  --twenty-six-letters-long   x\n" },
    { "--twenty-seven-letters-long-", "x",
      "  --twenty-seven-letters-long-\n" INDENT "x\n" },
    { "-a", "", "  -a\n" },
    /* 49 columns are a line, and the 50th begins the next */
    { "-a", "1234567890 1234567890 1234567890 1234567890 12345",
      "  -a                          "
      "1234567890 1234567890 1234567890 1234567890 12345\n" },
    { "-a", "1234567890 1234567890 1234567890 1234567890 123456 7",
      "  -a                          "
      "1234567890 1234567890 1234567890 1234567890\n" INDENT "123456 7\n" },
    /* a word that fits on no line is not cut */
    { "-a", "12345678901234567890123456789012345678901234567890 2",
      "  -a                          "
      "12345678901234567890123456789012345678901234567890\n" INDENT "2\n" },
};

static void
append_line(void *arg, const char *text)
{
    strcat(arg, text);
    strcat(arg, "\n");
}

LOOP_TEST(help_is_as_wide_as_a_terminal, N_ELEM(helps))
{
    char rows[500] = "";

    rad_help_row(helps[_i].head, helps[_i].text, append_line, rows);
    ck_assert_str_eq(rows, helps[_i].rows);
}
