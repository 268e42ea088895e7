/* made_picture.h - pictures without a scene, for tests */
#ifndef RADD_TESTS_MADE_PICTURE_H
#define RADD_TESTS_MADE_PICTURE_H

#include "image/hdr.h"
#include "tests/unit.h"

static inline struct rad_picture
blank(int width, int height)
{
    struct rad_picture p = { .width = width, .height = height, .pixaspect = 1 };

    p.L = calloc((size_t)width * (size_t)height, sizeof *p.L);
    ck_assert_ptr_nonnull(p.L);
    return p;
}

/* A grey picture of the values. */
static inline struct rad_picture
grey(int width, int height, const float *v)
{
    struct rad_picture p = blank(width, height);

    for (int i = 0; i < width * height; i++)
        p.L[i] = rad_grey(v[i]);
    return p;
}

#endif
