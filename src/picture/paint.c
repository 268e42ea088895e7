/* paint.c - see paint.h
 *
 * A source is painted as what is seen of it: convex polygons by their corners,
 * balls, disks and distant sources by a polygon of the circle's area, tubes by
 * a rectangle; a polygon that is not convex and a ring with a hole by a square
 * as large.  What no sample misses is left to the sampler. */
#include "config.h"

#include "picture/paint.h"
#include "arith/elementary.h"
#include "base/rng.h"
#include "base/vec.h"
#include "light/direct/source.h"
#include "light/direct/emitter.h"

#include <stdlib.h>
#include <string.h>

enum {
    /* clipping to a pixel adds one corner a side */
    MOST_CORNERS = RAD_PAINT_CORNERS + 4,
    /* branch of a painting ray's key, away from those of surfaces */
    BRANCH_PAINT = 0x7f000000
};

/* A distant source of this radius [rad] or more is never missed. */
#define WIDE_DISTANT .05

/* A polygon whose hull is larger by this share is not convex. */
#define CONCAVE 1e-6

/* A pixel that differs by less than this from the source has met it. */
#define SAME_RADIANCE .07

typedef double corner[2];

/* Clip a polygon to side * v[axis] >= side * limit; the far side of each pair
 * is open, so that an edge between two pixels belongs to one.
 * Source: Sutherland & Hodgman 1974. */
static int
clip(const corner *in, int n, int axis, double limit, int side, corner *out)
{
    int kept = 0;

    for (int i = 0; i < n; i++) {
        const double *a = in[(i + n - 1) % n], *b = in[i];
        bool a_in = side > 0 ? a[axis] >= limit : a[axis] < limit;
        bool b_in = side > 0 ? b[axis] >= limit : b[axis] < limit;

        if (a_in != b_in) {
            double t = (limit - a[axis]) / (b[axis] - a[axis]);

            out[kept][1 - axis] = a[1 - axis] + t * (b[1 - axis] - a[1 - axis]);
            out[kept++][axis] = limit;
        }
        if (b_in) {
            out[kept][0] = b[0];
            out[kept++][1] = b[1];
        }
    }
    return kept;
}

static double
area(const corner *v, int n)
{
    double twice = 0;

    for (int i = 2; i < n; i++)
        twice += (v[i - 1][0] - v[0][0]) * (v[i][1] - v[0][1]) -
                 (v[i - 1][1] - v[0][1]) * (v[i][0] - v[0][0]);
    return fabs(twice) / 2;
}

double
rad_paint_coverage(const double (*in)[2], int n, int width, int height, int x,
                   int y, double centre[2])
{
    corner a[MOST_CORNERS], b[MOST_CORNERS];

    n = clip(in, n, 0, (double)x / width, 1, a);
    n = clip(a, n, 0, (x + 1.) / width, -1, b);
    n = clip(b, n, 1, (double)y / height, 1, a);
    n = clip(a, n, 1, (y + 1.) / height, -1, b);
    if (n == 0)
        return 0;
    centre[0] = centre[1] = 0;
    for (int i = 0; i < n; i++) {
        centre[0] += b[i][0] / n;
        centre[1] += b[i][1] / n;
    }
    return area(b, n) * width * height;
}

static int
by_position(const void *a, const void *b)
{
    const double *p = a, *q = b;

    if (p[0] != q[0])
        return p[0] < q[0] ? -1 : 1;
    return p[1] < q[1] ? -1 : p[1] > q[1];
}

/* Does the path a, b, c turn left? */
static bool
turns_left(const double *a, const double *b, const double *c)
{
    return (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0]);
}

/* Convex hull of the corners, which get sorted; returns how many it has.
 * Source: Andrew 1979 (monotone chain). */
static int
hull(corner *v, int n, corner *out)
{
    corner chain[2 * RAD_PAINT_CORNERS];
    int k = 0;

    qsort(v, (size_t)n, sizeof *v, by_position);
    for (int pass = 0; pass < 2; pass++) {
        int start = k;

        for (int i = 0; i < n; i++) {
            const double *p = v[pass ? n - 1 - i : i];

            while (k >= start + 2 && !turns_left(chain[k - 2], chain[k - 1], p))
                k--;
            memcpy(chain[k++], p, sizeof *chain);
        }
        k--; /* the last is the other half's first */
    }
    memcpy(out, chain, (size_t)k * sizeof *out);
    return k;
}

