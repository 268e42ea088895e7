/* check_wild.c - numbers that no one writes, in every place of a scene
 *
 * Each primitive that the renderer has stands in a small lit room, with one to
 * three of its arguments replaced by what is huge, tiny, negative, zero or no
 * number.  The scene is refused with words, or it gives a picture whose pixels
 * are finite and not negative, as it is and after a trip through an octree
 * file. */
#include "config.h"

#include "base/rng.h"
#include "scene/octree.h"
#include "scene/octfile.h"
#include "scene/file/parse.h"
#include "tests/unit.h"
#include "wild.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_REALS 15
#define TEXT      20000

/* What is tried.  %s in a scene is its argument list. */
static const struct victim {
    const char *before, *after;
    int n;
    double real[MAX_REALS];
} victims[] = {
    /* clang-format off */
    { "void plastic m 0 0", "m sphere s 0 0 4 0 2 0 .5", 5,
      { .5, .4, .3, .1, .1 } },
    { "void metal m 0 0", "m sphere s 0 0 4 0 2 0 .5", 5,
      { .5, .4, .3, .8, .1 } },
    { "void trans m 0 0", "m sphere s 0 0 4 0 2 0 .5", 7,
      { .5, .4, .3, .1, .1, .5, .5 } },
    { "void plastic2 m 4 Py A1 1 . 0", "m sphere s 0 0 4 0 2 0 .5", 6,
      { .5, .4, .3, .1, .1, .3 } },
    { "void trans2 m 4 1 A8 A5 . 0", "m sphere s 0 0 4 0 2 0 .5", 8,
      { .5, .4, .3, .1, .1, .4, .5, .5 } },
    { "void ashik2 m 4 Nz Nx A7 . 0", "m sphere s 0 0 4 0 2 0 .5", 8,
      { .5, .4, .3, .2, .1, .1, 10, 50 } },
    { "void metfunc m 2 sq . 0", "m sphere s 0 0 4 0 2 0 .5", 4,
      { .5, .4, .3, .4 } },
    { "void transfunc m 2 Ldx . 0", "m sphere s 0 0 4 0 2 0 .5", 9,
      { .5, .4, .3, .1, .5, .5, 1, .5, .2 } },
    { "void BRTDfunc m 10 A10 Rdot .2 A11 .1 A10/A11 sq 0 Ldy . 0",
      "m sphere s 0 0 4 0 2 0 .5", 14,
      { .3, .2, .1, .1, .2, .3, .1, .1, .1, .2, .5, 1, 0, .5 } },
    { "void WGMDfunc m 13 void A10 A11 .1 void .3 A12 A11 void A1 A10 Nz . 0",
      "m sphere s 0 0 4 0 2 0 .5", 12,
      { .3, .2, .1, .1, .2, .3, .1, .1, .1, .2, .1, .2 } },
    { "void prism1 m 5 A1 DxA+A2 DyA+Dy*A3 Dz+A4 . 0",
      "m polygon s 0 0 12 -1 1 -1 1 1 -1 1 1.2 1 -1 1.2 1", 4,
      { .5, .1, 1, .2 } },
    { "void prism2 m 9 fprism_val(3,1,1) fprism_val(0,1,1) fprism_val(1,1,1) "
      "fprism_val(2,1,1) .3 Dx*A1 Dy Dz . 0",
      "m polygon s 0 0 12 -1 1 -1 1 1 -1 1 1.2 1 -1 1.2 1", 10,
      { 1, 2, 0, 1, 1.5, .01, 1, .5, .1, .3 } },
    { "void glass m 0 0", "m sphere s 0 0 4 0 2 0 .5", 4,
      { .9, .8, .7, 1.5 } },
    { "void dielectric m 0 0", "m sphere s 0 0 4 0 2 0 .5", 5,
      { .9, .8, .7, 1.5, 3 } },
    { "void interface m 0 0", "m sphere s 0 0 4 0 2 0 .5", 8,
      { .9, .8, .7, 1.5, .8, .9, .7, 1.3 } },
    { "void light m 0 0", "m sphere s 0 0 4 0 2 0 .5", 3, { 3, 2, 1 } },
    { "void light m 0 0", "m source s 0 0 4 .3 -1 .4 5", 3, { 3, 2, 1 } },
    { "void illum m 0 0", "m ring s 0 0 8 0 2 0 0 -1 0 0 .5", 3,
      { 3, 2, 1 } },
    { "void illum m 1 floor 0", "m ring s 0 0 8 0 2 0 0 -1 0 0 .5", 3,
      { 3, 2, 1 } },
    { "void glow m 0 0", "m sphere s 0 0 4 0 2 0 .5", 4, { 3, 2, 1, 5 } },
    { "void glow m 0 0", "m source s 0 0 4 .3 1 .4 90", 4, { 3, 2, 1, 0 } },
    { "void spotlight m 0 0", "m ring s 0 0 8 0 2 0 0 -1 0 0 .5", 7,
      { 3, 2, 1, 40, 0, -1, .1 } },
    { "lamp source s 0 0", "", 4, { .3, -1, .4, 5 } },
    { "sky source s 0 0", "", 4, { .3, 1, .4, 90 } },
    { "floor sphere s 0 0", "", 4, { 0, 2, 0, .5 } },
    { "lamp sphere s 0 0", "", 4, { 0, 2, 0, .5 } },
    { "water sphere s 0 0", "", 4, { 0, 2, 0, .5 } },
    { "pane bubble s 0 0", "", 4, { 0, 2, 0, .5 } },
    { "floor polygon s 0 0", "", 12,
      { -1, 2, -.5, 1, 2, -.5, 1, 2.5, .5, -1, 2.5, .5 } },
    { "lamp polygon s 0 0", "", 12,
      { -1, 2, -.5, 1, 2, -.5, 1, 2.5, .5, -1, 2.5, .5 } },
    { "lamp polygon s 0 0", "", 15,
      { -1, 2, -.5, 0, 2, .1, 1, 2, -.5, 1, 2, .5, -1, 2, .5 } },
    { "pane polygon s 0 0", "", 9, { -1, 2, -.5, 1, 2, -.5, 1, 2, .5 } },
    { "floor cone s 0 0", "", 8, { 0, 2, -.5, .1, 2, .5, .5, .2 } },
    { "water cup s 0 0", "", 8, { 0, 2, -.5, .1, 2, .5, .5, .2 } },
    { "floor cylinder s 0 0", "", 7, { 0, 2, -.5, .1, 2, .5, .5 } },
    { "lamp cylinder s 0 0", "", 7, { 0, 2, -.5, .1, 2, .5, .5 } },
    { "pane tube s 0 0", "", 7, { 0, 2, -.5, .1, 2, .5, .5 } },
    { "floor ring s 0 0", "", 8, { 0, 2, 0, .1, -1, 0, .2, .6 } },
    { "lamp ring s 0 0", "", 8, { 0, 2, 0, .1, -1, 0, .2, .6 } },
    { "spot ring s 0 0", "", 8, { 0, 2, 0, .1, -1, 0, .2, .6 } },
    { "void brighttext m 2 square ab 0", "m plastic p 0 0 5 .5 .5 .5 0 0 "
      "p polygon s 0 0 12 -1 2 -1 1 2 -1 1 2 1 -1 2 1", 11,
      { -1, 2, 1, 1, 0, 0, 0, 0, -2, .2, 1 } },
    { "void colortext m 2 square ab 0", "m light p 0 0 3 5 5 5 "
      "p polygon s 0 0 12 -1 2 -1 1 2 -1 1 2 1 -1 2 1", 15,
      { -1, 2, 1, 1, 0, 0, 0, 0, -2, .2, .3, .4, 1, .5, 2 } },
    /* clang-format on */
};

