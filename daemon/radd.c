/* radd.c - the worker daemon: the shell around worker.h
 *
 * Everything here carries bytes: what is decided is decided in worker.c, and
 * what is rendered is rendered in children (render.c). */
#include "config.h"

#include "children.h"
#include "conf.h"
#include "dial.h"
#include "listen.h"
#include "log.h"
#include "render.h"
#include "service.h"
#include "shell.h"
#include "store.h"
#include "worker.h"

#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

#define TICK_MS     100
#define MAX_THREADS 1024

struct settings {
    char coordinator[CONF_TEXT];
    char name[CONF_TEXT];
    char listen[CONF_TEXT];
    char cache[CONF_TEXT];
    char ports_file[CONF_TEXT];
    char log_level[CONF_TEXT];
    int threads;
    int memory_mib;
    bool embedded;
    int lifetime_fd;
};

#define FIELD(f) offsetof(struct settings, f)
static const struct conf_key keys[] = {
    { "coordinator", CONF_TEXT_KEY, FIELD(coordinator), 0, 0,
      "127.0.0.1:" RADCOORD_PORT, "HOST:PORT|PATH", "whom to work for", false },
    { "name", CONF_TEXT_KEY, FIELD(name), 0, 0, "", "NAME",
      "of this worker, unlike all others (the host's name)", false },
    { "listen", CONF_TEXT_KEY, FIELD(listen), 0, 0, "127.0.0.1:" RADD_PORT,
      "ADDR:PORT|PATH", "where other workers dial", false },
    { "cache", CONF_TEXT_KEY, FIELD(cache), 0, 0, "/var/cache/radd", "DIR",
      "folder of the scenes' files", false },
    { "threads", CONF_INT_KEY, FIELD(threads), 0, MAX_THREADS, "0", "N",
      "that render; 0: one a processor", false },
    { "memory_mib", CONF_INT_KEY, FIELD(memory_mib), 0, 1 << 24, "0", "N",
      "most memory of a job's process [MiB]; 0: no limit", true },
    { "ports_file", CONF_TEXT_KEY, FIELD(ports_file), 0, 0, "", "FILE",
      "gets the sockets in use, one a line", false },
    { "log_level", CONF_TEXT_KEY, FIELD(log_level), 0, 0, "info", "LEVEL",
      "err, warn, info or debug", true },
    /* as in radcoord.c */
    { "embedded", CONF_BOOL_KEY, FIELD(embedded), 0, 0, "no", NULL, NULL,
      false },
    { "lifetime_fd", CONF_INT_KEY, FIELD(lifetime_fd), -1, 1 << 20, "-1", NULL,
      NULL, false },
    { NULL, 0, 0, 0, 0, NULL, NULL, NULL, false },
};

static int
check_settings(const void *settings, struct rad_error *err)
{
    const struct settings *s = settings;

    if (log_level_parse(s->log_level) < 0)
        return rad_fail(err, RAD_EUSAGE, "unknown log level '%s'",
                        s->log_level);
    if (strlen(s->name) > MSG_MAX_NAME)
        return rad_fail(err, RAD_EUSAGE, "name longer than %d bytes",
                        MSG_MAX_NAME);
    if (!s->listen[0] || !s->coordinator[0])
        return rad_fail(err, RAD_EUSAGE, "'%s' is not set",
                        s->listen[0] ? "coordinator" : "listen");
    return 0;
}

static const struct conf_table table = {
    .program = "radd",
    .synopsis = "[--coordinator=HOST:PORT|PATH] [--threads=N] ...",
    .file = SYSCONFDIR "/radd/radd.conf",
    .private_key = "embedded",
    .keys = keys,
    .size = sizeof(struct settings),
    .check = check_settings,
};

struct radd {
    struct settings set;
    int argc;
    char **argv;
    uv_loop_t loop;
    uv_timer_t ticker;
    uv_signal_t term, intr, hup;
    struct service_lifetime lifetime;
    struct listener *peers;
    struct store *store;
    struct shell shell;
    struct children children;
    struct worker *worker;
    bool stopping;
    int status;
};

static uint64_t
now(struct radd *r)
{
    return uv_now(&r->loop);
}

static void
stop(struct radd *r, int status)
{
    if (r->stopping)
        return;
    r->stopping = true;
    r->status = status;
    service_notify("STOPPING=1");
    uv_stop(&r->loop);
}

