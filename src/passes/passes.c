/* passes.c - see passes.h
 *
 * Deep records.  A random path leaves a pixel and bounces from surface to
 * surface; its rays are intersected, but not shaded.  At the end of bounce k it
 * asks for a record of level k, by a ray that is shaded.  These ends are
 * distributed like the hits of hemispheres' rays.  A record that the last round
 * of paths misses is made by the tile that needs it.  The ends of a round are
 * put in the order of a tree (parts.h), and a tile has an interval of them: a
 * compact part of space.  It asks in the order of paths.
 *
 * Pixels.  A tile has a square of its lattice's pixels. */
#include "config.h"

#include "passes/passes.h"

#include "passes/parts.h"
#include "base/rng.h"
#include "base/vec.h"
#include "image/hdr.h"
#include "light/indirect/ambtile.h"
#include "picture/path.h"
#include "trace/ray.h"

#include <stdatomic.h>
#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* Makes the keys of paths differ from those of pixels, which have the number of
 * a frame in its place. */
#define BRANCH UINT64_C(0x7061737365730000)

/* The tree that orders all ends is made of so many of them: each worker makes
 * the tree, and 8 ends for a leaf give much the same tree as all ends. */
#define TREE_ENDS (8 * RAD_PARTS_LEAVES)

/* Records are handed on so many at a time. */
#define BATCH 64

/* The place where a path arrives after some bounces. */
struct bend {
    double p[3];
    float n[3], err, weight; /* as in struct rad_ambplace */
};

/* The state of a path's bends.  Several threads may walk a path at once: the
 * first that is done keeps the bends. */
enum { UNKNOWN, BEING_KEPT, KNOWN };

/* A path. */
struct trail {
    _Atomic uint8_t state; /* of its bends and of `bounces` */
    int8_t bounces; /* before it leaves the scene, rad_passes.deepest at most */
    bool placed;    /* its spots are known */
};

/* The ends of a round of paths, in the order of the tree. */
struct ends {
    int level;
    uint32_t first, beyond; /* paths of the round: first .. beyond - 1 */
    uint32_t frame;         /* first frame of the batch */
    uint32_t *path;         /* path of each end; NULL: ends are not known */
    uint32_t n;             /* ends */
};

struct rad_passes {
    const struct rad_frame *frames; /* [fixed] */
    uint32_t nframes;               /* [fixed] */
    int deepest;                    /* [fixed] level of the deepest records */
    uint32_t frame;                 /* first frame of the batch of the trails */
    struct trail *trail;            /* the paths of that batch */
    uint32_t ntrails;
    struct bend *bend;          /* `deepest` for each path */
    struct rad_pass_spot *spot; /* the places of the bends, roughly */
    struct ends ends[2];        /* of the last two rounds, by pass->round */
};

/* --- paths --- */

/* The key of the paths of the pass's batch. */
static uint64_t
key_of(const struct rad_passes *p, const struct rad_pass *pass)
{
    return rad_mix64(p->frames[0].job->params.seed) ^ BRANCH ^ pass->frame;
}

/* Walk path i for so many bounces; r[k] gets its ray after k bounces.  Returns
 * the number of bounces before it leaves the scene; -1: the pixel shows nothing
 * from which a path could begin. */
static int
walk(const struct rad_passes *p, struct rad_ctx *ctx,
     const struct rad_pass *pass, uint32_t i, int bounces,
     struct rad_ray r[RAD_PASS_LEVELS + 1])
{
    uint64_t all = key_of(p, pass), key = rad_key_branch(all, i);
    uint32_t n = pass->beyond - pass->frame;

    if (!rad_path_begin(&p->frames[pass->frame + i % n], ctx, all, i / n, key,
                        &r[0]))
        return -1;
    for (int k = 0; k < bounces; k++)
        if (!rad_path_bounce(ctx, &r[k], key, k, &r[k + 1]) ||
            !rad_path_meet(ctx, &r[k + 1]))
            return k;
    return bounces;
}

