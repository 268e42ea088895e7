/* peer.h - a worker's jobs, and its links to the other workers of a job
 *
 * The structs that worker.c, peer.c and relay.c share, and what they ask of
 * each other.  Private to the three.
 *
 * The coordinator names a pair of workers to each other with a token; one
 * dials and says PEER-HELLO.  That may come before the coordinator's word, so
 * a hello that fits nothing yet is kept for a while.
 * Thread: one. */
#ifndef DAEMON_PEER_H
#define DAEMON_PEER_H

#include "lossy.h"
#include "worker.h"

struct wunit {
    uint32_t unit, attempt;
    bool parked; /* the child only waits for the base line above */
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
    struct lossy queue;
};

enum wjob_state {
    WJOB_FETCHING, /* files are missing */
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
    struct msg_area *frames; /* their sizes; the rest is 0 */
    uint32_t nframes;
    uint32_t flags;   /* MSG_JOB_... */
    uint8_t channels; /* of a pixel */
    uint8_t *files;   /* hashes that it needs */
    uint32_t nfiles;
    uint64_t child;    /* connection, 0: none */
    uint64_t heard_ms; /* when the child last said something, by awake_ms */
    struct lossy to_child;
    struct msg_ready ready;
    struct msg_tally tally;
    uint64_t bytes_in, bytes_out;
    uint64_t base_line_bytes, base_line_pixels; /* as in msg_tally */
    struct wunit *units; /* with the child, in the order in which they came */
    size_t nunits, cap_units;
    size_t kept_bytes;
    struct wkept *kept, **kept_tail;
    struct wpeer *peers;
    struct relay *relay; /* base lines that were made here; NULL: none yet */
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
    bool opened, welcome;
    uint64_t welcome_ms, dial_ms;
    unsigned delay_ms; /* before the next dial */
    bool draining, stopped;
    bool away; /* by worker_allow() */
    uint64_t next_conn;
    uint32_t next_peer;
    uint64_t progress;
    struct wjob *jobs;
    struct wcaller *callers;
    uint8_t *asked; /* hashes that were WANTed and have not come */
    uint32_t nasked, cap_asked;
};

uint64_t worker_new_conn(struct worker *w);
struct wjob *worker_find_job(const struct worker *w, const uint8_t id[MSG_JOB]);
/* A unit that the child has; NULL: it does not. */
struct wunit *worker_find_unit(const struct wjob *job, uint32_t unit,
                               uint32_t attempt);
/* Send to a job's child, keeping count of the bytes. */
void worker_send_child(struct worker *w, struct wjob *job, const struct msg *m);

/* --- peer.c --- */

void peer_introduce(struct worker *w, struct wjob *job,
                    const struct msg_job_peers *m);
void peer_accepted(struct worker *w, uint64_t conn);

/* Is that connection a peer's or a caller's?  Then the event is dealt with. */
bool peer_opened(struct worker *w, uint64_t conn);
bool peer_closed(struct worker *w, uint64_t conn);
bool peer_message(struct worker *w, uint64_t conn, const struct msg *m);
bool peer_written(struct worker *w, uint64_t conn, size_t n);

/* Records from the job's own child go to the peers; what waits for the child
 * goes as far as it takes it. */
void peer_spread(struct worker *w, struct wjob *job,
                 const struct msg_ambient *m);
void peer_feed_child(struct worker *w, struct wjob *job);

/* The peer of that name, if there is a link to it; else NULL. */
struct wpeer *peer_linked(const struct wjob *job, const char *name);
/* Send it what may not be dropped. */
void peer_send(struct worker *w, struct wjob *job, struct wpeer *p,
               const struct msg *m);

/* Dial again, and close callers that say nothing. */
void peer_tick(struct worker *w);

/* Close and free the links of a job; of all callers. */
void peer_release_job(struct worker *w, struct wjob *job);
void peer_release_callers(struct worker *w);

/* --- relay.c --- */

/* What workers share, on its way down from the coordinator and up from a job's
 * child; other messages are ignored. */
void relay_down(struct worker *w, const struct msg *m);
void relay_up(struct worker *w, struct wjob *job, const struct msg *m);
/* A link to a peer is there. */
void relay_linked(struct worker *w, struct wjob *job, const char *name);
/* Tell the coordinator all of them again: some may have been lost on the way.
 */
void relay_repeat(struct worker *w, const struct wjob *job);
/* May that be a base line of the job? */
bool relay_fits(const struct wjob *job, const struct msg_base_line *m);
void relay_release(struct wjob *job);

#endif
