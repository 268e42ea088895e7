/* ambcache.c - see ambcache.h
 *
 * Look-up.  A record is listed in every cell that its zone touches, of the
 * smallest cells at least SPAN times as wide as the zone reaches; so a look-up
 * walks one path, from the root to the smallest cell about the point, and then
 * back up.  A list is made of blocks of LANES places each.  Of ten records in a
 * list about one may serve, so a block says of each in a byte a number what
 * tells most of the others: where it is, how far it reaches, its normal, and
 * its weight.  The places of a block are tried all at once, in two lines of
 * memory, and only what passes is fetched and handed on.  Bytes are rounded so
 * that nothing is left out that may serve.
 * SPAN weighs insertions against look-ups: nanoseconds of both and bytes a
 * record (bench/ambient) are 900, 530, 505 with 1.4, 380, 440, 265 with 2 and
 * 250, 510, 185 with 3 for an office's 28000 dense records, and 700, 620, 392,
 * 440, 590, 242 and 310, 520, 184 for 100000 sparse ones.
 *
 * Records of each number of bounces have octrees of their own, for only those
 * of one are wanted at a time; beyond ROOTS - 1 bounces they share them.  There
 * are six to a number, by the axis that a record's normal is nearest to: where
 * floor and walls are near each other, a look-up on one walks past the records
 * of all others.  One about a normal in between, or for a ray of little weight,
 * which takes records with other normals, walks several.
 *
 * Growth.  Nothing is ever moved, changed or taken away until all is freed, so
 * a reader may hold on to whatever it has found.
 * Records, blocks and cells come from pools, lists of chunks.  A writer takes
 * the next place of the last chunk by adding to its counter; past the end it
 * makes a new chunk and hangs it behind the last by compare-and-swap; if
 * another was quicker it frees its own and uses that.  The pool of records is
 * the log: having written the record, its writer marks the place ready, then
 * lists it in cells: it takes the next place of the list's first block by
 * adding to its counter, fills it, and sets the place's bit among those that
 * are ready; where the block is full it puts another before it by
 * compare-and-swap, whose first place is filled already.  Children of a
 * cell come eight at a time, hung in the same way; who is late wastes eight.
 * A writer that is stopped half way holds up the log's readers, who come again
 * later, and no render thread: those find records through the octree.
 *
 * A vector is loaded whole, with places in it that a writer may just be
 * filling; what comes of those is masked away.  C11 has no word for such a
 * load, and ThreadSanitizer would report it, so under that only ready places
 * are read, one by one, which proves all but this.
 *
 * Two threads that miss at the same place both sample and both insert; that
 * costs time and happens seldom, and waiting would cost more.  */
#include "config.h"

#include "light/ambcache.h"
#include "base/vec.h"

#include <assert.h>
#include <math.h>
#include <stdalign.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)
#define WITH_VECTORS 1
#include <emmintrin.h>
#endif

#define LINE         64 /* bytes that a processor fetches at once */
#define CHUNK        256
#define WIDTH        16 /* of a vector of bytes */
#define LANES        14 /* so many make a block four lines of memory */
#define STEPS_LOG    7  /* of the steps to the side of a cell */
#define STEPS        (1 << STEPS_LOG)
#define NORMAL_STEPS 127.
#define SPAN         3
#define ROOTS        8
#define FACES        6
#define BITS         48 /* of a cell's number: beyond is rounding */
#define MAX_DEPTH    (BITS - STEPS_LOG)
#define READ_AHEAD   8 /* entries of the log */

/* --- pools --- */

struct chunk {
    _Atomic(struct chunk *) newer;
    _Atomic uint32_t taken;             /* places given out; may pass CHUNK */
    uint64_t first;                     /* [fixed] number of its first place */
    alignas(LINE) unsigned char item[]; /* CHUNK items, zero until taken */
};

struct pool {
    size_t size;                    /* [fixed] of an item, whole lines */
    struct chunk *oldest;           /* [fixed] */
    _Atomic(struct chunk *) newest; /* a hint: maybe one behind */
};

static void *
item_at(const struct pool *pool, struct chunk *k, uint32_t i)
{
    return k->item + i * pool->size;
}

static struct chunk *
new_chunk(const struct pool *pool, uint64_t first)
{
    size_t size = sizeof(struct chunk) + CHUNK * pool->size;
    struct chunk *k = aligned_alloc(LINE, size);

    if (!k)
        return NULL;
    memset(k, 0, size);
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
    alignas(LINE) struct rad_ambitem item; /* [fixed] once ready */
    _Atomic unsigned char state;           /* EMPTY until ready */
};

