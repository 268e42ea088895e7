/* check_func.c - tests of src/pattern/func.c: functions as patterns, textures
 * and mixtures
 *
 * A square in the plane z = 0 glows with radiance 1 and lights nothing, so that
 * what comes back from it is its pattern. */
#include "config.h"

#include "base/rng.h"
#include "tests/world_fixture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

FIXTURE(NULL, world_tear_down)

#define SQUARE " polygon s 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
#define SHINE                                                                  \
    " glow m 0 0 4 1 1 1 -1\n"                                                 \
    "m" SQUARE
#define PLAIN "-av 0 0 0 -st 0 -lw 0 -lr 30 -ss 0"

/* The only file that there is. */
#define OWN "lib/own.cal"

/* What is seen of the point (2, 3, 0) from (2, 3, 4). */
static struct rad_rgb
see(const char *scene, const char *file)
{
    struct world_file own[] = { { OWN, file }, { 0 } };
    struct rad_files files = { .read = world_file_read, .arg = own };

    return world_glance(scene, PLAIN, file ? &files : NULL, 2, 3, 4, 0, 0, -1);
}

static const struct {
    const char *pattern; /* the strings of a brightfunc in "." */
    double value;
} bright[] = {
    { "2 Px*10+Py .", 23 },
    { "2 T .", 4 },
    { "2 Ts .", 4 },
    { "2 Rdot .", 1 },
    { "2 2-Dz .", 3 },
    { "2 Nz+A2*AC .", 13 },
    { "4 Px . -s .5", 4 },
    { "4 T . -s .5", 8 },
    { "4 S . -s .5", 2 },
    { "6 Px*10+Py . -t 1 1 0", 12 },
    { "4 Px*10+Py . -rz 90", 28 }, /* (2,3) was (3,-2) */
    { "4 2-Dz . -s -3", 1 },       /* directions are turned, not scaled */
    { "6 U . -t 0 -1 0", 2 },
    { "2 1+atan2(Lu,Ty) .", 1 }, /* Ty is 0, not -0 */
    { "2 sqrt(-Px) .", 1 },      /* no value: no effect */
    { "2 1/(Px-2) .", 1 },
    { "2 arg(AC+1) .", 1 },
};

LOOP_TEST(brightness_is_the_functions_value, N_ELEM(bright))
{
    char scene[512];

    snprintf(scene, sizeof scene, "void brightfunc p %s 0 3 5 4 6\np" SHINE,
             bright[_i].pattern);
    ck_assert_double_eq_tol(see(scene, NULL).g, bright[_i].value, 1e-5);
}

TEST(colour_has_a_function_for_each_channel)
{
    struct rad_rgb L =
        see("void colorfunc p 4 Px Py Px*Py . 0 0\np" SHINE, NULL);

    ck_assert_double_eq_tol(L.r, 2, 1e-6);
    ck_assert_double_eq_tol(L.g, 3, 1e-6);
    ck_assert_double_eq_tol(L.b, 6, 1e-6);
}

/* Whether a colour has a value is asked when all of it was evaluated, from blue
 * to red: a library function drops the fault of a channel before it. */
static const struct {
    const char *colors;
    struct rad_rgb value;
} faulty[] = {
    { "sqrt(-Px) Py Px", { 1, 1, 1 } },
    { "Px sqrt(-Px) Py", { 1, 1, 1 } },
    { "Px Py sqrt(-Px)", { 1, 1, 1 } },
    { "Px floor(Py) sqrt(-Px)", { 2, 3, 0 } },
    { "floor(Px) Py sqrt(-Px)", { 2, 3, 0 } },
    { "floor(Px) sqrt(-Px) Py", { 2, 0, 3 } },
    { "sqrt(-Px) floor(Px) floor(Py)", { 1, 1, 1 } },
    { "4 sqrt(-Px) floor(Py)", { 1, 1, 1 } },
    { "floor(Px) 4 1/(Px-2)", { 2, 4, 0 } },
};

