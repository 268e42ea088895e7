/* ring.c - flat ring or disk
 *
 * The point where the ray meets the plane must lie between the radii.  These
 * are widened by the point's error, so that a ring that closes a cylinder
 * leaves no gap along the rim. */
#include "config.h"

#include "geom/prim.h"

#include "base/vec.h"

#include <math.h>

bool
rad_ring_make(struct rad_prim *p, const struct rad_object *o)
{
    const double *a = o->reals; /* centre, normal, radii */
    double r, big = 0;

    if (o->nreals < 8)
        return false;
    r = rad_most(a[6], a[7]);
    rad_copy(p->k, a + 3);
    if (!(r > 0 && r < INFINITY) || !(a[6] != a[7]) ||
        !rad_object_radii_fit(o) || !(rad_normalize(p->k) > 0))
        return false;
    for (int i = 0; i < 3; i++)
        big += fabs(a[i]);
    if (!(big < INFINITY))
        return false;
    p->k[3] = rad_dot(p->k, a);
    p->kind = PRIM_RING;
    p->v = a;
    p->slack = (float)(RAD_GEOM_ROUND * (big + r));
    return true;
}

void
rad_ring_bounds(const struct rad_prim *p, struct rad_box *box)
{
    double r = rad_most(p->v[6], p->v[7]);

    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        /* not r sqrt(1 - n_i^2), which cancels if n is near this axis */
        double h = r * sqrt(p->k[j] * p->k[j] + p->k[k] * p->k[k]);

        box->lo[i] = p->v[i] - h;
        box->hi[i] = p->v[i] + h;
    }
}

bool
rad_ring_hit(const struct rad_prim *p, const struct rad_probe *r, double tmin,
             double tmax, double *t)
{
    double den = rad_dot(p->k, r->dir);
    double d[3], rho2, err, least, most;

    *t = (p->k[3] - rad_dot(p->k, r->org)) / den;
    if (!(*t > tmin && *t < tmax))
        return false;
    for (int i = 0; i < 3; i++)
        d[i] = r->org[i] - p->v[i] + *t * r->dir[i];
    rho2 = rad_dot(d, d);
    err = RAD_GEOM_ROUND * (r->size + *t) + p->slack;
    least = rad_most(rad_least(p->v[6], p->v[7]) - err, 0);
    most = rad_most(p->v[6], p->v[7]) + err;
    return rho2 <= most * most && rho2 >= least * least;
}
