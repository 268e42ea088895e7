/* picfile.c - see picfile.h */
#include "config.h"

#include "picfile.h"

#include "picture/png.h"

#include <stdlib.h>

/* Larger pictures are for programs, not for the eye. */
#define MOST_PIXELS ((size_t)1 << 28)

static int
write_png(const char *path, const uint8_t *hdr, size_t n, bool durable,
          struct rad_error *err)
{
    struct rad_memory_out png = { 0 };
    struct rad_sink sink = rad_memory_sink(&png);
    struct rad_picture pic;
    int rc = rad_hdr_read(hdr, n, MOST_PIXELS, &pic, err);

    if (rc == 0)
        rc = rad_png_picture(&pic, &sink, err);
    if (rc == 0)
        rc = output_write(path, png.bytes, png.len, durable, err);
    free(png.bytes);
    rad_picture_release(&pic);
    return rc;
}

int
picfile_write(const char *path, enum picfile_format format, const uint8_t *hdr,
              size_t n, bool durable, struct rad_error *err)
{
    if (format == PICFILE_PNG ||
        (format == PICFILE_BY_SUFFIX && path && output_suffix(path, ".png")))
        return write_png(path, hdr, n, durable, err);
    return output_write(path, hdr, n, durable, err);
}
