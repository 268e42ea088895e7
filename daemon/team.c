/* team.c - see team.h
 *
 * Lines are numbered as the sampler's base lines; line i stands for base line
 * i and the bar above it.  What a line needs from the one above:
 *   - its densities, up to a little ahead of where it is itself (`ready`);
 *   - at last, its pixels as they are in the picture, small sources painted,
 *     as the top of the bar (`painted`).
 * The bar's bottom is the line as it was sampled, before painting, as in
 * rpict; so a line keeps both.
 *
 * Lines are begun in order, and the lowest one that is not done waits for
 * nobody; so nobody waits for ever.  Buffers form a ring: line i is begun only
 * when line i - nlines + 1, the last to look at its buffers, is done and its
 * rows are handed on. */
#include "config.h"

#include "team.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <uv.h>

/* Looks at a number that is about to change before a thread goes to sleep. */
#define SPINS 200

/* A member adds its rays to the team's when so many are new: some ms of work,
 * so that members do not wait for each other's cache line. */
#define RAYS_UNTOLD 4096

struct line {
    uint8_t *density;          /* for the line below; written by its member */
    struct rad_pixel *sampled; /* written by its member */
    /* Densities that are final, stored after them; pairs with the load in
     * wait_for().  One more than all of them: the line is painted. */
    _Atomic size_t ready;
    bool done; /* [mu] and the bar above it */
};

struct team {
    const struct rad_frame *frame; /* [fixed] */
    struct rad_window window;      /* [fixed] */
    struct rad_quincunx sampler;   /* [fixed] but for trace and arg */
    size_t ndensity;               /* [fixed] */
    int nbases, nlines, nslots;    /* [fixed] */
    team_rows_fn *fn;              /* [fixed] */
    void *arg;                     /* [fixed] */
    uint8_t *density;              /* [fixed] above line 0, then the lines' */
    struct rad_pixel *pixels;      /* [fixed] the lines' and the slots' */
    struct rad_pixel *slots;       /* [fixed] row k in slot k modulo nslots */
    struct line *lines;            /* [fixed] line i is number i % nlines */
    uv_mutex_t mu;
    uv_cond_t moved;       /* with ready, finished and stopped */
    int begun;             /* [mu] lines */
    int finished;          /* [mu] lines whose rows, and all above, are out */
    bool handing_on;       /* [mu] a member hands rows on */
    double waited_s;       /* [mu] in wait_for() */
    _Atomic uint64_t rays; /* relaxed: shown, never decided on */
    _Atomic int waiting;   /* threads in or about to be in uv_cond_wait() */
    _Atomic bool stopped;  /* relaxed where it only ends work earlier */
};

/* One member at work on one line. */
struct member {
    struct team *team;
    struct rad_ctx *ctx;
    struct rad_quincunx q;
    int i;
    uint64_t told; /* of ctx->counts.rays */
};

static struct line *
line_at(const struct team *t, int i)
{
    return &t->lines[i % t->nlines];
}

static struct rad_pixel *
row_at(const struct team *t, int row)
{
    return t->slots + (size_t)(row % t->nslots) * (size_t)t->window.width;
}

static void
trace(void *arg, int x, int y, struct rad_pixel *out)
{
    const struct member *m = arg;

    rad_frame_pixel(m->team->frame, m->ctx, x, y, out);
}

static bool
is_stopped(const struct team *t)
{
    return atomic_load_explicit(&t->stopped, memory_order_relaxed);
}

static void
wake(struct team *t)
{
    uv_mutex_lock(&t->mu);
    uv_cond_broadcast(&t->moved);
    uv_mutex_unlock(&t->mu);
}

/* The order of store and load here, and of add and load in wait_for(), is what
 * keeps a waker from missing a sleeper: both are sequentially consistent. */
static void
publish(struct team *t, struct line *l, size_t ready)
{
    atomic_store(&l->ready, ready);
    if (atomic_load(&t->waiting) > 0)
        wake(t);
}

