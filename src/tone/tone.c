/* tone.c - see tone.h */
#include "config.h"

#include "tone/tone.h"

#include <math.h>
#include <string.h>

/* Scaled log-average luminance.  It is above the 18 % of photography, since the
 * compression takes some of it away. */
#define MIDDLE_GREY .25
/* White, where exposure is absolute: four stops above middle grey. */
#define FIXED_WHITE (16 * MIDDLE_GREY)

/* pfilt(1): the mean that it aims at, and values too bright to count for it. */
#define MEAN_BRIGHTNESS .5
#define HOT             100

/* The saturation that the brightest colours keep.  With less, a red rug in the
 * sun is pink; with more, it is a flat patch. */
#define LEAST_SATURATION .5

/* Bins of luminance: each is 1/16 of a factor of 2, and the first is at
 * 2^-64. */
enum { STEPS = 16, LOWEST = -64, NBINS = 128 * STEPS };

/* The pixels in a range of luminance, and the sum of their log2 luminances. */
struct bin {
    size_t count;
    double logs;
};

/* --- photographic --- */

static size_t
fill_bins(struct bin bins[NBINS], const struct rad_picture *pic)
{
    size_t n = rad_picture_pixels(pic), counted = 0;

    for (size_t i = 0; i < n; i++) {
        float lum = rad_rgb_lum(pic->L[i]);

        if (lum > 0 && lum < INFINITY) {
            double l = log2((double)lum);
            int k = (int)((l - LOWEST) * STEPS);

            k = k < 0 ? 0 : k < NBINS ? k : NBINS - 1;
            bins[k].count++;
            bins[k].logs += l;
            counted++;
        }
    }
    return counted;
}

/* The first bin up to which a share of the n counted pixels lie. */
static int
percentile(const struct bin bins[NBINS], size_t n, double share)
{
    size_t sum = 0;
    int i = 0;

    for (; i < NBINS - 1; i++)
        if ((double)(sum += bins[i].count) >= share * (double)n)
            break;
    return i;
}

/* Equation 1, with both ends cut off, and equation 4's white. */
static bool
fit_photographic(struct rad_tone *t, const struct rad_picture *pic)
{
    struct bin bins[NBINS] = { { 0 } };
    size_t n = fill_bins(bins, pic);
    double sum = 0, least, most;
    int lo, hi;

    if (n == 0)
        return false;
    /* the darkest and brightest hundredths do not matter to viewers */
    lo = percentile(bins, n, .01);
    hi = percentile(bins, n, .99);
    least = bins[lo].logs / (double)bins[lo].count;
    most = bins[hi].logs / (double)bins[hi].count;
    for (int i = 0; i < NBINS; i++)
        sum += i < lo   ? (double)bins[i].count * least
               : i > hi ? (double)bins[i].count * most
                        : bins[i].logs;
    t->scale = MIDDLE_GREY / exp2(sum / (double)n);
    /* from four to forty times the average */
    t->white = t->scale * exp2(most);
    t->white = fmin(fmax(t->white, 4 * MIDDLE_GREY), 40 * MIDDLE_GREY);
    return true;
}

/* Equation 4, for scaled luminance. */
static double
photographic(double in, double white)
{
    return in < white ? in * (1 + in / (white * white)) / (1 + in) : 1;
}

/* In double, since the scale may exceed the range of float. */
static struct rad_rgb
scaled(struct rad_rgb L, double s)
{
    return rad_rgb((float)(L.r * s), (float)(L.g * s), (float)(L.b * s));
}

static struct rad_rgb
photographic_pixel(const struct rad_tone *t, struct rad_rgb L)
{
    double lum = rad_rgb_lum(L), in = lum * t->scale;

    if (!(in > 0))
        return rad_grey(0);
    return rad_tone_fit_gamut(scaled(L, photographic(in, t->white) / lum));
}

/* --- linear --- */

/* The mean luminance of pixels that are not black and, if there are any such,
 * not too bright. */
static bool
fit_linear(struct rad_tone *t, const struct rad_picture *pic)
{
    double sum = 0, hot_sum = 0;
    size_t n = 0, nhot = 0, all = rad_picture_pixels(pic);

    for (size_t i = 0; i < all; i++) {
        float lum = rad_rgb_lum(pic->L[i]);

        if (lum > 0 && lum < HOT) {
            sum += (double)lum;
            n++;
        } else if (lum > 0 && lum < INFINITY) {
            hot_sum += (double)lum;
            nhot++;
        }
    }
    if (n == 0 && nhot == 0)
        return false;
    t->scale =
        MEAN_BRIGHTNESS / (n > 0 ? sum / (double)n : hot_sum / (double)nhot);
    return true;
}

