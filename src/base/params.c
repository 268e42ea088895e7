/* params.c - see params.h
 *
 * An option is one row of the table, which parsing, printing, range checks and
 * help share.  The order is that of rpict -defaults. */
#include "config.h"

#include "base/params.h"
#include "base/number.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* rpict treats a larger -ps as 16, and so do we */
enum { LARGEST_PSAMPLE = 16 };
/* a ray's depth has 16 bits */
enum { DEEPEST = 30000 };

enum kind {
    KIND_BOOL, /* -dv+ -dv- -dv (toggles) */
    KIND_INT,
    KIND_REAL,
    KIND_RGB,
    KIND_U64,   /* --seed=N */
    KIND_PRIMS, /* -pRGB -pXYZ -pc: exclude each other */
    KIND_LIST,  /* -ae -ai: each use adds a name */
    KIND_WAVES, /* -cw: two wavelengths */
    KIND_BALL   /* --shown: centre and radius */
};

struct option {
    const char *name;
    enum kind kind;
    size_t field;  /* offset in struct rad_params */
    double lo, hi; /* range, ends included */
    double value;  /* default, of each channel with KIND_RGB */
    const char *help;
};

/* In place of `lo`: what is less than 0 counts as 0, as in rpict. */
#define FROM_0 (-HUGE_VAL)

#define FIELD(f) offsetof(struct rad_params, f)
#define BOOL(name, f, on, help)                                                \
    {                                                                          \
        name, KIND_BOOL, FIELD(f), 0, 1, on, help                              \
    }
#define INT(name, f, lo, hi, v, help)                                          \
    {                                                                          \
        name, KIND_INT, FIELD(f), lo, hi, v, help                              \
    }
#define REAL(name, f, lo, v, help)                                             \
    {                                                                          \
        name, KIND_REAL, FIELD(f), lo, DBL_MAX, v, help                        \
    }
#define RGB(name, f, help)                                                     \
    {                                                                          \
        name, KIND_RGB, FIELD(f), 0, FLT_MAX, 0, help                          \
    }

