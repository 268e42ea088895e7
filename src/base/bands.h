/* bands.h - the wavelengths that light is sampled at (-cs -cw)
 *
 * A range of wavelengths is cut into bands of the same width, the longest
 * first.  Three of them stand for red, green and blue, and colours are what
 * they always are.  Where there are more, rays still carry three channels, and
 * a picture is made in *planes*, each of which shows three of the bands.  The
 * bands of a plane lie a third of the range apart, so that each plane has long,
 * middle and short waves, and what goes by luminance (thresholds, chances)
 * goes much the same way in all of them.
 * A colour that is given as red, green and blue becomes a spectrum of three
 * steps, as in Radiance: at 588 and 480 nm, or at thirds of a range that lacks
 * one of the primaries.
 * Source: rpict(1), -cs and -cw. */
#ifndef RAD_BASE_BANDS_H
#define RAD_BASE_BANDS_H

#include "base/color.h"

#include <stdbool.h>

#define RAD_MAX_BANDS  24
#define RAD_MAX_PLANES ((RAD_MAX_BANDS + 2) / 3)

/* What is sampled where nobody says otherwise [nm]. */
#define RAD_LONGEST_WAVE  780.
#define RAD_SHORTEST_WAVE 380.

/* A range is no less [nm]. */
#define RAD_LEAST_RANGE 50.

struct rad_bands {
    int n;                    /* 3 to RAD_MAX_BANDS */
    double longest, shortest; /* [nm], RAD_LEAST_RANGE apart at least */
    int plane;                /* which of the planes is shown, from 0; -1: the
                               * first, or each in its turn */
};

/* Red, green and blue of the usual range. */
struct rad_bands rad_bands_rgb(void);

/* Are these bands red, green and blue? */
static inline bool
rad_bands_are_rgb(const struct rad_bands *b)
{
    return b->n == 3;
}

/* How many planes it takes. */
int rad_bands_planes(const struct rad_bands *b);

/* The band that a channel (0 to 2) of a plane shows, of the first for -1. Where
 * bands run out, the last channel of a plane shows the band of the one before.
 */
int rad_bands_of(const struct rad_bands *b, int plane, int channel);

/* What each band has, of what all planes show. */
void rad_bands_gather(const struct rad_bands *b, const struct rad_rgb plane[],
                      float band[RAD_MAX_BANDS]);

/* Where red begins, becomes green, becomes blue, and blue ends [nm]; i from 0
 * to 3. */
double rad_bands_split(const struct rad_bands *b, int i);

/* Which of red, green and blue a band has the value of: 0, 1, 2. */
int rad_bands_primary(const struct rad_bands *b, int band);

/* Has the range all three primaries in it? */
bool rad_bands_show_colour(const struct rad_bands *b);

#endif
