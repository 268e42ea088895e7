/* check_strict_pass.c - what a pass of a strict unit makes, hands on and counts
 */
#include "config.h"

#include "strict_fixture.h"

/* Of a unit whose top came late: AHEAD left its first bar out, for lack of
 * colours above, and nobody below should wait for that. */
START_TEST(a_late_top_lets_the_bottom_go_before_the_first_bar)
{
    struct rad_quincunx q = sampler(64, 60);
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 8);
    expect_pass(s, STRICT_LINES, false);
    expect_pass(s, STRICT_AHEAD, false);
    ck_assert_ptr_null(strict_next(s, STRICT_AHEAD));
    give_top(s, &q);
    expect_pass(s, STRICT_TRUE_LINES, false);
    expect_pass(s, STRICT_TRUTH, true);
    strict_free(s);
}
END_TEST

/* A unit that has time: its bars come along, are no longer given away once they
 * are made, and what is known of its densities is held against the truth. */
START_TEST(bars_that_come_along_stay)
{
    struct rad_quincunx q = sampler(64, 90);
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_flagged(s, &q, 0, 4, 24, MSG_UNIT_BARS);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_LINES && p->filled == 24 && !p->earlier);
    strict_split(s, 0, 1);
    ck_assert(p->stop);
    p->finished = 12;
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    p = strict_next(s, STRICT_AHEAD); /* of 12 lines that are left 6 are */
    ck_assert(p->last == 18 && p->filled == 18);
    p->finished = 18;
    strict_ended(s, p, true, NULL, NULL, &spent, &total);
    give_top(s, &q);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUE_LINES && p->filled == 4 && p->earlier);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_free(s);
}
END_TEST

/* The top of a unit that has time comes while its last line is made: the pass
 * that leaves out lines that come out as they were has not the colours that a
 * bar below them is filled from. */
START_TEST(what_leaves_lines_out_fills_no_bars)
{
    struct rad_quincunx q = sampler(64, 90);
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_flagged(s, &q, 0, 4, 24, MSG_UNIT_BARS);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_LINES && p->filled == 24);
    give_top(s, &q);
    ck_assert(p->stop);
    p->finished = 23;
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p->rank == STRICT_TRUE_LINES && p->earlier);
    ck_assert_int_eq(p->filled, p->first);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_free(s);
}
END_TEST

/* Line number of the next base line that is told of; -1: there is none. */
static int
next_base_line(struct strict *s)
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
make_pass(struct strict *s, const struct rad_quincunx *q, enum strict_rank rank,
          int first, int known)
{
    static const struct rad_pixel bottom[64];
    static const uint8_t density[64];
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p = strict_next(s, STRICT_AHEAD);

    ck_assert(p && p->rank == rank);
    ck_assert_int_eq(p->first, first);
    ck_assert_int_eq(p->top_known, known);
    ck_assert(known == 0 || p->top_density);
    memset(p->record, 0,
           (size_t)(p->last - p->first) * rad_quincunx_ndensity(q));
    p->finished = p->last;
    strict_ended(s, p, true, bottom, density, &spent, &total);
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
START_TEST(a_guess_from_true_densities_is_true)
{
    struct rad_quincunx q = sampler(64, 60);
    static const struct rad_pixel bottom[64];
    uint8_t density[64] = { guesses[_i].density };
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, guesses[_i].painted, job_id);
    give_unit(s, &q, 0, 4, 8);
    give_unit(s, &q, 1, 8, 11);
    for (int i = 0; i < 2; i++)
        expect_pass(s, STRICT_LINES, false);
    for (int i = 0; i < 2; i++)
        expect_pass(s, STRICT_AHEAD, false);
    ck_assert_int_eq(next_base_line(s), -1);
    give_top(s, &q);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUE_LINES);
    strict_ended(s, p, true, bottom, density, &spent, &total);
    if (guesses[_i].holds)
        ck_assert_int_eq(next_base_line(s), 10);
    ck_assert_int_eq(next_base_line(s), 7);
    ck_assert_int_eq(next_base_line(s), -1);
    if (!guesses[_i].holds)
        expect_pass(s, STRICT_TRUE_LINES, false);
    expect_pass(s, STRICT_TRUTH, true);
    expect_pass(s, STRICT_TRUTH, true);
    strict_free(s);
}
END_TEST

/* The next guess that goes to the unit below is at the densities after that
 * line, and follows from so many lines; known is -1 if none goes. */
static void
expect_guess(struct strict *s, int line, int known)
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
give_guess(struct strict *s, const struct rad_quincunx *q, uint32_t line,
           uint8_t known)
{
    static const uint8_t density[64];
    const struct msg_guess m = {
        job_id, 0, line, known, (uint32_t)rad_quincunx_ndensity(q), density
    };

    strict_guess(s, &m);
}

