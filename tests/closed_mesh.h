/* closed_mesh.h - a closed mesh about a point, and places on its edges
 *
 * A grid of longitude and latitude with every vertex pushed about, closed at
 * the poles: faces are triangles and (warped) quadrilaterals. */
#ifndef RADD_TESTS_CLOSED_MESH_H
#define RADD_TESTS_CLOSED_MESH_H

#include "base/rng.h"
#include "base/vec.h"

enum { MESH_NU = 24, MESH_NV = 16 };

static inline void
mesh_vertex(int u, int v, double size, const double c[3], double p[3])
{
    uint64_t key = rad_key_branch(5, (uint64_t)(v * MESH_NU + u % MESH_NU));
    double r = size, phi = 6.283185307179586 * (u % MESH_NU) / MESH_NU;
    double theta = 3.141592653589793 * v / MESH_NV;

    if (v > 0 && v < MESH_NV)
        r *= .8 + .4 * rad_rand(key, 0);
    p[0] = c[0] + (v % MESH_NV ? r * sin(theta) * cos(phi) : 0);
    p[1] = c[1] + (v % MESH_NV ? r * sin(theta) * sin(phi) : 0);
    p[2] = c[2] + r * cos(theta);
}

/* The faces of the cell between u and u + 1, v and v + 1: one of four corners,
 * or two of three.  Returns their number. */
static inline int
mesh_faces(int u, int v, double size, const double c[3], double face[2][12],
           int corners[2])
{
    double q[4][3];

    mesh_vertex(u, v, size, c, q[0]);
    mesh_vertex(u, v + 1, size, c, q[1]);
    mesh_vertex(u + 1, v + 1, size, c, q[2]);
    mesh_vertex(u + 1, v, size, c, q[3]);
    corners[0] = u % 3 == 0 ? 4 : 3;
    corners[1] = 3;
    for (int i = 0; i < 4; i++)
        rad_copy(face[0] + 3 * i, q[i]);
    rad_copy(face[1], q[0]);
    rad_copy(face[1] + 3, q[2]);
    rad_copy(face[1] + 6, q[3]);
    return corners[0] == 4 ? 1 : 2;
}

/* A vertex, or a point on an edge as near as double allows. */
static inline void
mesh_target(uint64_t key, double size, const double c[3], double p[3])
{
    int u = (int)(MESH_NU * rad_rand(key, 0));
    int v = (int)(MESH_NV * rad_rand(key, 1));
    double s = rad_rand(key, 2), a[3], b[3];

    mesh_vertex(u, v, size, c, a);
    mesh_vertex(rad_rand(key, 3) < .5 ? u : u + 1, v + 1, size, c, b);
    if (s < .2)
        s = 0;
    for (int i = 0; i < 3; i++)
        p[i] = a[i] + s * (b[i] - a[i]);
}

/* A ray from within, toward such a place. */
static inline void
mesh_ray(uint64_t key, double size, const double c[3], double org[3],
         double dir[3])
{
    for (uint32_t a = 0; a < 3; a++)
        org[a] = c[a] + size * (.4 * rad_rand(key, 4 + a) - .2);
    mesh_target(key, size, c, dir);
    rad_sub(dir, dir, org);
    rad_normalize(dir);
}

#endif
