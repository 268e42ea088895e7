/* check_place.c - instances and meshes: files, transforms, materials */
#include "config.h"

#include "tests/blocked.h"
#include "tests/parts.h"
#include "tests/world_fixture.h"

#include "base/rng.h"
#include "scene/meshfile.h"

#include <math.h>

#define MAT "void plastic m 0 0 5 .5 .5 .5 0 0\n"

static struct parts parts;
static const struct rad_files files = { .read = parts_read, .arg = &parts };

static void
tear_down(void)
{
    world_tear_down();
    parts_release(&parts);
}

FIXTURE(NULL, tear_down)

/* One object at the scene's place, moved there by an instance. */
static const struct {
    const char *what;
    const char *text, *moved; /* as its file has it; as it then lies */
    const char *move;         /* the instance's strings */
} same[] = {
    { "sphere", MAT "m sphere s 0 0 4 1 2 3 1\n",
      MAT "m sphere s 0 0 4 -4 4 6 2\n", "9 part.oct -s 2 -rz 90 -t 0 2 0" },
    { "bubble mirrored", MAT "m bubble s 0 0 4 1 2 3 1\n",
      MAT "m bubble s 0 0 4 -1 2 3 1\n", "2 part.oct -mx" },
    { "turned through the origin", MAT "m sphere s 0 0 4 1 2 3 1\n",
      MAT "m sphere s 0 0 4 -2 -4 -6 2\n", "3 part.oct -s -2" },
    { "triangle", MAT "m polygon p 0 0 9 0 0 0 4 0 0 0 4 1\n",
      MAT "m polygon p 0 0 9 1 1 1 1 5 1 -3 1 2\n",
      "7 part.oct -rz 90 -t 1 1 1" },
    { "cone", MAT "m cone p 0 0 8 0 0 0 0 0 3 2 1\n",
      MAT "m cone p 0 0 8 5 0 0 5 -1.5 0 1 .5\n",
      "9 part.oct -rx 90 -s .5 -t 5 0 0" },
    { "ring repeated", MAT "m ring r 0 0 8 0 0 0 0 0 1 1 4\n",
      MAT "m ring r 0 0 8 3 0 0 0 0 1 1 4\n", "7 part.oct -i 3 -t 1 0 0" },
};

/* Rays meet the copy where they meet the thing itself. */
LOOP_TEST(instance_is_the_moved_thing, N_ELEM(same))
{
    struct world a = { 0 }, b = { 0 };
    char text[256];
    int hits = 0;

    parts_add_octree(&parts, "part.oct", same[_i].text);
    snprintf(text, sizeof text, "void instance i\n%s\n0 0\n", same[_i].move);
    ck_assert_msg(world_try(&a, text, "", &files) == 0, "%s", a.err.what);
    world_open(&b, same[_i].moved, "");
    for (uint64_t k = 0; k < 2000; k++) {
        struct rad_span s = { .tmax = INFINITY };
        struct rad_geom_counts c = { 0 };
        struct rad_hit ha, hb;
        bool met;

        for (int i = 0; i < 3; i++) {
            s.org[i] = 30 * rad_rand(k, (uint32_t)i) - 15;
            s.dir[i] = 8 * rad_rand(k, 3 + (uint32_t)i) - 4 - s.org[i];
        }
        rad_normalize(s.dir);
        met = rad_geom_nearest(b.job->geom, &s, &hb, &c);
        ck_assert_msg(rad_geom_nearest(a.job->geom, &s, &ha, &c) == met,
                      "ray %d", (int)k);
        ck_assert(is_blocked(a.job->geom, &s, RAD_VOID, NULL, &c) == met);
        if (!met)
            continue;
        hits++;
        ck_assert_double_eq_tol(ha.t, hb.t, 1e-12 * 30);
        for (int i = 0; i < 3; i++) {
            ck_assert_double_eq_tol(ha.p[i], hb.p[i], ha.err + hb.err);
            ck_assert_double_eq_tol(ha.n[i], hb.n[i], 1e-12);
        }
        ck_assert_double_lt(ha.err, 1e-12);
        ck_assert_str_eq(a.scene->objects[ha.obj].name,
                         b.scene->objects[hb.obj].name);
    }
    ck_assert_int_gt(hits, 30);
    world_close(&a);
    world_close(&b);
}

