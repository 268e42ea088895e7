/* polygon.c - faces of any number of vertices, concave or with holes
 *
 * The test of a ray is in polygon.h; this file is what runs once or seldom. */
#include "config.h"

#include "geom/polygon.h"

#include "base/vec.h"

#include <math.h>
#include <string.h>

/* Vertices of a frozen octree have 31 bits of mantissa, so a flat face may come
 * back warped by this part of its coordinates.  Warps beyond that are the
 * author's, and no rounding error: the face is PRIM_WARPED. */
#define STORED_ROUND 0x1p-30

/* Twice the area times the normal (the sum of cross products in a fan around
 * the first vertex); returns the squared distance of the vertex farthest from
 * the first. */
static double
area_vector(double n[3], const double *v, int nv)
{
    double a[3], b[3], c[3], far2 = 0;

    n[0] = n[1] = n[2] = 0;
    rad_sub(a, v + 3, v);
    for (int i = 2; i < nv; i++) {
        far2 = fmax(far2, rad_dot(a, a));
        rad_sub(b, v + 3 * i, v);
        rad_cross(c, a, b);
        rad_madd(n, n, 1, c);
        rad_copy(a, b);
    }
    return fmax(far2, rad_dot(a, a));
}

bool
rad_polygon_make(struct rad_prim *p, const struct rad_object *o)
{
    const double *v = o->reals;
    int nv = o->nreals / 3;
    double size2, mean = 0, low = 0, high = 0, big = 0, warp;

    if (nv < 3)
        return false;
    size2 = area_vector(p->k, v, nv);
    /* with less area the normal is nothing but rounding errors */
    if (!(rad_dot(p->k, p->k) > 0) ||
        !(sqrt(rad_dot(p->k, p->k)) > nv * 0x1p-51 * size2) ||
        !(rad_normalize(p->k) > 0))
        return false;
    for (int i = 0; i < nv; i++) {
        double d[3], h;

        rad_sub(d, v + 3 * i, v);
        h = rad_dot(p->k, d);
        mean += h / nv;
        low = h < low ? h : low;
        high = h > high ? h : high;
        for (int j = 0; j < 3; j++)
            big = fmax(big, fabs(v[3 * i + j]));
    }
    p->k[3] = rad_dot(p->k, v) + mean;
    if (!(fabs(p->k[3]) <= big * 4 && big < INFINITY))
        return false; /* there is a NaN */
    warp = fmax(high - mean, mean - low);
    p->kind = warp > STORED_ROUND * big ? PRIM_WARPED : PRIM_POLYGON;
    p->v = v;
    p->nv = nv;
    p->slack =
        (float)(RAD_GEOM_ROUND * 3 * big + fmin(warp, STORED_ROUND * big));
    return true;
}

/* Of a polygon before it is laid. */
static void
warp_of(const struct rad_prim *p, struct rad_warp *warp)
{
    struct rad_box *box = &warp->box;

    warp->most = 0;
    rad_copy(box->lo, p->v);
    rad_copy(box->hi, p->v);
    for (const double *v = p->v; v < p->v + 3 * p->nv; v += 3) {
        warp->most = fmax(warp->most, fabs(rad_dot(p->k, v) - p->k[3]));
        for (int i = 0; i < 3; i++) {
            box->lo[i] = v[i] < box->lo[i] ? v[i] : box->lo[i];
            box->hi[i] = v[i] > box->hi[i] ? v[i] : box->hi[i];
        }
    }
}

void
rad_polygon_bounds(const struct rad_prim *p, struct rad_box *box)
{
    struct rad_warp warp;

    warp_of(p, &warp);
    for (int i = 0; i < 3; i++) { /* hit points lie on the mean plane */
        box->lo[i] = warp.box.lo[i] - warp.most * fabs(p->k[i]);
        box->hi[i] = warp.box.hi[i] + warp.most * fabs(p->k[i]);
    }
}

void
rad_polygon_lay(struct rad_prim *p, double *to)
{
    size_t n = rad_polygon_laid(p);
    const double *v = p->v;
    struct rad_warp warp;

    for (size_t i = 0; i < n; i++)
        for (size_t a = 0; a < 3; a++)
            to[a * n + i] = v[i < (size_t)p->nv ? 3 * i + a : a];
    if (p->kind == PRIM_WARPED) {
        warp_of(p, &warp);
        memcpy(to + 3 * n, &warp, sizeof warp);
    }
    p->v = to;
}

/* Rays that leave the face begin by rounding beyond its plane, and no farther
 * from the box than the face's hit points, which have been moved onto the plane
 * along the normal, and drawn back: the error bound of a hit is below twice the
 * face's slack. */
double
rad_warped_depth(const struct rad_prim *p, const struct rad_probe *r,
                 double tmin, double s)
{
    const struct rad_warp *warp = rad_polygon_warp(p);
    const double *lo = warp->box.lo, *hi = warp->box.hi;
    double enter = -INFINITY, leave = INFINITY;
    double off = 2 * (warp->most + RAD_GEOM_BACK * (double)p->slack);
    bool here = s <= tmin;

    for (int i = 0; i < 3; i++) {
        double at = r->org[i] + tmin * r->dir[i];
        double a = (lo[i] - r->org[i]) * r->rcp[i];
        double b = (hi[i] - r->org[i]) * r->rcp[i];

        here &= (at >= lo[i] - off) & (at <= hi[i] + off);
        if (!(fabs(r->rcp[i]) < INFINITY))
            continue;
        enter = rad_most(enter, rad_least(a, b));
        leave = rad_least(leave, rad_most(a, b));
    }
    if (here)
        return NAN;
    s = s > enter ? s : enter; /* a NaN becomes enter */
    return s < leave ? s : leave;
}

/* The point is moved onto the plane along the normal, so that its error depends
 * on the face's own numbers and not on the ray's length. */
void
rad_plane_surface(const struct rad_prim *p, const struct rad_probe *r,
                  struct rad_hit *hit)
{
    rad_madd(hit->p, r->org, hit->t, r->dir);
    rad_madd(hit->p, hit->p, p->k[3] - rad_dot(p->k, hit->p), p->k);
    rad_copy(hit->n, p->k);
    hit->err =
        RAD_GEOM_ROUND * (fabs(hit->p[0]) + fabs(hit->p[1]) + fabs(hit->p[2])) +
        p->slack;
}
