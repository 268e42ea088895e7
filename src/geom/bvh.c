/* bvh.c - building the tree, and rays in its coordinates
 *
 * Top down: a node starts as one range of items, and the range of the largest
 * surface is split in two until eight are there.  A split is the best of 16
 * bins along each axis by the surface area heuristic (Wald 2007, On fast
 * construction of SAH-based bounding volume hierarchies).  Lanes that would
 * stay empty are filled by splitting small ranges: testing a lane is free, an
 * item is not. */
#include "config.h"

#include "geom/bvh.h"

#include "base/vec.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NBINS     16
#define LEAF      4    /* a larger range always gets a node of its own */
#define NODE_COST 1.0f /* of testing a node, in tests of an item */

/* An item's bounds in the tree's coordinates, rounded outwards. */
struct item {
    float lo[3];
    uint32_t index; /* the caller's */
    float hi[3];
    uint32_t unused; /* 32 bytes: half a cache line */
};

struct range {
    uint32_t first, count;
    float lo[3], hi[3];
};

struct build {
    struct rad_bvh *bvh;
    struct item *items;
    struct rad_error *err;
};

static float
round_down(double x)
{
    float f = (float)x;

    return nextafterf((double)f > x ? nextafterf(f, -INFINITY) : f, -INFINITY);
}

static float
round_up(double x)
{
    return -round_down(-x);
}

static void
empty_box(float lo[3], float hi[3])
{
    for (int i = 0; i < 3; i++) {
        lo[i] = INFINITY;
        hi[i] = -INFINITY;
    }
}

static void
grow(float lo[3], float hi[3], const float l[3], const float h[3])
{
    for (int i = 0; i < 3; i++) {
        lo[i] = l[i] < lo[i] ? l[i] : lo[i];
        hi[i] = h[i] > hi[i] ? h[i] : hi[i];
    }
}

static float
half_area(const float lo[3], const float hi[3])
{
    float x = hi[0] - lo[0], y = hi[1] - lo[1], z = hi[2] - lo[2];

    return x < 0 ? 0 : x * y + y * z + z * x;
}

static void
fit(const struct item *items, struct range *r)
{
    empty_box(r->lo, r->hi);
    for (uint32_t i = 0; i < r->count; i++)
        grow(r->lo, r->hi, items[r->first + i].lo, items[r->first + i].hi);
}

/* Twice the middle; halving changes no comparison. */
static float
middle(const struct item *it, int axis)
{
    return it->lo[axis] + it->hi[axis];
}

struct bins {
    float lo[NBINS][3], hi[NBINS][3];
    uint32_t count[NBINS];
};

struct cut {
    float cost;
    int axis, bin;   /* bins below `bin` go left */
    float base, per; /* bin = (middle - base) * per */
};

static int
bin_of(const struct item *it, const struct cut *c)
{
    int b = (int)((middle(it, c->axis) - c->base) * c->per);

    return b < 0 ? 0 : b >= NBINS ? NBINS - 1 : b;
}

/* Cost of each border between bins of one axis; keeps the best. */
static void
sweep(const struct bins *b, struct cut at, struct cut *best)
{
    float lo[3], hi[3], area[NBINS];
    uint32_t n = 0, right[NBINS];

    empty_box(lo, hi);
    for (int i = NBINS - 1; i > 0; i--) {
        grow(lo, hi, b->lo[i], b->hi[i]);
        right[i] = n += b->count[i];
        area[i] = half_area(lo, hi);
    }
    empty_box(lo, hi);
    n = 0;
    for (int i = 1; i < NBINS; i++) {
        grow(lo, hi, b->lo[i - 1], b->hi[i - 1]);
        n += b->count[i - 1];
        if (!n || !right[i])
            continue;
        at.cost = half_area(lo, hi) * n + area[i] * right[i];
        if (at.cost < best->cost) {
            at.bin = i;
            *best = at;
        }
    }
}

static void
try_axis(const struct item *items, const struct range *r, struct cut at,
         struct cut *best)
{
    struct bins b;

    memset(b.count, 0, sizeof b.count);
    for (int i = 0; i < NBINS; i++)
        empty_box(b.lo[i], b.hi[i]);
    for (uint32_t i = 0; i < r->count; i++) {
        const struct item *it = &items[r->first + i];
        int k = bin_of(it, &at);

        b.count[k]++;
        grow(b.lo[k], b.hi[k], it->lo, it->hi);
    }
    sweep(&b, at, best);
}

static uint32_t
partition(struct item *items, const struct range *r, const struct cut *c)
{
    uint32_t i = r->first, j = r->first + r->count;

    while (i < j)
        if (bin_of(&items[i], c) < c->bin) {
            i++;
        } else {
            struct item swap = items[--j];

            items[j] = items[i];
            items[i] = swap;
        }
    return i - r->first;
}

/* Split r in two; halve: by count, whatever the places. */
static void
split(struct item *items, struct range *r, struct range *right, bool halve)
{
    struct cut best = { INFINITY, -1, 0, 0, 0 };
    uint32_t n = r->count / 2;

    for (int axis = 0; axis < 3 && !halve; axis++) {
        struct cut at = { 0, axis, 0, 0, 0 };
        float lo = INFINITY, hi = -INFINITY;

        for (uint32_t i = 0; i < r->count; i++) {
            float m = middle(&items[r->first + i], axis);

            lo = m < lo ? m : lo;
            hi = m > hi ? m : hi;
        }
        at.base = lo;
        at.per = NBINS / (hi - lo);
        if (hi > lo && at.per < INFINITY)
            try_axis(items, r, at, &best);
    }
    if (best.axis >= 0)
        n = partition(items, r, &best);
    right->first = r->first + n;
    right->count = r->count - n;
    r->count = n;
    fit(items, r);
    fit(items, right);
}

