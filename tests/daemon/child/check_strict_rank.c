/* check_strict_rank.c - which strict unit a thread takes next, and for which it
 * leaves a pass */
#include "config.h"

#include "strict_fixture.h"

/* A unit that nobody works on gets its top while another is traced ahead. */
START_TEST(what_is_ahead_makes_way_for_the_truth)
{
    struct strict_pass *p;

    give_unit(0, 4, 8);
    expect_pass(STRICT_LINES, false);
    expect_pass(STRICT_AHEAD, false);
    give_unit(1, 10, 12);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_LINES);
    ck_assert(!p->stop);
    give_top();
    ck_assert(p->stop);
    end_black(p, false);
    expect_pass(STRICT_TRUE_LINES, false);
    expect_pass(STRICT_TRUTH, true);
    expect_pass(STRICT_LINES, false); /* once more */
}
END_TEST

/* The bottom of a pass under a true top is out, all of it. */
static void
make_bottom(struct strict_pass *p)
{
    strict_bottom(s, p, 64, rad_quincunx_ndensity(&q), black, zeros);
}

/* Rows are wanted by nobody but the picture: what others wait for is made
 * before them, though it lies below, and they go on after it where they were.
 */
START_TEST(rows_make_way_for_a_bottom)
{
    struct strict_pass *p;

    give_unit(0, 0, 3);
    expect_pass(STRICT_TRUE_LINES, false);
    give_unit(1, 4, 5);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && p->unit == 0 && p->keeps);
    ck_assert(!p->stop);
    give_top();
    ck_assert(p->stop);
    p->finished = 2;
    spent.primary_rays = 5;
    ck_assert(!end_pass(p, false));
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && p->unit == 1);
    make_bottom(p); /* then it is no more urgent than the other */
    ck_assert(!p->stop);
    end_pass(p, false);
    strict_split(s, 0, 1); /* lines that are out are not given away */
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->unit == 0 && p->out == 2 && p->last == 3);
    ck_assert_int_eq(p->rank, STRICT_TRUTH);
    end_pass(p, false);
}
END_TEST

/* The base line above a unit comes before it, where the coordinator has it. */
START_TEST(rows_make_way_for_a_unit_that_has_its_top)
{
    struct strict_pass *p;

    give_unit(0, 0, 3);
    expect_pass(STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && p->unit == 0 && p->keeps);
    give_top();
    ck_assert(!p->stop);
    give_unit(1, 4, 5);
    ck_assert(p->stop);
    end_pass(p, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && p->unit == 1);
    end_pass(p, false);
}
END_TEST

/* A whole frame keeps no facts: left, it would be traced again. */
START_TEST(rows_that_are_not_kept_do_not_make_way)
{
    struct rad_quincunx frames[2];
    struct msg_unit below = { .job = job_id, .unit = 1, .attempt = 1 };
    struct strict_pass *p;

    frames[0] = frames[1] = q = sampler(4, 64, 61);
    strict_free(s);
    s = strict_new(frames, 2, false, job_id);
    give_unit(0, 0, rad_quincunx_nbases(&q));
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && !p->keeps);
    below.frame = 1;
    below.width = 64;
    below.mode = MSG_MODE_STRICT;
    below.y = (uint32_t)team_line_row(&q, 4);
    below.height = (uint32_t)team_line_row(&q, 5) - below.y;
    ck_assert_int_eq(strict_unit(s, &below, NULL), 0);
    give_line(1, 3);
    ck_assert(!p->stop);
    end_pass(p, false);
}
END_TEST

/* Of two units whose top is there the one whose bottom is out has time. */
START_TEST(who_owes_a_bottom_comes_first)
{
    struct strict_pass *p;

    give_unit(0, 0, 2);
    expect_pass(STRICT_TRUE_LINES, false);
    give_unit(1, 4, 5);
    give_top();
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUTH && p->unit == 1);
    end_pass(p, false);
}
END_TEST

int
main(void)
{
    TCase *tc = tcase_create("strict_rank");

    tcase_add_checked_fixture(tc, set_up, tear_down);
    tcase_add_test(tc, what_is_ahead_makes_way_for_the_truth);
    tcase_add_test(tc, rows_make_way_for_a_bottom);
    tcase_add_test(tc, rows_make_way_for_a_unit_that_has_its_top);
    tcase_add_test(tc, rows_that_are_not_kept_do_not_make_way);
    tcase_add_test(tc, who_owes_a_bottom_comes_first);
    return unit_run_case(tc);
}