/* A flat face keeps the normal that its file gives it, moved with it: mirroring
 * does not turn it over as mirrored vertices would. */
TEST(mirrored_normals_are_mirrored)
{
    struct rad_span s = { { 1, 1, 5 }, { 0, 0, -1 }, 0, INFINITY };
    struct rad_geom_counts c = { 0 };
    struct rad_hit hit;

    parts_add_octree(&parts, "a.oct",
                     MAT "m polygon p 0 0 12 0 0 0 4 0 0 4 4 0 0 4 0\n");
    ck_assert_int_eq(
        world_try(&w, "void instance i 2 a.oct -mx 0 0\n", "", &files), 0);
    s.org[0] = -1;
    ck_assert(rad_geom_nearest(w.job->geom, &s, &hit, &c));
    ck_assert_double_eq(hit.n[2], 1);
    ck_assert_int_eq(
        world_try(&w, "void instance i 2 a.oct -mz 0 0\n", "", &files), 0);
    s.org[0] = 1;
    ck_assert(rad_geom_nearest(w.job->geom, &s, &hit, &c));
    ck_assert_double_eq(hit.n[2], -1);
}

/* Forty levels of two copies, each half as large: 2^40 balls, of which one is
 * met; the number of its copy gives its transform. */
TEST(nested_copies_are_told_apart)
{
    struct rad_geom_counts c = { 0 };
    struct rad_span s = { { 0, 0, 4 }, { 0, 0, -1 }, 0, INFINITY };
    struct rad_xform move;
    struct rad_hit hit;
    char name[16] = "0.oct", text[200];
    double x[3] = { 0, 0, 1 }, at = 0;

    parts_add_octree(&parts, name, MAT "m sphere s 0 0 4 0 0 0 .9\n");
    for (int i = 1; i <= 40; i++) {
        snprintf(text, sizeof text,
                 "void instance a 7 %d.oct -s .5 -t -.5 0 0 0 0\n"
                 "void instance b 7 %d.oct -s .5 -t .5 0 0 0 0\n",
                 i - 1, i - 1);
        snprintf(name, sizeof name, "%d.oct", i);
        parts_add_octree(&parts, name, text);
        at = at / 2 + (i % 3 ? .5 : -.5); /* one of them */
    }
    ck_assert_int_eq(
        world_try(&w, "void instance i 1 40.oct 0 0\n", "", &files), 0);
    s.org[0] = at;
    ck_assert(rad_geom_nearest(w.job->geom, &s, &hit, &c));
    ck_assert_double_eq_tol(hit.t, 4 - .9 * 0x1p-40, 1e-14);
    ck_assert(rad_geom_place(&hit, &move));
    ck_assert_double_eq(move.scale, 0x1p-40);
    rad_xform_point(x, &move, x);
    ck_assert_double_eq_tol(x[0], at, 1e-15);
    ck_assert_double_eq_tol(x[2], 0x1p-40, 1e-20);
}

/* What is seen of a ball under a small lamp high above, reflectance .5 or .2 or
 * none. */
static const struct {
    const char *what;
    const char *scene;
    double times; /* the ball's own radiance */
} materials[] = {
    { "theirs", "void instance i 1 ball.oct 0 0\n", 1 },
    { "the instance's",
      "void plastic dark 0 0 5 .2 .2 .2 0 0\n"
      "dark instance i 1 ball.oct 0 0\n",
      .4 },
    { "the outer of two",
      "void plastic dark 0 0 5 .2 .2 .2 0 0\n"
      "dark instance i 1 outer.oct 0 0\n",
      .4 },
    { "the inner of two", "void instance i 1 outer.oct 0 0\n", 2 },
    { "an alias of the same name elsewhere",
      "void plastic m 0 0 5 .1 .1 .1 0 0\nvoid alias n m\n"
      "void instance i 1 ball.oct 0 0\n",
      1 },
};

