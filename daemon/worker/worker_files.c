/* worker_files.c - files that a worker's jobs need
 *
 * A file is asked for once, however many jobs need it; `asked` lists the files
 * that have not come.  A job's child is started when no file is missing.
 *
 * If a job's files find no room, or cannot be written, the worker tells the
 * coordinator (ROOM), which gives the job to other workers.  The worker looks
 * for room again, after a delay that grows, and tells the coordinator when
 * there is.
 *
 * Files of a job that ended may still come, or never, for the coordinator sends
 * no file of such a job that it has not begun to send.  They are marked as
 * lapsed, and asked for again if another job needs them; but not a file that
 * comes, for its rest follows.  Files that come twice, or were not asked for,
 * are ignored. */
#include "config.h"

#include "worker/worker_files.h"

#include "worker/state.h"
#include "worker/wjob.h"
#include "worker/worker.h"

#include "base/list.h"

#include <string.h>
#include <sysexits.h>

#define FIRST_LOOK_MS 1000  /* delay before looking for room again, doubled */
#define LAST_LOOK_MS  30000 /* up to this */

static struct wasked *
find_asked(const struct worker *w, const uint8_t *hash)
{
    for (uint32_t i = 0; i < w->nasked; i++)
        if (memcmp(w->asked[i].hash, hash, MSG_HASH) == 0)
            return &w->asked[i];
    return NULL;
}

static bool
add_asked(struct worker *w, const uint8_t *hash)
{
    if (!rad_list_grow(&w->asked, w->nasked, sizeof *w->asked))
        return false;
    w->asked[w->nasked] = (struct wasked){ .state = WASKED_WANTED };
    memcpy(w->asked[w->nasked++].hash, hash, MSG_HASH);
    return true;
}

/* Take a file off the list of those asked for; false: it is not listed. */
static bool
forget_asked(struct worker *w, const uint8_t *hash)
{
    struct wasked *a = find_asked(w, hash);

    if (a)
        *a = w->asked[--w->nasked];
    return a != NULL;
}

/* List a missing file as asked for; true: it was not, and WANT is due. */
static bool
ask_anew(struct worker *w, const uint8_t *hash)
{
    struct wasked *a = find_asked(w, hash);

    if (!a && !add_asked(w, hash))
        w->actions.failed = true;
    if (a && (!a->lapsed || a->state == WASKED_COMES))
        return false;
    if (a)
        a->lapsed = false;
    return true;
}

static void
want(struct worker *w, const uint8_t *hashes, uint32_t n)
{
    struct msg m = { .type = MSG_WANT, .want = { n, hashes } };

    if (n > 0)
        worker_send_coord(w, &m);
}

/* Start the child if no file is missing; else ask for the missing files that
 * were not asked for.  Not while the coordinator is away: it will start the job
 * again. */
static void
fetch(struct worker *w, struct wjob *job)
{
    uint8_t *news =
        rad_arena_alloc(&w->actions.mem, (size_t)job->nfiles * MSG_HASH + 1);
    uint32_t n = 0;

    if (!news) {
        w->actions.failed = true;
        return;
    }
    job->look_delay_ms = 0;
    job->nmissing = 0;
    for (uint32_t i = 0; i < job->nfiles; i++) {
        const uint8_t *hash = job->files + (size_t)i * MSG_HASH;

        if (w->env.has_file(w->env.arg, hash))
            continue;
        job->nmissing++;
        if (job->started && ask_anew(w, hash))
            memcpy(news + (size_t)n++ * MSG_HASH, hash, MSG_HASH);
    }
    want(w, news, n);
    if (job->nmissing == 0 && !w->stopped)
        wjob_spawn(w, job);
}

/* How often the job's list names the file. */
static uint32_t
times_named(const struct wjob *job, const uint8_t *hash)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < job->nfiles; i++)
        n += memcmp(job->files + (size_t)i * MSG_HASH, hash, MSG_HASH) == 0;
    return n;
}

bool
files_need(const struct wjob *job, const uint8_t *hash)
{
    return times_named(job, hash) > 0;
}

/* --- room --- */

static void
say_room(struct worker *w, const struct wjob *job, bool has, const char *text)
{
    struct msg m = { .type = MSG_ROOM, .room = { job->id, has, text } };

    worker_send_coord(w, &m);
}

static void
look_later(const struct worker *w, struct wjob *job)
{
    if (job->look_delay_ms == 0)
        job->look_delay_ms = FIRST_LOOK_MS;
    job->look_ms = w->now_ms + job->look_delay_ms;
    job->look_delay_ms *= 2;
    if (job->look_delay_ms > LAST_LOOK_MS)
        job->look_delay_ms = LAST_LOOK_MS;
}

