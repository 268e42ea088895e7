/* filter.c - see filter.h
 *
 * Weights come from a table by squared distance in steps of 1/20, as in pfilt,
 * so they are no product of a row's and a column's weight.  If pixels have a
 * whole number of samples, all pixels of a row have the same weights, and eight
 * pixels are summed at a time.  For that the samples of a row are sorted by
 * their place within a pixel ("phase"), so that the eight are neighbours.  Both
 * ways a pixel's sums are made in the same order and come out the same. */
#include "config.h"

#include "image/filter.h"
#include "arith/elementary.h"
#include "base/number.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define RADIUS 0.6
#define CUTOFF 2.0 /* radii */
#define STEPS  20. /* of the table, for each squared radius */
#define TINY   1e-6

enum { TABLE = 444 * 4, BLOCK = 8 };

struct rad_filter {
    struct rad_filter_shape s;
    int columns, rows;     /* of the small picture */
    double xratio, yratio; /* small picture over large one */
    int xrad, yrad;        /* samples to each side of the middle */
    int phases;            /* 1, or the samples of a pixel in a row */
    int room;              /* samples of a row in each phase */
    int pushed, clamped, pulled;
    float table[TABLE];
    float step[256]; /* of a mantissa, by exponent */
    double *dx2;     /* for each pixel the squared distances of its columns */
    float *window;   /* 2 * yrad + 1 rows of 3 colours of phases of room */
    struct rad_rgb *raw; /* with clamp the last three rows, as they came */
    float *kernel;       /* weights of the pixels of a row */
    bool even;           /* all pixels of a row have the same weights */
    /* for edges: luminances of the rows of the window, then the least and the
     * largest of each column in it */
    float *lum;
};

int
rad_filter_side(int side, int n)
{
    return (int)(1. / n * side + .5);
}

double
rad_filter_pixaspect(const struct rad_filter_shape *s, double pixaspect)
{
    double x = (double)rad_filter_side(s->width, s->oversample) / s->width;
    double y = (double)rad_filter_side(s->height, s->oversample) / s->height;

    return x / y < .995 || x / y > 1.005 ? pixaspect * (x / y) : pixaspect;
}

int
rad_filter_middle(int side, int n, int i)
{
    return (int)((i + .5) * side / rad_filter_side(side, n));
}

void
rad_filter_options(const struct rad_params *p, int oversample, double clamp,
                   char text[RAD_FILTER_OPTIONS])
{
    size_t n = 0, size = RAD_FILTER_OPTIONS;
    struct rad_params written = *p;
    char factor[RAD_NUMBER_TEXT];

    if (oversample > 1) {
        written.xres /= oversample;
        written.yres /= oversample;
        n += (size_t)snprintf(text, size, "--oversample=%d ", oversample);
    }
    rad_format_real(factor, clamp);
    if (clamp > 0)
        n += (size_t)snprintf(text + n, size - n, "--clamp=%s ", factor);
    rad_params_format(&written, text + n, size - n);
}

/* --- weights --- */

static void
fill_tables(struct rad_filter *f)
{
    double flat = f->xratio * f->yratio * .25 / (RADIUS * RADIUS);

    for (int i = 0; i < TABLE; i++)
        f->table[i] = (float)rad_exp(-(i / STEPS <= flat ? flat : i / STEPS));
    f->step[0] = 0;
    for (int e = 1; e < 256; e++)
        f->step[e] = ldexpf(1, e - 136);
}

static float
weight(const struct rad_filter *f, double d2)
{
    return f->table[(int)(STEPS * d2 + .5)];
}

static double
distance2(double ratio, int sample, int pixel)
{
    double d = (ratio * (sample + .5) - (pixel + .5)) / RADIUS;

    return d * d;
}

static int
taps(const struct rad_filter *f)
{
    return 2 * f->xrad + 1;
}

