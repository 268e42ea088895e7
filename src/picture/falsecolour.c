/* falsecolour.c - see falsecolour.h
 *
 * The legend is a bar of the scale with numbers in a font of 3 by 5 dots, each
 * SCALE pixels wide. */
#include "config.h"

#include "picture/falsecolour.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EFFICACY 179.0 /* [lm/W] */
#define DECADES  3
#define LARGEST  0.69314718055994530942 /* ln 2 */

enum {
    SCALE = 2,            /* pixels of a font's dot */
    GLYPH_W = 4 * SCALE,  /* with the gap behind */
    GLYPH_H = 5 * SCALE,
    BAR_W = 16,
    MARGIN = 8,
    MOST_LETTERS = 7,
    LEGEND_W = MARGIN + BAR_W + MARGIN + MOST_LETTERS * GLYPH_W,
    LEAST_H = 8 * GLYPH_H, /* of a picture, for its legend to fit */
    NTICKS = 7
};

/* Rows of three dots, the top row first. */
static const struct {
    char letter;
    const char *dots;
} font[] = {
    { '0', "### #.# #.# #.# ###" }, { '1', ".#. ##. .#. .#. ###" },
    { '2', "### ..# ### #.. ###" }, { '3', "### ..# ### ..# ###" },
    { '4', "#.# #.# ### ..# ..#" }, { '5', "### #.. ### ..# ###" },
    { '6', "### #.. ### #.# ###" }, { '7', "### ..# ..# ..# ..#" },
    { '8', "### #.# ### #.# ###" }, { '9', "### #.# ### ..# ###" },
    { '.', "... ... ... ... .#." }, { '-', "... ... ### ... ..." },
    { '+', "... .#. ### .#. ..." }, { 'e', "... ### ##. #.. ###" },
    { 'x', "... #.# .#. #.# ..." },
};

/* Colours along a scale from 0 to 1, evenly spaced. */
struct scale {
    int n;
    uint8_t stop[7][3];
};

static const struct scale luminance_scale = {
    7,
    { { 10, 8, 60 }, { 40, 30, 160 }, { 20, 110, 180 }, { 20, 160, 110 },
      { 110, 200, 50 }, { 240, 220, 40 }, { 255, 255, 220 } }
};

static const struct scale difference_scale = {
    5,
    { { 20, 40, 160 }, { 110, 160, 220 }, { 200, 200, 200 },
      { 235, 150, 110 }, { 160, 20, 30 } }
};

static void
colour_at(const struct scale *s, double t, uint8_t rgb[3])
{
    int i;

    t = !(t > 0) ? 0 : t < 1 ? t * (s->n - 1) : s->n - 1;
    i = t < s->n - 1 ? (int)t : s->n - 2;
    t -= i;
    for (int k = 0; k < 3; k++)
        rgb[k] = (uint8_t)(s->stop[i][k] * (1 - t) + s->stop[i + 1][k] * t +
                           .5);
}

static void
put_pixel(struct rad_image *m, int x, int y, const uint8_t rgb[3])
{
    if (x >= 0 && y >= 0 && x < m->width && y < m->height)
        memcpy(m->rgb + 3 * ((size_t)y * (size_t)m->width + (size_t)x), rgb,
               3);
}

static void
fill(struct rad_image *m, int x0, int y0, int w, int h, const uint8_t rgb[3])
{
    for (int y = y0; y < y0 + h; y++)
        for (int x = x0; x < x0 + w; x++)
            put_pixel(m, x, y, rgb);
}

static void
put_text(struct rad_image *m, int x, int y, const char *text)
{
    static const uint8_t white[3] = { 255, 255, 255 };

    for (; *text; text++, x += GLYPH_W)
        for (size_t i = 0; i < sizeof font / sizeof font[0]; i++)
            for (int k = 0; font[i].letter == *text && k < 19; k++)
                if (font[i].dots[k] == '#')
                    fill(m, x + k % 4 * SCALE, y + k / 4 * SCALE, SCALE, SCALE,
                         white);
}

/* The bar beside a picture of width columns, with the numbers of value(). */
static void
put_legend(struct rad_image *m, int width, const struct scale *s,
           void (*label)(double t, double top, char *buf, size_t size),
           double top)
{
    int x = width + MARGIN, h = m->height - 2 * GLYPH_H;
    uint8_t rgb[3];

    for (int y = 0; y < h; y++) {
        colour_at(s, 1 - y / (h - 1.), rgb);
        fill(m, x, y + GLYPH_H, BAR_W, 1, rgb);
    }
    for (int i = 0; i < NTICKS; i++) {
        double t = (double)i / (NTICKS - 1);
        char buf[32];

        label(t, top, buf, sizeof buf);
        buf[MOST_LETTERS] = '\0';
        put_text(m, x + BAR_W + MARGIN,
                 (int)((1 - t) * (h - 1)) + GLYPH_H / 2, buf);
    }
}

static int
image_new(struct rad_image *m, int width, int height, struct rad_error *err)
{
    m->width = width + LEGEND_W;
    m->height = height > LEAST_H ? height : LEAST_H;
    m->rgb = calloc((size_t)m->width * (size_t)m->height, 3);
    return m->rgb ? 0 : rad_fail(err, RAD_ENOMEM, "out of memory");
}

static void
luminance_label(double t, double top, char *buf, size_t size)
{
    double v = top * pow(10, DECADES * (t - 1));

    if (v >= 10 && v < 1e6)
        snprintf(buf, size, "%.0f", v);
    else
        snprintf(buf, size, "%.2g", v);
}

int
rad_false_colour(const struct rad_picture *pic, struct rad_image *out,
                 struct rad_error *err)
{
    double top = 0;
    int rc = image_new(out, pic->width, pic->height, err);

    if (rc < 0)
        return rc;
    for (size_t i = 0; i < (size_t)pic->width * (size_t)pic->height; i++) {
        float lum = rad_rgb_lum(pic->L[i]);

        if (lum < INFINITY)
            top = fmax(top, EFFICACY * lum);
    }
    if (!(top > 0))
        top = 1;
    for (int y = 0; y < pic->height; y++)
        for (int x = 0; x < pic->width; x++) {
            double lum = rad_rgb_lum(
                pic->L[(size_t)y * (size_t)pic->width + (size_t)x]);
            uint8_t rgb[3];

            colour_at(&luminance_scale,
                      1 + log10(EFFICACY * lum / top) / DECADES, rgb);
            put_pixel(out, x, y, rgb);
        }
    put_legend(out, pic->width, &luminance_scale, luminance_label, top);
    return 0;
}

static void
difference_label(double t, double top, char *buf, size_t size)
{
    snprintf(buf, size, "x%.2f", exp((2 * t - 1) * top));
}

int
rad_difference_map(const struct rad_picture *test,
                   const struct rad_picture *ref, struct rad_image *out,
                   struct rad_error *err)
{
    size_t n = (size_t)ref->width * (size_t)ref->height;
    double mean = 0;
    int rc = image_new(out, ref->width, ref->height, err);

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

            colour_at(&difference_scale, .5 + log(a / b) / (2 * LARGEST), rgb);
            put_pixel(out, x, y, rgb);
        }
    put_legend(out, ref->width, &difference_scale, difference_label, LARGEST);
    return 0;
}
