/* kernel.c - rays per second of intersection, by ray kind and kernel
 *
 *      kernel [-k kernel] [-n triangles] [-r rays] [-t seconds]
 *             [scene.rad [view.vf]]
 *
 * Ray kinds: `primary`, a picture's rays row by row; `bounce`, from where those
 * land into the hemisphere above, cosine-distributed; `shadow`, any hit between
 * there and a point of a light.  Without a scene one is generated: a closed
 * room with a rough floor of n triangles and lamps of every family.  Everything
 * is drawn beforehand, so that only rad_geom's work is timed. */
#include "config.h"

#define TOOL "kernel"
#include "tool.h"

#include "base/files.h"
#include "base/rng.h"
#include "base/vec.h"
#include "geom/kernel.h"
#include "picture/view.h"
#include "scene/file/parse.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

enum { KIND_PRIMARY, KIND_BOUNCE, KIND_SHADOW, NKINDS };

static const char *const kind_name[] = { "primary", "bounce", "shadow" };

struct bench {
    struct rad_scene *scene;
    uint8_t *surf;
    struct rad_geom *geom;
    struct rad_span *span[NKINDS];
    size_t nspans;
    struct rad_view view;
    double seconds;   /* at least so long for each figure */
    const char *only; /* this kernel, NULL: all */
};

static void
load(struct bench *b, const char *path, const char *view_path)
{
    struct rad_error err = { 0 };
    unsigned char *text;
    size_t len;

    text = rad_file_read(path, SIZE_MAX / 2, &len, &err);
    if (!text ||
        rad_parse_text(b->scene, (char *)text, len, path, NULL, &err) < 0)
        die(&err);
    free(text);
    if (!view_path)
        return;
    text = rad_file_read(view_path, SIZE_MAX / 2, &len, &err);
    if (!text || rad_view_read(&b->view, (char *)text, len, &err) < 0)
        die(&err);
    free(text);
}

static int32_t
add(struct rad_scene *s, enum rad_otype type, int32_t modifier,
    const double *reals, int n)
{
    struct rad_object o = { .type = type,
                            .modifier = modifier,
                            .file = -1,
                            .name = "it",
                            .nreals = n,
                            .reals = reals };
    struct rad_error err = { 0 };
    int i = rad_scene_add(s, &o, &err);

    if (i < 0)
        die(&err);
    return i;
}

/* A point of the rough floor, 10 by 10. */
static void
floor_point(int x, int y, int side, double p[3])
{
    p[0] = 10. * x / side;
    p[1] = 10. * y / side;
    p[2] = .3 * sin(p[0] * 3) * cos(p[1] * 2) +
           rad_rand(rad_key_pixel(0, 0, (uint32_t)x, (uint32_t)y), 0) / side;
}

static void
generate(struct bench *b, long triangles)
{
    static const double grey[] = { .5, .5, .5, 0, 0 }, light[] = { 9, 9, 9 };
    static const double sky[] = { 5, 5, 0, 20 };
    int side = (int)sqrt((double)triangles / 2);
    int32_t plastic = add(b->scene, RAD_PLASTIC, RAD_VOID, grey, 5);
    int32_t lamp = add(b->scene, RAD_LIGHT, RAD_VOID, light, 3);

    for (int i = 0; i < 2 * side * side; i++) {
        int x = i / 2 % side, y = i / 2 / side;
        double v[9];

        floor_point(x, y, side, v);
        floor_point(x + 1, y + i % 2, side, v + 3);
        floor_point(x + 1 - i % 2, y + 1, side, v + 6);
        add(b->scene, RAD_POLYGON, plastic, v, 9);
    }
    add(b->scene, RAD_BUBBLE, plastic, sky, 4);
    for (int i = 0; i < 9; i++) {
        double at[] = { 1. + 4 * (i % 3), 1. + 4 * (i / 3), 3, .1 };

        add(b->scene, RAD_SPHERE, lamp, at, 4);
    }
    rad_copy(b->view.vp, (double[]){ 5, -2, 4 });
    rad_copy(b->view.vdir, (double[]){ 0, 1, -.5 });
}
/* Bits of each surface by its material's type, as shading would set them. */
static void
set_surf(struct bench *b)
{
    const struct rad_scene *s = b->scene;

    b->surf = calloc((size_t)s->nobjects + 1, 1);
    if (!b->surf)
        die_of("out of memory");
    for (int32_t i = 0; i < s->nobjects; i++) {
        int32_t m = s->objects[i].modifier;

        b->surf[i] = RAD_SURF_OPAQUE;
        if (m != RAD_VOID && (s->objects[m].type == RAD_GLASS ||
                              s->objects[m].type == RAD_DIELECTRIC ||
                              s->objects[m].type == RAD_TRANS))
            b->surf[i] = RAD_SURF_TRANSPARENT;
    }
}

