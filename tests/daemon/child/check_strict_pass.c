/* check_strict_pass.c - what a pass of a strict unit makes, hands on and counts
 */
#include "config.h"

#include "strict_fixture.h"

FIXTURE(set_up, tear_down)

/* Of a unit whose top came late: AHEAD left its first bar out, for lack of
 * colours above, and nobody below should wait for that. */
TEST(a_late_top_lets_the_bottom_go_before_the_first_bar)
{
    give_unit(0, 4, 8);
    expect_pass(STRICT_LINES, false);
    expect_pass(STRICT_AHEAD, false);
    ck_assert_ptr_null(strict_next(s, STRICT_AHEAD));
    give_top();
    expect_pass(STRICT_TRUE_LINES, false);
    expect_pass(STRICT_TRUTH, true);
}

/* Line number of the next base line that is told of; -1: there is none. */
static int
next_base_line(void)
{
    const struct msg *m;

    while ((m = strict_message(s, true)))
        if (m->type == MSG_BASE_LINE)
            return (int)m->base_line.line;
    return -1;
}

/* The next pass has that rank and begins with line `first'; the densities above
 * follow from so many lines.  All densities that it makes are 0. */
static void
make_pass(enum strict_rank rank, int first, int known)
{
    struct strict_pass *p = strict_next(s, STRICT_AHEAD);

    ck_assert(p && p->rank == rank);
    ck_assert_int_eq(p->spec.first, first);
    ck_assert_int_eq(p->spec.ahead.top_known, known);
    ck_assert(known == 0 || p->spec.top_density);
    memset(p->spec.ahead.record, 0,
           (size_t)(p->spec.last - p->spec.first) * rad_quincunx_ndensity(&q));
    p->finished = p->spec.last;
    end_black(p, true);
}

static const struct {
    bool painted;
    uint8_t density; /* after the first unit, which is guessed to be 0 */
    bool holds;
} guesses[] = {
    { false, 0, true },
    { false, 1, false },
    { true, 0, false },
};

/* Of two units that were traced ahead, the lower one from the upper one's
 * bottom: if that was right, so is its own, and nobody need wait for a pass. */
LOOP_TEST(a_guess_from_true_densities_is_true, N_ELEM(guesses))
{
    uint8_t density[64] = { guesses[_i].density };
    struct team_bottom b = bottom_of(black, density);
    struct strict_pass *p;

    start(q, guesses[_i].painted);
    give_unit(0, 4, 8);
    give_unit(1, 8, 11);
    for (int i = 0; i < 2; i++)
        expect_pass(STRICT_LINES, false);
    for (int i = 0; i < 2; i++)
        expect_pass(STRICT_AHEAD, false);
    ck_assert_int_eq(next_base_line(), -1);
    give_top();
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUE_LINES);
    strict_ended(s, p, true, &b, &spent, &total);
    if (guesses[_i].holds)
        ck_assert_int_eq(next_base_line(), 10);
    ck_assert_int_eq(next_base_line(), 7);
    ck_assert_int_eq(next_base_line(), -1);
    if (!guesses[_i].holds)
        expect_pass(STRICT_TRUE_LINES, false);
    expect_pass(STRICT_TRUTH, true);
    expect_pass(STRICT_TRUTH, true);
}

/* The next guess that goes to the unit below is at the densities after that
 * line, and follows from so many lines; known is -1 if none goes. */
static void
expect_guess(int line, int known)
{
    const struct msg *m;

    while ((m = strict_message(s, true)) && m->type != MSG_GUESS)
        ;
    ck_assert(!m == (known < 0));
    if (!m)
        return;
    ck_assert_int_eq((int)m->guess.line, line);
    ck_assert_int_eq(m->guess.known, known);
}

/* Densities after a line, from the worker above. */
static void
give_guess(uint32_t line, uint8_t known)
{
    const struct msg_guess m = {
        job_id, 0, line, known, (uint32_t)rad_quincunx_ndensity(&q), zeros
    };

    strict_guess(s, &m);
}

/* All pixels of a base line, black: with these a unit below has colours. */
static void
give_facts(uint32_t line)
{
    static const uint8_t pixels[64 * 12];
    uint8_t bitmap[8];
    const struct msg_facts m = {
        job_id, 0,      line, (uint32_t)team_line_rows(&q, (int)line) - 1,
        1,      64,     0,    3,
        bitmap, pixels, 64
    };

    memset(bitmap, 0xff, sizeof bitmap);
    strict_facts(s, &m);
}

