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

#include "picture/parts.h"
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

/* Where a path arrives after some bounces. */
struct bend {
    double p[3];
    float n[3], err, weight; /* as in struct rad_ambplace */
};

/* Where a path goes. */
struct trail {
    bool known;
    int8_t bounces; /* then it leaves the scene, or has as many as matter */
};

struct rad_passes {
    const struct rad_frame *frames; /* [fixed] */
    uint32_t nframes;               /* [fixed] */
    uint64_t key;                   /* [fixed] while tiles are made */
    struct rad_pass pass;           /* [fixed] while tiles are made */
    struct trail *trail;            /* [fixed] likewise: of paths so far */
    uint32_t ntrails;
    int deepest;       /* [fixed] bounces that matter, */
    struct bend *bend; /* [fixed] so many for each trail */
    struct end *end;   /* [fixed] likewise: by place */
    uint32_t nends;
};

/* --- paths --- */

/* Walk path i to the end of so many bounces; r gets its rays.  Returns how
 * many there are before it leaves the scene, or -1. */
static int
walk(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t i, int bounces,
     struct rad_ray r[RAD_PASS_LEVELS + 1])
{
    uint64_t key = rad_key_branch(p->key, i);
    uint32_t n = p->pass.beyond - p->pass.frame;

    if (!rad_path_begin(&p->frames[p->pass.frame + i % n], ctx, p->key, i / n,
                        key, &r[0]))
        return -1;
    for (int k = 0; k < bounces; k++)
        if (!rad_path_bounce(ctx, &r[k], key, k, &r[k + 1]) ||
            !rad_path_meet(ctx, &r[k + 1]))
            return k;
    return bounces;
}

/* Where path i is after k bounces, 1 to those that matter. */
static struct bend *
bend_of(const struct rad_passes *p, uint32_t i, int k)
{
    return &p->bend[(size_t)i * (size_t)p->deepest + (size_t)k - 1];
}

static void
find_trail(struct rad_passes *p, struct rad_ctx *ctx, uint32_t i)
{
    struct rad_ray r[RAD_PASS_LEVELS + 1];
    struct rad_ambplace at;
    int n = walk(p, ctx, i, p->deepest, r);

    p->trail[i] = (struct trail){ true, (int8_t)n };
    for (int k = 1; k <= n; k++) {
        struct bend *b = bend_of(p, i, k);

        rad_path_place(&r[k], k, &at);
        rad_copy(b->p, at.p);
        for (int axis = 0; axis < 3; axis++)
            b->n[axis] = (float)at.n[axis];
        b->err = (float)at.err;
        b->weight = (float)at.weight;
    }
}

static bool
make_room(struct rad_passes *p, uint32_t n)
{
    struct trail *trail = realloc(p->trail, n * sizeof *trail);
    struct bend *bend;

    p->trail = trail ? trail : p->trail;
    bend = realloc(p->bend, (size_t)n * (size_t)p->deepest * sizeof *bend);
    p->bend = bend ? bend : p->bend;
    if (!trail || !bend)
        return false;
    memset(trail + p->ntrails, 0, (n - p->ntrails) * sizeof *trail);
    p->ntrails = n;
    return true;
}

/* Find the trails of the pass's paths.  Their rays count in the first pass that
 * has them, that of the deepest records. */
