/* dryrun.h - --dry-run: what a job would need and take
 *
 * Thread: one.  */
#ifndef RADD_CLIENT_DRYRUN_H
#define RADD_CLIENT_DRYRUN_H

#include "link/link.h"
#include "proto/message.h"
#include "trial/trial.h"

/* Where it would render. */
struct dryrun_cluster {
    bool embedded;
    int workers, threads; /* threads of all */
    int jobs;             /* that it has already */
};

/* Ask a coordinator.  RAD_EUNAVAIL where there is none. */
int dryrun_ask(struct dryrun_cluster *c, const struct link_where *where,
               const struct target *to, struct rad_error *err);

/* What --dry-run takes to say what it does. */
extern const struct trial_effort dryrun_effort;

/* Try the scene's pixels and predict all frames of the job, in samples: with
 * --oversample those are the large picture's; or the sensor points, unless
 * `points` is NULL. */
int dryrun_predict(struct prediction *p, const struct rad_scene *scene,
                   const struct rad_files *files,
                   const struct rad_params *params,
                   const struct msg_frame *frames, uint32_t nframes,
                   const struct rad_points *points,
                   const struct trial_effort *effort, struct rad_error *err);

/* For people, on stdout.  quality: the number of --quality's word, where all of
 * its set holds, else -1. */
void dryrun_print(const struct msg_spec *spec, const struct prediction *p,
                  int quality, const struct dryrun_cluster *c);

/* The same as JSON, to be freed; NULL: out of memory.  options are those of
 * the picture that is written (rad_filter_options()). */
char *dryrun_json(const struct msg_spec *spec, const char *options,
                  const struct prediction *p, const struct dryrun_cluster *c);

/* Statistics where there was nothing to render, to be freed; NULL: out of
 * memory. */
char *dryrun_json_of_none(const struct msg_spec *spec);

#endif
