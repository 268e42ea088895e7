/* job.h - what the coordinator knows about one job
 *
 * Plain data.  Units are numbers of the job's partition; a worker of the job
 * keeps its index for the job's life, so that what it did stays counted.
 * Thread: one. */
#ifndef DAEMON_JOB_H
#define DAEMON_JOB_H

#include "base/arena.h"
#include "jobs/frame.h"
#include "jobs/goal.h"
#include "jobs/kept.h"
#include "jobs/part.h"
#include "jobs/progress.h"
#include "jobs/unit.h"
#include "partition/partition.h"
#include "jobs/shared.h"

struct coord_owner;
struct coord_worker;
struct passes;
struct links;
struct stats_text;
struct steps;
struct survey;

/* As in msg_progress; drawn at the head of job.c. */
enum job_state {
    JOB_WAITING, /* not stored whole yet, or no unit went out yet */
    JOB_RUNNING,
    JOB_PAUSED,
    JOB_DONE,
    JOB_FAILED,
    JOB_CANCELLED
};

/* How far the store is with a job; drawn there, too. */
enum job_stage {
    STAGE_ARRIVING, /* files of it are yet to come */
    STAGE_OPENING,  /* the store was asked for room for its rows */
    STAGE_NO_ROOM,  /* the store waits for that room: text says why */
    STAGE_OPEN,     /* bundle and room for rows are there */
    STAGE_KEPT,     /* it is over, and the store has its statistics */
    STAGE_FILED     /* but for its end and its frames only the store knows it */
};
#define JOB_STAGES 6

/* A unit fails its job when it brought down the children of two workers, or,
 * where there is but one worker, that worker's child this often. */
#define JOB_MAX_CRASHES 3

/* A worker that loses its child so often in a row, for reasons of its own (its
 * memory, its disk, somebody who kills it), has no more part in the job. */
#define JOB_MAX_SETBACKS 5
#define JOB_DURATIONS    63 /* that are remembered */

/* Changed by speed.c. */
struct job_speed {
    uint32_t threads; /* of all workers that are ready */
    double all;       /* speeds of all workers that are there */
    double pace;      /* cost done in a ms, for a speed of 1; 0: not known */
    double finished;  /* cost finished or traced ahead, of all attempts */
    double workload;  /* ms of all workers, times their speed */
    uint32_t took_ms[JOB_DURATIONS]; /* of the last units that were done */
    uint32_t ntook;                  /* how many there were in all */
};

struct job {
    uint8_t id[MSG_JOB];
    char hex[MSG_JOB_HEX];
    char owner[MSG_MAX_NAME + 1];
    struct msg_spec spec;    /* all it points at lies in mem */
    uint64_t frames_counted; /* see job_count_frames() */
    struct rad_arena mem;
    uint64_t sequence; /* order of submission */
    enum job_state state;
    bool ending;          /* over, and what follows is to be done (verdict.h) */
    enum job_stage stage; /* by job_step() alone */
    bool full; /* the disk is full: this job is held, as all others are */
    bool watched;         /* a picture was asked for before it was whole */
    uint32_t lives;       /* of the coordinator that it has seen end */
    bool restored; /* from an earlier life, and no worker was ready since */
    struct stats_text *filing; /* its statistics, on their way to the store */
    struct msg_progress last;  /* with STAGE_FILED */
    uint64_t kept_bytes;       /* on the disk, once it is over */
    uint32_t unfetched;        /* frames that are written, and not fetched */
    uint64_t fetched_ms; /* when its owner last got one in this life; or 0 */
    uint32_t nfound;     /* its first files that the store was seen to have */
    uint64_t found_ms;   /* when the last of these files was seen */
    int status;          /* of sysexits.h, with JOB_FAILED */
    char text[MSG_MAX_TEXT + 1];

