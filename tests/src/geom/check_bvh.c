/* check_bvh.c - the tree finds what testing every surface finds */
#include "config.h"

#include "geom/geom.h"
#include "geom/kernel.h"
#include "tests/blocked.h"
#include "tests/unit.h"
#include "geom_scene.h"

#include <math.h>
#include <stdio.h>

enum { NSURFACES = 603, NRAYS = 4000 };

FIXTURE(NULL, geom_tear_down)

/* A surface of any family, somewhere in a box of half-width size around c. */
static void
add_random(uint64_t key, double size, const double c[3])
{
    static const enum rad_otype types[] = {
        RAD_POLYGON, RAD_SPHERE, RAD_BUBBLE,   RAD_CONE, RAD_CUP,
        RAD_POLYGON, RAD_RING,   RAD_CYLINDER, RAD_TUBE, RAD_POLYGON
    };
    enum rad_otype type = types[(int)geom_rand(key, 0, 0, 10)];
    double e = size * geom_rand(key, 1, .01, .2), v[15];
    int n = 9;

    for (int i = 0; i < 3; i++)
        v[i] = c[i] + geom_rand(key, (uint32_t)(2 + i), -size, size);
    for (int i = 3; i < 12; i++)
        v[i] = v[i % 3] + geom_rand(key, (uint32_t)(2 + i), -e, e);
    switch (type) {
    case RAD_SPHERE:
    case RAD_BUBBLE:
        v[3] = e;
        n = 4;
        break;
    case RAD_RING:
        geom_rand_dir(key, 20, v + 3);
        v[6] = e * geom_rand(key, 22, 0, .9);
        v[7] = e;
        n = 8;
        break;
    case RAD_CYLINDER:
    case RAD_TUBE:
        v[6] = e * .5;
        n = 7;
        break;
    case RAD_CONE:
    case RAD_CUP:
        v[6] = e * geom_rand(key, 22, 0, 1);
        v[7] = e * geom_rand(key, 23, 0, 1);
        n = 8;
        break;
    default:
        if (geom_rand(key, 24, 0, 1) < .5) { /* a parallelogram */
            n = 12;
            for (int i = 0; i < 3; i++)
                v[9 + i] = v[i] + v[6 + i] - v[3 + i];
        }
    }
    geom_scene_add(&g, type, RAD_VOID,
                   geom_rand(key, 25, 0, 1) < .7
                       ? RAD_SURF_OPAQUE
                       : RAD_SURF_TRANSPARENT | RAD_SURF_PASSED,
                   v, n);
}

static const struct {
    double size, offset;
} place[] = {
    { 1, 0 }, { 1e-6, 0 }, { 1e9, 0 }, { 1, 1e9 }, { 1e3, -1e9 }, { 1e-6, 1 },
};

/* What testing each surface by itself says. */
static bool
nearest_of_all(int n, const struct rad_span *span, struct rad_hit *best)
{
    struct rad_geom_counts counts = { 0 };
    struct rad_hit hit;

    best->obj = RAD_VOID;
    best->t = INFINITY;
    for (int i = 0; i < n; i++)
        if (rad_geom_hit_object(geom, i, span, &hit, &counts) &&
            hit.t < best->t)
            *best = hit;
    return best->obj != RAD_VOID;
}

static bool
any_of_all(const struct rad_span *span, int32_t skip)
{
    struct rad_geom_counts counts = { 0 };
    struct rad_hit hit;

    for (int i = 0; i < g.scene.nobjects; i++)
        if (i != skip && g.surf[i] & RAD_SURF_OPAQUE &&
            rad_geom_hit_object(geom, i, span, &hit, &counts))
            return true;
    return false;
}

static struct rad_span
random_ray(uint64_t key, double size, const double c[3])
{
    static const double axis[6][3] = {
        { 1, 0, 0 },  { 0, 1, 0 },  { 0, 0, 1 },
        { 0, 0, -1 }, { 0, -1, 0 }, { -1, 0, 0 }
    };
    struct rad_span s = { .tmin = 0, .tmax = INFINITY };

    for (int i = 0; i < 3; i++)
        s.org[i] = c[i] + geom_rand(key, (uint32_t)i, -2 * size, 2 * size);
    geom_rand_dir(key, 4, s.dir);
    if (rad_rand(key, 6) < .3) /* along an axis: no slope in two others */
        rad_copy(s.dir, axis[(int)geom_rand(key, 7, 0, 6)]);
    if (rad_rand(key, 8) < .3)
        s.tmax = size * rad_rand(key, 9);
    if (rad_rand(key, 10) < .2)
        s.tmin = size * rad_rand(key, 11);
    return s;
}

