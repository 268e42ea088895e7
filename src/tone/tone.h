/* tone.h - from radiance to the light of a screen
 *
 * Three curves.
 *   photographic  Reinhard et al.'s global operator: the log-average luminance
 *                 comes to a middle grey, and what is much brighter is bent
 *                 below white by a shoulder, so that lamps and windows keep
 *                 some shape in interiors and skies do not burn out by day
 *   linear        a factor and nothing else, by itself that of pfilt(1)
 *   human         what an eye that is adapted to the scene sees; see human.h
 *
 * All work on luminance: the three channels of a pixel get one factor.  Where
 * that brings one of them beyond what a screen can show, the pixel keeps its
 * hue and gives up brightness and saturation together: rad_tone_fit_gamut().
 *
 * Photographic is the default, since it needs no absolute units (a sky of any
 * brightness will do) and shows what linear burns out.  Its key and its white
 * are robust forms of the paper's: black pixels and the darkest and brightest
 * hundredths do not count, so that one lamp in view does not change the walls;
 * white is where the brightest hundredth begins, not the brightest pixel.
 *
 * Exposure is a factor of the curve's own, automatic one, or, if it is
 * absolute, of radiance itself: then equal radiances of two pictures have equal
 * colours.
 * The light of a screen is linear, from 0 to 1, in sRGB's primaries, for which
 * those of the picture are taken: see primaries.h.
 * Sources: Reinhard, Stark, Shirley & Ferwerda 2002, Photographic tone
 * reproduction for digital images (equations 1, 2 and 4); pfilt(1).
 * Thread: one for each struct rad_toner.  */
#ifndef RAD_PICTURE_TONE_H
#define RAD_PICTURE_TONE_H

#include "tone/eye.h"
#include "image/hdr.h"
#include "picture/view.h"

enum rad_tone_curve { RAD_TONE_PHOTOGRAPHIC, RAD_TONE_LINEAR, RAD_TONE_HUMAN };

struct rad_tone_options {
    enum rad_tone_curve curve;
    bool absolute;   /* exposure is of radiance, not of the automatic one */
    double exposure; /* above 0 */
    bool partial;    /* black pixels are such as are still to come */
};

/* What a picture says of how it is shown, and others of the same animation. */
struct rad_tone {
    bool fitted;
    double scale; /* of radiance, where the curve is straight */
    double white; /* photographic: scaled luminance that becomes 1 */
    struct rad_human human;
};

/* Does fitting look at the picture? */
bool rad_tone_looks(const struct rad_tone_options *o);

/* A picture on its way to a screen. */
struct rad_toner {
    struct rad_tone_options o;
    struct rad_tone tone;
    const struct rad_picture *pic;
    struct rad_eye *eye; /* human */
};

/* Begin.  A tone that is not fitted yet is fitted to the picture, unless all of
 * it is black; one that is serves as it is.  view: set up; NULL: unknown.
 * RAD_ENOMEM; *t can be released then too.  The picture is borrowed. */
int rad_toner_init(struct rad_toner *t, const struct rad_tone_options *o,
                   struct rad_tone *tone, const struct rad_picture *pic,
                   const struct rad_view *view, struct rad_error *err);
void rad_toner_release(struct rad_toner *t);

/* Row y, from the top, as the light of a screen. */
void rad_toner_row(struct rad_toner *t, int y, struct rad_rgb *out);

/* Bring a colour that is not negative within the screen's: one that a channel
 * leads beyond 1 goes to where the largest is 1.  The saturation that it keeps
 * falls from all to half as that channel rises, and luminance gives way: a
 * bright red comes out light red, not white and not orange. */
struct rad_rgb rad_tone_fit_gamut(struct rad_rgb c);

#endif
