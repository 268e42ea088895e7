/* program.h - what radsubmit's files share: one run of it
 *
 *   radsubmit.c       the parts put together, from the command line to the end
 *   program_say.c     what a person is told meanwhile, on standard error
 *   program_files.c   what is written, and whether it can be
 *   program_planes.c  jobs of planes, where there are more than three bands
 *   program_stream.c  jobs of sensor points that come one after another
 *
 * main() owns the program, and all in it lives as long.
 * Thread: the main one; a scene is compiled on another, which has p->scene,
 * p->frames and p->err for itself until it is done. */
#ifndef RADD_CLIENT_PROGRAM_H
#define RADD_CLIENT_PROGRAM_H

#include "compile/compile.h"
#include "trial/foresee.h"
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
    bool embedded;         /* a cluster of radsubmit's own, ... */
    uint64_t began_ms;     /* ... which began then, by the loop's time */
    struct local *local;   /* its folder holds the scene's files in any case */
    struct launch *launch; /* NULL: its workers are local's */
};

struct program_loop { /* events, and signals among them */
    uv_loop_t uv;
    uv_signal_t signals[3];
    bool watched;   /* the above are in use */
    int interrupts; /* so far: 2 end the program at once */
};

struct program_stream { /* points one after another, and so their values */
    bool is;            /* else all points are one job's */
    struct pointstream input;
    uint64_t batch; /* its number, from 1 */
    struct pointwriter *writer;
    struct batches *sums; /* what all came to; program_stream.c */
};

struct program_planes {  /* of -cs, a job each */
    int n, at;           /* which is at work; n is 1: there are no planes */
    struct planes *jobs; /* program_planes.c; while these run */
};

struct program_result { /* of the job so far, or of all */
    double elapsed_s, error;
    struct program_goal {
        double estimate;       /* of the error; 0: not known; */
        double mean_estimate;  /* of the error of the mean of all points */
        int stages;            /* that it took; 0: there was no goal */
        bool time_up, rays_up; /* a further one was left out for want of time,
                                * or of rays that it may take */
    } goal;
    enum {
        LIGHT_UNSEEN,
        LIGHT_NONE,
        LIGHT_SOME
    } light; /* of pictures so far */
    struct msg_nan nan;
    struct msg_fault faults[MSG_FAULTS];
};

struct program_said { /* lest it be said again */
    bool held, paused, waiting, left;
    bool wonders;     /* nobody is at the job, and it is not said why */
    char reason[300]; /* the last that the coordinator gave; "": none */
    struct progress_alone alone;
    int stages; /* of a goal, that ended */
    int notes;  /* of the file of rad's variables */
};

struct program_preview {
    struct show_last last;
    bool warned;
    struct rad_error why; /* the last one was not written */
};

struct program_rescue { /* what came and could not be written, is there: */
    bool needed;
    char *picture, *depth; /* NULL: nowhere */
};

struct program {
    /* what is asked for */
    struct words words;
    struct submit_options o;
    struct rifjob rif; /* where the scene is a file of rad's variables */
    int own_stderr;    /* before -e */
    /* what is to be rendered */
    struct frames frames;
    struct pointjob points; /* --points: all, or a batch of them */
    struct program_stream stream;
    struct pointwriter_text text; /* beside the points' values */
    struct program_planes planes;
    struct compiled scene;
    double compile_s;
    struct records records; /* -af */
    struct cargo cargo;
    struct jobspec job;
    char part_name[MSG_MAX_LABEL + 1]; /* of the job of a plane or batch */
    struct prediction prediction;      /* --dry-run */
    /* by whom, and what comes of it */
    struct program_cluster cluster;
    struct program_loop loop;
    struct program_result result;
    struct program_preview preview;
    struct program_rescue rescue;
    /* what is said */
    struct progress progress;
    struct foresee *foresee; /* NULL: no trial was begun */
    struct program_said said;
    struct rad_error *err;
};

/* --- program_say.c --- */

/* A line on standard error; a warning only without -w-. */
void program_say(void *program, const char *text);
void program_warn(struct program *p, const char *text);

/* Before the job. */
void program_warn_of_psample(struct program *p);
void program_warn_of_scene(struct program *p);
/* What rad would do and this does not; each is said once. */
void program_warn_of_rif(struct program *p);

/* How far the job is (submit.h), and why nothing happens. */
void program_on_progress(void *program, const struct msg_progress *m);

/* At the end: pictures without any light, unless pixels that are no numbers say
 * why; pixels and functions that failed; the last line. */
void program_warn_of_dark(struct program *p);
void program_warn_of_nan(struct program *p);
void program_warn_of_faults(struct program *p);
void program_say_done(struct program *p);
/* The job's statistics, as JSON: what came of --error and --time. */
void program_note_goal(struct program_goal *g, const uint8_t *json, size_t len);

/* --- program_files.c --- */

/* Before anything is sent: can all be written, and read?  RAD_EUSAGE,
 * RAD_ECANTCREAT. */
int program_check_outputs(const struct program *p);
int program_check_ambient(struct program *p);

/* What comes of the job (submit.h). */
int program_on_preview(void *program, const uint8_t *picture, size_t len,
                       struct rad_error *err);
int program_on_frame(void *program, uint32_t frame, const uint8_t *picture,
                     size_t picture_len, const uint8_t *depth, size_t depth_len,
                     struct rad_error *err);
/* What is written beside the values of the job's points. */
void program_fill_text(struct program *p);
/* Values of sensor points. */
int program_write_points(struct program *p,
                         const struct pointwriter_light *light,
                         struct rad_error *err);
int program_write_stats_of_none(struct program *p);
int program_on_stats(void *program, const uint8_t *json, size_t len,
                     struct rad_error *err);

/* What could not be written is not lost. */
void program_say_where_it_is(const struct program *p);

/* --- program_planes.c --- */

/* The job, or its current plane, for the coordinator. */
void program_fill_spec(struct program *p);

/* As submit_run(), with p->planes.n jobs in place of one. */
int program_run_planes(struct program *p, const struct submit_job *job,
                       const struct submit_callbacks *cb);

/* --- program_stream.c --- */

/* Is a stream of points possible with these options?  RAD_EUSAGE.  Of its
 * first batch a frame of any size stands in p->frames. */
int program_check_stream(struct program *p);

/* The same for points that come one after another, a batch a job; the scene is
 * compiled and records are read. */
int program_run_stream(struct program *p, const struct submit_job *job,
                       const struct submit_callbacks *cb);

#endif
