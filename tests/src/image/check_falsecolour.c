/* check_falsecolour.c - scales of false colour, their divisions and legends */
#include "config.h"

#include "tone/falsecolour.h"

#include "tests/unit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LM_PER_W 179

/* Of values in cd/m2. */
static struct rad_picture
picture(int width, int height, const double *value)
{
    size_t n = (size_t)width * (size_t)height;
    struct rad_picture p = { .width = width,
                             .height = height,
                             .pixaspect = 1,
                             .L = malloc(n * sizeof *p.L) };

    for (size_t i = 0; i < n; i++)
        p.L[i] = rad_grey((float)(value[i] / LM_PER_W));
    return p;
}

static struct rad_false_scale s;
static struct rad_image m;

static void
tear_down(void)
{
    free(m.rgb);
    m.rgb = NULL;
}

FIXTURE(NULL, tear_down)

static const uint8_t *
at(const struct rad_image *image, int x, int y)
{
    return image->rgb + 3 * ((size_t)y * (size_t)image->width + (size_t)x);
}

static int
light(const uint8_t *rgb)
{
    return 2126 * rgb[0] + 7152 * rgb[1] + 722 * rgb[2];
}

static const struct {
    const char *text;
    double top, decades; /* top 0: it is refused */
    int divisions;
    enum rad_contour contour;
    const char *label;
} scales[] = {
    { "500", 500, -1, 0, RAD_CONTOUR_NONE, "" },
    { "500,log=2", 500, 2, 0, RAD_CONTOUR_NONE, "" },
    { "2e4,n=8,contour=lines", 2e4, -1, 8, RAD_CONTOUR_LINES, "" },
    { ".5,contour=bands,label=nits", .5, -1, 0, RAD_CONTOUR_BANDS, "nits" },
    { "1,contour=steps,log=0", 1, 0, 0, RAD_CONTOUR_STEPS, "" },
    { "0", 0, 0, 0, 0, 0 },
    { "-5", 0, 0, 0, 0, 0 },
    { "nan", 0, 0, 0, 0, 0 },
    { "10,20", 0, 0, 0, 0, 0 },
    { "10,n=0", 0, 0, 0, 0, 0 },
    { "10,n=65", 0, 0, 0, 0, 0 },
    { "10,log=-1", 0, 0, 0, 0, 0 },
    { "10,log=13", 0, 0, 0, 0, 0 },
    { "10,contour=dots", 0, 0, 0, 0, 0 },
    { "10,label=", 0, 0, 0, 0, 0 },
    { "10,label=abcdefghijklmnopqrstuvwxyz", 0, 0, 0, 0, 0 },
    { "10,label=\xc3\xa9", 0, 0, 0, 0, 0 },
    { "10,", 0, 0, 0, 0, 0 },
    { ",10", 0, 0, 0, 0, 0 },
    { "auto,auto", 0, 0, 0, 0, 0 },
};

LOOP_TEST(scales_are_read_whole, N_ELEM(scales))
{
    struct rad_error err = { 0 };
    int rc = rad_false_parse(&s, scales[_i].text, &err);

    ck_assert_int_eq(rc, scales[_i].top > 0 ? 0 : RAD_EUSAGE);
    if (rc < 0)
        return;
    ck_assert_double_eq(s.top, scales[_i].top);
    ck_assert_double_eq(s.decades, scales[_i].decades);
    ck_assert_int_eq(s.divisions, scales[_i].divisions);
    ck_assert_int_eq(s.contour, scales[_i].contour);
    ck_assert_str_eq(s.label, scales[_i].label);
}

static const struct {
    double most, top;
} tops[] = { { 1.02, 2 },  { 900, 1000 }, { 1.1e-5, 2e-5 }, { 3, 5 },
             { 4.5, 5 },   { 5.5, 10 },   { 120, 200 },     { 1e7, 2e7 } };

