/* polygon.h - the test of a ray against a flat face (inside geom/ only)
 *
 * Here and not in polygon.c so that each kernel has it inline, compiled for
 * its own instruction set: it is what most of a ray's time goes into.  The
 * vectors below are the compiler's: two registers, one, or none, the same
 * operations on each element, so the same bits.
 *
 * A face is inside out where its edges cross the ray an odd number of times to
 * one side; so seams (edges run both ways, by which the scene language makes
 * holes) cancel, repeated vertices do not matter, and no triangulation is
 * needed.  The test is made in the plane across the ray after the shear of
 * Woop, Benthin & Wald 2013 (Watertight ray/triangle intersection): a vertex's
 * place there depends on ray and vertex alone, and the side of an edge is
 * decided from products that are bitwise the same for a->b and b->a.  Two
 * faces that share an edge therefore agree on it, rounding or not: the ray
 * meets an odd number of the faces on either side, never none.
 * A ray that meets an edge exactly meets both its faces, so that the tie rule
 * chooses between them and not the direction of an edge.
 *
 * The distance comes from the plane (mean offset, for faces that are not quite
 * flat), held between the nearest and the farthest vertex along the ray: in a
 * face seen edge-on the quotient would be noise. */
#ifndef RAD_GEOM_POLYGON_H
#define RAD_GEOM_POLYGON_H

#include "geom/prim.h"

#include "base/vec.h"

#include <math.h>

typedef double rad_v4d __attribute__((vector_size(32)));
typedef int64_t rad_v4i __attribute__((vector_size(32)));

/* Does the ray meet the edge from (x0, y0) to (x, y) exactly?  The edge's ends
 * then lie in opposite quadrants. */
static inline bool
rad_on_edge(double x0, double y0, double x, double y)
{
    return x0 * y == y0 * x && x0 * x <= 0 && y0 * y <= 0;
}

/* The same for any number of vertices; in polygon.c. */
bool rad_polygon_inside(const struct rad_prim *p, const struct rad_probe *r,
                        bool edges, double *zlo, double *zhi);

/* Does the ray pass inside a face of three or four vertices, or with `edges`
 * meet an edge of it?  [*zlo, *zhi] gets the span of the vertices along axis
 * kz, from the origin.  A fourth vertex equal to the first changes nothing: its
 * edge has no length. */
static inline __attribute__((always_inline)) bool
rad_quad_inside(const struct rad_prim *p, const struct rad_probe *r, bool edges,
                double *zlo, double *zhi)
{
    const double *a = p->v, *b = a + 3, *c = a + 6, *d = p->nv > 3 ? a + 9 : a;
    int kx = r->kx, ky = r->ky, kz = r->kz;
    rad_v4d z = (rad_v4d){ a[kz], b[kz], c[kz], d[kz] } - r->org[kz];
    rad_v4d x = (rad_v4d){ a[kx], b[kx], c[kx], d[kx] } - r->org[kx];
    rad_v4d y = (rad_v4d){ a[ky], b[ky], c[ky], d[ky] } - r->org[ky];
    rad_v4d x0, y0, e, f;
    rad_v4i odd, near;

    x -= r->sx * z;
    y -= r->sy * z;
    /* each vertex's neighbour: the edge between them */
    x0 = __builtin_shufflevector(x, x, 3, 0, 1, 2);
    y0 = __builtin_shufflevector(y, y, 3, 0, 1, 2);
    /* does it cross the positive x axis?  e and f swap when the edge is
     * walked the other way, and so does which of them must be greater */
    e = x0 * y;
    f = y0 * x;
    odd = ((y0 > 0) ^ (y > 0)) & (((y > y0) & (e > f)) | ((y < y0) & (e < f)));
    near = e == f;
    near[0] &= -(p->nv > 3); /* else an edge of no length */
    *zlo = rad_least(rad_least(z[0], z[1]), rad_least(z[2], z[3]));
    *zhi = rad_most(rad_most(z[0], z[1]), rad_most(z[2], z[3]));
    if (__builtin_expect((near[0] | near[1] | near[2] | near[3]) != 0, 0) &&
        edges)
        for (int i = 0; i < 4; i++)
            if (rad_on_edge(x0[i], y0[i], x[i], y[i]))
                return true;
    return (odd[0] ^ odd[1] ^ odd[2] ^ odd[3]) != 0;
}

static inline __attribute__((always_inline)) bool
rad_polygon_hit(const struct rad_prim *p, const struct rad_probe *r,
                double tmin, double tmax, double *t)
{
    double den = rad_dot(p->k, r->dir);
    double num = p->k[3] - rad_dot(p->k, r->org);
    double err = RAD_GEOM_ROUND * r->size + p->slack;
    double sign = copysign(1, den), rcp, zlo, zhi, lo, hi, s;
    bool edges;

    den *= sign;
    num *= sign;
    /* out of reach whatever the rounding; t itself can wait */
    if (!((num >= tmin * den - err) & (num <= tmax * den + err)))
        return false;
    /* all edges of a face seen edge-on are met: none counts */
    edges = den > RAD_GEOM_ROUND;
    if (!(p->nv <= 4 ? rad_quad_inside(p, r, edges, &zlo, &zhi)
                     : rad_polygon_inside(p, r, edges, &zlo, &zhi)))
        return false;
    rcp = r->rcp[r->kz];
    lo = (rcp > 0 ? zlo : zhi) * rcp;
    hi = (rcp > 0 ? zhi : zlo) * rcp;
    s = num / den;
    s = s > lo ? s : lo; /* a NaN becomes lo */
    s = s < hi ? s : hi;
    *t = s;
    return s > tmin && s < tmax;
}

/* Dispatch to the family; a place is none. */
static inline __attribute__((always_inline)) bool
rad_prim_hit(const struct rad_prim *p, const struct rad_probe *r, double tmin,
             double tmax, double *t)
{
    switch (p->kind) {
    case PRIM_POLYGON:
        return rad_polygon_hit(p, r, tmin, tmax, t);
    case PRIM_SPHERE:
        return rad_sphere_hit(p, r, tmin, tmax, t);
    case PRIM_CONE:
        return rad_cone_hit(p, r, tmin, tmax, t);
    case PRIM_RING:
        return rad_ring_hit(p, r, tmin, tmax, t);
    default:
        return false;
    }
}

#endif