LOOP_TEST(modifier_replaces_theirs, N_ELEM(materials))
{
    static const char lamp[] = "void light l 0 0 3 1e4 1e4 1e4\n"
                               "l sphere lamp 0 0 4 0 0 100 .5\n";
    char text[512];
    double alone;

    snprintf(text, sizeof text, "%s%s", lamp, MAT "m sphere s 0 0 4 0 0 0 1\n");
    world_open(&w, text, "");
    alone = world_see(&w, 5, 0, 6, -5, 0, -5).r;
    ck_assert_double_gt(alone, .01);
    parts_add_octree(&parts, "ball.oct", MAT "m sphere s 0 0 4 0 0 0 1\n");
    parts_add_octree(&parts, "outer.oct",
                     "void plastic white 0 0 5 1 1 1 0 0\n"
                     "white instance b 1 ball.oct 0 0\n");
    snprintf(text, sizeof text, "%s%s", lamp, materials[_i].scene);
    ck_assert_int_eq(world_try(&w, text, "", &files), 0);
    ck_assert_double_eq_tol(world_see(&w, 5, 0, 6, -5, 0, -5).r,
                            materials[_i].times * alone, 1e-6 * alone);
    /* one file, one reading, however many copies (when it was made, once) */
    ck_assert_int_le(parts.list[0].reads, 2);
}

/* Light on a floor at the origin, under a lamp, with an instance between. */
static const struct {
    const char *what;
    const char *part, *modifier;
    double least, most; /* of the free light */
} shades[] = {
    { "opaque", MAT "m sphere s 0 0 4 0 0 0 1\n", "void", 0, 0 },
    { "glass", "void glass g 0 0 3 .9 .9 .9\ng ring s 0 0 8 0 0 0 0 0 1 0 1\n",
      "void", .7, .95 },
    { "glass in front of stone",
      MAT "void glass g 0 0 3 .9 .9 .9\n"
          "g ring s 0 0 8 0 0 1 0 0 1 0 1\nm ring t 0 0 8 0 0 0 0 0 1 0 1\n",
      "void", 0, 0 },
    { "stone made glass", MAT "m ring s 0 0 8 0 0 0 0 0 1 0 1\n", "clear", .7,
      .95 },
    { "glass made stone",
      "void glass g 0 0 3 .9 .9 .9\ng ring s 0 0 8 0 0 0 0 0 1 0 1\n", "stone",
      0, 0 },
    { "nothing at all", "void ring s 0 0 8 0 0 0 0 0 1 0 1\n", "void", 1, 1 },
    { "no surface", "void plastic p 0 0 5 1 1 1 0 0\n", "void", 1, 1 },
};

LOOP_TEST(shadows_of_instances_are_their_materials, N_ELEM(shades))
{
    static const char room[] =
        "void light l 0 0 3 1e4 1e4 1e4\nl sphere lamp 0 0 4 0 0 100 .5\n" MAT
        "m ring floor 0 0 8 0 0 0 0 0 1 0 50\n"
        "void glass clear 0 0 3 .9 .9 .9\nvoid alias stone m\n";
    char text[700];
    double alone;

    world_open(&w, room, "");
    alone = world_see(&w, 5, 0, 5, -5, 0, -5).r;
    parts_add_octree(&parts, "a.oct", shades[_i].part);
    snprintf(text, sizeof text, "%s%s instance i 5 a.oct -t 0 0 20 0 0\n", room,
             shades[_i].modifier);
    ck_assert_int_eq(world_try(&w, text, "", &files), 0);
    for (int again = 0; again < 2; again++) { /* with a remembered blocker */
        double seen = world_see(&w, 5, 0, 5, -5, 0, -5).r;

        ck_assert_double_ge(seen, (shades[_i].least - 1e-6) * alone);
        ck_assert_double_le(seen, (shades[_i].most + 1e-6) * alone);
    }
}

/* A light in an instance is seen, and lights nothing; nor does what the
 * instance gives its own material to. */
static const char *const copied_lights[] = { "void",
                                             "void light o 0 0 3 7 7 7\no" };

LOOP_TEST(lights_within_are_no_sources, N_ELEM(copied_lights))
{
    char scene[200];

    parts_add_octree(
        &parts, "lamp.oct",
        "void light l 0 0 3 7 7 7\nl cone c 0 0 8 0 0 0 0 0 1 1 0\n"
        "l sphere lamp 0 0 4 0 0 9 1\n");
    snprintf(scene, sizeof scene,
             MAT "m ring floor 0 0 8 0 0 0 0 0 1 0 50\n"
                 "%s instance i 5 lamp.oct -t 0 0 3 0 0\n",
             copied_lights[_i]);
    ck_assert_int_eq(world_try(&w, scene, "", &files), 0);
    ck_assert_double_eq(world_see(&w, 9, 0, 12, -1, 0, 0).r, 7);
    ck_assert_double_eq(world_see(&w, 9, 0, 5, -1, 0, -1).r, 0);
}

