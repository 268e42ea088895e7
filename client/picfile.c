/* picfile.c - see picfile.h */
#include "config.h"

#include "picfile.h"

#include "outname.h"

#include "picture/hdr.h"
#include "picture/png.h"

#include <limits.h>

/* formats that somebody who asks for them does not get */
static const char *const others[] = { ".bmp", ".exr", ".gif",  ".jpeg",
                                      ".jpg", ".pdf", ".pfm",  ".ppm",
                                      ".tga", ".tif", ".tiff", ".webp" };
static const char *const rgbe[] = { ".hdr", ".pic" };

static bool
ends_in(const char *path, const char *const *suffix, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (outname_suffix(path, suffix[i]))
            return true;
    return false;
}

int
picfile_check(const char *path, bool always_png, struct rad_error *err)
{
    if (!ends_in(path, others, sizeof others / sizeof others[0]) &&
        !(always_png && ends_in(path, rgbe, sizeof rgbe / sizeof rgbe[0])))
        return 0;
    return rad_fail(err, RAD_EUSAGE,
                    "'%s': that format is not written there: use a name in %s",
                    path, always_png ? ".png" : ".hdr, .pic or .png");
}

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
        (format == PICFILE_BY_SUFFIX && path && outname_suffix(path, ".png")))
        return write_png(path, hdr, n, durable, err);
    return output_write(path, hdr, n, durable, err);
}