/* A few lamps do not decide about the end of a scale. */
LOOP_TEST(a_scale_ends_at_a_round_number, N_ELEM(tops))
{
    double v[4000];
    struct rad_picture p;

    for (int i = 0; i < 4000; i++)
        v[i] = tops[_i].most * (i % 2 ? 1 : .1);
    v[7] = 1e9;
    v[8] = INFINITY;
    v[9] = NAN;
    p = picture(40, 100, v);
    ck_assert_int_eq(rad_false_parse(&s, "", NULL), 0);
    ck_assert(rad_false_fit(&s, &p));
    ck_assert_double_eq_tol(s.top, tops[_i].top, 1e-9 * s.top);
    ck_assert_double_eq(s.decades, 3);
    ck_assert_str_eq(s.label, "cd/m2");
    rad_picture_release(&p);
}

TEST(a_black_picture_decides_nothing)
{
    static const double none[6];
    struct rad_picture p = picture(3, 2, none);

    p.irradiance = true;
    ck_assert_int_eq(rad_false_parse(&s, "auto", NULL), 0);
    ck_assert(!rad_false_fit(&s, &p));
    ck_assert_str_eq(s.label, "lux");
    ck_assert_int_eq(rad_false_colour(&s, &p, &m, NULL), 0);
    ck_assert_mem_eq(at(&m, 0, 0), at(&m, 2, 1), 3);
    rad_picture_release(&p);
}

TEST(brighter_is_lighter_up_to_the_end)
{
    double v[64];
    struct rad_picture p;

    for (int i = 0; i < 64; i++)
        v[i] = i * 100. / 60;
    p = picture(64, 1, v);
    ck_assert_int_eq(rad_false_parse(&s, "100", NULL), 0);
    rad_false_fit(&s, &p);
    ck_assert_int_eq(rad_false_colour(&s, &p, &m, NULL), 0);
    for (int i = 1; i < 60; i++)
        ck_assert_int_ge(light(at(&m, i, 0)), light(at(&m, i - 1, 0)));
    for (int i = 60; i < 64; i++)
        ck_assert_mem_eq(at(&m, i, 0), at(&m, 60, 0), 3);
    rad_picture_release(&p);
}

/* Where falsecolor -s 80 -n 8 -cp has its steps: at 10, 20, ... */
TEST(steps_begin_at_divisions)
{
    static const double v[] = { 0, 9.99, 10.01, 19.99, 20.01, 79.9, 80.1, 1e6 };
    static const int step[] = { 0, 0, 1, 1, 2, 7, 7, 7 };
    struct rad_picture p = picture(8, 1, v);

    ck_assert_int_eq(rad_false_parse(&s, "80,n=8,contour=steps", NULL), 0);
    rad_false_fit(&s, &p);
    ck_assert_int_eq(rad_false_colour(&s, &p, &m, NULL), 0);
    for (int i = 1; i < 8; i++)
        ck_assert((memcmp(at(&m, i, 0), at(&m, i - 1, 0), 3) == 0) ==
                  (step[i] == step[i - 1]));
    rad_picture_release(&p);
}

/* With log=2 and n=4 of 100: contours at 100, 31.6, 10, 3.16; none at 1. */
TEST(contours_part_neighbours)
{
    static const double v[] = { .5, .9, 1.1, 1.2, 3, 3, 3.3, 3.3,
                                9,  9,  11,  11,  90, 90, 110, 110 };
    /* those on both sides of what parts them are on a line; what is not, is
     * grey */
    static const bool line[] = { false, false, false, false, false, true,
                                 true,  false, false, true,  true,  true,
                                 true,  true,  true,  false };
    struct rad_picture p = picture(16, 1, v);

    ck_assert_int_eq(rad_false_parse(&s, "100,log=2,n=4,contour=lines", NULL),
                     0);
    rad_false_fit(&s, &p);
    ck_assert_int_eq(rad_false_colour(&s, &p, &m, NULL), 0);
    for (int x = 0; x < 16; x++) {
        const uint8_t *c = at(&m, x, 0);

        ck_assert_msg((c[0] != c[1] || c[1] != c[2]) == line[x], "pixel %d",
                      x);
    }
    rad_picture_release(&p);
}

