/* guide.c - see guide.h */
#include "config.h"

#include "light/hemisphere/guide.h"
#include "base/vec.h"

/* The square is cut into about so many parts along a side. */
#define PARTS 64

/* A hemisphere has a guide if, with one ray a cell, bright places alone would
 * give its mean this relative variance.  At .03 a room with a mirror has guides
 * nearly everywhere, for no gain; at 1 dark corners lack them. */
#define NOISY .3

struct rad_guide_lobe {
    int x, y, nx, ny; /* its parts: the first column and row, and how many */
    double upto;      /* sum of the light of the lobes up to this one */
};

/* Are places so small and bright that they make much of the noise?  light[i] is
 * set to what place i is expected to add to the mean luminance.
 * While few records are made, few places stand for all that is bright.  So, for
 * the noise, the places count as so wide that all together cover at least
 * RAD_BRIGHT_MOST cells of the grid. */
static bool
is_noisy(const struct rad_bright *b, size_t places, int n, const double *share,
         double usual, float *light)
{
    double least = b->cell * b->cell * RAD_BRIGHT_MOST / (double)b->n;
    double all = usual, square = 0;

    for (size_t i = 0; i < places; i++) {
        const struct rad_bright_place *q = &b->place[i];
        double wide =
            rad_least(share[i] * rad_most(q->area, least), 1) * q->lum;

        light[i] = (float)(rad_least(share[i] * q->area, 1) * q->lum);
        all += (double)light[i];
        square += wide * q->lum;
    }
    return square > NOISY * n * n * all * all;
}

/* Add the lobe of a place that is seen at (x, y) of the square, is up to
 * `width` wide there and brings `light`; `upto` is the sum of the light of all
 * lobes up to this lobe.  The lobe is half a part wider on each side, by which
 * (x, y) may be off. */
static void
add_lobe(struct rad_guide *g, double x, double y, double width, double light,
         double upto)
{
    struct rad_guide_lobe *l = &g->lobe[g->lobes++];
    double half = width / 2 + .5 / g->side;
    int last = g->side - 1;

    l->x = (int)(rad_most(x - half, 0) * g->side);
    l->y = (int)(rad_most(y - half, 0) * g->side);
    l->nx = (int)((x + half) * g->side);
    l->ny = (int)((y + half) * g->side);
    l->x = l->x < last ? l->x : last;
    l->y = l->y < last ? l->y : last;
    l->nx = (l->nx < last ? l->nx : last) - l->x + 1;
    l->ny = (l->ny < last ? l->ny : last) - l->y + 1;
    l->upto = upto;
    float per = (float)(light / (l->nx * l->ny));
    for (int i = l->y; i < l->y + l->ny; i++)
        for (int j = l->x; j < l->x + l->nx; j++)
            g->light[i * g->side + j] += per;
}

bool
rad_guide_set(struct rad_guide *g, const struct rad_bright *b,
              const struct rad_hemi *h, const double p[3], const double *share,
              double usual, struct rad_arena *scratch)
{
    int n = h->n;
    size_t places = rad_guide_places(b);
    double all = 0, kept = 0, at[2];
    float light[RAD_GUIDE_PLACES];

    if (!is_noisy(b, places, n, share, usual, light))
        return false;
    g->side = n * ((PARTS + n - 1) / n);
    g->light = rad_arena_calloc(scratch, (size_t)(g->side * g->side),
                                sizeof *g->light);
    g->lobe = rad_arena_alloc(scratch, places * sizeof *g->lobe);
    g->lobes = 0;
    if (!g->light || !g->lobe)
        return false;
    for (size_t i = 0; i < places; i++)
        all += (double)light[i];
    all *= RAD_BRIGHT_DIM / (double)places;
    for (size_t i = 0; i < places; i++) {
        double width = sqrt(rad_least(b->place[i].reach * share[i], 1));

        /* places wider than a cell are left to the cells' own rays */
        if ((double)light[i] > all && width * n < 1) {
            rad_bright_where(&b->place[i], h, p, at);
            kept += (double)light[i];
            add_lobe(g, at[0], at[1], width, (double)light[i], kept);
        }
    }
    g->scale = g->side * g->side / kept;
    return kept > 0;
}

void
rad_guide_draw(const struct rad_guide *g, const double u[3], int *lobe, int *x,
               int *y)
{
    double upto = u[0] * g->lobe[g->lobes - 1].upto;

    while (*lobe < g->lobes - 1 && g->lobe[*lobe].upto <= upto)
        ++*lobe;
    const struct rad_guide_lobe *l = &g->lobe[*lobe];
    *x = l->x + (int)(u[1] * l->nx);
    *y = l->y + (int)(u[2] * l->ny);
}