/* A pattern's coordinates are those of the file: it moves with the instance,
 * and not when the instance's own modifier has it. */
TEST(patterns_move_along)
{
    static const char half[] =
        "void brightfunc f 2 if(Px,1,0) . 0 0\nf glow g 0 0 4 1 1 1 0\n";
    char text[400];

    snprintf(text, sizeof text, "%sg ring r 0 0 8 0 0 0 0 0 1 0 50\n", half);
    parts_add_octree(&parts, "a.oct", text);
    ck_assert_int_eq(
        world_try(&w, "void instance i 5 a.oct -t 4 0 0 0 0\n", "", &files), 0);
    ck_assert_double_eq(world_see(&w, 5, 0, 9, 0, 0, -1).r, 1);
    ck_assert_double_eq(world_see(&w, 3, 0, 9, 0, 0, -1).r, 0);
    snprintf(text, sizeof text,
             "void brightfunc f 2 if(Px,1,0) . 0 0\nf plastic g 0 0 5 1 1 1 0 "
             "0\ng instance i 5 a.oct -t 4 0 0 0 0\n");
    ck_assert_int_eq(world_try(&w, text, "-av 1 1 1", &files), 0);
    ck_assert_double_eq(world_see(&w, 3, 0, 9, 0, 0, -1).r, 1);
    ck_assert_double_eq(world_see(&w, -3, 0, 9, 0, 0, -1).r, 0);
}

/* A floor that coincides with one inside an instance: the tie rule decides, the
 * later modifier wins, wherever a ray comes from. */
TEST(ties_cross_the_border)
{
    struct rad_geom_counts c = { 0 };

    parts_add_octree(&parts, "a.oct", MAT "m ring in 0 0 8 0 0 0 0 0 1 0 50\n");
    ck_assert_int_eq(world_try(&w,
                               "void plastic n 0 0 5 .5 .5 .5 0 0\n"
                               "n ring out 0 0 8 3 0 1 1 0 1 0 50\n"
                               "void instance i 7 a.oct -ry 45 -t 3 0 1 0 0\n",
                               "", &files),
                     0);
    for (uint64_t k = 0; k < 500; k++) {
        struct rad_span s = { .tmax = INFINITY };
        struct rad_hit hit;

        for (int i = 0; i < 3; i++) {
            s.org[i] = 20 * rad_rand(k, (uint32_t)i) - 10;
            s.dir[i] = rad_rand(k, 3 + (uint32_t)i) - .5;
        }
        rad_normalize(s.dir);
        if (rad_geom_nearest(w.job->geom, &s, &hit, &c))
            ck_assert_str_eq(w.scene->objects[hit.obj].name, "in");
    }
}

/* Ten thousand rays from the surface of a large, far instance: none meets it
 * again where it starts, and none falls through. */
static const struct {
    const char *what;
    const char *move;
    double scale, at; /* at: along x */
} places[] = {
    { "small", "7 b.oct -s 1e-6 -t 3 0 0", 1e-6, 3 },
    { "large", "5 b.oct -s 1e9 -rx 77", 1e9, 0 },
    { "far", "7 b.oct -rz 33 -t 1e9 0 0", 1, 1e9 },
    { "turned a thousand times", "7 b.oct -i 1000 -rx 7 -ry 3", 1, 0 },
};

