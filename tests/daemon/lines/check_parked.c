/* check_parked.c - lines that wait for others, and what comes to those that do
 */
#include "config.h"

#include "lines_fixture.h"

FIXTURE(set_up, tear_down)

TEST(facts_go_to_whoever_has_the_line_now_and_later)
{
    struct msg_unit a, b;
    uint32_t line;

    start_two(MSG_PART_STATIC, 0, &a, &b);
    line = line_above(b.y);
    facts(W1, line - 1); /* its own: nobody else wants it */
    ck_assert_int_eq(count(W1, MSG_FACTS) + count(W2, MSG_FACTS), 0);
    facts(W2, line); /* the base line above, made ahead */
    ck_assert_int_eq(count(W1, MSG_FACTS), 1);
    ck_assert_int_eq(count(W2, MSG_FACTS), 0);
    facts(W1, line); /* its bottom: a guess for the one below */
    ck_assert_int_eq(count(W1, MSG_FACTS), 1);
    ck_assert_int_eq(count(W2, MSG_FACTS), 1);
    clear();
    replace(W1, W3);
    ck_assert_uint_eq(unit_of(W3)->unit, a.unit);
    ck_assert_int_eq(count(W3, MSG_FACTS), 3);
    ck_assert_uint_eq(last(W3, MSG_FACTS)->m.facts.npixels, 2);
    a = *unit_of(W3);
    finish(W3, &a);
    clear();
    facts(W2, 1); /* nobody wants it any more */
    ck_assert_int_eq(f.nsaid, 0);
    /* and two that both had made */
    ck_assert_double_eq(stat_of("totals", "speculative_rays"), 2 + 2);
}

/* Guesses go to the worker of the unit below, the best of them also to a worker
 * that gets the unit later. */
TEST(a_guess_goes_to_whoever_has_the_unit_below)
{
    struct msg_unit a, b;
    uint32_t line;

    start_two(MSG_PART_STATIC, 0, &a, &b);
    line = line_above(b.y); /* of b's top */
    guess(W2, line - 1, 3); /* another's */
    guess(W1, line - 2, 3); /* within its unit */
    guess(W1, line, 3);     /* of the last line itself: b's own */
    ck_assert_int_eq(count(W1, MSG_GUESS) + count(W2, MSG_GUESS), 0);
    guess(W1, line - 1, 2);
    ck_assert_int_eq(count(W2, MSG_GUESS), 1);
    guess(W1, line - 1, 2); /* no better */
    ck_assert_int_eq(count(W2, MSG_GUESS), 1);
    guess(W1, line - 1, 3);
    ck_assert_int_eq(count(W2, MSG_GUESS), 2);
    ck_assert_uint_eq(last(W2, MSG_GUESS)->m.guess.line, line - 1);
    ck_assert_uint_eq(last(W2, MSG_GUESS)->m.guess.known, 3);
    clear();
    replace(W2, W3);
    ck_assert_uint_eq(unit_of(W3)->unit, b.unit);
    ck_assert_int_eq(count(W3, MSG_GUESS), 1);
    ck_assert_uint_eq(last(W3, MSG_GUESS)->m.guess.known, 3);
    base_line(W1, 0, line);
    clear();
    replace(W3, W2);
    ck_assert_int_eq(count(W2, MSG_GUESS), 0); /* the truth is here */
    result(W1, &a, 0, a.height, true);
}

TEST(a_guess_that_fits_no_line_ends_the_connection)
{
    struct msg m = { .type = MSG_GUESS,
                     .guess = { id, 0, 0, 1, ndensity() - 1, density } };

    start(MSG_PART_SCANBAR, 0, 2);
    join(W3, MSG_ROLE_WORKER, "ws3", "");
    ready(W3);
    say(W2, &m);
    ck_assert(f.closed[W2]);
    guess(W3, HEIGHT / BAR, 1); /* the last has none below */
    ck_assert(f.closed[W3]);
    guess(W1, UINT32_MAX, 1); /* line 0, which W1 has, is not the next */
    ck_assert(f.closed[W1]);
}

