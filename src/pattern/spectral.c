/* spectral.c - see spectral.h */
#include "config.h"

#include "pattern/spectral.h"
#include "image/spectrum.h"
#include "pattern/effect.h"
#include "pattern/stored.h"
#include "scene/file/data.h"

#include <math.h>
#include <string.h>

/* Places of a sample at which a specfunc is evaluated.  A part is nearly as
 * wide as a band, so its middle alone may overrate a narrow function or miss
 * it. */
enum { BAND_POINTS = 4 };

/* Samples that are looked up in data at a time. */
enum { AT_A_TIME = 32 };

struct spectral {
    struct rad_effect effect; /* expressions: the place in the data */
    const struct rad_spectrum *eye;
    int samples;
    double first, step; /* wavelengths: of the first sample, to the next */
    int points;         /* places of a sample where a function is evaluated */
    const struct rad_data *data;
    bool turned;   /* a picture, whose first dimension is y */
    int nshown;    /* samples that count in a channel, of data: */
    int *shown;    /* their numbers */
    double *nm;    /* and wavelengths */
    int call;      /* of the function */
    double rgb[3]; /* of a constant spectrum */
};

static bool
constant(struct rad_ctx *ctx, const struct rad_effect *e,
         const struct rad_ray *r, double value[3])
{
    const struct spectral *s = (const struct spectral *)e; /* first member */

    (void)ctx;
    (void)r;
    memcpy(value, s->rgb, sizeof s->rgb);
    return true;
}

/* The mean of the function over sample i. */
static bool
ask(struct rad_ctx *ctx, const struct spectral *s, int i, double *sample)
{
    *sample = 0;
    for (int k = 0; k < s->points; k++) {
        double at = i + (k + .5) / s->points - .5, v;
        double nm = s->first + at * s->step;

        if (!rad_expr_call(ctx, &s->effect.expr, s->call, &nm, &v))
            return false;
        *sample += v / s->points;
    }
    return true;
}

/* specfunc: a function of the wavelength. */
static bool
by_function(struct rad_ctx *ctx, const struct rad_effect *e,
            const struct rad_ray *r, double value[3])
{
    const struct spectral *s = (const struct spectral *)e;
    struct rad_expr_scope scope;
    double sum[3] = { 0 };

    rad_expr_begin(ctx, &e->expr, r, &scope);
    for (int i = 0; i < s->samples; i++) {
        double sample;

        if (!rad_spectrum_shows(s->eye, i))
            continue;
        if (!ask(ctx, s, i, &sample))
            return false;
        rad_spectrum_add(s->eye, i, sample, sum);
    }
    rad_spectrum_colour(s->eye, sum);
    memcpy(value, sum, sizeof sum);
    return true;
}

/* specdata, specpict: a function of data at a place, and of the wavelength. */
static bool
by_data(struct rad_ctx *ctx, const struct rad_effect *e,
        const struct rad_ray *r, double value[3])
{
    const struct spectral *s = (const struct spectral *)e;
    double place[RAD_MAX_DATA_DIMS], sum[3] = { 0 };
    struct rad_expr_scope scope;

    rad_expr_begin(ctx, &e->expr, r, &scope);
    if (!rad_expr_get(ctx, &e->expr, 0, e->expr.n, place))
        return false;
    if (s->turned) {
        double x = place[0];

        place[0] = place[1];
        place[1] = x;
    }
    for (int i = 0; i < s->nshown; i += AT_A_TIME) {
        int n = s->nshown - i < AT_A_TIME ? s->nshown - i : AT_A_TIME;
        double found[AT_A_TIME];

        rad_data_row(s->data, place, s->nm + i, n, found);
        for (int k = 0; k < n; k++) {
            double arg[2] = { found[k], s->nm[i + k] }, sample;

            if (!rad_expr_call(ctx, &e->expr, s->call, arg, &sample))
                return false;
            rad_spectrum_add(s->eye, s->shown[i + k], sample, sum);
        }
    }
    rad_spectrum_colour(s->eye, sum);
    memcpy(value, sum, sizeof sum);
    return true;
}

/* --- preparing ----------------------------------------------------------- */

/* Let there be n samples, at first, first + step, ..., each a step wide. */
static int
sample(struct rad_job *job, struct spectral *s, int n, double first,
       double step, struct rad_error *err)
{
    s->samples = n;
    s->first = first;
    s->step = step;
    s->eye = rad_spectrum_new(&job->arena, n, first - .5 * step,
                              first + (n - .5) * step, &job->params.bands);
    return s->eye ? 0 : rad_fail_memory(err);
}

static int
prepare_spectrum(struct rad_job *job, const struct rad_object *o,
                 struct spectral *s, struct rad_error *err)
{
    int n = o->nreals - 2;
    double step = (o->reals[1] - o->reals[0]) / (n - 1);
    int rc = sample(job, s, n, o->reals[0], step, err);

    if (rc < 0)
        return rc;
    for (int i = 0; i < n; i++)
        rad_spectrum_add(s->eye, i, o->reals[i + 2], s->rgb);
    rad_spectrum_colour(s->eye, s->rgb);
    return 0;
}

/* Take the samples from the data's last dimension, the wavelength. */
static int
sample_axis(struct rad_job *job, struct spectral *s, struct rad_error *err)
{
    double begin, length;
    int n;

    rad_data_axis(s->data, rad_data_dims(s->data) - 1, &begin, &length, &n);
    return sample(job, s, n, begin, length / (n - 1), err);
}

