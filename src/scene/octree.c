/* octree.c - see octree.h
 *
 * The tree is built from the top.  A cube has a list of the surfaces that meet
 * it.  If the list is too long, a byte for each surface says which of the eight
 * parts it meets, and each part gets a list in turn.  Parts are done one by
 * one, so lists lie on one stack.  A surface whose bounds lie within one part
 * needs no further test, which saves nearly all tests but in the lowest levels.
 *
 * Surfaces that coincide would be cut for ever, since every part that one of
 * them meets is met by all.  For surfaces that are only near each other one cut
 * may give that result, but two in a row seldom do (see SAME_MAX). */
#include "config.h"

#include "scene/octree.h"

#include "scene/overlap.h"
#include "scene/part.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* After so many cuts in a row that gave the whole list to several parts a cube
 * is not cut. */
#define SAME_MAX 2
/* The most entries of all sets, per surface, and a base for small scenes.  A
 * million separate triangles of a mesh need about 5 each. */
#define BUDGET_PER_OBJECT 32
#define BUDGET_BASE       (1 << 20)
/* oconv's margin around the scene */
#define MARGIN 1e-5

struct builder {
    const struct rad_scene *scene;
    struct rad_octree *t;
    struct rad_error *err;
    struct rad_extent *extents; /* of the surfaces that are entered */
    int32_t *index;             /* their objects, in the same order */
    int32_t *stack;             /* lists of their numbers in this order */
    size_t used, size;
    uint8_t *parts[RAD_OCTREE_DEPTH + 1]; /* by level: parts met, as bits */
    size_t nparts[RAD_OCTREE_DEPTH + 1];  /* allocated */
    int leaf;                             /* a cube with more is cut */
    int64_t budget;                       /* entries that may still be made */
    int rc;
};

struct cube {
    double centre[3], half;
    int level;
    int same; /* cuts in a row above it that gave several parts the whole list
               */
};

void
rad_octree_init(struct rad_octree *t)
{
    memset(t, 0, sizeof *t);
    t->root = RAD_OCTREE_EMPTY;
}

void
rad_octree_release(struct rad_octree *t)
{
    free(t->kids);
    free(t->sets);
    rad_octree_init(t);
}

static int
out_of_memory(struct builder *b)
{
    if (!b->rc)
        b->rc = rad_fail(b->err, RAD_ENOMEM, "out of memory for the octree");
    return b->rc;
}

/* --- nodes ---------------------------------------------------------------- */

bool
rad_octree_reserve(struct rad_octree *t, int32_t sets, int32_t kids)
{
    if (sets > t->max_sets - t->nsets) {
        size_t max = 2 * (size_t)t->max_sets + (size_t)sets + 1024;
        int32_t *more =
            max <= INT32_MAX ? realloc(t->sets, max * sizeof *more) : NULL;

        if (!more)
            return false;
        t->sets = more;
        t->max_sets = (int32_t)max;
    }
    if (kids > t->max_kids - t->nkids) {
        size_t max = 2 * (size_t)t->max_kids + (size_t)kids + 64;
        int32_t(*more)[8] =
            max <= INT32_MAX ? realloc(t->kids, max * sizeof *more) : NULL;

        if (!more)
            return false;
        t->kids = more;
        t->max_kids = (int32_t)max;
    }
    return true;
}

static int32_t
new_kids(struct builder *b)
{
    if (!rad_octree_reserve(b->t, 0, 1)) {
        out_of_memory(b);
        return RAD_OCTREE_EMPTY;
    }
    return b->t->nkids++;
}

