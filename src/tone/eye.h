/* eye.h - a picture as an eye sees it: foveal samples, veil, acuity, colour
 *
 * human.h describes the model; this file takes from a picture what it needs.
 * Sources: those of human.h; Moon & Spencer 1945 (veil).
 * Thread: one for each struct rad_eye.  */
#ifndef RAD_TONE_EYE_H
#define RAD_TONE_EYE_H

#include "image/hdr.h"
#include "tone/human.h"
#include "picture/view.h"

/* A picture and its foveal samples. */
struct rad_eye;

/* The picture is borrowed.  view: set up, or NULL.  partial: black pixels are
 * not rendered yet; they do not count and stay black.  NULL: memory is out, and
 * *err is set. */
struct rad_eye *rad_eye_new(const struct rad_picture *pic,
                            const struct rad_view *view, bool partial,
                            struct rad_error *err);
void rad_eye_free(struct rad_eye *e);

/* Adapt to the picture; false: nothing in it can be seen. */
bool rad_eye_fit(struct rad_eye *e, struct rad_human *h);

/* Prepare what *h needs for rows: veil and acuity.  *h may have been fitted to
 * another picture.  RAD_ENOMEM. */
int rad_eye_open(struct rad_eye *e, const struct rad_human *h,
                 struct rad_error *err);

/* Row y as the light of a screen; channels may be above 1. */
void rad_eye_row(struct rad_eye *e, const struct rad_human *h, int y,
                 struct rad_rgb *out);

/* Likewise a radiance within pixel (x, y), without what acuity loses. */
struct rad_rgb rad_eye_colour(const struct rad_eye *e,
                              const struct rad_human *h, int x, int y,
                              struct rad_rgb L);

#endif
