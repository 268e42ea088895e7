/* pointspec.h - rtrace's options for sensor points
 *
 * Thread: one. */
#ifndef RADD_CLIENT_POINTSPEC_H
#define RADD_CLIENT_POINTSPEC_H

#include "base/params.h"

#include <stdint.h>

/* Most letters of -o. */
#define POINTSPEC_VALUES 31

struct pointspec {
    const char *file;   /* --points; NULL: a job of pictures */
    bool irradiance;    /* -I */
    bool limited;       /* -ld */
    bool no_header;     /* -h- */
    char in, out;       /* -f: 'a', 'f' or 'd'; out also 'c' */
    const char *values; /* letters of -o */
    const char *mean;   /* "-pY", "-pA": light is one number; or NULL */
    int x, y;           /* -x and -y: points a row, rows; 0: not given */
    const char *option; /* first option of rtrace's that was given; or NULL */
};

void pointspec_init(struct pointspec *s);

/* Take the option at argv[0], if it is one that rtrace has and rpict lacks.  Of
 * -x and -y only 0 is taken; for other values this notes them and returns 0, so
 * that they are taken as rpict's, too.  Returns the number of words used, 0 for
 * another option, or RAD_EUSAGE. */
int pointspec_option(struct pointspec *s, int argc, char *const argv[],
                     struct rad_error *err);

/* RAD_EUSAGE: the options contradict each other. */
int pointspec_check(const struct pointspec *s, struct rad_error *err);

/* Most points that are read; with -x and -y also how many there should be. */
uint64_t pointspec_most(const struct pointspec *s);

/* After how many points rtrace writes what it has; 0: when it likes. */
uint32_t pointspec_flush(const struct pointspec *s);

/* Does any letter of -o need light, or the path of the traced ray? */
bool pointspec_lit(const struct pointspec *s);

/* Set rtrace's defaults where they differ from rpict's. */
void pointspec_defaults(struct rad_params *p);

/* Write the options as words, for the header, into buf of n bytes. */
void pointspec_format(const struct pointspec *s, char *buf, size_t n);

#endif
