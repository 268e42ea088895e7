/* check_strict_rank.c - which strict unit a thread takes next, and for which it
 * leaves a pass */
#include "config.h"

#include "strict_fixture.h"

FIXTURE(set_up, tear_down)

/* A unit that nobody works on gets its top while another is traced ahead. */
TEST(what_is_ahead_makes_way_for_the_truth)
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

/* Of two units whose top is there the one whose bottom is out has time. */
TEST(who_owes_a_bottom_comes_first)
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
