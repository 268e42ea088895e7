/* ambread.c - see ambread.h, and ambread_impl.h for the trees  */
#include "config.h"

#include "light/record/ambread_impl.h"
#include "base/vec.h"

#include <stdlib.h>
#include <string.h>
#if defined(__x86_64__)
#include <emmintrin.h>
#endif

#define AT_ONCE 3  /* records are handed on when there are so many */
#define HEAP    16 /* bytes that the heap takes beside what it gives, about */

void
rad_ambread_init(struct rad_ambread *r, const double org[3], double side)
{
    memset(r, 0, sizeof *r);
    rad_copy(r->org, org);
    r->side = side;
}

/* Free what a cell has on the heap, but for what it shares with `next`, the
 * same cell of the trees that were made next; NULL: there is none. */
static void
free_cell(const struct rad_ambread_cell *c, const struct rad_ambread_cell *next)
{
    const struct rad_ambread_cell *like =
        next && next->divided == c->divided ? next : NULL;

    if (!c->divided) {
        free(like && like->list == c->list ? NULL : c->list);
        return;
    }
    if (like && like->part == c->part)
        return;
    for (int k = 0; k < 8; k++)
        free_cell(&c->part[k], like ? &like->part[k] : NULL);
    free(c->part);
}

struct rad_ambread_trees *
rad_ambread_free_trees(struct rad_ambread_trees *t)
{
    struct rad_ambread_trees *next = t->next;

    for (int i = 0; i < TREES; i++)
        free_cell(&t->tree[i], next ? &next->tree[i] : NULL);
    free(next && next->item == t->item ? NULL : t->item);
    free(t);
    return next;
}

void
rad_ambread_release(struct rad_ambread *r)
{
    bool owned = false; /* r->item, by trees */

    rad_ambread_drop_settling(r);
    while (r->oldest) {
        owned |= r->oldest->item == r->item;
        r->oldest = rad_ambread_free_trees(r->oldest);
    }
    free(owned ? NULL : r->item);
    free(r->glint);
}

/* Make room in *array for one more element after n; if it is read it stays, and
 * a copy replaces it.  False: out of memory. */
static bool
make_room(void **array, bool is_read, size_t n, size_t *cap, size_t size)
{
    size_t more = n + n / 4 + 64;
    void *larger;

    if (n < *cap)
        return true;
    larger = realloc(is_read ? NULL : *array, more * size);
    if (!larger)
        return false;
    if (is_read)
        memcpy(larger, *array, n * size);
    *array = larger;
    *cap = more;
    return true;
}

static bool
add_glint(struct rad_ambread *r, const struct rad_glint *glint)
{
    void *array = r->glint;
    bool ok =
        make_room(&array, false, r->nglints, &r->glint_cap, sizeof *r->glint);

    r->glint = array;
    if (ok)
        r->glint[r->nglints++] =
            (struct rad_ambread_glint){ (uint32_t)r->n, *glint };
    return ok;
}

bool
rad_ambread_add(struct rad_ambread *r, const struct rad_ambrec *rec)
{
    const struct rad_ambread_trees *trees = rad_ambread_trees_of(r);
    bool is_read = trees && trees->item == r->item;
    void *array = r->item;
    bool ok = r->n < UINT32_MAX &&
              make_room(&array, is_read, r->n, &r->cap, sizeof *r->item);

    r->item = array;
    if (!ok || (rec->glint.lum > 0 && !add_glint(r, &rec->glint)))
        return false;
    rad_ambitem_set(&r->item[r->n++], rec);
    return true;
}

/* The index of the first glint that belongs to record i or a later record. */
static size_t
glint_from(const struct rad_ambread *r, size_t i)
{
    size_t lo = 0, hi = r->nglints;

    while (lo < hi) {
        size_t half = lo + (hi - lo) / 2;

        if (r->glint[half].item < i)
            lo = half + 1;
        else
            hi = half;
    }
    return lo;
}

size_t
rad_ambread_list(const struct rad_ambread *r, uint64_t *cursor,
                 struct rad_ambrec *out, size_t max)
{
    size_t n = 0, k = glint_from(r, *cursor);

    for (; n < max && *cursor < r->n; ++*cursor) {
        bool has = k < r->nglints && r->glint[k].item == *cursor;

        rad_ambitem_get(&r->item[*cursor], has ? &r->glint[k].glint : NULL,
                        &out[n++]);
        k += has;
    }
    return n;
}

void
rad_ambread_measure(const struct rad_ambread_cell *c,
                    struct rad_ambread_size *sum)
{
    size_t blocks = c->divided ? 0 : blocks_for(c->n);

