/* job.h - what the coordinator knows about one job
 *
 * Plain data.  A unit is known by its number in the job's partition, a worker
 * by the index of its part in job.parts, until the job is forgotten.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_JOB_H
#define DAEMON_JOB_H

#include "base/arena.h"
#include "jobs/frame.h"
#include "jobs/goal.h"
#include "jobs/kept.h"
#include "jobs/life.h"
#include "jobs/part.h"
#include "jobs/progress.h"
#include "jobs/unit.h"
#include "partition/partition.h"
#include "jobs/shared.h"

struct coord_owner;
struct passes;
struct links;
struct stats_text;
struct survey;

/* A unit fails its job when it brought down children of two workers, or, of a
 * single worker, this many. */
#define JOB_MAX_CRASHES 3

/* A worker that loses this many children in a row for reasons of its own (its
 * memory, its disk, somebody who kills them) is excluded from the job. */
#define JOB_MAX_SETBACKS 5
#define JOB_DURATIONS    63 /* durations of units that are remembered */

/* Changed by speed.c. */
struct job_speed {
    uint32_t threads; /* threads of all workers that are ready */
    double all;       /* sum of the speeds of workers that load or are ready */
    double pace;      /* cost that a speed of 1 works off in a ms; 0: unknown */
    double
        finished; /* cost of units finished or traced ahead, of all attempts */
    double workload; /* sum over workers of work time [ms] times speed */
    uint32_t took_ms[JOB_DURATIONS]; /* ring: how long the last units took */
    uint32_t ntook;                  /* durations written to the ring so far */
};

struct job {
    uint8_t id[MSG_JOB];
    char hex[MSG_JOB_HEX];
    char owner[MSG_MAX_NAME + 1];
    struct msg_spec spec;    /* its pointers lead into mem */
    uint64_t frames_counted; /* see job_count_frames() */
    struct rad_arena mem;
    uint64_t sequence; /* order of submission */
    uint8_t rank;      /* enum order_rank (desk/order.h) */
    struct job *chain; /* next in its chain of coord.by_job */
    enum job_state state; /* changed by life.c alone */
    bool ending;          /* the verdict is yet to be carried out (verdict.h) */
    enum job_place place; /* changed by life_move() alone */
    bool full;            /* the disk is full, so the job is held */
    bool watched;         /* a preview was asked for */
    uint32_t lives;       /* lives of the coordinator that the job outlived */
    bool restored; /* an earlier life laid its units out; no worker came yet */
    struct stats_text *filing; /* statistics under way to the store, or NULL */
    struct msg_progress last;  /* the last PROGRESS; set in PLACE_FILED */
    uint64_t kept_bytes; /* size of the job's folder; set once it is over */
    uint32_t unfetched;  /* frames that are written and not fetched */
    uint64_t fetched_ms; /* when a file was last sent in this life; or 0 */
    uint32_t nfound;     /* the first nfound files were seen in the store */
    uint64_t found_ms;   /* when the last of these files was seen */
    int status;          /* of sysexits.h, in JOB_FAILED */
    char text[MSG_MAX_TEXT + 1]; /* why it failed or is held */
    struct partition *partition; /* NULL until the first worker is ready */
    struct job_unit *units;      /* by their numbers in the partition */
    uint32_t nunits;
    uint32_t *out; /* units that are out; when a unit leaves the last takes its
                    * place, so a loop that may end attempts counts down */
    uint32_t nout;
    uint32_t late; /* units that are out for too long, and may have twins */
    struct coord_owner *payer; /* at whose limits the job counts */
    uint32_t served; /* coord.serving of the last search that asked this job */
    struct kept_passes kept;
    struct kept_cache cache;
    struct passes *passes; /* NULL: no passes, or not yet */
    bool exact; /* no ambient cache, or in passes: pixels follow from the job */
    bool filling;          /* some of its passes are not closed */
    struct job_goal goal;  /* zeros: no goal */
    struct survey *survey; /* NULL: costs are not estimated, or all are */
    struct shared *shared; /* NULL: lines are not shared */
    struct links *links;   /* linking.h; NULL: none was made when needed */
    uint64_t base_line_bytes; /* of base lines that the coordinator sent */
    uint64_t late_rays;       /* facts that came twice, or too late */
    uint32_t *suspects; /* units that crashed a child; out of the partition's
                         * queue, for workers that have nothing else */
    uint32_t nsuspects;
    struct job_frame *frames;
    uint32_t frames_ready; /* frames written, from the first without a gap */
    struct job_part *parts; /* of workers, as they came to the job */
    uint32_t nparts;
    uint32_t *index, nindex; /* places in parts, by coord_worker.id */
    struct job_speed speed;
    uint32_t units_done, units_redone;
    uint64_t pixels_done, pixels_total;
    double cost_done, cost_total; /* of units, as the partition has costs */
    struct progress_filled filled;
    struct progress_pace pace;
    uint64_t rays;              /* of units that are done */
    uint64_t estimate_ms;       /* how long the estimate took */
    struct msg_counts surveyed; /* counts of the estimate */
    struct msg_counts tiled;    /* counts of the passes' tiles (passes.c) */
    uint64_t rays_seen;   /* of units done, under way and lost; only grows */
    uint64_t pixels_seen; /* pixels_done, and pixels that units under way have
                           * passed; only grows, and stays below pixels_total */
    struct msg_nan nan;   /* its frame is the frame's number in the animation */
    struct msg_fault faults[MSG_FAULTS];
    struct msg_doubt doubt; /* of units that are done */
    uint64_t sent_bytes;    /* of the bundle, sent by radsubmit */
    uint64_t offer_ms;      /* radsubmit began to send files */
    uint64_t submit_ms;     /* SUBMIT came */
    uint64_t open_ms;       /* the job was accepted */
    uint64_t first_ms;      /* the first tile or unit went out; 0: not yet */
    uint64_t last_ms;       /* the last row was kept */
    uint64_t end_ms, over_ms; /* the job was over; that as a date (desk.h) */
};

