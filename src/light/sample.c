/* sample.c - see sample.h
 *
 * The flux of a flat patch toward a point is known exactly (contour.h): near
 * ones get that.  From afar less does.  With r the vector from the point to a
 * place on the patch, the irradiance vector per radiance is
 *     F = -(n.r) integral r / |r|^4 dA,
 * for n.r is the same all over the plane.  With g(r) = r / |r|^4 expanded
 * about the centroid c, the first order vanishes and the second is half the
 * sum of g's second derivatives along the moment axes a and b:
 *     g_aa = -8 (c.a) a / q^3 + (24 (c.a)^2 / q^4 - 4 (a.a) / q^3) c,  q = c.c
 * The part of the correction along c enters as 1 / (1 + e), not 1 - e: the
 * same to second order, exact on the axis of a disk, and of the right size
 * even where the patch is as wide as it is far.
 * A cylinder seen from perpendicular distance h is a strip of width 2r facing
 * the point; its flux is 2r h integral r / |r|^4 dl, the same integral.
 *
 * Spheres and the lateral jitter of cylinders sample sin(angle from the
 * centre) evenly, so that omega at the centre is the projected disk's,
 * pi r^2/d^2, which is exact for irradiance, and the mean over many is right.
 * Source: Radiance's use of -ds and -dj (rpict(1)); Lambert 1760 for F.  */
#include "config.h"

#include "light/sample.h"
#include "light/contour.h"
#include "light/polytree.h"
#include "light/quad.h"
#include "base/rng.h"
#include "base/vec.h"

#include <string.h>

/* Variance of a patch over its squared distance below which the expansion to
 * second order is good for 3e-5 (the third order of a triangle grows with the
 * power 3/2). */
#define FAR_VARIANCE 2e-4

struct patch {
    enum { TRIANGLE, SECTOR, LINE, GROUP } kind;
    int budget;                      /* patches that may come of it */
    double p[3], u[3], v[3];         /* LINE: centre and half-axis u; TRIANGLE:
                                      * corner and sides */
    double r0, r1, phi, delta;       /* SECTOR: radii; middle and half angle */
    const struct rad_polytree *node; /* GROUP */
};

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

/* A stretch of cylinder: its strip has no second axis, for its width is part
 * of the formula (see above). */
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

static void
ring_point(const struct rad_source *src, double r, double phi, double p[3])
{
    double x = r * cos(phi), y = r * sin(phi);

    /* the axes' length is that of the square that stands for the ring */
    double s = 1 / sqrt(rad_dot(src->axis[0], src->axis[0]));

    for (int k = 0; k < 3; k++)
        p[k] = src->centre[k] + s * (x * src->axis[0][k] + y * src->axis[1][k]);
}

/* Part of a ring between two radii and two angles.  Along the middle angle the
 * centroid is at rc, and <r^2> = (r0^2 + r1^2) / 2 splits between the two
 * directions by the mean of cos^2 and sin^2. */
static void
sector_moments(struct rad_moments *m, const struct rad_source *src,
               const struct patch *p)
{
    double sinc = p->delta < M_PI ? sin(p->delta) / p->delta : 0;
    double cos2 = (1 + cos(p->delta) * sinc) / 2; /* sin 2d / 4d */
    double r2 = (p->r0 * p->r0 + p->r1 * p->r1) / 2;
    double rc = 2. / 3 * sinc * (p->r1 + p->r0 * p->r0 / (p->r1 + p->r0));
    double along[3], across[3];

    ring_point(src, 1, p->phi, along);
    rad_sub(along, along, src->centre);
    rad_cross(across, src->normal, along);
    rad_madd(m->c, src->centre, rc, along);
    rad_scale(m->a, sqrt(rad_most(r2 * cos2 - rc * rc, 0)), along);
    rad_scale(m->b, sqrt(r2 * (1 - cos2)), across);
    m->area = p->delta * (p->r1 * p->r1 - p->r0 * p->r0);
    /* the centroid of a bent patch may be in the hole */
    rad_madd(m->aim, src->centre, rc > p->r0 || p->r0 == 0 ? rc : sqrt(r2),
             along);
}

