/* radcoord.c - the coordinator daemon: the shell around coord.h
 *
 * Everything here carries bytes: what is decided is decided in coord.c. */
#include "config.h"

#include "coord.h"
#include "daemon.h"
#include "keyorder.h"
#include "keyring.h"
#include "listen.h"
#include "log.h"
#include "recover.h"
#include "shell.h"
#include "store.h"
#include "transfer.h"

#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>
#include <unistd.h>

#define DEFAULT_LISTEN "127.0.0.1:" RADCOORD_PORT

struct settings {
    struct daemon_settings common;
    char listen[CONF_TEXT];
    char socket[CONF_TEXT];
    char state[CONF_TEXT];
    int keep_jobs, keep_days, keep_mib;
    int lease_floor_s;
    char keys[CONF_TEXT];
};

#define DEFAULT_SOCKET "/run/radd/radcoord.sock"
#define FIELD(f)       offsetof(struct settings, f)
static const struct conf_key keys[] = {
    { "listen", CONF_TEXT_KEY, FIELD(listen), 0, 0, DEFAULT_LISTEN, "ADDR:PORT",
      "where workers and users dial; empty: nowhere", false },
    { "socket", CONF_TEXT_KEY, FIELD(socket), 0, 0, DEFAULT_SOCKET, "PATH",
      "Unix socket of this machine's users; empty: none", false },
    { "state", CONF_TEXT_KEY, FIELD(state), 0, 0, "/var/lib/radd", "DIR",
      "folder of jobs, scenes, rows and pictures", false },
    { "keep_jobs", CONF_INT_KEY, FIELD(keep_jobs), 10, 100000, "100", "N",
      "jobs that are over and still remembered", true },
    { "keep_days", CONF_INT_KEY, FIELD(keep_days), 0, 36500, "30", "N",
      "for so many days at most; 0: no limit", true },
    { "keep_mib", CONF_INT_KEY, FIELD(keep_mib), 0, 1 << 30, "0", "N",
      "with so many MiB of pictures at most; 0: no limit", true },
    { "lease_floor_s", CONF_INT_KEY, FIELD(lease_floor_s), 1, 1 << 20, "60",
      "N", "a unit that is out for less is not late [s]", true },
    { "keys", CONF_TEXT_KEY, FIELD(keys), 0, 0, "", "FILE",
      "keys of who may come over the network; empty: nobody", false },
    DAEMON_KEYS,
};

static int
check_settings(const void *settings, struct rad_error *err)
{
    const struct settings *s = settings;

    if (!s->listen[0] && !s->socket[0])
        return rad_fail(err, RAD_EUSAGE, "neither 'listen' nor 'socket' set");
    return 0;
}

static const struct conf_table table = {
    .program = "radcoord",
    .synopsis = "[--listen=ADDR:PORT] [--socket=PATH] [--keys=FILE] ...",
    .about = "Coordinate a cluster that renders Radiance scenes, see "
             "radcoord(8); it stays in\nthe foreground.",
    .file = SYSCONFDIR "/radd/radcoord.conf",
    .private_key = "embedded",
    .keys = keys,
    .size = sizeof(struct settings),
    .check = check_settings,
};

#define SWEEP_MS (3600 * 1000)

struct radcoord {
    struct settings set;
    struct daemon daemon;
    struct listener *tcp, *local;
    struct keyring *keys;
    uint64_t keys_ms;  /* when they were last looked after */
    uint64_t sweep_ms; /* when files that nobody needs last went */
    struct store *store;
    struct transfers *transfers;
    struct shell shell;
    struct coord *coord;
    uint64_t clock_ms; /* what the clock on the wall is ahead of the loop's */
};

/* Never goes back in one life, and goes on with the next. */
static uint64_t
now(struct radcoord *r)
{
    return daemon_now(&r->daemon) + r->clock_ms;
}

/* --- from the connections to the machine --- */

static void
on_message(void *arg, uint64_t id, const struct msg *m)
{
    struct radcoord *r = arg;

    coord_message(r->coord, now(r), id, m);
}

static void
on_closed(void *arg, uint64_t id, const char *why)
{
    struct radcoord *r = arg;

    transfers_drop(r->transfers, id);
    coord_closed(r->coord, now(r), id, why);
}

static void
on_written(void *arg, uint64_t id, size_t n)
{
    struct radcoord *r = arg;

    (void)n;
    transfers_resume(r->transfers, id);
}