static bool
is_light(const struct rad_scene *s, const struct rad_object *o)
{
    enum rad_otype m;

    if (o->modifier == RAD_VOID || o->nreals < 4 || o->type == RAD_SOURCE)
        return false;
    m = s->objects[o->modifier].type;
    return m == RAD_LIGHT || m == RAD_SPOTLIGHT || m == RAD_GLOW;
}

/* The first point of each of up to `most` lights, or of surfaces where there
 * are none; returns how many. */
static int
light_points(const struct rad_scene *s, double (*p)[3], int most)
{
    int n = 0;

    for (int32_t i = 0; i < s->nobjects && n < most; i++)
        if (is_light(s, &s->objects[i]))
            rad_copy(p[n++], s->objects[i].reals);
    for (int32_t i = 0; i < s->nobjects && n == 0; i++)
        if (s->objects[i].nreals >= 7)
            rad_copy(p[n++], s->objects[i].reals);
    return n;
}

static void
draw_primary(struct bench *b)
{
    size_t side = (size_t)sqrt((double)b->nspans);

    b->nspans = side * side;
    for (size_t i = 0; i < b->nspans; i++) {
        struct rad_span *s = &b->span[KIND_PRIMARY][i];
        double x = ((double)(i % side) + .5) / (double)side;
        double y = 1 - ((double)(i / side) + .5) / (double)side;

        s->tmin = 0;
        s->tmax = INFINITY;
        if (rad_view_ray(&b->view, x, y, s->org, s->dir) < 0)
            die_of("view does not fill its picture");
    }
}

/* What leaves where the primary rays land. */
static void
draw_secondary(struct bench *b, const double (*lamps)[3], int nlamps)
{
    struct rad_geom_counts counts = { 0 };

    for (size_t i = 0; i < b->nspans; i++) {
        struct rad_span *s = &b->span[KIND_BOUNCE][i];
        struct rad_span *shadow = &b->span[KIND_SHADOW][i];
        uint64_t key = rad_key_branch(3, i);
        double n[3], u[3], v[3], r = sqrt(rad_rand(key, 1));
        double phi = 6.283185307179586 * rad_rand(key, 2);
        struct rad_hit hit;

        *s = *shadow = b->span[KIND_PRIMARY][i];
        if (!rad_geom_nearest(b->geom, s, &hit, &counts))
            continue;
        rad_scale(n, rad_dot(hit.n, s->dir) < 0 ? 1 : -1, hit.n);
        rad_frame(u, v, n);
        rad_scale(s->dir, sqrt(1 - r * r), n);
        rad_madd(s->dir, s->dir, r * cos(phi), u);
        rad_madd(s->dir, s->dir, r * sin(phi), v);
        rad_normalize(s->dir);
        rad_geom_leave(&hit, s->dir, s->org);
        rad_sub(shadow->dir, lamps[(int)(rad_rand(key, 0) * nlamps)], hit.p);
        shadow->tmax = rad_normalize(shadow->dir) * (1 - 1e-6);
        rad_geom_leave(&hit, shadow->dir, shadow->org);
    }
}

