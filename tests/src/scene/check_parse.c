/* check_parse.c - tests of src/scene and its folder file: text to objects */
#include "config.h"

#include "scene/file/parse.h"
#include "scene/scene.h"
#include "tests/unit.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Parse and check; the message of the first failure, or "". */
static struct rad_scene *
load(const char *text, char *message, size_t size)
{
    struct rad_scene *s = rad_scene_new();
    struct rad_error err = { 0 };

    ck_assert_ptr_nonnull(s);
    message[0] = '\0';
    if (rad_parse_text(s, text, strlen(text), "a.rad", NULL, &err) ||
        rad_scene_check(s, NULL, NULL, &err)) {
        ck_assert_int_ne(err.code, 0);
        rad_error_format(&err, message, size);
    }
    return s;
}

#define MAT "void plastic m 0 0 5 .5 .5 .5 0 0\n"
#define TRI "m polygon p 0 0 9 0 0 0 1 0 0 0 1 0\n"

/* --- numbers ----------------------------------------------------------- */

static const struct {
    const char *text;
    double value;
} numbers[] = {
    { "0", 0 },
    { "-0", -0. },
    { "1.", 1 },
    { ".5", .5 },
    { "+2.50", 2.5 },
    { "-1e-3", -1e-3 },
    { "1E+22", 1e22 },
    { "1e23", 1e23 }, /* beyond exact powers of ten */
    { "0.1", .1 },
    { "9007199254740993", 9007199254740992. }, /* 2^53 + 1: a tie to even */
    { "9007199254740993.0000000000000000001", 9007199254740994. },
    { "123456789012345678901234567890", 123456789012345678901234567890. },
    { "2.2250738585072011e-308", 2.2250738585072011e-308 },
    { "4.9e-324", 4.9e-324 },
    { "1.7976931348623157e308", 1.7976931348623157e308 },
    { "0e99999", 0 },
    { "0.000000000000000000000000000000000000000000012345e44", 1.2345 },
    { "4.89858719659e-17", 4.89858719659e-17 },
};

LOOP_TEST(number_is_the_nearest_double, N_ELEM(numbers))
{
    char text[256], message[512];
    struct rad_scene *s;

    snprintf(text, sizeof text, "void sphere s 0 0 4 %s 0 0 1",
             numbers[_i].text);
    s = load(text, message, sizeof message);
    ck_assert_str_eq(message, "");
    ck_assert(s->objects[0].reals[0] == numbers[_i].value);
    ck_assert_int_eq(signbit(s->objects[0].reals[0]) != 0,
                     signbit(numbers[_i].value) != 0);
    rad_scene_free(s);
}

static const char *const bad_numbers[] = {
    "nan",   "inf",  "-infinity", "0x10",  "1e",    "1e+",
    ".",     "-",    "1e999",     "1.2.3", "1,5",   "--1",
    "1e5.5", "five", "1e400",     "''",    "1_000", "1e-",
};

LOOP_TEST(what_is_no_number_is_refused, N_ELEM(bad_numbers))
{
    char text[256], message[512];

    snprintf(text, sizeof text, "void sphere s 0 0 4\n0 %s 0 1",
             bad_numbers[_i]);
    rad_scene_free(load(text, message, sizeof message));
    ck_assert_msg(strncmp(message, "a.rad:2: ", 9) == 0, "%s", message);
    ck_assert_ptr_nonnull(strstr(message, "sphere 's'"));
}

/* --- well formed -------------------------------------------------------- */

TEST(objects_are_read_as_written)
{
    static const char text[] =
        "# a comment\n"
        "void\n\t# red\nplastic red\n-0 +0 # no strings\n5 .5 0\r\n0 .1 .2\n"
        "\f\n"
        "void brighttext \"a 'b'\" 3 helvet.fnt #4 don't 'x 0\n"
        "11 0 0 0 1 0 0 0 -1 0 1 .5\n"
        "red polygon 'two words' 0 0 9 0 0 0 1 0 0 0 1 0";
    char message[512];
    struct rad_scene *s = load(text, message, sizeof message);
    const struct rad_object *o = s->objects;

    ck_assert_str_eq(message, "");
    ck_assert_int_eq(s->nobjects, 3);
    ck_assert_int_eq(o[0].type, RAD_PLASTIC);
    ck_assert_int_eq(o[0].line, 2);
    ck_assert_int_eq(o[0].nreals, 5);
    ck_assert(o[0].reals[4] == .2);
    ck_assert_int_eq(o[0].modifier, RAD_VOID);
    ck_assert_str_eq(o[1].name, "a 'b'");
    ck_assert_int_eq(o[1].nstrings, 3);
    ck_assert_str_eq(o[1].strings[0], "helvet.fnt");
    ck_assert_str_eq(o[1].strings[1], "#4");
    ck_assert_str_eq(o[1].strings[2], "dont x"); /* quotes open anywhere */
    ck_assert_str_eq(o[2].name, "two words");
    ck_assert_int_eq(o[2].modifier, 0);
    ck_assert_int_eq(o[2].line, 11);
    rad_scene_free(s);
}

