/* check_team.c - however a picture is cut, guessed at and traced ahead, it is
 * the one that one run of the sampler makes, and so are its primary rays */
#include "config.h"

#include "team_fixture.h"

#include <stdio.h>

/* Values of other workers that arrive while a pass is running; some lines had
 * no facts before. */
struct twin {
    struct world *w;
    uint64_t state;
    int first, last; /* lines */
    int n;
};

static void *
be_twin(void *arg)
{
    struct twin *t = arg;
    struct world *w = t->w;

    for (int k = 0; k < t->n; k++) {
        int i = t->first + draw(&t->state, t->last - t->first);
        int row = draw(&t->state, team_line_rows(&w->q, i));
        int x = draw(&t->state, w->q.width);
        struct rad_pixel p;

        atomic_store_explicit(&w->facts[i], w->all[i], memory_order_release);
        if (analytic_pixel(&w->a, w->q.depth, x, row + team_line_row(&w->q, i),
                           &p))
            rad_facts_put(w->all[i], x, row, &p, RAD_FACT_FOREIGN);
    }
    return NULL;
}

/* Some top, with colours and densities known, wrong, or not known. */
static void
guess_top(struct world *w, uint64_t *state, struct pass *p)
{
    static const struct rad_pixel black[MOST_W];
    static const uint8_t some[MOST_W + 3] = { 3, 0, 1, 7, 0, 0, 2 };
    struct pass truth = true_pass(w, p->mode, p->first, p->last);

    switch (p->first > 0 ? draw(state, 5) : 0) {
    case 1:
        p->top = black;
        p->density = some;
        break;
    case 2:
        p->top = truth.top;
        break;
    case 3:
        p->density = truth.density;
        break;
    case 4:
        p->top = truth.top;
        p->density = truth.density;
        break;
    default: /* nothing known: then perhaps with the line above */
        p->first -= p->first > 0 && draw(state, 2);
    }
}

/* Some pass on a guess over lines [first, last), perhaps cut short, perhaps
 * with facts that come in meanwhile. */
static void
guess(struct world *w, uint64_t *state, int first, int last)
{
    struct pass p = { .mode = draw(state, 2) ? TEAM_LINES : TEAM_AHEAD,
                      .first = first,
                      .last = last,
                      .nthreads = 1 + draw(state, 3),
                      .stop_after = draw(state, 2) ? 0 : draw(state, 300),
                      .least = draw(state, 4) ? 0 : first + 1 };
    struct twin twin = { w, *state, first, last, draw(state, 2) * 200 };
    pthread_t thread;

    guess_top(w, state, &p);
    for (int i = p.first; i < last; i++)
        w->facts[i] = w->all[i];
    ck_assert_int_eq(pthread_create(&thread, NULL, be_twin, &twin), 0);
    team_free(run_pass(w, &p));
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
}

/* The truth of some lines from first on, perhaps of the bottom first, perhaps
 * with facts that come in meanwhile.  Returns the line after them. */
static int
get_true(struct world *w, uint64_t *state, int first, int last)
{
    struct pass p = true_pass(w, TEAM_LINES, first, last);
    struct twin twin = { w, *state, first, last, draw(state, 2) * 200 };
    pthread_t thread;

    p.nthreads = 1 + draw(state, 3);

    ck_assert_int_eq(pthread_create(&thread, NULL, be_twin, &twin), 0);
    if (draw(state, 2)) {
        struct team *t;

        for (int i = first; i < last; i++)
            w->facts[i] = w->all[i];
        p.least = draw(state, 2) ? 0 : first + 1;
        t = run_pass(w, &p);
        ck_assert(team_done(t));
        p.last = team_shrink(t, last);
        assert_bottom(w, t, p.last);
        team_free(t);
    }
    p.mode = TEAM_TRUTH;
    p.least = draw(state, 2) ? 0 : first + 1;
    last = tell_truth(w, &p);
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    return last;
}

LOOP_TEST(any_guess_ends_in_the_same_picture, SEEDS)
{
    uint64_t state = (uint64_t)_i;

    for (int k = 0; k < WORLDS; k++) {
        struct world *w = random_world(&state);
        int most = 1 + draw(&state, 1 + draw(&state, 2) * 30), told = 0;

        while (told < w->nlines) {
            int first = told, last;

            if (draw(&state, 3) > 0)
                first += draw(&state, w->nlines - told);
            last = first + 1 + draw(&state, most);
            last = last < w->nlines ? last : w->nlines;
            if (first > told || draw(&state, 3) == 0)
                guess(w, &state, first, last);
            else
                told = get_true(w, &state, first, last);
        }
        assert_same(w);
        world_free(w);
    }
}

