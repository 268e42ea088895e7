/* bvh.c - building the tree
 *
 * Top down: a node starts as one range of items, and the range of the largest
 * surface area is split in two until there are eight.  A split is the best
 * border between up to 16 bins along each axis by the surface area heuristic
 * (Wald 2007, On fast construction of SAH-based bounding volume hierarchies).
 * Lanes that would stay empty are filled by splitting small ranges, since
 * testing another lane is free, and testing an item is not.
 *
 * A tree of a million items takes as long to build as some 100,000 rays to
 * trace.  For fewer rays the tree is built over groups of consecutive items,
 * which are neighbours in most files; each group is a leaf. */
#include "config.h"

#include "geom/bvh.h"

#include "base/vec.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#define NBINS     16
#define SAMPLE    2048 /* items that decide where to cut a large range */
#define LEAF      4    /* a range of more items always gets a node */
#define NODE_COST 1.0f /* of testing a node, in tests of an item */

#define ITEM_COST 32.0 /* of building over an item, in tests of an item */

#define GROUP 8 /* items; as many as a leaf can have */

/* Four floats, of which the fourth is unused, or an index.  Minima and maxima
 * are one instruction on some processors. */
typedef float v4f __attribute__((vector_size(16)));
typedef int32_t v4i __attribute__((vector_size(16)));

/* Bounds in the tree's coordinates, rounded outwards. */
struct bounds {
    v4f lo, hi;
};

/* An item, or a group of them; its index is HALF_INDEX * lo[3] + hi[3], where
 * both are integers that a float holds exactly. */
struct item {
    struct bounds box;
};
#define HALF_INDEX 16384

struct range {
    struct bounds box;
    struct bounds mid; /* of the items' middles, doubled: halving would change
                        * no comparison */
    uint32_t first, count;
    float area; /* half of the box's surface */
    bool node;  /* becomes a node, not a leaf */
};

struct build {
    struct rad_bvh *bvh;
    struct item *items;
    uint32_t n, group; /* items, and how many are one here */
    struct rad_error *err;
};

static inline v4f
least(v4f a, v4f b)
{
#ifdef __SSE2__
    return _mm_min_ps(a, b);
#else
    v4f r;

    for (int i = 0; i < 4; i++)
        r[i] = a[i] < b[i] ? a[i] : b[i];
    return r;
#endif
}

static inline v4f
most(v4f a, v4f b)
{
#ifdef __SSE2__
    return _mm_max_ps(a, b);
#else
    v4f r;

    for (int i = 0; i < 4; i++)
        r[i] = a[i] > b[i] ? a[i] : b[i];
    return r;
#endif
}

static inline v4f
all_of(float x)
{
    return (v4f){ x, x, x, x };
}

static inline struct bounds
no_bounds(void)
{
    return (struct bounds){ all_of(INFINITY), all_of(-INFINITY) };
}

static inline void
grow(struct bounds *b, const struct bounds *by)
{
    b->lo = least(b->lo, by->lo);
    b->hi = most(b->hi, by->hi);
}

static inline void
include(struct bounds *b, v4f p)
{
    b->lo = least(b->lo, p);
    b->hi = most(b->hi, p);
}

/* The float below a finite one. */
static inline float
step_down(float f)
{
    int32_t bits;

    memcpy(&bits, &f, sizeof bits);
    if (f > 0)
        bits--;
    else if (f < 0)
        bits++;
    else
        bits = (int32_t)0x80000001;
    memcpy(&f, &bits, sizeof f);
    return f;
}

static inline float
round_down(double x)
{
    float f = (float)x;

    return step_down((double)f > x ? step_down(f) : f);
}

static inline float
round_up(double x)
{
    return -round_down(-x);
}