static struct action_list *
actions(void *arg)
{
    struct radcoord *r = arg;

    return coord_actions(r->coord);
}

static void
out_of_memory(void *arg)
{
    struct radcoord *r = arg;

    log_err("out of memory");
    daemon_stop(&r->daemon, EX_OSERR);
}

/* --- keys --- */

/* Why the key of a connection is no longer good; then its worker's friends
 * hear of it, too. */
static const char *
key_fault(void *arg, const char *id)
{
    struct radcoord *r = arg;
    const char *fault = keyring_fault(r->keys, id);
    struct key k;

    if (fault && key_id_parse(id, &k) && k.role == MSG_ROLE_WORKER)
        coord_expel(r->coord, now(r), k.name);
    return fault;
}

/* Take the file over as it is now, and let those go whose key it ends. */
static int
reload_keys(struct radcoord *r, struct rad_error *err)
{
    int rc = keyring_reload(r->keys, err);

    if (rc < 0)
        return rc;
    shell_drop_keys(&r->shell, key_fault, r);
    keyring_settle(r->keys);
    return 0;
}

static void
reload_keys_or_say(struct radcoord *r)
{
    struct rad_error err = { 0 };
    char text[600];

    if (reload_keys(r, &err) == 0)
        return;
    rad_error_format(&err, text, sizeof text);
    log_err("keys not reloaded: %s", text);
}

/* Every second: the file may have changed, a key may have come to its end. */
static void
look_after_keys(struct radcoord *r)
{
    if (!keyring_has_file(r->keys) || now(r) - r->keys_ms < 1000)
        return;
    r->keys_ms = now(r);
    if (keyring_changed(r->keys)) {
        log_info("key file changed");
        reload_keys_or_say(r);
    } else {
        shell_drop_keys(&r->shell, key_fault, r);
    }
}

static int
order_key(struct radcoord *r, const struct msg_key *m, char **json,
          struct rad_error *err)
{
    struct key_order order = { (enum msg_key_order)m->what, m->name,
                               (int64_t)m->expires };
    int rc;

    if (!keyring_has_file(r->keys))
        return rad_fail(err, RAD_ENOINPUT,
                        "the coordinator was started without a key file");
    rc = key_order_run(keyring_path(r->keys), &order, (int64_t)time(NULL), json,
                       err);
    if (rc < 0 || m->what == MSG_KEY_LIST)
        return rc;
    log_info("key %s name=%s", m->what == MSG_KEY_ADD ? "added" : "retired",
             m->name);
    return reload_keys(r, err);
}

/* An admin's order.  One that retires its own key hears no answer. */
static void
do_key(struct radcoord *r, const struct action *a)
{
    struct msg m = { .type = MSG_ANSWER, .request = a->request };
    struct rad_error err = { 0 };
    struct conn *c;
    char *json = NULL;
    int rc = order_key(r, &a->key, &json, &err);

    c = shell_conn(&r->shell, a->conn);
    if (rc == 0) {
        m.answer.text = (const uint8_t *)json;
        m.answer.len = strlen(json);
    } else {
        m.type = MSG_FAILED;
        m.failed = (struct msg_failed){ .status = (uint16_t)rad_exit_status(rc),
                                        .text = err.what };
    }
    if (c)
        conn_send(c, &m);
    if (json)
        explicit_bzero(json, strlen(json));
    free(json);
}

/* --- from the machine to the store --- */

static void
open_job(struct radcoord *r, const uint8_t *job)
{
    struct saved_job saved;

    if (coord_saved(r->coord, job, &saved))
        store_open_job(r->store, job, &saved);
}

static void
end_job(struct radcoord *r, const struct action *a)
{
    struct saved_job saved;

    if (coord_saved(r->coord, a->job, &saved))
        store_end_job(r->store, &saved, a->bytes, a->len);
}

static void
send_source(struct radcoord *r, const struct action *a, bool file)
{
    struct conn *c = shell_conn(&r->shell, a->conn);
    struct store_source from = { .file = file,
                                 .frame = a->frame,
                                 .what = a->what };

    if (!c)
        return;
    if (file)
        memcpy(from.hash, a->hash, MSG_HASH);
    else
        memcpy(from.job, a->job, MSG_JOB);
    transfers_start(r->transfers, a->conn, c, a->request, &from);
}

