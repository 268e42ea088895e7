/* ambread_impl.h - the trees of a frozen cache; private to ambread*.c
 *
 * Records of each number of bounces and each face (the axis nearest to the
 * normal) have a tree of their own, as in ambcache.c: an octree of the cube,
 * each leaf of which lists every record whose zone touches it.  A look-up goes
 * down to one leaf and reads one list, small zones first, to its end or until
 * it has found enough.
 *
 * A list is made of blocks of PLACES places.  Of ten records in a list about
 * one serves.  So a place has, as bytes, the box of the record's zone, in
 * 256ths of the leaf, and two components of its normal.  All places of a block
 * are tested at once, and only records that pass are fetched.  The box is that
 * of half the ellipsoid about the record's axes, so on a wall it is thin.  The
 * point of a look-up and the sides of boxes become bytes by the steps of one
 * grid, so rounding leaves no record out.  */
#ifndef RAD_LIGHT_AMBREAD_IMPL_H
#define RAD_LIGHT_AMBREAD_IMPL_H

#include "light/record/ambread.h"
#include "light/record/ambcache_impl.h"

#define PLACES  16 /* of a block: a vector of bytes */
#define GRID    32 /* bits of a coordinate in the cube */
#define NO_SIZE 255
#define TREES   (ROOTS * FACES)

/* A block of a list. */
struct places {
    uint8_t lo[3][PLACES], hi[3][PLACES]; /* the zone, in 256ths of the leaf */
    uint8_t lean[2][PLACES]; /* the normal's components along the two axes that
                              * are not the face's: normal_byte() */
    uint8_t size[PLACES];    /* MAX_DEPTH - depth_for(reach), rising; NO_SIZE:
                              * the place is empty */
    uint32_t item[PLACES];
};

/* A cell of a tree: a leaf, unless it is divided.  All zero: an empty leaf. */
struct rad_ambread_cell {
    union {
        struct places *list;           /* of the leaf; NULL: empty */
        struct rad_ambread_cell *part; /* eight, by part_number() */
    };
    uint32_t n; /* records whose zones touch the cell */
    bool divided;
};

/* The trees that a settling made, and which no other changes. */
struct rad_ambread_trees {
    struct rad_ambread_trees *next; /* made by the next settling, or being made;
                                     * NULL: none */
    uint32_t number;                /* of the settling */
    struct rad_ambitem *item;
    struct rad_ambread_cell tree[TREES]; /* by bounces and face */
};

/* The trees that visits read, for the thread that changes them. */
static inline struct rad_ambread_trees *
rad_ambread_trees_of(const struct rad_ambread *r)
{
    return atomic_load_explicit(&r->trees, memory_order_relaxed);
}

/* The blocks of a list of n places. */
static inline size_t
blocks_for(size_t n)
{
    return (n + PLACES - 1) / PLACES;
}

/* A coordinate, in sides of the cube, as an integer of GRID bits. */
static inline uint32_t
grid_number(double q)
{
    return (uint32_t)(cell_number(q) >> (BITS - GRID));
}

/* The part of a cell that holds a place: by the numbers of the place along the
 * axes and the bit of these that tells. */
static inline unsigned
part_number(const uint32_t number[3], int bit)
{
    return (number[0] >> bit & 1) | (number[1] >> bit & 1) << 1 |
           (number[2] >> bit & 1) << 2;
}

/* What a cell has on the heap. */
struct rad_ambread_size {
    size_t blocks, bytes;
};
void rad_ambread_measure(const struct rad_ambread_cell *c,
                         struct rad_ambread_size *sum);
/* Free the trees, but for what those behind them share; returns these. */
struct rad_ambread_trees *rad_ambread_free_trees(struct rad_ambread_trees *t);

/* ambread_settle.c: free what is left of a settling that is under way. */
void rad_ambread_drop_settling(struct rad_ambread *r);

#endif