LOOP_TEST(tree_finds_what_testing_all_finds, 2 * N_ELEM(place))
{
    uint32_t rays = _i % 2 == 0 ? 0 : 1;
    double size = place[_i / 2].size, off = place[_i / 2].offset;
    const double c[3] = { off, -off, off };
    struct rad_geom_counts counts = { 0 };
    int hits = 0, blocked = 0;

    geom_scene_init(&g, NSURFACES, NSURFACES * 12);
    for (uint64_t i = 0; i < NSURFACES; i++)
        add_random(rad_key_branch(7, i), size, c);
    geom = geom_scene_compile_for(&g, rays);
    for (uint64_t i = 0; i < NRAYS; i++) {
        uint64_t key = rad_key_branch(99, i);
        struct rad_span s = random_ray(key, size, c);
        struct rad_hit hit, want;
        int32_t skip = (int32_t)geom_rand(key, 12, -1, NSURFACES);
        bool met = nearest_of_all(NSURFACES, &s, &want);
        bool shadow = any_of_all(&s, skip);

        ck_assert_int_eq(rad_geom_nearest(geom, &s, &hit, &counts), met);
        ck_assert_msg(hit.obj == want.obj, "ray %d: %d, not %d (t %.17g %.17g)",
                      (int)i, hit.obj, want.obj, hit.t, want.t);
        if (met)
            ck_assert(memcmp(&hit.t, &want.t, sizeof hit.t) == 0);
        ck_assert_int_eq(is_blocked(geom, &s, skip, NULL, &counts), shadow);
        hits += met;
        blocked += shadow;
    }
    /* the rays did meet things, and not always */
    ck_assert(hits > NRAYS / 20 && hits < NRAYS * 19 / 20);
    ck_assert(blocked > NRAYS / 20 && blocked < hits);
}

/* A face of 4 to 7 vertices that lie up to `warp` off a plane, in the frame
 * `axis` about c.  Returns the number of vertices. */
static int
warped_face(uint64_t key, double warp, double v[21], double axis[3][3],
            double c[3])
{
    int n = 4 + (int)geom_rand(key, 4, 0, 4);

    geom_rand_dir(key, 2, axis[2]);
    rad_frame(axis[0], axis[1], axis[2]);
    for (int i = 0; i < 3; i++)
        c[i] = geom_rand(key, (uint32_t)(5 + i), -2, 2);
    for (int i = 0; i < n; i++) {
        double a = 6.283185307179586 * i / n;

        rad_madd(v + 3 * i, c, cos(a), axis[0]);
        rad_madd(v + 3 * i, v + 3 * i, .7 * sin(a), axis[1]);
        rad_madd(v + 3 * i, v + 3 * i,
                 geom_rand(key, (uint32_t)(20 + i), -warp, warp), axis[2]);
    }
    return n;
}

/* A ray by a warped face, with a slope to it of `warp`, times up to ten either
 * way. */
static struct rad_span
graze(uint64_t key, double warp, double axis[3][3], const double c[3])
{
    double turn = geom_rand(key, 0, 0, 6.283185307179586);
    struct rad_span s = { .tmin = 0, .tmax = INFINITY };

    rad_scale(s.dir, cos(turn), axis[0]);
    rad_madd(s.dir, s.dir, sin(turn), axis[1]);
    rad_madd(s.dir, s.dir, warp * pow(10, geom_rand(key, 1, -1, 1)), axis[2]);
    rad_normalize(s.dir);
    rad_madd(s.org, c, geom_rand(key, 2, -.8, .8), axis[0]);
    rad_madd(s.org, s.org, geom_rand(key, 3, -.6, .6), axis[1]);
    rad_madd(s.org, s.org, -geom_rand(key, 4, 0, 6), s.dir);
    if (rad_rand(key, 5) < .5)
        s.tmax = geom_rand(key, 6, 0, 6);
    return s;
}

/* How far p is from the box of a face's vertices. */
static double
off_box(const double *v, int n, const double p[3])
{
    double off = 0;

    for (int a = 0; a < 3; a++) {
        double lo = v[a], hi = v[a];

        for (int i = 1; i < n; i++) {
            lo = fmin(lo, v[3 * i + a]);
            hi = fmax(hi, v[3 * i + a]);
        }
        off = fmax(off, fmax(lo - p[a], p[a] - hi));
    }
    return off;
}

static const double warps[] = { 1e-8, 1e-3, .01, .1 };

/* Rays all but along faces that are not flat: the tree finds the face that is
 * met, the point is near it, and a ray that leaves it does not meet it. */
