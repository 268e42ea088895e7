/* check_shelf.c - base lines that come in pieces */
#include "config.h"

#include "machine/shelf.h"
#include "proto/frame.h"
#include "tests/unit.h"

#include <stdint.h>
#include <string.h>

enum { WIDTH = 40, NDENSITY = 11, CHANNELS = 3, PIXEL = 4 * CHANNELS };

static const struct shelf_size size = { WIDTH, NDENSITY, CHANNELS };
static uint8_t pixels[WIDTH * PIXEL], density[NDENSITY];
static struct shelf shelf;

static void
set_up(void)
{
    for (unsigned i = 0; i < sizeof pixels; i++)
        pixels[i] = (uint8_t)(7 * i + 1);
    for (unsigned i = 0; i < sizeof density; i++)
        density[i] = (uint8_t)(i + 100);
    memset(&shelf, 0, sizeof shelf);
}

static void
tear_down(void)
{
    shelf_clear(&shelf);
}

FIXTURE(set_up, tear_down)

/* Columns [x, x + n) and densities [first, first + nd) of the line. */
static struct msg_base_line
piece(uint32_t x, uint32_t n, uint32_t first, uint32_t nd)
{
    return (struct msg_base_line){ .x = x,
                                   .n = n,
                                   .first = first,
                                   .ndensity = nd,
                                   .channels = CHANNELS,
                                   .pixels = pixels + (size_t)x * PIXEL,
                                   .density = density + first };
}

static void
put(uint32_t x, uint32_t n, uint32_t first, uint32_t nd)
{
    struct msg_base_line m = piece(x, n, first, nd);

    ck_assert(shelf_fits(&size, &m));
    ck_assert_int_eq(shelf_put(&shelf, &m), 0);
}

static void
expect(uint32_t nx, uint32_t nd)
{
    ck_assert_uint_eq(shelf.nx, nx);
    ck_assert_uint_eq(shelf.nd, nd);
    ck_assert(nx == 0 || memcmp(shelf.pixels, pixels, nx * PIXEL) == 0);
    ck_assert(nd == 0 || memcmp(shelf.density, density, nd) == 0);
    ck_assert(shelf_is_whole(&shelf, &size) == (nx == WIDTH && nd == NDENSITY));
}

TEST(pieces_make_the_line)
{
    expect(0, 0);
    put(0, 4, 0, 0);
    expect(4, 0);
    put(4, 30, 0, 8);
    put(34, 6, 8, 2);
    expect(40, 10);
    put(40, 0, 10, 1);
    expect(WIDTH, NDENSITY);
}

/* As when another sender begins at the beginning. */
TEST(pieces_come_again_and_overlap)
{
    put(0, 20, 0, 5);
    put(0, 20, 0, 5);
    expect(20, 5);
    put(0, 12, 0, 7);
    expect(20, 7);
    put(10, 20, 3, 3);
    expect(30, 7);
    put(0, WIDTH, 0, NDENSITY);
    expect(WIDTH, NDENSITY);
    put(3, 5, 2, 1);
    expect(WIDTH, NDENSITY);
}

TEST(a_piece_that_leaves_a_gap_is_dropped)
{
    put(8, 4, 0, 2);
    expect(0, 0);
    put(0, 8, 0, 2);
    put(9, 31, 2, 9);
    expect(8, 2);
    put(8, 32, 3, 8);
    expect(8, 2);
    put(8, 32, 2, 9);
    expect(WIDTH, NDENSITY);
}

TEST(pixels_of_other_kinds_do_not_mix)
{
    struct msg_base_line m = piece(10, 5, 0, 0);

    put(0, 10, 0, 0);
    m.channels = 4;
    ck_assert(!shelf_fits(&size, &m));
    ck_assert_int_eq(shelf_put(&shelf, &m), 0);
    expect(10, 0);
}

