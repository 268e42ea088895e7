/* prim.c - what all families of surfaces share */
#include "config.h"

#include "geom/prim.h"

#include "base/vec.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

bool
rad_prim_has(enum rad_otype type)
{
    switch (type) {
    case RAD_POLYGON:
    case RAD_SPHERE:
    case RAD_BUBBLE:
    case RAD_CONE:
    case RAD_CUP:
    case RAD_CYLINDER:
    case RAD_TUBE:
    case RAD_RING:
    case RAD_INSTANCE:
    case RAD_MESH:
        return true;
    default:
        return false;
    }
}

bool
rad_prim_bounded(const struct rad_prim *p)
{
    struct rad_box box;
    bool good = true;

    rad_prim_bounds(p, &box);
    for (int i = 0; i < 3; i++)
        good &=
            fabs(box.lo[i]) < RAD_GEOM_MOST && fabs(box.hi[i]) < RAD_GEOM_MOST;
    return good;
}

bool
rad_prim_make(struct rad_prim *p, const struct rad_object *o,
              struct rad_arena *arena, bool *nomem)
{
    bool good;

    memset(p, 0, sizeof *p);
    switch (o->type) {
    case RAD_POLYGON:
        good = rad_polygon_make(p, o);
        break;
    case RAD_SPHERE:
    case RAD_BUBBLE:
        good = rad_sphere_make(p, o);
        break;
    case RAD_CONE:
    case RAD_CUP:
    case RAD_CYLINDER:
    case RAD_TUBE:
        good = rad_cone_make(p, o, arena, nomem);
        break;
    case RAD_RING:
        good = rad_ring_make(p, o);
        break;
    default:
        return false;
    }
    /* float rounds to nearest: one step up keeps it a bound */
    p->slack = nextafterf(p->slack, INFINITY);
    return good && rad_prim_bounded(p);
}

void
rad_prim_bounds(const struct rad_prim *p, struct rad_box *box)
{
    switch (p->kind) {
    case PRIM_POLYGON:
    case PRIM_WARPED:
        rad_polygon_bounds(p, box);
        break;
    case PRIM_SPHERE:
        rad_sphere_bounds(p, box);
        break;
    case PRIM_CONE:
        rad_cone_bounds(p, box);
        break;
    case PRIM_PLACE:
        rad_place_bounds(p, box);
        break;
    default:
        rad_ring_bounds(p, box);
    }
    for (int i = 0; i < 3; i++) {
        box->lo[i] -= p->slack;
        box->hi[i] += p->slack;
    }
}

void
rad_prim_surface(const struct rad_prim *p, const struct rad_probe *r, double t,
                 struct rad_hit *hit)
{
    hit->t = t;
    hit->obj = p->obj;
    hit->uv[0] = hit->uv[1] = 0;
    hit->bent = false;
    hit->in = NULL;
    rad_hit_come(hit, r->dir);
    switch (p->kind) {
    case PRIM_SPHERE:
        rad_sphere_surface(p, r, hit);
        break;
    case PRIM_CONE:
        rad_cone_surface(p, r, hit);
        break;
    default:
        rad_plane_surface(p, r, hit);
    }
}
