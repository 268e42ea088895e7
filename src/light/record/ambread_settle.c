/* ambread_settle.c - a frozen cache's trees are made
 *
 * A cell is divided if its parts' lists take less to read than its own, by the
 * half of a block that a step down costs.  A part is taken to be looked up in
 * proportion to its number of records, for records are made where look-ups
 * miss.  Where all records of a cell are in a single part, as in a room that is
 * small in its scene, the part takes the cell's place: its list is no longer,
 * and tells boxes apart more finely.
 * Copies are bounded: a tree has at most COPIES places for a record, or one
 * block.  When a cell is divided its bound is shared out among its parts, in
 * proportion to their blocks.  */
#include "config.h"

#include "light/record/ambread_impl.h"
#include "base/vec.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#define COPIES  6  /* places for a record, in the mean, at most */
#define DEEPEST 24 /* depth of the smallest leaves */

/* The zone of a record. */
struct extent {
    uint32_t lo[3], hi[3]; /* its box, by grid_number() */
    float at[3], reach;    /* the ball about it, in sides of the cube; rounded
                            * up by the errors of floats */
    uint32_t item;         /* index of the record */
    uint8_t size;          /* as of struct places */
};

/* A tree being made. */
struct build {
    const struct rad_ambread *r;
    struct rad_ambread_tree tree;
    size_t most_parts, most_blocks; /* room in tree.part and tree.block */
    int face;
    const struct extent *extent;
    uint32_t *list;   /* a stack: indices of extents, for each cell on the way
                       * down and its parts */
    size_t top, most; /* length of list, and its room */
    uint8_t *touched; /* parts that each extent of a cell touches, as bits */
    bool failed;      /* memory was out */
};

/* Set *e to the zone, half an ellipsoid about the normal (struct rad_ambzone),
 * with a margin for the rounding of its axes. */
static void
set_extent(struct extent *e, const struct rad_ambread *r, uint32_t item,
           const struct rad_ambzone *zone)
{
    const struct rad_ambitem *it = &r->item[item];
    double per = (1 + 0x1p-20) / r->side, q[3];
    float across[3];
    double reach = zone->reach * per + 0x1p-48;
    double height = zone->height * per + 0x1p-48;
    double behind = zone->behind * per + 0x1p-48, slack = 2e-3 * reach;

    rad_ambitem_across(it, across);
    for (int k = 0; k < 3; k++) {
        double n = it->n[k], v = across[k];
        double wide = reach * reach * v * v;
        double whole =
            sqrt(wide + height * height * rad_most(1 - v * v, 0)) + slack;
        double half =
            sqrt(wide + height * height * rad_most(1 - v * v - n * n, 0)) +
            behind * fabs(n) + slack;

        half = rad_least(half, whole);
        q[k] = (it->p[k] - r->org[k]) / r->side;
        e->lo[k] = grid_number(q[k] - (n < 0 ? whole : half));
        e->hi[k] = grid_number(q[k] + (n < 0 ? half : whole));
        e->at[k] = (float)clamp(q[k], 0, 1);
    }
    e->reach = (float)(reach + slack + 1e-6);
    e->item = item;
    e->size = (uint8_t)(MAX_DEPTH - depth_for(reach));
}

/* A cell of the octree. */
struct spot {
    uint32_t cell[3]; /* the cell's number along each axis, at its depth */
    int depth;
};

/* Set d2 to the squared distances of a zone's centre from the two halves of a
 * cell along axis k; returns which halves the zone's box reaches, as bits. */
static inline unsigned
halves(const struct extent *e, const struct spot *s, int k, float d2[2])
{
    uint64_t middle = ((uint64_t)s->cell[k] * 2 + 1) << (GRID - 1 - s->depth);
    float side = ldexpf(.5f, -s->depth);
    float d = e->at[k] - (float)(2 * (uint64_t)s->cell[k] + 1) * side;
    float low = fabsf(d + side / 2) - side / 2;
    float high = fabsf(d - side / 2) - side / 2;

    d2[0] = low > 0 ? low * low : 0;
    d2[1] = high > 0 ? high * high : 0;
    return (unsigned)(e->lo[k] < middle) | (unsigned)(e->hi[k] >= middle) << 1;
}

