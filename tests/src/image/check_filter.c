/* check_filter.c - filtering down: pfilt's formula, its edges, spikes */
#include "config.h"

#include "base/rng.h"
#include "image/filter.h"
#include "image/hdr.h"
#include "tests/unit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    int side, n, expected;
} sides[] = {
    { 512, 2, 256 },  { 655, 2, 328 }, { 653, 2, 327 },    { 1001, 3, 334 },
    { 1000, 3, 333 }, { 4, 8, 1 },     { 3, 8, 0 },        { 1, 2, 1 },
    { 0, 1, 0 },      { 7, 1, 7 },     { 65535, 8, 8192 },
};

LOOP_TEST(sides_are_rounded, N_ELEM(sides))
{
    ck_assert_int_eq(rad_filter_side(sides[_i].side, sides[_i].n),
                     sides[_i].expected);
}

/* Samples of all magnitudes, four bytes each; to be freed. */
static uint8_t *
noise(int width, int height, uint64_t seed)
{
    size_t n = (size_t)width * (size_t)height;
    uint8_t *rgbe = malloc(4 * n);

    ck_assert_ptr_nonnull(rgbe);
    for (size_t i = 0; i < n; i++) {
        uint64_t bits = rad_mix64(seed + i);

        for (int k = 0; k < 3; k++)
            rgbe[4 * i + (size_t)k] = (uint8_t)(bits >> 8 * k);
        /* some 2^12 times as bright, some black */
        rgbe[4 * i + 3] = bits >> 32 & 15 ? 128 : bits >> 36 & 1 ? 140 : 0;
    }
    return rgbe;
}

/* The small picture of it, to be freed; most: rows that went in before the
 * first came out. */
static struct rad_rgb *
filter(const struct rad_filter_shape *s, const uint8_t *rgbe, int *most)
{
    int width = rad_filter_side(s->width, s->oversample), row = 0;
    int height = rad_filter_side(s->height, s->oversample);
    struct rad_rgb *out = calloc((size_t)width * (size_t)height, sizeof *out);
    struct rad_filter *f;

    ck_assert_ptr_nonnull(out);
    ck_assert_int_eq(rad_filter_new(&f, s, NULL), 0);
    ck_assert(!rad_filter_pull(f, out));
    *most = 0;
    for (int y = 0; y < s->height; y++) {
        rad_filter_push(f, rgbe + 4 * (size_t)y * (size_t)s->width);
        while (row < height && rad_filter_pull(f, out + row * width)) {
            if (row == 0)
                *most = y + 1;
            row++;
        }
    }
    ck_assert_int_eq(row, height);
    ck_assert(!rad_filter_pull(f, out));
    rad_filter_free(f);
    return out;
}

/* One pixel by the formula: a Gaussian of the squared distance in radii, which
 * is taken in steps of 1/20, flat over a sample's area, over the window of
 * samples that pfilt looks at. */
static void
direct(const struct rad_filter_shape *s, const uint8_t *rgbe, int c, int r,
       double L[3])
{
    int columns = rad_filter_side(s->width, s->oversample);
    int rows = rad_filter_side(s->height, s->oversample);
    double across = (double)columns / s->width, down = (double)rows / s->height;
    double flat = across * down * .25 / .36, all = 0;
    int cx = (int)((c + .5) / across + 1e-9), rx = (int)(1.2 / across + 1);
    int cy = (int)((r + .5) / down + 1e-9), ry = (int)(1.2 / down + 1);

    L[0] = L[1] = L[2] = 0;
    for (int y = cy - ry; y <= cy + ry; y++)
        for (int x = cx - rx; x <= cx + rx; x++) {
            double dx = (across * (x + .5) - (c + .5)) / .6;
            double dy = (down * (y + .5) - (r + .5)) / .6;
            double d = floor(20 * (dx * dx + dy * dy) + .5) / 20, w;
            int at = (x + s->width) % s->width;
            struct rad_rgb v;

            if (y < 0 || y >= s->height || (at != x && !s->around))
                continue;
            w = exp(-fmax(d, flat));
            v = rad_rgbe_radiance(
                rgbe + 4 * ((size_t)y * (size_t)s->width + (size_t)at));
            L[0] += w * v.r;
            L[1] += w * v.g;
            L[2] += w * v.b;
            all += w;
        }
    for (int k = 0; k < 3; k++)
        L[k] /= all;
}

static const struct rad_filter_shape shapes[] = {
    { 64, 48, 2, 0, false },  { 65, 48, 2, 0, false }, /* 33 columns */
    { 64, 47, 2, 0, false },  { 63, 48, 3, 0, false }, { 61, 44, 3, 0, false },
    { 60, 61, 3, 0, false },  { 80, 60, 4, 0, false }, { 100, 65, 5, 0, false },
    { 90, 61, 6, 0, false },  { 77, 70, 7, 0, false }, { 160, 96, 8, 0, false },
    { 165, 93, 8, 0, false }, { 64, 48, 2, 0, true },  { 90, 45, 3, 0, true },
    { 5, 9, 8, 0, false },    { 4, 4, 8, 0, false },   { 1, 64, 2, 0, false },
    { 64, 1, 2, 0, false },   { 3, 3, 2, 0, true },
};

