/* contrast.h - which cells of a grid of samples get more of them
 *
 * Where the cells around a cell differ, and where more is known to come.  A
 * cell's own sample has no say in its share: else a cell that drew a bright
 * sample would be averaged down and one that drew a dark one would not, and the
 * result would be too dark in the mean.  Nor has it by what the cells around
 * take of the whole: a cell with a small window that drew it would make them
 * take its own share, and count for up to twice what the window is. */
#ifndef RAD_LIGHT_CONTRAST_H
#define RAD_LIGHT_CONTRAST_H

struct rad_contrast {
    double lum;    /* luminance of the cell's one sample */
    double square; /* what is known of the cell: a mean square of luminance */
    double share;  /* gets its share; their sum is about 1, and 0 where nothing
                    * differs and nothing is known */
    /* inside only: of the cells around it, how many, their sum and that of
     * their squares; and the deviation that is expected of the cell */
    int around;
    double sum, sum2, noise;
};

/* Set the shares of n * n cells, row by row, of which the rest is 0. */
void rad_contrast_share(struct rad_contrast *cell, int n);

#endif
