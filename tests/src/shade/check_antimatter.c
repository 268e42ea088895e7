/* check_antimatter.c - tests of src/shade/antimatter.c: holes in surfaces */
#include "config.h"

#include "tests/parts.h"
#include "tests/world_fixture.h"

#include <stdio.h>

FIXTURE(NULL, world_tear_down)

/* A wall at z = 0 that faces up, and a bright ground behind it. */
#define WALL                                                                   \
    "void glow bright 0 0 4 7 7 7 0\nbright ring ground 0 0 8 0 0 -5 0 0 1 0 " \
    "99\nvoid plastic wall 0 0 5 .5 .5 .5 0 0\n"                               \
    "wall polygon w 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"

/* Length of the way down from (x, 0, 5). */
static double
depth(double x)
{
    struct rad_ray r;

    world_ray(&w, &r, x, 0, 5, 0, 0, -1);
    rad_ray_trace(&w.ctx, &r);
    return rad_ray_distance(&r);
}

TEST(hole_in_a_wall_lets_one_see_through)
{
    world_open(&w,
               WALL "void antimatter hole 2 void wall 0 0\n"
                    "hole sphere s 0 0 4 0 0 0 1\n",
               "-av 0 0 0");
    near(world_see(&w, 0, 0, 5, 0, 0, -1).r, 7);
    near(depth(0), 10);
    near(depth(.99), 10);
    near(depth(1.01), 5);
    ck_assert_double_eq(world_see(&w, 1.01, 0, 5, 0, 0, -1).r, 0);
}

TEST(names_that_are_not_there_cut_nothing)
{
    world_open(&w,
               WALL "void antimatter hole 2 void nobody 0 0\n"
                    "hole sphere s 0 0 4 0 0 0 1\n",
               "");
    near(depth(0), 5);
}

/* A part of a mixture cuts what is behind it for that part's light. */
TEST(antimatter_in_a_mixture_cuts_for_its_part)
{
    world_open(&w,
               WALL "void antimatter hole 2 void wall 0 0\n"
                    "void mixfunc some 4 hole void .25 . 0 0\n"
                    "void alias most some\n"
                    "most sphere s 0 0 4 0 0 0 1\n",
               "-av 1 1 1");
    near(world_see(&w, 0, 0, 5, 0, 0, -1).r, .25 * 7 + .75 * .5);
    ck_assert_double_eq(world_see(&w, 1.01, 0, 5, 0, 0, -1).r, .5);
}

/* A lamp behind the wall shines through the hole, and only there. */
TEST(light_falls_through_a_hole)
{
    static const double lit[3] = { 0, 0, -2 }, dark[3] = { 3, 0, -2 };
    static const double up[3] = { 0, 0, 1 };
    struct rad_ray r;

    world_open(&w,
               "void plastic wall 0 0 5 .5 .5 .5 0 0\n"
               "wall polygon w 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
               "void antimatter hole 2 void wall 0 0\n"
               "hole sphere s 0 0 4 0 0 0 1\n"
               "void light l 0 0 3 100 100 100\nl sphere b 0 0 4 0 0 2 .01\n",
               "");
    rad_ray_irradiance(&w.ctx, &r, lit, up, 1);
    near(r.L.r, M_PI * 100 * 1e-4 / 16);
    rad_ray_irradiance(&w.ctx, &r, dark, up, 1);
    ck_assert_double_eq(r.L.r, 0);
}

/* A ball of radius 2 with a ball of radius 1 cut from its top: where the first
 * name is its material, the cut is its surface; where it is void, the ball is
 * hollow. */
static const struct {
    const char *names;
    double depth;
} cut[] = { { "1 ball", 4 }, { "2 void ball", 7 }, { "2 ball void", 4 } };

LOOP_TEST(cut_in_a_solid_shows_its_filling, N_ELEM(cut))
{
    char scene[512];

    snprintf(scene, sizeof scene,
             "void plastic ball 0 0 5 .5 .5 .5 0 0\n"
             "ball sphere b 0 0 4 0 0 0 2\n"
             "void antimatter a %s 0 0\na sphere s 0 0 4 0 0 2 1\n",
             cut[_i].names);
    world_open(&w, scene, "-av 1 1 1");
    near(depth(0), cut[_i].depth);
    near(depth(1.9), 5 - sqrt(4 - 1.9 * 1.9)); /* beside the cut */
    near(world_see(&w, 0, 0, 5, 0, 0, -1).r, .5);
}

