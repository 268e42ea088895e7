/* check_strict_unit.c - the states of strict units: parked, revoked, looked at
 * again */
#include "config.h"

#include "strict/strict_state.h"
#include "strict_fixture.h"

FIXTURE(set_up, tear_down)

/* If its child dies of a pixel, a unit that is made while it is parked has
 * to be known. */
TEST(a_parked_unit_that_is_worked_on_says_so)
{
    struct strict_pass *p;

    give_unit(0, 4, 6);
    expect_pass(STRICT_LINES, false);
    expect_pass(STRICT_AHEAD, false);
    ck_assert(is_said(MSG_PARKED));
    give_unit(1, 2, 4);
    expect_pass(STRICT_LINES, false); /* of the upper unit */
    ck_assert(!is_said(MSG_RESUMED));
    p = strict_next(s, STRICT_AHEAD); /* the lower unit has densities above */
    ck_assert(p && p->unit == 0 && p->rank == STRICT_LINES &&
              p->spec.top_density);
    ck_assert(is_said(MSG_RESUMED));
    end_black(p, true);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->unit == 1);
    ck_assert(!is_said(MSG_RESUMED));
    end_black(p, true);
    p = strict_next(s, STRICT_AHEAD); /* and colours above */
    ck_assert(p && p->unit == 0 && p->rank == STRICT_AHEAD && p->spec.top);
    end_black(p, true);
    ck_assert(is_said(MSG_PARKED));
}

/* Nobody looks again without a reason; for one that waits there is none but
 * that it may wait for long, for a pass what others want of it. */
TEST(it_says_when_to_look_again)
{
    const struct msg_lend lend = { job_id, 0, 1, 32767 };
    struct strict_pass *p;

    ck_assert_uint_eq(strict_tick(s, 1000), STRICT_NEVER);
    give_unit(0, 4, 8);
    ck_assert(strict_has_work(s));
    ck_assert_uint_eq(strict_tick(s, 1000), STRICT_NEVER);
    expect_pass(STRICT_LINES, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_uint_eq(strict_tick(s, 1000), STRICT_NEVER);
    end_black(p, true);
    ck_assert(!strict_has_work(s));
    ck_assert_uint_eq(strict_tick(s, 2000), 2200); /* its facts are kept */
    ck_assert_uint_eq(strict_tick(s, 2199), 2200);
    ck_assert_uint_eq(strict_tick(s, 2200), STRICT_NEVER);
    give_top();
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUE_LINES);
    ck_assert_uint_eq(strict_tick(s, 3000), 3010); /* pieces of its bottom */
    end_black(p, true);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUTH);
    ck_assert_uint_eq(strict_tick(s, 3000), STRICT_NEVER);
    strict_lend(s, &lend);
    ck_assert_uint_eq(strict_tick(s, 3000), 3010);
    p->lend = 0;
    ck_assert_uint_eq(strict_tick(s, 3000), STRICT_NEVER);
    end_black(p, true);
    ck_assert_uint_eq(strict_tick(s, 3000), STRICT_NEVER);
}

/* Its top comes again before it does, while a pass of it is ending. */
TEST(a_unit_that_was_revoked_and_comes_again_has_its_top)
{
    struct strict_pass *p;

    give_unit(0, 4, 8);
    p = strict_next(s, STRICT_AHEAD);
    strict_revoke(s, 0, 1);
    give_top();
    ck_assert(!end_pass(p, false));
    give_unit(0, 4, 8);
    expect_pass(STRICT_TRUE_LINES, false);
    expect_pass(STRICT_TRUTH, true);
}

static void
expect_gave(uint32_t unit)
{
    const struct msg *m;

    while ((m = strict_message(s, true)) && m->type != MSG_GAVE)
        ;
    ck_assert_ptr_nonnull(m);
    ck_assert_uint_eq(m->gave.unit, unit);
    ck_assert_uint_eq(m->gave.height, 0);
}

