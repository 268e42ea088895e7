/* png.c - see png.h */
#include "config.h"

#include "image/png.h"

#include <math.h>
#include <png.h>
#include <stdlib.h>
#include <string.h>

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

static png_voidp
get_memory(png_structp png, png_alloc_size_t n)
{
    struct writer *w = png_get_mem_ptr(png);
    void *p = malloc(n);

    if (!p && w->rc == 0)
        w->rc = rad_fail_memory(w->err);
    return p;
}

static void
no_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void
put_header(png_structp png, png_infop info, const struct rad_png *p)
{
    png_set_IHDR(png, info, (png_uint_32)p->width, (png_uint_32)p->height,
                 p->bits, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    if (fabs(p->pixaspect - 1) > .005 && p->pixaspect < 1000)
        png_set_pHYs(png, info, (png_uint_32)(1000 * p->pixaspect + .5), 1000,
                     PNG_RESOLUTION_UNKNOWN);
    png_write_info(png, info);
}

int
rad_png_rows(const struct rad_png *p, rad_png_row_fn *fn, void *arg,
             const struct rad_sink *sink, struct rad_error *err)
{
    struct writer w = { sink, err, 0 };
    png_structp png = png_create_write_struct_2(
        PNG_LIBPNG_VER_STRING, &w, fail, no_warning, &w, get_memory, NULL);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    uint8_t *row = malloc((size_t)p->width * 3 * (size_t)(p->bits / 8));

    if (!info || !row) {
        png_destroy_write_struct(&png, NULL);
        free(row);
        return rad_fail_memory(err);
    }
    /* variables used after the jump do not change from here on, except w, whose
     * address libpng has */
    if (setjmp(png_jmpbuf(png)) == 0) {
        png_set_write_fn(png, &w, put, no_flush);
        png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
        put_header(png, info, p);
        for (int y = 0; y < p->height; y++) {
            fn(arg, y, row);
            png_write_row(png, row);
        }
        png_write_end(png, NULL);
    }
    png_destroy_write_struct(&png, &info);
    free(row);
    return w.rc;
}

struct bytes {
    const uint8_t *rgb;
    size_t row;
};

static void
copy_row(void *arg, int y, uint8_t *out)
{
    const struct bytes *b = arg;

    memcpy(out, b->rgb + (size_t)y * b->row, b->row);
}

int
rad_png_write(const uint8_t *rgb, int width, int height, double pixaspect,
              const struct rad_sink *sink, struct rad_error *err)
{
    struct rad_png p = { width, height, 8, pixaspect };
    struct bytes b = { rgb, 3 * (size_t)width };

    return rad_png_rows(&p, copy_row, &b, sink, err);
}