TEST(text_is_the_same_however_it_arrives)
{
    /* a word at every place of the lexer's buffer's end */
    static char text[3 * 65536];
    char message[512];
    struct rad_scene *s;
    size_t n;

    for (int pad = 65536 - 90; pad < 65536 + 8; pad++) {
        memset(text, ' ', (size_t)pad);
        text[0] = '#';
        text[pad - 1] = '\n';
        n = (size_t)pad;
        strcpy(text + n, MAT "m sphere s # x\n 0 0 4 1.25 2.5 3.75 .125\n");
        s = load(text, message, sizeof message);
        ck_assert_str_eq(message, "");
        ck_assert_int_eq(s->nobjects, 2);
        ck_assert(s->objects[1].reals[2] == 3.75);
        ck_assert(s->objects[1].reals[3] == .125);
        ck_assert_int_eq(s->objects[1].line, 3);
        rad_scene_free(s);
    }
}

TEST(alias_takes_or_keeps_the_modifier)
{
    static const char text[] = "void glow g 0 0 4 1 1 1 0\n"   /* 0 */
                               "void brightfunc b 2 1 . 0 0\n" /* 1 */
                               "b plastic p 0 0 5 1 1 1 0 0\n" /* 2 */
                               "void alias a1 g\n"             /* 3: plain */
                               "b alias a2 g\n"       /* 4: other modifier */
                               "inherit alias a3 p\n" /* 5: plain */
                               "void alias a4 a1\n"   /* 6: skips a1 */
                               "b alias a5 a3\n"      /* 7: p has b: plain */
                               "void alias a6 a2\n";  /* 8 */
    char message[512];
    struct rad_scene *s = load(text, message, sizeof message);
    const struct rad_object *o = s->objects;
    bool own;

    ck_assert_str_eq(message, "");
    ck_assert_int_eq(o[3].modifier, 0);
    ck_assert_int_eq(o[3].nstrings, 0);
    ck_assert_int_eq(o[4].modifier, 1);
    ck_assert_int_eq(o[4].nstrings, 1);
    ck_assert_str_eq(o[4].strings[0], "g");
    ck_assert_int_eq(o[5].modifier, 2);
    ck_assert_int_eq(o[6].modifier, 0);
    ck_assert_int_eq(o[7].modifier, 2);
    ck_assert_int_eq(o[7].nstrings, 0);
    ck_assert_int_eq(rad_scene_alias(s, 4, &own), 0);
    ck_assert(own);
    ck_assert_int_eq(rad_scene_alias(s, 6, &own), 0);
    ck_assert(!own);
    ck_assert_int_eq(rad_scene_alias(s, 8, &own), 0);
    ck_assert_int_eq(rad_scene_alias(s, 2, &own), 2);
    rad_scene_free(s);
}

TEST(the_last_different_definition_before_counts)
{
    static const char text[] =
        "void plastic m 0 0 5 .5 .5 .5 0 0\n"        /* 0 */
        "void sphere m 0 0 4 0 0 0 1\n"              /* 1: no modifier */
        "void plastic m 0 0 5 .50000001 .5 .5 0 0\n" /* 2: the same */
        "void plastic m 0 0 5 .6 .5 .5 0 0\n"        /* 3: another */
        "void plastic m 0 0 5 .5 .5 .5 0 0\n"        /* 4: as 0, not as 3 */
        "m sphere s 0 0 4 0 0 0 1\n";                /* 5 */
    char message[512];
    struct rad_scene *s = load(text, message, sizeof message);
    static const int expected[] = { -1, 0, 0, 0, 3, 4, 4 };

    ck_assert_str_eq(message, "");
    for (int before = 0; before < N_ELEM(expected); before++)
        ck_assert_int_eq(rad_scene_find_modifier(s, "m", before),
                         expected[before]);
    ck_assert_int_eq(s->objects[5].modifier, 4);
    ck_assert_int_eq(rad_scene_find_modifier(s, "x", 99), RAD_VOID);
    rad_scene_free(s);
}

