/* surroundings.c - see surroundings.h
 *
 * What a view shows is taken to be as large as a ball about one of its hits
 * that holds most of them: of those with something before them, as in a room,
 * for most of a picture may be a window with a wide view; of all where few
 * have.  What stands close before the eye is not it: zones for that alone would
 * be far too small for the rest, and cost a hundred times the rays.  A view of
 * a small part of a wall shows little, but is lit by all of its room; so the
 * part counts for no less than the space before its surface, or NEAR distances
 * from the eye if that is smaller: a room by itself is rendered alike from all
 * of these.
 *
 * Far from what is shown zones may be wider, so its place must hold whatever a
 * picture shows from near: the balls of the views that are looked at, and the
 * eyes of all. */
#include "config.h"

#include "trial/surroundings.h"

#include "base/number.h"
#include "base/vec.h"
#include "geom/geom.h"
#include "picture/view.h"
#include "trace/material.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rays of a view, along each side, with those that look about from each hit,
 * and views of a job at most. */
enum { SIDE = 12, RAYS = SIDE * SIDE, ABOUT = 5, MOST_VIEWS = 64 };

/* The options of --quality are good for scenes that are 1 to 11 times as large
 * as what a view shows: --surroundings brings others to within TIMES_SHOWN and
 * STEP times that. */
#define TIMES_SHOWN 3
enum { STEP = 4, MOST_TIMES = 1 << 30 };

/* A view that shows little but sky tells nothing. */
#define LEAST_HITS (RAYS / 4)

/* The hits with something before them count where they are so many of all; a
 * ball holds such a part of these, or of all. */
#define ENCLOSED    .25
#define IN_A_ROOM   .75
#define IN_THE_OPEN .5

#define NEAR (TIMES_SHOWN * STEP)

/* A place is told within the size of what is shown over this. */
#define ROUND 8

/* A ray from a surface begins so many bounds of its error above it. */
#define ABOVE 16

/* A ray passes so many panes and mirrors. */
#define MOST_PASSED 32

/* What the rays of one view met. */
struct look {
    const struct rad_scene *scene;
    const struct rad_geom *geom;
    int n;
    double at[RAYS][3]; /* n points */
    double eye[RAYS];   /* their distances from the eye; INFINITY: no eye */
    double space[RAYS]; /* before the surface there; INFINITY: open */
};

/* Surfaces without ambient values show what is behind or before them. */
enum kind { SHOWN, PANE, MIRROR };
static enum kind
kind_of(const struct rad_scene *scene, int32_t obj)
{
    int32_t m = rad_material_of(scene, scene->objects[obj].modifier);

    if (m == RAD_VOID)
        return PANE;
    switch (scene->objects[m].type) {
    case RAD_GLASS:
    case RAD_DIELECTRIC:
    case RAD_INTERFACE:
    case RAD_MIST:
    case RAD_ANTIMATTER:
    case RAD_ILLUM:
        return PANE;
    case RAD_MIRROR: /* or rays see its alternate */
        return scene->objects[m].nstrings > 0 ? SHOWN : MIRROR;
    default:
        return SHOWN;
    }
}

static void
reflect(struct rad_span *span, const struct rad_hit *hit)
{
    rad_copy(span->org, hit->p);
    rad_madd(span->dir, span->dir, -2 * rad_dot(span->dir, hit->n), hit->n);
    rad_normalize(span->dir);
    span->tmin = ABOVE * hit->err;
    span->tmax -= hit->t;
}

/* What does the span show, behind panes and in mirrors?  hit->t is the length
 * of all of the way. */
static bool
meets(const struct look *l, const struct rad_span *span, struct rad_hit *hit)
{
    struct rad_geom_counts counts = { 0, 0 };
    struct rad_span rest = *span;
    double before = 0;

    for (int i = 0; i < MOST_PASSED; i++) {
        if (!rad_geom_nearest(l->geom, &rest, hit, &counts))
            return false;
        switch (kind_of(l->scene, hit->obj)) {
        case SHOWN:
            hit->t += before;
            return true;
        case PANE:
            rest.tmin = hit->t + ABOVE * hit->err;
            break;
        case MIRROR:
            before += hit->t;
            reflect(&rest, hit);
        }
    }
    return false;
}

/* The space before a surface at p, which faces along n: the distance of what is
 * farthest straight before it and aslant, of what is met there.  What is
 * nearest would be the next slat of a blind, or the vase on a table; light
 * comes from the room about them.  Rays begin at `from`. */
