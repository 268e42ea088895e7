/* wjob.c - see wjob.h
 *
 * A unit is listed until its last rows came from the child.  A RESULT is kept
 * as bytes, ready to be sent, until the coordinator has acknowledged it.  So
 * results outlive their unit and the connection, but not the job; results of a
 * unit that is given up are freed with it. */
#include "config.h"

#include "worker/wjob.h"

#include "machine/shelf.h"
#include "machine/steps.h"
#include "worker/state.h"

#include "base/list.h"

#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

const struct steps wjob_steps = {
    WJOB_IDLE + 1,
    {
        [WJOB_FETCHING] = { "fetching", STEP(WJOB_NO_ROOM) |
                                            STEP(WJOB_LOADING) |
                                            STEP(WJOB_IDLE) },
        [WJOB_NO_ROOM] = { "no-room", STEP(WJOB_FETCHING) | STEP(WJOB_IDLE) },
        [WJOB_LOADING] = { "loading", STEP(WJOB_READY) | STEP(WJOB_IDLE) },
        [WJOB_READY] = { "ready", STEP(WJOB_IDLE) },
        [WJOB_IDLE] = { "idle", STEP(WJOB_FETCHING) },
    },
};

void
wjob_step(struct wjob *job, enum wjob_state to)
{
    job->state = (enum wjob_state)steps_take(&wjob_steps, job->state, to);
}

/* --- units and results of a job --- */

void
wjob_drop_kept(struct wjob *job, struct wkept **link)
{
    struct wkept *k = *link;

    job->kept_bytes -= k->len;
    *link = k->next;
    if (!*link)
        job->kept_tail = link;
    free(k->bytes);
    free(k);
}

struct wattempt *
wjob_find_attempt(const struct wjob *job, uint32_t unit, uint32_t attempt)
{
    for (size_t i = 0; i < job->nattempts; i++)
        if (job->attempts[i].unit == unit && job->attempts[i].number == attempt)
            return &job->attempts[i];
    return NULL;
}

bool
wjob_has_attempt(const struct wjob *job, uint32_t unit, uint32_t attempt)
{
    return wjob_find_attempt(job, unit, attempt) != NULL;
}

void
wjob_drop_attempt(struct wjob *job, uint32_t unit, uint32_t attempt)
{
    for (size_t i = 0; i < job->nattempts; i++)
        if (job->attempts[i].unit == unit &&
            job->attempts[i].number == attempt) {
            memmove(job->attempts + i, job->attempts + i + 1,
                    (job->nattempts - i - 1) * sizeof *job->attempts);
            job->nattempts--;
            return;
        }
}

bool
wjob_add_attempt(struct wjob *job, uint32_t unit, uint32_t attempt)
{
    if (!rad_list_grow(&job->attempts, job->nattempts, sizeof *job->attempts))
        return false;
    job->attempts[job->nattempts++] =
        (struct wattempt){ .unit = unit, .number = attempt };
    return true;
}

void
wjob_drop_attempts(struct wjob *job)
{
    for (struct wkept **link = &job->kept; *link;)
        if (wjob_has_attempt(job, (*link)->unit, (*link)->attempt))
            wjob_drop_kept(job, link);
        else
            link = &(*link)->next;
    job->nattempts = 0;
}

void
wjob_revoke_attempt(struct worker *w, struct wjob *job, uint32_t unit,
                    uint32_t attempt)
{
    struct msg m = { .type = MSG_REVOKE, .revoke = { job->id, unit, attempt } };

    for (struct wkept **link = &job->kept; *link;)
        if ((*link)->unit == unit && (*link)->attempt == attempt)
            wjob_drop_kept(job, link);
        else
            link = &(*link)->next;
    wjob_drop_attempt(job, unit, attempt);
    worker_send_child(w, job, &m);
}

bool
wjob_keep(struct wjob *job, const struct msg_result *r, const uint8_t *bytes,
          size_t len)
{
    struct wkept *k = calloc(1, sizeof *k);

    if (!k || !(k->bytes = malloc(len))) {
        free(k);
        return false;
    }
    k->unit = r->unit;
    k->attempt = r->attempt;
    k->row = r->row;
    memcpy(k->bytes, bytes, len);
    k->len = len;
    job->kept_bytes += len;
    *job->kept_tail = k;
    job->kept_tail = &k->next;
    return true;
}

/* --- jobs and their children --- */

void
wjob_free(struct wjob *job)
{
    while (job->kept)
        wjob_drop_kept(job, &job->kept);
    lossy_release(&job->to_child);
    free(job->start);
    free(job->files);
    free(job->attempts);
    free(job);
}

void
wjob_kill_child(struct worker *w, struct wjob *job)
{
    if (job->child == 0)
        return;
    actions_add(&w->actions, ACT_KILL, job->child);
    job->child = 0;
    lossy_release(&job->to_child);
}

