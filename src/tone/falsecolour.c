/* falsecolour.c - see falsecolour.h */
#include "config.h"

#include "tone/falsecolour.h"

#include "tone/legend.h"
#include "base/number.h"
#include "base/vec.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EFFICACY 179.0 /* [lm/W] */
#define LARGEST  0.69314718055994530942 /* largest difference: ln 2 */

#define LARGEST_VALUE 1e40 /* replaces larger values and infinity */
#define AUTO_DECADES 3
#define DIVISIONS    10
#define BRIGHTER     1e-3 /* share of pixels that may exceed an automatic top */

/* Colours along a scale from 0 to 1, evenly spaced. */
struct ramp {
    int n;
    uint8_t stop[7][3];
};

static const struct ramp luminance_ramp = {
    7,
    { { 10, 8, 60 }, { 40, 30, 160 }, { 20, 110, 180 }, { 20, 160, 110 },
      { 110, 200, 50 }, { 240, 220, 40 }, { 255, 255, 220 } }
};

static const struct ramp difference_ramp = {
    5,
    { { 20, 40, 160 }, { 110, 160, 220 }, { 200, 200, 200 },
      { 235, 150, 110 }, { 160, 20, 30 } }
};

static void
colour_at(const struct ramp *s, double t, uint8_t rgb[3])
{
    int i;

    t = !(t > 0) ? 0 : t < 1 ? t * (s->n - 1) : s->n - 1;
    i = t < s->n - 1 ? (int)t : s->n - 2;
    t -= i;
    for (int k = 0; k < 3; k++)
        rgb[k] = (uint8_t)(s->stop[i][k] * (1 - t) + s->stop[i + 1][k] * t +
                           .5);
}

/* --- the scale --- */

/* Skip "key=" at *at; false: it is not there. */
static bool
take_key(const char **at, const char *key)
{
    size_t n = strlen(key);

    if (strncmp(*at, key, n) != 0 || (*at)[n] != '=')
        return false;
    *at += n + 1;
    return true;
}

static bool
take_contour(struct rad_false_scale *s, const char *word)
{
    static const char *const words[] = { "none", "lines", "bands", "steps" };

    for (int i = 0; i < 4; i++)
        if (strcmp(word, words[i]) == 0) {
            s->contour = (enum rad_contour)i;
            return true;
        }
    return false;
}

/* Set the label, which may only have characters of the font. */
static bool
take_label(struct rad_false_scale *s, const char *text)
{
    size_t n = strlen(text);

    for (size_t i = 0; i < n; i++)
        if (text[i] < ' ' || text[i] > '~')
            return false;
    if (n == 0 || n > RAD_FALSE_LABEL)
        return false;
    memcpy(s->label, text, n + 1);
    return true;
}

static bool
take_part(struct rad_false_scale *s, const char *part, bool first)
{
    if (take_key(&part, "log"))
        return rad_parse_real(part, &s->decades) && s->decades >= 0 &&
               s->decades <= RAD_FALSE_DECADES;
    if (take_key(&part, "n"))
        return rad_parse_int(part, &s->divisions) && s->divisions >= 1 &&
               s->divisions <= RAD_FALSE_DIVISIONS;
    if (take_key(&part, "contour"))
        return take_contour(s, part);
    if (take_key(&part, "label"))
        return take_label(s, part);
    if (!first)
        return false;
    return strcmp(part, "auto") == 0 ||
           (rad_parse_real(part, &s->top) && s->top >= 1e-9 && s->top <= 1e15);
}

int
rad_false_parse(struct rad_false_scale *s, const char *text,
                struct rad_error *err)
{
    char part[80];
    bool first = true;

    *s = (struct rad_false_scale){ .decades = -1 };
    for (const char *at = text; at && *text; first = false) {
        size_t n = strcspn(at, ",");

        snprintf(part, sizeof part, "%.*s", (int)(n < 79 ? n : 79), at);
        if (!take_part(s, part, first))
            return rad_fail(err, RAD_EUSAGE,
                            "'%s' is no part of a scale: auto or a number of "
                            "cd/m2, log=DECADES (to %d), n=DIVISIONS (to %d), "
                            "contour=lines|bands|steps, label=TEXT (to %d)",
                            part, RAD_FALSE_DECADES, RAD_FALSE_DIVISIONS,
                            RAD_FALSE_LABEL);
        at = at[n] == ',' ? at + n + 1 : NULL;
    }
    return 0;
}

