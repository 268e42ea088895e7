/* overlap.c - see overlap.h */
#include "config.h"

#include "scene/overlap.h"

#include "base/vec.h"
#include "scene/part.h"

#include <math.h>
#include <string.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

/* Bounds the rounding of the few dozen operations of a test, relative to the
 * largest coordinate: each is 2^-53, and there is ample room. */
#define ROUND 1e-13

/* --- extents --- */

static void
include_point(struct rad_extent *e, const double p[3])
{
    for (int i = 0; i < 3; i++) {
        e->lo[i] = fmin(e->lo[i], p[i]);
        e->hi[i] = fmax(e->hi[i], p[i]);
    }
}

/* The sum of cross products: a vector along the normal, of twice the area. */
static void
polygon_normal(const struct rad_object *o, double n[3])
{
    const double *v = o->reals;
    double a[3], b[3], c[3];

    n[0] = n[1] = n[2] = 0;
    for (int32_t i = 3; i + 5 < o->nreals; i += 3) {
        rad_sub(a, v + i, v);
        rad_sub(b, v + i + 3, v);
        rad_cross(c, a, b);
        rad_madd(n, n, 1, c);
    }
}

/* The surface lies in the mean plane of the vertices, which may be off it. */
static bool
polygon_extent(const struct rad_object *o, struct rad_extent *e)
{
    double n[3], mean = 0, off = 0;

    for (int32_t i = 0; i + 2 < o->nreals; i += 3)
        include_point(e, o->reals + i);
    polygon_normal(o, n);
    if (!(rad_normalize(n) > 0))
        return false;
    for (int32_t i = 0; i + 2 < o->nreals; i += 3)
        mean += rad_dot(n, o->reals + i) / (o->nreals / 3);
    for (int32_t i = 0; i + 2 < o->nreals; i += 3)
        off = fmax(off, fabs(rad_dot(n, o->reals + i) - mean));
    e->slack = off;
    return true;
}

/* The line that makes a cone, cylinder or ring when turned about the axis: from
 * height 0 and radius r0 to height len and radius r1. */
struct generator {
    double base[3], axis[3]; /* axis of unit length */
    double len, r0, r1;
};

static bool
get_generator(const struct rad_object *o, struct generator *g)
{
    const double *a = o->reals;
    double len;

    rad_copy(g->base, a);
    if (o->type == RAD_RING)
        rad_copy(g->axis, a + 3);
    else
        rad_sub(g->axis, a + 3, a);
    len = rad_normalize(g->axis);
    g->len = o->type == RAD_RING ? 0 : len;
    g->r0 = fabs(a[6]);
    g->r1 = o->nreals > 7 ? fabs(a[7]) : g->r0;
    if (!(len > 0) || (o->nreals > 7 && !rad_object_radii_fit(o)))
        return false;
    return o->type == RAD_RING ? g->r0 != g->r1 : g->r0 + g->r1 > 0;
}

static bool
generator_extent(const struct rad_object *o, struct rad_extent *e)
{
    struct generator g;

    if (!get_generator(o, &g))
        return false;
    for (int end = 0; end < 2; end++) {
        double r = end ? g.r1 : g.r0;

        for (int i = 0; i < 3; i++) {
            double w = r * sqrt(fmax(0, 1 - g.axis[i] * g.axis[i]));
            double c = g.base[i] + (end ? g.len : 0) * g.axis[i];

            e->lo[i] = fmin(e->lo[i], c - w);
            e->hi[i] = fmax(e->hi[i], c + w);
        }
    }
    /* if 1 - axis^2 is small, half of its digits are lost */
    e->slack = 1e-8 * fmax(g.r0, g.r1);
    return true;
}

/* The transformed cube around an instance or mesh. */
struct turned {
    double middle[3], half;
    double axis[3][3]; /* of unit length */
};

static bool
get_turned(const struct rad_object *o, struct turned *t)
{
    const struct rad_use *use = o->use;
    double mid[3];

    if (!use || !(use->part->size > 0))
        return false;
    for (int i = 0; i < 3; i++) {
        mid[i] = use->part->org[i] + use->part->size / 2;
        rad_scale(t->axis[i], 1 / use->move.scale, use->move.m[i]);
    }
    rad_xform_point(t->middle, &use->move, mid);
    t->half = use->part->size / 2 * use->move.scale;
    return true;
}

