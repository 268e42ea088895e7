/* paint.c - see paint.h
 *
 * As in rpict, a flat or distant source is painted as a parallelogram, a ball
 * or tube as a box (light/direct/shape.c).  A box's outline has six corners:
 * all but the nearest to the eye and the furthest. */
#include "config.h"

#include "picture/paint.h"
#include "base/list.h"
#include "base/rng.h"
#include "base/vec.h"
#include "light/direct/source.h"
#include "light/direct/emitter.h"

#include <stdlib.h>
#include <string.h>

enum {
    /* clipping at one side of a pixel adds a corner, and half as many as there
     * are if the outline crosses itself: 6, 9, 13, 19, 28 */
    MOST_CORNERS = 28,
    /* branch of a painting ray's key, apart from those of surfaces */
    BRANCH_PAINT = 0x7f000000
};

/* A distant source of this radius [rad] or more cannot be missed. */
#define WIDE_DISTANT .05

/* The sampler has met the source in a pixel that differs by less than this. */
#define SAME_RADIANCE .07

typedef double corner[2];

/* Clip a polygon to side * v[axis] >= side * limit.  Side -1 excludes the limit
 * itself, so that an edge between two pixels belongs to one of them.
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
rad_paint_coverage(const struct rad_paint_source *s,
                   const struct rad_canvas *canvas, int x, int y,
                   double centre[2])
{
    corner a[MOST_CORNERS], b[MOST_CORNERS];
    int width = canvas->width, height = canvas->height;
    int n = clip(s->corner, s->ncorners, 0, (double)x / width, 1, a);

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

/* Make a polygon convex: drop each corner without which the area is no less. */
static int
drop_dents(corner *v, int n)
{
    double whole = area(v, n);

    for (int i = 0; i < n;) {
        corner rest[RAD_PAINT_CORNERS];
        double size;

        memcpy(rest, v, (size_t)i * sizeof *v);
        memcpy(rest + i, v + i + 1, (size_t)(n - 1 - i) * sizeof *v);
        size = area(rest, n - 1);
        if (size >= whole) {
            whole = size;
            memcpy(v, rest, (size_t)--n * sizeof *v);
        } else {
            i++;
        }
    }
    return n;
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

/* Is the source turned away from vp, or too wide to be missed? */
static bool
unseen(const struct rad_source_shape *s, const double vp[3],
       const struct rad_view *v)
{
    double to[3];

    if (s->distant)
        return v->type == 'l' || s->radius >= WIDE_DISTANT;
    rad_sub(to, s->centre, vp);
    return s->flat && rad_dot(to, s->axis[2]) >= 0;
}

/* The corner of a shape at the + end of each half-axis whose bit is set, and at
 * the - end of the others. */
static void
corner_of(const struct rad_source_shape *s, int naxes, unsigned bits,
          double p[3])
{
    rad_copy(p, s->centre);
    for (int k = 0; k < naxes; k++)
        rad_madd(p, p, bits >> k & 1 ? 1 : -1, s->axis[k]);
}

/* The corners, in space, of the shape that is painted for a source seen from
 * vp.  Those of a box begin with the one of the lowest bits and go round the
 * box in one direction.  The order decides which corners drop_dents() leaves if
 * a parallel view shows other sides of the box than are seen from vp. */
static int
silhouette(const struct rad_source_shape *s, const double vp[3], double (*p)[3])
{
    static const unsigned flat[] = { 0, 1, 3, 2 },
                          round[] = { 1, 3, 2, 6, 4, 5 };
    unsigned furthest = 0, parity = 0, start = 0, lowest;
    double to[3];

    if (s->flat || s->distant) {
        for (int i = 0; i < 4; i++)
            corner_of(s, 2, flat[i], p[i]);
        return 4;
    }
    rad_sub(to, s->centre, vp);
    for (int k = 0; k < 3; k++)
        if (rad_dot(to, s->axis[k]) > 0) {
            furthest |= 1u << k;
            parity ^= 1;
        }
    lowest = furthest == 0 || furthest == 7;
    while ((round[start] ^ furthest) != lowest)
        start++;
    for (unsigned i = 0; i < 6; i++)
        corner_of(s, 3, round[(start + (parity ? 6 - i : i)) % 6] ^ furthest,
                  p[i]);
    return 6;
}

/* The outline of a source or of its image; false: there is none, or it is not
 * wholly in view. */
static bool
find_outline(const struct rad_job *job, int32_t i,
             const struct rad_source_shape *shape, const struct rad_view *v,
             struct rad_paint_source *out)
{
    double p[RAD_PAINT_CORNERS][3], vp[3];
    int n;

    rad_source_seen_from(job->sources, i, v->vp, vp);
    if (unseen(shape, vp, v))
        return false;
    n = silhouette(shape, vp, p);
    for (int k = 0; k < n; k++) {
        rad_source_appears(job->sources, i, p[k], p[k]);
        if (shape->distant) /* any point beyond the fore plane serves */
            rad_madd(p[k], v->vp, 1 + v->vfore, p[k]);
        if (rad_view_locate(v, p[k], out->corner[k]) != 0)
            return false;
    }
    out->ncorners = n == 4 ? n : drop_dents(out->corner, n);
    return out->ncorners >= 3;
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
        struct rad_source_shape shape;
        struct rad_paint_source s;

        rad_source_shape(job->sources, i, &shape);
        e = rad_emitter_of(job, shape.obj);
        if (!e || e->type == RAD_ILLUM ||
            !find_outline(job, i, &shape, v, &s) ||
            least_width2(s.corner, s.ncorners, v->vn2 / v->hn2) > step * step)
            continue;
        if (!rad_list_grow(&p->list, (size_t)p->n, sizeof *p->list)) {
            rad_paint_release(p);
            return rad_fail_memory(err);
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

/* The radiance of source i along the ray at picture position pos, and the
 * distance; black if the source is hidden. */
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

/* Let the source, of radiance L at distance dist, cover the share w of a pixel.
 * If the sampler has met the source there (same radiance, and with -z the
 * source no nearer than what the sampler found), the pixel is all source, and
 * is scaled down to the share. */
static void
cover(struct rad_pixel *p, struct rad_rgb L, double dist, double w, bool depth)
{
    bool same = channel_same(L.r, p->L.r) && channel_same(L.g, p->L.g) &&
                channel_same(L.b, p->L.b);

    if (depth && dist < .99 * p->z) {
        p->z = (float)dist;
        same = false;
    }
    if (same)
        p->L = rad_rgb_scale(p->L, w);
    else
        p->L = rad_rgb_add(rad_rgb_scale(p->L, 1 - w), rad_rgb_scale(L, w));
}

/* Narrow [*x0, *x1) to the columns that a source may cover in row y from the
 * bottom; false: there are none. */
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
            double w = rad_paint_coverage(s, canvas, x, up, centre);
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
