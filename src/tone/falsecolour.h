/* falsecolour.h - luminance and differences as colours with a legend
 *
 * A value is luminance in cd/m2 (179 lm/W of radiance), or illuminance in lux
 * if the picture has irradiance.  Its place v on the scale is value / top, or
 * on a logarithmic scale log10(value / top) / decades + 1, but at least 0.  The
 * scale has divisions, and contours are at whole numbers of divisions, as in
 * falsecolor(1) with its -s, -log, -n, and -cl, -cb or -cp; but a logarithmic
 * scale of a decade or more, for which no number of divisions is said, has its
 * contours at round numbers.  The colours are our own, from dark blue over
 * green to yellow.  Each is lighter than the one before, so that they can be
 * told apart in grey, too.
 * Differences are the ln of the ratio of luminances: blue if the test picture
 * is darker, red if it is brighter, grey if they are equal.  The scale ends at
 * a factor of 2.
 * The legend is at the right of the picture, with the unit above.  If the
 * picture is not high enough for it, black rows are added.
 * Thread: any. */
#ifndef RAD_TONE_FALSECOLOUR_H
#define RAD_TONE_FALSECOLOUR_H

#include "image/hdr.h"
#include "image/raster.h"

enum rad_contour {
    RAD_CONTOUR_NONE,
    RAD_CONTOUR_LINES, /* lines over the picture in dim grey */
    RAD_CONTOUR_BANDS, /* bands over it, a fifth of a division wide */
    RAD_CONTOUR_STEPS  /* each division has one colour */
};

enum { RAD_FALSE_LABEL = 24, RAD_FALSE_DIVISIONS = 64, RAD_FALSE_DECADES = 12 };

struct rad_false_scale {
    double top;     /* cd/m2 or lux; 0: chosen by the picture */
    double decades; /* 0: linear; negative: 3 if the picture chooses the top,
                     * else linear */
    int divisions;  /* 1 to RAD_FALSE_DIVISIONS; 0: ten, or by round numbers */
    enum rad_contour contour;
    char label[RAD_FALSE_LABEL + 1]; /* the unit; "": "cd/m2" or "lux" */
};

/* Parse "auto|SCALE[,log=DECADES][,n=DIVISIONS][,contour=lines|bands|steps]
 * [,label=TEXT]".  Each part may be left out.  RAD_EUSAGE. */
int rad_false_parse(struct rad_false_scale *s, const char *text,
                    struct rad_error *err);

/* Let the picture choose what is open: the unit, and as top the least of 1, 2,
 * 5 or 10 times a power of ten that at most a thousandth of its pixels exceed.
 * False: the picture is black, and the top stays open. */
bool rad_false_fit(struct rad_false_scale *s, const struct rad_picture *pic);

/* Draw a picture in false colour, with its legend.  The scale should be fitted;
 * an open top is taken as 1.  RAD_ENOMEM. */
int rad_false_colour(const struct rad_false_scale *s,
                     const struct rad_picture *pic, struct rad_image *out,
                     struct rad_error *err);

/* Draw the differences of two pictures of one size (rad_metric_prepare()).
 * RAD_ENOMEM. */
int rad_difference_map(const struct rad_picture *test,
                       const struct rad_picture *ref, struct rad_image *out,
                       struct rad_error *err);

#endif