/* The place of path i after k bounces, 1 <= k <= p->deepest. */
static struct bend *
bend_of(const struct rad_passes *p, uint32_t i, int k)
{
    return &p->bend[(size_t)i * (size_t)p->deepest + (size_t)k - 1];
}

static void
keep_bend(const struct rad_ray *r, int k, struct bend *b)
{
    struct rad_ambplace at;

    rad_path_place(r, k, &at);
    rad_copy(b->p, at.p);
    for (int axis = 0; axis < 3; axis++)
        b->n[axis] = (float)at.n[axis];
    b->err = (float)at.err;
    b->weight = (float)at.weight;
}

/* Walk path i to its end; bend[] gets its bends, whose number is returned.
 * They are kept in *p, too, unless another thread has done that. */
static int
find_trail(const struct rad_passes *p, struct rad_ctx *ctx,
           const struct rad_pass *pass, uint32_t i,
           struct bend bend[RAD_PASS_LEVELS])
{
    struct rad_ray r[RAD_PASS_LEVELS + 1];
    struct trail *t = &p->trail[i];
    uint8_t was = UNKNOWN;
    int n = walk(p, ctx, pass, i, p->deepest, r);

    for (int k = 1; k <= n; k++)
        keep_bend(&r[k], k, &bend[k - 1]);
    if (!atomic_compare_exchange_strong(&t->state, &was, BEING_KEPT))
        return n;
    t->bounces = (int8_t)n;
    if (n > 0)
        memcpy(bend_of(p, i, 1), bend, (size_t)n * sizeof *bend);
    atomic_store_explicit(&t->state, KNOWN, memory_order_release);
    return n;
}

static bool
is_known(const struct rad_passes *p, uint32_t i)
{
    return atomic_load_explicit(&p->trail[i].state, memory_order_acquire) ==
           KNOWN;
}

/* Make room for the paths of the pass's batch.  Those of another batch are
 * dropped: no tile of it is made any more.  False: out of memory. */
static bool
make_room(struct rad_passes *p, const struct rad_pass *pass)
{
    size_t bends = (size_t)pass->paths * (size_t)p->deepest;

    if (pass->frame == p->frame && pass->paths == p->ntrails)
        return true;
    free(p->trail);
    free(p->bend);
    free(p->spot);
    p->trail = calloc(pass->paths, sizeof *p->trail);
    p->bend = malloc(bends * sizeof *p->bend);
    p->spot = malloc(bends * sizeof *p->spot);
    p->frame = pass->frame;
    p->ntrails = p->trail && p->bend && p->spot ? pass->paths : 0;
    return p->ntrails > 0;
}

/* --- where paths go, roughly --- */

/* Set *out to the spot of a point. */
static void
set_spot(const struct rad_passes *p, const double at[3],
         struct rad_pass_spot *out)
{
    double org[3], side;

    rad_ambient_cube(p->frames->job->ambient, org, &side);
    for (int axis = 0; axis < 3; axis++) {
        double q = (at[axis] - org[axis]) / side * RAD_PASS_NO_SPOT;

        out->at[axis] =
            (uint16_t)(q < 0                  ? 0
                       : q < RAD_PASS_NO_SPOT ? q
                                              : RAD_PASS_NO_SPOT - 1);
    }
}

/* Set out[] to the spots of a path with n bends. */
static void
set_spots(const struct rad_passes *p, const struct bend *bend, int n,
          struct rad_pass_spot *out)
{
    for (int k = 0; k < p->deepest; k++)
        if (k < n)
            set_spot(p, bend[k].p, &out[k]);
        else
            out[k] = (struct rad_pass_spot){ { RAD_PASS_NO_SPOT } };
}

static struct rad_pass_spot *
spots_of(const struct rad_passes *p, uint32_t i)
{
    return &p->spot[(size_t)i * (size_t)p->deepest];
}

