/* check_bsdf.c - tests of src/scene/bsdf and gloss/scatter.c: XML files of
 * scattering data, and the materials that use them */
#include "config.h"

#include "base/rng.h"
#include "scene/bsdf/bsdf.h"
#include "tests/world.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define HEAD(structure)                                                        \
    "<?xml version=\"1.0\"?>\n<WindowElement xmlns=\"http://x\">"              \
    "<FileType>BSDF</FileType><Optical><Layer><DataDefinition>"                \
    "<IncidentDataStructure>" structure "</IncidentDataStructure>"
/* One patch about the normal, 30 degrees wide, and four around it. */
#define BASIS                                                                  \
    "<AngleBasis><AngleBasisName>Five</AngleBasisName>"                        \
    "<AngleBasisBlock><nPhis>1</nPhis><ThetaBounds><LowerTheta>0</LowerTheta>" \
    "<UpperTheta>30</UpperTheta></ThetaBounds></AngleBasisBlock>"              \
    "<AngleBasisBlock><nPhis>4</nPhis><ThetaBounds><LowerTheta>30"             \
    "</LowerTheta><UpperTheta>90</UpperTheta></ThetaBounds></AngleBasisBlock>" \
    "</AngleBasis>"
#define BLOCK(channel, side, bases, values)                                    \
    "<WavelengthData><Wavelength>" channel "</Wavelength>"                     \
    "<WavelengthDataBlock><WavelengthDataDirection>" side                      \
    "</WavelengthDataDirection>" bases "<ScatteringData>" values               \
    "</ScatteringData></WavelengthDataBlock></WavelengthData>"
#define FIVE                                                                   \
    "<ColumnAngleBasis>Five</ColumnAngleBasis>"                                \
    "<RowAngleBasis>Five</RowAngleBasis>"
#define CHIU  "<AngleBasis>LBNL/Shirley-Chiu</AngleBasis>"
#define DEFS  "</DataDefinition>"
#define FOOT  "</Layer></Optical></WindowElement>"
#define OURRF "Reflection Back" /* the file's back is our front */
#define OURRB "Reflection Front"
#define OURTF "Transmission Back"
#define OURTB "Transmission Front"

/* By row, the direction out, then column, the direction in. */
#define TABLE                                                                  \
    ".10 .11 .12 .13 .14  .20 .21 .22 .23 .24,\n.30 .31 .32 .33 .34 "          \
    ".40 .41 .42 .43 .44  .50 .51 .52 .53 .54"
#define TREE4                                                                  \
    "{{.1}{.2}{.3}{.4}{.5}{.6}{.7}{.8}{.9}{.15}{.25}{.35}"                     \
    "{{.1 .2 .3 .4 .5 .6 .7 .8 .9 1 1.1 1.2 1.3 1.4 1.5 1.6}{0}{1}{2}{.1}{.2}" \
    "{.3}{.4}{.5}{.6}{.7}{.8}{.9}{.1}{.2}{.3}}{.45}{.55}{.65}}"
#define TREE3 "{.1,.2,.3,.4 .9 .9 .9 .9}"

static const char matrix[] =
    HEAD("Columns") BASIS DEFS BLOCK("Visible", OURRF, FIVE, TABLE)
        BLOCK("Visible", OURTF, FIVE, TABLE) BLOCK("Solar", OURRB, FIVE, "junk")
            FOOT;
static const char rows[] =
    HEAD("Rows") BASIS DEFS BLOCK("Visible", OURRF, FIVE, TABLE) FOOT;
static const char tree4[] =
    HEAD("TensorTree4") DEFS BLOCK("Visible", OURRB, CHIU, TREE4)
        BLOCK("Visible", OURTB, CHIU, TREE4) FOOT;
static const char tree3[] =
    HEAD("TensorTree3") DEFS BLOCK("Visible", OURRF, CHIU, TREE3)
        BLOCK("Visible", OURTF, CHIU, TREE3) FOOT;
/* of XYZ (2, 1, .5) times the table */
static const char coloured[] =
    HEAD("Columns") BASIS DEFS BLOCK("Visible", OURRF, FIVE, TABLE) BLOCK(
        "CIE-X", OURRF, FIVE,
        ".20 .22 .24 .26 .28 .40 .42 .44 .46 .48 .60 .62 .64 .66 .68 "
        ".80 .82 .84 .86 .88 1 1.02 1.04 1.06 1.08")
        BLOCK("CIE-Z", OURRF, FIVE,
              ".05 .055 .06 .065 .07 .10 .105 .11 .115 .12 .15 .155 .16 .165 "
              ".17 .20 .205 .21 .215 .22 .25 .255 .26 .265 .27") FOOT;

static struct rad_arena arena;

static void
set_up(void)
{
    rad_arena_init(&arena);
}

static void
tear_down(void)
{
    rad_arena_release(&arena);
}

FIXTURE(set_up, tear_down)