static void
patch_moments(const struct rad_source *src, const struct patch *p,
              struct rad_moments *m)
{
    switch (p->kind) {
    case TRIANGLE:
        rad_triangle_moments(m, p->p, p->u, p->v);
        break;
    case SECTOR:
        sector_moments(m, src, p);
        break;
    case LINE:
        line_moments(m, p->p, p->u, src->r1);
        break;
    case GROUP:
        *m = p->node->m;
        break;
    }
}

/* --- cutting --- */

static void
split_triangle(const struct patch *p, struct patch half[2])
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
split_line(const struct patch *p, struct patch half[2])
{
    for (int h = 0; h < 2; h++) {
        rad_scale(half[h].u, .5, half[h].u);
        rad_madd(half[h].p, p->p, h ? 1 : -1, half[h].u);
    }
}

/* Across the longer axis; what goes about a hole only ever by angle, which ends
 * that, whatever rounding has made of two axes that are equal. */
static void
split_sector(const struct patch *p, const struct rad_moments *m,
             struct patch half[2])
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

static void
from_node(struct patch *p, const struct rad_polytree *node)
{
    if (node->kid[0]) {
        p->kind = GROUP;
        p->node = node;
    } else {
        p->kind = TRIANGLE;
        rad_copy(p->p, node->p0);
        rad_copy(p->u, node->e1);
        rad_copy(p->v, node->e2);
    }
}

static void
split(const struct patch *p, const struct rad_moments *m, struct patch half[2])
{
    half[0] = half[1] = *p;
    half[0].budget = half[1].budget = p->budget / 2;
    switch (p->kind) {
    case TRIANGLE:
        split_triangle(p, half);
        break;
    case SECTOR:
        split_sector(p, m, half);
        break;
    case LINE:
        split_line(p, half);
        break;
    case GROUP:
        from_node(&half[0], p->node->kid[0]);
        from_node(&half[1], p->node->kid[1]);
        break;
    }
}

/* Is the patch small enough at its distance?  One without a longer side, as in
 * rpict, by the square of the same area, for its flux is exact however large it
 * is. */
static bool
small_enough(const struct patch *p, const struct rad_moments *m,
             const struct rad_light_view *view)
{
    double d2 = rad_dist2(view->p, m->c);

    if (p->kind != LINE)
        return m->area <= view->sizerat * view->sizerat * d2;
    return rad_side_small_enough(rad_dot(m->a, m->a), rad_dot(m->b, m->b),
                                 rad_dot(m->a, m->b),
                                 rad_side_limit(view->sizerat) * d2);
}

/* --- samples of one patch --- */

/* Is the point that s aims at too far for a glow, or dark for a spotlight? */
static bool
out_of_reach(const struct rad_source *src, const struct rad_light_sample *s)
{
    return (src->flags & RAD_LIGHT_NEAR && s->dist > src->reach) ||
           (src->flags & RAD_LIGHT_SPOT &&
            rad_spot_outside(&src->spot, s->aim));
}

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

/* Set dir and omega from the flux k * integral of g (see above).  What is added
 * along c is -e, and across it, with t = (c.a)^2 + (c.b)^2,
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
    /* far outside its range the expansion still must point at the patch */
    double side = rad_dot(corr, corr) * per;

    if (side > .25)
        rad_scale(corr, .5 / sqrt(side), corr);
    rad_madd(s->dir, corr, e > 0 ? 1 / (1 + e) : rad_least(1 - e, 2), c);
    s->omega = k * (per * per) * rad_normalize(s->dir);
}

/* Aim at point p; returns the inverse of its distance.  As rad_normalize(), by
 * one quotient. */
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

