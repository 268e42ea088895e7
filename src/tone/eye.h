/* eye.h - a picture as an eye sees it: foveal samples, veil, acuity, colour
 *
 * human.h has the model, this what it needs of a picture.
 * Sources: as there; Moon & Spencer 1945 (veil).
 * Thread: one for each struct rad_eye.  */
#ifndef RAD_PICTURE_EYE_H
#define RAD_PICTURE_EYE_H

#include "image/hdr.h"
#include "tone/human.h"
#include "picture/view.h"

/* A picture and its foveal samples. */
struct rad_eye;

/* partial: black pixels count nowhere and stay black.  view: set up, or NULL.
 * The picture is borrowed.  NULL: RAD_ENOMEM. */
struct rad_eye *rad_eye_new(const struct rad_picture *pic,
                            const struct rad_view *view, bool partial,
                            struct rad_error *err);
void rad_eye_free(struct rad_eye *e);

/* Adapt to the picture.  false: nothing of it can be seen. */
bool rad_eye_fit(struct rad_eye *e, struct rad_human *h);

/* Before rows: what *h has of veil and acuity; h may come from another picture.
 * RAD_ENOMEM. */
int rad_eye_open(struct rad_eye *e, const struct rad_human *h,
                 struct rad_error *err);

/* Row y, in the screen's light: channels may be beyond 1. */
void rad_eye_row(struct rad_eye *e, const struct rad_human *h, int y,
                 struct rad_rgb *out);

#endif
