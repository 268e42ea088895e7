/* bands.h - the wavelengths that light is sampled at (-cs -cw)
 *
 * A range of wavelengths is cut into bands of equal width, the longest waves
 * first.  Three bands stand for red, green and blue, and colours are treated as
 * ever.  With more bands rays still carry three channels, and a picture is made
 * in *planes*, each of which shows three of the bands.  The bands of a plane
 * lie a third of the range apart: each plane has long, middle and short waves,
 * so decisions by luminance (thresholds, probabilities) come out much the same
 * in all planes.
 * A scene that gives all colours as red, green and blue has but three different
 * bands: one plane shows these three colours, and each band is one of them.
 * A colour given as red, green and blue becomes a spectrum of three steps, as
 * in Radiance.  It steps at 588 and 480 nm, or at thirds of the range if that
 * lacks red or blue.
 * Source: rpict(1), -cs and -cw. */
#ifndef RAD_BASE_BANDS_H
#define RAD_BASE_BANDS_H

#include "base/color.h"

#include <stdbool.h>

#define RAD_MAX_BANDS  24
#define RAD_MAX_PLANES ((RAD_MAX_BANDS + 2) / 3)

/* The number of the plane that shows red, green and blue for all bands. */
#define RAD_PLANE_COLOURS RAD_MAX_PLANES

/* The default range [nm]. */
#define RAD_LONGEST_WAVE  780.
#define RAD_SHORTEST_WAVE 380.

/* The least width of a range [nm]. */
#define RAD_LEAST_RANGE 50.

struct rad_bands {
    int n;                    /* 3 to RAD_MAX_BANDS */
    double longest, shortest; /* [nm], at least RAD_LEAST_RANGE apart */
    int plane;                /* which plane is rendered, from 0, or
                               * RAD_PLANE_COLOURS; -1: the first one, or all,
                               * one after the other */
};

/* Red, green and blue of the default range. */
struct rad_bands rad_bands_rgb(void);

/* Are these bands red, green and blue? */
static inline bool
rad_bands_are_rgb(const struct rad_bands *b)
{
    return b->n == 3;
}

/* Are these more than three bands, and all of them rendered, not one plane by
 * itself? */
static inline bool
rad_bands_many(const struct rad_bands *b)
{
    return b->n > 3 && (b->plane < 0 || b->plane == RAD_PLANE_COLOURS);
}

/* The number of planes: one if that is RAD_PLANE_COLOURS. */
int rad_bands_planes(const struct rad_bands *b);

/* The band that a channel (0 to 2) of a plane, but not of RAD_PLANE_COLOURS,
 * shows; plane -1 is the first one.
 * If there are no bands left, the last channel repeats the channel before. */
int rad_bands_of(const struct rad_bands *b, int plane, int channel);

/* The values of all bands, from those of all planes. */
void rad_bands_gather(const struct rad_bands *b, const struct rad_rgb plane[],
                      float band[RAD_MAX_BANDS]);

/* The steps of a colour's spectrum [nm]: for i from 0 to 3 where red begins,
 * green begins, blue begins and blue ends. */
double rad_bands_split(const struct rad_bands *b, int i);

/* Which of red (0), green (1) and blue (2) gives a band its value. */
int rad_bands_primary(const struct rad_bands *b, int band);

/* Does the range contain red and blue? */
bool rad_bands_show_colour(const struct rad_bands *b);

#endif