static struct rad_bsdf *
parse(const char *xml, struct rad_error *err)
{
    return rad_bsdf_parse(&arena, xml, strlen(xml), err);
}

static struct rad_bsdf *
must_parse(const char *xml)
{
    struct rad_error err = { 0 };
    struct rad_bsdf *b = parse(xml, &err);

    ck_assert_msg(b != NULL, "%s", err.what);
    return b;
}

/* One lookup. */
static double
value(const struct rad_bsdf *b, const double in[3], const double out[3],
      double xyz[3])
{
    struct rad_bsdf_eye eye;
    double cell;

    rad_bsdf_look_from(b, in, &eye);
    rad_bsdf_value(&eye, out, xyz, &cell);
    return cell;
}

static double
total(const struct rad_bsdf *b, const double in[3], bool through)
{
    struct rad_bsdf_eye eye;

    rad_bsdf_look_from(b, in, &eye);
    return rad_bsdf_total(&eye, through);
}

static void
direction(double theta, double phi, double v[3])
{
    theta *= M_PI / 180;
    phi *= M_PI / 180;
    v[0] = sin(theta) * cos(phi);
    v[1] = sin(theta) * sin(phi);
    v[2] = cos(theta);
}

/* Light that comes in from azimuth 0 goes on to 180: patch 3 of the basis. */
static const struct {
    const char *xml;
    double in[2], out[2], value; /* theta, phi */
} matrices[] = {
    { matrix, { 0, 0 }, { 0, 0 }, .10 },
    { matrix, { 10, 77 }, { 50, 0 }, .20 },
    { matrix, { 10, 77 }, { 50, 90 }, .30 },
    { matrix, { 50, 0 }, { 50, 90 }, .33 },
    { matrix, { 50, 90 }, { 80, -90 }, .54 },
    { matrix, { 50, 200 }, { 29, -90 }, .11 },
    { rows, { 10, 77 }, { 50, 90 }, .12 },
    { rows, { 50, 0 }, { 50, 90 }, .42 },
    { matrix, { 50, 0 }, { 130, 90 }, .33 }, /* through */
    { matrix, { 130, 90 }, { 50, 0 }, .33 }, /* reciprocity */
    { matrix, { 130, 90 }, { 130, 0 }, 0 },  /* no data there */
};

LOOP_TEST(matrix_gives_the_value_of_its_patches, N_ELEM(matrices))
{
    struct rad_bsdf *b = must_parse(matrices[_i].xml);
    double in[3], out[3], xyz[3];

    direction(matrices[_i].in[0], matrices[_i].in[1], in);
    direction(matrices[_i].out[0], matrices[_i].out[1], out);
    value(b, in, out, xyz);
    ck_assert_double_eq_tol(xyz[1], matrices[_i].value, 4e-4);
    ck_assert_double_eq_tol(xyz[0], xyz[1], 1e-9);
    ck_assert_double_eq_tol(xyz[2], xyz[1], 1e-9);
}

TEST(colour_is_kept)
{
    struct rad_bsdf *b = must_parse(coloured);
    double in[3], out[3], xyz[3];

    direction(50, 0, in);
    direction(50, 90, out);
    value(b, in, out, xyz);
    ck_assert_double_eq_tol(xyz[0], .66, 4e-4);
    ck_assert_double_eq_tol(xyz[1], .33, 4e-4);
    ck_assert_double_eq_tol(xyz[2], .165, 4e-4);
    rad_bsdf_diffuse(b, true, false, xyz);
    ck_assert_double_eq_tol(xyz[0], M_PI * .2, 1e-3);
    ck_assert_double_eq_tol(xyz[1], M_PI * .1, 1e-3);
    ck_assert_double_eq_tol(xyz[2], M_PI * .05, 1e-3);
}

TEST(least_value_is_the_lambertian_rest)
{
    struct rad_bsdf *b = must_parse(matrix);
    double xyz[3], in[3] = { 0, 0, 1 };
    /* of patch 0: .1 is taken off .2 to .5 in quarters of 3/4 pi */
    double all = (.1 + .2 + .3 + .4) * .75 * M_PI / 4;

    rad_bsdf_diffuse(b, true, false, xyz);
    ck_assert_double_eq_tol(xyz[1], .1 * M_PI, 2e-4);
    rad_bsdf_diffuse(b, false, true, xyz);
    ck_assert_double_eq_tol(xyz[1], .1 * M_PI, 2e-4);
    ck_assert_double_eq_tol(total(b, in, false), all, 1e-3);
    ck_assert(rad_bsdf_scatters(b, true, false));
    ck_assert(rad_bsdf_scatters(b, false, true));
    ck_assert(!rad_bsdf_scatters(b, false, false));
}

/* Shirley and Chiu's square has azimuth 0 to the right, 90 up; upper halves are
 * the second of each pair, the last coordinate's first. */
