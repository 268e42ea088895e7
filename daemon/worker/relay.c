/* relay.c - see relay.h
 *
 * Messages about units that the child has pass between the coordinator and the
 * child.  A base line that the child makes goes to the coordinator, and at once
 * to the peer that waits for it.  The coordinator names that peer
 * (NEXT_HOLDER): often before the line is begun, sometimes when it is made
 * already, and it may name another peer later.  So the pieces of each base line
 * are kept here, put together, and a peer that is named or linked late gets
 * them from the first on.  If there are too many lines the oldest are dropped,
 * for the coordinator has a copy of all.  Unlike ambient records, base lines
 * are never dropped on a link that works. */
#include "config.h"

#include "worker/relay.h"

#include "machine/shelf.h"
#include "worker/gather.h"
#include "worker/peer.h"
#include "worker/state.h"
#include "worker/wjob.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BYTES ((size_t)64 << 20) /* of kept base lines of a job */
#define MOST_LINES 65536              /* base lines kept, or named */
#define BUCKETS    256

/* A base line of the job, as far as it came. */
struct rline {
    struct rline *next;    /* the next newer line */
    struct rline *chained; /* next in its bucket */
    uint32_t frame, line;
    struct shelf shelf;
    char name[MSG_MAX_NAME + 1]; /* the peer that waits for it; "": none */
    uint32_t to;                 /* id of the peer that sent_x and sent_d are
                                  * about; 0: none */
    uint32_t sent_x, sent_d;     /* columns and densities sent to that peer */
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

/* The line, made if need be; NULL: memory is out. */
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
put_piece(struct relay *r, struct rline *l, const struct msg_base_line *m)
{
    size_t before = shelf_bytes(&l->shelf);
    int rc = shelf_put(&l->shelf, m);

    r->bytes += shelf_bytes(&l->shelf) - before;
    return rc == 0;
}

/* Put into *m the next piece of the line, from column *x and density *first on,
 * and move *x and *first behind it; false: there is no more. */
static bool
next_piece(const struct wjob *job, const struct rline *l, uint32_t *x,
           uint32_t *first, struct msg_base_line *m)
{
    *m = (struct msg_base_line){ .job = job->id,
                                 .frame = l->frame,
                                 .line = l->line };
    return shelf_piece(&l->shelf, x, first, m);
}

/* --- to peers --- */

/* Send the peer that waits for the line, if it is linked, the pieces that it
 * has not got. */
static void
send_to_waiting(struct worker *w, struct wjob *job, struct rline *l)
{
    struct wpeer *p = l->name[0] ? peer_linked(job, l->name) : NULL;
    struct msg m = { .type = MSG_BASE_LINE };

    if (!p)
        return;
    if (l->to != p->id) {
        l->to = p->id;
        l->sent_x = l->sent_d = 0;
    }
    while (next_piece(job, l, &l->sent_x, &l->sent_d, &m.base_line))
        peer_send(w, job, p, &m);
}

void
relay_linked(struct worker *w, struct wjob *job, const char *name)
{
    for (struct rline *l = job->relay ? job->relay->first : NULL; l;
         l = l->next)
        if (strcmp(l->name, name) == 0)
            send_to_waiting(w, job, l);
}

static void
next_holder(struct worker *w, struct wjob *job, const struct msg *msg)
{
    const struct msg_next_holder *m = &msg->next_holder;
    struct rline *l = make_line(job, m->frame, m->line);

    if (!l) {
        w->actions.failed = true;
        return;
    }
    snprintf(l->name, sizeof l->name, "%s", m->name);
    send_to_waiting(w, job, l);
}

/* --- from the child --- */

static void
keep_line(struct worker *w, struct wjob *job, const struct msg_base_line *m)
{
    struct rline *l = make_line(job, m->frame, m->line);

    if (!l || !put_piece(job->relay, l, m)) {
        w->actions.failed = true;
        return;
    }
    send_to_waiting(w, job, l);
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

        while (next_piece(job, l, &x, &first, &m.base_line))
            actions_send(&w->actions, w->coord, &m);
    }
}

/* --- down to the child --- */

/* Pass a message about an attempt on if the child has the attempt. */
static void
to_attempt(struct worker *w, struct wjob *job, const struct msg *m,
           uint32_t unit, uint32_t attempt)
{
    if (wjob_find_attempt(job, unit, attempt))
        worker_send_child(w, job, m);
}

static void
on_split(struct worker *w, struct wjob *job, const struct msg *m)
{
    to_attempt(w, job, m, m->split.unit, m->split.attempt);
}

static void
on_yield(struct worker *w, struct wjob *job, const struct msg *m)
{
    to_attempt(w, job, m, m->yield.unit, m->yield.attempt);
}

static void
on_lend(struct worker *w, struct wjob *job, const struct msg *m)
{
    to_attempt(w, job, m, m->lend.unit, m->lend.attempt);
}