static const double *
dx2_of(const struct rad_filter *f, int column)
{
    return f->dx2 + (size_t)column * (size_t)taps(f);
}

static int
column_middle(const struct rad_filter *f, int column)
{
    return (int)((column + .5) * f->s.width / f->columns);
}

/* Fill dx2, and find out whether it is the same for all pixels. */
static void
fill_distances(struct rad_filter *f)
{
    double *d = f->dx2;

    f->even = f->s.width == f->phases * f->columns;
    for (int c = 0; c < f->columns; c++) {
        int x = column_middle(f, c) - f->xrad;

        for (int i = 0; i < taps(f); i++, d++) {
            *d = distance2(f->xratio, x + i, c);
            f->even &= fabs(*d - f->dx2[i]) < 1e-9;
        }
    }
}

/* Fill in the kernel for a row of pixels, whose window begins at sample row y0
 * and has n rows.  False: by rounding, weights may differ between pixels. */
static bool
fill_kernel(struct rad_filter *f, int row, int y0, int n, double *sum)
{
    float *k = f->kernel;

    *sum = TINY;
    for (int j = 0; j < n; j++) {
        double dy2 = distance2(f->yratio, y0 + j, row);

        for (int i = 0; i < taps(f); i++) {
            double at = STEPS * (f->dx2[i] + dy2) + .5;

            /* with halves, quarters and eighths nothing is rounded */
            if (f->s.oversample & (f->s.oversample - 1) &&
                fabs(at - rint(at)) < 1e-6)
                return false;
            *sum += *k++ = weight(f, f->dx2[i] + dy2);
        }
    }
    return true;
}

/* --- the window --- */

/* One phase of one colour of sample row y. */
static float *
plane(const struct rad_filter *f, int y, int colour, int phase)
{
    size_t row = (size_t)(y % (2 * f->yrad + 1));

    return f->window +
           ((row * 3 + (size_t)colour) * (size_t)f->phases + (size_t)phase) *
               (size_t)f->room;
}

/* The column of a sample that is in a pixel's window; -1: beyond the picture.
 */
static int
column_of(const struct rad_filter *f, int x)
{
    if (x >= 0 && x < f->s.width)
        return x;
    x += x < 0 ? f->s.width : -f->s.width;
    return f->s.around && x >= 0 && x < f->s.width ? x : -1;
}

/* For edges: the least luminance of each column in the window; the largest ones
 * are behind. */
static float *
least_of_columns(const struct rad_filter *f)
{
    return f->lum + (2 * (size_t)f->yrad + 1) * (size_t)f->s.width;
}

static float *
luminances(const struct rad_filter *f, int y)
{
    return f->lum + (size_t)(y % (2 * f->yrad + 1)) * (size_t)f->s.width;
}

static struct rad_rgb
sample(const struct rad_filter *f, const uint8_t *rgbe)
{
    float step = f->step[rgbe[3]];

    return rad_rgb((rgbe[0] + .5f) * step, (rgbe[1] + .5f) * step,
                   (rgbe[2] + .5f) * step);
}

static void
keep_row(struct rad_filter *f, int y, const struct rad_rgb *row)
{
    for (int p = 0; p < f->phases; p++) {
        float *r = plane(f, y, 0, p), *g = plane(f, y, 1, p);
        float *b = plane(f, y, 2, p);

        for (int x = p; x < f->s.width; x += f->phases) {
            *r++ = row[x].r;
            *g++ = row[x].g;
            *b++ = row[x].b;
        }
    }
    for (int x = 0; f->lum && x < f->s.width; x++)
        luminances(f, y)[x] = rad_rgb_lum(row[x]);
}

/* --- fireflies --- */

static struct rad_rgb *
raw_row(const struct rad_filter *f, int y)
{
    return f->raw + (size_t)(y % 3) * (size_t)f->s.width;
}

static double
amount(struct rad_rgb L)
{
    return (double)L.r + L.g + L.b;
}