static void
fail_job(struct worker *w, struct wjob *job, int status, const char *text)
{
    struct msg m = { .type = MSG_FAILED,
                     .failed = { job->id, (uint16_t)status, text } };

    worker_send_coord(w, &m);
    wjob_step(job, WJOB_IDLE);
}

/* The job's files find no room, or cannot be written: try again later. */
static void
wait_for_room(struct worker *w, struct wjob *job, int status, const char *text)
{
    if (w->env.one_disk) {
        fail_job(w, job, status, text);
        return;
    }
    look_later(w, job);
    if (job->state == WJOB_NO_ROOM)
        return; /* the coordinator was told */
    wjob_step(job, WJOB_NO_ROOM);
    actions_log(&w->actions, ACT_WARN, "job refused job=%s why=%s", job->hex,
                text);
    say_room(w, job, false, text);
    if (w->env.leave) /* files of this job may make room for others */
        w->env.leave(w->env.arg, job->id);
}

/* There is room again: tell the coordinator, which may start the job again. */
static void
offer_again(struct worker *w, struct wjob *job)
{
    actions_log(&w->actions, ACT_INFO, "room again job=%s", job->hex);
    wjob_step(job, WJOB_IDLE);
    say_room(w, job, true, "");
    if (w->env.leave)
        w->env.leave(w->env.arg, job->id);
}

/* Ask the shell which files are here, and whether the others find room. */
static void
look_for(struct worker *w, struct wjob *job)
{
    struct action_look l = { .nlook = job->nfiles,
                             .files = { job->nfiles, job->files },
                             .bytes = job->bundle_bytes };

    memcpy(l.job, job->id, MSG_JOB);
    if (!w->env.look || w->env.look(w->env.arg, &l))
        worker_looked(w, w->now_ms, &l);
}

void
files_look(struct worker *w, struct wjob *job)
{
    if (job->state != WJOB_FETCHING)
        wjob_step(job, WJOB_FETCHING);
    look_for(w, job);
}

void
worker_looked(struct worker *w, uint64_t now_ms, const struct action_look *l)
{
    struct wjob *job = worker_find_job(w, l->job);

    w->now_ms = now_ms;
    if (!job)
        return;
    if (job->state != WJOB_FETCHING && job->state != WJOB_NO_ROOM)
        return;
    if (l->status != 0)
        wait_for_room(w, job, l->status, l->why);
    else if (job->state == WJOB_FETCHING)
        fetch(w, job);
    else
        offer_again(w, job);
}

void
files_watch_room(struct worker *w)
{
    for (struct wjob *job = w->jobs; job; job = job->next)
        if (job->state == WJOB_NO_ROOM && w->now_ms >= job->look_ms) {
            job->look_ms = UINT64_MAX; /* until the look has ended */
            look_for(w, job);
        }
}

/* --- files that come --- */

bool
worker_take_chunk(struct worker *w, const struct msg_chunk *chunk)
{
    struct wasked *a = find_asked(w, chunk->hash);

    if (!a || (a->state == WASKED_WANTED && chunk->offset > 0))
        return false; /* the rest of a file that was given up */
    a->state = WASKED_COMES;
    return true;
}

void
files_lapse(struct worker *w)
{
    for (uint32_t i = 0; i < w->nasked; i++)
        w->asked[i].lapsed = true;
}

void
worker_file_stored(struct worker *w, uint64_t now_ms,
                   const uint8_t hash[MSG_HASH])
{
    w->now_ms = now_ms;
    forget_asked(w, hash);
    for (struct wjob *job = w->jobs; job; job = job->next) {
        uint32_t n = job->state == WJOB_FETCHING ? times_named(job, hash) : 0;

        if (n == 0)
            continue;
        job->nmissing -= n < job->nmissing ? n : job->nmissing;
        if (job->nmissing == 0)
            fetch(w, job); /* looks again: a file may have been removed */
    }
}

void
worker_file_failed(struct worker *w, uint64_t now_ms,
                   const uint8_t hash[MSG_HASH], int status, const char *text)
{
    w->now_ms = now_ms;
    if (!forget_asked(w, hash))
        return; /* the rest of a file that failed */
    for (struct wjob *job = w->jobs; job; job = job->next) {
        if (job->state != WJOB_FETCHING || !files_need(job, hash))
            continue;
        if (status == EX_PROTOCOL) /* the coordinator sent another file */
            wjob_send_lost(w, job, EX_IOERR, text);
        else
            wait_for_room(w, job, status, text);
    }
}
