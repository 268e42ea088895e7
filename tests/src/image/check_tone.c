/* check_tone.c - sRGB, and tone curves against their papers */
#include "config.h"

#include "tone/primaries.h"
#include "tone/screen.h"
#include "image/edge.h"
#include "image/srgb.h"
#include "tests/made_picture.h"

#include <math.h>
#include <string.h>

static struct rad_tone_options
choose(enum rad_tone_curve curve)
{
    struct rad_tone_options o = { curve, false, 1, false };

    return o;
}

static struct rad_tone_options
absolutely(enum rad_tone_curve curve, double factor)
{
    struct rad_tone_options o = { curve, true, factor, false };

    return o;
}

/* All of the picture in place, by a tone that is fitted if it is not; returns
 * whether it is. */
static bool
apply(const struct rad_tone_options *o, struct rad_tone *tone,
      struct rad_picture *p, const struct rad_view *view)
{
    struct rad_toner t;
    struct rad_rgb *out =
        malloc((size_t)p->width * (size_t)p->height * sizeof *out);

    ck_assert_ptr_nonnull(out);
    ck_assert_int_eq(rad_toner_init(&t, o, tone, p, view, NULL), 0);
    for (int y = 0; y < p->height; y++)
        rad_toner_row(&t, y, out + (size_t)y * (size_t)p->width);
    rad_toner_release(&t);
    free(p->L);
    p->L = out;
    return tone->fitted;
}

/* --- sRGB --- */

/* The table against the formula, where its steps meet and between. */
TEST(table_of_srgb_is_the_curve)
{
    static struct rad_srgb_table t;
    float v;

    rad_srgb_init(&t);
    for (v = 1e-5f; v < 1; v *= 1.0007f) {
        double want =
            v <= .0031308f ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - .055;

        ck_assert_double_eq_tol(rad_srgb_encode(&t, v), want, .05 / 65535);
    }
    ck_assert_float_eq(rad_srgb_encode(&t, 1), 1);
    ck_assert_float_eq(rad_srgb_encode(&t, INFINITY), 1);
    ck_assert_float_eq_tol(rad_srgb_encode(&t, .21404114f), .5f, 1e-6f);
    ck_assert_float_eq_tol(rad_srgb_encode(&t, nextafterf(1, 0)), 1, 1e-7f);
    ck_assert_float_eq(rad_srgb_encode(&t, 0), 0);
    ck_assert_float_eq(rad_srgb_encode(&t, -1), 0);
    ck_assert_float_eq(rad_srgb_encode(&t, NAN), 0);
}

/* --- photographic --- */

/* Worked by hand: equation 4, in (1 + in / 16) / (1 + in) at a white of 4, for
 * in = .5 L; the naive in / (1 + in) fails the last rows. */
static const struct {
    float L;
    double screen;
} reinhard[] = {
    { .002f, .000999063 }, { .5f, .2031250 }, { 2, .5312500 },
    { 6, .8906250 },       { 8, 1 },          { 800, 1 },
};

LOOP_TEST(photographic_is_equation_4, N_ELEM(reinhard))
{
    struct rad_tone_options o = absolutely(RAD_TONE_PHOTOGRAPHIC, .5);
    struct rad_picture p = grey(1, 1, &reinhard[_i].L);
    struct rad_tone tone = { 0 };

    apply(&o, &tone, &p, NULL);
    ck_assert_double_eq_tol(p.L[0].g, reinhard[_i].screen, 2e-6);
    rad_picture_release(&p);
}

/* The geometric mean of .1 and 10 is 1, which comes to .25; the hundredth that
 * is a lamp does not count for more than the rest, nor black ones at all. */
TEST(photographic_takes_the_log_average_to_middle_grey)
{
    struct rad_tone_options o = choose(RAD_TONE_PHOTOGRAPHIC);
    struct rad_picture p = blank(20, 20);
    struct rad_tone tone = { 0 };

    for (int i = 0; i < 200; i++)
        p.L[i] = rad_grey(i % 2 ? 10 : .1f);
    p.L[200] = rad_grey(1e6f);
    ck_assert(apply(&o, &tone, &p, NULL));
    /* (100 log .1 + 101 log 10) / 201 */
    ck_assert_double_eq_tol(tone.scale, .25 / pow(10, 1. / 201), 1e-6);
    ck_assert_double_eq_tol(tone.white, 10 * tone.scale, 1e-6);
    ck_assert_float_eq(p.L[399].r, 0);
    rad_picture_release(&p);
}

