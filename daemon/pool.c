/* pool.c - see pool.h
 *
 * A thread keeps only as many rows of its unit as the sampler still needs and
 * as wait to be sent: row k of the unit lies in slot k modulo `slots`.  When
 * the sampler asks whether to stop, the rows above the current base line are
 * done and go into a piece as soon as there are enough of them. */
#include "config.h"

#include "pool.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* rows are sent when so many bytes of them are done */
#define PIECE_BYTES (64u << 10)

struct queued {
    struct queued *next;
    struct pool_unit unit;
};

struct renderer {
    struct pool *pool;
    uv_thread_t thread;
    struct rad_ctx ctx;
    _Atomic bool cancel;   /* relaxed: one bar more or less does not matter */
    bool busy;             /* [pool->mu] */
    struct pool_unit unit; /* [pool->mu] while busy; written by its thread */
};

struct pool {
    const struct rad_job *job;      /* [fixed] */
    const struct rad_frame *frames; /* [fixed] */
    int nthreads;                   /* [fixed] after pool_new() */
    struct renderer *renderers;     /* [fixed] */
    pool_rows_fn *fn;               /* [fixed] */
    void *arg;                      /* [fixed] */
    uv_async_t async;
    uv_mutex_t mu;
    uv_cond_t work;              /* with todo and stopping */
    uv_cond_t room;              /* with unsent and stopping */
    struct queued *todo;         /* [mu] */
    struct queued **todo_end;    /* [mu] */
    struct pool_rows *done;      /* [mu] */
    struct pool_rows **done_end; /* [mu] */
    size_t unsent;               /* [mu] bytes of pixels under way */
    double busy_s;               /* [mu] */
    _Atomic bool stopping;       /* written with mu held; read anywhere */
};

