/* check_twins.c - units that several are at */
#include "config.h"

#include "lines_fixture.h"

FIXTURE(set_up, tear_down)

/* Two at one unit, all else being done: ws1 got it first, ws2 as well when it
 * was late. */
static void
twins(struct msg_unit *a, struct msg_unit *b)
{
    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    *b = *unit_of(W2);
    finish(W2, b);
    *a = *unit_of(W1);
    wait_ms(61000);
    *b = *unit_of(W2);
    ck_assert_uint_eq(desk_find_job(f.c, id)->nout, 1);
}

TEST(the_first_of_twins_whose_rows_come_leads)
{
    struct msg_unit a, b;

    twins(&a, &b);
    ck_assert(a.unit == b.unit && b.attempt == a.attempt + 1);
    ck_assert_uint_eq(b.height, a.height);
    clear();
    facts(W1, line_above(a.y + a.height));
    facts(W2, line_above(a.y + a.height));
    ck_assert_int_eq(count(W1, MSG_FACTS), 1);
    ck_assert_int_eq(count(W2, MSG_FACTS), 1);
    base_line(W2, 0, line_above(a.y + a.height));
    result(W2, &b, 0, 1, false);
    result(W1, &a, 0, 1, false); /* is forgotten */
    ck_assert_int_eq(count(W1, MSG_ACK), 1);
    result(W1, &a, 1, a.height - 1, true);
    ck_assert_int_eq(count(W1, MSG_ACK), 2);
    ck_assert(!f.done);
    clear();
    result(W2, &b, 1, b.height - 1, true);
    ck_assert_int_eq(count(W1, MSG_REVOKE), 1);
    ck_assert(f.done);
    ck_assert_double_eq(worker_stat("ws1", "units"), 0); /* it has the credit */
}

TEST(when_the_leader_goes_one_that_sent_nothing_goes_on)
{
    struct msg_unit a, b;

    twins(&a, &b);
    result(W2, &b, 0, 2, false);
    cut(W2);
    ck_assert_int_eq(count(W1, MSG_REVOKE), 0);
    finish(W1, &a);
    ck_assert(f.done);
}

TEST(when_the_leader_goes_one_whose_rows_were_dropped_begins_anew)
{
    struct msg_unit a, b;

    twins(&a, &b);
    facts(W2, line_above(a.y + a.height));
    result(W2, &b, 0, 2, false);
    result(W1, &a, 0, 1, false);
    clear();
    cut(W2);
    ck_assert_int_eq(count(W1, MSG_REVOKE), 1);
    b = *unit_of(W1);
    ck_assert(b.unit == a.unit && b.attempt == a.attempt + 2);
    ck_assert_int_eq(count(W1, MSG_FACTS), 1); /* they are kept */
    finish(W1, &b);
    ck_assert(f.done);
}

TEST(a_very_late_unit_gets_a_twin_with_scanbar_too)
{
    start(MSG_PART_SCANBAR, 0, 1);
    f.closed[W2] = true;
    coord_closed(f.c, f.now_ms, W2, "cut");
    join(W3, MSG_ROLE_WORKER, "ws3", "");
    ready(W3);
    for (int i = 0; i < f.nsaid; i++) /* what it gets, and what it gets then */
        if (f.said[i].conn == W3 && f.said[i].m.type == MSG_UNIT)
            attempt(W3, MSG_PARKED, &f.said[i].m.unit);
    clear();
    wait_ms(50000);
    ck_assert_int_eq(count(W3, MSG_UNIT), 0);
    wait_ms(20000);
    ck_assert_int_eq(count(W3, MSG_UNIT), 1);
    ck_assert_uint_eq(unit_of(W3)->attempt, 2);
}

/* ws2 has both units, ws3 the lower one, too, of which it lends ws1 columns.
 * ws2 is lost, and gets the upper unit again: its base line goes to ws3, for a
 * loan waits for none. */
TEST(a_twin_and_not_its_borrower_waits_for_the_base_line)
{
    struct msg_unit upper, lower, twin;

    start(MSG_PART_STATIC, 0, 2);
    lower = *unit_of(W2);
    wait_ms(40000);
    cut(W1);
    wait_ms(2000);
    attempt(W2, MSG_PARKED, &lower);
    upper = *unit_of(W2);
    ck_assert_uint_eq(upper.y + upper.height, lower.y);
    base_line(W2, 0, line_above(lower.y));
    join(W3, MSG_ROLE_WORKER, "ws3", "");
    ready(W3);
    wait_ms(20000);
    twin = *unit_of(W3);
    ck_assert_uint_eq(twin.unit, lower.unit);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    ready(W1);
    lend(W3, &twin, 6, 10);
    ck_assert_int_eq(count(W1, MSG_LOAN), 1);
    result(W3, &twin, 0, 1, false);
    clear();
    replace(W2, W2);
    ck_assert_uint_eq(unit_of(W2)->unit, upper.unit);
    ck_assert_str_eq(last(W2, MSG_NEXT_HOLDER)->name, "ws3");
}

/* Its child does nothing any more, though radd is there. */
TEST(one_that_waited_and_is_stuck_gets_a_twin)
{
    struct msg_unit a, b;

    start_two(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, &a, &b);
    attempt(W2, MSG_PARKED, &b);
    finish(W1, &a); /* it has its base line now */
    clear();
    wait_ms(59000);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    wait_ms(2000);
    ck_assert_uint_eq(unit_of(W1)->unit, b.unit);
    b = *unit_of(W1);
    finish(W1, &b);
    ck_assert(f.done);
}

/* Its child was stopped after its first rows: they count no more once a twin
 * has rows, and what it sends later is dropped. */
TEST(a_twin_overtakes_one_that_is_silent)
{
    struct msg_unit a, b, twin;

    start_two(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, &a, &b);
    result(W2, &b, 0, 1, false);
    finish(W1, &a);
    clear();
    wait_ms(61000);
    twin = *unit_of(W1);
    ck_assert_uint_eq(twin.unit, b.unit);
    result(W1, &twin, 0, 1, false);
    result(W2, &b, 1, b.height - 1, true);
    ck_assert(!f.done);
    result(W1, &twin, 1, twin.height - 1, true);
    ck_assert(f.done);
}

/* A minute for a row: whoever gets the unit anew has its first row before the
 * attempt that leads has another.  The unit is done all the same. */
TEST(twins_do_not_overtake_each_other_for_ever)
{
    struct msg_unit a, old, twin;
    uint64_t leads = W2, other = W1;

    start_two(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, &a, &old);
    result(W2, &old, 0, 1, false);
    finish(W1, &a);
    for (int i = 0; i < 8 && !f.done; i++) {
        uint64_t was = leads;

        wait_ms(61000);
        twin = *unit_of(other);
        ck_assert_uint_eq(twin.unit, old.unit);
        result(other, &twin, 0, 1, false);
        result(leads, &old, 1, old.height - 1, true);
        leads = other;
        other = was;
        old = twin;
    }
    ck_assert(f.done);
}

/* The unit above begins anew meanwhile, so it is not late either.  When the top
 * is there a worker that had no part in the job gets one. */
TEST(one_that_waits_gets_no_twin)
{
    struct msg_unit b;

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    b = *unit_of(W2);
    attempt(W2, MSG_PARKED, &b);
    wait_ms(50000);
    replace(W1, W3);
    wait_ms(20000);
    ck_assert_int_eq(count(W3, MSG_JOB_START), 0);
    base_line(W2, 0, line_above(b.y));
    wait_ms(1000);
    ready(W3);
    ck_assert_uint_eq(unit_of(W3)->unit, b.unit);
}