static const struct {
    const char *xml;
    double in[2], out[2], value;
} trees[] = {
    /* light from (phi + 180) goes on to phi; front data for rank 3 */
    { tree3, { 50, 180 }, { 50, 45 }, .4 },
    { tree3, { 50, 180 }, { 50, -45 }, .3 },
    { tree3, { 50, 180 }, { 50, 135 }, .2 },
    { tree3, { 20, 180 }, { 70, 225 }, .1 },
    { tree3, { 50, 270 }, { 50, 135 }, .4 }, /* turned with the light */
    { tree3, { 50, 180 }, { 130, 45 }, .4 },
    { tree3, { 130, 45 }, { 50, 180 }, .4 }, /* reciprocity */
    /* back data for rank 4: bits 0 and 1 for in, 2 and 3 for out */
    { tree4, { 130, 45 }, { 130, 225 }, .1 },
    { tree4, { 130, 45 }, { 130, 315 }, .5 },
    { tree4, { 130, 45 }, { 130, 135 }, .9 },
    { tree4, { 130, 135 }, { 130, 225 }, .2 },
    { tree4, { 130, 315 }, { 130, 225 }, .3 },
    { tree4, { 130, 225 }, { 130, 225 }, .4 },
    { tree4, { 130, 225 }, { 50, 45 }, .65 },
    { tree4, { 50, 45 }, { 130, 225 }, .65 },
};

LOOP_TEST(tree_gives_the_value_of_its_leaves, N_ELEM(trees))
{
    struct rad_bsdf *b = must_parse(trees[_i].xml);
    double in[3], out[3], xyz[3];

    direction(trees[_i].in[0], trees[_i].in[1], in);
    direction(trees[_i].out[0], trees[_i].out[1], out);
    value(b, in, out, xyz);
    ck_assert_double_eq_tol(xyz[1], trees[_i].value, 4e-4);
}

/* --- drawing ---------------------------------------------------------------
 */

enum { NRINGS = 4, NSECTORS = 8, NBINS = NRINGS * NSECTORS, FINE = 600 };

/* A bin of the projected hemisphere, of equal size. */
static int
bin_of(double x, double y)
{
    int ring = (int)((x * x + y * y) * NRINGS);
    int sector = (int)((atan2(y, x) / M_PI + 1) / 2 * NSECTORS);

    ring = ring < NRINGS ? ring : NRINGS - 1;
    sector = sector < NSECTORS ? sector : NSECTORS - 1;
    return ring * NSECTORS + sector;
}

/* The light that goes to each bin, by quadrature of what is looked up. */
static void
integrate(const struct rad_bsdf *b, const double in[3], bool through,
          double bin[NBINS])
{
    double rest[3];

    rad_bsdf_diffuse(b, in[2] > 0, through, rest);
    for (int i = 0; i < FINE * FINE; i++) {
        double x = (i / FINE + .5) * 2 / FINE - 1;
        double y = (i % FINE + .5) * 2 / FINE - 1;
        double z2 = 1 - x * x - y * y, xyz[3];
        double out[3] = { x, y, sqrt(fmax(z2, 0)) };

        if (z2 <= 0)
            continue;
        if (through == (in[2] > 0))
            out[2] = -out[2];
        value(b, in, out, xyz);
        bin[bin_of(x, y)] += (xyz[1] - rest[1] / M_PI) * 4 / FINE / FINE;
    }
}

static const struct {
    const char *xml;
    double in[2];
    bool through;
} drawn[] = {
    { matrix, { 10, 30 }, false }, { matrix, { 60, 100 }, false },
    { matrix, { 60, 100 }, true }, { matrix, { 120, 100 }, true },
    { rows, { 60, 190 }, false },  { tree3, { 40, 10 }, false },
    { tree3, { 70, 130 }, true },  { tree4, { 130, 45 }, false },
    { tree4, { 150, 80 }, true },  { tree4, { 130, 215 }, true },
    { tree4, { 50, 45 }, true },   { tree4, { 35, 200 }, true },
};

LOOP_TEST(directions_are_drawn_as_light_goes, N_ELEM(drawn))
{
    enum { N = 20000 };
    struct rad_bsdf_eye eye;
    struct rad_bsdf *b = must_parse(drawn[_i].xml);
    double in[3], truth[NBINS] = { 0 }, got[NBINS] = { 0 }, all;

    direction(drawn[_i].in[0], drawn[_i].in[1], in);
    integrate(b, in, drawn[_i].through, truth);
    rad_bsdf_look_from(b, in, &eye);
    all = rad_bsdf_total(&eye, drawn[_i].through);
    for (int i = 0; i < N; i++) {
        double out[3], xyz[3];

        ck_assert(
            rad_bsdf_sample(&eye, drawn[_i].through, (i + .5) / N, out, xyz));
        ck_assert_double_eq_tol(xyz[1], all, 1e-9);
        ck_assert_double_eq_tol(rad_dot(out, out), 1, 1e-9);
        ck_assert_int_eq(out[2] > 0, (in[2] > 0) != drawn[_i].through);
        got[bin_of(out[0], out[1])] += all / N;
    }
    /* bins cut through the quadrature's squares */
    for (int i = 0; i < NBINS; i++)
        ck_assert_double_eq_tol(got[i], truth[i], .004 * all + 4e-4);
}