/* What one unit is rendered with. */
struct rendering {
    struct renderer *by;
    const struct pool_unit *unit;
    struct rad_pixel *slots; /* nslots * width */
    int nslots, channels;
    int sent;       /* rows that are in pieces */
    int piece_rows; /* rows that make a piece */
    bool failed;    /* memory is out */
    struct rad_counts before;
    double cpu0, wall0;
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

static void
copy_row(float *to, const struct rad_pixel *from, int width, int channels)
{
    for (int x = 0; x < width; x++, to += channels) {
        to[0] = from[x].L.r;
        to[1] = from[x].L.g;
        to[2] = from[x].L.b;
        if (channels == 4)
            to[3] = from[x].z;
    }
}

static void
fill_counts(const struct rendering *r, struct msg_counts *out)
{
    const struct rad_counts *a = &r->before, *b = &r->by->ctx.counts;

    out->rays = b->rays - a->rays;
    out->primary_rays = b->primary_rays - a->primary_rays;
    out->shadow_rays = b->shadow_rays - a->shadow_rays;
    out->ambient_rays = b->ambient_rays - a->ambient_rays;
    out->paint_rays = b->paint_rays - a->paint_rays;
    out->intersection_tests = b->geom.tests - a->geom.tests;
    out->ambient_values = b->ambient_values - a->ambient_values;
    out->nan_pixels = b->nan_pixels - a->nan_pixels;
    out->cpu_s = seconds(CLOCK_THREAD_CPUTIME_ID) - r->cpu0;
    out->wall_s = seconds(CLOCK_MONOTONIC) - r->wall0;
}

/* Put the rows up to `end` into a piece. */
static void
send_rows(struct rendering *r, int end, bool last)
{
    int width = r->unit->window.width, n = end - r->sent;
    size_t row = (size_t)width * (size_t)r->channels;
    size_t bytes = (size_t)n * row * sizeof(float);
    struct pool_rows *p = calloc(1, sizeof *p + bytes);

    if (!p) {
        r->failed = true;
        return;
    }
    p->unit = *r->unit;
    p->row = (uint32_t)r->sent;
    p->rows = (uint32_t)n;
    p->channels = r->channels;
    p->last = last;
    for (int k = 0; k < n; k++)
        copy_row(p->pixels + (size_t)k * row,
                 r->slots + (size_t)((r->sent + k) % r->nslots) * (size_t)width,
                 width, r->channels);
    if (last)
        fill_counts(r, &p->counts);
    r->sent = end;
    put_done(r->by->pool, p, bytes);
}

/* Between bars: send what is done, see whether to go on. */
static bool
between_bars(void *arg, int rows_done)
{
    struct rendering *r = arg;
    struct renderer *by = r->by;

    if (atomic_load_explicit(&by->cancel, memory_order_relaxed) ||
        atomic_load(&by->pool->stopping))
        return true;
    while (rows_done - r->sent >= r->piece_rows && !r->failed)
        send_rows(r, r->sent + r->piece_rows, false);
    return r->failed;
}

static void
send_failure(struct rendering *r, const struct rad_error *err)
{
    struct pool_rows *p = calloc(1, sizeof *p);

    if (!p)
        abort(); /* the unit would never end */
    p->unit = *r->unit;
    p->err = *err;
    put_done(r->by->pool, p, 0);
}

/* The rest of a unit, in pieces that fit a message. */
static void
send_rest(struct rendering *r)
{
    int height = r->unit->window.height;

    while (height - r->sent > r->piece_rows && !r->failed)
        send_rows(r, r->sent + r->piece_rows, false);
    if (!r->failed)
        send_rows(r, height, true);
}

static int
render_window(struct rendering *r, struct rad_error *err)
{
    struct renderer *by = r->by;
    const struct rad_window *w = &r->unit->window;
    const struct rad_frame *f = &by->pool->frames[r->unit->frame];
    struct rad_pixel **rows = calloc((size_t)w->height, sizeof *rows);
    int xstep, ystep, rc;

    rad_quincunx_steps(by->pool->job->params.psample, &xstep, &ystep);
    r->channels = f->depth ? 4 : 3;
    r->piece_rows = (int)(PIECE_BYTES / ((size_t)w->width * sizeof(float) *
                                         (size_t)r->channels)) +
                    1;
    r->nslots = r->piece_rows + ystep + 1;
    if (r->nslots > w->height)
        r->nslots = w->height;
    r->slots = calloc((size_t)r->nslots * (size_t)w->width, sizeof *r->slots);
    if (!rows || !r->slots) {
        free(rows);
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    }
    for (int k = 0; k < w->height; k++)
        rows[k] = r->slots + (size_t)(k % r->nslots) * (size_t)w->width;
    rc = rad_frame_window(f, &by->ctx, w, rows, between_bars, r);
    if (rc == 0)
        send_rest(r);
    if (r->failed)
        rc = rad_fail(err, RAD_ENOMEM, "out of memory");
    else if (rc < 0 && rc != RAD_ETEMPFAIL)
        rad_fail(err, rc, "cannot render unit %u", r->unit->unit);
    free(rows);
    return rc;
}

static void
render_unit(struct renderer *by)
{
    struct rendering r = { .by = by,
                           .unit = &by->unit,
                           .before = by->ctx.counts,
                           .cpu0 = seconds(CLOCK_THREAD_CPUTIME_ID),
                           .wall0 = seconds(CLOCK_MONOTONIC) };
    struct rad_error err = { 0 };
    int rc = render_window(&r, &err);
    double wall = seconds(CLOCK_MONOTONIC) - r.wall0;

    if (rc < 0 && rc != RAD_ETEMPFAIL)
        send_failure(&r, &err);
    free(r.slots);
    uv_mutex_lock(&by->pool->mu);
    by->pool->busy_s += wall;
    by->busy = false;
    uv_mutex_unlock(&by->pool->mu);
}

/* Wait for a unit; false when it is time to end. */
static bool
take_unit(struct renderer *by)
{
    struct pool *p = by->pool;
    struct queued *q;

    uv_mutex_lock(&p->mu);
    while (!p->todo && !atomic_load(&p->stopping))
        uv_cond_wait(&p->work, &p->mu);
    q = atomic_load(&p->stopping) ? NULL : p->todo;
    if (q) {
        p->todo = q->next;
        if (!p->todo)
            p->todo_end = &p->todo;
        by->unit = q->unit;
        by->busy = true;
        atomic_store_explicit(&by->cancel, false, memory_order_relaxed);
    }
    uv_mutex_unlock(&p->mu);
    free(q);
    return q != NULL;
}

static void
run_thread(void *arg)
{
    struct renderer *by = arg;

    while (take_unit(by))
        render_unit(by);
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
    for (; r; r = next) {
        next = r->next;
        p->fn(p->arg, r);
        free(r);
    }
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
    for (int i = 0; i < p->nthreads; i++) {
        struct renderer *by = &p->renderers[i];

        if (by->busy && same_unit(&by->unit, unit, attempt))
            atomic_store_explicit(&by->cancel, true, memory_order_relaxed);
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

double
pool_busy(struct pool *p)
{
    double s;

    uv_mutex_lock(&p->mu);
    s = p->busy_s;
    uv_mutex_unlock(&p->mu);
    return s;
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
         const struct rad_frame *frames, int nthreads, pool_rows_fn *fn,
         void *arg, struct rad_error *err)
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
    p->fn = fn;
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