/* Square of the least width of a convex polygon, in picture widths; aspect2 is
 * the squared height of the picture over its width. */
static double
least_width2(const corner *v, int n, double aspect2)
{
    double least = INFINITY;

    for (int i = 0; i < n; i++) {
        const double *a = v[i], *b = v[(i + 1) % n];
        double ex = b[0] - a[0], ey = b[1] - a[1], widest = 0;
        double edge2 = ex * ex + ey * ey * aspect2;

        if (edge2 == 0)
            continue;
        for (int j = 0; j < n; j++) {
            double twice = ex * (v[j][1] - a[1]) - ey * (v[j][0] - a[0]);

            widest = fmax(widest, twice * twice * aspect2 / edge2);
        }
        least = fmin(least, widest);
    }
    return least;
}

/* A source, or the image of one, and who looks at it. */
struct seen {
    const struct rad_sources *sources;
    int32_t i;
    struct rad_source_shape shape;
    const struct rad_object *o;
    const struct rad_view *view;
    double vp[3], dir[3]; /* of the view, as the source itself has it */
};

static void
see(struct seen *s, const struct rad_job *job, int32_t i,
    const struct rad_view *v)
{
    double ahead[3];

    s->sources = job->sources;
    s->i = i;
    rad_source_shape(s->sources, i, &s->shape);
    s->o = &job->scene->objects[s->shape.obj];
    s->view = v;
    rad_source_seen_from(s->sources, i, v->vp, s->vp);
    rad_madd(ahead, v->vp, 1, v->dir);
    rad_source_seen_from(s->sources, i, ahead, s->dir);
    rad_sub(s->dir, s->dir, s->vp);
}

/* Where a source is looked at from: to its centre. */
static void
line_of_sight(const struct seen *s, double to[3])
{
    if (s->shape.distant)
        rad_copy(to, s->shape.centre);
    else if (s->view->type == 'l')
        rad_copy(to, s->dir);
    else
        rad_sub(to, s->shape.centre, s->vp);
}

/* Is the source turned away, or one that cannot be outlined? */
static bool
unseen(const struct seen *s)
{
    double to[3];

    if (s->shape.distant)
        return s->view->type == 'l' || s->shape.radius >= WIDE_DISTANT;
    if (!s->shape.flat)
        return false;
    line_of_sight(s, to);
    return rad_dot(to, s->shape.axis[2]) >= 0;
}

/* A parallelogram of half-axes a and b. */
static int
four_corners(const double centre[3], const double a[3], const double b[3],
             double (*p)[3])
{
    for (int k = 0; k < 4; k++) {
        rad_madd(p[k], centre, k == 1 || k == 2 ? 1 : -1, a);
        rad_madd(p[k], p[k], k > 1 ? 1 : -1, b);
    }
    return 4;
}

/* An ellipse, by a polygon of its area; a and b are half-axes of a
 * parallelogram as large. */
static int
round_corners(const double centre[3], const double a[3], const double b[3],
              double (*p)[3])
{
    const int n = RAD_PAINT_CORNERS;
    double scale = sqrt(8 / (n * rad_sin(2 * M_PI / n)));

    for (int k = 0; k < n; k++) {
        rad_madd(p[k], centre, scale * rad_cos(2 * M_PI * k / n), a);
        rad_madd(p[k], p[k], scale * rad_sin(2 * M_PI * k / n), b);
    }
    return n;
}

/* What is seen of a source, by its corners in space.  Of a tube that is a
 * rectangle across the line of sight; its ends are open and show nothing. */
