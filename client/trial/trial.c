/* trial.c - see trial.h
 *
 * A pixel costs its rays and, until the cache is full, ambient records: the
 * first pixels of a picture take a hundred times as long as the last.  With t
 * the time (or the rays), n pixels and R records, t = a n + b R.  Here b is
 * fitted to the doublings of strewn pixels.  a is taken from windows, where the
 * sampler chooses the pixels and most records that they need exist.  Each
 * window is traced twice: the second time makes no records, so it tells a by
 * itself where a short trial has too few windows and pixels to tell a and b
 * apart.
 * The number of records grows evenly with the logarithm of the pixels once
 * every surface has some, for each doubling asks for records between those.
 * This was measured on an office, a drafting room and a box, from 256 pixels to
 * 260 000.  A fine cache of one bounce has not reached that after a trial;
 * there the number is taken from the windows. */
#include "config.h"

#include "trial/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

/* memory of a record, with its places in the cache [bytes] */
#define RECORD_BYTES 320.

/* With more samples of a hemisphere than SMALL_DIV and SMALL_SSAMP together, at
 * most LAST_FULL pixels are traced with all of them. */
enum {
    FIRST = 64,
    MOST_WINDOWS = 32,
    SMALL_DIV = 64,
    SMALL_SSAMP = 0,
    LAST_FULL = 256
};

/* With a cache a trial has at most MOST_BOUNCES.  In a trial a record has all
 * records made that its rays need, down to the last bounce, before it is done
 * itself, while passes make those by paths: with six bounces the first pixel of
 * a room with many objects would take minutes.  Each further bounce, up to the
 * last that matters, makes records take FURTHER times as much. */
enum { MOST_BOUNCES = 3, LAST_BOUNCE = 8 };
static const double FURTHER = 1.05;

/* Shares of the windows' pixels that are made again, in areas without contrast
 * and at places. */
#define AREAS_TRIED  (1. / 1000)
#define PLACES_TRIED (1. / 1500)

static bool
stopped(const struct trial_effort *e)
{
    return e->stop && atomic_load_explicit(e->stop, memory_order_relaxed);
}

static int
fail_stopped(struct rad_error *err)
{
    return rad_fail(err, RAD_ETEMPFAIL, "the trial was stopped");
}

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

/* Trace pixels all over the picture, until most of the effort's seconds are
 * over or a fair part of the pixels is traced. */
static void
try_pixels(struct trial *t, const struct rad_frame *f, struct rad_ctx *ctx,
           const struct trial_effort *e)
{
    double begin = cpu_seconds(), seconds = .6 * e->seconds;
    long most = (long)f->width * f->height / 4 + 1, next = FIRST, n = 0;
    long full = (long)t->full.pixels;

    while (n < most && t->nsteps < 39 && !stopped(e) &&
           (n < e->pixels || cpu_seconds() - begin < seconds)) {
        trace_place(f, ctx, ++n);
        if (n == full)
            t->small = look(n, ctx, begin);
        if (n == next) {
            t->step[t->nsteps++] = look(n, ctx, begin);
            next *= 2;
        }
    }
    if (t->nsteps == 0 || t->step[t->nsteps - 1].pixels < (double)n)
        t->step[t->nsteps++] = look(n, ctx, begin);
}

/* Trace a window again, with all records in the cache. */
static int
again(struct trial *t, const struct rad_frame *f, struct rad_ctx *ctx,
      const struct rad_window *w, struct rad_pixel **rows)
{
    struct rad_counts before = ctx->counts;
    double begin = cpu_seconds();
    int rc = rad_frame_window(f, ctx, w, rows);

    t->again_cpu_s += cpu_seconds() - begin;
    t->again_primary +=
        (double)(ctx->counts.primary_rays - before.primary_rays);
    t->again_rays += (double)(ctx->counts.rays - before.rays);
    ctx->counts = before;
    return rc;
}

/* Make some of a window's pixels again, to estimate the error. */
static void
look_again(struct trial *t, const struct rad_frame *f, struct rad_ctx *ctx,
           const struct rad_window *w, struct rad_pixel **rows)
{
    const struct rad_doubt_share share = { AREAS_TRIED, PLACES_TRIED };
    struct rad_counts before = ctx->counts;
    double begin = cpu_seconds();

    rad_doubt_look_at_window(f, ctx, w, (const struct rad_pixel *const *)rows,
                             &share, NULL, &t->doubt);
    t->look_cpu_s += cpu_seconds() - begin;
    ctx->counts = before;
}

