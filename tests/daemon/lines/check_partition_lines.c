/* check_partition_lines.c - lines go out once, by each way to share them */
#include "config.h"

#include "partition/partition.h"
#include "tests/scarce.h"
#include "tests/unit.h"

#include <string.h>

/* 61 rows at -ps 4: base lines 3 rows apart, 21 lines. */
static struct msg_frame films[] = { { 0, 40, 61, "" },
                                    { 1, 40, 61, "" },
                                    { 2, 40, 61, "" } };
enum { LINES = 21 };

static struct partition_spec
lines_spec(enum msg_partition kind, uint32_t nframes)
{
    return (struct partition_spec){ .kind = kind,
                                    .balance = true,
                                    .psample = 4,
                                    .nframes = nframes,
                                    .frames = films };
}

static struct partition *
lines(enum msg_partition kind, uint32_t nframes)
{
    struct partition_spec spec = lines_spec(kind, nframes);
    struct partition *p = partition_new(&spec, NULL);

    ck_assert_ptr_nonnull(p);
    return p;
}

/* The lines of the worker's next unit, one of n of equal speed. */
static bool
cut(struct partition *p, uint32_t worker, uint32_t n, uint32_t *first,
    uint32_t *last, uint32_t *unit)
{
    struct partition_ask ask = {
        .worker = worker, .workers = n, .share = 1. / n, .idle = true
    };

    if (!partition_next(p, &ask, unit))
        return false;
    partition_unit_lines(p, *unit, first, last);
    return true;
}

/* Every line of every frame in one unit, and the rows of the units too. */
static void
check_cover(const struct partition *p, uint32_t nframes)
{
    uint8_t seen[3][61] = { { 0 } };

    for (uint32_t f = 0; f < nframes; f++)
        for (uint32_t i = 0; i < partition_lines(p, f); i++) {
            uint32_t first, last, unit = partition_line_unit(p, f, i);

            ck_assert_uint_lt(unit, partition_total(p));
            partition_unit_lines(p, unit, &first, &last);
            ck_assert(first <= i && i < last);
        }
    for (uint32_t u = 0; u < partition_total(p); u++) {
        struct partition_area a;

        partition_area(p, u, &a);
        ck_assert(a.x == 0 && a.width == 40);
        for (uint32_t y = a.y; y < a.y + a.height; y++)
            ck_assert_uint_eq(seen[a.frame][y]++, 0);
    }
    for (uint32_t f = 0; f < nframes; f++)
        for (int y = 0; y < 61; y++)
            ck_assert_uint_eq(seen[f][y], 1);
}

TEST(lines_are_base_lines_with_the_bar_above)
{
    struct partition *p = lines(MSG_PART_SCANBAR, 2);
    struct partition_area a;

    ck_assert_uint_eq(partition_lines(p, 0), LINES);
    ck_assert_uint_eq(partition_lines(p, 7), 0);
    ck_assert_uint_eq(partition_areas(p), 2 * LINES);
    partition_nth_area(p, 0, &a);
    ck_assert(a.y == 0 && a.height == 1);
    partition_nth_area(p, 1, &a);
    ck_assert(a.y == 1 && a.height == 3);
    partition_nth_area(p, LINES - 1, &a);
    ck_assert_uint_eq(a.y, 58);
    partition_nth_area(p, LINES + 1, &a);
    ck_assert(a.frame == 1 && a.y == 1 && a.height == 3 && a.width == 40);
    ck_assert_double_eq(partition_cost_total(p), 2 * 40 * 61);
    ck_assert_uint_eq(partition_line_unit(p, 0, 3), PARTITION_NONE);
    partition_free(p);
}

/* Without memory there is no partition, or lines have their costs. */
TEST(lines_have_costs_whatever_allocation_fails)
{
    struct partition_spec spec = lines_spec(MSG_PART_AUTO, 1);
    struct partition *p;
    long n = 0;

    do {
        scarce_at = ++n;
        p = partition_new(&spec, NULL);
    } while (!p);
    ck_assert(n > 1 || RAD_SANITIZED);
    scarce_at = 0;
    ck_assert_double_eq(partition_cost_total(p), 40 * 61);
    partition_free(p);
}

/* The first of three are some lines apart, then each goes on with what follows;
 * one that comes upon another's lines begins below all, and when there is
 * nothing below helps in the middle of what is left of the topmost. */