TEST(many_names_are_found)
{
    struct rad_scene *s = rad_scene_new();
    double reals[5] = { 0 };
    struct rad_object o = { .type = RAD_PLASTIC,
                            .modifier = RAD_VOID,
                            .file = -1,
                            .nreals = 5,
                            .reals = reals };
    char name[32];

    o.name = name;
    for (int i = 0; i < 20000; i++) {
        snprintf(name, sizeof name, "m%d", i / 2);
        reals[0] = i;
        ck_assert_int_eq(rad_scene_add(s, &o, NULL), i);
    }
    for (int i = 0; i < 20000; i++) {
        snprintf(name, sizeof name, "m%d", i / 2);
        ck_assert_int_eq(rad_scene_find_modifier(s, name, INT32_MAX), i | 1);
        ck_assert_int_eq(rad_scene_find_modifier(s, name, i + 1), i);
    }
    rad_scene_free(s);
}

/* --- malformed ---------------------------------------------------------- */

static const struct {
    const char *text, *message;
} bad[] = {
    { MAT "x sphere s 0 0 4 0 0 0 1", "a.rad:2: undefined modifier 'x'" },
    { MAT "m polygon p 0 0 9 0 0 0 1 0 0 1 1 0 0 1 0",
      "a.rad:2: undefined modifier '0': are there more arguments before it "
      "than "
      "their number says?" },
    { MAT "\n m spheer s 0 0 4 0 0 0 1", "a.rad:3: unknown type 'spheer'" },
    { MAT "m", "a.rad:2: text ends where a type is expected" },
    { MAT "\xef\xbb\xbf m sphere s 0 0 4 0 0 0 1",
      "a.rad:2: undefined modifier '?': a byte-order mark is before it: save "
      "its file without" }, /* as xform copies it from there */
    { MAT "m sphere", "a.rad:2: text ends where a name is expected" },
    { MAT "m sphere s 0 0",
      "a.rad:2: sphere 's': text ends where the number of real arguments is "
      "expected" },
    { MAT "m sphere s 0 0 4 0 0 0",
      "a.rad:2: sphere 's': text ends where a real argument is expected" },
    { MAT "m sphere s 0 0 3 0 0 0",
      "a.rad:2: sphere 's': expected 4 real arguments, got 3" },
    { MAT "m sphere s 0 1 3 4 0 0 0 1",
      "a.rad:2: sphere 's': expected 0 integer arguments, got 1: no type has "
      "any" },
    { MAT "m sphere s -1 0 4 0 0 0 1",
      "a.rad:2: sphere 's': expected the number of string arguments, got "
      "'-1'" },
    { MAT "m sphere s 0 0 4000000000 0",
      "a.rad:2: sphere 's': the number of real arguments is 4000000000, at "
      "most 32767 is possible" },
    { MAT "m polygon p 0 0 4 0 0 0 1",
      "a.rad:2: polygon 'p': expected at least 9 real arguments, got 4" },
    { MAT "m polygon p 0 0 10 0 0 0 1 0 0 1 1 0 5",
      "a.rad:2: polygon 'p': expected three real arguments for each vertex, "
      "got 10" },
    { "void light l 0 0 3 1 1 1\nl sphere s 0 0 4 0 0 0 0",
      "a.rad:2: sphere 's': a light source of zero radius" },
    { "void light l 0 0 3 1 1 1\nl source s 0 0 4 0 0 0 5",
      "a.rad:2: source 's': zero direction" },
    { "void glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 0",
      "a.rad:2: source 's': angle 0 is not above 0" },
    { "void plastic p 0 0 3 1 1 1",
      "a.rad:1: plastic 'p': expected 5 real arguments, got 3" },
    { "void trans p 0 0 5 1 1 1 0 0",
      "a.rad:1: trans 'p': expected 7 real arguments, got 5" },
    { "void glass g 0 0 5 1 1 1 1 1",
      "a.rad:1: glass 'g': expected 3 to 4 real arguments, got 5" },
    { "void glass g 0 0 4 1 1 1 0",
      "a.rad:1: glass 'g': refractive index 0 is not above 0" },
    { "void dielectric d 0 0 4 1 1 1 1.5",
      "a.rad:1: dielectric 'd': expected 5 real arguments, got 4" },
    { "void interface d 0 0 8 1 1 1 1.5 1 1 1 0",
      "a.rad:1: interface 'd': refractive index is not above 0" },
    { "void light l 0 0 4 1 1 1 0",
      "a.rad:1: light 'l': expected 3 real arguments, got 4" },
    { "void glow l 0 0 3 1 1 1",
      "a.rad:1: glow 'l': expected 4 real arguments, got 3" },
    { "void spotlight l 0 0 7 1 1 1 0 0 0 1",
      "a.rad:1: spotlight 'l': angle 0 is not above 0" },
    { "void spotlight l 0 0 7 1 1 1 30 0 0 0",
      "a.rad:1: spotlight 'l': zero direction" },
    { "void illum i 1 x 0 3 1 1 1",
      "a.rad:1: illum 'i': undefined modifier 'x'" },
    { "void brighttext t 1 f.fnt 0 11 0 0 0 1 0 0 0 1 0 1 0",
      "a.rad:1: brighttext 't': expected at least 2 string arguments, got 1" },
    { "void colortext t 2 f x 0 11 0 0 0 1 0 0 0 1 0 1 0",
      "a.rad:1: colortext 't': expected at least 15 real arguments, got 11" },
    { "void brighttext t 2 f x 0 11 0 0 0 1 0 0 -2 0 0 1 0",
      "a.rad:1: brighttext 't': right and down vectors are parallel" },
    { "void alias a x", "a.rad:1: alias 'a' of undefined modifier 'x'" },
    { "inherit sphere s 0 0 4 0 0 0 1",
      "a.rad:1: only an alias can have the modifier 'inherit'" },
    { "void plastic void 0 0 5 1 1 1 0 0",
      "a.rad:1: a plastic cannot be called 'void'" },
    { "void plastic \"a\tb\" 0 0 5 1 1 1 0 0", "a.rad:1: tab in name 'a?b'" },
    { "void plastic 'open\n 0 0 5\n",
      "a.rad:3: the quote ' opened in line 1 is not closed" },
    { MAT "!echo", "a.rad:2: commands are not run here: '!echo'" },
    { "void spectrum x 0 0 4 380 780 1 1\nx alias a b\n"
      "a sphere s 0 0 4 0 0 0 1",
      "a.rad:2: alias 'a' of undefined modifier 'b'" },
    { "void spectrum x 0 0 4 380 780 1 1\nx sphere s 0 0 4 0 0 0 1",
      "a.rad:1: spectrum 'x': expected at least 5 real arguments, got 4" },
    { "void spectrum x 0 0 5 0 780 1 1 1\nx sphere s 0 0 4 0 0 0 1",
      "a.rad:1: spectrum 'x': no wavelengths from 0 to 780 nm" },
    { "void specfile m 0 0 0\nvoid illum i 1 m 0 3 1 1 1\n"
      "i sphere s 0 0 4 0 0 0 1",
      "a.rad:1: specfile 'm': expected 1 string argument, got 0" },
    { "void mirror m 1 x 0 3 1 1 1",
      "a.rad:1: mirror 'm': undefined modifier 'x'" },
    { "void antimatter a 0 0 0",
      "a.rad:1: antimatter 'a': expected at least 1 string arguments, got 0" },
    { "void instance i 0 0 0",
      "a.rad:1: instance 'i': expected at least 1 string arguments, got 0" },
    { MAT "m metal n 0 0 5 1 1 1 0 0\nn sphere s 0 0 4 0 0 0 1",
      "a.rad:2: metal 'n': modified by another material, 'm'" },
    { "void light l 0 0 3 1 1 1\nl cone c 0 0 8 0 0 0 0 0 1 1 2",
      "a.rad:2: cone 'c': a cone cannot be a light source (its material is "
      "light 'l')" },
};