TEST(facts_that_fit_no_line_end_the_connection)
{
    struct msg m = { .type = MSG_FACTS,
                     .facts = { id, 0, 0, 0, BAR, WIDTH, 0, 3, bitmap, pixels,
                                2 } };

    start(MSG_PART_SCANBAR, 0, 2);
    say(W1, &m); /* line 0 has one row */
    ck_assert(f.closed[W1]);
}

TEST(a_parked_unit_takes_no_room)
{
    struct msg_unit b, c;

    start(MSG_PART_SCANBAR, 0, 2);
    b = *first_unit_of(W2);
    c = *unit_of(W2);
    clear();
    attempt(W1, MSG_PARKED, &b); /* another's */
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    attempt(W2, MSG_PARKED, &b);
    ck_assert_int_eq(count(W2, MSG_UNIT), 1);
    ck_assert_uint_eq(unit_of(W2)->y, c.y + c.height);
    attempt(W2, MSG_PARKED, &b); /* once is enough */
    ck_assert_int_eq(count(W2, MSG_UNIT), 1);
}

TEST(a_parked_unit_is_work_again_when_its_top_is_there)
{
    const struct job_part *part;
    struct msg_unit b;
    struct job *job;

    start(MSG_PART_STATIC, 0, 2);
    job = desk_find_job(f.c, id);
    part = &job->parts[part_find(job, "ws2")];
    b = *unit_of(W2);
    attempt(W2, MSG_PARKED, &b);
    ck_assert(part->parked == 1 && part->in_flight == 0);
    base_line(W1, 0, line_above(b.y));
    ck_assert(part->parked == 0 && part->in_flight == 1);
    finish(W2, &b);
    ck_assert(part->parked == 0 && part->in_flight == 0);
}

TEST(while_its_rows_go_to_the_disk_a_worker_has_other_work)
{
    struct msg bye = { .type = MSG_DRAIN, .drain = { .name = "ws1" } };
    struct msg_unit a;

    start(MSG_PART_SCANBAR, 0, 2);
    a = *first_unit_of(W1);
    clear();
    f.slow_disk = true;
    finish(W1, &a);
    ck_assert_int_ge(count(W1, MSG_UNIT), 1);
    a = *first_unit_of(W1);
    say(W1, &bye);
    clear();
    finish(W1, &a);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    ck_assert_int_eq(count(W1, MSG_BYE), 0); /* it may have to send again */
}

TEST(a_base_line_reaches_one_that_waits_when_its_link_is_broken)
{
    struct msg_unit a, b;

    start_two(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, &a, &b);
    attempt(W2, MSG_PARKED, &b);
    clear();
    base_line(W2, 0, line_above(b.y)); /* not his to make */
    wait_ms(300);
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 0);
    base_line(W1, 0, line_above(b.y));
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 0); /* it comes over the link */
    wait_ms(300);
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 1); /* it did not */
    result(W1, &a, 0, a.height, true);
    finish(W2, &b);
    ck_assert(f.done);
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 1);
}

TEST(a_base_line_goes_at_once_where_there_can_be_no_link)
{
    struct msg_unit b;

    coord_closed(f.c, f.now_ms, W1, "cut");
    coord_closed(f.c, f.now_ms, W2, "cut");
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    join(W2, MSG_ROLE_WORKER, "ws2", "");
    start(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, 2);
    b = *unit_of(W2);
    attempt(W2, MSG_PARKED, &b);
    base_line(W1, 0, line_above(b.y));
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 1);
}

TEST(a_base_line_that_fits_no_line_ends_the_connection)
{
    struct msg m = { .type = MSG_BASE_LINE,
                     .base_line = { id, 0, 3, 1, WIDTH, 0, 0, 3, density,
                                    pixels } };

    start(MSG_PART_SCANBAR, 0, 2);
    say(W1, &m);
    ck_assert(f.closed[W1]);
}

