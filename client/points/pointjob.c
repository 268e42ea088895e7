/* pointjob.c - see pointjob.h */
#include "config.h"

#include "points/pointjob.h"

#include "base/output.h"
#include "base/vec.h"
#include "image/hdr.h"
#include "points/pointfacts.h"
#include "points/points.h"
#include "scene/file/bundle.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int
pointjob_read(struct pointjob *j, const struct pointspec *spec,
              struct rad_error *err)
{
    uint32_t most = pointspec_most(spec);
    int rc = pointfile_read(&j->in, spec->file, spec->in, most, err);

    j->spec = spec;
    if (rc < 0)
        return rc;
    j->pixel = malloc(j->in.n * sizeof *j->pixel);
    if (!j->pixel)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    return rad_points_lay((const double(*)[6])j->in.point, j->in.n, &j->width,
                          &j->height, j->pixel, err);
}

bool
pointjob_is_short(const struct pointjob *j)
{
    uint32_t most = pointspec_most(j->spec);

    return most < UINT32_MAX && j->in.n < most;
}

int
pointjob_add(const struct pointjob *j, struct compiled *scene,
             const char *folder, struct rad_error *err)
{
    uint32_t flags = (j->spec->irradiance ? RAD_POINTS_IRRADIANCE : 0) |
                     (j->spec->limited ? RAD_POINTS_LIMITED : 0);
    uint8_t *file = rad_points_pack((const double(*)[6])j->in.point, j->in.n,
                                    0, flags, j->width, j->height, j->pixel);
    int rc;

    if (!file)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rc = compile_add(scene, RAD_BUNDLE_POINTS, file,
                     rad_points_bytes(j->width, j->height), folder, err);
    free(file);
    return rc;
}

/* --- what is written --- */

/* All of one point. */
struct record {
    const double *org;
    double dir[3]; /* as rtrace has it: with -I it looks at the surface */
    float light[4];
    struct pointfact fact;
};

struct writer {
    const struct pointjob *j;
    const struct pointjob_values *v;
    struct pointfacts *facts; /* NULL: no letter asks for one */
    FILE *to;
};

static void
put_numbers(const struct writer *w, const double *v, int n)
{
    for (int i = 0; i < n; i++) {
        float narrow = (float)v[i];

        if (w->j->spec->out == 'a')
            fprintf(w->to, "%e\t", v[i]);
        else if (w->j->spec->out == 'd')
            fwrite(&v[i], sizeof v[i], 1, w->to);
        else
            fwrite(&narrow, sizeof narrow, 1, w->to);
    }
}

static void
put_light(const struct writer *w, const float light[4])
{
    const double v[3] = { (double)light[0], (double)light[1],
                          (double)light[2] };
    uint8_t rgbe[4];

    if (w->j->spec->out != 'c') {
        put_numbers(w, v, 3);
        return;
    }
    rad_rgbe(rad_rgb(light[0], light[1], light[2]), rgbe);
    fwrite(rgbe, sizeof rgbe, 1, w->to);
}

