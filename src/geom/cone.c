/* cone.c - cone, cup, cylinder and tube
 *
 * In the frame of the axis, with x and y across it and h along it, the surface
 * is x^2 + y^2 = (r0 + k h)^2, 0 <= h <= len, k = (r1 - r0)/len; a cylinder
 * has k = 0.  Let f be the origin's and d the direction's part across the axis,
 * w = r0 + k h_f the radius at the origin's height and m = k h_d its rate along
 * the ray.  Then
 *      A t^2 - 2 B t + C = 0,   A = d.d - m^2,  B = w m - f.d,
 *      C = f.f - w^2,   B^2 - A C = |w d - m f|^2 - (f x d)^2.
 * The right-hand form does not cancel where B^2 and A C are both huge (a thin
 * pipe seen from afar).  The roots are C/q and q/A with q = B +- sqrt(..), with
 * the sign that does not cancel.
 * A wide, low cone, such as a torus is made of, is tested first for whether the
 * ray is near the surface between the ends: most rays are only beyond them. */
#include "config.h"

#include "geom/prim.h"

#include "base/vec.h"

#include <math.h>

struct rad_cone {
    double p0[3];
    double x[3], y[3], axis[3]; /* orthonormal */
    double len, r0, r1, k;
    double upright;     /* 1 / sqrt(1 + k^2) */
    double mid[3];      /* the middle between p0 and the other end */
    double least, most; /* the lesser and the greater radius */
    bool low;           /* less high than wide */
};

bool
rad_cone_make(struct rad_prim *p, const struct rad_object *o,
              struct rad_arena *arena, bool *nomem)
{
    const double *a = o->reals;
    bool straight = o->type == RAD_CYLINDER || o->type == RAD_TUBE;
    struct rad_cone c, *keep;
    double big = 0;

    if (o->nreals < (straight ? 7 : 8) ||
        (!straight && !rad_object_radii_fit(o)))
        return false;
    rad_copy(c.p0, a);
    rad_sub(c.axis, a + 3, a);
    c.r0 = fabs(a[6]);
    c.r1 = straight ? c.r0 : fabs(a[7]);
    c.len = rad_normalize(c.axis);
    for (int i = 0; i < 6; i++)
        big += fabs(a[i]);
    big += c.r0 + c.r1;
    if (!(c.len > 0) || !(c.r0 + c.r1 > 0) || !(big < INFINITY))
        return false;
    rad_frame(c.x, c.y, c.axis);
    c.k = (c.r1 - c.r0) / c.len;
    c.upright = 1 / sqrt(1 + c.k * c.k);
    rad_madd(c.mid, c.p0, c.len / 2, c.axis);
    c.least = rad_least(c.r0, c.r1);
    c.most = rad_most(c.r0, c.r1);
    c.low = c.len < 2 * c.most;
    keep = rad_arena_dup(arena, &c, sizeof c);
    if (!keep) {
        *nomem = true;
        return false;
    }
    p->kind = PRIM_CONE;
    p->cone = keep;
    p->side = o->type == RAD_CONE || o->type == RAD_CYLINDER ? 1 : -1;
    if (a[6] < 0 || (!straight && a[7] < 0))
        p->side = (int8_t)-p->side; /* negative radii turn it inside out */
    p->slack = (float)(RAD_GEOM_ROUND * big * 2);
    return true;
}

void
rad_cone_bounds(const struct rad_prim *p, struct rad_box *box)
{
    const struct rad_cone *c = p->cone;

    for (int i = 0; i < 3; i++) {
        /* half-width of a unit circle across the axis, along axis i */
        double h = sqrt(c->x[i] * c->x[i] + c->y[i] * c->y[i]);
        double a = c->p0[i], b = a + c->len * c->axis[i];

        box->lo[i] = rad_least(a - c->r0 * h, b - c->r1 * h);
        box->hi[i] = rad_most(a + c->r0 * h, b + c->r1 * h);
    }
}

/* Is t within the ray's limits, and the point between the cone's ends? */
static bool
between(double t, double tmin, double tmax, double h, double rise,
        const struct rad_cone *c, double err)
{
    double at = h + t * rise;

    return t > tmin && t < tmax && at >= -err && at <= c->len + err;
}