/* clang-format off */
static const struct option options[] = {
    INT("-x", xres, 1, RAD_MAX_RES, 512, "most columns"),
    INT("-y", yres, 1, RAD_MAX_RES, 512, "most rows"),
    { "-pRGB", KIND_PRIMS, 0, 0, 0, RAD_PRIM_RGB,
      "standard RGB color output" },
    { "-pXYZ", KIND_PRIMS, 0, 0, 0, RAD_PRIM_XYZ, "CIE XYZ color output" },
    { "-pc", KIND_PRIMS, 0, 0, 0, RAD_PRIM_CUSTOM,
      "output color primaries and white point" },
    REAL("-pa", pixaspect, -DBL_MAX, 1, "pixel aspect ratio, height / width"),
    REAL("-pj", pixjitter, 0, .67, "pixel jitter"),
    INT("-ps", psample, INT_MIN, INT_MAX, 4, "pixel sample spacing, 1 to 16"),
    REAL("-pt", maxdiff, 0, .05, "pixel threshold"),
    REAL("-pm", motion, FROM_0, 0, "pixel motion"),
    REAL("-pd", aperture, FROM_0, 0, "pixel depth-of-field"),
    BOOL("-i", irradiance, 0, "irradiance calculation"),
    BOOL("-u", rand_samp, 0, "uncorrelated Monte Carlo sampling"),
    BOOL("-bv", backvis, 1, "back face visibility"),
    REAL("-dt", shadthresh, FROM_0, .05, "direct threshold"),
    REAL("-dc", shadcert, 0, .5, "direct certainty"),
    REAL("-dj", srcjitter, 0, 0, "direct jitter"),
    REAL("-ds", srcsizerat, FROM_0, .25, "direct sampling"),
    INT("-dr", directrelay, FROM_0, 1000, 1, "direct relays"),
    INT("-dp", vspretest, FROM_0, INT_MAX, 512, "direct pretest density"),
    BOOL("-dv", directvis, 1, "direct visibility"),
    REAL("-ss", specjitter, 0, 1, "specular sampling"),
    REAL("-st", specthresh, FROM_0, .15, "specular threshold"),
    RGB("-av", ambval, "ambient value"),
    INT("-aw", ambvwt, FROM_0, INT_MAX, 0, "ambient value weight"),
    INT("-ab", ambounce, FROM_0, DEEPEST, 0, "ambient bounces"),
    REAL("-aa", ambacc, FROM_0, .2, "ambient accuracy"),
    INT("-ar", ambres, FROM_0, INT_MAX, 64, "ambient resolution"),
    INT("-ad", ambdiv, FROM_0, 1 << 24, 512, "ambient divisions"),
    INT("-as", ambssamp, FROM_0, 1 << 24, 128, "ambient super-samples"),
    { "-ae", KIND_LIST, 0, 0, 0, RAD_AMB_EXCLUDE,
      "modifiers with no ambient calculation" },
    { "-ai", KIND_LIST, 0, 0, 0, RAD_AMB_INCLUDE,
      "modifiers with ambient calculation" },
    RGB("-me", cextinction, "mist extinction coefficient"),
    RGB("-ma", salbedo, "mist scattering albedo"),
    { "-mg", KIND_REAL, FIELD(seccg), -1, 1, 0,
      "mist scattering eccentricity" },
    REAL("-ms", ssampdist, FROM_0, 0, "mist sampling distance"),
    INT("-lr", maxdepth, -DEEPEST, DEEPEST, 7,
        "limit reflection, 0 or less: Russian roulette"),
    REAL("-lw", minweight, FROM_0, 1e-4, "limit weight"),
    INT("-cs", bands.n, 3, INT_MAX, 3, "bands of wavelengths, 3 to 24"),
    { "-cw", KIND_WAVES, FIELD(bands), 1, 1e6, 0,
      "extreme wavelengths in nanometers" },
    INT("--plane", bands.plane, -1, RAD_PLANE_COLOURS, -1,
        "of -cs, the one that is rendered; -1: all; 8: red, green, blue"),
    INT("--samples", samples, 1, RAD_MOST_SAMPLES, 1,
        "rays of a pixel that is traced"),
    INT("--surroundings", surroundings, 0, 1 << 30, 0,
        "the scene's size over that of what is shown, 0: found"),
    { "--shown", KIND_BALL, FIELD(shown), 0, 0, 0,
      "centre and radius of a ball that holds it" },
    { "--seed", KIND_U64, FIELD(seed), 0, 0, 0, "of all random numbers" }
};

/* rpict's options that we lack.  Programs take some by themselves: -vf -o -z -S
 * -t -e -w -aE -aI -af -defaults -help -version -features */
static const struct {
    const char *name, *why;
} lacking[] = {
    { "-f", "definitions belong in the function files of the scene" },
    { "-r", "a job keeps what is rendered and goes on by itself; submit it "
            "again" },
    { "-ro", "a job keeps what is rendered and goes on by itself; submit it "
             "again" },
    { "-P", "the daemons stay, and a second job sends no scene again" },
    { "-PP", "the daemons stay, and a second job sends no scene again" },
    { "-ap", "there are no photon maps" },
    { "-am", "there are no photon maps" },
    { "-ac", "there are no photon maps" },
    { "-aC", "there are no photon maps" },
    { "-aH", "there are no photon maps" }
};
/* clang-format on */

#define NOPTIONS (sizeof options / sizeof options[0])

static void *
field_of(struct rad_params *p, const struct option *o)
{
    return (char *)p + o->field;
}

