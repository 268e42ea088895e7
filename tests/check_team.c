/* check_team.c - however a picture is cut, guessed at and traced ahead, it is
 * the one that one run of the sampler makes, and so are its primary rays */
#include "config.h"

#include "analytic.h"
#include "team/team.h"
#include "unit.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { MOST_W = 200, MOST_H = 160, MOST_LINES = MOST_H };

/* A picture, and what was made of it. */
struct world {
    struct analytic a;
    struct rad_quincunx q;
    bool paints;
    int nlines;
    size_t ndensity;
    _Atomic(struct rad_facts *) facts[MOST_LINES]; /* as teams see them */
    struct rad_facts *all[MOST_LINES];
    struct rad_pixel pixels[MOST_H][MOST_W]; /* handed on */
    int handed[MOST_H];
    uint64_t primary, traced; /* of truth; of all passes */
    _Atomic int stop_after;   /* pixels; the pass that is running */
    struct team *_Atomic team;
    /* one run of the sampler */
    struct rad_pixel want[MOST_H][MOST_W];
    uint8_t want_density[MOST_LINES][MOST_W + 3];
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

static bool
is_base_line(const struct world *w, int y)
{
    for (int i = 0; i < w->nlines; i++)
        if (rad_quincunx_base_row(&w->q, i) == y)
            return true;
    return false;
}

/* Rows that are out are not painted again, but for the tops of others. */
static void
paint(void *arg, struct rad_ctx *ctx, int x0, int x1, int y,
      struct rad_pixel *row)
{
    const struct world *w = arg;

    (void)ctx;
    ck_assert(w->handed[y] == 0 || is_base_line(w, y));
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
        memcpy(w->want_density[i], density, w->ndensity);
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
        w->facts[i] = w->all[i] =
            rad_facts_new(width, team_line_rows(&w->q, i));
    return w;
}

static void
world_free(struct world *w)
{
    for (int i = 0; i < w->nlines; i++)
        rad_facts_free(w->all[i]);
    free(w);
}

static uint64_t
unused(const struct world *w)
{
    uint64_t n = 0;

    for (int i = 0; i < w->nlines; i++)
        n += rad_facts_unused(w->all[i]);
    return n;
}

/* One pass, by nthreads at once; the team is returned when they have left. */
struct pass {
    enum team_mode mode;
    enum team_end end;
    int first, last, nthreads;
    const struct rad_pixel *top;
    const uint8_t *density;
    bool true_top;
    int stop_after; /* pixels; 0: not */
    int least;      /* shrink to that at least; 0: not */
    int filled;
    uint8_t *record;
    const uint8_t *earlier;
    uint64_t *cpu_ns;
};

static void *
be_member(void *team)
{
    team_work(team, NULL);
    return NULL;
}

static struct team_spec
spec_of(struct world *w, const struct pass *p)
{
    return (struct team_spec){ .sampler = w->q,
                               .mode = p->mode,
                               .end = p->end,
                               .first = p->first,
                               .last = p->last,
                               .top = p->top,
                               .top_density = p->density,
                               .true_top = p->true_top,
                               .filled = p->filled,
                               .record = p->record,
                               .earlier = p->earlier,
                               .cpu_ns = p->cpu_ns,
                               .facts = w->facts,
                               .trace = trace,
                               .paint = paint,
                               .rows = hand_on,
                               .arg = w,
                               .nthreads = p->nthreads };
}

static struct team *
run_pass(struct world *w, const struct pass *p)
{
    struct team_spec spec = spec_of(w, p);
    pthread_t thread[8];
    struct team *t = team_new(&spec);

    ck_assert_ptr_nonnull(t);
    w->team = t;
    w->stop_after = p->stop_after;
    for (int i = 1; i < p->nthreads; i++)
        ck_assert_int_eq(pthread_create(&thread[i], NULL, be_member, t), 0);
    if (p->least)
        team_shrink(t, p->least);
    team_work(t, NULL);
    for (int i = 1; i < p->nthreads; i++)
        ck_assert_int_eq(pthread_join(thread[i], NULL), 0);
    w->traced += team_rays(t);
    if (p->stop_after > 0) /* a gap, or some columns, each */
        ck_assert_int_ge(w->stop_after, -64 * p->nthreads);
    return t;
}

/* The bottom of a pass whose top was true is what one run has there. */
static void
assert_bottom(const struct world *w, struct team *t, int last)
{
    int row = rad_quincunx_base_row(&w->q, last - 1);
    struct team_bottom b;

    team_bottom(t, &b);
    ck_assert_int_eq(b.columns, w->q.width);
    ck_assert_uint_eq(b.ndensity, w->ndensity);
    ck_assert_mem_eq(b.pixels, w->want[row],
                     (size_t)w->q.width * sizeof *b.pixels);
    if (w->ndensity > 0)
        ck_assert_mem_eq(b.density, w->want_density[last - 1], w->ndensity);
}

/* A pass over lines [first, last) whose top is true. */
static struct pass
true_pass(struct world *w, enum team_mode mode, int first, int last)
{
    struct pass p = { .mode = mode,
                      .first = first,
                      .last = last,
                      .nthreads = 1,
                      .true_top = true };

    if (first > 0) {
        p.top = w->want[rad_quincunx_base_row(&w->q, first - 1)];
        p.density = w->want_density[first - 1];
    }
    return p;
}

/* Returns the line after the last: as least allows, fewer may be done. */
static int
tell_truth(struct world *w, const struct pass *p)
{
    struct team *t = run_pass(w, p);
    int last = team_shrink(t, p->last);

    ck_assert(team_done(t));
    ck_assert_int_gt(last, p->first);
    assert_bottom(w, t, last);
    w->primary += team_primary(t);
    team_free(t);
    return last;
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
                      .end = (enum team_end)draw(state, 4),
                      .first = first,
                      .last = last,
                      .nthreads = 1 + draw(state, 3),
                      .stop_after = draw(state, 2) ? 0 : draw(state, 300),
                      .least = draw(state, 4) ? 0 : first + 1 };
    struct twin twin = { w, *state, first, last, draw(state, 2) * 200 };
    pthread_t thread;

