/* human.h - a picture as an eye sees it that is adapted to the scene
 *
 * The eye adapts to one degree of its view at a time: the picture's averages
 * over such foveal samples, and its pixels, make a histogram of log luminance.
 * The cumulative histogram would be the tone curve, but that no part of it may
 * show contrasts that the scene would not show to an eye there: bins are
 * trimmed to the ratio of contrast thresholds at the screen's luminance and at
 * the world's until that holds.  Before it come
 *   veil     light scattered within the eye, from all of the picture
 *   acuity   detail that is too fine for the light there is blurred
 *   colour   below 5.62 cd/m2 colours fade to what rods see
 * each only if the picture's luminances make it visible.  pcond(1) calls these
 * -s -v -a -c, all of them -h; its options for fixations, centre weighting and
 * devices are not here.  The screen shows 1 to 100 cd/m2.
 *
 * Luminances are absolute: 179 lm/W times the picture's.  The view gives the
 * angles; where it is unknown, parallel, or 5 degrees or less, the larger side
 * is taken to span 40 degrees, as pcond does.
 * Where the view is wider than a fish-eye of 180 degrees samples are larger
 * than a degree.
 * Sources: Ward Larson, Rushmeier & Piatko 1997, A visibility matching tone
 * reproduction operator for high dynamic range scenes; Ferwerda, Pattanaik,
 * Shirley & Greenberg 1996, A model of visual adaptation for realistic image
 * synthesis (contrast thresholds).
 * Thread: any.  */
#ifndef RAD_PICTURE_HUMAN_H
#define RAD_PICTURE_HUMAN_H

#include <stdbool.h>

enum { RAD_HUMAN_BINS = 100 };

#define RAD_HUMAN_EFFICACY  179.0 /* [lm/W] */
#define RAD_HUMAN_BRIGHTEST 100.0 /* of the screen [cd/m^2] */
#define RAD_HUMAN_DARKEST   1.0
#define RAD_HUMAN_LEAST     1e-7 /* of the world that is seen at all [cd/m^2] */

/* What adaptation to a picture comes to. */
struct rad_human {
    bool linear;               /* contrasts fit the screen: a factor will do, */
    double scale;              /* of radiance to the screen's light */
    bool veil, acuity, colour; /* matter */
    double bmin, bmax;         /* ends of the bins: ln of luminance */
    bool spare;                /* the first bin is below all luminances */
    double below[RAD_HUMAN_BINS + 1]; /* share of samples below each bin */
};

/* A factor instead of the curve; veil, acuity and colour stay as they are. */
void rad_human_linear(struct rad_human *h, double scale);

/* The screen's luminance for one of the world. */
double rad_human_display(const struct rad_human *h, double Lw);

/* Least difference from luminance La that an eye sees [cd/m^2]. */
double rad_human_threshold(double La);

/* Finest detail that an eye sees [cycles/degree]. */
double rad_human_acuity(double La);

/* Luminances that an eye adapts to. */
struct rad_histogram {
    double bin[RAD_HUMAN_BINS];
    double total, logs; /* weight, and sum of ln luminance, of all */
};

/* Begin *h for luminances from least to most.  false: none can be seen. */
bool rad_human_range(struct rad_human *h, double least, double most);

/* Add a sample of that weight; a luminance out of range does not count. */
void rad_human_count(const struct rad_human *h, struct rad_histogram *w,
                     double Lw, double weight);

/* Luminance that a share of the samples is below. */
double rad_human_darkest(const struct rad_human *h,
                         const struct rad_histogram *w, double share);

/* Is the screen's range as large as the world's? */
bool rad_human_fits(const struct rad_human *h);

/* The curve for *w, which is not empty; by a factor where it fits. */
void rad_human_adapt(struct rad_human *h, const struct rad_histogram *w,
                     bool fits);

#endif
