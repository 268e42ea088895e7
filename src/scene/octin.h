/* octin.h - reading what octree and mesh files have in common (inside scene/
 * only)
 *
 * The input remembers its first failure, so that the code that follows a format
 * is straight and checks at its ends.  No count is believed: arrays grow with
 * what really arrives.  Functions return rc, or what they read, which means
 * nothing once rc is set. */
#ifndef RAD_SCENE_OCTIN_H
#define RAD_SCENE_OCTIN_H

#include "base/files.h"
#include "scene/octreal.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RAD_OCTIN_TYPES 128 /* a type's place is a signed byte */

struct rad_octin {
    struct rad_stream in;
    struct rad_error *err;
    int rc;        /* first failure */
    uint64_t base; /* offset of buf in the file */
    size_t pos, len;
    int width;        /* bytes of an index */
    int32_t first;    /* where the scene keeps the file's first object */
    int32_t nobjects; /* that it says it has; -1: it does not say */
    int types[RAD_OCTIN_TYPES]; /* enum rad_otype, or -1: unknown */
    char unknown[32];           /* the first of those */
    int ntypes;
    unsigned char buf[64 * 1024];
};

/* Fail with RAD_EDATA at the byte that is next. */
int rad_octin_bad(struct rad_octin *f, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));

/* True if a byte is there. */
bool rad_octin_fill(struct rad_octin *f);

/* A string into buf; the failure for one of `size` bytes or more. */
int rad_octin_string(struct rad_octin *f, char *buf, size_t size);

/* An index or count of 0 to max, else the failure and 0. */
int32_t rad_octin_index(struct rad_octin *f, int32_t max, const char *what);

/* May a file that starts so have a header?  Old ones begin with the command
 * that made the octree and not with "#?". */
bool rad_octin_begins(const char *start, size_t len);

/* The text to its empty line; it must say that it is of that format. */
int rad_octin_header(struct rad_octin *f, const char *format);

/* Is that what a line of a header says? */
bool rad_octin_says(const char *line, const char *format);

/* The lowest corner and the edge of the cube. */
int rad_octin_cube(struct rad_octin *f, double org[3], double *size);

void rad_octin_skip_tree(struct rad_octin *f);

/* The types' names, then the objects, to the end of them, appended to the
 * scene as read from its file number `file`. */
int rad_octin_types(struct rad_octin *f);
int rad_octin_objects(struct rad_octin *f, struct rad_scene *s, int32_t file);

static inline int
rad_octin_byte(struct rad_octin *f)
{
    if (f->pos == f->len && !rad_octin_fill(f)) {
        rad_octin_bad(f, "truncated");
        return 0;
    }
    return f->buf[f->pos++];
}

/* Big-endian, two's complement, 1 to 8 bytes.  Four that are there, nearly all
 * of a file, need no look at each. */
static inline int64_t
rad_octin_int(struct rad_octin *f, int bytes)
{
    const unsigned char *p = f->buf + f->pos;
    uint64_t v;

    if (bytes == 4 && f->len - f->pos >= 4) {
        f->pos += 4;
        return (int32_t)((uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 |
                         (uint32_t)p[2] << 8 | p[3]);
    }
    v = (uint64_t)rad_octin_byte(f);
    if (v & 0x80)
        v |= ~UINT64_C(0xff);
    while (--bytes > 0)
        v = v << 8 | (uint64_t)rad_octin_byte(f);
    return (int64_t)v;
}

static inline double
rad_octin_real(struct rad_octin *f)
{
    struct rad_octreal p;

    p.mantissa = (int32_t)rad_octin_int(f, 4);
    p.exponent = (int)rad_octin_int(f, 1);
    return rad_octreal_value(p);
}

#endif
