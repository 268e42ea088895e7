/* sample.c - see sample.h
 *
 * The flux of a flat patch toward a point is computed exactly (contour.h) if
 * the patch is near; if it is far an expansion will do.  With r the vector from
 * the point to a place on the patch, the irradiance vector per radiance is
 *     F = -(n.r) integral r / |r|^4 dA,
 * since n.r is the same everywhere in the plane.  Let g(r) = r / |r|^4 be
 * expanded about the centroid c: the first order vanishes, and the second is
 * half the sum of g's second derivatives along the moment axes a and b:
 *     g_aa = -8 (c.a) a / q^3 + (24 (c.a)^2 / q^4 - 4 (a.a) / q^3) c,  q = c.c
 * Let e be the correction along c.  Its factor is 1 / (1 + e), not 1 - e: that
 * is the same to second order, exact on the axis of a disk, and of the right
 * size even where the patch is as wide as it is far.
 * A cylinder seen from perpendicular distance h is a strip of width 2r facing
 * the point; its flux is 2r h integral r / |r|^4 dl, the same integral.
 *
 * Samples of a sphere, and of a cylinder across its axis, are uniform in the
 * sine of the angle from the centre.  So omega at the centre is that of the
 * projected disk, pi r^2/d^2, which is exact for irradiance, and the mean over
 * many samples is right.
 * Source: Radiance's use of -ds and -dj (rpict(1)); Lambert 1760 for F.  */
#include "config.h"

#include "light/sample/sample.h"
#include "light/sample/contour.h"
#include "light/sample/patch.h"
#include "light/sample/quad.h"
#include "arith/elementary.h"
#include "base/rng.h"
#include "base/vec.h"

#include <string.h>

/* Below this variance of a patch over its squared distance the expansion to
 * second order is off by 3e-5 at most (by the third order of a triangle, which
 * grows with the power 3/2). */
#define FAR_VARIANCE 2e-4

/* The patches of one source being visited. */
struct walk {
    const struct rad_source *src;
    const struct rad_light_view *view;
    rad_light_fn *fn;
    void *arg;
    uint32_t dim; /* random numbers used so far */
};

static double
next_rand(struct walk *w)
{
    return rad_rand(w->view->key, w->dim++);
}

/* --- moments of patches --- */

/* The moments of a stretch of cylinder: its strip has no second axis, since its
 * width is part of the formula (see above). */
static void
line_moments(struct rad_moments *m, const double c[3], const double u[3],
             double radius)
{
    rad_copy(m->c, c);
    rad_copy(m->aim, c);
    rad_scale(m->a, 1 / sqrt(3), u);
    memset(m->b, 0, sizeof m->b);
    m->area = 4 * radius * sqrt(rad_dot(u, u));
}

/* The moments of a sector, a ring's part between two radii and two angles.  The
 * centroid is at radius rc on the middle angle, and <r^2> = (r0^2 + r1^2)/2 is
 * shared between the two directions by the means of cos^2 and sin^2. */
static void
sector_moments(struct rad_moments *m, const struct rad_source *src,
               const struct rad_patch *p)
{
    double sine, cosine;

    rad_sin_and_cos(p->delta, &sine, &cosine);

    double sinc = p->delta < M_PI ? sine / p->delta : 0;
    double cos2 = (1 + cosine * sinc) / 2; /* sin 2d / 4d */
    double r2 = (p->r0 * p->r0 + p->r1 * p->r1) / 2;
    double rc = 2. / 3 * sinc * (p->r1 + p->r0 * p->r0 / (p->r1 + p->r0));
    double along[3], across[3];

    rad_ring_point(src, 1, p->phi, along);
    rad_sub(along, along, src->centre);
    rad_cross(across, src->normal, along);
    rad_madd(m->c, src->centre, rc, along);
    rad_scale(m->a, sqrt(rad_most(r2 * cos2 - rc * rc, 0)), along);
    rad_scale(m->b, sqrt(r2 * (1 - cos2)), across);
    m->area = p->delta * (p->r1 * p->r1 - p->r0 * p->r0);
    /* the centroid may lie in the ring's hole: then aim at the mean radius */
    rad_madd(m->aim, src->centre, rc > p->r0 || p->r0 == 0 ? rc : sqrt(r2),
             along);
}

