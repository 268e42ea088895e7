/* ambfile.h - ambient records in a file (-af)
 *
 * Two formats.  Both begin with a header of lines, as Radiance's files do,
 * which ends with an empty line.  Our own loses nothing:
 *
 *     #?RADIANCE
 *     SOFTWARE=radd 0.1
 *     SCENE=<64 hex digits>          hash of the scene and the files it needs
 *     OPTIONS=<rendering options>    those that records depend on
 *     FORMAT=radd_ambient_3
 *
 * The records follow as they travel between workers (ambshare.h), to the end of
 * the file.  FORMAT=Radiance_ambval is that of Radiance 6 with three channels:
 * after the header come the bytes 02 31 (hex), then 67 bytes for each record,
 * integers big-endian:
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
 * A flt is a mantissa, an i32 / (2^31 - 1), and an exponent of 2, an i8.  A
 * direction has the signs of x, y, z in bits 0 to 2 (1: negative).  Bits 5 to
 * 17 and 18 to 30 have its two smaller components, in units of 1/11584.5.  Bit
 * 3 is 1 if the first of these is x, 0 if it is y; bit 4 is 1 if the second is
 * z, 0 if it is the other of x and y.  The header names options, but no scene.
 * Source: what Radiance's programs write. */
#ifndef RADD_CLIENT_AMBFILE_H
#define RADD_CLIENT_AMBFILE_H

#include "base/sha.h"
#include "light/indirect/ambient.h"
#include "base/params.h"
#include "proto/wire.h"

#include <stdio.h>

enum ambfile_format { AMBFILE_OURS, AMBFILE_RADIANCE };

/* The scene and options that records belong to. */
struct ambfile {
    enum ambfile_format format; /* ours, unless a file in Radiance's was read */
    struct rad_params params;
    char scene[RAD_SHA_HEX + 1]; /* compile_digest() */
};

/* Lists have records as they travel between workers (ambshare.h). */

/* Parse a file of len bytes, and add each sound record to the list.  Sets
 * a->format.  RAD_EDATA: the file is malformed, ends in the middle of a record,
 * or belongs to another scene or other options, which the message names;
 * RAD_ENOMEM. */
int ambfile_parse(struct ambfile *a, const void *bytes, size_t len,
                  struct wire_out *list, struct rad_error *err);

/* Write the sound records of a list of len bytes, in a->format. */
int ambfile_format(const struct ambfile *a, const void *list, size_t len,
                   FILE *f, struct rad_error *err);

/* Read the file at path, of at most list->max bytes.  A missing file has no
 * records, nor has an empty one, such as mktemp(1) makes.  Errors of
 * ambfile_parse(). */
int ambfile_read(struct ambfile *a, const char *path, struct wire_out *list,
                 struct rad_error *err);

/* Write the list to path, whole or not at all: a reader sees either the old
 * file or the new one.  If two programs write it, the later one's records stay.
 */
int ambfile_write(const struct ambfile *a, const char *path,
                  const struct wire_out *list, bool durable,
                  struct rad_error *err);

/* Read the file into a cache, and write all records of a cache.  Errors also of
 * ambshare_load(). */
int ambfile_load(struct ambfile *a, const char *path, struct rad_ambient *amb,
                 struct rad_error *err);
int ambfile_save(const struct ambfile *a, const char *path,
                 const struct rad_ambient *amb, struct rad_error *err);

#endif
