/* expose.h - a picture with another exposure
 *
 * Its values are multiplied, and a line EXPOSURE= in its header says by what,
 * as pfilt does: what reads pictures divides by it again.
 * Thread: any. */
#ifndef RADD_CLIENT_EXPOSE_H
#define RADD_CLIENT_EXPOSE_H

#include "base/error.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* From a picture of ours (image/hdr.h), n bytes, whose rows run from the top.
 * *out, of *nout bytes, is to be freed.  RAD_EDATA, RAD_ENOMEM. */
int expose(const uint8_t *hdr, size_t n, double factor, uint8_t **out,
           size_t *nout, struct rad_error *err);

/* Is there no light in such a picture, which no exposure can show?  Reads it as
 * far as the first row that has some.  False for what is no picture. */
bool expose_nothing(const uint8_t *hdr, size_t n);

#endif