static void
patch_moments(const struct rad_source *src, const struct rad_patch *p,
              struct rad_moments *m)
{
    switch (p->kind) {
    case RAD_PATCH_TRIANGLE:
        rad_triangle_moments(m, p->p, p->u, p->v);
        break;
    case RAD_PATCH_SECTOR:
        sector_moments(m, src, p);
        break;
    case RAD_PATCH_LINE:
        line_moments(m, p->p, p->u, src->r1);
        break;
    case RAD_PATCH_GROUP:
        *m = p->node->m;
        break;
    }
}

/* --- cutting --- */

/* Halve a triangle across its longest side. */
static void
split_triangle(const struct rad_patch *p, struct rad_patch half[2])
{
    double side[3] = { rad_dot(p->u, p->u), rad_dot(p->v, p->v),
                       rad_dist2(p->u, p->v) };
    double q[3][3];
    int k = 0;

    /* corners; side 0 is q0 q1, side 1 q0 q2, side 2 q1 q2 */
    rad_copy(q[0], p->p);
    rad_madd(q[1], p->p, 1, p->u);
    rad_madd(q[2], p->p, 1, p->v);
    for (int i = 1; i < 3; i++)
        if (side[i] > side[k])
            k = i;
    int far = 2 - k, from = k == 2 ? 1 : 0, to = k == 0 ? 1 : 2;

    for (int h = 0; h < 2; h++) {
        double mid[3];

        rad_copy(half[h].p, q[far]);
        for (int i = 0; i < 3; i++)
            mid[i] = (q[from][i] + q[to][i]) / 2;
        rad_sub(half[h].u, h ? mid : q[from], q[far]);
        rad_sub(half[h].v, h ? q[to] : mid, q[far]);
    }
}

static void
split_line(const struct rad_patch *p, struct rad_patch half[2])
{
    for (int h = 0; h < 2; h++) {
        rad_scale(half[h].u, .5, half[h].u);
        rad_madd(half[h].p, p->p, h ? 1 : -1, half[h].u);
    }
}

/* Halve a sector across its longer axis.  A sector with a hole and a half angle
 * above 1 is always halved by angle, even if rounding of two equal axes says
 * otherwise. */
static void
split_sector(const struct rad_patch *p, const struct rad_moments *m,
             struct rad_patch half[2])
{
    if ((p->r0 > 0 && p->delta > 1) ||
        rad_dot(m->b, m->b) >= rad_dot(m->a, m->a)) {
        half[0].delta = half[1].delta = p->delta / 2;
        half[0].phi -= p->delta / 2;
        half[1].phi += p->delta / 2;
    } else {
        half[0].r1 = half[1].r0 = sqrt((p->r0 * p->r0 + p->r1 * p->r1) / 2);
    }
}

/* Make p the patch of a node: a group, or the triangle of a leaf. */
static void
from_node(struct rad_patch *p, const struct rad_polytree *node)
{
    if (node->kid[0]) {
        p->kind = RAD_PATCH_GROUP;
        p->node = node;
    } else {
        p->kind = RAD_PATCH_TRIANGLE;
        rad_copy(p->p, node->p0);
        rad_copy(p->u, node->e1);
        rad_copy(p->v, node->e2);
    }
}

static void
split(const struct rad_patch *p, const struct rad_moments *m,
      struct rad_patch half[2])
{
    half[0] = half[1] = *p;
    half[0].budget = half[1].budget = p->budget / 2;
    switch (p->kind) {
    case RAD_PATCH_TRIANGLE:
        split_triangle(p, half);
        break;
    case RAD_PATCH_SECTOR:
        split_sector(p, m, half);
        break;
    case RAD_PATCH_LINE:
        split_line(p, half);
        break;
    case RAD_PATCH_GROUP:
        from_node(&half[0], p->node->kid[0]);
        from_node(&half[1], p->node->kid[1]);
        break;
    }
}

/* Is the patch small enough at its distance?  A stretch of cylinder is compared
 * by its length; other patches, as in rpict, by the side of a square of the
 * same area, which may be coarse since their flux is exact at any size. */
static bool
small_enough(const struct rad_patch *p, const struct rad_moments *m,
             const struct rad_light_view *view)
{
    double d2 = rad_dist2(view->p, m->c);

    if (p->kind != RAD_PATCH_LINE)
        return m->area <= view->sizerat * view->sizerat * d2;
    return rad_side_small_enough(rad_dot(m->a, m->a), rad_dot(m->b, m->b),
                                 rad_dot(m->a, m->b),
                                 rad_side_limit(view->sizerat) * d2);
}

