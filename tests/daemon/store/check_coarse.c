/* check_coarse.c - a frame as a lattice of its pixels shows it */
#include "config.h"

#include "folder/coarse.h"
#include "folder/rows.h"
#include "image/hdr.h"
#include "tests/unit.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 100 };

static uint8_t colours[4 * 64], row[4 * MOST];

/* A picture that is bright to the right and below. */
static double
ramp(int x, int y)
{
    return 1 + .02 * x + .03 * y;
}

/* Put the whole lattice of that step. */
static void
put(struct coarse *c, int width, int height, int step)
{
    for (int y = 0; y < height; y += step)
        for (int x = 0; x < width; x += step) {
            struct action_colours k = { 0, x, y, step, 1, 1, colours };

            rad_rgbe(rad_grey((float)ramp(x, y)), colours);
            ck_assert(coarse_put(c, &k));
        }
}

/* The grey of a pixel of row y, as a preview has it. */
static double
filled(struct coarse *c, int x, int y)
{
    memset(row, 0, sizeof row);
    coarse_fill(c, y, row);
    return rad_rgbe_radiance(row + 4 * (size_t)x).g;
}

static const struct {
    int width, height, step;
} sizes[] = { { 1, 1, 32 },   { 1, 1, 8 },    { 8, 9, 8 },    { 7, 65, 32 },
              { 64, 64, 32 }, { 65, 1, 16 },  { 97, 75, 64 }, { 97, 75, 256 },
              { 97, 75, 32 }, { 97, 75, 16 }, { 97, 75, 8 },  { 33, 31, 8 } };

/* Whatever the lattice, a plane comes out as itself between its pixels, and
 * beyond the last of them as that one. */
LOOP_TEST(a_lattice_fills_the_picture, N_ELEM(sizes))
{
    int w = sizes[_i].width, h = sizes[_i].height, step = sizes[_i].step;
    struct coarse *c = coarse_new(w, h);

    ck_assert_ptr_nonnull(c);
    ck_assert_double_eq(filled(c, 0, 0), 0);
    put(c, w, h, step);
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            int lastx = (w - 1) / step * step, lasty = (h - 1) / step * step;
            double want = ramp(x < lastx ? x : lastx, y < lasty ? y : lasty);

            ck_assert_double_eq_tol(filled(c, x, y), want, .02 * want);
        }
    coarse_free(c);
}

/* A finer lattice that is only begun: the coarser one shows elsewhere, and no
 * longer where the finer one is. */
TEST(a_finer_lattice_takes_the_place_of_a_coarser_one)
{
    struct coarse *c = coarse_new(97, 75);
    struct action_colours k = { 0, 0, 0, 8, 8, 8, colours };

    put(c, 97, 75, 32);
    for (size_t i = 0; i < 64; i++)
        rad_rgbe(rad_grey(50), colours + 4 * i);
    ck_assert(coarse_put(c, &k));
    ck_assert_double_eq_tol(filled(c, 20, 20), 50, .5);
    ck_assert_double_eq_tol(filled(c, 80, 60), ramp(80, 60), .1);
    ck_assert_double_eq_tol(filled(c, 64, 56), ramp(64, 56), .1);
    coarse_free(c);
}

/* Black ones, too. */
TEST(pixels_that_came_stand_as_they_are)
{
    struct coarse *c = coarse_new(40, 20);

    put(c, 40, 20, 8);
    coarse_mark(c, 3, 5, 10, 2);
    for (int y = 0; y < 20; y++)
        for (int x = 0; x < 40; x++) {
            bool came = x >= 3 && x < 13 && y >= 5 && y < 7;

            ck_assert_int_eq(filled(c, x, y) == 0, came);
        }
    coarse_free(c);
}

static const struct action_colours wrong[] = {
    { 0, 0, 0, 4, 1, 1, colours },         { 0, 0, 0, 512, 1, 1, colours },
    { 0, 0, 0, 12, 1, 1, colours },        { 0, 4, 0, 8, 1, 1, colours },
    { 0, 0, 4, 8, 1, 1, colours },         { 0, -8, 0, 8, 1, 1, colours },
    { 0, 0, -8, 8, 1, 1, colours },        { 0, 40, 0, 8, 1, 1, colours },
    { 0, 0, 24, 8, 1, 1, colours },        { 0, 0, 0, 8, 6, 1, colours },
    { 0, 0, 0, 8, 1, 4, colours },         { 0, 0, 0, 8, 0, 1, colours },
    { 0, 0, 0, 8, 1, 0, colours },         { 0, 16, 0, 16, 3, 1, colours },
    { 0, 0, 0, 8, INT32_MAX, 1, colours },
};

LOOP_TEST(what_lies_on_no_lattice_is_refused, N_ELEM(wrong))
{
    struct coarse *c = coarse_new(40, 20);

    ck_assert(!coarse_put(c, &wrong[_i]));
    coarse_free(c);
}

/* So many frames may have colours as there is room for; they count until they
 * are dropped. */
TEST(colours_of_all_frames_are_bounded)
{
    struct action_colours k = { 0, 0, 0, 32, 1, 1, colours };
    struct rows_open among = { .coarse_bytes =
                                   COARSE_MOST - coarse_bytes(40, 20) };
    struct rows r[2] = {
        { .among = &among, .fd = -1, .width = 40, .height = 20 },
        { .among = &among, .fd = -1, .width = 40, .height = 20 }
    };

    rows_put_colours(&r[0], &k);
    rows_put_colours(&r[1], &k);
    ck_assert(r[0].coarse && !r[1].coarse);
    ck_assert_uint_eq(among.coarse_bytes, COARSE_MOST);
    rows_drop_colours(&r[0]);
    rows_put_colours(&r[1], &k);
    ck_assert(!r[0].coarse && r[1].coarse);
    rows_release(&r[1]);
    ck_assert_uint_eq(among.coarse_bytes, COARSE_MOST - coarse_bytes(40, 20));
}

/* No size overflows. */
TEST(huge_frames_have_none)
{
    struct action_colours k = { 0, 0, 0, 32, 1, 1, colours };
    struct rows_open among = { 0 };
    struct rows r = {
        .among = &among, .fd = -1, .width = MSG_MAX_SIDE, .height = MSG_MAX_SIDE
    };

    ck_assert_uint_gt(coarse_bytes(MSG_MAX_SIDE, MSG_MAX_SIDE), COARSE_MOST);
    rows_put_colours(&r, &k);
    ck_assert_ptr_null(r.coarse);
}
