/* jobspec.h - a job as the coordinator is told of it, and what that points at
 *
 * Of an animation the frames, and what their lines cost, travel as one more
 * file of the scene.
 * Thread: one. */
#ifndef RADD_CLIENT_JOBSPEC_H
#define RADD_CLIENT_JOBSPEC_H

#include "compile/cargo.h"
#include "compile/compile.h"
#include "job/frames.h"
#include "proto/message.h"
#include "job/submit_options.h"

#include "image/filter.h"

/* Zeroed at first. */
struct jobspec {
    struct msg_spec spec; /* once it is filled */
    uint8_t id[MSG_JOB], views[MSG_HASH];
    uint8_t scene[MSG_HASH], reuse[MSG_JOB];
    uint8_t *costs; /* of lines, from a former run; NULL: none */
    uint32_t ncosts;
    char params[RAD_PARAMS_TEXT];     /* of what is rendered, */
    char options[RAD_FILTER_OPTIONS]; /* and of what is written */
    char needs[MSG_MAX_NEEDS + 1];
    char origin[MSG_MAX_ORIGIN + 1];
};

/* A new id; RAD_EINTERNAL. */
int jobspec_name(struct jobspec *j, struct rad_error *err);

/* Read the costs of --estimate=FILE, if that is asked for: RAD_ENOINPUT,
 * RAD_EDATA, RAD_ENOMEM. */
int jobspec_read_costs(struct jobspec *j, const struct submit_options *o,
                       const struct frames *frames, struct rad_error *err);

/* Of several frames make a file of the scene, in that folder; after the costs.
 * RAD_EUSAGE when they take too much; RAD_ENOMEM, and as compile_add(). */
int jobspec_add_frames(struct jobspec *j, const struct frames *frames,
                       struct compiled *scene, const char *folder,
                       struct rad_error *err);

/* Which scene it is, and the job whose ambient cache it begins with; before
 * anything but its files is added to the scene.  RAD_EUSAGE: it has no such
 * cache; RAD_ENOMEM. */
int jobspec_set_scene(struct jobspec *j, const struct submit_options *o,
                      const struct compiled *scene, struct rad_error *err);

/* Is there a goal (--error, --time) for that many frames?  RAD_EUSAGE. */
int jobspec_check_goal(const struct submit_options *o, uint32_t nframes,
                       struct rad_error *err);

/* All else but compile_s and MSG_JOB_RECORDS; what it points at must outlive
 * it. */
void jobspec_fill(struct jobspec *j, const struct submit_options *o,
                  const struct frames *frames, const struct compiled *scene,
                  const struct cargo *cargo);

void jobspec_release(struct jobspec *j);

#endif