static int32_t
new_set(struct builder *b, const int32_t *list, int32_t n)
{
    struct rad_octree *t = b->t;
    int32_t at = t->nsets, *set;

    b->budget -= n;
    if (n > RAD_OCTREE_MAX_SET) {
        t->left_out += n - RAD_OCTREE_MAX_SET;
        n = RAD_OCTREE_MAX_SET;
    }
    if (!rad_octree_reserve(t, n + 1, 0)) {
        out_of_memory(b);
        return RAD_OCTREE_EMPTY;
    }
    set = t->sets + at;
    *set++ = n;
    for (int32_t i = 0; i < n; i++)
        *set++ = b->index[list[i]]; /* a list has the order of the objects */
    t->nsets = at + n + 1;
    return -2 - at;
}

/* --- cuts --- */

static void
part_of(struct cube *part, const struct cube *c, int k)
{
    part->half = c->half / 2;
    part->level = c->level + 1;
    for (int i = 0; i < 3; i++)
        part->centre[i] =
            c->centre[i] + (k >> i & 1 ? part->half : -part->half);
}

/* The parts of the cube that a surface in its list meets, as bits. */
static uint8_t
parts_met(const struct builder *b, const struct cube *c, int32_t place)
{
    return rad_overlaps_parts(&b->scene->objects[b->index[place]],
                              &b->extents[place], c->centre, c->half);
}

/* Make room on the stack for n more, and for n bytes of parts at the level. */
static int
reserve(struct builder *b, int level, size_t n)
{
    if (n > b->size - b->used) {
        size_t size = 2 * b->size + n;
        int32_t *more = realloc(b->stack, size * sizeof *more);

        if (!more)
            return out_of_memory(b);
        b->stack = more;
        b->size = size;
    }
    if (n > b->nparts[level]) {
        uint8_t *more = realloc(b->parts[level], n);

        if (!more)
            return out_of_memory(b);
        b->parts[level] = more;
        b->nparts[level] = n;
    }
    return 0;
}

/* Do all surfaces meet the same parts? */
static bool
all_same(const uint8_t *parts, int32_t n)
{
    for (int32_t i = 1; i < n; i++)
        if (parts[i] != parts[0])
            return false;
    return true;
}

/* How many cuts in a row that separated nothing does this one end?  Surfaces
 * that all lie in one part may be separated there, and cost no entries. */
static int
same_cuts(const struct cube *c, const uint8_t *parts, int32_t n)
{
    if (!all_same(parts, n))
        return 0;
    return c->same + ((parts[0] & (parts[0] - 1)) != 0);
}

static int32_t build(struct builder *b, const struct cube *c, size_t list,
                     int32_t n);

/* Cut a cube whose list of n surfaces begins at stack[list]. */
static int32_t
cut(struct builder *b, const struct cube *c, size_t list, int32_t n)
{
    struct cube part;
    int32_t node;
    uint8_t *parts;

    if (reserve(b, c->level, (size_t)n + 1))
        return RAD_OCTREE_EMPTY;
    parts = b->parts[c->level];
    for (int32_t i = 0; i < n; i++)
        parts[i] = parts_met(b, c, b->stack[list + (size_t)i]);
    part.same = same_cuts(c, parts, n);
    if (part.same >= SAME_MAX)
        return new_set(b, b->stack + list, n);
    node = new_kids(b);
    for (int k = 0; k < 8 && !b->rc; k++) {
        size_t start = b->used;
        int32_t kid;

        if (reserve(b, c->level, (size_t)n + 1))
            break;
        for (int32_t i = 0; i < n; i++) { /* no branch: it is unpredictable */
            b->stack[b->used] = b->stack[list + (size_t)i];
            b->used += parts[i] >> k & 1;
        }
        part_of(&part, c, k);
        kid = build(b, &part, start, (int32_t)(b->used - start));
        b->used = start;
        if (!b->rc)
            b->t->kids[node][k] = kid;
    }
    return node;
}

static int32_t
build(struct builder *b, const struct cube *c, size_t list, int32_t n)
{
    if (n == 0)
        return RAD_OCTREE_EMPTY;
    if (n <= b->leaf || c->level == RAD_OCTREE_DEPTH || b->budget < 0)
        return new_set(b, b->stack + list, n);
    return cut(b, c, list, n);
}