LOOP_TEST(pixels_are_those_of_the_formula, N_ELEM(shapes))
{
    const struct rad_filter_shape *s = &shapes[_i];
    int columns = rad_filter_side(s->width, s->oversample), most;
    int rows = rad_filter_side(s->height, s->oversample);
    uint8_t *rgbe = noise(s->width, s->height, (uint64_t)_i << 32);
    struct rad_rgb *out = filter(s, rgbe, &most);

    for (int r = 0; r < rows; r++)
        for (int c = 0; c < columns; c++) {
            struct rad_rgb v = out[r * columns + c];
            double L[3];

            direct(s, rgbe, c, r, L);
            ck_assert_double_eq_tol(v.r, L[0], 3e-6 * L[0]);
            ck_assert_double_eq_tol(v.g, L[1], 3e-6 * L[1]);
            ck_assert_double_eq_tol(v.b, L[2], 3e-6 * L[2]);
        }
    /* a window of rows is enough, however high the picture is */
    ck_assert_int_le(most, 2 * s->oversample + 4);
    free(rgbe);
    free(out);
}

static void
set(uint8_t *rgbe, float L)
{
    rad_rgbe(rad_grey(L), rgbe);
}

/* A picture of one radiance, but for a sample. */
static uint8_t *
spike(int width, int height, int x, int y, float L)
{
    uint8_t *rgbe = malloc(4 * (size_t)width * (size_t)height);

    ck_assert_ptr_nonnull(rgbe);
    for (int i = 0; i < width * height; i++)
        set(rgbe + 4 * i, 1);
    set(rgbe + 4 * (y * width + x), L);
    return rgbe;
}

static double
sum(const struct rad_rgb *row, int n)
{
    double s = 0;

    for (int i = 0; i < n; i++)
        s += row[i].g;
    return s;
}

/* Filtering keeps the light: what one sample of N by N adds is spread, a few
 * percent more or less by its place in a pixel, and no more nor less over all
 * places. */
TEST(light_is_kept)
{
    static const struct rad_filter_shape s = { 120, 120, 3, 0, false };
    double all = 0, share = 10000. / 9;

    for (int i = 0; i < 9; i++) {
        uint8_t *rgbe = spike(120, 120, 60 + i % 3, 57 + i / 3, 10000);
        int most;
        struct rad_rgb *out = filter(&s, rgbe, &most);
        double adds = sum(out, 1600) - 1600 * rad_rgbe_radiance(rgbe).g;

        ck_assert_double_eq_tol(adds, share, .08 * share);
        all += adds / 9;
        free(rgbe);
        free(out);
    }
    ck_assert_double_eq_tol(all, share, .005 * share);
}

/* A spike, by where it is, counts as factor times the mean of those about it,
 * and no more than it has. */
static const struct {
    int x, y;
    float L;
    double clamp, counts;
} spikes[] = {
    { 20, 20, 1000, 5, 5 }, { 20, 20, 4, 5, 4 },    { 0, 0, 1000, 5, 5 },
    { 39, 20, 1000, 8, 8 }, { 20, 39, 1000, 1, 1 }, { 39, 39, 1000, 2.5, 2.5 },
};

LOOP_TEST(a_spike_counts_as_its_surroundings_allow, N_ELEM(spikes))
{
    struct rad_filter_shape s = { 40, 40, 2, spikes[_i].clamp, false };
    struct rad_filter_shape off = { 40, 40, 2, 0, false };
    uint8_t *rgbe = spike(40, 40, spikes[_i].x, spikes[_i].y, spikes[_i].L);
    uint8_t *plain = spike(40, 40, 0, 0, 1);
    uint8_t *less;
    struct rad_rgb *out, *expected, *base;
    int most;

    less = spike(40, 40, spikes[_i].x, spikes[_i].y, (float)spikes[_i].counts);
    out = filter(&s, rgbe, &most);
    expected = filter(&off, less, &most);
    base = filter(&off, plain, &most);
    ck_assert_double_gt(sum(out, 400) + 1e-3, sum(base, 400));
    /* RGBE's steps are 1/128 of the ones and of the spike */
    for (int i = 0; i < 400; i++)
        ck_assert_double_eq_tol(out[i].g, expected[i].g, .01 * expected[i].g);
    free(rgbe);
    free(plain);
    free(less);
    free(out);
    free(expected);
    free(base);
}