LOOP_TEST(warped_faces_are_found_at_any_angle, N_ELEM(warps))
{
    enum { N = 300 };
    struct rad_geom_counts counts = { 0 };
    double v[21], axis[3][3], c[3], warp = warps[_i];
    int met = 0;

    geom_scene_init(&g, N, N * 21);
    for (uint64_t i = 0; i < N; i++) {
        int n = warped_face(rad_key_branch(5, i), warp, v, axis, c);

        geom_scene_add(&g, RAD_POLYGON, RAD_VOID, RAD_SURF_OPAQUE, v, 3 * n);
    }
    geom = geom_scene_compile(&g);
    for (uint64_t i = 0; i < 40 * N; i++) {
        uint64_t key = rad_key_branch(6, i);
        struct rad_span s, away = { .tmin = 0, .tmax = INFINITY };
        struct rad_hit hit, want;
        const struct rad_object *o;

        warped_face(rad_key_branch(5, i % N), warp, v, axis, c);
        s = graze(key, warp, axis, c);
        nearest_of_all(N, &s, &want);
        rad_geom_nearest(geom, &s, &hit, &counts);
        ck_assert_msg(hit.obj == want.obj, "ray %d: %d, not %d", (int)i,
                      hit.obj, want.obj);
        ck_assert_int_eq(is_blocked(geom, &s, RAD_VOID, NULL, &counts),
                         want.obj != RAD_VOID);
        if (hit.obj == RAD_VOID)
            continue;
        met++;
        o = &g.scene.objects[hit.obj];
        ck_assert(off_box(o->reals, o->nreals / 3, hit.p) < 2 * warp);
        rad_madd(away.dir, s.dir,
                 -geom_rand(key, 7, 0, 2) * rad_dot(s.dir, hit.n), hit.n);
        rad_normalize(away.dir);
        rad_geom_leave(&hit, away.dir, away.org);
        ck_assert(!rad_geom_hit_object(geom, hit.obj, &away, &hit, &counts));
    }
    ck_assert_int_gt(met, 10 * N);
}

/* Flat boxes of size 1 in a row, one after the other, or each far from the one
 * before. */
static void
box_in_row(const void *arg, uint32_t i, struct rad_box *box)
{
    const uint32_t *stride = arg;
    double x = (double)((uint64_t)i * *stride % 10000);

    *box = (struct rad_box){ { x, 0, 0 }, { x + 1, 1, 0 } };
}

static const struct {
    uint32_t stride, rays;
    bool small;
} rows[] = {
    { 1, 0, false },
    { 1, 800, true },
    { 1, 1000000, false }, /* too many for groups */
    { 7919, 800, false },  /* they would meet most groups */
};

LOOP_TEST(a_tree_for_few_rays_is_small, N_ELEM(rows))
{
    struct rad_bvh_items items = { box_in_row, &rows[_i].stride, 10000, 0 };
    uint32_t order[10000];
    struct rad_bvh all, few;

    ck_assert_int_eq(rad_bvh_build(&all, &items, order, NULL), 0);
    items.rays = rows[_i].rays;
    ck_assert_int_eq(rad_bvh_build(&few, &items, order, NULL), 0);
    ck_assert_int_eq(few.nnodes < all.nnodes / 2, rows[_i].small);
    rad_bvh_release(&few);
    rad_bvh_release(&all);
}

/* One ray's answers by one kernel. */
struct answer {
    struct rad_hit hit, first;
    struct rad_line line;
    bool shadow;
    int32_t blocker;
    struct rad_geom_counts counts;
};

static void
ask(const struct rad_kernel *k, const struct rad_span *span, struct answer *a)
{
    struct rad_line line;

    memset(a, 0, sizeof *a);
    a->blocker = RAD_VOID;
    rad_geom_use(geom, k);
    rad_geom_nearest(geom, span, &a->hit, &a->counts);
    rad_geom_first(geom, span, &a->first, &line, &a->counts);
    a->line.n = line.n;
    a->line.open = line.open;
    for (int i = 0; i < line.n; i++) {
        a->line.at[i].t = line.at[i].t;
        a->line.at[i].item = line.at[i].item;
    }
    a->shadow = is_blocked(geom, span, RAD_VOID, &a->blocker, &a->counts);
}

LOOP_TEST(kernels_give_the_same_bits, N_ELEM(place))
{
    double size = place[_i].size, off = place[_i].offset;
    const double c[3] = { off, -off, off };
    const struct rad_kernel *const *k;

    geom_scene_init(&g, NSURFACES, NSURFACES * 12);
    for (uint64_t i = 0; i < NSURFACES; i++)
        add_random(rad_key_branch(7, i), size, c);
    geom = geom_scene_compile(&g);
    for (uint64_t i = 0; i < NRAYS; i++) {
        struct rad_span s = random_ray(rad_key_branch(98, i), size, c);
        struct answer want, got;

        ask(&rad_kernel_plain, &s, &want);
        for (k = rad_kernels(); *k; k++) {
            if (!(*k)->usable())
                continue;
            ask(*k, &s, &got);
            /* all of it: hit, blocker, and what was visited on the way */
            ck_assert_msg(memcmp(&got, &want, sizeof got) == 0, "%s, ray %d",
                          (*k)->name, (int)i);
        }
    }
}