static bool
copy_extent(const struct rad_object *o, struct rad_extent *e)
{
    struct turned t;

    if (!get_turned(o, &t))
        return false;
    for (int i = 0; i < 3; i++) {
        double w = t.half * (fabs(t.axis[0][i]) + fabs(t.axis[1][i]) +
                             fabs(t.axis[2][i]));

        e->lo[i] = t.middle[i] - w;
        e->hi[i] = t.middle[i] + w;
    }
    /* for the twelve digits of the cube, and rounding of the transform */
    e->slack = 1e-10 * t.half;
    return true;
}

bool
rad_extent_of(const struct rad_object *o, struct rad_extent *e)
{
    bool good = false;

    e->slack = 0;
    for (int i = 0; i < 3; i++) {
        e->lo[i] = INFINITY;
        e->hi[i] = -INFINITY;
    }
    switch (o->type) {
    case RAD_POLYGON:
        good = o->nreals >= 9 && polygon_extent(o, e);
        break;
    case RAD_SPHERE:
    case RAD_BUBBLE:
        good = o->nreals == 4 && o->reals[3] != 0;
        for (int i = 0; good && i < 3; i++) {
            e->lo[i] = o->reals[i] - fabs(o->reals[3]);
            e->hi[i] = o->reals[i] + fabs(o->reals[3]);
        }
        break;
    case RAD_CONE:
    case RAD_CUP:
    case RAD_CYLINDER:
    case RAD_TUBE:
    case RAD_RING:
        good = o->nreals >= 7 && generator_extent(o, e);
        break;
    case RAD_INSTANCE:
    case RAD_MESH:
        good = copy_extent(o, e);
        break;
    default:
        break;
    }
    for (int i = 0; good && i < 3; i++) {
        e->slack += ROUND * fmax(fabs(e->lo[i]), fabs(e->hi[i]));
        good = isfinite(e->lo[i]) && isfinite(e->hi[i]);
    }
    for (int i = 0; good && i < 3; i++) {
        e->lo[i] -= e->slack;
        e->hi[i] += e->slack;
    }
    return good;
}

/* --- polygons --- */

/* Is the projection of a triangle, from a to b, apart from that of a cube, from
 * -r to r?  Plain comparisons, because a large mesh spends most of its time
 * here. */
static inline bool
apart(double a, double b, double r)
{
    return (a > r && b > r) || (a < -r && b < -r);
}

/* Does an axis along the cross product of the edge e and x, y or z separate the
 * triangle from the cube?  The triangle is given by an end of the edge and the
 * corner opposite to it. */
static inline bool
edge_parts(const double e[3], const double end[3], const double corner[3],
           double h, double pad)
{
    for (int i = 0; i < 3; i++) {
        int j = i == 2 ? 0 : i + 1;
        double r = h * (fabs(e[i]) + fabs(e[j])) + pad;

        if (apart(e[i] * end[j] - e[j] * end[i],
                  e[i] * corner[j] - e[j] * corner[i], r))
            return true;
    }
    return false;
}

static inline bool
within(const double p[3], double h)
{
    return fabs(p[0]) <= h && fabs(p[1]) <= h && fabs(p[2]) <= h;
}

/* Does a triangle meet the cube around 0 with half-edge h?  Their bounds meet,
 * so what is left to test are the triangle's plane and nine cross products of
 * edges.  The pads bound the rounding of an edge, relative to |v|, and of the
 * products, so that no sliver is lost.  An axis of length 0
 * separates nothing. */
static bool
triangle_meets_cube(const double v[3][3], double h)
{
    double e[3][3], n[3], size = 0, pad, d;

    if (within(v[0], h) || within(v[1], h) || within(v[2], h))
        return true;
    for (int i = 0; i < 3; i++) {
        rad_sub(e[i], v[i == 2 ? 0 : i + 1], v[i]);
        for (int k = 0; k < 3; k++)
            if (fabs(v[i][k]) > size)
                size = fabs(v[i][k]);
    }
    pad = 1e-15 * size * size;
    rad_cross(n, e[0], e[1]);
    d = rad_dot(n, v[0]);
    if (apart(d, d,
              h * (fabs(n[0]) + fabs(n[1]) + fabs(n[2])) + 4 * size * pad))
        return false;
    return !edge_parts(e[0], v[0], v[2], h, pad) &&
           !edge_parts(e[1], v[1], v[0], h, pad) &&
           !edge_parts(e[2], v[2], v[1], h, pad);
}

