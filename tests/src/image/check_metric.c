/* check_metric.c - comparing pictures, false colour */
#include "config.h"

#include "tone/falsecolour.h"
#include "image/metric.h"
#include "image/png.h"
#include "tests/unit.h"

#include <math.h>
#include <string.h>

/* A grey picture of the values. */
static struct rad_picture
grey(int width, int height, const float *v)
{
    struct rad_picture p = { .width = width, .height = height, .pixaspect = 1 };

    p.L = malloc((size_t)width * (size_t)height * sizeof *p.L);
    ck_assert_ptr_nonnull(p.L);
    for (int i = 0; i < width * height; i++)
        p.L[i] = rad_grey(v[i]);
    return p;
}

static const struct rad_metric_options as_is = { 1, 0, 1 };

/* Worked by hand: reference 1 1 1 1, test 1 1 1 2, e = .001. */
TEST(figures_agree_with_hand_calculation)
{
    static const float tv[] = { 2, 1, 1, 1 }, rv[] = { 1, 1, 1, 1 };
    struct rad_picture t = grey(2, 2, tv), r = grey(2, 2, rv), a, b;
    struct rad_metric m;

    ck_assert_int_eq(rad_metric_prepare(&t, &r, &as_is, &a, &b, NULL), 0);
    ck_assert_int_eq(rad_metric_compare(&a, &b, &m, NULL), 0);
    ck_assert_double_eq_tol(m.mean_ratio, 1.25, 1e-7);
    ck_assert_double_eq_tol(m.nrmse, .5, 1e-7);
    ck_assert_double_eq_tol(m.log_rmse, log(2.001 / 1.001) / 2, 1e-6);
    ck_assert_double_eq_tol(m.p50, 0, 1e-12);
    /* places .95 * 3 = 2.85 and .999 * 3 = 2.997 of 0, 0, 0, 1/1.001 */
    ck_assert_double_eq_tol(m.p95, .85 / 1.001, 1e-6);
    ck_assert_double_eq_tol(m.p99_9, .997 / 1.001, 1e-6);
    ck_assert_double_eq_tol(m.max, 1 / 1.001, 1e-6);
    ck_assert_double_eq_tol(m.maxabs, 1, 1e-7);
    a.height = b.height = 1; /* the median is between two */
    ck_assert_int_eq(rad_metric_compare(&a, &b, &m, NULL), 0);
    ck_assert_double_eq_tol(m.p50, .5 / 1.001, 1e-6);
    rad_picture_release(&a);
    rad_picture_release(&b);
    rad_picture_release(&t);
    rad_picture_release(&r);
}

TEST(channels_weigh_by_luminance)
{
    static const float one[] = { 1 };
    struct rad_picture t = grey(1, 1, one), r = grey(1, 1, one);
    struct rad_metric m;

    t.L[0].g = 2;
    ck_assert_int_eq(rad_metric_compare(&t, &r, &m, NULL), 0);
    ck_assert_double_eq_tol(m.mean_ratio, 1.670114631, 1e-6);
    ck_assert_double_eq_tol(m.nrmse, sqrt(1. / 3), 1e-7);
    /* 5 * .265074126 - 2 * .670114631 + .25 * .064811243, of 100 + e */
    r.L[0] = rad_grey(100);
    t.L[0] = rad_rgb(105, 98, 100.25f);
    ck_assert_int_eq(rad_metric_compare(&t, &r, &m, NULL), 0);
    ck_assert_double_eq_tol(m.p50, .00134417875 / 100.1, 1e-13);
    ck_assert_double_eq_tol(m.maxabs, .05, 1e-7);
    for (int c = 0; c < 3; c++) { /* a channel that is less */
        t.L[0] =
            rad_rgb(c == 0 ? 93 : 104, c == 1 ? 93 : 104, c == 2 ? 93 : 104);
        ck_assert_int_eq(rad_metric_compare(&t, &r, &m, NULL), 0);
        ck_assert_double_eq_tol(m.maxabs, .07, 1e-7);
    }
    rad_picture_release(&t);
    rad_picture_release(&r);
}

TEST(blocks_are_averaged_and_values_clipped)
{
    static const float tv[] = { 0, 2, 9, 0, 2, 9, 9, 9, 9 };
    static const float rv[] = { 1, 1, 5, 1, 1, 5, 5, 5, 5 };
    static const struct rad_metric_options block = { 1, 0, 2 };
    static const struct rad_metric_options clip = { 1, .1, 1 };
    struct rad_picture t = grey(3, 3, tv), r = grey(3, 3, rv), a, b;

    /* the third row and column have no block */
    ck_assert_int_eq(rad_metric_prepare(&t, &r, &block, &a, &b, NULL), 0);
    ck_assert(a.width == 1 && a.height == 1);
    ck_assert_float_eq(a.L[0].r, 1);
    ck_assert_float_eq(b.L[0].r, 1);
    rad_picture_release(&a);
    rad_picture_release(&b);
    ck_assert_int_eq(rad_metric_prepare(&t, &r, &clip, &a, &b, NULL), 0);
    ck_assert_float_eq_tol(a.L[8].g, .1f * 29 / 9, 1e-6f);
    ck_assert_float_eq(a.L[0].g, 0);
    rad_picture_release(&a);
    rad_picture_release(&b);
    rad_picture_release(&t);
    rad_picture_release(&r);
}

