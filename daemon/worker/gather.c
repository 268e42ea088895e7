/* gather.c - see gather.h
 *
 * Of some passes records are kept, from the first that the child lacks: the
 * coordinator goes on to the next ones without waiting for this worker.
 * Each tile's records are passed on once, so that they do not go round however
 * workers are told to feed each other. */
#include "config.h"

#include "worker/gather.h"

#include "machine/rowsum.h"
#include "machine/saved.h"
#include "proto/ambshare.h"
#include "worker/peer.h"
#include "worker/state.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Records that are under way when a pass is closed take no longer than that one
 * after the other. */
#define QUIET_MS 100

/* Records of a job's passes that are here, in bytes: of a stage no coordinator
 * takes more (filling/passes.c). */
#define MOST_BYTES SAVED_STAGE_BYTES

#define PASSES WJOB_PASSES

struct gtile {
    uint8_t *data;
    uint32_t count;
};

/* The records of a pass, by tile. */
struct gpass {
    uint32_t pass;
    uint32_t room;
    struct gtile *tile;
    uint64_t bytes;
    bool closed; /* it is, with: */
    uint32_t count;
    uint64_t sum;
    bool asks;
};

struct gather {
    struct gpass of[PASSES]; /* by the pass's number */
    uint32_t closed;         /* passes before are closed */
    bool lacks;              /* the coordinator was told that the first of
                              * these which the child has not got is not whole:
                              * it comes as FROZEN */
    uint64_t heard_ms;       /* when something of that pass came */
    uint32_t nfed;
    char fed[MSG_MOST_FED][MSG_MAX_NAME + 1];
};

static void
drop_pass(struct gpass *p)
{
    for (uint32_t i = 0; i < p->room; i++)
        free(p->tile[i].data);
    free(p->tile);
    *p = (struct gpass){ 0 };
}

void
gather_release(struct wjob *job)
{
    if (!job->gather)
        return;
    for (int i = 0; i < PASSES; i++)
        drop_pass(&job->gather->of[i]);
    free(job->gather);
    job->gather = NULL;
}

static struct gather *
open_gather(struct worker *w, struct wjob *job)
{
    if (!job->gather)
        job->gather = calloc(1, sizeof *job->gather);
    if (!job->gather)
        w->actions.failed = true;
    return job->gather;
}

static bool
is_near(const struct wjob *job, uint32_t pass)
{
    return job->state == WJOB_READY && pass >= job->ready.passes &&
           pass - job->ready.passes < PASSES;
}

void
gather_turn(struct wjob *job)
{
    struct gather *g = job->gather;

    if (!g)
        return;
    g->closed = 0;
    g->lacks = false;
    for (int i = 0; i < PASSES; i++) {
        g->of[i].closed = false;
        if (!is_near(job, g->of[i].pass))
            drop_pass(&g->of[i]);
    }
}

/* What is known of a pass that is near. */
static struct gpass *
pass_at(struct gather *g, uint32_t pass)
{
    struct gpass *p = &g->of[pass % PASSES];

    if (p->pass != pass) {
        drop_pass(p);
        p->pass = pass;
    }
    return p;
}

/* --- records that come --- */

/* Room for that many tiles; false: memory is out. */
static bool
make_room(struct gpass *p, uint32_t tiles)
{
    uint32_t room = p->room > 0 ? p->room : 64;
    struct gtile *tile;

    if (tiles <= p->room)
        return true;
    while (room < tiles)
        room *= 2;
    tile = realloc(p->tile, room * sizeof *tile);
    if (!tile)
        return false;
    memset(tile + p->room, 0, (room - p->room) * sizeof *tile);
    p->tile = tile;
    p->room = room;
    return true;
}

/* Is there room for so many bytes more, of a job's passes that are here and of
 * that one? */
static bool
is_within(const struct gather *g, const struct gpass *p, size_t more)
{
    uint64_t all = more;

    for (int i = 0; i < PASSES; i++)
        all += g->of[i].bytes;
    return all <= MOST_BYTES &&
           (!p->closed ||
            p->bytes + more <= (uint64_t)p->count * AMBSHARE_BYTES);
}

/* Keep a tile's records; false: they are here, or of no use. */
static bool
keep(struct worker *w, struct gather *g, struct gpass *p,
     const struct msg_tile_records *m)
{
    struct gtile *t;

    if (m->count == 0 || m->len != (size_t)m->count * AMBSHARE_BYTES ||
        !is_within(g, p, m->len) ||
        (m->tile < p->room && p->tile[m->tile].data))
        return false;
    if (!make_room(p, m->tile + 1) ||
        !(p->tile[m->tile].data = malloc(m->len))) {
        w->actions.failed = true;
        return false;
    }
    t = &p->tile[m->tile];
    t->count = m->count;
    memcpy(t->data, m->data, m->len);
    p->bytes += m->len;
    return true;
}

