/* check_octfile.c - tests of src/scene/octfile.c: octree files written and
 * read, and what is said of cut and damaged ones */
#include "config.h"

#include "base/rng.h"
#include "scene/octree.h"
#include "scene/octfile.h"
#include "scene/file/parse.h"
#include "tests/unit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char text[] =
    "void brightfunc pat 2 1+.1*x . 0 0\n"
    "pat plastic 'a name' 0 0 5 .1 .2 .3 0 1e-300\n"
    "void alias b 'a name'\n"
    "void glass g 0 0 3 .96 .96 .96\n"
    "void illum i 1 g 0 3 1 1 1\n"
    "b polygon p.1 0 0 9 0 0 0 1e9 -1e-9 .1 123456789.123456789 1e40 -1e-40\n"
    "i sphere s 0 0 4 1 -.3 1e100 -2\n"
    "void source sun 0 0 4 0 0 1 .5\n"
    "g ring '' 0 0 8 0 0 0 0 0 1 0 .7\n";

static struct rad_scene *
parsed(const char *from)
{
    struct rad_scene *s = rad_scene_new();

    ck_assert_int_eq(rad_parse_text(s, from, strlen(from), "a.rad", NULL, NULL),
                     0);
    return s;
}

/* The file of a scene. */
static struct rad_memory_out
written(const struct rad_scene *s)
{
    struct rad_octree t;
    struct rad_memory_out file;
    struct rad_sink sink = rad_memory_sink(&file);

    ck_assert_int_eq(rad_octree_build(&t, s, RAD_OCTREE_LEAF, NULL), 0);
    ck_assert_int_eq(rad_octfile_write(s, &t, &sink, NULL), 0);
    rad_octree_release(&t);
    return file;
}

static int
read_back(struct rad_scene *s, struct rad_octree *t, const void *p, size_t n,
          struct rad_error *err)
{
    struct rad_memory_in from = { p, n };
    struct rad_stream in = rad_memory_stream(&from);

    return rad_octfile_read(s, t, &in, "x.oct", err);
}

static void
assert_same_object(const struct rad_object *a, const struct rad_object *b,
                   double tolerance)
{
    ck_assert_int_eq(a->type, b->type);
    ck_assert_int_eq(a->modifier, b->modifier);
    ck_assert_str_eq(a->name, b->name);
    ck_assert_int_eq(a->nstrings, b->nstrings);
    ck_assert_int_eq(a->nreals, b->nreals);
    for (int i = 0; i < a->nstrings; i++)
        ck_assert_str_eq(a->strings[i], b->strings[i]);
    for (int i = 0; i < a->nreals; i++)
        if (tolerance == 0)
            ck_assert_int_eq(
                memcmp(&a->reals[i], &b->reals[i], sizeof a->reals[i]), 0);
        else if (fabs(a->reals[i]) < 1e-38)
            ck_assert(fabs(b->reals[i]) < 1e-38);
        else if (fabs(a->reals[i]) < 1e38)
            ck_assert_double_eq_tol(b->reals[i] / a->reals[i], 1, tolerance);
}

static void
assert_same(const struct rad_scene *a, const struct rad_scene *b,
            double tolerance)
{
    ck_assert_int_eq(a->nobjects, b->nobjects);
    for (int32_t i = 0; i < a->nobjects; i++)
        assert_same_object(&a->objects[i], &b->objects[i], tolerance);
}

TEST(scene_survives_to_the_last_bit)
{
    struct rad_scene *a = parsed(text), *b = rad_scene_new();
    struct rad_memory_out file = written(a), again;

    ck_assert(rad_octfile_is(file.bytes, file.len));
    ck_assert_int_eq(read_back(b, NULL, file.bytes, file.len, NULL), 0);
    assert_same(a, b, 0);
    again = written(b);
    ck_assert_uint_eq(file.len, again.len);
    ck_assert_int_eq(memcmp(file.bytes, again.bytes, file.len), 0);
    free(file.bytes);
    free(again.bytes);
    rad_scene_free(a);
    rad_scene_free(b);
}

/* Where the part that Radiance reads ends. */
static size_t
exact_part(const struct rad_memory_out *file)
{
    for (size_t i = file->len - 6; i > 0; i--)
        if (memcmp(file->bytes + i, "\377radd\1", 6) == 0)
            return i + 1;
    ck_abort_msg("no exact part");
}

TEST(radiance_part_stands_alone)
{
    struct rad_scene *a = parsed(text), *b = rad_scene_new();
    struct rad_memory_out file = written(a);

    ck_assert_int_eq(read_back(b, NULL, file.bytes, exact_part(&file), NULL),
                     0);
    assert_same(a, b, 0x1p-31);
    free(file.bytes);
    rad_scene_free(a);
    rad_scene_free(b);
}

