/* meshed.c - see meshed.h */
#include "config.h"

#include "geom/meshed.h"

#include "base/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct corners {
    double v[3][3];
};

static void
get_corners(struct corners *c, const struct rad_meshed *m, uint32_t i)
{
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            c->v[k][a] = m->xyz[m->tris[i].v[k]][a];
}

/* Bounds of a triangle, with a margin: points computed on it along the normal
 * may lie a little beyond its vertices. */
static void
triangle_bounds(const void *arg, uint32_t i, struct rad_box *box)
{
    struct corners c;

    get_corners(&c, arg, i);
    for (int a = 0; a < 3; a++) {
        box->lo[a] = rad_least(c.v[0][a], rad_least(c.v[1][a], c.v[2][a]));
        box->hi[a] = rad_most(c.v[0][a], rad_most(c.v[1][a], c.v[2][a]));
        box->lo[a] -= 8 * RAD_GEOM_ROUND * 0x1p31;
        box->hi[a] += 8 * RAD_GEOM_ROUND * 0x1p31;
    }
}

/* Put the triangles in the tree's order. */
static void
order_triangles(struct rad_meshed *m, const struct rad_mesh *mesh,
                const uint32_t *order)
{
    for (uint32_t i = 0; i < mesh->ntris; i++) {
        memcpy(m->tris[i].v, mesh->tris[order[i]].v, sizeof m->tris[i].v);
        m->tris[i].number = order[i];
    }
}

static void
set_faces(struct rad_meshed *m, const uint8_t *surf)
{
    for (uint32_t i = 0; i < m->mesh->nfaces; i++) {
        int32_t obj = m->mesh->faces[i];

        m->surf[i] = obj == RAD_VOID ? RAD_SURF_NOMATERIAL : surf[obj];
    }
}

int
rad_meshed_make(struct rad_set *set, const struct rad_part *part,
                const uint8_t *surf, uint32_t rays, struct rad_error *err)
{
    const struct rad_mesh *mesh = part->mesh;
    struct rad_meshed *m = calloc(1, sizeof *m);
    struct rad_bvh_items items = { triangle_bounds, m, mesh->ntris, rays };
    uint32_t *order = malloc(((size_t)mesh->ntris + 1) * sizeof *order);
    int rc = m && order ? 0 : rad_fail_memory(err);

    set->meshed = m;
    set->nprims = mesh->ntris;
    set->copies = 1;
    if (!rc) {
        m->mesh = mesh;
        m->xyz = (const int32_t(*)[3])mesh->xyz;
        m->tris = malloc(((size_t)mesh->ntris + 1) * sizeof *m->tris);
        m->surf = malloc((size_t)mesh->nfaces + 1);
        if (!m->tris || !m->surf)
            rc = rad_fail_memory(err);
    }
    if (!rc) {
        for (uint32_t i = 0; i < mesh->ntris; i++)
            order[i] = i;
        order_triangles(m, mesh, order);
        rc = rad_bvh_build(&set->bvh, &items, order, err);
    }
    if (!rc) {
        order_triangles(m, mesh, order);
        set_faces(m, surf);
    }
    free(order);
    return rc;
}

void
rad_meshed_free(struct rad_meshed *m)
{
    if (!m)
        return;
    free(m->tris);
    free(m->surf);
    free(m);
}

/* The shares w of the three corners in p, a point of the triangle; false: the
 * triangle has no area. */
static bool
shares(double w[3], const struct corners *c, const double p[3])
{
    double a[3], b[3], n[3], d[3], part[3], area;

    rad_sub(a, c->v[1], c->v[0]);
    rad_sub(b, c->v[2], c->v[0]);
    rad_cross(n, a, b);
    area = rad_dot(n, n);
    if (!(area > 0))
        return false;
    rad_sub(d, p, c->v[0]);
    rad_cross(part, d, b);
    w[1] = rad_dot(part, n) / area;
    rad_cross(part, a, d);
    w[2] = rad_dot(part, n) / area;
    w[0] = 1 - w[1] - w[2];
    return true;
}

/* Interpolate the corners' normals at a hit, and set hit->bend; not if a corner
 * has no normal. */
static void
bend(const struct rad_mesh *mesh, const uint32_t v[3], const double w[3],
     struct rad_hit *hit)
{
    double sum[3] = { 0, 0, 0 }, n[3];

    if (!mesh->normals)
        return;
    for (int k = 0; k < 3; k++) {
        uint32_t code = mesh->normals[v[k]];

        if (code == 0)
            return;
        rad_mesh_normal(n, code);
        rad_madd(sum, sum, w[k], n);
    }
    hit->bent = rad_normalize(sum) > 0;
    if (hit->bent)
        rad_sub(hit->bend, sum, hit->n);
}

static void
coordinates(const struct rad_mesh *mesh, const uint32_t v[3], const double w[3],
            struct rad_hit *hit)
{
    double uv[2] = { 0, 0 };

    if (!mesh->uv)
        return;
    for (int k = 0; k < 3; k++) {
        const uint32_t *at = mesh->uv[v[k]];

        if (at[0] == 0)
            return;
        for (int i = 0; i < 2; i++)
            uv[i] += w[k] * (mesh->uv0[i] + (mesh->uv1[i] - mesh->uv0[i]) *
                                                (at[i] + .5) * 0x1p-32);
    }
    hit->uv[0] = uv[0];
    hit->uv[1] = uv[1];
}

void
rad_meshed_met(const struct rad_walk *w, uint32_t i, double t,
               struct rad_met *met)
{
    const struct rad_meshed *m = w->meshed;
    const struct rad_mesh_tri *tri = &m->mesh->tris[m->tris[i].number];
    struct rad_hit *hit = &met->hit;
    struct corners c;
    double a[3], b[3], share[3];

    get_corners(&c, m, i);
    met->number = m->tris[i].number;
    met->surf = m->surf[tri->face];
    met->obj = hit->obj = m->mesh->faces[tri->face];
    hit->t = t;
    hit->uv[0] = hit->uv[1] = 0;
    hit->bent = false;
    hit->in = NULL;
    rad_hit_come(hit, w->probe.dir);
    rad_sub(a, c.v[1], c.v[0]);
    rad_sub(b, c.v[2], c.v[0]);
    rad_cross(hit->n, a, b);
    rad_normalize(hit->n);
    rad_madd(hit->p, w->probe.org, t, w->probe.dir);
    rad_sub(a, c.v[0], hit->p);
    rad_madd(hit->p, hit->p, rad_dot(a, hit->n), hit->n);
    hit->err = 0;
    for (int k = 0; k < 3; k++)
        hit->err += fabs(hit->p[k]) + fabs(c.v[0][k]);
    hit->err *= RAD_GEOM_ROUND;
    if (shares(share, &c, hit->p)) {
        bend(m->mesh, tri->v, share, hit);
        coordinates(m->mesh, tri->v, share, hit);
    }
}
