/* seed.c - see seed.h
 *
 * Paths tell where rays of hemispheres go.  They are few, for all who share the
 * work walk all of them; what they meet, in the order of the tree (parts.h), is
 * a map, cut into cells of a few points.  Then each goes from cell to cell of
 * its own part and asks for records: from where some path is, a ray goes to a
 * place between two points of the cell.  Places that are often hit so come up
 * sooner.
 * Many more records are in small zones in corners and between things.  Those
 * are seldom asked for by two at once, and to look for them takes longer than
 * to make them; so a cell is left where many that were asked for running were
 * there.
 * One part takes longer than another, and nobody waits for it: so each goes
 * over its cells twice, and what is wanted most comes first; and a part is in
 * pieces. */
#include "config.h"

#include "picture/seed.h"
#include "picture/parts.h"
#include "base/rng.h"
#include "base/vec.h"
#include "light/indirect/ambient.h"
#include "picture/path.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Paths: one for so many pixels, within these bounds.  Fewer pixels need but
 * some of the records: all of an office's were 8 % more rays for 64 x 64, and
 * as many again as the picture's for 24 x 24. */
#define PIXELS_A_PATH 64
#define LEAST_PATHS   512
#define MOST_PATHS    4096

/* Records of more bounces are made on the way, as ever. */
#define MOST_LEVELS 4

/* Views that paths begin in: of a long animation, some. */
#define MOST_VIEWS 16

/* Paths that a thread takes at a time. */
#define CHUNK 64

/* Points of a cell: they follow each other in the tree's order. */
#define CELL 8

/* Pieces of a part, from all over the room: less depends on how much there is
 * to do in one corner of it. */
#define PIECES 2

/* Places that are asked for from the end of a path. */
#define FROM_A_PATH 4

/* Rounds over the cells.  A cell is left when so many were there running; and
 * after so many in all, for what is always missing. */
#define ROUNDS    2
#define MOST_ASKS 1024
static const int enough[ROUNDS] = { 8, 32 };

/* Apart from the keys of pixels, which have a frame in this place. */
#define BRANCH UINT64_C(0x6465657073656564)

/* And those of cells apart from those of paths. */
#define BRANCH_CELL UINT64_C(0x63656c6c)

/* Dimensions of the numbers drawn at an asked place's key. */
enum { DIM_POINT, DIM_NEXT, DIM_BETWEEN, DIM_PATH };

struct rad_seed {
    const struct rad_frame *frames; /* [fixed] */
    uint32_t nframes, nviews;       /* [fixed] */
    uint64_t key;                   /* [fixed] */
    double first, last;             /* [fixed] */
    uint32_t npaths;                /* [fixed] */
    int levels;                     /* [fixed] bounces of a path */
    /* What paths met after each bounce, by path; x is NAN where nothing.
     * Written while they are walked, each by the thread that took the path;
     * then npoints, in the order of the tree. */
    double (*met)[3];
    size_t npoints;
    struct rad_parts *parts; /* NULL: paths are walked */
    /* Changed with none at work: */
    int level; /* what is asked for */
    int round;
    uint32_t *cells, ncells; /* [ncells] of our part */
    /* How many paths or cells there are, in the high half, and since then
     * taken, in the low one; stored with release after all that, and read with
     * acquire. */
    _Atomic uint64_t pieces;
};

/* --- paths --- */

/* Walk path i up to the given bounce; r gets its rays.  Returns the number of
 * the last that met something; negative: none did. */
static int
walk(const struct rad_seed *s, struct rad_ctx *ctx, uint32_t i, int upto,
     struct rad_ray *r)
{
    uint64_t key = rad_key_branch(s->key, i);
    uint64_t view = i % s->nviews;
    int k = 0;

    if (!rad_path_begin(&s->frames[view * s->nframes / s->nviews], ctx, s->key,
                        i / s->nviews, key, &r[0]))
        return -1;
    while (k < upto && rad_path_bounce(ctx, &r[k], key, k, &r[k + 1]) &&
           rad_path_meet(ctx, &r[k + 1]))
        k++;
    return k;
}

