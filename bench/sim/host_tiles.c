/* host_tiles.c - tiles of the ambient cache, and what comes when a pass is
 * closed, as pool_tiles.c has them
 *
 * Records are blank bytes: no coordinator looks inside. */
#include "config.h"

#include "host_impl.h"

#include "proto/ambshare.h"

#include <stdlib.h>

static const struct tile_pass *
pass_of(const struct host *h, uint32_t pass)
{
    return &h->cluster->spec->tiles->pass[pass];
}

bool
host_tiles_open(const struct host *h)
{
    const struct tiles *t = h->cluster->spec->tiles;

    return t && h->passes < t->npasses;
}

/* It works on the cache for so long, if no pass is closed meanwhile. */
static void
spend(struct host *h, enum host_state what, double seconds,
      void (*fn)(void *arg, struct event *e))
{
    struct event e = { .at = h->cluster->now_us + (uint64_t)(1e6 * seconds),
                       .fn = fn,
                       .node = h->number,
                       .n = h->life,
                       .len = ++h->tile_step };

    h->at_tiles = what;
    h->working = true;
    events_add(&h->cluster->events, &e);
}

/* The host that does what it was to do; NULL: it was stopped. */
static struct host *
host_there(void *arg, const struct event *e)
{
    struct host *h = host_alive(arg, e);

    return h && h->at_tiles != HOST_STATES && h->tile_step == e->len ? h : NULL;
}

static void
rest(struct host *h)
{
    host_time_note(h, h->at_tiles);
    h->at_tiles = HOST_STATES;
    h->working = false;
}

/* --- a tile --- */

static const struct tile_cost *
cost_of(const struct host *h, const struct host_tile *t)
{
    return &pass_of(h, t->pass)->tile[t->tile];
}

static void
send_tile(struct host *h, const struct host_tile *t)
{
    const struct tile_cost *cost = cost_of(h, t);
    struct msg m = { .type = MSG_TILE_MADE };
    size_t len = (size_t)cost->records * AMBSHARE_BYTES;
    uint8_t *blank = sim_alloc(len + 1);

    m.tile_made = (struct msg_tile_made){ .job = h->cluster->job,
                                          .pass = t->pass,
                                          .tile = t->tile,
                                          .count = cost->records,
                                          .data = blank,
                                          .len = len };
    m.tile_made.counts =
        host_counts(h, cost->seconds / h->speed, cost->seconds / h->speed, 0);
    m.tile_made.counts.rays = cost->rays;
    host_say(h, &m);
    free(blank);
}

static void
drop_tile(struct host *h, uint32_t i)
{
    for (h->ntiles--; i < h->ntiles; i++)
        h->tile[i] = h->tile[i + 1];
}

static void
tile_done(void *arg, struct event *e)
{
    struct host *h = host_there(arg, e);
    struct host_tile t;

    if (!h)
        return;
    t = h->tile[0];
    drop_tile(h, 0);
    rest(h);
    h->busy_s += cost_of(h, &t)->seconds / h->speed;
    if (!cluster_first(h->cluster, t.pass, t.tile))
        h->twice_s += cost_of(h, &t)->seconds / h->speed;
    send_tile(h, &t);
    host_go_on(h);
}

static void
walked(void *arg, struct event *e)
{
    struct host *h = host_there(arg, e);

    if (!h)
        return;
    rest(h);
    h->begun = h->tile[0].pass + 1;
    host_go_on(h);
}

static void
inserted(void *arg, struct event *e)
{
    struct host *h = host_there(arg, e);

    if (!h)
        return;
    rest(h);
    host_go_on(h);
}

bool
host_tiles_begin(struct host *h)
{
    if (h->insert_s > 0) {
        spend(h, HOST_INSERTS, h->insert_s, inserted);
        h->insert_s = 0;
        return true;
    }
    if (!host_tiles_open(h) || h->ntiles == 0 ||
        pass_of(h, h->tile[0].pass)->reads > h->passes)
        return false;
    if (h->begun <= h->tile[0].pass)
        spend(h, HOST_WALKS, pass_of(h, h->tile[0].pass)->begin_s / h->speed,
              walked);
    else
        spend(h, HOST_TILES, cost_of(h, &h->tile[0])->seconds / h->speed,
              tile_done);
    return true;
}

/* --- messages --- */

static void
take(struct host *h, const struct msg_tile *m)
{
    if (h->ntiles == HOST_MOST_TILES)
        abort();
    if (m->pass >= h->passes)
        h->tile[h->ntiles++] = (struct host_tile){ m->pass, m->tile };
}

/* Tiles of the pass, which is closed, are of no use. */
static void
stop(struct host *h, uint32_t pass)
{
    bool at_it = h->ntiles > 0 && h->tile[0].pass == pass;

    if (at_it && h->at_tiles == HOST_TILES)
        h->twice_s += 1e-6 * (double)(h->cluster->now_us - h->state_us);
    if (at_it && (h->at_tiles == HOST_TILES || h->at_tiles == HOST_WALKS))
        rest(h);
    for (uint32_t i = h->ntiles; i-- > 0;)
        if (h->tile[i].pass == pass)
            drop_tile(h, i);
}

/* All records of the pass are here. */
static void
close_pass(struct host *h, uint32_t count)
{
    h->insert_s += 1e-6 * h->cluster->spec->insert_us * count / h->speed;
    stop(h, h->passes);
    if (h->at_tiles == HOST_STATES)
        host_time_note(h, h->state); /* what it waited for */
    h->passes++;
}

static void
freeze(struct host *h, const struct msg_frozen *m)
{
    if (m->pass != h->passes)
        abort();
    if (m->last)
        close_pass(h, m->first + m->count);
}

bool
host_tiles_message(struct host *h, const struct msg *m)
{
    switch (m->type) {
    case MSG_TILE:
        take(h, &m->tile);
        return true;
    case MSG_FROZEN:
        freeze(h, &m->frozen);
        return true;
    default:
        return false;
    }
}

void
host_tiles_forget(struct host *h)
{
    h->ntiles = 0;
    h->insert_s = 0;
    h->passes = 0;
    h->begun = 0;
    h->at_tiles = HOST_STATES;
}
