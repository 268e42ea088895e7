/* ambcache.c - see ambcache.h
 *
 * Look-up.  The cells that list a record are the smallest whose side is at
 * least SPAN times the reach of its zone; every such cell that the zone touches
 * lists it.  So a look-up walks one path, from the root down to the smallest
 * cell about the point, and then back up through the lists.
 * A list is made of blocks of LANES places each, one place for a record.  Of
 * ten records in a list about one may serve.  So a place has, as bytes, the
 * numbers by which most others are ruled out: the record's point, the reach of
 * its zone, its normal and its weight.  All places of a block are tested at
 * once, which reads two lines of memory, and only records that pass are fetched
 * and handed on.  Bytes are rounded so that no record is left out that may
 * serve.
 * SPAN weighs insertions against look-ups.  By bench/ambient, in nanoseconds of
 * an insertion, of a look-up, and bytes of a record:
 *     SPAN                        1.4            2              3
 *     28000 dense (an office)     900 530 505    380 440 265    250 510 185
 *     100000 sparse               700 620 392    440 590 242    310 520 184
 *
 * Records of each number of bounces have octrees of their own, since a look-up
 * wants records of a single number; from ROOTS - 1 bounces on records share
 * octrees.  Each number has six octrees, by the axis that a record's normal is
 * nearest to: so where floor and walls are near each other, a look-up on the
 * floor does not pass the walls' records.  A look-up for a normal between two
 * axes, or for a ray of little weight, which takes records with other normals,
 * walks several octrees.
 *
 * Growth.  Nothing is moved, changed or freed until the whole cache is freed,
 * so a reader may keep pointers to what it has found.
 * Records, blocks and cells come from pools (ambpool.c); the pool of records is
 * the log.  A writer writes a record, marks it ready for the log's readers, and
 * then lists it in cells: it takes the next place of the list's first block by
 * adding to the block's counter, fills the place, and sets its bit in `ready`.
 * If the block is full the writer puts a new block, whose first place is
 * filled, before it by compare-and-swap.  A cell gets its eight children at
 * once, by compare-and-swap; a thread that comes late wastes its eight.
 * A writer that is stopped half way holds up readers of the log, which come
 * again later, but no render thread: those find records through the octree.
 *
 * Two threads that miss at the same place both sample and both insert: that is
 * rare, and to wait for each other would cost more.  */
#include "config.h"

#include "light/record/ambcache_impl.h"
#include "base/vec.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#define READ_AHEAD 8 /* entries of the log that are prefetched */

/* Records, blocks and cells are allocated so many at a time. */
enum { CHUNK_FEW = 16, CHUNK_MANY = 256 };

enum { EMPTY, LOCAL, RECEIVED };

/* An entry of the log. */
struct entry {
    alignas(LINE) struct rad_ambitem item; /* [fixed] once ready */
    struct rad_glint glint;                /* [fixed] once ready */
    _Atomic unsigned char state;           /* EMPTY until ready */
};

struct rad_ambcache *
rad_ambcache_new(const double org[3], double side, bool few)
{
    struct rad_ambcache *c = calloc(1, sizeof *c);
    uint32_t chunk = few ? CHUNK_FEW : CHUNK_MANY;

    if (!c)
        return NULL;
    rad_copy(c->org, org);
    c->side = side;
    c->scale = 1 / side;
    if (rad_ambpool_init(&c->entries, sizeof(struct entry), chunk) &&
        rad_ambpool_init(&c->blocks, sizeof(struct block), chunk) &&
        rad_ambpool_init(&c->cells, 8 * sizeof(struct cell), chunk)) {
        atomic_init(&c->read_last, NULL);
        return c;
    }
    rad_ambcache_free(c);
    return NULL;
}

void
rad_ambcache_free(struct rad_ambcache *c)
{
    if (!c)
        return;
    rad_ambpool_release(&c->entries);
    rad_ambpool_release(&c->blocks);
    rad_ambpool_release(&c->cells);
    free(c);
}

/* p in coordinates of the cube, from 0 to 1. */
static void
to_cube(const struct rad_ambcache *c, const double p[3], double q[3])
{
    for (int k = 0; k < 3; k++)
        q[k] = (p[k] - c->org[k]) * c->scale;
}

/* Which child of a cell at that depth holds the smallest cell `number`. */
static int
octant_at(const uint64_t number[3], int depth)
{
    int bit = BITS - 1 - depth;

    return (int)((number[0] >> bit & 1) | (number[1] >> bit & 1) << 1 |
                 (number[2] >> bit & 1) << 2);
}

