/* relay.c - shared lines, and tiles of passes, on their way through a worker
 *
 * Messages about units that the child has pass between the coordinator and the
 * child.  A base line that the child makes goes to the coordinator, and at once
 * to the peer that waits for it.  The coordinator names that peer
 * (NEXT_HOLDER), often before the line is begun, sometimes when it is made
 * already, and may name another later.  So the pieces of a base line are kept
 * here, put together, and sent from the beginning to a peer that is named, or
 * linked, later.  When there are too many lines the oldest are dropped: the
 * coordinator has a copy of all.  Unlike ambient records, base lines are never
 * dropped on a link that lives. */
#include "config.h"

#include "worker/relay.h"

#include "machine/shelf.h"
#include "worker/gather.h"
#include "worker/peer.h"
#include "worker/state.h"
#include "worker/wjob.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BYTES ((size_t)64 << 20) /* of kept lines of a job */
#define MOST_LINES 65536              /* kept, or known by name */
#define BUCKETS    256

struct rline {
    struct rline *next;    /* the newer one */
    struct rline *chained; /* in its bucket */
    uint32_t frame, line;
    struct shelf shelf;
    char name[MSG_MAX_NAME + 1]; /* the peer that waits for it; "": none */
    uint32_t to;                 /* peer that the next two are of; 0: none */
    uint32_t sent_x, sent_d;
};

struct relay {
    struct rline *first, **end; /* the oldest first */
    struct rline *bucket[BUCKETS];
    uint32_t n;
    size_t bytes;
};

/* --- the table --- */

static struct rline **
bucket_of(struct relay *r, uint32_t frame, uint32_t line)
{
    return &r->bucket[(frame * 31 + line) % BUCKETS];
}

static struct rline *
find_line(struct relay *r, uint32_t frame, uint32_t line)
{
    struct rline *l = *bucket_of(r, frame, line);

    while (l && (l->frame != frame || l->line != line))
        l = l->chained;
    return l;
}

static void
drop_oldest(struct relay *r)
{
    struct rline *l = r->first, **at = bucket_of(r, l->frame, l->line);

    while (*at != l)
        at = &(*at)->chained;
    *at = l->chained;
    r->first = l->next;
    if (!r->first)
        r->end = &r->first;
    r->n--;
    r->bytes -= shelf_bytes(&l->shelf);
    shelf_clear(&l->shelf);
    free(l);
}

/* The line, made if need be; NULL when memory is out. */
static struct rline *
make_line(struct wjob *job, uint32_t frame, uint32_t line)
{
    struct relay *r = job->relay;
    struct rline *l, **at;

    if (!r) {
        r = calloc(1, sizeof *r);
        if (!r)
            return NULL;
        r->end = &r->first;
        job->relay = r;
    }
    l = find_line(r, frame, line);
    if (l)
        return l;
    if (r->n == MOST_LINES)
        drop_oldest(r);
    l = calloc(1, sizeof *l);
    if (!l)
        return NULL;
    l->frame = frame;
    l->line = line;
    at = bucket_of(r, frame, line);
    l->chained = *at;
    *at = l;
    *r->end = l;
    r->end = &l->next;
    r->n++;
    return l;
}

void
relay_release(struct wjob *job)
{
    while (job->relay && job->relay->first)
        drop_oldest(job->relay);
    free(job->relay);
    job->relay = NULL;
}

/* --- pieces --- */

static bool
put(struct relay *r, struct rline *l, const struct msg_base_line *m)
{
    size_t before = shelf_bytes(&l->shelf);
    int rc = shelf_put(&l->shelf, m);

    r->bytes += shelf_bytes(&l->shelf) - before;
    return rc == 0;
}

/* The piece from column *x and density *first on, which then stand behind it;
 * false: there is none. */
static bool
piece(const struct wjob *job, const struct rline *l, uint32_t *x,
      uint32_t *first, struct msg_base_line *m)
{
    *m = (struct msg_base_line){ .job = job->id,
                                 .frame = l->frame,
                                 .line = l->line };
    return shelf_piece(&l->shelf, x, first, m);
}

/* --- to peers --- */

/* Send the peer that waits for the line the pieces that it has not got, if it
 * is linked. */
