/* check_partition.c - units cover each pixel once and go out in order */
#include "config.h"

#include "partition/partition.h"
#include "tests/unit.h"

#include <string.h>

static struct partition *
make(uint32_t w, uint32_t h, uint32_t windows, enum msg_order order)
{
    struct msg_frame f = { 0, w, h, "" };
    struct partition_spec spec = { .kind = MSG_PART_WINDOW,
                                   .order = order,
                                   .windows = windows,
                                   .seed = 5,
                                   .nframes = 1,
                                   .frames = &f };
    struct partition *p = partition_new(&spec, NULL);

    ck_assert_ptr_nonnull(p);
    return p;
}

/* The next unit for a worker that is alone. */
static bool
next(struct partition *p, uint32_t *unit)
{
    struct partition_ask ask = { .workers = 1, .share = 1, .idle = true };

    return partition_next(p, &ask, unit);
}

static const struct {
    uint32_t width, height, windows, units;
} sizes[] = {
    { 100, 100, 1, 1 },   { 100, 100, 7, 7 },
    { 384, 256, 64, 64 }, { 1, 100, 30, 30 },
    { 100, 1, 30, 30 },   { 37, 1, 14, 14 },
    { 3, 26, 40, 40 },    { 2, 2, 100, 4 },
    { 1, 1, 5, 1 },       { 320, 240, 320 * 240, 320 * 240 },
    { 65520, 1, 3, 3 },   { 384, 256, 0, 24 },
    { 50, 40, 0, 16 },    { 8200, 2050, 0, 4096 },
};

LOOP_TEST(every_pixel_is_in_one_window, N_ELEM(sizes))
{
    uint32_t w = sizes[_i].width, h = sizes[_i].height;
    struct partition *p = make(w, h, sizes[_i].windows, MSG_ORDER_FORWARD);
    size_t pixels = (size_t)w * h;
    uint8_t *seen = calloc(pixels, 1);
    uint64_t area = 0, twice = 0;

    ck_assert_ptr_nonnull(seen);
    ck_assert_uint_eq(partition_total(p), sizes[_i].units);
    for (uint32_t u = 0; u < partition_total(p); u++) {
        struct partition_area a;

        partition_area(p, u, &a);
        if (a.width < 1 || a.height < 1 || a.x + a.width > w ||
            a.y + a.height > h || !(partition_cost(p, u) > 0))
            ck_abort_msg("unit %u lies wrong", u);
        area += (uint64_t)a.width * a.height;
        for (uint32_t y = a.y; y < a.y + a.height; y++)
            for (uint32_t x = a.x; x < a.x + a.width; x++)
                twice += seen[(size_t)y * w + x]++;
    }
    ck_assert_uint_eq(area, pixels);
    ck_assert_uint_eq(twice, 0);
    free(seen);
    partition_free(p);
}

/* 64 windows of a picture of 384 by 256: near-equal, close to square. */
TEST(windows_are_near_equal_and_near_square)
{
    struct partition *p = make(384, 256, 64, MSG_ORDER_FORWARD);

    for (uint32_t u = 0; u < 64; u++) {
        struct partition_area a;

        partition_area(p, u, &a);
        ck_assert_uint_ge(a.width * a.height, 384 * 256 / 64 * 8 / 10);
        ck_assert_uint_le(a.width * a.height, 384 * 256 / 64 * 12 / 10);
        ck_assert_uint_le(a.width, 2 * a.height);
        ck_assert_uint_le(a.height, 2 * a.width);
    }
    partition_free(p);
}