/* The text with a surface behind it that uses its last object, if that is a
 * modifier; false: it is none. */
static bool
use_last(const char *text, char *used, size_t size)
{
    struct rad_scene *s = rad_scene_new();
    const struct rad_object *last = NULL;

    if (rad_parse_text(s, text, strlen(text), "a.rad", NULL, NULL) == 0 &&
        s->nobjects > 0)
        last = &s->objects[s->nobjects - 1];
    if (last && rad_otype_class(last->type) == RAD_CLASS_SURFACE)
        last = NULL;
    snprintf(used, size, "%s%s%s%s", text, last ? "\n" : "",
             last ? last->name : "", last ? " sphere used 0 0 4 0 0 0 1" : "");
    rad_scene_free(s);
    return last;
}

static void
keep_warning(void *arg, const struct rad_error *err)
{
    ck_assert_int_eq(err->code, RAD_WARNING);
    rad_error_format(err, arg, 512);
}

/* What a scene that is accepted is warned of: the last, or "". */
static void
warning_of(const char *text, char message[512])
{
    struct rad_scene *s = rad_scene_new();
    struct rad_error err = { 0 };

    message[0] = '\0';
    ck_assert_int_eq(rad_parse_text(s, text, strlen(text), "a.rad", NULL, &err),
                     0);
    ck_assert_int_eq(rad_scene_check(s, keep_warning, message, &err), 0);
    ck_assert_int_eq(err.code, 0);
    rad_scene_free(s);
}

