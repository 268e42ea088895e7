/* fetch.h - a file of a job, piece by piece
 *
 * Thread: the link's.  */
#ifndef RADD_CLIENT_FETCH_H
#define RADD_CLIENT_FETCH_H

#include "link/link.h"

/* Begins zeroed; the owner frees bytes. */
struct fetched {
    uint8_t *bytes;
    size_t len, cap;
};

/* Ask for a file of a job; the answers carry the request's number. */
int fetch_start(struct link *l, const uint8_t job[MSG_JOB], uint32_t frame,
                enum msg_what what, uint32_t request, struct rad_error *err);

/* Take a message that answers the request.  Returns 1 when the file is whole, 0
 * if more is to come; or the error of a FAILED, RAD_EPROTO, RAD_ENOMEM.  Memory
 * grows with what has come, not with the total that is claimed. */
int fetch_take(struct fetched *f, const struct msg *m, struct rad_error *err);

#endif