    sum->blocks += blocks;
    sum->bytes += blocks * sizeof *c->list;
    sum->bytes += c->divided ? 8 * sizeof *c->part : 0;
    sum->bytes += c->n > 0 ? HEAP : 0;
    for (int k = 0; c->divided && k < 8; k++)
        rad_ambread_measure(&c->part[k], sum);
}

size_t
rad_ambread_bytes(const struct rad_ambread *r)
{
    size_t bytes = r->cap * sizeof *r->item + r->glint_cap * sizeof *r->glint;
    const struct rad_ambread_trees *trees = rad_ambread_trees_of(r);
    struct rad_ambread_size size = { 0, 0 };

    for (int i = 0; trees && i < TREES; i++)
        rad_ambread_measure(&trees->tree[i], &size);
    return bytes + size.bytes;
}

void
rad_ambread_tighten(struct rad_ambread *r)
{
    struct rad_ambread_trees *trees = rad_ambread_trees_of(r);
    void *less;

    if (!trees)
        return;
    while (r->oldest != trees)
        r->oldest = rad_ambread_free_trees(r->oldest);
    less = realloc(r->item, r->n * sizeof *r->item);
    r->item = trees->item = less ? less : r->item;
    r->cap = less ? r->n : r->cap;
    less = realloc(r->glint, (r->nglints + 1) * sizeof *r->glint);
    r->glint = less ? less : r->glint;
    r->glint_cap = less ? r->nglints + 1 : r->glint_cap;
}

/* --- look-up --- */

/* A query for a list, as bytes that compare with those of a block. */
struct probe {
    uint8_t at[3], lean[2], turn;
};

#if defined(__x86_64__)

static inline __m128i
load(const uint8_t bytes[PLACES])
{
    return _mm_loadu_si128((const __m128i *)bytes);
}

/* Nonzero where a byte is less than `low`, or `high` less than a byte. */
static inline __m128i
outside(const uint8_t low[PLACES], __m128i at, const uint8_t high[PLACES])
{
    return _mm_or_si128(_mm_subs_epu8(load(low), at),
                        _mm_subs_epu8(at, load(high)));
}

static inline __m128i
leans(const uint8_t bytes[PLACES], uint8_t from, __m128i turn)
{
    __m128i a = load(bytes), b = _mm_set1_epi8((char)from);

    return _mm_subs_epu8(_mm_or_si128(_mm_subs_epu8(a, b), _mm_subs_epu8(b, a)),
                         turn);
}

/* The places of a block whose records may serve, as bits; empty places may be
 * among them. */
static inline unsigned
passing(const struct places *b, const struct probe *q)
{
    __m128i turn = _mm_set1_epi8((char)q->turn);
    __m128i over = leans(b->lean[0], q->lean[0], turn);

    over = _mm_or_si128(over, leans(b->lean[1], q->lean[1], turn));
    for (int k = 0; k < 3; k++)
        over = _mm_or_si128(
            over, outside(b->lo[k], _mm_set1_epi8((char)q->at[k]), b->hi[k]));
    return (unsigned)_mm_movemask_epi8(
        _mm_cmpeq_epi8(over, _mm_setzero_si128()));
}

/* The places of a block with zones of at most that size, as bits. */
static inline unsigned
up_to(const struct places *b, uint8_t size)
{
    __m128i over = _mm_subs_epu8(load(b->size), _mm_set1_epi8((char)size));

    return (unsigned)_mm_movemask_epi8(
        _mm_cmpeq_epi8(over, _mm_setzero_si128()));
}

#else

static unsigned
passing(const struct places *b, const struct probe *q)
{
    unsigned pass = 0;

    for (unsigned i = 0; i < PLACES; i++) {
        bool in = abs(b->lean[0][i] - q->lean[0]) <= q->turn &&
                  abs(b->lean[1][i] - q->lean[1]) <= q->turn;

        for (int k = 0; k < 3; k++)
            in &= b->lo[k][i] <= q->at[k] && q->at[k] <= b->hi[k][i];
        pass |= (unsigned)in << i;
    }
    return pass;
}

static unsigned
up_to(const struct places *b, uint8_t size)
{
    unsigned bits = 0;

    for (unsigned i = 0; i < PLACES; i++)
        bits |= (unsigned)(b->size[i] <= size) << i;
    return bits;
}

#endif

/* A list that is being read. */
struct reading {
    const struct places *block, *end; /* the block being read; the list's end */
    struct probe probe;
    unsigned pass, read; /* places of `block` that may serve, and that were
                          * read, as bits */
    uint8_t size;        /* of the next place; NO_SIZE: all is read */
};