/* --- samples of one patch --- */

/* Is the point that s aims at beyond a glow's reach, or outside a spotlight's
 * cone? */
static bool
out_of_reach(const struct rad_source *src, const struct rad_light_sample *s)
{
    return (src->flags & RAD_LIGHT_NEAR && s->dist > src->reach) ||
           (src->flags & RAD_LIGHT_SPOT &&
            rad_spot_outside(&src->spot, s->aim));
}

/* Pass a sample to the caller, unless it brings no light. */
static void
put(struct walk *w, struct rad_light_sample *s)
{
    const struct rad_source *src = w->src;

    if (!(s->omega > 0) || out_of_reach(src, s))
        return;
    if (src->flags & RAD_LIGHT_SPOT) {
        double f = s->dist / (s->dist + src->spot.focal_length);

        s->omega *= f * f;
    }
    w->fn(w->arg, s);
}

/* Set dir and omega from the flux k * integral of g (see above).  The
 * correction is -e along c, and corr across it; with t = (c.a)^2 + (c.b)^2,
 *     e = (2 (a.a + b.b) - 8 t / q) / q,
 *     corr = -4/q ((c.a) a + (c.b) b - t/q c). */
static void
second_order(struct rad_light_sample *s, const struct rad_light_view *view,
             const struct rad_moments *m, double k)
{
    double c[3], corr[3];

    rad_sub(c, m->c, view->p);
    double per = 1 / rad_dot(c, c), ca = rad_dot(c, m->a),
           cb = rad_dot(c, m->b), t = (ca * ca + cb * cb) * per;
    double e = (2 * (rad_dot(m->a, m->a) + rad_dot(m->b, m->b)) - 8 * t) * per;

    for (int i = 0; i < 3; i++)
        corr[i] = -4 * per * (ca * m->a[i] + cb * m->b[i] - t * c[i]);
    /* the flux must point at the patch even where the expansion fails */
    double side = rad_dot(corr, corr) * per;

    if (side > .25)
        rad_scale(corr, .5 / sqrt(side), corr);
    rad_madd(s->dir, corr, e > 0 ? 1 / (1 + e) : rad_least(1 - e, 2), c);
    s->omega = k * (per * per) * rad_normalize(s->dir);
}

/* Aim at point p; returns the inverse of its distance.  Like rad_normalize(),
 * with one division. */
static double
aim(struct rad_light_sample *s, const struct rad_light_view *view,
    const double p[3])
{
    double q, per;

    rad_sub(s->aim, p, view->p);
    q = rad_dot(s->aim, s->aim);
    if (!(q > 0x1p-600 && q < 0x1p+600)) {
        s->dist = rad_normalize(s->aim);
        return 1 / s->dist;
    }
    s->dist = sqrt(q);
    per = 1 / s->dist;
    rad_scale(s->aim, per, s->aim);
    return per;
}

/* Make the sample of a patch as if all of it were at point p: with r from
 * view->p to p, its flux is k |r| / |r|^4. */
static void
at_point(struct rad_light_sample *s, const struct rad_light_view *view,
         const double p[3], double k)
{
    double per = aim(s, view, p);

    s->omega = k * (per * per * per);
    rad_copy(s->dir, s->aim);
}

/* The point of a triangle for s and t in [0, 1]: uniform if these are. */
static void
triangle_point(double d[3], const double p0[3], const double e1[3],
               const double e2[3], double s, double t)
{
    if (s + t > 1) {
        s = 1 - s;
        t = 1 - t;
    }
    rad_madd(d, p0, s, e1);
    rad_madd(d, d, t, e2);
}

/* The jittered point of a sector for s and u in [0, 1].  Jitter j below 1
 * shrinks the sector, so that the mean point stays.
 * A sector without a hole shrinks about its centroid.  A whole disk shrinks so
 * that its points have the mean squared radius of rpict's: rpict bends a square
 * to a disk, with points (u sqrt(1 - v^2/2), v sqrt(1 - u^2/2)) for u and v
 * uniform in (-j, j), whose squared radius is 2/3 j^2 - 1/9 j^4 in the mean.
 * A sector of a ring shrinks in radius and angle, since about its centroid it
 * would leave the ring; a whole ring shrinks in radius alone. */
