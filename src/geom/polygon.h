/* polygon.h - the test of a ray against a face (inside geom/ only)
 *
 * The test is in a header so that each kernel inlines it, compiled for its own
 * instruction set: most of a ray's time is spent here.
 * Vertices come four at a time, as rad_polygon_lay() put them.  Their number is
 * filled up to a multiple of four with the first vertex; the edges of length 0
 * that this adds change nothing.
 *
 * A ray is inside a face if the face's edges cross it an odd number of times to
 * one side.  So seams cancel (edges that run both ways, by which the scene
 * language makes holes), repeated vertices do not matter, and no triangulation
 * is needed.  The test is made in the plane across the ray after the shear of
 * Woop, Benthin & Wald 2013 (Watertight ray/triangle intersection).  A vertex's
 * place there depends on ray and vertex alone, and the side of an edge is
 * decided from products that are bitwise the same for a->b and b->a.  So two
 * faces that share an edge agree on it, rounding or not: the ray meets an odd
 * number of the faces on either side, never none.
 * A ray that meets an edge exactly meets both of its faces, so that the tie
 * rule chooses between them and not the direction of an edge.
 *
 * The distance comes from the plane and is kept between those of the nearest
 * and the farthest vertex along the ray: for a face seen edge-on the quotient
 * would be noise.  A face that is not flat lies in the plane at the mean offset
 * of its vertices, where Radiance has it, too.  A ray that passes between its
 * edges all but along it meets that plane anywhere; see rad_warped_depth(). */
#ifndef RAD_GEOM_POLYGON_H
#define RAD_GEOM_POLYGON_H

#include "geom/prim.h"

#include "base/vec.h"

#include <math.h>
#include <string.h>

/* Edges of a face, in four lanes. */
struct rad_edges {
    rad_v4d x, y; /* the last four vertices */
    rad_v4i odd;  /* all bits: an odd number of edges crossed to one side */
    rad_v4i met;  /* all bits: the ray meets an edge exactly */
};

/* Load four vertices at v, of n for each axis, and shear them. */
static inline __attribute__((always_inline)) void
rad_edges_see(struct rad_edges *s, const double *v, size_t n,
              const struct rad_probe *r, rad_v4d *z)
{
    memcpy(&s->x, v + (size_t)r->kx * n, sizeof s->x);
    memcpy(&s->y, v + (size_t)r->ky * n, sizeof s->y);
    memcpy(z, v + (size_t)r->kz * n, sizeof *z);
    *z -= r->org[r->kz];
    s->x = s->x - r->org[r->kx] - r->sx * *z;
    s->y = s->y - r->org[r->ky] - r->sy * *z;
}

/* Add the edges from (x0, y0) to the vertices in s. */
static inline __attribute__((always_inline)) void
rad_edges_add(struct rad_edges *s, const rad_v4d *x0, const rad_v4d *y0)
{
    /* does it cross the positive x axis?  e and f swap when the edge is
     * walked the other way, and so does which of them must be greater */
    rad_v4d e = *x0 * s->y, f = *y0 * s->x;
    rad_v4i up = s->y > 0;

    s->odd ^= ((*y0 > 0) ^ up) & ((up & (e > f)) | (~up & (e < f)));
    /* a ray on an edge has its ends in opposite quadrants */
    s->met |= (e == f) & (*x0 * s->x <= 0) & (*y0 * s->y <= 0);
}

/* Is the ray inside the face, or with `edges` on one of its edges? */
static inline __attribute__((always_inline)) bool
rad_edges_inside(const struct rad_edges *s, bool edges)
{
    /* one sum over the lanes adds up both counts */
    rad_v4i both = (s->odd & 1) + (s->met & 16), swapped;
    int64_t n;

    swapped = __builtin_shufflevector(both, both, 2, 3, 0, 1);
    both += swapped;
    n = both[0] + both[1];
    return (n & 1) | (edges & (n >= 16));
}

static inline __attribute__((always_inline)) void
rad_span_of(const rad_v4d *z, double *zlo, double *zhi)
{
    const rad_v4d a = *z;

    *zlo = rad_least(rad_least(a[0], a[1]), rad_least(a[2], a[3]));
    *zhi = rad_most(rad_most(a[0], a[1]), rad_most(a[2], a[3]));
}