static void
on_action(void *arg, const struct action *a)
{
    struct radcoord *r = arg;

    switch (a->type) {
    case ACT_SEND_FILE:
        send_source(r, a, true);
        break;
    case ACT_SEND_PICTURE:
        send_source(r, a, false);
        break;
    case ACT_JOB_OPEN:
        open_job(r, a->job);
        break;
    case ACT_JOB_STATE:
        store_put_state(r->store, a->job, a->status);
        break;
    case ACT_JOB_END:
        end_job(r, a);
        break;
    case ACT_KEEP_UNIT:
        store_keep_unit(r->store, a->job, a->unit);
        break;
    case ACT_SETTLE:
        store_settle(r->store, a->conn, a->request);
        break;
    case ACT_PUT_ROWS:
        store_put_rows(r->store, &a->rows);
        break;
    case ACT_WRITE_PICTURE:
        store_write_picture(r->store, a->job, a->frame);
        break;
    case ACT_KEY:
        do_key(r, a);
        break;
    case ACT_JOB_FORGET:
        store_forget_job(r->store, a->job);
        break;
    default:
        log_err("action unknown type=%d", (int)a->type);
        break;
    }
}

static const struct shell_ops ops = {
    .message = on_message,
    .closed = on_closed,
    .written = on_written,
    .action = on_action,
    .actions = actions,
    .failed = out_of_memory,
};

/* --- from the store to the machine --- */

static void
settled(struct radcoord *r)
{
    shell_run(&r->shell);
    shell_store_progress(&r->shell);
}

static void
file_done(void *arg, uint64_t conn, const uint8_t hash[MSG_HASH], int status,
          const char *text)
{
    struct radcoord *r = arg;

    if (status == 0)
        coord_file_stored(r->coord, now(r), conn, hash);
    else
        coord_file_failed(r->coord, now(r), conn, hash, status, text);
    settled(r);
}

static void
job_done(void *arg, const uint8_t job[MSG_JOB], int status, const char *text)
{
    struct radcoord *r = arg;

    coord_job_opened(r->coord, now(r), job, status, text);
    settled(r);
}

static void
rows_done(void *arg, const struct action_rows *key, int status,
          const char *text)
{
    struct radcoord *r = arg;

    coord_rows_stored(r->coord, now(r), key, status, text);
    settled(r);
}

static void
picture_done(void *arg, const uint8_t job[MSG_JOB], uint32_t frame, int status,
             const char *text)
{
    struct radcoord *r = arg;

    coord_picture_written(r->coord, now(r), job, frame, status, text);
    settled(r);
}

static void
chunk_done(void *arg)
{
    struct radcoord *r = arg;

    shell_store_progress(&r->shell);
}

static void
job_filed(void *arg, const uint8_t job[MSG_JOB], uint64_t bytes)
{
    struct radcoord *r = arg;

    coord_job_filed(r->coord, now(r), job, bytes);
    settled(r);
}

static void
request_kept(void *arg, uint64_t conn, uint32_t request)
{
    struct radcoord *r = arg;

    coord_settled(r->coord, now(r), conn, request);
    settled(r);
}

static void
disk_full(void *arg, bool full, const char *text)
{
    struct radcoord *r = arg;

    coord_fullness(r->coord, now(r), full, text);
    shell_run(&r->shell);
}

/* Nothing is acknowledged from now on: what senders hear nothing of they send
 * again to the next life. */
static void
store_broken(void *arg, int status, const char *text)
{
    struct radcoord *r = arg;

    log_err("ending, for nothing can be kept any more why=%s", text);
    daemon_stop(&r->daemon, status);
}

static void
files_known(void *arg, const struct action_look *l)
{
    struct radcoord *r = arg;

    coord_looked(r->coord, now(r), l);
    shell_run(&r->shell);
}

static const struct store_handler store_handler = { .looked = files_known,
                                                    .file = file_done,
                                                    .job = job_done,
                                                    .rows = rows_done,
                                                    .picture = picture_done,
                                                    .progress = chunk_done,
                                                    .broken = store_broken,
                                                    .filed = job_filed,
                                                    .settled = request_kept,
                                                    .fullness = disk_full };

static bool
has_file(void *arg, const uint8_t hash[MSG_HASH])
{
    struct radcoord *r = arg;

    return store_has_file(r->store, hash);
}

static bool
look(void *arg, const struct action_look *l)
{
    struct radcoord *r = arg;

    return store_look(r->store, l);
}

/* --- connections --- */

/* On one machine: its root and the daemon's own user may be anything, others
 * only use it. */