TEST(orders_are_what_their_names_say)
{
    enum { N = 20 };
    uint32_t random[N], unit;
    struct partition *p = make(100, 100, N, MSG_ORDER_BACKWARD);
    int moved = 0;

    for (uint32_t i = 0; i < N; i++) {
        ck_assert(next(p, &unit));
        ck_assert_uint_eq(unit, N - 1 - i);
    }
    ck_assert(!next(p, &unit));
    partition_free(p);
    for (int round = 0; round < 2; round++) { /* the same each time */
        p = make(100, 100, N, MSG_ORDER_RANDOM);
        for (uint32_t i = 0; i < N; i++) {
            ck_assert(next(p, &unit));
            if (round == 0) {
                random[i] = unit;
                moved += unit != i;
            }
            ck_assert_uint_eq(unit, random[i]);
        }
        partition_free(p);
    }
    ck_assert_int_gt(moved, N / 2);
}

TEST(lost_units_go_out_before_the_others)
{
    struct partition *p = make(100, 100, 10, MSG_ORDER_FORWARD);
    uint32_t unit;

    for (int i = 0; i < 3; i++)
        ck_assert(next(p, &unit));
    partition_lost(p, 1);
    partition_lost(p, 1); /* twice is once */
    ck_assert_uint_eq(partition_waiting(p), 8);
    ck_assert(next(p, &unit) && unit == 1);
    partition_done(p, 1);
    ck_assert(next(p, &unit) && unit == 3);
    partition_free(p);
}

TEST(a_unit_that_was_taken_does_not_go_out)
{
    struct partition *p = make(100, 100, 4, MSG_ORDER_FORWARD);
    uint32_t unit;

    partition_take(p, 1);
    partition_take(p, 1);
    ck_assert_uint_eq(partition_waiting(p), 3);
    ck_assert(next(p, &unit) && unit == 0);
    ck_assert(next(p, &unit) && unit == 2);
    partition_lost(p, 0);
    partition_take(p, 0); /* out of those that came back, too */
    ck_assert(next(p, &unit) && unit == 3);
    ck_assert(!next(p, &unit));
    partition_lost(p, 1);
    ck_assert(next(p, &unit) && unit == 1);
    partition_free(p);
}

/* Whether they wait, came back or are taken out of turn. */
TEST(frames_that_are_not_open_stay)
{
    struct msg_frame f[2] = { { 0, 40, 40, "" }, { 1, 40, 40, "" } };
    struct partition_spec spec = {
        .kind = MSG_PART_WINDOW, .windows = 4, .nframes = 2, .frames = f
    };
    struct partition *p = partition_new(&spec, NULL);
    uint32_t unit;

    ck_assert_ptr_nonnull(p);
    partition_take(p, 6);
    partition_open(p, 1);
    ck_assert_uint_eq(partition_waiting(p), 4);
    partition_lost(p, 6);
    ck_assert_uint_eq(partition_waiting(p), 4);
    partition_take(p, 5);
    for (uint32_t i = 0; i < 4; i++) {
        ck_assert(next(p, &unit));
        ck_assert_uint_lt(unit, 4);
    }
    ck_assert_uint_eq(partition_waiting(p), 0);
    ck_assert(!next(p, &unit));
    partition_open(p, 2);
    ck_assert_uint_eq(partition_waiting(p), 3);
    ck_assert(next(p, &unit));
    ck_assert_uint_eq(unit, 6);
    partition_free(p);
}

TEST(frames_go_out_in_their_order)
{
    struct msg_frame f[3] = { { 1, 10, 10, "" },
                              { 2, 5, 5, "" },
                              { 3, 7, 9, "" } };
    struct partition_spec spec = { .kind = MSG_PART_WINDOW,
                                   .order = MSG_ORDER_RANDOM,
                                   .windows = 4,
                                   .nframes = 3,
                                   .frames = f };
    struct partition *p = partition_new(&spec, NULL);
    struct partition_area a;
    uint32_t unit;

    ck_assert_uint_eq(partition_total(p), 12);
    for (uint32_t i = 0; i < 12; i++) {
        ck_assert(next(p, &unit));
        partition_area(p, unit, &a);
        ck_assert_uint_eq(a.frame, i / 4);
    }
    partition_free(p);
}

