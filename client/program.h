/* program.h - what radsubmit's files share: one run of the program
 *
 *   radsubmit.c         the course of a run, from the command line to the end
 *   program_loop.c      the event loop and signals
 *   program_scene.c     the scene, compiled from the user's files
 *   program_cluster.c   the cluster that renders, also one of radsubmit's own
 *   program_job.c       a job, from its scene to its last picture
 *   program_planes.c    jobs of planes, for more than three bands
 *   program_stream.c    jobs of sensor points that come on a pipe
 *   program_files.c     the files that are written, and checks of them
 *   program_say.c       messages to the user, on standard error
 *
 * main() owns the program, and all in it lives as long.
 * Thread: the main one (but see program_scene.h). */
#ifndef RADD_CLIENT_PROGRAM_H
#define RADD_CLIENT_PROGRAM_H

#include "compile/compile.h"
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
#include "trial/surroundings.h"
#include "trial/trial.h"
#include "program_loop.h"

struct program_cluster { /* where the job is rendered */
    struct target target;
    bool embedded;         /* a cluster of radsubmit's own */
    uint64_t began_ms;     /* when that was started, in the loop's time */
    struct local *local;   /* its folder always has the scene's files */
    struct launch *launch; /* NULL: the workers are local's */
};

struct program_stream { /* sensor points on a pipe */
    bool is;            /* else all points are one job's */
    struct pointstream input;
    uint64_t batch; /* number of the batch, from 1 */
    struct pointwriter *writer;
    struct batches *sums; /* sums of all batches (program_stream.c) */
};

struct program_planes {  /* of -cs; each is a job */
    int n, at;           /* at: the current plane; n 0: light is red, green and
                          * blue, or of one plane that was asked for */
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
    int own_stderr;    /* a copy of it, once the file of -e is open, */
    off_t errors_before; /* which had so many bytes */
    /* what is rendered */
    struct frames frames;
    struct pointjob points; /* --points: of the job, or of the current batch */
    struct program_stream stream;
    struct pointwriter_text text; /* for the header of points' values */
    struct program_planes planes;
    struct compiled scene;
    double compile_s;
    struct surroundings surroundings; /* zeros: not looked for */
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
    struct program_said said;
    struct rad_error *err;
};

/* The number of jobs that make the pictures. */
static inline int
program_jobs(const struct program *p)
{
    return p->planes.n > 1 ? p->planes.n : 1;
}

/* What radctl fetch needs for the picture of a plane that was asked for by
 * itself; NULL: none was. */
static inline const char *
program_lone_plane(const struct program *p)
{
    const struct rad_bands *b = &p->o.params.bands;

    return p->planes.n == 0 && !rad_bands_are_rgb(b) && !rad_bands_many(b)
               ? " --plane"
               : NULL;
}

#endif