/* The sample at point p of a patch whose flux is k * |r| / |r|^4 there. */
static void
at_point(struct rad_light_sample *s, const struct rad_light_view *view,
         const double p[3], double k)
{
    double per = aim(s, view, p);

    s->omega = k * (per * per * per);
    rad_copy(s->dir, s->aim);
}

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

/* The same for a sector.  What is convex shrinks about its centroid, so that
 * the mean stays there; a whole disk must not lose a wedge.  It shrinks to the
 * spread of the square that rpict bends to a disk, so that -dj .9 means the
 * same: points (u sqrt(1 - v^2/2), v sqrt(1 - u^2/2)) with u and v even in
 * (-j, j), whose squared radius is 2/3 j^2 - 1/9 j^4 in the mean.
 * What is bent about a hole shrinks in radius and angle, or it would leave the
 * ring; all of a ring in radius alone. */
static void
sector_point(const struct walk *w, const struct patch *p, double s, double u,
             double d[3])
{
    double jit = w->view->jitter, r0 = p->r0 * p->r0, r1 = p->r1 * p->r1;
    struct rad_moments m;

    if (p->r0 > 0) {
        s = .5 + (s - .5) * jit;
        if (p->delta < M_PI)
            u = .5 + (u - .5) * jit;
    }
    ring_point(w->src, sqrt(r0 + s * (r1 - r0)),
               p->phi + (2 * u - 1) * p->delta, d);
    if (p->r0 > 0)
        return;
    if (p->delta == M_PI)
        jit *= sqrt(rad_least(4. / 3 - 2. / 9 * jit * jit, 1 / (jit * jit)));
    sector_moments(&m, w->src, p);
    for (int k = 0; k < 3; k++)
        d[k] = m.c[k] + jit * (d[k] - m.c[k]);
}

