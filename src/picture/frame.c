/* frame.c - see frame.h
 *
 * Rows count from the top.  Radiance aims its rays by rows from the bottom;
 * aim() converts. */
#include "config.h"

#include "picture/frame.h"
#include "base/rng.h"
#include "base/vec.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

/* Keeps the keys of a pixel's further samples apart from those of frames and of
 * pixels rendered again (doubt.c). */
#define SAMPLE UINT64_C(0x73616d706c650000)

int
rad_frame_size(const struct rad_params *p, const struct rad_view *view,
               int *width, int *height, double *pixaspect,
               struct rad_error *err)
{
    *width = p->xres;
    *height = p->yres;
    *pixaspect = p->pixaspect;
    rad_view_resolution(view, pixaspect, width, height);
    if (*width < 1 || *height < 1)
        return rad_fail(err, RAD_EUSAGE,
                        "empty picture: '-x %d -y %d -pa %g' with this view "
                        "is %d by %d pixels",
                        p->xres, p->yres, p->pixaspect, *width, *height);
    return 0;
}

static uint64_t
stamp_view(uint64_t stamp, const struct rad_view *v)
{
    uint64_t word[sizeof *v / sizeof(uint64_t)];

    memcpy(word, v, sizeof word);
    for (size_t i = 0; i < sizeof word / sizeof word[0]; i++)
        stamp = rad_mix64(stamp ^ word[i]) + 1;
    return stamp;
}

/* Set the stamp: a hash of all that the frame's rays depend on but the job. */
static void
stamp(struct rad_frame *f)
{
    uint64_t size = (uint64_t)f->width << 32 | (uint32_t)f->height;

    f->stamp = stamp_view(f->key ^ rad_mix64(size), &f->view);
    if (f->moving)
        f->stamp = stamp_view(f->stamp, &f->before);
    if (f->stamp == 0)
        f->stamp = 1;
}

int
rad_frame_init(struct rad_frame *f, const struct rad_job *job,
               const struct rad_view *view, uint32_t number, bool depth,
               struct rad_error *err)
{
    int rc;

    memset(f, 0, sizeof *f);
    f->job = job;
    f->view = *view;
    f->number = number;
    f->key = rad_key_frame(job->params.seed, number);
    f->depth = depth;
    if ((rc = rad_view_setup(&f->view, err)) < 0 ||
        (rc = rad_frame_size(&job->params, &f->view, &f->width, &f->height,
                             &f->pixaspect, err)) < 0)
        return rc;
    stamp(f);
    if (!job->params.directvis || job->params.aperture > 0)
        return 0;
    return rad_paint_init(&f->paint, job, &f->view, f->width, err);
}

int
rad_frame_move(struct rad_frame *f, const struct rad_view *before,
               struct rad_error *err)
{
    if (!(f->job->params.motion > 0))
        return 0;
    rad_paint_release(&f->paint);
    f->before = *before;
    f->moving = true;
    if (rad_view_setup(&f->before, err) < 0)
        return RAD_EUSAGE;
    stamp(f);
    return 0;
}

void
rad_frame_of_points(struct rad_frame *f, const struct rad_job *job,
                    const struct rad_points *points)
{
    memset(f, 0, sizeof *f);
    f->job = job;
    f->points = points;
    f->width = points->width;
    f->height = points->height;
    f->pixaspect = 1;
    f->key = rad_key_frame(job->params.seed, f->number);
    f->depth = true;
    stamp(f);
}

void
rad_frame_release(struct rad_frame *f)
{
    rad_paint_release(&f->paint);
}

int
rad_frame_oversample(const struct rad_frame *f)
{
    return f->oversample > 1 ? f->oversample : 1;
}

/* -pm: move a ray, and its distance to the aft plane, toward the ray that the
 * last frame's view has at the same position, or away from it.  Where that view
 * has no ray there is no blur, as in rpict. */
static bool
move(const struct rad_frame *f, double h, double v, struct rad_aim *r,
     double *aft)
{
    double d = f->job->params.motion * (.5 - rad_rand(r->key, RAD_DIM_MOTION));
    double org[3], dir[3], last = rad_view_ray(&f->before, h, v, org, dir);

    if (last < 0)
        return true;
    *aft = (1 - d) * *aft + d * last;
    for (int k = 0; k < 3; k++) {
        r->org[k] = (1 - d) * r->org[k] + d * org[k];
        r->dir[k] = (1 - d) * r->dir[k] + d * dir[k];
    }
    return rad_normalize(r->dir) > 0;
}

static bool
aim_at_point(const struct rad_frame *f, int x, int y, struct rad_aim *r)
{
    double length;

    if (!rad_points_at(f->points, x, y, r->org, r->dir))
        return false;
    r->key = rad_key_branch(f->key, rad_points_number(f->points, x, y));
    length = rad_normalize(r->dir);
    r->tmax = f->points->flags & RAD_POINTS_LIMITED ? length : INFINITY;
    return length > 0;
}