    guess_top(w, state, &p);
    p.filled = p.first + draw(state, 1 + last - p.first);
    for (int i = p.first; i < last; i++)
        w->facts[i] = w->all[i];
    ck_assert_int_eq(pthread_create(&thread, NULL, be_twin, &twin), 0);
    team_free(run_pass(w, &p));
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
}

/* Go over all lines of a pass on a guess first, and have the pass hold its
 * lines against it. */
static void
guess_all(struct world *w, uint64_t *state, struct pass *p)
{
    struct pass ahead = { .mode = draw(state, 2) ? TEAM_LINES : TEAM_AHEAD,
                          .first = p->first,
                          .last = p->last,
                          .filled = p->filled,
                          .nthreads = p->nthreads };

    p->record = malloc((size_t)(p->last - p->first) * w->ndensity + 1);
    ck_assert_ptr_nonnull(p->record);
    ahead.record = p->record;
    team_free(run_pass(w, &ahead));
    p->earlier = p->record;
    p->filled = p->first;
    p->nthreads = 1;
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
    p.end = (enum team_end)draw(state, 4);
    p.filled = first + draw(state, 1 + last - first);

    ck_assert_int_eq(pthread_create(&thread, NULL, be_twin, &twin), 0);
    if (draw(state, 2)) {
        struct team *t;

        for (int i = first; i < last; i++)
            w->facts[i] = w->all[i];
        if (draw(state, 2))
            guess_all(w, state, &p);
        p.least = draw(state, 2) ? 0 : first + 1;
        t = run_pass(w, &p);
        ck_assert(team_done(t));
        p.last = team_shrink(t, last);
        assert_bottom(w, t, p.last);
        team_free(t);
    }
    free(p.record);
    p.record = NULL;
    p.earlier = NULL;
    p.mode = TEAM_TRUTH;
    p.least = draw(state, 2) ? 0 : first + 1;
    last = tell_truth(w, &p);
    ck_assert_int_eq(pthread_join(thread, NULL), 0);
    return last;
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
    for (int i = 0; i < w->nlines; i++)
        if (draw(state, 2))
            w->facts[i] = NULL;
    render_alone(w);
    return w;
}

