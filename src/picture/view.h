/* view.h - views as rpict(1) has them, and the ray through a picture position
 *
 * -vtv perspective, -vtl parallel, -vth hemispherical fish-eye, -vta angular
 * fish-eye, -vtc cylindrical panorama, -vts planisphere (stereographic); -vp
 * -vd -vu -vh -vv -vs -vl -vo -va.  Angles are in degrees as in the options.
 * The fields that options set stay as given; rad_view_setup() derives the
 * others from them.  So a view that is written by rad_view_format() and read
 * back gives the same rays, bit for bit.
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
    double hvec[3];  /* to the right: for 'a', 's', 'c' of length 1, else as
                      * long as the view plane at distance 1 is wide */
    double vvec[3];  /* up: for 'a', 's' of length 1, else as long as the view
                      * plane at distance 1 is high */
    double hn2, vn2; /* squared width and height of the view plane at 1 */
};

/* rpict's default view: -vtv -vp 0 0 0 -vd 0 1 0 -vu 0 0 1 -vh 45 -vv 45. */
void rad_view_init(struct rad_view *v);

/* Take the view option at argv[0]; returns as rad_params_option() does.  -vf is
 * not taken: see rad_view_read(). */
int rad_view_option(struct rad_view *v, int argc, char *const argv[],
                    struct rad_error *err);

/* Read all view lines in the text of a view file or of a picture's header, up
 * to the first empty line.  A view line starts with "VIEW=" or with the name of
 * a program that notes its options there: rpict, rvu and others of Radiance, or
 * radsubmit.  Every view option in it changes *v; other words are skipped.
 * Returns the number of view lines with options, maybe 0, or RAD_EDATA for a
 * bad option. */
int rad_view_read(struct rad_view *v, const char *text, size_t len,
                  struct rad_error *err);

/* Read one line of the input that -S takes ("VIEW= ..." or "rpict ..."):
 * returns 1 if it is a view line with options, 0 if not, or RAD_EDATA. */
int rad_view_line(struct rad_view *v, const char *line, size_t len,
                  struct rad_error *err);

/* Check the options and fill the derived fields.  RAD_EUSAGE with rpict's
 * reasons (illegal angle, up parallel to direction, ...). */
int rad_view_setup(struct rad_view *v, struct rad_error *err);

/* Fit the picture of this view into xres by yres at a pixel aspect ratio
 * (height / width), as rpict does: reduces *xres or *yres, or sets *pixaspect
 * if it was 0.  A result may be 0 pixels wide or high.  The view must be set
 * up, here and for all functions below. */
void rad_view_resolution(const struct rad_view *v, double *pixaspect, int *xres,
                         int *yres);

/* The ray at picture position (x, y): its origin on the fore clipping plane,
 * and its unit direction.  Returns the distance from there to the aft plane, 0
 * if there is no such plane, or a negative number outside the view. */
double rad_view_ray(const struct rad_view *v, double x, double y, double org[3],
                    double dir[3]);

/* Let a ray of rad_view_ray() pass through a lens of this diameter, which is in
 * focus at the distance |vdir|.  u, three numbers from 0 to 1, chooses the
 * point of the lens.  Changes org and dir, and returns the distance to the aft
 * plane that replaces `aft`.  For perspective and parallel views the lens is a
 * disk across the view direction, about the view point or the pixel's own; for
 * all others a cylinder whose thickness is pi/4 of its diameter. */
double rad_view_lens(const struct rad_view *v, double diameter,
                     const double u[3], double org[3], double dir[3],
                     double aft);

/* Where a point of the world lies in the picture, as bits: 0 is in view. */
enum {
    RAD_VIEW_OUTSIDE = 1, /* beside the picture */
    RAD_VIEW_BEHIND = 2,  /* behind the view point or the fore plane */
    RAD_VIEW_BEYOND = 4,  /* at the aft plane or behind it */
    RAD_VIEW_NOWHERE = 8  /* it has no position: pos is not set */
};

/* The inverse of rad_view_ray(): pos[0], pos[1] is the picture position of
 * p.  Returns RAD_VIEW_ bits. */
unsigned rad_view_locate(const struct rad_view *v, const double p[3],
                         double pos[2]);

/* Write the view as text ("-vtv -vp 0 0 0 ..."): equal views give equal text,
 * and reading it gives the same fields again. */
#define RAD_VIEW_TEXT 512
void rad_view_format(const struct rad_view *v, char *buf, size_t size);

/* The view's part of rpict's -defaults; see rad_params_print_defaults(). */
void rad_view_print_defaults(const struct rad_view *v,
                             void (*line)(void *arg, const char *text),
                             void *arg);

#endif
