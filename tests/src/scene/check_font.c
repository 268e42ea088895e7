/* check_font.c - tests of src/scene/file/font.c: glyphs, and where those of a
 * line are */
#include "config.h"

#include "scene/file/font.h"
#include "tests/unit.h"

#include <stdlib.h>
#include <string.h>

/* A is a box with a square hole, B a triangle over the cell, and a space. */
static const char font_text[] = "# box and hole\n"
                                "65 10\n 50 50 200 50 200 200 50 200 50 50\n"
                                "100 100 150 100 150 150 100 150 100 100\n"
                                "32 0 # space\n"
                                "66 3\t0 0 254 0 128 254\n";
/* mean width: ((200-50) + 254) / 2 */
#define MEAN 202

static struct rad_arena arena;
static struct rad_font *font;

static void
setup(void)
{
    rad_arena_init(&arena);
    font = rad_font_parse(&arena, font_text, strlen(font_text), NULL);
}

static void
teardown(void)
{
    rad_arena_release(&arena);
}

FIXTURE(setup, teardown)

TEST(font_has_the_glyphs_of_its_file)
{
    ck_assert_ptr_nonnull(font);
    ck_assert_int_eq(font->mean_width, MEAN);
    ck_assert_int_eq(font->glyph['A']->nverts, 10);
    ck_assert_int_eq(font->glyph['A']->left, 50);
    ck_assert_int_eq(font->glyph['A']->top, 200);
    ck_assert_int_eq(font->glyph[' ']->nverts, 0);
    ck_assert_ptr_null(font->glyph['C']);
}

static const struct {
    char c;
    double x, y;
    bool in;
} place[] = {
    { 'A', 60, 60, true },     { 'A', 125, 125, false }, /* the hole */
    { 'A', 160, 125, true },   { 'A', 49.9, 125, false },
    { 'A', 100, 99.9, true },  { 'B', 128, 253, true },
    { 'B', 100, 250, false },  { 'B', 127, 0, true },
    { 'B', 5, 5, true },       { 'B', 5, 20, false },
    { 'B', 253.5, 0.5, true }, { ' ', 128, 128, false },
};

LOOP_TEST(glyph_is_inside_by_even_odd_rule, N_ELEM(place))
{
    ck_assert_int_eq(rad_glyph_inside(font->glyph[(int)place[_i].c],
                                      place[_i].x, place[_i].y),
                     place[_i].in);
}

/* Widths and starts by hand from the extents: A 50..200, B 0..254. */
static const struct {
    const char *text;
    int spacing, width, start[4];
} setting[] = {
    { "AB", 0, 510, { 0, 255 } },
    { "A A", 0, 765, { 0, 255, 510 } },
    { "A?A", 0, 510, { 0, 255, 255 } }, /* no room for what has no glyph */
    { "", 0, 0, { 0 } },
    /* 10 before A, between, and after; 150 + 254 of letters */
    { "AB", -10, 434, { -40, 170 } },
    /* a space is as wide as the mean letter */
    { "A A", -10, 10 + 150 + 10 + MEAN + 150 + 10, { -40, 165, 322 } },
    /* one column of three: 3 * (mean + 10) where 530 are needed, the 106 to
     * spare in shares of 35, 35, 36 behind each */
    { "AAA", 10, 3 * (MEAN + 10) - 40, { -40, 155, 350 } },
    { "", 10, 10, { 0 } },
};

LOOP_TEST(line_is_set_by_hand_computed_places, N_ELEM(setting))
{
    struct rad_textline line;
    const char *s = setting[_i].text;

    ck_assert_int_eq(rad_textline_set(&line, font, &arena, s, strlen(s),
                                      setting[_i].spacing, NULL),
                     0);
    ck_assert_int_eq(line.width, setting[_i].width);
    for (int i = 0; s[i]; i++)
        ck_assert_int_eq(line.start[i], setting[_i].start[i]);
}

/* The bisection against the plain walk over all letters. */
LOOP_TEST(place_in_line_agrees_with_trying_every_letter, 5)
{
    static const char text[] = "AB BA? A   AAB BB      A AB?B A";
    static const int spacing[] = { 0, 7, 60, -7, -60 };
    struct rad_textline line;
    int inside = 0;

    ck_assert_int_eq(rad_textline_set(&line, font, &arena, text, strlen(text),
                                      spacing[_i], NULL),
                     0);
    for (double x = -3.5; x < line.width + 9; x += 1.7)
        for (double y = 5; y < 255; y += 31) {
            bool in = false;

            for (int i = 0; i < line.n && line.reach[i] <= x; i++)
                if (line.glyph[i] && x < line.width && x >= 0 &&
                    x - line.start[i] < 255)
                    in |= rad_glyph_inside(line.glyph[i], x - line.start[i], y);
            ck_assert_int_eq(rad_textline_inside(&line, x, y), in);
            inside += in;
        }
    ck_assert_int_gt(inside, 1000);
}

static const struct {
    const char *text, *what;
} bad[] = {
    { "65", "line 1: bad number of vertices for character 65" },
    { "65 2\n0 0 1", "line 2: bad vertex of character 65" },
    { "65 1 0 256", "line 1: bad vertex of character 65" },
    { "65 1 0 -1", "line 1: bad vertex of character 65" },
    { "65 -1", "line 1: bad number of vertices for character 65" },
    { "65 32001", "line 1: bad number of vertices for character 65" },
    { "0 0", "line 1: illegal character 0" },
    { "256 0", "line 1: illegal character 256" },
    { "65 0\n\n65 0", "line 3: duplicate character 65" },
    { "A 0", "line 1: expected an integer" },
    { "65 0 66x", "line 1: expected an integer" },
    { "65 0 999999999", "line 1: expected an integer" },
};

LOOP_TEST(bad_font_says_where, N_ELEM(bad))
{
    struct rad_error err = { 0 };

    ck_assert_ptr_null(
        rad_font_parse(&arena, bad[_i].text, strlen(bad[_i].text), &err));
    ck_assert_int_eq(err.code, RAD_EDATA);
    ck_assert_str_eq(err.what, bad[_i].what);
}

TEST(overlong_line_is_refused)
{
    struct rad_error err = { 0 };
    struct rad_textline line;
    size_t n = 100001;
    char *text = malloc(n);

    ck_assert_ptr_nonnull(text);
    memset(text, 'A', n);
    ck_assert_int_eq(rad_textline_set(&line, font, &arena, text, n, 0, &err),
                     RAD_EDATA);
    ck_assert_int_eq(
        rad_textline_set(&line, font, &arena, text, n - 1, 0, NULL), 0);
    ck_assert_int_eq(line.width, 25500000);
    free(text);
}