TEST(tree_is_read_as_written)
{
    struct rad_scene *s = rad_scene_new(), *back = rad_scene_new();
    struct rad_octree t, u;
    struct rad_memory_out file;
    struct rad_sink sink = rad_memory_sink(&file);
    double v[4];
    struct rad_object o = { .type = RAD_SPHERE,
                            .modifier = RAD_VOID,
                            .file = -1,
                            .name = "",
                            .nreals = 4,
                            .reals = v };

    for (int i = 0; i < 500; i++) {
        for (int k = 0; k < 4; k++)
            v[k] = (k < 3 ? 10 : .5) * rad_rand(3, (uint32_t)(4 * i + k));
        ck_assert_int_eq(rad_scene_add(s, &o, NULL), i);
    }
    ck_assert_int_eq(rad_octree_build(&t, s, RAD_OCTREE_LEAF, NULL), 0);
    ck_assert_int_eq(rad_octfile_write(s, &t, &sink, NULL), 0);
    ck_assert_int_eq(read_back(back, &u, file.bytes, file.len, NULL), 0);
    ck_assert_int_eq(t.root, u.root);
    ck_assert_int_eq(t.nkids, u.nkids);
    ck_assert_int_eq(t.nsets, u.nsets);
    ck_assert_int_eq(memcmp(t.kids, u.kids, sizeof *t.kids * t.nkids), 0);
    ck_assert_int_eq(memcmp(t.sets, u.sets, sizeof *t.sets * t.nsets), 0);
    ck_assert(t.size == u.size && t.org[0] == u.org[0] &&
              t.org[1] == u.org[1] && t.org[2] == u.org[2]);
    rad_octree_release(&t);
    rad_octree_release(&u);
    rad_scene_free(s);
    rad_scene_free(back);
    free(file.bytes);
}

/* Bytes by hand, as Radiance's format has them: one sphere of radius 1/2 in a
 * cube of edge 2, with reals as oconv writes them. */
static const unsigned char by_hand[] =
    "#?RADIANCE\noconv -f x.rad\nFORMAT=Radiance_octree\n\n"
    "\x01\x1f"
    "-1\0-1\0-1\0"
    "2\0"
    "\0"
    "\0\0\0\1"
    "\2\0\0\0\0\0\0\0\1\0\0\0\1\0\0\0\0"
    "polygon\0sphere\0"
    "\0"
    "\1\377\377\377\377"
    "ball\0"
    "\0\0"
    "\0\4"
    "\0\0\0\0\0"
    "\x3f\xff\xff\xff\1" /* 1 */
    "\xc0\x00\x00\x01\0" /* -1/2 */
    "\x3f\xff\xff\xff\0\377" /* 1/2 */;

TEST(bytes_mean_what_radiance_says)
{
    struct rad_scene *s = rad_scene_new();
    struct rad_octree t;
    int32_t n;

    ck_assert_int_eq(read_back(s, &t, by_hand, sizeof by_hand - 1, NULL), 0);
    ck_assert_int_eq(s->nobjects, 1);
    ck_assert_str_eq(s->objects[0].name, "ball");
    ck_assert_int_eq(s->objects[0].type, RAD_SPHERE);
    ck_assert_int_eq(s->objects[0].modifier, RAD_VOID);
    ck_assert(s->objects[0].reals[0] == 0);
    ck_assert(s->objects[0].reals[1] == 1);
    ck_assert(s->objects[0].reals[2] == -.5);
    ck_assert(s->objects[0].reals[3] == .5);
    ck_assert_int_eq(t.nkids, 1);
    ck_assert_int_eq(t.kids[0][6], RAD_OCTREE_EMPTY);
    ck_assert_int_eq(rad_octree_set(&t, t.kids[0][7], &n)[0], 0);
    ck_assert_int_eq(n, 1);
    ck_assert(t.size == 2 && t.org[2] == -1);
    rad_octree_release(&t);
    rad_scene_free(s);
}

TEST(a_file_cut_anywhere_is_refused)
{
    struct rad_scene *a = parsed(text);
    struct rad_memory_out file = written(a);
    size_t whole = exact_part(&file);

    for (size_t n = 0; n < file.len; n++) {
        struct rad_scene *b = rad_scene_new();
        struct rad_octree t;
        struct rad_error err = { 0 };
        char message[600];
        int rc = read_back(b, n % 2 ? &t : NULL, file.bytes, n, &err);

        rad_error_format(&err, message, sizeof message);
        if (n == whole) {
            ck_assert_int_eq(rc, 0);
            if (n % 2)
                rad_octree_release(&t);
        } else {
            char expected[64];

            ck_assert_int_eq(rc, RAD_EDATA);
            snprintf(expected, sizeof expected, "x.oct: truncated at byte %zu",
                     n);
            ck_assert_str_eq(message, expected);
        }
        rad_scene_free(b);
    }
    free(file.bytes);
    rad_scene_free(a);
}