static int
prepare_file(struct rad_job *job, const struct rad_object *o,
             const struct rad_files *files, struct spectral *s,
             struct rad_error *err)
{
    int rc;

    s->data = rad_stored_data(job, o, files, o->strings[0], err);
    if (!s->data)
        return RAD_EDATA;
    if (rad_data_dims(s->data) != 1)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "'%s' has %d dimensions, expected 1",
                              o->strings[0], rad_data_dims(s->data));
    rc = sample_axis(job, s, err);
    for (int i = 0; rc == 0 && i < s->samples; i++) {
        double nm = s->first + i * s->step;

        rad_spectrum_add(s->eye, i, rad_data_value(s->data, &nm), s->rgb);
    }
    if (rc == 0)
        rad_spectrum_colour(s->eye, s->rgb);
    return rc;
}

static int
find_function(struct rad_job *job, const struct rad_object *o,
              struct spectral *s, int nargs, struct rad_error *err)
{
    s->call = rad_expr_function(job, o, &s->effect.expr, 0, nargs, err);
    return s->call < 0 ? s->call : 0;
}

/* Cut the wavelengths of a specfunc into parts, as Radiance does:
 * RAD_MAX_BANDS, but none narrower than a quarter of a band. */
static int
prepare_function(struct rad_job *job, const struct rad_object *o,
                 const struct rad_files *files, struct spectral *s,
                 struct rad_error *err)
{
    double a = o->reals[0], b = o->reals[1];
    const struct rad_bands *bands = &job->params.bands;
    double low = fmax(fmin(a, b), bands->shortest);
    double high = fmin(fmax(a, b), bands->longest);
    double step = fmax((high - low) / RAD_MAX_BANDS,
                       .25 / bands->n * (bands->longest - bands->shortest));
    int n = (int)((high - low) / step + .1), rc;

    if (!(low < high))
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "no wavelengths from %g to %g nm in %g to %g",
                              bands->shortest, bands->longest, a, b);
    n = n < 1 ? 1 : n;
    rc = rad_expr_prepare(job, o, files, 0, &s->effect.expr, err);
    if (rc == 0)
        rc = find_function(job, o, s, 1, err);
    if (rc < 0)
        return rc;
    s->samples = n;
    s->points = rad_bands_are_rgb(bands) ? 1 : BAND_POINTS;
    s->step = step;
    s->first = high - (n - .5) * step;
    s->eye = rad_spectrum_new(&job->arena, n, low, high, bands);
    return s->eye ? 0 : rad_fail_memory(err);
}

/* List the samples that count in a channel. */
static int
list_shown(struct rad_job *job, struct spectral *s, struct rad_error *err)
{
    size_t n = (size_t)s->samples;

    s->shown = rad_arena_alloc(&job->arena, n * sizeof *s->shown);
    s->nm = rad_arena_alloc(&job->arena, n * sizeof *s->nm);
    if (!s->shown || !s->nm)
        return rad_fail_memory(err);
    for (int i = 0; i < s->samples; i++)
        if (rad_spectrum_shows(s->eye, i)) {
            s->shown[s->nshown] = i;
            s->nm[s->nshown++] = s->first + i * s->step;
        }
    return 0;
}

static int
prepare_data(struct rad_job *job, const struct rad_object *o,
             const struct rad_files *files, struct spectral *s,
             struct rad_error *err)
{
    int dims, rc;

    s->turned = o->type == RAD_SPECPICT;
    s->data = s->turned ? rad_stored_specpict(job, o, files, o->strings[1], err)
                        : rad_stored_data(job, o, files, o->strings[1], err);
    if (!s->data)
        return RAD_EDATA;
    dims = rad_data_dims(s->data) - 1;
    if (dims < 1)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "'%s' has no dimension beside the wavelength's",
                              o->strings[1]);
    if (o->nstrings < 3 + dims)
        return rad_scene_fail(job->scene, o, err, RAD_EDATA,
                              "expected an expression for each of %d "
                              "dimensions",
                              dims);
    rc = rad_expr_prepare(job, o, files, ((1u << dims) - 1) << 3,
                          &s->effect.expr, err);
    if (rc == 0)
        rc = find_function(job, o, s, 2, err);
    if (rc == 0)
        rc = sample_axis(job, s, err);
    return rc == 0 ? list_shown(job, s, err) : rc;
}

int
rad_spectral_prepare(struct rad_job *job, int32_t index,
                     const struct rad_files *files, const void **data,
                     struct rad_error *err)
{
    const struct rad_object *o = &job->scene->objects[index];
    struct spectral *s = rad_arena_calloc(&job->arena, 1, sizeof *s);

    if (!s)
        return rad_fail_memory(err);
    *data = s;
    s->effect.values = constant;
    switch (o->type) {
    case RAD_SPECTRUM:
        return prepare_spectrum(job, o, s, err);
    case RAD_SPECFILE:
        return prepare_file(job, o, files, s, err);
    case RAD_SPECFUNC:
        s->effect.values = by_function;
        return prepare_function(job, o, files, s, err);
    default:
        s->effect.values = by_data;
        return prepare_data(job, o, files, s, err);
    }
}
