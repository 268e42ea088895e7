/* check_handoff.c - which lines of a picture go to whom, with what is known of
 * them */
#include "config.h"

#include "lines_fixture.h"

FIXTURE(set_up, tear_down)

TEST(lines_go_out_with_what_is_known_of_them)
{
    struct msg_unit a, b, c;

    start(MSG_PART_SCANBAR, 0, 2);
    a = *first_unit_of(W1);
    b = *first_unit_of(W2);
    ck_assert(a.mode == MSG_MODE_STRICT && a.y == 0 && a.height == 1 + BAR);
    ck_assert(a.width == WIDTH && a.flags == 0);
    ck_assert_uint_eq(b.height, BAR);
    ck_assert_uint_gt(b.y, a.y + a.height);   /* not what follows */
    ck_assert_uint_eq(b.flags, MSG_UNIT_TOP); /* nobody has what is above */
    ck_assert_int_eq(count(W1, MSG_JOB_PEERS), 0); /* not needed yet */
    a = *unit_of(W2); /* the one that follows is at hand */
    ck_assert_uint_eq(a.y, b.y + b.height);
    ck_assert_uint_eq(a.flags, 0);
    clear();
    base_line(W2, 0, line_above(a.y + a.height));
    attempt(W2, MSG_PARKED, &b);
    c = *unit_of(W2); /* and the next */
    ck_assert_uint_eq(c.y, a.y + a.height);
    ck_assert_uint_eq(c.flags, 0);
    ck_assert_str_eq(last(W2, MSG_NEXT_HOLDER)->name, "ws2");
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 1); /* its top is here */
    ck_assert_uint_eq(last(W2, MSG_BASE_LINE)->m.base_line.n, WIDTH);
}

static uint32_t
waiting(void)
{
    return job_waiting(desk_find_job(f.c, id));
}

/* Two that make a base line make one of them for nothing. */
TEST(a_line_that_the_one_below_makes_is_kept_till_it_is_there)
{
    struct msg_unit b;
    uint32_t n;

    start(MSG_PART_SCANBAR, 0, 2);
    b = *first_unit_of(W2);
    n = waiting();
    facts(W2, line_above(b.y) - 1); /* another's */
    facts(W1, line_above(b.y));     /* by another */
    ck_assert_uint_eq(waiting(), n);
    facts(W2, line_above(b.y));
    ck_assert_uint_eq(waiting(), n + 1);
}

TEST(a_kept_line_is_free_when_its_maker_has_no_more_to_do)
{
    struct msg_unit b;
    uint32_t n;

    start(MSG_PART_SCANBAR, 0, 2);
    b = *first_unit_of(W2);
    n = waiting();
    attempt(W2, MSG_PARKED, &b);
    ck_assert_uint_eq(waiting(), n); /* one is out for it */
}

TEST(a_kept_line_is_free_when_its_maker_is_lost)
{
    uint32_t n;

    start(MSG_PART_SCANBAR, 0, 2);
    n = waiting();
    cut(W2);
    ck_assert_uint_eq(waiting(), n + 3); /* and its two units */
}

TEST(a_kept_line_is_free_when_its_maker_is_stuck)
{
    uint32_t n;

    start(MSG_PART_SCANBAR, 0, 2);
    n = waiting();
    wait_ms(4900);
    ck_assert_uint_eq(waiting(), n);
    wait_ms(200);
    ck_assert_uint_eq(waiting(), n + 1);
}

/* However long a line takes: no thread waits for our answer.  In the end what
 * one has at hand another would wait for. */
TEST(a_line_is_at_hand_until_few_are_left)
{
    struct msg_unit u[2];
    int given = 0;

    start(MSG_PART_SCANBAR, 0, 2);
    ck_assert_int_eq(count(W1, MSG_UNIT), 2);
    ck_assert_int_eq(count(W2, MSG_UNIT), 2);
    u[0] = *first_unit_of(W2);
    u[1] = *unit_of(W2);
    for (;; given++) {
        wait_ms(1000);
        clear();
        attempt(W2, MSG_PARKED, &u[given % 2]);
        if (count(W2, MSG_UNIT) == 0)
            break;
        u[given % 2] = *unit_of(W2);
    }
    ck_assert_int_ge(given, 2);
    clear();
    attempt(W2, MSG_PARKED, &u[(given + 1) % 2]);
    ck_assert_int_eq(count(W2, MSG_UNIT), 1);
    ck_assert_int_eq(job_waiting(desk_find_job(f.c, id)), 3);
}

