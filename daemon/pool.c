/* pool.c - see pool.h
 *
 * A thread takes a unit from the queue and renders it as the first member of
 * its team (team.h); a thread that finds the queue empty joins a team that has
 * lines left to begin.  So with many units each has a thread to itself, and
 * one unit, or the last ones, have all of them.  The member that leaves last
 * says that the unit is done, and what its members counted.
 * Of strict units a team makes but a pass; what comes next is strict_pass.c's
 * to say.  What waits for nobody comes before what is traced ahead, and a
 * thread rather helps with the truth, or with base lines, than begins what
 * comes after them: others may wait for those. */
#include "config.h"

#include "pool.h"
#include "picture/doubt.h"
#include "picture/hdr.h"
#include "counted.h"
#include "team.h"
#ifdef RADD_TEST_HOOKS
#include "tests/hook.h"
#endif

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

/* rows are sent when so many bytes of them are done */
#define PIECE_BYTES (64u << 10)

/* Coded rows take so little that many wait in a piece: not for longer [s], so
 * that a preview shows them. */
#define PIECE_AGE .25

struct queued {
    struct queued *next;
    struct pool_unit unit;
};

/* A unit, or a pass of a strict one, that threads work on. */
struct active {
    struct active *next;      /* [mu] */
    struct pool *pool;        /* [fixed] */
    struct pool_unit unit;    /* [fixed] */
    struct strict_pass *pass; /* [mu] NULL: it is a window */
    enum strict_rank rank;    /* [fixed] a window's is the last */
    enum team_mode mode;      /* [fixed] */
    int row0;                 /* [fixed] the unit's first in the sampler's */
    struct team *team;        /* [fixed] */
    int members;              /* [mu] */
    struct msg_counts counts; /* [mu] of members that left */
    double wall0;             /* [fixed] */
    /* the member that hands rows on */
    int channels;
    struct pool_rows *piece; /* NULL: none begun */
    double piece_wall0;      /* when it was */
    struct rad_error err;    /* of a piece that could not be made */
    bool whole;              /* all rows were handed on, and count */
    struct rad_rough rough;
};

/* An estimate that threads work on, or that is done. */
struct estimating {
    struct estimating *next; /* [mu] */
    struct estimate *estimate;
    pool_estimate_fn *fn;
    int members;   /* [mu] */
    double wall_s; /* [mu] when it came; in the end, how long it took */
};

struct renderer {
    struct pool *pool;
    uv_thread_t thread;
    struct rad_ctx ctx;
    uint64_t seen;   /* [loop] ctx.at when it was last looked at */
    double seen_cpu; /* [loop] and what the thread had used when that was new */
};

struct pool {
    const struct rad_job *job;      /* [fixed] */
    const struct rad_frame *frames; /* [fixed] */
    struct strict *strict;          /* [mu] what it points to; NULL: none */
    bool coded;                     /* [fixed] rows leave as in a picture */
    int nthreads;                   /* [fixed] after pool_new() */
    struct renderer *renderers;     /* [fixed] */
    pool_rows_fn *fn;               /* [fixed] */
    pool_news_fn *news;             /* [fixed] */
    void *arg;                      /* [fixed] */
    uv_async_t async;
    uv_mutex_t mu;
    uv_cond_t work;                           /* with todo and stopping */
    uv_cond_t room;                           /* with unsent and stopping */
    struct queued *todo;                      /* [mu] */
    struct queued **todo_end;                 /* [mu] */
    struct active *active;                    /* [mu] */
    struct estimating *estimates, *estimated; /* [mu] under way; done */
    struct rad_seed *seed;                    /* [mu] NULL: none is under way */
    struct rad_seed *seeded_one;              /* [mu] that is done */
    pool_seed_fn *seed_fn;                    /* [mu] who is to hear of it */
    int seeding;                              /* [mu] threads at it */
    struct msg_counts seeded;                 /* [mu] what they counted */
    struct pool_rows *done;                   /* [mu] */
    struct pool_rows **done_end;              /* [mu] */
    size_t unsent;         /* [mu] bytes of pixels under way */
    double busy_s, wait_s; /* [mu] of units that are done with */
    int idle;              /* [mu] threads that find nothing to do */
    bool waits;            /* [mu] strict units waited then, */
    double waits_at;       /* [mu] when that was last looked at */
    _Atomic bool stopping; /* written with mu held; read anywhere */
};

