/* guide.h - a density of directions that favours small bright places
 *
 * A bright place that fills little of a hemisphere's cell is missed by most of
 * the cell's rays; a ray that meets it makes the cell far too bright.  The
 * guide is a density over the hemisphere's square (hemisphere.h), constant in
 * each of the parts that cells are cut into.  The density is a mixture of
 * lobes, a lobe for each place (bright.h): a lobe is uniform over the parts
 * that the place may touch, and weighted by the light that it is expected to
 * bring.
 * Some rays are drawn from the guide.  A ray counts by the inverse of the
 * density of all rays, the cells' and the guide's, in its direction (the
 * balance heuristic of Veach & Guibas 1995), so the mean is right whatever the
 * guide says.
 * Thread: that of its scratch arena. */
#ifndef RAD_LIGHT_GUIDE_H
#define RAD_LIGHT_GUIDE_H

#include "light/hemisphere/bright.h"

/* Only so many places have lobes: those with most glints. */
#define RAD_GUIDE_PLACES 256

static inline size_t
rad_guide_places(const struct rad_bright *b)
{
    return b->n < RAD_GUIDE_PLACES ? b->n : RAD_GUIDE_PLACES;
}

struct rad_guide_lobe;

struct rad_guide {
    int side;     /* parts along a side of the square, a multiple of h->n */
    float *light; /* light that each part is expected to bring, row by row */
    double scale; /* light times scale is the density, whose mean is 1 */
    struct rad_guide_lobe *lobe;
    int lobes;
};

/* Set the guide of a hemisphere at p, if places are expected to make much of
 * its noise.  Of h only n and the frame are read.
 *   share   of the first rad_guide_places(), as rad_bright_look() sets it
 *   usual   geometric mean of the luminances that records see
 * False: the hemisphere has no guide, or memory is out.  The guide lives in
 * scratch until the caller rewinds it. */
bool rad_guide_set(struct rad_guide *g, const struct rad_bright *b,
                   const struct rad_hemi *h, const double p[3],
                   const double *share, double usual,
                   struct rad_arena *scratch);

/* The density at a point of the square. */
static inline double
rad_guide_density(const struct rad_guide *g, double x, double y)
{
    int last = g->side - 1, i = (int)(y * g->side), j = (int)(x * g->side);

    i = i < last ? i : last;
    j = j < last ? j : last;
    return (double)g->light[i * g->side + j] * g->scale;
}

/* Draw a part, in column *x and row *y, by three random numbers u of [0, 1).
 * Draws go in order of u[0]: *lobe is 0 at first, and keeps the lobe of the
 * last draw. */
void rad_guide_draw(const struct rad_guide *g, const double u[3], int *lobe,
                    int *x, int *y);

#endif
