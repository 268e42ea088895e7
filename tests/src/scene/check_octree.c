/* check_octree.c - tests of octree and overlap of src/scene
 *
 * The oracle: points drawn on a surface lie in cubes that name it, however
 * surfaces and scenes are shaped, placed and scaled. */
#include "config.h"

#include "base/rng.h"
#include "base/vec.h"
#include "scene/octree.h"
#include "scene/overlap.h"
#include "tests/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

struct draw {
    uint64_t key;
    uint32_t dim;
};

static double
draw(struct draw *d)
{
    return rad_rand(d->key, d->dim++);
}

static int
add(struct rad_scene *s, enum rad_otype type, int n, const double *reals)
{
    struct rad_object o = { .type = type,
                            .modifier = RAD_VOID,
                            .file = -1,
                            .name = "x",
                            .nreals = n,
                            .reals = reals };

    return rad_scene_add(s, &o, NULL);
}

static void
draw_point(struct draw *d, double p[3], double spread)
{
    for (int i = 0; i < 3; i++)
        p[i] = spread * (draw(d) - .5);
}

/* A flat star-shaped polygon of n vertices in a random plane. */
static int
draw_polygon(struct draw *d, double *v, int n)
{
    double c[3], axis[3], x[3], y[3], r = .01 + pow(draw(d), 4);

    draw_point(d, c, 4);
    draw_point(d, axis, 1);
    if (draw(d) < .3)
        axis[0] = axis[1] = 0; /* along the cubes' faces */
    rad_normalize(axis);
    rad_frame(x, y, axis);
    for (int i = 0; i < n; i++) {
        double a = 2 * 3.14159265358979 * i / n, b = r * (.2 + draw(d));

        for (int k = 0; k < 3; k++)
            v[3 * i + k] = c[k] + b * (cos(a) * x[k] + sin(a) * y[k]);
    }
    return 3 * n;
}

static void
draw_surface(struct draw *d, struct rad_scene *s, double scale, double offset)
{
    static const enum rad_otype types[] = { RAD_POLYGON, RAD_SPHERE,
                                            RAD_CONE,    RAD_CYLINDER,
                                            RAD_RING,    RAD_POLYGON };
    enum rad_otype type = types[(int)(draw(d) * N_ELEM(types))];
    double v[120];
    int n, points;

    if (type == RAD_POLYGON) {
        n = draw_polygon(d, v, 3 + (int)(draw(d) * draw(d) * 36));
        points = n;
    } else {
        draw_point(d, v, 4);
        draw_point(d, v + 3, type == RAD_RING ? 1 : 4);
        v[6] = pow(draw(d), 3);
        v[7] = pow(draw(d), 3);
        if (type == RAD_SPHERE)
            v[3] = v[6];
        n = type == RAD_SPHERE ? 4 : type == RAD_CYLINDER ? 7 : 8;
        points = type == RAD_SPHERE || type == RAD_RING ? 3 : 6;
    }
    for (int i = 0; i < n; i++)
        if (type != RAD_RING || i < 3 || i > 5)
            v[i] = scale * v[i] + (i < points ? offset : 0);
    ck_assert_int_ge(add(s, type, n, v), 0);
}

/* A point on the surface, to rounding. */
static void
point_on(struct draw *d, const struct rad_object *o, double p[3])
{
    const double *a = o->reals;
    double x[3], y[3], axis[3], t = draw(d), phi = 6.283185307179586 * draw(d);

    if (o->type == RAD_POLYGON) { /* on a spoke: it is star-shaped */
        int n = o->nreals / 3, i = (int)(draw(d) * n), j = (i + 1) % n;
        double u = draw(d), c[3] = { 0, 0, 0 };

        for (int k = 0; k < o->nreals; k++)
            c[k % 3] += a[k] / n;
        for (int k = 0; k < 3; k++)
            p[k] = n > 3
                       ? a[3 * i + k] + u * (a[3 * j + k] - a[3 * i + k])
                       : c[k] + t * (a[3 * i + k] +
                                     u * (a[3 * j + k] - a[3 * i + k]) - c[k]);
        return;
    }
    if (o->type == RAD_SPHERE) {
        draw_point(d, axis, 1);
        rad_normalize(axis);
        for (int k = 0; k < 3; k++)
            p[k] = a[k] + a[3] * axis[k];
        return;
    }
    double len = 0, r1 = o->nreals == 7 ? a[6] : a[7];
    double r = a[6] + t * (r1 - a[6]);

    if (o->type == RAD_RING) {
        rad_copy(axis, a + 3);
        rad_normalize(axis);
    } else {
        rad_sub(axis, a + 3, a);
        len = rad_normalize(axis);
    }
    rad_frame(x, y, axis);
    for (int k = 0; k < 3; k++)
        p[k] =
            a[k] + t * len * axis[k] + r * (cos(phi) * x[k] + sin(phi) * y[k]);
}