LOOP_TEST(surfaces_in_copies_hold, N_ELEM(places))
{
    struct rad_geom_counts c = { 0 };
    double scale = places[_i].scale;
    char text[200];

    parts_add_octree(&parts, "b.oct", MAT "m sphere s 0 0 4 0 0 0 1\n");
    snprintf(text, sizeof text, "void instance i %s 0 0\n", places[_i].move);
    ck_assert_int_eq(world_try(&w, text, "", &files), 0);
    for (uint64_t k = 0; k < 10000; k++) {
        struct rad_span s = { .tmax = INFINITY };
        struct rad_hit hit, next;
        double out[3];

        for (int i = 0; i < 3; i++) {
            s.dir[i] = rad_rand(k, (uint32_t)i) - .5;
            out[i] = rad_rand(k, 3 + (uint32_t)i) - .5;
        }
        rad_normalize(s.dir);
        rad_normalize(out);
        s.org[0] = places[_i].at;
        ck_assert(rad_geom_nearest(w.job->geom, &s, &hit, &c)); /* within */
        rad_copy(s.dir, out);
        rad_geom_leave(&hit, s.dir, s.org);
        if (rad_dot(out, hit.n) > 0)
            ck_assert(!rad_geom_nearest(w.job->geom, &s, &next, &c));
        else
            ck_assert(rad_geom_nearest(w.job->geom, &s, &next, &c) &&
                      next.t > .3 * scale * -rad_dot(out, hit.n));
    }
}

/* --- what cannot be ------------------------------------------------------- */

static const struct {
    const char *scene, *message;
} bad[] = {
    { "void instance i 1 none.oct 0 0\n",
      "test.rad:1: instance 'i': no file 'none.oct'" },
    { "void instance i 3 a.oct -s 0 0 0\n",
      "test.rad:1: instance 'i': transform scales by 0" },
    { "void instance i 2 a.oct wood 0 0\n",
      "test.rad:1: instance 'i': 'wood' is not a transform" },
    { "void instance i 1 loop.oct 0 0\n",
      "loop.oct: instance 'l': 'loop.oct' holds itself" },
    { "void mesh i 1 a.oct 0 0\n",
      "test.rad:1: mesh 'i': a.oct: not a compiled mesh" },
    { "void instance i 1 q.rtm 0 0\n",
      "test.rad:1: instance 'i': q.rtm: not an octree" },
    { "void instance i 1 deep70.oct 0 0\n",
      "deep7.oct: instance 'd': instances are nested more than 64 files deep" },
};

/* Octrees that parts_add_octree() would refuse to make, as it does not find
 * what they name. */
static void
add_wild(struct parts *p, const char *name, const char *text)
{
    struct rad_scene *s = rad_scene_new();
    struct rad_octree tree;
    struct rad_sink out;

    rad_octree_init(&tree);
    ck_assert_int_eq(rad_parse_text(s, text, strlen(text), name, NULL, NULL),
                     0);
    out = parts_add(p, name);
    ck_assert_int_eq(rad_octfile_write(s, &tree, &out, NULL), 0);
    rad_scene_free(s);
}

static void
add_triangle(struct parts *p, const char *name, const char *mods, int modifier)
{
    static const struct parts_vertex v[] = {
        { { 0, 0, 0 }, { .6, 0, .8 }, { .25, .25 } },
        { { 4, 0, 0 }, { .6, 0, .8 }, { .75, .25 } },
        { { 0, 4, 0 }, { -.6, 0, .8 }, { .25, .75 } },
    };
    const struct parts_triangle t = { { 0, 1, 2 }, modifier };
    static const double org[3] = { -4, -4, -4 };

    parts_add_mesh(p, name, org, 16, v, 3, &t, 1, mods);
}

LOOP_TEST(what_cannot_be_is_refused, N_ELEM(bad))
{
    char text[100], name[24], message[600];

    parts_add_octree(&parts, "a.oct", MAT "m sphere s 0 0 4 0 0 0 1\n");
    add_wild(&parts, "loop.oct", "void instance l 1 loop.oct 0 0\n");
    add_triangle(&parts, "q.rtm", MAT, 0);
    for (int i = 1; i <= 70; i++) {
        snprintf(name, sizeof name, "deep%d.oct", i);
        snprintf(text, sizeof text, "void instance d 1 deep%d.oct 0 0\n",
                 i - 1);
        add_wild(&parts, name, text);
    }
    ck_assert_int_lt(world_try(&w, bad[_i].scene, "", &files), 0);
    rad_error_format(&w.err, message, sizeof message);
    ck_assert_ptr_nonnull(strstr(message, bad[_i].message));
}

/* Sixteen copies of sixteen, sixteen times over, are 2^64, besides those with
 * fewer levels. */