void
rad_params_init(struct rad_params *p)
{
    memset(p, 0, sizeof *p);
    for (size_t i = 0; i < NOPTIONS; i++) {
        const struct option *o = &options[i];
        void *field = field_of(p, o);

        switch (o->kind) {
        case KIND_BOOL:
            *(bool *)field = o->value != 0;
            break;
        case KIND_INT:
            *(int *)field = (int)o->value;
            break;
        case KIND_REAL:
            *(double *)field = o->value;
            break;
        case KIND_RGB:
            *(struct rad_rgb *)field = rad_grey((float)o->value);
            break;
        case KIND_U64:
            *(uint64_t *)field = (uint64_t)o->value;
            break;
        case KIND_WAVES:
            ((struct rad_bands *)field)->longest = RAD_LONGEST_WAVE;
            ((struct rad_bands *)field)->shortest = RAD_SHORTEST_WAVE;
            break;
        case KIND_BALL: /* none, RGB and an empty list are all zeros */
        case KIND_PRIMS:
        case KIND_LIST:
            break;
        }
    }
}

bool
rad_params_switch(const char *word, const char *name, bool *on)
{
    const char *rest;

    if (strncmp(word, name, strlen(name)) != 0)
        return false;
    rest = word + strlen(name);
    if (rest[0] && rest[1])
        return false;
    if (rest[0] && !strchr("+1yYtT-0nNfF", rest[0]))
        return false;
    *on = rest[0] ? strchr("+1yYtT", rest[0]) != NULL : !*on;
    return true;
}

/* The text after the name of a boolean or long option; NULL: another option. */
static const char *
name_ends(const struct option *o, const char *word)
{
    size_t n = strlen(o->name);
    const char *rest;
    bool on = false;

    if (strncmp(word, o->name, n) != 0)
        return NULL;
    rest = word + n;
    if (o->kind == KIND_BOOL)
        return rad_params_switch(rest, "", &on) ? rest : NULL;
    return *rest == '=' && o->name[1] == '-' ? rest + 1 : *rest ? NULL : rest;
}

static const struct option *
find_option(const char *word, const char **rest)
{
    for (size_t i = 0; i < NOPTIONS; i++)
        if ((*rest = name_ends(&options[i], word)) != NULL)
            return &options[i];
    return NULL;
}

static int
bad_range(const struct option *o, double v, const char *text,
          struct rad_error *err)
{
    char lo[RAD_NUMBER_TEXT], hi[RAD_NUMBER_TEXT];

    rad_format_real(lo, o->lo == FROM_0 ? 0 : o->lo);
    rad_format_real(hi, o->hi);
    if (v < o->lo && (o->hi >= FLT_MAX || o->hi == INT_MAX))
        return rad_fail(err, RAD_EUSAGE, "option '%s': '%.40s' is less than %s",
                        o->name, text, lo);
    return rad_fail(err, RAD_EUSAGE,
                    "option '%s': '%.40s' is not between %s and %s", o->name,
                    text, lo, hi);
}

static int
take_int(int *field, const struct option *o, const char *text,
         struct rad_error *err)
{
    int v;

    if (!rad_parse_int(text, &v))
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s': expected an integer, got '%.40s'",
                        o->name, text);
    if (o->lo == FROM_0 && v < 0)
        v = 0;
    if (v < o->lo || v > o->hi)
        return bad_range(o, v, text, err);
    *field = v;
    return 0;
}

static int
take_real(double *field, const struct option *o, const char *text,
          struct rad_error *err)
{
    double v;

    if (!rad_parse_real(text, &v))
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s': expected a number, got '%.40s'", o->name,
                        text);
    if (o->lo == FROM_0 && v < 0)
        v = 0;
    if (v < o->lo || v > o->hi)
        return bad_range(o, v, text, err);
    *field = v;
    return 0;
}

static int
take_rgb(struct rad_rgb *field, const struct option *o, char *const argv[],
         struct rad_error *err)
{
    double v[3];

    for (int i = 0; i < 3; i++) {
        int rc = take_real(&v[i], o, argv[i], err);

        if (rc < 0)
            return rc;
    }
    *field = rad_rgb((float)v[0], (float)v[1], (float)v[2]);
    return 0;
}

/* Take two wavelengths, in either order. */
static int
take_waves(struct rad_bands *b, const struct option *o, char *const argv[],
           struct rad_error *err)
{
    double v[2];