TEST(scanbar_hands_out_single_lines)
{
    static const struct {
        uint32_t worker, first, last;
    } want[] = { { 0, 0, 2 },   { 1, 4, 5 },   { 2, 8, 9 },   { 1, 5, 6 },
                 { 0, 2, 3 },   { 2, 9, 10 },  { 0, 3, 4 },   { 2, 10, 11 },
                 { 0, 12, 13 }, { 2, 11, 12 }, { 2, 16, 17 }, { 1, 6, 7 },
                 { 2, 17, 18 }, { 1, 7, 8 },   { 1, 20, 21 }, { 2, 18, 19 },
                 { 2, 19, 20 }, { 2, 14, 15 } };
    struct partition *p = lines(MSG_PART_SCANBAR, 1);
    uint32_t first, last, unit;

    for (int i = 0; i < N_ELEM(want); i++) {
        ck_assert(cut(p, want[i].worker, 3, &first, &last, &unit));
        ck_assert_msg(first == want[i].first && last == want[i].last,
                      "%d: lines %u to %u", i, first, last);
    }
    while (cut(p, 1, 3, &first, &last, &unit))
        ck_assert_uint_eq(last, first + 1);
    ck_assert_uint_eq(partition_waiting(p), 0);
    check_cover(p, 1);
    partition_free(p);
}

/* One frame of 151 lines, for three workers many. */
static struct partition *
many_lines(void)
{
    static const struct msg_frame tall = { .width = 40, .height = 451 };
    struct partition_spec spec = lines_spec(MSG_PART_SCANBAR, 1);
    struct partition *p;

    spec.frames = &tall;
    p = partition_new(&spec, NULL);
    ck_assert_ptr_nonnull(p);
    ck_assert_uint_eq(partition_lines(p, 0), 151);
    return p;
}

/* Towards the end its regions get smaller; then the middle of the topmost
 * stretch that is free comes. */
TEST(scanbar_of_many_lines_ends_with_small_regions)
{
    static const uint32_t want[] = { 0,   17,  34,  51,  68,  85,
                                     100, 111, 120, 128, 136, 144 };
    struct partition *p = many_lines();
    uint32_t first, last, unit;

    for (uint32_t i = 0; i < N_ELEM(want); i++) { /* new ones all the time */
        ck_assert(cut(p, i, 3, &first, &last, &unit));
        ck_assert_msg(first == want[i], "%u: line %u", i, first);
    }
    ck_assert(cut(p, N_ELEM(want), 3, &first, &last, &unit));
    ck_assert_uint_eq(first, 9);
    partition_free(p);
}

/* A line to which nobody comes by itself holds up all below it: whoever begins
 * anew begins there. */
TEST(scanbar_leaves_no_line_behind)
{
    struct partition *p = many_lines();
    uint32_t first, last, unit;

    ck_assert(cut(p, 0, 3, &first, &last, &unit) && first == 0);
    ck_assert(cut(p, 1, 3, &first, &last, &unit) && first == 17);
    partition_keep_line(p, 0, 16, true); /* its base line is being made */
    for (uint32_t i = 2; i < 16; i++)
        ck_assert(cut(p, 0, 3, &first, &last, &unit) && first == i);
    ck_assert(cut(p, 0, 3, &first, &last, &unit) && first == 34);
    partition_keep_line(p, 0, 16, false);
    for (uint32_t i = 18; i < 34; i++)
        ck_assert(cut(p, 1, 3, &first, &last, &unit) && first == i);
    ck_assert(cut(p, 1, 3, &first, &last, &unit) && first == 16);
    ck_assert(cut(p, 2, 3, &first, &last, &unit) && first == 51);
    partition_set_absent(p, 2, true);
    ck_assert(cut(p, 1, 3, &first, &last, &unit) && first == 52);
    partition_free(p);
}

TEST(auto_gives_one_worker_whole_frames)
{
    struct partition *p = lines(MSG_PART_AUTO, 3);
    uint32_t first, last, unit;

    for (uint32_t f = 0; f < 3; f++) {
        struct partition_area a;

        ck_assert(cut(p, 0, 1, &first, &last, &unit));
        ck_assert(first == 0 && last == LINES);
        partition_area(p, unit, &a);
        ck_assert_uint_eq(a.frame, f);
    }
    ck_assert(!cut(p, 0, 1, &first, &last, &unit));
    ck_assert_ptr_nonnull(strstr(partition_choice(p), "one worker"));
    partition_free(p);
}

