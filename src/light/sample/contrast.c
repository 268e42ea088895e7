/* contrast.c - see contrast.h */
#include "config.h"

#include "light/sample/contrast.h"
#include "base/vec.h"

#include <math.h>

struct block {
    int top, bottom, left, right;
};

/* The cells around cell k, and itself. */
static struct block
block_of(int k, int n)
{
    int i = k / n, j = k % n;

    return (struct block){ i > 0 ? i - 1 : 0, i < n - 1 ? i + 1 : i,
                           j > 0 ? j - 1 : 0, j < n - 1 ? j + 1 : j };
}

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

static double
expected(const struct rad_contrast *c)
{
    double var = 0;

    if (c->around > 0)
        var = rad_most(c->sum2 - c->sum * c->sum / c->around, 0) / c->around;
    return sqrt(c->square + var);
}

/* By how much cell k's sample raises what is expected of the cells around. */
static double
own_part(const struct rad_contrast *cell, int k, int n)
{
    struct block b = block_of(k, n);
    double part = 0;

    for (int i = b.top; i <= b.bottom; i++)
        for (int j = b.left; j <= b.right; j++) {
            struct rad_contrast c = cell[i * n + j];

            if (i * n + j == k)
                continue;
            c.around--;
            c.sum -= cell[k].lum;
            c.sum2 -= cell[k].lum * cell[k].lum;
            part += c.noise - expected(&c);
        }
    return part;
}

void
rad_contrast_share(struct rad_contrast *cell, int n)
{
    double all = 0;

    for (int k = 0; k < n * n; k++) {
        look_around(cell, k, n);
        cell[k].noise = expected(&cell[k]);
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
