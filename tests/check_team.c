/* check_team.c - however a picture is cut, guessed at and traced ahead, it is
 * the one that one run of the sampler makes, and so are its primary rays */
#include "config.h"

#include "analytic.h"
#include "team.h"
#include "unit.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum { MOST_W = 200, MOST_H = 160, MOST_LINES = MOST_H };

/* A picture, and what was made of it. */
struct world {
    struct analytic a;
    struct rad_quincunx q;
    bool paints;
    int nlines;
    size_t ndensity;
    _Atomic(struct rad_facts *) facts[MOST_LINES];
    struct rad_pixel pixels[MOST_H][MOST_W]; /* handed on */
    int handed[MOST_H];
    uint64_t primary, traced; /* of truth; of all passes */
    /* true tops, by the line they are */
    struct rad_pixel top[MOST_LINES][MOST_W];
    uint8_t density[MOST_LINES][MOST_W];
    _Atomic int stop_after; /* pixels; the pass that is running */
    struct team *_Atomic team;
    /* one run of the sampler */
    struct rad_pixel want[MOST_H][MOST_W];
    uint64_t want_primary;
};

static bool
trace(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    struct world *w = arg;

    (void)ctx;
    if (atomic_fetch_sub(&w->stop_after, 1) == 1)
        team_stop(w->team);
    return analytic_pixel(&w->a, w->q.depth, x, y, out);
}

static void
paint(void *arg, struct rad_ctx *ctx, int x0, int x1, int y,
      struct rad_pixel *row)
{
    const struct world *w = arg;

    (void)ctx;
    if (w->paints)
        analytic_paint(&w->a, x0, x1, y, row);
}

static void
hand_on(void *arg, int row, const struct rad_pixel *pixels)
{
    struct world *w = arg;

    ck_assert_int_eq(w->handed[row], 0);
    if (row > 0)
        ck_assert_int_eq(w->handed[row - 1], 1);
    w->handed[row]++;
    memcpy(w->pixels[row], pixels, (size_t)w->q.width * sizeof *pixels);
}

static void
trace_alone(void *arg, int x, int y, struct rad_pixel *out)
{
    struct world *w = arg;

    w->want_primary += analytic_pixel(&w->a, w->q.depth, x, y, out);
}

/* The picture at one go: base line, bar, paint. */
static void
render_alone(struct world *w)
{
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    uint8_t density[MOST_W + 3];
    struct rad_quincunx q = w->q;
    int above = 0;

    q.trace = trace_alone;
    q.arg = w;
    rad_quincunx_start(&q, density);
    for (int i = 0; i < w->nlines; i++) {
        int y = rad_quincunx_base_row(&q, i);

        rad_quincunx_base(&q, i, density, w->want[y]);
        for (int k = above; k <= y; k++)
            rows[k - above] = w->want[k];
        if (i > 0)
            rad_quincunx_bar(&q, i - 1, rows);
        for (int k = team_line_row(&q, i); k <= y; k++)
            paint(w, NULL, q.x0, q.x0 + q.width, q.y0 + k, w->want[k]);
        above = y;
    }
}

static struct world *
world_new(const struct analytic *a, int ps, int width, int height,
          double maxdiff, bool depth)
{
    struct world *w = calloc(1, sizeof *w);

    ck_assert_ptr_nonnull(w);
    w->a = *a;
    w->q.width = width;
    w->q.height = height;
    w->q.maxdiff = maxdiff;
    w->q.depth = depth;
    rad_quincunx_steps(ps, &w->q.xstep, &w->q.ystep);
    w->nlines = rad_quincunx_nbases(&w->q);
    w->ndensity = rad_quincunx_ndensity(&w->q);
    for (int i = 0; i < w->nlines; i++)
        w->facts[i] = rad_facts_new(width, team_line_rows(&w->q, i));
    return w;
}

static void
world_free(struct world *w)
{
    for (int i = 0; i < w->nlines; i++)
        rad_facts_free(w->facts[i]);
    free(w);
}

static uint64_t
unused(const struct world *w)
{
    uint64_t n = 0;

    for (int i = 0; i < w->nlines; i++)
        n += rad_facts_unused(w->facts[i]);
    return n;
}