/* The eight children of a cell, made if need be; NULL: out of memory. */
static struct cell *
kids_of(struct rad_ambcache *c, struct cell *cell)
{
    struct cell *kids = atomic_load_explicit(&cell->kids, memory_order_acquire);
    struct cell *mine;

    if (kids)
        return kids;
    mine = rad_ambpool_take(&c->cells);
    if (!mine)
        return NULL;
    /* release: pairs with the acquires of cell->kids here and in
     * descend, which then see empty cells */
    return atomic_compare_exchange_strong_explicit(&cell->kids, &kids, mine,
                                                   memory_order_acq_rel,
                                                   memory_order_acquire)
               ? mine
               : kids;
}

/* A record on its way into the octree. */
struct load {
    const struct rad_ambitem *item;
    struct rad_ambzone zone; /* in sides of the cube */
    double q[3];             /* the record's point, in sides of the cube; moved
                              * to the cube's face if it is outside */
    int depth;               /* of the cells that are to list it */
};

/* One of the cells that are to list a record, and how far down to it the walk
 * has come. */
struct place {
    const struct load *load;
    uint64_t cell[3]; /* number of the cell, at load->depth */
    struct cell *at;  /* the cell on the way that has been reached */
    int depth;        /* of `at` */
};

/* Records that go into the octree together.  The cells and lists that they
 * touch are seldom in the processor's caches.  So all records go down one level
 * at a time, and for each the cell or list that it needs next is prefetched.
 * (One after the other, an office's 25000 records from other workers take 800
 * nanoseconds each while threads render.) */
enum { TOGETHER = 16, MOST_PLACES = 8 * TOGETHER };

struct bulk {
    struct rad_ambcache *c;
    int nloads, nplaces;
    bool ok; /* memory was not out so far */
    struct load load[TOGETHER];
    struct place place[MOST_PLACES];
};

/* Fill place i of a block, whose cell has the corner `from` in sides of the
 * cell; the side of the cube is `scale` cells.  The reach has a margin for the
 * rounding of both points. */
static void
fill(struct block *b, unsigned i, const struct load *l, const double from[3],
     double scale)
{
    const struct rad_ambitem *item = l->item;

    for (int k = 0; k < 3; k++) {
        b->at[k][i] = place_byte(l->q[k] * scale - from[k]);
        b->n[k][i] = normal_byte((double)item->n[k]);
    }
    b->reach[i] = reach_byte(l->zone.reach * scale + 0x1p-16);
    b->weight[i] = (uint8_t)ceil(weight_steps((double)item->weight));
    b->item[i] = l->item;
}

/* List a record in a cell; `from` and `scale` as of fill().  False: out of
 * memory. */
static bool
push(struct rad_ambcache *c, struct cell *cell, const struct load *l,
     const double from[3], double scale)
{
    struct block *head, *mine;
    unsigned i;

    /* acquire: pairs with the release below, for `taken` and `ready` */
    head = atomic_load_explicit(&cell->list, memory_order_acquire);
    /* read before it is added to, so that the counter cannot wrap round */
    if (head &&
        atomic_load_explicit(&head->taken, memory_order_relaxed) < LANES) {
        i = atomic_fetch_add_explicit(&head->taken, 1, memory_order_relaxed);
        if (i < LANES) {
            fill(head, i, l, from, scale);
            /* release: pairs with the acquire of b->ready in ready_places */
            atomic_fetch_or_explicit(&head->ready, 1u << i,
                                     memory_order_release);
            return true;
        }
    }
    mine = rad_ambpool_take(&c->blocks);
    if (!mine)
        return false;
    fill(mine, 0, l, from, scale);
    atomic_store_explicit(&mine->taken, 1, memory_order_relaxed);
    atomic_store_explicit(&mine->ready, 1, memory_order_relaxed);
    mine->next = head;
    /* release: pairs with the acquires of cell->list here and in
     * descend; earlier blocks of the list were released by the threads that
     * pushed them, and each push is part of the same release sequence */
    while (!atomic_compare_exchange_weak_explicit(&cell->list, &mine->next,
                                                  mine, memory_order_acq_rel,
                                                  memory_order_acquire))
        ;
    return true;
}

/* Does the zone touch the cell with this number and side, in sides of the cube?
 */
