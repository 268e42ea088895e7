/* shape.c - the shapes of light sources, from the surfaces of a scene
 *
 * An undivided polygon is sampled at the mean of its corners, as in rpict; if
 * that point lies outside, at its centroid or in its largest triangle.
 * The half-axes are rpict's:
 *   quadrilateral       along the edges at its first corner
 *   triangle            of a square about the centroid that touches the nearest
 *                       edge, parallel to that edge
 *   other polygon, ring, distant source    of a square of equal area
 *   sphere, cylinder    of a cube, or box, within it  */
#include "config.h"

#include "light/sample/polytree.h"
#include "light/sample/sample.h"
#include "arith/elementary.h"
#include "base/vec.h"

/* How far a quadrilateral's corners may be off a parallelogram's, relative to
 * its longer diagonal: allows for coordinates of single precision in a scene's
 * text. */
#define PARALLEL 1e-6

/* Half the side of the cube that stands for the unit sphere, and of the square
 * that stands for the unit circle of a cylinder's section; as in rpict. */
#define SPHERE_BOX   0.7236
#define CYLINDER_BOX 0.8559

/* A unit vector u perpendicular to n: the cross product of n with the last
 * coordinate axis that is not nearly parallel to it. */
static void
perpendicular(double u[3], const double n[3])
{
    double e[3] = { 0, 0, 0 };
    int i = 2;

    while (i > 0 && !(fabs(n[i]) < .6))
        i--;
    e[i] = 1;
    rad_cross(u, e, n);
    rad_normalize(u);
}

/* Half-axes of a square of this area, perpendicular to n. */
static void
square_axes(struct rad_source *src, const double n[3], double area)
{
    perpendicular(src->axis[0], n);
    rad_scale(src->axis[0], sqrt(area) / 2, src->axis[0]);
    rad_cross(src->axis[1], n, src->axis[0]);
}

/* The unit normal of a polygon, by the sum of its triangles' cross products
 * (Newell); returns the polygon's area. */
static double
polygon_normal(const double *v, int n, double normal[3])
{
    double a[3], b[3], c[3];

    normal[0] = normal[1] = normal[2] = 0;
    for (int i = 1; i + 1 < n; i++) {
        rad_sub(a, v + 3 * i, v);
        rad_sub(b, v + 3 * (i + 1), v);
        rad_cross(c, a, b);
        rad_madd(normal, normal, 1, c);
    }
    return rad_normalize(normal) / 2;
}

static bool
is_parallelogram(const double *v)
{
    double d[3], diag = fmax(rad_dist2(v, v + 6), rad_dist2(v + 3, v + 9));

    for (int k = 0; k < 3; k++)
        d[k] = v[k] - v[3 + k] + v[6 + k] - v[9 + k];
    return rad_dot(d, d) <= PARALLEL * PARALLEL * diag;
}

static void
mean_corner(const double *v, int n, double c[3])
{
    for (int k = 0; k < 3; k++) {
        c[k] = 0;
        for (int i = 0; i < n; i++)
            c[k] += v[3 * i + k];
        c[k] /= n;
    }
}

/* Half-axes along the edges at a quadrilateral's first corner. */
static void
edge_axes(struct rad_source *src, const double *v)
{
    for (int k = 0; k < 3; k++) {
        src->axis[0][k] = (v[3 + k] - v[k]) / 2;
        src->axis[1][k] = (v[9 + k] - v[k]) / 2;
    }
}

/* Half-axes of a triangle: the edge nearest to the centroid is the longest one,
 * at a third of the height over it. */
static void
triangle_axes(struct rad_source *src, const double *v)
{
    double edge[3], longest2;

    rad_sub(edge, v, v + 6);
    longest2 = rad_dot(edge, edge);
    for (int i = 0; i < 6; i += 3) {
        double l2 = rad_dist2(v + i, v + i + 3);

        if (l2 > longest2) {
            longest2 = l2;
            rad_sub(edge, v + i + 3, v + i);
        }
    }
    /* height = 2 area / longest */
    rad_scale(src->axis[0], 2 * src->size / (3 * longest2), edge);
    rad_cross(src->axis[1], src->normal, src->axis[0]);
}

/* Set the patch that stands for the whole polygon; false: memory is out. */
static bool
set_root(struct rad_source *src, const double *v, int n,
         struct rad_arena *arena)
{
    if (n == 4 && is_parallelogram(v)) {
        for (int k = 0; k < 3; k++) {
            src->root.a[k] = src->axis[0][k] / sqrt(3);
            src->root.b[k] = src->axis[1][k] / sqrt(3);
        }
        rad_copy(src->root.c, src->centre);
        rad_copy(src->root.aim, src->centre);
        src->root.area = src->size;
        return true;
    }
    src->tree = rad_polytree_new(v, n, src->normal, arena);
    if (!src->tree)
        return false;
    src->root = src->tree->m;
    /* as in rpict: aim at the mean of the corners, if that is inside */
    if (rad_polytree_has(src->tree, src->centre, src->normal))
        rad_copy(src->root.aim, src->centre);
    return true;
}