static struct rad_rgb
linear_pixel(const struct rad_tone *t, struct rad_rgb L)
{
    /* the product of large radiance and scale may exceed the range of float */
    double most = rad_rgb_max(L) * t->scale;
    double s = most < 1e30 ? t->scale : t->scale * 1e30 / most;

    return rad_tone_fit_gamut(scaled(L, s));
}

/* --- all --- */

struct rad_rgb
rad_tone_fit_gamut(struct rad_rgb c)
{
    float most = rad_rgb_max(c), lum, m, s, Y;

    if (most <= 1)
        return c;
    lum = rad_rgb_lum(c);
    m = most / lum;
    s = (float)LEAST_SATURATION + (1 - (float)LEAST_SATURATION) / most;
    /* Y (1 + s (m - 1)) = 1: luminance does not increase */
    Y = 1 / (1 + s * (m - 1));
    return rad_rgb(Y * (1 + s * (c.r / lum - 1)), Y * (1 + s * (c.g / lum - 1)),
                   Y * (1 + s * (c.b / lum - 1)));
}

bool
rad_tone_looks(const struct rad_tone_options *o)
{
    return !o->absolute || o->curve == RAD_TONE_HUMAN;
}

static bool
fit(struct rad_tone *t, const struct rad_toner *m)
{
    const struct rad_tone_options *o = &m->o;

    t->scale = t->white = 1;
    if (!rad_tone_looks(o)) {
        t->scale = o->exposure;
        t->white = FIXED_WHITE;
        return true;
    }
    switch (o->curve) {
    case RAD_TONE_LINEAR:
        t->fitted = fit_linear(t, m->pic);
        break;
    case RAD_TONE_HUMAN:
        t->fitted = rad_eye_fit(m->eye, &t->human);
        if (o->absolute)
            rad_human_linear(&t->human, 1);
        break;
    default:
        t->fitted = fit_photographic(t, m->pic);
    }
    t->scale *= o->exposure;
    return t->fitted;
}

int
rad_toner_init(struct rad_toner *t, const struct rad_tone_options *o,
               struct rad_tone *tone, const struct rad_picture *pic,
               const struct rad_view *view, struct rad_error *err)
{
    memset(t, 0, sizeof *t);
    t->o = *o;
    t->pic = pic;
    if (o->curve == RAD_TONE_HUMAN &&
        !(t->eye = rad_eye_new(pic, view, o->partial, err)))
        return err ? err->code : RAD_ENOMEM;
    if (!tone->fitted)
        tone->fitted = fit(tone, t);
    t->tone = *tone;
    return t->eye ? rad_eye_open(t->eye, &t->tone.human, err) : 0;
}

void
rad_toner_release(struct rad_toner *t)
{
    rad_eye_free(t->eye);
    memset(t, 0, sizeof *t);
}

/* A colour, for human as the eye sees it, as the light of a screen. */
static struct rad_rgb
shown(const struct rad_toner *t, struct rad_rgb L)
{
    return t->o.curve == RAD_TONE_PHOTOGRAPHIC ? photographic_pixel(&t->tone, L)
                                               : linear_pixel(&t->tone, L);
}

/* Likewise a colour within pixel (x, y). */
static struct rad_rgb
shown_within(const struct rad_toner *t, int x, int y, struct rad_rgb L)
{
    return shown(t,
                 t->eye ? rad_eye_colour(t->eye, &t->tone.human, x, y, L) : L);
}

/* Where a pixel has an edge, the mean of what is shown of its two sides; but
 * not to an eye that sees no detail of a pixel's size. */
static void
show_edges(const struct rad_toner *t, int y, struct rad_rgb *out)
{
    bool blurred = t->o.curve == RAD_TONE_HUMAN && t->tone.human.acuity;
    int n = blurred ? 0 : rad_edges_count(&t->pic->edges, y);

    for (int i = 0; i < n; i++) {
        struct rad_edge e;

        rad_edges_get(&t->pic->edges, y, i, &e);
        out[e.x] = rad_rgb_add(
            rad_rgb_scale(shown_within(t, e.x, y, e.bright), e.share),
            rad_rgb_scale(shown_within(t, e.x, y, e.dark), 1 - e.share));
    }
}

void
rad_toner_row(struct rad_toner *t, int y, struct rad_rgb *out)
{
    int width = t->pic->width;
    const struct rad_rgb *L = t->pic->L + (size_t)y * (size_t)width;

    if (t->eye) {
        rad_eye_row(t->eye, &t->tone.human, y, out);
        L = out;
    }
    for (int x = 0; x < width; x++)
        out[x] = shown(t, L[x]);
    show_edges(t, y, out);
}
