/* picfile.h - a picture that came as .hdr, in the format that is wanted
 *
 * Thread: any.  */
#ifndef RADD_CLIENT_PICFILE_H
#define RADD_CLIENT_PICFILE_H

#include "base/output.h"
#include "show/show.h"

#include <stdint.h>

/* the words of radsubmit's --format, in its order */
enum picfile_format { PICFILE_BY_SUFFIX, PICFILE_RGBE, PICFILE_PNG };

/* RAD_EUSAGE for a name that promises another format than its suffix gives, as
 * "x.jpg", or "x.hdr" where what is written is PNG in any case.  A suffix that
 * is none of a picture's is anybody's own. */
int picfile_check(const char *path, bool always_png, struct rad_error *err);

/* Is a picture of that name and format written as PNG?  path NULL: standard
 * output. */
bool picfile_is_png(const char *path, enum picfile_format format);

/* Write the picture in hdr[0..n-1] to path (NULL: standard output), whole: as
 * it is, or as PNG the way that *show says, which learns from it.  RAD_EDATA
 * for bytes that are no picture; output.h's errors. */
int picfile_write(const char *path, enum picfile_format format,
                  const uint8_t *hdr, size_t n, bool durable, struct show *show,
                  struct rad_error *err);

/* The same as a PNG of a picture that is not whole yet; see show.h. */
int picfile_preview(const char *path, const uint8_t *hdr, size_t n,
                    const struct show *show, struct show_last *last,
                    struct rad_error *err);

/* Let *show learn from a picture that is not written. */
int picfile_look(const uint8_t *hdr, size_t n, struct show *show,
                 struct rad_error *err);

#endif
