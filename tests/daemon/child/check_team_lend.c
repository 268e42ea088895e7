/* check_team_lend.c - a picture whose last lines are made while columns of them
 * are lent to other teams is the same, and no pixel is traced twice */
#include "config.h"

#include "team_fixture.h"

/* A picture whose last lines are made while columns of them are lent. */
enum { MOST_LOANS = 6 };

struct lent {
    struct team_loan is;
    struct rad_pixel top[MOST_W], bottom[MOST_W];
    uint8_t density[MOST_W + 3], wanted[MOST_W / 8 + 1];
};

struct lender {
    struct world *w;
    struct team *team;
    uint64_t *state;
    int pause;   /* pixels until it lends again */
    double part; /* of what is left */
    int nloans;
    struct lent loan[MOST_LOANS];
};

/* Lend as soon as that is possible after some pixels. */
static bool
trace_and_lend(void *arg, struct rad_ctx *ctx, int x, int y,
               struct rad_pixel *out)
{
    struct lender *l = arg;
    struct lent *to = &l->loan[l->nloans];
    bool lends = --l->pause < 0 && l->nloans < MOST_LOANS;

    (void)ctx;
    if (lends)
        to->is.wanted = to->wanted;
    if (lends && team_lend(l->team, l->part, &to->is)) {
        size_t n = (size_t)to->is.n * sizeof *to->top;

        memcpy(to->top, to->is.top, n);
        to->is.top = to->top;
        if (to->is.bottom)
            to->is.bottom = memcpy(to->bottom, to->is.bottom, n);
        if (to->is.density)
            to->is.density =
                memcpy(to->density, to->is.density, l->w->ndensity);
        ck_assert(to->is.given > 0 && to->is.left >= 0);
        ck_assert_double_le(to->is.given + to->is.left, 1 + 1e-9);
        l->nloans++;
        l->pause = draw(l->state, 40);
    }
    return analytic_pixel(&l->w->a, l->w->q.depth, x, y, out);
}

static void
hand_on_lender(void *arg, int row, const struct rad_pixel *pixels)
{
    const struct lender *l = arg;

    hand_on(l->w, row, pixels);
}

static void
paint_lender(void *arg, struct rad_ctx *ctx, int x0, int x1, int y,
             struct rad_pixel *row)
{
    const struct lender *l = arg;

    paint(l->w, ctx, x0, x1, y, row);
}

/* The truth about the last lines, which lends; or what was lent, over facts of
 * its own, which lends on. */
static struct team *
run_lender(struct lender *l, const struct pass *p, int out,
           const struct team_loan *loan, _Atomic(struct rad_facts *) *facts)
{
    struct team_spec spec = spec_of(l->w, p);

    spec.facts = facts;
    spec.truth.out = out;
    spec.loan = loan;
    spec.trace = trace_and_lend;
    spec.paint = paint_lender;
    spec.truth.rows = hand_on_lender;
    spec.arg = l;
    spec.nthreads = 1;
    l->team = team_new(&spec);
    ck_assert_ptr_nonnull(l->team);
    team_work(l->team, NULL);
    l->w->traced += team_rays(l->team);
    return l->team;
}

/* Bring the facts of what was lent home: none was made there, but for the ends
 * of gaps at either side. */
static void
bring_home(struct world *w, const struct rad_facts *facts, int line,
           uint64_t *twice)
{
    int rows = rad_facts_rows(facts);
    struct rad_pixel p;

    for (int r = 0; r < rows; r++)
        for (int x = 0; x < w->q.width; x++)
            if (rad_facts_get(facts, x, r, &p) &&
                !rad_facts_put(w->all[line], x, r, &p, RAD_FACT_FOREIGN)) {
                ck_assert_int_eq(r, rows - 1);
                ++*twice;
            }
}

/* Do what was lent, and what of that was lent on. */
static void
do_loans(struct lender *l, uint64_t *twice)
{
    const struct pass p = { .mode = TEAM_LOAN };

    for (int i = 0; i < l->nloans; i++) {
        const struct team_loan *loan = &l->loan[i].is;
        _Atomic(struct rad_facts *) facts[MOST_LINES] = { NULL };
        struct rad_facts *own =
            rad_facts_new(l->w->q.width, team_line_rows(&l->w->q, loan->line));
        struct pass this = p;
        struct team *t;

        ck_assert_ptr_nonnull(own);
        facts[loan->line] = own;
        this.first = loan->line;
        this.last = loan->line + 1;
        l->pause = draw(l->state, 40);
        t = run_lender(l, &this, 0, loan, facts);
        ck_assert(team_done(t));
        bring_home(l->w, own, loan->line, twice);
        team_free(t);
        rad_facts_free(own);
    }
}

/* Lines from `first` on, with as many teams as it takes. */
static void
lend_lines(struct world *w, uint64_t *state, int first, unsigned *nloans)
{
    struct lender l = { .w = w, .state = state };
    struct pass p = true_pass(w, TEAM_TRUTH, first, w->nlines);
    uint64_t twice = 0, before = w->traced;
    int out = 0;
    struct team *t;

    l.pause = draw(state, 200);
    l.part = .1 + .1 * draw(state, 8);
    t = run_lender(&l, &p, 0, NULL, w->facts);
    ck_assert(team_blocked(t, &out) == (l.nloans > 0));
    if (l.nloans > 0) {
        ck_assert(!team_done(t));
        ck_assert_int_eq(out, w->nlines - 1);
        team_free(t);
        *nloans += (unsigned)l.nloans;
        do_loans(&l, &twice);
        l.nloans = MOST_LOANS;
        t = run_lender(&l, &p, out, NULL, w->facts);
    }
    ck_assert(team_done(t) && !team_blocked(t, &out));
    w->primary += team_primary(t);
    ck_assert_uint_le(twice, 2 * MOST_LOANS);
    if (w->q.maxdiff > 0) /* else what was interpolated decides, and a block
                           * begins without what the column before it found */
        ck_assert_uint_le(w->traced - before, team_primary(t) + twice);
    team_free(t);
}

LOOP_TEST(columns_that_are_lent_are_traced_once, SEEDS)
{
    uint64_t state = (uint64_t)_i + 77;
    unsigned nloans = 0;

    for (int k = 0; k < 4 * WORLDS; k++) {
        struct world *w = random_world(&state);
        int first = w->nlines - 1 - draw(&state, 3);

        for (int i = 0; i < w->nlines; i++)
            w->facts[i] = w->all[i];
        first = first > 0 ? first : 0;
        if (first > 0) {
            struct pass p = true_pass(w, TEAM_TRUTH, 0, first);

            tell_truth(w, &p);
        }
        lend_lines(w, &state, first, &nloans);
        assert_same(w);
        world_free(w);
    }
    ck_assert(nloans > 0 || _i > 0);
}