static void
sector_point(const struct walk *w, const struct rad_patch *p, double s,
             double u, double d[3])
{
    double jit = w->view->jitter, r0 = p->r0 * p->r0, r1 = p->r1 * p->r1;
    struct rad_moments m;

    if (p->r0 > 0) {
        s = .5 + (s - .5) * jit;
        if (p->delta < M_PI)
            u = .5 + (u - .5) * jit;
    }
    rad_ring_point(w->src, sqrt(r0 + s * (r1 - r0)),
                   p->phi + (2 * u - 1) * p->delta, d);
    if (p->r0 > 0)
        return;
    if (p->delta == M_PI)
        jit *= sqrt(rad_least(4. / 3 - 2. / 9 * jit * jit, 1 / (jit * jit)));
    sector_moments(&m, w->src, p);
    for (int k = 0; k < 3; k++)
        d[k] = m.c[k] + jit * (d[k] - m.c[k]);
}

/* A random point of the patch, which is shrunk to `jitter` about its middle. */
static void
jittered_point(struct walk *w, const struct rad_patch *p, double d[3])
{
    const struct rad_polytree *t = p->node;
    double jit = w->view->jitter, s = next_rand(w), u = next_rand(w), c[3];

    switch (p->kind) {
    case RAD_PATCH_SECTOR:
        sector_point(w, p, s, u, d);
        break;
    case RAD_PATCH_LINE:
        rad_madd(d, p->p, (2 * s - 1) * jit, p->u);
        break;
    case RAD_PATCH_TRIANGLE:
        triangle_point(d, p->p, p->u, p->v, s, u);
        for (int k = 0; k < 3; k++) {
            c[k] = p->p[k] + (p->u[k] + p->v[k]) / 3;
            d[k] = c[k] + jit * (d[k] - c[k]);
        }
        break;
    case RAD_PATCH_GROUP:
        /* draw a triangle in proportion to its area by s, which is rescaled at
         * each step down to be uniform again */
        while (t->kid[0]) {
            double f = t->kid[0]->m.area / t->m.area;

            int k = s < f ? 0 : 1;

            s = k ? (s - f) / (1 - f) : s / f;
            t = t->kid[k];
        }
        triangle_point(d, t->p0, t->e1, t->e2, s, u);
        for (int k = 0; k < 3; k++)
            d[k] = t->m.c[k] + jit * (d[k] - t->m.c[k]);
        break;
    }
}

/* Set dir and omega to the exact flux of a patch; false: the patch is far away,
 * or has no flux, so second_order() is to be used. */
static bool
exact(struct rad_light_sample *s, const struct walk *w,
      const struct rad_patch *p, const struct rad_moments *m)
{
    double F[3] = { 0, 0, 0 }, to[3];

    rad_sub(to, m->c, w->view->p);
    if (rad_dot(m->a, m->a) + rad_dot(m->b, m->b) <
        FAR_VARIANCE * rad_dot(to, to))
        return false;
    rad_patch_flux(F, w->src, w->view->p, p);
    s->omega = rad_contour_whole(F, to, s->dir);
    return s->omega > 0;
}

/* In standard deviations along a line through the centroid: no place of a
 * triangle is farther than sqrt(8), none of a sector than sqrt(11), the limit
 * for a small one whose arc bends by as much as it is wide. */
#define FARTHEST2 12

/* Is all of the patch on one side of the horizon of `up`?  1: above, -1: below,
 * 0: it may lie across.  to: from the point to the centroid. */
static int
side_of_horizon(const struct rad_patch *p, const struct rad_moments *m,
                const double to[3], const double up[3])
{
    double h = rad_dot(to, up), a = rad_dot(m->a, up), b = rad_dot(m->b, up);

    if (p->kind == RAD_PATCH_GROUP || h * h < FARTHEST2 * (a * a + b * b))
        return 0;
    return h > 0 ? 1 : -1;
}

/* Set dir and omega to those of a ring's centre, which lies in the hole and
 * cannot be aimed at.  k: see at_point(). */
static void
aim_at_centre(struct rad_light_sample *s, const double to[3], double k)
{
    double d2 = rad_dot(to, to);

    s->omega = k / (d2 * sqrt(d2));
    rad_copy(s->dir, to);
    rad_normalize(s->dir);
}

