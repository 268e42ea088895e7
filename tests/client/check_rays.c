/* check_rays.c - tests of client/rays: radscene's sub-command rays */
#include "config.h"

#include "rays.h"
#include "scene/file/parse.h"
#include "tests/unit.h"

#include <math.h>
#include <string.h>

static const char scene_text[] =
    "void glow g 0 0 4 .1 .25 1 0 g source s 0 0 4 0 0 1 180\n"
    "void light l 0 0 3 1e4 2e4 3e4 l source sun 0 0 4 0 0 1 .5\n"
    "void plastic m 0 0 5 .5 .5 .5 0 0\n"
    "m polygon p 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n";

static const char *scene = scene_text;

/* Run with options and input; the output is in buf.  Returns rays_run()'s
 * code or that of what is wrong before. */
static int
run(const char *options, const char *input, char *buf, size_t size,
    struct rad_error *err)
{
    char words[256], name[] = "rays", *argv[32] = { name }, *save = NULL;
    struct rad_scene *s = rad_scene_new();
    FILE *in = tmpfile(), *out = tmpfile();
    struct rad_fault faults[RAD_MAX_FAULTS];
    struct rays_options o;
    struct words w;
    int argc = 1, rc;
    size_t n;

    ck_assert(s && in && out);
    strcpy(words, options);
    for (char *p = strtok_r(words, " ", &save); p;
         p = strtok_r(NULL, " ", &save))
        argv[argc++] = p;
    ck_assert_int_eq(words_init(&w, argc, argv, err), 0);
    rc = rays_options(&o, &w, err);
    if (rc >= 0) {
        ck_assert_str_eq(w.list[rc], "scene.rad");
        ck_assert_int_eq(
            rad_parse_text(s, scene, strlen(scene), "scene.rad", NULL, err), 0);
        ck_assert_int_eq(rad_scene_check(s, NULL, NULL, err), 0);
        fputs(input, in);
        rewind(in);
        rc = rays_run(&o, &(struct rays_scene){ .scene = s }, in, out, faults,
                      err);
    }
    rewind(out);
    n = fread(buf, 1, size - 1, out);
    buf[n] = '\0';
    fclose(in);
    fclose(out);
    words_release(&w);
    rad_scene_free(s);
    return rc;
}

static const struct {
    const char *options, *input, *output;
} good[] = {
    { "scene.rad", "5 5 5 1 0 1\n", "0.100000001 0.25 1\n" },
    /* one line for each, blank ones aside; no direction sees nothing */
    { "scene.rad", "-5 5 -5  0 0 -2\n\n \t1 1 1 0 0 0\r\n5 5 5 1 0 1",
      "0 0 0\n0 0 0\n0.100000001 0.25 1\n" },
    { "-av 1 1 1 scene.rad", "5 5 -5 0 0 1\n", "0.5 0.5 0.5\n" },
    { "-dv- scene.rad", "5 5 5 1 0 1\n5 5 5 0 0 1\n",
      "0.100000001 0.25 1\n0 0 0\n" },
    { "scene.rad", "", "" },
};

/* A wall of reflectance s(nm) under a lamp of l(nm), both linear in 40 nm, as
 * its own bands have them: the radiance is rho E / pi in each, E that of a
 * distant lamp straight above, L pi sin^2 of half its angle. */
static const char bands_text[] =
    "void spectrum s 0 0 12 400 760 .1 .2 .3 .4 .5 .6 .7 .8 .9 1\n"
    "s plastic m 0 0 5 .5 .5 .5 0 0\n"
    "void spectrum l 0 0 12 400 760 10 9 8 7 6 5 4 3 2 1\n"
    "l light lamp 0 0 3 1e4 1e4 1e4 lamp source sun 0 0 4 0 0 1 .5\n"
    "m polygon p 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n";