/* Each worker guesses at what is above its unit.  What it makes of that goes to
 * the unit below, and what comes from above makes it look again, once for each
 * step from a guess to the truth. */
TEST(a_better_guess_from_above_makes_the_lines_again)
{
    struct strict_pass *p;

    give_unit(0, 4, 6);
    make_pass(STRICT_LINES, 4, 0);
    expect_guess(4, 1); /* above line 5 */
    give_facts(3);
    make_pass(STRICT_LINES, 3, 0); /* with line 3, which has colours now */
    expect_guess(4, 2);
    expect_pass(STRICT_AHEAD, false);
    ck_assert_ptr_null(strict_next(s, STRICT_AHEAD));
    give_guess(2, 1);
    make_pass(STRICT_LINES, 3, 1);
    expect_guess(4, 3);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->rank == STRICT_AHEAD && !p->stop);
    give_guess(2, 1); /* no better */
    ck_assert(!p->stop);
    give_guess(2, 4);
    ck_assert(p->stop);
    end_pass(p, false);
    make_pass(STRICT_LINES, 3, 4);
    expect_guess(4, TEAM_SURE);
    make_pass(STRICT_AHEAD, 3, 4);
    give_guess(2, 9); /* the former was as good as true */
    ck_assert_ptr_null(strict_next(s, STRICT_AHEAD));
    give_top(); /* just what was guessed: the bottom is made */
    ck_assert_int_eq(next_base_line(), 5);
    expect_pass(STRICT_TRUTH, true);
}

/* One more pixel of a row of line 5 is traced by that pass. */
static void
trace_of_5(struct strict_pass *p, int row)
{
    ck_assert_ptr_nonnull(p);
    ck_assert(rad_facts_put(p->spec.facts[5], 0, row, black, 0));
}

/* Only the base line is of use to the worker below: what was traced of the bar
 * above it is sent when the unit has waited for long, and not with a guess. */
TEST(a_guess_goes_with_facts_of_the_base_line_alone)
{
    int base = team_line_rows(&q, 5) - 1;
    const struct msg *m;
    struct strict_pass *p;

    give_unit(0, 4, 6);
    make_pass(STRICT_LINES, 4, 0);
    trace_of_5(p = strict_next(s, STRICT_AHEAD), 0);
    end_black(p, true);
    give_facts(3);
    trace_of_5(p = strict_next(s, STRICT_AHEAD), base);
    ck_assert_int_eq(p->rank, STRICT_LINES);
    end_black(p, true);
    while ((m = strict_message(s, true)) && m->type != MSG_FACTS)
        ;
    ck_assert(m && m->facts.line == 5);
    ck_assert_uint_eq(m->facts.row, (uint32_t)base);
    ck_assert_uint_eq(m->facts.npixels, 1);
    ck_assert(!is_said(MSG_FACTS));
    expect_pass(STRICT_AHEAD, false);
    strict_tick(s, 1000);
    strict_tick(s, 1200);
    while ((m = strict_message(s, true)) && m->type != MSG_FACTS)
        ;
    ck_assert(m && m->facts.line == 5 && m->facts.row == 0);
    ck_assert_uint_eq(m->facts.npixels, 1);
}

/* A unit that has waited for long is worked on, as facts of the line above
 * come, and waits again: what it has traced since then goes up, too. */
TEST(facts_of_a_unit_that_waits_again_are_sent)
{
    const struct msg *m;
    struct strict_pass *p;

    give_unit(0, 4, 6);
    make_pass(STRICT_LINES, 4, 0);
    expect_pass(STRICT_AHEAD, false);
    ck_assert_uint_eq(strict_tick(s, 1000), 1200);
    ck_assert_uint_eq(strict_tick(s, 1200), STRICT_NEVER);
    give_facts(3);
    make_pass(STRICT_LINES, 3, 0);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->rank == STRICT_AHEAD);
    ck_assert(rad_facts_put(p->spec.facts[4], 0, 0, black, 0));
    end_black(p, true);
    ck_assert_uint_eq(strict_tick(s, 2000), 2200);
    ck_assert_uint_eq(strict_tick(s, 2200), STRICT_NEVER);
    while ((m = strict_message(s, true)) && m->type != MSG_FACTS)
        ;
    ck_assert(m && m->facts.line == 4);
}