static double
value_of(struct rad_rgb L)
{
    double v = EFFICACY * (double)rad_rgb_lum(L);

    return v > 0 ? fmin(v, LARGEST_VALUE) : 0; /* NaN is 0 */
}

/* Bins of values by logarithm, each 1/16 of an octave. */
enum { PER_OCTAVE = 16, OCTAVES = 256, BINS = PER_OCTAVE * OCTAVES };

static int
bin_of(double value)
{
    double b = (log2(value) + OCTAVES / 2) * PER_OCTAVE;

    return b < 0 ? 0 : b < BINS ? (int)b : BINS - 1;
}

/* The value that a share BRIGHTER of the pixels exceed, to the width of a bin;
 * 0: all pixels are black. */
static double
brightest(const struct rad_picture *pic)
{
    size_t n = rad_picture_pixels(pic), above = 0, bin[BINS] = { 0 };
    int i = BINS;

    for (size_t k = 0; k < n; k++) {
        double v = value_of(pic->L[k]);

        if (v > 0 && v < LARGEST_VALUE)
            bin[bin_of(v)]++;
    }
    while (i > 0 && (double)above <= BRIGHTER * (double)n)
        above += bin[--i];
    return above > 0 ? exp2((i + 1.) / PER_OCTAVE - OCTAVES / 2) : 0;
}

/* Round numbers, to be multiplied by powers of ten. */
static const double steps[] = { 1, 2, 5 };

/* The least of 1, 2, 5 or 10 times a power of ten that is not below v. */
static double
round_up(double v)
{
    double power = pow(10, floor(log10(v)));

    for (int i = 0; i < 3; i++)
        if (steps[i] * power >= v * (1 - 1e-9)) /* rounding of the power */
            return steps[i] * power;
    return 10 * power;
}

bool
rad_false_fit(struct rad_false_scale *s, const struct rad_picture *pic)
{
    bool by_itself = s->top == 0;
    double most = by_itself ? brightest(pic) : s->top;

    if (s->label[0] == '\0')
        strcpy(s->label, pic->irradiance ? "lux" : "cd/m2");
    if (s->decades < 0)
        s->decades = by_itself ? AUTO_DECADES : 0;
    if (most > 0 && by_itself)
        s->top = round_up(most);
    return s->top > 0;
}

/* The place of a value on the scale; values below the scale have place 0. */
static double
place_of(const struct rad_false_scale *s, double value)
{
    double v = value / s->top;

    if (!(s->decades > 0))
        return v;
    return v > pow(10, -s->decades) ? log10(v) / s->decades + 1 : 0;
}

static double
value_at(const struct rad_false_scale *s, double place)
{
    return s->decades > 0 ? s->top * pow(10, (place - 1) * s->decades)
                          : s->top * place;
}

/* --- colours --- */

struct drawing {
    struct rad_false_scale scale;
    const struct rad_picture *pic;
    struct rad_legend legend; /* its ticks part the divisions */
};

/* Where division i, counted from 0, begins.  A division above the last tick is
 * as wide as the one below. */
static double
start_of(const struct rad_legend *l, int i)
{
    if (i <= l->nticks)
        return i > 0 ? l->tick[i - 1].at : 0;
    return 2 * start_of(l, i - 1) - start_of(l, i - 2);
}

/* How many divisions place v is above the scale's beginning.  The division
 * above the last tick has no end. */
static double
divisions_to(const struct rad_legend *l, double v)
{
    double from;
    int i = 0;

    while (i < l->nticks && v >= l->tick[i].at)
        i++;
    from = start_of(l, i);
    return i + rad_least((v - from) / (start_of(l, i + 1) - from), .999);
}

static void
scale_colour(const void *arg, double v, uint8_t rgb[3])
{
    const struct drawing *d = arg;

    v = v < 1 ? v : nextafter(1, 0);
    if (d->scale.contour == RAD_CONTOUR_STEPS) {
        int i = (int)divisions_to(&d->legend, v);

        v = (start_of(&d->legend, i) + start_of(&d->legend, i + 1)) / 2;
    }
    colour_at(&luminance_ramp, v, rgb);
}