bool
rad_passes_place(struct rad_passes *p, const struct rad_pass *pass,
                 const struct rad_pass_spot *spot)
{
    if (!make_room(p, pass))
        return false;
    memcpy(p->spot, spot,
           (size_t)pass->paths * (size_t)p->deepest * sizeof *spot);
    for (uint32_t i = 0; i < pass->paths; i++)
        p->trail[i].placed = true;
    return true;
}

/* Find the spots of path i, by a walk if its bends are not known. */
static void
place_path(const struct rad_passes *p, struct rad_ctx *ctx,
           const struct rad_pass *pass, uint32_t i)
{
    struct bend bend[RAD_PASS_LEVELS];
    struct trail *t = &p->trail[i];

    if (is_known(p, i))
        set_spots(p, bend_of(p, i, 1), t->bounces, spots_of(p, i));
    else
        set_spots(p, bend, find_trail(p, ctx, pass, i, bend), spots_of(p, i));
    t->placed = true;
}

/* Find the missing spots of the pass's paths.  The rays are not counted: they
 * count in the tiles of the pass that walks. */
static void
place_paths(const struct rad_passes *p, struct rad_ctx *ctx,
            const struct rad_pass *pass)
{
    struct rad_counts counts = ctx->counts;

    for (uint32_t i = pass->first; i < pass->end; i++)
        if (!p->trail[i].placed)
            place_path(p, ctx, pass, i);
    ctx->counts = counts;
}

/* The place of a path's end, in the units of struct rad_pass_spot. */
static void
end_at(const struct rad_passes *p, const struct ends *e, uint32_t path,
       double at[3])
{
    const uint16_t *spot = spots_of(p, path)[e->level - 1].at;

    for (int axis = 0; axis < 3; axis++)
        at[axis] = spot[axis];
}

/* Make the tree that orders the ends, of about TREE_ENDS of them, evenly
 * chosen.  NULL: out of memory. */
static struct rad_parts *
plant(const struct rad_passes *p, const struct ends *e)
{
    uint32_t apart = e->n / TREE_ENDS + 1, n = 0;
    double(*point)[3] = malloc((size_t)e->n * sizeof *point);
    struct rad_parts *parts;

    for (uint32_t i = 0; point && i < e->n; i += apart)
        end_at(p, e, e->path[i], point[n++]);
    parts = point ? rad_parts_new(point, n) : NULL;
    free(point);
    return parts;
}

/* Put the ends into the order of the tree's leaves; within a leaf they stay in
 * the order of paths.  False: out of memory. */
static bool
sort_ends(const struct rad_passes *p, struct ends *e)
{
    struct rad_parts *parts = plant(p, e);
    uint32_t *sorted = malloc(e->n * sizeof *sorted);
    uint16_t *leaf = malloc(e->n * sizeof *leaf);
    uint32_t first[RAD_PARTS_LEAVES + 1] = { 0 }; /* of each leaf */
    bool whole = parts && sorted && leaf;
    double at[3];

    for (uint32_t i = 0; whole && i < e->n; i++) {
        end_at(p, e, e->path[i], at);
        leaf[i] = (uint16_t)(rad_parts_place(parts, at) * RAD_PARTS_LEAVES);
        first[leaf[i] + 1]++;
    }
    for (int i = 0; i < RAD_PARTS_LEAVES; i++)
        first[i + 1] += first[i];
    for (uint32_t i = 0; whole && i < e->n; i++)
        sorted[first[leaf[i]]++] = e->path[i];
    free(leaf);
    rad_parts_free(parts);
    free(whole ? e->path : sorted);
    e->path = whole ? sorted : e->path;
    return whole;
}

/* The ends of the pass's round, or NULL if they are not known.  (The ends of
 * the next round may be found at the same time.) */
static const struct ends *
ends_of(const struct rad_passes *p, const struct rad_pass *pass)
{
    const struct ends *e = &p->ends[pass->round];

    return e->path && e->level == pass->level && e->first == pass->first &&
                   e->beyond == pass->end && e->frame == pass->frame
               ? e
               : NULL;
}

