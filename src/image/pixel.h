/* pixel.h - a pixel as it is rendered */
#ifndef RAD_IMAGE_PIXEL_H
#define RAD_IMAGE_PIXEL_H

#include "base/color.h"

struct rad_pixel {
    struct rad_rgb L;
    float z; /* distance; 0 without -z */
};

#endif