/* Is a place so many divisions up within half a division of a contour?  There
 * is no contour at 0. */
static bool
near_contours(const struct rad_legend *l, double up)
{
    return up >= .5 && up < l->nticks + .5;
}

static bool
in_band(const struct rad_legend *l, double up)
{
    double part = up - floor(up);

    return near_contours(l, up) && (part <= .1 || part >= .9);
}

static double
place_at(const struct drawing *d, int x, int y)
{
    int w = d->pic->width, h = d->pic->height;

    x = x < 0 ? 0 : x < w ? x : w - 1;
    y = y < 0 ? 0 : y < h ? y : h - 1;
    return place_of(&d->scale,
                    value_of(d->pic->L[(size_t)y * (size_t)w + (size_t)x]));
}

static double
divisions_at(const struct drawing *d, int x, int y)
{
    return divisions_to(&d->legend, place_at(d, x, y));
}

/* Is there a contour between the neighbours of a pixel so many divisions up? */
static bool
on_line(const struct drawing *d, int x, int y, double up)
{
    return near_contours(&d->legend, up) &&
           (floor(divisions_at(d, x - 1, y)) !=
                floor(divisions_at(d, x + 1, y)) ||
            floor(divisions_at(d, x, y - 1)) !=
                floor(divisions_at(d, x, y + 1)));
}

/* The colour of the contour nearest to a place so many divisions up.  The
 * contours' colours spread over the whole ramp. */
static void
contour_colour(const struct rad_legend *l, double up, uint8_t rgb[3])
{
    double first = start_of(l, 1), last = start_of(l, l->nticks);
    double at = start_of(l, (int)floor(up + .5));

    colour_at(&luminance_ramp, last > first ? (at - first) / (last - first) : 1,
              rgb);
}

static void
pixel_colour(const struct drawing *d, int x, int y, uint8_t rgb[3])
{
    enum rad_contour contour = d->scale.contour;
    double gamma = d->scale.decades > 0 ? 1 : 1 / 2.2;
    double v = place_at(d, x, y), up;

    if (contour == RAD_CONTOUR_NONE || contour == RAD_CONTOUR_STEPS) {
        scale_colour(d, v, rgb);
        return;
    }
    up = divisions_to(&d->legend, v);
    if (contour == RAD_CONTOUR_LINES ? on_line(d, x, y, up)
                                     : in_band(&d->legend, up))
        contour_colour(&d->legend, up, rgb);
    else /* half as bright as white, so that contours stand out */
        memset(rgb, (int)(128 * pow(v < 1 ? v : 1, gamma)), 3);
}

/* --- legends --- */

/* Four digits, or whole numbers: daylight has tens of thousands of lux. */
static void
write_value(char text[RAD_LEGEND_TEXT], double v)
{
    if (v >= 1e3 && v < 1e6)
        snprintf(text, RAD_LEGEND_TEXT, "%.0f", v);
    else if (v >= 1e-3 && v < 1e3)
        snprintf(text, RAD_LEGEND_TEXT, "%.4g", v);
    else
        snprintf(text, RAD_LEGEND_TEXT, "%.2g", v);
}

/* Set a tick at each division; not at 0 if the scale has contours or is
 * logarithmic. */
static void
tick_divisions(const struct rad_false_scale *s, struct rad_legend *l)
{
    for (int i = s->contour != RAD_CONTOUR_NONE || s->decades > 0;
         i <= s->divisions; i++) {
        struct rad_legend_tick *t = &l->tick[l->nticks++];

        t->at = (double)i / s->divisions;
        write_value(t->text, value_at(s, t->at));
    }
}

/* Set ticks of a logarithmic scale at 1, 2 and 5 times powers of ten, or only
 * at powers of ten if there are many; not at 0 if the scale has contours. */
