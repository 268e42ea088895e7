/* fetch.h - a file of a job, piece by piece
 *
 * Thread: the link's.  */
#ifndef RADD_CLIENT_FETCH_H
#define RADD_CLIENT_FETCH_H

#include "link/link.h"

#include "base/files.h"

/* Ask for a file of a job; the answers carry the request's number. */
int fetch_start(struct link *l, const uint8_t job[MSG_JOB], uint32_t frame,
                enum msg_what what, uint32_t request, struct rad_error *err);

/* Take a message that answers the request into *f, which begins zeroed and
 * whose bytes the caller frees.  Returns 1 when the file is whole, 0 if more is
 * to come; or the error of a FAILED, RAD_EPROTO, RAD_ENOMEM.  Memory grows with
 * what has come, not with the total that is claimed. */
int fetch_take(struct rad_memory_out *f, const struct msg *m,
               struct rad_error *err);

#endif