TEST(copies_beyond_number_are_refused)
{
    char name[16] = "0.oct", text[2000];

    parts_add_octree(&parts, name, MAT "m sphere s 0 0 4 0 0 0 .9\n");
    for (int i = 1; i <= 16; i++) {
        int n = 0;

        for (int k = 0; k < 16; k++)
            n += sprintf(text + n,
                         "void instance a 7 %d.oct -s .1 -t %d 0 0 0 0\n",
                         i - 1, k);
        snprintf(name, sizeof name, "%d.oct", i);
        parts_add_octree(&parts, name, text);
    }
    ck_assert_int_eq(
        world_try(&w, "void instance i 1 15.oct 0 0\n", "", &files), 0);
    ck_assert_int_eq(
        world_try(&w, "void instance i 1 16.oct 0 0\n", "", &files), RAD_EDATA);
    ck_assert_ptr_nonnull(strstr(w.err.what, "2^64"));
}

/* --- meshes ----------------------------------------------------------------
 */

/* The ray's hit in the instance of add_triangle()'s mesh. */
static void
hit_triangle(struct rad_ray *r, double x, double y)
{
    world_ray(&w, r, x, y, 9, 0, 0, -1);
    rad_ray_trace(&w.ctx, r);
    ck_assert_int_ne(r->hit.obj, RAD_VOID);
}

TEST(mesh_normals_and_coordinates_lie_between_the_corners)
{
    struct rad_ray r;
    double n[3];

    add_triangle(&parts, "q.rtm", MAT, 0);
    ck_assert_int_eq(world_try(&w, "void mesh q 1 q.rtm 0 0\n", "", &files), 0);
    hit_triangle(&r, 1, 1); /* a half of corner 0, a quarter of the others */
    ck_assert_double_eq_tol(r.hit.t, 9, 1e-8);
    ck_assert_double_eq_tol(r.hit.n[2], 1, 1e-12);
    ck_assert_double_eq_tol(r.hit.uv[0], .375, 1e-8);
    ck_assert_double_eq_tol(r.hit.uv[1], .375, 1e-8);
    rad_ray_normal(&r, n); /* .6, 0, .8 by three quarters, and the other */
    ck_assert_double_eq_tol(n[0], .3 / hypot(.3, .8), 2e-4);
    ck_assert_double_eq_tol(n[1], 0, 2e-4);
    ck_assert_double_eq_tol(n[2], .8 / hypot(.3, .8), 2e-4);
    /* its own material, as the mesh has none */
    ck_assert_str_eq(w.scene->objects[r.hit.obj].name, RAD_MESH_FACE);
}

/* A mesh that has coordinates lies below one that has none. */
TEST(mesh_without_coordinates_has_zeros)
{
    static const struct parts_vertex v[] = { { { 0, 0, 1 }, { 0 }, { 0 } },
                                             { { 4, 0, 1 }, { 0 }, { 0 } },
                                             { { 0, 4, 1 }, { 0 }, { 0 } } };
    static const struct parts_triangle t = { { 0, 1, 2 }, 0 };
    static const double org[3] = { -4, -4, -4 };
    struct rad_ray r;

    add_triangle(&parts, "q.rtm", MAT, 0);
    parts_add_mesh(&parts, "bare.rtm", org, 16, v, 3, &t, 1, MAT);
    ck_assert_int_eq(
        world_try(&w,
                  "void mesh q 1 q.rtm 0 0\nvoid mesh bare 1 bare.rtm 0 0\n",
                  "", &files),
        0);
    hit_triangle(&r, 1, 1);
    ck_assert_double_eq_tol(r.hit.t, 8, 1e-8);
    ck_assert_double_eq(r.hit.uv[0], 0);
    ck_assert_double_eq(r.hit.uv[1], 0);
    ck_assert(!r.hit.bent); /* it has no normals either */
}

/* Turned by 90 degrees about z, x goes to y; mirrored, -x. */
TEST(mesh_normals_turn_with_it)
{
    struct rad_ray r;
    double n[3];

    add_triangle(&parts, "q.rtm", MAT, 0);
    ck_assert_int_eq(
        world_try(&w, "void mesh q 5 q.rtm -s 2 -rz 90 0 0\n", "", &files), 0);
    hit_triangle(&r, -2, 2);
    rad_ray_normal(&r, n);
    ck_assert_double_eq_tol(n[1], .3 / hypot(.3, .8), 2e-4);
    ck_assert_double_eq_tol(n[0], 0, 2e-4);
    ck_assert_int_eq(world_try(&w, "void mesh q 2 q.rtm -mx 0 0\n", "", &files),
                     0);
    hit_triangle(&r, -1, 1);
    rad_ray_normal(&r, n);
    ck_assert_double_eq_tol(n[0], -.3 / hypot(.3, .8), 2e-4);
    ck_assert_double_eq_tol(n[2], .8 / hypot(.3, .8), 2e-4);
}

