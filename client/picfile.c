/* picfile.c - see picfile.h */
#include "config.h"

#include "picfile.h"

int
picfile_write(const char *path, enum picfile_format format, const uint8_t *hdr,
              size_t n, bool durable, struct rad_error *err)
{
    if (format == PICFILE_PNG ||
        (format == PICFILE_BY_SUFFIX && path && output_suffix(path, ".png")))
        return rad_fail(err, RAD_EUSAGE, "no PNG can be written yet");
    return output_write(path, hdr, n, durable, err);
}
