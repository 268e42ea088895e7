/* trial.c - see trial.h; trial_predict.c says what the measurements are for */
#include "config.h"

#include "trial/trial.h"

#include "light/indirect/ambtile.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

enum { FIRST = 64, MOST_WINDOWS = 32, RECORDS = 64 };

/* Shares of the windows' pixels that are made again, in even areas and at
 * places. */
#define AREAS_TRIED  (1. / 450)
#define PLACES_TRIED (1. / 1500)

/* Processor time of a trial, roughly, and its least numbers of strewn pixels
 * and of windows.  With fewer it tells little, so these are traced however long
 * they take. */
static const double SECONDS = 3;
enum { LEAST_PIXELS = 256, LEAST_WINDOWS = 4, SIDE = 64 };

static double
cpu_seconds(void)
{
    struct timespec t;

    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double
peak_bytes(void)
{
    struct rusage u;

    getrusage(RUSAGE_SELF, &u);
    return 1024. * (double)u.ru_maxrss;
}

/* The k-th place of a sequence that covers n by m evenly (Roberts 2018, R2). */
static void
place(long k, int n, int m, int *x, int *y)
{
    double g = 1.32471795724474602596, u, v;

    u = .5 + (double)k / g;
    v = .5 + (double)k / (g * g);
    *x = (int)(n * (u - floor(u)));
    *y = (int)(m * (v - floor(v)));
}

/* A job, a frame of it and a thread's context. */
struct stand {
    struct rad_job *job;
    struct rad_frame frame;
    struct rad_ctx ctx;
    struct rad_ambtile tile; /* of a frozen cache: the records that are made
                              * until it ends */
};

static void
stand_release(struct stand *s)
{
    rad_ambtile_end(&s->tile, &s->ctx);
    rad_ctx_release(&s->ctx);
    rad_frame_release(&s->frame);
    rad_job_free(s->job);
}

static bool
is_frozen(const struct stand *s)
{
    return s->job->ambient && rad_ambient_is_frozen(s->job->ambient);
}

/* Begin a tile of a frozen cache. */
static void
make_records(struct stand *s)
{
    if (is_frozen(s))
        rad_ambtile_begin(&s->tile, &s->ctx, 0, NULL);
}

static int
stand_init(struct stand *s, const struct trial_scene *scene,
           const struct rad_params *params, struct rad_error *err)
{
    int rc = 0;

    s->job = rad_job_new(scene->scene, params, scene->files, err);
    if (!s->job)
        return err->code;
    if (scene->points)
        rad_frame_of_points(&s->frame, s->job, scene->points);
    else
        rc = rad_frame_init(&s->frame, s->job, scene->view, 0, false, err);
    s->frame.oversample = scene->oversample;
    if (rc == 0 && (rc = rad_ctx_init(&s->ctx, s->job, err)) < 0)
        rad_frame_release(&s->frame);
    if (rc < 0) {
        rad_job_free(s->job);
        return rc;
    }
    s->tile = (struct rad_ambtile){ .own = NULL };
    if (scene->passes && s->job->ambient)
        rad_ambient_freeze(s->job->ambient);
    make_records(s);
    return 0;
}

/* End the tile: its records go into the frozen cache; with `smooth` pixels see
 * smoothed values.  Does nothing to a live cache. */
static int
keep_records(struct stand *s, bool smooth, struct rad_error *err)
{
    struct rad_ambient *amb = s->job->ambient;
    struct rad_ambrec rec[RECORDS];
    uint64_t cursor = 0;
    bool ok = !s->tile.failed;
    size_t n;

    if (!s->ctx.tile)
        return 0;
    while ((n = rad_ambtile_list(&s->tile, &cursor, rec, RECORDS)) > 0)
        rad_ambient_insert_all(amb, rec, n);
    rad_ambtile_end(&s->tile, &s->ctx);
    ok = ok && rad_ambient_settle(amb) && (!smooth || rad_ambient_smooth(amb));
    return ok ? 0 : rad_fail_memory(err);
}

static struct trial_step
look(long n, const struct rad_ctx *ctx, double begin)
{
    return (struct trial_step){ .pixels = (double)n,
                                .rays = (double)ctx->counts.rays,
                                .records = (double)ctx->counts.ambient_values,
                                .cpu_s = cpu_seconds() - begin };
}

static void
trace_place(const struct rad_frame *f, struct rad_ctx *ctx, long k)
{
    struct rad_pixel out;
    int x, y;

    place(k, f->width, f->height, &x, &y);
    rad_frame_pixel(f, ctx, x, y, &out);
}

/* Trace pixels all over the picture, until most of SECONDS are over or a fair
 * part of the pixels is traced. */
static int
try_pixels(struct trial *t, struct stand *s, struct rad_error *err)
{
    double begin = cpu_seconds(), seconds = .6 * SECONDS;
    long most = (long)s->frame.width * s->frame.height / 4 + 1;
    long next = FIRST, n = 0;
    int rc = 0;

    while (rc == 0 && n < most && t->nsteps < 39 &&
           (n < LEAST_PIXELS || cpu_seconds() - begin < seconds)) {
        trace_place(&s->frame, &s->ctx, ++n);
        if (n == next) {
            if ((rc = keep_records(s, false, err)) == 0)
                make_records(s);
            t->step[t->nsteps++] = look(n, &s->ctx, begin);
            next *= 2;
        }
    }
    if (t->nsteps == 0 || t->step[t->nsteps - 1].pixels < (double)n)
        t->step[t->nsteps++] = look(n, &s->ctx, begin);
    return rc < 0 ? rc : keep_records(s, true, err);
}

/* The part of a window that is sampled as densely as the top of a picture,
 * because nothing is known of the lines above: its upper half, with whole bars.
 */
static struct rad_window
dense_part(const struct rad_frame *f, const struct rad_window *w)
{
    struct rad_window upper = *w;
    int xstep, ystep;

    rad_quincunx_steps(f->job->params.psample, &xstep, &ystep);
    if (w->height / 2 > ystep)
        upper.height = (w->height - 1) / 2 / ystep * ystep + 1;
    return upper;
}

/* The number of pixels, of `most`, at most `side`, that whole steps and the
 * sample at their end take. */
static int
whole_steps(int most, int side, int step)
{
    return most <= side ? most : (side - 1) / step * step + 1;
}

/* The pixels that the samples of a window stand for: it has a first and a last
 * column of samples, and windows beside each other would share them. */
static double
pixels_of(const struct rad_frame *f, const struct rad_window *w)
{
    int xstep, ystep;

    rad_quincunx_steps(f->job->params.psample, &xstep, &ystep);
    return (w->width + (w->width < f->width ? .5 * (xstep - 1) : 0)) *
           w->height;
}

/* The part of the samples in a window's upper half that is usual: a picture has
 * a top as dense once, above as many windows as it is high. */
static double
usual_share(const struct rad_frame *f, const struct rad_window *w,
            const struct rad_window *upper)
{
    return upper->height < w->height ? (double)(w->height - upper->height) /
                                           (f->height - upper->height)
                                     : 1;
}

/* Trace the upper half of a window again, with all records in the cache. */
static int
again(struct trial *t, struct stand *s, const struct rad_window *w,
      struct rad_pixel **rows)
{
    struct rad_counts before = s->ctx.counts;
    struct rad_window upper = dense_part(&s->frame, w);
    double begin = cpu_seconds(), primary, unusual;
    int rc = rad_frame_window(&s->frame, &s->ctx, &upper, rows);

    primary = (double)(s->ctx.counts.primary_rays - before.primary_rays);
    t->again_cpu_s += cpu_seconds() - begin;
    t->again_primary += primary;
    t->again_rays += (double)(s->ctx.counts.rays - before.rays);
    unusual = 1 - usual_share(&s->frame, w, &upper);
    t->usual_pixels -= unusual * pixels_of(&s->frame, &upper);
    t->usual_primary -= unusual * primary;
    s->ctx.counts = before;
    return rc;
}

/* Make some of a window's pixels again, to estimate the error. */
static int
look_again(struct trial *t, struct stand *s, const struct rad_window *w,
           struct rad_pixel **rows)
{
    const struct rad_doubt_share share = { AREAS_TRIED, PLACES_TRIED };
    const struct rad_doubt_rows shown = {
        &s->frame, w->x,      w->y,
        w->width,  w->height, (const struct rad_pixel *const *)rows
    };
    struct rad_counts before = s->ctx.counts;
    int rc = 0;

    if (is_frozen(s)) /* its pixels with smoothed records */
        rc = rad_frame_window(&s->frame, &s->ctx, w, rows);
    if (rc == 0)
        rad_doubt_look_at_window(&shown, &s->ctx, &share, NULL, &t->doubt);
    s->ctx.counts = before;
    return rc;
}

static int
try_window(struct trial *t, struct stand *s, const struct rad_window *w,
           struct rad_pixel **rows, struct rad_error *err)
{
    struct rad_counts before = s->ctx.counts;
    double begin = cpu_seconds(), primary;
    int rc;

    make_records(s);
    rc = rad_frame_window(&s->frame, &s->ctx, w, rows);
    t->cpu_s += cpu_seconds() - begin;
    if (rc < 0 || (rc = keep_records(s, true, err)) < 0)
        return rc;
    primary = (double)(s->ctx.counts.primary_rays - before.primary_rays);
    t->pixels += (double)w->width * w->height;
    t->primary += primary;
    t->usual_pixels += pixels_of(&s->frame, w);
    t->usual_primary += primary;
    t->rays += (double)(s->ctx.counts.rays - before.rays);
    t->records +=
        (double)(s->ctx.counts.ambient_values - before.ambient_values);
    rc = look_again(t, s, w, rows);
    return rc < 0 ? rc : again(t, s, w, rows);
}

/* Windows that cover a picture evenly, to its edges. */
struct grid {
    int columns, rows; /* of windows */
    int leap;          /* from window to window, so that the first few are
                        * spread: no factor of it divides their number */
    struct rad_window window;
};

static int
common_factor(int a, int b)
{
    return b == 0 ? a : common_factor(b, a % b);
}

static struct grid
lay_grid(const struct rad_frame *f)
{
    const double golden = .61803398874989485;
    struct grid g = { 0 };
    int xstep, ystep, n;

    rad_quincunx_steps(f->job->params.psample, &xstep, &ystep);
    g.window.width = whole_steps(f->width, SIDE, xstep);
    g.window.height = whole_steps(f->height, SIDE, ystep);
    g.columns = (f->width + g.window.width - 1) / g.window.width;
    g.rows = (f->height + g.window.height - 1) / g.window.height;
    n = g.columns * g.rows;
    for (g.leap = (int)(golden * n) + 1; common_factor(n, g.leap) > 1;)
        g.leap++;
    return g;
}

/* Where window i of n begins, in a picture of that size. */
static int
begin_of(int i, int n, int size, int side)
{
    return n > 1 ? (int)((double)i * (size - side) / (n - 1)) : 0;
}

/* The k-th window to be tried. */
static const struct rad_window *
window_at(struct grid *g, const struct rad_frame *f, int k)
{
    int n = g->columns * g->rows;
    int at = (int)(((int64_t)k * g->leap + n / 2) % n);
    struct rad_window *w = &g->window;

    w->x = begin_of(at % g->columns, g->columns, f->width, w->width);
    w->y = begin_of(at / g->columns, g->rows, f->height, w->height);
    return w;
}

static int
try_windows(struct trial *t, struct stand *s, struct rad_error *err)
{
    int n, rc = 0;
    struct rad_pixel *pixels = malloc(sizeof *pixels * SIDE * SIDE);
    struct rad_pixel *rows[SIDE];
    struct grid g = lay_grid(&s->frame);
    double begin = cpu_seconds(), seconds = .4 * SECONDS;

    if (!pixels)
        return rad_fail_memory(err);
    for (int i = 0; i < SIDE; i++)
        rows[i] = pixels + SIDE * i;
    n = g.columns * g.rows < MOST_WINDOWS ? g.columns * g.rows : MOST_WINDOWS;
    for (int k = 0; rc == 0 && k < n; k++) {
        if (k >= LEAST_WINDOWS && cpu_seconds() - begin > seconds)
            break;
        rc = try_window(t, s, window_at(&g, &s->frame, k), rows, err);
    }
    free(pixels);
    return rc;
}

int
trial_run(struct trial *t, const struct trial_scene *scene,
          const struct rad_params *params, struct rad_error *err)
{
    struct rad_params tried = *params;
    double begin = cpu_seconds();
    struct stand s;
    int rc;

    memset(t, 0, sizeof *t);
    if (params->ambacc > 0 && params->ambounce > TRIAL_BOUNCES)
        tried.ambounce = TRIAL_BOUNCES;
    if ((rc = stand_init(&s, scene, &tried, err)) < 0)
        return rc;
    t->load_s = cpu_seconds() - begin;
    if ((rc = try_pixels(t, &s, err)) == 0)
        rc = try_windows(t, &s, err);
    t->peak_bytes = peak_bytes();
    stand_release(&s);
    return rc;
}
