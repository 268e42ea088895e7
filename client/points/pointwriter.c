/* pointwriter.c - see pointwriter.h */
#include "config.h"

#include "points/pointwriter.h"

#include "base/output.h"
#include "base/vec.h"
#include "image/hdr.h"
#include "image/spectrum.h"
#include "points/pointfacts.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* All values of a point. */
struct record {
    const double *org;
    double dir[3]; /* as rtrace has it: with -I towards the surface */
    struct rad_rgb light[RAD_MAX_PLANES];
    double length; /* effective length */
    struct pointfact fact;
};

struct pointwriter {
    const struct pointspec *spec;
    const struct pointwriter_text *text;
    struct pointfacts *facts; /* NULL: no letter of -o needs facts */
    struct rad_arena arena;
    const struct rad_spectrum *eye; /* for colours of bands, or NULL */
    struct rad_output out;
    FILE *to;
};

static void
put_numbers(const struct pointwriter *w, const double *v, int n)
{
    for (int i = 0; i < n; i++) {
        float narrow = (float)v[i];

        if (w->spec->out == 'a')
            fprintf(w->to, "%e\t", v[i]);
        else if (w->spec->out == 'd')
            fwrite(&v[i], sizeof v[i], 1, w->to);
        else
            fwrite(&narrow, sizeof narrow, 1, w->to);
    }
}

/* Does the light consist of bands instead of red, green and blue? */
static bool
in_bands(const struct pointwriter *w)
{
    return rad_bands_many(&w->text->params->bands);
}

/* Are the values spectra? */
static bool
in_spectra(const struct pointwriter *w)
{
    return in_bands(w) && w->text->spectral;
}

static int
numbers_of_light(const struct pointwriter *w)
{
    return w->spec->mean ? 1 : in_spectra(w) ? w->text->params->bands.n : 3;
}

/* The colour of all bands, in the output's primaries. */
static struct rad_rgb
colour_of(const struct pointwriter *w, const float band[RAD_MAX_BANDS])
{
    const struct rad_params *p = w->text->params;
    double sum[3] = { 0 };

    for (int i = 0; i < p->bands.n; i++)
        rad_spectrum_add(w->eye, i, (double)band[i], sum);
    if (p->primaries != RAD_PRIM_XYZ) /* X, Y and Z can be of any colour */
        rad_spectrum_colour(w->eye, sum);
    return rad_params_colour(
        p, rad_rgb((float)sum[0], (float)sum[1], (float)sum[2]));
}

/* -fac: as in a picture. */
static void
put_pixel(const struct pointwriter *w, const float band[], struct rad_rgb c)
{
    int n = numbers_of_light(w);
    uint8_t pixel[RAD_MAX_BANDS + 1];

    if (in_spectra(w))
        rad_hdr_spectrum(band, n, pixel);
    else
        rad_rgbe(c, pixel);
    fwrite(pixel, (size_t)n + 1, 1, w->to);
}

/* -pY: luminance or illuminance; -pA: the mean of all bands. */
static double
mean_of(const struct pointwriter *w, const float band[], struct rad_rgb c)
{
    int n = w->text->params->bands.n;
    double sum = 0;

    if (strcmp(w->spec->mean, "-pY") == 0)
        return 179 * (double)rad_rgb_lum(c);
    for (int i = 0; i < n; i++)
        sum += (double)band[i];
    return sum / n;
}

static void
put_light(const struct pointwriter *w, const struct rad_rgb light[])
{
    struct rad_rgb c = light[0];
    float band[RAD_MAX_BANDS];
    double v[RAD_MAX_BANDS];

    if (in_bands(w))
        rad_bands_gather(&w->text->params->bands, light, band);
    if (w->eye)
        c = colour_of(w, band);
    if (w->spec->out == 'c') {
        put_pixel(w, band, c);
        return;
    }
    if (w->eye || !in_bands(w)) {
        band[0] = c.r;
        band[1] = c.g;
        band[2] = c.b;
    }
    for (int i = 0; i < numbers_of_light(w); i++)
        v[i] = w->spec->mean ? mean_of(w, band, c) : (double)band[i];
    put_numbers(w, v, numbers_of_light(w));
}