/* Wait until `need` of the line's densities are final; false: stopped. */
static bool
wait_for(struct team *t, struct line *l, size_t need)
{
    uint64_t begin;

    for (int spin = 0; spin < SPINS; spin++)
        if (atomic_load(&l->ready) >= need)
            return true;
    begin = uv_hrtime();
    uv_mutex_lock(&t->mu);
    atomic_fetch_add(&t->waiting, 1);
    while (atomic_load(&l->ready) < need && !is_stopped(t))
        uv_cond_wait(&t->moved, &t->mu);
    atomic_fetch_sub(&t->waiting, 1);
    t->waited_s += 1e-9 * (double)(uv_hrtime() - begin);
    uv_mutex_unlock(&t->mu);
    return !is_stopped(t);
}

/* Let others see the rays that are new, if there are so many. */
static void
tell_rays(struct member *m, uint64_t least)
{
    uint64_t n = m->ctx->counts.rays - m->told;

    if (n < least)
        return;
    m->told += n;
    atomic_fetch_add_explicit(&m->team->rays, n, memory_order_relaxed);
}

static void
paint(const struct member *m, int row)
{
    const struct rad_window *w = &m->team->window;

    rad_frame_paint_row(m->team->frame, m->ctx, w->x, w->x + w->width,
                        w->y + row, row_at(m->team, row));
}

/* Densities of the line above that the next step reads.  The last step of a
 * line takes over what lies beyond its own. */
static size_t
needed(const struct member *m, const struct rad_quincunx_line *s)
{
    size_t n = rad_quincunx_line_needs(s);

    if (n == 0)
        return 0;
    if (n > m->team->ndensity || m->q.width - 1 - s->x <= m->q.xstep)
        n = m->team->ndensity;
    return n;
}

/* Sample base line i; false: stopped. */
static bool
sample_line(struct member *m)
{
    struct team *t = m->team;
    struct line *l = line_at(t, m->i);
    const uint8_t *above = NULL;
    struct rad_quincunx_line s;

    if (t->ndensity > 0)
        above = m->i > 0 ? line_at(t, m->i - 1)->density : t->density;
    rad_quincunx_line_start(&s, &m->q, m->i, above, l->density, l->sampled);
    do {
        size_t need = needed(m, &s);

        if (s.ndensity > 0)
            publish(t, l, s.ndensity);
        tell_rays(m, RAYS_UNTOLD);
        if (is_stopped(t) ||
            (m->i > 0 && need > 0 && !wait_for(t, line_at(t, m->i - 1), need)))
            return false;
    } while (rad_quincunx_line_step(&s));
    return true;
}

/* Put the line into the picture. */
static void
show_line(struct member *m)
{
    struct team *t = m->team;
    struct line *l = line_at(t, m->i);
    int row = rad_quincunx_base_row(&m->q, m->i);

    memcpy(row_at(t, row), l->sampled,
           (size_t)t->window.width * sizeof *l->sampled);
    paint(m, row);
    publish(t, l, t->ndensity + 1);
}

/* Fill the bar above base line i; false: stopped. */
static bool
fill_bar(struct member *m)
{
    struct team *t = m->team;
    struct rad_pixel *rows[RAD_QUINCUNX_MAX_YSTEP + 1];
    int top = rad_quincunx_base_row(&m->q, m->i - 1);
    int n = rad_quincunx_base_row(&m->q, m->i) - top;

    if (!wait_for(t, line_at(t, m->i - 1), t->ndensity + 1))
        return false;
    for (int k = 0; k < n; k++)
        rows[k] = row_at(t, top + k);
    rows[n] = line_at(t, m->i)->sampled;
    rad_quincunx_bar(&m->q, m->i - 1, rows);
    for (int k = 1; k < n; k++)
        paint(m, top + k);
    return true;
}

/* Hand on the rows of line i: its bar's and its own. */
static void
hand_on(struct team *t, int i)
{
    int end = rad_quincunx_base_row(&t->sampler, i) + 1;
    int row = i > 0 ? rad_quincunx_base_row(&t->sampler, i - 1) + 1 : 0;

    for (; row < end; row++)
        t->fn(t->arg, row, row_at(t, row));
}

/* Line i is done.  If it was the one that all others waited to come after,
 * hand on what is complete, unless another member is at it. */
static void
finish_line(struct team *t, int i)
{
    uv_mutex_lock(&t->mu);
    line_at(t, i)->done = true;
    if (!t->handing_on) {
        t->handing_on = true;
        while (t->finished < t->begun && line_at(t, t->finished)->done) {
            uv_mutex_unlock(&t->mu);
            hand_on(t, t->finished);
            uv_mutex_lock(&t->mu);
            t->finished++;
            uv_cond_broadcast(&t->moved);
        }
        t->handing_on = false;
    }
    uv_mutex_unlock(&t->mu);
}

