/* gather.c - see gather.h
 *
 * Records are kept of WJOB_PASSES passes from the first that the child lacks
 * on, for the coordinator goes on to further passes without waiting for this
 * worker.  Each tile's records are passed on to peers once: so they cannot go
 * round for ever, whatever feeds whatever. */
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

/* Records that are on the way when a pass is closed follow each other within
 * this time. */
#define QUIET_MS 100

/* Most bytes of records of a job's passes that are kept: the most that a stage
 * may have (filling/passes.c). */
#define MOST_BYTES SAVED_STAGE_BYTES

#define PASSES WJOB_PASSES

struct gtile {
    uint8_t *data;
    uint32_t count;
};

/* The records of a pass, by tile. */
struct gpass {
    uint32_t pass;      /* its number */
    uint32_t room;      /* length of tile */
    struct gtile *tile; /* of each tile that came */
    uint64_t bytes;     /* of all records */
    bool closed;        /* CLOSED came, with: */
    uint32_t count;     /* how many records there are */
    uint64_t sum;       /* hash of their bytes */
    bool asks;          /* the coordinator waits for HOLDS */
};

struct gather {
    struct gpass pass[PASSES]; /* by pass number modulo PASSES */
    uint32_t closed;   /* number of the pass after the last closed one */
    bool lacks;        /* the coordinator was told that the next pass of
                        * the child is not whole here, and sends FROZEN */
    uint64_t heard_ms; /* when something of that pass last came */
    uint32_t nfed;     /* workers that this worker feeds */
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
        drop_pass(&job->gather->pass[i]);
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

/* Is the pass one of those that are kept? */
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
        g->pass[i].closed = false;
        if (!is_near(job, g->pass[i].pass))
            drop_pass(&g->pass[i]);
    }
}

/* The place of a pass that is near; empty if it had another pass. */
static struct gpass *
pass_at(struct gather *g, uint32_t pass)
{
    struct gpass *p = &g->pass[pass % PASSES];

    if (p->pass != pass) {
        drop_pass(p);
        p->pass = pass;
    }
    return p;
}

/* --- records that come --- */

/* Make room for that many tiles; false: memory is out. */
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

/* May so many more bytes be kept, of the job's passes in all and of this one?
 */
static bool
is_within(const struct gather *g, const struct gpass *p, size_t more)
{
    uint64_t all = more;

    for (int i = 0; i < PASSES; i++)
        all += g->pass[i].bytes;
    return all <= MOST_BYTES &&
           (!p->closed ||
            p->bytes + more <= (uint64_t)p->count * AMBSHARE_BYTES);
}

/* Keep a tile's records; false: they were here, or are of no use. */
static bool
keep_tile(struct worker *w, struct gather *g, struct gpass *p,
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

/* --- closed passes --- */

static void
send_holds(struct worker *w, const struct wjob *job, bool whole)
{
    struct msg m = { .type = MSG_HOLDS,
                     .holds = { job->id, job->ready.passes, whole } };

    worker_send_coord(w, &m);
}

static void
tell_lack(struct worker *w, struct wjob *job)
{
    job->gather->lacks = true;
    send_holds(w, job, false);
}

/* All records of a pass, in the order of tiles; NULL: memory is out. */
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

/* Give the child the records of a closed pass; false: they are not all here. */
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
        tell_lack(w, job);
    } else {
        if (p->asks)
            send_holds(w, job, true);
        give_child(w, job, all, p->count);
        wjob_next_pass(job);
    }
    free(all);
    drop_pass(p);
    return whole;
}

/* Give the child closed passes, in their order, as far as they are here. */
static void
feed_child(struct worker *w, struct wjob *job)
{
    struct gather *g = job->gather;
    bool gave = true;

    while (gave && !g->lacks && job->ready.passes < g->closed) {
        struct gpass *p = pass_at(g, job->ready.passes);

        if (!p->closed) { /* when CLOSED came the pass was too far ahead */
            tell_lack(w, job);
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

    if (!g || !keep_tile(w, g, pass_at(g, m->pass), m))
        return;
    job->bytes_in += m->len;
    pass_on(w, job, m);
    if (m->pass == job->ready.passes) {
        g->heard_ms = w->now_ms;
        feed_child(w, job);
    }
}

/* The number of the first pass that may be open. */
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
        return; /* the coordinator is about to hear that the child is gone */
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
    feed_child(w, job);
}

void
gather_frozen(struct worker *w, struct wjob *job)
{
    struct gather *g = job->gather;

    if (!g)
        return;
    drop_pass(&g->pass[(job->ready.passes - 1) % PASSES]);
    g->lacks = false;
    g->heard_ms = w->now_ms;
    feed_child(w, job);
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
        tell_lack(w, job);
}