/* Places of a list, newer blocks first.  What belongs to a place is [fixed]
 * once its bit in `ready` is set. */
struct block {
    alignas(LINE) uint8_t at[3][WIDTH]; /* the record's point: place_byte() */
    uint8_t reach[WIDTH];               /* of its zone, in the same steps */
    uint8_t n[3][WIDTH];                /* its normal: normal_byte() */
    uint8_t weight[WIDTH];              /* weight_steps(), rounded up */
    struct block *next;                 /* [fixed] once pushed */
    _Atomic uint32_t taken;             /* places given out; may pass LANES */
    _Atomic uint32_t ready;             /* a bit for each */
    const struct rad_ambitem *item[LANES];
};

struct cell {
    _Atomic(struct block *) list;
    _Atomic(struct cell *) kids; /* eight, by x | y << 1 | z << 2 */
};

/* A query on its way through a cell, in bytes as in a block. */
struct probe {
    uint8_t at[3], n[3], weight;
    uint8_t turn; /* so far may a normal be off along each axis */
};

struct rad_ambcache {
    double org[3], side;                /* [fixed] */
    double scale;                       /* [fixed] 1 / side */
    struct cell root[ROOTS][FACES];     /* by bounces and face_of() */
    struct pool entries, blocks, cells; /* cells: eight an item */
    _Atomic size_t count;               /* relaxed: shown, never decided on */
    _Atomic(struct chunk *) read_last;  /* of entries; a hint for readers */
};

/* --- bytes --- */

