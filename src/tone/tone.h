/* tone.h - from radiance to the light of a screen
 *
 * There are three curves.
 *   photographic  Reinhard et al.'s global operator: the log-average luminance
 *                 becomes a middle grey, and much brighter luminances are
 *                 compressed below white, so that lamps and windows of a room
 *                 keep some shape, and daylit skies do not burn out
 *   linear        just a factor, which by default is pfilt(1)'s
 *   human         what an eye that is adapted to the scene sees; see human.h
 *
 * What meets within a pixel (image/edge.h) is shown by itself, and the pixel is
 * the mean of that.
 *
 * All curves work on luminance: the three channels of a pixel get one factor.
 * If that makes a channel brighter than a screen can show, the pixel keeps its
 * hue, and loses some brightness and saturation: rad_tone_fit_gamut().
 *
 * Photographic is the default, since it needs no absolute units (a sky may have
 * any brightness) and shows what the linear curve burns out.  Its key and its
 * white are robust forms of the paper's.  Black pixels do not count, and the
 * darkest and brightest hundredths are cut off, so that one lamp in view does
 * not darken the walls.  White is where the brightest hundredth begins, not the
 * brightest pixel.
 *
 * Exposure multiplies the curve's own automatic factor.  If it is absolute, it
 * multiplies radiance itself, and equal radiances in two pictures have equal
 * colours.
 * The light of a screen is linear, from 0 to 1, in sRGB's primaries, in which
 * the picture is assumed to be: see primaries.h.
 * Sources: Reinhard, Stark, Shirley & Ferwerda 2002, Photographic tone
 * reproduction for digital images (equations 1, 2 and 4); pfilt(1).
 * Thread: one for each struct rad_toner.  */
#ifndef RAD_TONE_TONE_H
#define RAD_TONE_TONE_H

#include "tone/eye.h"
#include "image/hdr.h"
#include "picture/view.h"

enum rad_tone_curve { RAD_TONE_PHOTOGRAPHIC, RAD_TONE_LINEAR, RAD_TONE_HUMAN };

struct rad_tone_options {
    enum rad_tone_curve curve;
    bool absolute;   /* exposure multiplies radiance itself */
    double exposure; /* above 0 */
    bool partial;    /* black pixels are not rendered yet */
};

/* How a picture is shown; all pictures of an animation may share it. */
struct rad_tone {
    bool fitted;
    double scale; /* factor of radiance */
    double white; /* photographic: scaled luminance that becomes 1 */
    struct rad_human human;
};

/* Does fitting need the picture? */
bool rad_tone_looks(const struct rad_tone_options *o);

/* A picture that is converted for a screen. */
struct rad_toner {
    struct rad_tone_options o;
    struct rad_tone tone;
    const struct rad_picture *pic;
    struct rad_eye *eye; /* for human, else NULL */
};

/* Begin with a picture, which is borrowed.  *tone is fitted to it unless it is
 * fitted already; a black picture leaves it unfitted.  view: set up, or NULL:
 * unknown.  RAD_ENOMEM; *t can be released even then. */
int rad_toner_init(struct rad_toner *t, const struct rad_tone_options *o,
                   struct rad_tone *tone, const struct rad_picture *pic,
                   const struct rad_view *view, struct rad_error *err);
void rad_toner_release(struct rad_toner *t);

/* Row y, from the top, as the light of a screen. */
void rad_toner_row(struct rad_toner *t, int y, struct rad_rgb *out);

/* Bring a colour without negative channels into the screen's range.  A colour
 * with a channel above 1 is changed so that the largest is 1.  As that channel
 * rises, the saturation that the colour keeps falls from all to half, and its
 * luminance falls: a bright red becomes light red, not white and not orange. */
struct rad_rgb rad_tone_fit_gamut(struct rad_rgb c);

#endif