/* Polygons with more vertices are not clipped, and only their bounds and their
 * plane are tested. */
#define MAX_CLIPPED 32
/* Each of six planes adds at most one vertex per two edges. */
#define MAX_VERTICES (MAX_CLIPPED * 12)

/* Clip a loop to side * v[axis] <= h; returns the number of vertices. */
static int
clip_loop(double out[][3], const double in[][3], int n, int axis, double side,
          double h)
{
    int m = 0;

    for (int i = 0; i < n; i++) {
        const double *a = in[i], *b = in[i + 1 < n ? i + 1 : 0];
        double da = h - side * a[axis], db = h - side * b[axis];

        if (da >= 0)
            rad_copy(out[m++], a);
        if ((da < 0) != (db < 0)) {
            double t = da / (da - db);

            for (int k = 0; k < 3; k++)
                out[m][k] = a[k] + t * (b[k] - a[k]);
            out[m++][axis] = side * h;
        }
    }
    return m;
}

static bool
loop_meets_cube(double v[][3], int n, double h)
{
    double other[MAX_VERTICES][3];

    for (int axis = 0; axis < 3 && n > 0; axis++) {
        n = clip_loop(other, (const double(*)[3])v, n, axis, 1, h);
        n = clip_loop(v, (const double(*)[3])other, n, axis, -1, h);
    }
    return n > 0;
}

static bool
plane_meets_cube(const struct rad_object *o, const double centre[3], double h)
{
    double n[3], d[3], mean = 0;

    polygon_normal(o, n);
    for (int32_t i = 0; i + 2 < o->nreals; i += 3) {
        rad_sub(d, o->reals + i, centre);
        mean += rad_dot(n, d) / (o->nreals / 3);
    }
    return fabs(mean) <= h * (fabs(n[0]) + fabs(n[1]) + fabs(n[2]));
}

static bool
polygon_meets_cube(const struct rad_object *o, const double centre[3], double h)
{
    double v[MAX_VERTICES][3];
    int n = o->nreals / 3;

    if (n > MAX_CLIPPED)
        return plane_meets_cube(o, centre, h);
    for (int i = 0; i < n; i++)
        rad_sub(v[i], o->reals + 3 * (size_t)i, centre);
    if (n == 3)
        return triangle_meets_cube((const double(*)[3])v, h);
    return loop_meets_cube(v, n, h);
}

/* --- curved surfaces --- */

static bool
sphere_meets_cube(const struct rad_object *o, const double centre[3], double h)
{
    double near = 0, far = 0, r2 = o->reals[3] * o->reals[3];

    for (int i = 0; i < 3; i++) {
        double d = fabs(o->reals[i] - centre[i]);

        if (d > h)
            near += (d - h) * (d - h);
        far += (d + h) * (d + h);
    }
    return near <= r2 && far >= r2;
}

/* The distance of p from the surface. */
static double
generator_distance(const struct generator *g, const double p[3])
{
    double d[3], q[3], height, radius, dh = g->len, dr = g->r1 - g->r0, t, a, b;

    rad_sub(d, p, g->base);
    height = rad_dot(d, g->axis);
    rad_madd(q, d, -height, g->axis);
    radius = sqrt(rad_dot(q, q));
    t = (height * dh + (radius - g->r0) * dr) / (dh * dh + dr * dr);
    t = fmin(1, fmax(0, t));
    a = height - t * dh;
    b = radius - g->r0 - t * dr;
    return sqrt(a * a + b * b);
}

/* Test the balls inside and around the cube, then the same for its eight parts,
 * to the given depth. */
static bool
generator_meets_cube(const struct generator *g, const double centre[3],
                     double h, double slack, int depth)
{
    double d = generator_distance(g, centre);

    if (d <= h + slack)
        return true;
    if (d > 1.7320508075688774 * h + slack)
        return false;
    if (depth == 0)
        return true;
    for (int k = 0; k < 8; k++) {
        double c[3];

        for (int i = 0; i < 3; i++)
            c[i] = centre[i] + (k >> i & 1 ? h / 2 : -h / 2);
        if (generator_meets_cube(g, c, h / 2, slack, depth - 1))
            return true;
    }
    return false;
}