static void
tick_powers(const struct rad_false_scale *s, struct rad_legend *l)
{
    double least = s->contour != RAD_CONTOUR_NONE ? 1e-9 : -1e-9;
    int few = s->decades > 3 ? 1 : 3;
    int first = (int)floor(log10(s->top) - s->decades) - 1;

    for (int k = first; k <= first + RAD_FALSE_DECADES + 2; k++)
        for (int i = 0; i < few; i++) {
            double v = steps[i] * pow(10, k), at;
            struct rad_legend_tick *t = &l->tick[l->nticks];

            at = 1 + log10(v / s->top) / s->decades;
            if (at < least || at > 1 + 1e-9 || l->nticks == RAD_LEGEND_TICKS)
                continue;
            t->at = at < 0 ? 0 : at < 1 ? at : 1;
            write_value(t->text, v);
            l->nticks++;
        }
}

/* A scale that is too short for round numbers has divisions. */
static void
set_ticks(struct rad_false_scale *s, struct rad_legend *l)
{
    bool contours = s->contour != RAD_CONTOUR_NONE;

    if (s->decades > 0 && !(contours && (s->divisions > 0 || s->decades < 1)))
        tick_powers(s, l);
    else {
        s->divisions = s->divisions > 0 ? s->divisions : DIVISIONS;
        tick_divisions(s, l);
    }
}

int
rad_false_colour(const struct rad_false_scale *scale,
                 const struct rad_picture *pic, struct rad_image *out,
                 struct rad_error *err)
{
    struct drawing d = { .scale = *scale, .pic = pic };
    struct rad_false_scale *s = &d.scale;
    int rc;

    s->top = s->top > 0 ? s->top : 1;
    s->decades = s->decades > 0 ? s->decades : 0;
    d.legend.title = s->label;
    d.legend.colour = scale_colour;
    d.legend.arg = &d;
    set_ticks(s, &d.legend);
    rc = rad_legend_image(&d.legend, pic->width, pic->height, out, err);
    for (int y = 0; rc == 0 && y < pic->height; y++)
        for (int x = 0; x < pic->width; x++) {
            uint8_t rgb[3];

            pixel_colour(&d, x, y, rgb);
            rad_image_pixel(out, x, y, rgb);
        }
    return rc;
}

static void
difference_colour(const void *arg, double at, uint8_t rgb[3])
{
    (void)arg;
    colour_at(&difference_ramp, at, rgb);
}

static void
tick_ratios(struct rad_legend *l)
{
    static const struct {
        double ratio;
        const char *text;
    } ratios[] = { { .5, "x 0.5" },   { 1 / 1.5, "x 0.67" }, { .8, "x 0.8" },
                   { 1 / 1.1, "x 0.91" }, { 1, "x 1" },      { 1.1, "x 1.1" },
                   { 1.25, "x 1.25" }, { 1.5, "x 1.5" },     { 2, "x 2" } };

    for (size_t i = 0; i < sizeof ratios / sizeof ratios[0]; i++) {
        struct rad_legend_tick *t = &l->tick[l->nticks++];

        t->at = .5 + log(ratios[i].ratio) / (2 * LARGEST);
        snprintf(t->text, sizeof t->text, "%s", ratios[i].text);
    }
}

int
rad_difference_map(const struct rad_picture *test,
                   const struct rad_picture *ref, struct rad_image *out,
                   struct rad_error *err)
{
    struct rad_legend l = { .title = "test/ref",
                            .colour = difference_colour };
    size_t n = rad_picture_pixels(ref);
    double mean = 0;
    int rc;

    tick_ratios(&l);
    rc = rad_legend_image(&l, ref->width, ref->height, out, err);
    if (rc < 0)
        return rc;
    for (size_t i = 0; i < n; i++)
        mean += (double)rad_rgb_lum(ref->L[i]) / (double)n;
    for (int y = 0; y < ref->height; y++)
        for (int x = 0; x < ref->width; x++) {
            size_t i = (size_t)y * (size_t)ref->width + (size_t)x;
            double e = 1e-3 * mean; /* as in metric.h */
            double a = rad_rgb_lum(test->L[i]) + e;
            double b = rad_rgb_lum(ref->L[i]) + e;
            uint8_t rgb[3];

            colour_at(&difference_ramp, .5 + log(a / b) / (2 * LARGEST), rgb);
            rad_image_pixel(out, x, y, rgb);
        }
    return 0;
}
