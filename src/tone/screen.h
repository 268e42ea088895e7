/* screen.h - a picture as a screen shows it, in a PNG
 *
 * Thread: any. */
#ifndef RAD_PICTURE_SCREEN_H
#define RAD_PICTURE_SCREEN_H

#include "tone/tone.h"

struct rad_screen {
    struct rad_tone_options tone;
    int bits; /* of a channel: 8 or 16 */
};

/* Photographic, its own exposure, 8 bits. */
void rad_screen_init(struct rad_screen *s);

/* Write the picture as an sRGB PNG; *tone and view as rad_toner_init() has
 * them.  RAD_ENOMEM, or what the sink returns. */
int rad_screen_png(const struct rad_screen *s, struct rad_tone *tone,
                   const struct rad_picture *pic, const struct rad_view *view,
                   const struct rad_sink *sink, struct rad_error *err);

#endif
