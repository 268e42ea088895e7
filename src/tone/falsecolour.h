/* falsecolour.h - luminance and differences as colours with a legend
 *
 * A value is luminance in cd/m2 (179 lm/W of radiance), or illuminance in lux
 * where the picture holds irradiance.  Its place v on the scale is value / top,
 * or log10(value / top) / decades + 1, which 10^-decades of the top and less
 * make 0.  The scale is cut into divisions: contours lie where v times their
 * number is whole, as falsecolor(1) has them for its -s, -log, -n, and -cl, -cb
 * or -cp; the colours are ours: from dark blue over green to yellow, each
 * lighter than the one before, so that they can be told in grey, too.
 * Differences are ln of the ratio of luminances, blue where the test picture is
 * darker, red where it is brighter, grey where they agree; the scale ends at a
 * factor of 2.
 * The legend stands to the right of the picture, its unit above it; a picture
 * that is too low for it gets black rows.  Thread: any. */
#ifndef RAD_PICTURE_FALSECOLOUR_H
#define RAD_PICTURE_FALSECOLOUR_H

#include "image/hdr.h"
#include "image/raster.h"

enum rad_contour {
    RAD_CONTOUR_NONE,
    RAD_CONTOUR_LINES, /* over the picture in dim grey */
    RAD_CONTOUR_BANDS, /* a fifth of a division wide, the same */
    RAD_CONTOUR_STEPS  /* each division is of one colour */
};

enum { RAD_FALSE_LABEL = 24, RAD_FALSE_DIVISIONS = 64, RAD_FALSE_DECADES = 12 };

struct rad_false_scale {
    double top;     /* cd/m2 or lux; 0: by the picture */
    double decades; /* 0: linear; below 0: 3 where the picture decides about
                     * the top, else linear */
    int divisions;  /* 1 to RAD_FALSE_DIVISIONS */
    enum rad_contour contour;
    char label[RAD_FALSE_LABEL + 1]; /* of the unit; "": "cd/m2" or "lux" */
};

/* "auto|SCALE[,log=DECADES][,n=DIVISIONS][,contour=lines|bands|steps]
 * [,label=TEXT]", of which all may be left out: ten linear divisions.
 * RAD_EUSAGE. */
int rad_false_parse(struct rad_false_scale *s, const char *text,
                    struct rad_error *err);

/* Fill in what the picture decides: as the top 1, 2, 5 or 10 times a power of
 * ten that no more than a thousandth of its pixels exceed, and the unit.  A
 * black picture decides nothing; false then. */
bool rad_false_fit(struct rad_false_scale *s, const struct rad_picture *pic);

/* The scale is fitted, or top is taken for 1; RAD_ENOMEM. */
int rad_false_colour(const struct rad_false_scale *s,
                     const struct rad_picture *pic, struct rad_image *out,
                     struct rad_error *err);

/* Of two pictures of one size (rad_metric_prepare()). */
int rad_difference_map(const struct rad_picture *test,
                       const struct rad_picture *ref, struct rad_image *out,
                       struct rad_error *err);

#endif