    for (int i = 0; i < 2; i++) {
        int rc = take_real(&v[i], o, argv[i], err);

        if (rc < 0)
            return rc;
    }
    b->longest = fmax(v[0], v[1]);
    b->shortest = fmin(v[0], v[1]);
    return 0;
}

static int
take_ball(double ball[4], const struct option *o, char *const argv[],
          struct rad_error *err)
{
    double v[4];

    for (int i = 0; i < 4; i++)
        if (!rad_parse_real(argv[i], &v[i]))
            return rad_fail(err, RAD_EUSAGE,
                            "option '%s': expected a number, got '%.40s'",
                            o->name, argv[i]);
    if (!(v[3] > 0))
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s': the radius '%.40s' is not above 0",
                        o->name, argv[3]);
    memcpy(ball, v, sizeof v);
    return 0;
}

static int
take_u64(uint64_t *field, const struct option *o, const char *text,
         struct rad_error *err)
{
    if (!rad_parse_u64(text, field))
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s': expected a whole number from 0 to "
                        "18446744073709551615, got '%.40s'",
                        o->name, text);
    return 0;
}

/* How many words of values follow the option. */
static int
words_of(const struct option *o, const char *rest)
{
    switch (o->kind) {
    case KIND_INT:
    case KIND_U64:
        return rest[-1] == '=' ? 0 : 1;
    case KIND_REAL:
        return 1;
    case KIND_RGB:
        return 3;
    case KIND_WAVES:
        return 2;
    case KIND_BALL:
        return 4;
    case KIND_LIST:
        return 1;
    case KIND_PRIMS:
        return o->value == RAD_PRIM_CUSTOM ? 8 : 0;
    default:
        return 0;
    }
}

/* Are these eight numbers Radiance's own primaries, to three digits? */
static bool
are_standard(const double c[8])
{
    static const double own[8] = {
        .64, .33, .29, .6, .15, .06, 1. / 3, 1. / 3
    };

    for (int i = 0; i < 8; i++)
        if (fabs(c[i] - own[i]) > .001)
            return false;
    return true;
}

/* Do the chromaticities span colours?  As in rpict: none out of range, no two
 * the same, and a white point inside the diagram. */
static bool
chromaticities_fit(const double c[8])
{
    const double eps = 1e-4;

    for (int i = 0; i < 8; i += 2) {
        double sum = c[i] + c[i + 1];

        if (!(c[i] > -2 && c[i] < 3 && c[i + 1] > -2 && c[i + 1] < 3 &&
              sum > -2 && sum < 3))
            return false;
        for (int j = i + 2; j < 8; j += 2)
            if (fabs(c[i] - c[j]) <= eps && fabs(c[i + 1] - c[j + 1]) <= eps)
                return false;
    }
    return c[6] > eps && c[6] < 1 - eps && c[7] > eps && c[7] < 1 - eps;
}

static int
take_prims(struct rad_params *p, const struct option *o, char *const argv[],
           struct rad_error *err)
{
    double c[8] = { 0 };

    if (o->value == RAD_PRIM_CUSTOM) {
        for (int i = 0; i < 8; i++)
            if (!rad_parse_real(argv[i], &c[i]))
                return rad_fail(err, RAD_EUSAGE,
                                "option '-pc': expected a number, got '%.40s'",
                                argv[i]);
        if (!are_standard(c) && !chromaticities_fit(c))
            return rad_fail(err, RAD_EUSAGE,
                            "option '-pc': illegal primary chromaticities");
    }
    p->primaries = (enum rad_primaries)o->value;
    if (o->value == RAD_PRIM_CUSTOM && are_standard(c)) {
        p->primaries = RAD_PRIM_RGB;
        memset(c, 0, sizeof c);
    }
    memcpy(p->chroma, c, sizeof c);
    return 0;
}

/* Add a name to the list.  As in rpict there is one list, of the kind of the
 * last option. */
static int
take_name(struct rad_params *p, const struct option *o, const char *name,
          struct rad_error *err)
{
    size_t used, n = strlen(name), total;