static const struct {
    const char *what;
    const char *materials; /* of the mesh */
    int modifier;
    const char *scene;
    double L;
} surfaces[] = {
    { "its own", "void glow g 0 0 4 3 3 3 0\n", 0, "void mesh q 1 q.rtm 0 0\n",
      3 },
    { "by its coordinates",
      "void brightfunc f 2 Lu . 0 0\nf glow g 0 0 4 8 8 8 0\n", 1,
      "void mesh q 1 q.rtm 0 0\n", 3 },
    { "the mesh's", "void glow g 0 0 4 3 3 3 0\n", 0,
      "void brightfunc f 2 Lv . 0 0\nf plastic p 0 0 5 1 1 1 0 0\n"
      "p mesh q 1 q.rtm 0 0\n",
      .375 },
    { "that of an instance around it", "void glow g 0 0 4 3 3 3 0\n", 0,
      "void plastic p 0 0 5 .5 .5 .5 0 0\np instance q 1 q.oct 0 0\n", .5 },
    { "its own, in an instance", "void glow g 0 0 4 3 3 3 0\n", 0,
      "void instance q 1 q.oct 0 0\n", 3 },
    { "none", "void glow g 0 0 4 3 3 3 0\n", -1,
      "void mesh q 1 q.rtm 0 0\nvoid glow h 0 0 4 5 5 5 0\n"
      "h ring r 0 0 8 0 0 -1 0 0 1 0 9\n",
      5 },
};

LOOP_TEST(mesh_has_its_material_or_ours, N_ELEM(surfaces))
{
    struct rad_ray r;

    add_triangle(&parts, "q.rtm", surfaces[_i].materials,
                 surfaces[_i].modifier);
    parts_add_octree(&parts, "q.oct", "void mesh q 1 q.rtm 0 0\n");
    ck_assert_msg(world_try(&w, surfaces[_i].scene, "-av 1 1 1", &files) == 0,
                  "%s", w.err.what);
    hit_triangle(&r, 1, 1);
    ck_assert_double_eq_tol(r.L.r, surfaces[_i].L, 1e-5);
}

/* A closed octahedron of a mesh: no ray from within gets out, also along its
 * edges and through its corners, in any position. */
LOOP_TEST(closed_mesh_does_not_leak, 3)
{
    static const struct parts_vertex v[] = {
        { { 1, 0, 0 }, { 0 }, { 0 } }, { { -1, 0, 0 }, { 0 }, { 0 } },
        { { 0, 1, 0 }, { 0 }, { 0 } }, { { 0, -1, 0 }, { 0 }, { 0 } },
        { { 0, 0, 1 }, { 0 }, { 0 } }, { { 0, 0, -1 }, { 0 }, { 0 } },
    };
    static const struct parts_triangle t[] = {
        { { 0, 2, 4 }, 0 }, { { 2, 1, 4 }, 0 }, { { 1, 3, 4 }, 0 },
        { { 3, 0, 4 }, 0 }, { { 2, 0, 5 }, 0 }, { { 1, 2, 5 }, 0 },
        { { 3, 1, 5 }, 0 }, { { 0, 3, 5 }, 0 },
    };
    static const double org[3] = { -2, -2, -2 };
    static const char *const moves[] = { "1 o.rtm", "3 o.rtm -s 1e-5",
                                         "9 o.rtm -rx 12 -ry 34 -t 5 6 7" };
    struct rad_geom_counts c = { 0 };
    char text[100];

    parts_add_mesh(&parts, "o.rtm", org, 4, v, 6, t, 8, MAT);
    snprintf(text, sizeof text, "void mesh o %s 0 0\n", moves[_i]);
    ck_assert_int_eq(world_try(&w, text, "", &files), 0);
    for (uint64_t k = 0; k < 20000; k++) {
        struct rad_span s = { .tmax = INFINITY };
        struct rad_hit hit;
        double to[3];

        /* at a corner, a point of an edge, or any */
        for (int i = 0; i < 3; i++) {
            s.org[i] = .4 * rad_rand(k, (uint32_t)i) - .2;
            to[i] = k % 3 == 0   ? v[k % 6].p[i]
                    : k % 3 == 1 ? v[k % 2].p[i] + .5 * v[2 + k % 4].p[i]
                                 : rad_rand(k, 3 + (uint32_t)i) - .5;
        }
        rad_xform_point(s.org, &w.scene->objects[0].use->move, s.org);
        rad_xform_point(to, &w.scene->objects[0].use->move, to);
        rad_sub(s.dir, to, s.org);
        rad_normalize(s.dir);
        ck_assert(rad_geom_nearest(w.job->geom, &s, &hit, &c));
        ck_assert(rad_dot(hit.n, s.dir) > 0);
        ck_assert(is_blocked(w.job->geom, &s, RAD_VOID, NULL, &c));
    }
}