static int
silhouette(const struct seen *seen, double (*p)[3])
{
    const struct rad_source_shape *s = &seen->shape;
    const struct rad_object *o = seen->o;
    double to[3], a[3], b[3];

    line_of_sight(seen, to);
    switch (o->type) {
    case RAD_SPHERE:
        rad_normalize(to);
        rad_frame(a, b, to);
        rad_scale(a, sqrt(M_PI) / 2 * s->radius, a);
        rad_scale(b, sqrt(M_PI) / 2 * s->radius, b);
        return round_corners(s->centre, a, b, p);
    case RAD_CYLINDER:
        rad_cross(a, s->axis[0], to);
        rad_normalize(a);
        rad_scale(a, fabs(o->reals[6]), a);
        return four_corners(s->centre, s->axis[0], a, p);
    case RAD_POLYGON:
        if (o->nreals > 3 * RAD_PAINT_CORNERS)
            break;
        memcpy(p, o->reals, (size_t)o->nreals * sizeof *o->reals);
        return o->nreals / 3;
    default:
        if (o->type == RAD_SOURCE || o->reals[6] == 0 || o->reals[7] == 0)
            return round_corners(s->centre, s->axis[0], s->axis[1], p);
    }
    return four_corners(s->centre, s->axis[0], s->axis[1], p);
}

/* Outline in picture positions of what has n corners in space; false: not
 * wholly in view, or not convex. */
static bool
outline(const struct seen *s, int n, double (*p)[3],
        struct rad_paint_source *out)
{
    corner v2[RAD_PAINT_CORNERS];
    double whole;

    for (int k = 0; k < n; k++) {
        rad_source_appears(s->sources, s->i, p[k], p[k]);
        if (s->shape.distant) /* any point beyond the fore plane will do */
            rad_madd(p[k], s->view->vp, 1 + s->view->vfore, p[k]);
        if (rad_view_locate(s->view, p[k], v2[k]) != 0)
            return false;
    }
    whole = area(v2, n);
    out->ncorners = hull(v2, n, out->corner);
    return out->ncorners >= 3 &&
           area(out->corner, out->ncorners) <= whole * (1 + CONCAVE);
}

static bool
find_outline(const struct seen *s, struct rad_paint_source *out)
{
    double p[RAD_PAINT_CORNERS][3];

    if (unseen(s))
        return false;
    if (outline(s, silhouette(s, p), p, out))
        return true;
    /* a polygon that is not convex, by a square as large */
    return s->o->type == RAD_POLYGON &&
           outline(s,
                   four_corners(s->shape.centre, s->shape.axis[0],
                                s->shape.axis[1], p),
                   p, out);
}

/* Can no sample miss it?  Samples are `step` picture widths apart.  A strip as
 * wide as a step meets some; what is round or has three corners may lie between
 * four of them until it is as wide as they are across. */
static bool
never_missed(const struct rad_paint_source *s, const struct rad_view *v,
             double step)
{
    double wide = s->ncorners == 4 ? step : M_SQRT2 * step;

    return least_width2(s->corner, s->ncorners, v->vn2 / v->hn2) > wide * wide;
}

/* Room for one more in the list, which doubles. */
static bool
grow(struct rad_paint *p)
{
    size_t n = (size_t)p->n;
    struct rad_paint_source *more = p->list;

    if ((n & (n - 1)) == 0)
        more = realloc(p->list, (n ? 2 * n : 1) * sizeof *more);
    if (more)
        p->list = more;
    return more;
}

int
rad_paint_init(struct rad_paint *p, const struct rad_job *job,
               const struct rad_view *v, int width, struct rad_error *err)
{
    int32_t n = rad_sources_targets(job->sources);
    double step = (double)job->params.psample / width;

    p->n = 0;
    p->list = NULL;
    for (int32_t i = 0; i < n; i++) {
        const struct rad_emitter *e;
        struct rad_paint_source s;
        struct seen seen;

        see(&seen, job, i, v);
        e = rad_emitter_of(job, seen.shape.obj);
        if (!e || e->type == RAD_ILLUM || !find_outline(&seen, &s) ||
            never_missed(&s, v, step))
            continue;
        if (!grow(p)) {
            rad_paint_release(p);
            return rad_fail(err, RAD_ENOMEM, "out of memory");
        }
        s.source = i;
        p->list[p->n++] = s;
    }
    return 0;
}

