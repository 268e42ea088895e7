/* check_data.c - tests of src/scene/file/data.c: grids and pictures as
 * functions */
#include "config.h"

#include "scene/file/data.h"
#include "tests/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rad_data *
parse(struct rad_arena *arena, const char *text, struct rad_error *err)
{
    char *copy = malloc(strlen(text) + 1); /* without a NUL behind it */
    struct rad_data *d;

    ck_assert_ptr_nonnull(copy);
    memcpy(copy, text, strlen(text));
    rad_arena_init(arena);
    d = rad_data_parse(arena, copy, strlen(text), err);
    free(copy);
    return d;
}

#define LINE   "1 10 20 3  5 7 1"
#define PLACES "1 0 0 4  0 1 3 7  10 20 40 80"
#define FALL   "1 0 0 4  7 3 1 0  80 40 20 10"
#define BACK   "1 20 10 3  1 7 5"
#define TABLE  "# rows by x\n2\n0 1 2 # x\n0 20 3\n1 2 3\n4 5 7\n"

static const struct {
    const char *text;
    double at[2], value;
} values[] = {
    { LINE, { 10 }, 5 },
    { LINE, { 15 }, 7 },
    { LINE, { 18 }, 3.4 },
    { LINE, { 20 }, 1 },
    { LINE, { 8 }, 4.2 },                 /* straight on */
    { LINE, { 5 }, 3 },                   /* as far as one step */
    { LINE, { 0 }, 2 * 5 / 2. - 7 / 2. }, /* then as 1/2, at two steps */
    { LINE, { -10 }, 1 * 3 / 4. },
    { LINE, { 25 }, -5 },
    { LINE, { 30 }, (2 * 1 - 7) / 4. }, /* beyond the last: as 1 / (1 + 3) */
    { LINE, { 1e30 }, 0 },
    { LINE, { -1e30 }, 0 },
    { BACK, { 18 }, 3.4 },
    { BACK, { 8 }, 4.2 },
    { PLACES, { 0 }, 10 },
    { PLACES, { .5 }, 15 },
    { PLACES, { 1 }, 20 },
    { PLACES, { 2 }, 30 },
    { PLACES, { 6 }, 70 },
    { PLACES, { 7 }, 80 },
    { PLACES, { 11 }, 120 },
    { PLACES, { -1 }, 0 },
    { FALL, { .5 }, 15 },
    { FALL, { 2 }, 30 },
    { FALL, { 6 }, 70 },
    { FALL, { 3 }, 40 },
    { TABLE, { 0, 0 }, 1 },
    { TABLE, { 1, 20 }, 7 },
    { TABLE, { 0, 15 }, 2.5 },
    { TABLE, { .5, 15 }, 4.25 },
    { TABLE, { 1, 5 }, 4.5 },
    { "1 0 1 2 1e2 +.5e1", { .5 }, 52.5 },
    { "+1 0 +1 +2 1 3", { .5 }, 2 },
    { "\xef\xbb\xbf"
      "1 0 1 2 1 3",
      { .5 },
      2 },
    { "1 0 1 2 .5#half\n1.5#", { .5 }, 1 },
};

LOOP_TEST(value_is_interpolated, N_ELEM(values))
{
    struct rad_error err = { 0 };
    struct rad_arena arena;
    struct rad_data *d = parse(&arena, values[_i].text, &err);

    ck_assert_msg(d != NULL, "%s", err.what);
    ck_assert_double_eq_tol(rad_data_value(d, values[_i].at), values[_i].value,
                            1e-6 * (1 + fabs(values[_i].value)));
    rad_arena_release(&arena);
}