TEST(larger_test_picture_is_brought_down)
{
    static const float tv[] = { 1, 3, 1, 3, 3, 1, 3, 1 }, rv[] = { 2, 2 };
    static const struct rad_metric_options half = { 2, 0, 1 };
    struct rad_picture t = grey(4, 2, tv), r = grey(2, 1, rv), a, b;
    struct rad_error err = { 0 };
    struct rad_metric m;

    ck_assert_int_eq(rad_metric_prepare(&r, &t, &as_is, &a, &b, &err),
                     RAD_EDATA);
    ck_assert_str_eq(err.what, "sizes differ: 2x1 and 4x2");
    ck_assert_int_eq(rad_metric_prepare(&t, &r, &half, &a, &b, NULL), 0);
    ck_assert_int_eq(rad_metric_compare(&a, &b, &m, NULL), 0);
    ck_assert_double_eq(m.nrmse, 0);
    rad_picture_release(&a);
    rad_picture_release(&b);
    ck_assert_int_eq(rad_metric_prepare(&r, &r, &half, &a, &b, NULL),
                     RAD_EDATA);
    rad_picture_release(&t);
    rad_picture_release(&r);
}

TEST(black_and_infinite_pictures_are_refused)
{
    static const float black[] = { 0 }, inf[] = { INFINITY };
    struct rad_picture t = grey(1, 1, inf), r = grey(1, 1, black), a, b;
    struct rad_metric m;

    ck_assert_int_eq(rad_metric_compare(&t, &r, &m, NULL), RAD_EDATA);
    ck_assert_int_eq(rad_metric_prepare(&t, &r, &as_is, &a, &b, NULL),
                     RAD_EDATA);
    rad_picture_release(&t);
    rad_picture_release(&r);
}

static int
refuse(void *arg, const void *data, size_t n, struct rad_error *err)
{
    (void)arg;
    (void)data;
    (void)n;
    return rad_fail(err, RAD_EIO, "disk full");
}

TEST(png_passes_on_why_it_could_not_be_written)
{
    static const uint8_t rgb[3] = { 1, 2, 3 };
    struct rad_sink sink = { refuse, NULL };
    struct rad_error err = { 0 };

    ck_assert_int_eq(rad_png_write(rgb, 1, 1, 1, &sink, &err), RAD_EIO);
    ck_assert_str_eq(err.what, "disk full");
}

struct bytes {
    uint8_t at[4096];
    size_t n;
};

static int
keep(void *arg, const void *data, size_t n, struct rad_error *err)
{
    struct bytes *b = arg;

    (void)err;
    ck_assert_uint_le(n, sizeof b->at - b->n);
    memcpy(b->at + b->n, data, n);
    b->n += n;
    return 0;
}

/* pixels to a metre across and down, of which the ratio alone means something
 */
TEST(png_says_that_pixels_are_not_square)
{
    static const struct {
        double pixaspect;
        const char *chunk;
    } row[] = { { 1, NULL },
                { 1.004, NULL },
                { .5, "pHYs\0\0\1\xf4\0\0\3\xe8" },
                { 2.5, "pHYs\0\0\x9\xc4\0\0\3\xe8" },
                { 1e9, NULL } };
    static const uint8_t rgb[3] = { 1, 2, 3 };

    for (size_t i = 0; i < N_ELEM(row); i++) {
        struct bytes b = { .n = 0 };
        struct rad_sink sink = { keep, &b };
        const void *found;

        ck_assert_int_eq(
            rad_png_write(rgb, 1, 1, row[i].pixaspect, &sink, NULL), 0);
        found = memmem(b.at, b.n, row[i].chunk ? row[i].chunk : "pHYs",
                       row[i].chunk ? 12 : 4);
        ck_assert_int_eq(found != NULL, row[i].chunk != NULL);
    }
}

TEST(differences_are_red_and_blue)
{
    static const float tv[] = { 1000, 2000, 500, 1e9f, 0, 1000 };
    static const float rv[] = { 1000, 1000, 1000, 1000, 1000, 1000 };
    static const uint8_t want[6][3] = { { 200, 200, 200 }, { 160, 20, 30 },
                                        { 20, 40, 160 },   { 160, 20, 30 },
                                        { 20, 40, 160 },   { 200, 200, 200 } };
    struct rad_picture t = grey(6, 1, tv), r = grey(6, 1, rv);
    struct rad_image image;
    size_t ticks = 0;

    ck_assert_int_eq(rad_difference_map(&t, &r, &image, NULL), 0);
    ck_assert_int_gt(image.width, 6);
    for (int x = 0; x < 6; x++)
        for (int c = 0; c < 3; c++)
            ck_assert_int_le(abs(image.rgb[3 * x + c] - want[x][c]), 1);
    ck_assert_mem_eq(image.rgb + 3 * 6, "\0\0\0", 3);
    for (int i = image.width * image.height / 2; i < image.width * image.height;
         i++)
        ticks += memcmp(image.rgb + 3 * i, "\377\377\377", 3) == 0;
    ck_assert_uint_gt(ticks, 20);
    free(image.rgb);
    rad_picture_release(&t);
    rad_picture_release(&r);
}

TEST(false_colours_span_three_decades)
{
    static const float v[] = { 1, .001f, 1e-9f, 0, INFINITY, NAN };
    struct rad_picture p = grey(6, 1, v);
    struct rad_false_scale s;
    struct rad_image image;

    ck_assert_int_eq(rad_false_parse(&s, "179,log=3", NULL), 0);
    ck_assert(rad_false_fit(&s, &p));
    ck_assert_int_eq(rad_false_colour(&s, &p, &image, NULL), 0);
    ck_assert_mem_eq(image.rgb, "\377\377\334", 3);
    for (int x = 1; x < 6; x++) /* at and below the scale's lower end */
        ck_assert_int_eq(image.rgb[3 * x], x == 4 ? 255 : 10);
    free(image.rgb);
    rad_picture_release(&p);
}
