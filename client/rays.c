/* rays.c - see rays.h */
#include "config.h"

#include "rays.h"
#include "points/pointfile.h"
#include "records/ambfile.h"
#include "records/amblist.h"
#include "base/rng.h"
#include "base/vec.h"
#include "image/spectrum.h"
#include "light/indirect/ambient.h"
#include "trace/ray.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* The number of words of the option at `at`; 0: it is unknown. */
static int
take_option(struct rays_options *o, struct words *w, int at,
            struct rad_error *err)
{
    const char *word = w->list[at];
    int n;

    if (strcmp(word, "-I") == 0) {
        o->irradiance = true;
        return 1;
    }
    if (rad_params_switch(word, "-co", &o->spectral))
        return 1;
    if (strcmp(word, "--commands") == 0) {
        o->commands = true;
        return 1;
    }
    if (strcmp(word, "-af") == 0 && at + 1 < w->n) {
        o->ambfile = w->list[at + 1];
        return 2;
    }
    n = amblist_option(&o->params, w->n - at, w->list + at, err);
    return n != 0 ? n
                  : rad_params_option(&o->params, w->n - at, w->list + at, err);
}

/* Take all options before the first scene.  Returns the place of the word
 * behind them. */
static int
take_options(struct rays_options *o, struct words *w, struct rad_error *err)
{
    for (int at = 0;;) {
        int n, rc = words_expand(w, at, err);
        const char *word = w->list[at];

        if (rc < 0)
            return rc;
        if (!word || word[0] != '-' || word[1] == '\0')
            return at;
        if (strcmp(word, "--") == 0)
            return at + 1;
        n = take_option(o, w, at, err);
        if (n < 0)
            return n;
        if (n == 0)
            return rad_fail(err, RAD_EUSAGE, "unknown option '%s'", word);
        at += n;
    }
}

int
rays_options(struct rays_options *o, struct words *w, struct rad_error *err)
{
    int at;

    rad_params_init(&o->params);
    o->irradiance = o->spectral = false;
    o->ambfile = NULL;
    o->commands = false;
    at = take_options(o, w, err);
    if (at < 0)
        return at;
    if (at == w->n)
        return rad_fail(err, RAD_EUSAGE, "no scene file");
    for (int i = at; i < w->n; i++)
        if (strcmp(w->list[i], "-") == 0)
            return rad_fail(err, RAD_EUSAGE,
                            "the standard input has the rays, not a scene");
    if (o->params.primaries != RAD_PRIM_RGB)
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s': answers are red, green and blue",
                        o->params.primaries == RAD_PRIM_XYZ ? "-pXYZ" : "-pc");
    return rad_params_check(&o->params, err) < 0 ? RAD_EUSAGE : at;
}

static struct rad_rgb
see(struct rad_ctx *ctx, double v[6], bool irradiance, uint64_t key)
{
    struct rad_ray r;

    if (rad_normalize(v + 3) == 0)
        return rad_grey(0);
    if (irradiance) {
        rad_ray_irradiance(ctx, &r, v, v + 3, key);
        return r.L;
    }
    rad_ray_spawn(ctx, &r, RAD_RAY_PRIMARY, NULL, NULL, 0);
    rad_copy(r.org, v);
    rad_copy(r.dir, v + 3);
    r.tmax = INFINITY;
    r.key = key;
    rad_ray_trace(ctx, &r);
    return r.L;
}

/* --- bands ---------------------------------------------------------------- */

/* The scene made ready for each plane. */
struct planes {
    struct rad_bands bands; /* three, or those of -cs */
    struct rad_job *job[RAD_MAX_PLANES];
    struct rad_ctx ctx[RAD_MAX_PLANES];
    int n;
    struct rad_arena arena;
    const struct rad_spectrum *eye; /* for colours of bands, or NULL */
};

static int
add_plane(struct planes *p, struct rad_params params,
          const struct rays_scene *s, struct rad_error *err)
{
    struct rad_error why = { 0 };

    if (p->bands.n > 3)
        params.bands.plane = p->bands.plane < 0 ? p->n : p->bands.plane;
    p->job[p->n] = rad_job_new(s->scene, &params, s->files, &why);
    if (p->job[p->n] && rad_ctx_init(&p->ctx[p->n], p->job[p->n], &why) == 0) {
        p->n++;
        return 0;
    }
    rad_job_free(p->job[p->n]);
    if (err && err->code == 0)
        *err = why;
    return why.code;
}

static int
prepare_planes(struct planes *p, const struct rays_options *o,
               const struct rays_scene *s, struct rad_error *err)
{
    struct rad_bands colours = rad_bands_rgb();
    int rc = 0;

    *p = (struct planes){ .bands = o->params.bands };
    rad_arena_init(&p->arena);
    if (!rad_bands_many(&p->bands)) /* three channels, maybe of one plane */
        p->bands.n = 3;
    else if (!rad_scene_spectrum(s->scene))
        p->bands.plane = RAD_PLANE_COLOURS;
    if (p->bands.n > 3 && !o->spectral) {
        p->eye = rad_spectrum_new(&p->arena, p->bands.n, p->bands.longest,
                                  p->bands.shortest, &colours);
        rc = p->eye ? 0 : rad_fail_memory(err);
    }
    for (int i = 0; rc == 0 && i < rad_bands_planes(&p->bands); i++)
        rc = add_plane(p, o->params, s, err);
    return rc;
}