/* The pass of the first unit ends before; the second has no pass. */
TEST(units_are_given_back_whole)
{
    struct strict_pass *p;
    uint32_t first;

    give_unit(0, 4, 8);
    give_unit(1, 8, 12);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_ptr_nonnull(p);
    first = p->unit;
    strict_yield(s, first, 1);
    ck_assert(p->stop);
    ck_assert(!end_pass(p, false));
    expect_gave(first);
    strict_yield(s, 1 - first, 1);
    expect_gave(1 - first);
    ck_assert_ptr_null(strict_next(s, STRICT_AHEAD));
}

/* A child may have thousands of units that wait, in the end. To look at all of
 * them at each message must not take the square of that. */
TEST(thousands_of_units_may_wait)
{
    enum { N = 3000, WIDE = 3 };
    struct msg_base_line top = {
        .job = job_id, .n = WIDE, .channels = 3, .pixels = zeros
    };
    struct strict_pass *p;

    start(sampler(1, WIDE, N + 2), false);
    for (uint32_t i = 1; i <= N; i++) {
        struct msg_unit u = { .job = job_id,
                              .unit = i,
                              .attempt = 1,
                              .y = i,
                              .width = WIDE,
                              .height = 1,
                              .mode = MSG_MODE_STRICT };

        ck_assert_int_eq(strict_unit(s, &u, NULL), 0);
    }
    for (uint32_t i = N; i-- > 0;) {
        top.line = i;
        strict_base_line(s, &top);
        strict_tick(s, 10 * i);
    }
    p = strict_next(s, STRICT_TRUTH);
    ck_assert_ptr_nonnull(p);
    ck_assert_uint_eq(p->unit, 1);
    ck_assert_int_eq(strict_error(s), 0);
    end_pass(p, false);
}

/* The drawings at the head of strict_unit.h, as "from to" pairs. */
TEST(unit_states_follow_the_drawings)
{
    static const enum strict_progress progress[][2] = {
        { PROGRESS_NONE, PROGRESS_LINES },
        { PROGRESS_LINES, PROGRESS_AHEAD },
        { PROGRESS_AHEAD, PROGRESS_LINES },
    };
    static const enum strict_fate fate[][2] = {
        { FATE_STAYS, FATE_SPLITS }, { FATE_SPLITS, FATE_STAYS },
        { FATE_STAYS, FATE_YIELDS }, { FATE_SPLITS, FATE_YIELDS },
        { FATE_STAYS, FATE_OVER },   { FATE_SPLITS, FATE_OVER },
        { FATE_YIELDS, FATE_OVER },  { FATE_STAYS, FATE_GONE },
        { FATE_SPLITS, FATE_GONE },  { FATE_YIELDS, FATE_GONE },
    };
    int n = 0;

    for (size_t i = 0; i < N_ELEM(progress); i++)
        ck_assert(steps_permit(&strict_progress_steps, progress[i][0],
                               progress[i][1]));
    for (size_t i = 0; i < N_ELEM(fate); i++)
        ck_assert(steps_permit(&strict_fate_steps, fate[i][0], fate[i][1]));
    for (unsigned i = 0; i <= STRICT_PROGRESSES; i++)
        for (unsigned k = 0; k <= STRICT_PROGRESSES; k++)
            n += steps_permit(&strict_progress_steps, i, k);
    ck_assert_int_eq(n, N_ELEM(progress)); /* and no other */
    n = 0;
    for (unsigned i = 0; i <= STRICT_FATES; i++)
        for (unsigned k = 0; k <= STRICT_FATES; k++)
            n += steps_permit(&strict_fate_steps, i, k);
    ck_assert_int_eq(n, N_ELEM(fate));
}

/* Below the last base line there is no unit. */
TEST(base_lines_that_no_unit_is_below_are_dropped)
{
    uint32_t n = (uint32_t)frame_of(s, 0)->nlines;

    give_line(1, 3);
    give_line(0, UINT32_MAX);
    give_line(0, n - 1);
    ck_assert_ptr_null(s->edges);
    give_line(0, n - 2);
    ck_assert_ptr_nonnull(s->edges);
}
