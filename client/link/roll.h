/* roll.h - which workers are at a coordinator
 *
 * Thread: one. */
#ifndef RADD_CLIENT_ROLL_H
#define RADD_CLIENT_ROLL_H

#include "base/error.h"
#include "proto/message.h"

#include <stdbool.h>

struct roll {
    int n;           /* workers that are there */
    bool busy;       /* one of them is at some job */
    char names[400]; /* "ws1, ws2", perhaps cut */
};

/* Add a page of the list of workers; *next is the cursor of what is behind it,
 * 0 at the end.  RAD_EPROTO: it is none; answer may be NULL. */
int roll_page(struct roll *r, const struct msg_answer *answer, uint64_t *next,
              struct rad_error *err);

#endif