LOOP_TEST(colour_has_a_value_if_its_last_channel_has, N_ELEM(faulty))
{
    struct rad_rgb want = faulty[_i].value, L;
    char scene[512];

    snprintf(scene, sizeof scene, "void colorfunc p 4 %s . 0 0\np" SHINE,
             faulty[_i].colors);
    L = see(scene, NULL);
    ck_assert_msg(fabs(L.r - want.r) + fabs(L.g - want.g) + fabs(L.b - want.b) <
                      1e-5,
                  "%s: %g %g %g", faulty[_i].colors, L.r, L.g, L.b);
}

TEST(function_file_is_found_and_has_its_arguments)
{
    struct rad_rgb L =
        see("void brightfunc p 2 twice lib/own.cal 0 1 5\n"
            "p brightfunc q 2 1+twice lib/own.cal 0 1 .5\nq" SHINE,
            "f(x) = 2*x;\ntwice = f(A1);\n");

    ck_assert_double_eq_tol(L.g, 10 * 2, 1e-5);
}

TEST(texture_tilts_the_normal)
{
    /* a mirror tilted by .1 looks .2 away from the zenith */
    struct rad_rgb L =
        see("void brightfunc up 2 Dz . 0 0\nup glow sky 0 0 4 1 1 1 0\n"
            "sky source s 0 0 4 0 0 1 180\n"
            "void texfunc t 6 0 A1 0 . -rz -90 0 1 .10033467208545055\n"
            "t metal m 0 0 5 1 1 1 1 0\nm" SQUARE,
            NULL);

    ck_assert_double_eq_tol(L.g, cos(.2), 1e-6);
}

/* A distant source is at no place: its functions see where it is seen from, as
 * in Radiance, by the eye or by what it lights. */
TEST(distant_source_has_the_place_it_is_seen_from)
{
    static const double at[3] = { 4, 0, 0 }, up[3] = { 0, 0, 1 };
    struct rad_ray r;

    world_open(&w,
               "void brightfunc p 2 Px+Pz/4 . 0 0\np glow g 0 0 4 2 2 2 0\n"
               "g source sky 0 0 4 0 0 1 180\n"
               "p light l 0 0 3 50 50 50\nl source sun 0 0 4 0 0 1 10\n",
               "");
    ck_assert_double_eq_tol(world_see(&w, 3, 0, 2, .6, 0, .8).r, 7, 1e-6);
    rad_ray_irradiance(&w.ctx, &r, at, up, 1);
    ck_assert_double_eq_tol(r.L.r / (50 * 2 * M_PI * (1 - cos(5 * M_PI / 180))),
                            4, .02);
}

/* Radiance's bound: what is flat decides how far sources spread gloss. */
TEST(texture_of_a_millionth_is_none)
{
    struct rad_ray r = { .pert = { 6e-7, 6e-7, 0 } };

    ck_assert(!rad_ray_perturbed(&r));
    r.pert[2] = 7e-7;
    ck_assert(rad_ray_perturbed(&r));
}

/* Functions that jump at whole numbers, such as fnoise3(), must not see a level
 * floor's points scattered about its height. */
TEST(points_of_a_level_floor_have_its_height)
{
    static const char scene[] = "void brightfunc p 2 if(Pz,1,if(-Pz,1,2)) . 0 0"
                                "\np" SHINE;

    ck_assert_int_eq(world_try(&w, scene, PLAIN, NULL), 0);
    for (int i = 0; i < 1000; i++) {
        double x = rad_rand(1, 3 * (uint32_t)i), y = rad_rand(2, (uint32_t)i);
        double z = .1 + rad_rand(3, (uint32_t)i);

        ck_assert_double_eq(world_see(&w, x, y, z, y - .7, .6 - x, -z).g, 2);
    }
}