/* Does the ray pass inside a face of three or four vertices, or with `edges`
 * meet an edge of it?  [*zlo, *zhi] gets the span of the vertices along axis
 * kz, from the origin. */
static inline __attribute__((always_inline)) bool
rad_quad_inside(const struct rad_prim *p, const struct rad_probe *r, bool edges,
                double *zlo, double *zhi)
{
    struct rad_edges s = { .odd = { 0 }, .met = { 0 } };
    rad_v4d x0, y0, z;

    rad_edges_see(&s, p->v, 4, r, &z);
    x0 = __builtin_shufflevector(s.x, s.x, 3, 0, 1, 2);
    y0 = __builtin_shufflevector(s.y, s.y, 3, 0, 1, 2);
    rad_edges_add(&s, &x0, &y0);
    if (!rad_edges_inside(&s, edges))
        return false;
    rad_span_of(&z, zlo, zhi);
    return true;
}

/* The same for a face of any number of vertices. */
static inline __attribute__((always_inline)) bool
rad_polygon_inside(const struct rad_prim *p, const struct rad_probe *r,
                   bool edges, double *zlo, double *zhi)
{
    size_t n = rad_polygon_laid(p);
    struct rad_edges s = { .odd = { 0 }, .met = { 0 } };
    rad_v4d x, y, x0, y0, z;
    double lo, hi;

    rad_edges_see(&s, p->v + n - 4, n, r, &z); /* the last precede the first */
    rad_span_of(&z, zlo, zhi);
    for (size_t i = 0; i < n; i += 4) {
        x = s.x;
        y = s.y;
        rad_edges_see(&s, p->v + i, n, r, &z);
        x0 = __builtin_shufflevector(x, s.x, 3, 4, 5, 6);
        y0 = __builtin_shufflevector(y, s.y, 3, 4, 5, 6);
        rad_edges_add(&s, &x0, &y0);
        rad_span_of(&z, &lo, &hi);
        *zlo = rad_least(lo, *zlo);
        *zhi = rad_most(hi, *zhi);
    }
    return rad_edges_inside(&s, edges);
}

static inline const struct rad_warp *
rad_polygon_warp(const struct rad_prim *p)
{
    return (const void *)(p->v + 3 * rad_polygon_laid(p));
}

/* Where a ray that passes between a warped face's edges, and meets its plane at
 * s, meets the face: there, but within the box of the vertices.  So a tree that
 * knows that box finds it.  NAN: nowhere, since the ray begins on the face and
 * is beyond its plane. */
double rad_warped_depth(const struct rad_prim *p, const struct rad_probe *r,
                        double tmin, double s);

/* warped: is it a PRIM_WARPED? */
static inline __attribute__((always_inline)) bool
rad_face_hit(const struct rad_prim *p, const struct rad_probe *r, double tmin,
             double tmax, double *t, bool warped)
{
    double den = rad_dot(p->k, r->dir);
    double num = p->k[3] - rad_dot(p->k, r->org);
    double err = RAD_GEOM_ROUND * r->size + p->slack;
    double sign = copysign(1, den), rcp, zlo, zhi, lo, hi, s;
    bool edges;

    if (warped)
        err += rad_polygon_warp(p)->most;
    den *= sign;
    num *= sign;
    /* beyond the limits, rounding or not; this needs no division */
    if (!((num >= tmin * den - err) & (num <= tmax * den + err)))
        return false;
    /* a ray along a face would meet all its edges: none counts */
    edges = den > RAD_GEOM_ROUND;
    if (!(p->nv <= 4 ? rad_quad_inside(p, r, edges, &zlo, &zhi)
                     : rad_polygon_inside(p, r, edges, &zlo, &zhi)))
        return false;
    if (warped) {
        *t = s = rad_warped_depth(p, r, tmin, num / den);
        return s > tmin && s < tmax;
    }
    rcp = r->rcp[r->kz];
    lo = (rcp > 0 ? zlo : zhi) * rcp;
    hi = (rcp > 0 ? zhi : zlo) * rcp;
    s = num / den;
    s = s > lo ? s : lo; /* a NaN becomes lo */
    s = s < hi ? s : hi;
    *t = s;
    return s > tmin && s < tmax;
}

#endif
