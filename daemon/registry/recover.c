/* recover.c - see recover.h */
#include "config.h"

#include "registry/recover.h"

#include "desk/desk.h"
#include "desk/order.h"
#include "jobs/job.h"
#include "jobs/part.h"
#include "jobs/progress.h"
#include "jobs/shared.h"
#include "jobs/unit.h"
#include "desk/verdict.h"
#include "registry/bygone.h"
#include "registry/connlife.h"
#include "registry/joblife.h"
#include "filling/stages.h"
#include "filling/filled.h"
#include "filling/passes.h"
#include "sched/loss.h"
#include "sched/result.h"
#include "users/known.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* How long units wait for their workers, which dial again [ms]. */
#define RETURN_MS 10000

struct recovery {
    struct coord *c;
    struct job *job;
    const struct saved_job *s;
    recover_row_fn *row;
    void *arg;
    struct rad_error *err;
};

static int
damaged(const struct recovery *r, const char *what, uint32_t number)
{
    return rad_fail(r->err, RAD_EDATA, "job %s: %s %u does not fit",
                    r->job->hex, what, number);
}

/* --- units --- */

/* The index in the job of the worker that had the unit, and that counts as gone
 * for now; JOB_NOBODY: no worker had the unit, or memory is out. */
static uint32_t
worker_of(const struct recovery *r, const struct saved_unit *s)
{
    struct coord_worker *w =
        s->worker[0] ? connlife_worker(r->c, s->worker) : NULL;
    uint32_t index = w ? desk_add_part(r->c, r->job, w) : JOB_NOBODY;

    if (index != JOB_NOBODY && s->fingerprint) {
        r->job->parts[index].fingerprint = s->fingerprint;
        r->job->parts[index].took_part = true;
    }
    return index;
}

static void
count_rows(struct job *job, const struct saved_unit *s)
{
    uint64_t pixels = (uint64_t)s->stored * s->area.width;

    job->pixels_done += pixels;
    job->frames[s->area.frame].rows_pixels += pixels;
}

static bool
fits(const struct job *job, const struct saved_unit *s)
{
    return s->area.frame < job->spec.nframes && s->stored <= s->area.height &&
           s->done == (s->stored == s->area.height) &&
           partition_restore(job->partition, s->unit, &s->area);
}

static int
take_unit(const struct recovery *r, const struct saved_unit *s)
{
    struct job *job = r->job;
    struct job_unit *u;

    if (!fits(job, s))
        return damaged(r, "unit", s->unit);
    if (!unit_grow(job))
        return rad_fail_memory(r->err);
    u = &job->units[s->unit];
    u->part = worker_of(r, s);
    if (u->part == JOB_NOBODY && (s->worker[0] || s->stored > 0))
        return s->worker[0] ? rad_fail_memory(r->err)
                            : damaged(r, "unit", s->unit);
    u->lead = s->attempt;
    if (s->attempt > u->latest)
        u->latest = s->attempt;
    u->tries = s->tries;
    job->units_redone += s->tries > 1 ? s->tries - 1 : 0;
    u->next_row = u->stored_rows = s->stored;
    count_rows(job, s);
    if (s->done) {
        u->counts = s->counts;
        unit_done(job, s->unit, s->end_ms);
        progress_see(job);
    }
    return 0;
}

/* Queue the units that are not done, the first of them in front, and keep each
 * for its worker. */
static void
queue_units(const struct recovery *r)
{
    struct job *job = r->job;

    for (uint32_t i = r->s->nunits; i-- > 0;)
        if (!r->s->units[i].done)
            partition_lost(job->partition, r->s->units[i].unit);
    for (uint32_t i = 0; i < job->nparts; i++)
        loss_keep(r->c, job, i, RETURN_MS);
}

/* --- base lines --- */

/* Is the last base line of this unit, which is done, the top of a unit that is
 * not done?  *line: the number of that line. */
static bool
is_needed(const struct job *job, const struct saved_unit *s, uint32_t *line)
{
    uint32_t first, last, below;

    partition_unit_lines(job->partition, s->unit, &first, &last);
    *line = last - 1;
    if (last == partition_lines(job->partition, s->area.frame))
        return false;
    below = partition_line_unit(job->partition, s->area.frame, last);
    return below == PARTITION_NONE || job->units[below].state != UNIT_DONE;
}

static int
put_bottom(const struct recovery *r, const struct saved_unit *s)
{
    struct job *job = r->job;
    uint8_t channels = job->spec.flags & MSG_JOB_DEPTH ? 4 : 3;
    uint32_t y = s->area.y + s->area.height - 1, line;
    struct msg_base_line m = { .frame = s->area.frame,
                               .n = s->area.width,
                               .ndensity = s->nbottom,
                               .channels = channels,
                               .density = s->bottom };
    uint8_t *pixels;
    bool whole = false;

    if (!is_needed(job, s, &line))
        return 0;
    if (s->nbottom != shared_ndensity(job->shared, s->area.frame))
        return damaged(r, "the base line of unit", s->unit);
    pixels = malloc((size_t)s->area.width * channels * 4);
    if (!pixels)
        return rad_fail_memory(r->err);
    m.line = line;
    m.pixels = pixels;
    if (r->row(r->arg, job->id, s->area.frame, y, pixels))
        whole = shared_put_base(job->shared, &m, r->c->now_ms);
    free(pixels);
    return whole ? 0 : damaged(r, "the base line of unit", s->unit);
}

/* --- frames --- */

static void
take_frame(struct job *job, uint32_t frame, const struct saved_frame *s)
{
    if (!s->written)
        return;
    frame_step(&job->frames[frame], s->fetched ? FRAME_FETCHED : FRAME_WRITTEN);
    job->unfetched += !s->fetched;
}

