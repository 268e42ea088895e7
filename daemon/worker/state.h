/* state.h - the state of a worker's machine, and its files
 *
 *   worker.c        events, and the connection to the coordinator
 *   worker_coord.c  messages of the coordinator
 *   worker_child.c  messages of a child
 *   worker_end.c    a job is over
 *   link.c          events of links to other workers
 *   gather.c        records of tiles, until their pass is closed
 *   relay.c         shared lines, on their way up and down
 *   peer.c          links to other workers: sending
 *   worker_files.c  files that jobs need
 *   wjob.c          jobs: their units, results and children
 *   worker_post.c   messages to the coordinator and to children
 * A file calls files below it alone.
 * Thread: one. */
#ifndef DAEMON_STATE_H
#define DAEMON_STATE_H

#include "ground/lossy.h"
#include "worker/worker.h"

struct wunit {
    uint32_t unit, attempt;
    uint32_t height; /* rows, but for a loan */
    bool parked;     /* the child only waits for others */
    bool loan;       /* columns that another worker lends; over when PAID */
    bool lends;      /* columns of that line, or did */
    uint32_t line;
};

/* A RESULT that is not acknowledged. */
struct wkept {
    struct wkept *next;
    uint32_t unit, attempt, row, rows;
    uint8_t *bytes; /* whole frame */
    size_t len;
};

/* Another worker of the job, which the coordinator named in JOB_PEERS.
 *
 *   it dials us --> EXPECTED --a caller has its name and token--> LINKED
 *   we dial it ---> DIALLING --the connection is up-------------> LINKED
 *
 * When a dial fails or a link breaks both are as at the beginning.  The peer is
 * forgotten after MOST_TRIES dials (link.c), and when the coordinator says so.
 */
enum peer_state { PEER_EXPECTED, PEER_DIALLING, PEER_LINKED };

struct wpeer {
    struct wpeer *next;
    uint32_t id; /* the peer's number, for the child */
    char name[MSG_MAX_NAME + 1];
    char address[MSG_MAX_ADDRESS + 1];
    uint8_t token[MSG_TOKEN];
    uint32_t flags;   /* MSG_PEER_... */
    unsigned version; /* that is spoken with it */
    enum peer_state state;
    uint64_t conn;
    uint64_t retry_ms; /* dial again then; 0: no */
    unsigned tries;
    struct lossy queue;
};

/* Of so many passes, from the first that the child lacks, something is known:
 * of those that may be open when it has all before, and of those that may be
 * when the coordinator is as much ahead. */
#define WJOB_PASSES (2 * MSG_OPEN_PASSES)

/* A job at this worker.  From any state to FETCHING, when the coordinator
 * starts the job again.
 *
 *   FETCHING -- all files are here --> LOADING -- the child's READY --> READY
 *    |                                    '-- the child is gone --.------'
 *    v                                                            v
 *   NO_ROOM ---------- room again: the coordinator is told ----> IDLE  */
enum wjob_state {
    WJOB_FETCHING, /* files are missing */
    WJOB_NO_ROOM,  /* and cannot be had now: the coordinator was told so */
    WJOB_LOADING,  /* child started */
    WJOB_READY,
    WJOB_IDLE /* no child: the child died or gave up, or none was started */
};

struct wjob {
    struct wjob *next;
    uint8_t id[MSG_JOB];
    char hex[MSG_JOB_HEX];
    enum wjob_state state;
    bool started;           /* by the coordinator, in this connection */
    uint32_t memory_mib;    /* its own limit; 0: none */
    uint8_t reuse[MSG_JOB]; /* the job whose cache it begins with; or zeros */
    uint8_t *start;         /* the JOB-START frame, for children */
    size_t start_len;
    uint32_t nframes;
    uint32_t width, height; /* the largest of any frame */
    uint32_t flags;         /* MSG_JOB_... */
    uint8_t channels;       /* of a pixel */
    uint8_t *files;         /* hashes of the files that the job needs */
    uint32_t nfiles;
    uint32_t nmissing;      /* with WJOB_FETCHING: of these files */
    uint64_t bundle_bytes;  /* of all files, as the submitter said */
    uint64_t look_ms;       /* with WJOB_NO_ROOM: when to look again */
    unsigned look_delay_ms; /* and how long after that the next time */
    uint64_t child;         /* connection, 0: none */
    uint64_t heard_ms; /* when the child last said something, by awake_ms */
    struct lossy to_child;
    struct msg_ready ready;       /* the child's, but for passes: of so many the
                                   * child has had the records by now */
    uint32_t ntiles[WJOB_PASSES]; /* that the child is to make, by the pass's
                                   * number */
    struct msg_tally tally;
    struct msg_counts paid;   /* in PAIDs of this child that were sent on, */
    struct msg_counts unpaid; /* and in PAIDs that could not be sent */
    uint64_t bytes_in, bytes_out;
    uint64_t base_line_bytes, base_line_pixels; /* as in msg_tally */
    struct wunit *units; /* with the child, in the order in which they came */
    size_t nunits;
    size_t kept_bytes;
    struct wkept *kept, **kept_tail;
    struct wpeer *peers;
    struct gather *gather; /* records of passes; NULL: none came */
    struct relay *relay;   /* base lines that were made here; NULL: none yet */
};

/* A file that was asked for. */
struct wasked {
    uint8_t hash[MSG_HASH];
    enum { WASKED_WANTED, WASKED_COMES } state;
    bool lapsed; /* its job is over, and the file may never come */
};

/* A peer's connection that has not been matched with a job. */
struct wcaller {
    struct wcaller *next;
    uint64_t conn, since_ms;
    bool said; /* its PEER-HELLO came: what follows is known */
    uint8_t job[MSG_JOB], token[MSG_TOKEN];
    char name[MSG_MAX_NAME + 1];
};

struct worker {
    struct worker_env env;
    struct action_list actions;
    uint64_t now_ms;
    uint64_t tick_ms;  /* of the last worker_tick() */
    bool held;         /* children are not listened to: worker_hold() */
    uint64_t awake_ms; /* now_ms without the time that this process slept */
    uint64_t coord;    /* connection, 0: none */
    bool welcome;      /* the coordinator has answered our HELLO, */
    unsigned version;  /* with this version of the protocol */
    bool parted;       /* by BYE or REFUSE: its end is no loss */
    uint64_t welcome_ms, dial_ms;
    unsigned delay_ms; /* before the next dial */
    bool draining, stopped;
    bool away; /* the machine is not to be used now: worker_allow() */
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
struct wjob *worker_find_job(const struct worker *w, const uint8_t id[MSG_JOB]);
/* To the coordinator, if it is there. */
void worker_send_coord(struct worker *w, const struct msg *m);
/* Send to a job's child, keeping count of the bytes. */
void worker_send_child(struct worker *w, struct wjob *job, const struct msg *m);
void worker_send_child_bytes(struct worker *w, struct wjob *job,
                             const uint8_t *bytes, size_t len);
/* Send the TALLY of a job's child. */
void worker_send_tally(struct worker *w, struct wjob *job);
/* The daemon is to end, with a status of sysexits.h. */
void worker_stop(struct worker *w, int status, const char *text);

#endif
