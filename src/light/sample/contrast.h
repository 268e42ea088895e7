/* contrast.h - how further samples are shared out among the cells of a grid
 *
 * Each cell has one sample.  A cell's share of the further samples grows with
 * its expected deviation: with the differences between the samples of the cells
 * around it, and with a mean square that the caller knows of the cell.
 * A cell's own sample must not change its share.  Else a cell that drew a
 * bright sample would get more samples and be averaged down, a cell that drew a
 * dark sample would not, and the mean would be too dark.  Shares are parts of
 * the deviations' sum over all cells.  A bright sample raises the deviations of
 * the cells around it; by the plain sum it would so lower its own cell's share,
 * and count for up to twice its light.  So each cell's share is a part of the
 * sum as it is without the cell's own sample. */
#ifndef RAD_LIGHT_CONTRAST_H
#define RAD_LIGHT_CONTRAST_H

struct rad_contrast {
    double lum;    /* luminance of the cell's one sample */
    double square; /* mean square of luminance that is known of the cell */
    double share;  /* set to the cell's share of the further samples; the shares
                    * of all cells sum to about 1, or to 0 if no luminance
                    * differs and all squares are 0 */
    /* inside only: the sums of the luminances around this cell and of their
     * squares; the inverse of the number of cells there, less one; the
     * deviation expected of the cell */
    double sum, sum2, less, noise;
};

/* n * n cells lie row by row within a border of one cell, in an array of
 * rad_contrast_size(n): where cell k is. */
static inline int
rad_contrast_at(int k, int n)
{
    return (k / n + 1) * (n + 2) + k % n + 1;
}

static inline int
rad_contrast_size(int n)
{
    return (n + 2) * (n + 2);
}

/* Set the shares of n * n cells.  The caller has set their lum and square, and
 * all else in the array to 0. */
void rad_contrast_share(struct rad_contrast *cell, int n);

#endif