static void
pass_on(struct worker *w, struct wjob *job, const struct msg_tile_records *m)
{
    struct wire_out *out = &w->actions.scratch;
    const struct gather *g = job->gather;
    struct msg pass = { .type = MSG_TILE_RECORDS, .tile_records = *m };
    uint8_t *kept = NULL;

    out->len = 0;
    if (g->nfed == 0 || msg_pack(out, &pass) != 0)
        return;
    for (uint32_t i = 0; i < g->nfed; i++) {
        struct wpeer *p = peer_named(job, g->fed[i]);

        if (p)
            peer_records(w, job, p, &kept);
    }
}

/* --- a pass that is closed --- */

static void
say(struct worker *w, const struct wjob *job, bool whole)
{
    struct msg m = { .type = MSG_HOLDS,
                     .holds = { job->id, job->ready.passes, whole } };

    worker_send_coord(w, &m);
}

static void
say_lacks(struct worker *w, struct wjob *job)
{
    job->gather->lacks = true;
    say(w, job, false);
}

/* All records of a pass in the order of tiles; NULL: memory is out. */
static uint8_t *
put_together(const struct gpass *p)
{
    uint8_t *all = malloc(p->bytes + 1), *to = all;

    for (uint32_t i = 0; all && i < p->room; i++)
        if (p->tile[i].data) {
            size_t len = (size_t)p->tile[i].count * AMBSHARE_BYTES;

            memcpy(to, p->tile[i].data, len);
            to += len;
        }
    return all;
}

static void
give_child(struct worker *w, struct wjob *job, const uint8_t *all, uint32_t n)
{
    struct msg m = { .type = MSG_FROZEN,
                     .frozen = { .job = job->id, .pass = job->ready.passes } };

    while (ambshare_piece(&m.frozen, all, n))
        worker_send_child(w, job, &m);
}

/* The child gets a pass that is closed if all its records are here; false: they
 * are not. */
static bool
give_pass(struct worker *w, struct wjob *job, struct gpass *p)
{
    uint8_t *all;
    bool whole;

    if (p->bytes != (uint64_t)p->count * AMBSHARE_BYTES)
        return false;
    all = put_together(p);
    if (!all) {
        w->actions.failed = true;
        return false;
    }
    whole = rowsum_hash(all, p->bytes) == p->sum;
    if (!whole) {
        say_lacks(w, job);
    } else {
        if (p->asks)
            say(w, job, true);
        give_child(w, job, all, p->count);
        wjob_next_pass(job);
    }
    free(all);
    drop_pass(p);
    return whole;
}

/* Passes that are closed go to the child, in their order, up to one that is not
 * here. */
static void
look(struct worker *w, struct wjob *job)
{
    struct gather *g = job->gather;
    bool gave = true;

    while (gave && !g->lacks && job->ready.passes < g->closed) {
        struct gpass *p = pass_at(g, job->ready.passes);

        if (!p->closed) { /* it was far ahead when it was */
            say_lacks(w, job);
            return;
        }
        gave = give_pass(w, job, p);
    }
}

/* --- messages --- */

void
gather_take(struct worker *w, struct wjob *job,
            const struct msg_tile_records *m)
{
    struct gather *g = is_near(job, m->pass) ? open_gather(w, job) : NULL;

    if (!g || !keep(w, g, pass_at(g, m->pass), m))
        return;
    job->bytes_in += m->len;
    pass_on(w, job, m);
    if (m->pass == job->ready.passes) {
        g->heard_ms = w->now_ms;
        look(w, job);
    }
}

/* The first pass that may be open. */
static uint32_t
next_closed(const struct wjob *job)
{
    uint32_t closed = job->gather->closed;

    return closed > job->ready.passes ? closed : job->ready.passes;
}

void
gather_closed(struct worker *w, struct wjob *job, const struct msg_closed *m)
{
    struct gather *g = job->state == WJOB_READY ? open_gather(w, job) : NULL;
    struct gpass *p;

    if (!g || m->pass != next_closed(job))
        return; /* the coordinator will hear of the lost child */
    if (is_near(job, m->pass)) {
        p = pass_at(g, m->pass);
        p->closed = true;
        p->count = m->count;
        p->sum = m->sum;
        p->asks = m->asks;
    }
    g->closed = m->pass + 1;
    if (m->pass == job->ready.passes)
        g->heard_ms = w->now_ms;
    look(w, job);
}

void
gather_frozen(struct worker *w, struct wjob *job)
{
    struct gather *g = job->gather;

    if (!g)
        return;
    drop_pass(&g->of[(job->ready.passes - 1) % PASSES]);
    g->lacks = false;
    g->heard_ms = w->now_ms;
    look(w, job);
}

void
gather_feed(struct worker *w, struct wjob *job, const struct msg_feed *m)
{
    struct gather *g = open_gather(w, job);

    if (!g)
        return;
    g->nfed = m->n;
    for (uint32_t i = 0; i < m->n; i++)
        snprintf(g->fed[i], sizeof g->fed[i], "%s", m->name[i]);
}

void
gather_tick(struct worker *w, struct wjob *job)
{
    struct gather *g = job->gather;

    if (g && !g->lacks && job->ready.passes < g->closed &&
        w->now_ms - g->heard_ms >= QUIET_MS)
        say_lacks(w, job);
}
