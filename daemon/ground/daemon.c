/* daemon.c - see daemon.h */
#include "config.h"

#include "ground/daemon.h"

#include "ground/memory.h"

#include "base/output.h"
#include "net/log.h"
#include "ground/threads.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

uint64_t
daemon_now(const struct daemon *d)
{
    return uv_now(&d->loop);
}

void
daemon_stop(struct daemon *d, int status)
{
    if (d->stopping)
        return;
    d->stopping = true;
    d->status = status;
    service_notify(d->notify, "STOPPING=1");
    uv_stop(&d->loop);
}

/* Tell systemd that the loop runs. */
static void
feed_watchdog(struct daemon *d)
{
    if (d->watchdog_ms == 0 || daemon_now(d) - d->fed_ms < d->watchdog_ms / 2)
        return;
    d->fed_ms = daemon_now(d);
    service_notify(d->notify, "WATCHDOG=1");
}

static void
on_tick(uv_timer_t *timer)
{
    struct daemon *d = timer->data;

    feed_watchdog(d);
    d->ops->tick(d->arg);
}

static void
on_term(uv_signal_t *sig, int signum)
{
    struct daemon *d = sig->data;

    if (d->stopping && !d->set->embedded) /* a second signal: do not wait */
        _exit(EX_TEMPFAIL);
    if (d->stopping) /* an embedded daemon first removes its folder */
        return;
    log_info("stopping signal=%d", signum);
    service_notify(d->notify, "STOPPING=1");
    d->ops->term(d->arg);
}

static void
on_hup(uv_signal_t *sig, int signum)
{
    struct daemon *d = sig->data;
    struct rad_error err = { 0 };
    char text[600], later[CONF_TEXT];

    (void)signum;
    if (d->stopping)
        return;
    service_notify(d->notify, "RELOADING=1");
    if (conf_reload(d->table, d->set, d->loaded, d->argc, d->argv, later,
                    &err) < 0) {
        rad_error_format(&err, text, sizeof text);
        log_err("reload failed: %s", text);
    } else {
        log_set_level((enum log_level)log_level_parse(d->set->log_level));
        d->ops->reloaded(d->arg);
        if (later[0])
            log_warn("changed, but in force only after a restart keys=%s",
                     later);
        log_info("reloaded");
    }
    service_notify(d->notify, "READY=1");
}

static void
on_lifetime_end(void *arg)
{
    log_debug("stopping: whoever started this is gone");
    daemon_stop(arg, EX_OK);
}

static void
catch_signal(struct daemon *d, uv_signal_t *sig, uv_signal_cb cb, int signum)
{
    uv_signal_init(&d->loop, sig);
    sig->data = d;
    uv_signal_start(sig, cb, signum);
}

static int
start(struct daemon *d, struct rad_error *err)
{
    int rc;

    /* before peers can know of us; signals are handled when the loop runs */
    catch_signal(d, &d->sigterm, on_term, SIGTERM);
    catch_signal(d, &d->sigint, on_term, SIGINT);
    catch_signal(d, &d->sighup, on_hup, SIGHUP);
    rc = d->ops->start(d->arg, err);
    if (rc == 0)
        rc = service_watch_lifetime(&d->lifetime, &d->loop, d->set->lifetime_fd,
                                    on_lifetime_end, d, err);
    if (rc < 0)
        return rc;
    uv_timer_init(&d->loop, &d->ticker);
    d->ticker.data = d;
    uv_timer_start(&d->ticker, on_tick, DAEMON_TICK_MS, DAEMON_TICK_MS);
    return 0;
}

static void
close_own(void *handle)
{
    uv_handle_t *h = handle;

    if (h->type != UV_UNKNOWN_HANDLE) /* the handle was started */
        uv_close(h, NULL);
}

/* Catch signals to the end: a user who stops a launcher may send many, and none
 * may end a daemon before its folder is removed. */
static void
finish(struct daemon *d)
{
    uv_signal_t *signals[] = { &d->sigterm, &d->sigint, &d->sighup };
    const size_t n = sizeof signals / sizeof *signals;

    d->stopping = true; /* also if start() failed */
    d->ops->finish(d->arg);
    close_own(&d->ticker);
    close_own(&d->lifetime.poll);
    for (size_t i = 0; i < n; i++)
        uv_unref((uv_handle_t *)signals[i]);
    uv_run(&d->loop, UV_RUN_DEFAULT);
    d->ops->release(d->arg);
    for (size_t i = 0; i < n; i++)
        close_own(signals[i]);
    uv_run(&d->loop, UV_RUN_DEFAULT);
    uv_loop_close(&d->loop);
}

static int
fail(const struct daemon *d, const struct rad_error *err)
{
    char text[600];

    rad_error_format(err, text, sizeof text);
    fprintf(stderr, "%s: %s\n", d->table->program, text);
    return rad_exit_status(err->code);
}

int
daemon_check_text(const char *name, const char *value, struct rad_error *err)
{
    if (strcmp(name, "log_level") == 0 && log_level_parse(value) < 0)
        return rad_fail(err, RAD_ECONFIG,
                        "expected err, warn, info or debug, got '%s'", value);
    if ((strcmp(name, "state") == 0 || strcmp(name, "cache") == 0) && !value[0])
        return rad_fail(err, RAD_ECONFIG, "expected a folder");
    return 0;
}

int
daemon_run(struct daemon *d, int argc, char *argv[])
{
    struct rad_error err = { 0 };
    int rc;

    rad_output_guard();
    rc = conf_load(d->table, d->set, argc, argv, &err);
    if (rc < 0)
        return fail(d, &err);
    if (rc != CONF_RUN) {
        (rc == CONF_HELP ? conf_help : conf_version)(d->table);
        if (fflush(stdout) == 0)
            return EX_OK;
        rad_fail(&err, RAD_EIO, "cannot write: %s", strerror(errno));
        return fail(d, &err);
    }
    d->argc = argc;
    d->argv = argv;
    d->loaded = malloc(d->table->size);
    if (!d->loaded)
        log_out_of_memory();
    memcpy(d->loaded, d->set, d->table->size);
    log_open(d->table->program,
             (enum log_level)log_level_parse(d->set->log_level));
    signal(SIGPIPE, SIG_IGN);
    memory_catch();
    if (service_raise_descriptors(&err) < 0)
        return fail(d, &err);
    d->notify = service_notify_open();
    rc = uv_loop_init(&d->loop);
    if (rc < 0) {
        rad_fail(&err, RAD_ESHORT, "cannot start: %s", uv_strerror(rc));
        return fail(d, &err);
    }
    threads_start(&d->loop, &d->first_work, d->set->embedded);
    d->watchdog_ms = service_watchdog_ms();
    if (start(d, &err) == 0) {
        service_notify(d->notify, "READY=1");
        uv_run(&d->loop, UV_RUN_DEFAULT);
    } else {
        d->status = fail(d, &err);
    }
    finish(d);
    free(d->loaded);
    return d->status;
}
