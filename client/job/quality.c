/* quality.c - see quality.h
 *
 * The rows of the cache are rungs of bench/speed-error's ladder; the others go
 * with them so that neither decides alone.  doc/accuracy.md has the time that
 * each word takes and the error that it leaves. */
#include "config.h"

#include "job/quality.h"

#include <string.h>

enum { QUALITIES = 5 };

/* clang-format off */
static const struct {
    const char *option;
    const char *value[QUALITIES];
} table[] = {
    /*        draft   low     medium  high    reference */
    { "-ps", { "8",    "6",    "4",    "3",    "1" } },
    { "-pt", { ".15",  ".08",  ".05",  ".03",  "0" } },
    { "-pj", { ".5",   ".7",   ".9",   ".9",   "1" } },
    { "-dj", { "0",    ".4",   ".9",   ".9",   "1" } },
    { "-ds", { ".4",   ".2",   ".15",  ".1",   ".05" } },
    { "-dt", { ".2",   ".1",   ".05",  ".02",  "0" } },
    { "-dc", { ".3",   ".5",   ".75",  ".9",   "1" } },
    { "-dr", { "2",    "2",    "3",    "3",    "4" } },
    { "-dp", { "64",   "256",  "512",  "1024", "4096" } },
    { "-st", { ".01",  ".01",  ".01",  ".01",  "0" } },
    { "-ab", { "4",    "5",    "6",    "7",    "8" } },
    { "-aa", { ".5",   ".4",   ".3",   ".2",   ".1" } },
    { "-ar", { "32",   "64",   "96",   "128",  "256" } },
    { "-ad", { "64",   "96",   "224",  "512",  "4096" } },
    { "-as", { "16",   "24",   "56",   "128",  "1024" } },
    { "-lr", { "8",    "8",    "10",   "12",   "14" } },
    { "-lw", { ".002", ".001", "2e-4", "1e-4", "2e-5" } },
};
/* clang-format on */

static const int oversample[QUALITIES] = { 1, 2, 2, 3, 4 };

/* bench/quality.sh; of `reference` there is nothing to compare it with. */
static const double promise[QUALITIES][2] = {
    { 7, 27 }, { 3, 13 }, { 2, 9 }, { 1, 5 }, { 0, 0 }
};

enum { ROWS = sizeof table / sizeof table[0] };

quality_given
quality_bit(const char *option)
{
    for (unsigned i = 0; i < ROWS; i++)
        if (strcmp(table[i].option, option) == 0)
            return (quality_given)1 << i;
    return 0;
}

int
quality_oversample(int quality)
{
    return oversample[quality];
}

bool
quality_promise(int quality, double *least, double *most)
{
    *least = promise[quality][0];
    *most = promise[quality][1];
    return *most > 0;
}

const char *
quality_word(int quality, int *len)
{
    const char *word = QUALITY_WORDS;

    for (; quality > 0; quality--)
        word += strcspn(word, "|") + 1;
    *len = (int)strcspn(word, "|");
    return word;
}

/* What a job's stages leave as it is (-ps, -ab, -lr, -lw) is good enough for
 * small errors, the rest is a quick picture's. */
/* clang-format off */
static const char *const first[][2] = {
    { "-ps", "4" },   { "-pt", ".15" }, { "-pj", ".9" }, { "-dj", ".5" },
    { "-ds", ".4" },  { "-dt", ".1" },  { "-dc", ".5" }, { "-dr", "3" },
    { "-dp", "512" }, { "-st", ".01" }, { "-ab", "5" },  { "-aa", ".5" },
    { "-ar", "16" },  { "-ad", "64" },  { "-as", "32" }, { "-lr", "10" },
    { "-lw", ".001" }
};
/* clang-format on */

static int
set(struct rad_params *p, const char *name, const char *to,
    struct rad_error *err)
{
    char option[8], value[8], *argv[3] = { option, value, NULL };
    int rc;

    strcpy(option, name);
    strcpy(value, to);
    rc = rad_params_option(p, 2, argv, err);
    return rc < 0 ? rc : 0;
}

int
quality_first(struct rad_params *p, struct rad_error *err)
{
    int rc = 0;

    for (size_t i = 0; rc == 0 && i < sizeof first / sizeof first[0]; i++)
        rc = set(p, first[i][0], first[i][1], err);
    return rc;
}

int
quality_apply(int quality, quality_given given, struct rad_params *p,
              struct rad_error *err)
{
    int rc = 0;

    for (unsigned i = 0; rc == 0 && i < ROWS; i++)
        if (!(given >> i & 1))
            rc = set(p, table[i].option, table[i].value[quality], err);
    return rc;
}
