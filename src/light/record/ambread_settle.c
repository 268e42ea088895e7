/* ambread_settle.c - new records are put into a frozen cache's trees
 *
 * A new record is added to the lists of the leaves that its zone touches; all
 * else stays, and is shared with the trees that visits read meanwhile.  The
 * lists, and the parts of cells on the way down to them, are new.  A leaf whose
 * list gets longer by a block is divided if its parts' lists take less to read,
 * by the half of a block that a step down costs.  A part is taken to be looked
 * up in proportion to its number of records, for records are made where
 * look-ups miss.  A leaf whose records are all in a single part, as those of a
 * room that is small in its scene, is divided, too: the part's list is no
 * longer, and tells boxes apart more finely.
 *
 * Copies are bounded: a tree has at most COPIES places for a record, or one
 * block.  This is shared out among the parts of a cell, in proportion to their
 * blocks.  Since that proportion changes as records come, a tree may come to
 * have more places; it is made anew when it gets records next.
 *
 * Pieces are cells that few of the new records touch; the thread that begins
 * goes down to them.  The shape of the trees does not depend on who makes which
 * piece, and what look-ups find does not depend on the shape (ambread.h). */
#include "config.h"

#include "light/record/ambread_impl.h"
#include "base/list.h"
#include "base/vec.h"

#include <stdlib.h>
#include <string.h>

#define COPIES  6  /* places for a record, in the mean, at most */
#define DEEPEST 24 /* depth of the smallest leaves */

/* A piece has at most one of so many parts of the new records, or LEAST. */
#define PARTS 256
#define LEAST 16

/* The zone of a record. */
struct extent {
    uint32_t lo[3], hi[3]; /* its box, by grid_number() */
    float at[3], reach;    /* the ball about it, in sides of the cube; rounded
                            * up by the errors of floats */
    uint32_t item;         /* index of the record */
    uint8_t size;          /* as of struct places */
    uint8_t tree;
    uint8_t touched; /* parts of a cell, as bits: divide() */
};

/* A cell of the octree. */
struct spot {
    uint32_t cell[3]; /* the cell's number along each axis, at its depth */
    int depth;
};

/* A cell and the new records that touch it. */
struct piece {
    struct rad_ambread_cell *cell;
    struct spot spot;
    size_t most; /* as of grow() */
    struct extent *list;
    size_t n;
    bool failed; /* memory was out */
};

struct rad_ambread_settling {
    rad_ambread_zone_fn *zone;
    const void *arg;
    struct rad_ambread_trees *trees; /* being made */
    struct piece *piece;
    size_t n, at_most; /* pieces; records of one at most */
    bool failed;       /* memory was out */
};

/* Trees or a piece that grow. */
struct growth {
    struct rad_ambread *r;
    bool cuts;           /* leave small cells for pieces */
    struct extent *list; /* a stack: lists of the cells on the way down and of
                          * their parts */
    size_t top, cap;     /* length of list, and its room */
    bool failed;         /* memory was out */
};

/* Set *e to the zone, half an ellipsoid about the normal (struct rad_ambzone),
 * with a margin for the rounding of its axes. */
static void
set_extent(struct extent *e, const struct rad_ambread *r, uint32_t item,
           uint8_t tree, const struct rad_ambzone *zone)
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
    e->tree = tree;
}

/* Set d2 to the squared distances of a zone's centre from the two halves of a
 * cell, of that length, along axis k; returns which halves the zone's box
 * reaches, as bits. */
static inline unsigned
halves(const struct extent *e, const struct spot *s, float half, int k,
       float d2[2])
{
    uint64_t middle = ((uint64_t)s->cell[k] * 2 + 1) << (GRID - 1 - s->depth);
    float d = e->at[k] - (float)(2 * (uint64_t)s->cell[k] + 1) * half;
    float low = fabsf(d + half / 2) - half / 2;
    float high = fabsf(d - half / 2) - half / 2;

    d2[0] = low > 0 ? low * low : 0;
    d2[1] = high > 0 ? high * high : 0;
    return (unsigned)(e->lo[k] < middle) | (unsigned)(e->hi[k] >= middle) << 1;
}

