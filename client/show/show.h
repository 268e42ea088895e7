/* show.h - how the pictures of a job are shown on a screen
 *
 * All frames of an animation have the same exposure: if it is chosen
 * automatically, that of the first frame that is not black.  An exposure that
 * changed from frame to frame would flicker, and brightness could not be
 * compared between frames.  The same holds for the scale of false colours,
 * which replace the tone curve.
 * Thread: one. */
#ifndef RADD_CLIENT_SHOW_H
#define RADD_CLIENT_SHOW_H

#include "base/error.h"
#include "tone/falsecolour.h"
#include "tone/screen.h"

/* the words of --tone, in the order of enum rad_tone_curve, and of --bits */
#define SHOW_TONES "photographic|linear|human"
#define SHOW_BITS  "8|16"
enum { SHOW_8_BITS, SHOW_16_BITS };

struct show {
    struct rad_screen screen;
    bool each;            /* each frame has its own exposure */
    struct rad_tone tone; /* fitted to the first frame */
    bool false_colour;
    struct rad_false_scale scale; /* for false_colour */
    bool scaled;                  /* tone or scale is settled */
};

/* Set the defaults. */
void show_init(struct show *s);

/* --exposure=[first,|each,]auto|+STOPS|-STOPS|FACTOR, or first or each alone.
 * RAD_EUSAGE. */
int show_exposure(struct show *s, const char *text, struct rad_error *err);

/* --tone, --bits.  RAD_EUSAGE. */
int show_tone(struct show *s, const char *word, struct rad_error *err);
int show_bits(struct show *s, const char *word, struct rad_error *err);

/* Which of these options are given: texts, or NULL. */
struct show_asked {
    bool tone, bits;
    const char *exposure, *false_colour;
};

/* Name the first option that is given; *name is NULL if none is.  RAD_EUSAGE:
 * it does not go with --false-colour. */
int show_first(const struct show_asked *a, const char **name,
               struct rad_error *err);

/* Take exposure and false_colour.  RAD_EUSAGE. */
int show_take(struct show *s, const struct show_asked *a,
              struct rad_error *err);

/* Will the first picture settle how frames are shown, and is not there yet? */
bool show_waits(const struct show *s);

/* Let a whole picture settle how frames are shown, unless it is black.
 * RAD_ENOMEM. */
int show_fit(struct show *s, const struct rad_picture *pic,
             const struct rad_view *view, struct rad_error *err);

/* Write a whole picture as PNG into the sink.  It settles how pictures are
 * shown if that is open, or if each frame does. */
int show_picture(struct show *s, const struct rad_picture *pic,
                 const struct rad_view *view, const struct rad_sink *sink,
                 struct rad_error *err);

/* What a preview keeps of the one before; zeroed for a new frame. */
struct show_last {
    struct rad_tone tone;
    struct rad_false_scale scale;
    size_t seen; /* pixels with light when tone or scale was fitted */
};

/* Write a picture that is not whole, or even empty; *s does not change.  If the
 * exposure is not settled it is fitted to the pixels that exist, and fitted
 * again when they have doubled, and at the end: a preview whose brightness
 * changed with each row would flicker. */
int show_preview(const struct show *s, struct show_last *last,
                 const struct rad_picture *pic, const struct rad_view *view,
                 const struct rad_sink *sink, struct rad_error *err);

#endif
