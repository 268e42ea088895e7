/* records.c - see records.h
 *
 * A job that begins with another job's records has these as its first pass.
 * Until the store has read them, a worker that lacks them gets no records of
 * other passes. */
#include "config.h"

#include "filling/records.h"

#include "filling/passes_impl.h"
#include "desk/feeding.h"
#include "jobs/part.h"
#include "proto/ambshare.h"

#include <string.h>

/* Send a worker the records of a closed pass (FROZEN). */
static void
send_closed(struct coord *c, const struct job *job, uint32_t pass,
            const struct coord_worker *w)
{
    const struct closed *k = &job->passes->closed[pass];
    struct msg m = { .type = MSG_FROZEN,
                     .frozen = { .job = job->id,
                                 .pass = job->passes->base + pass } };

    while (ambshare_piece(&m.frozen, k->records, k->n))
        actions_send(&c->actions, w->conn, &m);
}

bool
records_allow(const struct job *job, uint32_t index, uint32_t passes)
{
    return desk_is_ready(job, index) &&
           job->parts[index].passes >= job->passes->base + passes;
}

static struct msg
stage_of(const struct job *job)
{
    return (struct msg){ .type = MSG_STAGE,
                         .stage = { job->id, job->passes->base,
                                    goal_options(job) } };
}

/* Send SHOW to a worker that was told of all passes of a job with a goal: the
 * options of the pictures, which were chosen after the worker's last STAGE. */
static void
show_pictures(struct coord *c, const struct job *job, struct job_part *part)
{
    const struct passes *s = job->passes;
    struct msg m = { .type = MSG_SHOW,
                     .show = { job->id, s->base + s->n - 1,
                               goal_options(job) } };

    if (job->goal.state == GOAL_AHEAD || s->n == 0 || part->shows ||
        part->lags || part->passes != s->base + s->n)
        return;
    actions_send(&c->actions, part->worker->conn, &m);
    part->shows = true;
}

/* Pack a message once, and send it to each worker that wanted() names. */
static void
send_some(struct coord *c, const struct job *job, const struct msg *m,
          bool (*wanted)(const struct job *job, uint32_t index))
{
    struct wire_out *out = &c->actions.scratch;
    uint8_t *kept;

    out->len = 0;
    if (msg_pack(out, m) != 0 ||
        !(kept = actions_keep(&c->actions, out->buf, out->len))) {
        c->actions.failed = true;
        return;
    }
    for (uint32_t i = 0; i < job->nparts; i++)
        if (wanted(job, i))
            actions_send_kept(&c->actions, job->parts[i].worker->conn, kept,
                              out->len);
}

static struct msg
message_of(const struct job *job, uint32_t pass, uint32_t tile)
{
    const struct tile *t = &passes_sheet(job->passes, pass)->tile[tile];
    size_t len = (size_t)t->n * AMBSHARE_BYTES;

    return (struct msg){ .type = MSG_TILE_RECORDS,
                         .tile_records = { job->id, job->passes->base + pass,
                                           tile, t->n, t->records, len } };
}

/* Send a new worker the records of the tiles of open passes that are made so
 * far. */
static void
send_made(struct coord *c, const struct job *job, const struct coord_worker *w)
{
    struct passes *s = job->passes;

    for (uint32_t pass = s->open; pass < s->opened; pass++) {
        const struct sheet *k = passes_sheet(s, pass);

        for (uint32_t i = 0; i < k->ntiles; i++)
            if (k->tile[i].made && k->tile[i].n > 0) {
                struct msg m = message_of(job, pass, i);

                actions_send(&c->actions, w->conn, &m);
            }
    }
}

void
records_feed(struct coord *c, struct job *job, uint32_t pass, uint32_t tile)
{
    struct msg m = message_of(job, pass, tile);

    if (m.tile_records.count > 0)
        send_some(c, job, &m, feeding_is_direct);
}

/* Must the worker wait for the first pass, which has yet to come from the
 * store?
 */
static bool
awaits_store(const struct passes *s, const struct job_part *part)
{
    return s->reuse != REUSE_NONE && part->passes == 0;
}

/* Must the worker answer that it has the records of the pass, before it gets
 * more?  Yes after a batch's last pass, for units follow; and if the worker has
 * a tile of the pass that another worker made meanwhile, for it may hang. */
static bool
must_confirm(const struct passes *s, const struct job_part *part, uint32_t pass)
{
    return part->ntiles[pass % MSG_OPEN_PASSES] > 0 ||
           rad_pass_is_last(s->plan, s->n, pass);
}

