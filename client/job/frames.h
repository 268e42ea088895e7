/* frames.h - the pictures that a command line asks for
 *
 * One, or with -S one for each view line of a file; each line changes the view
 * before it, as in rpict(1).  Sizes are fitted to the view as rpict does.
 * Thread: one.  */
#ifndef RADD_CLIENT_FRAMES_H
#define RADD_CLIENT_FRAMES_H

#include "proto/message.h"
#include "job/submit_options.h"
#include "base/arena.h"

struct frames {
    struct rad_arena arena; /* of list, its views and their names */
    struct msg_frame *list; /* n of them */
    uint32_t n, room;
    uint32_t seen; /* views, those that --no-clobber leaves out among them */
    const char **names; /* of the views, for those of a .rif file; or NULL */
};

/* A view that has a name. */
struct frames_view {
    struct rad_view view;
    const char *name;
    uint32_t number; /* of the frame */
};

/* RAD_EUSAGE, RAD_EDATA for a bad view or none at all, RAD_ENOINPUT,
 * RAD_ENOMEM; *f can be released then too. */
int frames_init(struct frames *f, const struct submit_options *o,
                struct rad_error *err);

/* The one frame of sensor points, which has no view. */
int frames_init_points(struct frames *f, int width, int height,
                       struct rad_error *err);

/* The same from n views that have names. */
int frames_init_views(struct frames *f, const struct submit_options *o,
                      const struct frames_view *views, int n,
                      struct rad_error *err);

/* The file's name for a frame, by a pattern with %d for its number (-S) or %s
 * for its view's name; malloc'd.  RAD_EUSAGE for a pattern that lacks it. */
int frames_name(const struct frames *f, const struct submit_options *o,
                const char *pattern, uint32_t frame, char **name,
                struct rad_error *err);

void frames_release(struct frames *f);

#endif
