/* recheck.c - see recheck.h
 *
 * Differences are relative to the mean of what is compared, which is near the
 * difference of logarithms and never more than 2.  Squares of areas count up to
 * MOST_SQUARE: an edge of a lamp counts, but not more than all the rest.
 * Of an area few pixels are made again.  The square of a sum of differences is
 * that of their products in pairs, and of each with itself: the former come
 * from different pixels, the latter from some that are traced once more.  A
 * sensor point is an area by itself: nobody takes the mean of those around. */
#include "config.h"

#include "refine/recheck.h"

#include "base/rng.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Apart from the keys of pixels, which have a frame in this place. */
#define BRANCH UINT64_C(0x636865636b730000)

#define PLACES 8 /* of a tile */

/* As differences of pixels count up to half of their mean (doubt.c). */
#define MOST_SQUARE .25

enum {
    SIDE = 5,  /* of an area [pixels] */
    AREAS = 4, /* of a window, at most */
    AGAIN = 8, /* pixels of an area that are traced again, */
    TWICE = 2, /* and so many of them once more */
    STEPS = 3, /* of the sampler, in a window: across, */
    LINES = 4, /* and base lines */
    MOST_WIDTH = STEPS * RAD_QUINCUNX_MAX_XSTEP + 1,
    MOST_HEIGHT = LINES * RAD_QUINCUNX_MAX_YSTEP + 1
};

/* Frames like the job's, with other random numbers. */
enum { PICTURE, FIRST, SECOND, NFRAMES };

struct check {
    struct rad_frame frame[NFRAMES];
    struct rad_ctx *ctx;
    const _Atomic bool *stop;
    uint64_t key;
    uint32_t drawn; /* numbers of the key */
    struct rad_refine_sums *out;
    int side;         /* of an area, */
    int again, twice; /* pixels of it, */
    int areas;        /* of a window, at most */
};

static bool
is_stopped(const struct check *c)
{
    return atomic_load_explicit(c->stop, memory_order_relaxed);
}

static void
count(struct check *c, enum rad_refine_sum sum, double x)
{
    c->out->v[sum] += x;
}

/* From 0 to n - 1. */
static int
draw(struct check *c, int n)
{
    return (int)(rad_rand(c->key, c->drawn++) * n);
}

/* The luminance of a pixel. */
static double
pixel(struct check *c, int frame, int x, int y)
{
    struct rad_pixel p;

    rad_frame_pixel(&c->frame[frame], c->ctx, x, y, &p);
    return rad_rgb_lum(p.L);
}

/* --- places --- */

static double
fraction(double x)
{
    return x - floor(x);
}

/* Place n of a sequence that is spread evenly over the picture (path.h). */
static void
check_place(struct check *c, uint64_t n)
{
    const struct rad_frame *f = &c->frame[PICTURE];
    int x = (int)(fraction((double)n * .7548776662466927) * f->width);
    int y = (int)(fraction((double)n * .5698402909980532) * f->height);
    double d[2], product, off, mean = 0;

    for (int k = 0; k < 2; k++) {
        double cached = pixel(c, FIRST + k, x, y), fresh;

        c->ctx->fresh = true;
        fresh = pixel(c, FIRST + k, x, y);
        c->ctx->fresh = false;
        d[k] = fresh - cached;
        mean += (fresh + cached) / 4;
    }
    if (!(mean > 0))
        return;
    product = d[0] * d[1] / (mean * mean);
    off = (d[0] + d[1]) / 2;
    count(c, RAD_REFINE_LIGHT, mean);
    count(c, RAD_REFINE_OFF, off);
    count(c, RAD_REFINE_OFF2, off * off);
    count(c, RAD_REFINE_PLACES, 1);
    count(c, RAD_REFINE_AMBIENT, product);
    count(c, RAD_REFINE_AMBIENT2, product * product);
}

/* --- windows --- */

struct sampled {
    struct rad_window at;
    struct rad_pixel pixel[MOST_HEIGHT][MOST_WIDTH];
};

/* The first n of `order` become some of the pixels of an area, each once. */
static void
shuffle(struct check *c, int order[SIDE * SIDE], int n)
{
    int all = c->side * c->side;

    for (int i = 0; i < all; i++)
        order[i] = i;
    for (int i = 0; i < n; i++) {
        int k = i + draw(c, all - i), kept = order[i];

        order[i] = order[k];
        order[k] = kept;
    }
}

/* Differences of an area, relative to its mean. */
struct differences {
    double sum, squares; /* of all pixels that were traced again */
    double own;          /* products of a pixel's two */
    double noise;        /* half the squares of what these differ by */
};

/* The square of the area's error. */
static double
square_of(const struct check *c, const struct differences *d)
{
    double n = c->side * c->side, again = c->again, pairs = 0;

    if (again > 1)
        pairs = (d->sum * d->sum - d->squares) / (again * (again - 1));
    return (n - 1) / n * pairs + d->own / c->twice / n;
}

static int
least(int a, int b)
{
    return a < b ? a : b;
}

