/* guide.c - see guide.h */
#include "config.h"

#include "light/hemisphere/guide.h"
#include "base/vec.h"
#include "light/sample/disk.h"

/* Parts along a side of the square, about. */
#define PARTS 64

/* So many places are looked at: those that most records chose. */
#define LOOKED_AT 256

/* There is a guide where these alone, with a ray a cell, would give the mean of
 * the hemisphere such a relative variance.  At .03 a room with a mirror has one
 * nearly everywhere, for no gain; at 1 dark corners lack it. */
#define NOISY .3

/* A place that brings less than this over the mean of them has no lobe. */
#define DIM .25

struct rad_guide_lobe {
    int x, y, nx, ny; /* its parts: from there on, so many */
    double upto;      /* light of lobes, this the last */
};

/* The share of the square that a unit of area at a place has. */
static inline double
share_of(const struct rad_bright_place *q, const struct rad_hemi *h,
         const double p[3])
{
    double d[3];

    rad_sub(d, q->p, p);
    double dist2 = rad_dot(d, d), up = rad_dot(d, h->w);

    return up > 0 ? up / (dist2 * sqrt(dist2) * M_PI) : 0;
}

/* Are places so small and bright that they are much of the noise?  light[]
 * becomes what each brings to the mean.  While few records have been made, few
 * places stand for all of what is bright: for noise each counts as more than
 * its area, so that all that are kept would cover as many cells of the grid. */
static bool
is_noisy(const struct rad_bright *b, size_t places, const struct rad_hemi *h,
         const double p[3], double usual, float *light)
{
    double least = b->cell * b->cell * RAD_BRIGHT_MOST / (double)b->n;
    double all = usual, square = 0;

    for (size_t i = 0; i < places; i++) {
        const struct rad_bright_place *q = &b->place[i];
        double share = share_of(q, h, p);
        double wide = rad_least(share * rad_most(q->area, least), 1) * q->lum;

        light[i] = (float)(rad_least(share * q->area, 1) * q->lum);
        all += (double)light[i];
        square += wide * q->lum;
    }
    return square > NOISY * h->n * h->n * all * all;
}

/* Add the lobe of a place that brings `light`; `upto` counts that in.  Where it
 * is in its square is not known to half a part. */
static void
add_lobe(struct rad_guide *g, const struct rad_bright_view *v, double light,
         double upto)
{
    struct rad_guide_lobe *l = &g->lobe[g->lobes++];
    double half = v->width / 2 + .5 / g->side;
    int last = g->side - 1;

    l->x = (int)(rad_most(v->x - half, 0) * g->side);
    l->y = (int)(rad_most(v->y - half, 0) * g->side);
    l->nx = (int)((v->x + half) * g->side);
    l->ny = (int)((v->y + half) * g->side);
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
              const struct rad_hemi *h, const double p[3], double usual,
              struct rad_arena *scratch)
{
    int n = h->n;
    size_t places = b->n < LOOKED_AT ? b->n : LOOKED_AT;
    double all = 0, kept = 0;
    struct rad_bright_view v;
    float light[LOOKED_AT];

    if (!is_noisy(b, places, h, p, usual, light))
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
    all *= DIM / (double)places;
    for (size_t i = 0; i < places; i++)
        if ((double)light[i] > all && rad_bright_see(&v, b, i, h, p) &&
            v.width * n < 1) { /* else the cells do */
            kept += (double)light[i];
            add_lobe(g, &v, (double)light[i], kept);
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
