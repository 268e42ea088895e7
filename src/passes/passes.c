/* passes.c - see passes.h
 *
 * Deep records.  A path leaves a pixel and bounces about, by intersection
 * alone; where bounce number k ends a record of level k is asked for, by a ray
 * that is shaded.  Such places are as often where hemispheres' rays go as these
 * are.  What the last round of paths misses is made by the tiles that come to
 * need it.  A round's ends are put in the order of a tree (parts.h), and a tile
 * has some that follow each other: a compact part of space.
 *
 * Pixels.  A tile has a square of its lattice's. */
#include "config.h"

#include "passes/passes.h"

#include "base/parts.h"
#include "base/rng.h"
#include "base/vec.h"
#include "image/hdr.h"
#include "light/indirect/ambtile.h"
#include "picture/path.h"
#include "trace/asks.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Apart from the keys of pixels, which have a frame in this place. */
#define BRANCH UINT64_C(0x7061737365730000)

/* Records that are handed on at a time. */
#define BATCH 64

struct end {
    uint32_t path;
    double place; /* in the order of the tree */
};

struct rad_passes {
    const struct rad_frame *frames; /* [fixed] */
    uint32_t nframes;               /* [fixed] */
    uint64_t key;                   /* [fixed] */
    struct rad_pass pass;           /* [fixed] while tiles are made */
    struct end *end;                /* [fixed] likewise: by place */
    uint32_t nends;
};

/* --- paths --- */

static uint64_t
key_of_path(const struct rad_passes *p, uint32_t i)
{
    return rad_key_branch(p->key ^ (uint64_t)p->pass.level, i);
}

/* Walk path i to the end of the pass's bounce; r gets its rays.  False: it
 * leaves the scene before. */
static bool
walk(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t i,
     struct rad_ray r[RAD_PASS_LEVELS + 1])
{
    uint64_t key = key_of_path(p, i);

    if (!rad_path_begin(&p->frames[i % p->nframes], ctx, p->key, i / p->nframes,
                        key, &r[0]))
        return false;
    for (int k = 0; k < p->pass.level; k++)
        if (!rad_path_bounce(ctx, &r[k], key, k, &r[k + 1]) ||
            !rad_path_meet(ctx, &r[k + 1]))
            return false;
    return true;
}

static int
by_place(const void *a, const void *b)
{
    const struct end *x = a, *y = b;

    return x->place != y->place ? (x->place < y->place ? -1 : 1)
           : x->path < y->path  ? -1
                                : x->path > y->path;
}

/* Put the ends into the order of the tree of where they are, at[]. */
static bool
sort_ends(struct rad_passes *p, double (*at)[3])
{
    double(*points)[3] = malloc((size_t)p->nends * sizeof *points);
    struct rad_parts *parts;

    if (!points)
        return false;
    for (uint32_t i = 0; i < p->nends; i++)
        rad_copy(points[i], at[i]);
    parts = rad_parts_new(points, p->nends);
    for (uint32_t i = 0; parts && i < p->nends; i++)
        p->end[i].place = rad_parts_place(parts, at[i]);
    free(points);
    if (!parts)
        return false;
    rad_parts_free(parts);
    qsort(p->end, p->nends, sizeof *p->end, by_place);
    return true;
}

/* Where the paths of the pass end. */
static bool
find_ends(struct rad_passes *p, struct rad_ctx *ctx)
{
    uint32_t n = p->pass.end - p->pass.first;
    double(*at)[3] = malloc((size_t)n * sizeof *at);
    struct rad_ray r[RAD_PASS_LEVELS + 1];
    bool ok = true;

    p->end = malloc(n * sizeof *p->end);
    if (!at || !p->end) {
        free(at);
        return false;
    }
    for (uint32_t i = p->pass.first; i < p->pass.end; i++)
        if (walk(p, ctx, i, r)) {
            rad_copy(at[p->nends], r[p->pass.level].hit.p);
            p->end[p->nends++].path = i;
        }
    if (p->nends > 0)
        ok = sort_ends(p, at);
    free(at);
    return ok;
}

/* Ask for a record where path i ends. */
static void
ask_at_end(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t i)
{
    struct rad_ray r[RAD_PASS_LEVELS + 1];
    uint64_t key = key_of_path(p, i);
    int k = p->pass.level;

    if (!walk(p, ctx, i, r) || rad_ambient_serves(ctx, &r[k]) ||
        !rad_path_bounce(ctx, &r[k - 1], key, k - 1, &r[k]))
        return;
    r[k].key = rad_key_branch(key, RAD_PATH_BRANCH);
    rad_ray_trace(ctx, &r[k]);
}

