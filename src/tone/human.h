/* human.h - a picture as seen by an eye that is adapted to the scene
 *
 * The eye adapts to one degree of its view at a time.  The picture's averages
 * over such foveal samples, and its pixels, make a histogram of log luminance.
 * Its cumulative form is the tone curve, with one limit: the curve must not
 * show contrasts that an eye in the scene would not see.  So bins are trimmed
 * until the curve rises nowhere faster than the ratio of the contrast
 * thresholds at the screen's luminance and at the world's.  Before the curve
 * come
 *   veil     light from all of the picture is scattered within the eye
 *   acuity   detail too fine for the amount of light is blurred
 *   colour   below 5.62 cd/m2 colours fade to what rods see
 * each only if the picture's luminances make it visible.  pcond(1) calls these
 * -s -v -a -c, and all of them -h; its options for fixations, centre weighting
 * and devices are not supported.  The screen shows 1 to 100 cd/m2.
 *
 * Luminances are absolute: 179 lm/W times the picture's.  The view gives the
 * angles.  If it is unknown, parallel, or at most 5 degrees, the larger side is
 * assumed to span 40 degrees, as in pcond.
 * If the view is wider than a fish-eye of 180 degrees, samples are larger than
 * a degree.
 * Sources: Ward Larson, Rushmeier & Piatko 1997, A visibility matching tone
 * reproduction operator for high dynamic range scenes; Ferwerda, Pattanaik,
 * Shirley & Greenberg 1996, A model of visual adaptation for realistic image
 * synthesis (contrast thresholds).
 * Thread: any.  */
#ifndef RAD_TONE_HUMAN_H
#define RAD_TONE_HUMAN_H

#include <stdbool.h>

enum { RAD_HUMAN_BINS = 100 };

#define RAD_HUMAN_EFFICACY  179.0 /* [lm/W] */
#define RAD_HUMAN_BRIGHTEST 100.0 /* of the screen [cd/m^2] */
#define RAD_HUMAN_DARKEST   1.0
#define RAD_HUMAN_LEAST     1e-7 /* least visible in the world [cd/m^2] */

/* Result of adapting to a picture. */
struct rad_human {
    bool linear;               /* contrasts fit the screen: instead of a
                                * curve */
    double scale;              /* there is a factor from radiance to its
                                * light */
    bool veil, acuity, colour; /* visible effects */
    double bmin, bmax;         /* ends of the bins, ln of luminance */
    bool spare;                /* all luminances are above the first bin */
    double below[RAD_HUMAN_BINS + 1]; /* share of samples below each bin */
};

/* Replace the curve by a factor; veil, acuity and colour do not change. */
void rad_human_linear(struct rad_human *h, double scale);

/* The luminance of the screen for a luminance of the world [cd/m^2], by the
 * curve: not for a factor. */
double rad_human_display(const struct rad_human *h, double Lw);

/* The least difference from luminance La that an eye sees [cd/m^2]. */
double rad_human_threshold(double La);

/* The finest detail that an eye sees [cycles/degree]. */
double rad_human_acuity(double La);

/* Histogram of the luminances that an eye adapts to. */
struct rad_histogram {
    double bin[RAD_HUMAN_BINS];
    double total, logs; /* sums of weights and of weighted ln luminance */
};

/* Set up *h for luminances from least to most; false: none can be seen. */
bool rad_human_range(struct rad_human *h, double least, double most);

/* Add a sample of that weight; a luminance outside the range does not count. */
void rad_human_count(const struct rad_human *h, struct rad_histogram *w,
                     double Lw, double weight);

/* The luminance below which this share of the samples lies. */
double rad_human_darkest(const struct rad_human *h,
                         const struct rad_histogram *w, double share);

/* Is the range of the world at most that of the screen? */
bool rad_human_fits(const struct rad_human *h);

/* Make the curve for *w, which must not be empty; or a factor, if the range
 * fits or the screen can show all contrasts. */
void rad_human_adapt(struct rad_human *h, const struct rad_histogram *w,
                     bool fits);

#endif
