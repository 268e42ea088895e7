/* ambcache_impl.h - the octree of ambient records, as ambcache.c makes it and
 * ambcache_find.c reads it
 *
 * Private to these two, but for what ambread.c shares of it: trees by bounces
 * and face, sizes, bytes of normals.  ambcache.c says how the octree is laid
 * out and why.  */
#ifndef RAD_LIGHT_AMBCACHE_IMPL_H
#define RAD_LIGHT_AMBCACHE_IMPL_H

#include "light/indirect/ambcache.h"
#include "light/indirect/ambpool.h"

#include <math.h>
#include <stdalign.h>

#define LINE         RAD_AMBPOOL_LINE
#define WIDTH        16 /* of a vector of bytes */
#define LANES        14 /* so many make a block four lines of memory */
#define STEPS_LOG    7  /* of the steps to the side of a cell */
#define STEPS        (1 << STEPS_LOG)
#define NORMAL_STEPS 127.
#define SPAN         3 /* a cell's side over the zones that it lists */
#define ROOTS        8
#define FACES        6
#define BITS         48 /* of a cell's number: beyond is rounding */
#define MAX_DEPTH    (BITS - STEPS_LOG)

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

struct rad_ambcache {
    double org[3], side;                       /* [fixed] */
    double scale;                              /* [fixed] 1 / side */
    struct cell root[ROOTS][FACES];            /* by bounces and face_of() */
    struct rad_ambpool entries, blocks, cells; /* cells: eight an item */
    _Atomic size_t count; /* relaxed: shown, never decided on */
    /* of entries: where the last reader was, or NULL */
    _Atomic(struct rad_ambchunk *) read_last;
};

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

/* The axis that n is nearest to, and its sign. */
static inline int
face_of(const float n[3])
{
    int k = fabsf(n[1]) > fabsf(n[0]) ? 1 : 0;

    if (fabsf(n[2]) > fabsf(n[k]))
        k = 2;
    return 2 * k + (n[k] < 0);
}

/* The tree of records of that many bounces. */
static inline int
root_of(int level)
{
    return level < ROOTS ? level : ROOTS - 1;
}

/* Number of the smallest cell there could be, along an axis: bit BITS - 1 - d
 * says which child to take at depth d.  What is a little outside the cube
 * counts as on its face, which brings no two points farther apart. */
static inline uint64_t
cell_number(double q)
{
    const uint64_t last = (UINT64_C(1) << BITS) - 1;

    if (!(q > 0))
        return 0;
    return q >= 1 ? last : (uint64_t)(q * 0x1p48);
}

/* Depth of the smallest cells that are SPAN times as wide. */
static inline int
depth_for(double reach)
{
    int e;

    frexp(SPAN * reach, &e);
    return e > 0 ? 0 : e < -MAX_DEPTH ? MAX_DEPTH : -e;
}

/* The faces that records which fit a normal may have, as bits. */
unsigned rad_ambfit_faces(const struct rad_ambfit *fit, const double n[3]);

/* Cells of that depth in a row. */
static inline double
cells_across(int depth)
{
    return (double)(INT64_C(1) << depth);
}

#endif
