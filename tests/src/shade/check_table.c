/* check_table.c - tests of table and mixtext of src/pattern: data files,
 * pictures and writing as patterns, textures and mixtures
 *
 * A square in the plane z = 0 glows with radiance 1 and lights nothing, so that
 * what comes back from it is its pattern. */
#include "config.h"

#include "tests/world.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define SQUARE " polygon s 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
#define SHINE                                                                  \
    " glow m 0 0 4 1 1 1 -1\n"                                                 \
    "m" SQUARE
#define PLAIN "-av 0 0 0 -st 0 -lw 0 -lr 30 -ss 0"

static struct world_file texts[] = {
    { "line.dat", "1 0 10 2 0 10" },                 /* f = x */
    { "sq.dat", "1 0 0 4 0 1 2 3 0 1 4 9" },         /* x^2 at whole numbers */
    { "plane.dat", "2 0 10 2 0 10 2 0 10 100 110" }, /* f = 10x + y */
    { "own.cal", "f(a) = A1*a; g(a,b,c) = a+10*b+100*c; u = Px+1;" },
    { "tilt.cal", "no(a,b,c) = 0; f2(a,b,c) = A1*b/4;" },
    { "box.fnt", "65 4 0 0 255 0 255 255 0 255\n32 0\n" },
    { "a.txt", "A\n" },
    /* one pixel, of (64, 32, 16) + .5 in 128ths */
    { "pixel.hdr", "#?RADIANCE\nEXPOSURE=9\n\n-Y 1 +X 1\n\x40\x20\x10\x81" },
    /* 2 by 1: mantissas 32 and 96 */
    { "two.hdr", "#?RADIANCE\n\n-Y 1 +X 2\n\x20\x20\x20\x81\x60\x60\x60\x81" },
    { 0 }
};
static const struct rad_files files = { .read = world_file_read, .arg = texts };

/* What is seen of the point (2, 3, 0) from (2, 3, 4). */
static struct rad_rgb
see(const char *scene)
{
    return world_glance(scene, PLAIN, &files, 2, 3, 4, 0, 0, -1);
}

#define PIX(m) (((m) + .5) / 128)

static const struct {
    const char *pattern;
    double r, g, b;
} seen[] = {
    { "brightdata p 4 noop line.dat . Px 0 0", 2, 2, 2 },
    { "brightdata p 4 f line.dat own.cal u 0 1 5", 15, 15, 15 },
    { "brightdata p 4 noop sq.dat . Px+.5 0 0", 6.5, 6.5, 6.5 },
    { "brightdata p 5 noop plane.dat . Px Py 0 0", 23, 23, 23 },
    { "brightdata p 9 noop plane.dat . Px Py -t 1 1 0 0 0", 12, 12, 12 },
    { "brightdata p 4 sqrt line.dat . -Px 0 0", 1, 1, 1 }, /* no value */
    { "brightdata p 4 noop line.dat . 1/(Px-2) 0 0", 1, 1, 1 },
    { "colordata p 9 noop noop noop plane.dat plane.dat plane.dat . Px Py 0 0",
      23, 23, 23 },
    { "colordata p 8 red green blue line.dat sq.dat line.dat . Px 0 0", 2, 4,
      2 },
    { "colordata p 8 noop noop noop line.dat sq.dat line.dat . Px 0 0", 2, 4,
      2 },
    { "colordata p 8 g f g line.dat sq.dat line.dat own.cal Px 0 1 3",
      2 + 40 + 200, 3 * 4, 2 + 40 + 200 },
    { "colorpict p 7 red green blue pixel.hdr . Px Py 0 0", PIX(64), PIX(32),
      PIX(16) },
    { "colorpict p 7 noop noop noop pixel.hdr . Px Py 0 0", PIX(64), PIX(32),
      PIX(16) },
    { "colorpict p 7 g f g pixel.hdr own.cal Px Py 0 1 2",
      PIX(64) + 10 * PIX(32) + 100 * PIX(16), 2 * PIX(32),
      PIX(64) + 10 * PIX(32) + 100 * PIX(16) },
    { "colorpict p 9 red green blue two.hdr . Px Py -s 4 0 0", PIX(48), PIX(48),
      PIX(48) },
};

LOOP_TEST(pattern_is_what_the_table_says, N_ELEM(seen))
{
    char scene[512];
    struct rad_rgb L;

    snprintf(scene, sizeof scene, "void %s\np" SHINE, seen[_i].pattern);
    L = see(scene);
    ck_assert_double_eq_tol(L.r, seen[_i].r, 2e-6 * seen[_i].r);
    ck_assert_double_eq_tol(L.g, seen[_i].g, 2e-6 * seen[_i].g);
    ck_assert_double_eq_tol(L.b, seen[_i].b, 2e-6 * seen[_i].b);
}

