/* worker_files.c - files that a worker's jobs need
 *
 * A file is asked for once, however many jobs need it; `asked` holds those that
 * have not come.  A job starts its child when nothing is missing: each file
 * that is stored is a reason to look at all jobs that fetch. */
#include "config.h"

#include "worker_impl.h"

#include <stdlib.h>
#include <string.h>

static bool
is_asked(const struct worker *w, const uint8_t *hash)
{
    for (uint32_t i = 0; i < w->nasked; i++)
        if (memcmp(w->asked + (size_t)i * MSG_HASH, hash, MSG_HASH) == 0)
            return true;
    return false;
}

static void
forget_asked(struct worker *w, const uint8_t *hash)
{
    for (uint32_t i = 0; i < w->nasked; i++)
        if (memcmp(w->asked + (size_t)i * MSG_HASH, hash, MSG_HASH) == 0) {
            memmove(w->asked + (size_t)i * MSG_HASH,
                    w->asked + (size_t)(w->nasked - 1) * MSG_HASH, MSG_HASH);
            w->nasked--;
            return;
        }
}

static bool
add_asked(struct worker *w, const uint8_t *hash)
{
    if (w->nasked == w->cap_asked) {
        uint32_t cap = w->cap_asked ? 2 * w->cap_asked : 64;
        uint8_t *v = realloc(w->asked, (size_t)cap * MSG_HASH);

        if (!v)
            return false;
        w->asked = v;
        w->cap_asked = cap;
    }
    memcpy(w->asked + (size_t)w->nasked++ * MSG_HASH, hash, MSG_HASH);
    return true;
}

/* Ask for what is missing and was not asked for; start the child when nothing
 * is. */
static void
fetch(struct worker *w, struct wjob *job)
{
    uint32_t first = w->nasked;
    struct msg m = { .type = MSG_WANT };
    bool missing = false;

    job->state = WJOB_FETCHING;
    for (uint32_t i = 0; i < job->nfiles; i++) {
        const uint8_t *hash = job->files + (size_t)i * MSG_HASH;

        if (w->env.has_file(w->env.arg, hash))
            continue;
        missing = true;
        if (!is_asked(w, hash) && !add_asked(w, hash))
            w->actions.failed = true;
    }
    if (w->nasked > first) {
        m.want.n = w->nasked - first;
        m.want.hash = w->asked + (size_t)first * MSG_HASH;
        worker_send_coord(w, &m);
    }
    if (!missing)
        wjob_spawn(w, job);
}

bool
wjob_needs_file(const struct wjob *job, const uint8_t *hash)
{
    for (uint32_t i = 0; i < job->nfiles; i++)
        if (memcmp(job->files + (size_t)i * MSG_HASH, hash, MSG_HASH) == 0)
            return true;
    return false;
}

void
wjob_look(struct worker *w, struct wjob *job)
{
    struct action_look l = { .files = { job->nfiles, job->files } };

    memcpy(l.job, job->id, MSG_JOB);
    job->state = WJOB_FETCHING;
    if (!w->env.look || w->env.look(w->env.arg, &l))
        fetch(w, job);
}

void
worker_looked(struct worker *w, uint64_t now_ms, const struct action_look *l)
{
    struct wjob *job = worker_find_job(w, l->job);

    w->now_ms = now_ms;
    if (job && job->state == WJOB_FETCHING)
        fetch(w, job);
}

void
worker_file_stored(struct worker *w, uint64_t now_ms,
                   const uint8_t hash[MSG_HASH])
{
    w->now_ms = now_ms;
    forget_asked(w, hash);
    for (struct wjob *job = w->jobs; job; job = job->next)
        if (job->state == WJOB_FETCHING && wjob_needs_file(job, hash))
            fetch(w, job);
}

void
worker_file_failed(struct worker *w, uint64_t now_ms,
                   const uint8_t hash[MSG_HASH], int status, const char *text)
{
    (void)status;
    w->now_ms = now_ms;
    forget_asked(w, hash);
    for (struct wjob *job = w->jobs; job; job = job->next)
        if (job->state == WJOB_FETCHING && wjob_needs_file(job, hash))
            wjob_send_lost(w, job, true, text);
}
