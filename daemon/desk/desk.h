/* desk.h - what the coordinator knows, and what all of its files look up, ask
 * and say
 *
 * These structs, and those of a job (jobs/job.h), are changed by the files of
 * the floors above; a struct that one file alone changes names it.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_DESK_H
#define DAEMON_DESK_H

#include "desk/account.h"
#include "desk/env.h"
#include "jobs/job.h"
#include "net/log.h"
#include "users/uploads.h"

/* A worker that is, or was, connected.  What it may get follows from conn,
 * drained, leaving, alone and hangs (desk_takes_units()); what it does in each
 * job is its part there (part.h), each attempt at a unit a go (go.h). */
struct coord_worker {
    struct coord_worker *next;
    char name[MSG_MAX_NAME + 1];
    char program[MSG_MAX_NAME + 1];
    char address[MSG_MAX_ADDRESS + 1]; /* where peers dial it */
    uint64_t conn;                     /* 0: not connected */
    uint32_t threads;
    unsigned version; /* of the protocol that it speaks */
    uint64_t fingerprint;
    uint64_t since_ms;    /* connected, or gone, since */
    uint32_t id;          /* from 0, by the order of their first HELLO */
    uint32_t in_flight;   /* units of all jobs that it works on */
    uint32_t parked;      /* units that wait for something (go.h) */
    uint32_t delivered;   /* units whose rows are on their way to the disk */
    double relative;      /* speed of a thread, by earlier jobs; 1: usual */
    uint64_t free_ms;     /* when in_flight last came to be 0 */
    int64_t priority;     /* the highest of the jobs whose units it works on;
                           * INT64_MIN: of none */
    int64_t rank;         /* the same, with jobs that have units for it */
    uint32_t load;        /* of its host, in hundredths, by its last PING */
    uint64_t progress;    /* the number that the last PING had */
    uint64_t progress_ms; /* when that number was new */
    bool hangs;           /* it has work, and makes no progress */
    const struct job *loading; /* what its next READY is for */
    bool forgotten;            /* gone, and not told of any more */
    bool drained;              /* gets nothing new: an admin's wish */
    bool leaving;              /* gets nothing new: its own wish */
    bool alone;        /* has a unit that crashed once: nothing beside it */
    char no_room[256]; /* why it could not take a job last (job_worker) */
};

struct coord_settling;
struct coord_telling;

/* Is the connection to end, when the event is over (verdict.h)? */
enum coord_verdict {
    CONN_STAYS,
    CONN_BREAKS, /* it broke the rules */
    CONN_PARTS   /* both sides know that it ends */
};

struct coord_conn {
    struct coord_conn *next;
    struct coord_conn *chain; /* the next of coord.by_id */
    uint64_t id;
    enum msg_session session;
    unsigned version; /* of the protocol, since its HELLO */
    unsigned roles;   /* that it may ask for */
    char address[MSG_MAX_ADDRESS + 1];
    char owner[MSG_MAX_NAME + 1];
    char name[MSG_MAX_NAME + 1]; /* of the worker that it may be; empty: any */
    struct coord_worker *worker; /* with MSG_AT_COORD_WORKER */
    const struct job *watch;     /* job whose progress it gets */
    uint32_t watch_request;      /* request id of its SUBMIT */
    uint64_t offer_ms;           /* first OFFER since the last SUBMIT; or 0 */
    uint64_t sent_bytes;         /* CHUNK bytes since then */
    uint64_t moved_ms;           /* the last OFFER or CHUNK */
    uint32_t answers;            /* that it is to get, and that take a while */
    struct coord_owner *payer;
    struct coord_settling *settling;
    struct coord_telling *telling;
    enum coord_verdict verdict;
    const char *why; /* of a verdict, for the log */
};

#define COORD_CONNS 1024 /* a power of 2 */

struct coord {
    struct coord_env env;
    struct coord_keep keep;
    bool keep_due;            /* a job ended or was fetched */
    uint64_t keep_ms;         /* of the last coord_forget_old() */
    struct saved_gone *gones; /* how jobs that were forgotten ended */
    size_t ngones;
    struct coord_limits limits;
    struct uploads uploads;
    uint64_t uploads_ms; /* when those that wait were looked at last */
    bool full;           /* the disk is full: jobs are held */
    char full_text[MSG_MAX_TEXT + 1];
    bool full_told;        /* the log has it that the disk is full now */
    uint64_t full_told_ms; /* when it last said so; 0: never */
    struct action_list actions;
    uint64_t now_ms;
    struct coord_conn *conns;
    struct coord_worker *workers;
    uint32_t nworkers; /* that ever were; the next one's id */
    struct coord_owner *owners;
    uint32_t serving;  /* counts searches for a unit */
    struct job **jobs; /* by priority, then as they came */
    size_t njobs;
    uint64_t sequence;
    uint64_t known_ms;    /* when files that owners know of expired last */
    uint64_t progress_ms; /* when PROGRESS was sent last */
    uint64_t lease_ms;    /* a unit that is out for less is not late */
    bool stirred; /* since sched_run() any worker may get a unit or tile */
    struct coord_worker *roomy; /* if not: this worker alone; NULL: none */
    uint32_t verdicts;    /* that wait to be carried out */
    struct coord_conn *by_id[COORD_CONNS]; /* chains of conns */
    struct log_limit breaks; /* of lines on others' connections than workers' */
};

