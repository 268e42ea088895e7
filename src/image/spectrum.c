/* spectrum.c - see spectrum.h
 *
 * All steps but the last are linear, so a sample has one weight per channel. */
#include "config.h"

#include "image/spectrum.h"

#include <math.h>

/* The observer's response at 360 nm, 365 nm, ...: X, Y, Z. */
#define FIRST 360
#define STEP  5
static const double observer[][3] = {
    { 0.0001299, 3.917e-06, 0.0006061 },
    { 0.0002321, 6.965e-06, 0.001086 },
    { 0.0004149, 1.239e-05, 0.001946 },
    { 0.0007416, 2.202e-05, 0.003486 },
    { 0.001368, 3.9e-05, 0.00645 },
    { 0.002236, 6.4e-05, 0.01055 },
    { 0.004243, 0.00012, 0.02005 },
    { 0.00765, 0.000217, 0.03621 },
    { 0.01431, 0.000396, 0.06785 },
    { 0.02319, 0.00064, 0.1102 },
    { 0.04351, 0.00121, 0.2074 },
    { 0.07763, 0.00218, 0.3713 },
    { 0.13438, 0.004, 0.6456 },
    { 0.21477, 0.0073, 1.03905 },
    { 0.2839, 0.0116, 1.3856 },
    { 0.3285, 0.01684, 1.62296 },
    { 0.34828, 0.023, 1.74706 },
    { 0.34806, 0.0298, 1.7826 },
    { 0.3362, 0.038, 1.77211 },
    { 0.3187, 0.048, 1.7441 },
    { 0.2908, 0.06, 1.6692 },
    { 0.2511, 0.0739, 1.5281 },
    { 0.19536, 0.09098, 1.28764 },
    { 0.1421, 0.1126, 1.0419 },
    { 0.09564, 0.13902, 0.81295 },
    { 0.05795, 0.1693, 0.6162 },
    { 0.03201, 0.20802, 0.46518 },
    { 0.0147, 0.2586, 0.3533 },
    { 0.0049, 0.323, 0.272 },
    { 0.0024, 0.4073, 0.2123 },
    { 0.0093, 0.503, 0.1582 },
    { 0.0291, 0.6082, 0.1117 },
    { 0.06327, 0.71, 0.07825 },
    { 0.1096, 0.7932, 0.05725 },
    { 0.1655, 0.862, 0.04216 },
    { 0.22575, 0.91485, 0.02984 },
    { 0.2904, 0.954, 0.0203 },
    { 0.3597, 0.9803, 0.0134 },
    { 0.43345, 0.99495, 0.00875 },
    { 0.51205, 1, 0.00575 },
    { 0.5945, 0.995, 0.0039 },
    { 0.6784, 0.9786, 0.00275 },
    { 0.7621, 0.952, 0.0021 },
    { 0.8425, 0.9154, 0.0018 },
    { 0.9163, 0.87, 0.00165 },
    { 0.9786, 0.8163, 0.0014 },
    { 1.0263, 0.757, 0.0011 },
    { 1.0567, 0.6949, 0.001 },
    { 1.0622, 0.631, 0.0008 },
    { 1.0456, 0.5668, 0.0006 },
    { 1.0026, 0.503, 0.00034 },
    { 0.9384, 0.4412, 0.00024 },
    { 0.85445, 0.381, 0.00019 },
    { 0.7514, 0.321, 0.0001 },
    { 0.6424, 0.265, 5e-05 },
    { 0.5419, 0.217, 3e-05 },
    { 0.4479, 0.175, 2e-05 },
    { 0.3608, 0.1382, 1e-05 },
    { 0.2835, 0.107, 0 },
    { 0.2187, 0.0816, 0 },
    { 0.1649, 0.061, 0 },
    { 0.1212, 0.04458, 0 },
    { 0.0874, 0.032, 0 },
    { 0.0636, 0.0232, 0 },
    { 0.04677, 0.017, 0 },
    { 0.0329, 0.01192, 0 },
    { 0.0227, 0.00821, 0 },
    { 0.01584, 0.005723, 0 },
    { 0.011359, 0.004102, 0 },
    { 0.008111, 0.002929, 0 },
    { 0.00579, 0.002091, 0 },
    { 0.004109, 0.001484, 0 },
    { 0.002899, 0.001047, 0 },
    { 0.002049, 0.00074, 0 },
    { 0.00144, 0.00052, 0 },
    { 0.001, 0.000361, 0 },
    { 0.00069, 0.000249, 0 },
    { 0.000476, 0.000172, 0 },
    { 0.000332, 0.00012, 0 },
    { 0.000235, 8.5e-05, 0 },
    { 0.000166, 6e-05, 0 },
    { 0.000117, 4.2e-05, 0 },
    { 8.3e-05, 3e-05, 0 },
    { 5.9e-05, 2.1e-05, 0 },
    { 4.2e-05, 1.5e-05, 0 },
};
enum {
    NOBSERVER = sizeof observer / sizeof observer[0],
    NWAVES = STEP * (NOBSERVER - 1) + 1
};