/* --- from connections and children to the machine --- */

static void
on_message(void *arg, uint64_t id, const struct msg *m)
{
    struct radd *r = arg;

    worker_message(r->worker, now(r), id, m);
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

static uint64_t
progress(void *arg)
{
    struct radd *r = arg;

    return worker_progress(r->worker);
}

static struct action_list *
actions(void *arg)
{
    struct radd *r = arg;

    return worker_actions(r->worker);
}

static void
out_of_memory(void *arg)
{
    log_err("out of memory");
    stop(arg, EX_OSERR);
}

static void
on_child_ended(void *arg, uint64_t id, const char *text)
{
    struct radd *r = arg;

    worker_child_ended(r->worker, now(r), id, text);
    shell_run(&r->shell);
}

static void
on_dialled(void *arg, uint64_t id, uv_stream_t *stream, const char *peer,
           const char *why)
{
    struct radd *r = arg;

    if (r->stopping) {
        if (stream)
            conn_stream_close(stream);
        return;
    }
    if (!stream) {
        shell_gone(&r->shell, id, why);
        return;
    }
    if (!shell_add(&r->shell, id, stream, MSG_AT_DIALLER, peer)) {
        shell_gone(&r->shell, id, "out of memory");
        return;
    }
    worker_opened(r->worker, now(r), id);
    shell_run(&r->shell);
}

static void
on_peer(void *arg, uv_stream_t *stream, const char *peer)
{
    struct radd *r = arg;
    uint64_t id = shell_new_id(&r->shell);

    if (!shell_add(&r->shell, id, stream, MSG_AT_PEER_NEW, peer)) {
        log_err("connection refused peer=%s: out of memory", peer);
        return;
    }
    worker_accepted(r->worker, now(r), id);
    shell_run(&r->shell);
}

/* --- from the machine --- */

static void
on_action(void *arg, const struct action *a)
{
    struct radd *r = arg;

    switch (a->type) {
    case ACT_DIAL:
        dial(&r->loop, a->text && a->text[0] ? a->text : r->set.coordinator,
             a->conn, on_dialled, r);
        break;
    case ACT_SPAWN:
        children_spawn(&r->children, a->conn);
        break;
    case ACT_KILL:
        children_kill(&r->children, a->conn);
        break;
    case ACT_STOP:
        stop(r, EX_OK);
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
    .progress = progress,
    .failed = out_of_memory,
};

/* --- the cache --- */

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

static const struct store_handler store_handler = { .file = file_done };

static bool
has_file(void *arg, const uint8_t hash[MSG_HASH])
{
    struct radd *r = arg;

    return store_has_file(r->store, hash);
}

/* --- time and signals --- */

static void
on_tick(uv_timer_t *t)
{
    struct radd *r = t->data;

    worker_tick(r->worker, now(r));
    shell_run(&r->shell);
}

static void
on_term(uv_signal_t *sig, int signum)
{
    struct radd *r = sig->data;

    if (r->stopping)
        _exit(EX_TEMPFAIL);
    log_info("draining signal=%d", signum);
    service_notify("STOPPING=1");
    worker_drain(r->worker, now(r));
    shell_run(&r->shell);
}

static void
on_hup(uv_signal_t *sig, int signum)
{
    struct radd *r = sig->data;
    struct rad_error err = { 0 };
    char text[600];

    (void)signum;
    service_notify("RELOADING=1");
    if (conf_reload(&table, &r->set, r->argc, r->argv, &err) < 0) {
        rad_error_format(&err, text, sizeof text);
        log_err("reload failed: %s", text);
    } else {
        log_set_level((enum log_level)log_level_parse(r->set.log_level));
        r->children.conf.memory_mib = r->set.memory_mib;
        log_info("reloaded");
    }
    service_notify("READY=1");
}

static void
on_lifetime_end(void *arg)
{
    log_debug("stopping: whoever started this is gone");
    stop(arg, EX_OK);
}

static void
catch_signal(struct radd *r, uv_signal_t *sig, uv_signal_cb cb, int signum)
{
    uv_signal_init(&r->loop, sig);
    sig->data = r;
    uv_signal_start(sig, cb, signum);
}

/* --- start and end --- */

static int
processors(void)
{
    cpu_set_t set;

    if (sched_getaffinity(0, sizeof set, &set) < 0)
        return 1;
    return CPU_COUNT(&set) > 0 ? CPU_COUNT(&set) : 1;
}

static int
open_socket(struct radd *r, struct rad_error *err)
{
    const char *line;

    r->peers = listener_open(&r->loop, r->set.listen, on_peer, r, err);
    if (!r->peers)
        return err->code;
    line = listener_text(r->peers);
    log_info("listening on=%s", line);
    if (r->set.ports_file[0])
        return service_ports_file(r->set.ports_file, &line, 1, err);
    return 0;
}

static int
make_worker(struct radd *r, struct rad_error *err)
{
    struct children_conf conf = { .files_dir = store_files_dir(r->store),
                                  .threads = r->set.threads,
                                  .memory_mib = r->set.memory_mib };
    struct worker_env env = { .has_file = has_file,
                              .random = shell_random,
                              .arg = r,
                              .program = "radd " PACKAGE_VERSION,
                              .name = r->set.name,
                              .address = listener_text(r->peers),
                              .threads = (unsigned)r->set.threads };

    children_init(&r->children, &r->shell, &conf, on_child_ended, r);
    r->worker = worker_new(&env);
    if (!r->worker)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    return 0;
}

static int
start(struct radd *r, struct rad_error *err)
{
    size_t n = MSG_MAX_NAME + 1;

    if (!r->set.threads)
        r->set.threads = processors();
    if (!r->set.name[0] && uv_os_gethostname(r->set.name, &n) < 0)
        return rad_fail(err, RAD_EUSAGE, "no host name: 'name' must be set");
    r->store = store_open(&r->loop, r->set.cache, !r->set.embedded,
                          &store_handler, r, err);
    if (!r->store)
        return err->code;
    r->shell.store = r->store;
    if (open_socket(r, err) < 0 || make_worker(r, err) < 0 ||
        service_watch_lifetime(&r->lifetime, &r->loop, r->set.lifetime_fd,
                               on_lifetime_end, r, err) < 0)
        return err->code;
    uv_timer_init(&r->loop, &r->ticker);
    r->ticker.data = r;
    uv_timer_start(&r->ticker, on_tick, TICK_MS, TICK_MS);
    catch_signal(r, &r->term, on_term, SIGTERM);
    catch_signal(r, &r->intr, on_term, SIGINT);
    catch_signal(r, &r->hup, on_hup, SIGHUP);
    worker_start(r->worker, now(r));
    shell_run(&r->shell);
    return 0;
}

static void
close_own(void *handle)
{
    uv_handle_t *h = handle;

    if (h->type != UV_UNKNOWN_HANDLE) /* was started */
        uv_close(h, NULL);
}

static void
finish(struct radd *r)
{
    listener_close(r->peers);
    children_kill_all(&r->children);
    shell_close(&r->shell);
    while (r->store && !store_idle(r->store))
        uv_run(&r->loop, UV_RUN_ONCE);
    close_own(&r->ticker);
    close_own(&r->term);
    close_own(&r->intr);
    close_own(&r->hup);
    close_own(&r->lifetime.poll);
    uv_run(&r->loop, UV_RUN_DEFAULT);
    worker_free(r->worker);
    store_close(r->store);
    uv_loop_close(&r->loop);
}

static int
fail(const struct rad_error *err)
{
    char text[600];

    rad_error_format(err, text, sizeof text);
    fprintf(stderr, "radd: %s\n", text);
    return rad_exit_status(err->code);
}

int
main(int argc, char *argv[])
{
    static struct radd r;
    struct rad_error err = { 0 };
    int rc;

    if (argc > 1 && strcmp(argv[1], RENDER_CHILD_OPTION) == 0)
        return render_main(argc, argv);
    rc = conf_load(&table, &r.set, argc, argv, &err);
    if (rc < 0)
        return fail(&err);
    if (rc != CONF_RUN) {
        (rc == CONF_HELP ? conf_help : conf_version)(&table);
        return EX_OK;
    }
    r.argc = argc;
    r.argv = argv;
    log_open("radd", (enum log_level)log_level_parse(r.set.log_level));
    signal(SIGPIPE, SIG_IGN);
    uv_loop_init(&r.loop);
    shell_init(&r.shell, &r.loop, &ops, &r);
    if (start(&r, &err) == 0) {
        service_notify("READY=1");
        uv_run(&r.loop, UV_RUN_DEFAULT);
    } else {
        r.status = fail(&err);
    }
    finish(&r);
    return r.status;
}