static double
space_before(const struct look *l, const double p[3], const double n[3],
             double from)
{
    static const int aslant[ABOUT][2] = {
        { 0, 0 }, { 1, 0 }, { -1, 0 }, { 0, 1 }, { 0, -1 }
    };
    struct rad_span span = { .tmin = from, .tmax = INFINITY };
    struct rad_hit hit;
    double u[3], v[3], farthest = 0;

    rad_copy(span.org, p);
    rad_frame(u, v, n);
    for (int i = 0; i < ABOUT; i++) {
        for (int k = 0; k < 3; k++)
            span.dir[k] = n[k] + aslant[i][0] * u[k] + aslant[i][1] * v[k];
        rad_normalize(span.dir);
        if (meets(l, &span, &hit))
            farthest = fmax(farthest, hit.t);
    }
    return farthest > 0 ? farthest : INFINITY;
}

static void
note(struct look *l, const double p[3], double eye, double space)
{
    rad_copy(l->at[l->n], p);
    l->eye[l->n] = eye;
    l->space[l->n++] = space;
}

static void
look_along(struct look *l, const struct rad_span *span)
{
    struct rad_hit hit;

    if (!meets(l, span, &hit))
        return;
    if (hit.n[0] * hit.way[0] + hit.n[1] * hit.way[1] + hit.n[2] * hit.way[2] >
        0)
        for (int k = 0; k < 3; k++)
            hit.n[k] = -hit.n[k];
    note(l, hit.p, hit.t, space_before(l, hit.p, hit.n, ABOVE * hit.err));
}

/* The value that this part of n values does not exceed; INFINITY: there are
 * none. */
static double
quantile(double *x, int n, double part)
{
    qsort(x, (size_t)n, sizeof *x, rad_compare_reals);
    return n > 0 ? x[(int)((n - 1) * part)] : INFINITY;
}

/* Keep the hits with something before them. */
static void
keep_enclosed(struct look *l)
{
    int n = 0;

    for (int i = 0; i < l->n; i++)
        if (l->space[i] < INFINITY) {
            rad_copy(l->at[n], l->at[i]);
            l->eye[n] = l->eye[i];
            l->space[n++] = l->space[i];
        }
    l->n = n;
}

/* The diameter of the smallest ball about a hit that holds this part of all;
 * *about is that hit. */
static double
smallest_ball(const struct look *l, double part, int *about)
{
    double least = INFINITY, far[RAYS];

    for (int i = 0; i < l->n; i++) {
        for (int j = 0; j < l->n; j++)
            far[j] = sqrt(rad_dist2(l->at[i], l->at[j]));
        far[0] = quantile(far, l->n, part);
        if (far[0] < least) {
            least = far[0];
            *about = i;
        }
    }
    return 2 * least;
}

/* How large is what was met, and about which hit?  INFINITY: that is not known.
 */
static double
size_of(struct look *l, int *about)
{
    int all = l->n, enclosed = 0;
    double size;

    if (all < LEAST_HITS)
        return INFINITY;
    for (int i = 0; i < all; i++)
        enclosed += l->space[i] < INFINITY;
    if (enclosed > ENCLOSED * all) {
        keep_enclosed(l);
        size = fmax(smallest_ball(l, IN_A_ROOM, about),
                    fmin(quantile(l->space, l->n, .5),
                         NEAR * quantile(l->eye, l->n, .5)));
    } else {
        size = smallest_ball(l, IN_THE_OPEN, about);
    }
    return size > 0 ? size : INFINITY;
}

/* Let the box hold a ball. */
static void
hold(struct surroundings *s, const double at[3], double radius)
{
    for (int k = 0; k < 3; k++) {
        s->lo[k] = fmin(s->lo[k], at[k] - radius);
        s->hi[k] = fmax(s->hi[k], at[k] + radius);
    }
}

static int
read_view(struct rad_view *view, const char *options, struct rad_error *err)
{
    char text[RAD_VIEW_TEXT + 8];
    int rc;

    snprintf(text, sizeof text, "VIEW= %s", options);
    rad_view_init(view);
    rc = rad_view_read(view, text, strlen(text), err);
    return rc < 0 ? rc : rad_view_setup(view, err);
}

static void
look_at_view(struct look *l, const struct rad_view *view)
{
    for (int i = 0; i < RAYS; i++) {
        struct rad_span span = { .tmin = 0 };
        double aft = rad_view_ray(view, (i % SIDE + .5) / SIDE,
                                  (i / SIDE + .5) / SIDE, span.org, span.dir);

        span.tmax = aft > 0 ? aft : INFINITY;
        if (aft >= 0)
            look_along(l, &span);
    }
}

/* A place whose irradiance is asked for is shown itself. */
static void
look_at_points(struct look *l, const struct rad_points *points, double slack)
{
    uint64_t pixels = (uint64_t)points->width * (uint64_t)points->height;

    for (uint64_t i = 0; i < RAYS; i++) {
        uint64_t pixel = i * pixels / RAYS;
        struct rad_span span = { .tmin = 0, .tmax = INFINITY };

        if (!rad_points_at(points, (int)(pixel % (uint64_t)points->width),
                           (int)(pixel / (uint64_t)points->width), span.org,
                           span.dir) ||
            !(rad_normalize(span.dir) > 0))
            continue;
        if (points->flags & RAD_POINTS_IRRADIANCE) {
            note(l, span.org, INFINITY,
                 space_before(l, span.org, span.dir, slack));
        } else {
            look_along(l, &span);
        }
    }
}