static void
to_child(struct worker *w, struct wjob *job, const struct msg *m, size_t len)
{
    if (job->state != WJOB_READY)
        return; /* the coordinator is about to hear that the child is gone */
    job->bytes_in += len;
    worker_send_child(w, job, m);
}

/* Columns that another worker lends are a unit of the child until PAID. */
static void
on_loan(struct worker *w, struct wjob *job, const struct msg *m)
{
    const struct msg_loan *l = &m->loan;

    w->progress++;
    if (job->state != WJOB_READY || l->frame >= job->nframes ||
        l->channels != job->channels ||
        wjob_find_attempt(job, l->unit, l->attempt))
        return;
    if (!wjob_add_attempt(job, l->unit, l->attempt)) {
        w->actions.failed = true;
        return;
    }
    wjob_find_attempt(job, l->unit, l->attempt)->loan = true;
    to_child(w, job, m, (size_t)l->n * l->channels * 8);
}

static void
on_back(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wattempt *a = wjob_find_attempt(job, m->back.unit, m->back.attempt);

    if (!a)
        return;
    a->parked = false;
    worker_send_child(w, job, m);
}

static void
on_facts(struct worker *w, struct wjob *job, const struct msg *m)
{
    to_child(w, job, m, (size_t)m->facts.npixels * m->facts.channels * 4);
}

static void
on_base_line(struct worker *w, struct wjob *job, const struct msg *m)
{
    to_child(w, job, m, (size_t)m->base_line.n * m->base_line.channels * 4);
}

static void
on_estimate(struct worker *w, struct wjob *job, const struct msg *m)
{
    w->progress++;
    to_child(w, job, m, 0);
}

static void
on_order(struct worker *w, struct wjob *job, const struct msg *m)
{
    to_child(w, job, m, 0);
}

static void
on_tile(struct worker *w, struct wjob *job, const struct msg *m)
{
    w->progress++;
    if (job->state != WJOB_READY || m->tile.pass < job->ready.passes)
        return; /* its pass was closed, or the coordinator is about to hear that
                 * the child is gone */
    if (m->tile.pass - job->ready.passes < WJOB_PASSES)
        job->ntiles[m->tile.pass % WJOB_PASSES]++;
    worker_send_child(w, job, m);
}

/* Ignore a pass that is not the child's next: a new child gets all passes again
 * from the first. */
static void
on_frozen(struct worker *w, struct wjob *job, const struct msg *m)
{
    if (job->state != WJOB_READY || m->frozen.pass != job->ready.passes)
        return;
    to_child(w, job, m, m->frozen.len);
    if (!m->frozen.last)
        return;
    wjob_next_pass(job);
    gather_frozen(w, job);
}

static void
on_tile_records(struct worker *w, struct wjob *job, const struct msg *m)
{
    gather_take(w, job, &m->tile_records);
}

static void
on_closed(struct worker *w, struct wjob *job, const struct msg *m)
{
    w->progress++;
    gather_closed(w, job, &m->closed);
}

static void
on_feed(struct worker *w, struct wjob *job, const struct msg *m)
{
    gather_feed(w, job, &m->feed);
}

static void
on_stage(struct worker *w, struct wjob *job, const struct msg *m)
{
    if (job->state != WJOB_READY || m->stage.pass < job->ready.passes)
        return;
    worker_send_child(w, job, m);
    job->ready.passes = m->stage.pass;
    memset(job->ntiles, 0, sizeof job->ntiles);
    gather_turn(job);
}

struct handler {
    enum msg_type type;
    size_t job; /* offset of the job's id in a struct msg */
    void (*handle)(struct worker *w, struct wjob *job, const struct msg *m);
};

/* The row of a message whose body is that member of struct msg. */
#define ROW(TYPE, body, handle)                                                \
    {                                                                          \
        MSG_##TYPE, offsetof(struct msg, body.job), handle                     \
    }

static const struct handler downwards[] = {
    ROW(SPLIT, split, on_split),
    ROW(YIELD, yield, on_yield),
    ROW(LEND, lend, on_lend),
    ROW(LOAN, loan, on_loan),
    ROW(BACK, back, on_back),
    ROW(FACTS, facts, on_facts),
    ROW(GUESS, guess, on_order),
    ROW(BASE_LINE, base_line, on_base_line),
    ROW(NEXT_HOLDER, next_holder, next_holder),
    ROW(ESTIMATE, estimate, on_estimate),
    ROW(TILE, tile, on_tile),
    ROW(FROZEN, frozen, on_frozen),
    ROW(STAGE, stage, on_stage),
    ROW(SHOW, show, on_order),
    ROW(TILE_RECORDS, tile_records, on_tile_records),
    ROW(CLOSED, closed, on_closed),
    ROW(FEED, feed, on_feed),
};

static const struct handler *
find_handler(const struct handler *v, size_t n, uint16_t type)
{
    for (size_t i = 0; i < n; i++)
        if (v[i].type == type)
            return &v[i];
    return NULL;
}

