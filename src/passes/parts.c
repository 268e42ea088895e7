/* parts.c - see parts.h
 *
 * The tree is complete.  Its inner nodes lie in one array, the children of node
 * i at 2 i + 1 and 2 i + 2.  Leaves are not stored: a leaf's place in the order
 * follows from its number. */
#include "config.h"

#include "passes/parts.h"

#include <stdlib.h>

/* A leaf has at least so many points: with fewer, its borders are chance. */
#define LEAF 4

struct node {
    int axis;
    double at; /* points below go to the first half, all others to the second */
};

struct rad_parts {
    int depth; /* of the leaves */
    struct node node[];
};

static void
swap(double a[3], double b[3])
{
    for (int k = 0; k < 3; k++) {
        double t = a[k];

        a[k] = b[k];
        b[k] = t;
    }
}

/* Partition p[lo..hi] along the axis by the coordinate of the middle point
 * (Hoare 1961): points up to the returned index, which is below hi, have at
 * most that coordinate, those behind at least that. */
static size_t
part_at_middle(double (*p)[3], size_t lo, size_t hi, int axis)
{
    double pivot = p[lo + (hi - lo) / 2][axis];
    size_t i = lo, j = hi;

    for (;;) {
        while (p[i][axis] < pivot)
            i++;
        while (p[j][axis] > pivot)
            j--;
        if (i >= j)
            return j;
        swap(p[i++], p[j--]);
    }
}

/* Reorder n points along the axis: none before index `at` has a larger
 * coordinate than the point at that index, none behind it a smaller one. */
static void
select_nth(double (*p)[3], size_t n, size_t at, int axis)
{
    size_t lo = 0, hi = n - 1;

    while (lo < hi) {
        size_t j = part_at_middle(p, lo, hi, axis);

        if (at <= j)
            hi = j;
        else
            lo = j + 1;
    }
}

static int
longest_side(double (*p)[3], size_t n)
{
    double most = -1;
    int axis = 0;

    for (int k = 0; k < 3; k++) {
        double lo = p[0][k], hi = p[0][k];

        for (size_t i = 1; i < n; i++) {
            lo = p[i][k] < lo ? p[i][k] : lo;
            hi = p[i][k] > hi ? p[i][k] : hi;
        }
        if (hi - lo > most) {
            most = hi - lo;
            axis = k;
        }
    }
    return axis;
}

/* Make node i, at that depth, and those below it from n points, at least one.
 */
static void
cut(struct rad_parts *parts, size_t i, int depth, double (*p)[3], size_t n)
{
    struct node *node = &parts->node[i];
    size_t half = n / 2;

    if (depth == parts->depth)
        return;
    node->axis = longest_side(p, n);
    select_nth(p, n, half, node->axis);
    node->at = p[half][node->axis];
    cut(parts, 2 * i + 1, depth + 1, p, half);
    cut(parts, 2 * i + 2, depth + 1, p + half, n - half);
}

struct rad_parts *
rad_parts_new(double (*p)[3], size_t n)
{
    struct rad_parts *parts;
    int depth = 0;

    while (1 << depth < RAD_PARTS_LEAVES && n >> (depth + 1) >= LEAF)
        depth++;
    parts = malloc(sizeof *parts +
                   (((size_t)1 << depth) - 1) * sizeof parts->node[0]);
    if (!parts)
        return NULL;
    parts->depth = depth;
    cut(parts, 0, 0, p, n);
    return parts;
}

void
rad_parts_free(struct rad_parts *parts)
{
    free(parts);
}

double
rad_parts_place(const struct rad_parts *parts, const double p[3])
{
    size_t leaves = (size_t)1 << parts->depth, i = 0;

    while (i < leaves - 1) {
        const struct node *node = &parts->node[i];

        i = 2 * i + 1 + !(p[node->axis] < node->at);
    }
    return ((double)(i - (leaves - 1)) + .5) / (double)leaves;
}