/* A modifier is wrong once a surface uses it, and warned of before. */
LOOP_TEST(bad_scene_is_refused_with_its_line, N_ELEM(bad))
{
    char message[512], text[1024], expected[512];
    bool modifier = use_last(bad[_i].text, text, sizeof text);

    rad_scene_free(load(text, message, sizeof message));
    ck_assert_str_eq(message, bad[_i].message);
    if (!modifier)
        return;
    warning_of(bad[_i].text, message);
    snprintf(expected, sizeof expected, "%s; no surface uses it",
             bad[_i].message);
    ck_assert_str_eq(message, expected);
}

static const struct {
    const char *text, *message;
} left_out[] = {
    { "void ring r 0 0 8 0 0 0 0 0 1 -1 2",
      "a.rad:1: ring 'r': negative radius: it is left out" },
    { "void ring r 0 0 8 0 0 0 0 0 1 2 2",
      "a.rad:1: ring 'r': equal radii: it is left out" },
    { "void ring r 0 0 8 0 0 0 0 0 0 1 2",
      "a.rad:1: ring 'r': zero direction: it is left out" },
    { "void cone c 0 0 8 0 0 0 0 0 1 -1 2",
      "a.rad:1: cone 'c': radii of opposite sign: it is left out" },
    { "void cup c 0 0 8 0 0 0 0 0 1 1 -2",
      "a.rad:1: cup 'c': radii of opposite sign: it is left out" },
    { "void cup c 0 0 8 0 0 0 0 0 1 0 -2",
      "a.rad:1: cup 'c': negative radius: it is turned inside out" },
    { "void cylinder c 0 0 7 0 0 0 0 0 1 0",
      "a.rad:1: cylinder 'c': zero radius: it is left out" },
    { "void tube c 0 0 7 0 1 2 0 1 2 1",
      "a.rad:1: tube 'c': zero length: it is left out" },
    { "void tube c 0 0 7 0 1 2 0 1 3 -1",
      "a.rad:1: tube 'c': negative radius: it is turned inside out" },
    { "void sphere s 0 0 4 1 2 3 0",
      "a.rad:1: sphere 's': zero radius: it is left out" },
    { "void bubble s 0 0 4 1 2 3 -1",
      "a.rad:1: bubble 's': negative radius: it is turned inside out" },
    { "void polygon p 0 0 12 0 0 0 1 1 1 2 2 2 3 3 3",
      "a.rad:1: polygon 'p': zero area: it is left out" },
    { "void polygon p 0 0 12 0 0 0 1 0 0 1 1 .3 0 1 0\n",
      "a.rad:1: polygon 'p': corners that are not in one plane: it is made "
      "flat" },
    { MAT "m source s 0 0 4 0 0 0 5", "a.rad:2: source 's': zero direction" },
    { "void source s 0 0 4 0 0 1 0",
      "a.rad:1: source 's': angle 0 is not above 0" },
    { "void light l 0 0 3 0 0 0\nl source s 0 0 4 0 0 1 -1",
      "a.rad:2: source 's': angle -1 is not above 0" },
};

LOOP_TEST(what_radiance_leaves_out_is_warned_of, N_ELEM(left_out))
{
    char message[512];

    warning_of(left_out[_i].text, message);
    ck_assert_str_eq(message, left_out[_i].message);
}