static double
seconds(clockid_t clock)
{
    struct timespec t;

    clock_gettime(clock, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Hand a piece to the loop; waits while too much is under way. */
static void
put_done(struct pool *p, struct pool_rows *rows, size_t bytes)
{
    uv_mutex_lock(&p->mu);
    while (p->unsent > POOL_UNSENT && !atomic_load(&p->stopping))
        uv_cond_wait(&p->room, &p->mu);
    p->unsent += bytes;
    *p->done_end = rows;
    p->done_end = &rows->next;
    uv_mutex_unlock(&p->mu);
    uv_async_send(&p->async);
}

/* Put a row at `to` as it is to leave; returns its bytes. */
static size_t
put_row(void *to, const struct rad_pixel *from, int width, int channels)
{
    float *p = to;

    if (channels == 1)
        return rad_hdr_encode_pixels(from, width, to);
    for (int x = 0; x < width; x++, p += channels) {
        p[0] = from[x].L.r;
        p[1] = from[x].L.g;
        p[2] = from[x].L.b;
        if (channels == 4)
            p[3] = from[x].z;
    }
    return (size_t)((char *)p - (char *)to);
}

/* The most that a row takes, and what putting it there takes to work in. */
static size_t
row_room(const struct active *u)
{
    size_t width = (size_t)u->unit.window.width;

    if (u->channels == 1)
        return RAD_HDR_ROW_BYTES(width);
    return width * (size_t)u->channels * sizeof(float);
}

/* Begin a piece at `row` of the unit; NULL: memory is out, which ends it. */
static struct pool_rows *
new_piece(struct active *u, int row)
{
    size_t left = (size_t)(u->unit.window.height - row) * row_room(u);
    size_t most = PIECE_BYTES + row_room(u);
    struct pool_rows *p;

    /* the pixels are written before they are read */
    p = malloc(sizeof *p + (left < most ? left : most));
    if (!p) {
        rad_fail(&u->err, RAD_ENOMEM, "out of memory");
        team_stop(u->team);
        return NULL;
    }
    memset(p, 0, sizeof *p);
    u->piece_wall0 = seconds(CLOCK_MONOTONIC);
    p->unit = u->unit;
    p->row = (uint32_t)row;
    p->channels = u->channels;
    return p;
}

static bool
trace(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    const struct active *u = arg;
    bool seen =
        rad_frame_pixel(&u->pool->frames[u->unit.frame], ctx, x, y, out);

#ifdef RADD_TEST_HOOKS
    test_hook_pixel(u->pool->job->scene, x, y);
#endif
    return seen;
}

/* What is no number stays the lender's to trace: a fact is black and does not
 * say so, and it may be used though the loan was taken back meanwhile. */
static bool
trace_lent(void *arg, struct rad_ctx *ctx, int x, int y, struct rad_pixel *out)
{
    uint64_t unsound = ctx->counts.unsound_rays;

    return trace(arg, ctx, x, y, out) && ctx->counts.unsound_rays == unsound;
}

static void
paint(void *arg, struct rad_ctx *ctx, int x0, int x1, int y,
      struct rad_pixel *row)
{
    const struct active *u = arg;

    rad_frame_paint_row(&u->pool->frames[u->unit.frame], ctx, x0, x1, y, row);
}

static uint64_t
count(void *arg, const struct rad_ctx *ctx)
{
    (void)arg;
    return ctx->counts.rays;
}

static void
send_piece(struct active *u)
{
    put_done(u->pool, u->piece, u->piece->bytes);
    u->piece = NULL;
}

static bool
is_full(const struct active *u)
{
    return u->piece->bytes > PIECE_BYTES ||
           (u->channels == 1 &&
            seconds(CLOCK_MONOTONIC) - u->piece_wall0 > PIECE_AGE);
}

/* A row is done: into the piece with it.  A full piece goes out when there is
 * another row: the last one waits for the counts, and which that is a strict
 * unit does not know. */
static void
on_row(void *arg, int row, const struct rad_pixel *pixels)
{
    struct active *u = arg;

    if (u->piece && is_full(u))
        send_piece(u);
    if (!u->piece && !(u->piece = new_piece(u, row - u->row0)))
        return;
    rad_rough_row(&u->rough, pixels, u->unit.window.width, row,
                  u->pool->job->params.psample);
    u->piece->bytes += put_row((char *)u->piece->pixels + u->piece->bytes,
                               pixels, u->unit.window.width, u->channels);
    u->piece->rows++;
}

static void
free_active(struct active *u)
{
    if (u) {
        team_free(u->team);
        free(u->piece);
        free(u);
    }
}

static void
send_failure(struct pool *p, const struct pool_unit *unit,
             const struct rad_error *err)
{
    struct pool_rows *r = calloc(1, sizeof *r);

    if (!r)
        _exit(EX_OSERR); /* the unit would never end */
    r->unit = *unit;
    r->err = *err;
    put_done(p, r, 0);
}

/* Nobody works on the unit any more, and nobody knows of it: send the rest. */
static void
end_active(struct active *u)
{
    if (u->err.code < 0) {
        send_failure(u->pool, &u->unit, &u->err);
    } else if (u->whole) {
        u->piece->last = true;
        u->piece->counts = u->counts;
        send_piece(u);
    } else if (u->piece) {
        send_piece(u); /* whoever goes on makes them no more */
    }
    free_active(u);
}

static void on_bottom(void *arg);

static struct team *
new_team(struct active *u)
{
    const struct rad_frame *f = &u->pool->frames[u->unit.frame];
    const struct rad_window all = { 0, 0, f->width, f->height };
    const struct strict_pass *pass = u->pass;
    struct team_spec spec = { .mode = u->mode,
                              .trace = trace,
                              .paint = paint,
                              .count = count,
                              .arg = u,
                              .nthreads = u->pool->nthreads };

    rad_frame_sampler(f, pass ? &all : &u->unit.window, &spec.sampler);
    if (u->mode == TEAM_TRUTH)
        spec.rows = on_row;
    if (!pass) {
        spec.last = rad_quincunx_nbases(&spec.sampler);
        return team_new(&spec);
    }
    spec.end = pass->end;
    spec.first = pass->first;
    spec.last = pass->last;
    spec.true_top = pass->true_top;
    spec.top_known = pass->top_known;
    spec.filled = pass->filled;
    spec.record = pass->record;
    spec.earlier = pass->earlier;
    spec.cpu_ns = pass->cpu_ns;
    spec.top = pass->top;
    spec.top_density = pass->top_density;
    spec.facts = pass->facts;
    spec.out = pass->out;
    spec.lent = pass->lent;
    spec.loan = pass->loan;
    if (pass->loan)
        spec.trace = trace_lent;
    if (pass->true_top)
        spec.bottom = on_bottom;
    if (pass->earlier)
        spec.nthreads = 1;
    if (spec.nthreads > spec.last - spec.first)
        spec.nthreads = spec.last - spec.first;
    return team_new(&spec);
}

/* NULL: memory is out. */
static struct active *
new_active(struct pool *p, const struct pool_unit *unit,
           struct strict_pass *pass)
{
    struct active *u = calloc(1, sizeof *u);

    if (!u)
        return NULL;
    u->pool = p;
    u->unit = *unit;
    u->pass = pass;
    u->rank = pass ? pass->rank : STRICT_AHEAD;
    u->mode = pass ? pass->mode : TEAM_TRUTH;
    u->row0 = pass ? unit->window.y : 0;
    u->wall0 = seconds(CLOCK_MONOTONIC);
    u->channels = p->coded ? 1 : p->frames[unit->frame].depth ? 4 : 3;
    u->team = new_team(u);
    if (!u->team) {
        free_active(u);
        return NULL;
    }
    return u;
}

/* --- strict units --- */

/* Time that threads have nothing to do, while units of theirs wait. */
static void
settle_waits_locked(struct pool *p)
{
    double now, waited;

    if (!p->strict)
        return;
    now = seconds(CLOCK_MONOTONIC);
    waited = p->waits ? p->idle * (now - p->waits_at) : 0;
    p->busy_s += waited;
    p->wait_s += waited;
    p->waits = strict_waits(p->strict);
    p->waits_at = now;
}

/* Do what the machine wants of a pass, and tell it how far it is. */
static void
look_locked(struct pool *p)
{
    for (struct active *u = p->active; u; u = u->next)
        if (u->pass)
            strict_look(p->strict, u->pass, u->team);
}

/* Something changed: there may be work, and something to say. */
static void
strict_changed_locked(struct pool *p)
{
    look_locked(p);
    /* what a bottom made true may have ended another pass */
    look_locked(p);
    settle_waits_locked(p);
    uv_cond_broadcast(&p->work);
    uv_async_send(&p->async);
}

static void
on_bottom(void *arg)
{
    struct active *u = arg;

    uv_mutex_lock(&u->pool->mu);
    strict_changed_locked(u->pool);
    uv_mutex_unlock(&u->pool->mu);
}

/* All have left a pass: u->counts are the unit's if that is all of it. */
static void
end_pass_locked(struct active *u)
{
    struct pool *p = u->pool;
    struct msg_counts spent = u->counts;
    struct team_bottom b;
    int finished;

    spent.primary_rays = u->mode == TEAM_TRUTH ? team_primary(u->team) : 0;
    if (team_blocked(u->team, &finished)) {
        spent.primary_rays = 0; /* those that follow count them */
        strict_blocked(p->strict, u->pass, finished);
    }
    team_bottom(u->team, &b);
    u->pass->finished = finished;
    u->whole = strict_ended(p->strict, u->pass, team_done(u->team), b.pixels,
                            b.density, &spent, &u->counts);
    u->pass = NULL;
    strict_changed_locked(p);
}

/* --- work --- */

/* The last member has left. */
static void
leave_locked(struct active *u)
{
    struct pool *p = u->pool;
    struct active **at = &p->active;

    while (*at != u)
        at = &(*at)->next;
    *at = u->next;
    p->wait_s += team_waited(u->team);
    u->counts.wall_s = seconds(CLOCK_MONOTONIC) - u->wall0;
    u->counts.doubt.rough = u->rough.sum;
    u->counts.doubt.nrough = u->rough.n;
    if (u->pass)
        end_pass_locked(u);
    else
        u->whole = team_done(u->team);
}

/* What a thread's clocks said when it began with something. */
struct stint {
    double cpu, wall;
};

static struct stint
begin_stint(struct renderer *by)
{
    by->ctx.counts = (struct rad_counts){ 0 };
    return (struct stint){ seconds(CLOCK_THREAD_CPUTIME_ID),
                           seconds(CLOCK_MONOTONIC) };
}

/* Locks the pool, too, for what was counted meanwhile; returns the processor
 * time that it took [s]. */
static double
end_stint_and_lock(struct renderer *by, const struct stint *s)
{
    double cpu = seconds(CLOCK_THREAD_CPUTIME_ID) - s->cpu;
    double wall = seconds(CLOCK_MONOTONIC) - s->wall;

    uv_mutex_lock(&by->pool->mu);
    by->pool->busy_s += wall;
    return cpu;
}

/* Be a member of the unit's team until there is nothing left to begin. */
static void
work_on(struct renderer *by, struct active *u)
{
    struct pool *p = by->pool;
    struct stint stint = begin_stint(by);
    double cpu;
    bool last;

    team_work(u->team, &by->ctx);
    cpu = end_stint_and_lock(by, &stint);
    counted_add(&u->counts, &by->ctx.counts, cpu);
    last = --u->members == 0;
    if (last)
        leave_locked(u);
    uv_mutex_unlock(&p->mu);
    if (last)
        end_active(u);
}

/* What a thread finds to do: one of them. */
struct work {
    struct rad_seed *seed;
    struct estimating *estimate;
    struct active *help;
    struct queued *window;
    struct strict_pass *pass;
};

/* Where the rows of a pass's unit are. */
static struct pool_unit
unit_of_pass(const struct pool *p, const struct strict_pass *pass)
{
    const struct rad_frame *f = &p->frames[pass->frame];
    const struct rad_window all = { 0, 0, f->width, f->height };
    struct rad_quincunx q;
    int y, end;

    rad_frame_sampler(f, &all, &q);
    y = team_line_row(&q, pass->least - 1);
    end = rad_quincunx_base_row(&q, pass->last - 1) + 1;
    return (struct pool_unit){ .unit = pass->unit,
                               .attempt = pass->attempt,
                               .frame = pass->frame,
                               .window = { 0, y, f->width, end - y } };
}

/* Memory is out. */
static void
fail_begin(struct pool *p, const struct pool_unit *unit,
           struct strict_pass *pass)
{
    struct msg_counts none = { 0 };
    struct rad_error err = { 0 };

    rad_fail(&err, RAD_ENOMEM, "out of memory");
    send_failure(p, unit, &err);
    if (!pass)
        return;
    uv_mutex_lock(&p->mu);
    strict_ended(p->strict, pass, false, NULL, NULL, &none, NULL);
    uv_mutex_unlock(&p->mu);
}

/* Begin what was found. */
static struct active *
begin(struct pool *p, struct work *w)
{
    struct pool_unit unit =
        w->window ? w->window->unit : unit_of_pass(p, w->pass);
    struct active *u = new_active(p, &unit, w->pass);

    free(w->window);
    if (!u) {
        fail_begin(p, &unit, w->pass);
        return NULL;
    }
    u->members = 1;
    uv_mutex_lock(&p->mu);
    u->next = p->active;
    p->active = u;
    if (atomic_load(&p->stopping))
        team_stop(u->team);
    if (u->pass) {
        look_locked(p);           /* it may be stopped, or split, by now */
        uv_async_send(&p->async); /* others may wait for what it makes */
    }
    if (!p->todo)
        uv_cond_broadcast(&p->work); /* those who wait can help */
    uv_mutex_unlock(&p->mu);
    return u;
}

/* --- estimates --- */

static struct estimating *
find_estimate_locked(const struct pool *p)
{
    struct estimating *e = p->estimates;

    while (e && !estimate_open(e->estimate))
        e = e->next;
    return e;
}

/* The last member has left: it is for the loop. */
static void
end_estimate_locked(struct pool *p, struct estimating *e)
{
    struct estimating **at = &p->estimates;

    while (*at != e)
        at = &(*at)->next;
    *at = e->next;
    e->wall_s = seconds(CLOCK_MONOTONIC) - e->wall_s;
    e->next = p->estimated;
    p->estimated = e;
    uv_async_send(&p->async);
}

/* Take areas until there are none. */
static void
work_on_estimate(struct renderer *by, struct estimating *e)
{
    struct pool *p = by->pool;
    struct stint stint = begin_stint(by);
    double cpu;

    estimate_work(e->estimate, &by->ctx, &p->stopping);
    cpu = end_stint_and_lock(by, &stint);
    estimate_count(e->estimate, &by->ctx.counts, cpu);
    if (--e->members == 0 && !estimate_open(e->estimate))
        end_estimate_locked(p, e);
    uv_mutex_unlock(&p->mu);
}

/* Hand on what is done. */
static void
give_estimates(struct pool *p)
{
    struct estimating *e, *next;

    uv_mutex_lock(&p->mu);
    e = p->estimated;
    p->estimated = NULL;
    uv_mutex_unlock(&p->mu);
    for (; e; e = next) {
        next = e->next;
        e->fn(p->arg, e->estimate, e->wall_s);
        free(e);
    }
}

bool
pool_estimate(struct pool *p, struct estimate *estimate, pool_estimate_fn *fn)
{
    struct estimating *e = calloc(1, sizeof *e);

    if (!e)
        return false;
    e->estimate = estimate;
    e->fn = fn;
    e->wall_s = seconds(CLOCK_MONOTONIC);
    uv_mutex_lock(&p->mu);
    e->next = p->estimates;
    p->estimates = e;
    if (estimate_open(estimate))
        uv_cond_broadcast(&p->work);
    else
        end_estimate_locked(p, e); /* no areas */
    uv_mutex_unlock(&p->mu);
    return true;
}

static void
free_estimates(struct estimating *e)
{
    while (e) {
        struct estimating *next = e->next;

        estimate_free(e->estimate);
        free(e);
        e = next;
    }
}

/* --- seeding --- */

/* The last member has left what can be done now: on to the next, or that was
 * it.  Meanwhile nobody finds anything to begin. */
static void
go_on_seeding(struct pool *p, struct rad_seed *s)
{
    bool more = !atomic_load(&p->stopping) && rad_seed_next(s);

    uv_mutex_lock(&p->mu);
    if (!more) {
        p->seeded_one = s;
        p->seed = NULL;
        uv_async_send(&p->async);
    }
    uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
}

static void
work_on_seed(struct renderer *by, struct rad_seed *s)
{
    struct pool *p = by->pool;
    struct stint stint = begin_stint(by);
    double cpu;
    bool last;

    rad_seed_work(s, &by->ctx, &p->stopping);
    cpu = end_stint_and_lock(by, &stint);
    counted_add(&p->seeded, &by->ctx.counts, cpu);
    last = --p->seeding == 0 && !rad_seed_open(s);
    uv_mutex_unlock(&p->mu);
    if (last)
        go_on_seeding(p, s);
}

/* Tell of what is done. */
static void
end_seed(struct pool *p)
{
    struct rad_seed *s;
    pool_seed_fn *fn;

    uv_mutex_lock(&p->mu);
    s = p->seeded_one;
    fn = p->seed_fn;
    p->seeded_one = NULL;
    uv_mutex_unlock(&p->mu);
    if (!s)
        return;
    rad_seed_free(s);
    fn(p->arg);
}

void
pool_seed(struct pool *p, struct rad_seed *s, pool_seed_fn *fn)
{
    uv_mutex_lock(&p->mu);
    p->seed = s;
    p->seed_fn = fn;
    uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
}

/* --- threads --- */

/* A unit that has lines left to begin, in a pass as urgent as `least`. */
static struct active *
find_open_locked(const struct pool *p, enum strict_rank least)
{
    struct active *u = p->active;

    while (u && (u->rank > least || !team_open(u->team)))
        u = u->next;
    return u;
}

static struct queued *
take_queued_locked(struct pool *p)
{
    struct queued *q = p->todo;

    if (q) {
        p->todo = q->next;
        if (!p->todo)
            p->todo_end = &p->todo;
    }
    return q;
}

/* Strict work as urgent as `least`: to be begun, or helped with. */
static bool
find_strict_locked(struct pool *p, enum strict_rank least, struct work *w)
{
    if (p->strict && !(w->pass = strict_next(p->strict, least))) {
        w->help = find_open_locked(p, least);
        if (strict_error(p->strict) < 0)
            uv_async_send(&p->async);
    }
    return w->pass || w->help;
}

static bool
find_locked(struct pool *p, struct work *w)
{
    *w = (struct work){ 0 };
    if (p->seed) {
        /* what others are at is wanted for what comes next */
        if (!rad_seed_open(p->seed))
            return false;
        w->seed = p->seed;
        p->seeding++;
        return true;
    }
    if ((w->estimate = find_estimate_locked(p)))
        w->estimate->members++;
    else if (!find_strict_locked(p, STRICT_TRUTH, w) &&
             !(w->window = take_queued_locked(p)) &&
             !find_strict_locked(p, STRICT_LINES, w) &&
             !find_strict_locked(p, STRICT_AHEAD, w) &&
             !(w->help = find_open_locked(p, STRICT_AHEAD)))
        return false;
    if (w->help)
        w->help->members++;
    return true;
}

/* Wait for something to do; false when it is time to end. */
static bool
find_work(struct pool *p, struct work *w)
{
    bool found = false;

    uv_mutex_lock(&p->mu);
    while (!atomic_load(&p->stopping) && !(found = find_locked(p, w))) {
        settle_waits_locked(p);
        p->idle++;
        uv_cond_wait(&p->work, &p->mu);
        settle_waits_locked(p);
        p->idle--;
    }
    uv_mutex_unlock(&p->mu);
    return found;
}

static void
run_thread(void *arg)
{
    struct renderer *by = arg;
    struct work w;

    while (find_work(by->pool, &w)) {
        if (w.seed) {
            work_on_seed(by, w.seed);
            continue;
        }
        if (w.estimate) {
            work_on_estimate(by, w.estimate);
            continue;
        }
        if (!w.help)
            w.help = begin(by->pool, &w);
        if (w.help)
            work_on(by, w.help);
    }
}

static void
on_async(uv_async_t *async)
{
    struct pool *p = async->data;
    struct pool_rows *r, *next;

    uv_mutex_lock(&p->mu);
    r = p->done;
    p->done = NULL;
    p->done_end = &p->done;
    uv_mutex_unlock(&p->mu);
    end_seed(p);
    if (p->strict)
        p->news(p->arg);
    for (; r; r = next) {
        next = r->next;
        p->fn(p->arg, r);
        free(r);
    }
    give_estimates(p);
}

bool
pool_push(struct pool *p, const struct pool_unit *u)
{
    struct queued *q = calloc(1, sizeof *q);

    if (!q)
        return false;
    q->unit = *u;
    uv_mutex_lock(&p->mu);
    *p->todo_end = q;
    p->todo_end = &q->next;
    uv_cond_signal(&p->work);
    uv_mutex_unlock(&p->mu);
    return true;
}

struct strict *
pool_strict(struct pool *p)
{
    uv_mutex_lock(&p->mu);
    return p->strict;
}

void
pool_strict_done(struct pool *p)
{
    strict_changed_locked(p);
    uv_mutex_unlock(&p->mu);
}

uint64_t
pool_tick(struct pool *p, uint64_t now_ms)
{
    uint64_t due;

    uv_mutex_lock(&p->mu);
    look_locked(p);
    due = strict_tick(p->strict, now_ms);
    settle_waits_locked(p);
    if (p->idle > 0 && strict_has_work(p->strict))
        uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
    return due;
}

const struct msg *
pool_message(struct pool *p, bool room)
{
    const struct msg *m;

    uv_mutex_lock(&p->mu);
    m = p->strict ? strict_message(p->strict, room) : NULL;
    uv_mutex_unlock(&p->mu);
    return m;
}

int
pool_error(struct pool *p)
{
    int rc;

    uv_mutex_lock(&p->mu);
    rc = p->strict ? strict_error(p->strict) : 0;
    uv_mutex_unlock(&p->mu);
    return rc;
}

static bool
same_unit(const struct pool_unit *u, uint32_t unit, uint32_t attempt)
{
    return u->unit == unit && u->attempt == attempt;
}

void
pool_revoke(struct pool *p, uint32_t unit, uint32_t attempt)
{
    struct queued **at, *gone = NULL;

    uv_mutex_lock(&p->mu);
    for (at = &p->todo; *at; at = &(*at)->next)
        if (same_unit(&(*at)->unit, unit, attempt)) {
            gone = *at;
            *at = gone->next;
            if (!*at)
                p->todo_end = at;
            break;
        }
    for (struct active *u = p->active; u; u = u->next)
        if (!u->pass && same_unit(&u->unit, unit, attempt))
            team_stop(u->team);
    if (p->strict) {
        strict_revoke(p->strict, unit, attempt);
        strict_changed_locked(p);
    }
    uv_mutex_unlock(&p->mu);
    free(gone);
}

void
pool_sent(struct pool *p, size_t n)
{
    uv_mutex_lock(&p->mu);
    p->unsent -= n < p->unsent ? n : p->unsent;
    if (p->unsent <= POOL_UNSENT)
        uv_cond_broadcast(&p->room);
    uv_mutex_unlock(&p->mu);
}

struct pool_tally
pool_tally(struct pool *p)
{
    struct pool_tally t = { 0 };

    uv_mutex_lock(&p->mu);
    settle_waits_locked(p);
    t.busy_s = p->busy_s;
    t.wait_base_line_s = p->wait_s;
    t.seeded = p->seeded;
    if (p->strict) {
        t.rays_under_way = strict_rays(p->strict);
        strict_dropped(p->strict, &t.dropped);
    }
    for (const struct active *u = p->active; u; u = u->next) {
        t.wait_base_line_s += team_waited(u->team);
        t.rays_under_way += team_rays(u->team);
    }
    uv_mutex_unlock(&p->mu);
    return t;
}

/* Processor time of a thread. */
static double
used(const struct renderer *by)
{
    clockid_t clock;

    return pthread_getcpuclockid(by->thread, &clock) == 0 ? seconds(clock) : 0;
}

bool
pool_stuck(struct pool *p, double limit_s, int *x, int *y)
{
    bool stuck = false;

    for (int i = 0; i < p->nthreads && limit_s > 0 && !stuck; i++) {
        struct renderer *by = &p->renderers[i];
        uint64_t at = atomic_load_explicit(&by->ctx.at, memory_order_relaxed);
        double cpu = used(by);

        if (at != by->seen)
            by->seen_cpu = cpu;
        by->seen = at;
        stuck = at != 0 && cpu - by->seen_cpu > limit_s;
        *x = RAD_AT_X(at);
        *y = RAD_AT_Y(at);
    }
    return stuck;
}

static void
async_closed(uv_handle_t *h)
{
    struct pool *p = h->data;

    uv_mutex_destroy(&p->mu);
    uv_cond_destroy(&p->work);
    uv_cond_destroy(&p->room);
    free(p->renderers);
    free(p);
}

void
pool_free(struct pool *p)
{
    if (!p)
        return;
    uv_mutex_lock(&p->mu);
    atomic_store(&p->stopping, true);
    for (struct active *u = p->active; u; u = u->next)
        team_stop(u->team);
    uv_cond_broadcast(&p->work);
    uv_cond_broadcast(&p->room);
    uv_mutex_unlock(&p->mu);
    for (int i = 0; i < p->nthreads; i++) {
        uv_thread_join(&p->renderers[i].thread);
        rad_ctx_release(&p->renderers[i].ctx);
    }
    while (p->todo) {
        struct queued *q = p->todo;

        p->todo = q->next;
        free(q);
    }
    while (p->done) {
        struct pool_rows *r = p->done;

        p->done = r->next;
        free(r);
    }
    free_estimates(p->estimates);
    free_estimates(p->estimated);
    rad_seed_free(p->seed);
    rad_seed_free(p->seeded_one);
    uv_close((uv_handle_t *)&p->async, async_closed);
}

/* nthreads counts those that run, also when a later one does not start. */
static int
start_threads(struct pool *p, int nthreads, struct rad_error *err)
{
    for (int i = 0; i < nthreads; i++) {
        struct renderer *by = &p->renderers[i];
        int rc = rad_ctx_init(&by->ctx, p->job, err);

        if (rc < 0)
            return rc;
        by->pool = p;
        rc = uv_thread_create(&by->thread, run_thread, by);
        if (rc < 0) {
            rad_ctx_release(&by->ctx);
            return rad_fail(err, RAD_ENOMEM, "cannot start thread %d: %s", i,
                            uv_strerror(rc));
        }
        p->nthreads = i + 1;
    }
    return 0;
}

struct pool *
pool_new(uv_loop_t *loop, const struct rad_job *job,
         const struct rad_frame *frames, struct strict *strict, int nthreads,
         bool coded, pool_rows_fn *fn, pool_news_fn *news, void *arg,
         struct rad_error *err)
{
    struct pool *p = calloc(1, sizeof *p);

    if (p)
        p->renderers = calloc((size_t)nthreads, sizeof *p->renderers);
    if (!p || !p->renderers) {
        free(p);
        rad_fail(err, RAD_ENOMEM, "out of memory");
        return NULL;
    }
    p->job = job;
    p->frames = frames;
    p->strict = strict;
    p->coded = coded;
    p->fn = fn;
    p->news = news;
    p->arg = arg;
    p->todo_end = &p->todo;
    p->done_end = &p->done;
    uv_mutex_init(&p->mu);
    uv_cond_init(&p->work);
    uv_cond_init(&p->room);
    uv_async_init(loop, &p->async, on_async);
    p->async.data = p;
    if (start_threads(p, nthreads, err) < 0) {
        pool_free(p);
        return NULL;
    }
    return p;
}
