/* ambcache.c - see ambcache.h
 *
 * Look-up.  A record is listed in every cell that its zone touches, of the
 * smallest cells that are larger than the zone's reach; so a look-up walks one
 * path, from the root to the smallest cell about the point.  What a list holds
 * of a record is a link with the centre and reach of the zone in single
 * precision, relative to the cube and rounded up, so that most records that do
 * not serve are never touched.
 *
 * Growth.  Nothing is ever moved, changed or taken away until all is freed, so
 * a reader may hold on to whatever it has found.
 * Records, links and cells come from pools, lists of chunks.  A writer takes
 * the next place of the last chunk by adding to its counter; past the end it
 * makes a new chunk and hangs it behind the last by compare-and-swap; if
 * another was quicker it frees its own and uses that.  The pool of records is
 * the log: having written the record, its writer marks the place ready, then
 * pushes links to it on the lists of cells by compare-and-swap.  Children of a
 * cell come eight at a time, hung in the same way; who is late wastes eight.
 * A writer that is stopped half way holds up the log's readers, who come again
 * later, and no render thread: those find records through the octree.
 *
 * Two threads that miss at the same place both sample and both insert; that
 * costs time and happens seldom, and waiting would cost more.  */
#include "config.h"

#include "light/ambcache.h"
#include "base/vec.h"

#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>

#define CHUNK     256
#define MAX_DEPTH 48 /* beyond it cells are smaller than rounding */

/* --- pools --- */

struct chunk {
    _Atomic(struct chunk *) newer;
    _Atomic uint32_t taken; /* places given out; may pass CHUNK */
    uint64_t first;         /* [fixed] number of its first place */
    max_align_t item[];     /* CHUNK items, zero until taken */
};

struct pool {
    size_t size;                    /* [fixed] of an item */
    struct chunk *oldest;           /* [fixed] */
    _Atomic(struct chunk *) newest; /* a hint: maybe one behind */
};

static void *
item_at(const struct pool *pool, struct chunk *k, uint32_t i)
{
    return (char *)k->item + i * pool->size;
}

static struct chunk *
new_chunk(const struct pool *pool, uint64_t first)
{
    struct chunk *k = calloc(1, sizeof *k + CHUNK * pool->size);

    if (k)
        k->first = first;
    return k;
}

static bool
pool_init(struct pool *pool, size_t size)
{
    pool->size = size;
    pool->oldest = new_chunk(pool, 0);
    atomic_init(&pool->newest, pool->oldest);
    return pool->oldest != NULL;
}

static void
pool_release(struct pool *pool)
{
    struct chunk *k, *newer;

    for (k = pool->oldest; k; k = newer) {
        newer = atomic_load_explicit(&k->newer, memory_order_relaxed);
        free(k);
    }
}

/* The chunk behind k, made if there is none yet; NULL: out of memory. */
static struct chunk *
chunk_after(const struct pool *pool, struct chunk *k)
{
    struct chunk *newer = atomic_load_explicit(&k->newer, memory_order_acquire);
    struct chunk *mine;

    if (newer)
        return newer;
    mine = new_chunk(pool, k->first + CHUNK);
    if (!mine)
        return NULL;
    /* release: pairs with the acquires of k->newer here and in
     * rad_ambcache_read, which then see an empty chunk */
    if (atomic_compare_exchange_strong_explicit(&k->newer, &newer, mine,
                                                memory_order_acq_rel,
                                                memory_order_acquire))
        return mine;
    free(mine);
    return newer;
}

/* A zeroed item of the caller's own; NULL: out of memory. */
static void *
pool_take(struct pool *pool)
{
    /* acquire: pairs with the release below */
    struct chunk *k = atomic_load_explicit(&pool->newest, memory_order_acquire);

    for (;;) {
        uint32_t i = atomic_load_explicit(&k->taken, memory_order_relaxed);

        /* asked first, so that the counter cannot wrap round */
        if (i < CHUNK)
            i = atomic_fetch_add_explicit(&k->taken, 1, memory_order_relaxed);
        if (i < CHUNK)
            return item_at(pool, k, i);
        struct chunk *newer = chunk_after(pool, k), *old = k;

        if (!newer)
            return NULL;
        /* a failure means that another has moved it on already */
        atomic_compare_exchange_strong_explicit(&pool->newest, &old, newer,
                                                memory_order_release,
                                                memory_order_relaxed);
        k = newer;
    }
}