/* All pixels of a base line, black: with these a unit below has colours. */
static void
give_facts(struct strict *s, const struct rad_quincunx *q, uint32_t line)
{
    static const uint8_t pixels[64 * 12];
    uint8_t bitmap[8];
    const struct msg_facts m = {
        job_id, 0,      line, (uint32_t)team_line_rows(q, (int)line) - 1,
        1,      64,     0,    3,
        bitmap, pixels, 64
    };

    memset(bitmap, 0xff, sizeof bitmap);
    strict_facts(s, &m);
}

/* Each worker guesses at what is above its unit.  What it makes of that goes to
 * the unit below, and what comes from above makes it look again, once for each
 * step from a guess to the truth. */
START_TEST(a_better_guess_from_above_makes_the_lines_again)
{
    struct rad_quincunx q = sampler(64, 60);
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 6);
    make_pass(s, &q, STRICT_LINES, 4, 0);
    expect_guess(s, 4, 1); /* above line 5 */
    give_facts(s, &q, 3);
    make_pass(s, &q, STRICT_LINES, 3,
              0); /* with line 3, which has colours now */
    expect_guess(s, 4, 2);
    expect_pass(s, STRICT_AHEAD, false);
    ck_assert_ptr_null(strict_next(s, STRICT_AHEAD));
    give_guess(s, &q, 2, 1);
    make_pass(s, &q, STRICT_LINES, 3, 1);
    expect_guess(s, 4, 3);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->rank == STRICT_AHEAD && !p->stop);
    give_guess(s, &q, 2, 1); /* no better */
    ck_assert(!p->stop);
    give_guess(s, &q, 2, 4);
    ck_assert(p->stop);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    make_pass(s, &q, STRICT_LINES, 3, 4);
    expect_guess(s, 4, TEAM_SURE);
    make_pass(s, &q, STRICT_AHEAD, 3, 4);
    give_guess(s, &q, 2, 9); /* the former was as good as true */
    ck_assert_ptr_null(strict_next(s, STRICT_AHEAD));
    give_top(s, &q); /* just what was guessed: the bottom is made */
    ck_assert_int_eq(next_base_line(s), 5);
    expect_pass(s, STRICT_TRUTH, true);
    strict_free(s);
}
END_TEST

/* A unit that has waited for long is worked on, as facts of the line above
 * come, and waits again: what it has traced since then goes up, too. */
START_TEST(facts_of_a_unit_that_waits_again_are_sent)
{
    struct rad_quincunx q = sampler(64, 60);
    static const struct rad_pixel bottom[64];
    static const uint8_t density[64];
    const struct msg_counts spent = { 0 };
    const struct msg *m;
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 6);
    make_pass(s, &q, STRICT_LINES, 4, 0);
    expect_pass(s, STRICT_AHEAD, false);
    ck_assert_uint_eq(strict_tick(s, 1000), 1200);
    ck_assert_uint_eq(strict_tick(s, 1200), STRICT_NEVER);
    give_facts(s, &q, 3);
    make_pass(s, &q, STRICT_LINES, 3, 0);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->rank == STRICT_AHEAD);
    ck_assert(rad_facts_put(p->facts[4], 0, 0, bottom, 0));
    strict_ended(s, p, true, bottom, density, &spent, &total);
    ck_assert_uint_eq(strict_tick(s, 2000), 2200);
    ck_assert_uint_eq(strict_tick(s, 2200), STRICT_NEVER);
    while ((m = strict_message(s, true)) && m->type != MSG_FACTS)
        ;
    ck_assert(m && m->facts.line == 4);
    strict_free(s);
}
END_TEST

static const struct {
    int finished, known; /* lines before that one are done; -1: no guess */
} splits[] = { { 5, -1 }, { 6, 1 } };

/* A unit that is split in its first pass tells the worker of the other half of
 * densities, if it made its new last line from these: else both workers would
 * trace that line. */
START_TEST(a_guess_goes_with_lines_that_are_given_away)
{
    struct rad_quincunx q = sampler(64, 60);
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s = strict_new(&q, 1, false, job_id);

    give_unit(s, &q, 0, 4, 8);
    p = strict_next(s, STRICT_AHEAD);
    strict_split(s, 0, 1);
    ck_assert(p && p->stop);
    memset(p->record, 0, 4 * rad_quincunx_ndensity(&q));
    p->finished = splits[_i].finished;
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    expect_guess(s, 4, splits[_i].known);
    strict_free(s);
}
END_TEST

/* Without densities the first guess is right: it is not passed on, and colours
 * that come make no lines again. */