static inline float
half_area(const struct bounds *b)
{
    v4f d = b->hi - b->lo;

    return d[0] < 0 ? 0 : d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

static inline v4f
middle(const struct item *it)
{
    return it->box.lo + it->box.hi;
}

/* Does a node over the items of r save more tests than it costs?  A ray that
 * meets r meets an item with a probability equal to the ratio of surfaces. */
static bool
wants_node(const struct item *items, const struct range *r)
{
    float parts = 0;

    if (r->count == 1 || r->count > LEAF)
        return r->count > LEAF;
    for (uint32_t i = r->first; i < r->first + r->count; i++)
        parts += half_area(&items[i].box);
    return NODE_COST * r->area + parts < (float)r->count * r->area;
}

/* Set area and node; the items and bounds of r are set. */
static void
finish(const struct item *items, struct range *r)
{
    r->area = half_area(&r->box);
    r->node = wants_node(items, r);
}

static void
fit(const struct item *items, struct range *r)
{
    r->box = r->mid = no_bounds();
    for (uint32_t i = r->first; i < r->first + r->count; i++) {
        grow(&r->box, &items[i].box);
        include(&r->mid, middle(&items[i]));
    }
    finish(items, r);
}

/* Bins along each of the three axes. */
struct bins {
    struct bounds box[3][NBINS];
    uint32_t count[3][NBINS];
};

struct cut {
    float cost;
    int axis, bin; /* bins below `bin` go left */
};

/* Bins from middles: (middle - base) * per.  per is 0 along an axis on which
 * all middles are equal.  There are no more bins than items, since most ranges
 * are small. */
struct scale {
    v4f base, per, last;
    int bins;
};

static struct scale
scale_of(const struct range *r)
{
    v4f width = r->mid.hi - r->mid.lo;
    int n = r->count < NBINS ? (int)r->count : NBINS;
    struct scale s = { r->mid.lo, all_of(0), all_of((float)(n - 1)), n };

    for (int a = 0; a < 3; a++) {
        float per = (float)n / width[a];

        if (width[a] > 0 && per < INFINITY)
            s.per[a] = per;
    }
    return s;
}

static inline v4i
bins_of(const struct item *it, const struct scale *s)
{
    v4f at = (middle(it) - s->base) * s->per;

    at = most(least(at, s->last), all_of(0));
    return __builtin_convertvector(at, v4i);
}

/* Find the cheapest border between the bins of one axis, if it is cheaper than
 * *best. */
static void
sweep(const struct bins *b, int nbins, int axis, struct cut *best)
{
    struct bounds box = no_bounds();
    uint32_t n = 0, right[NBINS];
    float area[NBINS];

    for (int i = nbins - 1; i > 0; i--) {
        grow(&box, &b->box[axis][i]);
        right[i] = n += b->count[axis][i];
        area[i] = half_area(&box);
    }
    box = no_bounds();
    n = 0;
    for (int i = 1; i < nbins; i++) {
        float cost;

        grow(&box, &b->box[axis][i - 1]);
        n += b->count[axis][i - 1];
        if (!n || !right[i])
            continue;
        cost = half_area(&box) * (float)n + area[i] * (float)right[i];
        if (cost < best->cost)
            *best = (struct cut){ cost, axis, i };
    }
}

static struct cut
find_cut(const struct item *items, const struct range *r,
         const struct scale *scale)
{
    struct cut best = { INFINITY, -1, 0 };
    uint32_t step = r->count > 2 * SAMPLE ? r->count / SAMPLE : 1;
    struct bins b;

    for (int a = 0; a < 3; a++)
        for (int i = 0; i < scale->bins; i++) {
            b.box[a][i] = no_bounds();
            b.count[a][i] = 0;
        }
    for (uint32_t i = r->first; i < r->first + r->count; i += step) {
        v4i k = bins_of(&items[i], scale);

        for (int a = 0; a < 3; a++) {
            grow(&b.box[a][k[a]], &items[i].box);
            b.count[a][k[a]]++;
        }
    }
    for (int a = 0; a < 3; a++)
        if (scale->per[a] > 0)
            sweep(&b, scale->bins, a, &best);
    return best;
}

/* Split r at the cut: items in bins below it stay in r, others go to right. */
static void
partition(struct item *items, struct range *r, struct range *right,
          const struct scale *scale, const struct cut *c)
{
    uint32_t i = r->first, j = r->first + r->count, end = j;

    r->box = r->mid = right->box = right->mid = no_bounds();
    while (i < j) {
        struct item it = items[i];

        if (bins_of(&it, scale)[c->axis] < c->bin) {
            grow(&r->box, &it.box);
            include(&r->mid, middle(&it));
            i++;
        } else {
            grow(&right->box, &it.box);
            include(&right->mid, middle(&it));
            items[i] = items[--j];
            items[j] = it;
        }
    }
    r->count = i - r->first;
    right->first = i;
    right->count = end - i;
    finish(items, r);
    finish(items, right);
}

/* Split r in two; halve: in halves by count, wherever the items are. */
static void
split(struct item *items, struct range *r, struct range *right, bool halve)
{
    struct cut cut = { INFINITY, -1, 0 };
    struct scale scale = scale_of(r);
    uint32_t n = r->count / 2;

    if (!halve)
        cut = find_cut(items, r, &scale);
    if (cut.axis >= 0) {
        partition(items, r, right, &scale, &cut);
        return;
    }
    right->first = r->first + n;
    right->count = r->count - n;
    r->count = n;
    fit(items, r);
    fit(items, right);
}

/* Which of the n ranges to split next, or -1. */
static int
choose(const struct range *r, int n, bool halve)
{
    int best = -1;
    float score = -1;

    for (int i = 0; i < n; i++) {
        /* ranges that need a node come first */
        float mine = halve       ? (float)r[i].count
                     : r[i].node ? 1e3f + r[i].area
                                 : r[i].area;

        if (r[i].count > 1 && mine > score) {
            best = i;
            score = mine;
        }
    }
    return best;
}

/* Is a before b in a node?  Larger areas come first; ties go by first item. */
static bool
precedes(const struct range *a, const struct range *b)
{
    return a->area != b->area ? a->area > b->area : a->first < b->first;
}

static void
sort_ranges(struct range *r, int n)
{
    for (int i = 1; i < n; i++) {
        struct range held = r[i];
        int k = i;

        for (; k > 0 && precedes(&held, &r[k - 1]); k--)
            r[k] = r[k - 1];
        r[k] = held;
    }
}

static void
clear_lanes(struct rad_bvh_node *node)
{
    for (int i = 0; i < RAD_BVH_WIDTH; i++) {
        for (int a = 0; a < 3; a++) {
            node->bound[RAD_BVH_BOUND(a, 0) + i] = FLT_MAX;
            node->bound[RAD_BVH_BOUND(a, 1) + i] = -FLT_MAX;
        }
        node->child[i] = 0;
    }
}

static int
new_node(struct build *b, uint32_t *index)
{
    struct rad_bvh *bvh = b->bvh;

    if (bvh->nnodes == bvh->capacity) {
        uint32_t cap = bvh->capacity ? bvh->capacity / 2 * 3 : 16;
        void *p = realloc(bvh->nodes, (size_t)cap * sizeof *bvh->nodes);

        if (!p)
            return rad_fail_memory(b->err);
        bvh->nodes = p;
        bvh->capacity = cap;
    }
    *index = bvh->nnodes++;
    clear_lanes(&bvh->nodes[*index]);
    return 0;
}

static inline uint32_t
index_of(const struct item *it)
{
    return (uint32_t)it->box.lo[3] * HALF_INDEX + (uint32_t)it->box.hi[3];
}

static uint32_t
leaf_of(const struct build *b, const struct range *r)
{
    uint32_t first;

    if (b->group == 1)
        return rad_bvh_leaf(r->first, r->count);
    first = index_of(&b->items[r->first]) * b->group;
    return rad_bvh_leaf(first,
                        b->n - first < b->group ? b->n - first : b->group);
}

static void
set_lane(const struct build *b, struct rad_bvh_node *node, int lane,
         const struct range *r)
{
    for (int a = 0; a < 3; a++) {
        node->bound[RAD_BVH_BOUND(a, 0) + lane] = r->box.lo[a];
        node->bound[RAD_BVH_BOUND(a, 1) + lane] = r->box.hi[a];
    }
    node->child[lane] = leaf_of(b, r);
}

static int
build_node(struct build *b, const struct range *whole, int depth,
           uint32_t *index)
{
    struct range r[RAD_BVH_WIDTH] = { *whole };
    bool halve = depth >= RAD_BVH_DEPTH;
    int n = 1, i, rc;

    for (; n < RAD_BVH_WIDTH && (i = choose(r, n, halve)) >= 0; n++)
        split(b->items, &r[i], &r[n], halve);
    sort_ranges(r, n);
    rc = new_node(b, index);
    if (rc < 0)
        return rc;
    for (i = 0; i < n; i++)
        set_lane(b, &b->bvh->nodes[*index], i, &r[i]);
    for (i = 0; i < n; i++)
        if (b->group > 1 ? r[i].count > 1 : r[i].node) {
            uint32_t child;

            rc = build_node(b, &r[i], depth + 1, &child);
            if (rc < 0)
                return rc;
            b->bvh->nodes[*index].child[i] = child;
        }
    return 0;
}

/* Set the bounds of all items, and the coordinates of the tree. */
static void
set_frame(struct rad_bvh *bvh, const struct rad_box *boxes, uint32_t n)
{
    double half = 0;
    int e;

    for (int a = 0; a < 3 && n; a++) {
        bvh->lo[a] = INFINITY;
        bvh->hi[a] = -INFINITY;
    }
    for (uint32_t i = 0; i < n; i++)
        for (int a = 0; a < 3; a++) {
            double lo = boxes[i].lo[a], hi = boxes[i].hi[a];

            bvh->lo[a] = lo < bvh->lo[a] ? lo : bvh->lo[a];
            bvh->hi[a] = hi > bvh->hi[a] ? hi : bvh->hi[a];
        }
    for (int a = 0; a < 3; a++) {
        bvh->centre[a] = bvh->lo[a] / 2 + bvh->hi[a] / 2;
        half = fmax(half, bvh->hi[a] / 2 - bvh->lo[a] / 2);
    }
    frexp(half, &e);
    bvh->scale = half > 0 ? ldexp(1, -e) : 1;
    /* more than the rounding of a slab test in float, and of this product */
    bvh->reach = bvh->scale * (1 + 0x1p-20);
}

static void
set_items(struct item *items, const struct rad_bvh *bvh,
          const struct rad_box *boxes, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        struct item *it = &items[i];

        for (int a = 0; a < 3; a++) {
            double c = bvh->centre[a], s = bvh->scale;

            it->box.lo[a] = round_down((boxes[i].lo[a] - c) * s);
            it->box.hi[a] = round_up((boxes[i].hi[a] - c) * s);
        }
        it->box.lo[3] = (float)(i / HALF_INDEX);
        it->box.hi[3] = (float)(i % HALF_INDEX);
    }
}