/* Compute the primary ray of a pixel; false: the view has none there. */
static bool
aim(const struct rad_frame *f, int x, int y, struct rad_aim *r)
{
    const struct rad_params *p = &f->job->params;
    double jx = .5, jy = .5, aft, u[3];

    if (f->points)
        return aim_at_point(f, x, y, r);
    r->key = rad_key_in_frame(f->key, (uint32_t)x, (uint32_t)y);
    if (p->pixjitter > 0) {
        jx += p->pixjitter * (.5 - rad_rand(r->key, RAD_DIM_PIXEL));
        jy += p->pixjitter * (.5 - rad_rand(r->key, RAD_DIM_PIXEL + 1));
    }
    jx = (x + jx) / f->width;
    jy = (f->height - 1 - y + jy) / f->height;
    aft = rad_view_ray(&f->view, jx, jy, r->org, r->dir);
    if (aft < 0 || (f->moving && !move(f, jx, jy, r, &aft)))
        return false;
    if (p->aperture > 0) {
        for (int k = 0; k < 3; k++)
            u[k] = rad_rand(r->key, RAD_DIM_LENS + (uint32_t)k);
        aft = rad_view_lens(&f->view, p->aperture, u, r->org, r->dir, aft);
    }
    r->tmax = aft > 0 ? aft : INFINITY;
    return true;
}

static void
follow(const struct rad_aim *a, struct rad_ray *r)
{
    r->key = a->key;
    r->tmax = a->tmax;
    rad_copy(r->org, a->org);
    rad_copy(r->dir, a->dir);
}

/* Are pixels the irradiance at sensor points? */
static bool
on_surface(const struct rad_frame *f)
{
    return f->points && f->points->flags & RAD_POINTS_IRRADIANCE;
}

bool
rad_frame_start(const struct rad_frame *f, struct rad_ctx *ctx, int x, int y,
                struct rad_ray *r, bool *met)
{
    struct rad_aim a;

    *met = on_surface(f);
    if (!aim(f, x, y, &a))
        return false;
    if (*met) {
        rad_ray_place(ctx, r, a.org, a.dir, a.key);
        return true;
    }
    follow(&a, r);
    return rad_ray_spawn(ctx, r, RAD_RAY_PRIMARY, NULL, NULL, 0);
}

/* Trace r, whose origin, direction and key are set. */
static bool
look(const struct rad_frame *f, struct rad_ctx *ctx, struct rad_ray *r)
{
    double org[3], dir[3];

    ctx->sensor = f->points != NULL;
    if (on_surface(f)) {
        rad_copy(org, r->org);
        rad_copy(dir, r->dir);
        ctx->counts.rays++;
        rad_ray_irradiance(ctx, r, org, dir, r->key);
        return true;
    }
    if (!rad_ray_spawn(ctx, r, RAD_RAY_PRIMARY, NULL, NULL, 0))
        return false;
    rad_ray_trace(ctx, r);
    return true;
}

bool
rad_frame_look(const struct rad_frame *f, struct rad_ctx *ctx, int x, int y,
               struct rad_ray *r)
{
    struct rad_aim a;

    if (!aim(f, x, y, &a))
        return false;
    follow(&a, r);
    return look(f, ctx, r);
}

/* Set up r as the primary ray of a pixel; false: the view has none.  If pixels
 * come in even steps along a row, also compute the next pixel's ray into
 * ctx->aim: its square root and divisions, which wait for each other, then
 * overlap with the tracing of r. */
static bool
take_aim(const struct rad_frame *f, struct rad_ctx *ctx, int x, int y,
         struct rad_ray *r)
{
    struct rad_aim *a = &ctx->aim;
    bool found = a->frame == f->stamp && a->x == x && a->y == y, seen;
    uint64_t last = atomic_load_explicit(&ctx->at, memory_order_relaxed);
    int step = RAD_AT_Y(last) == y ? x - RAD_AT_X(last) : 0;

    if (!found)
        a->seen = aim(f, x, y, a);
    seen = a->seen;
    if (seen)
        follow(a, r);
    a->frame = 0;
    if (step > 0 && step == a->step && step < f->width - x) {
        a->frame = f->stamp;
        a->x = x + step;
        a->y = y;
        a->seen = aim(f, x + step, y, a);
    }
    a->step = step;
    return seen;
}

void
rad_frame_sampler(const struct rad_frame *f, const struct rad_window *w,
                  struct rad_quincunx *q)
{
    q->x0 = w->x;
    q->y0 = w->y;
    q->width = w->width;
    q->height = w->height;
    q->maxdiff = f->job->params.maxdiff;
    q->depth = f->depth;
    rad_quincunx_steps(f->job->params.psample, &q->xstep, &q->ystep);
}