TEST(neighbouring_numbers_give_neighbouring_directions)
{
    struct rad_bsdf *b = must_parse(tree4);
    double in[3], last[3], out[3], xyz[3], far = 0;
    struct rad_bsdf_eye eye;

    direction(130, 45, in);
    rad_bsdf_look_from(b, in, &eye);
    for (int i = 0; i < 4000; i++) {
        ck_assert(rad_bsdf_sample(&eye, false, (i + .5) / 4000, out, xyz));
        if (i > 0)
            far += hypot(out[0] - last[0], out[1] - last[1]);
        rad_copy(last, out);
    }
    ck_assert_double_lt(far / 4000, .06); /* at random it would be .9 */
}

static const struct {
    const char *xml;
    double in[2], out[2], cell;
} cells[] = {
    { matrix, { 10, 0 }, { 20, 0 }, M_PI / 4 },
    { matrix, { 50, 0 }, { 50, 0 }, M_PI * .75 / 4 },
    { matrix, { 130, 0 }, { 130, 0 }, M_PI },
    { tree3, { 50, 0 }, { 50, 45 }, M_PI / 4 },
    { tree4, { 130, 45 }, { 130, 225 }, M_PI / 4 },
    { tree4, { 170, 45 }, { 170, 135 }, M_PI / 4 },
};

LOOP_TEST(cells_have_their_size, N_ELEM(cells))
{
    struct rad_bsdf *b = must_parse(cells[_i].xml);
    double in[3], out[3], xyz[3];

    direction(cells[_i].in[0], cells[_i].in[1], in);
    direction(cells[_i].out[0], cells[_i].out[1], out);
    ck_assert_double_eq_tol(value(b, in, out, xyz), cells[_i].cell, 1e-9);
}

static const struct {
    const char *xml, *problem;
} bad[] = {
    { "", "line 1" },
    { "<WindowElement>", "line 1" },
    { "<a></b>", "line 1: mismatched tag" },
    { "<a/>", "top element is not WindowElement" },
    { "<!DOCTYPE a [<!ENTITY b \"c\">]><a>&b;</a>", "defines an entity" },
    { "<WindowElement><FileType>x</FileType></WindowElement>",
      "FileType is not BSDF" },
    { "<WindowElement/>", "no optical layer" },
    { "<WindowElement><Optical><Layer/></Optical></WindowElement>",
      "no IncidentDataStructure" },
    { HEAD("Pages") DEFS FOOT, "'Pages' is not supported" },
    { HEAD("TensorTree5") DEFS FOOT, "'TensorTree5' is not supported" },
    { HEAD("Columns") DEFS BLOCK("Visible", OURRF, FIVE, TABLE) FOOT,
      "no angle basis 'Five'" },
    { HEAD("Columns") BASIS DEFS BLOCK("Visible", OURRF, FIVE, "1 2 3") FOOT,
      "value 4 of 25 is missing" },
    { HEAD("Columns") BASIS DEFS BLOCK("Visible", OURRF, FIVE, "1 nan") FOOT,
      "value 2 of 25 is missing or no number" },
    { HEAD("TensorTree4") DEFS BLOCK("Visible", OURRF, "", TREE4) FOOT,
      "angle basis '' of a tree" },
    { HEAD("TensorTree4") DEFS BLOCK("Visible", OURRF, CHIU, "{1 2 3}") FOOT,
      "no power of two" },
    { HEAD("TensorTree4") DEFS BLOCK("Visible", OURRF, CHIU, "{{1}{2}") FOOT,
      "expected '{'" },
    { HEAD("TensorTree3") DEFS BLOCK("Visible", OURRF, CHIU, "{1} 2") FOOT,
      "more behind its end" },
    { HEAD("TensorTree3") DEFS BLOCK("Visible", OURRF, CHIU, "{x}") FOOT,
      "expected a number" },
    { HEAD("TensorTree3") DEFS BLOCK(
          "Visible", OURRF, CHIU, "{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{{1") FOOT,
      "divided too finely" },
};

LOOP_TEST(bad_file_is_refused, N_ELEM(bad))
{
    struct rad_error err = { 0 };

    ck_assert_ptr_null(parse(bad[_i].xml, &err));
    ck_assert(err.code == RAD_EDATA || err.code == RAD_EUNSUPPORTED);
    ck_assert_msg(strstr(err.what, bad[_i].problem) != NULL, "%s", err.what);
}

static char *
put_leaves(char *to, int levels)
{
    *to++ = '{';
    if (levels == 0)
        *to++ = '1';
    for (int i = 0; levels > 0 && i < 16; i++)
        to = put_leaves(to, levels - 1);
    *to++ = '}';
    return to;
}

