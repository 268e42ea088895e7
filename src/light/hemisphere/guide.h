/* guide.h - a density of directions that knows small bright places
 *
 * A place that fills little of a cell of a hemisphere is missed by most of the
 * cell's rays, and counts for far too much with one that meets it.  The guide
 * is a density over the hemisphere's square (hemisphere.h), constant in the
 * parts that its cells are cut into: a mixture of lobes, one for each place
 * (bright.h), by what it is expected to bring, even over the parts that it may
 * touch.  Some rays are drawn from it, and a ray counts by what all together
 * send its way (the balance heuristic of Veach & Guibas 1995), so that the mean
 * is right whatever the guide says.
 * Thread: as its scratch arena. */
#ifndef RAD_LIGHT_GUIDE_H
#define RAD_LIGHT_GUIDE_H

#include "light/hemisphere/bright.h"

/* So many places are looked at: those that most records chose. */
#define RAD_GUIDE_PLACES 256

static inline size_t
rad_guide_places(const struct rad_bright *b)
{
    return b->n < RAD_GUIDE_PLACES ? b->n : RAD_GUIDE_PLACES;
}

struct rad_guide_lobe;

struct rad_guide {
    int side;     /* parts along a side of the square, a multiple of h->n */
    float *light; /* of parts, row by row */
    double scale; /* light times this is density, whose mean is 1 */
    struct rad_guide_lobe *lobe;
    int lobes;
};

/* Set the guide of a hemisphere at p, by places (share is of rad_bright_look(),
 * for the first of them) and frame alone, if they are expected to be much of
 * the noise there; records see a luminance of `usual`.
 * False: there is none.  It lives as long as what scratch held before. */
bool rad_guide_set(struct rad_guide *g, const struct rad_bright *b,
                   const struct rad_hemi *h, const double p[3],
                   const double *share, double usual,
                   struct rad_arena *scratch);

/* Density at a point of the square. */
static inline double
rad_guide_density(const struct rad_guide *g, double x, double y)
{
    int last = g->side - 1, i = (int)(y * g->side), j = (int)(x * g->side);

    i = i < last ? i : last;
    j = j < last ? j : last;
    return (double)g->light[i * g->side + j] * g->scale;
}

/* Draw a part, in column *x and row *y, by three numbers of [0, 1).  `lobe` is
 * that of the last draw, whose u[0] was no larger, and 0 at first. */
void rad_guide_draw(const struct rad_guide *g, const double u[3], int *lobe,
                    int *x, int *y);

#endif