/* --- tiles --- */

static bool
is_set(const _Atomic bool *stop)
{
    return atomic_load_explicit(stop, memory_order_relaxed);
}

static void
ask_along_paths(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t tile,
                const _Atomic bool *stop)
{
    uint64_t from = (uint64_t)p->nends * tile / p->pass.tiles;
    uint64_t to = (uint64_t)p->nends * (tile + 1) / p->pass.tiles;

    for (; from < to && !is_set(stop); from++)
        ask_at_end(p, ctx, p->end[from].path);
}

/* Ask for what a pixel shows; returns the object that it shows, or RAD_VOID. */
static int32_t
ask_at_pixel(const struct rad_frame *f, struct rad_ctx *ctx, int x, int y)
{
    struct rad_ray r;

    atomic_store_explicit(&ctx->at, RAD_AT(x, y), memory_order_relaxed);
    if (!rad_frame_ray(f, x, y, &r) ||
        !rad_ray_spawn(ctx, &r, RAD_RAY_PRIMARY, NULL, NULL, 0))
        return RAD_VOID;
    rad_ray_trace(ctx, &r);
    return r.hit.obj;
}

/* The pixels that a tile may ask at. */
struct patch {
    const struct rad_frame *frame;
    struct rad_ctx *ctx;
    const _Atomic bool *stop;
    int x0, y0, x1, y1;
    int step;
};

enum { MOST_SIDE = RAD_PASS_SIDE * RAD_PASS_FINEST };

/* A pixel of a tile of the finest lattice. */
struct spot {
    bool asked;
    uint8_t made;  /* records were made here, when pixels so far apart were
                    * asked at; 0: none was */
    int32_t shows; /* an object */
};

struct spots {
    struct spot at[MOST_SIDE][MOST_SIDE]; /* by row */
};

/* The pixel, if it is in the tile and was asked at; else NULL. */
static const struct spot *
asked_at(const struct patch *p, const struct spots *s, int i, int k)
{
    return i >= 0 && k >= 0 && p->x0 + i < p->x1 && p->y0 + k < p->y1 &&
                   s->at[k][i].asked
               ? &s->at[k][i]
               : NULL;
}

static void
ask_at_spot(const struct patch *p, struct spots *s, int i, int k, int distance)
{
    struct spot *at = &s->at[k][i];
    uint32_t made = p->ctx->tile->made;

    at->asked = true;
    at->shows = ask_at_pixel(p->frame, p->ctx, p->x0 + i, p->y0 + k);
    at->made = p->ctx->tile->made > made ? (uint8_t)distance : 0;
}

/* Does something end, or are records dense, between the two? */
static bool
is_between(const struct spot *a, const struct spot *b, int distance)
{
    return a && b &&
           (a->shows != b->shows || a->made == 2 * distance ||
            b->made == 2 * distance);
}

/* Half way between pixels that were asked at, ask where one object ends, or
 * there may be a small one, and where these pixels made records; again at half
 * the distance, and so on. */
static void
ask_between(const struct patch *p, struct spots *s)
{
    for (int d = p->step / 2; d > 0; d /= 2)
        for (int k = 0; p->y0 + k < p->y1; k += d)
            for (int i = 0; p->x0 + i < p->x1 && !is_set(p->stop); i += d)
                if (!s->at[k][i].asked &&
                    (is_between(asked_at(p, s, i - d, k),
                                asked_at(p, s, i + d, k), d) ||
                     is_between(asked_at(p, s, i, k - d),
                                asked_at(p, s, i, k + d), d) ||
                     is_between(asked_at(p, s, i - d, k - d),
                                asked_at(p, s, i + d, k + d), d)))
                    ask_at_spot(p, s, i, k, d);
}

static void
ask_at_finest(const struct patch *p)
{
    struct spots s;

    memset(&s, 0, sizeof s);
    for (int k = 0; p->y0 + k < p->y1; k += p->step)
        for (int i = 0; p->x0 + i < p->x1 && !is_set(p->stop); i += p->step)
            ask_at_spot(p, &s, i, k, p->step);
    ask_between(p, &s);
}

static void
ask_at_coarse(const struct patch *p, int done)
{
    for (int y = p->y0; y < p->y1; y += p->step)
        for (int x = p->x0; x < p->x1 && !is_set(p->stop); x += p->step)
            if (done == 0 || x % done != 0 || y % done != 0)
                ask_at_pixel(p->frame, p->ctx, x, y);
}

