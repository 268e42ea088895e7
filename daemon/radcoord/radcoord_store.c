/* radcoord_store.c - from the store to the machine; see radcoord_impl.h */
#include "config.h"

#include "radcoord/radcoord_impl.h"

#include "net/log.h"
#include "registry/bygone.h"
#include "registry/recover.h"

#include <string.h>
#include <time.h>

#define NOTE_MS (3600 * 1000) /* between two notes of the date */

/* --- answers of the store --- */

static void
settled(struct radcoord *r)
{
    uint64_t since_ns = uv_hrtime();

    shell_run(&r->shell);
    shell_store_progress(&r->shell);
    turns_note(&r->turns, "stored", uv_hrtime() - since_ns);
}

static void
file_done(void *arg, uint64_t conn, const uint8_t hash[MSG_HASH], int status,
          const char *text)
{
    struct radcoord *r = arg;

    if (status == 0)
        coord_file_stored(r->coord, radcoord_now(r), conn, hash);
    else
        coord_file_failed(r->coord, radcoord_now(r), conn, hash, status, text);
    settled(r);
}

static void
job_done(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence, int status,
         const char *text)
{
    struct radcoord *r = arg;

    coord_job_opened(r->coord, radcoord_now(r), job, sequence, status, text);
    settled(r);
}

static void
submit_read(void *arg, uint64_t conn, const struct msg *m, int status,
            const char *text)
{
    struct radcoord *r = arg;

    if (status == 0)
        coord_message(r->coord, radcoord_now(r), conn, m);
    else
        radcoord_refuse_submit(r, conn, m, status, text);
    settled(r);
}

static void
job_waits(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
          const char *text)
{
    struct radcoord *r = arg;

    coord_job_waits(r->coord, radcoord_now(r), job, sequence, text);
    shell_run(&r->shell);
}

static void
rows_done(void *arg, const struct action_rows *key, int status,
          const char *text)
{
    struct radcoord *r = arg;

    coord_rows_stored(r->coord, radcoord_now(r), key, status, text);
    settled(r);
}

static void
picture_done(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
             uint32_t frame, int status, const char *text)
{
    struct radcoord *r = arg;

    coord_picture_written(r->coord, radcoord_now(r), job, sequence, frame,
                          status, text);
    settled(r);
}

static void
chunk_done(void *arg)
{
    struct radcoord *r = arg;

    shell_store_progress(&r->shell);
}

static void
job_filed(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
          uint64_t bytes, uint64_t cache_bytes)
{
    struct radcoord *r = arg;

    coord_job_filed(r->coord, radcoord_now(r), job, sequence, bytes,
                    cache_bytes);
    settled(r);
}

static void
cache_read(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
           const struct saved_cache *cache)
{
    struct radcoord *r = arg;

    coord_cache_came(r->coord, radcoord_now(r), job, sequence, cache);
    settled(r);
}

static void
request_kept(void *arg, uint64_t conn, uint32_t request)
{
    struct radcoord *r = arg;

    coord_settled(r->coord, radcoord_now(r), conn, request);
    settled(r);
}

static void
disk_full(void *arg, bool full, const char *text)
{
    struct radcoord *r = arg;

    coord_fullness(r->coord, radcoord_now(r), full, text);
    shell_run(&r->shell);
}

/* End the daemon: the disk failed, or memory is out.  Nothing is acknowledged
 * from now on; workers and users send all that was not acknowledged again to
 * the next life of the coordinator. */
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

    coord_looked(r->coord, radcoord_now(r), l);
    shell_run(&r->shell);
}

static void
pace(void *arg, struct coord_pace *out)
{
    const struct radcoord *r = arg;
    const struct turns_seen *s = &r->turns.seen;

    *out = (struct coord_pace){ s->slow, s->longest_ms, s->longest_cpu_ms };
}

static uint64_t
unread(void *arg, const char *owner)
{
    const struct radcoord *r = arg;

    return fair_unread(&r->fair, owner);
}

static bool
has_room(void *arg, uint64_t id)
{
    struct radcoord *r = arg;
    const struct conn *c = shell_conn(&r->shell, id);

    return c && transfers_have_room(c);
}

static void
each_sent(void *arg, coord_sent_fn *fn, void *with)
{
    const struct radcoord *r = arg;

    transfers_of_jobs(r->transfers, fn, with);
}

/* By the system's clock with that number [ms]. */
static uint64_t
clock_ms(clockid_t id)
{
    struct timespec t = { 0 };

    clock_gettime(id, &t);
    return (uint64_t)t.tv_sec * 1000 + (uint64_t)t.tv_nsec / 1000000;
}

/* For how long the machine has slept since radcoord started; the loop's clock
 * stands still meanwhile. */
static uint64_t
slept_ms(void *arg)
{
    const struct radcoord *r = arg;
    uint64_t awake_ms = clock_ms(CLOCK_MONOTONIC) + r->slept_ms;
    uint64_t all_ms = clock_ms(CLOCK_BOOTTIME);

    return all_ms > awake_ms ? all_ms - awake_ms : 0;
}

