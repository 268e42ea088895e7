/* host_tiles.c - tiles of the ambient cache, and what comes when a pass is
 * closed, as pool_tiles.c has them
 *
 * Records are blank bytes: no coordinator looks inside. */
#include "config.h"

#include "host_impl.h"

#include "proto/ambshare.h"

#include <stdlib.h>
#include <string.h>

static const struct tile_pass *
pass_of(const struct host *h, uint32_t pass)
{
    return &h->cluster->spec->tiles->pass[pass];
}

bool
host_tiles_open(const struct host *h)
{
    const struct tiles *t = h->cluster->spec->tiles;

    return t && h->closed < t->npasses;
}

bool
host_tiles_change(const struct host *h)
{
    return h->changing || h->passes < h->closed;
}

static void
spend(struct host_thread *t, enum host_state what, double seconds,
      void (*fn)(void *arg, struct event *e))
{
    t->at_tiles = what;
    host_spend(t, seconds / t->host->speed, fn);
}

/* The thread has done, or does no more, what it was to do for tiles. */
static void
rest(struct host_thread *t)
{
    if (t->at_tiles == HOST_TILES)
        t->host->members[t->tile.pass % MSG_OPEN_PASSES]--;
    else
        t->host->changing = false;
    t->at_tiles = HOST_STATES;
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
    struct host_thread *t = host_rests(arg, e);
    struct host *h;
    double seconds;

    if (!t)
        return;
    h = t->host;
    rest(t);
    seconds = cost_of(h, &t->tile)->seconds / h->speed;
    h->busy_s += seconds;
    if (!cluster_first(h->cluster, t->tile.pass, t->tile.tile))
        h->twice_s += seconds;
    send_tile(h, &t->tile);
    host_go_on(h);
}

/* --- what one thread alone does --- */

static void
walked(void *arg, struct event *e)
{
    struct host_thread *t = host_rests(arg, e);

    if (!t)
        return;
    rest(t);
    t->host->begun[t->tile.pass % MSG_OPEN_PASSES] = t->tile.pass + 1;
    host_go_on(t->host);
}

static void
inserted(void *arg, struct event *e)
{
    struct host_thread *t = host_rests(arg, e);

    if (!t)
        return;
    rest(t);
    t->host->passes++;
    host_go_on(t->host);
}

static bool
begin_insert(struct host_thread *t)
{
    const struct cluster *c = t->host->cluster;

    t->host->changing = true;
    t->host->alone = pass_of(t->host, t->host->passes)->alone;
    spend(t, HOST_INSERTS,
          1e-6 * c->spec->insert_us * c->nrecords[t->host->passes], inserted);
    return true;
}

static bool
has_begun(const struct host *h, uint32_t pass)
{
    return h->begun[pass % MSG_OPEN_PASSES] == pass + 1;
}

/* Make a tile, or first get its pass ready. */
static bool
begin_tile(struct host_thread *t, uint32_t i)
{
    struct host *h = t->host;

    t->tile = h->tile[i];
    if (!has_begun(h, t->tile.pass)) {
        h->changing = true;
        h->alone = false;
        spend(t, HOST_WALKS, pass_of(h, t->tile.pass)->begin_s, walked);
        return true;
    }
    drop_tile(h, i);
    h->members[t->tile.pass % MSG_OPEN_PASSES]++;
    spend(t, HOST_TILES, cost_of(h, &t->tile)->seconds, tile_done);
    return true;
}

static bool
at_tiles(const struct host *h)
{
    int n = 0;

    for (int i = 0; i < MSG_OPEN_PASSES; i++)
        n += h->members[i];
    return n > 0;
}

static bool
can_begin(const struct host *h, uint32_t pass)
{
    return pass_of(h, pass)->reads <= h->passes &&
           (!h->changing || has_begun(h, pass));
}

bool
host_tiles_begin(struct host_thread *t)
{
    const struct host *h = t->host;
    bool waits = !h->changing && h->passes < h->closed;
    uint32_t i = 0;

    if (waits && !h->teams && !(pass_of(h, h->passes)->alone && at_tiles(h)))
        return begin_insert(t);
    if ((h->changing && h->alone) || (waits && !at_tiles(h)))
        return false;
    while (i < h->ntiles && !can_begin(h, h->tile[i].pass))
        i++;
    return i < h->ntiles && begin_tile(t, i);
}

/* --- messages --- */

static void
take(struct host *h, const struct msg_tile *m)
{
    if (h->ntiles == (uint32_t)h->cluster->spec->threads * HOST_MOST_TILES)
        abort();
    if (m->pass >= h->closed)
        h->tile[h->ntiles++] = (struct host_tile){ m->pass, m->tile };
}

/* Tiles of the pass, which is closed, are of no use. */
static void
stop(struct host *h, uint32_t pass)
{
    for (int i = 0; i < h->cluster->spec->threads; i++) {
        struct host_thread *t = &h->thread[i];

        if (t->at_tiles != HOST_TILES || t->tile.pass != pass)
            continue;
        h->twice_s += 1e-6 * (double)(h->cluster->now_us - t->state_us);
        host_time_note(t);
        rest(t);
        t->working = false;
        t->step++;
    }
    for (uint32_t i = h->ntiles; i-- > 0;)
        if (h->tile[i].pass == pass)
            drop_tile(h, i);
}

/* All records of the pass are here. */
static void
close_pass(struct host *h, uint32_t count)
{
    h->cluster->nrecords[h->closed] = count;
    stop(h, h->closed);
    for (int i = 0; i < h->cluster->spec->threads; i++)
        host_time_note(&h->thread[i]); /* what it waited for */
    h->closed++;
}

static void
freeze(struct host *h, const struct msg_frozen *m)
{
    if (m->pass != h->closed)
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
    for (int i = 0; i < h->cluster->spec->threads; i++)
        h->thread[i].at_tiles = HOST_STATES;
    h->ntiles = 0;
    h->closed = h->passes = 0;
    memset(h->members, 0, sizeof h->members);
    h->changing = false;
    memset(h->begun, 0, sizeof h->begun);
}