static const char *const good[] = {
    "",
    "# nothing\n",
    /* modifiers that no surface reaches may be of any type, and wrong */
    "void mixfunc x 4 void void 1 . 0 0\n" MAT TRI,
    "void mixfunc x 4 no one 1 . 0 0\nvoid plastic y 0 0 2 1 1\n" MAT TRI,
    "void spectrum b 0 0 0\n",
    /* no source of direct light: any surface may have it */
    "void glow g 0 0 4 1 1 1 0\ng cone c 0 0 8 0 0 0 0 0 1 1 2",
    "void light l 0 0 3 0 0 0\nl cone c 0 0 8 0 0 0 0 0 1 1 2",
    "void illum i 1 void 0 3 1 1 1\ni ring r 0 0 8 0 0 0 0 0 1 0 1",
    MAT "void illum i 1 m 0 3 1 1 1\ni sphere s 0 0 4 0 0 0 1",
    /* an alias' own modifier stands in for the material's */
    MAT "void brighttext t 2 f x 0 11 0 0 0 1 0 0 0 -1 0 1 0\n"
        "t alias a m\na sphere s 0 0 4 0 0 0 1",
    "void sphere s 0 0 4 0 0 0 -1",
    "void polygon p 0 0 9 0 0 0 0 0 0 0 0 0",
    "\xef\xbb\xbf" MAT TRI,
    "\xef\xbb\xbf",
};

LOOP_TEST(good_scene_is_accepted, N_ELEM(good))
{
    char message[512];

    rad_scene_free(load(good[_i], message, sizeof message));
    ck_assert_str_eq(message, "");
}

static const struct {
    const char *file, *text, *message;
} foreign[] = {
    { "a.OBJ", "# Blender\nmtllib a.mtl\nv 1 2 3\n", "obj2rad" },
    { "a.ies", "IESNA:LM-63-1995\nTILT=NONE\n", "ies2rad" },
    { "a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n", "picture" },
};

LOOP_TEST(a_file_that_is_no_scene_is_told_apart, N_ELEM(foreign))
{
    struct rad_scene *s = rad_scene_new();
    struct rad_error err = { 0 };

    ck_assert_int_eq(rad_parse_text(s, foreign[_i].text,
                                    strlen(foreign[_i].text), foreign[_i].file,
                                    NULL, &err),
                     RAD_EDATA);
    ck_assert_ptr_nonnull(strstr(err.what, foreign[_i].message));
    rad_scene_free(s);
}

TEST(words_have_a_limit)
{
    char text[2000], message[512];
    char *p = text;

    p += sprintf(p, "void plastic ");
    memset(p, 'x', RAD_MAX_WORD);
    strcpy(p + RAD_MAX_WORD, " 0 0 5 1 1 1 0 0");
    rad_scene_free(load(text, message, sizeof message));
    ck_assert_str_eq(message, "");
    memset(p, 'x', RAD_MAX_WORD + 1);
    strcpy(p + RAD_MAX_WORD + 1, " 0 0 5 1 1 1 0 0");
    rad_scene_free(load(text, message, sizeof message));
    ck_assert_str_eq(message, "a.rad:1: word of more than 511 bytes: "
                              "'xxxxxxxxxxxxxxxxxxxxxxxx...'");
}

TEST(binary_data_is_no_scene)
{
    struct rad_scene *s = rad_scene_new();
    struct rad_error err = { 0 };
    char data[1000];

    for (int i = 0; i < N_ELEM(data); i++)
        data[i] = (char)(i * 7 + i / 256);
    data[0] = '!'; /* even what looks like a command is not run */
    ck_assert_int_eq(rad_parse_text(s, data, sizeof data, "a.rad", NULL, &err),
                     RAD_EDATA);
    ck_assert_ptr_nonnull(strstr(err.what, "not a scene description"));
    rad_scene_free(s);
}

/* --- every error -------------------------------------------------------- */

struct messages {
    char text[8][512];
    int n;
};

static void
collect(void *arg, const struct rad_error *err)
{
    struct messages *m = arg;

    ck_assert_int_lt(m->n, 8);
    rad_error_format(err, m->text[m->n], sizeof m->text[0]);
    m->n++;
}

