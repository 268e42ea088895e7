/* frames.h - the pictures that a command line asks for
 *
 * One, or with -S one for each view line of a file; each line changes the view
 * before it, as in rpict(1).  Sizes are fitted to the view as rpict does.
 * Thread: one.  */
#ifndef RADD_CLIENT_FRAMES_H
#define RADD_CLIENT_FRAMES_H

#include "message.h"
#include "submit_options.h"

struct frames {
    struct rad_arena arena; /* of list and its views */
    struct msg_frame *list; /* n of them */
    uint32_t n, room;
};

/* RAD_EUSAGE, RAD_EDATA for a bad view or none at all, RAD_ENOINPUT,
 * RAD_ENOMEM; *f can be released then too. */
int frames_init(struct frames *f, const struct submit_options *o,
                struct rad_error *err);
void frames_release(struct frames *f);

#endif
