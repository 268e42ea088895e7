/* view.h - views as rpict(1) has them, and the ray through a picture position
 *
 * -vtv perspective, -vtl parallel, -vth hemispherical fish-eye, -vta angular
 * fish-eye, -vtc cylindrical panorama, -vts planisphere (stereographic); -vp
 * -vd -vu -vh -vv -vs -vl -vo -va.  Angles are in degrees as in the options.
 * What the options say stays as they said it; rad_view_setup() derives the
 * rest from it, so a view that went through rad_view_format() and back gives
 * the same rays, bit for bit.
 * Picture positions are 0..1 from the lower left corner.
 * Source: rpict(1), "-vt"; Radiance reference manual. */
#ifndef RAD_PICTURE_VIEW_H
#define RAD_PICTURE_VIEW_H

#include "base/error.h"

#include <stddef.h>

struct rad_view {
    char type;          /* 'v' 'l' 'h' 'a' 'c' 's' */
    double vp[3];       /* view point */
    double vdir[3];     /* direction as given, of any length but 0 */
    double vup[3];      /* up vector as given */
    double horiz, vert; /* -vh -vv: degrees, or world units for 'l' */
    double hoff, voff;  /* -vs -vl: shift, lift [picture widths, heights] */
    double vfore, vaft; /* -vo -va: clipping distances; vaft 0: none */
    /* filled by rad_view_setup() */
    double dir[3];   /* vdir, of unit length */
    double hvec[3];  /* to the right, vvec up; for 'v', 'l', 'h' across one */
    double vvec[3];  /* picture, for 'a' and 's' unit; for 'c' hvec is unit */
    double hn2, vn2; /* squared width and height of the view plane at 1 */
};

/* rpict's default view: -vtv -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 45 -vv 45. */
void rad_view_init(struct rad_view *v);

/* Take the view option at argv[0]; as rad_params_option().  -vf is not taken
 * here: see rad_view_read(). */
int rad_view_option(struct rad_view *v, int argc, char *const argv[],
                    struct rad_error *err);

/* All view lines of a view file's or a picture header's text, up to the first
 * empty line: those that start with "VIEW=", rpict, rvu or another program of
 * Radiance's or ours that notes its options there; in each, every view option
 * changes *v and other words are skipped.  Returns the number of lines with
 * view options, 0 if there was none, or RAD_EDATA on a bad one. */
int rad_view_read(struct rad_view *v, const char *text, size_t len,
                  struct rad_error *err);

/* The view options of one line as -S reads it from its input ("VIEW= ..." or
 * "rpict ..."): returns 1 if it was a view line, 0 if not. */
int rad_view_line(struct rad_view *v, const char *line, size_t len,
                  struct rad_error *err);

/* Check and fill the derived fields.  RAD_EUSAGE with rpict's reasons
 * (illegal angle, up parallel to direction, ...). */
int rad_view_setup(struct rad_view *v, struct rad_error *err);

/* Fit the picture into xres by yres for this view and pixel aspect ratio
 * (height / width), as rpict does: reduces *xres or *yres, or sets *pixaspect
 * where it was 0.  A result may be 0 pixels wide or high.  Needs setup, as all
 * below. */
void rad_view_resolution(const struct rad_view *v, double *pixaspect, int *xres,
                         int *yres);

/* The ray at (x, y).  Gives the unit direction, the origin on the fore
 * clipping plane, and returns the distance from there to the aft one (0: no
 * such plane), or a negative number outside the view. */
double rad_view_ray(const struct rad_view *v, double x, double y, double org[3],
                    double dir[3]);

/* Let the ray that rad_view_ray() gave pass a lens of this diameter, in focus
 * at the length of the view direction, by the place that u[3], each from 0 to
 * 1, says: changes org and dir, and returns the distance to the aft plane in
 * the place of aft.  The lens is a disk across the direction of perspective and
 * parallel views, about the view point or the pixel's; of all others a cylinder
 * as thick as pi/4 of its diameter. */
double rad_view_lens(const struct rad_view *v, double diameter,
                     const double u[3], double org[3], double dir[3],
                     double aft);

/* Where a point of the world lies in the picture, as bits: 0 is in view. */
enum {
    RAD_VIEW_OUTSIDE = 1, /* beside the picture */
    RAD_VIEW_BEHIND = 2,  /* behind the view point or the fore plane */
    RAD_VIEW_BEYOND = 4,  /* at the aft plane or behind it */
    RAD_VIEW_NOWHERE = 8  /* no position at all: pos is not set */
};

/* The inverse of rad_view_ray(): pos[0], pos[1] is the picture position of
 * p.  Returns RAD_VIEW_ bits. */
unsigned rad_view_locate(const struct rad_view *v, const double p[3],
                         double pos[2]);

/* Canonical text ("-vtv -vp 0 0 0 ..."), the same for the same view; reading
 * it gives the same fields again. */
#define RAD_VIEW_TEXT 512
void rad_view_format(const struct rad_view *v, char *buf, size_t size);

/* The view's part of rpict's -defaults; as rad_params_print_defaults(). */
void rad_view_print_defaults(const struct rad_view *v,
                             void (*line)(void *arg, const char *text),
                             void *arg);

#endif