TEST(fresh_windows_go_out_frame_by_frame)
{
    struct msg_frame f[2] = { { .width = 40, .height = 40 },
                              { .width = 40, .height = 40 } };
    struct partition_spec spec = { .kind = MSG_PART_WINDOW,
                                   .windows = 4,
                                   .fresh = true,
                                   .psample = 4,
                                   .nframes = 2,
                                   .frames = f };
    struct partition *p = partition_new(&spec, NULL);
    struct partition_area a;
    uint32_t unit;

    for (int i = 0; i < 4; i++) {
        ck_assert(next(p, &unit));
        partition_area(p, unit, &a);
        ck_assert_uint_eq(a.frame, 0);
    }
    for (uint32_t u = 0; u < 4; u++) {
        ck_assert(!next(p, &unit));
        if (u == 2) { /* one comes back meanwhile */
            partition_lost(p, 3);
            ck_assert(next(p, &unit) && unit == 3);
        }
        partition_done(p, u);
    }
    for (int i = 0; i < 4; i++) {
        ck_assert(next(p, &unit));
        partition_area(p, unit, &a);
        ck_assert_uint_eq(a.frame, 1);
    }
    ck_assert(!next(p, &unit));
    partition_free(p);
}

/* Dearest first: by costs of lines that were given, and by an estimate. */
TEST(windows_go_out_by_cost)
{
    static struct msg_frame film = { 0, 40, 61, "" };
    float given[21] = { [12] = 10, [13] = 10 };
    double cost[4] = { 1, 3, 2, 3 };
    struct partition_spec spec = { .kind = MSG_PART_WINDOW,
                                   .order = MSG_ORDER_COST,
                                   .windows = 4,
                                   .psample = 4,
                                   .ncosts = N_ELEM(given),
                                   .costs = given,
                                   .nframes = 1,
                                   .frames = &film };
    struct partition *p = partition_new(&spec, NULL);
    static const uint32_t want[] = { 1, 3, 2, 0 };
    struct partition_area a;
    uint32_t unit;

    ck_assert_double_eq_tol(partition_cost_total(p), 20, 1e-3);
    ck_assert(next(p, &unit));
    partition_area(p, unit, &a); /* base rows 36 and 39, below the middle */
    ck_assert(a.y <= 36 && a.y + a.height > 39);
    partition_free(p);
    spec.ncosts = 0;
    p = partition_new(&spec, NULL);
    ck_assert_uint_eq(partition_areas(p), 4);
    partition_set_costs(p, cost);
    for (int i = 0; i < 4; i++)
        ck_assert(next(p, &unit) && unit == want[i]);
    partition_free(p);
}

static const struct {
    enum msg_partition kind;
    uint32_t width, windows, ncosts;
    const char *what;
} refused[] = {
    { MSG_PART_WINDOW, 65520, 100001, 0, "too many windows" },
    { MSG_PART_WINDOW, 65535, 0, 0, "picture of 65535 columns" },
    { MSG_PART_SCANBAR, 65535, 0, 0, "picture of 65535 columns" },
    { MSG_PART_SCANBAR, 10, 0, 3,
      "costs of 3 lines, but the pictures have 65535" },
    { MSG_PART_WINDOW, 10, 0, 65534, "costs of 65534 lines" },
};

LOOP_TEST(what_cannot_be_is_refused_by_name, N_ELEM(refused))
{
    struct msg_frame f = { 0, refused[_i].width, 65535, "" };
    struct partition_spec spec = { .kind = refused[_i].kind,
                                   .windows = refused[_i].windows,
                                   .ncosts = refused[_i].ncosts,
                                   .psample = 1,
                                   .nframes = 1,
                                   .frames = &f };
    struct rad_error err = { 0 };

    ck_assert_ptr_null(partition_new(&spec, &err));
    ck_assert_int_eq(err.code, RAD_EUSAGE);
    ck_assert_msg(strstr(err.what, refused[_i].what) != NULL, "%s", err.what);
}