/* The parts of a cell that a zone touches, as bits, by x | y << 1 | z << 2. */
static unsigned
parts_touched(const struct extent *e, const struct spot *s, float half)
{
    float x[2], y[2], z[2], r2 = e->reach * e->reach;
    unsigned in[3] = { halves(e, s, half, 0, x), halves(e, s, half, 1, y),
                       halves(e, s, half, 2, z) };
    unsigned parts = 0;

    for (unsigned k = 0; k < 8; k++)
        parts |= (in[0] >> (k & 1) & in[1] >> (k >> 1 & 1) & in[2] >> (k >> 2) &
                  (unsigned)(x[k & 1] + y[k >> 1 & 1] + z[k >> 2] <= r2))
                 << k;
    return parts;
}

/* Make room for n more on the stack. */
static bool
reserve(struct growth *g, size_t n)
{
    struct extent *more = g->list;

    if (g->top + n <= g->cap)
        return true;
    more = realloc(more, 2 * (g->top + n) * sizeof *more);
    g->failed |= !more;
    if (more) {
        g->list = more;
        g->cap = 2 * (g->top + n);
    }
    return more != NULL;
}

/* The lists of a cell's eight parts, on the stack. */
struct parts {
    size_t from[8], n[8];
};

/* Put the lists of a cell's parts on the stack; the cell's own list has n
 * extents from list[from] on.  False: out of memory. */
static bool
divide(struct growth *g, size_t from, size_t n, const struct spot *s,
       struct parts *p)
{
    float half = ldexpf(.5f, -s->depth);
    size_t at[8];

    memset(p->n, 0, sizeof p->n);
    for (size_t i = from; i < from + n; i++) {
        unsigned touched = parts_touched(&g->list[i], s, half);

        g->list[i].touched = (uint8_t)touched;
        for (; touched; touched &= touched - 1)
            p->n[__builtin_ctz(touched)]++;
    }
    for (int k = 0; k < 8; k++) {
        if (!reserve(g, p->n[k]))
            return false;
        at[k] = p->from[k] = g->top;
        g->top += p->n[k];
    }
    for (size_t i = from; i < from + n; i++)
        for (unsigned to = g->list[i].touched; to; to &= to - 1)
            g->list[at[__builtin_ctz(to)]++] = g->list[i];
    return true;
}

/* --- leaves --- */

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
set_place(const struct growth *g, struct places *list, size_t at,
          const struct extent *e, const struct spot *s)
{
    const float *n = g->r->item[e->item].n;
    struct places *to = &list[at / PLACES];
    int axis = e->tree % FACES / 2;

    at %= PLACES;
    for (int k = 0; k < 3; k++) {
        to->lo[k][at] = byte_in(e->lo[k], s->cell[k], s->depth);
        to->hi[k][at] = byte_in(e->hi[k], s->cell[k], s->depth);
    }
    for (int k = 0; k < 2; k++)
        to->lean[k][at] = normal_byte((double)n[(axis + 1 + k) % 3]);
    to->size[at] = e->size;
    to->item[at] = e->item;
}

static void
move_place(struct places *list, size_t from, size_t at)
{
    const struct places *old = &list[from / PLACES];
    struct places *to = &list[at / PLACES];

    from %= PLACES;
    at %= PLACES;
    for (int k = 0; k < 3; k++) {
        to->lo[k][at] = old->lo[k][from];
        to->hi[k][at] = old->hi[k][from];
    }
    for (int k = 0; k < 2; k++)
        to->lean[k][at] = old->lean[k][from];
    to->size[at] = old->size[from];
    to->item[at] = old->item[from];
}

static uint8_t
size_at(const struct places *list, size_t i)
{
    return list[i / PLACES].size[i % PLACES];
}