static void
check_area(struct check *c, const struct sampled *s, int x0, int y0)
{
    int order[SIDE * SIDE];
    struct differences d = { 0, 0, 0, 0 };
    double a[AGAIN], b[AGAIN], b2[TWICE], mean = 0, square;

    shuffle(c, order, c->again);
    for (int i = 0; i < c->again; i++) {
        int x = x0 + order[i] % c->side, y = y0 + order[i] / c->side;

        a[i] = rad_rgb_lum(s->pixel[y][x].L);
        b[i] = pixel(c, FIRST, s->at.x + x, s->at.y + y);
        if (i < c->twice)
            b2[i] = pixel(c, SECOND, s->at.x + x, s->at.y + y);
        mean += (a[i] + b[i]) / (2 * c->again);
    }
    if (!(mean > 0) || is_stopped(c))
        return;
    for (int i = 0; i < c->again; i++) {
        double off = (a[i] - b[i]) / mean;

        d.sum += off;
        d.squares += off * off;
        if (i < c->twice) {
            double other = (a[i] - b2[i]) / mean;

            d.own += off * other;
            d.noise += (off - other) * (off - other) / 2;
        }
    }
    square = fmax(fmin(square_of(c, &d), MOST_SQUARE), -MOST_SQUARE);
    count(c, RAD_REFINE_AREAS, 1);
    count(c, RAD_REFINE_PIXEL, square);
    count(c, RAD_REFINE_PIXEL2, square * square);
    count(c, RAD_REFINE_NOISE, d.noise / c->twice / (c->side * c->side));
}

/* A window at random, some steps of the sampler wide and high, and no less than
 * an area. */
static struct rad_window
draw_window(struct check *c)
{
    const struct rad_frame *f = &c->frame[PICTURE];
    struct rad_window w;
    int xstep, ystep;

    rad_quincunx_steps(f->job->params.psample, &xstep, &ystep);
    w.width = STEPS * xstep + 1 < SIDE ? SIDE : STEPS * xstep + 1;
    w.height = LINES * ystep + 1;
    w.width = least(w.width, f->width);
    w.height = least(w.height, f->height);
    w.x = draw(c, f->width - w.width + 1);
    w.y = draw(c, f->height - w.height + 1);
    return w;
}

static bool
sample_window(struct check *c, struct sampled *s)
{
    struct rad_counts *counts = &c->ctx->counts;
    struct rad_pixel *rows[MOST_HEIGHT];
    uint64_t rays = counts->rays, traced = counts->primary_rays;

    s->at = draw_window(c);
    for (int y = 0; y < s->at.height; y++)
        rows[y] = s->pixel[y];
    if (rad_frame_window(&c->frame[PICTURE], c->ctx, &s->at, rows, NULL, NULL))
        return false;
    count(c, RAD_REFINE_TRACED, (double)(counts->primary_rays - traced));
    count(c, RAD_REFINE_RAYS, (double)(counts->rays - rays));
    count(c, RAD_REFINE_SHOWN, (double)s->at.width * s->at.height);
    return true;
}

static bool
check_window(struct check *c)
{
    struct sampled *s = malloc(sizeof *s);
    int across, down, n, first;

    if (!s || !sample_window(c, s)) {
        free(s);
        return false;
    }
    across = s->at.width / c->side;
    down = s->at.height / c->side;
    n = across * down;
    first = n > 0 ? draw(c, n) : 0;
    for (int i = 0; i < least(n, c->areas) && !is_stopped(c); i++) {
        int k = (first + i) % n;

        check_area(c, s, k % across * c->side, k / across * c->side);
    }
    free(s);
    return true;
}

/* --- tiles --- */

static struct rad_frame
with_key(const struct rad_frame *f, uint64_t which)
{
    struct rad_frame out = *f;

    out.key = rad_key_branch(f->key ^ BRANCH, which);
    out.stamp = rad_key_branch(f->stamp ^ BRANCH, which) | 1;
    out.depth = false;
    return out;
}

static bool
check_all(struct check *c, uint32_t tile, uint32_t nframes)
{
    bool ok = check_window(c);

    for (uint64_t i = 0; ok && i < PLACES && !is_stopped(c); i++)
        check_place(c, (uint64_t)(tile / nframes) * PLACES + i);
    return ok && !is_stopped(c);
}

/* What belongs to pictures, and not to their check. */
static void
restore(struct rad_counts *to, const struct rad_counts *before)
{
    to->primary_rays = before->primary_rays;
    to->nan_pixels = before->nan_pixels;
    to->nan_x = before->nan_x;
    to->nan_y = before->nan_y;
    to->doubt = before->doubt;
}

bool
rad_refine_make(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t tile,
                const _Atomic bool *stop, struct rad_refine_sums *out)
{
    uint32_t nframes;
    const struct rad_frame *f = rad_passes_frames(p, &nframes);
    struct rad_counts before = ctx->counts;
    struct check c = { .ctx = ctx, .stop = stop, .out = out, .side = SIDE,
                       .areas = AREAS };
    bool ok;

    memset(out, 0, sizeof *out);
    f += tile % nframes;
    if (f->points) {
        c.side = 1;
        c.areas = 4 * AREAS; /* they cost as much */
    }
    c.again = least(AGAIN, c.side * c.side);
    c.twice = least(TWICE, c.again);
    c.key = rad_key_branch(f->key ^ BRANCH, NFRAMES + (uint64_t)tile);
    for (int i = 0; i < NFRAMES; i++)
        c.frame[i] = with_key(f, (uint64_t)i);
    ok = check_all(&c, tile, nframes);
    restore(&ctx->counts, &before);
    return ok;
}
