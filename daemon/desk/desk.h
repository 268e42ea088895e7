/* desk.h - what the coordinator knows: connections, workers, users and jobs;
 * functions that look these up, ask about them, and send messages
 *
 * Rooms above change these structs and those of a job (jobs/job.h).
 * Thread: the coordinator's loop. */
#ifndef DAEMON_DESK_H
#define DAEMON_DESK_H

#include "desk/account.h"
#include "desk/env.h"
#include "desk/worker.h"
#include "jobs/job.h"
#include "net/log.h"
#include "users/uploads.h"

/* Shall the connection end when the event is over (verdict.h)? */
enum coord_verdict {
    CONN_STAYS,
    CONN_BREAKS, /* yes: rules were broken, or there is no room for it */
    CONN_PARTS   /* yes, and the other end knows */
};

struct coord_conn {
    struct coord_conn *next, *chain; /* chain: next in its chain of by_id */
    uint64_t id;
    enum msg_session session;
    unsigned version; /* of the protocol, known since its HELLO */
    unsigned roles;   /* bit 1u << enum msg_role: roles HELLO may ask for */
    char address[MSG_MAX_ADDRESS + 1];
    char owner[MSG_MAX_NAME + 1];
    char name[MSG_MAX_NAME + 1]; /* of the only worker that may use the
                                  * connection; empty: any may */
    struct coord_worker *worker; /* set in the session MSG_AT_COORD_WORKER */
    const struct job *watch;     /* job whose progress is sent; NULL: none */
    uint32_t watch_request;      /* request id of its SUBMIT */
    uint64_t offer_ms;           /* first OFFER since last SUBMIT; 0: none */
    uint64_t sent_bytes;         /* bytes of CHUNK since the last job */
    uint64_t moved_ms;           /* when the last OFFER or CHUNK came */
    bool in_line;     /* the limit user_jobs has refused its SUBMIT (quota.h) */
    uint32_t answers; /* answers under way, each over several turns */
    struct coord_owner *payer;
    struct coord_settling *settling; /* answers that wait for the store */
    struct coord_telling *telling;   /* statistics that are being sent */
    enum coord_verdict verdict;
    const char *why; /* the reason for the verdict, for the log */
};

#define COORD_CONNS 1024 /* a power of 2 */
#define COORD_JOBS  4096

struct coord {
    struct coord_env env;
    struct coord_keep keep;
    bool keep_due;            /* a job ended or was fetched since keep_ms */
    uint64_t keep_ms;         /* when bygone_forget_old() last ran */
    struct saved_gone *gones; /* records of jobs that were forgotten */
    size_t ngones;
    struct coord_limits limits;
    struct uploads uploads;
    uint64_t uploads_ms; /* when waiting uploads were last looked at */
    bool full;           /* the disk is full: jobs are held */
    char full_text[MSG_MAX_TEXT + 1];
    bool full_told;        /* the log says that the disk is full now */
    uint64_t full_told_ms; /* when the log last said so; 0: never */
    struct action_list actions;
    uint64_t now_ms;
    struct coord_conn *conns;
    struct coord_worker *workers;
    uint32_t nworkers; /* workers ever known; the id of the next new worker */
    struct coord_owner *owners;
    uint32_t serving;  /* number of the present search for a unit */
    struct job **jobs; /* all, in the order of order.h */
    size_t njobs, nbegun, nopen, nended;
    uint64_t sequence;
    uint64_t pieces_told; /* of statistics, made or sent (delivery.c) */
    uint64_t known_ms;    /* when owners' known files last expired */
    uint64_t told_progress_ms; /* when PROGRESS was last sent */
    uint64_t lease_floor_ms;   /* a unit that is out for less is not late */
    bool stirred; /* any worker may get a unit or tile since sched_run() */
    struct coord_worker *roomy; /* if not stirred: this worker alone may */
    uint32_t verdicts;          /* verdicts to be carried out */
    struct coord_conn *by_id[COORD_CONNS]; /* hash table of conns: chains */
    struct job *by_job[COORD_JOBS];        /* likewise, of jobs (order.c) */
    struct log_limit breaks; /* of log lines on connections of non-workers */
};

/* --- look up --- */

