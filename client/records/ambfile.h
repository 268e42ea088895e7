/* ambfile.h - ambient records in a file (-af)
 *
 * Two formats, both with a header of lines as Radiance's files have, ended by
 * an empty one.  Ours loses nothing:
 *
 *     #?RADIANCE
 *     SOFTWARE=radd 0.1
 *     SCENE=<64 hex digits>          of the scene and the files it needs
 *     OPTIONS=<rendering options>    those on which records depend
 *     FORMAT=radd_ambient_3
 *
 * and then records as they travel between workers (ambshare.h), to the end of
 * the file.  FORMAT=Radiance_ambval is Radiance 6's own, with three channels:
 * after the header 02 31 (hex), then 67 bytes a record, integers big-endian:
 *
 *     u8      level
 *     flt     weight
 *     flt[3]  point
 *     u32[2]  directions: normal, u
 *     flt[2]  radii along u and normal x u
 *     flt[2]  gradient for moving
 *     flt[2]  gradient for turning
 *     u32     corral
 *     u8[4]   E / pi as RGBE
 *
 * where a flt is a mantissa i32 / (2^31 - 1) and an exponent of 2 as i8, and a
 * direction has the signs of x, y, z in bits 0 to 2 (1: negative), in bits 5
 * to 17 and 18 to 30 the two smaller components in units of 1/11584.5, and says
 * in bit 3 that the first of them is x, else y, and in bit 4 that the second
 * is z, else the other of x and y.  It names no scene, but options.
 * Source of the latter: what Radiance's programs write.  */
#ifndef RADD_CLIENT_AMBFILE_H
#define RADD_CLIENT_AMBFILE_H

#include "base/sha.h"
#include "light/indirect/ambient.h"
#include "base/params.h"

#include <stdio.h>

enum ambfile_format { AMBFILE_OURS, AMBFILE_RADIANCE };

/* What records belong to. */
struct ambfile {
    enum ambfile_format format; /* ours, until a file in the other is read */
    struct rad_params params;
    char scene[RAD_SHA_HEX + 1]; /* compile_digest() */
};

/* Read a file of len bytes and hand on its records, sound ones alone.
 * RAD_EDATA: it is none, ends in the middle, or belongs to another scene or to
 * other options, which are named.  Sets a->format. */
typedef void ambfile_take(void *arg, const struct rad_ambrec *rec);
int ambfile_parse(struct ambfile *a, const void *bytes, size_t len,
                  ambfile_take *take, void *arg, struct rad_error *err);

/* Write all records of the cache, in a->format; or of a list of len bytes, as
 * they travel between workers (ambshare.h), sound ones alone. */
int ambfile_format(const struct ambfile *a, const struct rad_ambient *amb,
                   FILE *f, struct rad_error *err);
int ambfile_format_list(const struct ambfile *a, const void *list, size_t len,
                        FILE *f, struct rad_error *err);

/* Read what there is at path into the cache; no file there is not wrong.
 * Besides the above: RAD_EDATA when a record lies outside the scene. */
int ambfile_load(struct ambfile *a, const char *path, struct rad_ambient *amb,
                 struct rad_error *err);

/* Write the cache to path, whole or not at all: who reads it meanwhile has the
 * old file.  Of two that save at once, the last one's records are kept. */
int ambfile_save(const struct ambfile *a, const char *path,
                 const struct rad_ambient *amb, struct rad_error *err);

#endif
