/* radcoord.c - the coordinator daemon: the shell around coord.h
 *
 * Its parts are named in radcoord_impl.h. */
#include "config.h"

#include "radcoord/radcoord_impl.h"

#include "net/log.h"
#include "ground/memory.h"
#include "ground/service.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define TRIM_MS 2000

/* --- from the connections to the machine --- */

/* Give the machine a SUBMIT; if the job's frames are in a file, read the file
 * first. */
static void
read_submit(struct radcoord *r, uint64_t id, const struct msg *m)
{
    if (!coord_has_file(r->coord, id, m->submit.views))
        radcoord_refuse_submit(
            r, id, m, EX_NOINPUT,
            "the list of frames is not there: send it first");
    else if (!store_read_submit(r->store, id, m))
        radcoord_refuse_submit(r, id, m, EX_TEMPFAIL,
                               "another job of this connection is being read");
}

static void
on_message(void *arg, uint64_t id, const struct msg *m)
{
    struct radcoord *r = arg;

    if (m->type == MSG_SUBMIT && !m->submit.frames)
        read_submit(r, id, m);
    else
        coord_message(r->coord, radcoord_now(r), id, m);
}

static void
on_closed(void *arg, uint64_t id, const char *why)
{
    struct radcoord *r = arg;

    transfers_drop(r->transfers, id);
    r->lost_conns = true;
    coord_closed(r->coord, radcoord_now(r), id, why);
}

static void
on_written(void *arg, uint64_t id, size_t n)
{
    struct radcoord *r = arg;

    (void)n;
    transfers_resume(r->transfers, id);
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

    char *stats = actions_take(coord_actions(r->coord), a->bytes);

    if (coord_saved(r->coord, a->job, &saved))
        store_end_job(r->store, &saved, stats, a->len);
    else
        free(stats);
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
    case ACT_SEND_PICTURE:
        send_source(r, a, a->type == ACT_SEND_FILE);
        break;
    case ACT_DROP_FILES:
        transfers_drop_files(r->transfers, a->conn);
        break;
    case ACT_JOB_OPEN:
        open_job(r, a->job);
        break;
    case ACT_JOB_STATE:
        store_put_state(r->store, a->job, a->status, a->priority);
        break;
    case ACT_DRAINED:
        store_put_drained(r->store, a->text, a->status != 0);
        break;
    case ACT_JOB_END:
        end_job(r, a);
        break;
    case ACT_KEEP_UNIT:
        store_keep_unit(r->store, a->job, a->unit);
        break;
    case ACT_PUT_PASS:
        store_put_pass(r->store, a->job, a->frame, a->pass);
        break;
    case ACT_PUT_COLOURS:
        store_put_colours(r->store, a->job, &a->colours);
        break;
    case ACT_LOAD_CACHE:
        store_load_cache(r->store, a->job, a->sequence);
        break;
    case ACT_DROP_CACHE:
        store_drop_cache(r->store, a->job, a->sequence);
        break;
    case ACT_OPTIONS:
        store_set_options(r->store, a->job, a->text);
        break;
    case ACT_SETTLE:
        store_settle(r->store, a->conn, a->request);
        break;
    case ACT_WRITE_PICTURE:
        store_write_picture(r->store, a->job, a->sequence, a->frame);
        break;
    case ACT_KEY:
        radcoord_do_key(r, a);
        break;
    case ACT_JOB_FETCHED:
        store_note_fetched(r->store, a->job, a->frame);
        break;
    case ACT_JOB_FORGET:
        store_forget_job(r->store, a->gone);
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
};

/* --- start and end --- */

static void
trim(uv_work_t *work)
{
    (void)work;
    service_trim_memory();
}

static void
trimmed(uv_work_t *work, int status)
{
    struct radcoord *r = work->data;

    (void)status;
    r->trimming = false;
}

/* Return memory of closed connections to the system.  After hundreds of closed
 * connections that takes the kernel a tenth of a second, so a thread does it;
 * the loop waits for that thread only if it needs new memory from the heap
 * meanwhile. */
static void
give_back_memory(struct radcoord *r)
{
    if (!r->lost_conns || r->trimming || radcoord_now(r) - r->trim_ms < TRIM_MS)
        return;
    r->trim_ms = radcoord_now(r);
    r->lost_conns = false;
    r->trim.data = r;
    r->trimming = uv_queue_work(&r->daemon.loop, &r->trim, trim, trimmed) == 0;
}

static void
on_tick(void *arg)
{
    struct radcoord *r = arg;
    uint64_t since_ns = uv_hrtime();

    coord_tick(r->coord, radcoord_now(r));
    shell_run(&r->shell);
    transfers_tick(r->transfers);
    radcoord_tick_keys(r);
    radcoord_tick_store(r);
    give_back_memory(r);
    turns_note(&r->turns, "tick", uv_hrtime() - since_ns);
}

static void
on_term(void *arg)
{
    struct radcoord *r = arg;

    daemon_stop(&r->daemon, EX_OK);
}

static void
on_reload(void *arg)
{
    struct radcoord *r = arg;

    radcoord_reload_keys(r);
    owners_set_map(r->owners, r->set.logins);
    radcoord_apply(r);
    shell_run(&r->shell);
}

static int
start(void *arg, struct rad_error *err)
{
    struct radcoord *r = arg;

    shell_init(&r->shell, &r->daemon, &ops, r);
    r->shell.turns = &r->turns;
    fair_init(&r->fair, &r->daemon.loop);
    service_return_memory();
    json_set_alloc_funcs(memory_need, free);
    if (!r->set.keys[0]) /* else the key file that systemd passes, if any */
        service_credential("keys", r->set.keys, sizeof r->set.keys);
    if (keyring_open(&r->keys, r->set.keys, err) < 0)
        return err->code;
    r->owners = owners_new(&r->daemon.loop, radcoord_on_login, r);
    if (!r->owners)
        return rad_fail_memory(err);
    owners_set_map(r->owners, r->set.logins);
    if (radcoord_open_store(r, err) < 0 || radcoord_listen(r, err) < 0)
        return err->code;
    shell_run(&r->shell); /* actions of recovered jobs */
    turns_start(&r->turns, &r->daemon.loop);
    return 0;
}

/* Close all sockets, then wait until the store has carried out all requests. */
static void
finish(void *arg)
{
    struct radcoord *r = arg;

    listener_close(r->tcp);
    listener_close(r->local);
    owners_close(r->owners);
    if (r->transfers)
        transfers_drop_all(r->transfers); /* their connections end now */
    shell_close(&r->shell);
    fair_close(&r->fair);
    turns_stop(&r->turns);
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
    free(r->worker_keys);
    owners_free(r->owners);
    store_close(r->store);
}

static const struct daemon_ops daemon_ops = { start,     on_tick, on_term,
                                              on_reload, finish,  release };

int
main(int argc, char *argv[])
{
    static struct radcoord r = { .daemon = { .table = &radcoord_table,
                                             .set = &r.set.common,
                                             .ops = &daemon_ops,
                                             .arg = &r } };

    return daemon_run(&r.daemon, argc, argv);
}
