/* walk.h - the walks through a tree, for one instruction set
 *
 * A kernel file defines, then includes this once:
 *   WALK_TARGET   attribute that lets the compiler use the instruction set
 *   WALK(name)    the name of a function in this kernel
 *   WALK(boxes)   which lanes of a node the ray meets before limit, as bits,
 *                 and where it enters them
 * Everything that decides lies here, and a box test is the same IEEE
 * operations in any width, so all kernels give the same bits.
 * Each walk is there twice: over surfaces and, mesh_, over a mesh's triangles.
 * A place is walked by way of rad_place_meet(), which comes back here. */

/* How far behind the nearest hit another may tie with it; geom.c applies the
 * bound proper. */
static inline WALK_TARGET double
WALK(window)(const struct rad_walk *w, double t)
{
    return RAD_WALK_WINDOW * (w->probe.size + t);
}

/* Does the ray meet item i?  A place does what is to be done itself. */
static inline WALK_TARGET __attribute__((always_inline)) bool
WALK(meets)(struct rad_walk *w, uint32_t i, enum rad_meet how, double *t)
{
    const struct rad_prim *p = &w->prims[i];

    switch (p->kind) {
    case PRIM_POLYGON:
        return rad_polygon_hit(p, &w->probe, w->tmin, w->cut, t);
    case PRIM_SPHERE:
        return rad_sphere_hit(p, &w->probe, w->tmin, w->cut, t);
    case PRIM_CONE:
        return rad_cone_hit(p, &w->probe, w->tmin, w->cut, t);
    case PRIM_RING:
        return rad_ring_hit(p, &w->probe, w->tmin, w->cut, t);
    default:
        return rad_place_meet(w, i, how);
    }
}

static inline WALK_TARGET __attribute__((always_inline)) bool
WALK(mesh_meets)(struct rad_walk *w, uint32_t i, double *t)
{
    return rad_tri_hit(w->meshed, i, &w->probe, w->tmin, w->cut, t);
}

/* Item i, met at t, is the nearest. */
static inline WALK_TARGET void
WALK(lead)(struct rad_walk *w, uint32_t i, double t)
{
    double behind = t + WALK(window)(w, t);

    w->tie = w->best <= behind;
    w->best = t;
    w->prim = i;
    w->cut = behind < w->tmax ? behind : w->tmax;
}

/* along: what is passed does not end the walk. */
static inline WALK_TARGET __attribute__((always_inline)) void
WALK(leaf_hits)(struct rad_walk *w, uint32_t first, uint32_t count, bool along)
{
    for (uint32_t i = first; i < first + count; i++) {
        double t;

        if (!WALK(meets)(w, i, RAD_MEET_NEAREST, &t))
            continue;
        if (along && rad_line_passes(&w->prims[i], &w->probe))
            w->cut = rad_least(rad_line_note(w, i, t), w->cut);
        else if (t > w->best ||
                 (t == w->best && w->prims[i].obj > w->prims[w->prim].obj))
            w->tie = true;
        else
            WALK(lead)(w, i, t);
    }
}

static inline WALK_TARGET void
WALK(leaf_nearest)(struct rad_walk *w, uint32_t first, uint32_t count)
{
    WALK(leaf_hits)(w, first, count, false);
}

static inline WALK_TARGET void
WALK(leaf_along)(struct rad_walk *w, uint32_t first, uint32_t count)
{
    WALK(leaf_hits)(w, first, count, true);
}

static inline WALK_TARGET void
WALK(mesh_leaf_nearest)(struct rad_walk *w, uint32_t first, uint32_t count)
{
    for (uint32_t i = first; i < first + count; i++) {
        double t;

        if (!WALK(mesh_meets)(w, i, &t))
            continue;
        if (t > w->best || (t == w->best && i > w->prim))
            w->tie = true;
        else
            WALK(lead)(w, i, t);
    }
}

/* A node or leaf yet to be visited and where the ray enters it: the float's
 * bits, which order as its value does since it is not negative, above the
 * child's. */