LOOP_TEST(curve_rises_and_does_not_care_for_units, 2)
{
    struct rad_tone_options o = choose((enum rad_tone_curve)_i);
    struct rad_picture p = blank(10, 10), q = blank(10, 10);
    struct rad_tone tone = { 0 }, scaled = { 0 };

    for (int i = 0; i < 100; i++) {
        p.L[i] = rad_grey(powf(1.1f, (float)i - 60));
        q.L[i] = rad_rgb_scale(p.L[i], 1 / 1024.f);
    }
    apply(&o, &tone, &p, NULL);
    apply(&o, &scaled, &q, NULL);
    for (int i = 0; i < 100; i++) {
        ck_assert_float_eq_tol(p.L[i].r, p.L[i].b, 1e-6f);
        ck_assert_float_eq_tol(p.L[i].r, q.L[i].r, 1e-5f);
        ck_assert(i == 0 || p.L[i].r >= p.L[i - 1].r - 1e-6f);
    }
    ck_assert_float_eq_tol(p.L[99].r, 1, 1e-6f);
    rad_picture_release(&p);
    rad_picture_release(&q);
}

/* --- linear --- */

/* pfilt: the mean of what is above 0 and below 100 comes to a half. */
TEST(linear_takes_the_mean_to_a_half)
{
    static const float v[] = { 0, 1, 3, 1e5f };
    struct rad_tone_options o = choose(RAD_TONE_LINEAR);
    struct rad_picture p = grey(4, 1, v);
    struct rad_tone tone = { 0 };

    ck_assert(apply(&o, &tone, &p, NULL));
    ck_assert_double_eq_tol(tone.scale, .25, 1e-7);
    ck_assert_float_eq_tol(p.L[1].g, .25f, 1e-6f);
    ck_assert_float_eq_tol(p.L[2].g, .75f, 1e-6f);
    ck_assert_float_eq_tol(p.L[3].g, 1, 1e-6f);
    rad_picture_release(&p);
}

TEST(a_picture_of_lamps_alone_has_an_exposure)
{
    static const float v[] = { 1000, 3000 };
    struct rad_tone_options o = choose(RAD_TONE_LINEAR);
    struct rad_picture p = grey(2, 1, v);
    struct rad_tone tone = { 0 };

    ck_assert(apply(&o, &tone, &p, NULL));
    ck_assert_double_eq_tol(tone.scale, .5 / 2000, 1e-9);
    rad_picture_release(&p);
}

/* --- exposure --- */

enum { CURVES = 3 }; /* of enum rad_tone_curve */

/* Far below the shoulder a stop is twice the light, for each curve. */
LOOP_TEST(a_stop_is_twice_the_light, CURVES)
{
    struct rad_tone_options o = choose((enum rad_tone_curve)_i);
    struct rad_picture p = blank(64, 64), q = blank(64, 64);
    struct rad_tone tone = { 0 }, brighter = { 0 };

    for (int i = 0; i < 64 * 64; i++)
        p.L[i] = q.L[i] = rad_grey(i % 64 ? .5f : .0005f);
    apply(&o, &tone, &p, NULL);
    o.exposure = 2;
    apply(&o, &brighter, &q, NULL);
    ck_assert_float_eq_tol(q.L[0].g / p.L[0].g, 2, .001f);
    rad_picture_release(&p);
    rad_picture_release(&q);
}

/* Equal radiance is shown alike, whatever else is in the picture. */
LOOP_TEST(a_factor_is_of_radiance, CURVES)
{
    static const float v[] = { .1f, .2f }, w[] = { .1f, 2000 };
    struct rad_tone_options o = absolutely((enum rad_tone_curve)_i, 2);
    struct rad_picture p = grey(2, 1, v), q = grey(2, 1, w);
    struct rad_tone tone = { 0 }, other = { 0 };

    other.human.veil = tone.human.veil = false;
    apply(&o, &tone, &p, NULL);
    if (o.curve == RAD_TONE_HUMAN) { /* a lamp's veil is to be seen */
        other = tone;
        ck_assert_float_eq_tol(p.L[0].g, .2f, .001f);
    }
    apply(&o, &other, &q, NULL);
    ck_assert_float_eq_tol(p.L[0].g, q.L[0].g, 1e-6f);
    rad_picture_release(&p);
    rad_picture_release(&q);
}