/* Of what is bright two ways on nothing is taken. */
TEST(lines_and_edges_are_no_spikes)
{
    struct rad_filter_shape s = { 60, 60, 3, 4, false }, off = s;
    uint8_t *rgbe = spike(60, 60, 0, 0, 1);
    struct rad_rgb *out, *expected;
    int most;

    for (int i = 0; i < 60; i++) {
        set(rgbe + 4 * (60 * i + 20), 5000);     /* a column */
        set(rgbe + 4 * (60 * 30 + i), 5000);     /* a row */
        set(rgbe + 4 * (60 * i + i), 5000);      /* aslant */
        for (int y = 40; y < 60 && i >= 45; y++) /* a corner */
            set(rgbe + 4 * (60 * y + i), 5000);
    }
    off.clamp = 0;
    out = filter(&s, rgbe, &most);
    expected = filter(&off, rgbe, &most);
    /* where lines end at the picture's edge they do */
    for (int y = 2; y < 18; y++)
        for (int x = 2; x < 18; x++)
            ck_assert(out[20 * y + x].g == expected[20 * y + x].g);
    free(rgbe);
    free(out);
    free(expected);
}

/* Its colour stays; what is black about a sample leaves nothing of it. */
TEST(what_is_clamped_keeps_its_colour)
{
    struct rad_filter_shape s = { 40, 40, 2, 3, false };
    uint8_t *rgbe = calloc(1600, 4);
    struct rad_rgb *out;
    int most;

    ck_assert_ptr_nonnull(rgbe);
    rad_rgbe(rad_rgb(800, 400, 100), rgbe + 4 * (40 * 10 + 10));
    out = filter(&s, rgbe, &most);
    for (int i = 0; i < 400; i++)
        ck_assert(out[i].r == 0);
    free(out);
    for (int i = 0; i < 1600; i++)
        if (i != 40 * 10 + 10)
            rad_rgbe(rad_rgb(.8f, .4f, .1f), rgbe + 4 * i);
    out = filter(&s, rgbe, &most);
    for (int i = 0; i < 400; i++) {
        ck_assert_double_eq_tol(out[i].r / out[i].g, 2, .02);
        ck_assert_double_eq_tol(out[i].r / out[i].b, 8, .2);
        ck_assert_double_le(out[i].r, 3 * .81);
    }
    free(rgbe);
    free(out);
}

/* All around, the first column has the last one beside it. */
LOOP_TEST(a_view_all_around_has_no_edge, 2)
{
    struct rad_filter_shape s = { 48, 24, 2, 0, true };
    uint8_t *rgbe = noise(48, 24, 7), *turned = malloc(4 * 48 * 24);
    struct rad_rgb *a, *b;
    int most;

    ck_assert_ptr_nonnull(turned);
    for (int y = 0; y < 24; y++)
        for (int x = 0; x < 48; x++)
            memcpy(turned + 4 * (48 * y + (x + 10) % 48),
                   rgbe + 4 * (48 * y + x), 4);
    s.clamp = _i ? 4 : 0;
    a = filter(&s, rgbe, &most);
    b = filter(&s, turned, &most);
    for (int y = 0; y < 12; y++)
        for (int x = 0; x < 24; x++)
            ck_assert_double_eq_tol(a[24 * y + x].r, b[24 * y + (x + 5) % 24].r,
                                    1e-4);
    free(rgbe);
    free(turned);
    free(a);
    free(b);
}

TEST(the_middle_is_the_nearest_sample)
{
    ck_assert_int_eq(rad_filter_middle(512, 2, 0), 1); /* the later of two */
    ck_assert_int_eq(rad_filter_middle(513, 3, 0), 1);
    ck_assert_int_eq(rad_filter_middle(513, 3, 170), 511);
    for (int i = 0; i < 334; i++) { /* 1001 samples */
        double middle = (i + .5) * 1001 / 334;
        int at = rad_filter_middle(1001, 3, i);

        ck_assert_int_ge(at, 0);
        ck_assert_int_lt(at, 1001);
        ck_assert_double_le(fabs(at + .5 - middle), .5 + 1e-9);
    }
}

/* As pfilt writes it: what is within half a percent is not said. */
TEST(the_aspect_of_pixels_follows_the_rounding)
{
    struct rad_filter_shape s = { 512, 384, 2, 0, false };

    ck_assert(rad_filter_pixaspect(&s, 1.25) == 1.25);
    s.height = 13; /* becomes 7 */
    ck_assert_double_eq_tol(rad_filter_pixaspect(&s, 1.25),
                            1.25 * .5 / (7. / 13), 1e-12);
}

TEST(options_are_those_of_what_is_written)
{
    char text[RAD_FILTER_OPTIONS], plain[RAD_PARAMS_TEXT];
    struct rad_params p;

    rad_params_init(&p);
    p.xres = 900;
    p.yres = 600;
    rad_params_format(&p, plain, sizeof plain);
    rad_filter_options(&p, 1, 0, text);
    ck_assert_str_eq(text, plain);
    rad_filter_options(&p, 3, 4.5, text);
    ck_assert_int_eq(
        strncmp(text, "--oversample=3 --clamp=4.5 -x 300 -y 200 ", 41), 0);
}