/* One pass, by nthreads at once; the team is returned when they have left. */
struct pass {
    enum team_mode mode;
    enum team_end end;
    int first, last, nthreads;
    const struct rad_pixel *top;
    const uint8_t *density;
    int stop_after; /* 0: not */
    int shrink;     /* once it has begun; 0: not */
};

static void *
be_member(void *team)
{
    team_work(team, NULL);
    return NULL;
}

static struct team *
run_pass(struct world *w, const struct pass *p)
{
    struct team_spec spec = { .sampler = w->q,
                              .mode = p->mode,
                              .end = p->end,
                              .first = p->first,
                              .last = p->last,
                              .top = p->top,
                              .top_density = p->density,
                              .facts = w->facts,
                              .trace = trace,
                              .paint = paint,
                              .rows = hand_on,
                              .arg = w,
                              .nthreads = p->nthreads };
    pthread_t thread[8];
    struct team *t = team_new(&spec);

    ck_assert_ptr_nonnull(t);
    w->team = t;
    w->stop_after = p->stop_after;
    for (int i = 1; i < p->nthreads; i++)
        ck_assert_int_eq(pthread_create(&thread[i], NULL, be_member, t), 0);
    if (p->shrink)
        team_shrink(t, p->first + 1);
    team_work(t, NULL);
    for (int i = 1; i < p->nthreads; i++)
        ck_assert_int_eq(pthread_join(thread[i], NULL), 0);
    w->traced += team_traced(t);
    return t;
}

/* The truth of lines [first, last), whose top is known; its bottom is kept. */
static void
tell_truth(struct world *w, int first, int last, enum team_end end,
           int nthreads)
{
    struct pass p = { TEAM_TRUTH,
                      end,
                      first,
                      last,
                      nthreads,
                      first > 0 ? w->top[first - 1] : NULL,
                      first > 0 ? w->density[first - 1] : NULL,
                      0,
                      0 };
    struct team *t = run_pass(w, &p);
    struct team_bottom b;

    ck_assert(team_done(t));
    team_bottom(t, &b);
    ck_assert_int_eq(b.columns, w->q.width);
    ck_assert_uint_eq(b.ndensity, w->ndensity);
    memcpy(w->top[last - 1], b.pixels, (size_t)w->q.width * sizeof *b.pixels);
    memcpy(w->density[last - 1], b.density, w->ndensity);
    w->primary += team_primary(t);
    team_free(t);
}

static void
assert_same(const struct world *w)
{
    for (int y = 0; y < w->q.height; y++) {
        ck_assert_int_eq(w->handed[y], 1);
        ck_assert_mem_eq(w->pixels[y], w->want[y],
                         (size_t)w->q.width * sizeof *w->want[y]);
    }
    ck_assert_uint_eq(w->primary, w->want_primary);
}

/* A random number below n. */
static int
draw(uint64_t *state, int n)
{
    *state = rad_key_branch(*state, 1);
    return (int)(*state % (uint64_t)n);
}

/* Values of other workers that arrive while a pass is running. */
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

        if (analytic_pixel(&w->a, w->q.depth, x, row + team_line_row(&w->q, i),
                           &p))
            rad_facts_put(w->facts[i], x, row, &p, RAD_FACT_FOREIGN);
    }
    return NULL;
}

/* Some pass on a guess over lines [first, last), perhaps cut short, perhaps
 * with facts that come in meanwhile. */
static void
guess(struct world *w, uint64_t *state, int first, int last)
{
    static const uint8_t some[MOST_W] = { 3, 0, 1, 7, 0, 0, 2 };
    struct pass p = { .mode = draw(state, 2) ? TEAM_LINES : TEAM_AHEAD,
                      .end = (enum team_end)draw(state, 4),
                      .first = first,
                      .last = last,
                      .nthreads = 1 + draw(state, 3),
                      .stop_after = draw(state, 2) ? 0 : draw(state, 300),
                      .shrink = draw(state, 4) == 0 };
    int how = draw(state, 4);
    struct twin twin = { w, *state, first, last, draw(state, 2) * 200 };
    pthread_t thread;

    if (first > 0 && how > 0)
        p.top = w->top[first - 1]; /* black, or the truth */
    if (first > 0 && how > 1)
        p.density = how == 2 ? some : w->density[first - 1];
    ck_assert_int_eq(pthread_create(&thread, NULL, be_twin, &twin), 0);
    team_free(run_pass(w, &p));
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
}