static int
polygon_shape(struct rad_source *src, const struct rad_object *o,
              struct rad_arena *arena)
{
    const double *v = o->reals;
    int n = o->nreals / 3;

    /* a polygon may repeat its first corner at its end */
    while (n > 3 && rad_dist2(v, v + 3 * (n - 1)) == 0)
        n--;
    src->flags |= RAD_LIGHT_FLAT;
    src->size = polygon_normal(v, n, src->normal);
    if (!(src->size > 0 && src->size < INFINITY))
        return 1;
    mean_corner(v, n, src->centre);
    if (n == 4)
        edge_axes(src, v);
    else if (n == 3)
        triangle_axes(src, v);
    else
        square_axes(src, src->normal, src->size);
    if (!set_root(src, v, n, arena))
        return RAD_ENOMEM;
    rad_copy(src->axis[2], src->normal);
    for (int i = 0; i < n; i++)
        src->radius =
            fmax(src->radius, sqrt(rad_dist2(v + 3 * i, src->centre)));
    return src->root.area > 0 ? 0 : 1;
}

static int
ring_shape(struct rad_source *src, const struct rad_object *o)
{
    const double *a = o->reals;
    double r2;

    src->flags |= RAD_LIGHT_FLAT;
    rad_copy(src->centre, a);
    rad_copy(src->normal, a + 3);
    src->r0 = fmin(fabs(a[6]), fabs(a[7]));
    src->r1 = fmax(fabs(a[6]), fabs(a[7]));
    r2 = src->r1 * src->r1 + src->r0 * src->r0;
    src->size = M_PI * (src->r1 * src->r1 - src->r0 * src->r0);
    if (!rad_object_radii_fit(o) || !(rad_normalize(src->normal) > 0) ||
        !(src->size > 0 && src->size < INFINITY))
        return 1;
    src->radius = src->r1;
    square_axes(src, src->normal, src->size);
    rad_copy(src->axis[2], src->normal);
    rad_copy(src->root.c, src->centre);
    rad_copy(src->root.aim, src->centre);
    if (src->r0 > 0) /* aim beside the hole */
        rad_madd(src->root.aim, src->centre, sqrt(2 * r2 / src->size),
                 src->axis[0]);
    src->root.area = src->size;
    /* <x^2> = <y^2> = (r0^2 + r1^2) / 4 */
    rad_scale(src->root.a, sqrt(r2 / src->size), src->axis[0]);
    rad_scale(src->root.b, sqrt(r2 / src->size), src->axis[1]);
    return 0;
}

static int
sphere_shape(struct rad_source *src, const struct rad_object *o)
{
    rad_copy(src->centre, o->reals);
    src->radius = src->r1 = fabs(o->reals[3]);
    src->size = M_PI * src->r1 * src->r1;
    for (int k = 0; k < 3; k++)
        src->axis[k][k] = SPHERE_BOX * src->r1;
    return src->size > 0 && src->size < INFINITY ? 0 : 1;
}

static int
cylinder_shape(struct rad_source *src, const struct rad_object *o)
{
    const double *a = o->reals;
    double axis[3], len;

    rad_sub(axis, a + 3, a);
    len = rad_normalize(axis);
    src->r1 = fabs(a[6]);
    src->size = 2 * src->r1 * len;
    if (!(src->size > 0 && src->size < INFINITY))
        return 1;
    for (int k = 0; k < 3; k++)
        src->centre[k] = (a[k] + a[3 + k]) / 2;
    src->radius = sqrt(len * len / 4 + src->r1 * src->r1);
    rad_scale(src->axis[0], len / 2, axis);
    perpendicular(src->axis[2], axis);
    rad_scale(src->axis[2], CYLINDER_BOX * src->r1, src->axis[2]);
    rad_cross(src->axis[1], src->axis[2], axis);
    rad_copy(src->root.c, src->centre);
    rad_copy(src->root.aim, src->centre);
    rad_scale(src->root.a, 1 / sqrt(3), src->axis[0]);
    src->root.area = src->size;
    return 0;
}

static int
distant_shape(struct rad_source *src, const struct rad_object *o)
{
    src->flags |= RAD_LIGHT_DISTANT;
    rad_copy(src->centre, o->reals);
    if (!(rad_normalize(src->centre) > 0) || !(o->reals[3] > 0))
        return 1;
    /* size is the solid angle 2 pi (1 - cos a), a half the angle, as
     * 4 pi sin^2(a / 2), which does not cancel for a small a */
    src->radius = 2 * rad_sin(M_PI / 720 * o->reals[3]);
    src->size = M_PI * src->radius * src->radius;
    square_axes(src, src->centre, src->size);
    return 0;
}

int
rad_light_shape(struct rad_source *src, const struct rad_object *o,
                struct rad_arena *arena)
{
    src->shape = rad_object_shape(o);
    switch (src->shape) {
    case RAD_POLYGON:
        return polygon_shape(src, o, arena);
    case RAD_RING:
        return ring_shape(src, o);
    case RAD_SPHERE:
        return sphere_shape(src, o);
    case RAD_CYLINDER:
        return cylinder_shape(src, o);
    case RAD_SOURCE:
        return distant_shape(src, o);
    default:
        return RAD_EDATA;
    }
}