/* Note what a worker needs to know of the job's frames. */
static void
note_frames(struct wjob *job, const struct msg_spec *spec)
{
    job->nframes = spec->nframes;
    job->flags = spec->flags;
    job->memory_mib = spec->memory_mib;
    job->channels = spec->flags & MSG_JOB_DEPTH ? 4 : 3;
    job->width = spec->width;
    job->height = spec->height;
    for (uint32_t i = 0; spec->frames && i < spec->nframes; i++) {
        const struct msg_frame *f = &spec->frames[i];

        job->width = f->width > job->width ? f->width : job->width;
        job->height = f->height > job->height ? f->height : job->height;
    }
}

/* Pack JOB_START into the worker's scratch as children get it: without the
 * priority, which may change in a job's life and does not change what a child
 * renders.  False: memory is out. */
static bool
pack_start(struct worker *w, const struct msg *m)
{
    struct msg start = *m;

    start.job_start.priority = 0;
    w->actions.scratch.len = 0;
    return msg_pack(&w->actions.scratch, &start) == 0;
}

bool
wjob_is_same(struct worker *w, const struct wjob *job, const struct msg *m)
{
    const struct wire_out *out = &w->actions.scratch;

    return pack_start(w, m) && out->len == job->start_len &&
           memcmp(out->buf, job->start, out->len) == 0;
}

struct wjob *
wjob_new(struct worker *w, const struct msg *m)
{
    const struct wire_out *out = &w->actions.scratch;
    const struct msg_spec *spec = &m->job_start;
    size_t nbytes = (size_t)spec->files.n * MSG_HASH;
    struct wjob *job = calloc(1, sizeof *job);

    if (!job)
        return NULL;
    job->kept_tail = &job->kept;
    lossy_init(&job->to_child);
    job->files = malloc(nbytes ? nbytes : 1);
    note_frames(job, spec);
    if (!job->files || !pack_start(w, m) || !(job->start = malloc(out->len))) {
        wjob_free(job);
        return NULL;
    }
    memcpy(job->id, spec->job, MSG_JOB);
    msg_job_format(job->id, job->hex);
    memcpy(job->start, out->buf, out->len);
    job->start_len = out->len;
    if (nbytes)
        memcpy(job->files, spec->files.hash, nbytes);
    job->nfiles = spec->files.n;
    job->bundle_bytes = spec->bundle_bytes;
    job->next = w->jobs;
    w->jobs = job;
    return job;
}

void
wjob_spawn(struct worker *w, struct wjob *job)
{
    struct action *a;

    job->child = worker_new_conn(w);
    wjob_step(job, WJOB_LOADING);
    job->heard_ms = w->awake_ms;
    job->held = false;
    job->tally = (struct msg_tally){ 0 };
    job->paid = job->unpaid = (struct msg_counts){ 0 };
    actions_log(&w->actions, ACT_INFO, "job start job=%s", job->hex);
    a = actions_add_job(&w->actions, ACT_SPAWN, job->child, job->id);
    if (a)
        a->memory_mib = job->memory_mib;
    worker_send_child_bytes(w, job, job->start, job->start_len);
}

/* The status of a job that fails everywhere as it did here.  What a worker
 * lacks is not what its user lacks, so of memory and files alone is told. */
static uint16_t
status_for_user(int status)
{
    if (!worker_status_is_local(status))
        return EX_SOFTWARE;
    return status == EX_OSERR || status == EX_TEMPFAIL ? EX_OSERR : EX_IOERR;
}

void
wjob_send_lost(struct worker *w, struct wjob *job, int status, const char *text)
{
    uint32_t list[64];
    struct msg m = { .type = MSG_LOST,
                     .lost = { job->id, status_for_user(status), text, 0,
                               list } };
    bool local = worker_status_is_local(status);

    for (size_t i = 0; !local && i < job->nattempts &&
                       m.lost.nunits < w->env.threads && m.lost.nunits < 64;
         i++)
        if (!job->attempts[i].parked)
            list[m.lost.nunits++] = job->attempts[i].unit;
    worker_send_coord(w, &m);
    wjob_drop_attempts(job);
    wjob_step(job, WJOB_IDLE);
}

void
wjob_next_pass(struct wjob *job)
{
    job->ntiles[job->ready.passes++ % WJOB_PASSES] = 0;
}

/* The worker does not know the frame, only that a base line has at most one
 * density for each column; the child checks the rest. */
bool
wjob_fits_line(const struct wjob *job, const struct msg_base_line *m)
{
    const struct shelf_size most = { job->width, job->width, job->channels };

    return m->frame < job->nframes && m->line + 1 < job->height &&
           shelf_fits(&most, m);
}
