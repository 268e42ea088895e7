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

struct pointfile {
    const char *name; /* for errors; borrowed */
    char format;      /* 'a' (text), 'f' or 'd' */
    uint64_t most;    /* what follows so many points is not looked at */
    double (*point)[6];
    uint32_t n;
    size_t room;
    uint64_t taken; /* points before these, that are not here any more */
    long line;      /* lines of text so far */
};

void pointfile_init(struct pointfile *f, const char *name, char format,
                    uint64_t most);

/* Take n more bytes apart; *used of them were whole points, and unless they are
 * the last, the caller says the others again with those that follow. RAD_EDATA,
 * with the name and the line, or the point, of what is wrong; RAD_ENOMEM. */
int pointfile_more(struct pointfile *f, const void *bytes, size_t n, bool last,
                   size_t *used, struct rad_error *err);

/* The first n points become *to's.  RAD_ENOMEM. */
int pointfile_take(struct pointfile *from, uint32_t n, struct pointfile *to,
                   struct rad_error *err);

/* All of the file of that name; "-" is the standard input, to its end.
 * RAD_ENOINPUT, RAD_EUSAGE for more than RAD_MAX_POINTS. */
int pointfile_read(struct pointfile *f, struct rad_error *err);

void pointfile_release(struct pointfile *f);

#endif
