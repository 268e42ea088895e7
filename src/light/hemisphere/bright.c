/* bright.c - see bright.h */
#include "config.h"

#include "light/hemisphere/bright.h"
#include "arith/angle.h"
#include "base/rng.h"
#include "base/vec.h"
#include "light/sample/disk.h"

#include <stdlib.h>
#include <string.h>

/* A glint is brighter than so many times the mean of its hemisphere. */
#define FAR_ABOVE 3

/* A glint is seen through an opening if hits beside it are nearer than this
 * part of its distance. */
#define NEARER .5

/* Cells of the grid along the side of its cube. */
#define ACROSS 64

/* Dimension of the random number that draws a glint, at the key of the ray that
 * asked for the record. */
#define DIM_GLINT (RAD_DIM_AMBIENT + 1)

#define NONE UINT32_MAX

/* A cell of the grid in which there are glints. */
struct cell {
    uint64_t number;        /* grid_cell() */
    uint32_t glints, first; /* how many, and the index of the first */
    uint32_t place; /* made of these; NONE: too many cells have more glints */
};

/* Glints by cells. */
struct grid {
    struct cell *cell;    /* in the order of first glints */
    struct cell **order;  /* those with most glints first */
    uint32_t n;           /* cells */
    uint32_t *of;         /* cell of each glint; NONE: it has no light */
    uint32_t *slot, mask; /* a hash table of cells; NONE: free */
};

/* Grid cell of a point: its numbers along the axes, 20 bits each.  Cells beyond
 * the cube, as for the sky, are larger by the power of two of their distance.
 */
static uint64_t
grid_cell(const float p[3], const double org[3], double side)
{
    uint64_t cell = 0;
    double q[3], most = 1, across = ACROSS;
    int larger = 1;

    for (int k = 0; k < 3; k++) {
        q[k] = ((double)p[k] - org[k]) / side - .5;
        most = rad_most(most, fabs(q[k]));
    }
    if (most > 1) { /* it is beyond the cube, and not near it */
        frexp(most, &larger);
        across = ldexp(ACROSS, 1 - larger);
    }
    for (int k = 0; k < 3; k++)
        cell =
            cell << 20 | ((uint64_t)(floor(q[k] * across) + 0x1p19) & 0xfffff);
    return cell ^ (uint64_t)larger << 60;
}

/* Note that glint i is in the cell with that number. */
static void
enter(struct grid *g, uint32_t i, uint64_t number)
{
    uint32_t at = (uint32_t)rad_mix64(number) & g->mask;

    while (g->slot[at] != NONE && g->cell[g->slot[at]].number != number)
        at = (at + 1) & g->mask;
    if (g->slot[at] == NONE) {
        g->slot[at] = g->n;
        g->cell[g->n++] = (struct cell){ number, 0, i, NONE };
    }
    g->of[i] = g->slot[at];
    g->cell[g->of[i]].glints++;
}

/* Orders cells by their glints, most first. */
static int
by_glints(const void *a, const void *b)
{
    const struct cell *x = *(struct cell *const *)a;
    const struct cell *y = *(struct cell *const *)b;

    if (x->glints != y->glints)
        return x->glints > y->glints ? -1 : 1;
    return x->first < y->first ? -1 : x->first > y->first;
}

static void
grid_release(struct grid *g)
{
    free(g->cell);
    free(g->order);
    free(g->of);
    free(g->slot);
}

/* Make room for n glints.  False: out of memory. */
static bool
grid_init(struct grid *g, size_t n)
{
    size_t slots = 1;

    while (slots < 2 * n)
        slots *= 2;
    g->cell = malloc(n * sizeof *g->cell + 1);
    g->order = malloc(n * sizeof *g->order + 1);
    g->of = malloc(n * sizeof *g->of + 1);
    g->slot = malloc(slots * sizeof *g->slot);
    g->mask = (uint32_t)(slots - 1);
    g->n = 0;
    if (g->cell && g->order && g->of && g->slot) {
        memset(g->slot, 0xff, slots * sizeof *g->slot);
        return true;
    }
    grid_release(g);
    return false;
}

/* Give the cells with most glints places, which are empty. */
static void
rank(struct grid *g, struct rad_bright *b)
{
    for (uint32_t i = 0; i < g->n; i++)
        g->order[i] = &g->cell[i];
    qsort(g->order, g->n, sizeof *g->order, by_glints);
    for (b->n = 0; b->n < g->n && b->n < RAD_BRIGHT_MOST; b->n++) {
        g->order[b->n]->place = (uint32_t)b->n;
        b->place[b->n] = (struct rad_bright_place){ .lum = 0 };
    }
}

/* The place that glint i belongs to, and its number of glints; NULL: none. */
static struct rad_bright_place *
place_of(const struct grid *g, struct rad_bright *b, size_t i, double *n)
{
    const struct cell *c;

    if (g->of[i] == NONE || (c = &g->cell[g->of[i]])->place == NONE)
        return NULL;
    *n = c->glints;
    return &b->place[c->place];
}

/* Make the places of their glints.  The area is that of a disk whose points
 * have the mean squared distance of the glints from their mean. */