    if (n == 0 || strpbrk(name, " \t\r\n"))
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s': '%.40s' is no modifier's name", o->name,
                        name);
    if (p->amblisted != (int)o->value)
        memset(p->amblist, 0, sizeof p->amblist);
    used = strlen(p->amblist);
    total = n + 5;
    for (const char *s = p->amblist; *s; s++)
        total += *s == ' ' ? 5 : 1;
    total += used > 0 ? 5 : 0;
    if (total > sizeof p->amblist)
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s': more than %d bytes of options in all",
                        o->name, RAD_MAX_AMBLIST);
    p->amblisted = (int)o->value;
    if (used > 0)
        p->amblist[used++] = ' ';
    memcpy(p->amblist + used, name, n + 1);
    return 0;
}

static int
take_value(struct rad_params *p, const struct option *o, const char *rest,
           char *const argv[], struct rad_error *err)
{
    void *field = field_of(p, o);
    const char *text = rest[-1] == '=' ? rest : argv[1];

    switch (o->kind) {
    case KIND_BOOL:
        rad_params_switch(rest, "", field);
        return 0;
    case KIND_INT:
        return take_int(field, o, text, err);
    case KIND_REAL:
        return take_real(field, o, argv[1], err);
    case KIND_RGB:
        return take_rgb(field, o, argv + 1, err);
    case KIND_WAVES:
        return take_waves(field, o, argv + 1, err);
    case KIND_BALL:
        return take_ball(field, o, argv + 1, err);
    case KIND_U64:
        return take_u64(field, o, text, err);
    case KIND_PRIMS:
        return take_prims(p, o, argv + 1, err);
    case KIND_LIST:
        return take_name(p, o, argv[1], err);
    default:
        return 0;
    }
}

/* Is it -am 0, which limits nothing?  rpict -defaults names it. */
static bool
is_no_limit(int argc, char *const argv[])
{
    double most;

    return argc > 1 && strcmp(argv[0], "-am") == 0 &&
           rad_parse_real(argv[1], &most) && most == 0;
}

static int
refuse_lacking(const char *word, struct rad_error *err)
{
    for (size_t i = 0; i < sizeof lacking / sizeof lacking[0]; i++) {
        size_t n = strlen(lacking[i].name);

        if (strncmp(word, lacking[i].name, n) == 0 &&
            (word[n] == '\0' || (strchr("+-", word[n]) && !word[n + 1])))
            return rad_fail(err, RAD_EUSAGE,
                            "option '%s' of rpict is not supported: %s", word,
                            lacking[i].why);
    }
    return 0;
}

int
rad_params_option(struct rad_params *p, int argc, char *const argv[],
                  struct rad_error *err)
{
    const struct option *o;
    const char *rest;
    int nwords, rc;

    if (argc < 1 || argv[0][0] != '-')
        return 0;
    o = find_option(argv[0], &rest);
    if (!o)
        return is_no_limit(argc, argv) ? 2 : refuse_lacking(argv[0], err);
    nwords = words_of(o, rest);
    if (argc - 1 < nwords)
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s': expected %d value%s, got %d", o->name,
                        nwords, nwords > 1 ? "s" : "", argc - 1);
    rc = take_value(p, o, rest, argv, err);
    if (rc < 0)
        return rc;
    if (p->pixaspect < 0) /* rpict fills its picture, as with 0 */
        p->pixaspect = 0;
    if (p->psample < 1)
        p->psample = 1;
    else if (p->psample > LARGEST_PSAMPLE)
        p->psample = LARGEST_PSAMPLE;
    if (p->bands.n > RAD_MAX_BANDS)
        p->bands.n = RAD_MAX_BANDS;
    return 1 + nwords;
}

struct rad_rgb
rad_params_colour(const struct rad_params *p, struct rad_rgb L)
{
    struct rad_rgb xyz;

    if (p->primaries != RAD_PRIM_XYZ)
        return L;
    xyz = rad_rgb_to_xyz(L);
    /* the XYZ of a radiance near the largest float would overflow */
    return rad_rgb(fminf(xyz.r, RAD_MAX_RADIANCE),
                   fminf(xyz.g, RAD_MAX_RADIANCE),
                   fminf(xyz.b, RAD_MAX_RADIANCE));
}

