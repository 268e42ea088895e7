/* pointspec.c - see pointspec.h */
#include "config.h"

#include "points/pointspec.h"

#include "base/number.h"

#include <stdio.h>
#include <string.h>

/* letters of -o that are supported; others that rtrace has */
static const char known[] = "odvVwWlLpnNsmM~", lacking[] = "tTcrxRX";

void
pointspec_init(struct pointspec *s)
{
    memset(s, 0, sizeof *s);
    s->in = s->out = 'a';
    s->values = "v";
}

/* -f with the format of the input (a, f, d) and, if it is another, of the
 * output (a, f, d, c). */
static int
take_formats(struct pointspec *s, const char *word)
{
    const char *in = word + 2, *out = in[0] && in[1] ? in + 1 : in;

    if (!in[0] || !strchr("afd", in[0]) || !strchr("afdc", out[0]) || out[1])
        return 0;
    s->in = in[0];
    s->out = out[0];
    return 1;
}

static int
take_values(struct pointspec *s, const char *word, struct rad_error *err)
{
    for (const char *c = word + 2; *c; c++) {
        if (strchr(known, *c))
            continue;
        return rad_fail(err, RAD_EUSAGE,
                        strchr(lacking, *c)
                            ? "option '%.40s': '%c' of rtrace is not supported"
                            : "unknown option '%.40s': rtrace's -o has no '%c' "
                              "(-o FILE names the file that is written)",
                        word, *c);
    }
    if (strlen(word + 2) > POINTSPEC_VALUES)
        return rad_fail(err, RAD_EUSAGE, "option '%.40s': more than %d letters",
                        word, POINTSPEC_VALUES);
    s->values = word + 2;
    return 1;
}

/* -pY, -pA, as long as no -pRGB or -pXYZ follows. */
static int
take_mean(struct pointspec *s, const char *word, struct rad_error *err)
{
    if (strcmp(word, "-pS") == 0 || strcmp(word, "-pM") == 0)
        return rad_fail(err, RAD_EUSAGE,
                        "option '%s' of rtrace is not supported: -cs 20 -co+ "
                        "gives the bands to weigh",
                        word);
    if (strcmp(word, "-pRGB") == 0 || strcmp(word, "-pXYZ") == 0)
        s->mean = NULL;
    if (strcmp(word, "-pY") != 0 && strcmp(word, "-pA") != 0)
        return 0;
    s->mean = word;
    return 1;
}

/* Take a side that is 0, which rpict's -x and -y lack; other numbers are
 * checked there. */
static int
take_side(struct pointspec *s, int *side, int argc, char *const argv[])
{
    if (argc < 2 || !rad_parse_int(argv[1], side) || *side < 0)
        *side = 0;
    if (argc < 2 || strcmp(argv[1], "0") != 0)
        return 0;
    s->option = s->option ? s->option : argv[0];
    return 2;
}

int
pointspec_option(struct pointspec *s, int argc, char *const argv[],
                 struct rad_error *err)
{
    const char *word = argv[0];
    bool header = !s->no_header;
    int used = 0;

    if (strcmp(word, "-x") == 0)
        return take_side(s, &s->x, argc, argv);
    if (strcmp(word, "-y") == 0)
        return take_side(s, &s->y, argc, argv);
    if (rad_params_switch(word, "-I", &s->irradiance) ||
        rad_params_switch(word, "-ld", &s->limited))
        used = 1;
    else if (rad_params_switch(word, "-h", &header))
        used = 1;
    else if (strncmp(word, "-f", 2) == 0)
        used = take_formats(s, word);
    else if (strncmp(word, "-o", 2) == 0 && word[2])
        used = take_values(s, word, err);
    else
        used = take_mean(s, word, err);
    s->no_header = !header;
    if (used > 0 && !s->option)
        s->option = word;
    return used;
}

int
pointspec_check(const struct pointspec *s, struct rad_error *err)
{
    if (!s->file)
        return s->option ? rad_fail(err, RAD_EUSAGE,
                                    strlen(s->option) == 2 &&
                                            strchr("xy", s->option[1])
                                        ? "option '%s': 0 is for --points"
                                        : "option '%s' is for --points",
                                    s->option)
                         : 0;
    if (s->out == 'c' && strcmp(s->values, "v") != 0)
        return rad_fail(err, RAD_EUSAGE, "colours (-f%cc) are of -ov alone",
                        s->in);
    if (s->out == 'c' && s->mean)
        return rad_fail(err, RAD_EUSAGE,
                        "-f%cc writes colours, and %s asks for one number",
                        s->in, s->mean);
    if (s->irradiance && !pointspec_lit(s))
        return rad_fail(err, RAD_EUSAGE, "-I needs a value in -o");
    return 0;
}

uint64_t
pointspec_most(const struct pointspec *s)
{
    uint64_t n = s->x > 1 ? (uint64_t)s->x * (uint64_t)s->y : (uint64_t)s->y;

    return n == 0 ? UINT64_MAX : n;
}

uint32_t
pointspec_flush(const struct pointspec *s)
{
    return s->y == 0 || s->x == 1 ? (uint32_t)s->x : 0;
}

bool
pointspec_lit(const struct pointspec *s)
{
    return s->values[strcspn(s->values, "vVlW")] != '\0';
}

void
pointspec_defaults(struct rad_params *p)
{
    p->shadthresh = .03;
    p->shadcert = .75;
    p->srcsizerat = .2;
    p->directrelay = 2;
    p->vspretest = 512;
    p->ambacc = .1;
    p->ambres = 256;
    p->ambdiv = 1024;
    p->ambssamp = 512;
    p->maxdepth = -10;
    p->minweight = 1e-4;
    p->psample = 1;
    p->pixjitter = 0;
}

void
pointspec_format(const struct pointspec *s, char *buf, size_t n)
{
    char sides[60] = "";

    if (s->x > 0 || s->y > 0)
        snprintf(sides, sizeof sides, " -x %d -y %d", s->x, s->y);
    snprintf(buf, n, "%s%s -f%c%c -o%s%s%s%s", s->irradiance ? "-I+" : "-I-",
             s->limited ? " -ld+" : "", s->in, s->out, s->values, sides,
             s->mean ? " " : "", s->mean ? s->mean : "");
}