static void
put_letter(const struct pointwriter *w, char letter, const struct record *r)
{
    double one[RAD_MAX_BANDS];

    for (int i = 0; i < RAD_MAX_BANDS; i++)
        one[i] = 1;

    switch (letter) {
    case 'o':
        put_numbers(w, r->org, 3);
        break;
    case 'd':
        put_numbers(w, r->dir, 3);
        break;
    case 'v':
    case 'V': /* contribution: a primary ray's is its value */
        put_light(w, r->light);
        break;
    case 'w':
        put_numbers(w, one, 1);
        break;
    case 'W':
        put_numbers(w, one, numbers_of_light(w));
        break;
    case 'l':
        put_numbers(w, &r->length, 1);
        break;
    case 'L':
        put_numbers(w, &r->fact.length, 1);
        break;
    case 'p':
        put_numbers(w, r->fact.at, 3);
        break;
    case 'n':
        put_numbers(w, r->fact.perturbed, 3);
        break;
    case 'N':
        put_numbers(w, r->fact.normal, 3);
        break;
    case 's':
        fprintf(w->to, "%s\t", r->fact.surface);
        break;
    case 'm':
        fprintf(w->to, "%s\t", r->fact.modifier);
        break;
    case 'M':
        fprintf(w->to, "%s\t", r->fact.material);
        break;
    default:
        fputs("~\t", w->to);
    }
}

static void
find_fact(const struct pointwriter *w, const double *point, double length,
          struct record *r)
{
    const struct pointspec *s = w->spec;

    pointfacts_none(&r->fact, point);
    if (s->irradiance && length > 0)
        r->fact.length = 0;
    else if (w->facts && length > 0)
        pointfacts_find(w->facts, point, r->dir, s->limited ? length : INFINITY,
                        &r->fact);
}

static void
put_point(const struct pointwriter *w, const struct pointjob *j,
          const struct pointwriter_light *light, uint32_t i)
{
    const double *point = j->in.point[i];
    const struct pointspec *s = w->spec;
    size_t at = 4 * (size_t)j->pixel[i];
    struct record r = { .org = point, .length = 1e10 };
    double length;

    rad_copy(r.dir, point + 3);
    length = rad_normalize(r.dir);
    find_fact(w, point, length, &r);
    if (s->irradiance)
        rad_scale(r.dir, -1, r.dir);
    for (int k = 0; length > 0 && k < light->n; k++) {
        const float *v = (const float *)light->plane[k] + at;

        r.light[k] = rad_rgb(v[0], v[1], v[2]);
        if (k == 0)
            r.length = (double)v[3];
    }
    for (const char *c = s->values; *c; c++)
        put_letter(w, *c, &r);
    if (s->out == 'a')
        putc('\n', w->to);
}

/* How many numbers a point has, for the header; a name counts as one. */
static int
count_numbers(const struct pointwriter *w)
{
    int n = 0;

    for (const char *c = w->spec->values; *c; c++)
        n += strchr("vVW", *c)     ? numbers_of_light(w)
             : strchr("odpnN", *c) ? 3
                                   : *c != '~';
    return n;
}

/* Name the bands of spectra; or X, Y and Z, the primaries of -pXYZ. */
static void
put_colours(const struct pointwriter *w)
{
    const struct rad_bands *b = &w->text->params->bands;

    if (w->text->params->primaries == RAD_PRIM_XYZ)
        fprintf(w->to, "PRIMARIES= 1.0000 0.0000 0.0000 1.0000 0.0000 0.0000 "
                       "0.3333 0.3333\n");
    if (!in_spectra(w))
        return;
    fprintf(w->to, "WAVELENGTH_SPLITS=");
    for (int i = 0; i < 4; i++)
        fprintf(w->to, " %g", rad_bands_split(b, i));
    putc('\n', w->to);
}

/* Write the options, of all bands that are written, without -x and -y, which
 * are those of a picture. */
static void
put_options(const struct pointwriter *w)
{
    struct rad_params params = *w->text->params;
    char options[RAD_PARAMS_TEXT];
    int n = 0;

    if (params.bands.plane == RAD_PLANE_COLOURS)
        params.bands.plane = -1;
    rad_params_format(&params, options, sizeof options);
    sscanf(options, "-x %*d -y %*d %n", &n);
    fprintf(w->to, "%s%s\n", options + n,
            !in_bands(w)        ? ""
            : w->text->spectral ? " -co+"
                                : " -co-");
}

