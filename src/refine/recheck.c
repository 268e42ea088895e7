/* recheck.c - see recheck.h */
#include "config.h"

#include "refine/recheck.h"

#include "base/rng.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Keeps the keys of checks apart from those of pixels, which have a frame's
 * number in this place. */
#define BRANCH UINT64_C(0x636865636b740000)

/* For a tile: the number of places, of windows, and of areas looked at if all
 * are even; all areas if the pictures are small. */
#define PLACES  2
#define WINDOWS 2
#define AREAS   5.
#define POINTS  16. /* sensors looked at, each an area, in place of AREAS */

/* The size of a window: in steps of the sampler across, more with --oversample,
 * and in base lines.  With --oversample it holds an area at least. */
enum {
    STEPS = 4,
    LINES = 3,
    MOST_WIDTH =
        STEPS * (RAD_MAX_OVERSAMPLE + 1) / 2 * RAD_QUINCUNX_MAX_XSTEP + 1,
    MOST_HEIGHT = LINES * RAD_QUINCUNX_MAX_YSTEP + 1
};
_Static_assert(RAD_DOUBT_SIDE *RAD_MAX_OVERSAMPLE < MOST_HEIGHT, "no room");

struct check {
    struct rad_frame frame; /* like the job's, with other random numbers */
    struct rad_ctx *ctx;
    const _Atomic bool *stop;
    uint64_t key;
    uint64_t first; /* added to the numbers of windows and places */
    bool small;  /* see rad_refine_is_small() */
    int windows; /* of the tile */
    struct rad_refine_sums *out;
};

static bool
is_stopped(const struct check *c)
{
    return atomic_load_explicit(c->stop, memory_order_relaxed);
}

/* Set at[] to number n of a sequence that is spread evenly over an area of that
 * size (path.h). */
static void
spread(uint64_t n, int width, int height, int at[2])
{
    double x = (double)n * .7548776662466927, y = (double)n * .5698402909980532;

    at[0] = (int)((x - floor(x)) * width);
    at[1] = (int)((y - floor(y)) * height);
}

/* --- places --- */

/* Check a place: one of RAD_DOUBT_TRIED pixels, from number n of the sequence
 * on. */
static void
check_place(struct check *c, uint64_t n)
{
    const struct rad_frame *f = &c->frame;
    int at[RAD_DOUBT_TRIED][2];

    for (int i = 0; i < RAD_DOUBT_TRIED; i++, n++)
        spread(n, f->width, f->height, at[i]);
    rad_doubt_place(f, c->ctx, rad_key_branch(c->key, n), (const int(*)[2])at,
                    &c->out->doubt, &c->out->off);
}

/* --- windows --- */

struct sampled {
    struct rad_frame frame; /* like the check's, with other random numbers */
    struct rad_window at;
    struct rad_pixel *row[MOST_HEIGHT];
    struct rad_pixel pixel[MOST_HEIGHT][MOST_WIDTH];
};

static int
least(int a, int b)
{
    return a < b ? a : b;
}

static int
most(int a, int b)
{
    return a > b ? a : b;
}

static struct rad_window
window_at(const struct check *c, uint64_t n)
{
    const struct rad_frame *f = &c->frame;
    struct rad_window w;
    int oversample = rad_frame_oversample(f), xstep, ystep, at[2];
    int area = oversample > 1 ? RAD_DOUBT_SIDE * oversample : 0;

    rad_quincunx_steps(f->job->params.psample, &xstep, &ystep);
    w.width = most(STEPS * (oversample + 1) / 2 * xstep, area) + 1;
    w.height = most(LINES * ystep, area) + 1;
    w.width = least(w.width, f->width);
    w.height = least(w.height, f->height);
    spread(n, f->width - w.width + 1, f->height - w.height + 1, at);
    w.x = at[0];
    w.y = at[1];
    return w;
}