static struct patch
patch_of(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t tile,
         const _Atomic bool *stop)
{
    const struct rad_frame *f = p->frames + p->pass.frame;
    int step = p->pass.step;
    struct rad_pass_area a;

    for (uint32_t n;
         tile >= (n = rad_pass_tiles(&p->pass, f->width, f->height));
         f += p->pass.stride)
        tile -= n;
    a = rad_pass_area(&p->pass, f->width, f->height, tile);
    return (struct patch){ f, ctx, stop, a.x0, a.y0, a.x1, a.y1, step };
}

static void
ask_along_lattice(const struct rad_passes *p, const struct patch *patch)
{
    if (p->pass.finest)
        ask_at_finest(patch);
    else
        ask_at_coarse(patch, p->pass.done);
}

/* Trace the pixels of the lattice as those of the picture. */
static void
trace_colours(const struct patch *p, struct rad_pass_colours *out)
{
    struct rad_pixel pixel;

    for (int y = p->y0; y < p->y1; y += p->step)
        for (int x = p->x0; x < p->x1 && !is_set(p->stop); x += p->step) {
            rad_frame_pixel(p->frame, p->ctx, x, y, &pixel);
            rad_rgbe(pixel.L, out->rgbe[out->n++]);
        }
    if (is_set(p->stop)) /* some are missing */
        out->n = 0;
}

/* The context is left as it was: what it blocked last decides how many tests
 * the next rays take. */
static void
look(const struct patch *p, struct rad_pass_colours *out)
{
    struct rad_ctx *ctx = p->ctx;
    size_t n = sizeof *ctx->last_blocker *
               (size_t)rad_sources_targets(ctx->job->sources);
    struct rad_arena_mark mark = rad_arena_mark(&ctx->scratch);
    void *blocker = rad_arena_dup(&ctx->scratch, ctx->last_blocker, n);
    struct rad_counts counts = ctx->counts;

    if (blocker) {
        trace_colours(p, out);
        memcpy(ctx->last_blocker, blocker, n);
    }
    ctx->counts = counts;
    rad_arena_rewind(&ctx->scratch, mark);
}

static void
hand_on(const struct rad_ambtile *tile, rad_passes_fn *fn, void *arg)
{
    struct rad_ambrec rec[BATCH];
    uint64_t cursor = 0;
    size_t n;

    while ((n = rad_ambtile_list(tile, &cursor, rec, BATCH)) > 0)
        fn(arg, rec, n);
}

bool
rad_passes_make(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t tile,
                const _Atomic bool *stop, rad_passes_fn *fn, void *arg,
                struct rad_pass_colours *colours)
{
    struct rad_ambtile own;
    struct patch patch;
    bool whole;

    if (colours)
        colours->n = 0;
    if (!rad_ambtile_begin(&own, ctx, p->pass.level))
        return false;
    ctx->no_direct = true; /* at the places that records are asked for */
    if (p->pass.level > 0) {
        ask_along_paths(p, ctx, tile, stop);
    } else {
        patch = patch_of(p, ctx, tile, stop);
        ask_along_lattice(p, &patch);
    }
    ctx->no_direct = false;
    whole = !is_set(stop) && !own.failed;
    if (whole)
        hand_on(&own, fn, arg);
    if (whole && colours && rad_pass_shows(&p->pass)) /* may make records */
        look(&patch, colours);
    rad_ambtile_end(&own, ctx);
    return whole;
}

/* --- from one pass to the next --- */

int
rad_passes_begin(struct rad_passes *p, struct rad_ctx *ctx,
                 const struct rad_pass *pass, struct rad_error *err)
{
    free(p->end);
    p->end = NULL;
    p->nends = 0;
    p->pass = *pass;
    if (pass->level > 0 && !find_ends(p, ctx))
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    return 0;
}

struct rad_passes *
rad_passes_new(const struct rad_frame *frames, uint32_t nframes,
               struct rad_error *err)
{
    struct rad_passes *p = calloc(1, sizeof *p);

    if (!p) {
        rad_fail(err, RAD_ENOMEM, "out of memory");
        return NULL;
    }
    p->frames = frames;
    p->nframes = nframes;
    p->key = rad_mix64(frames[0].job->params.seed) ^ BRANCH;
    return p;
}

void
rad_passes_free(struct rad_passes *p)
{
    if (!p)
        return;
    free(p->end);
    free(p);
}

const struct rad_frame *
rad_passes_frames(const struct rad_passes *p, uint32_t *n)
{
    *n = p->nframes;
    return p->frames;
}