/* Note what path i meets. */
static void
look(const struct rad_seed *s, struct rad_ctx *ctx, uint32_t i)
{
    double(*met)[3] = s->met + (size_t)i * (size_t)s->levels;
    struct rad_ray r[MOST_LEVELS + 1];
    int n = walk(s, ctx, i, s->levels, r);

    for (int k = 0; k < s->levels; k++)
        if (k < n)
            rad_copy(met[k], r[k + 1].hit.p);
        else
            met[k][0] = NAN;
}

/* --- records --- */

/* A point near what was met in the cell. */
static void
draw_target(const struct rad_seed *s, uint32_t cell, uint64_t key, double p[3])
{
    size_t first = (size_t)cell * CELL, left = s->npoints - first;
    double n = left < CELL ? (double)left : CELL;
    const double *a = s->met[first + (size_t)(n * rad_rand(key, DIM_POINT))];
    const double *b = s->met[first + (size_t)(n * rad_rand(key, DIM_NEXT))];
    double t = 2 * rad_rand(key, DIM_BETWEEN) - .5;

    for (int k = 0; k < 3; k++)
        p[k] = a[k] + t * (b[k] - a[k]);
}

/* Is that place in the order of the tree? */
static bool
is_in_part(const struct rad_seed *s, double place)
{
    double at = place * PIECES;

    at -= floor(at);
    return at >= s->first && at < s->last;
}

static bool
is_ours(const struct rad_seed *s, const double p[3])
{
    return is_in_part(s, rad_parts_place(s->parts, p));
}

/* Send a ray to p from where r, the last of a path, ends. */
static bool
send(struct rad_ctx *ctx, const struct rad_ray *r, const double p[3],
     struct rad_ray *to)
{
    if (!rad_path_leave(ctx, r, to))
        return false;
    rad_sub(to->dir, p, r->hit.p);
    return rad_normalize(to->dir) > 0 && rad_dot(to->dir, r->n) * r->cos_o > 0;
}

/* Ask for a record in the cell, from where r, the last of a path, ends, and
 * make it if there is none. */
static void
ask(const struct rad_seed *s, struct rad_ctx *ctx, uint32_t cell,
    const struct rad_ray *r, uint64_t key)
{
    struct rad_ray to;
    struct rad_ambplace at;
    double p[3];

    draw_target(s, cell, key, p);
    if (!send(ctx, r, p, &to) || !rad_path_meet(ctx, &to) ||
        !is_ours(s, to.hit.p))
        return;
    rad_path_place(&to, s->level, &at);
    if (rad_ambient_serves(ctx, &at))
        return;
    if (send(ctx, r, p, &to)) {
        to.key = key;
        rad_ray_trace(ctx, &to);
    }
}

static void
fill(const struct rad_seed *s, struct rad_ctx *ctx, uint32_t cell,
     const _Atomic bool *stop)
{
    uint64_t which = (uint64_t)(s->level * ROUNDS + s->round) << 32 | cell;
    uint64_t key = rad_key_branch(s->key ^ BRANCH_CELL, which);
    struct rad_ray r[MOST_LEVELS];
    int run = 0, level = -1;

    for (uint32_t i = 0; i < MOST_ASKS && run < enough[s->round]; i++) {
        uint64_t made = ctx->counts.ambient_values;
        uint64_t own = rad_key_branch(key, i);

        if (atomic_load_explicit(stop, memory_order_relaxed))
            return;
        if (i % FROM_A_PATH == 0)
            level =
                walk(s, ctx, (uint32_t)(rad_rand(own, DIM_PATH) * s->npaths),
                     s->level - 1, r);
        if (level == s->level - 1)
            ask(s, ctx, cell, &r[level], own);
        run = ctx->counts.ambient_values > made ? 0 : run + 1;
    }
}

/* --- from one to the next --- */

bool
rad_seed_open(const struct rad_seed *s)
{
    uint64_t pieces = atomic_load_explicit(&s->pieces, memory_order_acquire);

    return (uint32_t)pieces < pieces >> 32;
}

static void
begin_pieces(struct rad_seed *s, uint32_t n)
{
    atomic_store_explicit(&s->pieces, (uint64_t)n << 32, memory_order_release);
}

/* Take n; false: there is none.  Past the end of what there is
 * threads that come at the same time may count some more. */
