/* shell.h - the common part of the shells around both daemons' machines
 *
 * Keeps the numbered connections, turns their messages and ends into events of
 * the machine, and carries out the actions that coordinator and worker share.
 * The end of a connection while actions are carried out becomes an event when
 * all actions have been carried out.
 * Thread: the loop's. */
#ifndef RADD_DAEMON_SHELL_H
#define RADD_DAEMON_SHELL_H

#include "machine/action.h"
#include "net/conn.h"
#include "store/store.h"
#include "ground/daemon.h"
#include "ground/turns.h"

#define SHELL_BUCKETS 64

struct shell_link;

struct shell_ops {
    /* events for the machine; shell_run() follows each */
    void (*message)(void *arg, uint64_t id, const struct msg *m);
    void (*closed)(void *arg, uint64_t id, const char *why);
    void (*written)(void *arg, uint64_t id, size_t n);
    /* carry out an action of this daemon alone */
    void (*action)(void *arg, const struct action *a);
    void (*ping)(void *arg, struct msg_ping *ping); /* fill in a PING to send */
};

struct shell {
    struct daemon *daemon;       /* ends when the machine is out of memory */
    struct store *store;         /* may be NULL until it is open */
    struct action_list *actions; /* the machine's, as soon as there is one */
    const struct shell_ops *ops;
    void *arg;
    struct shell_link *links[SHELL_BUCKETS]; /* by number */
    struct shell_link *gone;                 /* closed, no event of it yet */
    uint64_t next_id;
    bool running;
    struct conn_handler handler; /* of all connections */
    struct log_limit errors;
    struct turns *turns; /* learns how long each message took; or NULL */
};

void shell_init(struct shell *s, struct daemon *daemon,
                const struct shell_ops *ops, void *arg);

/* Return a new number, for a connection that came in. */
uint64_t shell_new_id(struct shell *s);

/* Take an open stream and its session (conn.h) as connection id; false when
 * memory is out. */
bool shell_add(struct shell *s, uint64_t id, uv_stream_t *stream,
               struct tls *tls, enum msg_session session, const char *peer);

/* End the connections whose key (conn_key()) is no longer valid, as if they had
 * ended by themselves; why() says why a key is not, or returns NULL. */
typedef const char *shell_key_fn(void *arg, const char *key);
void shell_drop_keys(struct shell *s, shell_key_fn *why, void *arg);

/* The connection of that number; NULL: there is none, or it has ended. */
struct conn *shell_conn(const struct shell *s, uint64_t id);

/* Give the machine the closed event of a connection that never came about. */
void shell_gone(struct shell *s, uint64_t id, const char *why);

/* Drop a connection without an event. */
void shell_remove(struct shell *s, uint64_t id);

/* Carry out the machine's actions, and further actions that they bring about.
 */
void shell_run(struct shell *s);

/* The store has less to write: read on from connections whose reading stopped
 * for the store, if that has caught up. */
void shell_store_progress(struct shell *s);

/* Close every connection, without events. */
void shell_close(struct shell *s);

/* Fill buf with n random bytes, for tokens; arg is not used. */
void shell_random(void *arg, void *buf, size_t n);

#endif