static bool
find_trails(struct rad_passes *p, struct rad_ctx *ctx)
{
    const struct rad_pass *pass = &p->pass;
    struct rad_counts counts = ctx->counts;

    if (pass->end > p->ntrails && !make_room(p, pass->end))
        return false;
    for (uint32_t i = pass->first; i < pass->end; i++)
        if (!p->trail[i].known)
            find_trail(p, ctx, i);
    if (pass->level < p->deepest)
        ctx->counts = counts; /* of a worker that came late */
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

/* Put the ends into the order of the tree of where they are. */
static bool
sort_ends(struct rad_passes *p)
{
    double(*points)[3] = malloc((size_t)p->nends * sizeof *points);
    struct rad_parts *parts;

    if (!points)
        return false;
    for (uint32_t i = 0; i < p->nends; i++)
        rad_copy(points[i], bend_of(p, p->end[i].path, p->pass.level)->p);
    parts = rad_parts_new(points, p->nends);
    for (uint32_t i = 0; parts && i < p->nends; i++)
        p->end[i].place = rad_parts_place(
            parts, bend_of(p, p->end[i].path, p->pass.level)->p);
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
    p->end = malloc((p->pass.end - p->pass.first) * sizeof *p->end);
    if (!p->end || !find_trails(p, ctx))
        return false;
    for (uint32_t i = p->pass.first; i < p->pass.end; i++)
        if (p->trail[i].bounces >= p->pass.level)
            p->end[p->nends++].path = i;
    return p->nends == 0 || sort_ends(p);
}

static bool
is_served(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t i)
{
    const struct bend *b = bend_of(p, i, p->pass.level);
    struct rad_ambplace at = { .err = (double)b->err,
                               .level = p->pass.level,
                               .weight = (double)b->weight };

    rad_copy(at.p, b->p);
    for (int axis = 0; axis < 3; axis++)
        at.n[axis] = at.pn[axis] = (double)b->n[axis];
    return rad_ambient_serves(ctx, &at);
}

/* Have a record made where path i ends, if there is none.  *walked: add the
 * rays of the walk, which count as those of hemispheres, too. */
static void
ask_at_end(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t i,
           uint64_t *walked)
{
    struct rad_ray r[RAD_PASS_LEVELS + 1];
    int k = p->pass.level;
    uint64_t key = rad_key_branch(p->key, i), before = ctx->counts.ambient_rays;
    bool asks = !is_served(p, ctx, i) && walk(p, ctx, i, k - 1, r) == k - 1 &&
                rad_path_bounce(ctx, &r[k - 1], key, k - 1, &r[k]);

    *walked += ctx->counts.ambient_rays - before;
    if (!asks)
        return;
    r[k].key = rad_key_branch(key ^ (uint64_t)k, RAD_PATH_BRANCH);
    rad_ray_trace(ctx, &r[k]);
}

/* --- tiles --- */

static bool
is_set(const _Atomic bool *stop)
{
    return atomic_load_explicit(stop, memory_order_relaxed);
}

/* When a tile asks for nothing more. */
struct limit {
    const struct rad_ctx *ctx;
    const _Atomic bool *stop;
    uint64_t rays;   /* of hemispheres, as the context counts them; */
    uint64_t walked; /* and of paths, which do not count here */
};

static struct limit
limit_of(const struct rad_passes *p, const struct rad_ctx *ctx,
         const _Atomic bool *stop)
{
    uint64_t most = p->pass.rays;

    return (struct limit){ ctx, stop,
                           most ? ctx->counts.ambient_rays + most : UINT64_MAX,
                           0 };
}

static bool
is_over(const struct limit *until)
{
    return is_set(until->stop) ||
           until->ctx->counts.ambient_rays - until->walked >= until->rays;
}

static void
ask_along_paths(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t tile,
                struct limit *until)
{
    uint64_t from = (uint64_t)p->nends * tile / p->pass.tiles;
    uint64_t to = (uint64_t)p->nends * (tile + 1) / p->pass.tiles;

    for (; from < to && !is_over(until); from++)
        ask_at_end(p, ctx, p->end[from].path, &until->walked);
}

/* Ask for what a pixel shows; returns the object that it shows, or RAD_VOID. */
static int32_t
ask_at_pixel(const struct rad_frame *f, struct rad_ctx *ctx, int x, int y)
{
    struct rad_ray r;

    atomic_store_explicit(&ctx->at, RAD_AT(x, y), memory_order_relaxed);
    return rad_frame_look(f, ctx, x, y, &r) ? r.hit.obj : RAD_VOID;
}

/* The pixels that a tile may ask at. */
struct patch {
    const struct rad_frame *frame;
    struct rad_ctx *ctx;
    const struct limit *until;
    int x0, y0, x1, y1;
    int step;
    bool objects; /* ask between those that show different ones */
};

/* A pixel of a tile of the finest lattice. */
struct spot {
    bool asked;
    uint8_t made;  /* records were made here, when pixels so far apart were
                    * asked at; 0: none was */
    int32_t shows; /* an object */
};

struct spots {
    bool differ; /* some show different objects, or made records */
    struct spot at[RAD_PASS_PIXELS][RAD_PASS_PIXELS]; /* by row */
};

static void
ask_at_spot(const struct patch *p, struct spots *s, int i, int k, int distance)
{
    struct spot *at = &s->at[k][i];
    uint32_t made = p->ctx->tile->made;

    at->asked = true;
    at->shows = ask_at_pixel(p->frame, p->ctx, p->x0 + i, p->y0 + k);
    at->made = p->ctx->tile->made > made ? (uint8_t)distance : 0;
    s->differ |= at->made || at->shows != s->at[0][0].shows;
}

/* The pixel, if it is in the tile and was asked at; else NULL.  Where objects
 * do not matter those beyond the tile were, and made nothing. */
static const struct spot *
asked_at(const struct patch *p, const struct spots *s, int i, int k)
{
    static const struct spot beyond = { .shows = RAD_VOID };

    if (i < 0 || k < 0 || p->x0 + i >= p->x1 || p->y0 + k >= p->y1)
        return p->objects ? NULL : &beyond;
    return s->at[k][i].asked ? &s->at[k][i] : NULL;
}

/* Does something end, or are records dense, between the two? */
static bool
is_between(const struct patch *p, const struct spot *a, const struct spot *b,
           int distance)
{
    return a && b &&
           (a->made == 2 * distance || b->made == 2 * distance ||
            (p->objects && a->shows != b->shows));
}

static bool
is_wanted(const struct patch *p, const struct spots *s, int i, int k, int d)
{
    return is_between(p, asked_at(p, s, i - d, k), asked_at(p, s, i + d, k),
                      d) ||
           is_between(p, asked_at(p, s, i, k - d), asked_at(p, s, i, k + d),
                      d) ||
           is_between(p, asked_at(p, s, i - d, k - d),
                      asked_at(p, s, i + d, k + d), d);
}

/* Half way between pixels that were asked at, ask where one object ends, or
 * there may be a small one, and where these pixels made records; again at half
 * the distance, and so on. */
static void
ask_between(const struct patch *p, struct spots *s)
{
    for (int d = p->step / 2; d > 0; d /= 2)
        for (int k = 0; p->y0 + k < p->y1; k += d)
            for (int i = 0; p->x0 + i < p->x1 && !is_over(p->until); i += d)
                if (!s->at[k][i].asked && is_wanted(p, s, i, k, d))
                    ask_at_spot(p, s, i, k, d);
}

static void
ask_at_finest(const struct patch *p)
{
    struct spots s;

    s.differ = false;
    memset(s.at, 0, (size_t)(p->y1 - p->y0) * sizeof s.at[0]);
    for (int k = 0; p->y0 + k < p->y1; k += p->step)
        for (int i = 0; p->x0 + i < p->x1 && !is_over(p->until); i += p->step)
            ask_at_spot(p, &s, i, k, p->step);
    if (s.differ)
        ask_between(p, &s);
}

static void
ask_at_coarse(const struct patch *p, int done)
{
    for (int y = p->y0; y < p->y1; y += p->step)
        for (int x = p->x0; x < p->x1 && !is_over(p->until); x += p->step)
            if (done == 0 || x % done != 0 || y % done != 0)
                ask_at_pixel(p->frame, p->ctx, x, y);
}

/* The square of that number; false: there is none. */
static bool
find_patch(const struct rad_passes *p, struct rad_ctx *ctx, uint32_t number,
           const struct limit *until, struct patch *out)
{
    struct rad_pass_area a;

    for (uint32_t i = p->pass.frame, n; i < p->pass.beyond;
         i += p->pass.stride) {
        const struct rad_frame *f = &p->frames[i];

        n = rad_pass_tiles(&p->pass, f->width, f->height);
        if (number < n) {
            a = rad_pass_area(&p->pass, f->width, f->height, number);
            *out = (struct patch){ .frame = f,
                                   .ctx = ctx,
                                   .until = until,
                                   .x0 = a.x0,
                                   .y0 = a.y0,
                                   .x1 = a.x1,
                                   .y1 = a.y1,
                                   .step = p->pass.step,
                                   .objects = !p->pass.scattered };
            return true;
        }
        number -= n;
    }
    return false;
}

/* Ask at the squares of a tile, one unless the pass is scattered, the last of
 * which is *patch then. */
static void
ask_along_lattice(const struct rad_passes *p, struct rad_ctx *ctx,
                  uint32_t tile, const struct limit *until, struct patch *patch)
{
    for (; find_patch(p, ctx, tile, until, patch); tile += p->pass.tiles)
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
        for (int x = p->x0; x < p->x1 && !is_set(p->until->stop);
             x += p->step) {
            rad_frame_pixel(p->frame, p->ctx, x, y, &pixel);
            rad_rgbe(pixel.L, out->rgbe[out->n++]);
        }
    if (is_set(p->until->stop)) /* some are missing */
        out->n = 0;
}

/* What somebody sees for a while is worth no good records, which would cost far
 * more than the rest of the look. */
static void
look(const struct patch *p, struct rad_pass_colours *out)
{
    struct rad_ctx *ctx = p->ctx;
    struct rad_counts counts = ctx->counts;

    ctx->glance = true;
    trace_colours(p, out);
    ctx->glance = false;
    ctx->counts = counts;
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
    struct limit until = limit_of(p, ctx, stop);
    struct rad_ambtile own;
    struct patch patch;
    bool whole;

    if (colours)
        colours->n = 0;
    rad_ambtile_begin(&own, ctx, p->pass.level);
    own.most = until.rays;
    ctx->no_direct = true; /* at the places that records are asked for */
    if (p->pass.level > 0)
        ask_along_paths(p, ctx, tile, &until);
    else
        ask_along_lattice(p, ctx, tile, &until, &patch);
    ctx->no_direct = false;
    whole = !is_set(stop) && !own.failed;
    if (whole)
        hand_on(&own, fn, arg);
    if (whole && colours && rad_pass_shows(&p->pass))
        look(&patch, colours);
    rad_ambtile_end(&own, ctx);
    return whole;
}

/* --- from one pass to the next --- */

/* Of the paths of the pass's batch. */
static uint64_t
key_of(const struct rad_passes *p, const struct rad_pass *pass)
{
    return rad_mix64(p->frames[0].job->params.seed) ^ BRANCH ^ pass->frame;
}

int
rad_passes_begin(struct rad_passes *p, struct rad_ctx *ctx,
                 const struct rad_pass *pass, struct rad_error *err)
{
    free(p->end);
    p->end = NULL;
    p->nends = 0;
    if (pass->frame != p->pass.frame)
        p->ntrails = 0; /* another batch's */
    p->pass = *pass;
    p->key = key_of(p, pass);
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
    p->deepest = rad_pass_deepest(&frames->job->params);
    return p;
}

void
rad_passes_free(struct rad_passes *p)
{
    if (!p)
        return;
    free(p->trail);
    free(p->bend);
    free(p->end);
    free(p);
}

const struct rad_frame *
rad_passes_frames(const struct rad_passes *p, uint32_t *n)
{
    *n = p->nframes;
    return p->frames;
}
