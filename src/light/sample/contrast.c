/* contrast.c - see contrast.h */
#include "config.h"

#include "light/sample/contrast.h"
#include "base/vec.h"

#include <math.h>

struct block {
    int top, bottom, left, right;
};

/* The block of cell k and the cells around it. */
static struct block
block_of(int k, int n)
{
    int i = k / n, j = k % n;

    return (struct block){ i > 0 ? i - 1 : 0, i < n - 1 ? i + 1 : i,
                           j > 0 ? j - 1 : 0, j < n - 1 ? j + 1 : j };
}

/* Sum up the luminances of the cells around cell k. */
static void
look_around(struct rad_contrast *cell, int k, int n)
{
    struct block b = block_of(k, n);
    struct rad_contrast *c = &cell[k];

    for (int i = b.top; i <= b.bottom; i++)
        for (int j = b.left; j <= b.right; j++) {
            double lum = cell[i * n + j].lum;

            if (i * n + j == k)
                continue;
            c->around++;
            c->sum += lum;
            c->sum2 += lum * lum;
        }
}

/* The deviation expected of a cell, by its `square` and the sums over `around`
 * neighbours.  It is computed nine times for each cell, and a division would
 * take as long as all the rest: so inverses are in a table. */
static double
expected(double square, int around, double sum, double sum2)
{
    static const double over[9] = { 0,      1,      1. / 2, 1. / 3, 1. / 4,
                                    1. / 5, 1. / 6, 1. / 7, 1. / 8 };
    double mean = sum * over[around];

    return sqrt(square + rad_most(sum2 * over[around] - mean * mean, 0));
}

/* By how much cell k's sample raises the deviations expected of the cells
 * around it, in all. */
static double
own_part(const struct rad_contrast *cell, int k, int n)
{
    struct block b = block_of(k, n);
    double part = 0, lum = cell[k].lum, lum2 = lum * lum;

    for (int i = b.top; i <= b.bottom; i++)
        for (int j = b.left; j <= b.right; j++) {
            const struct rad_contrast *c = &cell[i * n + j];

            if (i * n + j != k)
                part += c->noise - expected(c->square, c->around - 1,
                                            c->sum - lum, c->sum2 - lum2);
        }
    return part;
}

void
rad_contrast_share(struct rad_contrast *cell, int n)
{
    double all = 0;

    for (int k = 0; k < n * n; k++) {
        look_around(cell, k, n);
        cell[k].noise =
            expected(cell[k].square, cell[k].around, cell[k].sum, cell[k].sum2);
        all += cell[k].noise;
    }
    if (!(all > 0 && all < INFINITY))
        return;
    for (int k = 0; k < n * n; k++) {
        double noise = cell[k].noise;

        if (noise > 0)
            cell[k].share = noise / rad_most(all - own_part(cell, k, n), noise);
    }
}
