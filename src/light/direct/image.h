/* image.h - the mirrors and prisms of a scene, for making the images of sources
 * in them (inside light/direct only) */
#ifndef RAD_LIGHT_IMAGE_H
#define RAD_LIGHT_IMAGE_H

#include "light/direct/sources.h"

/* A mirror, or a prism. */
struct rad_mirror {
    int32_t obj;
    int32_t prism; /* material of a prism, or RAD_VOID */
    double normal[3], offset;
    double centre[3], radius; /* of a disk that holds the mirror */
    double lo[3], hi[3];      /* of a box that holds the mirror */
};

struct rad_mirrors {
    struct rad_mirror *list; /* in the order of objects */
    int32_t n;
    double size; /* the scene's largest extent along an axis */
};

/* Test images from `first` on with as many rays as -dp says.  Hidden images are
 * dropped; `sure` of the others says whether all rays reached them.
 * 0 or a negative code. */
int rad_pretest(struct rad_job *job, const struct rad_mirrors *mirrors,
                int32_t first, struct rad_error *err);

#endif
