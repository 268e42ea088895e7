/* picfile.h - a picture that came as .hdr, in the format that is wanted
 *
 * Thread: any.  */
#ifndef RADD_CLIENT_PICFILE_H
#define RADD_CLIENT_PICFILE_H

#include "output.h"

#include <stdint.h>

/* the words of radsubmit's --format, in its order */
enum picfile_format { PICFILE_BY_SUFFIX, PICFILE_RGBE, PICFILE_PNG };

/* RAD_EUSAGE for a name that promises another format than its suffix gives, as
 * "x.jpg", or "x.hdr" where what is written is PNG in any case.  A suffix that
 * is none of a picture's is anybody's own. */
int picfile_check(const char *path, bool always_png, struct rad_error *err);

/* Write the picture in hdr[0..n-1] to path (NULL: standard output), whole.  By
 * its suffix .png is tone-mapped, every other name RGBE.  RAD_EDATA for bytes
 * that are no picture; output.h's errors. */
int picfile_write(const char *path, enum picfile_format format,
                  const uint8_t *hdr, size_t n, bool durable,
                  struct rad_error *err);

#endif
