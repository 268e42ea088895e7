/* ambcache.c - see ambcache.h
 *
 * Growth.  Nothing is ever moved, changed or taken away until all is freed, so
 * a reader may hold on to whatever it has found.
 *
 * The log is a list of chunks of records.  A writer takes the next place of
 * the last chunk by adding to its counter; past the end it makes a new chunk
 * and hangs it behind the last by compare-and-swap; if another was quicker it
 * frees its own and uses that.  Having written the record it marks the place
 * ready, then pushes it on the list of its octree cell by compare-and-swap.
 * Children of a cell come eight at a time, hung in the same way.
 * A writer that is stopped half way holds up the log's readers, who come again
 * later, and no render thread: those find records through the octree.
 *
 * Two threads that miss at the same place both sample and both insert; that
 * costs time and happens seldom, and waiting would cost more.  */
#include "config.h"

#include "light/ambcache.h"
#include "base/vec.h"

#include <stdatomic.h>
#include <stdlib.h>

#define CHUNK     256
#define MAX_DEPTH 48 /* beyond it cells are smaller than rounding */

enum { EMPTY, LOCAL, RECEIVED };

struct entry {
    struct entry *next;    /* [fixed] once pushed: next in the cell's list */
    struct rad_ambrec rec; /* [fixed] once ready */
    _Atomic unsigned char state; /* EMPTY until ready */
};

struct chunk {
    _Atomic(struct chunk *) newer;
    _Atomic uint32_t taken; /* places given out; may pass CHUNK */
    uint64_t first;         /* [fixed] log position of its first place */
    struct entry entry[CHUNK];
};

struct cell {
    _Atomic(struct entry *) list;
    _Atomic(struct cell *) kids; /* eight, by x | y << 1 | z << 2 */
};

struct rad_ambcache {
    double org[3], side; /* [fixed] */
    struct cell root;
    struct chunk *oldest;           /* [fixed] */
    _Atomic(struct chunk *) newest; /* a hint: maybe one behind */
    _Atomic size_t count;           /* relaxed: shown, never decided on */
};

struct rad_ambcache *
rad_ambcache_new(const double org[3], double side)
{
    struct rad_ambcache *c = calloc(1, sizeof *c);

    if (!c)
        return NULL;
    rad_copy(c->org, org);
    c->side = side;
    c->oldest = calloc(1, sizeof *c->oldest);
    if (!c->oldest) {
        free(c);
        return NULL;
    }
    atomic_init(&c->newest, c->oldest);
    return c;
}

static void
free_kids(struct cell *cell)
{
    struct cell *kids = atomic_load_explicit(&cell->kids, memory_order_relaxed);

    if (!kids)
        return;
    for (int i = 0; i < 8; i++)
        free_kids(&kids[i]);
    free(kids);
}

void
rad_ambcache_free(struct rad_ambcache *c)
{
    struct chunk *k, *newer;

    if (!c)
        return;
    free_kids(&c->root);
    for (k = c->oldest; k; k = newer) {
        newer = atomic_load_explicit(&k->newer, memory_order_relaxed);
        free(k);
    }
    free(c);
}

/* The chunk behind k, made if there is none yet; NULL: out of memory. */
static struct chunk *
chunk_after(struct chunk *k)
{
    struct chunk *newer = atomic_load_explicit(&k->newer, memory_order_acquire);
    struct chunk *mine;

    if (newer)
        return newer;
    mine = calloc(1, sizeof *mine);
    if (!mine)
        return NULL;
    mine->first = k->first + CHUNK;
    /* release: pairs with the acquires of k->newer here and in
     * rad_ambcache_read, which then see an empty chunk */
    if (atomic_compare_exchange_strong_explicit(&k->newer, &newer, mine,
                                                memory_order_acq_rel,
                                                memory_order_acquire))
        return mine;
    free(mine);
    return newer;
}

/* A place in the log, of the caller's own until it is marked ready. */
static struct entry *
take_place(struct rad_ambcache *c)
{
    /* acquire: pairs with the release below */
    struct chunk *k = atomic_load_explicit(&c->newest, memory_order_acquire);

    for (;;) {
        uint32_t i = atomic_load_explicit(&k->taken, memory_order_relaxed);

        /* asked first, so that the counter cannot wrap round */
        if (i < CHUNK)
            i = atomic_fetch_add_explicit(&k->taken, 1, memory_order_relaxed);
        if (i < CHUNK)
            return &k->entry[i];
        struct chunk *newer = chunk_after(k), *old = k;

        if (!newer)
            return NULL;
        /* a failure means that another has moved it on already */
        atomic_compare_exchange_strong_explicit(&c->newest, &old, newer,
                                                memory_order_release,
                                                memory_order_relaxed);
        k = newer;
    }
}

