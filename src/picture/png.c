/* png.c - see png.h */
#include "config.h"

#include "picture/png.h"

#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

/* Scaled log-average luminance: a little above the 18 % of photography, since
 * the shoulder takes some of it away. */
#define MIDDLE_GREY .25

/* Luminances are counted in steps of 1/16 of a factor of 2 from 2^-64 on. */
enum { STEPS = 16, LOWEST = -64, NBINS = 128 * STEPS };

static int
bin_of(double lum)
{
    int i = (int)((log2(lum) - LOWEST) * STEPS);

    return i < 0 ? 0 : i < NBINS ? i : NBINS - 1;
}

static double
lum_of(int bin)
{
    return exp2((bin + .5) / STEPS + LOWEST);
}

/* The bin that share of the n counted pixels lie in or below. */
static int
percentile(const size_t *count, size_t n, double share)
{
    size_t sum = 0;
    int i = 0;

    for (; i < NBINS - 1; i++)
        if ((sum += count[i]) >= share * (double)n)
            break;
    return i;
}

struct rad_tone
rad_tone_of(const struct rad_rgb *L, size_t n)
{
    struct rad_tone t = { 1, 1 };
    size_t count[NBINS] = { 0 }, counted = 0;
    double sum = 0;
    int lo, hi;

    for (size_t i = 0; i < n; i++) {
        float lum = rad_rgb_lum(L[i]);

        if (lum > 0 && lum < INFINITY) {
            count[bin_of((double)lum)]++;
            counted++;
        }
    }
    if (counted == 0)
        return t;
    /* the darkest and brightest hundredths are not what one looks at */
    lo = percentile(count, counted, .01);
    hi = percentile(count, counted, .99);
    for (int i = 0; i < NBINS; i++)
        sum += (double)count[i] * log(lum_of(i < lo ? lo : i > hi ? hi : i));
    t.scale = MIDDLE_GREY / exp(sum / (double)counted);
    /* white is what the brightest hundredth begins with, within four and
     * forty times the average */
    t.white = t.scale * lum_of(hi);
    t.white = fmin(fmax(t.white, 4 * MIDDLE_GREY), 40 * MIDDLE_GREY);
    return t;
}

uint8_t
rad_srgb(double v)
{
    if (!(v > 0))
        return 0;
    if (v >= 1)
        return 255;
    v = v <= .0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - .055;
    return (uint8_t)(v * 255 + .5);
}

void
rad_tone_map(const struct rad_tone *t, struct rad_rgb L, uint8_t rgb[3])
{
    double in = rad_rgb_lum(L) * t->scale, out;
    double c[3] = { L.r, L.g, L.b }, most, grey = 0;

    if (!(in > 0)) {
        rgb[0] = rgb[1] = rgb[2] = 0;
        return;
    }
    out = in < t->white ? in * (1 + in / (t->white * t->white)) / (1 + in) : 1;
    for (int i = 0; i < 3; i++)
        c[i] *= t->scale * out / in;
    /* a saturated light turns white rather than change its hue */
    most = fmax(c[0], fmax(c[1], c[2]));
    if (most > 1 && out < 1)
        grey = (most - 1) / (most - out);
    else if (out >= 1)
        grey = 1;
    for (int i = 0; i < 3; i++)
        rgb[i] = rad_srgb(c[i] + grey * (out - c[i]));
}

struct writer {
    const struct rad_sink *sink;
    struct rad_error *err;
    int rc;
};

static void
put(png_structp png, png_bytep data, png_size_t len)
{
    struct writer *w = png_get_io_ptr(png);

    w->rc = w->sink->write(w->sink->arg, data, len, w->err);
    if (w->rc < 0)
        png_error(png, "write failed");
}

static void
no_flush(png_structp png)
{
    (void)png;
}

static void
fail(png_structp png, png_const_charp message)
{
    struct writer *w = png_get_error_ptr(png);

    if (w->rc == 0)
        w->rc = rad_fail(w->err, RAD_EINTERNAL, "PNG: %s", message);
    png_longjmp(png, 1);
}

static void
no_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void
put_header(png_structp png, png_infop info, int width, int height,
           double pixaspect)
{
    png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, 8,
                 PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (fabs(pixaspect - 1) > .005 && pixaspect < 1000)
        png_set_pHYs(png, info, (png_uint_32)(1000 * pixaspect + .5), 1000,
                     PNG_RESOLUTION_UNKNOWN);
    png_write_info(png, info);
}

int
rad_png_write(const uint8_t *rgb, int width, int height, double pixaspect,
              const struct rad_sink *sink, struct rad_error *err)
{
    struct writer w = { sink, err, 0 };
    png_structp png =
        png_create_write_struct(PNG_LIBPNG_VER_STRING, &w, fail, no_warning);
    png_infop info = png ? png_create_info_struct(png) : NULL;

    if (!info) {
        png_destroy_write_struct(&png, NULL);
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    }
    /* nothing that is used after the jump changes after this point but w,
     * whose address libpng holds */
    if (setjmp(png_jmpbuf(png)) == 0) {
        png_set_write_fn(png, &w, put, no_flush);
        png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
        put_header(png, info, width, height, pixaspect);
        for (int y = 0; y < height; y++)
            png_write_row(png, rgb + 3 * (size_t)width * (size_t)y);
        png_write_end(png, NULL);
    }
    png_destroy_write_struct(&png, &info);
    return w.rc;
}

int
rad_png_picture(const struct rad_picture *pic, const struct rad_sink *sink,
                struct rad_error *err)
{
    size_t n = (size_t)pic->width * (size_t)pic->height;
    struct rad_tone tone = rad_tone_of(pic->L, n);
    uint8_t *rgb = malloc(3 * n);
    int rc;

    if (!rgb)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    for (size_t i = 0; i < n; i++)
        rad_tone_map(&tone, pic->L[i], rgb + 3 * i);
    rc = rad_png_write(rgb, pic->width, pic->height, pic->pixaspect, sink, err);
    free(rgb);
    return rc;
}