static void
release_planes(struct planes *p)
{
    for (int i = 0; i < p->n; i++) {
        rad_ctx_release(&p->ctx[i]);
        rad_job_free(p->job[i]);
    }
    rad_arena_release(&p->arena);
}

/* --- lines ---------------------------------------------------------------- */

static void
print_colour(struct rad_rgb c, FILE *out)
{
    fprintf(out, "%.9g %.9g %.9g\n", (double)c.r, (double)c.g, (double)c.b);
}

static void
print_line(const struct planes *p, const struct rad_rgb L[], FILE *out)
{
    float band[RAD_MAX_BANDS];
    double sum[3] = { 0 };

    if (p->bands.n == 3) {
        print_colour(L[0], out);
        return;
    }
    rad_bands_gather(&p->bands, L, band);
    if (!p->eye) {
        for (int i = 0; i < p->bands.n; i++)
            fprintf(out, "%s%.9g", i > 0 ? " " : "", (double)band[i]);
        fputc('\n', out);
        return;
    }
    for (int i = 0; i < p->bands.n; i++)
        rad_spectrum_add(p->eye, i, (double)band[i], sum);
    rad_spectrum_colour(p->eye, sum);
    print_colour(rad_rgb((float)sum[0], (float)sum[1], (float)sum[2]), out);
}

static int
trace_one(struct planes *p, const double v[6], bool irradiance, uint64_t key,
          FILE *out, struct rad_error *err)
{
    struct rad_rgb L[RAD_MAX_PLANES];

    for (int i = 0; i < p->n; i++) {
        double ray[6];

        memcpy(ray, v, sizeof ray);
        L[i] = see(&p->ctx[i], ray, irradiance, key);
        if (p->ctx[i].scratch.lacked)
            return rad_fail_memory(err);
    }
    print_line(p, L, out);
    return 0;
}

static int
trace_lines(struct planes *p, bool irradiance, FILE *in, FILE *out,
            struct rad_error *err)
{
    uint64_t seed = p->job[0]->params.seed;
    uint32_t number = 0;
    char *line = NULL;
    size_t size = 0;
    ssize_t n;
    int rc = 0;

    for (long at = 1; rc >= 0 && (n = getline(&line, &size, in)) >= 0; at++) {
        double v[6];

        if (n > 0 && line[n - 1] == '\n')
            n--;
        rc = pointfile_line(line, (size_t)n, v, err);
        if (rc < 0)
            rad_error_where(err, "stdin:%ld", at);
        if (rc > 0)
            rc = trace_one(p, v, irradiance,
                           rad_key_pixel(seed, 0, number++, 0), out, err);
    }
    free(line);
    if (rc >= 0 && !feof(in)) /* getline() tells of memory by errno alone */
        rc = errno == ENOMEM
                 ? rad_fail_memory(err)
                 : rad_fail(err, RAD_EIO, "cannot read the rays: %s",
                            strerror(errno));
    if (fflush(out) != 0 && rc >= 0)
        rc = rad_fail(err, RAD_EIO, "cannot write: %s", strerror(errno));
    return rc < 0 ? rc : 0;
}

/* Trace with the records of the file; then write all records if there are new
 * ones. */
static int
trace_with_file(const struct rays_options *o, const char *digest,
                struct planes *p, FILE *in, FILE *out, struct rad_error *err)
{
    struct rad_ambient *amb = p->job[0]->ambient;
    struct ambfile file = { .params = o->params };
    size_t before;
    int rc;

    if (!amb)
        return rad_fail(err, RAD_EUSAGE,
                        "-af: there are no ambient records without -ab and "
                        "-aa");
    if (p->bands.n > 3)
        return rad_fail(err, RAD_EUSAGE,
                        "-af: a file's records have three channels, and -cs is "
                        "%d",
                        p->bands.n);
    snprintf(file.scene, sizeof file.scene, "%s", digest);
    rc = ambfile_load(&file, o->ambfile, amb, err);
    before = rad_ambient_count(amb);
    if (rc == 0)
        rc = trace_lines(p, o->irradiance, in, out, err);
    if (rc == 0 && rad_ambient_count(amb) > before)
        rc = ambfile_save(&file, o->ambfile, amb, err);
    return rc;
}

int
rays_run(const struct rays_options *o, const struct rays_scene *s, FILE *in,
         FILE *out, struct rad_fault faults[RAD_MAX_FAULTS],
         struct rad_error *err)
{
    struct planes p;
    int rc = prepare_planes(&p, o, s, err);

    memset(faults, 0, RAD_MAX_FAULTS * sizeof *faults);
    if (rc == 0) {
        rc = o->ambfile ? trace_with_file(o, s->digest, &p, in, out, err)
                        : trace_lines(&p, o->irradiance, in, out, err);
        memcpy(faults, p.ctx[0].counts.faults, RAD_MAX_FAULTS * sizeof *faults);
    }
    release_planes(&p);
    return rc;
}
