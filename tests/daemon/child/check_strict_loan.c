/* check_strict_loan.c - columns of a line that a strict unit lends or has from
 * another */
#include "config.h"

#include "strict_fixture.h"

#include <string.h>

FIXTURE(set_up, tear_down)

/* A block of line 4 of a picture of 64 columns, black. */
static struct msg_loan
some_loan(void)
{
    return (struct msg_loan){ .job = job_id,
                              .unit = 3,
                              .attempt = 9,
                              .line = 4,
                              .x = 6,
                              .n = 6,
                              .channels = 3,
                              .wanted = zeros,
                              .top = zeros,
                              .bottom = zeros };
}

/* Whoever made it is wrong, not the job; its columns go back. */
TEST(a_loan_that_fits_no_line_is_not_taken)
{
    struct msg_loan loan = some_loan();
    struct rad_error err = { 0 };
    const struct msg *m;

    loan.n = 5; /* no whole block */
    ck_assert_int_eq(strict_loan(s, &loan, &err), RAD_EPROTO);
    ck_assert_ptr_nonnull(strstr(err.what, "unit 3"));
    m = strict_message(s, true);
    ck_assert(m && m->type == MSG_PAID);
    ck_assert(m->paid.unit == 3 && m->paid.attempt == 9);
    ck_assert_uint_eq(m->paid.counts.rays, 0);
    ck_assert_ptr_null(strict_next(s, STRICT_AHEAD));
    loan.n = 6;
    ck_assert_int_eq(strict_loan(s, &loan, &err), 0);
    expect_pass(STRICT_LOAN, false);
}

/* Of a loan that cost 7 ns, and then of a unit whose second half was given
 * away: what was spent on it before stays with the lines. */
TEST(what_lines_cost_is_told)
{
    const struct msg_loan loan = some_loan();
    struct strict_pass *p;
    const struct msg *m;

    ck_assert_int_eq(strict_loan(s, &loan, NULL), 0);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->rank == STRICT_LOAN && p->spec.first == 4);
    p->spec.cpu_ns[0] = 7;
    spent.rays = 2;
    end_pass(p, true);
    m = strict_message(s, true);
    ck_assert(m && m->type == MSG_LINE_COSTS);
    ck_assert(m->line_costs.frame == 0 && m->line_costs.line == 3);
    ck_assert_uint_eq(m->line_costs.nlines, 2);
    ck_assert(m->line_costs.cpu_ns[0] == 0 && m->line_costs.cpu_ns[1] == 7);
    m = strict_message(s, true);
    ck_assert(m && m->type == MSG_PAID);

    give_unit(1, 0, 4);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->rank == STRICT_TRUE_LINES && p->spec.first == 0);
    for (unsigned i = 0; i < 4; i++)
        p->spec.cpu_ns[i] = i + 1;
    strict_split(s, 1, 1);
    strict_shrunk(s, p, 2);
    end_pass(p, false);
    expect_pass(STRICT_TRUE_LINES, false);
    expect_pass(STRICT_TRUTH, true);
    while ((m = strict_message(s, true)) && m->type != MSG_LINE_COSTS)
        ;
    ck_assert_ptr_nonnull(m);
    ck_assert(m->line_costs.line == 0 && m->line_costs.nlines == 4);
    for (unsigned i = 0; i < 4; i++)
        ck_assert_uint_eq(m->line_costs.cpu_ns[i], i + 1);
}

