/* worker.h - a worker's side of the protocol, apart from sockets and processes
 *
 * A pure machine like coord.h: events in, actions (action.h) out.  It keeps
 * the connection to the coordinator (dials again with a growing delay), asks
 * for the files of a job that its cache lacks, starts a child per job, passes
 * units down and results up, keeps results until the coordinator has
 * acknowledged them, and carries ambient records between the job's children
 * without looking into them.
 *
 * Ambient records may be dropped, oldest first, where a peer or a child takes
 * them too slowly: the shell says what a connection has written.  Nothing else
 * is ever dropped.
 *
 * now_ms: milliseconds on a clock that never goes back.
 * Thread: one. */
#ifndef DAEMON_WORKER_H
#define DAEMON_WORKER_H

#include "machine/action.h"

struct worker_env {
    bool (*has_file)(void *arg, const uint8_t hash[MSG_HASH]);
    void (*random)(void *arg, void *buf, size_t n); /* jitter */
    void *arg;
    action_look_fn *look; /* then worker_looked; or NULL */
    /* the job's files may be removed from the cache; or NULL */
    void (*leave)(void *arg, const uint8_t job[MSG_JOB]);
    const char *program; /* "radd 0.1.0"; all strings outlive the worker */
    const char *name;
    const char *coordinator; /* the coordinator's address, for the log */
    const char *address;     /* where peers dial this worker; see msg_hello */
    unsigned threads;
    bool one_disk;   /* all workers are on it: a job whose files find no room
                      * here has failed, and does not wait for another worker */
    unsigned load_s; /* longest time that a child may load, or be silent while
                      * it has units; 0: any */
};

struct worker;

/* NULL when memory is out. */
struct worker *worker_new(const struct worker_env *env);
void worker_free(struct worker *w);

struct action_list *worker_actions(struct worker *w);

/* --- events --- */

/* Dials the coordinator. */
void worker_start(struct worker *w, uint64_t now_ms);

/* An ACT_DIAL succeeded.  (worker_closed when it fails.) */
void worker_opened(struct worker *w, uint64_t now_ms, uint64_t conn);

/* A peer dialled us; its session is MSG_AT_PEER_NEW. */
void worker_accepted(struct worker *w, uint64_t now_ms, uint64_t conn);

/* A connection to the coordinator or a peer is gone or did not come about. */
void worker_closed(struct worker *w, uint64_t now_ms, uint64_t conn,
                   const char *why);

/* A message arrived that the session of the connection allows, a child's
 * too. */
void worker_message(struct worker *w, uint64_t now_ms, uint64_t conn,
                    const struct msg *m);

/* A child (its connection) ended by itself, all its messages having been
 * delivered.  local: the cause is this machine, not the scene.
 * text: "killed by signal 11", "exit status 70". */
void worker_child_ended(struct worker *w, uint64_t now_ms, uint64_t conn,
                        bool local, const char *text);

/* Does a child that gives up with that status of sysexits.h say nothing of the
 * scene, but that memory, a file or a permission is missing here? */
bool worker_status_is_local(int status);

/* The limits of worker_env have changed. */
void worker_set_limits(struct worker *w, unsigned load_s);

/* The files of a job that began are known. */
void worker_looked(struct worker *w, uint64_t now_ms,
                   const struct action_look *l);
void worker_file_stored(struct worker *w, uint64_t now_ms,
                        const uint8_t hash[MSG_HASH]);
void worker_file_failed(struct worker *w, uint64_t now_ms,
                        const uint8_t hash[MSG_HASH], int status,
                        const char *text);

/* n bytes that were sent to a connection have been written out. */
void worker_written(struct worker *w, uint64_t now_ms, uint64_t conn, size_t n);

/* Rows that wait for an ACK [bytes].  Rows are never dropped: above some number
 * of bytes the shell stops reading from children, and says so by worker_hold(),
 * for the children are silent then. */
size_t worker_kept(const struct worker *w);
void worker_hold(struct worker *w, bool held);

/* Leave: finish the units in hand, then ACT_STOP.  A second call, or no
 * coordinator: ACT_STOP at once. */
void worker_drain(struct worker *w, uint64_t now_ms);

/* May the worker work?  If not it finishes the units in hand, leaves the
 * coordinator and has no child; it dials again once it may. */
void worker_allow(struct worker *w, uint64_t now_ms, bool allowed);

/* Time passes; to be called about every 100 ms. */
void worker_tick(struct worker *w, uint64_t now_ms);

/* --- for the shell to look at --- */

/* The connection to the coordinator; 0: none. */
uint64_t worker_coord(const struct worker *w);
/* Does fits(arg, job, token) accept any peer that may dial us? */
typedef bool worker_token_fn(void *arg, const uint8_t job[MSG_JOB],
                             const uint8_t token[MSG_TOKEN]);
bool worker_peer_token(const struct worker *w, worker_token_fn *fits,
                       void *arg);

/* Grows with units and rows that pass, for PING. */
uint64_t worker_progress(const struct worker *w);

#endif