static bool
sample_window(struct check *c, uint64_t n, struct sampled *s)
{
    const struct rad_counts *counts = &c->ctx->counts;
    uint64_t rays = counts->rays;

    s->at = window_at(c, n);
    s->frame = c->frame;
    /* ~n and not n: c->key, of the tile's places, is the branch of this key by
     * the tile's number */
    s->frame.key = rad_key_branch(c->frame.key, ~n);
    s->frame.stamp = rad_key_branch(c->frame.stamp, n) | 1;
    for (int y = 0; y < s->at.height; y++)
        s->row[y] = s->pixel[y];
    if (rad_frame_window(&s->frame, c->ctx, &s->at, s->row))
        return false;
    c->out->rays += (double)(counts->rays - rays);
    c->out->shown += (double)s->at.width * s->at.height;
    return true;
}

static bool
look_at_window(struct check *c, const struct sampled *s)
{
    double pixels = (double)s->at.width * s->at.height * c->windows;
    double areas = s->frame.points ? POINTS : AREAS;
    struct rad_doubt_share share = { c->small ? INFINITY : areas / pixels, 0 };
    struct rad_doubt_rows rows = {
        &s->frame,   s->at.x,      s->at.y,
        s->at.width, s->at.height, (const struct rad_pixel *const *)s->row
    };

    return rad_doubt_look_at_window(&rows, c->ctx, &share, c->stop,
                                    &c->out->doubt);
}

/* Sample a window, and make some of it again. */
static bool
check_window(struct check *c, uint64_t n)
{
    struct sampled *s = malloc(sizeof *s);
    bool ok = s && sample_window(c, n, s) && look_at_window(c, s);

    free(s);
    return ok;
}

/* --- tiles --- */

static bool
check_all(struct check *c, uint32_t tile, uint32_t nframes)
{
    uint64_t n = c->first + tile / nframes; /* of the frame's tiles */
    bool ok = true;

    for (int i = 0; ok && i < c->windows && !is_stopped(c); i++)
        ok = check_window(c, n * (uint64_t)c->windows + (uint64_t)i);
    for (uint64_t i = 0; ok && i < PLACES && !is_stopped(c); i++)
        check_place(c, (n * PLACES + i) * RAD_DOUBT_TRIED);
    return ok && !is_stopped(c);
}

/* Each stage looks at windows and places of its own, so that stages say more
 * together than one does: they differ in these options. */
static uint64_t
first_of(const struct rad_params *p)
{
    double by[2] = { p->ambacc, p->maxdiff };
    uint64_t bits[2];

    memcpy(bits, by, sizeof bits);
    return rad_mix64(rad_mix64(bits[0]) + bits[1]) >> 44;
}

static bool
are_small(const struct rad_frame *f, uint32_t nframes)
{
    uint64_t pixels = 0;

    for (uint32_t i = 0; i < nframes; i++)
        pixels += (uint64_t)f[i].width * (uint64_t)f[i].height;
    return rad_refine_is_small(&f->job->params, pixels);
}

bool
rad_refine_make(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t tile,
                const _Atomic bool *stop, struct rad_refine_sums *out)
{
    uint32_t nframes;
    const struct rad_frame *f = rad_passes_frames(p, &nframes);
    struct rad_counts before = ctx->counts;
    struct check c = { .ctx = ctx, .stop = stop, .out = out };
    bool ok;

    memset(out, 0, sizeof *out);
    c.frame = f[tile % nframes];
    c.first = first_of(&c.frame.job->params);
    c.small = are_small(f, nframes);
    c.windows = rad_frame_oversample(&c.frame) > 1 ? 1 : WINDOWS;
    c.key = rad_key_branch(c.frame.key ^ BRANCH, tile);
    c.frame.key ^= BRANCH;
    c.frame.stamp = (c.frame.stamp ^ BRANCH) | 1;
    ok = check_all(&c, tile, nframes);
    ctx->counts.primary_rays = before.primary_rays;
    ctx->counts.nan_pixels = before.nan_pixels;
    ctx->counts.nan_x = before.nan_x;
    ctx->counts.nan_y = before.nan_y;
    return ok;
}
