/* radcoord_impl.h - what the files of the coordinator daemon share
 *
 * Private to radcoord*.c:
 *   radcoord.c        main; events and actions of the machine, start and end
 *   radcoord_conf.c   settings: read, and told to the machine
 *   radcoord_conns.c  sockets; the roles and owners of connections
 *   radcoord_keys.c   the key file: orders, changes, keys that expire
 *   radcoord_store.c  answers of the store; jobs of earlier lives
 * These files only carry bytes; coord.c decides.
 * Thread: the loop's. */
#ifndef DAEMON_RADCOORD_IMPL_H
#define DAEMON_RADCOORD_IMPL_H

#include "front/coord.h"
#include "ground/daemon.h"
#include "net/key/keyring.h"
#include "net/listen.h"
#include "users/owner.h"
#include "shell/shell.h"
#include "store/store.h"
#include "shell/transfer.h"
#include "ground/turns.h"

#define RADCOORD_LISTEN "127.0.0.1:" RADCOORD_PORT
#define RADCOORD_SOCKET "/run/radd/radcoord.sock"

struct radcoord_settings {
    struct daemon_settings common;
    char listen[CONF_TEXT];
    char socket[CONF_TEXT];
    char state[CONF_TEXT];
    int keep_jobs, keep_days, keep_mib, keep_caches_mib, keep_unfetched_days;
    int user_unfetched;
    int lease_floor_s;
    int user_jobs, user_frames, user_mib;
    int user_uploads, user_upload_mib;
    int user_connections, user_answers, user_unread_mib;
    int upload_s;
    char keys[CONF_TEXT];
    char logins[CONF_TEXT];
};

/* The key by which a worker last came. */
struct worker_key {
    char name[MSG_MAX_NAME + 1], id[KEY_ID];
};

struct radcoord {
    struct radcoord_settings set;
    struct daemon daemon;
    struct listener *tcp, *local;
    struct keyring *keys;
    struct worker_key *worker_keys; /* by which workers came in this life, and
                                     * that did not end since */
    size_t nworker_keys;
    struct owners *owners;
    uint64_t keys_ms;  /* when the key file was last looked at */
    uint64_t sweep_ms; /* when unneeded files were last removed */
    struct store *store;
    struct transfers *transfers;
    struct shell shell;
    struct fair fair;
    struct turns turns;
    bool lost_conns;  /* connections closed since trim_ms */
    uint64_t trim_ms; /* when memory was last returned to the system */
    uv_work_t trim;   /* work of a pool thread: return memory to the system */
    bool trimming;    /* that work is under way */
    struct coord *coord;
    uint64_t clock_ms; /* the coordinator's time less the loop's */
    uint64_t slept_ms; /* sleep of the machine before radcoord started */
    uint64_t noted_ms; /* the date that the store was last told */
};

/* The coordinator's time [ms]: begins at the wall clock's time when radcoord
 * starts, if that can be right, and never goes back while it runs. */
static inline uint64_t
radcoord_now(struct radcoord *r)
{
    return daemon_now(&r->daemon) + r->clock_ms;
}

/* --- radcoord_conf.c --- */

extern const struct conf_table radcoord_table;

/* Tell the machine its settings, at the start and when they have changed. */
void radcoord_apply(struct radcoord *r);

/* --- radcoord_conns.c --- */

/* Take a connection that came by the Unix socket, of this owner; it is closed
 * if owner is NULL: the login could not be looked up. */
void radcoord_on_login(void *arg, uv_stream_t *stream, const char *owner);
/* Listen at the Unix socket and at the address of the settings. */
int radcoord_listen(struct radcoord *r, struct rad_error *err);

/* Answer a SUBMIT by FAILED. */
void radcoord_refuse_submit(struct radcoord *r, uint64_t id,
                            const struct msg *m, int status, const char *text);

/* --- radcoord_keys.c --- */

/* A worker comes by the key k, whose id is id: when the key ends the worker is
 * expelled, connected or not.  False: memory is out. */
bool radcoord_note_key(struct radcoord *r, const struct key *k, const char *id);
/* Read the key file again; log why if that fails. */
void radcoord_reload_keys(struct radcoord *r);
/* Look whether the key file has changed or a key has expired; called each tick.
 */
void radcoord_tick_keys(struct radcoord *r);
/* Carry out an administrator's order about keys (ACT_KEY). */
void radcoord_do_key(struct radcoord *r, const struct action *a);

/* --- radcoord_store.c --- */

/* Open the state folder and recover its jobs. */
int radcoord_open_store(struct radcoord *r, struct rad_error *err);
/* Note the date, and remove files that no job needs, now and then; called each
 * tick. */
void radcoord_tick_store(struct radcoord *r);

#endif