static int
take_frames(const struct recovery *r)
{
    struct job *job = r->job;

    for (uint32_t i = 0; i < job->spec.nframes; i++) {
        struct job_frame *f = &job->frames[i];

        take_frame(job, i, &r->s->frames[i]);
        if (frame_is_written(f) && f->pixels_left > 0)
            return damaged(r, "frame", job->spec.frames[i].number);
        if (!frame_is_written(f) && f->pixels_left == 0)
            result_frame_done(r->c, job, i);
    }
    frame_count_ready(job);
    return 0;
}

/* --- the job --- */

static int
take_units(const struct recovery *r)
{
    const struct saved_job *s = r->s;
    int rc = 0;

    if (s->nunits > 0)
        rc = job_split(r->job, r->err);
    for (uint32_t i = 0; i < s->nunits && rc == 0; i++)
        rc = take_unit(r, &s->units[i]);
    if (rc < 0)
        return rc;
    queue_units(r);
    for (uint32_t i = 0; i < s->nunits && rc == 0; i++)
        if (s->units[i].done && r->job->shared)
            rc = put_bottom(r, &s->units[i]);
    return rc;
}

/* Take up a job that goes on. */
static int
take_up(const struct recovery *r)
{
    struct job *job = r->job;
    const char *lost;
    int rc = take_units(r);

    if (rc == 0 && !kept_copy(&job->kept, r->s))
        rc = rad_fail_memory(r->err);
    if (rc == 0)
        rc = stages_take_up(r->c, job, r->err);
    if (rc == 0)
        rc = take_frames(r);
    if (rc < 0)
        return rc;
    job->restored = r->s->nunits > 0;
    if (r->s->nunits > 0)
        job->first_ms = job->open_ms;
    if (job->kept.n > 0 && !job->first_ms)
        passes_restore(job);
    filled_restore(job);
    if (r->s->state == JOB_PAUSED)
        life_pause(job);
    else if (job->first_ms)
        life_set_running(job);
    actions_log(&r->c->actions, ACT_INFO,
                "job goes on job=%s owner=%s units=%u pixels=%llu of=%llu",
                job->hex, job->owner, job->units_done,
                (unsigned long long)job->pixels_done,
                (unsigned long long)job->pixels_total);
    if (job->frames_ready == job->spec.nframes) /* the job's end was not kept */
        verdict_job(r->c, job, JOB_DONE, 0, NULL);
    else if (r->s->given_up)
        verdict_job(r->c, job, JOB_CANCELLED, EX_TEMPFAIL, "cancelled");
    else if ((lost = stages_lost(job)))
        verdict_job(r->c, job, JOB_FAILED, EX_IOERR, lost);
    joblife_end_all(r->c);
    return 0;
}

/* Take up a job that is over. */
static void
take_filed(const struct recovery *r)
{
    const struct saved_job *s = r->s;
    struct job *job = r->job;

    life_move(job, PLACE_FILED);
    life_step(job, (enum job_state)s->state);
    job->status = s->status;
    snprintf(job->text, sizeof job->text, "%s", s->text);
    job->last = s->last;
    job->goal.rungs[0] = s->last.rungs[0];
    job->goal.rungs[1] = s->last.rungs[1];
    job->goal.number = s->last.stage;
    job->goal.state = s->last.ended ? GOAL_REACHED : GOAL_AHEAD;
    job->goal.error = s->last.goal_error;
    job->kept_bytes = s->kept_bytes;
    job->cache.bytes = s->cache_bytes;
    for (uint32_t i = 0; i < job->spec.nframes; i++)
        take_frame(job, i, &s->frames[i]);
    frame_count_ready(job);
    order_move(r->c, job);
}

/* The time, but at most now: if the clock was set back a time of an earlier
 * life lies in the future. */
static uint64_t
not_after(uint64_t now_ms, uint64_t ms)
{
    return ms < now_ms ? ms : now_ms;
}

static void
take_times(struct job *job, uint64_t now_ms, const struct saved_job *s)
{
    job->offer_ms = not_after(now_ms, s->offer_ms);
    job->submit_ms = not_after(now_ms, s->submit_ms);
    job->open_ms = not_after(now_ms, s->open_ms);
    job->end_ms = job->over_ms = not_after(now_ms, s->end_ms);
    job->sent_bytes = s->sent_bytes;
}

int
recover_job(struct coord *c, uint64_t now_ms, const struct saved_job *s,
            recover_row_fn *row, void *arg, struct rad_error *err)
{
    struct recovery r = { .c = c, .s = s, .row = row, .arg = arg, .err = err };

    c->now_ms = now_ms;
    r.job = job_new(&s->spec, s->owner);
    if (!r.job || !joblife_add(c, r.job)) {
        joblife_free(r.job);
        return rad_fail_memory(err);
    }
    bygone_drop(c, r.job->id);
    take_times(r.job, now_ms, s);
    r.job->lives = s->lives + 1;
    if (!known_name(&r.job->payer->files, &r.job->spec.files))
        return rad_fail_memory(err);
    if (s->state >= JOB_DONE) {
        take_filed(&r);
        return 0;
    }
    life_move(r.job, PLACE_OPEN);
    return take_up(&r);
}

int
recover_drained(struct coord *c, uint64_t now_ms, const char *name,
                struct rad_error *err)
{
    struct coord_worker *w;

    c->now_ms = now_ms;
    w = connlife_worker(c, name);
    if (!w)
        return rad_fail_memory(err);
    w->drained = true;
    return 0;
}
