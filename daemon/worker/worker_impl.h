/* worker_impl.h - what the files of a worker's machine share
 *
 * Private to worker*.c, and to peer.c, relay.c (peer.h) and spread.c:
 *   worker.c        events, and the connection to the coordinator
 *   wjob.c    jobs, their units, results and children
 *   worker_files.c  files that jobs need
 *   worker_coord.c  messages of the coordinator
 *   worker_child.c  messages of a child */
#ifndef DAEMON_WORKER_IMPL_H
#define DAEMON_WORKER_IMPL_H

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

enum peer_state { PEER_EXPECTED, PEER_DIALLING, PEER_LINKED };

struct wpeer {
    struct wpeer *next;
    uint32_t id; /* the child knows it by this number */
    char name[MSG_MAX_NAME + 1];
    char address[MSG_MAX_ADDRESS + 1];
    uint8_t token[MSG_TOKEN];
    uint32_t flags;   /* MSG_PEER_... */
    unsigned version; /* that is spoken with it */
    enum peer_state state;
    uint64_t conn;
    uint64_t retry_ms; /* dial again then; 0: no */
    unsigned tries;
    uint64_t since_ms; /* when it was made known */
    struct lossy queue;
};

/* fetching -> loading -> ready -> idle: its child is gone, until it is started
 *   |    ^                         ^     again, and fetches
 *   v    \- started again          |
 *  no room -> there is again ------/  */
enum wjob_state {
    WJOB_FETCHING, /* files are missing */
    WJOB_NO_ROOM,  /* and cannot be had now: the coordinator was told so */
    WJOB_LOADING,  /* child started */
    WJOB_READY,
    WJOB_IDLE /* no child: it died, or gave up */
};

struct wjob {
    struct wjob *next;
    uint8_t id[MSG_JOB];
    char hex[MSG_JOB_HEX];
    enum wjob_state state;
    bool started;        /* by the coordinator, in this connection */
    uint32_t memory_mib; /* its own limit; 0: none */
    uint8_t *start;      /* the JOB-START frame, for children */
    size_t start_len;
    uint32_t nframes;
    uint32_t width, height; /* the largest of any frame */
    uint32_t flags;   /* MSG_JOB_... */
    uint8_t channels; /* of a pixel */
    uint8_t *files;   /* hashes that it needs */
    uint32_t nfiles;
    uint32_t nmissing;     /* fetching: of those */
    uint64_t bundle_bytes; /* of all of them, by its submitter */
    uint64_t look_ms;      /* no room: when to look again */
    unsigned look_delay_ms; /* and how long after that the next time */
    uint64_t child;    /* connection, 0: none */
    uint64_t heard_ms; /* when the child last said something, by awake_ms */
    struct lossy to_child;
    struct msg_ready ready;
    struct msg_tally tally;
    struct msg_counts paid;   /* by PAIDs of this child that were sent, */
    struct msg_counts unpaid; /* and by those that could not be */
    uint64_t bytes_in, bytes_out;
    uint64_t base_line_bytes, base_line_pixels; /* as in msg_tally */
    struct wunit *units; /* with the child, in the order in which they came */
    size_t nunits, cap_units;
    size_t kept_bytes;
    struct wkept *kept, **kept_tail;
    struct wpeer *peers;
    struct relay *relay;   /* base lines that were made here; NULL: none yet */
    struct spread *spread; /* who is sent which records; NULL: each peer, all */
};

/* A file that was asked for. */
struct wasked {
    uint8_t hash[MSG_HASH];
    enum { WASKED_WANTED, WASKED_COMES } state;
    bool lapsed; /* the job is over, and it may never come */
};

/* A peer's connection that has not been matched with a job. */
struct wcaller {
    struct wcaller *next;
    uint64_t conn, since_ms;
    bool said; /* its PEER-HELLO, below */
    uint8_t job[MSG_JOB], token[MSG_TOKEN];
    char name[MSG_MAX_NAME + 1];
};

