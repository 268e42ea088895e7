/* worker.h - a worker's side of the protocol, apart from sockets and processes
 *
 * A pure machine like coord.h: events in, actions (action.h) out.  It dials the
 * coordinator again and again, with a growing delay; asks for the files of a
 * job that the cache lacks; starts a child for each job; passes units down to
 * it and results up; keeps results until the coordinator has acknowledged them;
 * and carries ambient records between children without looking into them.
 *
 * Where a peer or a child takes ambient records too slowly the oldest are
 * dropped; the shell says what a connection has written (worker_written()).
 * Nothing else is ever dropped.
 *
 * now_ms: milliseconds on a clock that never goes back.
 * Thread: radd's loop. */
#ifndef DAEMON_WORKER_H
#define DAEMON_WORKER_H

#include "machine/action.h"

struct worker_env {
    bool (*has_file)(void *arg, const uint8_t hash[MSG_HASH]);
    void (*random)(void *arg, void *buf, size_t n); /* for jitter */
    void *arg;
    action_look_fn *look; /* the answer is an event, worker_looked(); or NULL */
    /* files of the job may be removed from the cache; or NULL */
    void (*leave)(void *arg, const uint8_t job[MSG_JOB]);
    const char *program; /* "radd 0.1.0"; all strings outlive the worker */
    const char *name;
    const char *coordinator; /* the coordinator's address, for the log */
    const char *address;     /* where peers dial this worker; see msg_hello */
    unsigned threads;
    bool one_disk;   /* all workers share this disk: a job whose files find no
                      * room has failed, for no other worker has room */
    unsigned load_s; /* most seconds that a child may load, or say nothing while
                      * it has work; 0: no limit */
};

struct worker;

/* NULL when memory is out. */
struct worker *worker_new(const struct worker_env *env);
void worker_free(struct worker *w);

struct action_list *worker_actions(struct worker *w);

/* --- events --- */

/* Start: dial the coordinator. */
void worker_start(struct worker *w, uint64_t now_ms);

/* An ACT_DIAL has succeeded.  If it fails: worker_closed(). */
void worker_opened(struct worker *w, uint64_t now_ms, uint64_t conn);

/* A peer has dialled this worker; its session is MSG_AT_PEER_NEW. */
void worker_accepted(struct worker *w, uint64_t now_ms, uint64_t conn);

/* A connection to the coordinator or a peer ended, or could not be made. */
void worker_closed(struct worker *w, uint64_t now_ms, uint64_t conn,
                   const char *why);

/* A message came, from the coordinator, a peer or a child; the connection's
 * session allows it. */
void worker_message(struct worker *w, uint64_t now_ms, uint64_t conn,
                    const struct msg *m);

/* A child ended by itself; conn is its connection, all its messages were
 * delivered.  status: its own; EX_OSERR if somebody killed it, EX_SOFTWARE if
 * it crashed, EX_DATAERR if its job is the same everywhere.  text: "killed by
 * signal 11", "exit status 70". */
void worker_child_ended(struct worker *w, uint64_t now_ms, uint64_t conn,
                        int status, const char *text);

/* Does this status of sysexits.h, with which a child gave up, tell of this
 * machine (memory, a file, a permission is missing), not of the scene? */
bool worker_status_is_local(int status);

/* env.load_s has changed. */
void worker_set_limits(struct worker *w, unsigned load_s);

/* The answer to env.look. */
void worker_looked(struct worker *w, uint64_t now_ms,
                   const struct action_look *l);
/* A file of a job is in the cache; or could not be stored, with the reason. */
void worker_file_stored(struct worker *w, uint64_t now_ms,
                        const uint8_t hash[MSG_HASH]);
void worker_file_failed(struct worker *w, uint64_t now_ms,
                        const uint8_t hash[MSG_HASH], int status,
                        const char *text);

/* n bytes of those sent to a connection have been written. */
void worker_written(struct worker *w, uint64_t now_ms, uint64_t conn, size_t n);

/* Bytes of rows of that child's job that wait for an ACK.  Above some number
 * the shell stops reading from the child, for rows are never dropped, and says
 * so by worker_hold(): the child is silent then. */
size_t worker_kept(const struct worker *w, uint64_t child);
void worker_hold(struct worker *w, uint64_t child, bool held);

/* Leave: give work back, then ACT_STOP.  A second call, or without a
 * coordinator: ACT_STOP at once. */
void worker_drain(struct worker *w, uint64_t now_ms);

/* May this machine be used?  away: 0, or MSG_DRAIN_HOURS or MSG_DRAIN_IN_USE:
 * the worker gives its work back, leaves the coordinator and ends its children;
 * it dials again when it may be used. */
void worker_allow(struct worker *w, uint64_t now_ms, enum msg_drain_why away);

/* Time passes; to be called about every 100 ms. */
void worker_tick(struct worker *w, uint64_t now_ms);

/* --- for the shell to ask --- */

/* The connection to the coordinator; 0: none. */
uint64_t worker_coord(const struct worker *w);
/* Does fits(arg, job, token) hold for a peer that may dial this worker? */
typedef bool worker_token_fn(void *arg, const uint8_t job[MSG_JOB],
                             const uint8_t token[MSG_TOKEN]);
bool worker_peer_token(const struct worker *w, worker_token_fn *fits,
                       void *arg);

/* The progress counter for PING: it grows with units and rows that pass. */
uint64_t worker_progress(const struct worker *w);

#endif