static bool
in_set(const struct rad_octree *t, int32_t node, int32_t obj)
{
    int32_t n;
    const int32_t *set = rad_octree_set(t, node, &n);

    for (int32_t i = 0; i < n; i++)
        if (set[i] == obj)
            return true;
    return false;
}

/* Does some cube that has p, or misses it by rounding, name the object? */
static bool
found(const struct rad_octree *t, int32_t node, const double org[3],
      double size, const double p[3], double slack, int32_t obj)
{
    for (int i = 0; i < 3; i++)
        if (p[i] < org[i] - slack || p[i] > org[i] + size + slack)
            return false;
    if (node == RAD_OCTREE_EMPTY)
        return false;
    if (node < 0)
        return in_set(t, node, obj);
    for (int k = 0; k < 8; k++) {
        double at[3];

        for (int i = 0; i < 3; i++)
            at[i] = org[i] + (k >> i & 1 ? size / 2 : 0);
        if (found(t, t->kids[node][k], at, size / 2, p, slack, obj))
            return true;
    }
    return false;
}

static const struct {
    double scale, offset;
    int objects;
} scenes[] = {
    { 1, 0, 1 },       { 1, 0, 7 },     { 1, 0, 300 },
    { 1e-6, 0, 300 },  { 1e9, 0, 300 }, { 1, 1e6, 300 },
    { 1e-6, 1e3, 40 }, { 1, 0, 5000 },  { 1e3, -1e9, 300 },
};

static void
check_cubes(int which, int leaf)
{
    struct draw d = { rad_mix64((uint64_t)which + 1), 0 };
    struct rad_scene *s = rad_scene_new();
    struct rad_octree t;

    for (int i = 0; i < scenes[which].objects; i++)
        draw_surface(&d, s, scenes[which].scale, scenes[which].offset);
    ck_assert_int_eq(rad_octree_build(&t, s, leaf, NULL), 0);
    if (scenes[which].objects <= leaf)
        ck_assert_int_eq(t.nkids, 0);
    else
        ck_assert(t.nkids > scenes[which].objects / (16 * leaf));
    for (int i = 0; i < scenes[which].objects; i++)
        for (int k = 0; k < 40; k++) {
            double p[3], slack = 1e-14 * (fabs(scenes[which].offset) +
                                          4 * scenes[which].scale);

            point_on(&d, &s->objects[i], p);
            ck_assert_msg(found(&t, t.root, t.org, t.size, p, slack, i),
                          "object %d (%s) is missed at %.17g %.17g %.17g", i,
                          rad_otype_name(s->objects[i].type), p[0], p[1], p[2]);
        }
    rad_octree_release(&t);
    rad_scene_free(s);
}

LOOP_TEST(a_cube_names_every_surface_in_it, N_ELEM(scenes))
{
    check_cubes(_i, RAD_OCTREE_LEAF);
    check_cubes(_i, RAD_OCTREE_MAX_SET);
}

/* --- the test of one cube ----------------------------------------------------
 */