/* Index in coord.by_id of the chain for connections of that id. */
size_t desk_slot(uint64_t id);
/* The connection of that id, or NULL. */
struct coord_conn *desk_find_conn(const struct coord *c, uint64_t id);
/* The job of that id, or NULL. */
struct job *desk_find_job(const struct coord *c, const uint8_t id[MSG_JOB]);
/* The same, if it has that sequence: a deleted job's id may come again. */
struct job *desk_same_job(const struct coord *c, const uint8_t id[MSG_JOB],
                          uint64_t sequence);
/* The worker of that name, connected or not, or NULL. */
struct coord_worker *desk_find_worker(const struct coord *c, const char *name);
/* The owner of that name, made if need be; NULL: memory is out. */
struct coord_owner *desk_owner(struct coord *c, const char *name);
/* Index of the worker's part in the job; JOB_NOBODY: it has none. */
uint32_t desk_index(const struct job *job, const struct coord_worker *w);
/* The same, the part made if need be; JOB_NOBODY: memory is out. */
uint32_t desk_add_part(struct coord *c, struct job *j, struct coord_worker *w);

/* The job that a message of worker w names; *index: of the worker's part.
 * NULL: the job is over or unknown, and the worker is sent JOB_END. */
struct job *desk_job_of(struct coord *c, const struct coord_worker *w,
                        const uint8_t *id, uint32_t *index);

/* --- ask --- */

/* May the worker have more work? */
bool desk_takes_units(const struct coord_worker *w);
/* Is the job's worker of this index ready, and connected? */
bool desk_is_ready(const struct job *job, uint32_t index);
/* May the job's worker of this index get units, now or when it is ready? */
bool desk_may_take_part(const struct job *job, uint32_t index);
/* Has the job nothing that any worker could do now? */
bool desk_idle_job(const struct job *job);
/* Could a worker without work take over part of what other workers have? */
bool desk_can_balance(const struct job *job);
/* May a worker give lines of the job's units away (SPLIT)? */
bool desk_splits(const struct job *job);
/* Is the worker ready for the job, and does it work, if at all, for jobs of
 * lower priority alone? */
bool desk_is_idle(const struct job *job, uint32_t index);
/* Must the worker give units of the job back: the job is paused, the worker is
 * to leave, or a job of higher priority has units for it? */
bool desk_gives_way(const struct job *job, uint32_t index);
/* Is there a worker other than w (NULL: any) that may do the job?  Workers that
 * are late in the job, or have no room for it yet, count only if `ever`. */
bool desk_others_may(const struct coord *c, const struct job *job,
                     const struct coord_worker *w, bool ever);
/* May the worker try work that brought children down?  If its own was the first
 * another worker gets the work, if any other may do the job. */
bool desk_may_try(const struct coord *c, const struct job *job,
                  const struct unit_crashes *crashes, uint32_t index);
/* The date: the time by a clock that runs on while the machine sleeps.  By it
 * jobs that are over age; for workers no time passes during a sleep. */
uint64_t desk_date_ms(const struct coord *c);
/* What the system's clock shows at such a date, for users. */
uint64_t desk_shown_ms(const struct coord *c, uint64_t date_ms);
/* For how long the job has been over, sleep of the machine included. */
uint64_t desk_age_ms(const struct coord *c, const struct job *job);
/* Is the job over, with frames that its owner has not fetched but still may? */
bool desk_unfetched(const struct coord *c, const struct job *job);

/* --- say --- */

/* Note that the worker is late: other workers do its units, too, and it gets
 * nothing more of the job.  With late false: it was heard of again. */
void desk_late(struct job *job, uint32_t index, bool late);
/* Log an attempt at a unit, for debugging. */
void desk_log_unit(struct coord *c, const struct job *job,
                   const struct job_attempt *attempt, const char *what);
void desk_send_ack(struct coord *c, uint64_t conn, const struct msg_ack *ack);
/* Send REVOKE, SPLIT or YIELD for the attempt to its worker. */
void desk_send_attempt(struct coord *c, const struct job *job, uint16_t type,
                       const struct job_attempt *attempt);
/* Send ambient records of the job to connections that watch it. */
void desk_send_records(struct coord *c, const struct job *job,
                       const struct msg_records *r);
/* Tell the worker that the job is over. */
void desk_send_job_end(struct coord *c, uint64_t conn, const uint8_t *job);
/* Ask the store to keep the unit as it is now. */
void desk_keep_unit(struct coord *c, const struct job *job, uint32_t unit);
/* Answer a request with FAILED. */
void desk_reply_failed(struct coord *c, const struct coord_conn *conn,
                       uint32_t request, const uint8_t *job, int status,
                       const char *text);

#endif