static void
put_letter(const struct writer *w, char letter, const struct record *r)
{
    static const double one[3] = { 1, 1, 1 };
    const double effective = (double)r->light[3];

    switch (letter) {
    case 'o':
        put_numbers(w, r->org, 3);
        break;
    case 'd':
        put_numbers(w, r->dir, 3);
        break;
    case 'v':
    case 'V': /* a ray of nobody's contributes all that it is */
        put_light(w, r->light);
        break;
    case 'w':
        put_numbers(w, one, 1);
        break;
    case 'W':
        put_numbers(w, one, 3);
        break;
    case 'l':
        put_numbers(w, &effective, 1);
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
find_fact(const struct writer *w, const double *point, double length,
          struct record *r)
{
    const struct pointspec *s = w->j->spec;

    pointfacts_none(&r->fact, point);
    if (s->irradiance && length > 0)
        r->fact.length = 0;
    else if (w->facts && length > 0)
        pointfacts_find(w->facts, point, r->dir, s->limited ? length : INFINITY,
                        &r->fact);
}

static void
put_point(const struct writer *w, uint32_t i)
{
    const double *point = w->j->in.point[i];
    const struct pointspec *s = w->j->spec;
    struct record r = { .org = point, .light = { 0, 0, 0, 1e10f } };
    double length;

    rad_copy(r.dir, point + 3);
    length = rad_normalize(r.dir);
    find_fact(w, point, length, &r);
    if (s->irradiance)
        rad_scale(r.dir, -1, r.dir);
    if (length > 0 && w->v->pixels)
        memcpy(r.light,
               (const float *)w->v->pixels + 4 * (size_t)w->j->pixel[i],
               sizeof r.light);
    for (const char *c = s->values; *c; c++)
        put_letter(w, *c, &r);
    if (s->out == 'a')
        putc('\n', w->to);
}

/* Numbers of a point, for the header: names count as one. */
static int
count_numbers(const char *values)
{
    int n = 0;

    for (const char *c = values; *c; c++)
        n += strchr("odvVWpnN", *c) ? 3 : *c != '~';
    return n;
}

static void
put_header(const struct writer *w)
{
    static const struct {
        char letter;
        const char *name;
    } format[] = { { 'a', "ascii" }, { 'f', "float" }, { 'd', "double" } };
    const struct pointspec *s = w->j->spec;
    const uint16_t order = 1;
    const char *name = w->v->params->primaries == RAD_PRIM_XYZ
                           ? "32-bit_rle_xyze"
                           : "32-bit_rle_rgbe";
    char words[160];

    if (s->no_header)
        return;
    pointspec_format(s, words, sizeof words);
    fprintf(w->to, "#?RADIANCE\n%sradsubmit --points %s %s\n", w->v->origin,
            words, w->v->options);
    fprintf(w->to, "SOFTWARE= radd " PACKAGE_VERSION "\nNCOMP=%d\n",
            count_numbers(s->values));
    if (s->out == 'f' || s->out == 'd')
        fprintf(w->to, "BigEndian=%d\n", *(const uint8_t *)&order == 0);
    for (int i = 0; i < 3; i++)
        if (format[i].letter == s->out)
            name = format[i].name;
    fprintf(w->to, "FORMAT=%s\n\n", name);
}

static void
put_all(const struct writer *w)
{
    const struct pointspec *s = w->j->spec;

    put_header(w);
    if (s->x > 0 && s->y > 0)
        fprintf(w->to, "-Y %d +X %d\n", s->y, s->x);
    for (uint32_t i = 0; i < w->j->in.n; i++)
        put_point(w, i);
}

/* Does any letter ask for what the ray meets first? */
static bool
wants_facts(const struct pointspec *s)
{
    return !s->irradiance && s->values[strcspn(s->values, "LpnNsmM")] != '\0';
}

int
pointjob_write(const struct pointjob *j, const struct pointjob_values *v,
               const char *path, bool durable, struct rad_error *err)
{
    struct writer w = { j, v, NULL, NULL };
    struct rad_output out = { 0 };
    struct rad_files files = compile_files(v->scene);
    size_t want = (size_t)j->width * (size_t)j->height * 4 * sizeof(float);
    int rc;

    if (v->pixels && v->len != want)
        return rad_fail(err, RAD_EPROTO,
                        "values of %zu bytes where %zu are expected", v->len,
                        want);
    if (wants_facts(j->spec)) {
        w.facts = pointfacts_new(v->scene->scene, &files, v->params, err);
        if (!w.facts)
            return err->code;
    }
    rc = rad_output_open(&out, path, durable, err);
    if (rc == 0) {
        w.to = out.file;
        put_all(&w); /* a failure shows at the commit */
        rc = rad_output_commit(&out, err);
    }
    pointfacts_free(w.facts);
    return rc;
}

void
pointjob_release(struct pointjob *j)
{
    pointfile_release(&j->in);
    free(j->pixel);
    memset(j, 0, sizeof *j);
}
