/* check_spectrum.c - tests of src/image/spectrum and of hyperspectral pictures
 */
#include "config.h"

#include "image/spectrum.h"
#include "scene/file/specpict.h"
#include "tests/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct rad_arena arena;
static struct rad_bands rgb_bands;

static void
begin(void)
{
    rad_arena_init(&arena);
    rgb_bands = rad_bands_rgb();
}

static void
end(void)
{
    rad_arena_release(&arena);
}

FIXTURE(begin, end)

static void
colour(int n, double from, double to, double (*f)(double), double rgb[3])
{
    const struct rad_spectrum *sp =
        rad_spectrum_new(&arena, n, from, to, &rgb_bands);

    ck_assert_ptr_nonnull(sp);
    rgb[0] = rgb[1] = rgb[2] = 0;
    for (int i = 0; i < n; i++)
        rad_spectrum_add(sp, i, f(from + (i + .5) * (to - from) / n), rgb);
    rad_spectrum_colour(sp, rgb);
}

static double
one(double nm)
{
    (void)nm;
    return 1;
}

static double
hill(double nm)
{
    return .2 + exp(-(nm - 560) * (nm - 560) / 3000);
}

static double
line_at_520(double nm)
{
    return nm > 516 && nm < 524;
}

static const struct {
    int n;
    double from, to;
} grids[] = {
    { 24, 780, 380 }, { 24, 380, 780 },  { 3, 780, 380 },  { 41, 380, 790 },
    { 1, 300, 900 },  { 400, 380, 780 }, { 5, 2500, 300 },
};

/* What the observer sees of 380 to 780 nm is all but 4e-4 of it. */
LOOP_TEST(even_spectrum_is_white, N_ELEM(grids))
{
    double rgb[3];

    colour(grids[_i].n, grids[_i].from, grids[_i].to, one, rgb);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(rgb[k], 1, 1e-3);
}

TEST(direction_and_fineness_hardly_matter)
{
    double a[3], b[3], c[3];

    colour(400, 380, 780, hill, a);
    colour(400, 780, 380, hill, b);
    colour(25, 380, 780, hill, c);
    for (int k = 0; k < 3; k++) {
        ck_assert_double_eq_tol(a[k], b[k], 1e-9);
        ck_assert_double_eq_tol(a[k], c[k], .03 * a[k]);
    }
}

/* A line is outside of what three primaries can show: none is negative, and the
 * luminance is what the observer's Y says: .710 of 106.857 a nanometre. */
TEST(pure_colour_is_shown_paler)
{
    double rgb[3], lum;

    colour(400, 380, 780, line_at_520, rgb);
    ck_assert_double_eq_tol(rgb[0], 0, 1e-9);
    ck_assert_double_ge(rgb[2], 0);
    ck_assert_double_gt(rgb[1], 3 * rgb[2]);
    lum = (double)rad_rgb_lum(
        rad_rgb((float)rgb[0], (float)rgb[1], (float)rgb[2]));
    /* bands of 16.7 nm hold the line's eight samples */
    ck_assert_double_eq_tol(lum, 8 * .710 / 106.857, .1 * lum);
}

TEST(three_bands_are_the_channels)
{
    const struct rad_spectrum *sp =
        rad_spectrum_new(&arena, 3, 780, 380, &rgb_bands);
    double rgb[3] = { 0 };

    for (int i = 0; i < 3; i++)
        rad_spectrum_add(sp, i, .1 * (i + 1), rgb);
    rad_spectrum_colour(sp, rgb);
    for (int k = 0; k < 3; k++)
        ck_assert_double_eq_tol(rgb[k], .1 * (k + 1), 1e-12);
}

/* Bands of a job: what samples fill of each, none lost where the range holds
 * them; and of all planes each band once. */
TEST(bands_get_the_mean_of_samples)
{
    struct rad_bands b = { 20, 780, 380, 0 };
    struct rad_rgb plane[RAD_MAX_PLANES];
    float band[RAD_MAX_BANDS];

    for (b.plane = 0; b.plane < rad_bands_planes(&b); b.plane++) {
        const struct rad_spectrum *sp =
            rad_spectrum_new(&arena, 8, 400, 720, &b);
        double sum[3] = { 0 };

        for (int i = 0; i < 8; i++) /* of 40 nm: the sample's middle */
            rad_spectrum_add(sp, i, 420 + 40 * i, sum);
        rad_spectrum_colour(sp, sum);
        plane[b.plane] = rad_rgb((float)sum[0], (float)sum[1], (float)sum[2]);
    }
    rad_bands_gather(&b, plane, band);
    for (int i = 0; i < 20; i++) {
        double low = 760 - 20 * i; /* of the band */
        double want =
            low >= 720 || low < 400 ? 0 : 420 + 40 * floor((low - 400) / 40);

        ck_assert_double_eq_tol((double)band[i], want, 1e-3);
    }
}

RANGE_TEST(planes_have_each_band_once_and_far_apart, 3, RAD_MAX_BANDS + 1)
{
    struct rad_bands b = { _i, 780, 380, -1 };
    int planes = rad_bands_planes(&b), seen[RAD_MAX_BANDS] = { 0 };

    for (int p = 0; p < planes; p++)
        for (int k = 0; k < 3; k++) {
            int band = rad_bands_of(&b, p, k);

            ck_assert(band >= 0 && band < b.n);
            seen[band]++;
            if (k == 1)
                ck_assert_int_eq(band - rad_bands_of(&b, p, 0), planes);
        }
    for (int i = 0; i < b.n; i++)
        ck_assert_int_ge(seen[i], 1);
    ck_assert_int_le(planes, RAD_MAX_PLANES);
}