TEST(all_errors_are_told)
{
    static const char text[] =
        "x sphere a 0 0 4 0 0 0 1\n"
        "void plasti m 0 0 5 .5 .5 .5 0 0\n"
        "m sphere b 0 0 4 0 0 0 1\n" /* m was defined, if badly */
        "void alias c y\n"
        "void sphere d 0 0 4 0 0\n";
    struct rad_scene *s = rad_scene_new();
    struct messages m = { .n = 0 };
    struct rad_parse_io io = { .each = collect, .arg = &m };
    struct rad_error err = { 0 };
    char first[512];

    ck_assert_int_eq(
        rad_parse_text(s, text, sizeof text - 1, "a.rad", &io, &err),
        RAD_EDATA);
    ck_assert_int_eq(m.n, 4);
    ck_assert_str_eq(m.text[0], "a.rad:1: undefined modifier 'x'");
    ck_assert_str_eq(m.text[1], "a.rad:2: unknown type 'plasti'");
    ck_assert_str_eq(m.text[2], "a.rad:4: alias 'c' of undefined modifier 'y'");
    ck_assert_str_eq(m.text[3], "a.rad:6: sphere 'd': text ends where a real "
                                "argument is expected");
    rad_error_format(&err, first, sizeof first);
    ck_assert_str_eq(first, m.text[0]);
    rad_scene_free(s);
}

TEST(check_tells_all_errors)
{
    static const char text[] =
        "void plastic m 0 0 4 .5 .5 .5 0\n"
        "m sphere b 0 0 3 0 0 0\n"
        "void specfile c 0 0 0\nc sphere s 0 0 4 0 0 0 1\n";
    struct rad_scene *s = rad_scene_new();
    struct messages m = { .n = 0 };

    ck_assert_int_eq(
        rad_parse_text(s, text, sizeof text - 1, "a.rad", NULL, NULL), 0);
    ck_assert_int_eq(rad_scene_check(s, collect, &m, NULL), RAD_EDATA);
    ck_assert_int_eq(m.n, 3);
    ck_assert_str_eq(
        m.text[2], "a.rad:3: specfile 'c': expected 1 string argument, got 0");
    rad_scene_free(s);
}

/* Mixtures of mixtures, and aliases of aliases: n of them, and a surface. */
static int
check_nested(const char *one, int n, struct rad_error *err)
{
    static const char head[] = "void plastic m0 0 0 5 1 1 1 0 0\n"
                               "void brightfunc p 2 1 . 0 0\n"
                               "void brightfunc q 2 1 . 0 0\n";
    struct rad_scene *s = rad_scene_new();
    char text[200];
    int rc = rad_parse_text(s, head, sizeof head - 1, "a.rad", NULL, err);

    for (int i = 1; i <= n && rc == 0; i++) {
        snprintf(text, sizeof text, one, i % 2 ? "p" : "q", i, i - 1);
        rc = rad_parse_text(s, text, strlen(text), "b.rad", NULL, err);
    }
    snprintf(text, sizeof text, "m%d sphere s 0 0 4 0 0 0 1\n", n);
    if (rc == 0)
        rc = rad_parse_text(s, text, strlen(text), "c.rad", NULL, err);
    if (rc == 0)
        rc = rad_scene_check(s, NULL, NULL, err);
    rad_scene_free(s);
    return rc;
}

LOOP_TEST(nesting_has_a_limit, 3)
{
    static const char *const ones[] = {
        "%s mixfunc m%d 4 m%d void 1 . 0 0\n",
        "%s alias m%d m%d\n",
        "%s illum m%d 1 m%d 0 3 1 1 1\n",
    };
    struct rad_error err = { 0 };

    ck_assert_int_eq(check_nested(ones[_i], 256, &err), 0);
    ck_assert_int_eq(check_nested(ones[_i], 257, &err), RAD_EDATA);
    ck_assert_ptr_nonnull(strstr(err.what, "nested more than 256 deep"));
    err.code = 0;
    /* and in good time, without taking the stack for it */
    ck_assert_int_eq(check_nested(ones[_i], 50000, &err), RAD_EDATA);
}

