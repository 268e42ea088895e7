/* frames.h - the pictures that a command line asks for
 *
 * One picture; or with -S one for each view line of a file, where each line
 * changes the view before it, as in rpict(1).  Sizes are fitted to the view as
 * rpict does.
 * Thread: one. */
#ifndef RADD_CLIENT_FRAMES_H
#define RADD_CLIENT_FRAMES_H

#include "proto/message.h"
#include "job/submit_options.h"
#include "base/arena.h"

struct frames {
    struct rad_arena arena; /* has the views and their names */
    struct msg_frame *list; /* n of them */
    uint32_t n;
    uint32_t seen; /* views, including those that --no-clobber leaves out */
    const char **names; /* of the views of a .rif file; else NULL */
};

/* A view of a .rif file. */
struct frames_view {
    struct rad_view view;
    const char *name;
    uint32_t number; /* of its frame */
};

/* Make the frames.  RAD_EUSAGE; RAD_EDATA: a malformed view, or none at all;
 * RAD_ENOINPUT; RAD_ENOMEM.  *f can be released in any case. */
int frames_init(struct frames *f, const struct submit_options *o,
                struct rad_error *err);

/* The one frame of sensor points, which has no view. */
int frames_init_points(struct frames *f, int width, int height,
                       struct rad_error *err);

/* Make a frame for each of n named views; errors as of frames_init(). */
int frames_init_views(struct frames *f, const struct submit_options *o,
                      const struct frames_view *views, int n,
                      struct rad_error *err);

/* The name of a frame's file, malloc'd: pattern with %d replaced by its number
 * (-S) or %s by its view's name.  RAD_EUSAGE: the pattern needs one and has
 * none. */
int frames_name(const struct frames *f, const struct submit_options *o,
                const char *pattern, uint32_t frame, char **name,
                struct rad_error *err);

void frames_release(struct frames *f);

#endif
