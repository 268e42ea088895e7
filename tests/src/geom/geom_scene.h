/* geom_scene.h - scenes made by hand for the tests of geom/
 *
 * A scene without a parser: objects point at numbers that the test owns. */
#ifndef RADD_TESTS_GEOM_SCENE_H
#define RADD_TESTS_GEOM_SCENE_H

#include "base/rng.h"
#include "base/vec.h"
#include "geom/geom.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

struct geom_scene {
    struct rad_scene scene;
    int32_t maxobj;
    uint8_t *surf;
    double *reals; /* of all objects */
    size_t nreals, maxreals;
};

static inline void
geom_scene_init(struct geom_scene *g, int maxobj, size_t maxreals)
{
    memset(g, 0, sizeof *g);
    g->scene.objects = calloc((size_t)maxobj, sizeof *g->scene.objects);
    g->maxobj = maxobj;
    g->surf = calloc((size_t)maxobj, 1);
    g->reals = calloc(maxreals, sizeof *g->reals);
    g->maxreals = maxreals;
}

static inline void
geom_scene_release(struct geom_scene *g)
{
    free(g->scene.objects);
    free(g->surf);
    free(g->reals);
}

/* An object of n numbers; returns its index. */
static inline int32_t
geom_scene_add(struct geom_scene *g, enum rad_otype type, int32_t modifier,
               uint8_t surf, const double *reals, int n)
{
    struct rad_object *o = &g->scene.objects[g->scene.nobjects];

    ck_assert_int_lt(g->scene.nobjects, g->maxobj);
    ck_assert_uint_le(g->nreals + (size_t)n, g->maxreals);
    o->type = type;
    o->modifier = modifier;
    o->name = "it";
    o->nreals = n;
    o->reals = g->reals + g->nreals;
    for (int i = 0; i < n; i++)
        g->reals[g->nreals + (size_t)i] = reals[i];
    g->nreals += (size_t)n;
    g->surf[g->scene.nobjects] = surf;
    return g->scene.nobjects++;
}

#define GEOM_ADD(g, type, ...)                                                 \
    geom_scene_add(                                                            \
        (g), (type), RAD_VOID, RAD_SURF_OPAQUE,                                \
        (const double[]){ __VA_ARGS__ },                                       \
        (int)(sizeof((const double[]){ __VA_ARGS__ }) / sizeof(double)))

/* rays: rad_geom_new() */
static inline struct rad_geom *
geom_scene_compile_for(const struct geom_scene *g, uint32_t rays)
{
    struct rad_error err = { 0 };
    struct rad_geom *geom = rad_geom_new(&g->scene, g->surf, rays, &err);

    ck_assert_msg(geom != NULL, "%s", err.what);
    return geom;
}

static inline struct rad_geom *
geom_scene_compile(const struct geom_scene *g)
{
    return geom_scene_compile_for(g, 0);
}

static inline struct rad_span
geom_span(double ox, double oy, double oz, double dx, double dy, double dz)
{
    struct rad_span s = { { ox, oy, oz }, { dx, dy, dz }, 0, INFINITY };

    rad_normalize(s.dir);
    return s;
}

/* Uniform in [lo, hi). */
static inline double
geom_rand(uint64_t key, uint32_t dim, double lo, double hi)
{
    return lo + rad_rand(key, dim) * (hi - lo);
}

/* Uniform on the sphere of directions. */
static inline void
geom_rand_dir(uint64_t key, uint32_t dim, double d[3])
{
    double z = geom_rand(key, dim, -1, 1);
    double a = geom_rand(key, dim + 1, 0, 6.283185307179586);

    d[0] = sqrt(1 - z * z) * cos(a);
    d[1] = sqrt(1 - z * z) * sin(a);
    d[2] = z;
}

/* The scene of a test, and what it was made into. */
static struct geom_scene g;
static struct rad_geom *geom;

static inline void
geom_tear_down(void)
{
    rad_geom_free(geom);
    geom_scene_release(&g);
    geom = NULL;
    g = (struct geom_scene){ 0 };
}

#endif