static unsigned
roles_of(long uid)
{
    unsigned user = 1u << MSG_ROLE_USER;

    if (uid != 0 && uid != (long)geteuid())
        return user;
    return user | 1u << MSG_ROLE_WORKER | 1u << MSG_ROLE_ADMIN;
}

/* A key is for one role, but that who may steer may also use. */
static unsigned
roles_of_key(const struct key *k)
{
    unsigned role = 1u << k->role;

    return k->role == MSG_ROLE_ADMIN ? role | 1u << MSG_ROLE_USER : role;
}

static void
add_conn(struct radcoord *r, uv_stream_t *stream, struct tls *tls,
         const struct coord_peer *who)
{
    uint64_t id = shell_new_id(&r->shell);

    if (!shell_add(&r->shell, id, stream, tls, MSG_AT_COORD_NEW,
                   who->address)) {
        log_err("connection refused peer=%s: out of memory", who->address);
        return;
    }
    coord_opened(r->coord, now(r), id, who);
    shell_run(&r->shell);
}

static void
on_local(void *arg, uv_stream_t *stream, struct tls *tls, const char *peer)
{
    struct radcoord *r = arg;
    struct coord_peer who = { .address = peer,
                              .owner = peer,
                              .roles = roles_of(conn_stream_uid(stream)) };

    add_conn(r, stream, tls, &who);
}

static void
on_keyed(void *arg, uv_stream_t *stream, struct tls *tls, const char *peer)
{
    struct radcoord *r = arg;
    struct coord_peer who = { .address = peer };
    struct key k;

    if (!key_id_parse(tls_id(tls), &k)) { /* it is one that we have */
        tls_free(tls);
        conn_stream_close(stream);
        return;
    }
    who.owner = k.name;
    who.roles = roles_of_key(&k);
    who.name = k.role == MSG_ROLE_WORKER ? k.name : NULL;
    log_debug("connection peer=%s key=%s", peer, tls_id(tls));
    add_conn(r, stream, tls, &who);
}

static const char *
find_key(void *arg, const char *id, uint8_t *secret)
{
    struct radcoord *r = arg;

    return keyring_find(r->keys, id, secret);
}

/* The default socket is one for a system's coordinator: who has not the right
 * to make it, or runs a second one beside it, can do with an address. */
static int
open_local(struct radcoord *r, struct rad_error *err)
{
    struct rad_error why = { 0 };
    struct listener_conf conf = { .fn = on_local, .arg = r };
    char path[CONF_TEXT + 2];

    /* a path in any case: "x:80" must not become an address, where nobody
     * could tell who comes */
    snprintf(path, sizeof path, "%s%s", strchr(r->set.socket, '/') ? "" : "./",
             r->set.socket);
    r->local = listener_open(&r->daemon.loop, path, &conf, &why);
    if (r->local)
        return 0;
    if (strcmp(r->set.socket, DEFAULT_SOCKET) != 0 || !r->set.listen[0]) {
        *err = why;
        return why.code;
    }
    log_warn("going on without the default socket: %s", why.what);
    return 0;
}

static int
open_sockets(struct radcoord *r, struct rad_error *err)
{
    struct listener_conf conf = { .fn = on_keyed,
                                  .find = find_key,
                                  .anywhere = keyring_has_file(r->keys),
                                  .arg = r };
    const char *lines[2];
    int n = 0;

    if (r->set.socket[0] && open_local(r, err) < 0)
        return err->code;
    if (r->local)
        lines[n++] = listener_text(r->local);
    if (r->set.listen[0] && !(r->set.common.embedded &&
                              strcmp(r->set.listen, DEFAULT_LISTEN) == 0)) {
        r->tcp = listener_open(&r->daemon.loop, r->set.listen, &conf, err);
        if (!r->tcp)
            return err->code;
        if (!conf.anywhere)
            log_warn("nobody can come over tcp: there is no key file");
        lines[n++] = listener_text(r->tcp);
    }
    for (int i = 0; i < n; i++)
        log_info("listening on=%s", lines[i]);
    if (r->set.common.ports_file[0])
        return service_ports_file(r->set.common.ports_file, lines, n, err);
    return 0;
}

/* --- start and end --- */

/* At first, and every hour: files that no job names have no use, but that of
 * one whose user has sent them and has yet to say so. */