static void
draw(struct bench *b)
{
    enum { NLAMPS = 64 };
    double lamps[NLAMPS][3];
    int n = light_points(b->scene, lamps, NLAMPS);

    if (n == 0)
        die_of("no surface to aim at");
    for (int k = 0; k < NKINDS; k++) {
        b->span[k] = calloc(b->nspans, sizeof *b->span[k]);
        if (!b->span[k])
            die_of("out of memory");
    }
    draw_primary(b);
    draw_secondary(b, lamps, n);
}

static size_t
trace_all(const struct bench *b, int kind, struct rad_geom_counts *counts)
{
    struct rad_line line;
    struct rad_hit hit;
    size_t hits = 0;

    for (size_t i = 0; i < b->nspans; i++) {
        const struct rad_span *s = &b->span[kind][i];

        hits += kind == KIND_SHADOW
                    ? rad_geom_sight(b->geom, s, RAD_VOID, NULL, &hit, &line,
                                     counts) == RAD_SIGHT_BLOCKED
                    : rad_geom_nearest(b->geom, s, &hit, counts);
    }
    return hits;
}

/* The best of several rounds: what else the machine does only slows. */
static void
measure(struct bench *b, const struct rad_kernel *k, int kind)
{
    struct rad_geom_counts counts;
    double start = now(), best = INFINITY, rays = (double)b->nspans;
    size_t hits;

    rad_geom_use(b->geom, k);
    do {
        double round = now();

        memset(&counts, 0, sizeof counts);
        hits = trace_all(b, kind, &counts);
        best = fmin(best, now() - round);
    } while (now() - start < b->seconds);
    printf("%-8s %-8s %8.3f %8.1f %8.2f %8.2f\n", k->name, kind_name[kind],
           1e-6 * rays / best, 100. * (double)hits / rays,
           (double)counts.tests / rays, (double)counts.nodes / rays);
}

static long
peak_kib(void)
{
    struct rusage u;

    getrusage(RUSAGE_SELF, &u);
    return u.ru_maxrss;
}

static void
run(struct bench *b)
{
    const struct rad_kernel *const *k;
    struct rad_error err = { 0 };
    long before = peak_kib();
    double start = now();

    b->geom = rad_geom_new(b->scene, b->surf, 0, &err);
    if (!b->geom)
        die(&err);
    printf("%d objects, built in %.3f s, peak %.1f MiB (%.1f before)\n",
           (int)b->scene->nobjects, now() - start, (double)peak_kib() / 1024,
           (double)before / 1024);
    draw(b);
    printf("%-8s %-8s %8s %8s %8s %8s\n", "kernel", "rays", "M/s", "% hit",
           "tests", "nodes");
    for (k = rad_kernels(); *k; k++) {
        if (!(*k)->usable() || (b->only && strcmp(b->only, (*k)->name) != 0))
            continue;
        for (int kind = 0; kind < NKINDS; kind++)
            measure(b, *k, kind);
    }
}

int
main(int argc, char **argv)
{
    struct bench b = { .nspans = 256 * 256, .seconds = 1 };
    long triangles = 100000;
    struct rad_error err = { 0 };
    int i;

    rad_view_init(&b.view);
    b.scene = rad_scene_new();
    if (!b.scene)
        die_of("out of memory");
    for (i = 1; i + 1 < argc && argv[i][0] == '-'; i += 2)
        switch (argv[i][1]) {
        case 'k':
            b.only = argv[i + 1];
            break;
        case 'n':
            triangles = atol(argv[i + 1]);
            break;
        case 'r':
            b.nspans = (size_t)atol(argv[i + 1]);
            break;
        case 't':
            b.seconds = atof(argv[i + 1]);
            break;
        default:
            die_of("usage: kernel [-k kernel] [-n triangles] [-r rays] "
                   "[-t seconds] [scene.rad [view.vf]]");
        }
    if (i < argc)
        load(&b, argv[i], i + 1 < argc ? argv[i + 1] : NULL);
    else
        generate(&b, triangles);
    if (rad_view_setup(&b.view, &err) < 0)
        die(&err);
    set_surf(&b);
    run(&b);
    rad_geom_free(b.geom);
    rad_scene_free(b.scene);
    free(b.surf);
    for (int k = 0; k < NKINDS; k++)
        free(b.span[k]);
    return 0;
}