struct rad_spectrum {
    bool as_it_is;     /* sums are channels already: none is made paler */
    double (*part)[3]; /* by sample: its weight in each channel */
};

/* The observer at FIRST + i nm, by the cubic through the four nearest values of
 * the table, as CIE 167:2005 recommends. */
static double
observe(int i, int channel)
{
    int k = i / STEP - 1;
    double x, sum = 0;

    k = k < 0 ? 0 : k > NOBSERVER - 4 ? NOBSERVER - 4 : k;
    x = (double)i / STEP - k;
    for (int a = 0; a < 4; a++) {
        double w = 1;

        for (int b = 0; b < 4; b++)
            if (b != a)
                w *= (x - b) / (a - b);
        sum += w * observer[k + a][channel];
    }
    return sum;
}

/* The part of the observer's total response that is below FIRST + i nm. */
struct seen {
    double below[NWAVES + 1][3];
};

static void
add_up(struct seen *seen)
{
    for (int c = 0; c < 3; c++) {
        double sum = 0;

        for (int i = 0; i < NWAVES; i++) {
            seen->below[i][c] = sum;
            sum += observe(i, c);
        }
        for (int i = 0; i < NWAVES; i++)
            seen->below[i][c] /= sum;
        seen->below[NWAVES][c] = 1;
    }
}

/* As in Radiance, a sum contains up to one nanometre above a band's edge. */
static const double *
seen_below(const struct seen *seen, double nm)
{
    double i = floor(nm) - FIRST + 2;

    return seen->below[i < 0 ? 0 : i > NWAVES ? NWAVES : (int)i];
}

/* Red, green and blue of a spectrum that is 1 in this band. */
static void
band_colour(const struct seen *seen, double longer, double shorter,
            double rgb[3])
{
    static const double matrix[3][3] = {
        { 2.56531285, -1.16684962, -.39846323 },
        { -1.02210817, 1.97828662, .04382156 },
        { .07472437, -.25193956, 1.17721519 }
    };
    const double *up = seen_below(seen, longer),
                 *low = seen_below(seen, shorter);

    for (int k = 0; k < 3; k++) {
        rgb[k] = 0;
        for (int c = 0; c < 3; c++)
            rgb[k] += matrix[k][c] * (up[c] - low[c]);
    }
}

/* The colours of n bands, the longest waves first; three bands are the
 * channels. */
static void
band_colours(int n, double longest, double shortest, double (*rgb)[3])
{
    double step = (longest - shortest) / n;
    struct seen seen;

    add_up(&seen);
    for (int i = 0; i < n; i++)
        if (n == 3)
            for (int k = 0; k < 3; k++)
                rgb[i][k] = i == k;
        else
            band_colour(&seen, i == 0 ? longest : shortest + (n - i) * step,
                        shortest + (n - 1 - i) * step, rgb[i]);
}

/* The fraction of band j of n that wavelengths a to b fill. */
static double
filled(double a, double b, int j, int n, const struct rad_bands *range)
{
    double step = (range->longest - range->shortest) / n;
    double longer = a > b ? a : b, shorter = a > b ? b : a;
    double up = range->longest - j * step, low = up - step;
    double common =
        (longer < up ? longer : up) - (shorter > low ? shorter : low);

    return common > 0 ? common / step : 0;
}