static void
flat_sample(struct walk *w, const struct rad_patch *p,
            const struct rad_moments *m)
{
    const struct rad_light_view *view = w->view;
    struct rad_light_sample s;
    double to[3], point[3];

    rad_sub(to, m->c, view->p);
    double k = -rad_dot(w->src->normal, to) * m->area;

    if (view->up && view->sizerat > 0 && !(view->jitter > 0)) {
        int side = side_of_horizon(p, m, to, view->up);

        if (side == 0 && rad_patch_risen(&s, w->src, view, p))
            put(w, &s);
        if (side <= 0)
            return;
    }
    if (view->jitter > 0) {
        jittered_point(w, p, point);
        at_point(&s, view, point, k);
    } else {
        at_point(&s, view, m->aim, k);
        if (out_of_reach(w->src, &s))
            return; /* before the flux is computed */
        if (view->sizerat > 0) {
            if (!exact(&s, w, p, m))
                second_order(&s, view, m, k);
        } else if (p->kind == RAD_PATCH_SECTOR && p->r0 > 0) {
            aim_at_centre(&s, to, k);
        }
    }
    put(w, &s);
}

/* Set dir and omega to the exact flux of a stretch of cylinder.  Its outline,
 * seen from any point, is two lines along it and the near arcs of its ends.
 *   axis  the cylinder's axis, a unit vector
 *   perp  unit vector from the point to the axis, perpendicular to it
 *   h     distance of the point to the axis
 * The lines lie on both sides of perp, at the distance l from the point, where
 * its view touches the wall: their sum points along perp.
 * False: the stretch is far away, or has no flux, so second_order() is to be
 * used. */
static bool
line_flux(struct rad_light_sample *s, const struct walk *w,
          const struct rad_patch *p, const double axis[3], const double perp[3],
          double h)
{
    double r = w->src->r1, half2 = rad_dot(p->u, p->u), half, z;
    double l = sqrt((h - r) * (h + r)), delta, to[3], F[3], flux[2] = { 0, 0 };

    rad_sub(to, p->p, w->view->p);
    if (half2 / 3 + r * r < FAR_VARIANCE * rad_dot(to, to))
        return false;
    half = sqrt(half2);
    z = rad_dot(to, axis);
    delta = rad_atan2(l, r);
    rad_contour_end(flux, z - half, h, r, delta, -1);
    rad_contour_end(flux, z + half, h, r, delta, 1);
    flux[1] -= r / h * rad_atan2(2 * half * l, (z - half) * (z + half) + l * l);
    rad_scale(F, flux[0], axis);
    rad_madd(F, F, flux[1], perp);
    s->omega = rad_contour_whole(F, to, s->dir);
    return s->omega > 0;
}

/* Sample a random point of the visible side of a stretch of cylinder; axis,
 * perp and h are those of line_flux().  Let `lat` be the sine of the angle
 * between the point and perp, about the axis' direction through view->p: it is
 * uniform in (-r/h, r/h), and the point's height is uniform on the stretch.
 * At a distance t across the axis and d in space the solid angle is t^2 / d^3
 * per unit of angle and of height. */
static void
wall_sample(struct rad_light_sample *s, struct walk *w,
            const struct rad_patch *p, const double axis[3],
            const double perp[3], double h)
{
    const struct rad_light_view *view = w->view;
    double r = w->src->r1, point[3], side[3], z, t;
    double even = 2 * rad_rand(view->key, w->dim + 2) - 1;
    double lat = view->jitter * even * r / h, cosine = sqrt(1 - lat * lat);

    jittered_point(w, p, point);
    w->dim++;
    rad_cross(side, axis, perp);
    z = rad_dot(point, axis) - rad_dot(view->p, axis);
    t = (h * h - r * r) /
        (h * cosine + sqrt(rad_most(r * r - h * h * lat * lat, 0)));
    rad_madd(point, view->p, z, axis);
    rad_madd(point, point, t * cosine, perp);
    rad_madd(point, point, t * lat, side);
    at_point(s, view, point,
             t * t / cosine * 2 * (r / h) * 2 * sqrt(rad_dot(p->u, p->u)));
}

/* Aim at the middle of a stretch of cylinder; where the ray would enter by the
 * cylinder's open end, aim at the near wall of the stretch. */