/* 5 and 10 are below what this picture has, 500 is above the scale. */
TEST(logarithmic_contours_are_at_round_numbers)
{
    static const double v[] = { 19, 19, 21,  21,  49,  49,  51,  51,
                                99, 99, 101, 101, 240, 240, 301, 301 };
    static const bool line[] = { false, true,  true,  false, false, true,
                                 true,  false, false, true,  true,  true,
                                 true,  false, false, false };
    static const int step[] = {
        0, 0, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 4, 4, 4, 4
    };
    static const char *const modes[] = { "300,log=2,contour=lines",
                                         "300,log=2,contour=steps" };
    struct rad_picture p = picture(16, 1, v);
    struct rad_image drawn[2];

    for (int i = 0; i < 2; i++) {
        ck_assert_int_eq(rad_false_parse(&s, modes[i], NULL), 0);
        rad_false_fit(&s, &p);
        ck_assert_int_eq(rad_false_colour(&s, &p, &drawn[i], NULL), 0);
    }
    for (int x = 0; x < 16; x++) {
        const uint8_t *c = at(&drawn[0], x, 0);

        ck_assert_msg((c[0] != c[1] || c[1] != c[2]) == line[x], "pixel %d", x);
    }
    for (int x = 1; x < 16; x++)
        ck_assert((memcmp(at(&drawn[1], x, 0), at(&drawn[1], x - 1, 0), 3) ==
                   0) == (step[x] == step[x - 1]));
    for (int i = 0; i < 2; i++)
        free(drawn[i].rgb);
    rad_picture_release(&p);
}

TEST(bands_are_a_fifth_of_a_division_wide)
{
    static const double v[] = { 8.5, 9.2, 10, 10.8, 11.2, 0, .5 };
    static const bool band[] = { false, true, true, true, false, false, false };
    struct rad_picture p = picture(7, 1, v);

    ck_assert_int_eq(rad_false_parse(&s, "100,contour=bands", NULL), 0);
    rad_false_fit(&s, &p);
    ck_assert_int_eq(rad_false_colour(&s, &p, &m, NULL), 0);
    for (int x = 0; x < 7; x++) {
        const uint8_t *c = at(&m, x, 0);

        ck_assert_msg((c[0] != c[1] || c[1] != c[2]) == band[x], "pixel %d",
                      x);
    }
    rad_picture_release(&p);
}

static const int sizes[][2] = { { 1, 1 },     { 8, 8 },   { 3000, 2 },
                                { 2, 3000 },  { 40, 90 }, { 640, 480 },
                                { 100, 5000 } };

static bool
is_lit(int left, int y)
{
    for (int x = left; x < m.width; x++)
        if (light(at(&m, x, y)) > 0)
            return true;
    return false;
}

/* Of the rows that are lit right of a column those of the title end before the
 * scale begins. */
static bool
title_is_apart(int left)
{
    int y = 0, end = m.height;

    while (!is_lit(left, y))
        y++;
    while (is_lit(left, y))
        y++;
    while (!is_lit(left, end - 1))
        end--;
    return y < end / 2;
}

/* The legend is beside the picture, whatever that is, and is inside the image:
 * its last columns and rows are black. */
LOOP_TEST(legends_fit_any_picture, N_ELEM(sizes))
{
    int w = sizes[_i][0], h = sizes[_i][1];
    double *v = calloc((size_t)w * (size_t)h, sizeof *v);
    struct rad_picture p;
    size_t lit = 0;

    for (size_t i = 0; i < (size_t)w * (size_t)h; i++)
        v[i] = 50;
    p = picture(w, h, v);
    ck_assert_int_eq(
        rad_false_parse(&s, "123456,log=5,label=WWWWWWWWWWWWWWWWWWWWWWWW",
                        NULL),
        0);
    rad_false_fit(&s, &p);
    ck_assert_int_eq(rad_false_colour(&s, &p, &m, NULL), 0);
    ck_assert_int_ge(m.height, h);
    for (int y = 0; y < m.height; y++) {
        ck_assert_int_eq(light(at(&m, m.width - 1, y)), 0);
        for (int x = w; x < m.width; x++)
            lit += light(at(&m, x, y)) > 0;
    }
    ck_assert(title_is_apart(w));
    for (int x = w; x < m.width; x++) {
        ck_assert_int_eq(light(at(&m, x, 0)), 0);
        ck_assert_int_eq(light(at(&m, x, m.height - 1)), 0);
    }
    ck_assert_uint_gt(lit, 500);
    free(v);
    rad_picture_release(&p);
}