static inline WALK_TARGET uint64_t
WALK(entry)(float enter, uint32_t child)
{
    uint32_t bits;

    memcpy(&bits, &enter, sizeof bits);
    return (uint64_t)bits << 32 | child;
}

/* Push the lanes of mask so that the nearest ends on top.  Each new one sinks
 * through what was pushed before by minima and maxima: which of two is nearer
 * is a coin toss that no branch should hang on. */
static inline WALK_TARGET int
WALK(push_sorted)(uint64_t *stack, int n, const struct rad_bvh_node *node,
                  unsigned mask, const float *enter)
{
    for (int base = n; mask; mask &= mask - 1) {
        int lane = __builtin_ctz(mask);
        uint64_t e = WALK(entry)(enter[lane], node->child[lane]);

        for (int i = base; i < n; i++) {
            uint64_t old = stack[i];

            stack[i] = old > e ? old : e;
            e = old > e ? e : old;
        }
        stack[n++] = e;
    }
    return n;
}

/* From a node down to the nearest leaf under it that the ray may meet; what it
 * passes by is pushed.  False: there is none. */
static inline WALK_TARGET bool
WALK(descend)(struct rad_walk *w, const struct rad_bvh_ray *ray,
              uint64_t *stack, int *n, uint32_t *child, float limit)
{
    float enter[RAD_BVH_WIDTH];

    while (!(*child & RAD_BVH_LEAF)) {
        const struct rad_bvh_node *node = &w->bvh->nodes[*child];
        unsigned mask = WALK(boxes)(node, ray, limit, enter);

        w->nodes++;
        if (!mask)
            return false;
        if (!(mask & (mask - 1))) {
            *child = node->child[__builtin_ctz(mask)];
            continue;
        }
        *n = WALK(push_sorted)(stack, *n, node, mask, enter);
        *child = (uint32_t)stack[--*n];
    }
    return true;
}

static inline WALK_TARGET __attribute__((always_inline)) void
WALK(seek)(struct rad_walk *w,
           void (*leaf)(struct rad_walk *, uint32_t, uint32_t))
{
    uint64_t stack[RAD_BVH_STACK];
    struct rad_bvh_ray ray;
    float limit = rad_bvh_limit(w->bvh, w->cut);
    uint64_t past = WALK(entry)(limit, UINT32_MAX), top;
    uint32_t child = 0;
    int n = 0;

    rad_bvh_ray_init(&ray, w->bvh, &w->probe, w->tmin);
    for (;;) {
        if (WALK(descend)(w, &ray, stack, &n, &child, limit)) {
            uint32_t count = rad_bvh_leaf_count(child);

            leaf(w, rad_bvh_leaf_first(child), count);
            limit = rad_bvh_limit(w->bvh, w->cut);
            past = WALK(entry)(limit, UINT32_MAX);
            w->tests += count;
        }
        do {
            if (n == 0)
                return;
            top = stack[--n];
        } while (top > past);
        child = (uint32_t)top;
    }
}

static WALK_TARGET void
WALK(nearest)(struct rad_walk *w)
{
    WALK(seek)(w, WALK(leaf_nearest));
}

static WALK_TARGET void
WALK(along)(struct rad_walk *w)
{
    WALK(seek)(w, WALK(leaf_along));
}

static WALK_TARGET void
WALK(mesh_nearest)(struct rad_walk *w)
{
    WALK(seek)(w, WALK(mesh_leaf_nearest));
}

/* Does what has these bits stop a shadow ray? */
static inline WALK_TARGET bool
WALK(stops)(const struct rad_walk *w, uint8_t surf)
{
    return ((surf & w->keep) | w->give) & RAD_SURF_OPAQUE;
}

static inline WALK_TARGET bool
WALK(leaf_any)(struct rad_walk *w, uint32_t first, uint32_t count)
{
    double t;

    for (uint32_t i = first; i < first + count; i++) {
        const struct rad_prim *p = &w->prims[i];

        if (p->obj == w->skip ||
            (w->veiled && !w->line && !WALK(stops)(w, p->surf)))
            continue;
        w->tests++;
        if (!WALK(meets)(w, i, RAD_MEET_ANY, &t))
            continue;
        if (WALK(stops)(w, p->surf)) {
            w->prim = i;
            return true;
        }
        w->veiled = true;
        if (w->line)
            rad_line_note(w, i, t);
    }
    return false;
}

