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

/* A block of a list. */
struct places {
    uint8_t lo[3][PLACES], hi[3][PLACES]; /* the zone, in 256ths of the leaf */
    uint8_t lean[2][PLACES]; /* the normal's components along the two axes that
                              * are not the face's: normal_byte() */
    uint8_t size[PLACES];    /* MAX_DEPTH - depth_for(reach), rising; NO_SIZE:
                              * the place is empty */
    uint32_t item[PLACES];
};

/* A cell is a number.  A leaf: LEAF | number of its blocks << 32 | index of the
 * first block.  A cell that is divided: index of its first part. */
#define LEAF (UINT64_C(1) << 63)

struct rad_ambread_tree {
    uint64_t root;
    uint64_t *part; /* cells: eight for each cell that is divided */
    struct places *block;
    size_t nparts, nblocks;
};

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

/* Free what a tree holds. */
void rad_ambread_release_tree(struct rad_ambread_tree *t);

#endif
