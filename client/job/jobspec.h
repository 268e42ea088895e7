/* jobspec.h - a job's specification as the coordinator gets it, with all that
 * it points at
 *
 * The frames of an animation, and the costs of their lines, are a file of the
 * scene's bundle.
 * Thread: one. */
#ifndef RADD_CLIENT_JOBSPEC_H
#define RADD_CLIENT_JOBSPEC_H

#include "compile/cargo.h"
#include "compile/compile.h"
#include "job/frames.h"
#include "proto/message.h"
#include "job/submit_options.h"

#include "image/filter.h"

/* Begins zeroed. */
struct jobspec {
    struct msg_spec spec; /* valid after jobspec_fill() */
    uint8_t id[MSG_JOB], views[MSG_HASH];
    uint8_t scene[MSG_HASH], reuse[MSG_JOB];
    uint8_t *costs; /* of lines, from a former job; NULL: none */
    uint32_t ncosts;
    char params[RAD_PARAMS_TEXT];     /* rendering options, as text */
    char options[RAD_FILTER_OPTIONS]; /* the picture's, as text */
    char name[MSG_MAX_LABEL + 1];     /* cut to fit */
    char needs[MSG_MAX_NEEDS + 1];
    char origin[MSG_MAX_ORIGIN + 1];
};

/* Is an ambient cache filled in passes, if the options use one? */
bool jobspec_passes(const struct submit_options *o);

/* Choose a new id; RAD_EINTERNAL. */
int jobspec_name(struct jobspec *j, struct rad_error *err);

/* Read the costs if --estimate=FILE is given: RAD_ENOINPUT, RAD_EDATA,
 * RAD_ENOMEM. */
int jobspec_read_costs(struct jobspec *j, const struct submit_options *o,
                       const struct frames *frames, struct rad_error *err);

/* If there are several frames, write them into a file of the scene's bundle, in
 * that folder.  Call after jobspec_read_costs().  RAD_EUSAGE: they take too
 * many bytes; RAD_ENOMEM; errors of compile_add(). */
int jobspec_add_frames(struct jobspec *j, const struct frames *frames,
                       struct compiled *scene, const char *folder,
                       struct rad_error *err);

/* Set the scene's hash and the job whose ambient cache this job begins with.
 * Call before any file is added to the scene's own.  RAD_EUSAGE: the options
 * use no cache; RAD_ENOMEM. */
int jobspec_set_scene(struct jobspec *j, const struct submit_options *o,
                      const struct compiled *scene, struct rad_error *err);

/* RAD_EUSAGE: there is a goal (--error, --time), and too many frames for one.
 */
int jobspec_check_goal(const struct submit_options *o, uint32_t nframes,
                       struct rad_error *err);

/* RAD_EUSAGE: all frames together have too many --windows. */
int jobspec_check_windows(const struct submit_options *o,
                          const struct frames *frames, struct rad_error *err);

/* Fill in all other fields but compile_s and MSG_JOB_RECORDS.  All arguments
 * must outlive *j. */
void jobspec_fill(struct jobspec *j, const struct submit_options *o,
                  const struct frames *frames, const struct compiled *scene,
                  const struct cargo *cargo);

void jobspec_release(struct jobspec *j);

#endif
