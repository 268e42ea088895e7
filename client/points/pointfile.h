/* pointfile.h - sensor points from a file, as rtrace(1) reads them
 *
 * Each point is six numbers, origin and direction: a line of text, which ends
 * with a newline, a return or both; or floats or doubles in the machine's byte
 * order.
 * Thread: one. */
#ifndef RADD_CLIENT_POINTFILE_H
#define RADD_CLIENT_POINTFILE_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Read a line of text, of n bytes without its end: 1: six finite numbers; 0: it
 * is empty; or RAD_EDATA. */
int pointfile_line(const char *line, size_t n, double v[6],
                   struct rad_error *err);

struct pointfile {
    const char *name; /* for errors; borrowed */
    char format;      /* 'a' (text), 'f' or 'd' */
    uint64_t most;    /* points after so many are ignored */
    double (*point)[6];
    uint32_t n;
    uint64_t taken; /* points that were read before these, and taken */
    long line;      /* lines of text so far */
    bool returned;  /* the last of them ended with a return */
};

void pointfile_init(struct pointfile *f, const char *name, char format,
                    uint64_t most);

/* Parse n more bytes.  *used: how many of them were whole points; unless these
 * bytes are the last, the caller passes the rest again, followed by more.
 * RAD_EDATA, with the name and the line or number of a malformed point;
 * RAD_ENOMEM. */
int pointfile_more(struct pointfile *f, const void *bytes, size_t n, bool last,
                   size_t *used, struct rad_error *err);

/* Move the first n points to *to, which takes no others.  RAD_ENOMEM. */
int pointfile_take(struct pointfile *from, uint32_t n, struct pointfile *to,
                   struct rad_error *err);

/* Read the whole file of that name; "-" is the standard input.  RAD_ENOINPUT;
 * RAD_EUSAGE: more than RAD_MAX_POINTS. */
int pointfile_read(struct pointfile *f, struct rad_error *err);

void pointfile_release(struct pointfile *f);

#endif