TEST(a_line_that_is_kept_back_goes_out_when_it_is_not)
{
    struct partition *p = lines(MSG_PART_SCANBAR, 2);
    uint32_t first, last, unit, n = partition_waiting(p);
    uint32_t per_frame = partition_lines(p, 0);

    partition_keep_line(p, 0, 5, true);
    partition_keep_line(p, 0, 5, true);
    ck_assert_uint_eq(partition_waiting(p), n - 1);
    for (uint32_t i = 0; i < per_frame - 2; i++) { /* 0 goes with 1 */
        ck_assert(cut(p, 0, 1, &first, &last, &unit));
        ck_assert(first > 5 || last <= 5);
    }
    ck_assert_uint_eq(partition_waiting(p), per_frame);
    ck_assert(cut(p, 0, 1, &first, &last, &unit)); /* of the next frame */
    ck_assert_uint_eq(partition_line_unit(p, 0, 5), PARTITION_NONE);
    partition_keep_line(p, 0, 5, false);
    partition_keep_line(p, 0, 5, false);
    ck_assert(cut(p, 0, 1, &first, &last, &unit));
    ck_assert_uint_eq(partition_line_unit(p, 0, 5), unit);
    partition_keep_line(p, 0, 5, true); /* too late */
    while (cut(p, 0, 1, &first, &last, &unit))
        ;
    ck_assert_uint_eq(partition_waiting(p), 0);
    partition_free(p);
}

/* Units of auto get smaller, none is below what is worth one, and several
 * frames are cut only when few are left. */
TEST(auto_cuts_shares_of_what_is_left)
{
    struct partition *p = lines(MSG_PART_AUTO, 3);
    struct partition_ask ask = { .workers = 2, .share = .5, .least = 360 };
    uint32_t first, last, unit, n = 0;
    double before = 1e9;

    ck_assert(partition_next(p, &ask, &unit));
    ck_assert_double_eq(partition_cost(p, unit), 40 * 61); /* one of three */
    ask.worker = 1;
    ck_assert(partition_next(p, &ask, &unit));
    ck_assert_double_eq(partition_cost(p, unit), 40 * 61); /* one of two */
    ck_assert(partition_next(p, &ask, &unit));
    partition_unit_lines(p, unit, &first, &last);
    ck_assert(first == 0 && last == 10); /* half of one: 28 rows of 61 */
    while (partition_next(p, &ask, &unit)) {
        partition_unit_lines(p, unit, &first, &last);
        ck_assert(partition_cost(p, unit) >= 360 || n == 0);
        ck_assert(partition_cost(p, unit) <= before + 2 * 360);
        before = partition_cost(p, unit);
        ask.worker = n++ % 2;
    }
    ck_assert_uint_ge(n, 3);
    ck_assert_ptr_nonnull(strstr(partition_choice(p), "2 workers"));
    check_cover(p, 3);
    partition_free(p);
}

/* So many workers that there are no regions: all lines are out soon, and only
 * the last units are smaller. */
TEST(auto_has_all_lines_out_early)
{
    static struct msg_frame tall = { 0, 40, 1441, "" }; /* 481 lines */
    struct partition_spec spec = lines_spec(MSG_PART_AUTO, 1);
    struct partition *p;
    uint32_t first, last, unit, n = 0;

    spec.frames = &tall;
    p = partition_new(&spec, NULL);
    while (cut(p, n % 40, 40, &first, &last, &unit)) {
        if (n < 40) /* an even share is 12 */
            ck_assert(last - first >= 6 && last - first <= 13);
        n++;
    }
    ck_assert(n > 60 && n < 100); /* without a least: 150 */
    partition_free(p);
}

/* Where there are many lines for each worker it has regions, one after the
 * other; where there are few, units follow each other. */
TEST(auto_gives_regions_where_there_are_many_lines)
{
    static struct msg_frame tall = { 0, 40, 289, "" }; /* 97 lines */
    struct partition_spec spec = lines_spec(MSG_PART_AUTO, 1);
    struct partition *p;
    uint32_t first, last, before, unit;

    spec.frames = &tall;
    p = partition_new(&spec, NULL);
    ck_assert(cut(p, 0, 4, &first, &last, &unit));
    ck_assert(first == 0 && last == 8);
    partition_lost(p, unit);
    ck_assert(cut(p, 1, 4, &first, &last, &unit)); /* which others wait for */
    ck_assert(first == 0 && last == 8);
    for (uint32_t i = 1; i < 12; i++) {
        before = last;
        ck_assert(cut(p, i % 4, 4, &first, &last, &unit));
        ck_assert_uint_eq(first, before);
        ck_assert_uint_eq(last - first, 8);
    }
    while (cut(p, 1, 4, &first, &last, &unit)) /* what rounding left */
        ck_assert_uint_ge(first, 96);
    partition_free(p);

    p = partition_new(&spec, NULL);
    ck_assert(cut(p, 0, 5, &first, &last, &unit)); /* 19 lines each */
    before = last;
    ck_assert(cut(p, 1, 5, &first, &last, &unit));
    ck_assert_uint_eq(first, before);
    partition_free(p);
}