struct worker {
    struct worker_env env;
    struct action_list actions;
    uint64_t now_ms;
    uint64_t tick_ms;  /* of the last worker_tick() */
    bool held;         /* children are not listened to: worker_hold() */
    uint64_t awake_ms; /* all time but what this process slept through */
    uint64_t coord;    /* connection, 0: none */
    bool opened, welcome, parted; /* ...: it said that it lets us go */
    unsigned version; /* welcome: of the protocol, with the coordinator */
    uint64_t welcome_ms, dial_ms;
    unsigned delay_ms; /* before the next dial */
    bool draining, stopped;
    bool away; /* by worker_allow() */
    uint64_t next_conn;
    uint32_t next_peer;
    uint64_t progress;
    struct wjob *jobs;
    struct wcaller *callers;
    struct wasked *asked; /* that have not come */
    uint32_t nasked, cap_asked;
};

/* --- worker.c --- */

uint64_t worker_new_conn(struct worker *w);
struct wjob *worker_find_job(const struct worker *w, const uint8_t id[MSG_JOB]);
/* To the coordinator, if it is there. */
void worker_send_coord(struct worker *w, const struct msg *m);
/* Send to a job's child, keeping count of the bytes. */
void worker_send_child(struct worker *w, struct wjob *job, const struct msg *m);
void worker_send_child_bytes(struct worker *w, struct wjob *job,
                             const uint8_t *bytes, size_t len);
/* What is known of a job's child so far. */
void worker_send_tally(struct worker *w, struct wjob *job);
/* The daemon is to end, with a status of sysexits.h. */
void worker_stop(struct worker *w, int status, const char *text);

/* --- wjob.c --- */

/* A job that starts here; NULL: memory is out. */
struct wjob *wjob_new(struct worker *w, const struct msg *m);
/* It is over: its child goes, and all that is known of it. */
void wjob_end(struct worker *w, struct wjob *job);
void wjob_spawn(struct worker *w, struct wjob *job);
void wjob_kill_child(struct worker *w, struct wjob *job);
/* Tell the coordinator that the job has no child here any more.  Units on which
 * nobody worked are not under suspicion, and none is if the reason lies here.
 */
void wjob_send_lost(struct worker *w, struct wjob *job, bool local,
                    const char *text);
/* A unit that the child has; NULL: it does not. */
struct wunit *worker_find_unit(const struct wjob *job, uint32_t unit,
                               uint32_t attempt);
bool wjob_has_unit(const struct wjob *job, uint32_t unit, uint32_t attempt);
/* False: memory is out. */
bool wjob_add_unit(struct wjob *job, uint32_t unit, uint32_t attempt);
void wjob_drop_unit(struct wjob *job, uint32_t unit, uint32_t attempt);
/* Units that are not finished will not be: forget them and their rows. */
void wjob_drop_units(struct wjob *job);
/* Its child is at that unit no more, and hears of it. */
void wjob_revoke_unit(struct worker *w, struct wjob *job, uint32_t unit,
                      uint32_t attempt);
/* Keep the frame of a RESULT until it is acknowledged; false: memory is out. */
bool wjob_keep(struct wjob *job, const struct msg_result *r,
               const uint8_t *bytes, size_t len);
void wjob_drop_kept(struct wjob *job, struct wkept **link);

/* --- worker_files.c --- */

/* Fetch what is missing, then start the child.  Which files are here may take a
 * while to tell. */
void files_look(struct worker *w, struct wjob *job);
bool files_need(const struct wjob *job, const uint8_t *hash);
/* Look again for room, where it is time. */
void files_watch_room(struct worker *w);
/* Is a piece of a file one that is to be kept? */
bool worker_take_chunk(struct worker *w, const struct msg_chunk *chunk);
/* A job that fetched is over: what was asked for may never come. */
void files_lapse(struct worker *w);

/* --- worker_coord.c --- */

void worker_from_coord(struct worker *w, const struct msg *m);

/* --- worker_child.c --- */

void worker_from_child(struct worker *w, struct wjob *job, const struct msg *m);
/* Lose children that hang, loading or with units in hand. */
void worker_watch_children(struct worker *w);

#endif
