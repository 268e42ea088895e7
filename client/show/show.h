/* show.h - how the pictures of a job are shown on a screen
 *
 * One exposure serves a whole animation: by itself that of its first frame that
 * is not black, since a walk whose exposure changes from frame to frame
 * flickers, and nobody could tell light from dark between two of its frames.
 * The same holds for the scale of false colours, which are shown in place of a
 * tone where they are asked for.
 * Thread: one.  */
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
    bool each;            /* every frame has an exposure of its own */
    struct rad_tone tone; /* the first frame's */
    bool false_colour;
    struct rad_false_scale scale; /* of it */
    bool scaled;                  /* the first frame has had its say */
};

/* The defaults. */
void show_init(struct show *s);

/* --exposure=[first,|each,]auto|+STOPS|-STOPS|FACTOR, or first or each alone.
 * RAD_EUSAGE. */
int show_exposure(struct show *s, const char *text, struct rad_error *err);

/* --tone, --bits.  RAD_EUSAGE. */
int show_tone(struct show *s, const char *word, struct rad_error *err);
int show_bits(struct show *s, const char *word, struct rad_error *err);

/* --false-colour=SCALE, as rad_false_parse() has it.  RAD_EUSAGE. */
int show_false(struct show *s, const char *scale, struct rad_error *err);

/* Does a frame wait for the first to say how it is shown? */
bool show_waits(const struct show *s);

/* Let a whole picture say it; RAD_ENOMEM.  One that is black says nothing. */
int show_fit(struct show *s, const struct rad_picture *pic,
             const struct rad_view *view, struct rad_error *err);

/* A whole picture as a PNG into the sink; it says how it is shown where none
 * has yet, or each does. */
int show_picture(struct show *s, const struct rad_picture *pic,
                 const struct rad_view *view, const struct rad_sink *sink,
                 struct rad_error *err);

/* What a preview remembers of the last one; zeroed for another frame. */
struct show_last {
    struct rad_tone tone;
    struct rad_false_scale scale;
    size_t seen; /* pixels when the tone or the scale was fitted */
};

/* A picture of which some may be there, or nothing at all: *s is not changed.
 * Its exposure is the first frame's, where that is known; else what is there
 * says it, and again when there is twice as much, and at the end: a preview
 * whose brightness changed with every row would flicker. */
int show_preview(const struct show *s, struct show_last *last,
                 const struct rad_picture *pic, const struct rad_view *view,
                 const struct rad_sink *sink, struct rad_error *err);

#endif