static const struct {
    double longest, shortest;
    int n;
    const char *primaries; /* of the bands */
    bool colours;
} split[] = {
    { 780, 380, 4, "rrgb", true },
    { 780, 380, 20, "rrrrrrrrrrgggggbbbbb", true },
    { 700, 400, 6, "rrggbb", true },
    { 600, 500, 6, "rrggbb", false },
};

LOOP_TEST(colours_become_three_steps, N_ELEM(split))
{
    struct rad_bands b = { split[_i].n, split[_i].longest, split[_i].shortest,
                           -1 };

    ck_assert_int_eq(rad_bands_show_colour(&b), split[_i].colours);
    for (int i = 0; i < b.n; i++)
        ck_assert_int_eq("rgb"[rad_bands_primary(&b, i)],
                         split[_i].primaries[i]);
}

#define HEAD                                                                   \
    "#?RADIANCE\nNCOMP=4\nWAVELENGTH_SPLITS= 780 588 480 380\n"                \
    "FORMAT=Radiance_spectra\n\n"

static struct rad_data *
parse(const char *text, size_t len, struct rad_error *err)
{
    uint8_t *copy = malloc(len); /* nothing readable behind it */
    struct rad_data *d;

    ck_assert_ptr_nonnull(copy);
    memcpy(copy, text, len);
    d = rad_specpict_parse(&arena, copy, len, err);
    free(copy);
    return d;
}

/* The ends of such samples are at most .7 nm off, taken together. */
TEST(samples_that_are_almost_bands_are_these)
{
    struct rad_bands b = { 6, 720, 420, 0 };

    for (int close = 0; close < 2; close++) {
        double off = close ? .4 : .6, sum[3] = { 0 };
        const struct rad_spectrum *sp =
            rad_spectrum_new(&arena, 6, 720 + off, 420 + off, &b);

        rad_spectrum_add(sp, 2, 1, sum); /* channel 1 of the first plane */
        rad_spectrum_colour(sp, sum);
        ck_assert_double_eq(sum[0], 0);
        ck_assert_double_eq_tol(sum[1], close ? 1 : 1 - off / 50, 1e-9);
        ck_assert_double_eq(sum[2], 0);
    }
}

TEST(picture_has_its_samples)
{
    static const char text[] = HEAD "-Y 2 +X 3\n"
                                    "\1\2\3\4\200"
                                    "\5\6\7\10\200"
                                    "\1\1\1\1\0"
                                    "\1\1\1\1\201"
                                    "\2\2\2\2\201"
                                    "\3\3\3\3\201";
    struct rad_error err = { 0 };
    struct rad_data *d = parse(text, sizeof text - 1, &err);
    double first, length;
    int n;

    ck_assert_msg(d != NULL, "%s", err.what);
    rad_data_axis(d, 2, &first, &length, &n);
    ck_assert_int_eq(n, 4);
    ck_assert_double_eq(first, 730);
    ck_assert_double_eq(length, -300);
    /* the upper left pixel: half a step is added to what is stored */
    ck_assert_double_eq(rad_data_value(d, (double[]){ 1, 0, 730 }), 1.5 / 256);
    ck_assert_double_eq(rad_data_value(d, (double[]){ 1, 0, 430 }), 4.5 / 256);
    ck_assert_double_eq(rad_data_value(d, (double[]){ 1, 1.5, 530 }), 0);
    ck_assert_double_eq(rad_data_value(d, (double[]){ 0, 1.5, 530 }), 7. / 256);
}

static const struct {
    const char *text, *problem;
} bad[] = {
    { "", "header ends early" },
    { "#?RADIANCE\nNCOMP=4\n", "header ends early" },
    { "NCOMP=3\nWAVELENGTH_SPLITS= 780 588 480 380\n\n-Y 1 +X 1\n12345",
      "NCOMP is not 4 to 24" },
    { "NCOMP=25\nWAVELENGTH_SPLITS= 780 588 480 380\n\n-Y 1 +X 1\n12345",
      "NCOMP is not 4 to 24" },
    { "NCOMP=4\n\n-Y 1 +X 1\n12345", "no WAVELENGTH_SPLITS" },
    { "NCOMP=4\nWAVELENGTH_SPLITS= 1 2\n\n-Y 1 +X 1\n12345",
      "bad WAVELENGTH_SPLITS" },
    { "NCOMP=4\nWAVELENGTH_SPLITS= nan 2 3 nan\n\n-Y 1 +X 1\n12345",
      "or bad ones" },
    { "FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n12345", "not Radiance_spectra" },
    { HEAD "+Y 1 +X 1\n12345", "bad resolution line" },
    { HEAD "-Y 0 +X 1\n12345", "bad resolution line" },
    { HEAD "-Y 2 +X 1\n123456789", "ends early" },
    { HEAD "-Y 16777216 +X 16777216\n12345", "too many pixels" },
};

LOOP_TEST(bad_picture_is_refused, N_ELEM(bad))
{
    struct rad_error err = { 0 };

    ck_assert_ptr_null(parse(bad[_i].text, strlen(bad[_i].text), &err));
    ck_assert_int_eq(err.code, RAD_EDATA);
    ck_assert_msg(strstr(err.what, bad[_i].problem) != NULL, "%s", err.what);
}