static const struct {
    enum rad_otype type;
    int n;
    double reals[16];
    double centre[3], half;
    bool meets;
} cubes[] = {
    /* triangle through the middle, its corners far outside */
    { RAD_POLYGON, 9, { -9, -9, 0, 9, -9, 0, 0, 9, 0 }, { 0, 0, 0 }, 1, 1 },
    { RAD_POLYGON, 9, { -9, -9, 2, 9, -9, 2, 0, 9, 2 }, { 0, 0, 0 }, 1, 0 },
    /* a corner of the cube is cut off by the slanting plane, or just not */
    { RAD_POLYGON, 9, { 9, 0, 0, 0, 9, 0, 0, 0, 9 }, { 2, 2, 2 }, 1.01, 1 },
    { RAD_POLYGON, 9, { 9, 0, 0, 0, 9, 0, 0, 0, 9 }, { 2, 2, 2 }, .99, 0 },
    /* bounds and plane meet the cube, the triangle passes by an edge */
    { RAD_POLYGON, 9, { 0, 3, 0, 3, 0, 0, 3, 3, 0 }, { 0, 0, 0 }, 1.4, 0 },
    { RAD_POLYGON, 9, { 0, 3, 0, 3, 0, 0, 3, 3, 0 }, { 0, 0, 0 }, 1.6, 1 },
    /* the same for a polygon that is clipped */
    { RAD_POLYGON,
      12,
      { 0, 3, 0, 3, 0, 0, 4, 0, 0, 4, 3, 0 },
      { 0, 0, 0 },
      1.4,
      0 },
    { RAD_POLYGON,
      12,
      { 0, 3, 0, 3, 0, 0, 4, 0, 0, 4, 3, 0 },
      { 0, 0, 0 },
      1.6,
      1 },
    /* a large square around the cube's section */
    { RAD_POLYGON,
      12,
      { -9, -9, 0, 9, -9, 0, 9, 9, 0, -9, 9, 0 },
      { 0, 0, 0 },
      1,
      1 },
    /* in the bay of a U */
    { RAD_POLYGON,
      15,
      { -9, -9, 0, 9, -9, 0, 9, 9, 0, 0, -5, 0, -9, 9, 0 },
      { 0, 0, 0 },
      1,
      0 },
    /* inside a sphere, across its shell, outside of it by a corner */
    { RAD_SPHERE, 4, { 0, 0, 0, 9 }, { 1, 1, 1 }, 1, 0 },
    { RAD_SPHERE, 4, { 0, 0, 0, 9 }, { 8, 0, 0 }, 2, 1 },
    { RAD_SPHERE, 4, { 0, 0, 0, -9 }, { 8, 8, 8 }, 2, 0 },
    { RAD_SPHERE, 4, { 0, 0, 0, 9 }, { 0, 0, 0 }, 20, 1 },
    /* on the axis of a tube, far inside; through its wall */
    { RAD_TUBE, 7, { 0, 0, -9, 0, 0, 9, 5 }, { 0, 0, 0 }, 1, 0 },
    { RAD_TUBE, 7, { 0, 0, -9, 0, 0, 9, 5 }, { 4, 0, 0 }, 1.1, 1 },
    { RAD_TUBE, 7, { 0, 0, -9, 0, 0, 9, 5 }, { 0, 0, 0 }, 20, 1 },
    { RAD_CONE, 8, { 0, 0, 0, 0, 0, 9, 9, 0 }, { 0, 0, 9 }, 1, 1 },
    { RAD_CONE, 8, { 0, 0, 0, 0, 0, 9, 9, 0 }, { 6, 0, 6 }, 1, 0 },
    { RAD_RING, 8, { 0, 0, 0, 0, 0, 9, 4, 9 }, { 0, 0, 0 }, 1, 0 },
    { RAD_RING, 8, { 0, 0, 0, 0, 0, 9, 4, 9 }, { 6, 0, 0 }, 1, 1 },
    { RAD_RING, 8, { 0, 0, 0, 0, 0, 9, 9, 4 }, { 6, 0, 1.5 }, 1, 0 },
};

LOOP_TEST(cube_and_surface_meet, N_ELEM(cubes))
{
    struct rad_object o = { .type = cubes[_i].type,
                            .name = "x",
                            .nreals = cubes[_i].n,
                            .reals = cubes[_i].reals };
    struct rad_extent e;

    ck_assert(rad_extent_of(&o, &e));
    ck_assert_int_eq(
        rad_overlaps_cube(&o, &e, cubes[_i].centre, cubes[_i].half),
        cubes[_i].meets);
}