/* The weights of a sample of wavelengths a to b, over n bands of the range. */
static void
spread(double a, double b, int n, const struct rad_bands *range,
       double (*rgb)[3], double part[3])
{
    part[0] = part[1] = part[2] = 0;
    for (int j = 0; j < n; j++) {
        double f = filled(a, b, j, n, range);

        for (int k = 0; k < 3; k++)
            part[k] += f * rgb[j][k];
    }
}

/* The number of bands that Radiance makes of n samples.  If it were below three
 * in the visible range, the most possible are made. */
static int
count_bands(int n, double begin, double end, const struct rad_bands *range)
{
    double visible = range->longest - range->shortest;
    double bands = floor(n * visible / fabs(end - begin) + .99);

    return bands < 3 || bands > RAD_MAX_BANDS ? RAD_MAX_BANDS : (int)bands;
}

/* Set the weights of all samples for red, green and blue. */
static void
to_colours(struct rad_spectrum *sp, int n, double begin, double end,
           const struct rad_bands *range)
{
    double band[RAD_MAX_BANDS][3], step = (end - begin) / n;
    int nbands = n;

    if (n <= RAD_MAX_BANDS && begin > end) {
        band_colours(n, begin, end, sp->part);
    } else {
        nbands = count_bands(n, begin, end, range);
        band_colours(nbands, range->longest, range->shortest, band);
        for (int i = 0; i < n; i++)
            spread(begin + i * step, begin + (i + 1) * step, nbands, range,
                   band, sp->part[i]);
    }
    sp->as_it_is = nbands == 3;
}

/* Set the weights of all samples for the bands of a plane.  As in Radiance,
 * samples that have the wavelengths of the bands, but for a fraction of a
 * nanometre, are these bands. */
static void
to_bands(struct rad_spectrum *sp, int n, double begin, double end,
         const struct rad_bands *b)
{
    double step = (end - begin) / n, off0 = begin - b->longest,
           off1 = end - b->shortest;
    bool same = n == b->n && off0 * off0 + off1 * off1 <= .5;

    for (int i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            int j = rad_bands_of(b, b->plane, k);

            sp->part[i][k] = same ? i == j
                                  : filled(begin + i * step,
                                           begin + (i + 1) * step, j, b->n, b);
        }
    sp->as_it_is = true;
}

const struct rad_spectrum *
rad_spectrum_new(struct rad_arena *arena, int n, double begin, double end,
                 const struct rad_bands *to)
{
    struct rad_spectrum *sp = rad_arena_calloc(arena, 1, sizeof *sp);

    if (!sp ||
        !(sp->part = rad_arena_calloc(arena, (size_t)n, sizeof *sp->part)))
        return NULL;
    (rad_bands_are_rgb(to) ? to_colours : to_bands)(sp, n, begin, end, to);
    return sp;
}

bool
rad_spectrum_shows(const struct rad_spectrum *sp, int i)
{
    return sp->part[i][0] != 0 || sp->part[i][1] != 0 || sp->part[i][2] != 0;
}

void
rad_spectrum_add(const struct rad_spectrum *sp, int i, double sample,
                 double sum[3])
{
    for (int k = 0; k < 3; k++)
        sum[k] += sample * sp->part[i][k];
}

/* Where a channel is negative, mix in grey of the same luminance. */
void
rad_spectrum_colour(const struct rad_spectrum *sp, double sum[3])
{
    struct rad_rgb c = rad_rgb((float)sum[0], (float)sum[1], (float)sum[2]);
    double grey = (double)rad_rgb_lum(c), keep = 1;

    if (sp->as_it_is)
        return;
    for (int k = 0; k < 3 && grey > 0; k++)
        if (sum[k] < 0 && grey / (grey - sum[k]) < keep)
            keep = grey / (grey - sum[k]);
    for (int k = 0; k < 3; k++) {
        double v = grey > 0 ? keep * sum[k] + (1 - keep) * grey : 0;

        sum[k] = v > 0 ? v : 0;
    }
}