static int
try_windows(struct trial *t, const struct rad_frame *f, struct rad_ctx *ctx,
            const struct trial_effort *e, struct rad_error *err)
{
    int side = e->side;
    struct rad_pixel *pixels = malloc(sizeof *pixels * (size_t)(side * side));
    struct rad_pixel *rows[TRIAL_SIDE];
    struct rad_window w = { .width = f->width < side ? f->width : side,
                            .height = f->height < side ? f->height : side };
    struct rad_counts before = ctx->counts;
    double begin = cpu_seconds(), seconds = .4 * e->seconds;
    int rc = 0;

    if (!pixels)
        return rad_fail_memory(err);
    for (int i = 0; i < side; i++)
        rows[i] = pixels + side * i;
    for (long k = 1; rc == 0 && k <= MOST_WINDOWS && !stopped(e); k++) {
        place(k, f->width - w.width + 1, f->height - w.height + 1, &w.x, &w.y);
        rc = rad_frame_window(f, ctx, &w, rows);
        if (rc == 0)
            look_again(t, f, ctx, &w, rows);
        if (rc == 0)
            rc = again(t, f, ctx, &w, rows);
        t->pixels += (double)w.width * w.height;
        if (k >= e->windows && cpu_seconds() - begin > seconds)
            break;
    }
    free(pixels);
    t->primary = (double)(ctx->counts.primary_rays - before.primary_rays);
    t->rays = (double)(ctx->counts.rays - before.rays);
    t->cpu_s = cpu_seconds() - begin - t->again_cpu_s - t->look_cpu_s;
    t->records = (double)(ctx->counts.ambient_values - before.ambient_values);
    return rc;
}

/* A job, a frame of it and a thread's context. */
struct stand {
    struct rad_job *job;
    struct rad_frame frame;
    struct rad_ctx ctx;
};

static void
stand_release(struct stand *s)
{
    rad_ctx_release(&s->ctx);
    rad_frame_release(&s->frame);
    rad_job_free(s->job);
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
        rad_frame_of_points(&s->frame, s->job, scene->points, 0);
    else
        rc = rad_frame_init(&s->frame, s->job, scene->view, 0, false, err);
    if (rc == 0 && (rc = rad_ctx_init(&s->ctx, s->job, err)) < 0)
        rad_frame_release(&s->frame);
    if (rc < 0)
        rad_job_free(s->job);
    return rc;
}

/* Trace the first pixels with full hemispheres. */
static int
try_full(struct trial *t, const struct trial_scene *scene,
         const struct rad_params *params, const struct trial_effort *e,
         struct rad_error *err)
{
    struct stand s;
    double begin;
    long n = 0;
    int rc = stand_init(&s, scene, params, err);

    if (rc < 0)
        return rc;
    begin = cpu_seconds();
    do
        trace_place(&s.frame, &s.ctx, ++n);
    while (n < LAST_FULL && !stopped(e) && cpu_seconds() - begin < e->seconds);
    t->full = look(n, &s.ctx, begin);
    stand_release(&s);
    return 0;
}

int
trial_run(struct trial *t, const struct trial_scene *scene,
          const struct rad_params *params, const struct trial_effort *effort,
          struct rad_error *err)
{
    struct rad_params tried = *params, small;
    struct trial_effort part = *effort;
    double begin;
    struct stand s;
    int rc = 0;

    memset(t, 0, sizeof *t);
    if (params->ambacc > 0 && params->ambounce > MOST_BOUNCES) {
        tried.ambounce = MOST_BOUNCES;
        t->untried = params->ambounce - MOST_BOUNCES;
    }
    small = tried;
    if (params->ambounce > 0 && params->ambacc > 0 &&
        params->ambdiv + params->ambssamp > SMALL_DIV + SMALL_SSAMP) {
        t->samples = (double)(params->ambdiv + params->ambssamp) /
                     (SMALL_DIV + SMALL_SSAMP);
        small.ambdiv = SMALL_DIV;
        small.ambssamp = SMALL_SSAMP;
        part.seconds /= 2;
        rc = try_full(t, scene, &tried, &part, err);
    }
    begin = cpu_seconds();
    if (rc < 0 || (rc = stand_init(&s, scene, &small, err)) < 0)
        return rc;
    t->load_s = cpu_seconds() - begin;
    try_pixels(t, &s.frame, &s.ctx, &part);
    rc = try_windows(t, &s.frame, &s.ctx, &part, err);
    if (rc == 0 && stopped(effort))
        rc = fail_stopped(err);
    t->peak_bytes = peak_bytes();
    stand_release(&s);
    return rc;
}