static const struct {
    enum rad_otype type;
    int n;
    double reals[12];
} nothing[] = {
    { RAD_POLYGON, 9, { 0, 0, 0, 1, 1, 1, 2, 2, 2 } },
    { RAD_POLYGON, 9, { 0, 0, 0, 0, 0, 0, 2, 2, 2 } },
    { RAD_SPHERE, 4, { 0, 0, 0, 0 } },
    { RAD_RING, 8, { 0, 0, 0, 0, 0, 0, 0, 1 } },
    { RAD_RING, 8, { 0, 0, 0, 0, 0, 1, 1, 1 } },
    { RAD_CONE, 8, { 0, 0, 0, 0, 0, 0, 0, 1 } },
    { RAD_CYLINDER, 7, { 0, 0, 0, 0, 0, 1, 0 } },
    { RAD_SOURCE, 4, { 0, 0, 1, 5 } },
};

LOOP_TEST(what_has_no_area_is_in_no_cube, N_ELEM(nothing))
{
    struct rad_scene *s = rad_scene_new();
    struct rad_octree t;

    add(s, nothing[_i].type, nothing[_i].n, nothing[_i].reals);
    ck_assert_int_eq(rad_octree_build(&t, s, RAD_OCTREE_LEAF, NULL), 0);
    ck_assert_int_eq(t.root, RAD_OCTREE_EMPTY);
    ck_assert(t.size == 0);
    rad_octree_release(&t);
    rad_scene_free(s);
}

TEST(coincident_surfaces_end)
{
    static const double square[12] = { 0, 0, 0, 1, 0, .1, 1, 1, .1, 0, 1, 0 };
    struct rad_scene *s = rad_scene_new();
    struct rad_octree t;
    int32_t n;

    for (int i = 0; i < 600; i++)
        add(s, RAD_POLYGON, 12, square);
    ck_assert_int_eq(rad_octree_build(&t, s, RAD_OCTREE_LEAF, NULL), 0);
    ck_assert_int_lt(t.nkids, 100);
    ck_assert_int_gt(t.left_out, 0); /* Radiance reads 511 in a set */
    for (int32_t at = 0; at < t.nsets; at += n + 1) {
        n = t.sets[at];
        ck_assert(n > 0 && n <= RAD_OCTREE_MAX_SET);
    }
    rad_octree_release(&t);
    rad_scene_free(s);
}

/* A thousand spheres, .0002 apart, in a corner of a scene that is 1 wide. */
TEST(a_crowd_in_one_part_is_cut_where_it_lies)
{
    struct rad_scene *s = rad_scene_new();
    struct rad_octree t;

    add(s, RAD_SPHERE, 4, (double[4]){ 0, 0, 0, .01 });
    add(s, RAD_SPHERE, 4, (double[4]){ 1, 1, 1, .01 });
    for (int i = 0; i < 1000; i++)
        add(s, RAD_SPHERE, 4,
            (double[4]){ .3 + .0002 * (i % 10), .3 + .0002 * (i / 10 % 10),
                         .3 + .0002 * (i / 100), 1e-5 });
    ck_assert_int_eq(rad_octree_build(&t, s, RAD_OCTREE_LEAF, NULL), 0);
    ck_assert_int_eq(t.left_out, 0);
    for (int32_t at = 0; at < t.nsets; at += t.sets[at] + 1)
        ck_assert_int_le(t.sets[at], RAD_OCTREE_LEAF);
    rad_octree_release(&t);
    rad_scene_free(s);
}

TEST(crossing_surfaces_stay_within_the_budget)
{
    struct draw d = { 5, 0 };
    struct rad_scene *s = rad_scene_new();
    struct rad_octree t;
    double v[9];

    for (int i = 0; i < 2000; i++) {
        for (int k = 0; k < 9; k++)
            v[k] = draw(&d);
        add(s, RAD_POLYGON, 9, v);
    }
    ck_assert_int_eq(rad_octree_build(&t, s, RAD_OCTREE_LEAF, NULL), 0);
    ck_assert_int_lt(t.nsets, 4 * (32 * 2000 + (1 << 20)));
    rad_octree_release(&t);
    rad_scene_free(s);
}

TEST(too_large_a_scene_is_refused)
{
    static const double v[4] = { 1e307, 0, 0, 1e306 };
    struct rad_scene *s = rad_scene_new();
    struct rad_error err = { 0 };
    struct rad_octree t;

    add(s, RAD_SPHERE, 4, v);
    ck_assert_int_eq(rad_octree_build(&t, s, RAD_OCTREE_LEAF, &err), RAD_EDATA);
    ck_assert(err.what[0]);
    rad_octree_release(&t);
    rad_scene_free(s);
}