/* --- copies --- */

/* Do the projections on the axis separate the cube from the copy?  d is the
 * vector from the cube's middle to the copy's. */
static bool
axis_parts(const double axis[3], const double d[3], const struct turned *t,
           double h)
{
    double reach = h * (fabs(axis[0]) + fabs(axis[1]) + fabs(axis[2]));

    for (int i = 0; i < 3; i++)
        reach += t->half * fabs(rad_dot(t->axis[i], axis));
    return fabs(rad_dot(axis, d)) > reach * (1 + 1e-10);
}

/* The bounds meet, so what is left to test are the copy's axes, and the cross
 * products of an edge of each. */
static bool
copy_meets_cube(const struct rad_object *o, const double centre[3], double h)
{
    static const double edge[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    struct turned t;
    double d[3], axis[3];

    if (!get_turned(o, &t))
        return false;
    rad_sub(d, t.middle, centre);
    for (int i = 0; i < 3; i++) {
        if (axis_parts(t.axis[i], d, &t, h))
            return false;
        for (int k = 0; k < 3; k++) {
            rad_cross(axis, t.axis[i], edge[k]);
            /* nearly parallel edges: other axes decide */
            if (rad_dot(axis, axis) > 1e-12 && axis_parts(axis, d, &t, h))
                return false;
        }
    }
    return true;
}

bool
rad_overlaps_cube(const struct rad_object *o, const struct rad_extent *e,
                  const double centre[3], double half)
{
    struct generator g;

    for (int i = 0; i < 3; i++)
        if (e->lo[i] > centre[i] + half || e->hi[i] < centre[i] - half)
            return false;
    half += e->slack;
    switch (o->type) {
    case RAD_POLYGON:
        return polygon_meets_cube(o, centre, half);
    case RAD_SPHERE:
    case RAD_BUBBLE:
        return sphere_meets_cube(o, centre, half);
    case RAD_INSTANCE:
    case RAD_MESH:
        return copy_meets_cube(o, centre, half);
    default:
        return get_generator(o, &g) &&
               generator_meets_cube(&g, centre, half, e->slack, 2);
    }
}

/* --- parts of a cube ----------------------------------------------------- */

/* A number for each of four parts. */
typedef float v4f __attribute__((vector_size(16)));
typedef int32_t v4i __attribute__((vector_size(16)));

static inline uint8_t
bits_of(v4i v)
{
#ifdef __SSE2__
    return (uint8_t)_mm_movemask_ps((__m128)v);
#else
    return (uint8_t)((v[0] & 1) | (v[1] & 2) | (v[2] & 4) | (v[3] & 8));
#endif
}

/* The parts that the bounds meet. */
static uint8_t
parts_by_bounds(const struct rad_extent *e, const double centre[3])
{
    static const uint8_t low[3] = { 0x55, 0x33, 0x0f };
    uint8_t met = 0xff;

    for (int i = 0; i < 3; i++) {
        if (e->lo[i] > centre[i])
            met &= (uint8_t)~low[i];
        if (e->hi[i] < centre[i])
            met &= low[i];
    }
    return met;
}

static bool
is_within_cube(const struct rad_extent *e, const double centre[3], double half)
{
    for (int i = 0; i < 3; i++)
        if (e->lo[i] < centre[i] - half || e->hi[i] > centre[i] + half)
            return false;
    return true;
}

/* triangle_parts() serves triangles up to so many times a part's half-edge. */
#define MOST_TIMES 256
/* Bounds the rounding to float of a product of numbers up to 1, some 16 times
 * over, so that no sliver is lost. */
#define FLOAT_PAD 2e-6f

/* The tests of triangle_meets_cube() for the eight parts at once, in float,
 * with all numbers scaled to at most 1.  Coordinates are relative to the middle
 * of the cube, and a part's middle is at +-h along each axis; this adds the
 * same to the projections of all corners. */
static uint8_t
triangle_parts(const double vertex[3][3], double half, double size,
               double slack)
{
    static const v4f even = { -1, 1, -1, 1 }, pair = { -1, -1, 1, 1 };
    const float h = (float)(half / size), wide = h + (float)(slack / size);
    float v[3][3], e[3][3], n[3], d, r;
    v4i low = { 0 }, high = { 0 }; /* parts of low and high z that are apart */
    v4f s, t;

    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            v[k][i] = (float)(vertex[k][i] / size);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            e[k][i] = v[k == 2 ? 0 : k + 1][i] - v[k][i];
    for (int i = 0; i < 3; i++) {
        int j = i == 2 ? 0 : i + 1, l = i == 0 ? 2 : i - 1;

        n[i] = e[0][j] * e[1][l] - e[0][l] * e[1][j];
    }
    d = n[0] * v[0][0] + n[1] * v[0][1] + n[2] * v[0][2];
    r = wide * (fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2])) + 4 * FLOAT_PAD;
    s = even * (h * n[0]) + pair * (h * n[1]);
    low |= (s > d + h * n[2] + r) | (s < d + h * n[2] - r);
    high |= (s > d - h * n[2] + r) | (s < d - h * n[2] - r);
    for (int k = 0; k < 3; k++) { /* f: edge, a: its begin, b: opposite
                                   * corner */
        const float *f = e[k], *a = v[k], *b = v[k == 0 ? 2 : k - 1];

        for (int i = 0; i < 3; i++) {
            int j = i == 2 ? 0 : i + 1;
            float x = f[i] * a[j] - f[j] * a[i];
            float y = f[i] * b[j] - f[j] * b[i];
            float most = x > y ? x : y, least = x > y ? y : x;

            r = wide * (fabsf(f[i]) + fabsf(f[j])) + FLOAT_PAD;
            most += r;
            least -= r;
            if (i == 0) { /* axes x and y: the same for low and high z */
                s = pair * (h * f[0]) - even * (h * f[1]);
                s = (v4f)((s > most) | (s < least));
                low |= (v4i)s;
                high |= (v4i)s;
                continue;
            }
            if (i == 1) { /* y and z */
                s = pair * (-h * f[2]) - h * f[1];
                t = pair * (-h * f[2]) + h * f[1];
            } else { /* z and x */
                s = even * (h * f[2]) + h * f[0];
                t = even * (h * f[2]) - h * f[0];
            }
            low |= (s > most) | (s < least);
            high |= (t > most) | (t < least);
        }
    }
    return (uint8_t) ~(bits_of(low) | bits_of(high) << 4);
}