START_TEST(without_densities_no_guess_is_better)
{
    struct rad_quincunx q = { .width = 64, .height = 60 };
    struct strict *s;

    rad_quincunx_steps(1, &q.xstep, &q.ystep);
    ck_assert_uint_eq(rad_quincunx_ndensity(&q), 0);
    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 5);
    expect_pass(s, STRICT_LINES, false);
    give_facts(s, &q, 3);
    expect_pass(s, STRICT_AHEAD, false);
    ck_assert(!strict_has_work(s));
    expect_guess(s, 0, -1);
    strict_free(s);
}
END_TEST

/* Columns [x, x + n) of line 2, with its densities. */
static void
give_piece(struct strict *s, const struct rad_quincunx *q, uint32_t x,
           uint32_t n)
{
    static const uint8_t pixels[64 * 12], density[64];
    uint32_t ndensity = (uint32_t)rad_quincunx_ndensity(q);
    const struct msg_base_line m = { .job = job_id,
                                     .line = 2,
                                     .x = x,
                                     .n = n,
                                     .channels = 3,
                                     .first = x > 0 ? ndensity : 0,
                                     .ndensity = x > 0 ? 0 : ndensity,
                                     .density = density,
                                     .pixels = pixels };

    strict_base_line(s, &m);
}

/* The guess goes with the unit that it served, but not what came meanwhile of
 * the line: it may be the top of a unit that is on its way to this child. */
START_TEST(a_top_that_is_coming_outlives_a_guess_at_it)
{
    struct rad_quincunx q = sampler(64, 60);
    struct strict *s = strict_new(&q, 1, false, job_id);

    give_guess(s, &q, 2, 1);
    give_unit(s, &q, 0, 4, 6);
    give_top(s, &q);
    give_piece(s, &q, 0, 32);
    expect_pass(s, STRICT_TRUE_LINES, false);
    expect_pass(s, STRICT_TRUTH, true);
    give_piece(s, &q, 32, 32);
    give_unit(s, &q, 1, 3, 4);
    expect_pass(s, STRICT_TRUTH, true);
    strict_free(s);
}
END_TEST

/* A unit of one line made from the guess of a unit above it here passes that
 * on; and no guess is for a line that has none below, or of another picture. */
START_TEST(a_guess_goes_down_through_units_of_one_line)
{
    struct rad_quincunx q = sampler(64, 60);
    static const uint8_t density[80];
    const struct msg_guess wrong[] = {
        { job_id, 1, 2, 1, (uint32_t)rad_quincunx_ndensity(&q), density },
        { job_id, 0, (uint32_t)rad_quincunx_nbases(&q) - 1, 1,
          (uint32_t)rad_quincunx_ndensity(&q), density },
        { job_id, 0, 2, 1, (uint32_t)rad_quincunx_ndensity(&q) + 1, density },
    };
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    for (int i = 0; i < N_ELEM(wrong); i++)
        strict_guess(s, &wrong[i]);
    give_unit(s, &q, 0, 4, 7);
    give_unit(s, &q, 1, 7, 8);
    make_pass(s, &q, STRICT_LINES, 4, 0);
    expect_guess(s, 0, -1); /* the unit below is here */
    make_pass(s, &q, STRICT_LINES, 7, 3);
    expect_guess(s, 6, 3);
    strict_free(s);
}
END_TEST

/* A line goes out as fast as it is read: what is made meanwhile is one piece.
 */
START_TEST(pieces_that_nobody_took_yet_are_one)
{
    static const int made[] = { 12, 24, 48, 64 }; /* taken after the second */
    struct rad_quincunx q = sampler(64, 60);
    struct rad_pixel bottom[64] = { 0 };
    uint8_t density[64], want[64 * 12];
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    const struct msg *m;
    struct strict *s;
    uint32_t n, from = 0;

    n = (uint32_t)rad_quincunx_ndensity(&q);
    for (int x = 0; x < 64; x++) {
        const float v[3] = { (float)x, 0, 1 };

        bottom[x].L = (struct rad_rgb){ v[0], v[1], v[2] };
        density[x] = (uint8_t)(100 + x);
        wire_floats_put(want + 12 * x, v, 3);
    }
    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 0, 4);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(p && p->true_top);
    for (int i = 0; i < N_ELEM(made); i++) {
        uint32_t to = (uint32_t)made[i], d = n * to / 64;

        strict_bottom(s, p, made[i], d, bottom, density);
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
    strict_ended(s, p, false, bottom, density, &spent, &total);
    strict_free(s);
}
END_TEST

/* What is made of it counts once, however often it was left. */
START_TEST(rows_that_went_on_count_their_rays_once)
{
    struct rad_quincunx q = sampler(64, 60);
    static const struct rad_pixel bottom[64];
    static const uint8_t density[64];
    const struct msg_counts some = { .rays = 7, .primary_rays = 2 };
    const struct msg_counts all = { .rays = 3, .primary_rays = 5 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 0, 2);
    expect_pass(s, STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUTH);
    strict_ended(s, p, false, NULL, NULL, &some, &total);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert(strict_ended(s, p, true, bottom, density, &all, &total));
    ck_assert_uint_eq(total.primary_rays, 5);
    ck_assert_uint_eq(total.rays, 10);
    strict_free(s);
}
END_TEST

