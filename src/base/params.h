/* params.h - rendering parameters, with rpict's names, defaults and meaning
 *
 * One table in params.c (name, kind, range, default, help) parses the options
 * of rpict(1), prints -defaults and the canonical option string that goes into
 * picture headers, and is checked against radsubmit(1).
 * A struct rad_params is plain data without pointers: it is copied freely and
 * read-only while a job renders. */
#ifndef RAD_PICTURE_PARAMS_H
#define RAD_PICTURE_PARAMS_H

#include "base/bands.h"
#include "base/color.h"
#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* most columns or rows of a picture */
#define RAD_MAX_RES 1048576

/* Most rays of a pixel: it is not left before it is done. */
#define RAD_MOST_SAMPLES 1024

/* Bytes of the names of -ae and -ai, as options ("-ae name" and a blank). */
#define RAD_MAX_AMBLIST 2400

/* What the numbers of a pixel stand for. */
enum rad_primaries {
    RAD_PRIM_RGB,   /* -pRGB: Radiance's own primaries */
    RAD_PRIM_XYZ,   /* -pXYZ: CIE tristimulus values, 179 lm/W in them */
    RAD_PRIM_CUSTOM /* -pc: the same numbers, declared to be others */
};

/* What -ae and -ai say of the surfaces of the modifiers that they name. */
enum {
    RAD_AMB_ALL,     /* nothing is named */
    RAD_AMB_EXCLUDE, /* they get no ambient calculation, */
    RAD_AMB_INCLUDE  /* or they alone do */
};

struct rad_params {
    /* picture */
    int xres, yres; /* -x -y: most columns and rows */
    enum rad_primaries primaries;
    double chroma[8]; /* -pc: x y of red, green, blue, white; else 0 */
    double pixaspect; /* -pa: height / width of a pixel; 0: fill x by y */
    double pixjitter; /* -pj: 0 centre .. 1 anywhere in the pixel */
    int psample;      /* -ps: sample spacing [pixels], 1: every pixel; what
                       * is beyond 1..16 is brought there, as in rpict */
    double maxdiff;   /* -pt: difference that forces a sample */
    double motion;    /* -pm: open part of the time between two frames */
    double aperture;  /* -pd: diameter of the lens [scene units] */
    int samples;      /* --samples: rays of a pixel that is traced */
    bool directvis;   /* -dv: sources visible to the eye */
    /* direct light */
    double srcjitter;  /* -dj dstrsrc */
    double srcsizerat; /* -ds: largest source size / distance; 0: whole */
    double shadthresh; /* -dt */
    double shadcert;   /* -dc */
    int directrelay;   /* -dr */
    int vspretest;     /* -dp [samples/sr] */
    /* specular */
    double specjitter; /* -ss */
    double specthresh; /* -st */
    bool backvis;      /* -bv */
    bool irradiance;   /* -i */
    bool rand_samp;    /* -u: pure Monte Carlo; never takes the clock */
    /* medium: -me [1/unit] -ma -mg -ms [unit] */
    struct rad_rgb cextinction, salbedo;
    double seccg, ssampdist;
    /* indirect light */
    int ambounce;                  /* -ab */
    double ambacc;                 /* -aa */
    int ambres;                    /* -ar */
    int ambdiv;                    /* -ad */
    int ambssamp;                  /* -as */
    struct rad_rgb ambval;         /* -av: radiance [W/sr/m^2] */
    int ambvwt;                    /* -aw */
    int amblisted;                 /* RAD_AMB_* */
    char amblist[RAD_MAX_AMBLIST]; /* names, a blank between two */
    /* limits */
    int maxdepth;           /* -lr; <= 0: Russian roulette */
    double minweight;       /* -lw */
    struct rad_bands bands; /* -cs -cw --plane */
    /* ours */
    uint64_t seed; /* --seed */
};

/* rpict's defaults. */
void rad_params_init(struct rad_params *p);

/* Try to take the option at argv[0] (argc words are there).  Returns the
 * number of words used (>= 1), 0 if it is no rendering option of ours, or
 * RAD_EUSAGE with a message that names the option: a bad or missing number, a
 * value out of range, or an option of rpict that we lack.
 * Not here, for programs to take: -vf -o -z -S -t -e -w -aE -aI -defaults -help
 * -version. */
int rad_params_option(struct rad_params *p, int argc, char *const argv[],
                      struct rad_error *err);

/* What a pixel of radiance L holds under -pRGB, -pXYZ or -pc. */
struct rad_rgb rad_params_colour(const struct rad_params *p, struct rad_rgb L);

/* The same but for all that decides about no ambient record: which pixels there
 * are, where in them and through which lens and in which time they are looked
 * at, and how they are written.  Two jobs on one scene for which this and the
 * seed are the same make records by the same rules. */
void rad_params_of_records(const struct rad_params *p, struct rad_params *out);

/* Is the word the option of that name, which is on or off, as Radiance's
 * programs take it?  Behind the name stands +, 1, y or t, or -, 0, n or f, or
 * nothing, which turns *on over.  False leaves *on as it is. */
bool rad_params_switch(const char *word, const char *name, bool *on);

/* Check what options forbid together; 0 or RAD_EUSAGE. */
int rad_params_check(const struct rad_params *p, struct rad_error *err);

/* The options that matter to pixels, canonical: every option in table order
 * with its value, one blank between words, the same string for the same
 * parameters.  Needs at most RAD_PARAMS_TEXT bytes; parsing its words again
 * gives the same struct, bit for bit (reals are printed with 17 digits where
 * fewer do not suffice). */
#define RAD_PARAMS_TEXT 4000
void rad_params_format(const struct rad_params *p, char *buf, size_t size);
/* The name in b, *n bytes long, of the first option whose value is another in
 * a; both are canonical. */
const char *rad_params_differ(const char *a, const char *b, int *n);

/* rpict's -defaults: one line an option, "-dt 0.05    # direct threshold", to
 * a caller's sink. */
void rad_params_print_defaults(const struct rad_params *p,
                               void (*line)(void *arg, const char *text),
                               void *arg);

#endif