static void
flush(struct worker *w, struct wjob *job, struct rline *l)
{
    struct wpeer *p = l->name[0] ? peer_linked(job, l->name) : NULL;
    struct msg m = { .type = MSG_BASE_LINE };

    if (!p)
        return;
    if (l->to != p->id) {
        l->to = p->id;
        l->sent_x = l->sent_d = 0;
    }
    while (piece(job, l, &l->sent_x, &l->sent_d, &m.base_line))
        peer_send(w, job, p, &m);
}

void
relay_linked(struct worker *w, struct wjob *job, const char *name)
{
    for (struct rline *l = job->relay ? job->relay->first : NULL; l;
         l = l->next)
        if (strcmp(l->name, name) == 0)
            flush(w, job, l);
}

static void
next_holder(struct worker *w, struct wjob *job, const struct msg_next_holder *m)
{
    struct rline *l = make_line(job, m->frame, m->line);

    if (!l) {
        w->actions.failed = true;
        return;
    }
    snprintf(l->name, sizeof l->name, "%s", m->name);
    flush(w, job, l);
}

/* --- from the child --- */

static void
made(struct worker *w, struct wjob *job, const struct msg_base_line *m)
{
    struct rline *l = make_line(job, m->frame, m->line);

    if (!l || !put(job->relay, l, m)) {
        w->actions.failed = true;
        return;
    }
    flush(w, job, l);
    while (job->relay->bytes > MOST_BYTES && job->relay->first->next)
        drop_oldest(job->relay);
}

void
relay_repeat(struct worker *w, const struct wjob *job)
{
    struct msg m = { .type = MSG_BASE_LINE };

    for (struct rline *l = job->relay ? job->relay->first : NULL; l;
         l = l->next) {
        uint32_t x = 0, first = 0;

        while (piece(job, l, &x, &first, &m.base_line))
            actions_send(&w->actions, w->coord, &m);
    }
}

/* --- down to the child --- */

/* TWIN, SPLIT and YIELD, about a unit that the child has. */
static void
on_attempt(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->twin.job);

    if (job && wjob_find_unit(job, m->twin.unit, m->twin.attempt))
        worker_send_child(w, job, m);
}

/* FACTS, BASE_LINE, ESTIMATE and REST, which all begin with the job. */
static void
to_child(struct worker *w, const struct msg *m, const uint8_t *id, size_t len)
{
    struct wjob *job = worker_find_job(w, id);

    if (!job || job->state != WJOB_READY)
        return; /* the coordinator will hear of the lost child */
    job->bytes_in += len;
    worker_send_child(w, job, m);
}

static void
on_lend(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->lend.job);

    if (job && wjob_find_unit(job, m->lend.unit, m->lend.attempt))
        worker_send_child(w, job, m);
}

/* Columns that another worker lends are a unit like others, until PAID. */
static void
on_loan(struct worker *w, const struct msg *m)
{
    const struct msg_loan *l = &m->loan;
    struct wjob *job = worker_find_job(w, l->job);

    w->progress++;
    if (!job || job->state != WJOB_READY || l->frame >= job->nframes ||
        l->channels != job->channels ||
        wjob_find_unit(job, l->unit, l->attempt))
        return;
    if (!wjob_add_unit(job, l->unit, l->attempt)) {
        w->actions.failed = true;
        return;
    }
    wjob_find_unit(job, l->unit, l->attempt)->loan = true;
    job->bytes_in += (size_t)l->n * l->channels * 8;
    worker_send_child(w, job, m);
}

static void
on_back(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->back.job);
    struct wunit *u =
        job ? wjob_find_unit(job, m->back.unit, m->back.attempt) : NULL;

    if (!u)
        return;
    u->parked = false;
    worker_send_child(w, job, m);
}

static void
on_facts(struct worker *w, const struct msg *m)
{
    to_child(w, m, m->facts.job,
             (size_t)m->facts.npixels * m->facts.channels * 4);
}

static void
on_base_line(struct worker *w, const struct msg *m)
{
    to_child(w, m, m->base_line.job,
             (size_t)m->base_line.n * m->base_line.channels * 4);
}

static void
on_estimate(struct worker *w, const struct msg *m)
{
    w->progress++;
    to_child(w, m, m->estimate.job, 0);
}