/* arg: how often, an int. */
static unsigned char *
count_reads(void *arg, const char *name, size_t *len, struct rad_error *err)
{
    ++*(int *)arg;
    return world_file_read(texts, name, len, err);
}

TEST(file_is_read_once)
{
    int reads = 0;
    struct rad_files counted = { .read = count_reads, .arg = &reads };
    struct rad_rgb L = world_glance(
        "void brightdata a 4 noop line.dat . Px 0 0\n"
        "a colordata b 8 noop noop noop line.dat line.dat line.dat . Py 0 "
        "0\n"
        "b colorpict c 7 red green blue pixel.hdr . Px Py 0 0\n"
        "c colorpict d 7 red green blue pixel.hdr . Py Px 0 0\nd" SHINE,
        PLAIN, &counted, 2, 3, 4, 0, 0, -1);

    ck_assert_double_eq_tol(L.r, 6 * PIX(64) * PIX(64), 1e-5);
    ck_assert_int_eq(reads, 2);
}

TEST(texture_tilts_the_normal)
{
    /* a mirror tilted by .1 looks .2 away from the zenith; the data are
     * (2, 4, 2) and the texture (0, 4 k, 0), turned by -90 */
    struct rad_rgb L =
        see("void brightfunc up 2 Dz . 0 0\nup glow sky 0 0 4 1 1 1 0\n"
            "sky source s 0 0 4 0 0 1 180\n"
            "void texdata t 10 no f2 no line.dat sq.dat line.dat tilt.cal Py "
            "-rz -90 0 1 .10033467208545055\n"
            "t metal m 0 0 5 1 1 1 1 0\nm" SQUARE);

    ck_assert_double_eq_tol(L.g, cos(.2), 1e-6);
}

static const struct {
    const char *mixture;
    double r, g;
} mixed[] = {
    { "mixdata m 6 one two noop line.dat . Px/8 0 0", .25, .75 },
    { "mixdata m 6 one two noop line.dat . Px 0 0", 1, 0 },
    { "mixdata m 6 one void noop line.dat . .25 0 0", .25, 3 * .75 },
    { "mixdata m 6 void one noop line.dat . .25 0 0", .75, 3 * .25 },
    { "mixpict m 7 one two blue pixel.hdr . Px Py 0 0", PIX(16), 1 - PIX(16) },
    { "mixpict m 7 one two noop pixel.hdr . Px Py 0 0", PIX(64), 1 - PIX(64) },
    { "mixdata m 6 one two sqrt line.dat . -Px 0 0", 0, 3 }, /* neither */
    /* the letter covers x 1 to 3, y 2 to 4 */
    { "mixtext m 4 one two box.fnt a.txt 0 9 1 4 0 2 0 0 0 -2 0", 1, 0 },
    { "mixtext m 5 one two box.fnt . A 0 9 1 4 0 2 0 0 0 -2 0", 1, 0 },
    { "mixtext m 5 one two box.fnt . A 0 9 3 4 0 2 0 0 0 -2 0", 0, 1 },
    /* with half a cell more on either side the letter covers x 5/3 to 3 */
    { "mixtext m 5 one two box.fnt . A 0 10 1 4 0 2 0 0 0 -2 0 -.5", 1, 0 },
    { "mixtext m 5 one two box.fnt . A 0 10 1.5 4 0 2 0 0 0 -2 0 -.5", 0, 1 },
    { "mixtext m 5 void two box.fnt . A 0 9 1 4 0 2 0 0 0 -2 0", 0, 3 },
    { "mixtext m 4 one two box.fnt . 0 9 1 4 0 2 0 0 0 -2 0", 0, 1 },
    /* a newline in a quoted word begins no line */
    { "mixtext m 5 one two box.fnt . \"\nA\" 0 9 1 4 0 2 0 0 0 -2 0", 1, 0 },
    { "mixtext m 5 one two box.fnt . \"\nA\" 0 9 1 6 0 2 0 0 0 -2 0", 0, 1 },
};

