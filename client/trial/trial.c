/* trial.c - see trial.h; trial_predict.c says what the measurements are for */
#include "config.h"

#include "trial/trial.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

/* With more samples of a hemisphere than SMALL_DIV and SMALL_SSAMP together, at
 * most LAST_FULL pixels are traced with all of them. */
enum {
    FIRST = 64,
    MOST_WINDOWS = 32,
    SMALL_DIV = 64,
    SMALL_SSAMP = 0,
    LAST_FULL = 256
};

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
    if (params->ambacc > 0 && params->ambounce > TRIAL_BOUNCES) {
        tried.ambounce = TRIAL_BOUNCES;
        t->untried = params->ambounce - TRIAL_BOUNCES;
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