/* The mean amount of a sample's neighbours. */
static double
mean_about(const struct rad_filter *f, int x, int y)
{
    int n = 0, last = f->s.width - 1;
    double sum = 0;

    for (int v = y > 0 ? y - 1 : 0; v <= y + 1 && v < f->s.height; v++)
        for (int u = x - 1; u <= x + 1; u++) {
            int at = u < 0 ? last : u > last ? 0 : u;

            if ((u == x && v == y) || (at != u && !f->s.around))
                continue;
            sum += amount(raw_row(f, v)[at]);
            n++;
        }
    return n > 0 ? sum / n : INFINITY;
}

/* Clamp row y, whose neighbours are there, and put it into the window. */
static void
clamp_row(struct rad_filter *f, int y, struct rad_rgb *to)
{
    const struct rad_rgb *row = raw_row(f, y);

    for (int x = 0; x < f->s.width; x++) {
        double has = amount(row[x]);
        double most = has > 0 ? f->s.clamp * mean_about(f, x, y) : 0;

        to[x] = has > most ? rad_rgb_scale(row[x], most / has) : row[x];
    }
    keep_row(f, y, to);
}

/* --- sums --- */

/* Compute a single pixel: one at an edge, or with weights of its own. */
static struct rad_rgb
pixel_alone(const struct rad_filter *f, int column, int row, int y0, int y1)
{
    int x0 = column_middle(f, column) - f->xrad, n = f->phases;
    const double *dx2 = dx2_of(f, column);
    struct rad_rgb sum = rad_grey(0);
    double all = TINY;

    for (int y = y0; y < y1; y++) {
        double dy2 = distance2(f->yratio, y, row);

        for (int i = 0; i < taps(f); i++) {
            int x = column_of(f, x0 + i);
            float w;

            if (x < 0)
                continue;
            w = weight(f, dx2[i] + dy2);
            all += w;
            sum.r += w * plane(f, y, 0, x % n)[x / n];
            sum.g += w * plane(f, y, 1, x % n)[x / n];
            sum.b += w * plane(f, y, 2, x % n)[x / n];
        }
    }
    all = 1 / all;
    return rad_rgb((float)(sum.r * all), (float)(sum.g * all),
                   (float)(sum.b * all));
}

static void
add_weighed(float *restrict sum, const float *restrict from, float w)
{
    for (int k = 0; k < BLOCK; k++)
        sum[k] += w * from[k];
}

/* Compute BLOCK pixels from a column on.  All their samples lie in the picture;
 * the kernel has their weights, whose sum is `all`. */
static void
block(const struct rad_filter *f, int column, int y0, int y1, double all,
      struct rad_rgb *out)
{
    float sum[3][BLOCK] = { { 0 } };
    const float *w = f->kernel;
    int x0 = column_middle(f, column) - f->xrad;

    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x0 + taps(f); x++, w++)
            for (int c = 0; c < 3; c++)
                add_weighed(sum[c],
                            plane(f, y, c, x % f->phases) + x / f->phases, *w);
    all = 1 / all;
    for (int k = 0; k < BLOCK; k++)
        out[k] = rad_rgb((float)(sum[0][k] * all), (float)(sum[1][k] * all),
                         (float)(sum[2][k] * all));
}

/* Do all samples of BLOCK pixels from that column on lie in the picture? */
static bool
is_inside(const struct rad_filter *f, int column)
{
    return column + BLOCK <= f->columns &&
           column_middle(f, column) >= f->xrad &&
           column_middle(f, column + BLOCK - 1) + f->xrad < f->s.width;
}

/* --- rows --- */

