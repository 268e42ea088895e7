/* expose.h - change a picture's exposure
 *
 * The values are multiplied by a factor, and a line EXPOSURE= in the header
 * names it, as pfilt does; programs that read the picture divide by it again.
 * Thread: any. */
#ifndef RADD_CLIENT_EXPOSE_H
#define RADD_CLIENT_EXPOSE_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Multiply a picture of n bytes in the form of image/hdr.h, with rows from the
 * top.  *out, of *nout bytes, is to be freed.  RAD_EDATA, RAD_ENOMEM. */
int expose(const uint8_t *hdr, size_t n, double factor, uint8_t **out,
           size_t *nout, struct rad_error *err);

/* Is such a picture all black, so that no exposure shows anything?  Reads up to
 * the first row with light.  False for bytes that are not a picture. */
bool expose_nothing(const uint8_t *hdr, size_t n);

#endif