/* A million leaves take some 50 MB.  It takes a process of its own, which has
 * no memory from other tests. */
TEST(large_tree_wants_memory)
{
    static const char head[] = HEAD("TensorTree4") DEFS
        "<WavelengthData><Wavelength>Visible</Wavelength>"
        "<WavelengthDataBlock><WavelengthDataDirection>" OURRF
        "</WavelengthDataDirection>" CHIU "<ScatteringData>";
    static const char foot[] = "</ScatteringData></WavelengthDataBlock>"
                               "</WavelengthData>" FOOT;
    char *xml = malloc(8 << 20), *end;
    const char *fork = getenv("CK_FORK");
    struct rad_error err = { 0 };
    struct rlimit limit;
    unsigned long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");

    ck_assert(xml && f && fscanf(f, "%lu", &pages) == 1);
    fclose(f);
    if (!fork || strcmp(fork, "no") != 0) {
        strcpy(xml, head);
        end = put_leaves(xml + strlen(head), 5);
        strcpy(end, foot);
        ck_assert_int_eq(getrlimit(RLIMIT_AS, &limit), 0);
        limit.rlim_cur = pages * (rlim_t)sysconf(_SC_PAGESIZE) + (24 << 20);
        ck_assert_int_eq(setrlimit(RLIMIT_AS, &limit), 0);
        ck_assert_ptr_null(parse(xml, &err));
        ck_assert_msg(err.code == RAD_ENOMEM, "%s", err.what);
    }
    free(xml);
}

/* --- materials --------------------------------------------------------------
 */

/* Nothing passes but straight ahead: .6 in one cell of 1/16. */
enum { PEAK_LEVELS = 4 };

static char *
add_peak(char *to, int level)
{
    if (level == PEAK_LEVELS)
        return to + sprintf(to, "{%.9g}", .6 * 256 / M_PI);
    *to++ = '{';
    for (unsigned bits = 0; bits < 16; bits++) {
        if ((bits & 3) == bits >> 2) /* in and out alike */
            to = add_peak(to, level + 1);
        else
            to += sprintf(to, "{0}");
    }
    *to++ = '}';
    *to = '\0';
    return to;
}

static char peak[1 << 18];

static void
make_peak(void)
{
    char *to = peak;

    to += sprintf(to, "%s",
                  HEAD("TensorTree4") DEFS
                  "<WavelengthData><Wavelength>Visible</Wavelength>"
                  "<WavelengthDataBlock><WavelengthDataDirection>" OURTF
                  "</WavelengthDataDirection>" CHIU "<ScatteringData>");
    to = add_peak(to, 0);
    sprintf(to, "%s",
            "</ScatteringData></WavelengthDataBlock></WavelengthData>" FOOT);
}

FIXTURE(make_peak, NULL)

/* All .2 / pi, so Lambertian: 20 % each way, with colour by the material. */
#define EVEN                                                                   \
    "{.063661977 .063661977 .063661977 .063661977 .063661977 .063661977 "      \
    ".063661977 .063661977}"

static const char even[] =
    HEAD("TensorTree3") DEFS BLOCK("Visible", OURRF, CHIU, EVEN)
        BLOCK("Visible", OURTF, CHIU, EVEN) FOOT;
/* Reflects alike wherever light comes from. */
static const char fan[] = HEAD("Columns")
    BASIS DEFS BLOCK("Visible", OURRF, FIVE,
                     ".1 .1 .1 .1 .1 .2 .2 .2 .2 .2 .3 .3 .3 "
                     ".3 .3 .4 .4 .4 .4 .4 .5 .5 .5 .5 .5") FOOT;
static struct world_file texts[] = { { "even.xml", even },
                                     { "peak.xml", peak },
                                     { "matrix.xml", matrix },
                                     { "fan.xml", fan },
                                     { 0 } };
static const struct rad_files files = { .read = world_file_read, .arg = texts };

#define PLAIN "-av 0 0 0 -st 1 -lw 0 -lr 30 -ss 0 -dj 0 -ds 0 -dt 0 -dc 1"
#define PANE                                                                   \
    " polygon pane 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"                       \
    "void light lamp 0 0 3 9 9 9\n"
#define ABOVE "lamp sphere l 0 0 4 1 2 5 .1\n"
#define BELOW "lamp sphere l 0 0 4 1 2 -5 .1\n"

/* What is seen from dir at the origin. */
static struct rad_rgb
see(const char *scene, const char *options, double x, double y, double z)
{
    return world_glance(scene, options, &files, x, y, z, -x, -y, -z);
}

