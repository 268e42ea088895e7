/* params.c - see params.h
 *
 * One row of the table is all that there is to an option: parsing, printing,
 * range and help all walk it.  The order is that of rpict -defaults. */
#include "config.h"

#include "picture/params.h"
#include "picture/number.h"

#include <float.h>
#include <limits.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* beyond rpict's -ps 16 nothing is sampled more coarsely, as in rpict */
enum { LARGEST_PSAMPLE = 16 };
/* rays keep their depth in 16 bits */
enum { DEEPEST = 30000 };

enum kind {
    KIND_BOOL, /* -dv+ -dv- -dv (toggles) */
    KIND_INT,
    KIND_REAL,
    KIND_RGB,
    KIND_U64,    /* --seed=N */
    KIND_NOTHING /* states the default: -pRGB */
};

struct option {
    const char *name;
    enum kind kind;
    size_t field;  /* offset in struct rad_params */
    double lo, hi; /* range, ends included */
    double value;  /* default, of each channel with KIND_RGB */
    const char *help;
};

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
    { "-pRGB", KIND_NOTHING, 0, 0, 0, 0, "Radiance's primaries" },
    REAL("-pa", pixaspect, 0, 1, "pixel aspect ratio, height / width"),
    REAL("-pj", pixjitter, 0, .67, "pixel jitter"),
    INT("-ps", psample, INT_MIN, INT_MAX, 4, "pixel sample spacing, 1 to 16"),
    REAL("-pt", maxdiff, 0, .05, "pixel threshold"),
    BOOL("-i", irradiance, 0, "irradiance calculation"),
    BOOL("-u", rand_samp, 0, "uncorrelated Monte Carlo sampling"),
    BOOL("-bv", backvis, 1, "back face visibility"),
    REAL("-dt", shadthresh, 0, .05, "direct threshold"),
    REAL("-dc", shadcert, 0, .5, "direct certainty"),
    REAL("-dj", srcjitter, 0, 0, "direct jitter"),
    REAL("-ds", srcsizerat, 0, .25, "direct sampling"),
    INT("-dr", directrelay, 0, 1000, 1, "direct relays"),
    INT("-dp", vspretest, 0, INT_MAX, 512, "direct pretest density"),
    BOOL("-dv", directvis, 1, "direct visibility"),
    REAL("-ss", specjitter, 0, 1, "specular sampling"),
    REAL("-st", specthresh, 0, .15, "specular threshold"),
    RGB("-av", ambval, "ambient value"),
    INT("-aw", ambvwt, 0, INT_MAX, 0, "ambient value weight"),
    INT("-ab", ambounce, 0, DEEPEST, 0, "ambient bounces"),
    REAL("-aa", ambacc, 0, .2, "ambient accuracy"),
    INT("-ar", ambres, 0, INT_MAX, 64, "ambient resolution"),
    INT("-ad", ambdiv, 0, 1 << 24, 512, "ambient divisions"),
    INT("-as", ambssamp, 0, 1 << 24, 128, "ambient super-samples"),
    RGB("-me", cextinction, "mist extinction coefficient"),
    RGB("-ma", salbedo, "mist scattering albedo"),
    { "-mg", KIND_REAL, FIELD(seccg), -1, 1, 0,
      "mist scattering eccentricity" },
    REAL("-ms", ssampdist, 0, 0, "mist sampling distance"),
    INT("-lr", maxdepth, -DEEPEST, DEEPEST, 7,
        "limit reflection, 0 or less: Russian roulette"),
    REAL("-lw", minweight, 0, 1e-4, "limit weight"),
    { "--seed", KIND_U64, FIELD(seed), 0, 0, 0, "of all random numbers" }
};

/* what else rpict(1) has, but for what programs do themselves: -vf -o -z -S
 * -defaults -help -version -features */
static const char *const lacking[] = {
    "-pm", "-pd", "-pc", "-pXYZ", "-t", "-w", "-w+", "-w-", "-e", "-f", "-r",
    "-ro", "-P", "-PP", "-af", "-ae", "-ai", "-aE", "-aI", "-ap", "-am",
    "-am+", "-am-", "-ac", "-aC", "-aH", "-cs", "-cw"
};
/* clang-format on */

#define NOPTIONS (sizeof options / sizeof options[0])

static void *
field_of(struct rad_params *p, const struct option *o)
{
    return (char *)p + o->field;
}