/* Look along so many of the views, or about the points. */
static int
look_at_all(struct surroundings *s, struct look *l,
            const struct surroundings_of *of, uint32_t views,
            struct rad_error *err)
{
    double least = INFINITY, size;
    int rc = 0;

    for (uint32_t i = 0; i < views && rc == 0; i++) {
        struct rad_view view;
        int about = 0;

        l->n = 0;
        if (of->points) {
            look_at_points(l, of->points, 1e-7 * s->cube);
        } else {
            rc = read_view(&view, of->frames[(uint64_t)i * of->n / views].view,
                           err);
            if (rc == 0)
                look_at_view(l, &view);
        }
        size = size_of(l, &about);
        if (isfinite(size))
            hold(s, l->at[about], size / 2);
        least = fmin(least, size);
    }
    s->shown = isfinite(least) ? least : 0;
    return rc;
}

int
surroundings_find(struct surroundings *s, const struct rad_scene *scene,
                  const struct surroundings_of *of, struct rad_error *err)
{
    uint8_t *surf = calloc((size_t)scene->nobjects + 1, 1);
    struct look *l = malloc(sizeof *l);
    uint32_t views = of->points ? 1 : of->n < MOST_VIEWS ? of->n : MOST_VIEWS;
    struct rad_geom *geom = NULL;
    double lo[3], hi[3];
    int rc = 0;

    *s = (struct surroundings){ 0 };
    for (int k = 0; k < 3; k++) {
        s->lo[k] = INFINITY;
        s->hi[k] = -INFINITY;
    }
    if (!surf || !l)
        rc = rad_fail_memory(err);
    else if (!(geom =
                   rad_geom_new(scene, surf, views * RAYS * (1 + ABOUT), err)))
        rc = err->code;
    if (rc == 0) {
        rad_geom_bounds(geom, lo, hi);
        for (int k = 0; k < 3; k++)
            s->cube = rad_most(s->cube, hi[k] - lo[k]);
        l->scene = scene;
        l->geom = geom;
        rc = look_at_all(s, l, of, views, err);
    }
    rad_geom_free(geom);
    free(l);
    free(surf);
    return rc;
}

int
surroundings_times(const struct surroundings *s)
{
    double more = s->shown > 0 ? s->cube / (TIMES_SHOWN * s->shown) : 1;
    int times = 1;

    while (times < MOST_TIMES && times * (double)STEP <= more)
        times *= STEP;
    return times > 1 ? times : 0;
}

/* Let the box hold all eyes, or the places of all points: of many frames or
 * points not all are looked at. */
static int
hold_eyes(struct surroundings *s, const struct surroundings_of *of,
          struct rad_error *err)
{
    const struct rad_points *points = of->points;
    double org[3], dir[3];
    struct rad_view view;
    int rc = 0;

    for (int y = 0; points && y < points->height; y++)
        for (int x = 0; x < points->width; x++)
            if (rad_points_at(points, x, y, org, dir))
                hold(s, org, 0);
    for (uint32_t i = 0; !points && i < of->n && rc == 0; i++)
        if ((rc = read_view(&view, of->frames[i].view, err)) == 0)
            hold(s, view.vp, 0);
    return rc;
}

/* In steps of a power of two, so that a picture's header has short numbers. */
int
surroundings_place(const struct surroundings *s,
                   const struct surroundings_of *of, double ball[4],
                   struct rad_error *err)
{
    struct surroundings all = *s;
    double step = exp2(floor(log2(s->shown / ROUND))), radius;
    int rc;

    memset(ball, 0, 4 * sizeof *ball);
    if (!(s->shown > 0))
        return 0;
    rc = hold_eyes(&all, of, err);
    radius = ceil(sqrt(rad_dist2(all.lo, all.hi)) / 2 / step + 1) * step;
    if (rc < 0 || !isfinite(radius))
        return rc;
    for (int k = 0; k < 3; k++)
        ball[k] = floor((all.lo[k] + all.hi[k]) / 2 / step + .5) * step;
    ball[3] = radius;
    return 0;
}

bool
surroundings_blur(const struct surroundings *s, int ambres)
{
    return surroundings_times(s) > 0 && ambres > 0 &&
           s->cube / ambres > s->shown;
}

int
surroundings_ambres(int times, int ambres)
{
    enum { MOST = 1000000000 };
    double to = (double)ambres * (times > 1 ? times : 1);

    return to < MOST ? (int)to : ambres > MOST ? ambres : MOST;
}
