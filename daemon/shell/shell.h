/* shell.h - what both daemons' shells around their machines have in common
 *
 * Keeps the numbered connections, turns what they say into the machine's
 * events, and carries out the actions that coordinator and worker share.  An
 * event that comes up while actions are carried out waits until they all are.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_SHELL_H
#define RADD_DAEMON_SHELL_H

#include "machine/action.h"
#include "net/conn.h"
#include "store/store.h"
#include "ground/turns.h"

#define SHELL_BUCKETS 64

struct shell_link;

struct shell_ops {
    /* events for the machine; shell_run() follows each */
    void (*message)(void *arg, uint64_t id, const struct msg *m);
    void (*closed)(void *arg, uint64_t id, const char *why);
    void (*written)(void *arg, uint64_t id, size_t n);
    /* an action that is not common to both */
    void (*action)(void *arg, const struct action *a);
    struct action_list *(*actions)(void *arg);
    void (*ping)(void *arg, struct msg_ping *ping); /* what it is to say */
    void (*failed)(void *arg);       /* the machine is out of memory */
};

struct shell {
    uv_loop_t *loop;
    struct store *store; /* may be NULL until it is open */
    const struct shell_ops *ops;
    void *arg;
    struct shell_link *links[SHELL_BUCKETS]; /* by number */
    struct shell_link *gone;                 /* closed, not told yet */
    uint64_t next_id;
    bool running;
    struct conn_handler handler; /* of all connections */
    struct log_limit errors;
    struct turns *turns; /* learns what takes how long; or NULL */
};

void shell_init(struct shell *s, uv_loop_t *loop, const struct shell_ops *ops,
                void *arg);

/* A number for a connection that came in. */
uint64_t shell_new_id(struct shell *s);

/* Take an open stream and its session (conn.h) as connection id; false when
 * memory is out. */
bool shell_add(struct shell *s, uint64_t id, uv_stream_t *stream,
               struct tls *tls, enum msg_session session, const char *peer);

/* End those connections whose key (conn_key) is no longer good, as if they had
 * ended by themselves; why says so, or is NULL. */
typedef const char *shell_key_fn(void *arg, const char *key);
void shell_drop_keys(struct shell *s, shell_key_fn *why, void *arg);

/* NULL: there is none (any more). */
struct conn *shell_conn(const struct shell *s, uint64_t id);

/* A connection that never came about: its closed event. */
void shell_gone(struct shell *s, uint64_t id, const char *why);

/* Drop a connection without an event. */
void shell_remove(struct shell *s, uint64_t id);

/* Carry out the machine's actions, and what they bring about. */
void shell_run(struct shell *s);

/* The store has caught up: read on where reading was stopped for it. */
void shell_store_progress(struct shell *s);

/* Close every connection, without events. */
void shell_close(struct shell *s);

/* Randomness for the machines. */
void shell_random(void *arg, void *buf, size_t n);

#endif