static void
line_aim(struct rad_light_sample *s, const struct walk *w,
         const struct rad_moments *m, const double axis[3],
         const double perp[3], double h)
{
    const struct rad_source *src = w->src;
    double met[3], z;

    at_point(s, w->view, m->aim, h * m->area);
    if (!(w->view->sizerat > 0))
        return;
    rad_madd(met, w->view->p, s->dist * (1 - src->r1 / h), s->aim);
    rad_sub(met, met, src->centre);
    z = rad_dot(met, axis);
    if (z * z <= rad_dot(src->axis[0], src->axis[0]))
        return;
    rad_madd(met, m->aim, -src->r1, perp);
    aim(s, w->view, met);
}

/* Make the sample of a stretch of cylinder. */
static void
line_sample(struct walk *w, const struct rad_patch *p,
            const struct rad_moments *m)
{
    const struct rad_light_view *view = w->view;
    const struct rad_source *src = w->src;
    struct rad_light_sample s;
    double to[3], axis[3], perp[3], h;

    rad_copy(axis, src->axis[0]);
    rad_normalize(axis);
    rad_sub(to, src->centre, view->p);
    rad_madd(perp, to, -rad_dot(to, axis), axis);
    h = rad_normalize(perp);
    if (view->jitter > 0) {
        wall_sample(&s, w, p, axis, perp, h);
    } else {
        line_aim(&s, w, m, axis, perp, h);
        if (view->sizerat > 0 && !line_flux(&s, w, p, axis, perp, h))
            second_order(&s, view, m, h * m->area);
    }
    put(w, &s);
}

/* Make the samples of a parallelogram (quad.h). */
static void
visit_quad(struct walk *w)
{
    struct rad_light_sample s[RAD_LIGHT_PATCHES];
    int n = rad_quad_samples(w->src, w->view, s);

    for (int i = 0; i < n; i++)
        put(w, &s[i]);
}

/* Make the samples of patch p: cut it, if it is too large, into halves. */
static void
visit(struct walk *w, const struct rad_patch *p, const struct rad_moments *m)
{
    if (w->view->sizerat > 0 && p->budget > 1 && !small_enough(p, m, w->view)) {
        struct rad_patch half[2];
        struct rad_moments hm;

        split(p, m, half);
        for (int h = 0; h < 2; h++) {
            patch_moments(w->src, &half[h], &hm);
            visit(w, &half[h], &hm);
        }
    } else if (p->kind == RAD_PATCH_LINE) {
        line_sample(w, p, m);
    } else {
        flat_sample(w, p, m);
    }
}

/* --- sources that are not cut into patches --- */

static bool
is_quad(const struct rad_source *src)
{
    return !src->tree && src->shape == RAD_POLYGON;
}

/* Is the source flat, and seen by one sample without jitter, whose dir is aim?
 */
static bool
is_whole(const struct rad_source *src, const struct rad_light_view *view)
{
    return src->flags & RAD_LIGHT_FLAT && !(view->sizerat > 0) &&
           !(view->jitter > 0) && !(src->shape == RAD_RING && src->r0 > 0);
}

static void
whole_sample(struct walk *w)
{
    const struct rad_source *src = w->src;
    const struct rad_moments *m = &src->root;
    bool quad = is_quad(src);
    struct rad_light_sample s;
    double to[3];

    rad_sub(to, quad ? src->centre : m->c, w->view->p);
    at_point(&s, w->view, quad ? src->centre : m->aim,
             -rad_dot(src->normal, to) * m->area);
    put(w, &s);
}

static void
sphere_sample(struct walk *w)
{
    const struct rad_light_view *view = w->view;
    const struct rad_source *src = w->src;
    struct rad_light_sample s;
    double to[3], u[3], v[3];
    double sin_max = src->r1 * aim(&s, view, src->centre), cosine = 1;

    if (!(sin_max < 1))
        return; /* the point is inside the sphere */
    if (view->jitter > 0) {
        double r = view->jitter * sin_max * sqrt(next_rand(w));
        double s_phi, c_phi;

        rad_sin_and_cos(2 * M_PI * next_rand(w), &s_phi, &c_phi);
        cosine = sqrt(1 - r * r);
        rad_copy(to, s.aim);
        rad_frame(u, v, to);
        rad_scale(s.aim, cosine, to);
        rad_madd(s.aim, s.aim, r * c_phi, u);
        rad_madd(s.aim, s.aim, r * s_phi, v);
    }
    rad_copy(s.dir, s.aim);
    /* s.dist is the distance to the centre, to which a glow's reach applies */
    s.omega = M_PI * sin_max * sin_max / cosine;
    put(w, &s);
}