/* By how much the system's clock, if it can be right, is ahead of the date. */
static int64_t
ahead_ms(void *arg)
{
    uint64_t clock = clock_ms(CLOCK_REALTIME);
    int64_t by_ms = (int64_t)(clock - radcoord_now(arg) - slept_ms(arg));

    return clock < DAEMON_RIGHT_MS ? 0 : by_ms;
}

static void
sent(void *arg, uint64_t id, const struct store_source *whole)
{
    struct radcoord *r = arg;

    coord_sent(r->coord, id);
    if (whole && !whole->file) {
        bygone_fetched(r->coord, radcoord_now(r), id, whole->job, whole->frame,
                       whole->what);
        shell_run(&r->shell);
    }
}

static void
recall_gone(void *arg, const struct saved_gone *g)
{
    struct radcoord *r = arg;

    bygone_recall(r->coord, g);
}

static const struct store_handler store_handler = { .gone = recall_gone,
                                                    .looked = files_known,
                                                    .file = file_done,
                                                    .job = job_done,
                                                    .submit = submit_read,
                                                    .waits = job_waits,
                                                    .rows = rows_done,
                                                    .picture = picture_done,
                                                    .progress = chunk_done,
                                                    .broken = store_broken,
                                                    .filed = job_filed,
                                                    .cache = cache_read,
                                                    .settled = request_kept,
                                                    .fullness = disk_full };

static bool
has_file(void *arg, const uint8_t hash[MSG_HASH])
{
    struct radcoord *r = arg;

    return store_check_file(r->store, hash);
}

static bool
look(void *arg, const struct action_look *l)
{
    struct radcoord *r = arg;

    return store_look(r->store, l);
}

/* --- jobs of earlier lives --- */

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
    struct saved_job as = *saved;
    char owner[OWNER_TEXT];

    owners_of_saved(saved->owner, owner);
    as.owner = owner;
    return recover_job(r->coord, radcoord_now(r), &as, read_row, r, err);
}

static int
recover_worker(void *arg, const char *name, struct rad_error *err)
{
    struct radcoord *r = arg;

    return recover_drained(r->coord, radcoord_now(r), name, err);
}

int
radcoord_open_store(struct radcoord *r, struct rad_error *err)
{
    struct coord_env env = { .has_file = has_file,
                             .random = shell_random,
                             .arg = r,
                             .look = look,
                             .pace = pace,
                             .unread = unread,
                             .has_room = has_room,
                             .each_sent = each_sent,
                             .slept_ms = slept_ms,
                             .ahead_ms = ahead_ms,
                             .program = "radcoord " PACKAGE_VERSION,
                             .keeps = !r->set.common.embedded,
                             .one_user = r->set.common.embedded };
    uint64_t clock = clock_ms(CLOCK_REALTIME), epoch;

    r->slept_ms = slept_ms(r);
    r->noted_ms = clock;
    r->store = store_open(&r->daemon.loop, r->set.state,
                          !r->set.common.embedded, &store_handler, r, err);
    if (!r->store)
        return err->code;
    r->shell.store = r->store;
    r->transfers = transfers_new(r->store, sent, r);
    r->coord = coord_new(&env);
    if (!r->transfers || !r->coord)
        return rad_fail_memory(err);
    r->shell.actions = coord_actions(r->coord);
    if (store_begin_life(r->store, &r->noted_ms, &epoch, err) < 0)
        return err->code;
    if (r->noted_ms != clock)
        log_warn("clock wrong by_s=%llu: the date is as it was last known",
                 (unsigned long long)(r->noted_ms - clock) / 1000);
    r->clock_ms = r->noted_ms - daemon_now(&r->daemon);
    if (store_read_drained(r->store, recover_worker, r, err) < 0 ||
        store_recover(r->store, radcoord_now(r), recover_one, r, err) < 0)
        return err->code;
    coord_set_epoch(r->coord, epoch);
    radcoord_apply(r);
    return 0;
}

/* --- now and then --- */

/* So the next life knows when this one was last seen. */
static void
note_date(struct radcoord *r)
{
    uint64_t date_ms = radcoord_now(r) + slept_ms(r);

    if (date_ms < r->noted_ms + NOTE_MS)
        return;
    r->noted_ms = date_ms;
    store_note_date(r->store, date_ms);
}

/* At the start, then every quarter of upload_s, files are removed that no job
 * names.  Files that came within upload_s stay, for their user may still submit
 * a job. */
static void
sweep_files(struct radcoord *r)
{
    uint64_t period_ms = UINT64_C(250) * (unsigned)r->set.upload_s;
    uint8_t *list;
    size_t n;

    if (r->set.common.embedded ||
        (r->sweep_ms > 0 && radcoord_now(r) - r->sweep_ms < period_ms))
        return;
    r->sweep_ms = radcoord_now(r);
    list = coord_files(r->coord, &n);
    if (list)
        store_sweep(r->store, list, n, r->set.upload_s);
}

void
radcoord_tick_store(struct radcoord *r)
{
    note_date(r);
    sweep_files(r);
}
