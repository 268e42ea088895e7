/* rescue.h - save results that radsubmit could not write to their place
 *
 * Most coordinators keep pictures, but radsubmit's own ends with it: then a
 * disk that is full after hours of rendering would lose everything.
 * Thread: one. */
#ifndef RADD_CLIENT_RESCUE_H
#define RADD_CLIENT_RESCUE_H

#include "proto/message.h"

/* Write n bytes to a file below TMPDIR, /var/tmp or /tmp, the first of these
 * with room.  Its name has the job, the frame and the ending (".hdr").  Returns
 * its path, to be freed; NULL: no folder has room. */
char *rescue_write(const uint8_t job[MSG_JOB], uint32_t frame,
                   const char *ending, const uint8_t *bytes, size_t n);

/* The same for a file that write(arg, path, err) writes. */
char *rescue_by(const uint8_t job[MSG_JOB], uint32_t frame, const char *ending,
                int (*write)(void *arg, const char *path,
                             struct rad_error *err),
                void *arg);

#endif