/* Does a node for the items of r save tests enough to pay for itself?  The
 * chance that a ray which meets r meets an item is the ratio of surfaces. */
static bool
wants_node(const struct item *items, const struct range *r)
{
    float whole = half_area(r->lo, r->hi), parts = 0;

    if (r->count == 1 || r->count > LEAF)
        return r->count > LEAF;
    for (uint32_t i = r->first; i < r->first + r->count; i++)
        parts += half_area(items[i].lo, items[i].hi);
    return NODE_COST * whole + parts < (float)r->count * whole;
}

/* Which of the n ranges to split next, or -1. */
static int
choose(const struct item *items, const struct range *r, int n, bool halve)
{
    int best = -1;
    float most = -1;

    for (int i = 0; i < n; i++) {
        float area = half_area(r[i].lo, r[i].hi);
        /* those that need a node come first */
        float score = halve                      ? (float)r[i].count
                      : wants_node(items, &r[i]) ? 1e3f + area
                                                 : area;

        if (r[i].count > 1 && score > most) {
            best = i;
            most = score;
        }
    }
    return best;
}

static int
by_area(const void *a, const void *b)
{
    const struct range *ra = a, *rb = b;
    float x = half_area(ra->lo, ra->hi), y = half_area(rb->lo, rb->hi);

    if (x != y)
        return x > y ? -1 : 1;
    return ra->first < rb->first ? -1 : 1;
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
            return rad_fail(b->err, RAD_ENOMEM, "out of memory");
        bvh->nodes = p;
        bvh->capacity = cap;
    }
    *index = bvh->nnodes++;
    clear_lanes(&bvh->nodes[*index]);
    return 0;
}

static void
set_lane(struct rad_bvh_node *node, int lane, const struct range *r)
{
    for (int a = 0; a < 3; a++) {
        node->bound[RAD_BVH_BOUND(a, 0) + lane] = r->lo[a];
        node->bound[RAD_BVH_BOUND(a, 1) + lane] = r->hi[a];
    }
    node->child[lane] = rad_bvh_leaf(r->first, r->count);
}

static int
build_node(struct build *b, const struct range *whole, int depth,
           uint32_t *index)
{
    struct range r[RAD_BVH_WIDTH] = { *whole };
    bool halve = depth >= RAD_BVH_DEPTH;
    int n = 1, i, rc;

    for (; n < RAD_BVH_WIDTH && (i = choose(b->items, r, n, halve)) >= 0; n++)
        split(b->items, &r[i], &r[n], halve);
    qsort(r, (size_t)n, sizeof r[0], by_area);
    rc = new_node(b, index);
    if (rc < 0)
        return rc;
    for (i = 0; i < n; i++)
        set_lane(&b->bvh->nodes[*index], i, &r[i]);
    for (i = 0; i < n; i++)
        if (wants_node(b->items, &r[i])) {
            uint32_t child;

            rc = build_node(b, &r[i], depth + 1, &child);
            if (rc < 0)
                return rc;
            b->bvh->nodes[*index].child[i] = child;
        }
    return 0;
}

/* Bounds of all, and the frame that they give. */
static void
set_frame(struct rad_bvh *bvh, const struct rad_bvh_items *list)
{
    double half = 0;
    int e;

    for (int a = 0; a < 3 && list->n; a++) {
        bvh->lo[a] = INFINITY;
        bvh->hi[a] = -INFINITY;
    }
    for (uint32_t i = 0; i < list->n; i++) {
        struct rad_box box;

        list->bounds(list->arg, i, &box);
        for (int a = 0; a < 3; a++) {
            bvh->lo[a] = box.lo[a] < bvh->lo[a] ? box.lo[a] : bvh->lo[a];
            bvh->hi[a] = box.hi[a] > bvh->hi[a] ? box.hi[a] : bvh->hi[a];
        }
    }
    for (int a = 0; a < 3; a++) {
        bvh->centre[a] = bvh->lo[a] / 2 + bvh->hi[a] / 2;
        half = fmax(half, bvh->hi[a] / 2 - bvh->lo[a] / 2);
    }
    frexp(half, &e);
    bvh->scale = half > 0 ? ldexp(1, -e) : 1;
}

static void
set_items(struct item *items, const struct rad_bvh *bvh,
          const struct rad_bvh_items *list)
{
    for (uint32_t i = 0; i < list->n; i++) {
        struct rad_box box;

        list->bounds(list->arg, i, &box);
        items[i].index = i;
        for (int a = 0; a < 3; a++) {
            double c = bvh->centre[a], s = bvh->scale;

            items[i].lo[a] = round_down((box.lo[a] - c) * s);
            items[i].hi[a] = round_up((box.hi[a] - c) * s);
        }
    }
}

int
rad_bvh_build(struct rad_bvh *bvh, const struct rad_bvh_items *list,
              uint32_t *order, struct rad_error *err)
{
    struct build b = { bvh, NULL, err };
    struct range all = { 0, list->n, { 0 }, { 0 } };
    uint32_t root, n = list->n;
    int rc;

    memset(bvh, 0, sizeof *bvh);
    if (n >= RAD_BVH_MAX_ITEMS)
        return rad_fail(err, RAD_EDATA, "too many surfaces");
    b.items = calloc(n ? n : 1, sizeof *b.items);
    if (!b.items)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    set_frame(bvh, list);
    set_items(b.items, bvh, list);
    fit(b.items, &all);
    rc = n ? build_node(&b, &all, 0, &root) : new_node(&b, &root);
    for (uint32_t i = 0; i < n; i++)
        order[i] = b.items[i].index;
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
