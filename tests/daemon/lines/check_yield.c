/* check_yield.c - units that go back before their end, for something that comes
 * first */
#include "config.h"

#include "lines_fixture.h"

FIXTURE(set_up, tear_down)

static void
about_job(uint64_t conn, uint16_t type)
{
    struct msg m = { .type = type, .request = 9, .pause = { id } };

    say(conn, &m);
}

static void
about_worker(uint16_t type, const char *name)
{
    struct msg m = { .type = type, .request = 9, .drain = { .name = name } };

    say(ADMIN, &m);
}

/* ws1 and ws2 are at lines. */
static void
begin(struct msg_unit *a, struct msg_unit *b)
{
    start(MSG_PART_AUTO, 0, 2);
    *a = *first_unit_of(W1);
    *b = *first_unit_of(W2);
    clear();
}

TEST(a_paused_jobs_units_go_back_and_come_again_with_their_facts)
{
    struct msg_unit a, b, again;

    begin(&a, &b);
    about_job(ANA, MSG_PAUSE);
    wait_ms(100);
    ck_assert_int_ge(count(W1, MSG_YIELD), 1);
    ck_assert_int_ge(count(W2, MSG_YIELD), 1);
    wait_ms(1000);
    ck_assert_int_eq(count(W1, MSG_REVOKE) + count(W2, MSG_REVOKE), 0);
    facts(W1, line_above(a.y + a.height));
    gave(W1, &a, 0);
    ck_assert_int_eq(count(W1, MSG_UNIT) + count(W2, MSG_UNIT), 0);
    clear();
    about_job(ANA, MSG_RESUME);
    again = *first_unit_of(W1);
    ck_assert(again.unit == a.unit && again.attempt > a.attempt);
    ck_assert_int_ge(count(W1, MSG_FACTS), 1);
    ck_assert_double_eq(stat_of("totals", "units_redone"), 0);
}

TEST(rows_that_are_out_stay)
{
    uint32_t keep;
    struct msg_unit a, b;

    begin(&a, &b);
    ck_assert_uint_eq(a.y, 0);
    keep = 1 + BAR;
    ck_assert_uint_gt(a.height, keep);
    result(W1, &a, 0, keep - 1, false);
    about_job(ANA, MSG_PAUSE);
    wait_ms(100);
    gave(W1, &a, keep);
    base_line(W1, a.frame, line_above(keep));
    result(W1, &a, keep - 1, 1, true);
    ck_assert_int_eq(desk_find_job(f.c, id)->units[a.unit].state, UNIT_DONE);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
    about_job(ANA, MSG_RESUME);
    ck_assert_uint_eq(first_unit_of(W1)->y, keep);
}

TEST(a_drained_worker_is_let_go_of_all)
{
    struct msg_unit a, b;

    begin(&a, &b);
    about_worker(MSG_DRAIN, "ws1");
    wait_ms(100);
    ck_assert_int_ge(count(W1, MSG_YIELD), 1);
    ck_assert_int_eq(count(W2, MSG_YIELD), 0);
    gave(W1, &a, 0);
    ck_assert_uint_eq(f.c->workers->in_flight, 0);
    wait_ms(500);
    ck_assert_int_eq(count(W1, MSG_UNIT), 0);
}

TEST(a_child_that_does_not_answer_loses_its_unit)
{
    struct msg_unit a, b;

    begin(&a, &b);
    about_worker(MSG_DRAIN, "ws1");
    wait_ms(4000);
    ck_assert_int_eq(count(W1, MSG_REVOKE), 0);
    wait_ms(2000);
    ck_assert_int_ge(count(W1, MSG_REVOKE), 1);
}

/* Its areas go to another worker. */
TEST(a_worker_that_leaves_its_estimate_is_let_go)
{
    struct msg leave = { .type = MSG_DRAIN, .drain = { .name = "ws1" } };

    submit(MSG_PART_AUTO, 0, "20b", 1);
    ready(W1);
    ready(W2);
    clear();
    say(W1, &leave);
    wait_ms(100);
    ck_assert_int_eq(count(W1, MSG_BYE), 1);
    ck_assert(f.closed[W1]);
    ck_assert_int_eq(count(W2, MSG_ESTIMATE), 0); /* it has areas */
}

TEST(a_worker_of_a_restarted_coordinator_does_not_hang)
{
    struct msg_unit a, b;

    f.now_ms += 1000000; /* what its clock says has no beginning */
    come(2);
    begin(&a, &b);
    wait_ms(1000);
    for (const struct coord_worker *w = f.c->workers; w; w = w->next)
        ck_assert(!w->hangs);
}