static inline WALK_TARGET bool
WALK(mesh_leaf_any)(struct rad_walk *w, uint32_t first, uint32_t count)
{
    double t;

    w->tests += count;
    for (uint32_t i = first; i < first + count; i++) {
        const struct rad_meshed *m = w->meshed;

        if (!WALK(mesh_meets)(w, i, &t))
            continue;
        if (WALK(stops)(w, m->surf[m->mesh->tris[m->tris[i].number].face]))
            return true;
        w->veiled = true;
    }
    return false;
}

static inline WALK_TARGET void
WALK(offer)(struct rad_walk *w, uint32_t i, double t)
{
    struct rad_met met;

    rad_walk_met(w, i, t, &met);
    w->offer(w, &met);
}

static inline WALK_TARGET bool
WALK(leaf_all)(struct rad_walk *w, uint32_t first, uint32_t count)
{
    double t;

    w->tests += count;
    for (uint32_t i = first; i < first + count; i++)
        if (WALK(meets)(w, i, RAD_MEET_ALL, &t))
            WALK(offer)(w, i, t);
    return false;
}

static inline WALK_TARGET bool
WALK(mesh_leaf_all)(struct rad_walk *w, uint32_t first, uint32_t count)
{
    double t;

    w->tests += count;
    for (uint32_t i = first; i < first + count; i++)
        if (WALK(mesh_meets)(w, i, &t))
            WALK(offer)(w, i, t);
    return false;
}

/* In the order of the lanes (biggest first), until leaf says true. */
static inline WALK_TARGET __attribute__((always_inline)) bool
WALK(visit)(struct rad_walk *w,
            bool (*leaf)(struct rad_walk *, uint32_t, uint32_t))
{
    uint32_t stack[RAD_BVH_STACK];
    struct rad_bvh_ray ray;
    float limit = rad_bvh_limit(w->bvh, w->cut), enter[RAD_BVH_WIDTH];
    int n = 1;

    rad_bvh_ray_init(&ray, w->bvh, &w->probe, w->tmin);
    stack[0] = 0;
    while (n > 0) {
        uint32_t child = stack[--n];

        if (child & RAD_BVH_LEAF) {
            if (leaf(w, rad_bvh_leaf_first(child), rad_bvh_leaf_count(child)))
                return true;
        } else {
            const struct rad_bvh_node *node = &w->bvh->nodes[child];
            unsigned mask = WALK(boxes)(node, &ray, limit, enter);

            w->nodes++;
            while (mask) { /* the first lane ends on top */
                int lane = 31 - __builtin_clz(mask);

                stack[n++] = node->child[lane];
                mask ^= 1u << lane;
            }
        }
    }
    return false;
}

static WALK_TARGET bool
WALK(any)(struct rad_walk *w)
{
    return WALK(visit)(w, WALK(leaf_any));
}

static WALK_TARGET void
WALK(all)(struct rad_walk *w)
{
    WALK(visit)(w, WALK(leaf_all));
}

static WALK_TARGET bool
WALK(mesh_any)(struct rad_walk *w)
{
    return WALK(visit)(w, WALK(mesh_leaf_any));
}

static WALK_TARGET void
WALK(mesh_all)(struct rad_walk *w)
{
    WALK(visit)(w, WALK(mesh_leaf_all));
}

static WALK_TARGET bool
WALK(one)(const struct rad_walk *w, const struct rad_prim *p, double *t)
{
    return rad_prim_hit(p, &w->probe, w->tmin, w->cut, t);
}

/* What a kernel's table holds. */
#define WALK_ALL                                                               \
    WALK(one), WALK(nearest), WALK(along), WALK(any), WALK(all),               \
        WALK(mesh_nearest), WALK(mesh_any), WALK(mesh_all)
