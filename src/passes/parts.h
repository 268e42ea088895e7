/* parts.h - an order of points in space whose intervals are compact
 *
 * The order of the leaves of a k-d tree.  Boxes are halved by number of points,
 * across their longest side: so points that follow each other are near each
 * other, and an interval of the order is a compact part of space.  The same
 * points make the same tree on every machine.
 * Source: Bentley 1975, Multidimensional binary search trees.
 * Thread: any, once it is made. */
#ifndef RAD_PASSES_PARTS_H
#define RAD_PASSES_PARTS_H

#include <stddef.h>

struct rad_parts;

/* Leaves of a tree, at most. */
#define RAD_PARTS_LEAVES 1024

/* Make the tree of n points, at least one, with finite coordinates; p[] is
 * reordered.  NULL: out of memory. */
struct rad_parts *rad_parts_new(double (*p)[3], size_t n);
void rad_parts_free(struct rad_parts *parts);

/* The place of p in the tree's order, in [0, 1): about this fraction of the
 * points comes before p. */
double rad_parts_place(const struct rad_parts *parts, const double p[3]);

#endif