/* The parts of a cell that a zone touches, as bits, by x | y << 1 | z << 2. */
static unsigned
parts_touched(const struct extent *e, const struct spot *s)
{
    float x[2], y[2], z[2], r2 = e->reach * e->reach;
    unsigned in[3] = { halves(e, s, 0, x), halves(e, s, 1, y),
                       halves(e, s, 2, z) };
    unsigned parts = 0;

    for (unsigned k = 0; k < 8; k++)
        parts |= (in[0] >> (k & 1) & in[1] >> (k >> 1 & 1) & in[2] >> (k >> 2) &
                  (unsigned)(x[k & 1] + y[k >> 1 & 1] + z[k >> 2] <= r2))
                 << k;
    return parts;
}

static size_t
blocks_for(size_t n)
{
    return (n + PLACES - 1) / PLACES;
}

static void
push(struct build *b, uint32_t e)
{
    if (b->top == b->most) {
        size_t most = 2 * b->most + 1024;
        uint32_t *more = realloc(b->list, most * sizeof *more);

        b->failed |= !more;
        if (!more)
            return;
        b->list = more;
        b->most = most;
    }
    b->list[b->top++] = e;
}

/* A coordinate of a box, by grid_number(), as a byte in a cell: 0 or 255 beyond
 * the cell. */
static uint8_t
byte_in(uint32_t number, uint32_t cell, int depth)
{
    uint64_t from = (uint64_t)cell << (GRID - depth);
    uint64_t last = from + (UINT64_C(1) << (GRID - depth)) - 1;
    uint64_t at = number < from ? from : number > last ? last : number;

    return (uint8_t)((at - from) >> (GRID - depth - 8));
}

static void
fill(const struct build *b, struct places *to, int i, const struct extent *e,
     const struct spot *s)
{
    const float *n = b->r->item[e->item].n;
    int axis = b->face / 2;

    for (int k = 0; k < 3; k++) {
        to->lo[k][i] = byte_in(e->lo[k], s->cell[k], s->depth);
        to->hi[k][i] = byte_in(e->hi[k], s->cell[k], s->depth);
    }
    for (int k = 0; k < 2; k++)
        to->lean[k][i] = normal_byte((double)n[(axis + 1 + k) % 3]);
    to->size[i] = e->size;
    to->item[i] = e->item;
}

/* Make a leaf of the n extents from list[from] on. */
static uint64_t
make_leaf(struct build *b, size_t from, size_t n, const struct spot *s)
{
    struct rad_ambread_tree *t = &b->tree;
    size_t first = t->nblocks, blocks = blocks_for(n);

    if (first + blocks > b->most_blocks) {
        size_t most = 2 * first + blocks;
        struct places *more = realloc(t->block, most * sizeof *more);

        b->failed |= !more;
        if (!more)
            return LEAF;
        t->block = more;
        b->most_blocks = most;
    }
    t->nblocks += blocks;
    for (size_t i = 0; i < blocks; i++) {
        memset(&t->block[first + i], 0, sizeof *t->block);
        memset(t->block[first + i].size, NO_SIZE, PLACES);
    }
    for (size_t i = 0; i < n; i++)
        fill(b, &t->block[first + i / PLACES], (int)(i % PLACES),
             &b->extent[b->list[from + i]], s);
    return LEAF | (uint64_t)blocks << 32 | first;
}

static struct spot
part_of(const struct spot *s, unsigned k)
{
    return (struct spot){ { s->cell[0] << 1 | (k & 1),
                            s->cell[1] << 1 | (k >> 1 & 1),
                            s->cell[2] << 1 | k >> 2 },
                          s->depth + 1 };
}

/* The lists of a cell's eight parts, on the stack. */
struct parts {
    size_t from[8], n[8];
    size_t blocks; /* of all eight, as leaves */
};

/* Put the lists of a cell's parts on the stack; the cell's own list has n
 * extents from list[from] on. */
