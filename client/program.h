/* program.h - what radsubmit's files share: one run of the program
 *
 *   radsubmit.c       the course of a run, from the command line to the end
 *   program_say.c     messages to the user, on standard error
 *   program_files.c   the files that are written, and checks of them
 *   program_planes.c  jobs of planes, for more than three bands
 *   program_stream.c  jobs of sensor points that come on a pipe
 *
 * main() owns the program, and all in it lives as long.
 * Thread: the main one.  A scene is compiled on another thread, which has
 * p->scene, p->frames and p->err for itself until it is done. */
#ifndef RADD_CLIENT_PROGRAM_H
#define RADD_CLIENT_PROGRAM_H

#include "compile/compile.h"
#include "trial/foresee.h"
#include "trial/outcome.h"
#include "job/frames.h"
#include "job/jobspec.h"
#include "points/pointjob.h"
#include "points/pointstream.h"
#include "points/pointwriter.h"
#include "trial/progress.h"
#include "records/records.h"
#include "rif/rifjob.h"
#include "job/submit_options.h"
#include "link/submit.h"
#include "link/target.h"
#include "trial/trial.h"

#include <uv.h>

struct program_cluster { /* where the job is rendered */
    struct target target;
    bool embedded;         /* a cluster of radsubmit's own */
    uint64_t began_ms;     /* when that was started, in the loop's time */
    struct local *local;   /* its folder always has the scene's files */
    struct launch *launch; /* NULL: the workers are local's */
};

struct program_loop { /* the event loop, with signals */
    uv_loop_t uv;
    uv_signal_t signals[3];
    bool watched;   /* uv and signals are in use */
    int interrupts; /* so far; 2 end the program at once */
};

struct program_stream { /* sensor points on a pipe */
    bool is;            /* else all points are one job's */
    struct pointstream input;
    uint64_t batch; /* number of the batch, from 1 */
    struct pointwriter *writer;
    struct batches *sums; /* sums of all batches (program_stream.c) */
};

struct program_planes {  /* of -cs; each is a job */
    int n, at;           /* at: the current plane; n 1: there are no planes */
    struct planes *jobs; /* while they run (program_planes.c) */
};

struct program_result {
    struct outcome job;     /* the current job's, so far */
    struct outcome_sum sum; /* of the jobs that have ended */
    struct program_goal {
        double estimate;      /* of the relative error; 0: not known */
        double mean_estimate; /* of the relative error of all points' mean */
        int stages;           /* number of stages; 0: there was no goal */
        bool time_up, rays_up, stages_up; /* what another stage has not got */
        bool by_clock; /* the time that was left chose options */
    } goal;
    enum { LIGHT_UNSEEN, LIGHT_NONE, LIGHT_SOME } light; /* in the pictures */
};

struct program_said { /* so that nothing is said twice */
    bool held, paused, waiting, left;
    bool begun;       /* a worker was at the job, or work of it is done */
    bool wonders;     /* no worker is at the job, and no reason is known */
    char reason[300]; /* last reason from the coordinator; "": none */
    struct progress_alone alone;
    int stages; /* stages of a goal that have ended */
    int notes;  /* notes about the .rif file */
};

struct program_preview {
    struct show_last last;
    bool warned;
    struct rad_error why; /* code 0, or why the last preview was not written */
};

struct program_rescue { /* results that could not be written to their place: */
    bool needed;
    char *picture, *depth; /* paths where they are; NULL: nowhere */
};

struct program {
    /* what is asked for */
    struct words words;
    struct submit_options o;
    struct rifjob rif; /* if the scene is a file of rad's variables */
    int own_stderr;    /* a copy of it, before -e */
    /* what is rendered */
    struct frames frames;
    struct pointjob points; /* --points: of the job, or of the current batch */
    struct program_stream stream;
    struct pointwriter_text text; /* for the header of points' values */
    struct program_planes planes;
    struct compiled scene;
    double compile_s;
    struct records records; /* -af */
    struct cargo cargo;
    struct jobspec job;
    char part_name[MSG_MAX_LABEL + 1]; /* name of the job of a plane or batch */
    struct prediction prediction;      /* --dry-run */
    /* the cluster and the results */
    struct program_cluster cluster;
    struct program_loop loop;
    struct program_result result;
    struct program_preview preview;
    struct program_rescue rescue;
    /* messages */
    struct progress progress;
    struct foresee *foresee; /* NULL: no trial was begun */
    struct program_said said;
    struct rad_error *err;
};

/* --- program_say.c --- */

/* Print a line on standard error: news unless this is in the place of rpict or
 * rtrace, which have none without -t; a warning unless -w- is given. */
void program_say(void *program, const char *text);
void program_news(struct program *p, const char *text);
void program_warn(struct program *p, const char *text);
void program_warn_of_psample(struct program *p);
/* Frames of --no-clobber whose exposure is not that of the frames there. */
void program_warn_of_rest(struct program *p);
void program_warn_of_scene(struct program *p);
/* Tell what rad would do and radsubmit does not, each note once. */
void program_warn_of_rif(struct program *p);

/* Show a report of progress (submit.h), and say what holds the job up. */
void program_on_progress(void *program, const struct msg_progress *m);

/* At the end of each job: warn of pixels that were no numbers, and sum up. */
void program_end_job(struct program *p);
/* At the end of all: warn of pictures that are all black without bad pixels, of
 * functions that failed.  Then the last line. */
void program_warn_of_dark(struct program *p);
void program_warn_of_faults(struct program *p);
void program_say_done(struct program *p);
/* Take from the job's statistics, JSON, what --error or --time have reached. */
void program_note_goal(struct program_goal *g, const uint8_t *json, size_t len);

/* --- program_files.c --- */

/* Check that all outputs can be written, and the -af file read, before anything
 * is sent.  RAD_EUSAGE, RAD_ECANTCREAT. */
int program_check_outputs(const struct program *p);
int program_check_ambient(struct program *p);

/* Take results of the job (submit.h). */
int program_on_preview(void *program, const uint8_t *picture, size_t len,
                       struct rad_error *err);
int program_on_frame(void *program, uint32_t frame, const uint8_t *picture,
                     size_t picture_len, const uint8_t *depth, size_t depth_len,
                     struct rad_error *err);
/* Set p->text, for the header of the points' values. */
void program_fill_text(struct program *p);
/* Write the values of sensor points. */
int program_write_points(struct program *p,
                         const struct pointwriter_light *light,
                         struct rad_error *err);
int program_write_stats_of_none(struct program *p);
int program_on_stats(void *program, const uint8_t *json, size_t len,
                     struct rad_error *err);

/* Tell where results are that could not be written to their place. */
void program_say_where_it_is(const struct program *p);

/* --- program_planes.c --- */

/* Fill in the specification of the job, or of the job of the current plane. */
void program_fill_spec(struct program *p);

/* As submit_run(), for the jobs of all planes. */
int program_run_planes(struct program *p, const struct submit_job *job,
                       const struct submit_callbacks *cb);

/* --- program_stream.c --- */

/* RAD_EUSAGE: these options do not go with points on a pipe.  Puts a frame of
 * any size into p->frames for the first batch. */
int program_check_stream(struct program *p);

/* As submit_run(), with a job for each batch of points.  The scene must be
 * compiled and records be read. */
int program_run_stream(struct program *p, const struct submit_job *job,
                       const struct submit_callbacks *cb);

#endif