/* What passes is turned by a texture, but not where it rounds off facets. */
static const char *const clear[] = {
    "glass m 0 0 4 1 1 1 1.5",
    "trans m 0 0 7 1 1 1 0 0 1 1",
    "trans2 m 4 1 0 0 . 0 8 1 1 1 0 .001 .001 1 1",
    "BRTDfunc m 10 0 0 0 1 1 1 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
    ("WGMDfunc m 13 void 0 0 0 inherit 1 0 0 void 1 0 0 . "
     "0 9 0 0 0 0 0 0 0 0 0"),
};

LOOP_TEST(texture_called_phong_turns_nothing_that_passes, N_ELEM(clear))
{
    static const char *const name[] = { "Phong", "phong" };

    for (int k = 0; k < 2; k++) {
        struct rad_rgb L[2];

        /* the way through a level pane goes straight down */
        for (int tilted = 0; tilted < 2; tilted++) {
            char scene[1024];

            snprintf(
                scene, sizeof scene,
                "void brightfunc up 2 2+Dx . 0 0\nup glow sky 0 0 4 1 1 1 0"
                "\nsky source s 0 0 4 0 0 -1 180\nvoid %s\n"
                "m texfunc %s 4 %g 0 0 . 0 0\n%s" SQUARE,
                clear[_i], name[k], tilted * .2, name[k]);
            L[tilted] = see(scene, NULL);
        }
        if (k == 0) /* glass reflects as it is tilted */
            ck_assert_double_eq_tol(L[0].g, L[1].g, .003);
        else
            ck_assert_double_gt(fabs(L[0].g - L[1].g), .05);
    }
}

static const struct {
    const char *mixture;
    double r, g;
} mixed[] = {
    { "4 one two Px/8 .", .25, .75 },
    { "4 one two 7 .", 1, 0 },
    { "4 one two -7 .", 0, 1 },
    { "4 one void .25 .", .25, 3 * .75 }, /* the rest shows what is behind */
    { "4 void one .25 .", .75, 3 * .25 },
};

LOOP_TEST(mixture_weighs_its_materials, N_ELEM(mixed))
{
    struct rad_rgb L;
    char scene[512];

    snprintf(scene, sizeof scene,
             "void glow one 0 0 4 1 0 0 -1\nvoid glow two 0 0 4 0 1 0 -1\n"
             "void glow three 0 0 4 0 3 0 -1\n"
             "three ring below 0 0 8 2 3 -1 0 0 1 0 1\n"
             "void mixfunc m %s 0 0\nm" SQUARE,
             mixed[_i].mixture);
    L = see(scene, NULL);
    ck_assert_double_eq_tol(L.r, mixed[_i].r, 1e-6);
    ck_assert_double_eq_tol(L.g, mixed[_i].g, 1e-6);
}

/* -i asks what is mixed: through the glass one sees the lamp below; the other
 * part is lit by nothing. */
TEST(irradiance_goes_through_a_mixture)
{
    struct rad_rgb L;

    world_open(&w,
               "void glass clear 0 0 3 1 1 1\nvoid plastic p 0 0 5 1 1 1 0 0\n"
               "void mixfunc m 4 clear p .75 . 0 0\nm" SQUARE
               "void glow g 0 0 4 8 8 8 -1\n"
               "g ring below 0 0 8 2 3 -1 0 0 1 0 1\n",
               PLAIN " -i");
    L = world_see(&w, 2, 3, 4, 0, 0, -1);
    ck_assert_double_eq_tol(L.g, .75 * 8, 1e-5);
}

static const struct {
    const char *mixture;
    double dist;
} far[] = {
    { "4 p clear 0", 5 }, /* a part that is all there is as one that is most */
    { "4 p clear 1e-7", 5 },
    { "4 clear p 1", 4 },
    { "4 clear p .9999999", 4 },
};

