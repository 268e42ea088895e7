/* screen.h - a picture as a PNG for a screen
 *
 * Thread: any. */
#ifndef RAD_TONE_SCREEN_H
#define RAD_TONE_SCREEN_H

#include "tone/tone.h"

struct rad_screen {
    struct rad_tone_options tone;
    int bits; /* of a channel: 8 or 16 */
};

/* The defaults: photographic, automatic exposure, 8 bits. */
void rad_screen_init(struct rad_screen *s);

/* Write the picture as an sRGB PNG; *tone and view are those of
 * rad_toner_init().  RAD_ENOMEM, or the sink's failure. */
int rad_screen_png(const struct rad_screen *s, struct rad_tone *tone,
                   const struct rad_picture *pic, const struct rad_view *view,
                   const struct rad_sink *sink, struct rad_error *err);

#endif