/* A byte changed: an error or another scene, never a crash. */
TEST(a_damaged_file_is_survived)
{
    struct rad_scene *a = parsed(text);
    struct rad_memory_out file = written(a);

    for (size_t n = 0; n < file.len; n++)
        for (int flip = 1; flip < 256; flip <<= 1) {
            struct rad_scene *b = rad_scene_new();
            struct rad_octree t;
            struct rad_error err = { 0 };

            file.bytes[n] ^= (unsigned char)flip;
            if (read_back(b, &t, file.bytes, file.len, &err) == 0)
                rad_octree_release(&t);
            else
                ck_assert(err.code && err.what[0]);
            file.bytes[n] ^= (unsigned char)flip;
            rad_scene_free(b);
        }
    free(file.bytes);
    rad_scene_free(a);
}

/* What by_hand becomes when one byte is another, and what is said of it. */
static const struct {
    const char *find; /* the byte behind this text is changed */
    size_t behind;
    unsigned char byte;
    const char *message;
} damage[] = {
    { "#?RADIANCE\n", 0, 'x', "x.oct: not an octree" },
    { "FORMAT=Radiance_octree", 21, 'x', "x.oct: not an octree" },
    { "\x01\x1f-1", 1, 0x1b,
      "x.oct: not an octree of a version that is known" },
    { "2\0\0\0\0\0\1", 0, 'x', "x.oct: bad cube" },
    { "2\0\0\0\0\0\1", 2, 'f', "x.oct: octree is not frozen" },
    { "2\0\0\0\0\0\1", 3, 0x80, "x.oct: the number of objects is -2147483647" },
    { "\2\0\0\0\0\0\0\0\1", 0, 3, "x.oct: damaged tree" },
    { "\2\0\0\0\0\0\0\0\1", 9, 1, "x.oct: a set is " },
    { "\1\377\377\377\377", 0, 0, NULL }, /* a polygon: check.c's affair */
    { "\1\377\377\377\377", 0, 2, "x.oct: object 0 has a bad type" },
    { "\1\377\377\377\377", 1, 0, "x.oct: object 0 has a bad modifier" },
    { "sphere", 0, 'S', "x.oct: object of unknown type 'Sphere'" },
    { "ball\0", 5, 0x80, "x.oct: negative number of strings" },
    { "ball\0", 7, 0x80, "x.oct: negative number of reals" },
    { "\0\0\0\1\2", 3, 2, "x.oct: 1 objects instead of 2" },
};

LOOP_TEST(damage_is_named, N_ELEM(damage))
{
    unsigned char file[sizeof by_hand];
    const char *find = damage[_i].find;
    size_t len = strlen(find), at = 0;
    struct rad_scene *s = rad_scene_new();
    struct rad_error err = { 0 };
    char message[600];
    int rc;

    if (len < 2) /* holds a NUL: these are the two longest of their kind */
        len = find[0] == '2' ? 7 : find[0] == '\2' ? 9 : 5;
    memcpy(file, by_hand, sizeof file);
    while (memcmp(file + at, find, len) != 0)
        ck_assert_uint_lt(++at, sizeof file - len);
    file[at + damage[_i].behind] = damage[_i].byte;
    rc = read_back(s, NULL, file, sizeof file - 1, &err);
    rad_error_format(&err, message, sizeof message);
    if (!damage[_i].message)
        ck_assert_int_eq(rc, 0);
    else
        ck_assert_msg(strncmp(message, damage[_i].message,
                              strlen(damage[_i].message)) == 0,
                      "%s", message);
    rad_scene_free(s);
}

TEST(what_is_an_octree_is_known_by_its_header)
{
    static const char long_one[] = "#?RADIANCE\nFORMAT=   Radiance_octree \n\n";

    ck_assert(rad_octfile_is(by_hand, sizeof by_hand));
    ck_assert(rad_octfile_is(long_one, strlen(long_one)));
    ck_assert(!rad_octfile_is("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n", 37));
    ck_assert(!rad_octfile_is("#?RADIANCE\n\nFORMAT=Radiance_octree\n", 36));
    ck_assert(!rad_octfile_is("# a comment\nFORMAT=Radiance_octree\n", 36));
    ck_assert(!rad_octfile_is("", 0));
}

TEST(a_missing_file_is_no_input)
{
    struct rad_error err = { 0 };

    ck_assert_ptr_null(rad_octfile_load("/nonexistent/x.oct", &err));
    ck_assert_int_eq(err.code, RAD_ENOINPUT);
}

/* The file that it is loaded from has a name that says nothing to a user. */
TEST(what_is_wrong_in_a_loaded_scene_is_wrong_in_the_scene)
{
    struct rad_error err = { 0 };
    char path[] = "check_octfile.XXXXXX";
    int fd = mkstemp(path);

    ck_assert_int_ge(fd, 0);
    ck_assert_int_eq(write(fd, by_hand, 40), 40);
    close(fd);
    ck_assert_ptr_null(rad_octfile_load(path, &err));
    unlink(path);
    ck_assert_str_eq(err.where, "the scene");
}