static void
put_header(const struct pointwriter *w)
{
    static const struct {
        char letter;
        const char *name;
    } format[] = { { 'a', "ascii" }, { 'f', "float" }, { 'd', "double" } };
    const struct pointspec *s = w->spec;
    const uint16_t order = 1;
    const char *name = in_spectra(w) ? "Radiance_spectra"
                       : w->text->params->primaries == RAD_PRIM_XYZ
                           ? "32-bit_rle_xyze"
                           : "32-bit_rle_rgbe";
    char words[160];

    if (s->no_header)
        return;
    pointspec_format(s, words, sizeof words);
    fprintf(w->to, "#?RADIANCE\n%sradsubmit --points %s ", w->text->origin,
            words);
    put_options(w);
    fprintf(w->to, "SOFTWARE= radd " PACKAGE_VERSION "\nNCOMP=%d\n",
            count_numbers(w));
    put_colours(w);
    if (s->out == 'f' || s->out == 'd')
        fprintf(w->to, "BigEndian=%d\n", *(const uint8_t *)&order == 0);
    for (int i = 0; i < 3; i++)
        if (format[i].letter == s->out)
            name = format[i].name;
    fprintf(w->to, "FORMAT=%s\n\n", name);
}

/* Does any letter need what the ray meets first? */
static bool
wants_facts(const struct pointspec *s)
{
    return !s->irradiance && s->values[strcspn(s->values, "LpnNsmM")] != '\0';
}

/* Make w->eye, if the colour of the bands is wanted. */
static int
find_eye(struct pointwriter *w, struct rad_error *err)
{
    const struct rad_bands *b = &w->text->params->bands;
    struct rad_bands colours = rad_bands_rgb();

    rad_arena_init(&w->arena);
    if (!in_bands(w) || w->text->spectral ||
        (w->spec->mean && strcmp(w->spec->mean, "-pA") == 0))
        return 0;
    w->eye =
        rad_spectrum_new(&w->arena, b->n, b->longest, b->shortest, &colours);
    return w->eye ? 0 : rad_fail_memory(err);
}

int
pointwriter_open(struct pointwriter **writer, const struct pointspec *spec,
                 const struct pointwriter_text *text, const char *path,
                 bool durable, struct rad_error *err)
{
    struct rad_files files = compile_files(text->scene);
    struct pointwriter *w = calloc(1, sizeof *w);

    *writer = w;
    if (!w)
        return rad_fail_memory(err);
    w->spec = spec;
    w->text = text;
    if (find_eye(w, err) < 0)
        return err->code;
    if (wants_facts(spec)) {
        w->facts =
            pointfacts_new(text->scene->scene, &files, text->params, err);
        if (!w->facts)
            return err->code;
    }
    if (rad_output_open(&w->out, path, durable, err) < 0)
        return err->code;
    w->to = w->out.file;
    put_header(w);
    if (spec->x > 0 && spec->y > 0)
        fprintf(w->to, "-Y %d +X %d\n", spec->y, spec->x);
    fflush(w->to); /* for scripts that read the header before they send points
                    */
    return 0;
}

int
pointwriter_put(struct pointwriter *w, const struct pointjob *j,
                const struct pointwriter_light *light, struct rad_error *err)
{
    size_t want = (size_t)j->width * (size_t)j->height * 4 * sizeof(float);

    if (light->n > 0 && light->len != want)
        return rad_fail(err, RAD_EPROTO,
                        "values of %zu bytes where %zu are expected",
                        light->len, want);
    for (uint32_t i = 0; i < j->in.n; i++)
        put_point(w, j, light, i);
    if (fflush(w->to) != 0)
        return rad_fail(err, RAD_EIO, "cannot write the values: %s",
                        strerror(errno));
    return 0;
}

int
pointwriter_close(struct pointwriter *w, bool keep, struct rad_error *err)
{
    int rc = 0;

    if (!w)
        return 0;
    if (w->to && keep)
        rc = rad_output_commit(&w->out, err);
    else if (w->to)
        rad_output_abort(&w->out);
    pointfacts_free(w->facts);
    rad_arena_release(&w->arena);
    free(w);
    return rc;
}

int
pointwriter_all(const struct pointjob *j, const struct pointwriter_text *text,
                const struct pointwriter_light *light, const char *path,
                bool durable, struct rad_error *err)
{
    struct pointwriter *w;
    int rc = pointwriter_open(&w, j->spec, text, path, durable, err), end;

    if (rc == 0)
        rc = pointwriter_put(w, j, light, err);
    end = pointwriter_close(w, rc == 0, err);
    return rc < 0 ? rc : end;
}