static bool
take(struct rad_seed *s, uint32_t n, uint32_t *first)
{
    uint64_t pieces;

    if (!rad_seed_open(s))
        return false;
    pieces = atomic_fetch_add_explicit(&s->pieces, n, memory_order_acq_rel);
    *first = (uint32_t)pieces;
    return *first < pieces >> 32;
}

void
rad_seed_work(struct rad_seed *s, struct rad_ctx *ctx, const _Atomic bool *stop)
{
    uint32_t first;

    if (!s->parts && take(s, CHUNK, &first)) {
        for (uint32_t i = first; i < first + CHUNK && i < s->npaths; i++) {
            if (atomic_load_explicit(stop, memory_order_relaxed))
                return;
            look(s, ctx, i);
        }
    } else if (s->parts && take(s, 1, &first)) {
        fill(s, ctx, s->cells[first], stop);
    }
}

/* The parts, from what was met. */
static bool
make_parts(struct rad_seed *s)
{
    size_t all = (size_t)s->npaths * (size_t)s->levels;

    for (size_t i = 0; i < all; i++)
        if (!isnan(s->met[i][0]))
            rad_copy(s->met[s->npoints++], s->met[i]);
    if (s->npoints > 0)
        s->parts = rad_parts_new(s->met, s->npoints);
    return s->parts != NULL;
}

/* Our cells: those whose middle is in our part. */
static bool
list_cells(struct rad_seed *s)
{
    uint32_t all = (uint32_t)((s->npoints + CELL - 1) / CELL);

    s->cells = malloc(all * sizeof *s->cells);
    for (uint32_t i = 0; s->cells && i < all; i++)
        if (is_in_part(s, (i + .5) / all))
            s->cells[s->ncells++] = i;
    return s->ncells > 0;
}

bool
rad_seed_next(struct rad_seed *s)
{
    if (!s->parts) {
        if (!make_parts(s) || !list_cells(s))
            return false;
        s->level = s->levels;
    } else if (++s->round == ROUNDS) {
        s->round = 0;
        if (--s->level == 0)
            return false;
    }
    begin_pieces(s, s->ncells);
    return true;
}

static uint64_t
count_pixels(const struct rad_frame *frames, uint32_t nframes)
{
    uint64_t n = 0;

    for (uint32_t i = 0; i < nframes; i++)
        n += (uint64_t)frames[i].width * (uint64_t)frames[i].height;
    return n;
}

bool
rad_seed_wanted(const struct rad_frame *frames, uint32_t nframes)
{
    const struct rad_job *job = frames[0].job;

    return job->ambient && job->params.ambounce > 1 && job->params.ambdiv > 0 &&
           count_pixels(frames, nframes) >= PIXELS_A_PATH * LEAST_PATHS;
}

static uint32_t
count_paths(const struct rad_frame *frames, uint32_t nframes)
{
    uint64_t n = count_pixels(frames, nframes) / PIXELS_A_PATH;

    return n < LEAST_PATHS  ? LEAST_PATHS
           : n > MOST_PATHS ? MOST_PATHS
                            : (uint32_t)n;
}

struct rad_seed *
rad_seed_new(const struct rad_frame *frames, uint32_t nframes, double first,
             double last, struct rad_error *err)
{
    const struct rad_params *p = &frames[0].job->params;
    struct rad_seed *s = calloc(1, sizeof *s);

    if (!s)
        goto nomem;
    s->frames = frames;
    s->nframes = nframes;
    s->nviews = nframes < MOST_VIEWS ? nframes : MOST_VIEWS;
    s->key = rad_mix64(p->seed) ^ BRANCH;
    s->first = first;
    s->last = last;
    s->npaths = count_paths(frames, nframes);
    s->levels = p->ambounce - 1 < MOST_LEVELS ? p->ambounce - 1 : MOST_LEVELS;
    s->met = calloc((size_t)s->npaths * (size_t)s->levels, sizeof *s->met);
    if (s->met) {
        begin_pieces(s, s->npaths);
        return s;
    }
nomem:
    rad_seed_free(s);
    rad_fail(err, RAD_ENOMEM, "out of memory");
    return NULL;
}

void
rad_seed_free(struct rad_seed *s)
{
    if (!s)
        return;
    rad_parts_free(s->parts);
    free(s->cells);
    free(s->met);
    free(s);
}