int
rad_params_check(const struct rad_params *p, struct rad_error *err)
{
    if (p->maxdepth <= 0 && p->minweight == 0)
        return rad_fail(err, RAD_EUSAGE,
                        "option '-lr %d' is Russian roulette, which needs "
                        "'-lw' above 0",
                        p->maxdepth);
    if (p->bands.longest - p->bands.shortest < RAD_LEAST_RANGE)
        return rad_fail(err, RAD_EUSAGE,
                        "option '-cw %g %g': a range is %g nm at least",
                        p->bands.shortest, p->bands.longest, RAD_LEAST_RANGE);
    if (p->bands.plane == RAD_PLANE_COLOURS
            ? rad_bands_are_rgb(&p->bands)
            : p->bands.plane >= rad_bands_planes(&p->bands))
        return rad_fail(err, RAD_EUSAGE,
                        "option '--plane %d': -cs %d has %d planes, from 0",
                        p->bands.plane, p->bands.n,
                        rad_bands_planes(&p->bands));
    return 0;
}

static void
format_rgb(char *buf, size_t size, struct rad_rgb c)
{
    char r[RAD_NUMBER_TEXT], g[RAD_NUMBER_TEXT], b[RAD_NUMBER_TEXT];

    rad_format_float(r, c.r);
    rad_format_float(g, c.g);
    rad_format_float(b, c.b);
    snprintf(buf, size, " %s %s %s", r, g, b);
}

static void
format_waves(char *buf, size_t size, const struct rad_bands *b)
{
    char shortest[RAD_NUMBER_TEXT], longest[RAD_NUMBER_TEXT];

    rad_format_real(shortest, b->shortest);
    rad_format_real(longest, b->longest);
    snprintf(buf, size, " %s %s", shortest, longest);
}

static void
format_reals(char *buf, const double v[], int n)
{
    for (int i = 0; i < n; i++) {
        *buf++ = ' ';
        rad_format_real(buf, v[i]);
        buf += strlen(buf);
    }
}

/* Write the list as one option a name; nothing if it is of the other kind. */
static void
format_names(const struct rad_params *p, const struct option *o, char *buf,
             size_t size)
{
    const char *name = p->amblist;
    size_t used = 0;

    buf[0] = '\0';
    if (p->amblisted != (int)o->value)
        return;
    while (*name && used < size) {
        size_t n = strcspn(name, " ");

        used += (size_t)snprintf(buf + used, size - used, "%s%s %.*s",
                                 used ? " " : "", o->name, (int)n, name);
        name += n + (name[n] != '\0');
    }
}

/* Are these the default bands, red, green and blue? */
static bool
are_usual(const struct rad_bands *b)
{
    return rad_bands_are_rgb(b) && b->longest == RAD_LONGEST_WAVE &&
           b->shortest == RAD_SHORTEST_WAVE;
}

/* Is the option to be written?  Some are written only if not at their defaults;
 * of options that exclude each other only the one in effect. */
static bool
is_said(const struct rad_params *p, const struct option *o)
{
    if (o->field == FIELD(samples))
        return p->samples > 1;
    if (o->field == FIELD(surroundings))
        return p->surroundings > 0;
    if (o->kind == KIND_BALL)
        return p->shown[3] > 0;
    if (o->field == FIELD(bands.plane))
        return p->bands.plane >= 0;
    if (o->field == FIELD(bands.n) || o->kind == KIND_WAVES)
        return !are_usual(&p->bands);
    if (o->kind == KIND_PRIMS)
        return (int)p->primaries == (int)o->value;
    if (o->kind == KIND_LIST)
        return p->amblisted == (int)o->value;
    return true;
}