/* f = 1 + 2a + 3b + 5c + 7d + 11e + 13f is a plane in six dimensions. */
TEST(six_dimensions_are_interpolated)
{
    static const double slope[6] = { 2, 3, 5, 7, 11, 13 };
    static const double at[6] = { .5, .25, .125, .75, .3, .9 };
    static const double last[3] = { .9, 0, .4 }; /* of a row of values */
    char text[1024] = "6 ";
    double truth = 1, row[3];
    struct rad_error err = { 0 };
    struct rad_arena arena;
    struct rad_data *d;

    for (int k = 0; k < 6; k++) {
        strcat(text, "0 1 2 ");
        truth += slope[k] * at[k];
    }
    for (int i = 0; i < 64; i++) {
        double v = 1;

        for (int k = 0; k < 6; k++)
            v += i >> (5 - k) & 1 ? slope[k] : 0;
        snprintf(text + strlen(text), 20, "%g ", v);
    }
    d = parse(&arena, text, &err);
    ck_assert_msg(d != NULL, "%s", err.what);
    ck_assert_int_eq(rad_data_dims(d), 6);
    ck_assert_double_eq_tol(rad_data_value(d, at), truth, 1e-5);
    rad_data_row(d, at, last, 3, row);
    for (int i = 0; i < 3; i++)
        ck_assert_double_eq_tol(row[i], truth + slope[5] * (last[i] - at[5]),
                                1e-5);
    rad_arena_release(&arena);
}

static const struct {
    const char *text, *problem;
} bad[] = {
    { "", "line 1: data file ends early" },
    { "# nothing\n", "line 2: data file ends early" },
    { "0", "no dimensions" },
    { "7 0 1 2 0 1 2 0 1 2", "7 dimensions, at most 6" },
    { "1.5 0 1 2 1 2", "expected a whole number" },
    { "1 0 1 1 5", "fewer than 2 points" },
    { "1 0 1 3 1 2", "data file ends early" },
    { "1 0 1 999999999 1 2", "fewer numbers than it says" },
    { "2 0 1 9 0 1 9 1 2 3 4 5 6 7 8 9 10", "fewer values than points" },
    { "1 0 1 99999999999999999999 1 2", "fewer numbers than it says" },
    { "1\n0 1 2\n1 x", "line 3: expected a number" },
    { "1\n0 1 2\n1 2x", "line 3: expected a number" },
    { "1\n0 1 2\n1 nan", "line 3: expected a number" },
    { "1\n0 1 2\n1 0x10", "line 3: expected a number" },
    { "1\n0 1 2\n1 1e39", "number out of range" },
    { "1\n-3e38 3e38 2\n1 2", "places too far apart" },
    { "1\n0 0 3 1 2 2\n1 2 3", "places neither rise nor fall" },
    { "1 0 1 2 1 "
      "0000000000000000000000000000000000000000000000000000000000000000000001",
      "word too long" },
};

LOOP_TEST(bad_data_file_is_refused, N_ELEM(bad))
{
    struct rad_error err = { 0 };
    struct rad_arena arena;

    ck_assert_ptr_null(parse(&arena, bad[_i].text, &err));
    ck_assert_int_eq(err.code, RAD_EDATA);
    ck_assert_msg(strstr(err.what, bad[_i].problem) != NULL, "%s", err.what);
    rad_arena_release(&arena);
}

/* --- pictures ------------------------------------------------------------ */

static struct rad_pict *
parse_picture(struct rad_arena *arena, const char *text, size_t n,
              struct rad_error *err)
{
    struct rad_memory_in from = { text, n };
    struct rad_stream in = rad_memory_stream(&from);

    return rad_pict_parse(arena, &in, true, err);
}

/* Three columns, two rows; the mantissa of red is the column, of green the row
 * from the bottom, both in 32nds; each with its half step. */
static struct rad_pict *
make_picture(struct rad_arena *arena, const char *head, const char *axes,
             struct rad_error *err)
{
    char text[512];
    size_t n;
    bool xmajor = strchr(axes, 'X') < strchr(axes, 'Y');

    n = (size_t)snprintf(text, sizeof text,
                         "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n%s\n%s\n", head,
                         axes);
    for (int scan = 0; scan < (xmajor ? 3 : 2); scan++)
        for (int i = 0; i < (xmajor ? 2 : 3); i++) {
            int x = xmajor ? scan : i, y = xmajor ? i : scan;

            if (strstr(axes, "-X"))
                x = 2 - x;
            if (strstr(axes, "-Y"))
                y = 1 - y;
            text[n++] = (char)(x * 32);
            text[n++] = (char)(y * 32);
            text[n++] = 7;
            text[n++] = (char)129;
        }
    rad_arena_init(arena);
    return parse_picture(arena, text, n, err);
}