/* --- look up --- */

/* Place of a connection's chain in coord.by_id. */
size_t desk_slot(uint64_t id);
/* The connection of that id, or NULL. */
struct coord_conn *desk_find_conn(const struct coord *c, uint64_t id);
/* The job of that id, or NULL. */
struct job *desk_find_job(const struct coord *c, const uint8_t id[MSG_JOB]);
/* The same, if the job has that sequence number: the id of one that was deleted
 * may be another's now. */
struct job *desk_same_job(const struct coord *c, const uint8_t id[MSG_JOB],
                          uint64_t sequence);
/* The worker of that name, there or gone, or NULL. */
struct coord_worker *desk_find_worker(const struct coord *c, const char *name);
/* The owner of that name, who may be new; NULL: memory is out. */
struct coord_owner *desk_owner(struct coord *c, const char *name);
/* Index of the worker in the job; JOB_NOBODY: it has no part in it. */
uint32_t desk_index(const struct job *job, const struct coord_worker *w);
/* The index of a worker in the job, which it may be new to; JOB_NOBODY when
 * memory is out. */
uint32_t desk_add_worker(struct job *job, struct coord_worker *w);

/* The job and the index of w in it, which said something of it; NULL when the
 * job is over or unknown, and then the worker is told so. */
struct job *desk_job_of(struct coord *c, const struct coord_worker *w,
                        const uint8_t *id, uint32_t *index);

/* --- ask --- */

/* May the worker have more work? */
bool desk_takes_units(const struct coord_worker *w);
/* Is that worker of the job ready, and connected? */
bool desk_is_ready(const struct job *job, uint32_t index);
/* Does that worker of the job get units, if there are any? */
bool desk_may_take_part(const struct job *job, uint32_t index);
/* Has the job nothing for any worker now? */
bool desk_idle_job(const struct job *job);
/* Could a worker without work get some of the units that others have? */
bool desk_can_balance(const struct job *job);
/* May units of the job give lines away? */
bool desk_splits(const struct job *job);
/* Has the worker nothing to do, for this job or another that comes before it?
 */
bool desk_is_idle(const struct job *job, uint32_t index);
/* Does the worker have to give back units of the job, for another job, a pause,
 * or because it is to leave? */
bool desk_gives_way(const struct job *job, uint32_t index);
/* Is there another worker than w that may do the job?  late: workers that are
 * late count, too. */
bool desk_others_may(const struct coord *c, const struct job *job,
                     const struct coord_worker *w, bool late);
/* Is the job over, and kept for its owner, who has not fetched all frames? */
bool desk_unfetched(const struct coord *c, const struct job *job);

/* --- say --- */

/* The worker is so late with a unit that another does the unit, too, and all
 * else that the worker would get; or it is heard of again. */
void desk_late(struct job *job, uint32_t index, bool late);
/* A line of the log, for those who debug, about an attempt at a unit. */
void desk_log_unit(struct coord *c, const struct job *job, uint32_t unit,
                   const struct job_go *go, const char *what);
void desk_send_ack(struct coord *c, uint64_t conn, const uint8_t *job,
                   uint32_t unit, uint32_t attempt, uint32_t row,
                   uint32_t rows);
/* REVOKE, TWIN or SPLIT. */
void desk_send_attempt(struct coord *c, const struct job *job, uint16_t type,
                       uint32_t unit, const struct job_go *go);
/* Ambient records of the job go to the connections that watch it. */
void desk_send_records(struct coord *c, const struct job *job,
                       const struct msg_records *r);
/* The worker is told that the job is over. */
void desk_send_job_end(struct coord *c, uint64_t conn, const uint8_t *job);
/* Ask the store to remember the unit as it is now. */
void desk_keep_unit(struct coord *c, const struct job *job, uint32_t unit);
/* FAILED, in answer to a request. */
void desk_reply_failed(struct coord *c, const struct coord_conn *conn,
                       uint32_t request, const uint8_t *job, int status,
                       const char *text);

#endif