static inline double
clamp(double x, double lo, double hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

/* A place along an axis in sides of a cell, from its corner: STEPS to the side,
 * and half a side before and behind, for records outside it that reach into
 * it.  What lies farther out counts as there, which brings no two places
 * farther apart.  Two bytes differ by less than one more than the places. */
static inline uint8_t
place_byte(double x)
{
    return (uint8_t)clamp((x + .5) * STEPS, 0, 255);
}

/* The steps within which a place is that is nearer than `reach` sides. */
static inline uint8_t
reach_byte(double reach)
{
    return (uint8_t)clamp(ceil(reach * STEPS) + 1, 0, 255);
}

/* Weights beyond 1.27 count as one.  Never less for more. */
static inline double
weight_steps(double weight)
{
    return clamp(weight * 200, 0, 255);
}

/* A component of a unit vector, off by half a step. */
static inline uint8_t
normal_byte(double x)
{
    return (uint8_t)(lrint(clamp(x, -1, 1) * NORMAL_STEPS) + 128);
}

/* The steps by which normals with a cosine of that at least differ along each
 * axis at most: no more than the chord between them. */
static uint8_t
turn_byte(double cosine)
{
    return (uint8_t)ceil(sqrt(2 - 2 * clamp(cosine, -1, 1)) * NORMAL_STEPS +
                         1.1);
}

void
rad_ambfit_set(struct rad_ambfit *fit, double min_cos, double weight)
{
    fit->sine = min_cos > 0 ? sqrt(rad_most(1 - min_cos * min_cos, 0)) : 2;
    fit->turn = turn_byte(min_cos);
    fit->weight = (uint8_t)weight_steps(weight);
}

/* --- faces --- */

/* The axis that n is nearest to, and its sign. */
static int
face_of(const float n[3])
{
    int k = fabsf(n[1]) > fabsf(n[0]) ? 1 : 0;

    if (fabsf(n[2]) > fabsf(n[k]))
        k = 2;
    return 2 * k + (n[k] < 0);
}

/* The axes that normals within an angle of n can be nearest to, as bits.  Those
 * of an axis are on its side of four planes, of which one is farther from n
 * than any other: that far, as a sine, a normal must be off, and a little for
 * what the lengths of normals are off.  Nor are they more than 55 degrees from
 * it, so what is beyond 145 does not matter. */
static inline unsigned
faces_about(const double n[3], double sine)
{
    double slack = M_SQRT2 * sine + 1e-3, at[3], least, middle, most;
    unsigned faces = 0;

    for (int k = 0; k < 3; k++)
        at[k] = fabs(n[k]);
    least = rad_least(at[0], at[1]);
    most = rad_most(at[0], at[1]);
    middle = rad_most(least, rad_least(most, at[2]));
    most = rad_most(most, at[2]);
    for (int k = 0; k < 3; k++) {
        double aside = at[k] == most ? middle : most;
        unsigned below = n[k] < 0;

        faces |= (unsigned)(aside - at[k] <= slack) << (2 * k + below);
        faces |= (unsigned)((aside + at[k] <= slack && at[k] < .82) || sine > 1)
                 << (2 * k + !below);
    }
    return faces;
}

/* --- scanning --- */

/* The tree of records of that many bounces. */
static int
root_of(int level)
{
    return level < ROOTS ? level : ROOTS - 1;
}

/* The places of a block that are ready, as bits. */
static inline unsigned
ready_places(const struct block *b)
{
    /* acquire: pairs with the release in push */
    return atomic_load_explicit(&b->ready, memory_order_acquire);
}

#ifdef WITH_VECTORS

static inline __m128i
load16(const void *p)
{
    return _mm_load_si128(p);
}

/* How far bytes are apart, or `far` if that is more. */
static inline __m128i
apart(__m128i far, const uint8_t *bytes, uint8_t from)
{
    __m128i a = load16(bytes), b = _mm_set1_epi8((char)from);

    return _mm_max_epu8(far,
                        _mm_or_si128(_mm_subs_epu8(a, b), _mm_subs_epu8(b, a)));
}

/* The places that may serve, as bits: within whose reach the point is along
 * each axis, that look the same way, and that were made for as much weight. */
static inline unsigned
passing(const struct block *b, const struct probe *q, unsigned ready)
{
    const __m128i zero = _mm_setzero_si128();
    __m128i far = zero, turn = zero, over;

    far = apart(far, b->at[0], q->at[0]);
    far = apart(far, b->at[1], q->at[1]);
    far = apart(far, b->at[2], q->at[2]);
    turn = apart(turn, b->n[0], q->n[0]);
    turn = apart(turn, b->n[1], q->n[1]);
    turn = apart(turn, b->n[2], q->n[2]);
    over = _mm_or_si128(_mm_subs_epu8(far, load16(b->reach)),
                        _mm_subs_epu8(turn, _mm_set1_epi8((char)q->turn)));
    over = _mm_or_si128(
        over, _mm_subs_epu8(_mm_set1_epi8((char)q->weight), load16(b->weight)));
    return ready & (unsigned)_mm_movemask_epi8(_mm_cmpeq_epi8(over, zero));
}

#else

static bool
may_serve(const struct block *b, const struct probe *q, unsigned i)
{
    for (int k = 0; k < 3; k++)
        if (abs(b->at[k][i] - q->at[k]) > b->reach[i] ||
            abs(b->n[k][i] - q->n[k]) > q->turn)
            return false;
    return b->weight[i] >= q->weight;
}

/* The places that may serve, as bits. */
static unsigned
passing(const struct block *b, const struct probe *q, unsigned ready)
{
    unsigned pass = 0;

    for (; ready; ready &= ready - 1) {
        unsigned i = (unsigned)__builtin_ctz(ready);

        pass |= (unsigned)may_serve(b, q, i) << i;
    }
    return pass;
}

#endif

/* All but the last records' addresses. */
static inline void
prefetch(const struct block *b)
{
    __builtin_prefetch(b);
    __builtin_prefetch((const char *)b + LINE);
    __builtin_prefetch((const char *)b + 2 * LINE);
}

/* What was found and is to be handed on. */
enum { MOST_FOUND = 4 * LANES };

struct finds {
    rad_ambcache_fn *fn;
    void *arg;
    int n;
    const struct rad_ambitem *item[MOST_FOUND];
};

static inline void
hand_on(struct finds *finds)
{
    if (finds->n > 0)
        finds->fn(finds->arg, finds->item, finds->n);
    finds->n = 0;
}

/* Walk a list and find what may serve. */
static inline void
scan(const struct block *b, const struct probe *q, struct finds *finds)
{
    for (; b; b = b->next) {
        unsigned pass;

        if (b->next)
            prefetch(b->next);
        pass = passing(b, q, ready_places(b));
        if (finds->n > MOST_FOUND - LANES)
            hand_on(finds);
        for (; pass; pass &= pass - 1) {
            const struct rad_ambitem *item = b->item[__builtin_ctz(pass)];

            __builtin_prefetch(item);
            __builtin_prefetch((const char *)item + LINE);
            finds->item[finds->n++] = item;
        }
    }
}

/* --- insertion --- */

struct rad_ambcache *
rad_ambcache_new(const double org[3], double side)
{
    struct rad_ambcache *c = calloc(1, sizeof *c);

    if (!c)
        return NULL;
    rad_copy(c->org, org);
    c->side = side;
    c->scale = 1 / side;
    if (pool_init(&c->entries, sizeof(struct entry)) &&
        pool_init(&c->blocks, sizeof(struct block)) &&
        pool_init(&c->cells, 8 * sizeof(struct cell))) {
        atomic_init(&c->read_last, c->entries.oldest);
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
    pool_release(&c->entries);
    pool_release(&c->blocks);
    pool_release(&c->cells);
    free(c);
}

static void
to_cube(const struct rad_ambcache *c, const double p[3], double q[3])
{
    for (int k = 0; k < 3; k++)
        q[k] = (p[k] - c->org[k]) * c->scale;
}

/* Number of the smallest cell there could be, along an axis: bit BITS - 1 - d
 * says which child to take at depth d.  What is a little outside the cube
 * counts as on its face, which brings no two points farther apart. */
static uint64_t
cell_number(double q)
{
    const uint64_t last = (UINT64_C(1) << BITS) - 1;

    if (!(q > 0))
        return 0;
    return q >= 1 ? last : (uint64_t)(q * 0x1p48);
}

/* Cells of that depth in a row. */
static inline double
cells_across(int depth)
{
    return (double)(INT64_C(1) << depth);
}

static int
octant_at(const uint64_t number[3], int depth)
{
    int bit = BITS - 1 - depth;

    return (int)((number[0] >> bit & 1) | (number[1] >> bit & 1) << 1 |
                 (number[2] >> bit & 1) << 2);
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

/* A record on its way into the octree. */
struct load {
    const struct rad_ambitem *item;
    struct rad_ambzone zone; /* in sides of the cube */
    double q[3];             /* its point, likewise, put on the cube's face
                              * where it is outside */
    int depth;               /* of the cells to list it in */
};

/* One of those cells, and how far down to it the walk has come. */
struct place {
    const struct load *load;
    uint64_t cell[3]; /* its number, at its depth */
    struct cell *at;
    int depth; /* of `at` */
};

/* Records that go into the octree together.  What they touch is seldom in the
 * processor's own memory, so all of them go down a level at a time, each having
 * asked for what it needs next: an office's 25000 records from others, between
 * which a thread rendered, took 800 nanoseconds each when one went after the
 * other. */
enum { TOGETHER = 16, MOST_PLACES = 8 * TOGETHER };

struct bulk {
    struct rad_ambcache *c;
    int nloads, nplaces;
    bool ok; /* no memory was missing */
    struct load load[TOGETHER];
    struct place place[MOST_PLACES];
};

/* Fill place i.  The reach has a margin for what both points are rounded by. */
static void
fill(struct block *b, unsigned i, const struct load *l, const double from[3],
     double scale)
{
    const struct rad_ambrec *rec = &l->item->rec;

    for (int k = 0; k < 3; k++) {
        b->at[k][i] = place_byte(l->q[k] * scale - from[k]);
        b->n[k][i] = normal_byte((double)rec->n[k]);
    }
    b->reach[i] = reach_byte(l->zone.reach * scale + 0x1p-16);
    b->weight[i] = (uint8_t)ceil(weight_steps((double)rec->weight));
    b->item[i] = l->item;
}

/* List it in a cell whose corner is `from`, in sides of the cell. */
static bool
push(struct rad_ambcache *c, struct cell *cell, const struct load *l,
     const double from[3], double scale)
{
    struct block *head, *mine;
    unsigned i;

    /* acquire: pairs with the release below, for `taken` and `ready` */
    head = atomic_load_explicit(&cell->list, memory_order_acquire);
    /* asked first, so that the counter cannot wrap round */
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
    mine = pool_take(&c->blocks);
    if (!mine)
        return false;
    fill(mine, 0, l, from, scale);
    atomic_store_explicit(&mine->taken, 1, memory_order_relaxed);
    atomic_store_explicit(&mine->ready, 1, memory_order_relaxed);
    mine->next = head;
    /* release: pairs with the acquires of cell->list here and in
     * rad_ambcache_visit; what is further down the list was released by those
     * who pushed it, and each push is part of the same release sequence */
    while (!atomic_compare_exchange_weak_explicit(&cell->list, &mine->next,
                                                  mine, memory_order_acq_rel,
                                                  memory_order_acquire))
        ;
    return true;
}

/* Does the zone touch the cell of that number, at its depth? */
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

/* Take all a level down, or leave them where there is no memory for smaller
 * cells; false: none can go farther. */
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

/* List it in the cell that was reached. */
static bool
list_at(struct rad_ambcache *c, const struct place *p)
{
    double from[3];

    for (int k = 0; k < 3; k++)
        from[k] = (double)(p->cell[k] >> (p->load->depth - p->depth));
    return push(c, p->at, p->load, from, ldexp(1, p->depth));
}

/* List what was gathered. */
static void
list_all(struct bulk *b)
{
    while (step_down(b))
        ;
    for (int i = 0; i < b->nplaces; i++) {
        /* relaxed: what is there is not looked at */
        const char *head = (const char *)atomic_load_explicit(
            &b->place[i].at->list, memory_order_relaxed);

        for (size_t at = 0; head && at < sizeof(struct block); at += LINE)
            __builtin_prefetch(head + at, 1);
    }
    for (int i = 0; i < b->nplaces; i++)
        b->ok &= list_at(b->c, &b->place[i]);
    b->nloads = b->nplaces = 0;
}

/* The box about the zone, as numbers of cells at its depth: half an ellipsoid
 * about the normal. */
static void
find_box(const struct load *l, uint64_t lo[3], uint64_t hi[3])
{
    for (int k = 0; k < 3; k++) {
        double n = l->item->rec.n[k], rest = rad_most(1 - n * n, 0);
        double reach = l->zone.reach, height = l->zone.height;
        double whole = sqrt(reach * reach * rest + height * height * n * n);
        double half = reach * sqrt(rest) + l->zone.behind;
        int shift = BITS - l->depth;

        /* the normal is rounded by 2^-24, and the root of that may count */
        whole += 1e-3 * reach;
        half = rad_least(half + 1e-3 * reach, whole);
        lo[k] = cell_number(l->q[k] - (n < 0 ? whole : half)) >> shift;
        hi[k] = cell_number(l->q[k] + (n < 0 ? half : whole)) >> shift;
    }
}

/* Gather the cells that the zone touches: they are wider than it is, so there
 * are at most eight. */
static void
spread(struct bulk *b, const struct load *l)
{
    const struct rad_ambrec *rec = &l->item->rec;
    struct cell *root = &b->c->root[root_of(rec->level)][face_of(rec->n)];
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

/* Depth of the smallest cells that are SPAN times as wide. */
static int
depth_for(double reach)
{
    int e;

    frexp(SPAN * reach, &e);
    return e > 0 ? 0 : e < -MAX_DEPTH ? MAX_DEPTH : -e;
}

void
rad_ambitem_set(struct rad_ambitem *item, const struct rad_ambrec *rec)
{
    const float *n = rec->n, *u = rec->u;

    item->rec = *rec;
    item->across[0] = n[1] * u[2] - n[2] * u[1];
    item->across[1] = n[2] * u[0] - n[0] * u[2];
    item->across[2] = n[0] * u[1] - n[1] * u[0];
    for (int k = 0; k < 2; k++)
        item->per[k] = 1 / rec->radius[k];
}

/* Into the log, and among what is to be listed. */
static bool
take_in(struct bulk *b, const struct rad_ambrec *rec,
        const struct rad_ambzone *zone, bool local)
{
    struct rad_ambcache *c = b->c;
    struct entry *e = pool_take(&c->entries);
    struct load *l = &b->load[b->nloads];

    if (!e)
        return false;
    rad_ambitem_set(&e->item, rec);
    l->item = &e->item;
    to_cube(c, rec->p, l->q);
    for (int k = 0; k < 3; k++)
        l->q[k] = clamp(l->q[k], 0, 1);
    /* rounded up by what places in the cube are rounded by, both ends */
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

/* --- look-up --- */

/* The lists of the cells about a point, from the root to the smallest. */
struct path {
    int depth; /* of that */
    const struct block *list[MAX_DEPTH + 1];
};

static inline void
descend(const struct cell *cell, const uint64_t number[3], struct path *path)
{
    uint64_t x = number[0] << (64 - BITS), y = number[1] << (64 - BITS),
             z = number[2] << (64 - BITS);

    for (int depth = 0;; depth++) {
        const struct block *list =
            atomic_load_explicit(&cell->list, memory_order_acquire);
        const struct cell *kids =
            atomic_load_explicit(&cell->kids, memory_order_acquire);

        path->list[depth] = list;
        path->depth = depth;
        if (list)
            prefetch(list);
        if (!kids || depth == MAX_DEPTH)
            return;
        cell = &kids[x >> 63 | y >> 63 << 1 | z >> 63 << 2];
        x <<= 1;
        y <<= 1;
        z <<= 1;
    }
}

/* The point as the cell at that depth has it: place_byte(), from the bits of
 * its number that follow the cell's. */
static inline void
aim(struct probe *probe, const uint64_t number[3], int depth)
{
    for (int k = 0; k < 3; k++)
        probe->at[k] = (uint8_t)(STEPS / 2 + (number[k] >> (MAX_DEPTH - depth) &
                                              (STEPS - 1)));
}

/* A look-up under way. */
struct visit {
    const struct rad_ambcache *c;
    uint64_t number[3];
    struct probe probe;
    bool any; /* something was looked at */
    rad_ambcache_more_fn *more;
    struct finds finds;
};

/* Be ready for lists of that depth; false: enough was found before. */
static inline bool
go_on(struct visit *v, int depth)
{
    if (v->any &&
        !v->more(v->finds.arg, v->c->side / (SPAN * cells_across(depth + 1))))
        return false;
    v->any = true;
    aim(&v->probe, v->number, depth);
    return true;
}

static inline void
look_at(struct visit *v, const struct block *list)
{
    scan(list, &v->probe, &v->finds);
    hand_on(&v->finds);
}

/* Back up along the path. */
static inline void
ascend(struct visit *v, const struct path *path)
{
    for (int depth = path->depth; depth >= 0; depth--) {
        if (!path->list[depth])
            continue;
        if (!go_on(v, depth))
            return;
        look_at(v, path->list[depth]);
    }
}

/* The same along several, in step. */
static void
ascend_all(struct visit *v, const struct path *path, int n)
{
    int depth = 0;

    for (int i = 0; i < n; i++)
        depth = path[i].depth > depth ? path[i].depth : depth;
    for (; depth >= 0; depth--) {
        bool here = false;

        for (int i = 0; i < n; i++) {
            if (depth > path[i].depth || !path[i].list[depth])
                continue;
            if (!here && !go_on(v, depth))
                return;
            here = true;
            look_at(v, path[i].list[depth]);
        }
    }
}

void
rad_ambcache_visit(const struct rad_ambcache *c, const struct rad_ambquery *q,
                   rad_ambcache_fn *fn, rad_ambcache_more_fn *more, void *arg)
{
    const struct cell *root = c->root[root_of(q->level)];
    unsigned faces = faces_about(q->n, q->fit->sine);
    struct path path[FACES];
    struct visit v;
    int n = 0;

    v.c = c;
    v.any = false;
    v.more = more;
    v.finds.fn = fn;
    v.finds.arg = arg;
    v.finds.n = 0;
    for (int k = 0; k < 3; k++) {
        v.number[k] = cell_number((q->p[k] - c->org[k]) * c->scale);
        v.probe.n[k] = normal_byte(q->n[k]);
    }
    v.probe.turn = q->fit->turn;
    v.probe.weight = q->fit->weight;
    for (; faces; faces &= faces - 1)
        descend(&root[__builtin_ctz(faces)], v.number, &path[n++]);
    if (n == 1)
        ascend(&v, path);
    else
        ascend_all(&v, path, n);
}

size_t
rad_ambcache_read(struct rad_ambcache *c, uint64_t *cursor, bool local_only,
                  struct rad_ambrec *out, size_t max)
{
    /* acquire: pairs with the release below; who has not read as far as the
     * one before has to begin at the beginning */
    struct chunk *k = atomic_load_explicit(&c->read_last, memory_order_acquire);
    size_t n = 0;

    if (k->first > *cursor)
        k = c->entries.oldest;

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
        /* past the chunk's end that asks for what is not wanted, no more */
        __builtin_prefetch(&e[READ_AHEAD].state);
        unsigned char state =
            atomic_load_explicit(&e->state, memory_order_acquire);

        if (state == EMPTY)
            break;
        if (state == LOCAL || !local_only)
            out[n++] = e->item.rec;
        ++*cursor;
    }
    if (k)
        atomic_store_explicit(&c->read_last, k, memory_order_release);
    return n;
}

size_t
rad_ambcache_count(const struct rad_ambcache *c)
{
    return atomic_load_explicit(&c->count, memory_order_relaxed);
}