/* Tell a worker of closed passes, up to the first that the worker must confirm.
 */
static void
tell_closed(struct coord *c, const struct job *job, struct job_part *part)
{
    const struct passes *s = job->passes;

    while (!part->lags && !awaits_store(s, part) &&
           part->passes < passes_number(s)) {
        uint32_t pass = part->passes - s->base;
        const struct closed *k = &s->closed[pass];
        struct msg m = { .type = MSG_CLOSED,
                         .closed = { job->id, part->passes, k->n, k->sum,
                                     must_confirm(s, part, pass) } };

        if (m.closed.asks)
            part->lags = true;
        else
            part->passes++;
        actions_send(&c->actions, part->worker->conn, &m);
    }
    show_pictures(c, job, part);
}

void
records_tell(struct coord *c, struct job *job)
{
    const struct passes *s = job->passes;

    feeding_mend(c, job);
    for (uint32_t i = 0; i < job->nparts; i++) {
        struct job_part *part = &job->parts[i];

        if (desk_is_ready(job, i))
            tell_closed(c, job, part);
        part->ntiles[(s->open - 1) % MSG_OPEN_PASSES] = 0;
    }
}

void
records_to_users(struct coord *c, const struct job *job, uint32_t pass)
{
    const struct closed *k = &job->passes->closed[pass];
    struct msg_frozen m = { 0 };

    while (ambshare_piece(&m, k->records, k->n))
        if (m.count > 0)
            desk_send_records(
                c, job,
                &(struct msg_records){ job->id, m.count, m.data, m.len });
}

/* Send a worker all that it lacks and that is here: stage, records, options. */
static void
catch_up(struct coord *c, const struct job *job, struct job_part *part)
{
    const struct passes *s = job->passes;

    if (!s || awaits_store(s, part))
        return;
    if (part->passes < s->base) {
        struct msg m = stage_of(job);

        actions_send(&c->actions, part->worker->conn, &m);
        part->passes = s->base;
    }
    for (; part->passes < passes_number(s); part->passes++)
        send_closed(c, job, part->passes - s->base, part->worker);
    part->lacked = part->passes;
    show_pictures(c, job, part);
    if (job->filling)
        send_made(c, job, part->worker);
}

/* May the worker have passes of another stage?  With a limit of time a
 * restarted coordinator may decide on a stage in another way than its earlier
 * life. */
static bool
may_be_stale(const struct job *job, const struct job_part *part, uint32_t have)
{
    return job->spec.time_ms > 0 && have > part->passes;
}

bool
records_ready(struct coord *c, struct job *job, uint32_t index, uint32_t have)
{
    struct job_part *part = &job->parts[index];
    struct passes *s = job->passes;
    uint32_t closed = s ? passes_number(s) : 0;

    if (have > closed || may_be_stale(job, part, have))
        return false;
    part->passes = part->lacked = have;
    part->lags = part->shows = false;
    memset(part->ntiles, 0, sizeof part->ntiles);
    catch_up(c, job, part);
    return true;
}

void
records_holds(struct coord *c, struct coord_worker *w, const struct msg *msg)
{
    const struct msg_holds *m = &msg->holds;
    uint32_t index;
    struct job *job = desk_job_of(c, w, m->job, &index);
    struct job_part *part = job ? &job->parts[index] : NULL;

    if (!part || !job->passes || m->pass < part->lacked ||
        m->pass >= part->passes + part->lags || m->pass < job->passes->base)
        return;
    if (!m->whole) {
        feeding_lacked(job, index);
        send_closed(c, job, m->pass - job->passes->base, w);
        part->lacked = m->pass + 1;
    }
    if (m->pass != part->passes)
        return;
    part->passes++;
    part->lags = false;
    tell_closed(c, job, part);
    c->stirred = true;
}

void
records_came(struct coord *c, struct job *job)
{
    for (uint32_t i = 0; i < job->nparts; i++)
        if (desk_is_ready(job, i) && job->parts[i].passes == 0)
            catch_up(c, job, &job->parts[i]);
}

void
records_drop(struct coord *c, struct job *job)
{
    struct msg m = stage_of(job);

    for (uint32_t i = 0; i < job->nparts; i++) {
        struct job_part *part = &job->parts[i];

        memset(part->ntiles, 0, sizeof part->ntiles);
        part->passes = part->lacked =
            desk_is_ready(job, i) ? job->passes->base : 0;
        part->lags = false;
    }
    send_some(c, job, &m, desk_is_ready);
}