static const char room[] =
    "void plastic floor 0 0 5 .5 .5 .5 .05 .1 void light lamp 0 0 3 9 9 9\n"
    "void glow sky 0 0 4 1 1 1 0 void glass pane 0 0 3 .9 .9 .9\n"
    "void dielectric water 0 0 5 .9 .9 .9 1.33 0\n"
    "void spotlight spot 0 0 7 9 9 9 60 0 -1 0\n"
    "floor polygon f 0 0 12 -3 -1 -1 3 -1 -1 3 5 -1 -3 5 -1\n"
    "floor bubble b 0 0 4 0 2 0 9\n"
    "lamp polygon l 0 0 12 -1 1 3 -1 2 3 1 2 3 1 1 3\n";

static const char *const words[] = {
    "0",      "-0",      "1",       "-1",    "1e-30", "-1e-30",
    "1e30",   "-1e30",   "1e-300",  "-1",    "1e300", "-1e300",
    "5e-324", "1.7e308", "1e16",    "-1e16", "1e-16", "1e8",
    "1e20",   "1e39",    "-1e39",   "3e38",  "1e50",  "1e52",
    "1e150",  "1e155",   ".999999", "180",   "360",   "1e-8",
    "nan",    "inf",     "-inf",    "0x10",  "1e",    "-",
};

static const char *const options[] = {
    "-dj 0 -dt .05 -ds .2 -ss 1",
    "-dj .9 -dt 0 -ds .05 -ps 4 -pj 1",
    "-dj .5 -ab 1 -aa .3 -ad 16 -as 0 -ar 16 -av .1 .1 .1",
    "-dj .5 -ab 2 -aa 0 -ad 4 -lr -4 -lw .001 -ds 0",
};

