/* rif_rules.c - see rif_rules.h */
#include "config.h"

#include "rif/rif_rules.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SMALLEST 1e-6 /* least size of a zone, as with rad */

enum level { LOW, MEDIUM, HIGH, LEVELS };

/* clang-format off */
static const struct {
    int ps[LEVELS][2];          /* by DETAIL; without and with PENUMBRAS */
    int dp[LEVELS], ar[LEVELS]; /* by DETAIL; ar for a zone as large as the
                                 * octree's cube */
    int ms[LEVELS];             /* this many steps through the zone; 0: -ms is
                                 * not set */
    const char *pt;
    const char *ds[2];          /* without and with PENUMBRAS */
    const char *direct;
    const char *ambient[LEVELS]; /* by VARIABILITY */
    const char *limits;
} rules[LEVELS] = { /* by QUALITY */
    [LOW] = {
        { { 16, 16 }, { 8, 8 }, { 4, 4 } },
        { 64, 128, 256 }, { 8, 16, 32 }, { 0, 0, 0 }, ".16",
        { "-ds 0", "-ds .4" },
        "-dt .1 -dc .5 -dr 0 -ss 0 -st .5",
        { "-aa .3 -ad 256 -as 0", "-aa .25 -ad 512 -as 0",
          "-aa .2 -ad 1024 -as 0" },
        "-lr 6 -lw .001" },
    [MEDIUM] = {
        { { 8, 4 }, { 6, 3 }, { 4, 2 } },
        { 256, 512, 1024 }, { 16, 32, 64 }, { 20, 40, 80 }, ".08",
        { "-ds .3", "-ds .2 -dj .9" },
        "-dt .07 -dc .7 -dr 1 -ss 1 -st .1",
        { "-aa .2 -ad 329 -as 42", "-aa .15 -ad 800 -as 128",
          "-aa .1 -ad 1536 -as 392" },
        "-lr 8 -lw 1e-4" },
    [HIGH] = {
        { { 8, 1 }, { 5, 1 }, { 3, 1 } },
        { 1024, 2048, 4096 }, { 32, 64, 128 }, { 40, 80, 160 }, ".04",
        { "-ds .2", "-ds .1 -dj .9" },
        "-dt .04 -dc .9 -dr 3 -ss 16 -st .01",
        { "-aa .125 -ad 512 -as 64", "-aa .1 -ad 1536 -as 768",
          "-aa .075 -ad 4096 -as 2048" },
        "-lr 12 -lw 5e-6" },
};
/* clang-format on */

static enum level
level(const struct rif *r, enum rif_var v, char none)
{
    switch (rif_letter(r, v, none)) {
    case 'L':
        return LOW;
    case 'M':
        return MEDIUM;
    default:
        return HIGH;
    }
}

static int
zone_of_octree(const struct rif *r, const struct rad_octree *t,
               struct rif_zone *z, struct rad_error *err)
{
    char text[6][24];

    z->interior = false;
    if (t->size <= SMALLEST)
        return rif_fail(r, RIF_ZONE, err,
                        "not given, and the scene has no surfaces to take it "
                        "from");
    /* rad reads numbers of six digits here, as getinfo prints them */
    for (int i = 0; i < 3; i++) {
        snprintf(text[i], sizeof text[i], "%g", t->org[i]);
        snprintf(text[3 + i], sizeof text[i], "%g", t->org[i] + t->size);
        z->org[i] = strtod(text[i], NULL);
        z->size[i] = strtod(text[3 + i], NULL) - z->org[i];
        if (z->size[i] <= SMALLEST)
            z->size[i] = t->size;
    }
    return 0;
}

int
rif_zone(struct rif *r, const struct rad_octree *t, struct rif_zone *z,
         struct rad_error *err)
{
    const char *text = rif_text(r, RIF_ZONE);
    char letter = rif_letter(r, RIF_ZONE, 'E');
    int n;