/* Trace the further samples of a pixel, whose first sample gave L; returns the
 * mean of all samples.  Each has random numbers of its own. */
static struct rad_rgb
look_again(const struct rad_frame *f, struct rad_ctx *ctx, int x, int y,
           struct rad_rgb L)
{
    int n = f->job->params.samples;
    struct rad_frame other = *f;
    struct rad_ray r;

    for (int i = 1; i < n; i++) {
        other.key = rad_key_branch(f->key ^ SAMPLE, (uint64_t)i);
        if (rad_frame_look(&other, ctx, x, y, &r))
            L = rad_rgb_add(L, r.L);
    }
    return rad_rgb_scale(L, 1 / (float)n);
}

bool
rad_frame_pixel(const struct rad_frame *f, struct rad_ctx *ctx, int x, int y,
                struct rad_pixel *out)
{
    uint64_t unsound = ctx->counts.unsound_rays;
    struct rad_ray r;
    bool seen = take_aim(f, ctx, x, y, &r);

    atomic_store_explicit(&ctx->at, RAD_AT(x, y), memory_order_relaxed);
    out->L = rad_grey(0);
    out->z = 0;
    if (!seen)
        return false;
    if (!look(f, ctx, &r))
        return false;
    ctx->counts.primary_rays++;
    if (f->depth)
        out->z = (float)rad_ray_distance(&r);
    if (f->job->params.samples > 1 && !ctx->glance)
        r.L = look_again(f, ctx, x, y, r.L);
    if (ctx->counts.unsound_rays != unsound)
        rad_counts_nan(&ctx->counts, x, y);
    out->L = rad_params_colour(&f->job->params, r.L);
    return true;
}

void
rad_frame_paint_row(const struct rad_frame *f, struct rad_ctx *ctx, int x0,
                    int x1, int y, struct rad_pixel *row)
{
    struct rad_canvas canvas = { .view = &f->view,
                                 .width = f->width,
                                 .height = f->height,
                                 .seed = f->job->params.seed,
                                 .frame = f->number,
                                 .depth = f->depth };

    if (f->paint.n > 0)
        rad_paint_row(&f->paint, &canvas, ctx, x0, x1, y, row);
}

struct tracer {
    const struct rad_frame *frame;
    struct rad_ctx *ctx;
};

static void
trace(void *arg, int x, int y, struct rad_pixel *out)
{
    const struct tracer *t = arg;

    rad_frame_pixel(t->frame, t->ctx, x, y, out);
}

/* Paint rows y0 to y1 - 1 of the window.  A base line belongs to the bar above
 * it, so that it is painted once. */
static void
paint(const struct rad_frame *f, struct rad_ctx *ctx,
      const struct rad_window *w, struct rad_pixel *const rows[], int y0,
      int y1)
{
    for (int y = y0; y < y1; y++)
        rad_frame_paint_row(f, ctx, w->x, w->x + w->width, w->y + y, rows[y]);
}

static void
render_bars(const struct rad_frame *f, const struct rad_quincunx *q,
            struct rad_ctx *ctx, const struct rad_window *w, uint8_t *density,
            struct rad_pixel *const rows[])
{
    int n = rad_quincunx_nbases(q), above = 0;

    rad_quincunx_base(q, 0, density, rows[0]);
    paint(f, ctx, w, rows, 0, 1);
    for (int i = 1; i < n; i++) {
        int y = rad_quincunx_base_row(q, i);

        rad_quincunx_base(q, i, density, rows[y]);
        rad_quincunx_bar_below(q, i - 1, rows + above);
        paint(f, ctx, w, rows, above + 1, y + 1);
        above = y;
    }
}

static bool
within(const struct rad_frame *f, const struct rad_window *w)
{
    return w->width > 0 && w->height > 0 && w->x >= 0 && w->y >= 0 &&
           w->width <= f->width - w->x && w->height <= f->height - w->y;
}

int
rad_frame_window(const struct rad_frame *f, struct rad_ctx *ctx,
                 const struct rad_window *w, struct rad_pixel *const rows[])
{
    struct tracer t = { f, ctx };
    struct rad_quincunx q = { .trace = trace, .arg = &t };
    struct rad_arena_mark mark = rad_arena_mark(&ctx->scratch);
    uint8_t *density;

    if (!within(f, w))
        return RAD_EUSAGE;
    rad_frame_sampler(f, w, &q);
    density = rad_arena_alloc(&ctx->scratch, rad_quincunx_ndensity(&q));
    if (!density)
        return RAD_ENOMEM;
    rad_quincunx_start(&q, density);
    render_bars(f, &q, ctx, w, density, rows);
    rad_arena_rewind(&ctx->scratch, mark);
    return 0;
}
