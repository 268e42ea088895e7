/* sphere.c - sphere and bubble
 *
 * The quadratic is solved as in Haines, Guenther & Akenine-Moller 2019
 * (Precision improvements for ray/sphere intersection, Ray Tracing Gems,
 * ch. 7).  The discriminant comes from the ray's distance to the centre, which
 * does not cancel for small or distant spheres; the roots are c/q and q, which
 * do not cancel for huge ones.  The point is then moved onto the sphere, so its
 * error is that of centre and radius, however long the ray. */
#include "config.h"

#include "geom/prim.h"

#include "base/vec.h"

#include <math.h>

bool
rad_sphere_make(struct rad_prim *p, const struct rad_object *o)
{
    double r, big = 0;

    if (o->nreals < 4)
        return false;
    r = fabs(o->reals[3]);
    if (!(r > 0 && r < INFINITY))
        return false;
    for (int i = 0; i < 3; i++) {
        p->k[i] = o->reals[i];
        big += fabs(p->k[i]);
    }
    if (!(big < INFINITY))
        return false;
    p->k[3] = r;
    p->kind = PRIM_SPHERE;
    /* a negative radius turns the surface inside out */
    p->side = (o->type == RAD_BUBBLE) == (o->reals[3] < 0) ? 1 : -1;
    p->slack = (float)(RAD_GEOM_ROUND * (big + r));
    return true;
}

void
rad_sphere_bounds(const struct rad_prim *p, struct rad_box *box)
{
    for (int i = 0; i < 3; i++) {
        box->lo[i] = p->k[i] - p->k[3];
        box->hi[i] = p->k[i] + p->k[3];
    }
}

bool
rad_sphere_hit(const struct rad_prim *p, const struct rad_probe *r, double tmin,
               double tmax, double t[2])
{
    double f[3], foot[3], b, disc, q, c, t0, t1;

    rad_sub(f, r->org, p->k);
    b = -rad_dot(f, r->dir);
    rad_madd(foot, f, b, r->dir);
    disc = p->k[3] * p->k[3] - rad_dot(foot, foot);
    if (!(disc >= 0))
        return false;
    q = b + copysign(sqrt(disc), b);
    c = rad_dot(f, f) - p->k[3] * p->k[3];
    t0 = q != 0 ? c / q : 0;
    t1 = q;
    *t = rad_least(t0, t1);
    t[1] = rad_most(t0, t1);
    if (!(*t > tmin))
        *t = t[1];
    if (!(t[1] > *t && t[1] < tmax))
        t[1] = INFINITY;
    return *t > tmin && *t < tmax;
}

void
rad_sphere_surface(const struct rad_prim *p, const struct rad_probe *r,
                   struct rad_hit *hit)
{
    rad_madd(hit->p, r->org, hit->t, r->dir);
    rad_sub(hit->n, hit->p, p->k);
    rad_normalize(hit->n);
    rad_madd(hit->p, p->k, p->k[3], hit->n);
    rad_scale(hit->n, p->side, hit->n);
    hit->err = p->slack;
}
