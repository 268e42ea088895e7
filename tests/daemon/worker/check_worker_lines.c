/* check_worker_lines.c - a worker passes base lines, facts and loans on */
#include "config.h"

#include "worker_fixture.h"

#include <sysexits.h>

FIXTURE(set_up, tear_down)

/* A piece of base line 1 of the job's picture, 8 columns wide. */
static struct msg
piece(uint32_t x, uint32_t n, uint32_t first, uint32_t ndensity)
{
    return (struct msg){ .type = MSG_BASE_LINE,
                         .base_line = { job_id, 0, 1, x, n, first, ndensity, 3,
                                        density, line_bytes } };
}

static void
made(uint32_t x, uint32_t n, uint32_t first, uint32_t ndensity)
{
    struct msg m = piece(x, n, first, ndensity);

    hear(f.child, &m);
}

static void
next_holder(const char *name)
{
    struct msg m = { .type = MSG_NEXT_HOLDER,
                     .next_holder = { job_id, 0, 1, name } };

    hear(f.coord, &m);
}

static void
link_peer(void)
{
    introduce(MSG_PEER_DIAL);
    peer_opened();
}

TEST(a_base_line_goes_to_whom_waits_and_to_the_coordinator)
{
    load_job();
    link_peer();
    next_holder("ws2");
    made(0, 5, 0, 2);
    ck_assert_int_eq(said(f.coord, MSG_BASE_LINE), 1);
    ck_assert_int_eq(said(f.peer, MSG_BASE_LINE), 1);
    made(5, 3, 2, 2);
    ck_assert_int_eq(said(f.peer, MSG_BASE_LINE), 2);
    ck_assert_uint_eq(f.last.base_line.x, 5);
    ck_assert_uint_eq(f.last.base_line.first, 2);
    next_holder("ws2"); /* has all of it */
    next_holder("ws9"); /* no link to that */
    next_holder("");
    ck_assert_int_eq(said(f.peer, MSG_BASE_LINE), 2);
    hear(f.child, &(struct msg){ .type = MSG_TALLY, .tally.job = job_id });
    ck_assert_int_eq(said(f.coord, MSG_TALLY), 1);
    /* each piece twice: frame, fields, a float for each colour, densities */
    ck_assert_uint_eq(f.last.tally.base_line_bytes,
                      2 * (2 * (MSG_HEADER + 41) + 8 * 12 + 4));
    ck_assert_uint_eq(f.last.tally.base_line_pixels, 8);
}

TEST(a_base_line_that_is_made_goes_to_one_named_late_or_linked_late)
{
    load_job();
    made(0, 5, 0, 2);
    made(0, 5, 0, 2); /* once more: the same values */
    made(7, 1, 4, 0); /* with a gap before it: not of use */
    made(5, 2, 2, 1);
    next_holder("ws2");
    ck_assert_int_eq(said(f.coord, MSG_BASE_LINE), 4);
    clear();
    link_peer();
    ck_assert_int_eq(said(f.peer, MSG_BASE_LINE), 1);
    ck_assert_uint_eq(f.last.base_line.n, 7);
    ck_assert_uint_eq(f.last.base_line.ndensity, 3);
    ck_assert_mem_eq(f.last.base_line.density, "\3\0\3", 3);
    made(7, 1, 3, 1);
    ck_assert_int_eq(said(f.peer, MSG_BASE_LINE), 2);
    ck_assert_uint_eq(f.last.base_line.x, 7);
}

TEST(a_base_line_from_a_peer_goes_to_the_child_if_it_fits)
{
    struct msg m = piece(0, 8, 0, 4);

    load_job();
    link_peer();
    hear(f.peer, &m);
    ck_assert_int_eq(said(f.child, MSG_BASE_LINE), 1);
    m.base_line.x = 1; /* to column 9 of 8 */
    hear(f.peer, &m);
    ck_assert_int_eq(said(f.child, MSG_BASE_LINE), 1);
    ck_assert_int_eq(f.session, MSG_NSESSION); /* closed */
    m.base_line.x = 0;
    hear(f.peer, &m);
    ck_assert_int_eq(said(f.child, MSG_BASE_LINE), 1);
    hear(f.coord, &m); /* the coordinator has it, too */
    ck_assert_int_eq(said(f.child, MSG_BASE_LINE), 2);
}