LOOP_TEST(a_fitted_tone_serves_other_pictures, CURVES)
{
    static const float v[] = { 1, 2 }, w[] = { 10, 20 };
    struct rad_tone_options o = choose((enum rad_tone_curve)_i);
    struct rad_picture p = grey(2, 1, v), q = grey(2, 1, w), r = grey(2, 1, v);
    struct rad_tone tone = { 0 };

    apply(&o, &tone, &p, NULL);
    apply(&o, &tone, &q, NULL);
    apply(&o, &tone, &r, NULL);
    ck_assert_float_eq(p.L[0].g, r.L[0].g);
    ck_assert(q.L[0].g > p.L[0].g);
    rad_picture_release(&p);
    rad_picture_release(&q);
    rad_picture_release(&r);
}

LOOP_TEST(black_pictures_stay_black_and_say_nothing, CURVES)
{
    struct rad_tone_options o = choose((enum rad_tone_curve)_i);
    struct rad_picture p = blank(4, 4), q = blank(4, 4);
    struct rad_tone tone = { 0 };

    ck_assert(!apply(&o, &tone, &p, NULL));
    for (int i = 0; i < 16; i++)
        ck_assert(rad_rgb_black(p.L[i]) && !isnan(p.L[i].r));
    for (int i = 0; i < 16; i++)
        q.L[i] = rad_grey(.5f);
    ck_assert(apply(&o, &tone, &q, NULL));
    ck_assert(q.L[0].g > .1f);
    rad_picture_release(&p);
    rad_picture_release(&q);
}

/* Of a picture that is half there the other half neither counts nor shows. */
LOOP_TEST(what_is_not_there_yet_does_not_count, CURVES)
{
    struct rad_tone_options o = choose((enum rad_tone_curve)_i);
    struct rad_picture half = blank(32, 32), small = blank(32, 15);
    struct rad_tone tone = { 0 }, of_half = { 0 };

    for (int i = 0; i < 32 * 15; i++)
        half.L[i] = small.L[i] = rad_grey(i % 3 ? .01f : 20);
    apply(&o, &tone, &small, NULL);
    o.partial = true;
    apply(&o, &of_half, &half, NULL);
    ck_assert_double_eq_tol(of_half.scale, tone.scale, 1e-9);
    for (int i = 1; i < RAD_HUMAN_BINS; i++)
        ck_assert_double_eq_tol(of_half.human.below[i], tone.human.below[i],
                                .02);
    ck_assert(half.L[0].g > .1f);
    for (int i = 32 * 15; i < 32 * 32; i++)
        ck_assert(rad_rgb_black(half.L[i]));
    rad_picture_release(&half);
    rad_picture_release(&small);
}

/* Values at the ends of what a picture holds come out from 0 to 1. */
LOOP_TEST(extremes_stay_on_the_screen, CURVES)
{
    static const float v[] = { 0, 1e-38f, 1e-7f, 1, 1e12f, 1.7e38f };
    static const double exposure[] = { 1, 1e12, 1e-12 };
    struct rad_tone_options o = choose((enum rad_tone_curve)_i);

    for (int k = 0; k < 6; k++) {
        struct rad_picture p = grey(6, 1, v);
        struct rad_tone tone = { 0 };

        p.L[5].b = p.L[4].r = 0;
        o.absolute = k >= 3;
        o.exposure = exposure[k % 3];
        apply(&o, &tone, &p, NULL);
        for (int i = 0; i < 6; i++)
            ck_assert(p.L[i].r >= 0 && p.L[i].g >= 0 && p.L[i].b >= 0 &&
                      rad_rgb_max(p.L[i]) <= 1.000001f);
        rad_picture_release(&p);
    }
}

/* --- hue --- */

/* Paints, a lamp, and the primaries, each of luminance 1 at brightness 1. */
static const struct rad_rgb paint[] = {
    { .5f, .1f, .08f }, { .05f, .25f, .6f }, { .8f, .7f, .2f },
    { .1f, .4f, .1f },  { .9f, .8f, .7f },   { 1, 0, 0 },
    { 0, 1, 0 },        { 0, 0, 1 },         { 1, 0, 1 },
};