static inline void
begin_block(struct reading *k)
{
    k->read = 0;
    k->size = NO_SIZE;
    if (k->block == k->end)
        return;
    k->size = k->block->size[0];
    k->pass = passing(k->block, &k->probe);
}

static inline void
begin_list(struct reading *k, const struct rad_ambread_cell *cell,
           const uint32_t number[3])
{
    int shift = GRID;

    while (cell->divided) {
        shift--;
        cell = &cell->part[part_number(number, shift)];
    }
    for (int j = 0; j < 3; j++)
        k->probe.at[j] = (uint8_t)(number[j] >> (shift - 8));
    k->block = k->end = cell->list;
    if (cell->n > 0)
        k->end += blocks_for(cell->n);
    begin_block(k);
}

/* Records that were found and are not handed on yet. */
struct finds {
    const struct rad_ambitem *all; /* the records */
    double side;                   /* of the cube */
    size_t before; /* only records with a smaller index are handed on */
    rad_ambcache_fn *fn;
    void *arg;
    bool enough; /* fn wants no more */
    int n;
    const struct rad_ambitem *item[AT_ONCE - 1 + PLACES];
};

static inline void
hand_on(struct finds *f)
{
    if (f->n > 0)
        f->enough = !f->fn(f->arg, f->item, f->n);
    f->n = 0;
}

/* Read the places of this size, if they come next in the list, and find the
 * records that may serve. */
static inline void
read_size(struct reading *k, uint8_t size, struct finds *f)
{
    while (k->size == size && !f->enough) {
        unsigned now = up_to(k->block, size), found = now & ~k->read & k->pass;

        for (; found; found &= found - 1) {
            uint32_t i = k->block->item[__builtin_ctz(found)];
            const struct rad_ambitem *item = &f->all[i];

            if (i >= f->before)
                continue;
            __builtin_prefetch(item);
            __builtin_prefetch((const char *)item + LINE);
            f->item[f->n++] = item;
        }
        if (f->n >= AT_ONCE)
            hand_on(f);
        k->read = now;
        k->size = NO_SIZE;
        if (now + 1 < 1u << PLACES)
            k->size = k->block->size[__builtin_ctz(~now)];
        if (k->size == NO_SIZE) {
            k->block++;
            begin_block(k);
        }
    }
}

/* Read n lists together: the zones of one size in all lists, then those of the
 * next size. */
static void
read_all(struct reading *list, int n, struct finds *f,
         rad_ambcache_more_fn *more)
{
    bool any = false;

    for (;;) {
        uint8_t size = NO_SIZE;

        for (int i = 0; i < n; i++)
            size = list[i].size < size ? list[i].size : size;
        if (size == NO_SIZE || f->enough)
            return;
        if (any && !more(f->arg,
                         f->side / (SPAN * cells_across(MAX_DEPTH - size + 1))))
            return;
        any = true;
        for (int i = 0; i < n; i++)
            read_size(&list[i], size, f);
        hand_on(f);
    }
}

void
rad_ambread_visit(const struct rad_ambread *r, size_t before,
                  const struct rad_ambquery *q, rad_ambcache_fn *fn,
                  rad_ambcache_more_fn *more, void *arg)
{
    struct finds finds; /* set by members: its array need not be */
    unsigned faces = rad_ambfit_faces(q->fit, q->n);
    const struct rad_ambread_trees *trees = /* pairs with the release in
                                             * rad_ambread_settle_end() */
        atomic_load_explicit(&r->trees, memory_order_acquire);
    struct reading list[FACES];
    uint32_t number[3];
    uint8_t lean[3];
    int n = 0;

    if (!trees)
        return;
    finds.all = trees->item;
    finds.side = r->side;
    finds.before = before;
    finds.fn = fn;
    finds.arg = arg;
    finds.enough = false;
    finds.n = 0;
    for (int k = 0; k < 3; k++) {
        number[k] = grid_number((q->p[k] - r->org[k]) / r->side);
        lean[k] = normal_byte(q->n[k]);
    }
    for (; faces; faces &= faces - 1) {
        int face = __builtin_ctz(faces);

        list[n].probe.turn = q->fit->turn;
        for (int k = 0; k < 2; k++)
            list[n].probe.lean[k] = lean[(face / 2 + 1 + k) % 3];
        begin_list(&list[n++], &trees->tree[root_of(q->level) * FACES + face],
                   number);
    }
    read_all(list, n, &finds, more);
}