/* Write an option as a user would type it. */
static void
format_option(const struct rad_params *p, const struct option *o, char *buf,
              size_t size)
{
    const void *field = (const char *)p + o->field;
    char num[8 * RAD_NUMBER_TEXT] = "";

    switch (o->kind) {
    case KIND_BOOL:
        strcpy(num, *(const bool *)field ? "+" : "-");
        break;
    case KIND_INT:
        snprintf(num, sizeof num, " %d", *(const int *)field);
        break;
    case KIND_REAL:
        num[0] = ' ';
        rad_format_real(num + 1, *(const double *)field);
        break;
    case KIND_RGB:
        format_rgb(num, sizeof num, *(const struct rad_rgb *)field);
        break;
    case KIND_WAVES:
        format_waves(num, sizeof num, field);
        break;
    case KIND_BALL:
        format_reals(num, field, 4);
        break;
    case KIND_U64:
        snprintf(num, sizeof num, "=%llu",
                 (unsigned long long)*(const uint64_t *)field);
        break;
    case KIND_PRIMS:
        if (o->value == RAD_PRIM_CUSTOM)
            format_reals(num, p->chroma, 8);
        break;
    case KIND_LIST:
        format_names(p, o, buf, size);
        return;
    }
    snprintf(buf, size, "%s%s", o->name, num);
}

void
rad_params_format(const struct rad_params *p, char *buf, size_t size)
{
    char text[RAD_PARAMS_TEXT];
    size_t used = 0;

    if (size > 0)
        buf[0] = '\0';
    for (size_t i = 0; i < NOPTIONS && used < size; i++) {
        /* -pRGB is the default and is left out */
        if (!is_said(p, &options[i]) ||
            (options[i].kind == KIND_PRIMS && options[i].value == RAD_PRIM_RGB))
            continue;
        format_option(p, &options[i], text, sizeof text);
        used += (size_t)snprintf(buf + used, size - used, "%s%s",
                                 used ? " " : "", text);
    }
}

/* Does an option follow at s, with the blank before it, or the end? */
static bool
is_edge(const char *s)
{
    return s[0] == '\0' ||
           (s[0] == ' ' && s[1] == '-' && !strchr("0123456789.", s[2]));
}

/* The number of options in a canonical text. */
static int
count(const char *text)
{
    int n = 0;

    for (; *text; text++)
        n += is_edge(text);
    return n;
}

const char *
rad_params_differ(const char *a, const char *b, int *n)
{
    size_t i = 0, at = 0;
    const char *name;

    for (;; i++) {
        if (is_edge(a + i) && is_edge(b + i))
            at = i;
        if (b[i] == '\0' || a[i] != b[i])
            break;
    }
    /* an option that one text lacks is one more in the other */
    name = (count(a) > count(b) ? a : b) + at;
    name += *name == ' ';
    *n = (int)strcspn(name, " =");
    return name;
}

void
rad_params_of_records(const struct rad_params *p, struct rad_params *out)
{
    struct rad_params usual;

    rad_params_init(&usual);
    *out = *p;
    if (p->bands.plane == RAD_PLANE_COLOURS)
        out->bands = usual.bands;
    out->xres = usual.xres;
    out->yres = usual.yres;
    out->primaries = usual.primaries;
    memcpy(out->chroma, usual.chroma, sizeof out->chroma);
    out->pixaspect = usual.pixaspect;
    out->pixjitter = usual.pixjitter;
    out->psample = usual.psample;
    out->maxdiff = usual.maxdiff;
    out->motion = usual.motion;
    out->aperture = usual.aperture;
    out->samples = usual.samples;
    memcpy(out->shown, usual.shown, sizeof out->shown);
}

void
rad_params_print_defaults(const struct rad_params *p,
                          void (*line)(void *arg, const char *text), void *arg)
{
    char text[RAD_PARAMS_TEXT], full[RAD_PARAMS_TEXT + 80];

    for (size_t i = 0; i < NOPTIONS; i++) {
        if (!is_said(p, &options[i]))
            continue;
        format_option(p, &options[i], text, sizeof text);
        snprintf(full, sizeof full, "%-31s # %s", text, options[i].help);
        line(arg, full);
    }
}
