/* check_back.c - workers whose connection breaks, and that come back to the
 * units that they are at */
#include "config.h"

#include "lines_fixture.h"
#include "tests/unit.h"

FIXTURE(set_up, tear_down)

static void
still(uint64_t conn, const struct msg_unit *u, uint32_t height)
{
    struct msg m = { .type = MSG_STILL,
                     .still = { id, u->unit, u->attempt, height } };

    say(conn, &m);
}

/* ws1 and ws2, of the current version, with a unit each; the first was cut, and
 * the other has nothing to do. */
static void
one_is_cut(struct msg_unit *a)
{
    struct msg_unit b;

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    *a = *unit_of(W1);
    b = *unit_of(W2);
    result(W1, a, 0, 1, false);
    cut(W1);
    clear();
    result(W2, &b, 0, b.height, true);
}

/* What happened meanwhile: the job was paused, or the worker drained. */
LOOP_TEST(one_that_comes_back_gives_back_what_it_may_not_be_at, 2)
{
    struct msg_unit a;
    struct msg pause = { .type = MSG_PAUSE, .request = 9, .pause = { id } };
    struct msg drain = { .type = MSG_DRAIN,
                         .request = 9,
                         .drain = { .name = "ws1" } };

    one_is_cut(&a);
    say(_i == 0 ? ANA : ADMIN, _i == 0 ? &pause : &drain);
    wait_ms(1500);
    clear();
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    wait_ms(100);
    ck_assert_int_eq(count(W1, MSG_JOB_START), 1);
    still(W1, &a, a.height);
    ready(W1);
    wait_ms(200);
    ck_assert_int_eq(count(W1, MSG_YIELD), 1);
    gave(W1, &a, 0);
    wait_ms(500);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
}

TEST(one_that_comes_back_goes_on_with_its_units)
{
    struct msg_unit a;

    one_is_cut(&a);
    wait_ms(1500);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    base_line(W1, 0, line_above(a.y + a.height));
    still(W1, &a, a.height);
    ready(W1);
    wait_ms(3000);
    ck_assert_int_eq(count(W1, MSG_REVOKE), 0);
    ck_assert_int_eq(count(W1, MSG_UNIT) + count(W2, MSG_UNIT), 0);
    result(W1, &a, 1, a.height - 1, true); /* the first row is here */
    ck_assert(f.done);
    ck_assert_double_eq(stat_of("totals", "units_redone"), 0);
}

TEST(one_that_comes_back_hears_who_waits_for_its_base_line)
{
    struct msg_unit a, b;

    start_two(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, &a, &b);
    attempt(W2, MSG_PARKED, &b);
    cut(W1);
    cut(W2);
    clear();
    join(W2, MSG_ROLE_WORKER, "ws2", "");
    still(W2, &b, b.height);
    attempt(W2, MSG_PARKED, &b);
    ready(W2);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    base_line(W1, 0, line_above(a.y + a.height));
    wait_ms(500);
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 1); /* as if by no link */
    still(W1, &a, a.height);
    ready(W1);
    ck_assert_str_eq(last(W1, MSG_NEXT_HOLDER)->name, "ws2");
    result(W2, &b, 0, b.height, true);
    result(W1, &a, 0, a.height, true);
    ck_assert(f.done);
}

TEST(what_one_lost_waits_for_it_but_not_for_long)
{
    struct msg_unit a, b;

    one_is_cut(&a);
    wait_ms(1900);
    ck_assert_int_eq(count(W2, MSG_UNIT), 0);
    wait_ms(200);
    b = *unit_of(W2);
    ck_assert(b.unit == a.unit && b.attempt == a.attempt + 1);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    still(W1, &a, a.height);
    ck_assert_int_eq(count(W1, MSG_REVOKE), 1);
    ready(W1);
    finish(W2, &b);
    ck_assert(f.done);
}

TEST(nobody_waits_for_one_that_loads)
{
    struct msg_unit a, b;

    one_is_cut(&a);
    wait_ms(1900);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    wait_ms(1000); /* a new process, that loads the scene */
    ready(W1);
    b = *unit_of(W2);
    ck_assert_uint_eq(b.unit, a.unit);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    finish(W2, &b);
    ck_assert(f.done);
}

TEST(one_that_is_soon_ready_gets_what_it_had)
{
    struct msg_unit a, b;

    one_is_cut(&a);
    wait_ms(1000);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    ready(W1);
    b = *unit_of(W1);
    ck_assert(b.unit == a.unit && b.attempt == a.attempt + 1);
    ck_assert_int_eq(count(W2, MSG_UNIT), 0);
    finish(W1, &b);
    ck_assert(f.done);
}