static const struct {
    const char *ours, *same;
    double x, y, z;
} lambertian[] = {
    { "void BSDF m 6 0 even.xml 0 1 0 . 0 0\nm" PANE ABOVE,
      "void trans m 0 0 7 .4 .4 .4 0 0 .5 0\nm" PANE ABOVE, 1, 0, 2 },
    { "void BSDF m 6 0 even.xml 0 1 0 . 0 3 .1 .2 .3\nm" PANE ABOVE,
      "void plastic m 0 0 5 .3 .4 .5 0 0\nm" PANE ABOVE, 1, 0, 2 },
    { "void BSDF m 6 0 even.xml 0 1 0 . 0 9 0 0 0 .1 .2 .3 0 0 0\nm" PANE BELOW,
      "void plastic m 0 0 5 .1 .2 .3 0 0\nm" PANE BELOW, 1, 0, -2 },
    { "void aBSDF m 5 even.xml 0 1 0 . 0 9 0 0 0 0 0 0 .1 0 .2\nm" PANE BELOW,
      "void trans m 0 0 7 .3 .2 .4 0 0 1 0\nm" PANE BELOW, 1, 0, 2 },
    { "void brightfunc p 2 .5 . 0 0\np BSDF m 6 0 even.xml 0 1 0 . 0 0\n"
      "m" PANE BELOW,
      "void trans m 0 0 7 .1 .1 .1 0 0 1 0\nm" PANE BELOW, 1, 0, 2 },
};

LOOP_TEST(even_scattering_is_lambertian, N_ELEM(lambertian))
{
    /* what the others pass or not is another matter */
    const char *options = _i == 0 ? PLAIN " -av .1 .2 .3" : PLAIN;
    struct rad_rgb a = see(lambertian[_i].ours, options, lambertian[_i].x,
                           lambertian[_i].y, lambertian[_i].z);
    struct rad_rgb b = see(lambertian[_i].same, options, lambertian[_i].x,
                           lambertian[_i].y, lambertian[_i].z);

    ck_assert_float_gt(b.g, 0);
    ck_assert_float_eq_tol(a.r, b.r, 2e-5f * b.r);
    ck_assert_float_eq_tol(a.g, b.g, 2e-5f * b.g);
    ck_assert_float_eq_tol(a.b, b.b, 2e-5f * b.b);
}

/* A lamp's light by the matrix: value times cosine, solid angle, radiance. */
TEST(direct_light_follows_the_data)
{
    struct rad_rgb L =
        see("void BSDF m 6 0 matrix.xml 0 1 0 . 0 0\nm" PANE ABOVE, PLAIN, -1,
            0, 1);
    double d2 = 1 + 4 + 25, cos_l = 5 / sqrt(d2);
    /* the eye at azimuth 180 is patch 1 of light in, the lamp at theta 24 is
     * patch 0 of light out */
    double value = .11, omega = M_PI * .01 / d2;

    ck_assert_double_eq_tol(L.g, value * cos_l * omega * 9, 2e-3 * L.g);
}

/* Mean light of a lamp overhead, scattered at the origin to 60 degrees from the
 * vertical, with -ss .1. */
static double
scattered_to(struct world *at, double azimuth, int times)
{
    double x = 2 * cos(azimuth), y = 2 * sin(azimuth), z = 2 / sqrt(3), sum = 0;

    for (int i = 0; i < times; i++) {
        struct rad_ray r;

        world_ray(at, &r, x, y, z, -x, -y, -z);
        r.key = rad_key_branch(5, (uint64_t)i);
        rad_ray_trace(&at->ctx, &r);
        sum += (double)r.L.g / times;
    }
    return sum;
}

/* An eye between two patches gets the mean of them. */
TEST(the_eye_is_jittered_evenly)
{
    struct world at = { 0 };

    ck_assert_int_eq(world_try(&at,
                               "void BSDF m 6 0 matrix.xml 0 1 0 . 0 0\nm" PANE
                               "lamp sphere l 0 0 4 0 0 5 .1\n",
                               PLAIN " -ss .1", &files),
                     0);
    for (int i = 0; i < 4; i++) {
        double a = scattered_to(&at, i * M_PI / 2, 1);
        double b = scattered_to(&at, (i + 1) * M_PI / 2, 1);
        double mean = scattered_to(&at, (i + .5) * M_PI / 2, 20000);

        ck_assert_double_ne(a, b);
        ck_assert_double_eq_tol(mean, (a + b) / 2, .02 * fabs(a - b));
    }
    world_close(&at);
}

/* A part of the vector that has no value is 0. */
TEST(way_up_may_lack_a_value)
{
#define UP(vector) "void BSDF m 6 0 matrix.xml " vector " . 0 0\nm" PANE ABOVE
    struct rad_rgb a = see(UP("0 1 0"), PLAIN, -1, 0, 1);
    struct rad_rgb b = see(UP("sqrt(Px-9) 1 0"), PLAIN, -1, 0, 1);
    struct rad_rgb none = see(UP("sqrt(Px-9) log(Px-9) 0"), PLAIN, -1, 0, 1);

    ck_assert_float_gt(a.g, 0);
    ck_assert_float_eq(a.g, b.g);
    ck_assert_float_eq(none.g, 0);
}