static void
divide(struct build *b, size_t from, size_t n, const struct spot *s,
       struct parts *p)
{
    for (size_t i = 0; i < n; i++)
        b->touched[i] =
            (uint8_t)parts_touched(&b->extent[b->list[from + i]], s);
    p->blocks = 0;
    for (unsigned k = 0; k < 8; k++) {
        p->from[k] = b->top;
        for (size_t i = 0; i < n; i++)
            if (b->touched[i] >> k & 1)
                push(b, b->list[from + i]);
        p->n[k] = b->top - p->from[k];
        p->blocks += blocks_for(p->n[k]);
    }
}

/* The only part that a cell's n extents touch; 8: there are several. */
static unsigned
only_part(const struct parts *p, size_t n)
{
    unsigned k = 0;

    while (k < 8 && (p->n[k] < n || p->blocks > blocks_for(n)))
        k++;
    return k;
}

/* As divide(), of the smallest cell in *s that has all of these extents to
 * itself; *s becomes that cell. */
static void
divide_within(struct build *b, size_t from, size_t n, struct spot *s,
              struct parts *p)
{
    size_t top = b->top;
    unsigned only;

    for (;;) {
        divide(b, from, n, s, p);
        only = only_part(p, n);
        if (only == 8 || s->depth + 1 == DEEPEST || b->failed)
            return;
        b->top = top;
        *s = part_of(s, only);
    }
}

/* Do the parts' lists take less to read than the cell's, of n extents, by half
 * a block?  Means, weighted by the parts' numbers of records. */
static bool
pays(const struct parts *p, size_t n)
{
    size_t sum = 0, whole = 0;

    for (int k = 0; k < 8; k++) {
        sum += p->n[k] * 2 * blocks_for(p->n[k]);
        whole += p->n[k];
    }
    return sum < whole * (2 * blocks_for(n) - 1);
}

/* Eight new cells; returns the index of the first. */
static size_t
new_parts(struct build *b)
{
    struct rad_ambread_tree *t = &b->tree;

    if (t->nparts + 8 > b->most_parts) {
        size_t most = 2 * t->nparts + 8;
        uint64_t *more = realloc(t->part, most * sizeof *more);

        b->failed |= !more;
        if (!more)
            return 0;
        t->part = more;
        b->most_parts = most;
    }
    t->nparts += 8;
    return t->nparts - 8;
}

/* The number of the cell that is so many steps above the cell *s, whose number
 * is `cell`, and that holds nothing else. */
static uint64_t
wrap(struct build *b, uint64_t cell, const struct spot *s, int steps)
{
    for (int i = 0; i < steps; i++) {
        size_t at = new_parts(b);

        if (b->failed)
            return LEAF;
        for (int k = 0; k < 8; k++)
            b->tree.part[at + (size_t)k] = LEAF;
        b->tree.part[at + part_number(s->cell, i)] = cell;
        cell = at;
    }
    return cell;
}

static uint64_t make_parts(struct build *b, const struct parts *p, size_t most,
                           const struct spot *s);

/* Make the cell of the n extents from list[from] on, with at most `most` blocks
 * unless it is a leaf; returns its number. */
static uint64_t
make_cell(struct build *b, size_t from, size_t n, size_t most,
          const struct spot *s)
{
    struct spot inner = *s;
    size_t top = b->top;
    struct parts p;
    uint64_t cell;

    if (n <= PLACES || s->depth == DEEPEST || b->failed)
        return make_leaf(b, from, n, s);
    divide_within(b, from, n, &inner, &p);
    cell = b->failed || p.blocks > most || !pays(&p, n)
               ? make_leaf(b, from, n, &inner)
               : make_parts(b, &p, most, &inner);
    b->top = top;
    return wrap(b, cell, &inner, inner.depth - s->depth);
}

/* Make the parts of the cell *s, with at most `most` blocks unless they are
 * leaves; returns the cell's number. */
