/* quadric.h - a quantity at a point, by a fit through noisy samples about it
 *
 * Weighted least squares: E = a + b x + c y + d x^2 + e x y + f y^2, with the
 * weights 1 - r^2 (Epanechnikov) within a width.  A prior for how much E bends
 * holds d, e and f near zero where noise would decide about them: so the fit is
 * a plane where there is much noise and a quadric where there is little.
 * Sources: Fan & Gijbels 1996, Local polynomial modelling; Hoerl & Kennard
 * 1970, Ridge regression.
 * Thread: any; pure functions of their arguments.  */
#ifndef RAD_LIGHT_QUADRIC_H
#define RAD_LIGHT_QUADRIC_H

#include <stdbool.h>

struct rad_quadric_sample {
    double x, y;  /* relative to the point */
    double d2;    /* squared distance to the point */
    double E[3];  /* red, green, blue */
    double lum;   /* luminance of E */
    double noise; /* variance of lum */
};

#define RAD_QUADRIC_TERMS 6

struct rad_quadric {
    double width;                   /* of the weights */
    double pull[RAD_QUADRIC_TERMS]; /* at the point, a sample of weight w counts
                                     * w (pull[0] + pull[1] x + ...) */
    double slope[2];                /* of the luminance, at the point */
    double noise;                   /* variance of a sample's luminance */
    double risk; /* expected squared error of the luminance at the point: by
                  * noise, and by how far samples are off the fit beyond their
                  * noise */
};

/* The variance of a sample: the weighted mean of those of all samples within a
 * width of 1.  It serves fits of all widths.  A narrow fit with the variance of
 * just its own samples, if these missed a rare light, would seem to have less
 * noise, be preferred, and lose that light. */
double rad_quadric_noise(const struct rad_quadric_sample *s, int n);

/* Fit n samples of variance `noise`; `bend` is the expected size of d, e and f
 * of the luminance.  False: within the width there are too few samples, or they
 * are too near each other. */
bool rad_quadric_fit(const struct rad_quadric_sample *s, int n, double width,
                     double noise, double bend, struct rad_quadric *q);

/* E at the point, by fit q of the same samples. */
void rad_quadric_middle(const struct rad_quadric_sample *s, int n,
                        const struct rad_quadric *q, double E[3]);

#endif