/* Hue [degrees]: the angle around grey of linear light. */
static double
hue(struct rad_rgb c)
{
    double x = c.r - .5 * (c.g + c.b), y = sqrt(.75) * (c.g - c.b);

    return atan2(y, x) * 180 / 3.14159265358979;
}

/* Hue as eyes have it [degrees]: CIE 1976 a*, b*, of equal-energy white. */
static double
eyes_hue(struct rad_rgb c)
{
    struct rad_rgb xyz = rad_rgb_to_xyz(c);
    double x = cbrt(xyz.r / 179.), y = cbrt(xyz.g / 179.);
    double z = cbrt(xyz.b / 179.);

    return atan2(200 * (y - z), 500 * (x - y)) * 180 / 3.14159265358979;
}

static double
apart(double a, double b)
{
    return fabs(remainder(a - b, 360));
}

/* In light from far below to 1e5 times white: linear hue stays to rounding,
 * the eye's within 6 degrees but for the red primary's 14, luminance rises, and
 * at least half of the saturation is left. */
LOOP_TEST(bright_colours_keep_their_hue, N_ELEM(paint))
{
    struct rad_rgb one = rad_rgb_scale(paint[_i], 1 / rad_rgb_lum(paint[_i]));
    double bound = paint[_i].r == 1 && paint[_i].b == 0 ? 14 : 6;
    float last = 0, m = rad_rgb_max(one);

    for (float k = 1e-3f; k < 1e5f; k *= 1.1f) {
        struct rad_rgb c = rad_tone_fit_gamut(rad_rgb_scale(one, k));
        float lum = rad_rgb_lum(c);

        ck_assert_double_lt(apart(hue(c), hue(one)), .05);
        ck_assert_double_lt(apart(eyes_hue(c), eyes_hue(one)), bound);
        ck_assert(lum >= last * .99999f && lum <= k * 1.00001f);
        ck_assert_float_le(rad_rgb_max(c), 1.00001f);
        if (k * m > 1) {
            ck_assert_float_eq_tol(rad_rgb_max(c), 1, 1e-5f);
            ck_assert_float_gt((1 / lum - 1) / (m - 1), .499f);
        }
        last = lum;
    }
}

TEST(white_stays_white)
{
    struct rad_rgb c = rad_tone_fit_gamut(rad_grey(37));

    ck_assert_float_eq_tol(c.r, 1, 1e-6f);
    ck_assert_float_eq_tol(c.b, 1, 1e-6f);
}

/* The sun on a red rug in a grey room, through photographic and human. */
LOOP_TEST(the_sun_on_a_red_rug_is_red, CURVES)
{
    struct rad_tone_options o = choose((enum rad_tone_curve)_i);
    struct rad_picture p = blank(100, 50);
    struct rad_tone tone = { 0 };
    struct rad_rgb c;

    for (int i = 0; i < 5000; i++)
        p.L[i] = rad_grey(.02f * (float)(1 + i % 7));
    for (int i = 4000; i < 4400; i++)
        p.L[i] = rad_rgb(50, 10, 8);
    apply(&o, &tone, &p, NULL);
    c = p.L[4199];
    ck_assert_float_gt(c.r, .9f);
    ck_assert_float_lt(c.g, .6f * c.r);
    ck_assert_float_lt(c.b, .6f * c.r);
    ck_assert_double_lt(apart(hue(c), hue(rad_rgb(50, 10, 8))), 2);
    rad_picture_release(&p);
}

/* --- human --- */

/* Worked from the paper's table of log10 of the threshold, and its acuity. */
static const struct {
    double La, threshold, acuity;
} sight[] = {
    { 1e-5, 1.38e-3, 0 },         { .01, 5.4723e-3, 5.308549 },
    { .1, 4.02717e-2, 11.75123 }, { 1.2589254, .4225681, 33.57938 },
    { 10, 1.07190, 43.86097 },    { 1000, 55.59043, 49.08436 },
};

LOOP_TEST(thresholds_and_acuity_are_the_papers, N_ELEM(sight))
{
    double La = sight[_i].La;

    ck_assert_double_eq_tol(rad_human_threshold(La), sight[_i].threshold,
                            2e-5 * sight[_i].threshold);
    if (sight[_i].acuity > 0)
        ck_assert_double_eq_tol(rad_human_acuity(La), sight[_i].acuity, 1e-4);
    ck_assert_double_gt(rad_human_acuity(0), 0);
}