void
rad_filter_push(struct rad_filter *f, const uint8_t *rgbe)
{
    int y = f->pushed++;
    struct rad_rgb *row = raw_row(f, f->s.clamp > 0 ? y : 0);
    struct rad_rgb *to = f->raw + 3 * (size_t)f->s.width;

    for (int x = 0; x < f->s.width; x++)
        row[x] = sample(f, rgbe + 4 * (size_t)x);
    if (!(f->s.clamp > 0)) {
        keep_row(f, y, row);
        f->clamped = f->pushed;
        return;
    }
    if (y > 0)
        clamp_row(f, f->clamped++, to);
    if (f->pushed == f->s.height)
        clamp_row(f, f->clamped++, to);
}

/* The next row of pixels, and the sample rows [*y0, *y1) of its window; false:
 * they are not there yet, or there is no next row. */
static bool
next_row(struct rad_filter *f, int *row, int *y0, int *y1)
{
    int middle = (int)((f->pulled + .5) * f->s.height / f->rows);

    if (f->pulled == f->rows)
        return false;
    *y0 = middle > f->yrad ? middle - f->yrad : 0;
    *y1 = middle + f->yrad + 1;
    *y1 = *y1 < f->s.height ? *y1 : f->s.height;
    if (f->clamped < *y1)
        return false;
    *row = f->pulled++;
    return true;
}

bool
rad_filter_pull(struct rad_filter *f, struct rad_rgb *out)
{
    int row, y0, y1, c = 0;
    double all = 1; /* sum of the kernel, if it is used */
    bool even;

    if (!next_row(f, &row, &y0, &y1))
        return false;
    even = f->even && fill_kernel(f, row, y0, y1 - y0, &all);
    while (c < f->columns)
        if (even && is_inside(f, c)) {
            block(f, c, y0, y1, all, out + c);
            c += BLOCK;
        } else {
            out[c] = pixel_alone(f, c, row, y0, y1);
            c++;
        }
    return true;
}

/* --- edges --- */

/* The luminances of samples. */
struct range {
    float least, most;
};

/* Fill in the least and the largest luminance of each column in sample rows
 * [y0, y1). */
static void
fill_columns(struct rad_filter *f, int y0, int y1)
{
    size_t width = (size_t)f->s.width;
    float *least = least_of_columns(f), *most = least + width;

    memcpy(least, luminances(f, y0), width * sizeof *least);
    memcpy(most, least, width * sizeof *most);
    for (int y = y0 + 1; y < y1; y++) {
        const float *lum = luminances(f, y);

        for (size_t x = 0; x < width; x++) {
            least[x] = lum[x] < least[x] ? lum[x] : least[x];
            most[x] = lum[x] > most[x] ? lum[x] : most[x];
        }
    }
}

static struct range
range_of(const struct rad_filter *f, int column)
{
    int x0 = column_middle(f, column) - f->xrad;
    const float *least = least_of_columns(f), *most = least + f->s.width;
    struct range r = { INFINITY, 0 };

    for (int i = 0; i < taps(f); i++) {
        int x = column_of(f, x0 + i);

        if (x < 0)
            continue;
        r.least = least[x] < r.least ? least[x] : r.least;
        r.most = most[x] > r.most ? most[x] : r.most;
    }
    return r;
}

/* Tell the samples of a pixel apart by a luminance, in *edge; false: all count
 * for one side. */
static bool
tell_apart(const struct rad_filter *f, int row, int y0, int y1, float lum,
           struct rad_edge *edge)
{
    int x0 = column_middle(f, edge->x) - f->xrad;
    const double *dx2 = dx2_of(f, edge->x);
    float sum[2][4] = { { 0 } }; /* of colours and weights */

