/* octin.h - reading the parts that octree and mesh files have in common (inside
 * scene/ only)
 *
 * The input remembers its first failure, so that code that follows a format is
 * straight and checks only at its end.  No count in a file is trusted: arrays
 * grow as data arrives.  Functions return rc or the value read, which means
 * nothing once rc is set. */
#ifndef RAD_SCENE_OCTIN_H
#define RAD_SCENE_OCTIN_H

#include "base/files.h"
#include "scene/octreal.h"
#include "scene/scene.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RAD_OCTIN_TYPES 128 /* a type's number is a signed byte */

struct rad_octin {
    struct rad_stream in;
    struct rad_error *err;
    int rc;        /* first failure */
    uint64_t base; /* offset of buf in the file */
    size_t pos, len;
    int width;        /* bytes of an index */
    int32_t first;    /* index of the file's first object in the scene */
    int32_t nobjects; /* number of objects by the file; -1: it has none */
    int types[RAD_OCTIN_TYPES]; /* enum rad_otype, or -1: unknown */
    char unknown[32];           /* name of the first unknown type */
    int ntypes;
    unsigned char buf[64 * 1024];
};

/* Fail with RAD_EDATA, and note the offset of the next byte. */
int rad_octin_bad(struct rad_octin *f, const char *fmt, ...)
    __attribute__((format(printf, 2, 3)));

/* Is there another byte?  Reads more if need be. */
bool rad_octin_fill(struct rad_octin *f);

/* Read a string into buf; one of `size` bytes or more is a failure. */
int rad_octin_string(struct rad_octin *f, char *buf, size_t size);

/* Read an index or count from 0 to max; another one is a failure. */
int32_t rad_octin_index(struct rad_octin *f, int32_t max, const char *what);

/* May a file with this start have a header?  Old files begin with the command
 * that made the octree and not with "#?". */
bool rad_octin_begins(const char *start, size_t len);

/* Read the text up to its empty line; it must name this format. */
int rad_octin_header(struct rad_octin *f, const char *format);

/* Does this line of a header name the format? */
bool rad_octin_says(const char *line, const char *format);

/* Read the lowest corner and the edge of the cube. */
int rad_octin_cube(struct rad_octin *f, double org[3], double *size);

void rad_octin_skip_tree(struct rad_octin *f);

/* Read the types' names; read all objects and append them to the scene, as from
 * its file number `file`. */
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

/* A big-endian integer in two's complement, of 1 to 8 bytes.  There is a short
 * cut for 4 bytes in the buffer, since nearly all integers are such. */
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