/* Luminances of 20 to 40 cd/m2 fit the screen: the threshold at 10 cd/m2, in
 * the middle of its logarithms, over that at the mean of the picture's. */
TEST(small_ranges_are_shown_by_a_factor)
{
    struct rad_tone_options o = choose(RAD_TONE_HUMAN);
    struct rad_picture p = blank(80, 80);
    struct rad_tone tone = { 0 };

    for (int i = 0; i < 6400; i++)
        p.L[i] = rad_grey((float)(20 * exp2(i % 80 / 79.) / 179));
    apply(&o, &tone, &p, NULL);
    ck_assert(tone.human.linear && !tone.human.veil && !tone.human.colour);
    ck_assert_double_eq_tol(tone.human.scale,
                            1.07190 / rad_human_threshold(20 * sqrt(2)) * 179 /
                                100,
                            .005 * tone.human.scale);
    rad_picture_release(&p);
}

/* The first bin, below all samples, gets half of the next, as in pcond: the
 * darkest are not shown black.  Of an even histogram nothing is trimmed. */
TEST(the_darkest_are_shared_by_two_bins)
{
    struct rad_histogram world = { .total = 0 };
    struct rad_human h;
    double step;

    ck_assert(rad_human_range(&h, 1, 1000));
    step = (h.bmax - h.bmin) / RAD_HUMAN_BINS;
    for (int i = 1; i < RAD_HUMAN_BINS; i++)
        rad_human_count(&h, &world, exp(h.bmin + (i + .5) * step), 1);
    ck_assert_double_eq_tol(log(rad_human_darkest(&h, &world, .25)),
                            h.bmin + 25.5 * step, 1e-9);
    rad_human_adapt(&h, &world, false);
    ck_assert(!h.linear);
    ck_assert_double_eq_tol(h.below[1] * (RAD_HUMAN_BINS - 1), .5, 1e-9);
    for (int i = 2; i < RAD_HUMAN_BINS; i++)
        ck_assert_double_eq_tol(h.below[i] * (RAD_HUMAN_BINS - 1), i - 1, 1e-9);
}

/* Six orders of magnitude, evenly, and a wall that is most of the picture: the
 * curve spans the screen, and nowhere is the screen's step of luminance more
 * thresholds than the world's, but for the share that may stay untrimmed. */
TEST(no_contrast_is_shown_that_would_not_be_seen)
{
    struct rad_tone_options o = choose(RAD_TONE_HUMAN);
    struct rad_picture p = blank(200, 200);
    struct rad_tone tone = { 0 };
    const struct rad_human *h = &tone.human;
    double step, steepest = 0;

    for (int i = 0; i < 40000; i++)
        p.L[i] = i % 4 ? rad_grey(.5f)
                       : rad_grey((float)pow(10, -3 + 6. * i / 40000));
    apply(&o, &tone, &p, NULL);
    ck_assert(!h->linear && h->veil);
    ck_assert_double_eq_tol(rad_human_display(h, exp(h->bmin)), 1, 1e-9);
    ck_assert_double_eq_tol(rad_human_display(h, exp(h->bmax)), 100, 1e-9);
    step = (h->bmax - h->bmin) / RAD_HUMAN_BINS;
    for (int i = 0; i < RAD_HUMAN_BINS; i++) {
        double a = rad_human_display(h, exp(h->bmin + i * step));
        double b = rad_human_display(h, exp(h->bmin + (i + 1) * step));
        double Lw = exp(h->bmin + (i + .5) * step), Ld = sqrt(a * b);
        double shown = (b - a) / rad_human_threshold(Ld);
        double seen = step * Lw / rad_human_threshold(Lw);

        ck_assert_double_ge(b, a);
        steepest = fmax(steepest, shown / seen);
    }
    /* trimmed samples, .025 of all, may be more than the others allow */
    ck_assert_double_lt(steepest, 1.5);
    ck_assert_double_gt(steepest, .8);
    rad_picture_release(&p);
}

static struct rad_view
square_view(double degrees)
{
    struct rad_view v;

    rad_view_init(&v);
    v.horiz = v.vert = degrees;
    ck_assert_int_eq(rad_view_setup(&v, NULL), 0);
    return v;
}

