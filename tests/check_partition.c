/* check_partition.c - units cover each pixel once and go out in order */
#include "config.h"

#include "partition.h"
#include "unit.h"

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

static const struct {
    uint32_t width, height, windows, units;
} sizes[] = {
    { 100, 100, 1, 1 },   { 100, 100, 7, 7 },
    { 384, 256, 64, 64 }, { 1, 100, 30, 30 },
    { 100, 1, 30, 30 },   { 37, 1, 14, 14 },
    { 3, 26, 40, 40 },    { 2, 2, 100, 4 },
    { 1, 1, 5, 1 },       { 640, 480, 640 * 480, 640 * 480 },
    { 65520, 1, 3, 3 },   { 384, 256, 0, 24 },
    { 50, 40, 0, 16 },    { 8200, 2050, 0, 4096 },
};

START_TEST(every_pixel_is_in_one_window)
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
END_TEST

/* 64 windows of a picture of 384 by 256: near-equal, close to square. */
START_TEST(windows_are_near_equal_and_near_square)
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
END_TEST

START_TEST(orders_are_what_their_names_say)
{
    enum { N = 20 };
    uint32_t random[N], unit;
    struct partition *p = make(100, 100, N, MSG_ORDER_BACKWARD);
    int moved = 0;

    for (uint32_t i = 0; i < N; i++) {
        ck_assert(partition_next(p, 0, &unit));
        ck_assert_uint_eq(unit, N - 1 - i);
    }
    ck_assert(!partition_next(p, 0, &unit));
    partition_free(p);
    for (int round = 0; round < 2; round++) { /* the same each time */
        p = make(100, 100, N, MSG_ORDER_RANDOM);
        for (uint32_t i = 0; i < N; i++) {
            ck_assert(partition_next(p, 0, &unit));
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
END_TEST

START_TEST(lost_units_go_out_before_the_others)
{
    struct partition *p = make(100, 100, 10, MSG_ORDER_FORWARD);
    uint32_t unit;

    for (int i = 0; i < 3; i++)
        ck_assert(partition_next(p, 0, &unit));
    partition_lost(p, 1);
    partition_lost(p, 1); /* twice is once */
    ck_assert_uint_eq(partition_waiting(p), 8);
    ck_assert(partition_next(p, 0, &unit) && unit == 1);
    partition_done(p, 1);
    ck_assert_uint_eq(partition_left(p), 9);
    ck_assert(partition_next(p, 0, &unit) && unit == 3);
    partition_free(p);
}
END_TEST

START_TEST(a_unit_that_was_taken_does_not_go_out)
{
    struct partition *p = make(100, 100, 4, MSG_ORDER_FORWARD);
    uint32_t unit;

    partition_take(p, 1);
    partition_take(p, 1);
    ck_assert_uint_eq(partition_waiting(p), 3);
    ck_assert(partition_next(p, 0, &unit) && unit == 0);
    ck_assert(partition_next(p, 0, &unit) && unit == 2);
    partition_lost(p, 0);
    partition_take(p, 0); /* out of those that came back, too */
    ck_assert(partition_next(p, 0, &unit) && unit == 3);
    ck_assert(!partition_next(p, 0, &unit));
    partition_lost(p, 1);
    ck_assert(partition_next(p, 0, &unit) && unit == 1);
    partition_free(p);
}
END_TEST

START_TEST(frames_go_out_in_their_order)
{
    struct msg_frame f[3] = { { 1, 10, 10, "" },
                              { 2, 5, 5, "" },
                              { 3, 7, 9, "" } };
    struct partition_spec spec = { .kind = MSG_PART_AUTO,
                                   .order = MSG_ORDER_RANDOM,
                                   .windows = 4,
                                   .nframes = 3,
                                   .frames = f };
    struct partition *p = partition_new(&spec, NULL);
    struct partition_area a;
    uint32_t unit;

    ck_assert_uint_eq(partition_total(p), 12);
    for (uint32_t i = 0; i < 12; i++) {
        ck_assert(partition_next(p, 0, &unit));
        partition_area(p, unit, &a);
        ck_assert_uint_eq(a.frame, i / 4);
    }
    partition_free(p);
    spec.single = true; /* one thread: one window a frame */
    p = partition_new(&spec, NULL);
    ck_assert_uint_eq(partition_total(p), 3);
    partition_free(p);
}
END_TEST

static const struct {
    enum msg_partition kind;
    enum msg_order order;
    uint32_t width, windows;
    const char *what;
} refused[] = {
    { MSG_PART_STATIC, 0, 10, 0, "--partition=static is not supported" },
    { MSG_PART_SCANBAR, 0, 10, 0, "--partition=scanbar is not supported" },
    { MSG_PART_WINDOW, MSG_ORDER_COST, 10, 0, "--order=cost is not" },
    { MSG_PART_WINDOW, 0, 65520, 2000000, "too many windows" },
    { MSG_PART_WINDOW, 0, 65535, 0, "picture of 65535 columns" },
};

START_TEST(what_is_not_there_is_refused_by_name)
{
    struct msg_frame f = { 0, refused[_i].width, 65535, "" };
    struct partition_spec spec = { .kind = refused[_i].kind,
                                   .order = refused[_i].order,
                                   .windows = refused[_i].windows,
                                   .nframes = 1,
                                   .frames = &f };
    struct rad_error err = { 0 };

    ck_assert_ptr_null(partition_new(&spec, &err));
    ck_assert_int_eq(err.code, RAD_EUSAGE);
    ck_assert_msg(strstr(err.what, refused[_i].what) != NULL, "%s", err.what);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("partition");
    TCase *tc = tcase_create("partition");

    tcase_add_loop_test(tc, every_pixel_is_in_one_window, 0, N_ELEM(sizes));
    tcase_add_test(tc, windows_are_near_equal_and_near_square);
    tcase_add_test(tc, orders_are_what_their_names_say);
    tcase_add_test(tc, lost_units_go_out_before_the_others);
    tcase_add_test(tc, a_unit_that_was_taken_does_not_go_out);
    tcase_add_test(tc, frames_go_out_in_their_order);
    tcase_add_loop_test(tc, what_is_not_there_is_refused_by_name, 0,
                        N_ELEM(refused));
    suite_add_tcase(s, tc);
    return unit_run(s);
}