static bool
touches(const struct load *l, const uint64_t cell[3], double side)
{
    double d2 = 0;

    for (int k = 0; k < 3; k++) {
        double from = (double)cell[k] * side;
        double d = rad_most(from - l->q[k], l->q[k] - from - side);

        if (d > 0)
            d2 += d * d;
    }
    return d2 <= l->zone.reach * l->zone.reach;
}

/* Take all places one level down, except those for which there is no memory for
 * smaller cells; false: no place went down. */
static bool
step_down(struct bulk *b)
{
    bool moved = false;

    for (int i = 0; i < b->nplaces; i++) {
        struct place *p = &b->place[i];
        int shift = BITS - p->load->depth;
        uint64_t number[3];
        struct cell *kids;

        if (p->depth == p->load->depth || !(kids = kids_of(b->c, p->at)))
            continue;
        for (int k = 0; k < 3; k++)
            number[k] = p->cell[k] << shift;
        p->at = &kids[octant_at(number, p->depth++)];
        __builtin_prefetch(p->at);
        moved = true;
    }
    return moved;
}

/* List a place's record in the cell that was reached. */
static bool
list_at(struct rad_ambcache *c, const struct place *p)
{
    double from[3];

    for (int k = 0; k < 3; k++)
        from[k] = (double)(p->cell[k] >> (p->load->depth - p->depth));
    return push(c, p->at, p->load, from, ldexp(1, p->depth));
}

/* List all records that were gathered. */
static void
list_all(struct bulk *b)
{
    while (step_down(b))
        ;
    for (int i = 0; i < b->nplaces; i++) {
        /* relaxed: the block is only prefetched, not read */
        const char *head = (const char *)atomic_load_explicit(
            &b->place[i].at->list, memory_order_relaxed);

        for (size_t at = 0; head && at < sizeof(struct block); at += LINE)
            __builtin_prefetch(head + at, 1);
    }
    for (int i = 0; i < b->nplaces; i++)
        b->ok &= list_at(b->c, &b->place[i]);
    b->nloads = b->nplaces = 0;
}

/* The box about the zone, half an ellipsoid about the normal, as numbers of
 * cells at l->depth. */
static void
find_box(const struct load *l, uint64_t lo[3], uint64_t hi[3])
{
    for (int k = 0; k < 3; k++) {
        double n = l->item->n[k], rest = rad_most(1 - n * n, 0);
        double reach = l->zone.reach, height = l->zone.height;
        double whole = sqrt(reach * reach * rest + height * height * n * n);
        double half = reach * sqrt(rest) + l->zone.behind;
        int shift = BITS - l->depth;

        /* the normal is rounded by 2^-24, and `rest` by as much: its square
         * root may be off by 2^-12 */
        whole += 1e-3 * reach;
        half = rad_least(half + 1e-3 * reach, whole);
        lo[k] = cell_number(l->q[k] - (n < 0 ? whole : half)) >> shift;
        hi[k] = cell_number(l->q[k] + (n < 0 ? half : whole)) >> shift;
    }
}

/* Gather the cells that a record's zone touches: each cell is wider than the
 * zone, so there are at most eight. */
static void
spread(struct bulk *b, const struct load *l)
{
    const struct rad_ambitem *item = l->item;
    struct cell *root = &b->c->root[root_of(item->level)][face_of(item->n)];
    double side = ldexp(1, -l->depth);
    uint64_t lo[3], hi[3], at[3];

    find_box(l, lo, hi);
    for (at[2] = lo[2]; at[2] <= hi[2]; at[2]++)
        for (at[1] = lo[1]; at[1] <= hi[1]; at[1]++)
            for (at[0] = lo[0]; at[0] <= hi[0]; at[0]++)
                if (touches(l, at, side)) {
                    assert(b->nplaces < MOST_PLACES);
                    b->place[b->nplaces++] =
                        (struct place){ l, { at[0], at[1], at[2] }, root, 0 };
                }
}

void
rad_ambitem_set(struct rad_ambitem *item, const struct rad_ambrec *rec)
{
    rad_copy(item->p, rec->p);
    memcpy(item->n, rec->n, sizeof item->n);
    memcpy(item->u, rec->u, sizeof item->u);
    memcpy(item->radius, rec->radius, sizeof item->radius);
    item->weight = rec->weight;
    item->level = rec->level;
    item->E = rec->E;
    memcpy(item->gpos, rec->gpos, sizeof item->gpos);
    memcpy(item->gdir, rec->gdir, sizeof item->gdir);
    item->var = rec->var;
    item->corral = rec->corral;
}

