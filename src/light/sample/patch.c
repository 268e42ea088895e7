/* patch.c - see patch.h
 *
 * The part above the horizon of a flat patch with straight sides is a polygon;
 * arcs are replaced by chords before they are cut. */
#include "config.h"

#include "light/sample/patch.h"
#include "light/sample/contour.h"

/* --- the flux of whole patches --- */

static void
triangle_flux(double F[3], const double at[3], const double p0[3],
              const double e1[3], const double e2[3])
{
    double q[3][3];

    rad_sub(q[0], p0, at);
    rad_madd(q[1], q[0], 1, e1);
    rad_madd(q[2], q[0], 1, e2);
    for (int i = 0; i < 3; i++)
        rad_contour_edge(F, q[i], q[(i + 1) % 3]);
}

static void
group_flux(double F[3], const double at[3], const struct rad_polytree *t)
{
    for (int i = 0; i < t->nedges; i++) {
        double a[3], b[3];

        rad_sub(a, t->edge[i].from, at);
        rad_sub(b, t->edge[i].to, at);
        rad_contour_edge(F, a, b);
    }
}

/* A sector's outline is an outer arc, an inner arc, and two straight sides. */
static void
sector_flux(double F[3], const double at[3], const struct rad_source *src,
            const struct rad_patch *p)
{
    double c[3], middle[3];

    rad_sub(c, src->centre, at);
    if (p->delta >= M_PI) {
        rad_contour_circle(F, c, src->normal, p->r1, 1);
        if (p->r0 > 0)
            rad_contour_circle(F, c, src->normal, p->r0, -1);
        return;
    }
    rad_ring_point(src, 1, p->phi, middle);
    rad_sub(middle, middle, src->centre);
    rad_normalize(middle);
    rad_contour_arc(F, c, src->normal, p->r1, middle, p->delta, 1);
    if (p->r0 > 0)
        rad_contour_arc(F, c, src->normal, p->r0, middle, p->delta, -1);
    for (int side = -1; side <= 1; side += 2) {
        double way[3], in[3], out[3];

        rad_ring_point(src, 1, p->phi + side * p->delta, way);
        rad_sub(way, way, src->centre);
        rad_madd(in, c, p->r0, way);
        rad_madd(out, c, p->r1, way);
        rad_contour_edge(F, side < 0 ? in : out, side < 0 ? out : in);
    }
}

void
rad_patch_flux(double F[3], const struct rad_source *src, const double at[3],
               const struct rad_patch *p)
{
    if (p->kind == RAD_PATCH_TRIANGLE)
        triangle_flux(F, at, p->p, p->u, p->v);
    else if (p->kind == RAD_PATCH_GROUP)
        group_flux(F, at, p->node);
    else
        sector_flux(F, at, src, p);
}

/* --- patches across the horizon --- */

/* Chords that stand for an arc of a sector that is cut by the horizon.  They
 * enclose the sector's area, so the flux is off by 1e-4 at most, except next to
 * the arc. */
enum { CHORDS = 24, MOST_CORNERS = 2 * (CHORDS + 1) };

/* The part of a patch above the horizon, relative to the point that sees it. */
struct risen {
    double F[3];           /* its flux */
    double aim[3], height; /* highest place to aim at, and its height; height 0:
                            * all places tried are below the horizon */
    double middle[3];      /* the place to aim at where height is 0: the mean
                            * corner of the part */
};

/* Add `sign` times the flux of the part of a polygon above the horizon of `up`.
 * Its n corners, at most MOST_CORNERS, are relative to the point that sees it.
 */
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

/* Aim at p, relative to the point, if it is higher than the places before. */
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
    for (int i = 0; i < 3; i++) { /* a place inside, next to each corner */
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

/* Put the corners of an arc's chords in v, relative to the point, in the order
 * that side (1 or -1) says; returns their number. */
static int
arc_corners(const struct rad_source *src, const struct rad_light_view *view,
            const struct rad_patch *p, double radius, double side,
            double v[][3])
{
    double step = 2 * p->delta / CHORDS,
           r = radius * sqrt(step / rad_sin(step));

    for (int i = 0; i <= CHORDS; i++) {
        rad_ring_point(src, r, p->phi + side * (p->delta - i * step), v[i]);
        rad_sub(v[i], v[i], view->p);
    }
    return CHORDS + 1;
}

/* Is the point within a quarter of the radius of a circle's nearest place, and
 * is that place above the horizon? */
static bool
is_next_to_risen(const struct rad_source *src,
                 const struct rad_light_view *view, double radius)
{
    double c[3], near[3], q;

    rad_sub(c, src->centre, view->p);
    rad_madd(near, c, -rad_dot(c, src->normal), src->normal);
    q = rad_normalize(near);
    if (!(q > 0))
        return false; /* on the axis: no place is nearest */
    rad_madd(near, c, -radius, near);
    return rad_dot(near, near) < radius * radius / 16 &&
           rad_dot(near, view->up) > 0;
}

/* Chords are imprecise for a point next to an arc.  There the flux of the part
 * below the horizon, by chords, is subtracted from the flux of the whole
 * sector, by its arcs; elsewhere the flux of the part above is computed by
 * chords. */
static void
rise_sector(struct risen *sum, const struct rad_source *src,
            const struct rad_light_view *view, const struct rad_patch *p)
{
    const double *up = view->up;
    double v[MOST_CORNERS][3], middle[3], down[3], sign = 1;
    int n = arc_corners(src, view, p, p->r1, -1, v);

    for (int i = 0; i < 8; i++) {
        rad_ring_point(src, sqrt((p->r0 * p->r0 + p->r1 * p->r1) / 2),
                       p->phi + (i - 3.5) / 4 * p->delta, middle);
        rad_sub(middle, middle, view->p);
        offer_aim(sum, up, middle);
    }
    if (sum->height > 0 && (is_next_to_risen(src, view, p->r1) ||
                            is_next_to_risen(src, view, p->r0))) {
        sector_flux(sum->F, view->p, src, p);
        rad_scale(down, -1, up);
        up = down;
        sign = -1;
    }
    if (p->delta >= M_PI) { /* whole circles: the last corner is the first */
        add_above(sum, up, v, n - 1, sign);
        if (p->r0 > 0) {
            n = arc_corners(src, view, p, p->r0, 1, v);
            add_above(sum, up, v, n - 1, -sign);
        }
        return;
    }
    if (p->r0 > 0) {
        n += arc_corners(src, view, p, p->r0, 1, v + n);
    } else {
        rad_sub(v[n], src->centre, view->p);
        n++;
    }
    add_above(sum, up, v, n, sign);
}

/* Not called for parallelograms (quad.c): as in rpict, they have all of their
 * flux while their middle is above the horizon. */
bool
rad_patch_risen(struct rad_light_sample *s, const struct rad_source *src,
                const struct rad_light_view *view, const struct rad_patch *p)
{
    struct risen sum = { .height = 0 };

    if (p->kind == RAD_PATCH_TRIANGLE)
        rise_triangle(&sum, view, p->p, p->u, p->v);
    else if (p->kind == RAD_PATCH_GROUP)
        rise_group(&sum, view, p->node);
    else
        rise_sector(&sum, src, view, p);
    s->omega = rad_normalize(sum.F);
    if (!(s->omega > 0))
        return false;
    rad_copy(s->aim, sum.height > 0 ? sum.aim : sum.middle);
    s->dist = rad_normalize(s->aim);
    rad_copy(s->dir, sum.F);
    return true;
}
