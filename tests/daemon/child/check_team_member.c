/* check_team_member.c - the threads of a team at one unit, and what can be
 * asked of them meanwhile */
#include "config.h"

#include "team_fixture.h"
#include "tests/scarce.h"

#include <sched.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

/* Each line's members' processor time is its own, and adds up. */
TEST(what_lines_take_is_counted)
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

static const struct {
    enum team_mode mode;
    bool bars, out;
} makes[] = {
    { TEAM_LINES, false, false },
    { TEAM_AHEAD, true, false },
    { TEAM_TRUTH, true, true },
};

LOOP_TEST(a_team_tells_what_it_has_gone_over, N_ELEM(makes))
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

enum { PATIENCE_S = 100 }; /* longest wait for another thread */

/* Threads that help each other with one line, or two. */
struct shared {
    struct world *w;
    struct rad_facts *late; /* facts of the line that come when two have met */
    pthread_mutex_t mu;
    pthread_cond_t met;
    pthread_t first;
    int line, threads;
    _Atomic bool reached, over;
};

static void
shared_rows(void *arg, int row, const struct rad_pixel *pixels)
{
    hand_on(((struct shared *)arg)->w, row, pixels);
}

static void *
be_helper(void *arg)
{
    struct shared *s = arg;

    while (!s->over)
        if (team_helps(s->w->team))
            team_work(s->w->team, NULL);
        else
            sched_yield();
    return NULL;
}

/* Make lines [first, last) by so many threads, each pixel traced once. */
static void
share_lines(struct shared *s, team_trace_fn *trace_fn, int first, int last,
            int nthreads)
{
    struct world *w = s->w;
    struct pass p = true_pass(w, TEAM_TRUTH, first, last);
    struct team_spec spec = spec_of(w, &p);
    int row = team_line_row(&w->q, first), end;
    pthread_t thread[8];

    spec.trace = trace_fn;
    spec.paint = NULL;
    spec.truth.rows = shared_rows;
    spec.arg = s;
    spec.nthreads = nthreads;
    if (row > 0)
        w->handed[row - 1] = 1;
    w->team = team_new(&spec);
    for (int i = 1; i < nthreads; i++) {
        bool member = i < last - first;

        ck_assert_int_eq(pthread_create(&thread[i], NULL,
                                        member ? be_member : be_helper,
                                        member ? (void *)w->team : s),
                         0);
    }
    team_work(w->team, NULL);
    for (int i = 1; i < nthreads; i++) {
        s->over = i >= last - first;
        ck_assert_int_eq(pthread_join(thread[i], NULL), 0);
    }
    ck_assert(team_done(w->team));
    end = rad_quincunx_base_row(&w->q, last - 1);
    for (int y = row; y <= end; y++)
        ck_assert_mem_eq(w->pixels[y], w->want[y],
                         (size_t)w->q.width * sizeof *w->want[y]);
    ck_assert_uint_eq(team_rays(w->team), team_primary(w->team));
    team_free(w->team);
}

/* No pixel of the bar is traced before two wait for one, or after a time that
 * no machine is late by. */
static bool
trace_when_met(void *arg, struct rad_ctx *ctx, int x, int y,
               struct rad_pixel *out)
{
    struct shared *s = arg;
    struct timespec until;

    clock_gettime(CLOCK_REALTIME, &until);
    until.tv_sec += PATIENCE_S;
    pthread_mutex_lock(&s->mu);
    if (!is_base_line(s->w, y) &&
        (s->threads == 0 ||
         (s->threads == 1 && !pthread_equal(s->first, pthread_self())))) {
        s->first = pthread_self();
        s->threads++;
        if (s->threads == 2 && s->late)
            s->w->facts[s->line] = s->late;
        pthread_cond_broadcast(&s->met);
    }
    while (s->threads == 1 &&
           pthread_cond_timedwait(&s->met, &s->mu, &until) == 0)
        ;
    pthread_mutex_unlock(&s->mu);
    return trace(s->w, ctx, x, y, out);
}

/* The line has no facts, or has some, or gets some meanwhile. */
LOOP_TEST(a_thread_without_a_line_helps_with_that_of_another, 3)
{
    struct analytic a = { ANALYTIC_NOISE, 1 };
    struct world *w = world_new(&a, 4, MOST_W, MOST_H, .05, false);
    struct shared s = { .w = w,
                        .mu = PTHREAD_MUTEX_INITIALIZER,
                        .met = PTHREAD_COND_INITIALIZER,
                        .line = 6 };

    render_alone(w);
    if (_i != 1)
        w->facts[s.line] = NULL;
    if (_i == 2)
        s.late = w->all[s.line];
    share_lines(&s, trace_when_met, s.line, s.line + 1, 2);
    ck_assert_int_eq(s.threads, 2);
    world_free(w);
}