static uint64_t
make_parts(struct build *b, const struct parts *p, size_t most,
           const struct spot *s)
{
    size_t at = new_parts(b);

    for (unsigned k = 0; k < 8 && !b->failed; k++) {
        struct spot part = part_of(s, k);
        uint64_t cell =
            make_cell(b, p->from[k], p->n[k],
                      most * blocks_for(p->n[k]) / p->blocks, &part);

        if (!b->failed)
            b->tree.part[at + k] = cell;
    }
    return at;
}

/* Give back memory that was not needed. */
static void
trim(struct build *b)
{
    struct rad_ambread_tree *t = &b->tree;
    void *less = realloc(t->part, (t->nparts + 1) * sizeof *t->part);

    t->part = less ? less : t->part;
    less = realloc(t->block, (t->nblocks + 1) * sizeof *t->block);
    t->block = less ? less : t->block;
}

/* Make the tree of n extents, which are in the order of compare(), in place of
 * the old tree.  False: out of memory; the old tree stays. */
static bool
make_tree(struct rad_ambread *r, int which, const struct extent *extent,
          size_t n)
{
    struct build b = { .r = r, .face = which % FACES, .extent = extent };
    struct spot whole = { .depth = 0 };
    size_t most = n * COPIES / PLACES;

    b.touched = malloc(n);
    b.failed = !b.touched;
    for (uint32_t i = 0; i < n; i++)
        push(&b, i);
    if (!b.failed)
        b.tree.root = make_cell(&b, 0, n, most, &whole);
    free(b.list);
    free(b.touched);
    if (b.failed) {
        rad_ambread_release_tree(&b.tree);
        return false;
    }
    trim(&b);
    rad_ambread_release_tree(&r->tree[which]);
    r->tree[which] = b.tree;
    return true;
}

static int
tree_of(const struct rad_ambitem *item)
{
    return root_of(item->level) * FACES + face_of(item->n);
}

/* Orders extents: small zones first, then as their records were added. */
static int
compare(const void *one, const void *other)
{
    const struct extent *a = one, *b = other;

    if (a->size != b->size)
        return a->size < b->size ? -1 : 1;
    return a->item < b->item ? -1 : 1;
}

/* Make a tree anew from all n records that belong to it. */
static bool
remake(struct rad_ambread *r, int which, size_t n, rad_ambread_zone_fn *zone,
       const void *arg)
{
    struct extent *extent = calloc(n, sizeof *extent);
    size_t got = 0;
    bool ok;

    if (!extent)
        return false;
    for (uint32_t i = 0; i < r->n; i++)
        if (tree_of(&r->item[i]) == which) {
            struct rad_ambzone z = zone(arg, &r->item[i]);

            set_extent(&extent[got++], r, i, &z);
        }
    assert(got == n);
    qsort(extent, n, sizeof *extent, compare);
    ok = make_tree(r, which, extent, n);
    free(extent);
    return ok;
}

static bool
make_forest(struct rad_ambread *r)
{
    if (r->tree)
        return true;
    r->tree = calloc(ROOTS * FACES, sizeof *r->tree);
    for (int i = 0; r->tree && i < ROOTS * FACES; i++)
        r->tree[i].root = LEAF;
    return r->tree != NULL;
}

bool
rad_ambread_settle(struct rad_ambread *r, rad_ambread_zone_fn *zone,
                   const void *arg)
{
    size_t n[ROOTS * FACES] = { 0 };
    bool grown[ROOTS * FACES] = { false };
    void *less;

    if (r->settled == r->n)
        return true;
    if (!make_forest(r))
        return false;
    for (size_t i = 0; i < r->n; i++) {
        int which = tree_of(&r->item[i]);

        n[which]++;
        grown[which] |= i >= r->settled;
    }
    for (int i = 0; i < ROOTS * FACES; i++)
        if (grown[i] && !remake(r, i, n[i], zone, arg))
            return false;
    less = realloc(r->item, r->n * sizeof *r->item);
    r->item = less ? less : r->item;
    r->cap = less ? r->n : r->cap;
    less = realloc(r->glint, (r->nglints + 1) * sizeof *r->glint);
    r->glint = less ? less : r->glint;
    r->glint_cap = less ? r->nglints + 1 : r->glint_cap;
    r->settled = r->n;
    return true;
}