TEST(base_lines_are_repeated_before_rows_that_were_not_acknowledged)
{
    load_job();
    made(0, 8, 0, 4);
    unit(0);
    rows(0, 0);
    rows(0, 2);
    cut();
    made(0, 8, 0, 4); /* nobody hears it */
    clear();
    tick(500);
    connect();
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_BASE_LINE), 1);
    ck_assert_int_eq(f.said[f.nsaid - 4].type, MSG_BASE_LINE);
    ck_assert_int_eq(f.said[f.nsaid - 3].type, MSG_RESULT);
    ack(0, 0);
    ack(0, 2);
    ack(1, 0);
    cut();
    clear();
    tick(1000);
    connect();
    start_job();
    ck_assert_int_eq(said(f.coord, MSG_BASE_LINE), 0);
}

/* Down only what is about a unit that the child has, up all of it. */
TEST(what_workers_share_passes_through)
{
    static const uint8_t bitmap[1] = { 1 };
    static const struct msg_area area = { 0, 0, 0, 8, 8 };
    static const struct msg_cost cost = { 3, 4 };
    const struct msg down[] = {
        { .type = MSG_SPLIT, .split = { job_id, 3, 1 } },
        { .type = MSG_LEND, .lend = { job_id, 3, 1, 9 } },
        { .type = MSG_BACK, .back = { job_id, 3, 1, 1, 0, 6 } },
        { .type = MSG_FACTS,
          .facts = { job_id, 0, 1, 0, 1, 8, 0, 3, bitmap,
                     .pixels = line_bytes } },
        { .type = MSG_GUESS, .guess = { job_id, 0, 1, 2, 1, density } },
        { .type = MSG_ESTIMATE, .estimate = { job_id, 1, 5, 1, &area } },
    };
    const struct msg up[] = {
        { .type = MSG_PARKED, .parked = { job_id, 3, 1 } },
        { .type = MSG_GAVE, .gave = { job_id, 3, 1, 2 } },
        { .type = MSG_LOAN,
          .loan = { job_id, 3, 1, 0, 1, 0, 6, 1, 2, 0, 3, 0, density, bitmap,
                    line_bytes, line_bytes } },
        { .type = MSG_FACTS,
          .facts = { job_id, 0, 1, 0, 1, 8, 0, 3, bitmap,
                     .pixels = line_bytes } },
        { .type = MSG_GUESS, .guess = { job_id, 0, 1, 2, 1, density } },
        { .type = MSG_ESTIMATED,
          .estimated = { job_id, 1, 1, &cost, { .rays = 9 } } },
    };

    load_job();
    for (int i = 0; i < 3; i++) { /* nothing about unit 3 */
        hear(f.coord, &down[i]);
        ck_assert_int_eq(said(f.child, down[i].type), 0);
    }
    for (int i = 0; i < 3; i++) {
        hear(f.child, &up[i]);
        ck_assert_int_eq(said(f.coord, up[i].type), 0);
    }
    unit(3);
    for (int i = 0; i < N_ELEM(down); i++) {
        hear(f.coord, &down[i]);
        ck_assert_int_eq(said(f.child, down[i].type), 1);
    }
    for (int i = 0; i < N_ELEM(up); i++) {
        hear(f.child, &up[i]);
        ck_assert_int_eq(said(f.coord, up[i].type), 1);
    }
}

/* Columns that another lends are with the child until it says PAID; again after
 * that, it may not have heard yet that they were taken back. */