TEST(needs_are_what_surfaces_reach)
{
    static const char text[] =
        "void mist fog 0 0 0\n"
        "void brighttext t 2 f x 0 11 0 0 0 1 0 0 0 -1 0 1 0\n"
        "t plastic m 0 0 5 .5 .5 .5 0 0\n"
        "void illum i 1 m 0 3 1 1 1\ni sphere s 0 0 4 0 0 0 1\n";
    char message[512];
    struct rad_scene *s = load(text, message, sizeof message);
    bool needs[RAD_NOTYPES];

    rad_scene_needs(s, needs);
    for (int t = 0; t < RAD_NOTYPES; t++)
        ck_assert_int_eq(needs[t], t == RAD_BRIGHTTEXT || t == RAD_PLASTIC ||
                                       t == RAD_ILLUM || t == RAD_SPHERE);
    rad_scene_free(s);
}

/* --- commands ------------------------------------------------------------ */

/* A shell of one command: "n", whose output is "!n-1" down to 0, and a sphere.
 */
struct job {
    char text[64];
    size_t left;
    const char *p;
};

static int running;

static long
job_read(void *arg, void *buf, size_t n, struct rad_error *err)
{
    struct job *j = arg;

    (void)err;
    n = j->left ? 1 : 0; /* a byte at a time */
    if (n)
        *(char *)buf = *j->p++;
    j->left -= n;
    return (long)n;
}

static int
job_begin(void *arg, const char *command, struct rad_stream *out, void **job,
          struct rad_error *err)
{
    struct job *j = malloc(sizeof *j);
    int n = atoi(command);

    (void)arg;
    (void)err;
    if (n < 0)
        snprintf(j->text, sizeof j->text, "x sphere s\n");
    else if (n == 0)
        snprintf(j->text, sizeof j->text, "void sphere s 0 0 4 0 0 0 1");
    else
        snprintf(j->text, sizeof j->text, "# %d\n!%d\\\n\n", n, n - 1);
    j->p = j->text;
    j->left = strlen(j->text);
    out->read = job_read;
    out->arg = j;
    *job = j;
    running++;
    return 0;
}

static int
job_end(void *arg, void *job, bool stop, struct rad_error *err)
{
    (void)arg;
    free(job);
    running--;
    ck_assert(stop || running >= 0);
    (void)err;
    return 0;
}

TEST(commands_are_read_in_their_place)
{
    static const char text[] = MAT "!3\n" TRI;
    struct rad_parse_io io = { job_begin, job_end, NULL, NULL, NULL };
    struct rad_scene *s = rad_scene_new();

    ck_assert_int_eq(
        rad_parse_text(s, text, sizeof text - 1, "a.rad", &io, NULL), 0);
    ck_assert_int_eq(s->nobjects, 3);
    ck_assert_int_eq(s->objects[1].type, RAD_SPHERE);
    ck_assert_str_eq(s->files[s->objects[1].file],
                     "a.rad:2 (!3):2 (!2\\...):2 (!1\\...):2 "
                     "(!0\\...)");
    ck_assert_int_eq(s->objects[2].type, RAD_POLYGON);
    ck_assert_int_eq(running, 0);
    rad_scene_free(s);
}

TEST(errors_in_commands_say_where)
{
    struct rad_parse_io io = { job_begin, job_end, NULL, NULL, NULL };
    struct rad_scene *s = rad_scene_new();
    struct rad_error err = { 0 };

    ck_assert_int_eq(rad_parse_text(s, "!-1", 3, "a.rad", &io, &err),
                     RAD_EDATA);
    ck_assert_str_eq(err.where, "a.rad:1 (!-1):1");
    ck_assert_str_eq(err.what, "undefined modifier 'x'");
    memset(&err, 0, sizeof err);
    ck_assert_int_eq(rad_parse_text(s, "!99", 3, "a.rad", &io, &err),
                     RAD_EDATA);
    ck_assert_str_eq(err.what, "commands are nested too deeply");
    ck_assert_int_eq(running, 0);
    rad_scene_free(s);
}

/* The end of a message that is too long tells the reason. */
TEST(a_long_failure_keeps_its_reason)
{
    char message[512], way[400];
    struct rad_scene *s = load(MAT TRI, message, sizeof message);
    struct rad_error err = { 0 };

    memset(way, 'w', sizeof way);
    rad_scene_fail(s, &s->objects[0], &err, RAD_EDATA, "%.*s: the reason",
                   (int)sizeof way, way);
    ck_assert_ptr_eq(strstr(err.what, "plastic 'm': ww"), err.what);
    ck_assert_str_eq(err.what + strlen(err.what) - 13, "w: the reason");
    rad_scene_free(s);
}