TEST(spectrum_under_a_spectral_lamp)
{
    struct rad_error err = { 0 };
    double half = .25 * M_PI / 180, v;
    char buf[512], *at = buf;
    int used, rc;

    scene = bands_text;
    rc = run("-cs 10 -cw 380 780 -co+ -dj 0 scene.rad", "0 0 5 0 0 -1\n", buf,
             sizeof buf, &err);
    scene = scene_text;
    ck_assert_msg(rc == 0, "%s: %s", err.where, err.what);
    for (int i = 0; i < 10; i++, at += used) {
        int nth = 9 - i; /* from the short waves on */
        double rho = .5 * .1 * (nth + 1), L = 1e4 * (10 - nth);
        double want = rho * L * sin(half) * sin(half);

        ck_assert_int_eq(sscanf(at, "%lf%n", &v, &used), 1);
        ck_assert_double_eq_tol(v, want, 1e-5 * want);
    }
    ck_assert_str_eq(at, "\n");
}

LOOP_TEST(each_line_gives_one, N_ELEM(good))
{
    struct rad_error err = { 0 };
    char buf[512];
    int rc = run(good[_i].options, good[_i].input, buf, sizeof buf, &err);

    ck_assert_msg(rc == 0, "%s: %s", err.where, err.what);
    ck_assert_str_eq(buf, good[_i].output);
}

/* L * 2 pi (1 - cos(.25 degrees)) */
TEST(irradiance_is_of_a_point_and_normal)
{
    struct rad_error err = { 0 };
    double r, g, b;
    char buf[512];

    ck_assert_int_eq(
        run("-I -ab 0 scene.rad", "5 5 0 0 0 1\n", buf, sizeof buf, &err), 0);
    ck_assert_int_eq(sscanf(buf, "%lf %lf %lf", &r, &g, &b), 3);
    ck_assert_double_eq_tol(r, .5981, .0001);
    ck_assert_double_eq_tol(g, 2 * r, 1e-6);
    ck_assert_double_eq_tol(b, 3 * r, 1e-6);
    /* and none from below */
    ck_assert_int_eq(
        run("-I scene.rad", "5 5 0 0 0 -1\n", buf, sizeof buf, &err), 0);
    ck_assert_str_eq(buf, "0 0 0\n");
}

static const struct {
    const char *options, *input;
    int code;
    const char *where, *what;
} bad[] = {
    { "scene.rad", "1 2 3 4 5\n", RAD_EDATA, "stdin:1",
      "expected six numbers, got 5" },
    { "scene.rad", "1 2 3 4 5 6\n1 2 3 4 5 6 7\n", RAD_EDATA, "stdin:2",
      "expected six numbers, got 7" },
    { "scene.rad", "\n\n1 2 x 4 5 6\n", RAD_EDATA, "stdin:3",
      "'x' is not a number" },
    { "scene.rad", "1 2 nan 4 5 6\n", RAD_EDATA, "stdin:1",
      "'nan' is not a number" },
    { "scene.rad", "1 2 3-4 5 6\n", RAD_EDATA, "stdin:1",
      "'3-4' is not a number" },
    { "scene.rad", "1 2 3 4 5 1e999\n", RAD_EDATA, "stdin:1",
      "'1e999' is not a number" },
    { "-q scene.rad", "", RAD_EUSAGE, "", "unknown option '-q'" },
    { "-I -ab 0", "", RAD_EUSAGE, "", "no scene file" },
    { "", "", RAD_EUSAGE, "", "no scene file" },
    { "scene.rad -", "", RAD_EUSAGE, "",
      "the standard input has the rays, not a scene" },
};

LOOP_TEST(bad_input_is_told_with_its_line, N_ELEM(bad))
{
    struct rad_error err = { 0 };
    char buf[512];

    ck_assert_int_eq(run(bad[_i].options, bad[_i].input, buf, sizeof buf, &err),
                     bad[_i].code);
    ck_assert_str_eq(err.where, bad[_i].where);
    ck_assert_str_eq(err.what, bad[_i].what);
}
