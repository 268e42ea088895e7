/* sched.h - who works on what: the part of the coordinator that hands out
 *
 * coord.c keeps connections and requests and calls these; both change the
 * structs below.  Private to coord.c, request.c, sched.c and report.c.
 * Thread: one. */
#ifndef DAEMON_SCHED_H
#define DAEMON_SCHED_H

#include "coord.h"
#include "job.h"

/* A worker that is, or was, connected. */
struct coord_worker {
    struct coord_worker *next;
    char name[MSG_MAX_NAME + 1];
    char program[MSG_MAX_NAME + 1];
    char address[MSG_MAX_ADDRESS + 1]; /* where peers dial it */
    uint64_t conn;                     /* 0: not connected */
    uint32_t threads;
    uint64_t fingerprint;
    uint64_t since_ms;         /* connected, or gone, since */
    uint32_t in_flight;        /* units of all jobs that it has */
    const struct job *loading; /* what its next READY is for */
    bool drained;              /* gets nothing new: an admin's wish */
    bool leaving;              /* gets nothing new: its own wish */
    bool alone; /* has a unit that crashed once: nothing beside it */
};

struct coord_conn {
    struct coord_conn *next;
    uint64_t id;
    enum msg_session session;
    unsigned roles; /* that it may ask for */
    char address[MSG_MAX_ADDRESS + 1];
    char owner[MSG_MAX_NAME + 1];
    struct coord_worker *worker; /* with MSG_AT_COORD_WORKER */
    const struct job *watch;     /* job whose progress it gets */
    uint32_t watch_request;      /* request id of its SUBMIT */
    uint64_t offer_ms;           /* first OFFER since the last SUBMIT; or 0 */
    uint64_t sent_bytes;         /* CHUNK bytes since then */
};

struct coord {
    struct coord_env env;
    struct action_list actions;
    uint64_t now_ms;
    struct coord_conn *conns;
    struct coord_worker *workers;
    struct job **jobs; /* in the order in which they are served */
    size_t njobs, cap_jobs;
    uint64_t sequence;
    uint64_t progress_ms; /* when PROGRESS was sent last */
};

/* Give units, and jobs to load, to every worker that has room. */
void sched_run(struct coord *c);

/* Messages of workers. */
void sched_ready(struct coord *c, struct coord_worker *w,
                 const struct msg_ready *m);
void sched_result(struct coord *c, struct coord_worker *w,
                  const struct msg_result *m);
void sched_lost(struct coord *c, struct coord_worker *w,
                const struct msg_lost *m);
void sched_tally(struct coord *c, struct coord_worker *w,
                 const struct msg_tally *m);

/* A worker went: its units wait again. */
void sched_worker_gone(struct coord *c, struct coord_worker *w);

/* Rows are kept. */
void sched_rows_stored(struct coord *c, const struct action_rows *key);

/* Take the units of a job back and tell its workers that it is over. */
void sched_job_over(struct coord *c, struct job *job);

/* --- coord.c --- */

/* The job or connection of that id, or NULL. */
struct job *coord_find_job(const struct coord *c, const uint8_t id[MSG_JOB]);
struct coord_conn *coord_find_conn(const struct coord *c, uint64_t id);

/* Close a connection that broke the rules, or that is not needed. */
void coord_break(struct coord *c, uint64_t conn, const char *why);

void coord_reply_failed(struct coord *c, const struct coord_conn *conn,
                        uint32_t request, const uint8_t *job, int status,
                        const char *text);
void coord_send_accept(struct coord *c, const struct coord_conn *conn,
                       const struct job *job, bool again);
/* The last words to one who watches the job. */
void coord_send_end(struct coord *c, const struct coord_conn *conn,
                    const struct job *job);

/* Put a job into the queue; false when memory is out. */
bool coord_add_job(struct coord *c, struct job *job);
/* Once its files are all there, ask for room for its rows. */
void coord_try_open(struct coord *c, struct job *job);
/* End a job; text may be NULL. */
void coord_job_ends(struct coord *c, struct job *job, enum job_state state,
                    int status, const char *text);

#endif
