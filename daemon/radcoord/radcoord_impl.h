/* radcoord_impl.h - what the files of the coordinator daemon share
 *
 * Private to radcoord*.c:
 *   radcoord.c        main; events and actions of the machine, start and end
 *   radcoord_conf.c   settings, and what the machine is told of them
 *   radcoord_conns.c  sockets, and who comes by them as what
 *   radcoord_keys.c   the key file: orders, changes, keys that end
 *   radcoord_store.c  what the disk has done; jobs of earlier lives
 * Everything in them carries bytes: what is decided is decided in coord.c.
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

struct radcoord {
    struct radcoord_settings set;
    struct daemon daemon;
    struct listener *tcp, *local;
    struct keyring *keys;
    struct owners *owners;
    uint64_t keys_ms;  /* when they were last looked after */
    uint64_t sweep_ms; /* when files that nobody needs last went */
    struct store *store;
    struct transfers *transfers;
    struct shell shell;
    struct fair fair;
    struct turns turns;
    bool lost_conns;  /* since memory was given back */
    uint64_t trim_ms; /* when that was */
    struct coord *coord;
    uint64_t clock_ms; /* what the clock on the wall is ahead of the loop's */
};

/* Never goes back in one life, and goes on with the next. */
static inline uint64_t
radcoord_now(struct radcoord *r)
{
    return daemon_now(&r->daemon) + r->clock_ms;
}

/* --- radcoord_conf.c --- */

extern const struct conf_table radcoord_table;

/* Tell the machine what is set; again when that has changed. */
void radcoord_apply(struct radcoord *r);

/* --- radcoord_conns.c --- */

/* The connection is of that login, or NULL: it cannot be found. */
void radcoord_on_login(void *arg, uv_stream_t *stream, const char *owner);
int radcoord_listen(struct radcoord *r, struct rad_error *err);

/* FAILED, in answer to a SUBMIT. */
void radcoord_refuse_submit(struct radcoord *r, uint64_t id,
                            const struct msg *m, int status, const char *text);

/* --- radcoord_keys.c --- */

/* Take the key file over as it is now, or log why it cannot be. */
void radcoord_reload_keys(struct radcoord *r);
void radcoord_tick_keys(struct radcoord *r);
/* An admin's order. */
void radcoord_do_key(struct radcoord *r, const struct action *a);

/* --- radcoord_store.c --- */

/* The state folder, and the jobs that are in it. */
int radcoord_open_store(struct radcoord *r, struct rad_error *err);
void radcoord_tick_files(struct radcoord *r);

#endif