/* Lines 4 to 7 of 64 columns, of three rows each. */
START_TEST(what_passes_are_past_counts_until_its_rows_are_out)
{
    enum { LINE = 64, UNIT = 4 * 3 * LINE };

    struct rad_quincunx q = sampler(LINE, 60);
    static const struct rad_pixel bottom[LINE];
    static const uint8_t density[LINE];
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict_pass *p;
    struct strict *s;

    ck_assert_int_eq(q.ystep, 3);
    s = strict_new(&q, 1, false, job_id);
    give_unit(s, &q, 0, 4, 8);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_uint_eq(strict_pixels(s), 0);
    p->made.base = 2 * LINE;
    ck_assert_uint_eq(strict_pixels(s), 2 * LINE);
    p->made.base = 4 * LINE;
    strict_ended(s, p, true, bottom, density, &spent, &total);
    p = strict_next(s, STRICT_AHEAD); /* goes over the lines again */
    ck_assert_int_eq(p->rank, STRICT_AHEAD);
    p->made = (struct team_made){ .base = LINE, .bars = 2 * LINE };
    ck_assert_uint_eq(strict_pixels(s), 6 * LINE);
    p->made = (struct team_made){ .base = 5 * LINE, .bars = 9 * LINE };
    ck_assert_uint_eq(strict_pixels(s), UNIT);
    strict_ended(s, p, true, bottom, density, &spent, &total);
    give_top(s, &q);
    expect_pass(s, STRICT_TRUE_LINES, false);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->rank, STRICT_TRUTH);
    p->made.out = 5 * LINE;
    ck_assert_uint_eq(strict_pixels(s), UNIT - 5 * LINE);
    p->finished = 6;
    p->stop = true;
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    ck_assert_uint_eq(strict_pixels(s), UNIT / 2);
    p = strict_next(s, STRICT_AHEAD);
    p->made.out = 3 * LINE;
    ck_assert_uint_eq(strict_pixels(s), UNIT / 4);
    strict_ended(s, p, true, bottom, density, &spent, &total);
    ck_assert_uint_eq(strict_pixels(s), 0);
    strict_free(s);
}
END_TEST

/* Of the base line above it that one makes ahead, the bar is another's. */
START_TEST(a_top_that_is_made_here_has_no_colours_above)
{
    struct rad_quincunx q = sampler(64, 60);
    struct strict_pass *p;
    struct msg_unit u = { .job = job_id,
                          .attempt = 1,
                          .width = 64,
                          .mode = MSG_MODE_STRICT,
                          .flags = MSG_UNIT_TOP };
    const struct msg_counts spent = { 0 };
    struct msg_counts total;
    struct strict *s;

    s = strict_new(&q, 1, false, job_id);
    give_top(s, &q); /* base line 3 */
    u.y = (uint32_t)team_line_row(&q, 5);
    u.height = (uint32_t)team_line_rows(&q, 5);
    ck_assert_int_eq(strict_unit(s, &u, NULL), 0);
    p = strict_next(s, STRICT_AHEAD);
    ck_assert_int_eq(p->first, 4);
    ck_assert_ptr_nonnull(p->top_density);
    ck_assert_ptr_null(p->top);
    strict_ended(s, p, false, NULL, NULL, &spent, &total);
    strict_free(s);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("strict_pass");
    TCase *tc = tcase_create("strict_pass");

    tcase_add_test(tc, a_late_top_lets_the_bottom_go_before_the_first_bar);
    tcase_add_test(tc, bars_that_come_along_stay);
    tcase_add_test(tc, what_leaves_lines_out_fills_no_bars);
    tcase_add_loop_test(tc, a_guess_from_true_densities_is_true, 0,
                        N_ELEM(guesses));
    tcase_add_test(tc, a_better_guess_from_above_makes_the_lines_again);
    tcase_add_test(tc, facts_of_a_unit_that_waits_again_are_sent);
    tcase_add_loop_test(tc, a_guess_goes_with_lines_that_are_given_away, 0,
                        N_ELEM(splits));
    tcase_add_test(tc, without_densities_no_guess_is_better);
    tcase_add_test(tc, a_top_that_is_coming_outlives_a_guess_at_it);
    tcase_add_test(tc, a_guess_goes_down_through_units_of_one_line);
    tcase_add_test(tc, pieces_that_nobody_took_yet_are_one);
    tcase_add_test(tc, rows_that_went_on_count_their_rays_once);
    tcase_add_test(tc, what_passes_are_past_counts_until_its_rows_are_out);
    tcase_add_test(tc, a_top_that_is_made_here_has_no_colours_above);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