#define SKY                                                                    \
    "void brightfunc up 2 2+Dz . 0 0\nup glow sky 0 0 4 1 1 1 0\n"             \
    "sky source s 0 0 4 0 0 1 360\n"

TEST(peak_is_seen_through)
{
    double c = 2 / sqrt(5);
    struct rad_rgb L =
        see("void aBSDF m 5 peak.xml 0 1 0 . 0 0\nm" PANE SKY, PLAIN, 1, 0, 2);

    ck_assert_double_eq_tol(L.g, .6 * (2 - c), 1e-3);
    /* as scattering it is all ambient with -st 1 */
    L = see("void BSDF m 6 0 peak.xml 0 1 0 . 0 0\nm" PANE SKY, PLAIN, 1, 0, 2);
    ck_assert_double_eq_tol(L.g, 0, 1e-9);
}

TEST(peak_casts_a_shadow)
{
#define FLOOR                                                                  \
    "void plastic w 0 0 5 .5 .5 .5 0 0\n"                                      \
    "w ring floor 0 0 8 0 0 0 0 0 1 0 9\nvoid light lamp 0 0 3 9 9 9\n"        \
    "lamp sphere l 0 0 4 1 2 5 .1\n"
    struct rad_rgb lit = see(FLOOR, PLAIN, 1, 0, .5);
    struct rad_rgb shaded = see(FLOOR "void aBSDF m 5 peak.xml 0 1 0 . 0 0\n"
                                      "m ring pane 0 0 8 0 0 2 0 0 1 0 9\n",
                                PLAIN, 1, 0, .5);

    ck_assert_double_eq_tol(shaded.g, .6 * lit.g, 1e-3 * lit.g);
    /* a BSDF without a thickness stops all */
    shaded = see(FLOOR "void BSDF m 6 0 peak.xml 0 1 0 . 0 0\n"
                       "m ring pane 0 0 8 0 0 2 0 0 1 0 9\n",
                 PLAIN, 1, 0, .5);
    ck_assert_double_eq_tol(shaded.g, 0, 1e-9);
}

/* Eye and lamp see the geometry that a BSDF of a thickness stands in for. */
TEST(thickness_hides_the_surface)
{
    struct rad_rgb bare = see(FLOOR, PLAIN, 1, 0, 4);
    struct rad_rgb behind = see(FLOOR "void BSDF m 6 1 matrix.xml 0 1 0 . 0 0\n"
                                      "m ring pane 0 0 8 0 0 1 0 0 1 0 9\n",
                                PLAIN, 1, 0, 4);

    ck_assert_float_gt(bare.g, 0);
    ck_assert_float_eq(behind.g, bare.g);
}

/* A glossy ray meets the surface, and its light starts a thickness deeper,
 * beyond the ring that is dark otherwise. */
TEST(scattered_light_passes_what_is_behind)
{
#define GLOSSY                                                                 \
    "void trans g 0 0 7 1 1 1 0 .1 1 1\ng ring eye 0 0 8 0 0 3 0 0 1 0 9\n"    \
    "void plastic black 0 0 5 0 0 0 0 0\n"                                     \
    "black ring hidden 0 0 8 0 0 .5 0 0 1 0 9\n"                               \
    "void glow sky 0 0 4 1 1 1 0\nsky source s 0 0 4 0 0 -1 180\n"
    double some = see(GLOSSY "void BSDF m 6 1 even.xml 0 1 0 . 0 0\n"
                             "m ring pane 0 0 8 0 0 1 0 0 1 0 9\n",
                      PLAIN " -st 0 -av 1 1 1", 0, 0, 9)
                      .g;
    double none = see(GLOSSY, PLAIN " -st 0 -av 1 1 1", 0, 0, 9).g;

    ck_assert_double_eq_tol(none, 0, 1e-9);
    ck_assert_double_eq_tol(some, .4, 1e-3); /* both parts are Lambertian */
}

/* ... and so do lamps: one before the surface lights it where it is met, one
 * behind it a thickness deeper. */
TEST(a_thick_surface_is_lit_from_both_sides)
{
    static const struct {
        const char *lamp;
        double x, z; /* from the place that it lights */
    } lit[] = {
        { "lamp sphere l 0 0 4 2 0 2 .1\n", 2, 2 },
        { "lamp sphere l 0 0 4 4 0 -5 .1\n", 4, 4 },
    };

    for (int i = 0; i < 2; i++) {
        double d2 = lit[i].x * lit[i].x + lit[i].z * lit[i].z;
        double want = .2 * lit[i].z / sqrt(d2) * .01 / d2 * 9;
        char scene[1024];

        snprintf(scene, sizeof scene,
                 "void trans g 0 0 7 1 1 1 0 .1 1 1\n"
                 "g ring eye 0 0 8 0 0 3 0 0 1 0 9\n"
                 "void BSDF m 6 1 even.xml 0 1 0 . 0 0\nm" PANE "%s",
                 lit[i].lamp);
        ck_assert_double_eq_tol(see(scene, PLAIN " -st 0", 0, 0, 9).g, want,
                                2e-3 * want);
    }
}

