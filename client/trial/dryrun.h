/* dryrun.h - --dry-run: what a job would need, and how long it would take
 *
 * Thread: one. */
#ifndef RADD_CLIENT_DRYRUN_H
#define RADD_CLIENT_DRYRUN_H

#include "link/link.h"
#include "proto/message.h"
#include "trial/trial.h"

/* The cluster that would render the job. */
struct dryrun_cluster {
    bool embedded;
    int workers, threads; /* threads: of all these workers */
    int drained;          /* further workers, which get no work */
    int jobs;             /* jobs that the coordinator has already */
};

/* Ask a coordinator.  RAD_EUNAVAIL: it cannot be reached. */
int dryrun_ask(struct dryrun_cluster *c, const struct link_where *where,
               const struct target *to, struct rad_error *err);

/* The job that is predicted.  With --oversample frames have the size of what is
 * rendered. */
struct dryrun_job {
    const struct rad_scene *scene;
    struct rad_files files;
    const struct rad_params *params;
    const struct msg_frame *frames;
    uint32_t nframes;
    const struct rad_points *points; /* NULL: pictures */
    bool passes;                     /* its ambient cache is filled in passes */
    int oversample;                  /* as in struct rad_frame */
};

/* Trace some pixels of the scene and predict all frames of the job, or all of
 * its sensor points. */
int dryrun_predict(struct prediction *p, const struct dryrun_job *job,
                   struct rad_error *err);

/* Print for people.  quality: the number of --quality's word, if its whole set
 * is used; else -1. */
void dryrun_print(const struct msg_spec *spec, const struct prediction *p,
                  int quality, const struct dryrun_cluster *c);

/* Make JSON of the same, to be freed; NULL: memory is out.  options: how the
 * picture is written, by rad_filter_options(). */
char *dryrun_json(const struct msg_spec *spec, const char *options,
                  const struct prediction *p, const struct dryrun_cluster *c);

/* Statistics for a job with nothing to render, to be freed; NULL: memory is
 * out. */
char *dryrun_json_of_none(const struct msg_spec *spec);

#endif