/* --- extrapolation --- */

/* Time or rays t of the strewn pixels are taken to be a n + b R, of n pixels
 * and R records, by least squares over the increments of each doubling,
 * relative to their size.  The first increment, which fills the cache, is left
 * out if there are others. */
struct sums {
    double nn, nr, rr, nt, rt;
};

static struct sums
sum_steps(const struct trial *t, bool time)
{
    struct sums m = { 0 };

    for (int i = t->nsteps > 3 ? 1 : 0; i < t->nsteps; i++) {
        struct trial_step zero = { 0, 0, 0, 0 };
        const struct trial_step *s = &t->step[i], *p = i ? s - 1 : &zero;
        double n = s->pixels - p->pixels, r = s->records - p->records;
        double y = time ? s->cpu_s - p->cpu_s : s->rays - p->rays;
        double w = y > 0 ? 1 / (y * y) : 0;

        m.nn += w * n * n;
        m.nr += w * n * r;
        m.rr += w * r * r;
        m.nt += w * n * y;
        m.rt += w * r * y;
    }
    return m;
}

struct fit {
    double a, b;
};

static struct fit
fit_steps(const struct trial *t, bool time)
{
    struct sums m = sum_steps(t, time);
    double det = m.nn * m.rr - m.nr * m.nr;
    struct fit f = { 0, 0 };

    if (det > 1e-9 * m.nn * m.rr) {
        f.a = (m.nt * m.rr - m.rt * m.nr) / det;
        f.b = (m.rt * m.nn - m.nt * m.nr) / det;
    }
    if (!(f.a > 0 && f.b > 0)) {
        /* charge all to records, or to pixels if there are no records */
        f.a = m.rr > 0 ? 0 : m.nn > 0 ? m.nt / m.nn : 0;
        f.b = m.rr > 0 ? m.rt / m.rr : 0;
    }
    return f;
}

/* Time or rays of a pixel whose records exist. */
static double
cost_of_pixel(const struct trial *t, bool time)
{
    double sum = time ? t->again_cpu_s : t->again_rays;

    return t->again_primary > 0 ? sum / t->again_primary : 0;
}

/* Time or rays of a record if a pixel takes a: b for that a. */
static double
cost_of_record(const struct trial *t, bool time, double a)
{
    struct sums m = sum_steps(t, time);
    double rt = m.rt - a * m.nr;

    return m.rr > 0 && rt > 0 ? rt / m.rr : 0;
}

/* How many records each further doubling of the pixels makes. */
static double
records_a_doubling(const struct trial *t)
{
    int last = t->nsteps - 1, first = last > 3 ? last - 3 : 0;
    double octaves;

    if (last <= first)
        return 0;
    octaves = log2(t->step[last].pixels / t->step[first].pixels);
    return (t->step[last].records - t->step[first].records) / octaves;
}

/* Does each doubling still make nearly twice as many records as the one before?
 * Then their number does not grow by the logarithm yet. */
static bool
unsaturated(const struct trial *t)
{
    const struct trial_step *s = &t->step[t->nsteps - 1];

    if (t->nsteps > 1 && s->pixels < 2 * s[-1].pixels)
        s--; /* the last step is no whole doubling */
    return s - t->step >= 2 &&
           s->records - s[-1].records > 1.7 * (s[-1].records - s[-2].records);
}

/* How many records are still to be made for that many pixels and primary rays:
 * the same number for each doubling of primary rays; while the cache is
 * unsaturated, as many per pixel as in the windows. */
