/* radd.c - the worker daemon: the shell around worker.h
 *
 * This file only carries bytes: worker.c decides, and children render
 * (render.c). */
#include "config.h"

#include "radd/children.h"
#include "ground/daemon.h"
#include "net/dial.h"
#include "radd/hours.h"
#include "radd/idle.h"
#include "radd/launched.h"
#include "radd/radd_conf.h"
#include "net/key/keyfile.h"
#include "net/listen.h"
#include "net/log.h"
#include "child/render.h"
#include "child/sandbox.h"
#include "shell/shell.h"
#include "store/store.h"
#include "worker/worker.h"

#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>

static uint64_t
cache_bytes_of(const struct radd_settings *s)
{
    return (uint64_t)s->cache_mib << 20;
}

static bool
needs_sandbox(const struct radd_settings *s)
{
    return strcmp(s->sandbox, "required") == 0;
}

struct radd {
    struct radd_settings set;
    struct daemon daemon;
    struct listener *peers;
    struct dialler *dialler;
    struct dial_key key; /* of this host; id empty: none */
    struct store *store;
    struct shell shell;
    struct children children;
    struct launched launched; /* if radsubmit's launcher started this worker */
    struct hours hours;       /* set.hours, parsed */
    struct idle idle;
    uint64_t hours_ms; /* when judge_work() was last called */
    uint32_t load;     /* load of this host as in struct msg_ping, measured at
                        * load_ms */
    uint64_t load_ms;
    struct worker *worker;
};

static uint64_t
now(struct radd *r)
{
    return daemon_now(&r->daemon);
}

/* Rows without ACK [bytes] above which their job's child is held. */
#define KEPT_HIGH ((size_t)64 << 20)

/* --- from connections and children to the machine --- */

/* Is the child to be held?  A child_hold_fn. */
static bool
judge_child(void *arg, uint64_t id, bool held)
{
    struct radd *r = arg;
    const struct conn *coord = shell_conn(&r->shell, worker_coord(r->worker));
    size_t waits = coord ? conn_queued(coord) : 0;
    size_t kept = worker_kept(r->worker, id), part = held ? 2 : 1;
    bool hold = waits > CONN_HIGH / part || kept > KEPT_HIGH / part;

    if (hold == held)
        return held;
    log_info(hold ? "child waits id=%llu kept=%zu queued=%zu"
                  : "child goes on id=%llu kept=%zu queued=%zu",
             (unsigned long long)(id & ~ACT_OWN_CONN), kept, waits);
    worker_hold(r->worker, id, hold);
    return hold;
}

/* Stop reading from a child while the coordinator takes rows more slowly than
 * it makes them, and go on when half of the bytes have left.  A child whose
 * messages are not read has its threads wait.  Rows of one job hold up no other
 * job: the coordinator may start that first. */
static void
balance_flow(struct radd *r)
{
    children_hold(&r->children, judge_child);
}

static void
on_message(void *arg, uint64_t id, const struct msg *m)
{
    struct radd *r = arg;

    worker_message(r->worker, now(r), id, m);
    balance_flow(r);
}

static void
on_closed(void *arg, uint64_t id, const char *why)
{
    struct radd *r = arg;

    if (!children_closed(&r->children, id, why))
        worker_closed(r->worker, now(r), id, why);
}

static void
on_written(void *arg, uint64_t id, size_t n)
{
    struct radd *r = arg;

    worker_written(r->worker, now(r), id, n);
}

static void
tell_ping(void *arg, struct msg_ping *ping)
{
    struct radd *r = arg;
    double mean[3];

    if (r->load_ms == 0 || now(r) - r->load_ms >= CONN_PING_MS) {
        uv_loadavg(mean);
        r->load = mean[0] > 0 ? (uint32_t)(100 * mean[0] + .5) : 0;
        r->load_ms = now(r);
    }
    ping->progress = worker_progress(r->worker);
    ping->load = r->load;
}

