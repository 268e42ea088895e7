/* picfile.h - write a picture, which came as .hdr, in the wanted format
 *
 * Thread: any. */
#ifndef RADD_CLIENT_PICFILE_H
#define RADD_CLIENT_PICFILE_H

#include "show/show.h"

#include <stdint.h>

/* in the order of the words of --format */
enum picfile_format { PICFILE_BY_SUFFIX, PICFILE_RGBE, PICFILE_PNG };

/* RAD_EUSAGE: the name's suffix is that of another format than will be written,
 * as "x.jpg", or "x.hdr" if always_png.  Suffixes that are not a picture
 * format's are accepted. */
int picfile_check(const char *path, bool always_png, struct rad_error *err);

/* Will a picture of that name and format be written as PNG?  path NULL:
 * standard output. */
bool picfile_is_png(const char *path, enum picfile_format format);

struct picfile {
    const char *path; /* NULL: standard output */
    enum picfile_format format;
    bool durable; /* sync to the disk */
};

/* Write the picture in hdr[0..n-1], whole or not at all: as it is, but for what
 * meets within pixels (image/edge.h), or as PNG by *show, which the picture may
 * settle (show.h).  RAD_EDATA: the bytes are not a picture; errors of output.h.
 */
int picfile_write(const struct picfile *to, const uint8_t *hdr, size_t n,
                  struct show *show, struct rad_error *err);

/* Write a picture that is not whole as PNG; see show_preview(). */
int picfile_preview(const char *path, const uint8_t *hdr, size_t n,
                    struct show *show, struct show_last *last,
                    struct rad_error *err);

/* Let a picture settle *show without writing it. */
int picfile_look(const uint8_t *hdr, size_t n, struct show *show,
                 struct rad_error *err);

#endif
