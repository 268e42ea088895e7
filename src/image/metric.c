/* metric.c - see metric.h */
#include "config.h"

#include "image/metric.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The mean of an n by n block whose first pixel is p. */
static struct rad_rgb
block_mean(const struct rad_rgb *p, int width, int n)
{
    double r = 0, g = 0, b = 0, area = (double)n * n;

    for (int y = 0; y < n; y++)
        for (int x = 0; x < n; x++) {
            const struct rad_rgb *c = &p[(size_t)y * (size_t)width + (size_t)x];

            r += c->r;
            g += c->g;
            b += c->b;
        }
    return rad_rgb((float)(r / area), (float)(g / area), (float)(b / area));
}

int
rad_picture_blocks(const struct rad_picture *in, int n, struct rad_picture *out,
                   struct rad_error *err)
{
    memset(out, 0, sizeof *out);
    if (in->width < n || in->height < n)
        return rad_fail(err, RAD_EDATA,
                        "%d by %d pixels have no block of %d by %d", in->width,
                        in->height, n, n);
    out->width = in->width / n;
    out->height = in->height / n;
    out->pixaspect = in->pixaspect;
    out->L = malloc(rad_picture_pixels(out) * sizeof *out->L);
    if (!out->L)
        return rad_fail_memory(err);
    for (int y = 0; y < out->height; y++)
        for (int x = 0; x < out->width; x++)
            out->L[(size_t)y * (size_t)out->width + (size_t)x] = block_mean(
                in->L + (size_t)(y * n) * (size_t)in->width + (size_t)(x * n),
                in->width, n);
    return 0;
}

static double
mean_of(const struct rad_picture *p)
{
    size_t n = rad_picture_pixels(p);
    double sum = 0;

    for (size_t i = 0; i < n; i++)
        sum += (double)p->L[i].r + p->L[i].g + p->L[i].b;
    return sum / (3 * (double)n);
}

static void
clip(struct rad_picture *p, double most)
{
    size_t n = rad_picture_pixels(p);
    float m = (float)most;

    for (size_t i = 0; i < n; i++)
        p->L[i] = rad_rgb(fminf(p->L[i].r, m), fminf(p->L[i].g, m),
                          fminf(p->L[i].b, m));
}

/* Average a picture in blocks, in place. */
static int
reduce(struct rad_picture *p, int n, struct rad_error *err)
{
    struct rad_picture out;
    int rc;

    if (n <= 1)
        return 0;
    rc = rad_picture_blocks(p, n, &out, err);
    if (rc < 0)
        return rc;
    rad_picture_release(p);
    *p = out;
    return 0;
}

static int
check_finite(const struct rad_picture *p, struct rad_error *err)
{
    size_t n = rad_picture_pixels(p);

    for (size_t i = 0; i < n; i++)
        if (!isfinite(p->L[i].r + p->L[i].g + p->L[i].b))
            return rad_fail(err, RAD_EDATA,
                            "picture has a value that is not finite");
    return 0;
}

static int
bring_together(struct rad_picture *a, struct rad_picture *b,
               const struct rad_metric_options *o, struct rad_error *err)
{
    int rc;

    if (o->down > 1 && (a->width % o->down || a->height % o->down))
        return rad_fail(err, RAD_EDATA, "%dx%d is not a multiple of %d",
                        a->width, a->height, o->down);
    if ((rc = reduce(a, o->down, err)) < 0)
        return rc;
    if (a->width != b->width || a->height != b->height)
        return rad_fail(err, RAD_EDATA, "sizes differ: %dx%d and %dx%d",
                        a->width, a->height, b->width, b->height);
    if (o->clip > 0) {
        double most = o->clip * mean_of(b);

        clip(a, most);
        clip(b, most);
    }
    if ((rc = reduce(a, o->block, err)) < 0 ||
        (rc = reduce(b, o->block, err)) < 0 || (rc = check_finite(a, err)) < 0)
        return rc;
    return check_finite(b, err);
}

int
rad_metric_prepare(const struct rad_picture *test,
                   const struct rad_picture *ref,
                   const struct rad_metric_options *o, struct rad_picture *a,
                   struct rad_picture *b, struct rad_error *err)
{
    int rc;

    memset(b, 0, sizeof *b);
    if ((rc = rad_picture_blocks(test, 1, a, err)) == 0 &&
        (rc = rad_picture_blocks(ref, 1, b, err)) == 0)
        rc = bring_together(a, b, o, err);
    if (rc < 0) {
        rad_picture_release(a);
        rad_picture_release(b);
    }
    return rc;
}

/* In double, weights included: for pictures that are nearly alike the rounding
 * of a float would be 1e-4 of the difference. */
static double
luminance(struct rad_rgb c)
{
    return .265074126 * c.r + .670114631 * c.g + .064811243 * c.b;
}

static double
mean_luminance(const struct rad_picture *p)
{
    size_t n = rad_picture_pixels(p);
    double sum = 0;

    for (size_t i = 0; i < n; i++)
        sum += luminance(p->L[i]);
    return sum / (double)n;
}

static int
by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;

    return x < y ? -1 : x > y;
}

/* A percentile of sorted values, interpolated between neighbours. */
static double
percentile(const double *v, size_t n, double percent)
{
    double at = percent / 100 * (double)(n - 1);
    size_t i = (size_t)at;

    return i + 1 < n ? v[i] + (at - (double)i) * (v[i + 1] - v[i]) : v[n - 1];
}

int
rad_metric_compare(const struct rad_picture *a, const struct rad_picture *b,
                   struct rad_metric *m, struct rad_error *err)
{
    size_t n = rad_picture_pixels(b);
    double mean = mean_of(b), lum = mean_luminance(b), e = 1e-3 * lum;
    double square = 0, logs = 0, most = 0;
    double *rel;

    if (!(lum > 0))
        return rad_fail(err, RAD_EDATA, "reference picture is black");
    rel = malloc(n * sizeof *rel);
    if (!rel)
        return rad_fail_memory(err);
    for (size_t i = 0; i < n; i++) {
        double r = (double)a->L[i].r - b->L[i].r;
        double g = (double)a->L[i].g - b->L[i].g;
        double bl = (double)a->L[i].b - b->L[i].b;
        double la = luminance(a->L[i]), lb = luminance(b->L[i]);
        double ratio = log((la + e) / (lb + e));

        square += r * r + g * g + bl * bl;
        most = fmax(most, fmax(fabs(r), fmax(fabs(g), fabs(bl))));
        logs += ratio * ratio;
        rel[i] = fabs(la - lb) / (lb + e);
    }
    qsort(rel, n, sizeof *rel, by_value);
    m->mean_ratio = mean_luminance(a) / lum;
    m->nrmse = sqrt(square / (3 * (double)n)) / mean;
    m->log_rmse = sqrt(logs / (double)n);
    m->p50 = percentile(rel, n, 50);
    m->p95 = percentile(rel, n, 95);
    m->p99_9 = percentile(rel, n, 99.9);
    m->max = rel[n - 1];
    m->maxabs = most / mean;
    free(rel);
    return 0;
}