/* The eight children of a cell, made if there are none; NULL: no memory. */
static struct cell *
kids_of(struct cell *cell)
{
    struct cell *kids = atomic_load_explicit(&cell->kids, memory_order_acquire);
    struct cell *mine;

    if (kids)
        return kids;
    mine = calloc(8, sizeof *mine);
    if (!mine)
        return NULL;
    /* release: pairs with the acquires of cell->kids here and in visit_cell,
     * which then see empty cells */
    if (atomic_compare_exchange_strong_explicit(&cell->kids, &kids, mine,
                                                memory_order_acq_rel,
                                                memory_order_acquire))
        return mine;
    free(mine);
    return kids;
}

/* The smallest cell about p that is larger than reach; the cells are visited
 * as far as their side beyond their faces. */
static struct cell *
find_cell(struct rad_ambcache *c, const double p[3], double reach)
{
    struct cell *cell = &c->root;
    double org[3], side = c->side;

    rad_copy(org, c->org);
    for (int depth = 0; side / 2 > reach && depth < MAX_DEPTH; depth++) {
        struct cell *kids = kids_of(cell);
        int octant = 0;

        if (!kids)
            return cell; /* larger than need be */
        side /= 2;
        for (int k = 0; k < 3; k++)
            if (p[k] > org[k] + side) {
                org[k] += side;
                octant |= 1 << k;
            }
        cell = &kids[octant];
    }
    return cell;
}

bool
rad_ambcache_insert(struct rad_ambcache *c, const struct rad_ambrec *rec,
                    double reach, bool local)
{
    struct entry *e = take_place(c);
    struct cell *cell;

    if (!e)
        return false;
    e->rec = *rec;
    /* release: pairs with the acquire in rad_ambcache_read */
    atomic_store_explicit(&e->state, local ? LOCAL : RECEIVED,
                          memory_order_release);
    cell = find_cell(c, rec->p, reach);
    e->next = atomic_load_explicit(&cell->list, memory_order_relaxed);
    /* release: pairs with the acquire of cell->list in visit_cell; what is
     * further down the list was released by those who pushed it, and each push
     * is part of the same release sequence */
    while (!atomic_compare_exchange_weak_explicit(
        &cell->list, &e->next, e, memory_order_release, memory_order_relaxed))
        ;
    atomic_fetch_add_explicit(&c->count, 1, memory_order_relaxed);
    return true;
}

struct visit {
    const double *p;
    rad_ambcache_fn *fn;
    rad_ambcache_more_fn *more;
    void *arg;
};

static void
visit_cell(const struct visit *v, const struct cell *cell, const double org[3],
           double side)
{
    const struct cell *kids =
        atomic_load_explicit(&cell->kids, memory_order_acquire);
    const struct entry *e;

    if (kids) {
        double half = side / 2, at[3];

        for (int i = 0; i < 8; i++) {
            int k;

            for (k = 0; k < 3; k++) {
                at[k] = i >> k & 1 ? org[k] + half : org[k];
                if (v->p[k] < at[k] - half || v->p[k] > at[k] + 2 * half)
                    break;
            }
            if (k == 3)
                visit_cell(v, &kids[i], at, half);
        }
        if (!v->more(v->arg, half))
            return;
    }
    e = atomic_load_explicit(&cell->list, memory_order_acquire);
    for (; e; e = e->next)
        v->fn(v->arg, &e->rec);
}

void
rad_ambcache_visit(const struct rad_ambcache *c, const double p[3],
                   rad_ambcache_fn *fn, rad_ambcache_more_fn *more, void *arg)
{
    struct visit v = { p, fn, more, arg };

    visit_cell(&v, &c->root, c->org, c->side);
}

size_t
rad_ambcache_read(const struct rad_ambcache *c, uint64_t *cursor,
                  bool local_only, struct rad_ambrec *out, size_t max)
{
    const struct chunk *k = c->oldest;
    size_t n = 0;

    while (n < max) {
        while (k && k->first + CHUNK <= *cursor)
            k = atomic_load_explicit(&k->newer, memory_order_acquire);
        if (!k)
            break;
        const struct entry *e = &k->entry[*cursor - k->first];
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