/* --- the whole --- */

static int32_t
collect_surfaces(struct builder *b)
{
    const struct rad_scene *s = b->scene;
    size_t max = 0;
    int32_t n = 0;

    for (int32_t i = 0; i < rad_scene_own(s); i++)
        max += rad_otype_is_surface(s->objects[i].type);
    b->extents = malloc((max + 1) * sizeof *b->extents);
    b->index = malloc((max + 1) * sizeof *b->index);
    if (!b->extents || !b->index) {
        out_of_memory(b);
        return 0;
    }
    for (int32_t i = 0; i < rad_scene_own(s); i++)
        if (rad_otype_is_surface(s->objects[i].type) &&
            rad_extent_of(&s->objects[i], &b->extents[n]))
            b->index[n++] = i;
    return n;
}

/* A number as it will be in the file: with twelve digits. */
static double
as_written(double x)
{
    char text[64];

    snprintf(text, sizeof text, "%.12g", x);
    return strtod(text, NULL);
}

/* Set a cube around all surfaces, larger by oconv's margin.  The margin is
 * smaller for a small scene, relative to it, and large enough for the twelve
 * digits of the cube if the scene is far from the origin. */
static int
enclose(struct builder *b, int32_t n)
{
    double lo[3], hi[3], size = 0, far = 0, margin;

    for (int i = 0; i < 3; i++) {
        lo[i] = INFINITY;
        hi[i] = -INFINITY;
        for (int32_t k = 0; k < n; k++) {
            lo[i] = fmin(lo[i], b->extents[k].lo[i]);
            hi[i] = fmax(hi[i], b->extents[k].hi[i]);
        }
        size = fmax(size, hi[i] - lo[i]);
        far = fmax(far, fmax(fabs(lo[i]), fabs(hi[i])));
    }
    margin = fmax(MARGIN * fmin(1, size), 1e-11 * far);
    size += 2 * margin;
    if (!(size > 0 && size + far < 1e300))
        return rad_fail(b->err, RAD_EDATA,
                        "coordinates of %g are too large for an octree", far);
    for (int i = 0; i < 3; i++)
        b->t->org[i] = as_written((lo[i] + hi[i] - size) / 2);
    b->t->size = as_written(size);
    return 0;
}

static int32_t
build_all(struct builder *b, int32_t n)
{
    struct cube root = { .half = b->t->size / 2 };

    for (int i = 0; i < 3; i++)
        root.centre[i] = b->t->org[i] + root.half;
    b->t->nkids = b->t->nsets = b->t->left_out = 0;
    b->budget = (int64_t)n * BUDGET_PER_OBJECT + BUDGET_BASE;
    b->used = 0;
    if (reserve(b, 0, (size_t)n))
        return RAD_OCTREE_EMPTY;
    for (int32_t i = 0; i < n; i++)
        b->stack[b->used++] = i;
    return build(b, &root, 0, n);
}

static void
free_builder(struct builder *b)
{
    free(b->extents);
    free(b->index);
    free(b->stack);
    for (int i = 0; i <= RAD_OCTREE_DEPTH; i++)
        free(b->parts[i]);
}

int
rad_octree_build(struct rad_octree *t, const struct rad_scene *scene, int leaf,
                 struct rad_error *err)
{
    struct builder b = { .scene = scene, .t = t, .err = err };
    int32_t n;

    rad_octree_init(t);
    n = collect_surfaces(&b);
    if (!b.rc && n)
        b.rc = enclose(&b, n);
    for (b.leaf = leaf; !b.rc && n; b.leaf *= 2) {
        t->root = build_all(&b, n);
        if (b.budget >= 0 || b.leaf > RAD_OCTREE_MAX_SET / 2)
            break;
    }
    free_builder(&b);
    if (b.rc)
        rad_octree_release(t);
    return b.rc;
}
