/* view.h - views as rpict(1) has them, and the ray through a picture position
 *
 * -vtv perspective, -vtl parallel, -vth hemispherical fish-eye, -vta angular
 * fish-eye, -vtc cylindrical panorama (-vts planisphere too); -vp -vd -vu -vh
 * -vv -vs -vl -vo -va.  Angles in degrees as in the options; vd's length is
 * kept out of it (normalized), up vector any that is not parallel to it.
 * Source: rpict(1), "-vt"; Radiance reference manual. */
#ifndef RAD_PICTURE_VIEW_H
#define RAD_PICTURE_VIEW_H

#include "base/error.h"

#include <stddef.h>

struct rad_view {
    char type;           /* 'v' 'l' 'h' 'a' 'c' 's' */
    double vp[3];        /* view point */
    double vdir[3];      /* direction, unit once set up */
    double vup[3];
    double vdist;        /* length of -vd as given; focus distance (-pd) */
    double horiz, vert;  /* -vh -vv: degrees, or world units for 'l' */
    double hoff, voff;   /* -vs -vl: shift, lift */
    double vfore, vaft;  /* -vo -va: clipping distances, 0: none */
    /* filled by rad_view_setup() */
    double hvec[3], vvec[3]; /* across one picture width, height */
    double hn2, vn2;         /* their squared lengths */
};

/* rpict's default view: -vtv -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 45 -vv 45. */
void rad_view_init(struct rad_view *v);

/* Take the view option at argv[0]; as rad_params_option().  -vf is not taken
 * here: see rad_view_read(). */
int rad_view_option(struct rad_view *v, int argc, char *const argv[],
                    struct rad_error *err);

/* The last view line of a view file's or picture header's text ("VIEW= ..." or
 * "rpict -vp ..."); each option found changes *v.  Returns the number of view
 * lines, 0 if there was none, negative on a bad one. */
int rad_view_read(struct rad_view *v, const char *text, size_t len,
                  struct rad_error *err);

/* Check and fill the derived fields.  RAD_EUSAGE with rpict's reasons
 * (illegal angle, up parallel to direction, ...). */
int rad_view_setup(struct rad_view *v, struct rad_error *err);

/* Width / height of the view plane; what rpict calls the view aspect, h/w. */
double rad_view_aspect(const struct rad_view *v);

/* Fit the picture into xres by yres for this view and pixel aspect ratio, as
 * rpict's normaspect: changes *xres or *yres, or *pixaspect where it was 0. */
void rad_view_resolution(const struct rad_view *v, double *pixaspect,
                         int *xres, int *yres);

/* The ray at (x, y), both 0..1 from the lower left corner.  Gives the unit
 * direction, the origin on the fore clipping plane, and returns the distance
 * to the aft one (0: none), or a negative number outside the view. */
double rad_view_ray(const struct rad_view *v, double x, double y,
                    double org[3], double dir[3]);

/* Canonical text ("-vtv -vp 0 0 0 ..."), the same for the same view. */
#define RAD_VIEW_TEXT 512
void rad_view_format(const struct rad_view *v, char *buf, size_t size);

#endif