/* The id of the job that a message of the handler's type is about. */
static const uint8_t *
job_of(const struct handler *h, const struct msg *m)
{
    const uint8_t *id;

    memcpy(&id, (const char *)m + h->job, sizeof id);
    return id;
}

void
relay_down(struct worker *w, const struct msg *m)
{
    const struct handler *h = find_handler(
        downwards, sizeof downwards / sizeof downwards[0], m->type);
    struct wjob *job = h ? worker_find_job(w, job_of(h, m)) : NULL;

    if (job)
        h->handle(w, job, m);
}

/* --- up --- */

/* Send a message up if the coordinator is there.  If it is lost pixels are
 * traced again, no more. */
static void
pass_up(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wire_out *out = &w->actions.scratch;

    out->len = 0;
    if (w->coord_state != COORD_WELCOME)
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
child_parked(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wattempt *a =
        wjob_find_attempt(job, m->parked.unit, m->parked.attempt);

    if (!a)
        return; /* revoked meanwhile */
    a->parked = true;
    pass_up(w, job, m);
}

/* The child works on the unit again: if it dies the unit is a suspect. */
static void
child_resumed(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wattempt *a =
        wjob_find_attempt(job, m->resumed.unit, m->resumed.attempt);

    (void)w;
    if (a)
        a->parked = false;
}

/* Pass PAID on even if the loan was revoked meanwhile, for no other message
 * tells its cost.  In case a PAID is lost TALLY tells the sum of all.  A new
 * child's sum begins at 0: the coordinator is told that before its first PAID.
 */
static void
child_paid(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wattempt *a = wjob_find_attempt(job, m->paid.unit, m->paid.attempt);

    if (a && a->loan)
        wjob_drop_attempt(job, a->unit, a->number);
    if (job->tally.busy_s == 0)
        worker_send_tally(w, job);
    msg_counts_add(w->coord_state == COORD_WELCOME ? &job->paid : &job->unpaid,
                   &m->paid.counts);
    pass_up(w, job, m);
}

static void
child_gave(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wattempt *a = wjob_find_attempt(job, m->gave.unit, m->gave.attempt);

    if (!a)
        return;
    a->height = m->gave.height;
    if (a->height == 0)
        wjob_drop_attempt(job, a->unit, a->number);
    pass_up(w, job, m);
}

/* Tell the child that all columns which it lent of the unit are its own again.
 */
static void
give_back(struct worker *w, struct wjob *job, struct wattempt *a)
{
    const struct msg m = { .type = MSG_BACK,
                           .back = { .job = job->id,
                                     .unit = a->unit,
                                     .attempt = a->number,
                                     .line = a->line } };

    a->lends = false;
    a->parked = false;
    worker_send_child(w, job, &m);
}

void
relay_cut(struct worker *w)
{
    for (struct wjob *job = w->jobs; job; job = job->next)
        for (uint32_t i = 0; i < job->nattempts; i++)
            if (job->attempts[i].lends)
                give_back(w, job, &job->attempts[i]);
}

static void
child_loan(struct worker *w, struct wjob *job, const struct msg *m)
{
    struct wattempt *a = wjob_find_attempt(job, m->loan.unit, m->loan.attempt);

    if (!a)
        return;
    a->lends = true;
    a->line = m->loan.line;
    if (w->coord_state == COORD_WELCOME)
        pass_up(w, job, m);
    else
        give_back(w, job, a); /* nobody can borrow now */
}

static void
child_base_line(struct worker *w, struct wjob *job, const struct msg *m)
{
    job->base_line_pixels += m->base_line.n;
    pass_up(w, job, m);
    keep_line(w, job, &m->base_line);
}

static void
child_tile_made(struct worker *w, struct wjob *job, const struct msg *m)
{
    uint32_t *n = &job->ntiles[m->tile_made.pass % WJOB_PASSES];

    if (m->tile_made.pass < job->ready.passes)
        return; /* the pass was closed meanwhile */
    if (*n > 0)
        --*n;
    pass_up(w, job, m);
}

static const struct handler upwards[] = {
    ROW(FACTS, facts, pass_up),
    ROW(GUESS, guess, pass_up),
    ROW(PARKED, parked, child_parked),
    ROW(GAVE, gave, child_gave),
    ROW(BASE_LINE, base_line, child_base_line),
    ROW(ESTIMATED, estimated, pass_up),
    ROW(LOAN, loan, child_loan),
    ROW(PAID, paid, child_paid),
    ROW(LINE_COSTS, line_costs, pass_up),
    ROW(RESUMED, resumed, child_resumed),
    ROW(TILE_MADE, tile_made, child_tile_made),
};

void
relay_up(struct worker *w, struct wjob *job, const struct msg *m)
{
    const struct handler *h =
        find_handler(upwards, sizeof upwards / sizeof upwards[0], m->type);
    const uint8_t *id = job->id;
    struct msg pass = *m;

    if (!h)
        return;
    pass.request = 0;
    memcpy((char *)&pass + h->job, &id,
           sizeof id); /* in place of the child's */
    h->handle(w, job, &pass);
}