void
rad_paint_release(struct rad_paint *p)
{
    free(p->list);
    p->list = NULL;
    p->n = 0;
}

/* The radiance of source i along the ray at picture position pos, and its
 * distance; black where it is hidden. */
static struct rad_rgb
look(const struct rad_canvas *canvas, struct rad_ctx *ctx, int32_t i,
     uint64_t key, const double pos[2], double *dist)
{
    struct rad_ray r;
    double aft = rad_view_ray(canvas->view, pos[0], pos[1], r.org, r.dir);

    if (aft < 0)
        return rad_grey(0);
    r.tmax = aft > 0 ? aft : INFINITY;
    r.key = key;
    if (!rad_ray_spawn(ctx, &r, RAD_RAY_RSHADOW, NULL, NULL, 0))
        return rad_grey(0);
    r.source = i;
    ctx->counts.paint_rays++;
    rad_ray_trace(ctx, &r);
    *dist = r.dist;
    return rad_params_colour(&ctx->job->params, r.L);
}

static bool
channel_same(float a, float b)
{
    return a - b <= SAME_RADIANCE * b && b - a <= SAME_RADIANCE * a;
}

/* Let the share w of a pixel have radiance L at distance dist.  One that the
 * sampler found as bright is brought down to what the source covers. */
static void
cover(struct rad_pixel *p, struct rad_rgb L, double dist, double w, bool depth)
{
    bool same = channel_same(L.r, p->L.r) && channel_same(L.g, p->L.g) &&
                channel_same(L.b, p->L.b);

    if (depth && dist < .99 * p->z)
        p->z = (float)dist;
    if (same)
        p->L = rad_rgb_scale(p->L, (float)w);
    else
        p->L = rad_rgb_add(rad_rgb_scale(p->L, (float)(1 - w)),
                           rad_rgb_scale(L, (float)w));
}

/* The columns of [x0, x1) that a source may cover in row y from the bottom;
 * false: none. */
static bool
columns(const struct rad_paint_source *s, const struct rad_canvas *canvas,
        int y, int *x0, int *x1)
{
    double lo[2] = { 1, 1 }, hi[2] = { 0, 0 };

    for (int i = 0; i < s->ncorners; i++)
        for (int k = 0; k < 2; k++) {
            lo[k] = fmin(lo[k], s->corner[i][k]);
            hi[k] = fmax(hi[k], s->corner[i][k]);
        }
    if (hi[1] * canvas->height <= y || lo[1] * canvas->height >= y + 1)
        return false;
    if (*x0 < (int)(lo[0] * canvas->width))
        *x0 = (int)(lo[0] * canvas->width);
    if (*x1 > (int)(hi[0] * canvas->width) + 1)
        *x1 = (int)(hi[0] * canvas->width) + 1;
    return *x0 < *x1;
}

void
rad_paint_row(const struct rad_paint *p, const struct rad_canvas *canvas,
              struct rad_ctx *ctx, int x0, int x1, int y, struct rad_pixel *row)
{
    int up = canvas->height - 1 - y;
    uint64_t unsound = ctx->counts.unsound_rays;

    for (int32_t i = 0; i < p->n; i++) {
        const struct rad_paint_source *s = &p->list[i];
        int from = x0, to = x1;

        if (!columns(s, canvas, up, &from, &to))
            continue;
        for (int x = from; x < to; x++) {
            double centre[2], dist = 0;
            double w = rad_paint_coverage(s->corner, s->ncorners, canvas->width,
                                          canvas->height, x, up, centre);
            uint64_t key = rad_key_pixel(canvas->seed, canvas->frame,
                                         (uint32_t)x, (uint32_t)y);
            struct rad_rgb L;

            if (w <= 0)
                continue;
            key = rad_key_branch(key, BRANCH_PAINT + (uint32_t)i);
            L = look(canvas, ctx, s->source, key, centre, &dist);
            if (ctx->counts.unsound_rays != unsound)
                rad_counts_nan(&ctx->counts, x, y);
            unsound = ctx->counts.unsound_rays;
            if (!rad_rgb_black(L))
                cover(&row[x - x0], L, dist, w, canvas->depth);
        }
    }
}
