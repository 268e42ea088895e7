/* check_lending.c - columns of a line that are lent to one who has no lines */
#include "config.h"

#include "lines_fixture.h"

FIXTURE(set_up, tear_down)

/* ws1 is at a line, all else being done, and ws2, and ws3 if it is there, have
 * nothing. */
static void
one_line_left(enum msg_partition kind, int workers, struct msg_unit *a)
{
    come(workers);
    start(kind, 0, workers);
    *a = *first_unit_of(W1);
    for (int i = 0; i < f.nsaid; i++) {
        const struct said s = f.said[i];

        if (s.conn == W1 && s.m.type == MSG_SPLIT)
            gave(W1, a, a->height);
        if (s.conn < W1 || s.conn > W3 || s.m.type != MSG_UNIT ||
            s.m.unit.unit == a->unit)
            continue;
        wait_ms(100);
        finish(s.conn, &s.m.unit);
    }
    ck_assert_uint_eq(desk_find_job(f.c, id)->nout, 1);
}

/* What ws2 got of it. */
static struct msg_unit
loan_of(uint64_t conn)
{
    const struct said *s = last(conn, MSG_LOAN);

    ck_assert_ptr_nonnull(s);
    return (struct msg_unit){ .unit = s->m.loan.unit,
                              .attempt = s->m.loan.attempt };
}

/* ws1 lends ws2 the right of its line, all that is left for so many. */
static struct msg_unit
lend_right(int workers, struct msg_unit *a)
{
    one_line_left(MSG_PART_SCANBAR, workers, a);
    lend(W1, a, 6, 10);
    return loan_of(W2);
}

static void
expect_back(uint64_t conn, const struct msg_unit *u, uint32_t x, uint32_t n)
{
    const struct said *s = last(conn, MSG_BACK);

    ck_assert_ptr_nonnull(s);
    ck_assert_uint_eq(s->m.back.attempt, u->attempt);
    ck_assert_uint_eq(s->m.back.line, line_above(u->y + u->height));
    ck_assert(s->m.back.x == x && s->m.back.n == n);
}

/* Those columns come back to ws1, which does them and is done. */
static void
expect_own_again(const struct msg_unit *u)
{
    expect_back(W1, u, 6, 10);
    finish(W1, u);
    ck_assert(f.done);
}

static const enum msg_partition with_loans[] = { MSG_PART_AUTO,
                                                 MSG_PART_SCANBAR,
                                                 MSG_PART_STATIC };

LOOP_TEST(an_idle_worker_is_lent_columns, N_ELEM(with_loans))
{
    struct msg_unit a, b;

    one_line_left(with_loans[_i], 2, &a);
    ck_assert_int_eq(count(W1, MSG_LEND), 1);
    ck_assert_uint_eq(last(W1, MSG_LEND)->m.lend.unit, a.unit);
    ck_assert_uint_gt(last(W1, MSG_LEND)->m.lend.part, 16384);
    clear();
    lend(W1, &a, 6, 10);
    b = loan_of(W2);
    ck_assert(b.unit == a.unit && b.attempt > a.attempt);
    ck_assert_int_eq(count(W2, MSG_UNIT), 0);
    facts(W2, line_above(a.y + a.height));
    ck_assert_int_eq(count(W1, MSG_FACTS), 1);
    facts(W1, line_above(a.y + a.height)); /* no use to it */
    ck_assert_int_eq(count(W2, MSG_FACTS), 0);
    ck_assert_int_eq(count(W1, MSG_BACK), 0);
    attempt(W1, MSG_PARKED, &a); /* nothing else left, and so on */
    paid(W2, &b, 5);
    expect_back(W1, &a, 6, 10);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 0);
    finish(W1, &a);
    ck_assert(f.done && !f.closed[W1] && !f.closed[W2]);
}

/* It is a part of the unit, and what it costs is known from a former run. */
TEST(what_was_lent_is_counted_to_its_unit)
{
    struct msg_unit a, b;
    double rays, w1, w2;
    const struct job_unit *u;

    b = lend_right(2, &a);
    w1 = worker_stat("ws1", "rays");
    w2 = worker_stat("ws2", "rays");
    rays = stat_of("totals", "rays");
    paid(W2, &b, 50);
    ck_assert_double_eq(worker_stat("ws2", "rays"), w2 + 50);
    finish(W1, &a); /* with 10 */
    ck_assert(f.done);
    u = &desk_find_job(f.c, id)->units[a.unit];
    ck_assert_uint_eq(u->counts.rays, 60);
    ck_assert_uint_eq(u->counts.faults[0].count, 3);
    ck_assert_uint_eq(u->counts.nan.pixels, 0); /* the lender made those */
    ck_assert_double_lt(u->counts.wall_s, 1000);
    ck_assert_uint_eq(f.kept_rays, 60); /* on the disk, too */
    ck_assert_double_eq(worker_stat("ws1", "rays"), w1 + 10);
    ck_assert_double_eq(stat_of("totals", "rays"), rays + 60);
    ck_assert_double_eq(stat_of("totals", "dropped_rays"), 0);
}

