/* bright.c - see bright.h */
#include "config.h"

#include "light/hemisphere/bright.h"
#include "arith/angle.h"
#include "base/rng.h"
#include "base/vec.h"
#include "light/sample/disk.h"

#include <stdlib.h>

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

/* A glint's cell of the grid, and its index. */
struct where {
    uint64_t cell;
    size_t glint;
};

/* Grid cell of a point: its numbers along the axes, 20 bits each.  Cells beyond
 * the cube, as for the sky, are larger by the power of two of their distance.
 */
static uint64_t
grid_cell(const float p[3], const double org[3], double side)
{
    uint64_t cell = 0;
    double q[3], most = 1;
    int larger;

    for (int k = 0; k < 3; k++) {
        q[k] = ((double)p[k] - org[k]) / side - .5;
        most = rad_most(most, fabs(q[k]));
    }
    frexp(most, &larger); /* 1 within the cube and near it */
    for (int k = 0; k < 3; k++)
        cell = cell << 20 |
               ((uint64_t)(floor(ldexp(q[k], 1 - larger) * ACROSS) + 0x1p19) &
                0xfffff);
    return cell ^ (uint64_t)larger << 60;
}

static int
by_cell(const void *a, const void *b)
{
    const struct where *x = a, *y = b;

    if (x->cell != y->cell)
        return x->cell < y->cell ? -1 : 1;
    return x->glint < y->glint ? -1 : x->glint > y->glint;
}

/* A place, the number of its glints, and the index of the first. */
struct found {
    struct rad_bright_place place;
    size_t glints, first;
};

/* Orders places by their glints, most first. */
static int
by_glints(const void *a, const void *b)
{
    const struct found *x = a, *y = b;

    if (x->glints != y->glints)
        return x->glints > y->glints ? -1 : 1;
    return x->first < y->first ? -1 : x->first > y->first;
}

/* Make the place of n glints, whose indices w[] has.  Its area is that of a
 * disk whose points have the mean squared distance of the glints from their
 * mean. */
static void
set_place(struct rad_bright_place *to, const struct rad_glint *glint,
          const struct where *w, size_t n, double cell)
{
    double spread = 0;

    *to = (struct rad_bright_place){ .lum = 0 };
    for (size_t i = 0; i < n; i++) {
        const struct rad_glint *one = &glint[w[i].glint];

        for (int k = 0; k < 3; k++)
            to->p[k] += (double)one->p[k] / (double)n;
        to->lum += (double)one->lum / (double)n;
    }
    for (size_t i = 0; i < n; i++) {
        const float *q = glint[w[i].glint].p;
        double d[3] = { (double)q[0] - to->p[0], (double)q[1] - to->p[1],
                        (double)q[2] - to->p[2] };

        spread += rad_dot(d, d) / (double)n;
    }
    to->area = rad_most(2 * M_PI * spread, cell * cell / 16);
    to->reach = to->area + cell * cell / (double)n;
}

bool
rad_bright_gather(struct rad_bright *b, const struct rad_glint *glint, size_t n,
                  const double org[3], double side)
{
    struct where *w = malloc(n * sizeof *w + 1);
    struct found *found = malloc(n * sizeof *found + 1);
    double cell = side / ACROSS;
    size_t there = 0, places = 0, k;
    bool ok = w && found;

    b->n = 0;
    b->cell = cell;
    for (size_t i = 0; ok && i < n; i++)
        if (glint[i].lum > 0)
            w[there++] = (struct where){ grid_cell(glint[i].p, org, side), i };
    if (ok)
        qsort(w, there, sizeof *w, by_cell);
    for (size_t i = 0; i < there; i = k, places++) {
        for (k = i; k < there && w[k].cell == w[i].cell; k++)
            ;
        set_place(&found[places].place, glint, &w[i], k - i, cell);
        found[places].glints = k - i;
        found[places].first = w[i].glint;
    }
    if (ok)
        qsort(found, places, sizeof *found, by_glints);
    for (; ok && b->n < places && b->n < RAD_BRIGHT_MOST; b->n++)
        b->place[b->n] = found[b->n].place;
    free(w);
    free(found);
    return ok;
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
            cell[cell_at(at, h->n)].square += square[i];
        }
}
