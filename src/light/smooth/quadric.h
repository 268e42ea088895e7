/* quadric.h - a quantity at the middle of noisy samples of it about a point
 *
 * Weighted least squares: E = a + b x + c y + d x^2 + e x y + f y^2, the
 * weights 1 - r^2 (Epanechnikov) within a width.  What is known beforehand of
 * how much E bends holds d, e and f near zero where noise would decide about
 * them, so the fit is a plane among much noise and a quadric among little.
 * Sources: Fan & Gijbels 1996, Local polynomial modelling; Hoerl & Kennard
 * 1970, Ridge regression.
 * Thread: any; pure functions of their arguments.  */
#ifndef RAD_LIGHT_QUADRIC_H
#define RAD_LIGHT_QUADRIC_H

#include <stdbool.h>

struct rad_quadric_sample {
    double x, y;  /* from the middle */
    double d2;    /* its distance squared */
    double E[3];  /* red, green, blue */
    double lum;   /* their luminance */
    double noise; /* variance of that */
};

#define RAD_QUADRIC_TERMS 6

struct rad_quadric {
    double width;                   /* of the weights */
    double pull[RAD_QUADRIC_TERMS]; /* with weight w, a sample counts for
                                     * w (pull[0] + pull[1] x + ...) */
    double slope[2];                /* of the luminance, at the middle */
    double noise;                   /* variance of a sample */
    double risk; /* variance of the luminance at the middle, with what the
                  * samples are off by beyond their noise */
};

/* Variance of a sample by what all of them within a width of 1 say of theirs,
 * the same for all widths: by those within alone a narrow fit among samples
 * that missed a rare light would seem to have less noise, be preferred, and
 * lose the light. */
double rad_quadric_noise(const struct rad_quadric_sample *s, int n);

/* Fit n samples with that `noise`; `bend` is the size that d, e and f of the
 * luminance are expected to have.  False: there are too few, or too few apart,
 * within that width. */
bool rad_quadric_fit(const struct rad_quadric_sample *s, int n, double width,
                     double noise, double bend, struct rad_quadric *q);

/* E at the middle. */
void rad_quadric_middle(const struct rad_quadric_sample *s, int n,
                        const struct rad_quadric *q, double E[3]);

#endif