/* --- the octree --- */

enum { EMPTY, LOCAL, RECEIVED };

struct entry {
    struct rad_ambrec rec;       /* [fixed] once ready */
    _Atomic unsigned char state; /* EMPTY until ready */
};

struct link {
    struct link *next;            /* [fixed] once pushed */
    const struct rad_ambrec *rec; /* [fixed] */
    float p[3], reach;            /* [fixed] in sides of the cube */
};

struct cell {
    _Atomic(struct link *) list;
    _Atomic(struct cell *) kids; /* eight, by x | y << 1 | z << 2 */
};

struct rad_ambcache {
    double org[3], side; /* [fixed] */
    struct cell root;
    struct pool entries, links, cells; /* cells: eight an item */
    _Atomic size_t count;              /* relaxed: shown, never decided on */
};

struct rad_ambcache *
rad_ambcache_new(const double org[3], double side)
{
    struct rad_ambcache *c = calloc(1, sizeof *c);

    if (!c)
        return NULL;
    rad_copy(c->org, org);
    c->side = side;
    if (pool_init(&c->entries, sizeof(struct entry)) &&
        pool_init(&c->links, sizeof(struct link)) &&
        pool_init(&c->cells, 8 * sizeof(struct cell)))
        return c;
    rad_ambcache_free(c);
    return NULL;
}

void
rad_ambcache_free(struct rad_ambcache *c)
{
    if (!c)
        return;
    pool_release(&c->entries);
    pool_release(&c->links);
    pool_release(&c->cells);
    free(c);
}

/* p in sides of the cube, and drawn into it: what is a little outside counts
 * as on its face, which brings no two points farther apart. */
static void
to_cube(const struct rad_ambcache *c, const double p[3], double q[3])
{
    for (int k = 0; k < 3; k++)
        q[k] = rad_least(rad_most((p[k] - c->org[k]) / c->side, 0), 1);
}

/* The eight children of a cell, made if there are none; NULL: no memory. */
static struct cell *
kids_of(struct rad_ambcache *c, struct cell *cell)
{
    struct cell *kids = atomic_load_explicit(&cell->kids, memory_order_acquire);
    struct cell *mine;

    if (kids)
        return kids;
    mine = pool_take(&c->cells);
    if (!mine)
        return NULL;
    /* release: pairs with the acquires of cell->kids here and in
     * rad_ambcache_visit, which then see empty cells */
    return atomic_compare_exchange_strong_explicit(&cell->kids, &kids, mine,
                                                   memory_order_acq_rel,
                                                   memory_order_acquire)
               ? mine
               : kids;
}

/* A zone on its way into the octree. */
struct zone {
    const struct rad_ambrec *rec;
    double q[3], reach; /* in sides of the cube */
};

static bool
push(struct rad_ambcache *c, struct cell *cell, const struct zone *z)
{
    struct link *l = pool_take(&c->links);

    if (!l)
        return false;
    l->rec = z->rec;
    for (int k = 0; k < 3; k++)
        l->p[k] = (float)z->q[k];
    l->reach = (float)z->reach;
    l->next = atomic_load_explicit(&cell->list, memory_order_relaxed);
    /* release: pairs with the acquire of cell->list in rad_ambcache_visit;
     * what is further down the list was released by those who pushed it, and
     * each push is part of the same release sequence */
    while (!atomic_compare_exchange_weak_explicit(
        &cell->list, &l->next, l, memory_order_release, memory_order_relaxed))
        ;
    return true;
}

/* Does the zone touch the cube at org with this side? */
static bool
touches(const struct zone *z, const double org[3], double side)
{
    double d2 = 0;

    for (int k = 0; k < 3; k++) {
        double d = rad_most(org[k] - z->q[k], z->q[k] - org[k] - side);

        if (d > 0)
            d2 += d * d;
    }
    return d2 <= z->reach * z->reach;
}

