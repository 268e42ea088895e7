/* roll.h - the workers that are connected to a coordinator
 *
 * Thread: one. */
#ifndef RADD_CLIENT_ROLL_H
#define RADD_CLIENT_ROLL_H

#include "base/error.h"
#include "proto/message.h"

#include <stdbool.h>

struct roll {
    int n;           /* connected workers */
    bool busy;       /* one of them works on a job */
    char names[400]; /* "ws1, ws2", cut if too long */
};

/* Add a page of the list of workers.  *next: the cursor of the next page, 0 at
 * the end.  RAD_EPROTO: the answer is missing (NULL) or not such a page. */
int roll_page(struct roll *r, const struct msg_answer *answer, uint64_t *next,
              struct rad_error *err);

#endif
