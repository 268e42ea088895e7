/* meshed.h - triangles of meshes (inside geom/ only)
 *
 * A mesh is the only surface of its set (place.h).  Its triangles keep their
 * integers, as in its file. */
#ifndef RAD_GEOM_MESHED_H
#define RAD_GEOM_MESHED_H

#include "geom/place.h"
#include "scene/meshfile.h"

/* A triangle of a mesh, in the tree's order. */
struct rad_tri {
    uint32_t v[3];
    uint32_t number; /* in the mesh */
};

struct rad_meshed {
    const struct rad_mesh *mesh;
    const int32_t (*xyz)[3]; /* the mesh's vertices */
    struct rad_tri *tris;
    uint8_t *surf; /* RAD_SURF_ bits by face */
};

/* Build a mesh's tree; surf holds RAD_SURF_ bits by object of the scene; rays:
 * see rad_geom_new().
 * RAD_ENOMEM, RAD_EDATA. */
int rad_meshed_make(struct rad_set *set, const struct rad_part *part,
                    const uint8_t *surf, uint32_t rays, struct rad_error *err);

void rad_meshed_free(struct rad_meshed *m);

/* Fill *met for a hit at t on triangle i, in the mesh's coordinates. */
void rad_meshed_met(const struct rad_walk *w, uint32_t i, double t,
                    struct rad_met *met);

/* Does the ray meet the triangle?  Edges and vertices that triangles share are
 * handled as in rad_quad_inside(); the distance lies between those of the
 * vertices. */
static inline __attribute__((always_inline)) bool
rad_tri_hit(const struct rad_meshed *m, uint32_t i, const struct rad_probe *r,
            double tmin, double tmax, double *t)
{
    const uint32_t *v = m->tris[i].v;
    const int32_t *a = m->xyz[v[0]], *b = m->xyz[v[1]], *c = m->xyz[v[2]];
    int kx = r->kx, ky = r->ky, kz = r->kz;
    double ox = r->org[kx], oy = r->org[ky], oz = r->org[kz];
    double az = a[kz] - oz, bz = b[kz] - oz, cz = c[kz] - oz;
    double ax = a[kx] - ox - r->sx * az, ay = a[ky] - oy - r->sy * az;
    double bx = b[kx] - ox - r->sx * bz, by = b[ky] - oy - r->sy * bz;
    double cx = c[kx] - ox - r->sx * cz, cy = c[ky] - oy - r->sy * cz;
    /* each is exactly the negative of the neighbour's value for that edge */
    double e = cx * by - cy * bx;
    double f = ax * cy - ay * cx;
    double g = bx * ay - by * ax;
    double det = e + f + g, s;

    if (((e < 0) | (f < 0) | (g < 0)) & ((e > 0) | (f > 0) | (g > 0)))
        return false;
    if (det == 0) /* seen edge-on */
        return false;
    s = (e * az + f * bz + g * cz) / det * r->rcp[kz];
    *t = s;
    return s > tmin && s < tmax;
}

#endif