/* List the zone in all cells of the right size below this one, at org. */
static bool
spread(struct rad_ambcache *c, struct cell *cell, const struct zone *z,
       const double org[3], double side, int depth)
{
    struct cell *kids = NULL;
    bool ok = true;

    if (side / 2 > z->reach && depth < MAX_DEPTH)
        kids = kids_of(c, cell);
    if (!kids) /* or no memory for smaller ones */
        return push(c, cell, z);
    side /= 2;
    for (int i = 0; i < 8; i++) {
        double at[3];

        for (int k = 0; k < 3; k++)
            at[k] = i >> k & 1 ? org[k] + side : org[k];
        if (touches(z, at, side))
            ok &= spread(c, &kids[i], z, at, side, depth + 1);
    }
    return ok;
}

bool
rad_ambcache_insert(struct rad_ambcache *c, const struct rad_ambrec *rec,
                    double reach, bool local)
{
    const double origin[3] = { 0, 0, 0 };
    struct entry *e = pool_take(&c->entries);
    struct zone z;

    if (!e)
        return false;
    e->rec = *rec;
    z.rec = &e->rec;
    to_cube(c, rec->p, z.q);
    /* rounded up by what floats lose of places in the cube, both ends */
    z.reach = reach / c->side * (1 + 0x1p-20) + 0x1p-20;
    /* release: pairs with the acquire in rad_ambcache_read */
    atomic_store_explicit(&e->state, local ? LOCAL : RECEIVED,
                          memory_order_release);
    atomic_fetch_add_explicit(&c->count, 1, memory_order_relaxed);
    return spread(c, &c->root, &z, origin, 1, 0);
}

static void
visit_list(const struct cell *cell, const float q[3], rad_ambcache_fn *fn,
           void *arg)
{
    const struct link *l =
        atomic_load_explicit(&cell->list, memory_order_acquire);

    for (; l; l = l->next) {
        float x = q[0] - l->p[0], y = q[1] - l->p[1], z = q[2] - l->p[2];

        if (x * x + y * y + z * z <= l->reach * l->reach)
            fn(arg, l->rec);
    }
}

void
rad_ambcache_visit(const struct rad_ambcache *c, const double p[3],
                   rad_ambcache_fn *fn, rad_ambcache_more_fn *more, void *arg)
{
    const struct cell *path[MAX_DEPTH + 1] = { &c->root };
    double q[3], mid[3] = { .5, .5, .5 }, side = 1;
    int depth = 0;

    to_cube(c, p, q);
    float qf[3] = { (float)q[0], (float)q[1], (float)q[2] };

    for (;;) {
        const struct cell *kids =
            atomic_load_explicit(&path[depth]->kids, memory_order_acquire);
        int octant = 0;

        if (!kids)
            break;
        side /= 2;
        for (int k = 0; k < 3; k++) {
            octant |= (q[k] > mid[k]) << k;
            mid[k] += q[k] > mid[k] ? side / 2 : -side / 2;
        }
        path[++depth] = &kids[octant];
    }
    for (;; depth--, side *= 2) {
        visit_list(path[depth], qf, fn, arg);
        if (depth == 0 || !more(arg, side * c->side))
            return;
    }
}

size_t
rad_ambcache_read(const struct rad_ambcache *c, uint64_t *cursor,
                  bool local_only, struct rad_ambrec *out, size_t max)
{
    struct chunk *k = c->entries.oldest;
    size_t n = 0;

    /* most who ask find nothing new; the count may lag, and they ask again */
    if (*cursor >= rad_ambcache_count(c))
        return 0;
    while (n < max) {
        while (k && k->first + CHUNK <= *cursor)
            k = atomic_load_explicit(&k->newer, memory_order_acquire);
        if (!k)
            break;
        const struct entry *e =
            item_at(&c->entries, k, (uint32_t)(*cursor - k->first));
        unsigned char state =
            atomic_load_explicit(&e->state, memory_order_acquire);

        if (state == EMPTY)
            break;
        if (state == LOCAL || !local_only)
            out[n++] = e->rec;
        ++*cursor;
    }
    return n;
}

size_t
rad_ambcache_count(const struct rad_ambcache *c)
{
    return atomic_load_explicit(&c->count, memory_order_relaxed);
}