static double
records_to_come(const struct trial *t, double pixels, double primary)
{
    const struct trial_step *last = &t->step[t->nsteps - 1];
    double more = 0;

    if (primary > last->pixels)
        more = records_a_doubling(t) * log2(primary / last->pixels);
    if (unsaturated(t) && t->pixels > 0)
        more = fmax(more, pixels * t->records / t->pixels - last->records);
    return more;
}

static double
field(const struct trial_step *s, bool time)
{
    return time ? s->cpu_s : s->rays;
}

/* Time or rays of a strewn pixel, of a primary ray of the picture and of a
 * record. */
struct price {
    double strewn, primary, record;
};

/* Prices from many windows: their first tracing less its records.  So records
 * that come faster than the strewn pixels tell are included. */
static struct price
price_by_windows(const struct trial *t, bool time)
{
    struct fit f = fit_steps(t, time);
    double windows = (time ? t->cpu_s : t->rays) - f.b * t->records;
    double a = t->primary > 0 ? windows / t->primary : 0;

    if (!(a > .2 * f.a))
        a = .2 * f.a; /* windows that made little but records */
    return (struct price){ f.a, a, f.b };
}

/* Prices from few windows: their second tracing, for most records of the first
 * one would be shared with neighbouring windows. */
static struct price
price_by_second_time(const struct trial *t, bool time)
{
    double a = cost_of_pixel(t, time);

    return (struct price){ a, a, cost_of_record(t, time, a) };
}

/* By how much records are more for the bounces that were not tried. */
static double
deeper(const struct trial *t)
{
    return pow(FURTHER, fmin(t->untried, LAST_BOUNCE - MOST_BOUNCES));
}

/* Time or rays of the picture: the records that were made and those to come,
 * and pixels as in the windows. */
static double
total(const struct trial *t, bool time, double primary, double more_records)
{
    const double MANY = 5000; /* primary rays in windows, at least */
    const struct trial_step *last = &t->step[t->nsteps - 1];
    struct price p = t->primary < MANY ? price_by_second_time(t, time)
                                       : price_by_windows(t, time);
    double strewn = field(last, time) - p.strewn * last->pixels;
    double records = (strewn > 0 ? strewn : 0) + p.record * more_records;

    if (t->small.pixels > 0 && field(&t->small, time) > 0) {
        /* small hemispheres were tried: the first records lie deep, where
         * hemispheres are small anyhow; late ones are asked for by primary rays
         * and get all samples */
        double first = field(&t->small, time);
        double more = field(&t->full, time) / first;

        if (first > records)
            first = records;
        records = more * first + fmax(more, t->samples) * (records - first);
    }
    return deeper(t) * records + p.primary * primary;
}

/* The sums that the job's passes would give, from those of the trial's cache:
 * there records are fitted to their neighbours, and several serve a place, so
 * errors' squares are a fifth (doc/measured.md).  Full hemispheres have less
 * error than the trial's small ones, but not of extrapolation; the power was
 * fitted on a box and an office at night. */
static struct rad_doubt
doubt_of(const struct trial *t)
{
    const double passes = .2;
    struct rad_doubt d = t->doubt;
    double less = passes * (t->samples > 1 ? pow(t->samples, -.25) : 1);

    d.v[RAD_DOUBT_AMBIENT] *= less;
    d.v[RAD_DOUBT_SAID] *= less;
    return d;
}

void
trial_predict(const struct trial *t, double pixels, struct prediction *p)
{
    const struct trial_step *last = &t->step[t->nsteps - 1];
    struct rad_doubt doubt = doubt_of(t);
    double more, records;

    p->primary_rays = t->pixels > 0 ? pixels * t->primary / t->pixels : pixels;
    more = records_to_come(t, pixels, p->primary_rays);
    records = last->records + more;
    if (t->small.records > 0)
        records *= t->full.records / t->small.records;
    records *= deeper(t);
    p->ambient_values = records;
    p->rays = total(t, false, p->primary_rays, more);
    p->load_s = t->load_s;
    p->cpu_s = t->load_s + total(t, true, p->primary_rays, more);
    p->error = rad_doubt_error(&doubt);
    p->bytes = t->peak_bytes + RECORD_BYTES * (records - last->records);
}

void
trial_repeat(struct prediction *p, int times)
{
    p->primary_rays *= times;
    p->rays *= times;
    p->ambient_values *= times;
    p->cpu_s *= times;
    p->load_s *= times;
}