static void
on_tile(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->tile.job);

    w->progress++;
    if (!job || job->state != WJOB_READY || m->tile.pass < job->ready.passes)
        return; /* its pass was closed, or the coordinator will hear of the lost
                 * child */
    if (m->tile.pass - job->ready.passes < WJOB_PASSES)
        job->ntiles[m->tile.pass % WJOB_PASSES]++;
    worker_send_child(w, job, m);
}

/* A child that was lost meanwhile gets all passes again, from the first. */
static void
on_frozen(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->frozen.job);

    if (!job || job->state != WJOB_READY || m->frozen.pass != job->ready.passes)
        return;
    job->bytes_in += m->frozen.len;
    worker_send_child(w, job, m);
    if (!m->frozen.last)
        return;
    wjob_next_pass(job);
    gather_frozen(w, job);
}

static void
on_tile_records(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->tile_records.job);

    if (job)
        gather_take(w, job, &m->tile_records);
}

static void
on_closed(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->closed.job);

    w->progress++;
    if (job)
        gather_closed(w, job, &m->closed);
}

static void
on_feed(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->feed.job);

    if (job)
        gather_feed(w, job, &m->feed);
}

static void
on_stage(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->stage.job);

    if (!job || job->state != WJOB_READY || m->stage.pass < job->ready.passes)
        return;
    worker_send_child(w, job, m);
    job->ready.passes = m->stage.pass;
    memset(job->ntiles, 0, sizeof job->ntiles);
    gather_turn(job);
}

static void
on_rest(struct worker *w, const struct msg *m)
{
    to_child(w, m, m->rest.job, 0);
}

static void
on_next_holder(struct worker *w, const struct msg *m)
{
    struct wjob *job = worker_find_job(w, m->next_holder.job);

    if (job)
        next_holder(w, job, &m->next_holder);
}

static const struct {
    enum msg_type type;
    void (*handle)(struct worker *w, const struct msg *m);
} downwards[] = {
    { MSG_TWIN, on_attempt },
    { MSG_SPLIT, on_attempt },
    { MSG_YIELD, on_attempt },
    { MSG_LEND, on_lend },
    { MSG_LOAN, on_loan },
    { MSG_BACK, on_back },
    { MSG_FACTS, on_facts },
    { MSG_BASE_LINE, on_base_line },
    { MSG_NEXT_HOLDER, on_next_holder },
    { MSG_ESTIMATE, on_estimate },
    { MSG_TILE, on_tile },
    { MSG_FROZEN, on_frozen },
    { MSG_STAGE, on_stage },
    { MSG_TILE_RECORDS, on_tile_records },
    { MSG_CLOSED, on_closed },
    { MSG_FEED, on_feed },
    { MSG_REST, on_rest },
};

void
relay_down(struct worker *w, const struct msg *m)
{
    for (size_t i = 0; i < sizeof downwards / sizeof downwards[0]; i++)
        if (downwards[i].type == m->type)
            downwards[i].handle(w, m);
}

/* --- up --- */

/* Send a message up, if the coordinator is there; its loss costs time alone. */
static void
pass_up(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wire_out *out = &w->actions.scratch;

    out->len = 0;
    if (!w->welcome)
        return;
    if (msg_pack(out, m) != 0) {
        w->actions.failed = true;
        return;
    }
    w->progress++;
    job->bytes_out += out->len;
    if (m->type == MSG_BASE_LINE)
        job->base_line_bytes += out->len;
    actions_send_bytes(&w->actions, w->coord, out->buf, out->len);
}

static void
child_facts(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_FACTS, .facts = m->facts };

    pass.facts.job = job->id;
    pass_up(w, job, &pass);
}

static void
child_parked(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_PARKED, .parked = m->parked };
    struct wunit *u = wjob_find_unit(job, m->parked.unit, m->parked.attempt);

    if (!u)
        return; /* revoked meanwhile */
    u->parked = true;
    pass.parked.job = job->id;
    pass_up(w, job, &pass);
}

/* The child is at the unit again: should it die, the unit is a suspect. */
static void
child_resumed(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wunit *u = wjob_find_unit(job, m->resumed.unit, m->resumed.attempt);

    (void)w;
    if (u)
        u->parked = false;
}

