/* check_balance.c - lines that are given away to one who has none */
#include "config.h"

#include "lines_fixture.h"

FIXTURE(set_up, tear_down)

TEST(an_idle_worker_gets_half_of_what_another_has_left)
{
    struct msg_unit a, b, c;

    start_two(MSG_PART_STATIC, 0, &a, &b);
    wait_ms(100);
    finish(W1, &a);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 1);
    gave(W1, &b, BAR); /* not his */
    ck_assert_int_eq(count(W1, MSG_UNIT), 1);
    clear();
    gave(W2, &b, 2 * BAR);
    c = *unit_of(W1);
    ck_assert(c.unit == 2 && c.y == b.y + 2 * BAR);
    ck_assert_uint_eq(c.y + c.height, HEIGHT);
    ck_assert_uint_eq(c.flags, 0); /* the giver makes the shared base line */
    ck_assert_str_eq(last(W2, MSG_NEXT_HOLDER)->name, "ws1");
    ck_assert_uint_eq(last(W2, MSG_NEXT_HOLDER)->m.next_holder.line,
                      line_above(c.y));
    facts(W1, line_above(c.y)); /* goes back to the giver */
    ck_assert_int_eq(count(W2, MSG_FACTS), 1);
    b.height = 2 * BAR;
    finish(W2, &b);
    finish(W1, &c);
    ck_assert(f.done);
}

TEST(one_that_has_nothing_to_give_is_not_asked_again)
{
    struct msg_unit a, b;

    start_two(MSG_PART_STATIC, 0, &a, &b);
    wait_ms(100);
    finish(W1, &a);
    gave(W2, &b, b.height);
    wait_ms(5000);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 1);
    ck_assert_int_eq(count(W1, MSG_UNIT), 1); /* static makes no twins */
}

/* It stood still when it was asked, and a twin has begun meanwhile, with all of
 * the unit. */
TEST(lines_that_come_after_a_twin_are_not_given)
{
    struct msg_unit a, b, twin;

    start_two(MSG_PART_STATIC, 0, &a, &b);
    wait_ms(100);
    finish(W1, &a);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 1);
    wait_ms(61000);
    twin = *unit_of(W1);
    ck_assert(twin.unit == b.unit && twin.height == b.height);
    gave(W2, &b, BAR);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    finish(W1, &twin);
    ck_assert(f.done && !f.closed[W1] && !f.closed[W2]);
}

TEST(without_balance_nobody_is_asked)
{
    struct msg_unit a;

    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    a = *unit_of(W1);
    wait_ms(100);
    finish(W1, &a);
    wait_ms(1000);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 0);
}

TEST(a_gave_that_fits_no_lines_ends_the_connection)
{
    struct msg_unit a, b;

    start_two(MSG_PART_STATIC, 0, &a, &b);
    gave(W2, &b, BAR); /* was not asked */
    ck_assert(!f.closed[W2]);
    wait_ms(100);
    finish(W1, &a);
    gave(W2, &b, BAR + 1);
    ck_assert(f.closed[W2]);
}

TEST(static_weighs_workers_by_what_earlier_jobs_showed)
{
    struct msg_unit a, b;
    struct msg tally = { .type = MSG_TALLY, .tally = { .job = id } };

    start_two(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, &a, &b);
    ck_assert_uint_ge(a.height, HEIGHT / 2 - BAR);
    wait_ms(1000);
    tally.tally.rays_under_way = 1000;
    say(W1, &tally);
    tally.tally.rays_under_way = 4000;
    say(W2, &tally);
    wait_ms(200);
    ck_assert_double_gt(desk_find_job(f.c, id)->parts[1].speed,
                        3 * desk_find_job(f.c, id)->parts[0].speed);
    tally.type = MSG_CANCEL;
    tally.cancel.job = id;
    say(ANA, &tally);
    clear();
    for (struct coord_worker *w = f.c->workers; w; w = w->next)
        ck_assert_double_lt(w->relative, 1.5);
    ck_assert_double_gt(f.c->workers->next->relative,
                        1.5 * f.c->workers->relative);
    (void)b;
}

/* All threads of a worker share its unit to the end; small units beside it
 * would wait for each other's base lines. */
TEST(a_worker_of_many_threads_has_one_unit_of_lines)
{
    struct msg_unit u;
    uint32_t most;

    f.threads = 4;
    f.tall = true;
    join(W3, MSG_ROLE_WORKER, "ws3", "");
    submit(MSG_PART_AUTO, 0, "uniform", 1);
    ready(W3);
    u = *unit_of(W3);
    most = u.height - BAR;
    ck_assert_uint_ge(most, 5 * BAR);
    wait_ms(1000);
    result(W3, &u, 0, most, false);
    wait_ms(100);
    ck_assert_int_eq(count(W3, MSG_UNIT), 1);
    result(W3, &u, most, BAR, true);
    wait_ms(100);
    ck_assert_int_eq(count(W3, MSG_UNIT), 2);
}

/* It had nothing left ahead of the truth; under that there are pixels again
 * that no guess could be sure of. */
TEST(one_whose_top_came_may_be_asked_again)
{
    struct msg_unit a, b, c;

    join(W3, MSG_ROLE_WORKER, "ws3", "");
    start(MSG_PART_STATIC, 0, 3);
    a = *unit_of(W1);
    b = *unit_of(W2);
    c = *unit_of(W3);
    wait_ms(100);
    finish(W3, &c);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 1);
    gave(W2, &b, b.height);
    ck_assert_int_eq(count(W1, MSG_SPLIT), 1);
    gave(W1, &a, a.height);
    attempt(W2, MSG_PARKED, &b);
    wait_ms(1000);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 1);
    base_line(W1, 0, line_above(b.y));
    wait_ms(100);
    ck_assert_int_eq(count(W2, MSG_SPLIT), 2);
    gave(W2, &b, BAR);
    ck_assert_uint_eq(unit_of(W3)->y, b.y + BAR);
}