/* Half of the box's surface. */
static double
half_surface(const struct rad_box *b)
{
    double x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1];
    double z = b->hi[2] - b->lo[2];

    return x * y + y * z + z * x;
}

static void
widen(struct rad_box *box, const struct rad_box *by)
{
    for (int a = 0; a < 3; a++) {
        box->lo[a] = rad_least(box->lo[a], by->lo[a]);
        box->hi[a] = rad_most(box->hi[a], by->hi[a]);
    }
}

/* Set *box to the bounds of group i. */
static void
group_bounds(const struct rad_bvh_items *list, uint32_t group, uint32_t i,
             struct rad_box *box)
{
    uint32_t first = i * group, n = list->n - first;

    list->bounds(list->arg, first, box);
    for (uint32_t k = 1; k < group && k < n; k++) {
        struct rad_box one;

        list->bounds(list->arg, first + k, &one);
        widen(box, &one);
    }
}

/* How many items are a group?  GROUP, if rays test the items of the groups that
 * they meet in less than half the time of building over single items.  Some
 * groups tell how many are met: a ray that meets the tree's bounds meets a
 * group with a probability equal to the ratio of surfaces. */
static uint32_t
group_of(const struct rad_bvh_items *list)
{
    uint32_t groups = list->n / GROUP, step = groups / SAMPLE + 1;
    struct rad_box all = { { INFINITY, INFINITY, INFINITY },
                           { -INFINITY, -INFINITY, -INFINITY } };
    double met = 0;

    if (list->rays == 0 || groups == 0)
        return 1;
    for (uint32_t i = 0; i < groups; i += step) {
        struct rad_box box;

        group_bounds(list, GROUP, i, &box);
        widen(&all, &box);
        met += half_surface(&box);
    }
    met = rad_most(1, met * step / half_surface(&all));
    return met * GROUP * list->rays < ITEM_COST / 2 * list->n ? GROUP : 1;
}