/* What reflects in the hole sends its ray back out of it: the wall is still cut
 * away, and not where the ray has left the hole. */
TEST(reflection_stays_on_its_side)
{
    world_open(&w,
               "void plastic wall 0 0 5 .5 .5 .5 0 0\n"
               "wall polygon w 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
               "wall polygon v 0 0 12 -9 9 3 9 9 3 9 -9 3 -9 -9 3\n"
               "void metal mirror 0 0 5 1 1 1 1 0\n"
               "mirror ring m 0 0 8 0 0 -.5 0 .6 .8 0 .3\n"
               "void antimatter hole 2 void wall 0 0\n"
               "hole sphere s 0 0 4 0 0 0 1\n",
               "-av 1 1 1");
    /* down through the hole, off the mirror, and up: w is cut away, v not */
    near(world_see(&w, 0, 0, 2, 0, 0, -1).r, .5);
    ck_assert_double_eq(world_see(&w, 0, 0, 2, 0, .8, -1.2).r, .5f);
}

/* A hole in a hole: within the second the first is not there. */
TEST(antimatter_may_be_cut_away)
{
    world_open(&w,
               WALL "void antimatter hole 2 void wall 0 0\n"
                    "void antimatter plug 2 void hole 0 0\n"
                    "hole cylinder s 0 0 7 0 0 -1 0 0 1 2\n"
                    "hole ring top 0 0 8 0 0 1 0 0 1 0 2\n"
                    "hole ring bottom 0 0 8 0 0 -1 0 0 -1 0 2\n"
                    "plug sphere p 0 0 4 0 0 1 .5\n",
               "");
    near(depth(1), 10);
    near(depth(0), 5);
}

/* Antimatter that is cut away by other antimatter, whose cut shows it, begins
 * where that ends: the ray goes into it there. */
TEST(a_cut_may_show_antimatter)
{
    world_open(&w,
               WALL "void antimatter hole 2 void wall 0 0\n"
                    "hole sphere s 0 0 4 0 0 0 2\n"
                    "void antimatter other 1 hole 0 0\n"
                    "other sphere t 0 0 4 0 0 2 1\n",
               "");
    near(depth(0), 10);
    near(depth(1.5), 10);
    near(depth(2.1), 5);
}

TEST(irradiance_of_the_eye_sees_no_antimatter)
{
    world_open(&w,
               "void plastic wall 0 0 5 .5 .5 .5 0 0\n"
               "wall polygon w 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
               "void antimatter hole 2 void other 0 0\n"
               "hole sphere s 0 0 4 0 0 0 1\n",
               "-i -av 1 1 1");
    near(world_see(&w, 0, 0, 5, 0, 0, -1).r, M_PI);
    near(depth(0), 5);
}

/* Two files of the same ball with the same bite, and their own names for them:
 * neither the one nor the other is whole, whichever is read first. */
static const char *const twice[] = {
    "void instance i 1 a.oct 0 0\nvoid instance j 5 b.oct -t 9 0 0 0 0\n",
    "void instance j 5 b.oct -t 9 0 0 0 0\nvoid instance i 1 a.oct 0 0\n",
};

LOOP_TEST(antimatter_of_one_file_knows_what_another_defines_alike,
          N_ELEM(twice))
{
    static const char bitten[] = "void plastic ball 0 0 5 .5 .5 .5 0 0\n"
                                 "void antimatter a 1 ball 0 0\n"
                                 "ball sphere b 0 0 4 0 0 0 2\n"
                                 "a sphere s 0 0 4 0 0 2 1\n";
    struct parts p = { .n = 0 };
    struct rad_files files = parts_files(&p);

    parts_add_octree(&p, "a.oct", bitten);
    parts_add_octree(&p, "b.oct", bitten);
    ck_assert_int_eq(world_try(&w, twice[_i], "-av 1 1 1", &files), 0);
    near(depth(0), 4);
    near(depth(9), 4);
    near(depth(9 + 1.9), 5 - sqrt(4 - 1.9 * 1.9));
    parts_release(&p);
}