    struct partition *partition; /* NULL until the first worker is ready */
    struct job_unit *units;      /* partition_total of them */
    uint32_t nunits;
    uint32_t *out; /* units that are out; the last takes the place of one that
                    * leaves, so whoever may end attempts goes backwards */
    uint32_t nout;
    uint32_t late; /* units that are out for too long, and may have twins */
    struct coord_owner *payer; /* the user whose job it is */
    uint32_t served; /* coord.serving of the last search that asked this job */
    struct kept_passes kept;
    struct kept_cache cache;
    struct passes *passes; /* NULL: none, or not yet */
    bool exact;            /* it has no ambient cache, or one in passes */
    bool filling;          /* some of its passes are not closed */
    struct job_goal goal;  /* zeros: it has none */
    struct survey *survey; /* NULL: costs are not estimated, or are by now */
    struct shared *shared; /* NULL: lines are not shared */
    struct links *links; /* linking.h; NULL: each worker is linked with all, or
                          * none is */
    uint64_t base_line_bytes; /* that the coordinator sent */
    uint64_t late_rays;       /* facts of lines that were done, or came again */
    uint32_t *suspects; /* units that crashed a child: out of the partition's
                         * queue, each to go to another worker alone */
    uint32_t nsuspects;
    struct job_frame *frames;
    uint32_t frames_ready; /* the first so many are written */
    struct job_worker *workers;
    uint32_t nworkers;
    uint32_t *index, nindex; /* in workers, by coord_worker.id */
    struct job_speed speed;

    uint32_t units_done, units_redone;
    uint64_t pixels_done, pixels_total;
    double cost_done, cost_total; /* of units */
    struct progress_lead lead;
    uint64_t rays;              /* of units that are done */
    uint64_t estimate_ms;       /* that the estimate took */
    struct msg_counts surveyed; /* by the estimate */
    struct msg_counts tiled;    /* by the tiles of passes (passes.c) */
    uint64_t rays_seen;   /* of units done, under way and lost; only grows */
    uint64_t pixels_seen; /* pixels_done, and those that units under way are
                           * past; only grows, and never to all */
    struct msg_nan nan;   /* frame: its number */
    struct msg_fault faults[MSG_FAULTS];
    struct msg_doubt doubt; /* of units that are done */
    uint64_t sent_bytes;    /* of the bundle, by radsubmit */
    uint64_t offer_ms;      /* its radsubmit began to send */
    uint64_t submit_ms;     /* SUBMIT came */
    uint64_t open_ms;       /* accepted */
    uint64_t first_ms;      /* first unit went out; 0: none yet */
    uint64_t last_ms;       /* last row was kept */
    uint64_t end_ms;
};

/* A job's frames, as the limit of a user's counts them: in many windows a frame
 * counts as one for each four that were asked for, as far as it has pixels, and
 * as one for each 1024 rows: windows and lines are what takes memory. */
uint64_t job_count_frames(const struct msg_spec *spec);
/* How many of the jobs that are kept it counts as: it holds memory until it is
 * forgotten, about 1 MiB for each 400 frames so counted, and from
 * job_lighten() on 80 KiB for each 400 frames. */
uint32_t job_weight(const struct job *job);

/* Copies what spec lends.  NULL: memory is out. */
struct job *job_new(const struct msg_spec *spec, const char *owner);

/* Pixels of the first frame as written, and samples a side of each. */
struct job_size {
    uint32_t width, height, oversample;
};
struct job_size job_size(const struct job *job);

/* Channels of the rows that its workers send, as a RESULT has them. */
uint8_t job_channels(const struct job *job);
void job_free(struct job *job);

/* Of a job that is over keep how it ended (job.last, which is set), and which
 * of its frames there are; the store tells the rest. */
void job_lighten(struct job *job);

/* Is it over, one way or the other? */
bool job_over(const struct job *job);
/* Which state may follow which; see the head of job.c. */
extern const struct steps job_stages;
/* The job is in another stage from here on, which must be permitted. */
void job_step(struct job *job, enum job_stage to);

/* Does it get no units for want of room on the disk? */
bool job_held(const struct job *job);

const char *job_state_name(enum job_state state); /* "running" */
const char *job_is(const struct job *job);        /* the same, or "held" */

/* How a job is to be split, but for single and the values of costs; RAD_EDATA
 * when its options are no options. */
int job_partition_spec(const struct msg_spec *from, struct partition_spec *spec,
                       struct rad_error *err);

/* Lay out the units; single as in partition_spec. */
int job_split(struct job *job, bool single, struct rad_error *err);

/* Units that may go out: waiting ones and suspects. */
uint32_t job_waiting(const struct job *job);

/* Workers that were told of the job and are still there. */
uint32_t job_active(const struct job *job);

#endif