/* The tree's n items, or groups, in the caller's order; NULL: memory is out. */
static struct item *
make_items(struct rad_bvh *bvh, const struct rad_bvh_items *list,
           uint32_t group, uint32_t n)
{
    struct rad_box *boxes = malloc(((size_t)n + 1) * sizeof *boxes);
    struct item *items = NULL;

    for (uint32_t i = 0; boxes && i < n; i++)
        group_bounds(list, group, i, &boxes[i]);
    if (boxes)
        items = aligned_alloc(sizeof *items, ((size_t)n + 1) * sizeof *items);
    if (items) {
        set_frame(bvh, boxes, n);
        set_items(items, bvh, boxes, n);
    }
    free(boxes);
    return items;
}

int
rad_bvh_build(struct rad_bvh *bvh, const struct rad_bvh_items *list,
              uint32_t *order, struct rad_error *err)
{
    struct build b = { bvh, NULL, list->n, group_of(list), err };
    uint32_t root, n = list->n / b.group + (list->n % b.group > 0);
    struct range all = { .count = n };
    int rc;

    memset(bvh, 0, sizeof *bvh);
    if (list->n >= RAD_BVH_MAX_ITEMS)
        return rad_fail(err, RAD_EDATA, "too many surfaces");
    b.items = make_items(bvh, list, b.group, n);
    if (!b.items)
        return rad_fail_memory(err);
    fit(b.items, &all);
    rc = n ? build_node(&b, &all, 0, &root) : new_node(&b, &root);
    for (uint32_t i = 0; i < list->n; i++)
        order[i] = b.group > 1 ? i : index_of(&b.items[i]);
    free(b.items);
    if (rc < 0)
        rad_bvh_release(bvh);
    return rc;
}

void
rad_bvh_release(struct rad_bvh *bvh)
{
    free(bvh->nodes);
    memset(bvh, 0, sizeof *bvh);
}
