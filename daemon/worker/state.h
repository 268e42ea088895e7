/* state.h - the state of a worker's machine, and its files
 *
 *   worker.c        events; the connection to the coordinator
 *   worker_coord.c  messages of the coordinator
 *   worker_child.c  messages of children
 *   worker_end.c    the end of a job
 *   link.c          events of links to other workers
 *   relay.c         shared lines and tiles, up and down
 *   gather.c        records of tiles, until their pass is closed
 *   peer.c          sending to other workers
 *   worker_files.c  files that jobs need
 *   wjob.c          jobs: their units, results and children
 *   worker_post.c   sending to the coordinator and to children
 * A file calls only files below it in this list.
 * Thread: radd's loop. */
#ifndef DAEMON_STATE_H
#define DAEMON_STATE_H

#include "ground/lossy.h"
#include "worker/worker.h"

/* An attempt at a unit, or a loan, that the job's child has. */
struct wattempt {
    uint32_t unit, number;
    uint32_t height; /* rows; not set for a loan */
    bool parked;     /* the child can only wait for others */
    bool loan;       /* columns that another worker lends; over when PAID */
    bool lends;      /* it lent columns of that line, some time */
    uint32_t line;
};

/* A RESULT that is not acknowledged yet. */
struct wkept {
    struct wkept *next;
    uint32_t unit, attempt, row;
    uint8_t *bytes; /* the whole message, header and all */
    size_t len;
};

/* Another worker of the job, which the coordinator named in JOB_PEERS.
 *
 *   it dials ------> EXPECTED --a caller has its name and token--> LINKED
 *   we dial it ----> DIALLING --the connection is up-------------> LINKED
 *
 * When a dial fails or a link breaks the peer is EXPECTED or DIALLING again.
 * It is forgotten with the job, or when the coordinator says so. */
enum peer_state { PEER_EXPECTED, PEER_DIALLING, PEER_LINKED };

struct wpeer {
    struct wpeer *next;
    uint32_t id; /* number of this peer, by which relay.c knows it */
    char name[MSG_MAX_NAME + 1];
    char address[MSG_MAX_ADDRESS + 1];
    uint8_t token[MSG_TOKEN];
    uint32_t flags;   /* MSG_PEER_... */
    unsigned version; /* of the protocol on the link */
    enum peer_state state;
    uint64_t conn;
    uint64_t retry_ms; /* when to dial again; 0: not planned */
    unsigned delay_ms; /* of the dial after the next; 0: none was planned */
    uint64_t since_ms; /* linked, or not; 0: the log says that it is not */
    struct lossy queue;
};

/* Passes that a worker keeps account of, from the first that its child lacks.
 * MSG_OPEN_PASSES may be open when the child has all closed ones; as many again
 * if the coordinator is ahead. */
#define WJOB_PASSES (2 * MSG_OPEN_PASSES)

/* A job at this worker.  Started again, any state but LOADING and READY becomes
 * FETCHING; FETCHING and NO_ROOM become IDLE if a file cannot be had.
 *
 *   FETCHING -- all files are here --> LOADING -- the child's READY --> READY
 *    |                                    '-- the child is gone --.------'
 *    v                                                            v
 *   NO_ROOM -- room again: the coordinator is told ------------> IDLE  */
enum wjob_state {
    WJOB_FETCHING, /* some files are missing */
    WJOB_NO_ROOM,  /* there is no room for them: the coordinator was told */
    WJOB_LOADING,  /* the child was started */
    WJOB_READY,
    WJOB_IDLE /* no child: it died, gave up or was not started */
};

