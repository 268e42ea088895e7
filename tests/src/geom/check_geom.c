/* check_geom.c - where rays meet surfaces: known answers and hard cases */
#include "config.h"

#include "geom/geom.h"
#include "tests/closed_mesh.h"
#include "tests/blocked.h"
#include "tests/unit.h"
#include "geom_scene.h"

#include <math.h>

static struct rad_geom_counts counts;

static void
set_up(void)
{
    counts = (struct rad_geom_counts){ 0 };
}

FIXTURE(set_up, geom_tear_down)

/* clang-format off */
/* One surface, one ray, and where it must be met. */
static const struct {
    const char *what;
    enum rad_otype type;
    int nreals;
    double reals[16];
    double ray[6]; /* origin, direction (any length) */
    double t;      /* 0: a miss */
    double n[3];
} closed[] = {
    { "square", RAD_POLYGON, 12, { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
      { .25, .5, 2, 0, 0, -1 }, 2, { 0, 0, 1 } },
    { "square from behind", RAD_POLYGON, 12,
      { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
      { .25, .5, -3, 0, 0, 1 }, 3, { 0, 0, 1 } },
    { "beside the square", RAD_POLYGON, 12,
      { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
      { 1.25, .5, 2, 0, 0, -1 }, 0, { 0 } },
    { "along the square", RAD_POLYGON, 12,
      { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
      { -1, .5, 0, 1, 0, 0 }, 0, { 0 } },
    { "away from the square", RAD_POLYGON, 12,
      { 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0 },
      { .25, .5, 2, 0, 0, 1 }, 0, { 0 } },
    { "triangle", RAD_POLYGON, 9, { 0, 0, 0, 0, 4, 0, 0, 0, 4 },
      { -1, 1, 1, 1, 0, 0 }, 1, { 1, 0, 0 } },
    { "notch of a concave face", RAD_POLYGON, 15,
      { 0, 0, 0, 4, 0, 0, 4, 4, 0, 2, 1, 0, 0, 4, 0 },
      { 2, 2, 1, 0, 0, -1 }, 0, { 0 } },
    { "arm of a concave face", RAD_POLYGON, 15,
      { 0, 0, 0, 4, 0, 0, 4, 4, 0, 2, 1, 0, 0, 4, 0 },
      { 3.5, 2, 1, 0, 0, -1 }, 1, { 0, 0, 1 } },
    { "sphere", RAD_SPHERE, 4, { 1, 2, 3, 2 }, { 1, 2, 10, 0, 0, -1 }, 5,
      { 0, 0, 1 } },
    { "sphere from inside", RAD_SPHERE, 4, { 1, 2, 3, 2 },
      { 1, 2, 3, 0, 1, 0 }, 2, { 0, 1, 0 } },
    { "bubble", RAD_BUBBLE, 4, { 1, 2, 3, 2 }, { 1, 2, 10, 0, 0, -1 }, 5,
      { 0, 0, -1 } },
    { "sphere of negative radius", RAD_SPHERE, 4, { 1, 2, 3, -2 },
      { 1, 2, 10, 0, 0, -1 }, 5, { 0, 0, -1 } },
    { "beside the sphere", RAD_SPHERE, 4, { 1, 2, 3, 2 },
      { 3.01, 2, 10, 0, 0, -1 }, 0, { 0 } },
    { "cylinder", RAD_CYLINDER, 7, { 0, 0, 0, 0, 0, 4, 1.5 },
      { 5, 0, 2, -1, 0, 0 }, 3.5, { 1, 0, 0 } },
    { "tube", RAD_TUBE, 7, { 0, 0, 0, 0, 0, 4, 1.5 },
      { 5, 0, 2, -1, 0, 0 }, 3.5, { -1, 0, 0 } },
    { "down a cylinder", RAD_CYLINDER, 7, { 0, 0, 0, 0, 0, 4, 1.5 },
      { 0, 0, 9, 0, 0, -1 }, 0, { 0 } },
    { "through an open end", RAD_CYLINDER, 7, { 0, 0, 0, 0, 0, 4, 1 },
      { 0, -2, 6, 0, 1, -1 }, 3 * 1.4142135623730951, { 0, 1, 0 } },
    { "cone", RAD_CONE, 8, { 0, 0, 0, 0, 0, 2, 0, 2 },
      { 5, 0, 1, -1, 0, 0 }, 4,
      { .7071067811865476, 0, -.7071067811865476 } },
    { "cone with the ends swapped", RAD_CONE, 8, { 0, 0, 2, 0, 0, 0, 2, 0 },
      { 5, 0, 1, -1, 0, 0 }, 4,
      { .7071067811865476, 0, -.7071067811865476 } },
    { "cup", RAD_CUP, 8, { 0, 0, 0, 0, 0, 2, 0, 2 }, { 5, 0, 1, -1, 0, 0 }, 4,
      { -.7071067811865476, 0, .7071067811865476 } },
    { "other nappe", RAD_CONE, 8, { 0, 0, 0, 0, 0, 2, 0, 2 },
      { 5, 0, -1, -1, 0, 0 }, 0, { 0 } },
    { "along a cone's side", RAD_CONE, 8, { 0, 0, 0, 0, 0, 2, 0, 2 },
      { 0, 1, .5, 1, 0, 1 }, 1.0606601717798212,
      { .4242640687119285, .565685424949238, -.7071067811865476 } },
    { "cone of equal radii", RAD_CONE, 8, { 0, 0, 0, 0, 0, 4, 1.5, 1.5 },
      { 5, 0, 2, -1, 0, 0 }, 3.5, { 1, 0, 0 } },
    { "ring", RAD_RING, 8, { 0, 0, 1, 0, 0, 2, 1, 2 },
      { 1.5, 0, 3, 0, 0, -1 }, 2, { 0, 0, 1 } },
    { "hole of a ring", RAD_RING, 8, { 0, 0, 1, 0, 0, 2, 1, 2 },
      { .5, 0, 3, 0, 0, -1 }, 0, { 0 } },
    { "outside a ring", RAD_RING, 8, { 0, 0, 1, 0, 0, 2, 1, 2 },
      { 2.5, 0, 3, 0, 0, -1 }, 0, { 0 } },
    { "disk", RAD_RING, 8, { 0, 0, 1, 0, 0, 2, 0, 2 },
      { .5, 0, 3, 0, 0, -1 }, 2, { 0, 0, 1 } },
};

/* clang-format on */
/* Each at the origin and as it is, and blown up with everything around it. */
static const double scales[] = { 1e-6, 1, 1e9 };

LOOP_TEST(surface_is_met_where_geometry_says, N_ELEM(closed) * N_ELEM(scales))
{
    int row = _i / N_ELEM(scales);
    double s = scales[_i % N_ELEM(scales)], reals[16];
    const double *ray = closed[row].ray;
    struct rad_span span =
        geom_span(s * ray[0], s * ray[1], s * ray[2], ray[3], ray[4], ray[5]);
    struct rad_hit hit;

    for (int i = 0; i < closed[row].nreals; i++)
        reals[i] = s * closed[row].reals[i];
    geom_scene_init(&g, 1, 16);
    geom_scene_add(&g, closed[row].type, RAD_VOID, RAD_SURF_OPAQUE, reals,
                   closed[row].nreals);
    geom = geom_scene_compile(&g);
    bool met = rad_geom_nearest(geom, &span, &hit, &counts);

    ck_assert_msg(met == (closed[row].t > 0), "%s", closed[row].what);
    ck_assert_int_eq(hit.obj, met ? 0 : RAD_VOID);
    ck_assert_int_eq(met, is_blocked(geom, &span, RAD_VOID, NULL, &counts));
    if (met) {
        double p[3];

        rad_madd(p, span.org, hit.t, span.dir);
        ck_assert_msg(fabs(hit.t - s * closed[row].t) < 1e-14 * hit.t,
                      "%s: %.17g", closed[row].what, hit.t / s);
        ck_assert_msg(rad_dist2(hit.n, closed[row].n) < 1e-28, "%s: %g %g %g",
                      closed[row].what, hit.n[0], hit.n[1], hit.n[2]);
        ck_assert(rad_dist2(p, hit.p) < 1e-28 * s * s * 100);
        ck_assert(hit.err > 0 && hit.err < 1e-13 * s);
    }
}

TEST(empty_scene_is_never_met)
{
    struct rad_span span = geom_span(1, 2, 3, 1, 1, 1);
    double lo[3], hi[3];
    struct rad_hit hit;

    geom_scene_init(&g, 1, 1);
    geom = geom_scene_compile(&g);
    ck_assert(!rad_geom_nearest(geom, &span, &hit, &counts));
    ck_assert(!is_blocked(geom, &span, RAD_VOID, NULL, &counts));
    ck_assert(!rad_geom_hit_object(geom, 0, &span, &hit, &counts));
    rad_geom_bounds(geom, lo, hi);
    for (int a = 0; a < 3; a++)
        ck_assert(lo[a] == 0 && hi[a] == 0);
}

static void
mesh_make(double size, const double c[3])
{
    for (int v = 0; v < MESH_NV; v++)
        for (int u = 0; u < MESH_NU; u++) {
            double face[2][12];
            int corners[2], n = mesh_faces(u, v, size, c, face, corners);

            for (int k = 0; k < n; k++)
                geom_scene_add(&g, RAD_POLYGON, RAD_VOID, RAD_SURF_OPAQUE,
                               face[k], 3 * corners[k]);
        }
}

static const struct {
    double size, offset;
} mesh_place[] = { { 1, 0 },    { 1e-6, 0 }, { 1e9, 0 },   { 1, 1e6 },
                   { 10, 1e9 }, { 1e-3, 1 }, { 1e9, 1e9 }, { .1, -3 } };

LOOP_TEST(closed_mesh_does_not_leak, N_ELEM(mesh_place))
{
    enum { N = 1000000 / N_ELEM(mesh_place) };
    double size = mesh_place[_i].size, off = mesh_place[_i].offset;
    const double c[3] = { off, off, -off };
    int leaks = 0;

    geom_scene_init(&g, 2 * MESH_NU * MESH_NV, 24 * MESH_NU * MESH_NV);
    mesh_make(size, c);
    geom = geom_scene_compile(&g);
    for (uint64_t i = 0; i < N; i++) {
        uint64_t key = rad_key_branch(6, i);
        struct rad_span s = { .tmin = 0, .tmax = INFINITY };
        struct rad_hit hit;

        mesh_ray(key, size, c, s.org, s.dir);
        leaks += !rad_geom_nearest(geom, &s, &hit, &counts);
        leaks += !is_blocked(geom, &s, RAD_VOID, NULL, &counts);
    }
    ck_assert_int_eq(leaks, 0);
}

/* Lean p over: `lean` along x for each step along y from c. */
static void
lean_over(double lean, const double c[3], double p[3])
{
    p[0] += lean * (p[1] - c[1]);
}

/* A box of half size `size` about c, leaning over. */
static void
box_make(double size, double lean, const double c[3])
{
    static const int turn[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };

    for (int f = 0; f < 6; f++) {
        double face[12];
        int axis = f / 2;

        for (int i = 0; i < 4; i++) {
            double *v = face + 3 * i;

            v[axis] = c[axis] + (f % 2 ? size : -size);
            for (int k = 0; k < 2; k++) {
                int other = (axis + 1 + k) % 3;

                v[other] = c[other] + (turn[i][k] ? size : -size);
            }
            lean_over(lean, c, v);
        }
        geom_scene_add(&g, RAD_POLYGON, RAD_VOID, RAD_SURF_OPAQUE, face, 12);
    }
}

/* A ray in the box to a corner, or every fourth to an edge. */
static struct rad_span
ray_to_corner(uint64_t key, double size, double lean, const double c[3])
{
    double corner[3];
    struct rad_span s = { .tmin = 0, .tmax = INFINITY };
    uint32_t along = (uint32_t)(8 * rad_rand(key, 8));

    for (uint32_t k = 0; k < 3; k++) {
        double to = rad_rand(key, k) < .5 ? -1 : 1;

        if (k == along / 2 && along % 2)
            to = geom_rand(key, 6, -1, 1);
        s.org[k] = c[k] + size * geom_rand(key, 3 + k, -.5, .5);
        corner[k] = c[k] + size * to;
    }
    lean_over(lean, c, corner);
    lean_over(lean, c, s.org);
    rad_sub(s.dir, corner, s.org);
    rad_normalize(s.dir);
    return s;
}

static const double leans[] = { 0, .2, .5, 1 }; /* edges of 45 degrees */

/* At a corner a path meets the walls again and again, after next to no way. */
LOOP_TEST(paths_from_corners_do_not_leak, N_ELEM(mesh_place) * N_ELEM(leans))
{
    int place = _i / N_ELEM(leans);
    double size = mesh_place[place].size, off = mesh_place[place].offset;
    double lean = leans[_i % N_ELEM(leans)];
    const double c[3] = { off, off, -off };
    int leaks = 0;

    geom_scene_init(&g, 6, 72);
    box_make(size, lean, c);
    geom = geom_scene_compile(&g);
    for (uint64_t i = 0; i < 5000; i++) {
        uint64_t key = rad_key_branch(10, i);
        struct rad_span s = ray_to_corner(key, size, lean, c);

        for (uint32_t n = 0; n < 4; n++) {
            struct rad_hit hit;
            double cos_i;

            if (!rad_geom_nearest(geom, &s, &hit, &counts)) {
                leaks++;
                break;
            }
            cos_i = rad_dot(s.dir, hit.n);
            geom_rand_dir(key, 10 + 2 * n, s.dir);
            if (cos_i * rad_dot(s.dir, hit.n) > 0)
                rad_scale(s.dir, -1, s.dir);
            rad_geom_leave(&hit, s.dir, s.org);
        }
    }
    ck_assert_int_eq(leaks, 0);
}

/* A square with a square hole, joined by a seam as Radiance's scenes do. */
TEST(seam_makes_a_hole)
{
    struct rad_hit hit;
    int met = 0;

    geom_scene_init(&g, 1, 30);
    GEOM_ADD(&g, RAD_POLYGON, 0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0, 0, 0, 0, 1, 1,
             0, 1, 3, 0, 3, 3, 0, 3, 1, 0, 1, 1, 0);
    geom = geom_scene_compile(&g);
    for (int i = 0; i < 64 * 64; i++) {
        /* multiples of 1/16 hit the seam and the corners on the spot */
        double x = i % 64 / 16., y = i / 64 / 16.;
        struct rad_span s = geom_span(x, y, 1, 0, 0, -1);
        bool hole = x > 1 && x < 3 && y > 1 && y < 3;
        bool edge = x == 0 || y == 0 ||
                    ((x == 1 || x == 3) && y >= 1 && y <= 3) ||
                    ((y == 1 || y == 3) && x >= 1 && x <= 3);

        if (edge)
            continue;
        ck_assert_msg(rad_geom_nearest(geom, &s, &hit, &counts) == !hole,
                      "%g %g", x, y);
        met += !hole;
    }
    ck_assert_int_gt(met, 2000);
}

/* Surfaces without area, or made of numbers that are none: left out. */
static const struct {
    enum rad_otype type;
    int nreals;
    double reals[12];
} degenerate[] = {
    { RAD_POLYGON, 9, { 1, 1, 1, 1, 1, 1, 1, 1, 1 } },
    { RAD_POLYGON, 9, { 0, 0, 0, 1, 2, 3, 2, 4, 6 } },
    { RAD_POLYGON, 9, { .1, .2, .3, 1.1, 2.2, 3.3, 2.1, 4.2, 6.3 } },
    { RAD_POLYGON, 12, { 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0 } },
    { RAD_POLYGON, 6, { 0, 0, 0, 1, 0, 0 } },
    { RAD_POLYGON, 9, { 0, 0, 0, 1, 0, 0, 0, NAN, 0 } },
    { RAD_POLYGON, 9, { 0, 0, 0, INFINITY, 0, 0, 0, 1, 0 } },
    { RAD_SPHERE, 4, { 0, 0, 0, 0 } },
    { RAD_SPHERE, 4, { 0, 0, 0, NAN } },
    { RAD_SPHERE, 4, { 0, NAN, 0, 1 } },
    { RAD_BUBBLE, 3, { 0, 0, 0 } },
    { RAD_CYLINDER, 7, { 1, 2, 3, 1, 2, 3, 1 } },
    { RAD_TUBE, 7, { 0, 0, 0, 0, 0, 1, 0 } },
    { RAD_CYLINDER, 7, { 0, 0, 0, 0, NAN, 1, 1 } },
    { RAD_CONE, 8, { 0, 0, 0, 0, 0, 1, 0, 0 } },
    { RAD_CONE, 8, { 0, 0, 0, 0, 0, 1, 1, NAN } },
    { RAD_RING, 8, { 0, 0, 0, 0, 0, 0, 0, 1 } },
    { RAD_RING, 8, { 0, 0, 0, 0, 0, 1, 1, 1 } },
    { RAD_RING, 8, { 0, 0, 0, 0, 0, 1, 0, INFINITY } },
    { RAD_SOURCE, 4, { 0, 0, 1, 180 } },
};

LOOP_TEST(degenerate_surface_is_left_out, N_ELEM(degenerate))
{
    struct rad_span s = geom_span(0, 0, 5, 0, 0, -1);
    struct rad_hit hit;
    double lo[3], hi[3];

    geom_scene_init(&g, 2, 30);
    geom_scene_add(&g, degenerate[_i].type, RAD_VOID, RAD_SURF_OPAQUE,
                   degenerate[_i].reals, degenerate[_i].nreals);
    GEOM_ADD(&g, RAD_SPHERE, 0, 0, 0, 1);
    geom = geom_scene_compile(&g);
    rad_geom_bounds(geom, lo, hi); /* of the sphere alone */
    for (int a = 0; a < 3; a++)
        ck_assert(fabs(lo[a] + 1) < 1e-14 && fabs(hi[a] - 1) < 1e-14);
    ck_assert(rad_geom_nearest(geom, &s, &hit, &counts));
    ck_assert_int_eq(hit.obj, 1);
    ck_assert(!rad_geom_hit_object(geom, 0, &s, &hit, &counts));
    ck_assert(rad_geom_hit_object(geom, 1, &s, &hit, &counts));
}

/* Two coincident squares that both face +z unless turned; the ray comes from
 * above.  Which of the two is met, whatever their order in the scene. */
static const struct {
    uint8_t surf[2];
    bool turned[2];
    int32_t modifier[2];
    int winner;
} tie[] = {
    { { RAD_SURF_OPAQUE, RAD_SURF_TRANSPARENT }, { 0, 0 }, { 2, 3 }, 0 },
    { { RAD_SURF_TRANSPARENT, RAD_SURF_OPAQUE }, { 0, 0 }, { 3, 2 }, 1 },
    { { RAD_SURF_OPAQUE, RAD_SURF_TRANSPARENT }, { 1, 0 }, { 2, 3 }, 0 },
    { { RAD_SURF_TRANSPARENT, RAD_SURF_NOMATERIAL }, { 1, 0 }, { 2, 3 }, 0 },
    { { RAD_SURF_OPAQUE, RAD_SURF_OPAQUE }, { 1, 0 }, { 3, 2 }, 1 },
    { { RAD_SURF_OPAQUE, RAD_SURF_OPAQUE }, { 0, 1 }, { 2, 3 }, 0 },
    { { RAD_SURF_OPAQUE, RAD_SURF_OPAQUE }, { 0, 0 }, { 2, 3 }, 1 },
    { { RAD_SURF_OPAQUE, RAD_SURF_OPAQUE }, { 0, 0 }, { 3, 2 }, 0 },
    { { RAD_SURF_OPAQUE, RAD_SURF_OPAQUE }, { 1, 1 }, { 3, 2 }, 0 },
};

/* A square across (1,1,1)/sqrt 3, scaled and turned within its plane: the same
 * plane from other vertices, so that the two differ by rounding. */
static void
tilted_square(double v[12], double turn, double size, bool turned)
{
    static const double n[3] = { .5773502691896258, .5773502691896258,
                                 .5773502691896258 };
    double x[3], y[3];

    rad_frame(x, y, n);
    for (int i = 0; i < 4; i++) {
        double a = turn + (turned ? -1 : 1) * i * 1.5707963267948966;

        for (int j = 0; j < 3; j++)
            v[3 * i + j] = n[j] * 7.3 + size * (cos(a) * x[j] + sin(a) * y[j]);
    }
}

LOOP_TEST(coincident_faces_are_told_apart_by_rule, 2 * N_ELEM(tie))
{
    int row = _i / 2, swap = _i % 2;
    struct rad_hit hit;
    double v[2][12];

    geom_scene_init(&g, 6, 24);
    /* stand-ins for modifiers 0 to 3 */
    for (int i = 0; i < 4; i++)
        geom_scene_add(&g, RAD_PLASTIC, RAD_VOID, 0, NULL, 0);
    tilted_square(v[0], .1, 3, tie[row].turned[0]);
    tilted_square(v[1], .9, 5, tie[row].turned[1]);
    for (int i = 0; i < 2; i++) {
        int k = i ^ swap;

        geom_scene_add(&g, RAD_POLYGON, tie[row].modifier[k], tie[row].surf[k],
                       v[k], 12);
    }
    geom = geom_scene_compile(&g);
    for (uint64_t i = 0; i < 500; i++) {
        struct rad_span s = geom_span(20, 18, 25, 0, 0, 0);
        uint64_t key = rad_key_branch(2, i);

        for (int a = 0; a < 3; a++)
            s.dir[a] = 7.3 * .5773502691896258 +
                       geom_rand(key, (uint32_t)a, -.8, .8) - s.org[a];
        rad_normalize(s.dir);
        ck_assert(rad_geom_nearest(geom, &s, &hit, &counts));
        ck_assert_msg(hit.obj == 4 + (tie[row].winner ^ swap), "ray %d",
                      (int)i);
    }
}

/* A floor and a wall whose edge each ray meets, exactly: both are hit, and the
 * one with the later modifier is seen, in front or from behind. */
LOOP_TEST(shared_edge_goes_to_the_later_modifier, 4)
{
    static const double floor[2][12] = {
        { -1, -1, -1, 1, -1, -1, 1, 1, -1, -1, 1, -1 },
        { -1, 1, -1, 1, 1, -1, 1, -1, -1, -1, -1, -1 },
    };
    static const double wall[2][12] = {
        { -1, -1, 1, 1, -1, 1, 1, -1, -1, -1, -1, -1 },
        { -1, -1, -1, 1, -1, -1, 1, -1, 1, -1, -1, 1 },
    };
    int later = _i % 2, turned = _i / 2;
    struct rad_hit hit;

    geom_scene_init(&g, 4, 24);
    for (int i = 0; i < 2; i++) /* stand-ins for modifiers */
        geom_scene_add(&g, RAD_PLASTIC, RAD_VOID, 0, NULL, 0);
    geom_scene_add(&g, RAD_POLYGON, later, RAD_SURF_OPAQUE, floor[turned], 12);
    geom_scene_add(&g, RAD_POLYGON, !later, RAD_SURF_OPAQUE, wall[turned], 12);
    geom = geom_scene_compile(&g);
    for (int i = -9; i <= 9; i++) {
        struct rad_span s = geom_span(3, 0, 0, i / 10. - 3, -1, -1);

        ck_assert(rad_geom_nearest(geom, &s, &hit, &counts));
        ck_assert_int_eq(hit.obj, later ? 2 : 3);
    }
}

/* A lamp as far behind a ceiling as a frozen octree or twelve digits may put
 * it, whose modifier is the later: its front is seen.  Its back is not, nor is
 * the lamp behind a pane, or farther off. */
enum { CEILING = RAD_SURF_OPAQUE, LIT = RAD_SURF_OPAQUE | RAD_SURF_LAMP };

static const struct {
    double z;
    uint8_t ceiling, lamp;
    double up;   /* of the lamp's normal */
    int earlier; /* 1: its modifier is the earlier */
    int seen;    /* 0: the ceiling, 1: the lamp */
} flush[] = {
    { 3 + 3 * 0x1p-31, CEILING, LIT, -1, 0, 1 },
    { 3 + 1e-11, CEILING, LIT, -1, 0, 1 },
    { 3 + 1e-11, CEILING, RAD_SURF_LAMP, -1, 0, 1 },
    { 3 + 1e-11, CEILING, LIT, -1, 1, 0 },
    { 3 + 1e-11, CEILING, CEILING, -1, 0, 0 },
    { 3 + 1e-11, CEILING, LIT, 1, 0, 0 },
    { 3 + 1e-11, RAD_SURF_TRANSPARENT, LIT, -1, 0, 0 },
    { 3 + 1e-7, CEILING, LIT, -1, 0, 0 },
};

LOOP_TEST(lamp_is_not_hidden_by_what_is_flush_with_it, 2 * N_ELEM(flush))
{
    int row = _i / 2, first = _i % 2, early = flush[row].earlier;
    double ring[2][8] = { { 0, 0, 3, 0, 0, -1, 0, 9 },
                          { 0, 0, flush[row].z, 0, 0, flush[row].up, 0, 8 } };
    struct rad_hit hit;

    geom_scene_init(&g, 4, 16);
    for (int i = 0; i < 2; i++) /* stand-ins for modifiers */
        geom_scene_add(&g, RAD_PLASTIC, RAD_VOID, 0, NULL, 0);
    for (int i = 0; i < 2; i++) {
        int k = i ^ first;

        geom_scene_add(&g, RAD_RING, k ^ early,
                       k ? flush[row].lamp : flush[row].ceiling, ring[k], 8);
    }
    geom = geom_scene_compile(&g);
    for (int i = 0; i < 9; i++) {
        struct rad_span s = geom_span(0, 0, 1, i, 1, 2);
        int seen = i < 8 && flush[row].seen;

        if (i == 8) /* past the lamp */
            s = geom_span(8.5, 0, 1, 0, 0, 1);
        ck_assert(rad_geom_nearest(geom, &s, &hit, &counts));
        ck_assert_int_eq(hit.obj, 2 + (seen ^ first));
    }
}

TEST(nearby_faces_are_no_tie)
{
    struct rad_span s = geom_span(.3, .4, 10, 0, 0, -1);
    struct rad_hit hit;

    geom_scene_init(&g, 3, 30);
    /* the nearer one would lose by every rule */
    geom_scene_add(&g, RAD_RING, RAD_VOID, RAD_SURF_TRANSPARENT,
                   (double[]){ 0, 0, 1 + 1e-12, 0, 0, -1, 0, 1 }, 8);
    GEOM_ADD(&g, RAD_RING, 0, 0, 1, 0, 0, 1, 0, 1);
    geom = geom_scene_compile(&g);
    ck_assert(rad_geom_nearest(geom, &s, &hit, &counts));
    ck_assert_int_eq(hit.obj, 0);
}

TEST(span_with_nan_meets_nothing)
{
    static const double bad[] = { NAN, INFINITY, -INFINITY };
    struct rad_hit hit;

    geom_scene_init(&g, 1, 4);
    GEOM_ADD(&g, RAD_BUBBLE, 0, 0, 0, 1);
    geom = geom_scene_compile(&g);
    for (int i = 0; i < 6 * N_ELEM(bad); i++) {
        struct rad_span s = geom_span(0, 0, 0, 1, 2, 3);

        *(i % 6 < 3 ? &s.org[i % 3] : &s.dir[i % 3]) = bad[i / 6];
        ck_assert(!rad_geom_nearest(geom, &s, &hit, &counts));
        ck_assert(!is_blocked(geom, &s, RAD_VOID, NULL, &counts));
        ck_assert(!rad_geom_hit_object(geom, 0, &s, &hit, &counts));
    }
    struct rad_span s = geom_span(0, 0, 0, 0, 0, 0);
    ck_assert(!rad_geom_nearest(geom, &s, &hit, &counts));
    s = geom_span(0, 0, 0, 1, 2, 3);
    s.tmax = NAN;
    ck_assert(!rad_geom_nearest(geom, &s, &hit, &counts));
    s.tmax = INFINITY;
    s.tmin = NAN;
    ck_assert(!rad_geom_nearest(geom, &s, &hit, &counts));
}

TEST(span_ends_where_it_says)
{
    struct rad_span s = geom_span(0, 0, 5, 0, 0, -1);
    struct rad_hit hit;

    geom_scene_init(&g, 1, 4);
    GEOM_ADD(&g, RAD_SPHERE, 0, 0, 0, 1);
    geom = geom_scene_compile(&g);
    s.tmax = 4; /* the sphere is met at 4 and 6, and the ends are open */
    ck_assert(!rad_geom_nearest(geom, &s, &hit, &counts));
    s.tmax = 4.001;
    ck_assert(rad_geom_nearest(geom, &s, &hit, &counts));
    s.tmin = 4;
    ck_assert(!rad_geom_nearest(geom, &s, &hit, &counts));
    s.tmax = INFINITY;
    ck_assert(rad_geom_nearest(geom, &s, &hit, &counts));
    ck_assert_double_eq_tol(hit.t, 6, 1e-14);
    s.tmin = 6;
    ck_assert(!rad_geom_nearest(geom, &s, &hit, &counts));
}

TEST(blocker_is_remembered_and_skipped)
{
    struct rad_span s = geom_span(0, 0, 5, 0, 0, -1);
    int32_t blocker = RAD_VOID;

    geom_scene_init(&g, 3, 30);
    GEOM_ADD(&g, RAD_RING, 0, 0, 0, 0, 0, 1, 0, 1);
    GEOM_ADD(&g, RAD_RING, 0, 0, -2, 0, 0, 1, 0, 1);
    geom_scene_add(&g, RAD_RING, RAD_VOID, RAD_SURF_TRANSPARENT,
                   (double[]){ 0, 0, 2, 0, 0, 1, 0, 1 }, 8);
    geom = geom_scene_compile(&g);
    ck_assert(is_blocked(geom, &s, 0, &blocker, &counts));
    ck_assert_int_eq(blocker, 1);
    ck_assert_uint_eq(counts.tests, 1); /* as if that had been remembered */
    ck_assert_uint_eq(counts.nodes, 0);
    ck_assert(is_blocked(geom, &s, RAD_VOID, &blocker, &counts));
    ck_assert_int_eq(blocker, 1); /* tested first, though not the nearest */
    ck_assert_uint_eq(counts.tests, 2);
    ck_assert_uint_eq(counts.nodes, 0);
    ck_assert(is_blocked(geom, &s, 1, &blocker, &counts));
    ck_assert_int_eq(blocker, 0);
    blocker = 2; /* see-through: no blocker, but no reason to forget others */
    ck_assert(is_blocked(geom, &s, RAD_VOID, &blocker, &counts));
    ck_assert_int_ne(blocker, 2);
    blocker = 77; /* from another scene */
    ck_assert(is_blocked(geom, &s, RAD_VOID, &blocker, &counts));
    s.tmax = 4;
    ck_assert(!is_blocked(geom, &s, RAD_VOID, &blocker, &counts));
}

/* Distance from p to the plane of the first three vertices. */
static long double
off_plane(const double *v, const double *p)
{
    long double a[3], b[3], n[3], h = 0;

    for (int i = 0; i < 3; i++) {
        a[i] = (long double)v[3 + i] - v[i];
        b[i] = (long double)v[6 + i] - v[i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;

        n[i] = a[j] * b[k] - a[k] * b[j];
        h += n[i] * ((long double)p[i] - v[i]);
    }
    return fabsl(h) / hypotl(hypotl(n[0], n[1]), n[2]);
}

/* Distance from p to the surface, in a wider format than the code's. */
static long double
off_surface(enum rad_otype type, const double *a, const double *p)
{
    long double d[3], x[3], h = 0, len = 0, rho = 0, r;

    if (type == RAD_POLYGON)
        return off_plane(a, p);
    for (int i = 0; i < 3; i++)
        d[i] = (long double)p[i] - a[i];
    if (type == RAD_SPHERE || type == RAD_BUBBLE)
        return fabsl(hypotl(hypotl(d[0], d[1]), d[2]) - a[3]);
    for (int i = 0; i < 3; i++) {
        x[i] = type == RAD_RING ? a[3 + i] : (long double)a[3 + i] - a[i];
        len += x[i] * x[i];
    }
    len = sqrtl(len);
    for (int i = 0; i < 3; i++)
        h += d[i] * x[i] / len;
    if (type == RAD_RING)
        return fabsl(h);
    for (int i = 0; i < 3; i++) {
        d[i] -= h * x[i] / len;
        rho += d[i] * d[i];
    }
    r = a[6];
    if (type == RAD_CONE || type == RAD_CUP)
        r += (a[7] - (long double)a[6]) * h / len;
    return fabsl(sqrtl(rho) - r);
}

/* Surfaces from near and far, at many sizes: the hit's error bound holds, and
 * a ray that leaves as rad_geom_leave says does not meet the same place. */
static const struct {
    enum rad_otype type;
    int nreals;
    double reals[12];
} leaving[] = {
    { RAD_POLYGON, 9, { .1, .2, .3, 1.7, .8, .2, .5, 1.1, 2.3 } },
    { RAD_POLYGON, 9, { 1e9, 7, 3, 1e9 + 4, 5, 8, 1e9 + 1, -2, 5 } },
    { RAD_POLYGON, 9, { 3e-6, 1e-6, 2e-6, -4e-6, 5e-6, 8e-6, 0, 0, 5e-6 } },
    { RAD_POLYGON, 12, { 1, 2, 3, 11, 2, 3, 11, 22, 3, 1, 22, 3 } },
    { RAD_SPHERE, 4, { .1, .2, .3, 1 } },
    { RAD_SPHERE, 4, { .1, .2, .3, 1e-6 } },
    { RAD_SPHERE, 4, { .1, .2, 1e10, 1e10 } },
    { RAD_BUBBLE, 4, { 1e9, 1e9, -1e9, 3 } },
    { RAD_CYLINDER, 7, { .1, .2, .3, .7, .8, .2, .5 } },
    { RAD_CYLINDER, 7, { .1, .2, .3, 100, 80, 20, 1e-4 } },
    { RAD_TUBE, 7, { 1e6, .2, .3, 1e6, .8, 20, 1e3 } },
    { RAD_CONE, 8, { .1, .2, .3, .7, .8, .2, 0, .5 } },
    { RAD_CUP, 8, { .1, .2, 1e6, .7, .8, 1e6, 1, .5 } },
    { RAD_RING, 8, { .1, 1e9, .3, .3, .4, .5, 0, 2 } },
};

/* A ray towards somewhere on the surface, from about dist away. */
static struct rad_span
aim(uint64_t key, int row, double dist)
{
    const double *a = leaving[row].reals;
    bool ball =
        leaving[row].type == RAD_SPHERE || leaving[row].type == RAD_BUBBLE;
    bool face = leaving[row].type == RAD_POLYGON;
    double r = ball ? a[3] : leaving[row].type == RAD_RING ? a[7] : a[6];
    double s = rad_rand(key, 9), to[3];
    struct rad_span span = { .tmin = 0, .tmax = INFINITY };

    geom_rand_dir(key, 0, to);
    geom_rand_dir(key, 2, span.org);
    for (int i = 0; i < 3; i++) {
        /* on the axis, or on an edge */
        double at = ball || leaving[row].type == RAD_RING
                        ? a[i]
                        : a[i] + s * (a[3 + i] - a[i]);

        if (face) /* from there towards the third vertex, to the edge too */
            to[i] = at + fmax(rad_rand(key, 10) - .1, 0) * (a[6 + i] - at);
        else
            to[i] = at + r * to[i];
        span.org[i] = to[i] + dist * span.org[i];
    }
    rad_sub(span.dir, to, span.org);
    rad_normalize(span.dir);
    return span;
}

/* Cones lower than they are wide, and one that is not quite. */
static const double low_cone[][8] = {
    { 0, 0, 0, 0, 0, .1, 1, 1 },
    { 0, 0, 0, .02, -.01, .02, .6, .59 },
    { 1, 2, 3, 1.1, 2.2, 3.3, 0, 1 },
    { 0, 0, 0, 0, 1e-5, 0, 1, .5 },
    { -3, 1, 2, -3, 2.9, 2, 1, .7 },
    { 1e9, -1e9, 1e9, 1e9, -1e9, 1e9 + 1, 4, 5 },
};

/* A point between the ends of a cone, as often as not `margin` from one, and
 * its normal. */
static void
cone_point(uint64_t key, const double a[8], double margin, double p[3],
           double n[3])
{
    double axis[3], x[3], y[3], phi = geom_rand(key, 0, 0, 2 * M_PI);
    double s = geom_rand(key, 1, -.5, 1.5), len;

    rad_sub(axis, a + 3, a);
    len = rad_normalize(axis);
    s = fmin(fmax(s, margin / len), 1 - margin / len);
    rad_frame(x, y, axis);
    rad_scale(n, cos(phi), x);
    rad_madd(n, n, sin(phi), y);
    rad_madd(p, a, s * len, axis);
    rad_madd(p, p, a[6] + s * (a[7] - a[6]), n);
    rad_madd(n, n, -(a[7] - a[6]) / len, axis);
    rad_normalize(n);
}

/* What is known of a ray between the ends must not hide a hit. */
LOOP_TEST(low_cone_is_met_where_it_is, N_ELEM(low_cone))
{
    static const double dists[] = { 1e-3, .3, 10, 1e7 };
    const double *a = low_cone[_i];
    double size = 0;
    int met = 0;

    for (int k = 0; k < 8; k++)
        size += fabs(a[k]);
    geom_scene_init(&g, 1, 8);
    geom_scene_add(&g, RAD_CONE, RAD_VOID, RAD_SURF_OPAQUE, a, 8);
    geom = geom_scene_compile(&g);
    for (uint64_t i = 0; i < 40000; i++) {
        uint64_t key = rad_key_branch(9, i);
        struct rad_span span = { .tmin = 0, .tmax = INFINITY };
        /* aimed at a place to within a few roundings; a ray along the surface
         * makes a hundred times as much of them */
        double off = 0x1p-50 * (size + dists[i % 4]), p[3], n[3], dist;
        struct rad_hit hit;

        cone_point(key, a, 200 * off, p, n);
        geom_rand_dir(key, 2, span.org);
        rad_madd(span.org, p, dists[i % 4], span.org);
        rad_sub(span.dir, p, span.org);
        dist = rad_normalize(span.dir);
        if (fabs(rad_dot(span.dir, n)) < .01)
            continue;
        ck_assert_msg(rad_geom_nearest(geom, &span, &hit, &counts),
                      "ray %d misses", (int)i);
        ck_assert(hit.t < dist + 1e4 * off); /* not the far side */
        met++;
    }
    ck_assert_int_gt(met, 20000);
}

LOOP_TEST(hit_is_within_its_bound_and_is_left_behind, N_ELEM(leaving))
{
    static const double dists[] = { 1e-3, 1, 1e3, 1e7 };
    const double *a = leaving[_i].reals;
    int met = 0;

    geom_scene_init(&g, 1, 12);
    geom_scene_add(&g, leaving[_i].type, RAD_VOID, RAD_SURF_OPAQUE, a,
                   leaving[_i].nreals);
    geom = geom_scene_compile(&g);
    for (uint64_t i = 0; i < 40000; i++) {
        uint64_t key = rad_key_branch(8, i);
        struct rad_span s = aim(key, _i, dists[i % 4]), away = s;
        struct rad_hit hit, again;
        double cos_out;

        if (!rad_geom_nearest(geom, &s, &hit, &counts))
            continue;
        met++;
        ck_assert_msg(off_surface(leaving[_i].type, a, hit.p) <= hit.err,
                      "off by %Lg, bound %g",
                      off_surface(leaving[_i].type, a, hit.p), hit.err);
        ck_assert(fabs(rad_dot(hit.n, hit.n) - 1) < 1e-14);
        geom_rand_dir(key, 20, away.dir);
        if (i % 3 == 0) { /* all but along the surface */
            double tilt = pow(10, geom_rand(key, 22, -17, -3));

            rad_madd(away.dir, away.dir, -rad_dot(away.dir, hit.n), hit.n);
            rad_madd(away.dir, away.dir, i % 2 ? tilt : -tilt, hit.n);
            rad_normalize(away.dir);
        }
        rad_geom_leave(&hit, away.dir, away.org);
        cos_out = rad_dot(away.dir, hit.n);
        if (!rad_geom_nearest(geom, &away, &again, &counts))
            continue;
        /* inside a round thing the far wall may be met, and only there */
        ck_assert(leaving[_i].type != RAD_RING &&
                  leaving[_i].type != RAD_POLYGON);
        ck_assert_msg(!signbit(rad_dot(again.n, away.dir)) != !signbit(cos_out),
                      "met again after %g", again.t);
    }
    ck_assert_int_gt(met, 300);
}