static void
distant_sample(struct walk *w)
{
    const struct rad_source *src = w->src;
    struct rad_light_sample s = { .dist = INFINITY, .omega = src->size };
    double u[3], v[3], jit = w->view->jitter;

    rad_copy(s.aim, src->centre);
    if (jit > 0) {
        /* uniform in solid angle; h is 1 - cos(angle from the centre) */
        double h = jit * jit * next_rand(w) * src->size / (2 * M_PI);
        double s_phi, c_phi, r = sqrt(h * (2 - h));

        rad_sin_and_cos(2 * M_PI * next_rand(w), &s_phi, &c_phi);
        rad_frame(u, v, src->centre);
        rad_scale(s.aim, 1 - h, src->centre);
        rad_madd(s.aim, s.aim, r * c_phi, u);
        rad_madd(s.aim, s.aim, r * s_phi, v);
    }
    rad_copy(s.dir, s.aim);
    /* not put(): the focal length makes no difference at infinity */
    if (!(src->flags & RAD_LIGHT_SPOT) || !rad_spot_outside(&src->spot, s.aim))
        w->fn(w->arg, &s);
}

static void
root_patch(const struct rad_source *src, struct rad_patch *p)
{
    memset(p, 0, sizeof *p);
    p->budget = RAD_LIGHT_PATCHES;
    if (src->tree) {
        from_node(p, src->tree);
    } else if (src->shape == RAD_RING) {
        p->kind = RAD_PATCH_SECTOR;
        p->r0 = src->r0;
        p->r1 = src->r1;
        p->delta = M_PI;
    } else {
        p->kind = RAD_PATCH_LINE;
        rad_copy(p->p, src->centre);
        rad_copy(p->u, src->axis[0]);
    }
}

void
rad_light_set_apex(struct rad_source *src)
{
    double c = 1 - src->spot.omega / (2 * M_PI); /* cosine of the half angle */

    src->apex = c > 0 ? src->radius / sqrt(1 - c * c) : INFINITY;
    src->cone2 = c * c * (1 - 1e-9);
}

/* Does a spotlight not reach a point, at d from its centre?  False where
 * rounding leaves a doubt: rad_spot_outside() tests each sample. */
static bool
spot_misses(const struct rad_source *src, const double d[3])
{
    double a = src->apex, along, dist2;

    if (!(a < INFINITY))
        return false;
    along = rad_dot(d, src->spot.aim);
    dist2 = rad_dot(d, d) + (2 * along + a) * a;
    along += a;
    return along <= 0 ? dist2 > 0 : along * along < src->cone2 * dist2;
}

bool
rad_light_reaches(const struct rad_source *src, const double p[3])
{
    double d[3], d2, z;

    if (src->flags & RAD_LIGHT_DISTANT)
        return true;
    rad_sub(d, p, src->centre);
    if (src->flags & RAD_LIGHT_FLAT && !(rad_dot(d, src->normal) > 0))
        return false;
    d2 = rad_dot(d, d);
    if (src->flags & RAD_LIGHT_NEAR) {
        double far = src->reach + src->radius;

        if (d2 > far * far)
            return false;
    }
    if (src->flags & RAD_LIGHT_SPOT && spot_misses(src, d))
        return false;
    if (src->flags & RAD_LIGHT_FLAT || src->shape == RAD_SPHERE)
        return true;
    /* is the point outside the infinite cylinder? */
    z = rad_dot(d, src->axis[0]);
    z *= z / rad_dot(src->axis[0], src->axis[0]);
    return d2 - z > src->r1 * src->r1;
}

void
rad_light_samples_within(const struct rad_source *src,
                         const struct rad_light_view *view, rad_light_fn *fn,
                         void *arg)
{
    struct walk w = { src, view, fn, arg, 0 };
    struct rad_patch root;

    if (src->flags & RAD_LIGHT_DISTANT) {
        distant_sample(&w);
    } else if (src->shape == RAD_SPHERE) {
        sphere_sample(&w);
    } else if (is_whole(src, view)) {
        whole_sample(&w);
    } else if (is_quad(src)) {
        visit_quad(&w);
    } else {
        root_patch(src, &root);
        visit(&w, &root, &src->root);
    }
}

void
rad_light_samples(const struct rad_source *src,
                  const struct rad_light_view *view, rad_light_fn *fn,
                  void *arg)
{
    if (rad_light_reaches(src, view->p))
        rad_light_samples_within(src, view, fn, arg);
}