TEST(what_was_taken_back_is_in_no_unit)
{
    struct msg_unit a, b;

    b = lend_right(2, &a);
    attempt(W1, MSG_PARKED, &a);
    wait_ms(5000);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    paid(W2, &b, 50); /* which it had not heard */
    finish(W1, &a);
    ck_assert(f.done);
    ck_assert_uint_eq(desk_find_job(f.c, id)->units[a.unit].counts.rays, 10);
    paid(W2, &b, 7);
    ck_assert_double_eq(stat_of("totals", "dropped_rays"), 57);
    ck_assert_double_eq(stat_of("totals", "nan_pixels"), 0);
}

/* Its PAIDs have said so many rays in all, in so many seconds. */
static void
tally(uint64_t conn, uint64_t rays, double busy_s)
{
    const struct msg m = { .type = MSG_TALLY,
                           .tally = { .job = id,
                                      .busy_s = busy_s,
                                      .paid = { .rays = rays,
                                                .primary_rays = 3,
                                                .cpu_s = (double)rays } } };

    say(conn, &m);
}

/* What it cost is not in the unit, but is not lost either; once. */
TEST(what_was_paid_as_the_connection_broke_is_dropped)
{
    struct msg_unit a, b;
    double rays;

    b = lend_right(2, &a);
    tally(W1, 9, 1); /* of an earlier life: its units have that */
    tally(W2, 0, 1);
    paid(W2, &b, 50);
    tally(W2, 50, 2);
    ck_assert_double_eq(stat_of("totals", "dropped_rays"), 0);
    rays = stat_of("totals", "rays");
    coord_closed(f.c, f.now_ms, W2, "cut");
    join(W2, MSG_ROLE_WORKER, "ws2", "127.0.0.1:2");
    for (int i = 0; i < 2; i++) {
        tally(W2, 57, 3);
        ck_assert_double_eq(stat_of("totals", "dropped_rays"), 7);
        ck_assert_double_eq(stat_of("totals", "rays"), rays);
    }
    tally(W2, 0, 0); /* a new child */
    tally(W2, 5, 1);
    ck_assert_double_eq(stat_of("totals", "dropped_rays"), 12);
    finish(W1, &a);
    ck_assert(f.done);
}

TEST(what_nobody_takes_goes_back_at_once)
{
    struct msg_unit a;

    one_line_left(MSG_PART_SCANBAR, 2, &a);
    coord_closed(f.c, f.now_ms, W2, "cut");
    clear();
    lend(W1, &a, 6, 10);
    expect_own_again(&a);
}

TEST(columns_of_one_that_is_lost_go_back)
{
    struct msg_unit a;

    one_line_left(MSG_PART_SCANBAR, 2, &a);
    lend(W1, &a, 6, 10);
    clear();
    cut(W2);
    expect_own_again(&a);
}

TEST(columns_that_nobody_waits_for_are_not_late)
{
    struct msg_unit a, b;

    b = lend_right(2, &a);
    wait_ms(30000);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 0);
    paid(W2, &b, 5);
    finish(W1, &a);
    ck_assert(f.done);
}

/* LEND and PARKED crossed: it lends once more when its top is there. */
TEST(columns_that_are_lent_after_a_wait_are_late_too)
{
    struct msg_unit a, b;

    b = lend_right(3, &a);
    wait_ms(1000);
    attempt(W1, MSG_PARKED, &a);
    wait_ms(100);
    lend(W1, &a, 0, 6);
    ck_assert_int_eq(count(W3, MSG_LOAN), 1);
    paid(W2, &b, 5);
    attempt(W1, MSG_PARKED, &a);
    wait_ms(6000);
    ck_assert_int_eq(count(W3, MSG_REVOKE), 1);
    expect_back(W1, &a, 0, 6);
    finish(W1, &a);
    ck_assert(f.done);
}

