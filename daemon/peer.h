/* peer.h - a worker's jobs, and its links to the other workers of a job
 *
 * The structs that worker.c and peer.c share, and what worker.c asks of
 * peer.c.  Private to the two.
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
    uint32_t flags; /* MSG_PEER_... */
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
    uint8_t *start; /* the JOB-START frame, for children */
    size_t start_len;
    uint8_t *files; /* hashes that it needs */
    uint32_t nfiles;
    uint64_t child; /* connection, 0: none */
    struct lossy to_child;
    struct msg_ready ready;
    struct msg_tally tally;
    uint64_t bytes_in, bytes_out;
    struct wunit *units; /* with the child, in the order in which they came */
    size_t nunits, cap_units;
    struct wkept *kept, **kept_tail;
    struct wpeer *peers;
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
    uint64_t coord; /* connection, 0: none */
    bool opened, welcome;
    uint64_t welcome_ms, dial_ms;
    uint64_t epoch; /* of the coordinator that was last met; 0: none */
    unsigned delay_ms; /* before the next dial */
    bool draining, stopped;
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

/* Dial again, and close callers that say nothing. */
void peer_tick(struct worker *w);

/* Close and free the links of a job; of all callers. */
void peer_release_job(struct worker *w, struct wjob *job);
void peer_release_callers(struct worker *w);

#endif
