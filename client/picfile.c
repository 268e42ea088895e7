/* picfile.c - see picfile.h */
#include "config.h"

#include "picfile.h"

#include "picture/hdr.h"
#include "picture/png.h"

#include <limits.h>

static int
put(void *arg, const void *data, size_t len, struct rad_error *err)
{
    (void)err; /* a failure shows at the commit */
    (void)!fwrite(data, 1, len, arg);
    return 0;
}

/* Tone-mapped, 8 bits. */
static int
write_png(const char *path, const uint8_t *hdr, size_t n, bool durable,
          struct rad_error *err)
{
    struct rad_picture pic = { 0 };
    struct output out = { 0 };
    struct rad_sink sink = { .write = put };
    int rc = rad_hdr_read(hdr, n, INT_MAX, &pic, err);

    if (rc == 0)
        rc = output_open(&out, path, durable, err);
    if (rc == 0) {
        sink.arg = out.file;
        rc = rad_png_picture(&pic, &sink, err);
        if (rc == 0)
            rc = output_commit(&out, err);
        else
            output_abort(&out);
    }
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
