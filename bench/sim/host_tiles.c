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
    struct event e = { .at_us = h->cluster->events.now_us +
                                (uint64_t)(1e6 * seconds),
                       .fn = fn,
                       .host = h->number,
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

static void
send_tile(struct host *h, uint32_t tile, const struct tile_cost *cost)
{
    struct msg m = { .type = MSG_TILE_MADE };
    size_t len = (size_t)cost->records * AMBSHARE_BYTES;
    uint8_t *blank = sim_alloc(len + 1);

    m.tile_made = (struct msg_tile_made){ .job = h->cluster->job,
                                          .pass = h->passes,
                                          .tile = tile,
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
tile_done(void *arg, struct event *e)
{
    struct host *h = host_there(arg, e);
    const struct tile_cost *cost;
    uint32_t tile;

    if (!h)
        return;
    tile = h->tile[0];
    cost = &pass_of(h, h->passes)->tile[tile];
    for (uint32_t i = 1; i < h->ntiles; i++)
        h->tile[i - 1] = h->tile[i];
    h->ntiles--;
    rest(h);
    h->busy_s += cost->seconds / h->speed;
    if (!cluster_first(h->cluster, h->passes, tile))
        h->twice_s += cost->seconds / h->speed;
    send_tile(h, tile, cost);
    host_go_on(h);
}

static void
walked(void *arg, struct event *e)
{
    struct host *h = host_there(arg, e);

    if (!h)
        return;
    rest(h);
    h->walked = true;
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
    const struct tile_pass *p;

    if (h->insert_s > 0) {
        spend(h, HOST_INSERTS, h->insert_s, inserted);
        h->insert_s = 0;
        return true;
    }
    if (!host_tiles_open(h) || h->ntiles == 0)
        return false;
    p = pass_of(h, h->passes);
    if (!h->walked)
        spend(h, HOST_WALKS, p->begin_s / h->speed, walked);
    else
        spend(h, HOST_TILES, p->tile[h->tile[0]].seconds / h->speed, tile_done);
    return true;
}

/* --- messages --- */

void
host_tiles_take(struct host *h, const struct msg_tile *m)
{
    if (m->pass != h->passes || h->ntiles == HOST_MOST_TILES)
        abort();
    h->tile[h->ntiles++] = m->tile;
}

/* Tiles of a pass that is closed are of no use. */
static void
stop(struct host *h)
{
    if (h->at_tiles == HOST_TILES)
        h->twice_s += 1e-6 * (double)(h->cluster->events.now_us - h->state_us);
    if (h->at_tiles != HOST_STATES)
        rest(h);
    h->ntiles = 0;
}

void
host_tiles_freeze(struct host *h, const struct msg_frozen *m)
{
    if (m->pass != h->passes)
        abort();
    h->insert_s += 1e-6 * h->cluster->spec->insert_us * m->count / h->speed;
    if (!m->last)
        return;
    stop(h);
    host_time_note(h, h->state); /* what it waited for */
    h->passes++;
    h->walked = false;
}

void
host_tiles_forget(struct host *h)
{
    h->ntiles = 0;
    h->insert_s = 0;
    h->passes = 0;
    h->walked = false;
    h->at_tiles = HOST_STATES;
}