/* Its answer to SPLIT was on the connection that broke, or comes now. */
TEST(lines_that_were_given_meanwhile_are_a_unit)
{
    struct msg_unit a, b;
    uint32_t height = 1 + 2 * BAR;

    one_is_cut(&a);
    ck_assert_uint_gt(a.height, height + BAR);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    still(W1, &a, a.height - BAR);
    ready(W1);
    b = *unit_of(W2);
    ck_assert(b.y == a.height - BAR && b.height == BAR);
    gave(W1, &a, height);
    finish(W2, &b);
    b = *unit_of(W2);
    ck_assert_uint_eq(b.y, height);
    ck_assert(!f.closed[W1]);
    base_line(W1, 0, line_above(height));
    result(W1, &a, 1, height - 1, true);
    finish(W2, &b);
    ck_assert(f.done);
}

TEST(what_nobody_has_is_no_unit)
{
    struct msg_unit a, b;

    one_is_cut(&a);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    b = a;
    b.unit = 999;
    still(W1, &b, a.height);
    b = a;
    b.attempt = 7;
    still(W1, &b, a.height);
    still(W1, &a, a.height + 1);
    ck_assert_int_eq(count(W1, MSG_REVOKE), 3);
    ready(W1);
    still(W1, &a, a.height); /* too late */
    ck_assert_int_eq(count(W1, MSG_REVOKE), 4);
    ck_assert_uint_eq(unit_of(W1)->attempt, a.attempt + 1);
    b = *unit_of(W1);
    finish(W1, &b);
    ck_assert(f.done && !f.closed[W1]);
}

/* The answer to SPLIT was on the connection that broke, and the unit is done.
 */
TEST(rows_that_end_sooner_say_that_lines_were_given)
{
    struct msg_unit a, b;
    uint32_t height = 1 + 2 * BAR;

    one_is_cut(&a);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    base_line(W1, 0, line_above(height));
    result(W1, &a, 1, height - 1, true);
    ready(W1);
    ck_assert(!f.closed[W1]);
    b = *(last(W2, MSG_UNIT) ? unit_of(W2) : unit_of(W1));
    ck_assert(b.y == height && b.height == a.height - height);
    finish(last(W2, MSG_UNIT) ? W2 : W1, &b);
    ck_assert(f.done);
    ck_assert_double_eq(stat_of("totals", "units_redone"), 0);
}

/* Each of its processes takes it down. */
TEST(one_that_dies_of_a_unit_does_not_keep_it)
{
    struct msg_unit a, b;

    one_is_cut(&a);
    for (int i = 0; i < 2; i++) {
        wait_ms(1000);
        join(W1, MSG_ROLE_WORKER, "ws1", "");
        ready(W1);
        ck_assert_uint_eq(unit_of(W1)->unit, a.unit);
        ck_assert_int_eq(count(W2, MSG_UNIT), 0);
        cut(W1);
    }
    b = *unit_of(W2);
    ck_assert_uint_eq(b.unit, a.unit);
    finish(W2, &b);
    ck_assert(f.done);
}

TEST(one_that_comes_and_goes_keeps_nothing)
{
    struct msg_unit a, b;

    one_is_cut(&a);
    for (int i = 0; i < 3; i++) {
        wait_ms(400);
        join(W1, MSG_ROLE_WORKER, "ws1", "");
        wait_ms(400);
        cut(W1);
    }
    b = *unit_of(W2);
    finish(W2, &b);
    ck_assert(f.done);
}

TEST(nothing_waits_for_one_that_leaves)
{
    struct msg leave = { .type = MSG_DRAIN, .drain = { .name = "ws1" } };
    struct msg_unit a, b;

    one_is_cut(&a);
    wait_ms(500);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    say(W1, &leave);
    ready(W1);
    wait_ms(200);
    b = *unit_of(W2);
    finish(W2, &b);
    ck_assert(f.done);
}

/* A unit that is late is so whether its worker's connection breaks or not. */
TEST(the_lease_of_a_unit_goes_on)
{
    struct msg_unit a, b;

    one_is_cut(&a);
    for (int i = 0; i < 7; i++) {
        join(W1, MSG_ROLE_WORKER, "ws1", "");
        still(W1, &a, a.height);
        ready(W1);
        wait_ms(10000);
        cut(W1);
    }
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    still(W1, &a, a.height);
    ready(W1);
    wait_ms(1000);
    b = *unit_of(W2);
    ck_assert(b.unit == a.unit && b.attempt != a.attempt);
    finish(W2, &b);
}

TEST(nobody_is_at_attempt_0)
{
    struct msg drain = { .type = MSG_DRAIN,
                         .request = 9,
                         .drain = { .name = "ws1" } };
    struct msg_unit a;

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    a = *unit_of(W1);
    cut(W2);
    say(ADMIN, &drain);
    result(W1, &a, 0, a.height, true); /* without its base line: nobody leads */
    cut(W1);
    drain.type = MSG_UNDRAIN;
    say(ADMIN, &drain);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    clear();
    a.attempt = 0;
    still(W1, &a, a.height);
    ck_assert_int_eq(count(W1, MSG_REVOKE), 1);
}