/* Three times, and the job fails; the rows are not taken. */
TEST(a_unit_without_its_base_line_is_done_again)
{
    submit(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, "uniform", 1);
    ready(W1);
    for (int i = 0; i < JOB_MAX_CRASHES; i++) {
        struct msg_unit a = *unit_of(W1);

        ck_assert_uint_eq(a.attempt, i + 1);
        result(W1, &a, 0, a.height, true);
        ck_assert_int_eq(count(W1, MSG_ACK), i + 1);
    }
    ck_assert(f.failed);
    ck_assert_ptr_nonnull(strstr(f.why, "unit 0 came incomplete"));
}

TEST(a_lost_workers_units_wait_again_the_parked_ones_too)
{
    struct msg_unit b;
    bool again = false;

    start(MSG_PART_SCANBAR, 0, 2);
    b = *first_unit_of(W2);
    facts(W2, line_above(b.y + b.height));
    attempt(W2, MSG_PARKED, &b);
    clear();
    replace(W2, W3);
    for (int i = 0; i < f.nsaid && !again; i++) {
        const struct msg_unit *u = &f.said[i].m.unit;

        if (f.said[i].conn != W3 || f.said[i].m.type != MSG_UNIT)
            continue;
        again = u->unit == b.unit && u->attempt == 2;
        attempt(W3, MSG_PARKED, u);
    }
    ck_assert(again);
    /* the unit's, and its last line's to the one below */
    ck_assert_int_eq(count(W3, MSG_FACTS), 2);
}

TEST(one_that_leaves_gives_up_what_only_waits)
{
    struct msg drain = { .type = MSG_DRAIN, .drain = { .name = "ws2" } };
    struct msg_unit a, b;

    start_two(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, &a, &b);
    say(W2, &drain);
    attempt(W2, MSG_PARKED, &b);
    clear();
    wait_ms(200);
    ck_assert_int_eq(count(W2, MSG_YIELD), 1);
    ck_assert_int_eq(count(W2, MSG_BYE), 0);
    gave(W2, &b, 0);
    wait_ms(200);
    ck_assert_int_eq(count(W2, MSG_BYE), 1);
    ck_assert(f.closed[W2]);
    finish(W1, &a);
    ck_assert_uint_eq(unit_of(W1)->unit, b.unit);
}

TEST(rows_that_cross_a_revoke_bring_nothing_back)
{
    struct msg drain = { .type = MSG_DRAIN, .drain = { .name = "ws2" } };
    struct msg_unit a, b;

    start_two(MSG_PART_STATIC, MSG_JOB_NO_BALANCE, &a, &b);
    say(ADMIN, &drain);
    attempt(W2, MSG_PARKED, &b);
    wait_ms(5700); /* it does not answer YIELD */
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    result(W2, &b, 0, 1, false); /* its top had just come from a peer */
    ck_assert_int_eq(count(W2, MSG_ACK), 1);
    finish(W1, &a);
    ck_assert_uint_eq(unit_of(W1)->unit, b.unit);
}

/* Its top was on its way to it, or it needs none. */
TEST(one_that_has_its_top_is_not_parked)
{
    const struct job_part *part;
    struct msg_unit a, b;
    struct job *job;

    start(MSG_PART_STATIC, 0, 2);
    job = desk_find_job(f.c, id);
    a = *unit_of(W1);
    b = *unit_of(W2);
    attempt(W1, MSG_PARKED, &a);
    part = &job->parts[part_find(job, "ws1")];
    ck_assert(part->parked == 0 && part->in_flight == 1);
    base_line(W1, 0, line_above(b.y));
    clear();
    attempt(W2, MSG_PARKED, &b);
    part = &job->parts[part_find(job, "ws2")];
    ck_assert(part->parked == 0 && part->in_flight == 1);
    wait_ms(300);
    ck_assert_int_eq(count(W2, MSG_BASE_LINE), 1);
}