/* The frames of a job, as a user's limit counts them.  A frame counts once for
 * each 4 windows that were asked for (never more than it has pixels), or once
 * for each 1024 rows if that is more, for windows and lines take the memory. */
uint64_t job_count_frames(const struct msg_spec *spec);
/* How many jobs the job counts as while it is remembered: 1, and 1 more for
 * each 400 counted frames: about 1 MiB, or 80 KiB after job_lighten(). */
uint32_t job_weight(const struct job *job);

/* Make a job; copies all that spec points at.  NULL: memory is out. */
struct job *job_new(const struct msg_spec *spec, const char *owner);

/* Pixels of the first frame's picture, and samples along a pixel's side. */
struct job_size {
    uint32_t width, height, oversample;
};
struct job_size job_size(const struct job *job);

/* Channels of the rows that the job's workers send, as in a RESULT. */
uint8_t job_channels(const struct job *job);
void job_free(struct job *job);

/* Free units, partition, lines and parts of a job that is over.  Its end
 * (job.last, which the caller has set) and its frames' states stay. */
void job_lighten(struct job *job);

/* Is the job done, failed or cancelled? */
bool job_over(const struct job *job);

/* Does the job get no units because the disk is full? */
bool job_held(const struct job *job);

const char *job_state_name(enum job_state state); /* "running" */
const char *job_is(const struct job *job);        /* its state, or "held" */

/* Set *spec, but for its field costs (the values), by the job's
 * specification.  RAD_EDATA: its rendering options are wrong. */
int job_partition_spec(const struct msg_spec *from, struct partition_spec *spec,
                       struct rad_error *err);

/* Cut the job into units. */
int job_split(struct job *job, struct rad_error *err);

/* The number of units that may go out: those that wait, and suspects. */
uint32_t job_waiting(const struct job *job);

/* The number of workers that load the job or are ready. */
uint32_t job_active(const struct job *job);

#endif
