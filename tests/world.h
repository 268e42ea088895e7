/* world.h - a scene from text, made ready to trace, for tests */
#ifndef RADD_TESTS_WORLD_H
#define RADD_TESTS_WORLD_H

#include "base/vec.h"
#include "scene/file/parse.h"
#include "scene/part.h"
#include "trace/job.h"
#include "trace/ray.h"
#include "tests/unit.h"

#include <string.h>

/* A closed white room of ten by ten by five with a lamp and two balls. */
#define WORLD_ROOM                                                             \
    "void light lamp 0 0 3 60 60 60\n"                                         \
    "lamp sphere bulb 0 0 4 2 2 4.5 .3\n"                                      \
    "void plastic white 0 0 5 .7 .7 .7 0 0\n"                                  \
    "white polygon floor 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0\n"                 \
    "white polygon ceiling 0 0 12 -5 -5 5 -5 5 5 5 5 5 5 -5 5\n"               \
    "white polygon west 0 0 12 -5 -5 0 -5 5 0 -5 5 5 -5 -5 5\n"                \
    "white polygon east 0 0 12 5 -5 0 5 -5 5 5 5 5 5 5 0\n"                    \
    "white polygon north 0 0 12 -5 5 0 5 5 0 5 5 5 -5 5 5\n"                   \
    "white polygon south 0 0 12 -5 -5 0 -5 -5 5 5 -5 5 5 -5 0\n"               \
    "void plastic red 0 0 5 .6 .2 .2 .02 .05\n"                                \
    "red sphere ball 0 0 4 -2 1 1 1\n"                                         \
    "red sphere other 0 0 4 1 -1 .7 .7\n"

struct world {
    struct rad_scene *scene;
    struct rad_params params;
    struct rad_job *job;
    struct rad_ctx ctx;
    struct rad_error err;
};

/* Rendering options, blank-separated, on top of what is there. */
static inline void
world_options(struct world *w, const char *options)
{
    char buf[512], *argv[64], *save = NULL;
    int argc = 0, n;

    ck_assert_uint_lt(strlen(options), sizeof buf);
    strcpy(buf, options);
    for (char *p = strtok_r(buf, " ", &save); p && argc < 63;
         p = strtok_r(NULL, " ", &save))
        argv[argc++] = p;
    argv[argc] = NULL;
    for (int i = 0; i < argc; i += n) {
        n = rad_params_option(&w->params, argc - i, argv + i, &w->err);
        ck_assert_msg(n > 0, "option %s: %s", argv[i], w->err.what);
    }
}

static inline void
world_close(struct world *w)
{
    if (w->job)
        rad_ctx_release(&w->ctx);
    rad_job_free(w->job);
    rad_scene_free(w->scene);
    memset(w, 0, sizeof *w);
}

/* A file that a scene names.  Where files has world_file_read and a table of
 * these, which a row of zeros ends, there are no others. */
struct world_file {
    const char *name, *text;
};

static inline unsigned char *
world_file_read(void *arg, const char *name, size_t *len, struct rad_error *err)
{
    for (const struct world_file *f = arg; f->name; f++)
        if (strcmp(f->name, name) == 0) {
            *len = strlen(f->text);
            return (unsigned char *)strdup(f->text);
        }
    rad_fail(err, RAD_ENOINPUT, "no file '%s'", name);
    return NULL;
}

/* With the parameters that w has.  0, or the code of what is wrong with the
 * scene. */
static inline int
world_build(struct world *w, const char *text, const struct rad_files *files)
{
    int rc;

    w->scene = rad_scene_new();
    ck_assert_ptr_nonnull(w->scene);
    rc =
        rad_parse_text(w->scene, text, strlen(text), "test.rad", NULL, &w->err);
    if (rc < 0 ||
        (rc = rad_scene_include(w->scene, files, NULL, NULL, &w->err)) < 0 ||
        (rc = rad_scene_check(w->scene, NULL, NULL, &w->err)) < 0)
        return rc;
    w->job = rad_job_new(w->scene, &w->params, files, &w->err);
    return w->job ? rad_ctx_init(&w->ctx, w->job, &w->err) : w->err.code;
}

/* In place of what w was, which is all zero at first. */
static inline int
world_try(struct world *w, const char *text, const char *options,
          const struct rad_files *files)
{
    world_close(w);
    rad_params_init(&w->params);
    world_options(w, options);
    return world_build(w, text, files);
}

static inline void
world_open(struct world *w, const char *text, const char *options)
{
    int rc = world_try(w, text, options, NULL);

    ck_assert_msg(rc == 0, "%s: %s", w->err.where, w->err.what);
}

/* The scene is refused, for that reason, which names its first line. */
static inline void
world_refused(const char *text, const char *options,
              const struct rad_files *files, const char *problem)
{
    char what[600];
    struct world w = { 0 };

    ck_assert_int_lt(world_try(&w, text, options, files), 0);
    ck_assert_ptr_null(w.job);
    rad_error_format(&w.err, what, sizeof what);
    ck_assert_msg(strstr(w.err.what, problem) != NULL, "%s", what);
    ck_assert_msg(strstr(what, "test.rad:1") != NULL, "%s", what);
    world_close(&w);
}

/* A primary ray, ready to trace; dir need not be of unit length. */
static inline void
world_ray(struct world *w, struct rad_ray *r, double ox, double oy, double oz,
          double dx, double dy, double dz)
{
    r->key = 1;
    r->tmax = INFINITY;
    rad_ray_spawn(&w->ctx, r, RAD_RAY_PRIMARY, NULL, NULL, 0);
    r->org[0] = ox;
    r->org[1] = oy;
    r->org[2] = oz;
    r->dir[0] = dx;
    r->dir[1] = dy;
    r->dir[2] = dz;
    ck_assert(rad_normalize(r->dir) > 0);
}

static inline struct rad_rgb
world_see(struct world *w, double ox, double oy, double oz, double dx,
          double dy, double dz)
{
    struct rad_ray r;

    world_ray(w, &r, ox, oy, oz, dx, dy, dz);
    rad_ray_trace(&w->ctx, &r);
    return r.L;
}

/* The same of a scene that is there for this ray alone. */
static inline struct rad_rgb
world_glance(const char *text, const char *options,
             const struct rad_files *files, double ox, double oy, double oz,
             double dx, double dy, double dz)
{
    struct rad_rgb L;
    struct world w = { 0 };
    int rc = world_try(&w, text, options, files);

    ck_assert_msg(rc == 0, "%s: %s", w.err.where, w.err.what);
    L = world_see(&w, ox, oy, oz, dx, dy, dz);
    world_close(&w);
    return L;
}

/* What is seen at the origin from above, deg from the vertical, in the plane
 * y = 0. */
static inline struct rad_rgb
world_tilted(struct world *w, double deg)
{
    double a = deg * M_PI / 180;

    return world_see(w, -sin(a), 0, cos(a), sin(a), 0, -cos(a));
}

#endif