/* Sampled light of an even sky is what is scattered. */
TEST(sampled_light_is_all_of_it)
{
    struct rad_rgb L =
        see("void BSDF m 6 0 matrix.xml 0 1 0 . 0 0\nm" PANE
            "void glow sky 0 0 4 1 1 1 0\nsky source s 0 0 4 0 0 1 360\n",
            "-av 0 0 0 -st 0 -lw 0 -lr 30 -ss 64 -ab 0", -1, 0, 1);
    /* patch 1 of light in, less the rest of .1: .01, .11, .21, .31, .41 */
    double total = M_PI / 4 * .01 + M_PI * .75 / 4 * (.11 + .21 + .31 + .41);

    ck_assert_double_eq_tol(L.g, 2 * total, .03 * total);
}

/* A surface that leans to x by the sine .6, up along y, under a sky that is
 * brighter to one side: the mean of samples is the integral over its front. */
TEST(samples_go_where_the_data_say)
{
    static const double axis[3][3] = { { .8, 0, -.6 },
                                       { 0, 1, 0 },
                                       { .6, 0, .8 } };
    enum { N = 300, TIMES = 40000 };
    double in[3] = { -M_SQRT1_2, 0, M_SQRT1_2 }, want = 0, sum = 0;
    struct rad_bsdf *b = must_parse(fan);
    struct world at = { 0 };

    for (int i = 0; i < N * N; i++) {
        double len = sqrt((i % N + .5) / N), phi = 2 * M_PI * (i / N + .5) / N;
        double out[3] = { len * cos(phi), len * sin(phi), sqrt(1 - len * len) };
        double xyz[3], d[3] = { 0, 0, 0 };

        value(b, in, out, xyz);
        for (int k = 0; k < 3; k++)
            rad_madd(d, d, out[k], axis[k]);
        /* .1 is the same for all, and no part of what is sampled */
        want += (xyz[1] - .1) * (2 + .5 * d[0] + .7 * d[1] + .3 * d[2]) * M_PI /
                (N * N);
    }
    ck_assert_int_eq(
        world_try(&at,
                  "void BSDF m 6 0 fan.xml 0 1 0 . 0 0\n"
                  "m polygon p 0 0 12 -4 -9 3 4 -9 -3 4 9 -3 -4 9 3\n"
                  "void brightfunc f 2 2+.5*Dx+.7*Dy+.3*Dz . 0 0\n"
                  "f glow sky 0 0 4 1 1 1 0\nsky source s 0 0 4 0 0 1 360\n",
                  PLAIN " -st 0 -ss 1", &files),
        0);
    for (int i = 0; i < TIMES; i++) {
        struct rad_ray r;

        world_ray(&at, &r, -.2, 0, 1.4, .2, 0, -1.4);
        r.key = rad_key_branch(6, (uint64_t)i);
        rad_ray_trace(&at.ctx, &r);
        sum += (double)r.L.g / TIMES;
    }
    world_close(&at);
    ck_assert_double_eq_tol(sum, want, .01 * want);
}

static const struct {
    const char *material, *problem;
} refused[] = {
    { "BSDF m 6 0 none.xml 0 1 0 . 0 0", "none.xml" },
    { "BSDF m 5 0 even.xml 0 1 0 0 0", "at least 6 string" },
    { "BSDF m 6 0 even.xml 0 1 0 . 0 4 1 1 1 1", "0, 3, 6 or 9 real" },
    { "aBSDF m 5 even.xml 0 nope 0 . 0 0", "undefined variable 'nope'" },
};

LOOP_TEST(bad_material_is_refused_by_name, N_ELEM(refused))
{
    char scene[512];

    snprintf(scene, sizeof scene, "void %s\nm" PANE, refused[_i].material);
    world_refused(scene, PLAIN, &files, refused[_i].problem);
}

TEST(file_belongs_to_the_bundle)
{
    static const char *const strings[] = {
        "0", "a.xml", "x", "y", "z", "b.cal"
    };
    struct rad_object o = { .type = RAD_BSDF,
                            .strings = strings,
                            .nstrings = 6 };

    ck_assert_str_eq(rad_object_file(&o, 0), "a.xml");
    ck_assert_str_eq(rad_object_file(&o, 1), "b.cal");
    ck_assert_ptr_null(rad_object_file(&o, 2));
    o = (struct rad_object){ .type = RAD_ABSDF,
                             .strings = strings + 1,
                             .nstrings = 5 };
    ck_assert_str_eq(rad_object_file(&o, 0), "a.xml");
    ck_assert_str_eq(rad_object_file(&o, 1), "b.cal");
}