static void
look_after_files(struct radcoord *r)
{
    uint8_t *list;
    size_t n;

    if (r->set.common.embedded ||
        (r->sweep_ms > 0 && now(r) - r->sweep_ms < SWEEP_MS))
        return;
    r->sweep_ms = now(r);
    list = coord_files(r->coord, &n);
    if (list)
        store_sweep(r->store, list, n);
}

static void
on_tick(void *arg)
{
    struct radcoord *r = arg;

    coord_tick(r->coord, now(r));
    shell_run(&r->shell);
    look_after_keys(r);
    look_after_files(r);
}

static void
on_term(void *arg)
{
    struct radcoord *r = arg;

    daemon_stop(&r->daemon, EX_OK);
}

static void
set_keep(struct radcoord *r)
{
    struct coord_keep keep = {
        .jobs = (uint32_t)r->set.keep_jobs,
        .ms = (uint64_t)r->set.keep_days * 24 * 3600 * 1000,
        .bytes = (uint64_t)r->set.keep_mib << 20,
    };

    coord_set_keep(r->coord, &keep);
}

static void
set_lease(struct radcoord *r)
{
    coord_set_lease(r->coord, UINT64_C(1000) * (unsigned)r->set.lease_floor_s);
}

static void
on_reload(void *arg)
{
    struct radcoord *r = arg;

    reload_keys_or_say(r);
    set_keep(r);
    set_lease(r);
    shell_run(&r->shell);
}

static bool
read_row(void *arg, const uint8_t job[MSG_JOB], uint32_t frame, uint32_t y,
         uint8_t *pixels)
{
    struct radcoord *r = arg;

    return store_read_row(r->store, job, frame, y, pixels);
}

static int
recover_one(void *arg, const struct saved_job *saved, struct rad_error *err)
{
    struct radcoord *r = arg;

    return recover_job(r->coord, now(r), saved, read_row, r, err);
}

/* The state folder, and the jobs that are in it. */
static int
open_store(struct radcoord *r, struct rad_error *err)
{
    struct coord_env env = { .has_file = has_file,
                             .random = shell_random,
                             .arg = r,
                             .look = look,
                             .program = "radcoord " PACKAGE_VERSION,
                             .keeps = !r->set.common.embedded };
    uint64_t epoch;

    r->store = store_open(&r->daemon.loop, r->set.state,
                          !r->set.common.embedded, &store_handler, r, err);
    if (!r->store)
        return err->code;
    r->shell.store = r->store;
    r->transfers = transfers_new(r->store);
    r->coord = coord_new(&env);
    if (!r->transfers || !r->coord)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    if (store_recover(r->store, now(r), &epoch, recover_one, r, err) < 0)
        return err->code;
    coord_set_epoch(r->coord, epoch);
    set_keep(r);
    set_lease(r);
    return 0;
}

static int
start(void *arg, struct rad_error *err)
{
    struct radcoord *r = arg;
    uv_timeval64_t wall;

    shell_init(&r->shell, &r->daemon.loop, &ops, r);
    if (!r->set.keys[0]) /* systemd's, if it has one */
        service_credential("keys", r->set.keys, sizeof r->set.keys);
    if (keyring_open(&r->keys, r->set.keys, err) < 0)
        return err->code;
    uv_gettimeofday(&wall);
    r->clock_ms = (uint64_t)wall.tv_sec * 1000 + (uint64_t)wall.tv_usec / 1000 -
                  daemon_now(&r->daemon);
    if (open_store(r, err) < 0 || open_sockets(r, err) < 0)
        return err->code;
    shell_run(&r->shell); /* what jobs of earlier lives want */
    return 0;
}

/* What was handed to the store is still written. */
static void
finish(void *arg)
{
    struct radcoord *r = arg;

    listener_close(r->tcp);
    listener_close(r->local);
    shell_close(&r->shell);
    if (r->store)
        store_end(r->store);
    while (r->store && !store_idle(r->store))
        uv_run(&r->daemon.loop, UV_RUN_ONCE);
}

static void
release(void *arg)
{
    struct radcoord *r = arg;

    transfers_free(r->transfers);
    coord_free(r->coord);
    keyring_free(r->keys);
    store_close(r->store);
}

static const struct daemon_ops daemon_ops = { start,     on_tick, on_term,
                                              on_reload, finish,  release };

int
main(int argc, char *argv[])
{
    static struct radcoord r = { .daemon = { .table = &table,
                                             .set = &r.set.common,
                                             .ops = &daemon_ops,
                                             .arg = &r } };

    return daemon_run(&r.daemon, argc, argv);
}
