/* stage.c - see stage.h */
#include "config.h"

#include "stage.h"
#include "base/vec.h"
#include "picture/frame.h"
#include "scene/file/parse.h"
#include "trace/ray.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void
check(int rc, const struct rad_error *err, const char *what)
{
    if (rc >= 0)
        return;
    fprintf(stderr, "accuracy: %s %s\n%s\n", err->where, err->what, what);
    exit(EXIT_FAILURE);
}

static void
take_options(struct rad_params *p, const char *options)
{
    char text[512], *argv[128], *save, *word = text;
    struct rad_error err = { 0 };
    int argc = 0, n;

    snprintf(text, sizeof text, "%s", options);
    while (argc < 127 && (argv[argc] = strtok_r(word, " ", &save)) != NULL) {
        argc++;
        word = NULL;
    }
    rad_params_init(p);
    for (int i = 0; i < argc; i += n) {
        n = rad_params_option(p, argc - i, argv + i, &err);
        check(n > 0 ? 0 : -1, &err, options);
    }
}

void
stage_open(struct stage *s, const char *options, const char *scene, ...)
{
    struct rad_error err = { 0 };
    va_list ap;
    char *text;
    int n;

    va_start(ap, scene);
    n = vsnprintf(NULL, 0, scene, ap);
    va_end(ap);
    text = malloc((size_t)n + 1);
    check(n < 0 || !text ? -1 : 0, &err, scene);
    va_start(ap, scene);
    vsnprintf(text, (size_t)n + 1, scene, ap);
    va_end(ap);
    *s = (struct stage){ .effort = s->effort };
    take_options(&s->params, options);
    s->scene = rad_scene_new();
    check(rad_parse_text(s->scene, text, strlen(text), "text", NULL, &err),
          &err, text);
    check(rad_scene_check(s->scene, NULL, NULL, &err), &err, text);
    s->job = rad_job_new(s->scene, &s->params, NULL, &err);
    check(s->job ? 0 : -1, &err, text);
    check(rad_ctx_init(&s->ctx, s->job, &err), &err, text);
    free(text);
}

void
stage_close(struct stage *s)
{
    if (!s->scene)
        return;
    rad_ctx_release(&s->ctx);
    rad_job_free(s->job);
    rad_scene_free(s->scene);
    s->scene = NULL;
}

double
stage_irradiance(struct stage *s, const double p[3], const double n[3])
{
    struct rad_ray r;

    rad_ray_irradiance(&s->ctx, &r, p, n, 1);
    return r.L.r;
}

double
stage_radiance(struct stage *s, const double org[3], const double dir[3],
               uint64_t key)
{
    struct rad_ray r;

    rad_ray_spawn(&s->ctx, &r, RAD_RAY_PRIMARY, NULL, NULL, 0);
    r.key = key;
    r.tmax = INFINITY;
    rad_copy(r.org, org);
    rad_copy(r.dir, dir);
    rad_normalize(r.dir);
    rad_ray_trace(&s->ctx, &r);
    return r.L.r;
}

double
stage_lit_area(struct stage *s, const char *view)
{
    struct rad_error err = { 0 };
    struct rad_frame f;
    struct rad_view v;
    double sum = 0;

    rad_view_init(&v);
    check(rad_view_read(&v, view, strlen(view), &err), &err, view);
    check(rad_frame_init(&f, s->job, &v, 0, false, &err), &err, view);
    for (int y = 0; y < f.height; y++)
        for (int x = 0; x < f.width; x++) {
            struct rad_pixel out;

            rad_frame_pixel(&f, &s->ctx, x, y, &out);
            sum += out.L.r > 0;
        }
    sum *= v.horiz * v.vert / f.width / f.height;
    rad_frame_release(&f);
    return sum;
}

/* Newton's method on the Legendre polynomial, from the usual first guess. */
void
stage_gauss(int n, double x[STAGE_GAUSS], double w[STAGE_GAUSS])
{
    for (int i = 0; i < n; i++) {
        double z = cos(M_PI * (i + .75) / (n + .5)), slope = 1;

        for (int step = 0; step < 20; step++) {
            double p = 1, before = 0;

            for (int k = 1; k <= n; k++) {
                double next = ((2 * k - 1) * z * p - (k - 1) * before) / k;

                before = p;
                p = next;
            }
            slope = n * (z * p - before) / (z * z - 1);
            z -= p / slope;
        }
        x[i] = (1 - z) / 2;
        w[i] = 1 / ((1 - z * z) * slope * slope);
    }
}