/* Speeds 1 : 3, costs that differ by line. */
TEST(static_gives_runs_of_equal_cost_for_the_speed)
{
    struct partition *p = lines(MSG_PART_STATIC, 2);
    static const double speed[] = { 1, 3 };
    double cost[2 * LINES], sum = 0;
    uint32_t first, last, unit;

    for (int i = 0; i < 2 * LINES; i++)
        sum += cost[i] = i < LINES ? 1 + i : 5;
    partition_set_costs(p, cost);
    ck_assert_double_eq_tol(partition_cost_total(p), sum, 1e-6);
    ck_assert(partition_set_speeds(p, speed, 2));
    ck_assert(cut(p, 0, 2, &first, &last, &unit)); /* 231 in all: 55 or 66 */
    ck_assert(first == 0 && last == 10);
    ck_assert_double_eq_tol(partition_cost(p, unit), 55, 1e-6);
    ck_assert(cut(p, 0, 2, &first, &last, &unit)); /* its run of frame 1 */
    ck_assert(first == 0 && last == 5);
    ck_assert(cut(p, 1, 2, &first, &last, &unit));
    ck_assert(first == 10 && last == LINES);
    ck_assert(cut(p, 0, 2, &first, &last, &unit)); /* balance: half of that */
    ck_assert(first == 13 && last == LINES);
    ck_assert(cut(p, 1, 2, &first, &last, &unit));
    ck_assert(first == 5 && last == 13);
    check_cover(p, 2);
    partition_free(p);
}

TEST(without_balance_only_absent_workers_lose_their_runs)
{
    struct partition_spec spec = lines_spec(MSG_PART_STATIC, 1);
    static const double speed[] = { 1, 1 };
    struct partition *p;
    uint32_t first, last, unit;

    spec.balance = false;
    p = partition_new(&spec, NULL);
    ck_assert(partition_set_speeds(p, speed, 2));
    ck_assert(cut(p, 0, 2, &first, &last, &unit));
    ck_assert(first == 0 && last == 10 + (last == 11));
    ck_assert(!cut(p, 0, 2, &first, &last, &unit));
    ck_assert_uint_gt(partition_waiting(p), 0);
    partition_set_absent(p, 1, true);
    ck_assert(cut(p, 0, 2, &first, &last, &unit));
    ck_assert_uint_eq(last, LINES);
    check_cover(p, 1);
    partition_free(p);
}

TEST(fresh_frames_go_out_one_after_another)
{
    struct partition_spec spec = lines_spec(MSG_PART_SCANBAR, 2);
    struct partition *p;
    uint32_t first, last, unit, n = 0;

    spec.fresh = true;
    p = partition_new(&spec, NULL);
    while (cut(p, 0, 1, &first, &last, &unit))
        n++;
    ck_assert_uint_eq(n, LINES - 1);
    ck_assert_uint_eq(partition_waiting(p), 0);
    for (uint32_t u = 0; u < n; u++)
        partition_done(p, u);
    ck_assert_uint_eq(partition_waiting(p), LINES);
    ck_assert(cut(p, 0, 1, &first, &last, &unit) && first == 0);
    partition_free(p);
}

TEST(a_unit_gives_whole_lines)
{
    struct partition *p = lines(MSG_PART_AUTO, 1);
    struct partition_area a;
    uint32_t first, last, unit, given;
    double cost;

    ck_assert(cut(p, 0, 1, &first, &last, &unit));
    cost = partition_cost(p, unit);
    ck_assert_uint_eq(partition_give(p, unit, 0), PARTITION_NONE);
    ck_assert_uint_eq(partition_give(p, unit, 5), PARTITION_NONE);
    ck_assert_uint_eq(partition_give(p, unit, 61), PARTITION_NONE);
    ck_assert_uint_eq(partition_give(p, unit, 64), PARTITION_NONE);
    given = partition_give(p, unit, 31); /* lines 0 to 10 */
    ck_assert_uint_eq(given, 1);
    partition_unit_lines(p, unit, &first, &last);
    ck_assert(first == 0 && last == 11);
    partition_unit_lines(p, given, &first, &last);
    ck_assert(first == 11 && last == LINES);
    partition_area(p, given, &a);
    ck_assert(a.y == 31 && a.height == 30);
    ck_assert_double_eq(partition_cost(p, unit) + partition_cost(p, given),
                        cost);
    ck_assert_uint_eq(partition_waiting(p), 1);
    ck_assert(cut(p, 0, 1, &first, &last, &unit) && unit == given);
    check_cover(p, 1);
    partition_lost(p, given);
    ck_assert(cut(p, 0, 1, &first, &last, &unit) && unit == given);
    partition_free(p);
}