/* Where all is black the second part says how far it is. */
LOOP_TEST(distance_of_black_is_that_of_the_second_part, N_ELEM(far))
{
    char scene[512];
    struct rad_ray r;

    snprintf(scene, sizeof scene,
             "void glass clear 0 0 3 1 1 1\nvoid plastic p 0 0 5 1 1 1 0 0\n"
             "void mixfunc m %s . 0 0\nm" SQUARE
             "p ring below 0 0 8 2 3 -1 0 0 1 0 1\n",
             far[_i].mixture);
    world_open(&w, scene, PLAIN);
    world_ray(&w, &r, 2, 3, 4, 0, 0, -1);
    rad_ray_trace(&w.ctx, &r);
    ck_assert(rad_rgb_black(r.L));
    ck_assert_double_eq_tol(r.dist, far[_i].dist, 1e-6);
}

TEST(mixture_of_patterns_is_a_pattern)
{
    struct rad_rgb L = see("void brightfunc two 2 2 . 0 0\n"
                           "void mixfunc p 4 two void .25 . 0 0\np" SHINE,
                           NULL);

    ck_assert_double_eq_tol(L.g, .25 * 2 + .75, 1e-6);
}

/* Only the first objects are kept, each with all that it failed. */
TEST(failures_are_counted_by_object)
{
    struct rad_counts c = { 0 };

    for (int i = 0; i < 20; i++)
        rad_counts_fault(&c, (i * 7 + 3) % 10);
    for (int i = 0; i < RAD_MAX_FAULTS; i++) {
        ck_assert_int_eq(c.faults[i].object, i);
        ck_assert_uint_eq(c.faults[i].count, 2);
    }
    world_open(&w,
               "void brightfunc good 2 Px . 0 0\n"
               "good brightfunc p 2 log(Px-2) . 0 0\np" SHINE,
               PLAIN);
    world_see(&w, 2, 3, 4, 0, 0, -1);
    world_see(&w, 2, 1, 4, 0, 0, -1);
    world_see(&w, 3, 3, 4, 0, 0, -1);
    ck_assert_int_eq(w.ctx.counts.faults[0].object, 1);
    ck_assert_uint_eq(w.ctx.counts.faults[0].count, 2);
    ck_assert_uint_eq(w.ctx.counts.faults[1].count, 0);
}

/* A texture that has no value at z = 0, and a material on it or below it. */
static const struct {
    const char *material;
    unsigned runs;
} cracked[] = {
    { "void plastic p 0 0 5 1 1 1 0 0\np texfunc m 4 1/Pz 0 0 . 0 0\n", 1 },
    { "void light l 0 0 3 1 1 1\nl texfunc m 4 1/Pz 0 0 . 0 0\n", 0 },
    { "void glow l 0 0 4 1 1 1 0\nl brightfunc b 2 1 . 0 0\n"
      "b texfunc m 4 1/Pz 0 0 . 0 0\n",
      0 },
    { "void plastic p 0 0 5 1 1 1 0 0\nvoid illum l 1 p 0 3 1 1 1\n"
      "l texfunc m 4 1/Pz 0 0 . 0 0\n",
      1 },
    /* on a lamp, but the alias puts it on plastic */
    { "void light l 0 0 3 1 1 1\nl texfunc t 4 1/Pz 0 0 . 0 0\n"
      "void plastic p 0 0 5 1 1 1 0 0\np alias m t\n",
      1 },
};

/* A lamp's light does not depend on the normal. */
LOOP_TEST(texture_is_not_run_for_a_lamp, N_ELEM(cracked))
{
    char scene[512];

    snprintf(scene, sizeof scene, "%sm" SQUARE, cracked[_i].material);
    world_open(&w, scene, PLAIN);
    world_see(&w, 2, 3, 4, 0, 0, -1);
    ck_assert_uint_eq(w.ctx.counts.faults[0].count, cracked[_i].runs);
}