static unsigned char *
read_font(void *arg, const char *name, size_t *len, struct rad_error *err)
{
    static const char font[] = "97 4 0 0 255 0 255 255 0 255\n"
                               "98 3 0 0 255 0 128 255\n";
    unsigned char *copy = malloc(sizeof font);

    (void)arg;
    (void)name;
    (void)err;
    ck_assert_ptr_nonnull(copy);
    memcpy(copy, font, sizeof font);
    *len = sizeof font - 1;
    return copy;
}

static const struct rad_files files = { .read = read_font, .arg = NULL };

static uint32_t
pick(uint64_t key, uint32_t dim, size_t n)
{
    return (uint32_t)(rad_rand(key, dim) * (double)n);
}

/* The text of victim v's scene number `turn`: first each place with each word,
 * then some places at a time, and lists that are too short or too long. */
static void
make_scene(char *text, const struct victim *v, unsigned turn)
{
    uint64_t key = rad_key_pixel(7, 0, turn, (uint32_t)(v - victims));
    unsigned n = (unsigned)v->n, nwords = N_ELEM(words), count = n;
    const char *word[MAX_REALS] = { NULL };
    int len;

    if (turn < n * nwords) {
        word[turn / nwords] = words[turn % nwords];
    } else {
        for (int k = 0; k < 3; k++)
            word[pick(key, (uint32_t)k, n)] =
                words[pick(key, 8 + (uint32_t)k, nwords - 6)];
        if (turn % 8 == 0)
            count = pick(key, 16, 2 * n + 1);
        if (turn % 64 == 1)
            count = 1500;
    }
    len = snprintf(text, TEXT, "%s%s %u", room, v->before, count);
    for (unsigned i = 0; i < count; i++) {
        if (word[i % n])
            len +=
                snprintf(text + len, (size_t)(TEXT - len), " %s", word[i % n]);
        else
            len += snprintf(text + len, (size_t)(TEXT - len), " %g",
                            v->real[i % n]);
        ck_assert_int_lt(len, TEXT);
    }
    snprintf(text + len, (size_t)(TEXT - len), "\n%s\n", v->after);
}

static void
render(const struct rad_scene *s, const char *opts, const char *text)
{
    struct world w = { .scene = NULL };
    struct rad_job *job;

    rad_params_init(&w.params);
    world_options(&w, opts);
    w.params.xres = w.params.yres = WILD_SIDE;
    job = rad_job_new(s, &w.params, &files, &w.err);
    if (!wild_refused(job ? 0 : w.err.code, 0, &w.err, text)) {
        ck_assert(wild_look(job, "VIEW= -vp 0 -1 0 -vd 0 1 0 -vu 0 0 1",
                            DBL_MAX, text));
        ck_assert(wild_look(
            job, "VIEW= -vta -vp 0 2 0 -vd 0 0 -1 -vu 0 1 0 -vh 270 -vv 270",
            DBL_MAX, text));
    }
    rad_job_free(job);
}

/* The scene as it comes out of an octree file. */
static void
render_stored(const struct rad_scene *s, const char *opts, const char *text)
{
    struct rad_memory_out bytes = { NULL, 0, 0 };
    struct rad_sink sink = rad_memory_sink(&bytes);
    struct rad_error err = { 0 };
    struct rad_octree tree;
    int rc = rad_octree_build(&tree, s, RAD_OCTREE_LEAF, &err);

    if (!wild_refused(rc, 0, &err, text)) {
        struct rad_memory_in from;
        struct rad_stream in;
        struct rad_scene *again = rad_scene_new();

        ck_assert_int_eq(rad_octfile_write(s, &tree, &sink, &err), 0);
        from = (struct rad_memory_in){ bytes.bytes, bytes.len };
        in = rad_memory_stream(&from);
        rc = rad_octfile_read(again, NULL, &in, "wild.oct", &err);
        ck_assert_msg(rc == 0, "%s for\n%s", err.what, text);
        ck_assert_int_eq(rad_scene_check(again, NULL, NULL, &err), 0);
        render(again, opts, text);
        rad_scene_free(again);
        free(bytes.bytes);
    }
    rad_octree_release(&tree);
}

LOOP_TEST(wild_numbers_are_refused_or_rendered, N_ELEM(victims))
{
    const struct victim *v = &victims[_i];
    unsigned turns = (unsigned)(v->n * N_ELEM(words)) + 100;
    char *text = malloc(TEXT);

    ck_assert_ptr_nonnull(text);
    for (unsigned t = 0; t < turns; t++) {
        struct rad_scene *s = rad_scene_new();
        struct rad_error err = { 0 };
        const char *opts = options[t % N_ELEM(options)];

        make_scene(text, v, t);
        int rc = rad_parse_text(s, text, strlen(text), "wild.rad", NULL, &err);

        if (rc == 0)
            rc = rad_scene_check(s, NULL, NULL, &err);
        if (!wild_refused(rc, 0, &err, text)) {
            if (t % 3 == 0)
                render_stored(s, opts, text);
            else
                render(s, opts, text);
        }
        rad_scene_free(s);
    }
    free(text);
}
