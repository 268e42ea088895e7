/* params.h - rendering parameters, with rpict's names, defaults and meaning
 *
 * One table in params.c (name, kind, range, default, help) parses the options
 * of rpict(1), prints -defaults and the canonical option string that goes into
 * picture headers, and is checked against radsubmit(1).
 * A struct rad_params is plain data without pointers: it is copied freely, and
 * read-only while a job renders. */
#ifndef RAD_BASE_PARAMS_H
#define RAD_BASE_PARAMS_H

#include "base/bands.h"
#include "base/color.h"
#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* The most columns or rows of a picture. */
#define RAD_MAX_RES 1048576

/* The most rays of a pixel; a thread finishes a pixel before it can stop. */
#define RAD_MOST_SAMPLES 1024

/* The most bytes of the names of -ae or -ai, with "-ae" and two blanks each. */
#define RAD_MAX_AMBLIST 2400

/* The colour space of a picture's pixels. */
enum rad_primaries {
    RAD_PRIM_RGB,   /* -pRGB: Radiance's own primaries */
    RAD_PRIM_XYZ,   /* -pXYZ: CIE tristimulus values, times 179 lm/W */
    RAD_PRIM_CUSTOM /* -pc: values as for -pRGB, declared as other primaries */
};

/* The kind of the list of modifiers that -ae or -ai gives. */
enum {
    RAD_AMB_ALL,     /* no list */
    RAD_AMB_EXCLUDE, /* surfaces of these get no ambient calculation */
    RAD_AMB_INCLUDE  /* only surfaces of these get it */
};

struct rad_params {
    /* picture */
    int xres, yres; /* -x -y: the most columns and rows */
    enum rad_primaries primaries;
    double chroma[8]; /* -pc: x y of red, green, blue, white; else 0 */
    double pixaspect; /* -pa: height / width of a pixel; 0: fill x by y */
    double pixjitter; /* -pj: 0 centre .. 1 anywhere in the pixel */
    int psample;      /* -ps: sample spacing [pixels], 1: every pixel; values
                       * outside 1..16 are brought there, as in rpict */
    double maxdiff;   /* -pt: difference that forces a sample */
    double motion;    /* -pm: shutter time, in times between two frames */
    double aperture;  /* -pd: diameter of the lens [scene units] */
    int samples;      /* --samples: rays of a pixel that is traced */
    bool directvis;   /* -dv: sources visible to the eye */
    /* direct light */
    double srcjitter;  /* -dj dstrsrc */
    double srcsizerat; /* -ds: largest source size / distance; 0: whole */
    double shadthresh; /* -dt: direct threshold */
    double shadcert;   /* -dc: direct certainty */
    int directrelay;   /* -dr: direct relays */
    int vspretest;     /* -dp: direct pretest density [samples/sr] */
    /* specular */
    double specjitter; /* -ss: specular sampling */
    double specthresh; /* -st: specular threshold */
    bool backvis;      /* -bv: back faces are visible */
    bool irradiance;   /* -i */
    bool rand_samp;    /* -u: pure Monte Carlo; the seed is --seed, not time */
    /* medium: -me [1/unit] -ma -mg -ms [unit] */
    struct rad_rgb cextinction, salbedo;
    double seccg, ssampdist;
    /* indirect light */
    int ambounce;                  /* -ab: bounces */
    double ambacc;                 /* -aa: accuracy */
    int ambres;                    /* -ar: resolution */
    int ambdiv;                    /* -ad: samples of a hemisphere */
    int ambssamp;                  /* -as: further samples */
    struct rad_rgb ambval;         /* -av: radiance [W/sr/m^2] */
    int ambvwt;                    /* -aw: weight of ambval */
    int amblisted;                 /* RAD_AMB_* */
    char amblist[RAD_MAX_AMBLIST]; /* names, a blank between two */
    /* limits */
    int maxdepth;           /* -lr: bounces; <= 0: Russian roulette */
    double minweight;       /* -lw: least weight of a ray */
    struct rad_bands bands; /* -cs -cw --plane */
    /* ours */
    int surroundings; /* --surroundings: the scene is so many times as large as
                       * the part of it that pictures show; 0: as 1 */
    double shown[4];  /* --shown: centre and radius of a ball that holds that
                       * part; radius 0: it is not known where it is */
    uint64_t seed;    /* --seed */
};

/* rpict's defaults. */
void rad_params_init(struct rad_params *p);

/* Take the option at argv[0], which is followed by argc - 1 words.  Returns how
 * many words it takes (>= 1), 0 if it is no rendering option of ours, or
 * RAD_EUSAGE with a message that names the option: a bad or missing number, a
 * value out of range, or an option of rpict that we lack.
 * Programs take -vf -o -z -S -t -e -w -aE -aI -defaults -help -version by
 * themselves. */
int rad_params_option(struct rad_params *p, int argc, char *const argv[],
                      struct rad_error *err);

/* The values of a pixel of radiance L under -pRGB, -pXYZ or -pc. */
struct rad_rgb rad_params_colour(const struct rad_params *p, struct rad_rgb L);

/* Copy *p, with defaults for the options that ambient records do not depend on:
 * which pixels there are, where in a pixel, through which lens and at what time
 * rays go, how pixels are written, how many bands red, green and blue are made
 * of (RAD_PLANE_COLOURS), and where what they show is, for a job takes no
 * wider zones than suit its place (rad_ambrec_narrow()).  If the results for
 * two jobs on one scene are equal, seed included, records of one suit the
 * other. */
void rad_params_of_records(const struct rad_params *p, struct rad_params *out);

/* Is the word the on/off option `name`, as Radiance's programs take it?  The
 * name is followed by one of + 1 y t (on), by one of - 0 n f (off), in either
 * case, or by nothing, which inverts *on.  If false, *on is unchanged. */
bool rad_params_switch(const char *word, const char *name, bool *on);

/* Check options that exclude each other; 0 or RAD_EUSAGE. */
int rad_params_check(const struct rad_params *p, struct rad_error *err);

/* Write the options as canonical text: in the table's order with their values,
 * one blank between words.  Equal parameters give equal text, and parsing its
 * words gives the same struct, bit for bit (with up to 17 digits).  The text
 * has at most RAD_PARAMS_TEXT bytes. */
#define RAD_PARAMS_TEXT 4000
void rad_params_format(const struct rad_params *p, char *buf, size_t size);
/* Find the first option that differs between two canonical texts: its name in
 * either, *n bytes long. */
const char *rad_params_differ(const char *a, const char *b, int *n);

/* rpict's -defaults: call `line` with one line for each option, such as
 * "-dt 0.05    # direct threshold". */
void rad_params_print_defaults(const struct rad_params *p,
                               void (*line)(void *arg, const char *text),
                               void *arg);

#endif