/* A ball that Radiance's obj2mesh made, of 308 quadrangles and triangles in two
 * patches, with normals that point from its middle and u, v that are its height
 * and x, shifted: whatever joins patches must fit. */
TEST(recorded_mesh_is_read)
{
    const char *top = getenv("top_srcdir");
    char path[512];

    snprintf(path, sizeof path, "%s/tests/scenes/ball.rtm", top ? top : ".");
    parts_add(&parts, "ball.rtm");
    parts.list[0].file.bytes =
        rad_file_read(path, 1 << 20, &parts.list[0].file.len, NULL);
    ck_assert_ptr_nonnull(parts.list[0].file.bytes);
    ck_assert_int_eq(world_try(&w, "void mesh b 1 ball.rtm 0 0\n", "", &files),
                     0);
    ck_assert_uint_eq(w.scene->parts[0]->mesh->ntris, 572);
    for (uint64_t k = 0; k < 20000; k++) {
        double d[3], n[3];
        struct rad_ray r;

        for (int i = 0; i < 3; i++)
            d[i] = rad_rand(k, (uint32_t)i) - .5;
        world_ray(&w, &r, .001, .002, .003, d[0], d[1], d[2]);
        rad_ray_trace(&w.ctx, &r);
        ck_assert_int_ne(r.hit.obj, RAD_VOID);
        ck_assert_double_gt(rad_dot(r.hit.n, r.dir), .9);
        rad_madd(n, r.hit.n, 1, r.hit.bend);
        ck_assert_double_gt(rad_dot(n, r.hit.p) / r.hit.t, .995);
        ck_assert_double_eq_tol(r.hit.uv[0], (r.hit.p[2] + 1.1) / 2.2, 1e-4);
        ck_assert_double_eq_tol(r.hit.uv[1], (r.hit.p[0] + 1.1) / 2.2, 1e-4);
    }
}

TEST(normal_codes_are_accurate)
{
    for (uint64_t k = 0; k < 2000; k++) {
        double n[3], back[3];

        for (int i = 0; i < 3; i++)
            n[i] = rad_rand(k, (uint32_t)i) - .5;
        rad_normalize(n);
        rad_mesh_normal(back, parts_normal_code(n));
        ck_assert_double_lt(acos(fmin(rad_dot(n, back), 1)), 2e-4);
    }
}

/* Every beginning of a mesh is refused with the place where it ends. */
TEST(truncated_mesh_is_refused)
{
    add_triangle(&parts, "q.rtm", MAT, 0);
    for (size_t len = 0; len < parts.list[0].file.len; len++) {
        struct rad_memory_in from = { parts.list[0].file.bytes, len };
        struct rad_stream in = rad_memory_stream(&from);
        struct rad_scene *s = rad_scene_new();
        struct rad_part part = { .n = 0 };
        struct rad_error err = { 0 };

        ck_assert_int_eq(rad_meshfile_read(s, &part, &in, "q.rtm", &err),
                         RAD_EDATA);
        ck_assert(err.what[0] && strcmp(err.where, "q.rtm") == 0);
        rad_mesh_free(part.mesh);
        rad_scene_free(s);
    }
}