/* Copy a leaf's list, with room for n more places.  False: out of memory. */
static bool
lengthen(struct rad_ambread_cell *c, size_t n)
{
    size_t had = blocks_for(c->n), blocks = blocks_for(c->n + n);
    struct places *list = malloc(blocks * sizeof *list);

    if (!list)
        return false;
    if (had > 0)
        memcpy(list, c->list, had * sizeof *list);
    memset(list + had, 0, (blocks - had) * sizeof *list);
    for (size_t i = had; i < blocks; i++)
        memset(list[i].size, NO_SIZE, PLACES);
    c->list = list;
    return true;
}

/* Add the n extents from list[from] on to a leaf.  Small zones come first, then
 * the order in which records were added, so a new record comes behind the old
 * ones of its size. */
static void
add_to_leaf(struct growth *g, struct rad_ambread_cell *c, size_t from, size_t n,
            const struct spot *s)
{
    const struct extent *e = &g->list[from];
    size_t old = c->n, to = c->n + n;

    if (!lengthen(c, n)) {
        g->failed = true;
        return;
    }
    c->n += (uint32_t)n;
    while (n > 0)
        if (old > 0 && size_at(c->list, old - 1) > e[n - 1].size)
            move_place(c->list, --old, --to);
        else
            set_place(g, c->list, --to, &e[--n], s);
}

/* --- cells that are divided --- */

/* Put the extents of a leaf on the stack, merged with the n that are new, from
 * list[from] on.  False: out of memory. */
static bool
gather(struct growth *g, const struct rad_ambread_cell *c, size_t from,
       size_t n)
{
    const struct rad_ambread_settling *s = g->r->settling;
    uint8_t tree = g->list[from].tree;
    struct extent *to;

    if (!reserve(g, c->n + n))
        return false;
    to = &g->list[g->top];
    g->top += c->n + n;
    for (size_t i = 0, end = from + n; i < c->n || from < end;)
        if (i == c->n ||
            (from < end && size_at(c->list, i) > g->list[from].size)) {
            *to++ = g->list[from++];
        } else {
            uint32_t item = c->list[i / PLACES].item[i % PLACES];
            struct rad_ambzone zone = s->zone(s->arg, &g->r->item[item]);

            set_extent(to++, g->r, item, tree, &zone);
            i++;
        }
    return true;
}

/* Is a leaf of n records divided?  Yes, if all are in a single part; or if the
 * parts' lists take at most `most` blocks, and less to read than the leaf's by
 * half a block: means, weighted by the parts' numbers of records. */
static bool
is_divided(const struct parts *p, size_t n, size_t most)
{
    size_t blocks = 0, sum = 0, places = 0;
    bool single = false;

    for (int k = 0; k < 8; k++) {
        blocks += blocks_for(p->n[k]);
        sum += p->n[k] * 2 * blocks_for(p->n[k]);
        places += p->n[k];
        single |= p->n[k] == n;
    }
    return (single && places == n) ||
           (blocks <= most && sum < places * (2 * blocks_for(n) - 1));
}

static void grow(struct growth *g, struct rad_ambread_cell *c, size_t from,
                 size_t n, size_t most, const struct spot *s);

/* Add to the parts of a divided cell what *p lists; they get at most `most`
 * blocks unless they are leaves. */
static void
grow_parts(struct growth *g, struct rad_ambread_cell *part,
           const struct parts *p, size_t most, const struct spot *s)
{
    size_t blocks[8], all = 0;

    for (int k = 0; k < 8; k++) {
        blocks[k] = blocks_for(part[k].n + p->n[k]);
        all += blocks[k];
    }
    for (unsigned k = 0; k < 8; k++) {
        struct spot spot = { { s->cell[0] << 1 | (k & 1),
                               s->cell[1] << 1 | (k >> 1 & 1),
                               s->cell[2] << 1 | k >> 2 },
                             s->depth + 1 };

        if (p->n[k] > 0)
            grow(g, &part[k], p->from[k], p->n[k], most * blocks[k] / all,
                 &spot);
    }
}

/* Divide a leaf to which n records are added, if that is better; arguments as
 * of grow().  False: the leaf is as it was. */
