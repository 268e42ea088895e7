/* radweb.c - the daemon that shows a cluster; see radweb_impl.h */
#include "config.h"

#include "web/radweb_impl.h"

#include "ground/memory.h"
#include "web/confine.h"

#include <jansson.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sysexits.h>

#define SWEEP_MS 500
#define NICE     15

/* The cluster has changed.  Jobs' pages change, too, if the coordinator has
 * gone or come back, for all pages say that. */
static void
on_model(void *arg)
{
    struct radweb *r = arg;

    events_wake(r, NULL);
    if (r->was_up == r->model.up)
        return;
    r->was_up = r->model.up;
    for (struct watch *w = r->watches.first; w; w = w->next) {
        w->version++;
        events_wake(r, w);
    }
}

static void
on_watch(void *arg, struct watch *w)
{
    events_wake(arg, w);
}

static void
on_tick(void *arg)
{
    struct radweb *r = arg;
    uint64_t now = uv_now(&r->daemon.loop);

    session_tick(r->session);
    model_tick(&r->model);
    watch_tick(&r->watches);
    route_tick(r, false);
    events_tick(r);
    if (now - r->sweep_ms >= SWEEP_MS) {
        r->sweep_ms = now;
        serve_sweep(r->serve);
    }
    serve_tick(r->serve);
}

static void
on_term(void *arg)
{
    struct radweb *r = arg;

    daemon_stop(&r->daemon, EX_OK);
}

static void
on_reload(void *arg)
{
    (void)arg; /* no setting of radweb may change at run time */
}

static int
open_http(struct radweb *r, struct rad_error *err)
{
    struct serve_conf conf = { .listen = r->set.listen,
                               .tls_cert = r->set.tls_cert,
                               .tls_key = r->set.tls_key,
                               .fn = route_request,
                               .ended = route_ended,
                               .arg = r };
    char line[ADDRESS_TEXT + 8];
    const char *lines[] = { line };

    r->serve = serve_open(&r->daemon.loop, &conf, err);
    if (!r->serve)
        return err->code;
    snprintf(line, sizeof line, "%s %s", r->set.tls_cert[0] ? "https" : "http",
             serve_address(r->serve));
    log_info("listening on=%s", line);
    if (!r->set.common.ports_file[0])
        return 0;
    return service_ports_file(r->set.common.ports_file, lines, 1, err);
}

/* Use the files that systemd passes, for settings that name no file. */
static void
take_credentials(struct radweb_settings *s)
{
    if (!s->key[0])
        service_credential("key", s->key, sizeof s->key);
    if (!s->token_file[0])
        service_credential("token", s->token_file, sizeof s->token_file);
    if (!s->tls_cert[0])
        service_credential("tls-cert", s->tls_cert, sizeof s->tls_cert);
    if (!s->tls_key[0])
        service_credential("tls-key", s->tls_key, sizeof s->tls_key);
}

/* Run at low priority, behind the coordinator above all.  A failure is ignored.
 */
static void
give_way(void)
{
    const struct sched_param none = { 0 };

    if (getpriority(PRIO_PROCESS, 0) < NICE)
        setpriority(PRIO_PROCESS, 0, NICE);
    if (sched_getscheduler(0) == SCHED_OTHER)
        sched_setscheduler(0, SCHED_BATCH, &none);
}

static int
start(void *arg, struct rad_error *err)
{
    struct radweb *r = arg;
    struct session_conf conf = { r->set.coordinator, r->set.key };

    give_way();
    take_credentials(&r->set);
    service_return_memory(); /* of pictures */
    json_set_alloc_funcs(memory_need, free);
    if (radweb_read_token(r, err) < 0 || radweb_check_listen(r, err) < 0)
        return err->code;
    r->session = session_new(&r->daemon.loop, &conf);
    if (!r->session ||
        !model_init(&r->model, &r->daemon.loop, r->session, on_model, r))
        return rad_fail_memory(err);
    watch_init(&r->watches, &r->daemon.loop, r->session, on_watch, r);
    if (open_http(r, err) < 0)
        return err->code;
    return confine_begin(err);
}

/* End all open event streams, and answer all requests that wait. */
static void
finish(void *arg)
{
    struct radweb *r = arg;

    r->closing = true;
    if (r->serve) {
        route_tick(r, true);
        events_tick(r);
    }
    serve_close(r->serve);
    session_close(r->session);
}

static void
release(void *arg)
{
    struct radweb *r = arg;

    watch_release(&r->watches);
    if (r->model.session)
        model_release(&r->model);
    for (int i = 0; i < RADWEB_SHEETS; i++)
        blob_unref(r->sheets[i].blob);
    blob_unref(r->event.blob);
    serve_free(r->serve);
    session_free(r->session);
    explicit_bzero(r->token, sizeof r->token);
}

static const struct daemon_ops ops = { start,     on_tick, on_term,
                                       on_reload, finish,  release };

int
main(int argc, char *argv[])
{
    static struct radweb r = { .daemon = { .table = &radweb_table,
                                           .set = &r.set.common,
                                           .ops = &ops,
                                           .arg = &r } };

    return daemon_run(&r.daemon, argc, argv);
}