static const struct {
    int finished, known; /* lines before that one are done; -1: no guess */
} splits[] = { { 5, -1 }, { 6, 1 } };

/* A unit that is split in its first pass tells the worker of the other half of
 * densities, if it made its new last line from these: else both workers would
 * trace that line. */
LOOP_TEST(a_guess_goes_with_lines_that_are_given_away, N_ELEM(splits))
{
    struct strict_pass *p;

    give_unit(0, 4, 8);
    p = strict_next(s, STRICT_AHEAD);
    strict_split(s, 0, 1);
    ck_assert(p && p->stop);
    memset(p->spec.ahead.record, 0, 4 * rad_quincunx_ndensity(&q));
    p->finished = splits[_i].finished;
    end_pass(p, false);
    expect_guess(4, splits[_i].known);
}

/* Without densities the first guess is right: it is not passed on, and colours
 * that come make no lines again. */
TEST(without_densities_no_guess_is_better)
{
    start(sampler(1, 64, 60), false);
    ck_assert_uint_eq(rad_quincunx_ndensity(&q), 0);
    give_unit(0, 4, 5);
    expect_pass(STRICT_LINES, false);
    give_facts(3);
    expect_pass(STRICT_AHEAD, false);
    ck_assert(!strict_has_work(s));
    expect_guess(0, -1);
}

/* Columns [x, x + n) of line 2, with its densities. */
static void
give_piece(uint32_t x, uint32_t n)
{
    uint32_t ndensity = (uint32_t)rad_quincunx_ndensity(&q);
    const struct msg_base_line m = { .job = job_id,
                                     .line = 2,
                                     .x = x,
                                     .n = n,
                                     .channels = 3,
                                     .first = x > 0 ? ndensity : 0,
                                     .ndensity = x > 0 ? 0 : ndensity,
                                     .density = zeros,
                                     .pixels = zeros };

    strict_base_line(s, &m);
}

/* The guess goes with the unit that it served, but not what came meanwhile of
 * the line: it may be the top of a unit that is on its way to this child. */
TEST(a_top_that_is_coming_outlives_a_guess_at_it)
{
    give_guess(2, 1);
    give_unit(0, 4, 6);
    give_top();
    give_piece(0, 32);
    expect_pass(STRICT_TRUE_LINES, false);
    expect_pass(STRICT_TRUTH, true);
    give_piece(32, 32);
    give_unit(1, 3, 4);
    expect_pass(STRICT_TRUTH, true);
}

/* A unit of one line made from the guess of a unit above it here passes that
 * on; and no guess is for a line that has none below, or of another picture. */
TEST(a_guess_goes_down_through_units_of_one_line)
{
    const struct msg_guess wrong[] = {
        { job_id, 1, 2, 1, (uint32_t)rad_quincunx_ndensity(&q), zeros },
        { job_id, 0, (uint32_t)rad_quincunx_nbases(&q) - 1, 1,
          (uint32_t)rad_quincunx_ndensity(&q), zeros },
        { job_id, 0, 2, 1, (uint32_t)rad_quincunx_ndensity(&q) + 1, zeros },
    };

    for (int i = 0; i < N_ELEM(wrong); i++)
        strict_guess(s, &wrong[i]);
    give_unit(0, 4, 7);
    give_unit(1, 7, 8);
    make_pass(STRICT_LINES, 4, 0);
    expect_guess(0, -1); /* the unit below is here */
    make_pass(STRICT_LINES, 7, 3);
    expect_guess(6, 3);
}

/* A line goes out as fast as it is read: what is made meanwhile is one piece.
 */