static int
unit_end(const struct world *w, int first, int n)
{
    return first + n < w->nlines ? first + n : w->nlines;
}

/* Units of n lines, each by a worker of its own that begins at once: the first
 * knows its top, the others guess until all is traced that can be, perhaps with
 * the base line above.  Rays for nothing, in per cent of the primary rays. */
static double
wasted(enum analytic_kind kind, int ps, int n, bool with_top)
{
    uint64_t waste = 0, primary = 0;

    for (uint64_t seed = 1; seed <= 2; seed++) {
        struct analytic a = { kind, seed };
        struct world *w = world_new(&a, ps, MOST_W, MOST_H, .05, false);

        render_alone(w);
        for (int i = n; i < w->nlines; i += n) {
            struct pass p = { .mode = TEAM_LINES,
                              .first = i - with_top,
                              .last = unit_end(w, i, n),
                              .nthreads = 1 };

            team_free(run_pass(w, &p));
            p.mode = TEAM_AHEAD;
            team_free(run_pass(w, &p));
        }
        for (int i = 0; i < w->nlines; i += n) {
            struct pass p = true_pass(w, TEAM_TRUTH, i, unit_end(w, i, n));

            tell_truth(w, &p);
        }
        waste += unused(w);
        primary += w->primary;
        ck_assert_uint_eq(w->traced, w->primary + unused(w));
        world_free(w);
    }
    return 100 * (double)waste / (double)primary;
}

/* Lines that a worker holds, and the share wasted at most [%].  Nothing where
 * only what is certain is traced; where densities are as good as true it takes
 * thin lines alone, which a sampler finds by chance, to be wrong. */
static const struct {
    int n;
    bool with_top;
    double most;
} holdings[] = {
    { 1, true, 0 }, { 2, false, 0 }, { 4, false, 0 }, { 16, false, .25 }
};

LOOP_TEST(little_is_traced_for_nothing, 3 * ANALYTIC_KINDS)
{
    enum analytic_kind kind = (enum analytic_kind)(_i / 3);
    int ps = 4 << _i % 3;

    printf("%-9s ps %2d: wasted", analytic_name[kind], ps);
    for (int i = 0; i < N_ELEM(holdings); i++) {
        double share = wasted(kind, ps, holdings[i].n, holdings[i].with_top);

        printf(" %5.2f %%", share);
        ck_assert_double_le(share, holdings[i].most);
    }
    printf("\n");
    fflush(stdout);
}

/* Another worker's value of a pixel, with indirect light a different one,
 * was there first. */
static bool
trace_late(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    struct world *w = arg;
    int i = (y + w->q.ystep - 1) / w->q.ystep;
    struct rad_pixel other;

    if (i >= w->nlines)
        i = w->nlines - 1;
    if (!trace(arg, ctx, x, y, out))
        return false;
    other = *out;
    other.L.r *= 1 + (float)(x % 3);
    rad_facts_put(w->facts[i], x, y - team_line_row(&w->q, i), &other,
                  RAD_FACT_FOREIGN);
    return true;
}

/* What is known of a line follows from the facts that the truth will find. */
TEST(a_guess_goes_by_the_facts_that_stay)
{
    struct analytic a = { (enum analytic_kind)3, 1 };
    struct world *w = world_new(&a, 4, MOST_W, MOST_H, .05, false);
    struct pass p = { .mode = TEAM_LINES, .last = w->nlines, .nthreads = 1 };
    struct team_spec spec = spec_of(w, &p);
    uint8_t *ahead = calloc((size_t)w->nlines, w->ndensity);
    uint8_t *again = calloc((size_t)w->nlines, w->ndensity);
    struct team *t;

    spec.ahead.record = ahead;
    spec.trace = trace_late;
    t = team_new(&spec);
    w->team = t;
    team_work(t, NULL);
    ck_assert_uint_gt(team_rays(t), 0);
    team_free(t);
    spec.ahead.record = again;
    spec.trace = trace;
    t = team_new(&spec);
    team_work(t, NULL);
    ck_assert_uint_eq(team_rays(t), 0);
    ck_assert_mem_eq(ahead, again, (size_t)w->nlines * w->ndensity);
    team_free(t);
    free(ahead);
    free(again);
    world_free(w);
}
