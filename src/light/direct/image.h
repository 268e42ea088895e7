/* image.h - mirrors while the images in them are made (inside light/direct
 * only) */
#ifndef RAD_LIGHT_IMAGE_H
#define RAD_LIGHT_IMAGE_H

#include "light/direct/sources.h"

/* A mirror, or a prism. */
struct rad_mirror {
    int32_t obj;
    int32_t prism; /* material of a prism, or RAD_VOID */
    double normal[3], offset;
    double centre[3], radius; /* of a disk that holds it, */
    double lo[3], hi[3];      /* and of a box */
};

struct rad_mirrors {
    struct rad_mirror *list; /* in the order of objects */
    int32_t n;
    double size; /* of the scene */
};

/* Test the images from `first` on as -dp says, and drop those that are hidden;
 * of the others `sure` is set.  0 or a negative code. */
int rad_pretest(struct rad_job *job, const struct rad_mirrors *mirrors,
                int32_t first, struct rad_error *err);

#endif