TEST(both_sides_hear_who_waits_for_a_base_line)
{
    struct msg_unit a, b;
    const struct said *s;

    start_two(MSG_PART_STATIC, 0, &a, &b);
    ck_assert_uint_eq(a.y + a.height, b.y);
    ck_assert_uint_eq(b.y + b.height, HEIGHT);
    s = last(W1, MSG_NEXT_HOLDER);
    ck_assert_ptr_nonnull(s);
    ck_assert_uint_eq(s->m.next_holder.line, line_above(b.y));
    ck_assert_str_eq(s->name, "ws2");
    ck_assert_uint_eq(b.flags, 0); /* its first bar's colours come soon */
    clear();
    replace(W1, W3); /* and another gets it */
    ck_assert_uint_eq(unit_of(W3)->y, 0);
    ck_assert_str_eq(last(W3, MSG_NEXT_HOLDER)->name, "ws2");
    ck_assert_int_eq(count(W3, MSG_JOB_PEERS), 1); /* a link for that */
}

TEST(a_single_worker_has_no_links_and_whole_frames)
{
    f.closed[W2] = true;
    coord_closed(f.c, f.now_ms, W2, "cut");
    submit(MSG_PART_AUTO, 0, "uniform", 2);
    ready(W1);
    for (uint32_t i = 0; i < 2; i++) {
        struct msg_unit u = i ? *unit_of(W1) : *first_unit_of(W1);

        ck_assert(u.frame == i && u.y == 0 && u.height == HEIGHT);
        ck_assert_uint_eq(u.flags, 0);
        finish(W1, &u);
    }
    ck_assert(f.done);
    ck_assert_int_eq(count(W1, MSG_JOB_PEERS), 0);
    ck_assert_int_eq(count(W1, MSG_NEXT_HOLDER), 0);
}

/* Each frame has a run of each worker; those of one that is drained would wait
 * for ever. */
TEST(what_was_to_be_a_drained_workers_goes_to_others)
{
    struct msg drain = { .type = MSG_DRAIN, .drain = { .name = "ws2" } };
    struct msg_unit a[2], b;

    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "uniform", 2);
    ready(W1);
    ready(W2);
    a[0] = *unit_of(W1);
    b = *unit_of(W2);
    say(ADMIN, &drain);
    finish(W1, &a[0]);
    finish(W2, &b);
    a[1] = *unit_of(W1);
    ck_assert(a[1].frame == 1 && a[1].y == 0);
    clear();
    finish(W1, &a[1]);
    b = *unit_of(W1);
    ck_assert(b.frame == 1 && b.y == a[1].height);
    finish(W1, &b);
    ck_assert(f.done);
}

/* Its child is stopped: it has the first unit, and would have another run. */
TEST(what_was_to_be_a_stopped_workers_goes_to_others)
{
    struct msg tally = { .type = MSG_TALLY, .tally = { .job = id } };
    struct msg_unit u[2], b;

    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "uniform", 3);
    ready(W1);
    ready(W2);
    b = *unit_of(W2);
    for (int i = 0; i < 3; i++) {
        u[0] = *unit_of(W1);
        ck_assert(u[0].frame == (uint32_t)i && u[0].y == 0);
        clear();
        finish(W1, &u[0]);
    }
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    wait_ms(61000);
    u[0] = *unit_of(W1);
    ck_assert_uint_eq(u[0].unit, b.unit);
    clear();
    finish(W1, &u[0]);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    ck_assert_int_eq(count(W2, MSG_UNIT), 0);
    u[1] = *unit_of(W1); /* W2's run of the next frame */
    ck_assert(u[1].frame == 1 && u[1].y == b.y);
    clear();
    say(W2, &tally);
    wait_ms(100);
    u[0] = *unit_of(W2); /* it goes on after all */
    ck_assert(u[0].frame == 2 && u[0].y == b.y);
    finish(W1, &u[1]);
    finish(W2, &u[0]);
    ck_assert(f.done);
}

TEST(one_that_is_drained_before_the_layout_has_no_part)
{
    struct msg drain = { .type = MSG_DRAIN, .drain = { .name = "ws2" } };

    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "uniform", 1);
    say(ADMIN, &drain);
    ready(W1);
    ready(W2);
    ck_assert_uint_eq(unit_of(W1)->height, HEIGHT);
}