/* A random point of the patch, drawn toward its middle by 1 - jitter. */
static void
jittered_point(struct walk *w, const struct patch *p, double d[3])
{
    const struct rad_polytree *t = p->node;
    double jit = w->view->jitter, s = next_rand(w), u = next_rand(w), c[3];

    switch (p->kind) {
    case SECTOR:
        sector_point(w, p, s, u, d);
        break;
    case LINE:
        rad_madd(d, p->p, (2 * s - 1) * jit, p->u);
        break;
    case TRIANGLE:
        triangle_point(d, p->p, p->u, p->v, s, u);
        for (int k = 0; k < 3; k++) {
            c[k] = p->p[k] + (p->u[k] + p->v[k]) / 3;
            d[k] = c[k] + jit * (d[k] - c[k]);
        }
        break;
    case GROUP:
        /* a triangle by its area; s is rescaled at each step down */
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

/* --- the flux of a patch, by its outline --- */

static void
triangle_flux(double F[3], const double view[3], const double p0[3],
              const double e1[3], const double e2[3])
{
    double q[3][3];

    rad_sub(q[0], p0, view);
    rad_madd(q[1], q[0], 1, e1);
    rad_madd(q[2], q[0], 1, e2);
    for (int i = 0; i < 3; i++)
        rad_contour_edge(F, q[i], q[(i + 1) % 3]);
}

static void
group_flux(double F[3], const double view[3], const struct rad_polytree *t)
{
    if (!t->kid[0]) {
        triangle_flux(F, view, t->p0, t->e1, t->e2);
    } else {
        group_flux(F, view, t->kid[0]);
        group_flux(F, view, t->kid[1]);
    }
}

/* The two straight sides of a sector are at its ends. */
static void
sector_flux(double F[3], const double view[3], const struct rad_source *src,
            const struct patch *p)
{
    double c[3], middle[3];

    rad_sub(c, src->centre, view);
    if (p->delta >= M_PI) {
        rad_contour_circle(F, c, src->normal, p->r1, 1);
        if (p->r0 > 0)
            rad_contour_circle(F, c, src->normal, p->r0, -1);
        return;
    }
    ring_point(src, 1, p->phi, middle);
    rad_sub(middle, middle, src->centre);
    rad_normalize(middle);
    rad_contour_arc(F, c, src->normal, p->r1, middle, p->delta, 1);
    if (p->r0 > 0)
        rad_contour_arc(F, c, src->normal, p->r0, middle, p->delta, -1);
    for (int side = -1; side <= 1; side += 2) {
        double in[3], out[3];

        ring_point(src, p->r0, p->phi + side * p->delta, in);
        ring_point(src, p->r1, p->phi + side * p->delta, out);
        rad_sub(in, in, view);
        rad_sub(out, out, view);
        rad_contour_edge(F, side < 0 ? in : out, side < 0 ? out : in);
    }
}

/* Set dir and omega; false: they must come from the moments. */
static bool
exact(struct rad_light_sample *s, const struct walk *w, const struct patch *p,
      const struct rad_moments *m)
{
    const double *view = w->view->p;
    double F[3] = { 0, 0, 0 }, to[3];

    rad_sub(to, m->c, view);
    if (rad_dot(m->a, m->a) + rad_dot(m->b, m->b) <
        FAR_VARIANCE * rad_dot(to, to))
        return false;
    if (p->kind == TRIANGLE)
        triangle_flux(F, view, p->p, p->u, p->v);
    else if (p->kind == GROUP)
        group_flux(F, view, p->node);
    else
        sector_flux(F, view, w->src, p);
    /* corners may go round the other way */
    if (rad_dot(F, to) < 0)
        rad_scale(F, -1, F);
    s->omega = rad_normalize(F);
    rad_copy(s->dir, F);
    return s->omega > 0;
}

/* --- patches across the horizon --- */

/* Places on a sector's arc that its outline goes through, where it is cut: the
 * chords hold its area, so their flux is off by 1e-4 at most, but next to the
 * arc. */
enum { CHORDS = 24, MOST_CORNERS = 2 * (CHORDS + 1) };

/* What of a patch is above the horizon. */
struct risen {
    double F[3];
    double aim[3], height; /* the highest place that may be aimed at */
    double middle[3];      /* in its stead, if that is below */
};

/* Add `sign` times the flux of what of a polygon is above: its corners are seen
 * from the point, and of n at most MOST_CORNERS. */
static void
add_above(struct risen *sum, const double up[3], double v[][3], int n,
          double sign)
{
    double kept[2 * MOST_CORNERS][3], F[3] = { 0, 0, 0 }, to[3] = { 0, 0, 0 };
    int k = 0;

    for (int i = 0; i < n; i++) {
        const double *a = v[i], *b = v[(i + 1) % n];
        double ha = rad_dot(a, up), hb = rad_dot(b, up);

        if (ha > 0)
            rad_copy(kept[k++], a);
        if ((ha > 0) != (hb > 0)) {
            rad_sub(kept[k], b, a);
            rad_madd(kept[k], a, ha / (ha - hb), kept[k]);
            k++;
        }
    }
    for (int i = 0; i < k; i++) {
        rad_contour_edge(F, kept[i], kept[(i + 1) % k]);
        rad_madd(to, to, 1, kept[i]);
    }
    if (sign > 0 && k > 0)
        rad_scale(sum->middle, 1. / k, to);
    rad_madd(sum->F, sum->F, rad_dot(F, to) < 0 ? -sign : sign, F);
}

/* May the place p, seen from the point, be aimed at rather than others? */
static void
offer_aim(struct risen *sum, const double up[3], const double p[3])
{
    double h = rad_dot(p, up);

    if (h > sum->height) {
        sum->height = h;
        rad_copy(sum->aim, p);
    }
}

static void
rise_triangle(struct risen *sum, const struct rad_light_view *view,
              const double p0[3], const double e1[3], const double e2[3])
{
    double v[3][3], near[3];

    rad_sub(v[0], p0, view->p);
    rad_madd(v[1], v[0], 1, e1);
    rad_madd(v[2], v[0], 1, e2);
    for (int i = 0; i < 3; i++) { /* next to each corner, inside */
        for (int k = 0; k < 3; k++)
            near[k] = (v[0][k] + v[1][k] + v[2][k] + 7 * v[i][k]) / 10;
        offer_aim(sum, view->up, near);
    }
    add_above(sum, view->up, v, 3, 1);
}

static void
rise_group(struct risen *sum, const struct rad_light_view *view,
           const struct rad_polytree *t)
{
    if (!t->kid[0]) {
        rise_triangle(sum, view, t->p0, t->e1, t->e2);
    } else {
        rise_group(sum, view, t->kid[0]);
        rise_group(sum, view, t->kid[1]);
    }
}

/* The corners of an arc in v, from side to side; returns their number. */
static int
arc_corners(const struct walk *w, const struct patch *p, double radius,
            double side, double v[][3])
{
    double step = 2 * p->delta / CHORDS, r = radius * sqrt(step / sin(step));

    for (int i = 0; i <= CHORDS; i++) {
        ring_point(w->src, r, p->phi + side * (p->delta - i * step), v[i]);
        rad_sub(v[i], v[i], w->view->p);
    }
    return CHORDS + 1;
}

/* Is the point next to a part of the circle of that radius that is above? */
static bool
is_next_to_risen(const struct walk *w, double radius)
{
    double c[3], near[3], q;

    rad_sub(c, w->src->centre, w->view->p);
    rad_madd(near, c, -rad_dot(c, w->src->normal), w->src->normal);
    q = rad_normalize(near);
    if (!(q > 0))
        return false; /* it is as far from all of it */
    rad_madd(near, c, -radius, near);
    return rad_dot(near, near) < radius * radius / 16 &&
           rad_dot(near, w->view->up) > 0;
}

/* Of a sector next to which the point is, the whole by its arcs without what
 * chords say is below; else what they say is above. */
static void
rise_sector(struct risen *sum, const struct walk *w, const struct patch *p)
{
    const double *up = w->view->up;
    double v[MOST_CORNERS][3], middle[3], down[3], sign = 1;
    int n = arc_corners(w, p, p->r1, -1, v);

    for (int i = 0; i < 8; i++) {
        ring_point(w->src, sqrt((p->r0 * p->r0 + p->r1 * p->r1) / 2),
                   p->phi + (i - 3.5) / 4 * p->delta, middle);
        rad_sub(middle, middle, w->view->p);
        offer_aim(sum, up, middle);
    }
    if (sum->height > 0 &&
        (is_next_to_risen(w, p->r1) || is_next_to_risen(w, p->r0))) {
        sector_flux(sum->F, w->view->p, w->src, p);
        rad_scale(down, -1, up);
        up = down;
        sign = -1;
    }
    if (p->delta >= M_PI) { /* two circles, each from a place to the same */
        add_above(sum, up, v, n - 1, sign);
        if (p->r0 > 0) {
            n = arc_corners(w, p, p->r0, 1, v);
            add_above(sum, up, v, n - 1, -sign);
        }
        return;
    }
    if (p->r0 > 0) {
        n += arc_corners(w, p, p->r0, 1, v + n);
    } else {
        rad_sub(v[n], w->src->centre, w->view->p);
        n++;
    }
    add_above(sum, up, v, n, sign);
}

/* The sample of a patch that may lie across the horizon: it aims at a place
 * above, and has the flux of what is there.  Parallelograms have all of their
 * flux while their middle is above, as in rpict. */
static void
risen_sample(struct walk *w, const struct patch *p)
{
    struct risen sum = { .height = 0 };
    struct rad_light_sample s;

    if (p->kind == TRIANGLE)
        rise_triangle(&sum, w->view, p->p, p->u, p->v);
    else if (p->kind == GROUP)
        rise_group(&sum, w->view, p->node);
    else
        rise_sector(&sum, w, p);
    s.omega = rad_normalize(sum.F);
    if (!(s.omega > 0))
        return;
    rad_copy(s.aim, sum.height > 0 ? sum.aim : sum.middle);
    s.dist = rad_normalize(s.aim);
    rad_copy(s.dir, sum.F);
    put(w, &s);
}

static void
flat_sample(struct walk *w, const struct patch *p, const struct rad_moments *m)
{
    const struct rad_light_view *view = w->view;
    struct rad_light_sample s;
    double to[3], point[3];

    rad_sub(to, m->c, view->p);
    double k = -rad_dot(w->src->normal, to) * m->area;

    if (view->up && view->sizerat > 0 && !(view->jitter > 0)) {
        risen_sample(w, p);
        return;
    }
    if (view->jitter > 0) {
        jittered_point(w, p, point);
        at_point(&s, view, point, k);
    } else {
        at_point(&s, view, m->aim, k);
        if (out_of_reach(w->src, &s))
            return; /* before it costs more */
        if (view->sizerat > 0) {
            if (!exact(&s, w, p, m))
                second_order(&s, view, m, k);
        } else if (p->kind == SECTOR && p->r0 > 0) {
            /* the middle is the hole's, and cannot be aimed at */
            double d2 = rad_dot(to, to);

            s.omega = k / (d2 * sqrt(d2));
            rad_copy(s.dir, to);
            rad_normalize(s.dir);
        }
    }
    put(w, &s);
}

/* The flux of a stretch of cylinder, whose axis is unit and from which the
 * point is h away against perp: what is seen of it lies between two lines along
 * it and the near arcs of its ends, wherever the point is.  False: it is far
 * enough to do without. */
static bool
line_flux(struct rad_light_sample *s, const struct walk *w,
          const struct patch *p, const double axis[3], const double perp[3],
          double h)
{
    const double *view = w->view->p;
    double r = w->src->r1, delta = acos(r / h),
           half = sqrt(rad_dot(p->u, p->u));
    double F[3] = { 0, 0, 0 }, to[3], near[3], side[3], end[2][3],
           line[2][2][3];

    rad_sub(to, p->p, view);
    if (half * half / 3 + r * r < FAR_VARIANCE * rad_dot(to, to))
        return false;
    rad_scale(near, -1, perp);
    rad_cross(side, axis, near);
    for (int e = 0; e < 2; e++) {
        rad_madd(end[e], to, e ? half : -half, axis);
        rad_contour_arc(F, end[e], axis, r, near, delta, e ? 1 : -1);
        for (int k = 0; k < 2; k++) {
            rad_madd(line[k][e], end[e], r * cos(delta), near);
            rad_madd(line[k][e], line[k][e], (k ? 1 : -1) * r * sin(delta),
                     side);
        }
    }
    rad_contour_edge(F, line[0][0], line[0][1]);
    rad_contour_edge(F, line[1][1], line[1][0]);
    if (rad_dot(F, to) < 0)
        rad_scale(F, -1, F);
    s->omega = rad_normalize(F);
    rad_copy(s->dir, F);
    return s->omega > 0;
}

/* A stretch of cylinder: a strip through its axis that faces the point. */
static void
line_sample(struct walk *w, const struct patch *p, const struct rad_moments *m)
{
    const struct rad_light_view *view = w->view;
    const struct rad_source *src = w->src;
    struct rad_light_sample s;
    double to[3], axis[3], perp[3], point[3], side[3];

    rad_copy(axis, src->axis[0]);
    rad_normalize(axis);
    rad_sub(to, src->centre, view->p);
    rad_madd(perp, to, -rad_dot(to, axis), axis);
    double h = rad_normalize(perp), k = h * m->area;

    if (view->jitter > 0) {
        /* sin(lateral angle) even in (-r/h, r/h) */
        double lat = view->jitter * (2 * rad_rand(view->key, w->dim + 2) - 1) *
                     src->r1 / h;
        double cosine = sqrt(1 - lat * lat);

        jittered_point(w, p, point);
        w->dim++;
        rad_cross(side, axis, perp);
        /* turn the place on the axis about the line through the point */
        double z = rad_dot(point, axis) - rad_dot(view->p, axis);

        rad_madd(point, view->p, z, axis);
        rad_madd(point, point, h * cosine, perp);
        rad_madd(point, point, h * lat, side);
        at_point(&s, view, point, k / cosine);
    } else {
        at_point(&s, view, m->aim, k);
        if (view->sizerat > 0 && !line_flux(&s, w, p, axis, perp, h))
            second_order(&s, view, m, k);
    }
    put(w, &s);
}

/* Parallelograms: see quad.h. */
static void
visit_quad(struct walk *w)
{
    struct rad_light_sample s[RAD_LIGHT_PATCHES];
    int n = rad_quad_samples(w->src, w->view, s);

    for (int i = 0; i < n; i++)
        put(w, &s[i]);
}

/* The other shapes. */
static void
visit(struct walk *w, const struct patch *p, const struct rad_moments *m)
{
    if (w->view->sizerat > 0 && p->budget > 1 && !small_enough(p, m, w->view)) {
        struct patch half[2];
        struct rad_moments hm;

        split(p, m, half);
        for (int h = 0; h < 2; h++) {
            patch_moments(w->src, &half[h], &hm);
            visit(w, &half[h], &hm);
        }
    } else if (p->kind == LINE) {
        line_sample(w, p, m);
    } else {
        flat_sample(w, p, m);
    }
}

/* --- sources without patches --- */

static bool
is_quad(const struct rad_source *src)
{
    return !src->tree && src->shape == RAD_POLYGON;
}

/* Has a flat source one sample, the same as flat_sample() would make of it? */
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
        return; /* inside */
    if (view->jitter > 0) {
        double r = view->jitter * sin_max * sqrt(next_rand(w));
        double phi = 2 * M_PI * next_rand(w);

        cosine = sqrt(1 - r * r);
        rad_copy(to, s.aim);
        rad_frame(u, v, to);
        rad_scale(s.aim, cosine, to);
        rad_madd(s.aim, s.aim, r * cos(phi), u);
        rad_madd(s.aim, s.aim, r * sin(phi), v);
    }
    rad_copy(s.dir, s.aim);
    /* -ds and the reach of a glow measure to the centre */
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
        /* even in solid angle */
        double h = jit * jit * next_rand(w) * src->size / (2 * M_PI);
        double phi = 2 * M_PI * next_rand(w), r = sqrt(h * (2 - h));

        rad_frame(u, v, src->centre);
        rad_scale(s.aim, 1 - h, src->centre);
        rad_madd(s.aim, s.aim, r * cos(phi), u);
        rad_madd(s.aim, s.aim, r * sin(phi), v);
    }
    rad_copy(s.dir, s.aim);
    /* the focus of a spotlight at infinity makes no difference */
    if (!(src->flags & RAD_LIGHT_SPOT) || !rad_spot_outside(&src->spot, s.aim))
        w->fn(w->arg, &s);
}

static void
root_patch(const struct rad_source *src, struct patch *p)
{
    memset(p, 0, sizeof *p);
    p->budget = RAD_LIGHT_PATCHES;
    if (src->tree) {
        from_node(p, src->tree);
    } else if (src->shape == RAD_RING) {
        p->kind = SECTOR;
        p->r0 = src->r0;
        p->r1 = src->r1;
        p->delta = M_PI;
    } else {
        p->kind = LINE;
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

/* Is a point, at d from the centre, outside of any light of a spotlight?  By
 * more than rounding: samples tell the rest. */
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
    /* inside the cylinder, however long? */
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
    struct patch root;

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