/* Moon and Spencer's veil in its own words, for the middle of sample (i, j). */
static double
veil_at(const struct rad_picture *p, const struct rad_view *v, int n, int i,
        int j)
{
    double org[3], to[3], from[3], sum = 0, all = 0;
    int size = p->width / n;

    rad_view_ray(v, (i + .5) / n, 1 - (j + .5) / n, org, to);
    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++) {
            double c, t;

            rad_view_ray(v, (x + .5) / n, 1 - (y + .5) / n, org, from);
            c = to[0] * from[0] + to[1] * from[1] + to[2] * from[2];
            if ((x == i && y == j) || c <= 0)
                continue;
            t = acos(c);
            sum += c / (t * t) * p->L[y * size * p->width + x * size].g;
            all += c / (t * t);
        }
    return .08 * sum / all;
}

/* A coloured lamp in a dark view of 12 degrees, which has 12 samples a side,
 * each of 5 pixels; 2 - 2 cos(t) for t^2 is .1 % off there. */
TEST(veil_is_light_scattered_by_angle)
{
    enum { N = 12, SIZE = 5 };
    struct rad_view v = square_view(12);
    struct rad_picture p = blank(N * SIZE, N * SIZE);
    struct rad_human h = { .linear = true, .scale = 1, .veil = true };
    struct rad_rgb row[N * SIZE];
    struct rad_eye *e;

    for (int y = 0; y < N * SIZE; y++)
        for (int x = 0; x < N * SIZE; x++)
            p.L[y * N * SIZE + x] = x / SIZE == 3 && y / SIZE == 4
                                        ? rad_rgb(2e4f, 1e4f, 3e4f)
                                        : rad_rgb(2, 1, 3);
    e = rad_eye_new(&p, &v, false, NULL);
    ck_assert_ptr_nonnull(e);
    ck_assert_int_eq(rad_eye_open(e, &h, NULL), 0);
    for (int j = 0; j < N; j++) {
        rad_eye_row(e, &h, j * SIZE + SIZE / 2, row);
        for (int i = 0; i < N; i++) {
            float L = p.L[(j * SIZE) * N * SIZE + i * SIZE].g;
            double want = .92 * L + veil_at(&p, &v, N, i, j);

            struct rad_rgb got = row[i * SIZE + SIZE / 2];

            ck_assert_double_eq_tol(got.g, want, .002 * want);
            ck_assert_float_eq_tol(got.r, 2 * got.g, 1e-5f * got.r);
            ck_assert_float_eq_tol(got.b, 3 * got.g, 1e-5f * got.b);
        }
    }
    rad_eye_free(e);
    rad_picture_release(&p);
}

/* A dark half beside a bright half: the eye adapts to the dark with the veil
 * that lies over it, and where no veil is seen to what is there. */
TEST(an_eye_adapts_to_what_the_veil_leaves)
{
    static const double range[] = { 1e6, 10 };
    struct rad_view v = square_view(60);

    for (int i = 0; i < 2; i++) {
        struct rad_picture p = blank(60, 60);
        struct rad_histogram w = { .total = 0 };
        struct rad_human h = { .linear = false }, bare;
        struct rad_eye *e;

        for (int k = 0; k < 3600; k++)
            p.L[k] =
                rad_grey((float)(k % 60 < 30 ? (1 + k / 1800) / range[i] : 1));
        e = rad_eye_new(&p, &v, false, NULL);
        ck_assert(rad_eye_fit(e, &h));
        bare = h;
        for (int k = 0; k < 3600; k++)
            rad_human_count(&h, &w, 179 * (double)p.L[k].g, 1);
        rad_human_adapt(&bare, &w, rad_human_fits(&bare));
        ck_assert(h.linear && bare.linear && h.veil == (i == 0));
        if (h.veil)
            ck_assert_double_lt(h.scale, bare.scale / 3);
        else
            ck_assert_double_eq_tol(h.scale, bare.scale, 1e-6 * bare.scale);
        rad_eye_free(e);
        rad_picture_release(&p);
    }
}

/* [cd/m2] of a pure colour: rods alone, half and half, cones alone. */
static const struct {
    double lum, cones;
} dusk[] = { { .001, 0 }, { 2.81281, .5 }, { 10, 1 } };

