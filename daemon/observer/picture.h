/* picture.h - a picture as radweb hands it out: for a screen, and its radiance
 *
 * From the bytes of a .hdr that a coordinator sent.  A picture of more than
 * PICTURE_PIXELS is made smaller by a whole factor, each pixel the mean
 * radiance of those that it covers.
 * Thread: any. */
#ifndef RADD_OBSERVER_PICTURE_H
#define RADD_OBSERVER_PICTURE_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PICTURE_PIXELS 1500000    /* most pixels that are handed out */
#define PICTURE_MOST   16000000   /* most pixels of a picture that is read */
/* Most bytes of its file, or of one of PICTURE_PIXELS with edges
 * (image/edge.h): a larger picture is shown without. */
#define PICTURE_BYTES  (66 << 20)
#define PICTURE_VIEW   1024

/* Ahead of the pixels in `rgbe`: "RWP1", then width, height and the factor by
 * which it was made smaller, four bytes each, the highest first. */
#define PICTURE_HEAD 16

struct picture {
    int width, height; /* as handed out */
    int factor;        /* by which it is smaller; 1: it is whole */
    uint8_t *rgbe;     /* PICTURE_HEAD bytes, then four a pixel (image/hdr.h) */
    size_t nrgbe;
    uint8_t *png; /* tone-mapped, sRGB */
    size_t npng;
    char view[PICTURE_VIEW];  /* rpict's options of its view; or "" */
    char scene[PICTURE_VIEW]; /* the files that it is of, as said; or "" */
};

/* partial: black pixels are still to come.  RAD_EDATA, RAD_ENOMEM; pic is empty
 * then. */
int picture_make(struct picture *pic, const uint8_t *hdr, size_t len,
                 bool partial, struct rad_error *err);
void picture_release(struct picture *pic);

#endif