/* Pass PAID on even if the loan was revoked meanwhile, for no other message has
 * its cost.  TALLY has the sum of all PAIDs, in case a PAID is lost; a child's
 * sum begins at 0, which the coordinator is told before the first PAID. */
static void
child_paid(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_PAID, .paid = m->paid };
    struct wunit *u = wjob_find_unit(job, m->paid.unit, m->paid.attempt);

    if (u && u->loan)
        wjob_drop_unit(job, u->unit, u->attempt);
    pass.paid.job = job->id;
    if (job->tally.busy_s == 0)
        worker_send_tally(w, job);
    msg_counts_add(w->welcome ? &job->paid : &job->unpaid, &m->paid.counts);
    pass_up(w, job, &pass);
}

static void
child_line_costs(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_LINE_COSTS, .line_costs = m->line_costs };

    pass.line_costs.job = job->id;
    pass_up(w, job, &pass);
}

static void
child_gave(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_GAVE, .gave = m->gave };
    struct wunit *u = wjob_find_unit(job, m->gave.unit, m->gave.attempt);

    if (!u)
        return;
    u->height = m->gave.height;
    if (u->height == 0)
        wjob_drop_unit(job, u->unit, u->attempt);
    pass.gave.job = job->id;
    pass_up(w, job, &pass);
}

/* Give the child back all columns that it lent of the unit. */
static void
give_back(struct worker *w, struct wjob *job, struct wunit *u)
{
    const struct msg m = { .type = MSG_BACK,
                           .back = { .job = job->id,
                                     .unit = u->unit,
                                     .attempt = u->attempt,
                                     .line = u->line } };

    u->lends = false;
    u->parked = false;
    worker_send_child(w, job, &m);
}

void
relay_cut(struct worker *w)
{
    for (struct wjob *job = w->jobs; job; job = job->next)
        for (uint32_t i = 0; i < job->nunits; i++)
            if (job->units[i].lends)
                give_back(w, job, &job->units[i]);
}

static void
child_loan(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_LOAN, .loan = m->loan };
    struct wunit *u = wjob_find_unit(job, m->loan.unit, m->loan.attempt);

    if (!u)
        return;
    u->lends = true;
    u->line = m->loan.line;
    pass.loan.job = job->id;
    if (w->welcome)
        pass_up(w, job, &pass);
    else
        give_back(w, job, u); /* there is nobody to lend to */
}

static void
child_base_line(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_BASE_LINE, .base_line = m->base_line };

    pass.base_line.job = job->id;
    job->base_line_pixels += m->base_line.n;
    pass_up(w, job, &pass);
    made(w, job, &pass.base_line);
}

static void
child_estimated(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_ESTIMATED, .estimated = m->estimated };

    pass.estimated.job = job->id;
    pass_up(w, job, &pass);
}

static void
child_tile_made(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct msg pass = { .type = MSG_TILE_MADE, .tile_made = m->tile_made };

    uint32_t *n = &job->ntiles[m->tile_made.pass % WJOB_PASSES];

    if (m->tile_made.pass < job->ready.passes)
        return; /* the pass was closed meanwhile */
    if (*n > 0)
        --*n;
    pass.tile_made.job = job->id;
    pass_up(w, job, &pass);
}

static const struct {
    enum msg_type type;
    void (*handle)(struct worker *w, struct wjob *job, const struct msg *m);
} upwards[] = {
    { MSG_FACTS, child_facts },         { MSG_PARKED, child_parked },
    { MSG_GAVE, child_gave },           { MSG_BASE_LINE, child_base_line },
    { MSG_ESTIMATED, child_estimated }, { MSG_LOAN, child_loan },
    { MSG_PAID, child_paid },           { MSG_LINE_COSTS, child_line_costs },
    { MSG_RESUMED, child_resumed },     { MSG_TILE_MADE, child_tile_made },
};

void
relay_up(struct worker *w, struct wjob *job, const struct msg *m)
{
    for (size_t i = 0; i < sizeof upwards / sizeof upwards[0]; i++)
        if (upwards[i].type == m->type)
            upwards[i].handle(w, job, m);
}