enum { SEEDS = 40, WORLDS = 5 };

START_TEST(any_guess_ends_in_the_same_picture)
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
END_TEST

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

START_TEST(little_is_traced_for_nothing)
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
END_TEST

/* Each line's members' processor time is its own, and adds up. */
START_TEST(what_lines_take_is_counted)
{
    struct analytic a = { ANALYTIC_NOISE, 1 };
    struct world *w = world_new(&a, 4, MOST_W, MOST_H, .05, false);
    uint64_t cpu_ns[MOST_LINES] = { 0 }, sum = 0;
    struct timespec t0, t1;
    struct pass p;
    int last = 12;

    render_alone(w);
    p = true_pass(w, TEAM_TRUTH, 0, last);
    p.nthreads = 3;
    p.cpu_ns = cpu_ns;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t0);
    tell_truth(w, &p);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t1);
    for (int i = 0; i < MOST_LINES; i++) {
        ck_assert_int_eq(cpu_ns[i] > 0, i < last);
        sum += cpu_ns[i];
    }
    ck_assert_uint_le(sum, (uint64_t)((t1.tv_sec - t0.tv_sec) * 1000000000 +
                                      t1.tv_nsec - t0.tv_nsec));
    world_free(w);
}
END_TEST

/* Bars that come along with the lines are facts after LINES. */
START_TEST(lines_are_filled_as_far_as_asked_for)
{
    struct analytic a = { (enum analytic_kind)0, 1 };
    struct world *w = world_new(&a, 4, MOST_W, MOST_H, .05, false);
    struct pass p = { .mode = TEAM_LINES,
                      .last = w->nlines,
                      .filled = w->nlines / 2,
                      .nthreads = 1,
                      .true_top = true };

    render_alone(w);
    team_free(run_pass(w, &p));
    for (int i = 1; i < w->nlines; i++) {
        int rows = team_line_rows(&w->q, i) - 1;
        bool some = false;

        for (int x = 0; x < w->q.width; x++)
            for (int k = 0; k < rows; k++) {
                struct rad_pixel pixel;

                some |= rad_facts_get(w->facts[i], x, k, &pixel);
            }
        ck_assert(some == (i < p.filled));
    }
    p = true_pass(w, TEAM_TRUTH, 0, w->nlines);
    tell_truth(w, &p);
    assert_same(w);
    world_free(w);
}
END_TEST

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

static const struct {
    enum team_mode mode;
    bool bars, out;
} makes[] = {
    { TEAM_LINES, false, false },
    { TEAM_AHEAD, true, false },
    { TEAM_TRUTH, true, true },
};

START_TEST(a_team_tells_what_it_has_gone_over)
{
    struct analytic a = { (enum analytic_kind)3, 1 };
    struct world *w = world_new(&a, 4, MOST_W, MOST_H, .05, false);
    struct pass p = { .mode = makes[_i].mode, .last = w->nlines };
    uint64_t width = (uint64_t)w->q.width, height = (uint64_t)w->q.height;
    uint64_t lines = (uint64_t)w->nlines;
    struct team_made made;
    struct team *t;

    p.nthreads = 3;
    t = run_pass(w, &p);
    made = team_made(t);
    ck_assert_uint_eq(made.base, lines * width);
    ck_assert_uint_eq(made.bars, makes[_i].bars ? (height - lines) * width : 0);
    ck_assert_uint_eq(made.out, makes[_i].out ? height * width : 0);
    team_free(t);
    world_free(w);
}
END_TEST