LOOP_TEST(colours_fade_in_the_dark, N_ELEM(dusk))
{
    static const double seen[3] = { .265074126, .670114631, .064811243 };
    static const double by_rods[3] = { .062, .608, .330 };
    struct rad_human h = { .linear = true, .scale = 1, .colour = true };
    struct rad_picture p = blank(4, 4);
    struct rad_rgb row[4];

    for (int c = 0; c < 3; c++) {
        double L = dusk[_i].lum / 179 / seen[c], cones = dusk[_i].cones * L;
        double rods = (1 - dusk[_i].cones) * by_rods[c] * L;
        struct rad_eye *e;

        for (int i = 0; i < 16; i++)
            p.L[i] = rad_rgb(c == 0 ? (float)L : 0, c == 1 ? (float)L : 0,
                             c == 2 ? (float)L : 0);
        e = rad_eye_new(&p, NULL, false, NULL);
        rad_eye_row(e, &h, 1, row);
        ck_assert_double_eq_tol(row[2].r, rods + (c == 0) * cones, 1e-5 * L);
        ck_assert_double_eq_tol(row[2].g, rods + (c == 1) * cones, 1e-5 * L);
        ck_assert_double_eq_tol(row[2].b, rods + (c == 2) * cones, 1e-5 * L);
        rad_eye_free(e);
    }
    rad_picture_release(&p);
}

/* How much is left of a grating's amplitude in the middle of a view of 20
 * degrees, 50 pixels each, by its period in pixels. */
static double
seen_of_grating(double lum, int period)
{
    enum { N = 1000 };
    struct rad_view v = square_view(20);
    struct rad_picture p = blank(N, N);
    struct rad_human h = { .linear = true, .scale = 179, .acuity = true };
    struct rad_rgb *row = malloc(N * sizeof *row);
    float least = INFINITY, most = 0;
    struct rad_eye *e;

    for (int i = 0; i < N * N; i++)
        p.L[i] = rad_grey(
            (float)(lum / 179 * (i % N % period < period / 2 ? 1.5 : .5)));
    e = rad_eye_new(&p, &v, false, NULL);
    ck_assert_int_eq(rad_eye_open(e, &h, NULL), 0);
    rad_eye_row(e, &h, N / 2, row);
    for (int x = N / 2 - 64; x < N / 2 + 64; x++) {
        least = fminf(least, row[x].g);
        most = fmaxf(most, row[x].g);
    }
    rad_eye_free(e);
    free(row);
    rad_picture_release(&p);
    return (double)(most - least) / lum;
}

/* At .1 cd/m2 an eye sees 11.75 cycles a degree: 4.25 pixels; 50 at 1000. */
TEST(fine_detail_is_lost_in_the_dark)
{
    ck_assert_double_lt(seen_of_grating(.1, 2), .02);
    ck_assert_double_lt(seen_of_grating(.1, 4), .2);
    ck_assert_double_gt(seen_of_grating(.1, 64), .95);
    ck_assert_double_gt(seen_of_grating(1000, 4), .7);
}

/* Where an eye sees 8 pixels, a little more light is a little more detail,
 * though pixels are averaged in squares of 4 there, not of 8. */
TEST(detail_comes_with_the_light)
{
    double lum = .001, before, after;

    while (rad_human_acuity(lum) < 50 / 8.)
        lum *= 1.001;
    before = seen_of_grating(lum / 1.02, 16);
    after = seen_of_grating(lum * 1.02, 16);
    ck_assert_msg(after > before && after < before + .05, "%g %g", before,
                  after);
}

/* What an even slope loses to its surroundings it gets from them. */
TEST(a_blur_leaves_slopes_where_they_are)
{
    enum { N = 400, EDGE = 64 };
    struct rad_view v = square_view(8);
    struct rad_picture p = blank(N, N);
    struct rad_human h = { .linear = true, .scale = 1, .acuity = true };
    struct rad_rgb row[N];
    struct rad_eye *e;

    for (int y = 0; y < N; y++)
        for (int x = 0; x < N; x++)
            p.L[y * N + x] = rad_grey((float)(x + 3 * y + N) * 1e-7f);
    e = rad_eye_new(&p, &v, false, NULL);
    ck_assert_int_eq(rad_eye_open(e, &h, NULL), 0);
    for (int y = EDGE; y < N - EDGE; y++) {
        rad_eye_row(e, &h, y, row);
        for (int x = EDGE; x < N - EDGE; x++)
            ck_assert_float_eq_tol(row[x].g, p.L[y * N + x].g, 1e-9f);
    }
    rad_eye_free(e);
    rad_picture_release(&p);
}