    z->cube = t->size;
    if (!text)
        return zone_of_octree(r, t, z, err);
    z->interior = letter == 'I';
    n = sscanf(text, "%*s %lf %lf %lf %lf %lf %lf", &z->org[0], &z->size[0],
               &z->org[1], &z->size[1], &z->org[2], &z->size[2]);
    if (n != 6 || (letter != 'I' && letter != 'E'))
        return rif_fail(r, RIF_ZONE, err,
                        "expected interior or exterior and xmin xmax ymin ymax "
                        "zmin zmax");
    for (int i = 0; i < 3; i++) {
        z->size[i] -= z->org[i];
        if (!isfinite(z->org[i]) || !isfinite(z->size[i]) ||
            z->size[i] <= SMALLEST)
            return rif_fail(r, RIF_ZONE, err, "a box without a volume");
    }
    return 0;
}

int
rif_exposure(const struct rif *r, double *factor, struct rad_error *err)
{
    const char *text =
        r->last[RIF_EXPOSURE] ? r->last[RIF_EXPOSURE]->text : NULL;

    *factor = 0;
    if (!text)
        return 0;
    *factor = strtod(text, NULL);
    if (text[0] == '+' || text[0] == '-')
        *factor = exp2(*factor);
    if (!(*factor >= 1e-20 && *factor <= 1e20))
        return rif_fail(r, RIF_EXPOSURE, err,
                        "expected stops with a sign, or a factor above 0");
    return 0;
}

int
rif_oversample(const struct rif *r)
{
    return 1 + (int)level(r, RIF_QUALITY, 'L');
}

/* -ab: rad sets none at low quality, and one more than INDIRECT at high. */
static int
bounces(const struct rif *r, enum level quality)
{
    const char *text =
        r->last[RIF_INDIRECT] ? r->last[RIF_INDIRECT]->text : "0";

    return quality == LOW ? 0 : (int)strtol(text, NULL, 10) + (quality == HIGH);
}

/* The ambient value.  A known exposure tells the scene's mean brightness. */
static double
ambient_value(const struct rif_zone *z, double exposure)
{
    if (exposure > 0)
        return .18 / exposure;
    return z->interior ? .01 : 10;
}

int
rif_rules(const struct rif *r, const struct rif_zone *z,
          char light[RIF_RULES_TEXT], char sampling[RIF_RULES_TEXT],
          struct rad_error *err)
{
    enum level quality = level(r, RIF_QUALITY, 'L');
    enum level detail = level(r, RIF_DETAIL, 'M');
    enum level variability = level(r, RIF_VARIABILITY, 'L');
    bool penumbras = rif_letter(r, RIF_PENUMBRAS, 'F') == 'T';
    double edge = (z->size[0] + z->size[1] + z->size[2]) / 3;
    double ar = rules[quality].ar[detail] * z->cube / edge, exposure, av;
    int ab = bounces(r, quality), ms = rules[quality].ms[detail], rc;
    char steps[40] = "", deep[40] = "";

    if ((rc = rif_exposure(r, &exposure, err)) < 0)
        return rc;
    av = ambient_value(z, exposure);
    if (ms > 0)
        snprintf(steps, sizeof steps, " -ms %.2g", edge / ms);
    if (ab != 0)
        snprintf(deep, sizeof deep, " -ab %d", ab);
    snprintf(light, RIF_RULES_TEXT,
             " -dp %d -ar %d%s %s %s%s %s -av %.2g %.2g %.2g %s",
             rules[quality].dp[detail], (int)fmin(ar, 1e9), steps,
             rules[quality].ds[penumbras], rules[quality].direct, deep,
             rules[quality].ambient[variability], av, av, av,
             rules[quality].limits);
    snprintf(sampling, RIF_RULES_TEXT, " -ps %d -pt %s",
             rules[quality].ps[detail][penumbras], rules[quality].pt);
    return 0;
}