/* Find and order the ends of the pass's round, while tiles of the round before
 * may be under way.  False: out of memory. */
static bool
find_ends(struct rad_passes *p, struct rad_ctx *ctx,
          const struct rad_pass *pass)
{
    struct ends *e = &p->ends[pass->round];

    free(e->path);
    *e = (struct ends){ .level = pass->level,
                        .first = pass->first,
                        .beyond = pass->end,
                        .frame = pass->frame,
                        .path = malloc((pass->end - pass->first) *
                                       sizeof *e->path) };
    if (!e->path)
        return false;
    place_paths(p, ctx, pass);
    for (uint32_t i = pass->first; i < pass->end; i++)
        if (spots_of(p, i)[pass->level - 1].at[0] != RAD_PASS_NO_SPOT)
            e->path[e->n++] = i;
    return e->n == 0 || sort_ends(p, e);
}

/* Set *out to the place where path i ends; false: the path does not get so far.
 * If the path is walked for this, the rays are not counted, since threads that
 * know its bends do not walk. */
static bool
find_end(const struct rad_passes *p, struct rad_ctx *ctx,
         const struct rad_pass *pass, uint32_t i, struct bend *out)
{
    struct rad_ray r[RAD_PASS_LEVELS + 1];
    struct rad_counts counts = ctx->counts;
    int k = pass->level;
    bool there;

    if (is_known(p, i)) {
        *out = *bend_of(p, i, k);
        return k <= p->trail[i].bounces;
    }
    there = walk(p, ctx, pass, i, k, r) == k;
    ctx->counts = counts;
    if (there)
        keep_bend(&r[k], k, out);
    return there;
}

/* Do records serve the place? */
static bool
is_served(struct rad_ctx *ctx, int level, const struct bend *b)
{
    struct rad_ambplace at = { .err = (double)b->err,
                               .level = level,
                               .weight = (double)b->weight };

    rad_copy(at.p, b->p);
    for (int axis = 0; axis < 3; axis++)
        at.n[axis] = at.pn[axis] = (double)b->n[axis];
    return rad_ambient_serves(ctx, &at);
}

/* Have a record made where path i ends, unless records serve there.  The rays
 * of the walk are added to *walked: the context counts them as ambient rays,
 * like those of hemispheres. */