/* At a pixel of the bar another thread comes to help. */
static bool
trace_helpless(void *arg, struct rad_ctx *ctx, int x, int y,
               struct rad_pixel *out)
{
    struct shared *s = arg;
    struct team *t = s->w->team;

    if (!is_base_line(s->w, y) && !s->reached) {
        s->reached = true;
        ck_assert(team_helps(t));
        scarce_at = 1;
        team_work(t, NULL);
        ck_assert_int_eq(scarce_at, 0);
        ck_assert(!team_helps(t));
    }
    return trace(s->w, ctx, x, y, out);
}

TEST(who_has_no_memory_to_help_is_not_asked_again)
{
    struct analytic a = { ANALYTIC_NOISE, 1 };
    struct shared s = { 0 };
    struct world *w;

    if (RAD_SANITIZED)
        return;
    w = s.w = world_new(&a, 4, MOST_W, MOST_H, .05, false);
    render_alone(w);
    w->facts[6] = NULL;
    share_lines(&s, trace_helpless, 6, 7, 1);
    ck_assert(s.reached);
    world_free(w);
}

/* The first pixels of each block of a base line take long. */
static bool
trace_blocks(void *arg, struct rad_ctx *ctx, int x, int y,
             struct rad_pixel *out)
{
    struct world *w = ((struct shared *)arg)->w;

    if (is_base_line(w, y) && x % team_block_columns(&w->q) < w->q.xstep)
        usleep(1000);
    return trace(w, ctx, x, y, out);
}

/* Blocks side by side share a pixel.  With facts and without. */
LOOP_TEST(threads_at_one_base_line_trace_no_pixel_twice, 2)
{
    struct analytic a = { ANALYTIC_INTERIOR, 2 };
    struct world *w = world_new(&a, 2, WIDE, 40, .05, false);
    struct shared s = { .w = w };

    ck_assert_int_gt(team_block_columns(&w->q), 4 * w->q.xstep);
    render_alone(w);
    if (_i)
        w->facts[6] = NULL;
    share_lines(&s, trace_blocks, 6, 7, 4);
    world_free(w);
}

/* Line 0 ends while the member of line 1 is at a gap in the middle, early, and
 * stays there for a while. */
static bool
trace_early_gap(void *arg, struct rad_ctx *ctx, int x, int y,
                struct rad_pixel *out)
{
    struct shared *s = arg;
    struct rad_quincunx *q = &s->w->q;
    int gap = rad_quincunx_gap_begin(q, 1, rad_quincunx_ngaps(q, 1) / 2);

    if (y == rad_quincunx_base_row(q, 1) && x == gap && !s->reached) {
        s->reached = true;
        usleep(50000);
    }
    for (int ms = 0; y == 0 && x > 0 && !s->reached; ms++) {
        ck_assert_int_lt(ms, PATIENCE_S * 1000);
        usleep(1000);
    }
    return trace(s->w, ctx, x, y, out);
}

LOOP_TEST(who_helps_traces_nothing_that_was_traced_early, 2)
{
    struct analytic a = { ANALYTIC_INTERIOR, 2 };
    struct world *w = world_new(&a, 2, WIDE, 40, .05, false);
    struct shared s = { .w = w };

    render_alone(w);
    if (_i)
        w->facts[1] = NULL;
    share_lines(&s, trace_early_gap, 0, 2, 3);
    world_free(w);
}

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

LOOP_TEST(bottoms_come_in_pieces_while_they_are_made, 2)
{
    struct analytic a = { ANALYTIC_INTERIOR, 3 };
    struct world *w = world_new(&a, 4, MOST_W, 40, .05, false);
    struct reader r = { 0 };
    struct team_spec spec = { .sampler = w->q,
                              .mode = _i ? TEAM_LINES : TEAM_TRUTH,
                              .last = 5,
                              .ahead.true_top = true,
                              .facts = w->facts,
                              .trace = trace_and_read,
                              .paint = paint_interior,
                              .truth.rows = ignore_row,
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
LOOP_TEST(who_waits_traces_what_is_wanted_anyway, 2)
{
    for (int kind = 0; kind < ANALYTIC_KINDS; kind++) {
        struct analytic a = { (enum analytic_kind)kind, 3 };
        struct world *w = world_new(&a, 4, MOST_W, 40, .05, false);
        struct halted h = { .w = w };
        struct team_spec spec = { .sampler = w->q,
                                  .last = w->nlines,
                                  .facts = _i ? w->facts : NULL,
                                  .trace = trace_halted,
                                  .truth.rows = halted_rows,
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
