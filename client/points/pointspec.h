/* pointspec.h - what rtrace's own options say of sensor points
 *
 * Thread: one. */
#ifndef RADD_CLIENT_POINTSPEC_H
#define RADD_CLIENT_POINTSPEC_H

#include "base/params.h"

#include <stdint.h>

/* Most letters of -o. */
#define POINTSPEC_VALUES 31

struct pointspec {
    const char *file;   /* --points; NULL: the job is of pictures */
    bool irradiance;    /* -I */
    bool limited;       /* -ld */
    bool no_header;     /* -h- */
    char in, out;       /* -f: 'a', 'f' or 'd'; out also 'c' */
    const char *values; /* letters of -o */
    int x, y;           /* -x -y: rays a row, rows; 0: not said */
    const char *option; /* the first of rtrace's own, for messages; or NULL */
};

void pointspec_init(struct pointspec *s);

/* Take the option at argv[0], if it is one of rtrace's that rpict lacks, or -x
 * or -y, which are *also to be tried as rpict's: 0 where they are positive.
 * Returns the words used, 0 for another option, RAD_EUSAGE. */
int pointspec_option(struct pointspec *s, int argc, char *const argv[],
                     struct rad_error *err);

/* Is what they say together possible?  RAD_EUSAGE. */
int pointspec_check(const struct pointspec *s, struct rad_error *err);

/* How many points are read at most, and with -x and -y at least. */
uint64_t pointspec_most(const struct pointspec *s);

/* Does any letter ask for light, or for where the ray went then? */
bool pointspec_lit(const struct pointspec *s);

/* rtrace's defaults, where they are not rpict's. */
void pointspec_defaults(struct rad_params *p);

/* The options of *s as words, for the header; buf gets at most n bytes. */
void pointspec_format(const struct pointspec *s, char *buf, size_t n);

#endif