static bool
split(struct growth *g, struct rad_ambread_cell *c, size_t from, size_t n,
      size_t most, const struct spot *s)
{
    size_t all = c->n + n, top = g->top;
    struct rad_ambread_cell *part;
    struct parts p;

    if (all <= PLACES || blocks_for(all) == blocks_for(c->n) ||
        s->depth == DEEPEST || !gather(g, c, from, n) ||
        !divide(g, top, all, s, &p) || !is_divided(&p, all, most))
        return false;
    part = calloc(8, sizeof *part);
    g->failed |= !part;
    if (!part)
        return false;
    *c = (struct rad_ambread_cell){ { .part = part }, (uint32_t)all, true };
    grow_parts(g, part, &p, most, s);
    return true;
}

/* Leave a cell to a piece; arguments as of grow(). */
static void
cut(struct growth *g, const struct piece *as, size_t from)
{
    struct rad_ambread_settling *s = g->r->settling;
    struct piece *p;

    if (!rad_list_grow(&s->piece, s->n, sizeof *s->piece)) {
        g->failed = true;
        return;
    }
    p = &s->piece[s->n++];
    *p = *as;
    p->list = malloc(p->n * sizeof *p->list);
    p->failed = !p->list;
    if (p->list)
        memcpy(p->list, &g->list[from], p->n * sizeof *p->list);
}

/* Copy the parts of a divided cell.  False: out of memory. */
static bool
copy_parts(struct growth *g, struct rad_ambread_cell *c)
{
    struct rad_ambread_cell *part = malloc(8 * sizeof *part);

    g->failed |= !part;
    if (part)
        c->part = memcpy(part, c->part, 8 * sizeof *part);
    return part != NULL;
}

/* Add the n new extents from list[from] on, at least one, to the cell *c, with
 * at most `most` blocks unless it is a leaf. */
static void
grow(struct growth *g, struct rad_ambread_cell *c, size_t from, size_t n,
     size_t most, const struct spot *s)
{
    size_t top = g->top;
    struct parts p;

    if (g->failed)
        return;
    if (g->cuts && n <= g->r->settling->at_most)
        cut(g, &(struct piece){ c, *s, most, NULL, n, false }, from);
    else if (c->divided && divide(g, from, n, s, &p) && copy_parts(g, c)) {
        c->n += (uint32_t)n;
        grow_parts(g, c->part, &p, most, s);
    } else if (!c->divided && !split(g, c, from, n, most, s) && !g->failed)
        add_to_leaf(g, c, from, n, s);
    g->top = top;
}

/* --- settling --- */

static int
tree_of(const struct rad_ambitem *item)
{
    return root_of(item->level) * FACES + face_of(item->n);
}

/* Orders extents: by tree, small zones first, then as their records were added.
 */
static int
compare(const void *one, const void *other)
{
    const struct extent *a = one, *b = other;

    if (a->tree != b->tree)
        return a->tree < b->tree ? -1 : 1;
    if (a->size != b->size)
        return a->size < b->size ? -1 : 1;
    return a->item < b->item ? -1 : a->item > b->item;
}

/* Begin those trees anew that have too many places: large zones came behind
 * small ones that their cells were divided for.  They are made of the records
 * from the returned index on, those in other trees left out. */
static size_t
empty_wasteful(struct rad_ambread *r)
{
    size_t from = r->settled;

    for (int i = 0; i < TREES; i++) {
        struct rad_ambread_cell *root = &r->settling->trees->tree[i];
        struct rad_ambread_size has = { 0, 0 };

        rad_ambread_measure(root, &has);
        if (has.blocks > 1 && has.blocks * PLACES > root->n * COPIES) {
            *root = (struct rad_ambread_cell){ .n = 0 };
            from = 0;
        }
    }
    return from;
}

/* Put the extents of the records on the stack that are in no tree. */
static void
list_new(struct growth *g)
{
    struct rad_ambread *r = g->r;
    const struct rad_ambread_settling *s = r->settling;
    size_t i = empty_wasteful(r);

    if (!reserve(g, r->n - i))
        return;
    for (; i < r->n; i++) {
        int tree = tree_of(&r->item[i]);

        if (i >= r->settled || s->trees->tree[tree].n == 0) {
            struct rad_ambzone zone = s->zone(s->arg, &r->item[i]);

            set_extent(&g->list[g->top++], r, (uint32_t)i, (uint8_t)tree,
                       &zone);
        }
    }
    qsort(g->list, g->top, sizeof *g->list, compare);
}