static const struct {
    const char *head, *axes;
    double x, y, column, row;
} pixels[] = {
    { "", "-Y 2 +X 3", 0, 0, 0, 0 },
    { "", "-Y 2 +X 3", 1.5, 1, 2, 1 },
    { "", "-Y 2 +X 3", .75, .25, 1, .25 },
    { "", "-Y 2 +X 3", .375, .5, .5, .5 },
    { "", "+Y 2 +X 3", .375, .25, .5, .25 },
    { "", "-Y 2 -X 3", .375, .25, .5, .25 },
    { "", "+Y 2 -X 3", .375, .25, .5, .25 },
    { "", "+X 3 +Y 2", .375, .25, .5, .25 },
    { "", "-X 3 +Y 2", .375, .25, .5, .25 },
    { "", "+X 3 -Y 2", .375, .25, .5, .25 },
    { "", "-X 3 -Y 2", .375, .25, .5, .25 },
    { "EXPOSURE=4\n", "-Y 2 +X 3", 1.5, 1, 2, 1 }, /* as stored */
    { "PIXASPECT=3\n", "-Y 2 +X 3", 1, 2, 2, 1 },  /* 1 wide, 2 high */
    { "PIXASPECT=.5\n", "-Y 2 +X 3", 3, .5, 2, .5 },
    { "", "-Y 2 +X 3", -.375, 1.5, -.5, 1.5 }, /* straight on */
};

LOOP_TEST(picture_is_interpolated, N_ELEM(pixels))
{
    struct rad_error err = { 0 };
    struct rad_arena arena;
    struct rad_pict *p =
        make_picture(&arena, pixels[_i].head, pixels[_i].axes, &err);
    double rgb[3], half = 1 / 256.;

    ck_assert_msg(p != NULL, "%s", err.what);
    rad_pict_value(p, pixels[_i].x, pixels[_i].y, rgb);
    ck_assert_double_eq_tol(rgb[0], pixels[_i].column / 4 + half, 1e-6);
    ck_assert_double_eq_tol(rgb[1], pixels[_i].row / 4 + half, 1e-6);
    ck_assert_double_eq_tol(rgb[2], 7.5 / 128, 1e-6);
    rad_arena_release(&arena);
}

TEST(one_pixel_is_the_same_everywhere)
{
    static const char text[] = "#?RADIANCE\n\n-Y 1 +X 1\n\x40\x20\x10\x81";
    struct rad_error err = { 0 };
    struct rad_arena arena;
    struct rad_pict *p;
    double rgb[3];

    rad_arena_init(&arena);
    p = parse_picture(&arena, text, sizeof text - 1, &err);
    ck_assert_msg(p != NULL, "%s", err.what);
    rad_pict_value(p, 3, -4, rgb);
    ck_assert_double_eq_tol(rgb[0], 64.5 / 128, 1e-6);
    ck_assert_double_eq_tol(rgb[2], 16.5 / 128, 1e-6);
    rad_arena_release(&arena);
}

static const char *const bad_pictures[] = {
    "",
    "#?RADIANCE\n\n-Y 2 +X 2\n",
    "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\nabcd",
    "#?RADIANCE\nPIXASPECT=-1\n\n-Y 1 +X 1\nabcd",
};

LOOP_TEST(bad_picture_is_refused, N_ELEM(bad_pictures))
{
    const char *text = bad_pictures[_i];
    struct rad_error err = { 0 };
    struct rad_arena arena;

    rad_arena_init(&arena);
    ck_assert_ptr_null(parse_picture(&arena, text, strlen(text), &err));
    ck_assert_int_eq(err.code, RAD_EDATA);
    rad_arena_release(&arena);
}