TEST(what_is_lent_is_a_unit_until_it_is_done)
{
    static const uint8_t bitmap[1] = { 1 };
    struct msg loan = { .type = MSG_LOAN,
                        .loan = { job_id, 3, 2, 0, 1, 0, 6, 1, 2, 0, 3, 0,
                                  density, bitmap, line_bytes, line_bytes } };
    const struct msg paid = { .type = MSG_PAID,
                              .paid = { job_id, 3, 2, { .rays = 9 } } };

    load_job();
    loan.loan.channels = 4; /* not this job's */
    hear(f.coord, &loan);
    ck_assert_int_eq(said(f.child, MSG_LOAN), 0);
    loan.loan.channels = 3;
    hear(f.coord, &loan);
    hear(f.coord, &loan); /* it has it */
    ck_assert_int_eq(said(f.child, MSG_LOAN), 1);
    hear(f.child, &paid);
    ck_assert_int_eq(said(f.coord, MSG_PAID), 1);
    ck_assert_uint_eq(f.last.paid.counts.rays, 9);
    hear(f.child, &paid);
    ck_assert_int_eq(said(f.coord, MSG_PAID), 2);
    child_crashes();
    ck_assert_uint_eq(f.last.lost.nunits, 0);
}

/* Its child would wait for ever. */
static struct msg_tally
tally_said(void)
{
    ck_assert_int_eq(f.last.type, MSG_TALLY);
    return f.last.tally;
}

/* What a loan cost is said once; in sum again, if it may not have come. */
TEST(what_loans_cost_is_not_lost_with_a_connection)
{
    const struct msg paid = { .type = MSG_PAID,
                              .paid = { job_id, 3, 2, { .rays = 9 } } };
    const struct msg tally = {
        .type = MSG_TALLY,
        .tally = { .job = job_id, .busy_s = 1, .dropped = { .rays = 2 } }
    };
    struct msg_tally t;

    load_job();
    hear(f.child, &paid);
    ck_assert_int_eq(said(f.coord, MSG_TALLY), 1); /* the child's sums begin */
    ck_assert_int_eq(said(f.coord, MSG_PAID), 1);
    hear(f.child, &tally);
    t = tally_said();
    ck_assert_uint_eq(t.paid.rays, 9);
    ck_assert_uint_eq(t.dropped.rays, 2);
    cut();
    hear(f.child, &paid); /* there is nobody to tell */
    tick(500);
    connect();
    t = tally_said();
    ck_assert_uint_eq(t.paid.rays, 9);
    ck_assert_uint_eq(t.dropped.rays, 11);
    child_crashes();
    start_job(); /* again: of a new child */
    child_ready();
    cut();
    tick(2000);
    connect();
    ck_assert_uint_eq(tally_said().dropped.rays, 0);
    hear(f.child, &tally);
    t = tally_said();
    ck_assert_uint_eq(t.paid.rays, 0);
    ck_assert_uint_eq(t.dropped.rays, 2);
}

TEST(what_it_lends_comes_back_when_the_coordinator_is_gone)
{
    static const uint8_t bitmap[1] = { 1 };
    const struct msg loan = { .type = MSG_LOAN,
                              .loan = { job_id, 3, 1, 0, 5, 0, 6, 1, 2, 0, 3, 0,
                                        density, bitmap, line_bytes,
                                        line_bytes } };

    load_job();
    unit(2);
    unit(3);
    hear(f.child, &loan);
    ck_assert_int_eq(said(f.coord, MSG_LOAN), 1);
    ck_assert_int_eq(said(f.child, MSG_BACK), 0);
    cut();
    ck_assert_int_eq(said(f.child, MSG_BACK), 1);
    ck_assert(f.last.back.unit == 3 && f.last.back.attempt == 1);
    ck_assert(f.last.back.line == 5 && f.last.back.n == 0);
    hear(f.child, &loan); /* asked for before */
    ck_assert_int_eq(said(f.child, MSG_BACK), 2);
}