TEST(columns_of_one_that_is_late_go_back)
{
    struct msg_unit a, b;

    b = lend_right(2, &a);
    clear();
    wait_ms(1000);
    attempt(W1, MSG_PARKED, &a); /* so long for as much */
    wait_ms(200);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 0);
    wait_ms(3000);
    ck_assert_int_eq(count(W2, MSG_REVOKE), 1);
    expect_back(W1, &a, 6, 10);
    clear();
    paid(W2, &b, 5); /* not heard any more */
    ck_assert_int_eq(count(W1, MSG_BACK), 0);
    finish(W1, &a);
    ck_assert(f.done);
}

TEST(columns_can_be_lent_on)
{
    struct msg_unit a, b, c;

    b = lend_right(3, &a);
    b.y = a.y;
    b.height = a.height;
    wait_ms(150);
    ck_assert_int_eq(count(W2, MSG_LEND), 1);
    lend(W2, &b, 12, 4);
    c = loan_of(W3);
    clear();
    paid(W2, &b, 5);
    expect_back(W1, &a, 6, 6); /* the rest is ws3's */
    paid(W3, &c, 5);
    expect_back(W1, &a, 12, 4);
    finish(W1, &a);
    ck_assert(f.done);
}

TEST(when_the_lender_goes_its_columns_are_dropped)
{
    struct msg tally = { .type = MSG_TALLY,
                         .tally = { .job = id, .dropped = { .rays = 7 } } };
    struct msg_unit a, b;
    double rays;

    one_line_left(MSG_PART_SCANBAR, 2, &a);
    lend(W1, &a, 6, 10);
    facts(W2, line_above(a.y + a.height));
    clear();
    cut(W1);
    ck_assert_int_eq(count(W2, MSG_YIELD), 1);
    wait_ms(2000);
    b = *unit_of(W2);
    ck_assert(b.unit == a.unit && b.y == a.y && b.height == a.height);
    ck_assert_int_eq(count(W2, MSG_FACTS), 1); /* they are kept */
    finish(W2, &b);
    ck_assert(f.done);
    rays = stat_of("totals", "rays");
    say(W2, &tally); /* what it cost, though all is over */
    ck_assert_double_eq(stat_of("totals", "dropped_rays"), 7);
    ck_assert_double_eq(stat_of("totals", "rays"), rays);
}

/* Its connection broke, and it has all columns again. */
TEST(a_lender_that_comes_back_goes_on)
{
    struct msg still = { .type = MSG_STILL };
    struct msg_unit a, loan = lend_right(2, &a);

    clear();
    cut(W1);
    ck_assert_uint_eq(last(W2, MSG_YIELD)->m.yield.attempt, loan.attempt);
    join(W1, MSG_ROLE_WORKER, "ws1", "");
    still.still = (struct msg_gave){ id, a.unit, a.attempt, a.height };
    say(W1, &still);
    ready(W1);
    ck_assert_int_eq(count(W1, MSG_REVOKE) + count(W1, MSG_BACK), 0);
    finish(W1, &a);
    ck_assert(f.done);
    ck_assert_double_eq(stat_of("totals", "units_redone"), 0);
}

/* What is wrong with it: columns, flags, densities. */
static const struct {
    uint32_t x, n;
    uint8_t flags, channels;
    uint32_t ndensity;
} wrong[] = { { 12, 5, 0, 3, 0 },
              { 9, 7, 0, 3, 0 },
              { 6, 9, 0, 3, 0 },
              { 6, 10, 0, 4, 0 },
              { 6, 10, MSG_LOAN_LINE, 3, 1 } };

LOOP_TEST(a_loan_that_fits_no_line_ends_the_connection, N_ELEM(wrong))
{
    struct msg m = { .type = MSG_LOAN,
                     .loan = { .job = id,
                               .x = wrong[_i].x,
                               .n = wrong[_i].n,
                               .flags = wrong[_i].flags,
                               .channels = wrong[_i].channels,
                               .ndensity = wrong[_i].ndensity,
                               .density = density,
                               .wanted = bitmap,
                               .top = pixels,
                               .bottom = pixels } };
    struct msg_unit a, b;

    one_line_left(MSG_PART_SCANBAR, 2, &a);
    m.loan.unit = a.unit;
    m.loan.attempt = a.attempt;
    m.loan.line = line_above(a.y + a.height);
    b = a;
    b.attempt += 7;
    lend(W1, &b, 0, 6); /* of an attempt that is not known */
    ck_assert_int_eq(count(W2, MSG_LOAN), 0);
    expect_back(W1, &b, 0, 6);
    ck_assert(!f.closed[W1]);
    say(W1, &m);
    ck_assert(f.closed[W1]);
    ck_assert_int_eq(count(W2, MSG_LOAN), 0);
    carry_out();
    wait_ms(2000);
    finish(W2, unit_of(W2)); /* the job goes on */
    ck_assert(f.done && !f.failed);
}