static const struct {
    const char *pattern, *file, *problem;
} bad[] = {
    { "brightfunc p 2 Px*( . 0 0", "", "expected a value, got the end" },
    { "brightfunc p 2 nope . 0 0", "", "undefined variable 'nope'" },
    { "brightfunc p 2 red(nope,1,1) . 0 0", "", "undefined variable 'nope'" },
    { "brightfunc p 2 a other.cal 0 0", "", "other.cal" },
    { "brightfunc p 2 a lib/own.cal 0 0", "a = ;", "lib/own.cal:1" },
    { "brightfunc p 2 a lib/own.cal 0 0", "b = 1;\na = c;", "lib/own.cal:2" },
    { "brightfunc p 4 1 . -s 0 0 0", "", "scales by 0" },
    { "brightfunc p 1 1 0 0", "", "expected at least 2 string arguments" },
    { "mixfunc p 4 void nope 1 . 0 0", "", "undefined modifier 'nope'" },
    /* arguments that any ray would ask for */
    { "brightfunc p 2 A1*A2 . 0 1 .5", "", "missing real argument 2" },
    { "brightfunc p 2 a lib/own.cal 0 0", "a=b(1)+2; b(x)=x*arg(3);",
      "missing real argument 3" },
    { "brightfunc p 2 a lib/own.cal 0 1 .5", "a=if(A2,1,2); c(x,y)=x;",
      "missing real argument 2" },
    { "brightfunc p 2 a lib/own.cal 0 1 .5", "a=c(A2,1); c(x,y)=y+x;",
      "missing real argument 2" },
    { "brightfunc p 2 c(1) lib/own.cal 0 0", "c(x,y)=x*y;",
      "too few arguments for c`lib_own()" },
    { "brightfunc p 2 green(1) . 0 0", "", "too few arguments for green()" },
};

/* Arguments that functions may do without. */
static const struct {
    const char *expression, *file;
} optional[] = {
    { "if(AC-1.5,A2,.5)", "" },
    { "select(A1,.5,A2)", "" },
    { "a", "a=c(A2,1); c(x,y)=y;" },
    { "a", "a=if(1-A1,1,arg(7)); c(x,y)=x;" },
    { "c(1)", "c(x,y)=if(x,x,y);" },
    { "arg(AC)", "" },
    { "red(A1)", "" },
    { "red(A1,nope,A9)", "" },
    { "clip_g(nope(1),1,1/0)", "" },
};

LOOP_TEST(an_argument_that_may_be_left_out_is_not_missed, N_ELEM(optional))
{
    struct world_file own[] = { { OWN, optional[_i].file }, { 0 } };
    struct rad_files files = { .read = world_file_read, .arg = own };
    char scene[512];

    snprintf(scene, sizeof scene, "void brightfunc p 2 %s %s 0 1 1\np" SHINE,
             optional[_i].expression, optional[_i].file[0] ? OWN : ".");
    ck_assert_msg(world_try(&w, scene, PLAIN, &files) == 0, "%s", w.err.what);
}

LOOP_TEST(bad_function_is_refused_by_name, N_ELEM(bad))
{
    struct world_file own[] = { { OWN, bad[_i].file }, { 0 } };
    struct rad_files files = { .read = world_file_read, .arg = own };
    char scene[512];

    snprintf(scene, sizeof scene, "void %s\np" SHINE, bad[_i].pattern);
    world_refused(scene, PLAIN, &files, bad[_i].problem);
}

TEST(scene_without_functions_has_no_evaluator)
{
    world_open(&w, "void" SHINE, PLAIN);
    ck_assert_ptr_null(w.job->calc);
    ck_assert_ptr_null(w.ctx.calc);
}

TEST(function_file_belongs_to_the_bundle)
{
    static const char *const in_file[] = { "a", "b", "c", "x.cal", "-s", "2" };
    static const char *const alone[] = { "a", ".", "-s", "2" };
    struct rad_object o = { .type = RAD_COLORFUNC,
                            .strings = in_file,
                            .nstrings = N_ELEM(in_file) };

    ck_assert_str_eq(rad_object_file(&o, 0), "x.cal");
    ck_assert_ptr_null(rad_object_file(&o, 1));
    o = (struct rad_object){ .type = RAD_BRIGHTFUNC,
                             .strings = alone,
                             .nstrings = N_ELEM(alone) };
    ck_assert_ptr_null(rad_object_file(&o, 0));
}
