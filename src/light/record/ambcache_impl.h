/* ambcache_impl.h - the octree of ambient records, as ambcache.c makes it and
 * ambcache_find.c reads it
 *
 * Private to these two files; ambread*.c use the numbering of trees by bounces
 * and face, the sizes, and the bytes of normals.  ambcache.c says how the
 * octree is laid out and why.  */
#ifndef RAD_LIGHT_AMBCACHE_IMPL_H
#define RAD_LIGHT_AMBCACHE_IMPL_H

#include "light/record/ambcache.h"
#include "light/record/ambpool.h"

#include <math.h>
#include <stdalign.h>

#define LINE         RAD_AMBPOOL_LINE
#define WIDTH        16 /* bytes of a vector */
#define LANES        14 /* places of a block, which is four lines of memory */
#define STEPS_LOG    7  /* a byte of a place has so many bits for the cell */
#define STEPS        (1 << STEPS_LOG)
#define NORMAL_STEPS 127.
#define SPAN         3  /* least side of a cell over the reach of its zones */
#define ROOTS        8  /* octrees by number of bounces */
#define FACES        6  /* octrees by normal: face_of() */
#define BITS         48 /* of a cell's number; further bits are rounding */
#define MAX_DEPTH    (BITS - STEPS_LOG)

/* Places of a list, newer blocks first.  A place's bytes and item are [fixed]
 * once its bit in `ready` is set. */
struct block {
    alignas(LINE) uint8_t at[3][WIDTH]; /* the record's point: place_byte() */
    uint8_t reach[WIDTH];               /* of the record's zone, in
                                         * place_byte()'s steps */
    uint8_t n[3][WIDTH];                /* the record's normal: normal_byte() */
    uint8_t weight[WIDTH];              /* weight_steps(), rounded up */
    struct block *next;                 /* [fixed] once pushed */
    _Atomic uint32_t taken;             /* places given out; may pass LANES */
    _Atomic uint32_t ready;             /* a bit for each place */
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
    struct rad_ambpool entries, blocks, cells; /* cells: items of eight */
    _Atomic size_t count; /* relaxed: shown, never decided on */
    /* chunk of entries that rad_ambcache_read() came to last, or NULL */
    _Atomic(struct rad_ambchunk *) read_last;
};

static inline double
clamp(double x, double lo, double hi)
{
    return x < lo ? lo : x > hi ? hi : x;
}

/* A coordinate relative to a cell's corner, in sides of the cell, as a byte:
 * STEPS to the side, and half a side before and behind, for records outside the
 * cell that reach into it.  Coordinates beyond that range are moved to its
 * ends, which brings no two of them farther apart.  Two bytes differ by at most
 * one step more than the coordinates. */
static inline uint8_t
place_byte(double x)
{
    return (uint8_t)clamp((x + .5) * STEPS, 0, 255);
}

/* The largest difference of place_byte() between coordinates that are at most
 * `reach` sides apart. */
static inline uint8_t
reach_byte(double reach)
{
    return (uint8_t)clamp(ceil(reach * STEPS) + 1, 0, 255);
}

/* A weight in steps of a byte; rises with the weight up to 1.27. */
static inline double
weight_steps(double weight)
{
    return clamp(weight * 200, 0, 255);
}

/* A component of a unit vector, rounded to a step. */
static inline uint8_t
normal_byte(double x)
{
    return (uint8_t)(lrint(clamp(x, -1, 1) * NORMAL_STEPS) + 128);
}

/* The face of a normal, 0 to 5: twice the axis that n is nearest to, plus 1 if
 * n's component along that axis is negative. */
static inline int
face_of(const float n[3])
{
    int k = fabsf(n[1]) > fabsf(n[0]) ? 1 : 0;

    if (fabsf(n[2]) > fabsf(n[k]))
        k = 2;
    return 2 * k + (n[k] < 0);
}

/* The tree of records of `level` bounces. */
static inline int
root_of(int level)
{
    return level < ROOTS ? level : ROOTS - 1;
}

/* The number of the smallest possible cell at coordinate q, in sides of the
 * cube, along an axis: bit BITS - 1 - d says which child to take at depth d.
 * Points outside the cube are moved to its face, which brings no two of them
 * farther apart. */
static inline uint64_t
cell_number(double q)
{
    const uint64_t last = (UINT64_C(1) << BITS) - 1;

    if (!(q > 0))
        return 0;
    return q >= 1 ? last : (uint64_t)(q * 0x1p48);
}

/* The depth of the smallest cells whose side is at least SPAN times `reach`,
 * which is in sides of the cube. */
static inline int
depth_for(double reach)
{
    int e;

    frexp(SPAN * reach, &e);
    return e > 0 ? 0 : e < -MAX_DEPTH ? MAX_DEPTH : -e;
}

/* The faces (face_of()) that records whose normal fits n may have, as bits. */
unsigned rad_ambfit_faces(const struct rad_ambfit *fit, const double n[3]);

/* How many cells of that depth the cube's side has. */
static inline double
cells_across(int depth)
{
    return (double)(INT64_C(1) << depth);
}

#endif
