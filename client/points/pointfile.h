/* pointfile.h - sensor points from a file, as rtrace(1) takes them
 *
 * Six numbers each, origin and direction: text, a point a line, or floats or
 * doubles in the machine's order.
 * Thread: one. */
#ifndef RADD_CLIENT_POINTFILE_H
#define RADD_CLIENT_POINTFILE_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Zeroed at first. */
struct pointfile {
    double (*point)[6];
    uint32_t n;
    size_t room;
    uint64_t taken; /* points before these, that are not here any more */
    long line;      /* lines of text so far */
};

/* Take n bytes apart, whose format is 'a' (text), 'f' or 'd'; what follows the
 * first `most` points is not looked at.  RAD_EDATA, with `name` and the line,
 * or the point, of what is wrong; RAD_ENOMEM.  *f can be released in any
 * case. */
int pointfile_parse(struct pointfile *f, const char *name, const void *bytes,
                    size_t n, char format, uint64_t most,
                    struct rad_error *err);

/* The same of n more bytes; *used of them were whole points, and unless they
 * are the last, the caller says the others again with those that follow. */
int pointfile_more(struct pointfile *f, const char *name, const void *bytes,
                   size_t n, char format, uint64_t most, bool last,
                   size_t *used, struct rad_error *err);

/* The first n points become *to's.  RAD_ENOMEM. */
int pointfile_take(struct pointfile *from, uint32_t n, struct pointfile *to,
                   struct rad_error *err);

/* The same of a file; "-" is the standard input, to its end.  RAD_ENOINPUT,
 * RAD_EUSAGE for more than RAD_MAX_POINTS. */
int pointfile_read(struct pointfile *f, const char *name, char format,
                   uint64_t most, struct rad_error *err);

void pointfile_release(struct pointfile *f);

#endif