/* Numbers of every size and kind, as a hostile scene may hold them. */
static double
wild(uint64_t key, uint32_t dim)
{
    static const double odd[] = { 0,        -0.,       1,     -1,     NAN,
                                  INFINITY, -INFINITY, 1e308, -1e308, 4.9e-324,
                                  1e-308,   1e154,     1e77,  -1e38,  1e-40 };

    if (rad_rand(key, dim) < .5)
        return odd[(int)geom_rand(key, dim + 100, 0, N_ELEM(odd))];
    return ldexp(geom_rand(key, dim + 200, -1, 1),
                 (int)geom_rand(key, dim + 300, -80, 80));
}

LOOP_TEST(wild_numbers_do_no_harm, 4)
{
    static const enum rad_otype types[] = { RAD_POLYGON, RAD_SPHERE, RAD_CONE,
                                            RAD_CYLINDER, RAD_RING };
    static const int nreals[] = { 12, 4, 8, 7, 8 };
    struct rad_geom_counts counts = { 0 };
    const struct rad_kernel *const *k = rad_kernels();

    geom_scene_init(&g, NSURFACES, NSURFACES * 12);
    for (uint64_t i = 0; i < NSURFACES; i++) {
        uint64_t key = rad_key_branch((uint64_t)_i, i);
        int type = (int)geom_rand(key, 99, 0, N_ELEM(types));
        double v[12];

        for (uint32_t j = 0; j < 12; j++) /* most are finite in part 0 */
            v[j] = _i ? wild(key, j) : geom_rand(key, j, -9, 9);
        geom_scene_add(&g, types[type], RAD_VOID, RAD_SURF_OPAQUE, v,
                       nreals[type]);
    }
    geom = geom_scene_compile(&g);
    for (uint64_t i = 0; i < NRAYS; i++) {
        uint64_t key = rad_key_branch(77, i);
        struct rad_span s = { .tmin = 0, .tmax = INFINITY };
        struct rad_hit hit;

        for (uint32_t a = 0; a < 3; a++)
            s.org[a] = wild(key, a);
        geom_rand_dir(key, 20, s.dir);
        if (i % 4 == 0)
            s.dir[i / 4 % 3] = i % 8 ? 4.9e-324 : -0.;
        while (!*k || !(*k)->usable())
            k = *k ? k + 1 : rad_kernels();
        rad_geom_use(geom, *k++);
        if (rad_geom_nearest(geom, &s, &hit, &counts)) {
            ck_assert(hit.t > 0 && hit.t < INFINITY);
            ck_assert(hit.obj >= 0 && hit.obj < NSURFACES);
            ck_assert(is_blocked(geom, &s, RAD_VOID, NULL, &counts));
        }
    }
}

/* Sizes in a geometric row make the deepest trees: each split takes few off.
 * And a thousand surfaces in one place, which no split can part. */
LOOP_TEST(lopsided_trees_are_walked_whole, 2)
{
    enum { N = 1000 };
    struct rad_geom_counts counts = { 0 };
    struct rad_hit hit;

    geom_scene_init(&g, N, 4 * N);
    for (int i = 0; i < N; i++)
        if (_i == 0)
            GEOM_ADD(&g, RAD_SPHERE, ldexp(1, i - N / 2), 0, 0,
                     ldexp(.3, i - N / 2));
        else
            GEOM_ADD(&g, RAD_SPHERE, 1, 2, 3, 1);
    /* the largest are beyond 2^170 and left out, as geom.h says */
    geom = geom_scene_compile(&g);
    for (int i = _i == 0 ? N / 2 - 400 : 0; i < N - 331; i++) {
        double r = ldexp(1, i - N / 2);
        struct rad_span s = geom_span(r, 0, r, 0, 0, -1);

        if (_i == 1)
            s = geom_span(1, 2, 9, 0, 0, -1);
        ck_assert_msg(rad_geom_nearest(geom, &s, &hit, &counts), "%d", i);
        /* of those in one place the last wins */
        ck_assert_int_eq(hit.obj, _i == 0 ? i : N - 1);
    }
}

static void
name_kernels(void)
{
    const struct rad_kernel *const *k;

    printf("kernels:");
    for (k = rad_kernels(); *k; k++)
        printf(" %s%s", (*k)->name, (*k)->usable() ? "" : " (not here)");
    printf("\n");
}

int
main(void)
{
    name_kernels();
    return unit_run();
}