LOOP_TEST(mixture_weighs_its_materials, N_ELEM(mixed))
{
    struct rad_rgb L;
    char scene[512];

    snprintf(scene, sizeof scene,
             "void glow one 0 0 4 1 0 0 -1\nvoid glow two 0 0 4 0 1 0 -1\n"
             "void glow three 0 0 4 0 3 0 -1\n"
             "three ring below 0 0 8 2 3 -1 0 0 1 0 1\n"
             "void %s\nm" SQUARE,
             mixed[_i].mixture);
    L = see(scene);
    ck_assert_double_eq_tol(L.r, mixed[_i].r, 1e-6);
    ck_assert_double_eq_tol(L.g, mixed[_i].g, 1e-6);
}

TEST(mixture_of_patterns_is_a_pattern)
{
    struct rad_rgb L = see("void brightfunc two 2 2 . 0 0\n"
                           "void mixdata p 6 two void noop line.dat . .25 0 0\n"
                           "p mixtext q 5 two void box.fnt . A 0 9 1 4 0 2 0 0 "
                           "0 -2 0\nq" SHINE);

    ck_assert_double_eq_tol(L.g, 2 * (.25 * 2 + .75), 1e-6);
}

static const struct {
    const char *pattern, *problem;
} bad[] = {
    { "brightdata p 4 noop no.dat . Px 0 0", "no.dat" },
    { "brightdata p 4 noop a.txt . Px 0 0", "'a.txt': line 1: expected" },
    { "brightdata p 4 nope line.dat . Px 0 0", "undefined function 'nope'" },
    { "brightdata p 4 1+1 line.dat . Px 0 0", "no name of a function" },
    { "brightdata p 4 noop plane.dat . Px 0 0", "each of 2 dimensions" },
    { "brightdata p 3 noop line.dat . 0 0", "at least 4 string arguments" },
    { "brightdata p 4 noop line.dat . no 0 0", "undefined variable 'no'" },
    { "colordata p 8 red green blue line.dat plane.dat line.dat . Px 0 0",
      "'plane.dat' has 2 dimensions, 'line.dat' has 1" },
    { "colorpict p 7 red green blue line.dat . Px Py 0 0",
      "'line.dat': picture: not a Radiance picture" },
    { "colorpict p 7 red green blue pixel.hdr . Px -s 0 0",
      "undefined variable 's'" },
    { "mixdata p 6 void nope noop line.dat . Px 0 0",
      "undefined modifier 'nope'" },
    { "mixtext p 4 void nope box.fnt a.txt 0 9 1 4 0 2 0 0 0 -2 0",
      "undefined modifier 'nope'" },
    { "mixtext p 4 void void box.fnt a.txt 0 9 1 4 0 2 0 0 2 0 0", "parallel" },
};

LOOP_TEST(bad_table_is_refused_by_name, N_ELEM(bad))
{
    char scene[512];

    snprintf(scene, sizeof scene, "void %s\np" SHINE, bad[_i].pattern);
    world_refused(scene, PLAIN, &files, bad[_i].problem);
}

TEST(scene_without_tables_stores_nothing)
{
    struct world w = { 0 };

    world_open(&w, "void" SHINE, PLAIN);
    ck_assert_ptr_null(w.job->stored);
    world_close(&w);
}

static const struct {
    enum rad_otype type;
    const char *strings; /* one letter each */
    const char *files;   /* those that name files, in order */
} named[] = {
    { RAD_BRIGHTDATA, "abcdef", "bc" }, { RAD_COLORDATA, "abcdefgh", "defg" },
    { RAD_COLORPICT, "abcdefg", "de" }, { RAD_TEXDATA, "abcdefgh", "defg" },
    { RAD_MIXDATA, "abcdef", "de" },    { RAD_MIXPICT, "abcdefg", "de" },
    { RAD_MIXPICT, "abcd.fg", "d" },    { RAD_MIXTEXT, "abcd", "cd" },
    { RAD_MIXTEXT, "abc.ef", "c" },     { RAD_BRIGHTTEXT, "ab", "ab" },
    { RAD_COLORTEXT, "a.cd", "a" },
};

LOOP_TEST(files_belong_to_the_bundle, N_ELEM(named))
{
    char word[16][2] = { { 0 } };
    const char *strings[16];
    struct rad_object o = { .type = named[_i].type, .strings = strings };
    int k = 0;

    for (; named[_i].strings[o.nstrings]; o.nstrings++) {
        word[o.nstrings][0] = named[_i].strings[o.nstrings];
        strings[o.nstrings] = word[o.nstrings];
    }
    for (; named[_i].files[k]; k++) {
        ck_assert_ptr_nonnull(rad_object_file(&o, k));
        ck_assert_int_eq(rad_object_file(&o, k)[0], named[_i].files[k]);
    }
    ck_assert_ptr_null(rad_object_file(&o, k));
}