struct wjob {
    struct wjob *next;
    uint8_t id[MSG_JOB];
    char hex[MSG_JOB_HEX];
    enum wjob_state state;  /* changed by wjob_step() alone */
    bool started;           /* the coordinator has sent JOB_START on this
                             * connection */
    uint32_t memory_mib;    /* limit for its child; 0: none of its own */
    uint8_t *start;         /* the JOB_START message, for children, without the
                             * priority */
    size_t start_len;
    uint32_t nframes;
    uint32_t width, height; /* the largest of any frame */
    uint32_t flags;         /* MSG_JOB_... */
    uint8_t channels;       /* of a pixel */
    uint8_t *files;         /* hashes of the files that the job needs */
    uint32_t nfiles;
    uint32_t nmissing;      /* in FETCHING: how many of these are missing */
    uint64_t bundle_bytes;  /* of all files, as radsubmit says */
    uint64_t look_ms;       /* in NO_ROOM: when to look for room again */
    unsigned look_delay_ms; /* in NO_ROOM: how long to wait after that look */
    uint64_t child;         /* its connection; 0: there is no child */
    uint64_t heard_ms;      /* awake_ms when the child last said something */
    bool held;              /* the child is not read from: worker_hold() */
    struct lossy to_child;
    struct msg_ready ready;       /* the child's READY; passes: how many it has
                                   * got the records of by now */
    uint32_t ntiles[WJOB_PASSES]; /* tiles that the child makes, by pass number
                                   * modulo WJOB_PASSES */
    struct msg_tally tally;
    struct msg_counts paid;   /* in PAIDs of this child that were sent on */
    struct msg_counts unpaid; /* in PAIDs that could not be sent on */
    uint64_t bytes_in, bytes_out;
    uint64_t base_line_bytes, base_line_pixels; /* as in msg_tally */
    struct wattempt *attempts; /* in the order in which they came */
    size_t nattempts;
    size_t kept_bytes;               /* of kept */
    struct wkept *kept, **kept_tail; /* the oldest first */
    struct wpeer *peers;
    struct gather *gather; /* records of passes; NULL: none came */
    struct relay *relay;   /* base lines that were made here; NULL: none yet */
};

/* A file that was asked for and has not come whole:
 *
 *   WANTED --its first bytes--> COMES --all are here--> no longer listed */
struct wasked {
    uint8_t hash[MSG_HASH];
    enum { WASKED_WANTED, WASKED_COMES } state;
    bool lapsed; /* its job ended: if it does not come yet it may never come */
};

/* A connection that a peer made and that is not matched with a job yet. */
struct wcaller {
    struct wcaller *next;
    uint64_t conn, since_ms;
    bool said; /* its PEER_HELLO came: */
    uint8_t job[MSG_JOB], token[MSG_TOKEN]; /* as PEER_HELLO has them */
    char name[MSG_MAX_NAME + 1];
};

/* The connection to the coordinator.
 *
 *   NONE --dial--> DIALLING --WELCOME--> WELCOME
 *                     | REFUSE              | BYE, REFUSE
 *                     '------> PARTED <-----'
 * When the connection ends it is NONE again; from PARTED that is no loss. */
enum coord_state { COORD_NONE, COORD_DIALLING, COORD_WELCOME, COORD_PARTED };

struct worker {
    struct worker_env env;
    struct action_list actions;
    uint64_t now_ms;
    uint64_t tick_ms;  /* when worker_tick() was last called */
    uint64_t awake_ms; /* now_ms without time that this process was stopped */
    enum coord_state coord_state;
    uint64_t coord;      /* the connection; 0 in COORD_NONE */
    uint64_t welcome_ms; /* when WELCOME came; 0: not on this connection */
    uint64_t epoch;      /* of the last WELCOME */
    uint64_t dial_ms;    /* when to dial next */
    unsigned delay_ms;   /* of the dial after the next */
    bool draining, stopped;
    enum msg_drain_why away; /* as worker_allow() said */
    uint64_t next_conn;
    uint32_t next_peer;
    uint64_t progress;
    struct wjob *jobs;
    struct wcaller *callers;
    struct wasked *asked; /* files that have not come */
    uint32_t nasked;
};

/* --- worker_post.c --- */

uint64_t worker_new_conn(struct worker *w);
/* A connection that lasted so long [ms] was a good one: its other side is
 * dialled again as soon as at first. */
#define WORKER_STEADY_MS 10000
/* The time of the next dial, *delay_ms from now; chance adds up to half of
 * that, so that workers do not all come back at once.  The delay then doubles,
 * up to 30 s. */
uint64_t worker_redial_ms(struct worker *w, unsigned *delay_ms);
struct wjob *worker_find_job(const struct worker *w, const uint8_t id[MSG_JOB]);
/* Send to the coordinator, if it is there. */
void worker_send_coord(struct worker *w, const struct msg *m);
void worker_send_drain(struct worker *w);
/* Send to a job's child. */
void worker_send_child(struct worker *w, struct wjob *job, const struct msg *m);
void worker_send_child_bytes(struct worker *w, struct wjob *job,
                             const uint8_t *bytes, size_t len);
/* Send the TALLY of a job's child. */
void worker_send_tally(struct worker *w, struct wjob *job);
/* End the daemon, with a status of sysexits.h. */
void worker_stop(struct worker *w, int status, const char *text);

#endif