static void
set_places(const struct grid *g, struct rad_bright *b,
           const struct rad_glint *glint, size_t n)
{
    struct rad_bright_place *to;
    double cell2 = b->cell * b->cell, count;

    for (size_t i = 0; i < n; i++)
        if ((to = place_of(g, b, i, &count))) {
            for (int k = 0; k < 3; k++)
                to->p[k] += (double)glint[i].p[k] / count;
            to->lum += (double)glint[i].lum / count;
        }
    for (size_t i = 0; i < n; i++)
        if ((to = place_of(g, b, i, &count))) {
            const float *q = glint[i].p;
            double d[3] = { (double)q[0] - to->p[0], (double)q[1] - to->p[1],
                            (double)q[2] - to->p[2] };

            to->area += rad_dot(d, d) / count;
        }
    for (size_t i = 0; i < b->n; i++) {
        to = &b->place[i];
        to->area = rad_most(2 * M_PI * to->area, cell2 / 16);
        to->reach = to->area + cell2 / g->order[i]->glints;
    }
}

bool
rad_bright_gather(struct rad_bright *b, const struct rad_glint *glint, size_t n,
                  const double org[3], double side)
{
    struct grid g;

    if (!grid_init(&g, n))
        return false;
    b->cell = side / ACROSS;
    for (size_t i = 0; i < n; i++)
        if (glint[i].lum > 0)
            enter(&g, (uint32_t)i, grid_cell(glint[i].p, org, side));
        else
            g.of[i] = NONE;
    rank(&g, b);
    set_places(&g, b, glint, n);
    grid_release(&g);
    return true;
}

/* The distance at which the glint of cell k is put, over the distance of its
 * hit.  If nearly all cells beside it met much nearer surfaces, the glint was
 * seen through an opening: it is put in the opening, where other places see it,
 * too. */
static double
shortened(const struct rad_hemi *h, int k)
{
    static const int beside[4][2] = {
        { -1, 0 }, { 1, 0 }, { 0, -1 }, { 0, 1 }
    };
    double far = sqrt(rad_dot(h->cell[k].p, h->cell[k].p)), sum = 0;
    int around = 0, near = 0;

    for (int b = 0; b < 4; b++) {
        int y = k / h->n + beside[b][0], x = k % h->n + beside[b][1];

        if (y < 0 || x < 0 || y >= h->n || x >= h->n)
            continue;
        const double *p = h->cell[y * h->n + x].p;
        double dist = sqrt(rad_dot(p, p));

        around++;
        if (dist < NEARER * far) {
            sum += dist;
            near++;
        }
    }
    return near > 1 && near >= around - 1 ? sum / near / far : 1;
}

struct rad_glint
rad_bright_glint(const struct rad_hemi *h, const double p[3], uint64_t key)
{
    double floor = FAR_ABOVE * rad_rgb_lum(h->E) / M_PI, all = 0;
    struct rad_glint g = { .lum = 0 };
    int n2 = h->n * h->n;

    for (int k = 0; k < n2; k++)
        all += rad_most((double)h->cell[k].lum - floor, 0);
    all *= rad_rand(key, DIM_GLINT);
    for (int k = 0; k < n2; k++) {
        const struct rad_hemicell *c = &h->cell[k];
        double above = rad_most((double)c->lum - floor, 0);

        if (above > 0) {
            double part = shortened(h, k);

            g.lum = c->lum;
            for (int i = 0; i < 3; i++)
                g.p[i] = (float)(p[i] +
                                 part * (c->p[0] * h->u[i] + c->p[1] * h->v[i] +
                                         c->p[2] * h->w[i]));
            if (all < above)
                break;
        }
        all -= above;
    }
    return g;
}

void
rad_bright_look(const struct rad_bright *b, size_t n, const struct rad_hemi *h,
                const double p[3], double *share)
{
    for (size_t i = 0; i < n; i++) {
        double d[3];

        rad_sub(d, b->place[i].p, p);
        double dist2 = rad_dot(d, d), up = rad_dot(d, h->w);

        share[i] = up > 0 ? up / (dist2 * sqrt(dist2) * M_PI) : 0;
    }
}

void
rad_bright_where(const struct rad_bright_place *q, const struct rad_hemi *h,
                 const double p[3], double at[2])
{
    double d[3];

    rad_sub(d, q->p, p);
    double over = 1 / sqrt(rad_dot(d, d));

    rad_square_of_disk(rad_dot(d, h->u) * over, rad_dot(d, h->v) * over, at);
}

/* The number of the cell, of n * n, in which a point of the square lies. */
static int
cell_at(const double at[2], int n)
{
    int x = (int)(at[0] * n), y = (int)(at[1] * n);

    x = x < 0 ? 0 : x < n ? x : n - 1;
    y = y < 0 ? 0 : y < n ? y : n - 1;
    return y * n + x;
}

void
rad_bright_cells(const struct rad_bright *b, const struct rad_hemi *h,
                 const double p[3], const double *share,
                 struct rad_contrast *cell)
{
    double square[RAD_BRIGHT_MOST], at[2], all = 0, n2 = h->n * h->n;

    for (size_t i = 0; i < b->n; i++) {
        const struct rad_bright_place *q = &b->place[i];

        square[i] = rad_least(share[i] * q->area * n2, 1) * q->lum * q->lum;
        all += square[i];
    }
    all *= RAD_BRIGHT_DIM / (double)b->n;
    for (size_t i = 0; i < b->n; i++)
        if (square[i] > all) {
            rad_bright_where(&b->place[i], h, p, at);
            cell[rad_contrast_at(cell_at(at, h->n), h->n)].square += square[i];
        }
}
