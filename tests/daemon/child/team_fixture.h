/* team_fixture.h - a picture that teams make, beside the same picture by one
 * run of the sampler
 *
 * All is static: each test program has its own. */
#ifndef RADD_TESTS_TEAM_FIXTURE_H
#define RADD_TESTS_TEAM_FIXTURE_H

#include "analytic.h"
#include "team/team.h"
#include "tests/unit.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Blocks of a line have several gaps in a picture as wide as WIDE. */
enum { MOST_W = 200, WIDE = 800, MOST_H = 160, MOST_LINES = MOST_H };
enum { SEEDS = 40, WORLDS = 5 };

/* A picture, and what was made of it. */
struct world {
    struct analytic a;
    struct rad_quincunx q;
    bool paints;
    int nlines;
    size_t ndensity;
    _Atomic(struct rad_facts *) facts[MOST_LINES]; /* as teams see them */
    struct rad_facts *all[MOST_LINES];
    struct rad_pixel pixels[MOST_H][WIDE]; /* handed on */
    int handed[MOST_H];
    uint64_t primary, traced; /* of truth; of all passes */
    /* of the pass that is running: pixels; what was begun when it had stopped */
    _Atomic int stop_after, late;
    _Atomic bool stopped;
    struct team *_Atomic team;
    /* one run of the sampler */
    struct rad_pixel want[MOST_H][WIDE];
    uint8_t want_density[MOST_LINES][WIDE + 3];
    uint64_t want_primary;
};

static inline bool
trace(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    struct world *w = arg;

    (void)ctx;
    w->late += w->stopped;
    if (atomic_fetch_sub(&w->stop_after, 1) == 1) {
        team_stop(w->team);
        w->stopped = true;
    }
    return analytic_pixel(&w->a, w->q.depth, x, y, out);
}

static inline bool
is_base_line(const struct world *w, int y)
{
    for (int i = 0; i < w->nlines; i++)
        if (rad_quincunx_base_row(&w->q, i) == y)
            return true;
    return false;
}

/* Rows that are out are not painted again, but for the tops of others. */
static inline void
paint(void *arg, struct rad_ctx *ctx, int x0, int x1, int y,
      struct rad_pixel *row)
{
    const struct world *w = arg;

    (void)ctx;
    ck_assert(w->handed[y] == 0 || is_base_line(w, y));
    if (w->paints)
        analytic_paint(&w->a, x0, x1, y, row);
}

static inline void
hand_on(void *arg, int row, const struct rad_pixel *pixels)
{
    struct world *w = arg;

    ck_assert_int_eq(w->handed[row], 0);
    if (row > 0)
        ck_assert_int_eq(w->handed[row - 1], 1);
    w->handed[row]++;
    memcpy(w->pixels[row], pixels, (size_t)w->q.width * sizeof *pixels);
}

static inline void
trace_alone(void *arg, int x, int y, struct rad_pixel *out)
{
    struct world *w = arg;

    w->want_primary += analytic_pixel(&w->a, w->q.depth, x, y, out);
}

/* The picture at one go: base line, bar, paint. */
static inline void
render_alone(struct world *w)
{
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    uint8_t density[WIDE + 3];
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
            rad_quincunx_bar_below(&q, i - 1, rows);
        for (int k = team_line_row(&q, i); k <= y; k++)
            paint(w, NULL, q.x0, q.x0 + q.width, q.y0 + k, w->want[k]);
        above = y;
    }
}

static inline struct world *
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

static inline void
world_free(struct world *w)
{
    for (int i = 0; i < w->nlines; i++)
        rad_facts_free(w->all[i]);
    free(w);
}

static inline uint64_t
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
    int first, last, nthreads;
    const struct rad_pixel *top;
    const uint8_t *density;
    bool true_top;
    int stop_after; /* pixels; 0: not */
    int least;      /* shrink to that at least; 0: not */
    uint8_t *record;
    uint64_t *cpu_ns;
};

static inline void *
be_member(void *team)
{
    team_work(team, NULL);
    return NULL;
}

static inline struct team_spec
spec_of(struct world *w, const struct pass *p)
{
    return (struct team_spec){ .sampler = w->q,
                               .mode = p->mode,
                               .first = p->first,
                               .last = p->last,
                               .top = p->top,
                               .top_density = p->density,
                               .ahead.true_top = p->true_top,
                               .ahead.record = p->record,
                               .cpu_ns = p->cpu_ns,
                               .facts = w->facts,
                               .trace = trace,
                               .paint = paint,
                               .truth.rows = hand_on,
                               .arg = w,
                               .nthreads = p->nthreads };
}

static inline struct team *
run_pass(struct world *w, const struct pass *p)
{
    struct team_spec spec = spec_of(w, p);
    pthread_t thread[8];
    struct team *t = team_new(&spec);

    ck_assert_ptr_nonnull(t);
    w->team = t;
    w->stop_after = p->stop_after;
    w->stopped = false;
    w->late = 0;
    for (int i = 1; i < p->nthreads; i++)
        ck_assert_int_eq(pthread_create(&thread[i], NULL, be_member, t), 0);
    if (p->least)
        team_shrink(t, p->least);
    team_work(t, NULL);
    for (int i = 1; i < p->nthreads; i++)
        ck_assert_int_eq(pthread_join(thread[i], NULL), 0);
    w->traced += team_rays(t);
    /* a gap, or some columns, each */
    ck_assert_int_le(w->late, 64 * p->nthreads);
    return t;
}

/* The bottom of a pass whose top was true is what one run has there. */
static inline void
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
static inline struct pass
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
static inline int
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

static inline void
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
static inline int
draw(uint64_t *state, int n)
{
    *state = rad_key_branch(*state, 1);
    return (int)(*state % (uint64_t)n);
}

static const double maxdiffs[] = { 0, .02, .05, .3 };

static inline struct world *
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

#endif