TEST(pieces_that_nobody_took_yet_are_one)
{
    static const int made[] = { 12, 24, 48, 64 }; /* taken after the second */
    struct rad_pixel bottom[64] = { 0 };
    uint8_t density[64], want[64 * 12];
    struct team_bottom b = { 0 };
    struct strict_pass *p;
    const struct msg *m;
    uint32_t n, from = 0;

    n = (uint32_t)rad_quincunx_ndensity(&q);
    for (int x = 0; x < 64; x++) {
        const float v[3] = { (float)x, 0, 1 };

        bottom[x].L = (struct rad_rgb){ v[0], v[1], v[2] };
        density[x] = (uint8_t)(100 + x);
        wire_floats_put(want + 12 * x, v, 3);
    }
    give_unit(0, 0, 4);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && strict_has_true_top(p));
    for (int i = 0; i < N_ELEM(made); i++) {
        uint32_t to = (uint32_t)made[i], d = n * to / 64;

        b = (struct team_bottom){ bottom, density, made[i], d };
        strict_bottom(s, p, &b);
        if (i % 2 == 0)
            continue;
        m = strict_message(s, true);
        ck_assert(m && m->type == MSG_BASE_LINE);
        ck_assert_uint_eq(m->base_line.x, from);
        ck_assert_uint_eq(m->base_line.n, to - from);
        ck_assert_uint_eq(m->base_line.first, n * from / 64);
        ck_assert_uint_eq(m->base_line.ndensity, d - n * from / 64);
        ck_assert_mem_eq(m->base_line.density, density + n * from / 64,
                         m->base_line.ndensity);
        ck_assert_mem_eq(m->base_line.pixels, want + 12 * from,
                         12 * (to - from));
        ck_assert_ptr_null(strict_message(s, true));
        from = to;
    }
    strict_ended(s, p, false, &b, &spent, &total);
}

/* What is made of it counts once, however often it was left. */
TEST(rows_that_went_on_count_their_rays_once)
{
    struct strict_pass *p;

    give_unit(0, 0, 2);
    expect_pass(STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUTH);
    spent = (struct msg_counts){ .rays = 7, .primary_rays = 2 };
    end_pass(p, false);
    p = strict_next(s, STRICT_AHEAD);
    spent = (struct msg_counts){ .rays = 3, .primary_rays = 5 };
    ck_assert(end_black(p, true));
    ck_assert_uint_eq(total.primary_rays, 5);
    ck_assert_uint_eq(total.rays, 10);
}

/* Lines 4 to 7 of 64 columns, of three rows each. */
TEST(what_passes_are_past_counts_until_its_rows_are_out)
{
    enum { LINE = 64, UNIT = 4 * 3 * LINE };

    struct strict_pass *p;

    ck_assert_int_eq(q.ystep, 3);
    give_unit(0, 4, 8);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_uint_eq(strict_pixels(s), 0);
    p->made.base = 2 * LINE;
    ck_assert_uint_eq(strict_pixels(s), 2 * LINE);
    p->made.base = 4 * LINE;
    end_black(p, true);
    p = strict_next(s, STRICT_AHEAD); /* goes over the lines again */
    ck_assert_int_eq(p->rank, STRICT_AHEAD);
    p->made = (struct team_made){ .base = LINE, .bars = 2 * LINE };
    ck_assert_uint_eq(strict_pixels(s), 6 * LINE);
    p->made = (struct team_made){ .base = 5 * LINE, .bars = 9 * LINE };
    ck_assert_uint_eq(strict_pixels(s), UNIT);
    end_black(p, true);
    give_top();
    expect_pass(STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUTH);
    p->made.out = 5 * LINE;
    ck_assert_uint_eq(strict_pixels(s), UNIT - 5 * LINE);
    p->finished = 6;
    p->stop = true;
    end_pass(p, false);
    ck_assert_uint_eq(strict_pixels(s), UNIT / 2);
    p = strict_next(s, STRICT_AHEAD);
    p->made.out = 3 * LINE;
    ck_assert_uint_eq(strict_pixels(s), UNIT / 4);
    end_black(p, true);
    ck_assert_uint_eq(strict_pixels(s), 0);
}

/* Of the base line above it that one makes ahead, the bar is another's. */
TEST(a_top_that_is_made_here_has_no_colours_above)
{
    struct strict_pass *p;
    struct msg_unit u = { .job = job_id,
                          .attempt = 1,
                          .width = 64,
                          .mode = MSG_MODE_STRICT,
                          .flags = MSG_UNIT_TOP };

    give_top(); /* base line 3 */
    u.y = (uint32_t)team_line_row(&q, 5);
    u.height = (uint32_t)team_line_rows(&q, 5);
    ck_assert_int_eq(strict_unit(s, &u, NULL), 0);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->spec.first, 4);
    ck_assert_ptr_nonnull(p->spec.top_density);
    ck_assert_ptr_null(p->spec.top);
    end_pass(p, false);
}