/* A pixel of a loan that its lender needed as well, and told of just then. */
TEST(what_a_loan_traced_for_nothing_is_told)
{
    struct msg_loan loan = some_loan();
    struct rad_facts *facts;
    struct strict_pass *p;
    const struct msg *m;

    loan.density = loan.top;
    ck_assert_int_eq(strict_loan(s, &loan, NULL), 0);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->rank == STRICT_LOAN);
    facts = p->spec.facts[4];
    ck_assert(rad_facts_put(facts, 6, 0, black, RAD_FACT_FOREIGN));
    ck_assert(!rad_facts_put(facts, 6, 0, black, 0));
    ck_assert(rad_facts_put(facts, 7, 0, black, 0));
    spent.rays = 2;
    end_pass(p, true);
    while ((m = strict_message(s, true)) && m->type != MSG_PAID)
        ck_assert(m->type == MSG_FACTS || m->type == MSG_LINE_COSTS);
    ck_assert_ptr_nonnull(m);
    ck_assert_uint_eq(m->paid.counts.rays, 2);
    ck_assert_uint_eq(m->paid.counts.speculative_rays, 1);
}

/* Having lent it would go over all of its lines again, through their facts. */
TEST(what_keeps_no_facts_does_not_lend)
{
    const struct msg_lend lend = { .job = job_id, .attempt = 1, .part = 99 };
    struct rad_quincunx picture = sampler(4, 64, 61);
    int nlines = rad_quincunx_nbases(&picture);

    for (int last = nlines - 1; last <= nlines; last++) {
        struct strict_pass *p;

        start(picture, false);
        give_unit(0, 0, last);
        if (last < nlines)
            expect_pass(STRICT_TRUE_LINES, false);
        p = strict_next(s, STRICT_TRUTH);
        ck_assert(p && p->rank == STRICT_TRUTH);
        strict_lend(s, &lend);
        ck_assert_int_eq(p->lend > 0, last < nlines);
        end_pass(p, false);
        p = strict_next(s, STRICT_TRUTH); /* it is made again */
        ck_assert_int_eq(p && p->lend > 0, last < nlines);
        end_pass(p, false);
    }
}

/* Six columns of line 6, of which nothing is known. */
static uint8_t none_wanted[8];
static const struct team_loan six_columns = { .line = 6,
                                              .x = 6,
                                              .n = 6,
                                              .wanted = none_wanted,
                                              .top = black,
                                              .bottom = black };

/* Having lent columns of its last line, a unit has handed on all rows above;
 * without that line it would have none left to be its last. */
TEST(a_line_is_left_when_others_are_out)
{
    const struct msg_lend lend = { .job = job_id, .attempt = 1, .part = 99 };
    struct msg_back back = { .job = job_id, .attempt = 1, .line = 6 };
    const struct msg *m;
    struct strict_pass *p;

    give_unit(0, 4, 7);
    give_top();
    expect_pass(STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_TRUTH);
    ck_assert(p && p->rank == STRICT_TRUTH);
    ck_assert_int_eq(strict_least(p), 5);
    strict_lend(s, &lend);
    strict_lent(s, p, &six_columns);
    strict_blocked(p, 6);
    end_pass(p, false);
    strict_back(s, &back);
    while (strict_message(s, true))
        ;
    strict_split(s, 0, 1);
    m = strict_message(s, true);
    ck_assert(m && m->type == MSG_GAVE);
    ck_assert_uint_eq(m->gave.height,
                      (uint32_t)(team_line_row(&q, 7) - team_line_row(&q, 4)));
    p = strict_next(s, STRICT_TRUTH);
    ck_assert(p && p->spec.truth.out == 6);
    ck_assert_int_eq(strict_least(p), 7);
    end_pass(p, false);
}

/* What was lent comes back while the unit says that it waits for it. */
TEST(a_parked_unit_that_has_its_columns_back_says_so)
{
    const struct msg_back back = { .job = job_id, .attempt = 1, .line = 6 };
    struct strict_pass *p;

    give_unit(0, 4, 7);
    give_top();
    expect_pass(STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_TRUTH);
    strict_lent(s, p, &six_columns);
    strict_blocked(p, 6);
    end_pass(p, false);
    ck_assert(is_said(MSG_PARKED));
    strict_back(s, &back);
    ck_assert(is_said(MSG_RESUMED));
    expect_pass(STRICT_TRUTH, true);
    ck_assert(!is_said(MSG_RESUMED));
}