static const struct {
    uint32_t x, n, first, nd;
    bool fits;
} places[] = {
    { 0, 40, 0, 11, true },
    { 40, 0, 11, 0, true },
    { 0, 41, 0, 0, false },
    { 40, 1, 0, 0, false },
    { 41, 0, 0, 0, false },
    { 0, 0, 0, 12, false },
    { 0, 0, 12, 0, false },
    { 0, 0, 11, 1, false },
    { UINT32_MAX, 1, 0, 0, false },
    { 1, UINT32_MAX, 0, 0, false },
    { 0, 0, UINT32_MAX, 1, false },
    { 0, 0, 1, UINT32_MAX, false },
    { 30, UINT32_MAX - 20, 0, 0, false },
};

/* Sums of what a message says may overflow. */
LOOP_TEST(what_lies_outside_does_not_fit, N_ELEM(places))
{
    const struct msg_base_line m = { .x = places[_i].x,
                                     .n = places[_i].n,
                                     .first = places[_i].first,
                                     .ndensity = places[_i].nd,
                                     .channels = CHANNELS };

    ck_assert(shelf_fits(&size, &m) == places[_i].fits);
}

TEST(a_long_line_is_handed_on_in_pieces_that_fit_a_message)
{
    enum { LONG = 65535 };
    static const struct shelf_size most = { LONG, 0, 4 };
    static uint8_t row[LONG * 16];
    struct msg_base_line m = { .n = LONG, .channels = 4, .pixels = row };
    uint32_t x = 0, first = 0, sum = 0;
    struct msg out = { .type = MSG_BASE_LINE };
    struct wire_out w;
    int n = 0;

    row[16 * (LONG - 1)] = 9;
    ck_assert_int_eq(shelf_put(&shelf, &m), 0);
    ck_assert(shelf_is_whole(&shelf, &most));
    ck_assert_uint_ge(shelf_bytes(&shelf), sizeof row);
    wire_out_init(&w, MSG_FRAME_MAX);
    for (; shelf_piece(&shelf, &x, &first, &out.base_line); n++) {
        ck_assert_uint_eq(out.base_line.x, sum);
        sum += out.base_line.n;
        ck_assert_uint_eq(x, sum);
        out.base_line.job = row;
        w.len = 0;
        ck_assert_int_eq(msg_pack(&w, &out), 0);
    }
    ck_assert_uint_eq(sum, LONG);
    ck_assert_int_eq(n, 4);
    ck_assert_uint_eq(out.base_line.pixels[16 * ((size_t)out.base_line.n - 1)],
                      9);
    wire_out_release(&w);
}

/* With -ps 1 a base line leaves no densities. */
TEST(a_line_may_have_columns_alone)
{
    static const struct shelf_size bare = { WIDTH, 0, CHANNELS };
    struct msg_base_line m = piece(0, WIDTH, 0, 0);
    uint32_t x = 0, first = 0;

    m.density = NULL;
    ck_assert(shelf_fits(&bare, &m));
    ck_assert_int_eq(shelf_put(&shelf, &m), 0);
    ck_assert(shelf_is_whole(&shelf, &bare));
    ck_assert(shelf_piece(&shelf, &x, &first, &m));
    ck_assert(m.n == WIDTH && m.ndensity == 0 && m.density);
    ck_assert(!shelf_piece(&shelf, &x, &first, &m));
}

/* Whoever gets the line while it comes gets each part once. */
TEST(what_came_since_is_handed_on)
{
    struct msg_base_line m;
    uint32_t x = 0, first = 0;

    ck_assert(!shelf_piece(&shelf, &x, &first, &m));
    put(0, 10, 0, 0);
    ck_assert(shelf_piece(&shelf, &x, &first, &m));
    ck_assert(m.x == 0 && m.n == 10 && m.ndensity == 0);
    ck_assert(!shelf_piece(&shelf, &x, &first, &m));
    put(10, 0, 0, 3);
    ck_assert(shelf_piece(&shelf, &x, &first, &m));
    ck_assert(m.n == 0 && m.first == 0 && m.ndensity == 3);
    put(10, 30, 3, 8);
    ck_assert(shelf_piece(&shelf, &x, &first, &m));
    ck_assert(m.x == 10 && m.n == 30 && m.first == 3 && m.ndensity == 8);
    ck_assert_mem_eq(m.pixels, pixels + (size_t)10 * PIXEL, (size_t)30 * PIXEL);
    ck_assert(!shelf_piece(&shelf, &x, &first, &m));
}
