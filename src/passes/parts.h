/* parts.h - an order of a cloud of points by which its intervals are compact
 *
 * A k-d tree: boxes are halved by number of points, across their longest side,
 * so points in its order are near each other where they follow each other, and
 * an interval of that order is a part of space with few borders.  The tree of the
 * same points is the same on every machine.
 * Source: Bentley 1975, Multidimensional binary search trees.
 * Thread: any, once it is made. */
#ifndef RAD_PASSES_PARTS_H
#define RAD_PASSES_PARTS_H

#include <stddef.h>

struct rad_parts;

/* Of a tree, at most. */
#define RAD_PARTS_LEAVES 1024

/* The tree of n points, one at least, each of finite coordinates; they are
 * put into the tree's order.  NULL: out of memory. */
struct rad_parts *rad_parts_new(double (*p)[3], size_t n);
void rad_parts_free(struct rad_parts *parts);

/* Where p is in the order of the tree, from 0 up to below 1: about that
 * fraction of the points comes before it. */
double rad_parts_place(const struct rad_parts *parts, const double p[3]);

#endif