static struct partition *
make_scanbar(uint32_t w, uint32_t h)
{
    struct msg_frame f = { 0, w, h, "" };
    struct partition_spec spec = {
        .kind = MSG_PART_SCANBAR, .psample = 4, .nframes = 1, .frames = &f
    };
    struct partition *p = partition_new(&spec, NULL);

    ck_assert_ptr_nonnull(p);
    return p;
}

/* Some units of a partition go out; one made anew from their areas hands out
 * the rest. */
LOOP_TEST(a_partition_is_made_again_from_its_units, 2)
{
    struct partition *p =
        _i ? make_scanbar(60, 60) : make(60, 60, 9, MSG_ORDER_BACKWARD);
    struct partition *q =
        _i ? make_scanbar(60, 60) : make(60, 60, 9, MSG_ORDER_BACKWARD);
    struct partition_area a;
    uint64_t pixels = 0;
    uint32_t unit;

    for (int i = 0; i < 4; i++) {
        ck_assert(next(p, &unit));
        partition_area(p, unit, &a);
        ck_assert(partition_restore(q, unit, &a));
        pixels += a.width * a.height;
        if (i % 2)
            partition_done(q, unit);
    }
    while (next(q, &unit)) {
        partition_area(q, unit, &a);
        pixels += a.width * a.height;
    }
    ck_assert_uint_eq(pixels, 60 * 60);
    partition_free(p);
    partition_free(q);
}

/* The same where frames go out one after the other: that of which there was
 * something has begun, whatever of it is under way. */
LOOP_TEST(a_frame_that_has_begun_goes_on_after_a_restart, MSG_ORDER_COST + 1)
{
    struct msg_frame f[2] = { { 1, 40, 40, "" }, { 2, 40, 40, "" } };
    struct partition_spec spec = { .kind = MSG_PART_WINDOW,
                                   .order = (enum msg_order)_i,
                                   .windows = 4,
                                   .fresh = true,
                                   .nframes = 2,
                                   .frames = f };
    struct partition *p = partition_new(&spec, NULL);
    struct partition_area a;
    uint32_t unit;

    ck_assert_ptr_nonnull(p);
    for (uint32_t u = 0; u < 6; u++) {
        partition_area(p, u, &a);
        ck_assert(partition_restore(p, u, &a));
        if (u < 4)
            partition_done(p, u);
    }
    ck_assert(next(p, &unit) && unit >= 6);
    ck_assert(next(p, &unit) && unit >= 6);
    ck_assert(!next(p, &unit));
    partition_free(p);
}

/* Of a picture of 60 by 60 with lines of row 0, rows 1 to 3, 4 to 6 ... */
static const struct partition_area no_unit[] = {
    { 1, 0, 0, 60, 1 },  { 0, 1, 0, 60, 1 },          { 0, 0, 0, 59, 1 },
    { 0, 0, 2, 60, 2 },  { 0, 0, 0, 60, 3 },          { 0, 0, 0, 60, 61 },
    { 0, 0, 60, 60, 3 }, { 0, 0, 4, 60, 3 },          { 0, 0, 1, 60, 9 },
    { 0, 0, 1, 60, 0 },  { 0, 0, 0, 60, UINT32_MAX },
};

LOOP_TEST(what_is_no_unit_is_not_made_one, N_ELEM(no_unit))
{
    static const struct partition_area taken = { 0, 0, 4, 60, 3 };
    struct partition *p = make_scanbar(60, 60);

    ck_assert(partition_restore(p, 0, &taken));
    ck_assert(!partition_restore(p, 1, &no_unit[_i]));
    ck_assert(!partition_restore(
        p, 5, &(struct partition_area){ 0, 0, 0, 60, 1 })); /* a gap */
    partition_free(p);
}