/* Add the new records to their trees, down to pieces. */
static void
grow_trees(struct growth *g)
{
    struct rad_ambread *r = g->r;
    struct spot whole = { .depth = 0 };
    size_t all = g->top;

    for (size_t i = 0, end; i < all; i = end) {
        struct rad_ambread_cell *root =
            &r->settling->trees->tree[g->list[i].tree];

        for (end = i; end < all && g->list[end].tree == g->list[i].tree;)
            end++;
        grow(g, root, i, end - i, (root->n + end - i) * COPIES / PLACES,
             &whole);
    }
}

/* Free former trees that no visit can be at. */
static void
free_former(struct rad_ambread *r, const struct rad_ambread_trees *now,
            bool alone)
{
    while (
        r->oldest != now &&
        (alone || r->settlings - r->oldest->next->number >= RAD_AMBREAD_LATE))
        r->oldest = rad_ambread_free_trees(r->oldest);
}

/* A copy of the trees that visits read, behind these.  NULL: out of memory. */
static struct rad_ambread_trees *
copy_trees(struct rad_ambread *r, struct rad_ambread_trees *now)
{
    struct rad_ambread_trees *trees = calloc(1, sizeof *trees);

    if (trees && now)
        memcpy(trees->tree, now->tree, sizeof trees->tree);
    if (!trees)
        return NULL;
    trees->number = r->settlings;
    trees->item = r->item;
    *(now ? &now->next : &r->oldest) = trees;
    return trees;
}

size_t
rad_ambread_settle_begin(struct rad_ambread *r, bool alone,
                         rad_ambread_zone_fn *zone, const void *arg)
{
    struct growth g = { .r = r, .cuts = true };
    struct rad_ambread_trees *now = rad_ambread_trees_of(r);

    r->settlings++;
    free_former(r, now, alone);
    if (r->settled == r->n)
        return 0;
    r->settling = calloc(1, sizeof *r->settling);
    if (!r->settling)
        return 0;
    r->settling->trees = copy_trees(r, now);
    r->settling->failed = !r->settling->trees;
    if (r->settling->failed)
        return 0;
    r->settling->zone = zone;
    r->settling->arg = arg;
    list_new(&g);
    r->settling->at_most = g.top / PARTS > LEAST ? g.top / PARTS : LEAST;
    grow_trees(&g);
    r->settling->failed = g.failed;
    free(g.list);
    return r->settling->n;
}

void
rad_ambread_settle_piece(struct rad_ambread *r, size_t piece)
{
    struct piece *p = &r->settling->piece[piece];
    struct growth g = {
        .r = r, .list = p->list, .top = p->n, .cap = p->n, .failed = p->failed
    };

    grow(&g, p->cell, 0, p->n, p->most, &p->spot);
    free(g.list);
    p->list = NULL;
    p->failed = g.failed;
}

void
rad_ambread_drop_settling(struct rad_ambread *r)
{
    struct rad_ambread_settling *s = r->settling;

    for (size_t i = 0; s && i < s->n; i++)
        free(s->piece[i].list);
    free(s ? s->piece : NULL);
    free(s);
    r->settling = NULL;
}

bool
rad_ambread_settle_end(struct rad_ambread *r)
{
    struct rad_ambread_settling *s = r->settling;
    struct rad_ambread_trees *trees = s ? s->trees : NULL;
    bool failed = !s || s->failed;

    if (r->settled == r->n)
        return true;
    for (size_t i = 0; s && i < s->n; i++)
        failed |= s->piece[i].failed;
    rad_ambread_drop_settling(r);
    if (failed)
        return false;
    r->settled = r->n;
    /* pairs with the acquire in rad_ambread_visit() */
    atomic_store_explicit(&r->trees, trees, memory_order_release);
    return true;
}