    for (int y = y0; y < y1; y++) {
        double dy2 = distance2(f->yratio, y, row);
        const float *r = plane(f, y, 0, 0), *g = plane(f, y, 1, 0);
        const float *b = plane(f, y, 2, 0), *l = luminances(f, y);

        for (int i = 0; i < taps(f); i++) {
            int x = column_of(f, x0 + i);
            float w, *to;

            if (x < 0)
                continue;
            to = sum[l[x] > lum];
            w = weight(f, dx2[i] + dy2);
            to[0] += w * r[x];
            to[1] += w * g[x];
            to[2] += w * b[x];
            to[3] += w;
        }
    }
    if (!(sum[0][3] > 0 && sum[1][3] > 0))
        return false;
    edge->share = sum[1][3] / (sum[0][3] + sum[1][3]);
    edge->dark =
        rad_rgb_scale(rad_rgb(sum[0][0], sum[0][1], sum[0][2]), 1 / sum[0][3]);
    edge->bright =
        rad_rgb_scale(rad_rgb(sum[1][0], sum[1][1], sum[1][2]), 1 / sum[1][3]);
    return true;
}

/* The luminance that parts the samples of an edge: the middle of their range by
 * ratio, of which what is darker than a thousandth of the brightest is no part.
 */
static float
parting(struct range r)
{
    return r.most * sqrtf(fmaxf(r.least / r.most, 1e-3f));
}

int
rad_filter_pull_edges(struct rad_filter *f, struct rad_edge *edge)
{
    int row, y0, y1, n = 0;

    if (!next_row(f, &row, &y0, &y1))
        return -1;
    fill_columns(f, y0, y1);
    for (int c = 0; c < f->columns; c++) {
        struct range r = range_of(f, c);

        edge[n].x = c;
        if (r.most > RAD_EDGE_CONTRAST * r.least &&
            tell_apart(f, row, y0, y1, parting(r), &edge[n]))
            n++;
    }
    return n;
}

void
rad_filter_free(struct rad_filter *f)
{
    if (!f)
        return;
    free(f->dx2);
    free(f->window);
    free(f->raw);
    free(f->kernel);
    free(f->lum);
    free(f);
}

int
rad_filter_new(struct rad_filter **to, const struct rad_filter_shape *s,
               struct rad_error *err)
{
    struct rad_filter *f = calloc(1, sizeof *f);
    size_t width = (size_t)s->width, high;

    *to = f;
    if (!f)
        return rad_fail_memory(err);
    f->s = *s;
    f->columns = rad_filter_side(s->width, s->oversample);
    f->rows = rad_filter_side(s->height, s->oversample);
    f->xratio = (double)f->columns / s->width;
    f->yratio = (double)f->rows / s->height;
    f->xrad = (int)(CUTOFF * RADIUS / f->xratio + 1);
    f->yrad = (int)(CUTOFF * RADIUS / f->yratio + 1);
    f->phases = s->width == s->oversample * f->columns ? s->oversample : 1;
    f->room = (s->width + f->phases - 1) / f->phases;
    high = 2 * (size_t)f->yrad + 1;
    f->dx2 = calloc((size_t)f->columns * (size_t)taps(f), sizeof *f->dx2);
    f->window = calloc(high * 3 * (size_t)f->phases * (size_t)f->room,
                       sizeof *f->window);
    f->raw = calloc(4 * width, sizeof *f->raw);
    f->kernel = calloc(high * (size_t)taps(f), sizeof *f->kernel);
    if (!f->dx2 || !f->window || !f->raw || !f->kernel) {
        rad_filter_free(f);
        *to = NULL;
        return rad_fail_memory(err);
    }
    fill_tables(f);
    fill_distances(f);
    return 0;
}

int
rad_filter_new_edges(struct rad_filter **to, const struct rad_filter_shape *s,
                     struct rad_error *err)
{
    int rc = rad_filter_new(to, s, err);
    struct rad_filter *f = *to;

    if (rc < 0)
        return rc;
    f->phases = 1; /* samples are looked at where they are */
    f->room = s->width;
    f->lum =
        calloc((2 * (size_t)f->yrad + 3) * (size_t)s->width, sizeof *f->lum);
    if (f->lum)
        return 0;
    rad_filter_free(f);
    *to = NULL;
    return rad_fail_memory(err);
}