/* The next line to begin, once its buffers are free; -1: there is none. */
static int
begin_line(struct team *t)
{
    int i = -1;

    uv_mutex_lock(&t->mu);
    while (t->begun < t->nbases && t->begun > t->finished + t->nlines - 2 &&
           !is_stopped(t))
        uv_cond_wait(&t->moved, &t->mu);
    if (t->begun < t->nbases && !is_stopped(t)) {
        i = t->begun++;
        line_at(t, i)->done = false;
        atomic_store(&line_at(t, i)->ready, 0);
    }
    uv_mutex_unlock(&t->mu);
    return i;
}

void
team_work(struct team *t, struct rad_ctx *ctx)
{
    struct member m = { .team = t, .ctx = ctx, .q = t->sampler };

    m.told = ctx->counts.rays;
    m.q.trace = trace;
    m.q.arg = &m;
    while ((m.i = begin_line(t)) >= 0) {
        if (!sample_line(&m))
            return;
        show_line(&m);
        if (m.i > 0 && !fill_bar(&m))
            return;
        tell_rays(&m, 1);
        finish_line(t, m.i);
    }
}

bool
team_open(struct team *t)
{
    bool open;

    uv_mutex_lock(&t->mu);
    open = t->begun < t->nbases && !is_stopped(t);
    uv_mutex_unlock(&t->mu);
    return open;
}

void
team_stop(struct team *t)
{
    atomic_store(&t->stopped, true);
    wake(t);
}

uint64_t
team_rays(const struct team *t)
{
    return atomic_load_explicit(&t->rays, memory_order_relaxed);
}

double
team_waited(struct team *t)
{
    double s;

    uv_mutex_lock(&t->mu);
    s = t->waited_s;
    uv_mutex_unlock(&t->mu);
    return s;
}

bool
team_done(const struct team *t)
{
    return t->finished == t->nbases;
}

/* Every buffer; the lines' densities and pixels lie one after the other. */
static bool
make_buffers(struct team *t)
{
    size_t width = (size_t)t->window.width, n = (size_t)t->nlines;

    t->lines = calloc(n, sizeof *t->lines);
    t->density = calloc(n + 1, t->ndensity + 1);
    t->pixels = calloc((n + (size_t)t->nslots) * width, sizeof *t->pixels);
    if (!t->lines || !t->density || !t->pixels)
        return false;
    for (size_t i = 0; i < n; i++) {
        t->lines[i].density = t->density + (i + 1) * (t->ndensity + 1);
        t->lines[i].sampled = t->pixels + i * width;
    }
    t->slots = t->pixels + n * width;
    return true;
}

struct team *
team_new(const struct rad_frame *f, const struct rad_window *w, int nthreads,
         team_rows_fn *fn, void *arg)
{
    struct team *t = calloc(1, sizeof *t);

    if (!t)
        return NULL;
    uv_mutex_init(&t->mu);
    uv_cond_init(&t->moved);
    t->frame = f;
    t->window = *w;
    t->fn = fn;
    t->arg = arg;
    t->sampler = (struct rad_quincunx){ .x0 = w->x,
                                        .y0 = w->y,
                                        .width = w->width,
                                        .height = w->height,
                                        .maxdiff = f->job->params.maxdiff,
                                        .depth = f->depth };
    rad_quincunx_steps(f->job->params.psample, &t->sampler.xstep,
                       &t->sampler.ystep);
    t->ndensity = rad_quincunx_ndensity(&t->sampler);
    t->nbases = rad_quincunx_nbases(&t->sampler);
    /* each member's line, one above the first and one to begin meanwhile */
    t->nlines = 2 * nthreads + 2;
    t->nslots = t->nlines * t->sampler.ystep + 1;
    if (!make_buffers(t)) {
        team_free(t);
        return NULL;
    }
    if (t->ndensity > 0)
        rad_quincunx_start(&t->sampler, t->density);
    return t;
}

void
team_free(struct team *t)
{
    if (!t)
        return;
    uv_mutex_destroy(&t->mu);
    uv_cond_destroy(&t->moved);
    free(t->lines);
    free(t->density);
    free(t->pixels);
    free(t);
}