static const double maxdiffs[] = { 0, .02, .05, .3 };

static struct world *
random_world(uint64_t *state)
{
    static const int ps[] = { 1, 2, 4, 8, 16 };
    struct analytic a = { (enum analytic_kind)draw(state, ANALYTIC_KINDS),
                          *state };
    int height = 1 + draw(state, draw(state, 2) ? 20 : MOST_H);
    int width = 1 + draw(state, draw(state, 2) ? 20 : MOST_W);
    struct world *w = world_new(&a, ps[draw(state, 5)], width, height,
                                maxdiffs[draw(state, 4)], draw(state, 3) == 0);

    w->paints = draw(state, 2);
    render_alone(w);
    return w;
}

/* Cuts the lines into units: cut[k] to cut[k + 1]. */
static int
cut_lines(const struct world *w, uint64_t *state, int cut[MOST_LINES + 1])
{
    int n = 0, most = 1 + draw(state, 1 + draw(state, 2) * 30);

    for (cut[0] = 0; cut[n] < w->nlines; n++) {
        cut[n + 1] = cut[n] + 1 + draw(state, most);
        if (cut[n + 1] > w->nlines)
            cut[n + 1] = w->nlines;
    }
    return n;
}

enum { SEEDS = 60, WORLDS = 5 };

START_TEST(any_guess_ends_in_the_same_picture)
{
    uint64_t state = (uint64_t)_i;

    for (int k = 0; k < WORLDS; k++) {
        struct world *w = random_world(&state);
        int cut[MOST_LINES + 1], n = cut_lines(w, &state, cut), told = 0;

        while (told < n) {
            if (draw(&state, 3) > 0) {
                int u = told + draw(&state, n - told);

                guess(w, &state, cut[u], cut[u + 1]);
            } else {
                tell_truth(w, cut[told], cut[told + 1],
                           (enum team_end)draw(&state, 4), 1 + draw(&state, 3));
                told++;
            }
        }
        assert_same(w);
        world_free(w);
    }
}
END_TEST

/* Units of n lines, each by a worker of its own that begins at once: the first
 * knows its top, the others guess until it comes.  Rays for nothing, in
 * per cent of the primary rays. */
static double
wasted(enum analytic_kind kind, int ps, int n)
{
    uint64_t waste = 0, primary = 0;

    for (uint64_t seed = 1; seed <= 6; seed++) {
        struct analytic a = { kind, seed };
        struct world *w = world_new(&a, ps, MOST_W, MOST_H, .05, false);

        for (int i = n; i < w->nlines; i += n) {
            struct pass p = { TEAM_LINES, TEAM_FROM_LEFT, i, 0, 1,
                              NULL,       NULL,           0, 0 };

            p.last = i + n < w->nlines ? i + n : w->nlines;
            team_free(run_pass(w, &p));
            p.mode = TEAM_AHEAD;
            team_free(run_pass(w, &p));
        }
        for (int i = 0; i < w->nlines; i += n)
            tell_truth(w, i, i + n < w->nlines ? i + n : w->nlines,
                       TEAM_FROM_LEFT, 1);
        waste += unused(w);
        primary += w->primary;
        ck_assert_uint_eq(w->traced, w->primary + unused(w));
        world_free(w);
    }
    return 100 * (double)waste / (double)primary;
}

START_TEST(little_is_traced_for_nothing)
{
    static const int lengths[] = { 1, 2, 4, 16 };

    for (int kind = 0; kind < ANALYTIC_KINDS; kind++)
        for (int ps = 2; ps <= 16; ps *= 2) {
            printf("%-9s ps %2d:", analytic_name[kind], ps);
            for (int i = 0; i < N_ELEM(lengths); i++)
                printf(" %6.2f %%",
                       wasted((enum analytic_kind)kind, ps, lengths[i]));
            printf("\n");
        }
    fflush(stdout);
}
END_TEST

int
main(void)
{
    Suite *s = suite_create("team");
    TCase *tc = tcase_create("team");

    tcase_set_timeout(tc, 120);
    tcase_add_loop_test(tc, any_guess_ends_in_the_same_picture, 0, SEEDS);
    tcase_add_test(tc, little_is_traced_for_nothing);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