/* Is this a signal by which an administrator, or the kernel for want of memory,
 * ends a child? */
static bool
killed_from_outside(int signum)
{
    return signum == SIGKILL || signum == SIGTERM || signum == SIGINT ||
           signum == SIGHUP;
}

static void
on_child_ended(void *arg, uint64_t id, struct child_end how, const char *text)
{
    struct radd *r = arg;
    int status = how.signal <= 0                   ? how.status
                 : killed_from_outside(how.signal) ? EX_OSERR
                                                   : EX_SOFTWARE;

    worker_child_ended(r->worker, now(r), id, status, text);
    shell_run(&r->shell);
}

static void
on_dialled(void *arg, uint64_t id, uv_stream_t *stream, struct tls *tls,
           const char *peer, const struct rad_error *why)
{
    struct radd *r = arg;

    if (!stream) {
        if (r->launched.welcome && why->code == UV_ECONNREFUSED &&
            id == worker_coord(r->worker))
            daemon_stop(&r->daemon, EX_OK); /* the coordinator has ended */
        shell_gone(&r->shell, id, why->what);
        return;
    }
    if (!shell_add(&r->shell, id, stream, tls, MSG_AT_DIALLER, peer)) {
        shell_gone(&r->shell, id, "out of memory");
        return;
    }
    worker_opened(r->worker, now(r), id);
    shell_run(&r->shell);
}

static void
on_peer(void *arg, uv_stream_t *stream, struct tls *tls, const char *peer)
{
    struct radd *r = arg;
    uint64_t id = shell_new_id(&r->shell);

    if (!shell_add(&r->shell, id, stream, tls, MSG_AT_PEER_NEW, peer)) {
        log_err("connection refused peer=%s: out of memory", peer);
        return;
    }
    worker_accepted(r->worker, now(r), id);
    shell_run(&r->shell);
}

/* --- keys --- */

/* Read the worker's key, and take its name if none is set.  If the file has no
 * worker's key, a key of another role is taken, which the coordinator refuses.
 * The file is read at each dial, so a new key needs no restart. */
static int
read_key(struct radd *r, struct rad_error *err)
{
    struct key k;
    int rc;

    if (!r->set.key[0])
        return 0;
    rc = keyfile_choose(r->set.key, MSG_ROLE_WORKER, r->key.id, r->key.secret,
                        &r->key.expires, err);
    if (rc == 0 && !r->set.name[0] && key_id_parse(r->key.id, &k))
        snprintf(r->set.name, sizeof r->set.name, "%s", k.name);
    return rc;
}

static void
dial_coordinator(struct radd *r, uint64_t id)
{
    struct rad_error err = { 0 };
    char text[600];

    if (read_key(r, &err) < 0) { /* go on with the key that was read before */
        rad_error_format(&err, text, sizeof text);
        log_err("key not read: %s", text);
    }
    if (!dial(r->dialler, r->set.coordinator, id,
              r->key.id[0] ? &r->key : NULL))
        log_out_of_memory(); /* else the worker would wait for ever */
}

static void
dial_peer(struct radd *r, const struct action *a)
{
    struct dial_key key = { .expires = 0 };
    bool made =
        tls_peer_key(a->job, MSG_JOB, a->token, MSG_TOKEN, key.id, key.secret);

    if (!dial(r->dialler, a->text, a->conn, made ? &key : NULL))
        log_out_of_memory(); /* else the worker would wait for ever */
    explicit_bzero(&key, sizeof key);
}

struct wanted {
    const char *id;
    uint8_t *secret;
};

static bool
fits(void *arg, const uint8_t job[MSG_JOB], const uint8_t token[MSG_TOKEN])
{
    struct wanted *w = arg;
    struct dial_key key;
    bool same;

    same = tls_peer_key(job, MSG_JOB, token, MSG_TOKEN, key.id, key.secret) &&
           strcmp(key.id, w->id) == 0;
    if (same)
        memcpy(w->secret, key.secret, TLS_SECRET);
    explicit_bzero(&key, sizeof key);
    return same;
}