void
rad_ambitem_get(const struct rad_ambitem *item, const struct rad_glint *glint,
                struct rad_ambrec *rec)
{
    memset(rec, 0, sizeof *rec); /* the padding, too */
    rad_copy(rec->p, item->p);
    memcpy(rec->n, item->n, sizeof rec->n);
    memcpy(rec->u, item->u, sizeof rec->u);
    memcpy(rec->radius, item->radius, sizeof rec->radius);
    rec->weight = item->weight;
    rec->level = item->level;
    rec->E = item->E;
    memcpy(rec->gpos, item->gpos, sizeof rec->gpos);
    memcpy(rec->gdir, item->gdir, sizeof rec->gdir);
    rec->var = item->var;
    rec->corral = item->corral;
    if (glint)
        rec->glint = *glint;
}

/* Add a record to the log, and to the records that are to be listed. */
static bool
take_in(struct bulk *b, const struct rad_ambrec *rec,
        const struct rad_ambzone *zone, bool local)
{
    struct rad_ambcache *c = b->c;
    struct entry *e = rad_ambpool_take(&c->entries);
    struct load *l = &b->load[b->nloads];

    if (!e)
        return false;
    rad_ambitem_set(&e->item, rec);
    e->glint = rec->glint;
    l->item = &e->item;
    to_cube(c, rec->p, l->q);
    for (int k = 0; k < 3; k++)
        l->q[k] = clamp(l->q[k], 0, 1);
    /* a margin for the rounding of both points in the cube */
    l->zone.reach = zone->reach / c->side * (1 + 0x1p-20) + 0x1p-48;
    l->zone.height = zone->height / c->side * (1 + 0x1p-20) + 0x1p-48;
    l->zone.behind = zone->behind / c->side * (1 + 0x1p-20) + 0x1p-48;
    l->depth = depth_for(l->zone.reach);
    /* release: pairs with the acquire in rad_ambcache_read */
    atomic_store_explicit(&e->state, local ? LOCAL : RECEIVED,
                          memory_order_release);
    atomic_fetch_add_explicit(&c->count, 1, memory_order_relaxed);
    spread(b, l);
    b->nloads++;
    return true;
}

bool
rad_ambcache_insert_all(struct rad_ambcache *c, const struct rad_ambrec *rec,
                        const struct rad_ambzone *zone, size_t n, bool local)
{
    struct bulk b;

    b.c = c;
    b.nloads = b.nplaces = 0;
    b.ok = true;
    for (size_t i = 0; i < n; i++) {
        b.ok &= take_in(&b, &rec[i], &zone[i], local);
        if (b.nloads == TOGETHER)
            list_all(&b);
    }
    list_all(&b);
    return b.ok;
}

bool
rad_ambcache_insert(struct rad_ambcache *c, const struct rad_ambrec *rec,
                    const struct rad_ambzone *zone, bool local)
{
    return rad_ambcache_insert_all(c, rec, zone, 1, local);
}

/* --- the log --- */

size_t
rad_ambcache_read(struct rad_ambcache *c, uint64_t *cursor, bool local_only,
                  struct rad_ambrec *out, size_t max)
{
    /* acquire: pairs with the release below */
    struct rad_ambchunk *near =
        atomic_load_explicit(&c->read_last, memory_order_acquire);
    size_t n = 0;

    /* most calls find nothing new; if the count lags a later call finds it */
    if (*cursor >= rad_ambcache_count(c))
        return 0;
    while (n < max) {
        const struct entry *e = rad_ambpool_item(&c->entries, *cursor, &near);
        unsigned char state;

        if (!e)
            break;
        /* beyond the chunk's end this prefetches in vain, which is harmless */
        __builtin_prefetch(&e[READ_AHEAD].state);
        state = atomic_load_explicit(&e->state, memory_order_acquire);
        if (state == EMPTY)
            break;
        if (state == LOCAL || !local_only)
            rad_ambitem_get(&e->item, &e->glint, &out[n++]);
        ++*cursor;
    }
    atomic_store_explicit(&c->read_last, near, memory_order_release);
    return n;
}

size_t
rad_ambcache_count(const struct rad_ambcache *c)
{
    return atomic_load_explicit(&c->count, memory_order_relaxed);
}