/* Get the vertices of a triangle relative to the middle of a cube with
 * half-edge h; returns the largest coordinate, or h.  0: o is no triangle. */
static double
get_triangle(double v[3][3], const struct rad_object *o, const double centre[3],
             double h)
{
    double size = h;

    if (o->type != RAD_POLYGON || o->nreals != 9)
        return 0;
    for (int k = 0; k < 3; k++) {
        rad_sub(v[k], o->reals + 3 * (size_t)k, centre);
        for (int i = 0; i < 3; i++)
            if (fabs(v[k][i]) > size)
                size = fabs(v[k][i]);
    }
    return size;
}

uint8_t
rad_overlaps_parts(const struct rad_object *o, const struct rad_extent *e,
                   const double centre[3], double half)
{
    uint8_t met = parts_by_bounds(e, centre), one = met & (uint8_t)(met - 1);
    double part[3], v[3][3], size;

    if (one == 0)
        return met;
    /* two parts, and it lies within the cube: it is in both */
    if ((one & (one - 1)) == 0 && is_within_cube(e, centre, half))
        return met;
    size = get_triangle(v, o, centre, half / 2);
    if (size > 0 && size <= MOST_TIMES * half / 2)
        return met &
               triangle_parts((const double(*)[3])v, half / 2, size, e->slack);
    for (int k = 0; k < 8; k++) {
        if (!(met >> k & 1))
            continue;
        for (int i = 0; i < 3; i++)
            part[i] = centre[i] + (k >> i & 1 ? half / 2 : -half / 2);
        if (!rad_overlaps_cube(o, e, part, half / 2))
            met &= (uint8_t) ~(1 << k);
    }
    return met;
}