static const void *
field_in(const struct rad_params *p, const struct option *o)
{
    return (const char *)p + o->field;
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
        case KIND_NOTHING:
            break;
        }
    }
}

/* What follows a boolean's or a long option's name; NULL: another option. */
static const char *
name_ends(const struct option *o, const char *word)
{
    size_t n = strlen(o->name);
    const char *rest = word + n;

    if (strncmp(word, o->name, n) != 0)
        return NULL;
    switch (o->kind) {
    case KIND_BOOL:
        if (*rest == '\0' || (strchr("+yYtT1-nNfF0", *rest) && !rest[1]))
            return rest;
        return NULL;
    case KIND_U64:
        return *rest == '=' ? rest + 1 : *rest ? NULL : rest;
    default:
        return *rest ? NULL : rest;
    }
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

    rad_format_real(lo, o->lo);
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

/* How many words of values follow. */
static int
words_of(const struct option *o, const char *rest)
{
    switch (o->kind) {
    case KIND_INT:
    case KIND_REAL:
        return 1;
    case KIND_RGB:
        return 3;
    case KIND_U64:
        return rest[-1] == '=' ? 0 : 1;
    default:
        return 0;
    }
}

static int
take_value(void *field, const struct option *o, const char *rest,
           char *const argv[], struct rad_error *err)
{
    switch (o->kind) {
    case KIND_BOOL:
        *(bool *)field =
            *rest ? strchr("+yYtT1", *rest) != NULL : !*(bool *)field;
        return 0;
    case KIND_INT:
        return take_int(field, o, argv[1], err);
    case KIND_REAL:
        return take_real(field, o, argv[1], err);
    case KIND_RGB:
        return take_rgb(field, o, argv + 1, err);
    case KIND_U64:
        return take_u64(field, o, rest[-1] == '=' ? rest : argv[1], err);
    default:
        return 0;
    }
}

static int
refuse_lacking(const char *word, struct rad_error *err)
{
    for (size_t i = 0; i < sizeof lacking / sizeof lacking[0]; i++)
        if (strcmp(word, lacking[i]) == 0)
            return rad_fail(err, RAD_EUSAGE,
                            "option '%s' of rpict is not supported", word);
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
        return refuse_lacking(argv[0], err);
    nwords = words_of(o, rest);
    if (argc - 1 < nwords)
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s': expected %d value%s, got %d", o->name,
                        nwords, nwords > 1 ? "s" : "", argc - 1);
    rc = take_value(field_of(p, o), o, rest, argv, err);
    if (rc < 0)
        return rc;
    if (p->psample < 1)
        p->psample = 1;
    else if (p->psample > LARGEST_PSAMPLE)
        p->psample = LARGEST_PSAMPLE;
    return 1 + nwords;
}

int
rad_params_check(const struct rad_params *p, struct rad_error *err)
{
    if (p->maxdepth <= 0 && p->minweight == 0)
        return rad_fail(err, RAD_EUSAGE,
                        "option '-lr %d' is Russian roulette, which needs "
                        "'-lw' above 0",
                        p->maxdepth);
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

/* One option as one would type it. */
static void
format_option(const struct rad_params *p, const struct option *o, char *buf,
              size_t size)
{
    const void *field = field_in(p, o);
    char num[4 * RAD_NUMBER_TEXT] = "";

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
    case KIND_U64:
        snprintf(num, sizeof num, "=%llu",
                 (unsigned long long)*(const uint64_t *)field);
        break;
    case KIND_NOTHING:
        break;
    }
    snprintf(buf, size, "%s%s", o->name, num);
}

void
rad_params_format(const struct rad_params *p, char *buf, size_t size)
{
    char text[160];
    size_t used = 0;

    if (size > 0)
        buf[0] = '\0';
    for (size_t i = 0; i < NOPTIONS && used < size; i++) {
        if (options[i].kind == KIND_NOTHING)
            continue;
        format_option(p, &options[i], text, sizeof text);
        used += (size_t)snprintf(buf + used, size - used, "%s%s",
                                 used ? " " : "", text);
    }
}

void
rad_params_print_defaults(const struct rad_params *p,
                          void (*line)(void *arg, const char *text), void *arg)
{
    char text[160], full[256];

    for (size_t i = 0; i < NOPTIONS; i++) {
        format_option(p, &options[i], text, sizeof text);
        snprintf(full, sizeof full, "%-31s # %s", text, options[i].help);
        line(arg, full);
    }
}