/* Ticks of a logarithmic scale are at 1, 2, 5 and so on: 1000 is at the end of
 * the scale, and 2 is .9 of three decades below. */
TEST(ticks_are_where_their_values_are)
{
    static const double value[] = { 1000, 500, 200, 100, 50, 20, 10, 5, 2, 1 };
    double v[600] = { 0 };
    struct rad_picture p = picture(1, 600, v);
    int columns = 0;

    ck_assert_int_eq(rad_false_parse(&s, "1000,log=3", NULL), 0);
    ck_assert_int_eq(rad_false_colour(&s, &p, &m, NULL), 0);
    for (int x = 1; x < m.width; x++) {
        int n = 0, tick[300];

        for (int y = 1; y < m.height; y++)
            if (at(&m, x, y)[2] == 255 && at(&m, x, y - 1)[2] < 255)
                tick[n++] = y;
        if (n != N_ELEM(value) || tick[n - 1] - tick[0] < 500)
            continue;
        for (int i = 0; i < n; i++)
            ck_assert_double_eq_tol((tick[i] - tick[0]) /
                                        (double)(tick[n - 1] - tick[0]),
                                    1 - log10(value[i]) / 3, .003);
        columns++;
    }
    ck_assert_int_ge(columns, 1);
    rad_picture_release(&p);
}

/* Is the text drawn somewhere in these rows, right of a column? */
static bool
is_written(int left, int rows, const char *text)
{
    static const uint8_t white[3] = { 255, 255, 255 };
    int w = rad_image_text_width(text, 1);
    struct rad_image t;
    bool found = false;

    ck_assert_int_eq(rad_image_new(&t, w, RAD_FONT_HEIGHT, NULL), 0);
    rad_image_text(&t, 0, 0, 1, text, white);
    for (int y = 0; y + RAD_FONT_HEIGHT <= rows && !found; y++)
        for (int x = left; x + w <= m.width && !found; x++) {
            found = true;
            for (int k = 0; k < RAD_FONT_HEIGHT && found; k++)
                found = memcmp(at(&m, x, y + k), at(&t, 0, k),
                               (size_t)(3 * w)) == 0;
        }
    free(t.rgb);
    return found;
}

static const struct {
    int height;
    const char *scale, *end;
} ends[] = {
    { 200, "999.95,n=1", "1000" },
    { 200, "7055.2,n=4", "7055" },
    { 200, "50000,n=1", "50000" },
    { 200, "50000,log=3", "50000" },
    { 200, "123456.7,n=10,log=2,contour=lines", "123457" },
    { 200, ".05,n=2", "0.05" },
    { 200, "2e6,n=2", "2e+06" },
    { 90, "100000,n=7", "100000" }, /* from here on not all ticks have room */
    { 90, "1000,n=64", "1000" },
    { 160, "1000,log=4,n=20,contour=bands", "1000" },
    { 90, "100,log=6", "100" },
};

/* A legend says where its scale ends, in digits that are read at a glance. */
LOOP_TEST(the_end_of_a_scale_is_written_out, N_ELEM(ends))
{
    double v[200] = { 0 };
    struct rad_picture p = picture(1, ends[_i].height, v);

    ck_assert_int_eq(rad_false_parse(&s, ends[_i].scale, NULL), 0);
    ck_assert_int_eq(rad_false_colour(&s, &p, &m, NULL), 0);
    ck_assert_msg(is_written(1, 40, ends[_i].end), "%s", ends[_i].scale);
    rad_picture_release(&p);
}

TEST(text_is_of_dots)
{
    static const uint8_t white[3] = { 255, 255, 255 };
    /* T: a bar above, a stem; twice as large */

    ck_assert_int_eq(rad_image_new(&m, 12, 14, NULL), 0);
    rad_image_text(&m, 0, 0, 2, "T", white);
    for (int y = 0; y < 14; y++)
        for (int x = 0; x < 12; x++)
            ck_assert_int_eq(at(&m, x, y)[0] > 0,
                             y < 2 ? x < 10 : x == 4 || x == 5);
    ck_assert_int_eq(rad_image_text_width("cd/m2", 2), 60);
}