static void
ask_at_end(const struct rad_passes *p, struct rad_ctx *ctx,
           const struct rad_pass *pass, uint32_t i, uint64_t *walked)
{
    struct rad_ray r[RAD_PASS_LEVELS + 1];
    int k = pass->level;
    uint64_t key = rad_key_branch(key_of(p, pass), i);
    uint64_t before = ctx->counts.ambient_rays;
    struct bend b;
    bool asks = find_end(p, ctx, pass, i, &b) && !is_served(ctx, k, &b) &&
                walk(p, ctx, pass, i, k - 1, r) == k - 1 &&
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

/* When a tile asks for nothing more: it is stopped, or has traced its rays. */
struct limit {
    const struct rad_ctx *ctx;
    const _Atomic bool *stop;
    uint64_t rays;   /* the tile is over when the context's ambient rays, less
                      * `walked`, are as many */
    uint64_t walked; /* rays of paths, which do not count here */
};

static struct limit
limit_of(const struct rad_pass *pass, const struct rad_ctx *ctx,
         const _Atomic bool *stop)
{
    uint64_t most = pass->rays;

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

/* Compare two numbers of paths, for qsort(). */
static int
compare_paths(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;

    return (*x > *y) - (*x < *y);
}

/* Ask for records at the ends that are the tile's, in the order of paths: they
 * are random.  In the order of the tree, from one side of the tile's part of
 * space to the other, each record would lie on the same side of the places that
 * it serves, and there be too much or too little light with it.  False: out of
 * memory. */
static bool
ask_along_paths(const struct rad_passes *p, struct rad_ctx *ctx,
                const struct rad_pass *pass, uint32_t tile, struct limit *until)
{
    const struct ends *e = ends_of(p, pass);
    uint32_t first, all = rad_pass_round(pass, &first);
    size_t from = (size_t)((uint64_t)e->n * (first + tile) / all);
    size_t n = (size_t)((uint64_t)e->n * (first + tile + 1) / all) - from;
    struct rad_arena_mark mark = rad_arena_mark(&ctx->scratch);
    uint32_t *path = rad_arena_alloc(&ctx->scratch, (n + 1) * sizeof *path);

    if (!path)
        return false;
    memcpy(path, e->path + from, n * sizeof *path);
    qsort(path, n, sizeof *path, compare_paths);
    for (size_t i = 0; i < n && !is_over(until); i++)
        ask_at_end(p, ctx, pass, path[i], &until->walked);
    rad_arena_rewind(&ctx->scratch, mark);
    return true;
}

/* --- paths of a pass that walks --- */

bool
rad_passes_walk(const struct rad_passes *p, struct rad_ctx *ctx,
                const struct rad_pass *pass, uint32_t tile,
                const _Atomic bool *stop, struct rad_pass_spot *out)
{
    uint32_t first, n = rad_pass_paths(pass, tile, &first);

    for (uint32_t i = first; i < first + n && !is_set(stop); i++) {
        struct bend bend[RAD_PASS_LEVELS];
        int bends = find_trail(p, ctx, pass, i, bend);

        if (out)
            set_spots(p, bend, bends,
                      &out[(size_t)(i - first) * (size_t)p->deepest]);
    }
    return !is_set(stop);
}

/* Ask for a record at the point that a pixel shows. */
static void
ask_at_pixel(const struct rad_frame *f, struct rad_ctx *ctx, int x, int y)
{
    struct rad_ray r;

    atomic_store_explicit(&ctx->at, RAD_AT(x, y), memory_order_relaxed);
    rad_frame_look(f, ctx, x, y, &r);
}

/* A square of pixels at which a tile asks for records. */
struct patch {
    const struct rad_frame *frame;
    struct rad_ctx *ctx;
    const struct limit *until;
    int x0, y0, x1, y1; /* x1 and y1 beyond the last */
    int step;           /* of the lattice */
};

/* A pixel of a tile of the finest lattice. */
struct spot {
    bool asked;
    uint8_t made; /* if asking here made a record: the distance of the pixels
                   * that were asked at then; else 0 */
};

struct spots {
    bool made;                                        /* a record was made */
    struct spot at[RAD_PASS_PIXELS][RAD_PASS_PIXELS]; /* by row */
};

/* Ask at pixel (i, k) of the patch, when pixels at that distance are asked at.
 */
static void
ask_at_spot(const struct patch *p, struct spots *s, int i, int k, int distance)
{
    struct spot *at = &s->at[k][i];
    uint32_t made = p->ctx->tile->made;

    at->asked = true;
    ask_at_pixel(p->frame, p->ctx, p->x0 + i, p->y0 + k);
    at->made = p->ctx->tile->made > made ? (uint8_t)distance : 0;
    s->made |= at->made > 0;
}

/* Pixel (i, k) of the patch, if it was asked at; else NULL.  A pixel beyond the
 * patch counts as asked at, with no record made. */
static const struct spot *
asked_at(const struct patch *p, const struct spots *s, int i, int k)
{
    static const struct spot beyond = { .made = 0 };

    if (i < 0 || k < 0 || p->x0 + i >= p->x1 || p->y0 + k >= p->y1)
        return &beyond;
    return s->at[k][i].asked ? &s->at[k][i] : NULL;
}

/* Is a pixel half way between a and b wanted?  Yes, if one of them made a
 * record when it was asked at. */
static bool
is_between(const struct spot *a, const struct spot *b, int distance)
{
    return a && b && (a->made == 2 * distance || b->made == 2 * distance);
}

/* Is pixel (i, k), half way between pixels at distance d, wanted? */
static bool
is_wanted(const struct patch *p, const struct spots *s, int i, int k, int d)
{
    return is_between(asked_at(p, s, i - d, k), asked_at(p, s, i + d, k), d) ||
           is_between(asked_at(p, s, i, k - d), asked_at(p, s, i, k + d), d) ||
           is_between(asked_at(p, s, i - d, k - d),
                      asked_at(p, s, i + d, k + d), d);
}

/* Ask half way between pixels that made records when they were asked at; then
 * again at half the distance, and so on. */
static void
ask_between(const struct patch *p, struct spots *s)
{
    for (int d = p->step / 2; d > 0; d /= 2)
        for (int k = 0; p->y0 + k < p->y1; k += d)
            for (int i = 0; p->x0 + i < p->x1 && !is_over(p->until); i += d)
                if (!s->at[k][i].asked && is_wanted(p, s, i, k, d))
                    ask_at_spot(p, s, i, k, d);
}

/* Ask at a patch of the finest lattice, or of a scattered pass. */
static void
ask_at_finest(const struct patch *p)
{
    struct spots s;

    s.made = false;
    memset(s.at, 0, (size_t)(p->y1 - p->y0) * sizeof s.at[0]);
    for (int k = 0; p->y0 + k < p->y1; k += p->step)
        for (int i = 0; p->x0 + i < p->x1 && !is_over(p->until); i += p->step)
            ask_at_spot(p, &s, i, k, p->step);
    if (s.made)
        ask_between(p, &s);
}

/* Ask at a patch of a lattice that is not the finest, except at pixels of the
 * lattice of step `done`, which is over. */
static void
ask_at_coarse(const struct patch *p, int done)
{
    for (int y = p->y0; y < p->y1; y += p->step)
        for (int x = p->x0; x < p->x1 && !is_over(p->until); x += p->step)
            if (done == 0 || x % done != 0 || y % done != 0)
                ask_at_pixel(p->frame, p->ctx, x, y);
}

/* Set *out to square number `number` of the pass. */
static void
find_patch(const struct rad_passes *p, struct rad_ctx *ctx,
           const struct rad_pass *pass, uint32_t number,
           const struct limit *until, struct patch *out)
{
    struct rad_pass_area a;

    for (uint32_t i = pass->frame, n; i < pass->beyond; i += pass->stride) {
        const struct rad_frame *f = &p->frames[i];

        n = rad_pass_tiles(pass, f->width, f->height);
        if (number < n) {
            a = rad_pass_area(pass, f->width, f->height, number);
            *out = (struct patch){ .frame = f,
                                   .ctx = ctx,
                                   .until = until,
                                   .x0 = a.x0,
                                   .y0 = a.y0,
                                   .x1 = a.x1,
                                   .y1 = a.y1,
                                   .step = pass->step };
            return;
        }
        number -= n;
    }
    assert(!"no such square");
}

/* Ask at the squares of a tile.  *patch gets the last square. */
static void
ask_along_lattice(const struct rad_passes *p, struct rad_ctx *ctx,
                  const struct rad_pass *pass, uint32_t tile,
                  const struct limit *until, struct patch *patch)
{
    uint32_t n = rad_pass_squares(pass, tile);

    for (uint32_t i = 0; i < n; i++) {
        find_patch(p, ctx, pass, rad_pass_square(pass, tile, i), until, patch);
        if (pass->finest)
            ask_at_finest(patch);
        else
            ask_at_coarse(patch, pass->done);
    }
}

/* Trace the patch's pixels with all their light. */
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
    if (is_set(p->until->stop)) /* pixels are missing */
        out->n = 0;
}

/* Set *out to the colours of the patch's pixels, for a preview.  Good records
 * would cost far more than all else, so coarse records serve (ctx->glance). */
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

/* Keep the records of that level; returns their number. */
static size_t
keep_level(struct rad_ambrec *rec, size_t n, int level)
{
    size_t kept = 0;

    for (size_t i = 0; i < n; i++)
        if (rec[i].level == level)
            rec[kept++] = rec[i];
    return kept;
}

/* Call fn with the tile's records, with `most` of them at most; level: with
 * records of this level, -1: of all levels.  Returns the number handed on. */
static size_t
hand_on_some(const struct rad_ambtile *tile, int level, size_t most,
             rad_passes_fn *fn, void *arg)
{
    struct rad_ambrec rec[BATCH];
    uint64_t cursor = 0;
    size_t n, sent = 0;

    while (sent < most &&
           (n = rad_ambtile_list(tile, &cursor, rec, BATCH)) > 0) {
        n = level < 0 ? n : keep_level(rec, n, level);
        n = n < most - sent ? n : most - sent;
        fn(arg, rec, n);
        sent += n;
    }
    return sent;
}

/* Call fn with the tile's records.  If there are too many, deep records are
 * left out, for a deep record serves fewer pixels, and tiles nearby often make
 * the same record. */
static void
hand_on(const struct rad_ambtile *tile, int levels, rad_passes_fn *fn,
        void *arg)
{
    size_t left = RAD_PASS_MOST_RECORDS;

    if (!tile->own || rad_ambcache_count(tile->own) <= left)
        hand_on_some(tile, -1, left, fn, arg);
    else
        for (int level = 0; level < levels && left > 0; level++)
            left -= hand_on_some(tile, level, left, fn, arg);
}

bool
rad_passes_make(const struct rad_passes *p, struct rad_ctx *ctx,
                const struct rad_passes_order *o)
{
    const struct rad_pass *pass = o->pass;
    struct limit until = limit_of(pass, ctx, o->stop);
    struct rad_ambtile own;
    struct patch patch = { .frame = NULL }; /* of a lattice: the last square */
    bool whole;

    if (o->colours)
        o->colours->n = 0;
    if (pass->walks)
        return rad_passes_walk(p, ctx, pass, o->tile, o->stop, NULL);
    rad_ambtile_begin(&own, ctx, pass->level, o->seen);
    own.most = until.rays;
    own.end = pass->rays ? until.rays + pass->rays : UINT64_MAX;
    ctx->no_direct = true; /* only hits of hemispheres need direct light */
    if (pass->level > 0)
        own.failed |= !ask_along_paths(p, ctx, pass, o->tile, &until);
    else
        ask_along_lattice(p, ctx, pass, o->tile, &until, &patch);
    ctx->no_direct = false;
    whole = !is_set(o->stop) && !own.failed;
    if (whole)
        hand_on(&own, ctx->job->params.ambounce, o->fn, o->arg);
    own.end = UINT64_MAX;
    if (whole && o->colours && rad_pass_shows(pass))
        look(&patch, o->colours);
    rad_ambtile_end(&own, ctx);
    return whole;
}

/* --- from one pass to the next --- */

int
rad_passes_begin(struct rad_passes *p, struct rad_ctx *ctx,
                 const struct rad_pass *pass, struct rad_error *err)
{
    if ((pass->walks && !make_room(p, pass)) ||
        (pass->level > 0 && !ends_of(p, pass) &&
         (!make_room(p, pass) || !find_ends(p, ctx, pass))))
        return rad_fail_memory(err);
    return 0;
}

struct rad_passes *
rad_passes_new(const struct rad_frame *frames, uint32_t nframes,
               struct rad_error *err)
{
    struct rad_passes *p = calloc(1, sizeof *p);

    if (!p) {
        rad_fail_memory(err);
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
    free(p->spot);
    free(p->ends[0].path);
    free(p->ends[1].path);
    free(p);
}

const struct rad_frame *
rad_passes_frames(const struct rad_passes *p, uint32_t *n)
{
    *n = p->nframes;
    return p->frames;
}