/* What is known of a line follows from the facts that the truth will find. */
START_TEST(a_guess_goes_by_the_facts_that_stay)
{
    struct analytic a = { (enum analytic_kind)3, 1 };
    struct world *w = world_new(&a, 4, MOST_W, MOST_H, .05, false);
    struct pass p = { .mode = TEAM_LINES, .last = w->nlines, .nthreads = 1 };
    struct team_spec spec = spec_of(w, &p);
    uint8_t *ahead = calloc((size_t)w->nlines, w->ndensity);
    uint8_t *again = calloc((size_t)w->nlines, w->ndensity);
    struct team *t;

    spec.record = ahead;
    spec.trace = trace_late;
    t = team_new(&spec);
    w->team = t;
    team_work(t, NULL);
    ck_assert_uint_gt(team_rays(t), 0);
    team_free(t);
    spec.record = again;
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
END_TEST

/* May a member join a team for that pass? */
static bool
is_open(struct world *w, const struct pass *p)
{
    struct team_spec spec = spec_of(w, p);
    struct team *t = team_new(&spec);
    bool open;

    ck_assert_ptr_nonnull(t);
    open = team_open(t);
    team_free(t);
    return open;
}

/* A true pass over facts that comes to what an earlier one found leaves out the
 * lines between: else it would trace the one whose facts are gone. */
START_TEST(lines_that_come_out_as_before_are_left_out)
{
    struct analytic a = { (enum analytic_kind)0, 1 };
    struct world *w = world_new(&a, 4, MOST_W, MOST_H, .05, false);
    int first = 4, last = w->nlines, middle = last - 3;
    uint8_t *record = malloc((size_t)last * w->ndensity);
    struct pass p = { .mode = TEAM_LINES,
                      .first = first,
                      .last = last,
                      .nthreads = 1,
                      .record = record };
    struct rad_facts *none =
        rad_facts_new(w->q.width, team_line_rows(&w->q, middle));
    struct team *t;

    render_alone(w);
    team_free(run_pass(w, &p));
    w->facts[middle] = none;
    p = true_pass(w, TEAM_LINES, first, last);
    ck_assert(is_open(w, &p));
    p.earlier = record;
    ck_assert(!is_open(w, &p)); /* lines are left out by one member */
    t = run_pass(w, &p);
    ck_assert(team_done(t));
    assert_bottom(w, t, last);
    /* some of the first lines may be missing */
    ck_assert_uint_lt(team_rays(t), (uint64_t)(w->q.width / w->q.xstep));
    team_free(t);
    p.earlier = NULL;
    t = run_pass(w, &p);
    ck_assert_uint_ge(team_rays(t), (uint64_t)(w->q.width / w->q.xstep));
    team_free(t);
    rad_facts_free(none);
    free(record);
    world_free(w);
}
END_TEST

/* One who reads a bottom in pieces, as they become final. */
struct reader {
    struct team *team;
    struct rad_pixel pixels[MOST_W];
    uint8_t density[MOST_W + 3];
    int columns, pieces;
    size_t ndensity;
};

static void
read_bottom(struct reader *r)
{
    struct team_bottom b;

    team_bottom(r->team, &b);
    r->pieces += b.columns > r->columns;
    for (; r->columns < b.columns; r->columns++)
        r->pixels[r->columns] = b.pixels[r->columns];
    for (; r->ndensity < b.ndensity; r->ndensity++)
        r->density[r->ndensity] = b.density[r->ndensity];
}

/* Read as tracing goes on, by the one who traces: so each piece is seen. */
static bool
trace_and_read(void *arg, struct rad_ctx *ctx, int x, int y,
               struct rad_pixel *out)
{
    (void)ctx;
    read_bottom(arg);
    return analytic_pixel(&(struct analytic){ ANALYTIC_INTERIOR, 3 }, false, x,
                          y, out);
}

static void
paint_interior(void *arg, struct rad_ctx *ctx, int x0, int x1, int y,
               struct rad_pixel *row)
{
    (void)arg;
    (void)ctx;
    analytic_paint(&(struct analytic){ ANALYTIC_INTERIOR, 3 }, x0, x1, y, row);
}

static void
ignore_row(void *arg, int row, const struct rad_pixel *pixels)
{
    (void)arg;
    (void)row;
    (void)pixels;
}

START_TEST(bottoms_come_in_pieces_while_they_are_made)
{
    struct analytic a = { ANALYTIC_INTERIOR, 3 };
    struct world *w = world_new(&a, 4, MOST_W, 40, .05, false);
    struct reader r = { 0 };
    struct team_spec spec = { .sampler = w->q,
                              .mode = _i ? TEAM_LINES : TEAM_TRUTH,
                              .last = 5,
                              .true_top = true,
                              .facts = w->facts,
                              .trace = trace_and_read,
                              .paint = paint_interior,
                              .rows = ignore_row,
                              .arg = &r,
                              .nthreads = 1 };

    w->paints = true;
    render_alone(w);
    r.team = team_new(&spec);
    read_bottom(&r);
    ck_assert_int_eq(r.columns, 0);
    team_work(r.team, NULL);
    ck_assert_int_ge(r.pieces, 2);
    read_bottom(&r);
    ck_assert_int_eq(r.columns, MOST_W);
    ck_assert_uint_eq(r.ndensity, w->ndensity);
    ck_assert_mem_eq(r.pixels, w->want[rad_quincunx_base_row(&w->q, 4)],
                     MOST_W * sizeof *r.pixels);
    ck_assert_mem_eq(r.density, w->want_density[4], w->ndensity);
    team_free(r.team);
    world_free(w);
}
END_TEST

/* Workers at the same unit.  They take turns, a pixel each, so that the time
 * that passes is the number of turns, and send each other what they have every
 * so many turns. */
enum { TWINS = 4, MAIL_TURNS = 8 };

struct shift {
    struct twin_worker *workers;
    int n, turn, ended;
    pthread_mutex_t mu;
    pthread_cond_t moved;
};

struct twin_worker {
    struct world *w;
    struct shift *shift;
    struct pass pass;
    int number;
    uint64_t turns, ended_at;
};

/* All that is new with one worker goes to the others. */
static void
mail(struct shift *s, struct twin_worker *from)
{
    static uint8_t bitmap[MOST_W * (RAD_QUINCUNX_MAX_YSTEP + 1)];
    static float pixels[3 * MOST_W * (RAD_QUINCUNX_MAX_YSTEP + 1)];

    for (int i = from->pass.first; i < from->pass.last; i++) {
        int rows = team_line_rows(&from->w->q, i);
        size_t n =
            rad_facts_export(from->w->facts[i], 0, rows, 3, 0, bitmap, pixels);

        for (int k = 0; k < s->n; k++)
            if (k != from->number)
                ck_assert_int_eq(rad_facts_import(s->workers[k].w->facts[i], 0,
                                                  rows, 3, RAD_FACT_FOREIGN,
                                                  bitmap, pixels, n),
                                 0);
    }
}

static void
next_turn(struct shift *s)
{
    do
        s->turn = (s->turn + 1) % s->n;
    while (s->workers[s->turn].ended_at > 0 && s->ended < s->n);
    pthread_cond_broadcast(&s->moved);
}

static void
wait_turn(struct shift *s, const struct twin_worker *t)
{
    while (s->turn != t->number)
        pthread_cond_wait(&s->moved, &s->mu);
}

static bool
trace_in_turn(void *arg, struct rad_ctx *ctx, int x, int y,
              struct rad_pixel *out)
{
    struct twin_worker *t = arg;
    struct shift *s = t->shift;

    (void)ctx;
    pthread_mutex_lock(&s->mu);
    if (++t->turns % MAIL_TURNS == 0)
        mail(s, t);
    next_turn(s);
    wait_turn(s, t);
    pthread_mutex_unlock(&s->mu);
    return analytic_pixel(&t->w->a, t->w->q.depth, x, y, out);
}

static void
hand_on_in_turn(void *arg, int row, const struct rad_pixel *pixels)
{
    struct twin_worker *t = arg;

    hand_on(t->w, row, pixels);
}

static void
paint_in_turn(void *arg, struct rad_ctx *ctx, int x0, int x1, int y,
              struct rad_pixel *row)
{
    struct twin_worker *t = arg;

    paint(t->w, ctx, x0, x1, y, row);
}

static void *
be_worker(void *arg)
{
    struct twin_worker *t = arg;
    struct shift *s = t->shift;
    struct team_spec spec = spec_of(t->w, &t->pass);
    struct team *team;

    spec.trace = trace_in_turn;
    spec.paint = paint_in_turn;
    spec.rows = hand_on_in_turn;
    spec.arg = t;
    spec.nthreads = 1;
    team = team_new(&spec);
    pthread_mutex_lock(&s->mu);
    wait_turn(s, t);
    pthread_mutex_unlock(&s->mu);
    team_work(team, NULL);
    t->w->primary = team_primary(team);
    t->w->traced = team_rays(team);
    team_free(team);
    pthread_mutex_lock(&s->mu);
    t->ended_at = t->turns + 1;
    s->ended++;
    next_turn(s);
    pthread_mutex_unlock(&s->mu);
    return NULL;
}

/* n workers on lines [first, last): each makes what one makes alone.  *turns is
 * how long the first took, of *alone; *traced what all traced. */
static void
share_unit(const struct analytic *a, int ps, int n, int first, int last,
           uint64_t *alone, uint64_t *turns, uint64_t *traced)
{
    struct twin_worker workers[TWINS] = { 0 };
    struct shift s = { .workers = workers, .n = n };
    pthread_t thread[TWINS];

    pthread_mutex_init(&s.mu, NULL);
    pthread_cond_init(&s.moved, NULL);
    for (int i = 0; i < n; i++) {
        struct twin_worker *t = &workers[i];

        t->w = world_new(a, ps, MOST_W, MOST_H, .05, false);
        render_alone(t->w);
        t->shift = &s;
        t->number = i;
        t->pass = true_pass(t->w, TEAM_TRUTH, first, last);
        t->pass.end = (enum team_end)i;
        memset(t->w->handed, 0, sizeof t->w->handed);
        if (first > 0)
            t->w->handed[rad_quincunx_base_row(&t->w->q, first - 1)] = 1;
    }
    for (int i = 0; i < n; i++)
        ck_assert_int_eq(
            pthread_create(&thread[i], NULL, be_worker, &workers[i]), 0);
    *turns = UINT64_MAX;
    *traced = 0;
    for (int i = 0; i < n; i++)
        ck_assert_int_eq(pthread_join(thread[i], NULL), 0);
    for (int i = 0; i < n; i++) {
        struct world *w = workers[i].w;
        int row = team_line_row(&w->q, first);

        *turns = workers[i].turns < *turns ? workers[i].turns : *turns;
        *traced += w->traced;
        *alone = w->primary;
        ck_assert_uint_eq(w->primary, workers[0].w->primary);
        for (; row <= rad_quincunx_base_row(&w->q, last - 1); row++)
            ck_assert_mem_eq(w->pixels[row], w->want[row],
                             MOST_W * sizeof *w->want[row]);
    }
    for (int i = 0; i < n; i++)
        world_free(workers[i].w);
    pthread_mutex_destroy(&s.mu);
    pthread_cond_destroy(&s.moved);
}

static const struct {
    int n, lines;
} crews[] = { { 1, 2 }, { 2, 1 }, { 2, 4 }, { 3, 1 }, { 4, 1 }, { 4, 4 } };

START_TEST(twins_share_the_work)
{
    int n = crews[_i].n, lines = crews[_i].lines;
    uint64_t alone = 0, turns = 0, traced = 0;

    for (int kind = 0; kind < ANALYTIC_KINDS; kind++)
        for (int ps = 4; ps <= 8; ps *= 2) {
            struct analytic a = { (enum analytic_kind)kind, 7 };
            uint64_t one, fastest, all;

            share_unit(&a, ps, n, 6, 6 + lines, &one, &fastest, &all);
            alone += one;
            turns += fastest;
            traced += all;
        }
    printf("%d at %d lines: %.2f times as fast, %.1f %% traced twice\n", n,
           lines, (double)alone / (double)turns,
           100 * ((double)traced / (double)alone - 1));
    fflush(stdout);
    ck_assert_uint_le(turns * (uint64_t)n * 3, alone * 4);
    ck_assert_uint_le(traced * 3, alone * 4);
}
END_TEST

/* The picture's first line stands still until the second is traced from its end
 * to its beginning: the thread at that may not wait. */
struct halted {
    struct world *w;
    _Atomic bool reached;
};

static bool
trace_halted(void *arg, struct rad_ctx *ctx, int x, int y,
             struct rad_pixel *out)
{
    enum { PATIENCE_S = 100 };
    struct halted *h = arg;
    struct world *w = h->w;

    (void)ctx;
    if (y == rad_quincunx_base_row(&w->q, 1) &&
        x == rad_quincunx_gap_begin(&w->q, 1, 1))
        h->reached = true;
    for (int ms = 0; y == 0 && x > 0 && !h->reached; ms++) {
        ck_assert_int_lt(ms, PATIENCE_S * 1000);
        usleep(1000);
    }
    return analytic_pixel(&w->a, false, x, y, out);
}

static void
halted_rows(void *arg, int row, const struct rad_pixel *pixels)
{
    hand_on(((struct halted *)arg)->w, row, pixels);
}

/* With facts and without. */
START_TEST(who_waits_traces_what_is_wanted_anyway)
{
    for (int kind = 0; kind < ANALYTIC_KINDS; kind++) {
        struct analytic a = { (enum analytic_kind)kind, 3 };
        struct world *w = world_new(&a, 4, MOST_W, 40, .05, false);
        struct halted h = { .w = w };
        struct team_spec spec = { .sampler = w->q,
                                  .last = w->nlines,
                                  .facts = _i ? w->facts : NULL,
                                  .trace = trace_halted,
                                  .rows = halted_rows,
                                  .arg = &h,
                                  .nthreads = 2 };
        struct team *t = team_new(&spec);
        pthread_t thread;

        render_alone(w);
        ck_assert_ptr_nonnull(t);
        ck_assert_int_eq(pthread_create(&thread, NULL, be_member, t), 0);
        team_work(t, NULL);
        ck_assert_int_eq(pthread_join(thread, NULL), 0);
        ck_assert(team_done(t));
        w->primary = team_primary(t);
        assert_same(w);
        ck_assert_uint_eq(team_rays(t), w->want_primary);
        ck_assert_uint_eq(unused(w), 0);
        team_free(t);
        world_free(w);
    }
}
END_TEST

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
    spec.out = out;
    spec.loan = loan;
    spec.trace = trace_and_lend;
    spec.paint = paint_lender;
    spec.rows = hand_on_lender;
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

    p.end = (enum team_end)draw(state, 4);
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

START_TEST(columns_that_are_lent_are_traced_once)
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
END_TEST

int
main(void)
{
    Suite *s = suite_create("team");
    TCase *tc = tcase_create("team");

    tcase_set_timeout(tc, 600);
    tcase_add_loop_test(tc, any_guess_ends_in_the_same_picture, 0, SEEDS);
    tcase_add_loop_test(tc, columns_that_are_lent_are_traced_once, 0, SEEDS);
    tcase_add_loop_test(tc, little_is_traced_for_nothing, 0,
                        3 * ANALYTIC_KINDS);
    tcase_add_test(tc, lines_are_filled_as_far_as_asked_for);
    tcase_add_test(tc, lines_that_come_out_as_before_are_left_out);
    tcase_add_test(tc, a_guess_goes_by_the_facts_that_stay);
    tcase_add_loop_test(tc, a_team_tells_what_it_has_gone_over, 0,
                        N_ELEM(makes));
    tcase_add_test(tc, what_lines_take_is_counted);
    tcase_add_loop_test(tc, bottoms_come_in_pieces_while_they_are_made, 0, 2);
    tcase_add_loop_test(tc, twins_share_the_work, 0, N_ELEM(crews));
    tcase_add_loop_test(tc, who_waits_traces_what_is_wanted_anyway, 0, 2);
    suite_add_tcase(s, tc);
    return unit_run(s);
}