/* Edges whose sides have the light of their pixels change nothing: they are
 * under the veil of where they are. */
TEST(an_edge_has_its_pixels_veil)
{
    enum { W = 32, H = 24 };
    static uint8_t code[H * RAD_EDGE_ROW_BYTES(W) + RAD_EDGE_END_BYTES];
    struct rad_tone_options o = choose(RAD_TONE_HUMAN);
    struct rad_tone tone = { 0 };
    struct rad_picture p = blank(W, H), other = blank(W, H);
    size_t n = 0;

    for (int y = 0; y < H; y++) {
        struct rad_edge edge[W];

        for (int x = 0; x < W; x++) {
            struct rad_rgb L = rad_grey(x < 4 && y > 9 ? 1024 : .0625f);

            p.L[y * W + x] = other.L[y * W + x] = L;
            edge[x] = (struct rad_edge){ x, .5f, L, L };
        }
        n += rad_edge_encode_row(edge, W, code + n);
    }
    rad_edge_encode_end(n, code + n);
    n += RAD_EDGE_END_BYTES;
    ck_assert_int_eq(rad_edges_read(code, n, W, H, &p.edges, NULL), 0);
    ck_assert_int_eq(rad_edges_count(&p.edges, 1), W);
    apply(&o, &tone, &other, NULL);
    ck_assert(tone.human.veil && !tone.human.acuity);
    apply(&o, &tone, &p, NULL);
    /* RGBE, of which edges are, is .4 % off */
    for (int i = 0; i < W * H; i++)
        ck_assert_float_eq_tol(p.L[i].g, other.L[i].g, .01f * other.L[i].g);
    rad_picture_release(&p);
    rad_picture_release(&other);
}

/* --- primaries --- */

TEST(primaries_become_srgbs)
{
    static const double srgb[8] = {
        .64, .33, .30, .60, .15, .06, .3127, .3290
    };
    static const double adobe[8] = {
        .64, .33, .21, .71, .15, .06, .3127, .3290
    };
    static const double radiance[8] = { .64, .33, .29,    .60,
                                        .15, .06, 1 / 3., 1 / 3. };
    static const double none[8] = { .3, .3, .3, .3, .3, .3, .3, .3 };
    /* as published for Adobe RGB (1998) */
    static const double want[3][3] = { { 1.3984, -.3984, 0 },
                                       { 0, 1, 0 },
                                       { 0, -.0429, 1.0429 } };
    double m[3][3];

    ck_assert(!rad_primaries_matrix(none, m));
    ck_assert(rad_primaries_matrix(srgb, m));
    for (int i = 0; i < 9; i++)
        ck_assert_double_eq_tol(m[i / 3][i % 3], i % 4 == 0, 1e-9);
    ck_assert(rad_primaries_matrix(adobe, m));
    for (int i = 0; i < 9; i++)
        ck_assert_double_eq_tol(m[i / 3][i % 3], want[i / 3][i % 3], 1e-4);
    ck_assert(rad_primaries_matrix(radiance, m));
    for (int i = 0; i < 3; i++) /* another white, and it is white */
        ck_assert_double_eq_tol(m[i][0] + m[i][1] + m[i][2], 1, 1e-9);
}

static const char swapped[] =
    "#?RADIANCE\nPRIMARIES= .29 .60 .64 .33 .15 .06 .3333333 .3333333\n"
    "FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\200\100\040\201";

/* One whose red and green have changed places. */
TEST(a_picture_of_other_primaries_is_understood)
{
    struct rad_picture p;

    ck_assert_int_eq(
        rad_hdr_read((const uint8_t *)swapped, sizeof swapped - 1, 1, &p, NULL),
        0);
    ck_assert(p.other_primaries);
    ck_assert_float_gt(p.L[0].r, 1.9f * p.L[0].g);
    rad_primaries_convert(&p);
    ck_assert(!p.other_primaries);
    ck_assert_float_gt(p.L[0].g, 1.9f * p.L[0].r);
    rad_picture_release(&p);
}