/* Find the key of a link with a peer, which the coordinator gives to both
 * workers.  The peer may get it first; then the handshake waits until we have
 * it, too (TLS_LATER). */
static const char *
find_peer(void *arg, const char *id, uint8_t *secret)
{
    struct radd *r = arg;
    struct wanted w = { id, secret };

    if (worker_peer_token(r->worker, fits, &w))
        return NULL;
    return strncmp(id, "peer:", 5) == 0 ? TLS_LATER : "unknown key";
}

/* --- from the machine --- */

static void
on_action(void *arg, const struct action *a)
{
    struct radd *r = arg;

    switch (a->type) {
    case ACT_DIAL:
        if (r->daemon.stopping) /* finish() has closed the dialler, or will */
            break;
        if (a->token)
            dial_peer(r, a);
        else
            dial_coordinator(r, a->conn);
        break;
    case ACT_SPAWN:
        if (!r->daemon.stopping) /* the store may end a look after finish() */
            children_spawn(&r->children, a->conn, a->memory_mib);
        break;
    case ACT_KILL:
        children_kill(&r->children, a->conn);
        break;
    case ACT_STOP:
        daemon_stop(&r->daemon, a->status);
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
    .ping = tell_ping,
};

/* --- the store --- */

static void
file_done(void *arg, uint64_t conn, const uint8_t hash[MSG_HASH], int status,
          const char *text)
{
    struct radd *r = arg;

    (void)conn;
    if (status == 0)
        worker_file_stored(r->worker, now(r), hash);
    else
        worker_file_failed(r->worker, now(r), hash, status, text);
    shell_run(&r->shell);
    shell_store_progress(&r->shell);
}

static void
chunk_done(void *arg)
{
    struct radd *r = arg;

    shell_store_progress(&r->shell);
}

static void
files_known(void *arg, const struct action_look *l)
{
    struct radd *r = arg;

    worker_looked(r->worker, now(r), l);
    shell_run(&r->shell);
}

static const struct store_handler store_handler = { .looked = files_known,
                                                    .file = file_done,
                                                    .progress = chunk_done };

static bool
look(void *arg, const struct action_look *l)
{
    struct radd *r = arg;

    return store_look(r->store, l);
}

static void
leave(void *arg, const uint8_t job[MSG_JOB])
{
    struct radd *r = arg;

    store_leave(r->store, job);
}

static bool
has_file(void *arg, const uint8_t hash[MSG_HASH])
{
    struct radd *r = arg;

    return store_check_file(r->store, hash);
}

/* --- start and end --- */

/* Why the machine may not work now, by its hours and by idle_only; 0: it may.
 */
static enum msg_drain_why
judge_work(struct radd *r)
{
    time_t t = time(NULL);
    struct tm tm;

    tzset(); /* the machine's time zone may change */
    if (!localtime_r(&t, &tm) ||
        !hours_open(&r->hours, tm.tm_wday, 60 * tm.tm_hour + tm.tm_min))
        return MSG_DRAIN_HOURS;
    return r->set.idle_only && idle_look(&r->idle, now(r)) ? MSG_DRAIN_IN_USE
                                                           : 0;
}

/* Judge again if IDLE_LOOK_MS have passed, or at once. */
static void
look_at_clock(struct radd *r, bool at_once)
{
    if (!at_once && now(r) - r->hours_ms < IDLE_LOOK_MS)
        return;
    r->hours_ms = now(r);
    worker_allow(r->worker, now(r), judge_work(r));
}

/* A launched worker ends with its coordinator, which will not come back. */
static void
watch_coordinator(struct radd *r)
{
    bool there = shell_conn(&r->shell, worker_coord(r->worker)) != NULL;

    if (r->set.launched && launched_over(&r->launched, now(r), there))
        daemon_stop(&r->daemon, r->launched.welcome ? EX_OK : EX_UNAVAILABLE);
}

static void
on_tick(void *arg)
{
    struct radd *r = arg;

    watch_coordinator(r);
    look_at_clock(r, false);
    worker_tick(r->worker, now(r));
    balance_flow(r);
    shell_run(&r->shell);
}

static void
on_term(void *arg)
{
    struct radd *r = arg;

    worker_drain(r->worker, now(r));
    shell_run(&r->shell);
}

static void
on_reload(void *arg)
{
    struct radd *r = arg;

    r->children.conf.memory_mib = r->set.memory_mib;
    r->children.conf.nice = r->set.nice;
    r->children.conf.pixel_s = r->set.pixel_s;
    if (!r->set.common.embedded)
        store_limit(r->store, cache_bytes_of(&r->set), NULL);
    worker_set_limits(r->worker, (unsigned)r->set.load_s);
    hours_parse(r->set.hours, &r->hours, NULL);
    look_at_clock(r, true);
    shell_run(&r->shell);
}

static int
open_socket(struct radd *r, struct rad_error *err)
{
    struct listener_conf conf = { .fn = on_peer,
                                  .find = find_peer,
                                  .anywhere = r->key.id[0] != '\0',
                                  .arg = r };
    const char *line;

    r->peers = listener_open(&r->daemon.loop, r->set.listen, &conf, err);
    if (!r->peers)
        return err->code;
    line = listener_text(r->peers);
    log_info("listening on=%s", line);
    if (r->set.common.ports_file[0])
        return service_ports_file(r->set.common.ports_file, &line, 1, err);
    return 0;
}

static int
make_worker(struct radd *r, struct rad_error *err)
{
    struct children_conf conf = { .files_dir = store_files_dir(r->store),
                                  .threads = r->set.threads,
                                  .memory_mib = r->set.memory_mib,
                                  .nice = r->set.nice,
                                  .pixel_s = r->set.pixel_s,
                                  .sandboxed = needs_sandbox(&r->set) };
    struct worker_env env = { .has_file = has_file,
                              .random = shell_random,
                              .arg = r,
                              .look = look,
                              .leave = leave,
                              .program = "radd " PACKAGE_VERSION,
                              .name = r->set.name,
                              .coordinator = r->set.coordinator,
                              .address = listener_text(r->peers),
                              .threads = (unsigned)r->set.threads,
                              .one_disk =
                                  r->set.common.embedded && !r->set.launched,
                              .load_s = (unsigned)r->set.load_s };

    children_init(&r->children, &r->shell, &conf, on_child_ended, r);
    r->worker = worker_new(&env);
    if (!r->worker)
        return rad_fail_memory(err);
    r->shell.actions = worker_actions(r->worker);
    return 0;
}

/* Log which means the children's sandbox lacks here.  RAD_EPERM: the settings
 * require these. */
static int
check_sandbox(const struct radd *r, struct rad_error *err)
{
    bool refuse;
    const char *lacks = sandbox_lacks(&refuse);

    if (lacks && refuse && needs_sandbox(&r->set))
        return rad_fail(err, RAD_EPERM,
                        "sandbox is required, and the kernel lacks %s", lacks);
    if (lacks)
        log_warn("sandbox incomplete lacks=%s", lacks);
    return 0;
}

/* Check that we have a key if the coordinator is at the other end of a network.
 */
static int
check_coordinator(const struct radd *r, struct rad_error *err)
{
    char host[ADDRESS_TEXT], port[8];
    bool local;
    int rc = address_split(r->set.coordinator, host, port, &local, err);

    if (rc < 0 || local || r->key.id[0])
        return rc;
    return rad_fail(err, RAD_EPERM,
                    "a coordinator at '%s' asks for a key: use --key, or a "
                    "Unix socket on its own machine",
                    r->set.coordinator);
}

/* Take the job's key, and set the settings that the launcher's arguments leave
 * out. */
static int
begin_launched(struct radd *r, struct rad_error *err)
{
    int rc = launched_key(&r->key, err);

    if (rc == 0)
        rc = launched_begin(&r->launched, err);
    if (rc < 0)
        return rc;
    snprintf(r->set.cache, sizeof r->set.cache, "%s", r->launched.folder);
    snprintf(r->set.listen, sizeof r->set.listen, "*:0");
    if (!r->set.name[0])
        launched_name(r->set.name, MSG_MAX_NAME + 1);
    return 0;
}

/* Find the key, the coordinator's address and this worker's name. */
static int
find_identity(struct radd *r, struct rad_error *err)
{
    size_t n = MSG_MAX_NAME + 1;
    int rc = 0;

    if (r->set.launched)
        rc = begin_launched(r, err);
    else if (!r->set.key[0]) /* else the key file that systemd passes, if any */
        service_credential("key", r->set.key, sizeof r->set.key);
    if (rc == 0)
        rc = read_key(r, err);
    if (rc == 0)
        rc = check_coordinator(r, err);
    if (rc == 0 && !r->set.name[0] && uv_os_gethostname(r->set.name, &n) < 0)
        rc = rad_fail(err, RAD_EUSAGE, "no host name: 'name' must be set");
    return rc;
}

static int
open_store(struct radd *r, struct rad_error *err)
{
    /* not durable: a file that power was lost under is found spoilt, for each
     * is compared with its hash after a start, and the coordinator sends it
     * again */
    r->store = store_open(&r->daemon.loop, r->set.cache, false, &store_handler,
                          r, err);
    if (!r->store)
        return err->code;
    r->shell.store = r->store;
    if (r->set.common.embedded) /* the folder goes at the end: no limit */
        return 0;
    return store_limit(r->store, cache_bytes_of(&r->set), err);
}

static int
start(void *arg, struct rad_error *err)
{
    struct radd *r = arg;
    int rc;

    shell_init(&r->shell, &r->daemon, &ops, r);
    rc = check_sandbox(r, err);
    if (rc < 0)
        return rc;
    if (!r->set.threads)
        r->set.threads = (int)uv_available_parallelism();
    r->dialler = dialler_new(&r->daemon.loop, on_dialled, r);
    if (!r->dialler)
        return rad_fail_memory(err);
    if ((rc = find_identity(r, err)) < 0 || (rc = open_store(r, err)) < 0 ||
        (rc = open_socket(r, err)) < 0 || (rc = make_worker(r, err)) < 0)
        return rc;
    hours_parse(r->set.hours, &r->hours, NULL);
    look_at_clock(r, true);
    worker_start(r->worker, now(r));
    shell_run(&r->shell);
    return 0;
}

static void
finish(void *arg)
{
    struct radd *r = arg;

    listener_close(r->peers);
    dialler_close(r->dialler);
    children_kill_all(&r->children);
    shell_close(&r->shell);
    launched_end(&r->launched); /* early: SIGKILL may follow soon */
    while (r->store && !store_idle(r->store))
        uv_run(&r->daemon.loop, UV_RUN_ONCE);
}

static void
release(void *arg)
{
    struct radd *r = arg;

    worker_free(r->worker);
    explicit_bzero(&r->key, sizeof r->key);
    store_close(r->store);
    launched_end(&r->launched);
}

static const struct daemon_ops daemon_ops = { start,     on_tick, on_term,
                                              on_reload, finish,  release };

int
main(int argc, char *argv[])
{
    static struct radd r = { .daemon = { .table = &radd_table,
                                         .set = &r.set.common,
                                         .ops = &daemon_ops,
                                         .arg = &r } };

    if (argc > 1 && strcmp(argv[1], RENDER_CHILD_OPTION) == 0)
        return render_main(argc, argv);
    return daemon_run(&r.daemon, argc, argv);
}