/* Is the ray far from the surface wherever it is between the ends?  At t it is
 * half way between the ends, at far[] from the middle of the axis, and it stays
 * between them for `half` before and after.  In that stretch its distance from
 * the axis changes by at most half times the sine of its angle to the axis,
 * sqrt(1 - rise^2) <= 1 - rise^2 / 2.  Margins for rounding and for the bound
 * `err` are generous.  For a ray across the axis all values are infinite or
 * NaN, and the answer is no. */
static inline bool
is_missed(const struct rad_cone *c, const struct rad_probe *r, double tmin,
          double tmax, double err)
{
    double o[3], h, rise = rad_dot(r->dir, c->axis), steep = fabs(rise);
    double half = c->len / 2 + 4 * err, t, far[3], rho2, aside, in;

    rad_sub(o, r->org, c->mid);
    h = rad_dot(o, c->axis);
    t = copysign(1, rise) * -h; /* not divided by steep yet */
    if (t + half < tmin * steep || t - half > tmax * steep)
        return true;
    t /= steep;
    half /= steep;
    rad_madd(far, o, t, r->dir);
    rho2 = rad_dot(far, far);
    aside = half * (1 - rise * rise / 2) +
            4 * (RAD_GEOM_ROUND * (fabs(t) + half) + err);
    in = c->least - aside;
    if (in > 0 && rho2 < in * in)
        return true;
    aside += c->most;
    return rho2 > aside * aside;
}

bool
rad_cone_hit(const struct rad_prim *p, const struct rad_probe *r, double tmin,
             double tmax, double t[2])
{
    const struct rad_cone *c = p->cone;
    double err = RAD_GEOM_ROUND * r->size + p->slack, o[3];

    if (c->low && is_missed(c, r, tmin, tmax, err))
        return false;
    rad_sub(o, r->org, c->p0);
    double fx = rad_dot(o, c->x), fy = rad_dot(o, c->y);
    double dx = rad_dot(r->dir, c->x), dy = rad_dot(r->dir, c->y);
    double h = rad_dot(o, c->axis), rise = rad_dot(r->dir, c->axis);
    double w = c->r0 + c->k * h, m = c->k * rise;
    double ex = w * dx - m * fx, ey = w * dy - m * fy;
    double cross = fx * dy - fy * dx;
    double disc = ex * ex + ey * ey - cross * cross;

    if (!(disc >= 0))
        return false;
    double B = w * m - (fx * dx + fy * dy);
    double q = B + copysign(sqrt(disc), B);
    double t0 = (fx * fx + fy * fy - w * w) / q;
    double t1 = q / (dx * dx + dy * dy - m * m);

    /* either may be infinite or NaN: the comparisons fail then */
    double near = t0 < t1 ? t0 : t1, far = t0 < t1 ? t1 : t0;

    if (!between(near, tmin, tmax, h, rise, c, err)) {
        t[0] = far;
        t[1] = INFINITY;
        return between(far, tmin, tmax, h, rise, c, err);
    }
    t[0] = near;
    t[1] = between(far, near, tmax, h, rise, c, err) ? far : INFINITY;
    return true;
}

void
rad_cone_surface(const struct rad_prim *p, const struct rad_probe *r,
                 struct rad_hit *hit)
{
    const struct rad_cone *c = p->cone;
    double d[3], radial[3], h;

    rad_madd(hit->p, r->org, hit->t, r->dir);
    rad_sub(d, hit->p, c->p0);
    h = rad_least(rad_most(rad_dot(d, c->axis), 0), c->len);
    rad_madd(radial, d, -rad_dot(d, c->axis), c->axis);
    if (!(rad_normalize(radial) > 0))
        rad_copy(radial, c->x); /* at the apex any direction serves */
    rad_madd(hit->p, c->p0, h, c->axis);
    rad_madd(hit->p, hit->p, rad_most(c->r0 + c->k * h, 0), radial);
    for (int i = 0; i < 3; i++)
        hit->n[i] = p->side * (radial[i] - c->k * c->axis[i]) * c->upright;
    hit->err = p->slack;
}
