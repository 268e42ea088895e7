/* falsecolour.h - luminance and differences as colours with a legend
 *
 * Luminance runs over three decades below the brightest pixel, from dark blue
 * over green to yellow, in cd/m^2 (179 lm/W).  Differences are ln of the ratio
 * of luminances, blue where the test picture is darker, red where it is
 * brighter, grey where they agree; the scale ends at a factor of 2.
 * A legend stands to the right of the picture. */
#ifndef RAD_PICTURE_FALSECOLOUR_H
#define RAD_PICTURE_FALSECOLOUR_H

#include "picture/hdr.h"

/* An 8 bit picture, three bytes a pixel, the top row first; malloc'd. */
struct rad_image {
    int width, height;
    uint8_t *rgb;
};

int rad_false_colour(const struct rad_picture *pic, struct rad_image *out,
                     struct rad_error *err);

/* Of two pictures of one size (rad_metric_prepare()). */
int rad_difference_map(const struct rad_picture *test,
                       const struct rad_picture *ref, struct rad_image *out,
                       struct rad_error *err);

#endif
