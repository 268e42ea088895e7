/* rescue.h - what a cluster of its own rendered and radsubmit could not write
 *
 * A coordinator keeps pictures, but one that ends with radsubmit does not: a
 * disk that is full after hours of rendering would cost all of it.
 * Thread: one. */
#ifndef RADD_CLIENT_RESCUE_H
#define RADD_CLIENT_RESCUE_H

#include "proto/message.h"

/* Write n bytes to a file of the job's, and the frame's, name and that ending
 * (".hdr") below TMPDIR, /var/tmp or /tmp, the first that has room.  Its path,
 * to be freed; NULL: nowhere. */
char *rescue_write(const uint8_t job[MSG_JOB], uint32_t frame,
                   const char *ending, const uint8_t *bytes, size_t n);

/* The same of what write(arg, path, err) puts into the file. */
char *rescue_by(const uint8_t job[MSG_JOB], uint32_t frame, const char *ending,
                int (*write)(void *arg, const char *path,
                             struct rad_error *err),
                void *arg);

#endif
