/* pool_tiles.c - the ambient cache in passes: tiles, and the records of passes
 * that are closed
 *
 * A tile reads the cache, so the cache changes only while no thread is at a
 * tile: when a pass is closed the tiles that are under way are stopped, and the
 * last thread that leaves one, or the next that looks for work, puts the
 * records of the pass in.  It waits for threads at units, too: between batches
 * of frames these are units that another worker was faster with, which the
 * coordinator takes back.  Likewise one thread alone finds out where the paths
 * of the next pass end. */
#include "config.h"

#include "child/pool_impl.h"
#include "light/indirect/ambient.h"
#include "machine/counted.h"
#include "machine/sums.h"
#include "refine/recheck.h"
#include "proto/ambshare.h"

#include <stdlib.h>

/* --- a tile --- */

/* Keep records as they are sent; those that a message has no room for are left
 * out, by everybody who makes the tile. */
static void
keep_records(void *arg, const struct rad_ambrec *rec, size_t n)
{
    struct pool_tile *t = arg;

    for (size_t i = 0; i < n && t->records.len + AMBSHARE_BYTES <= MSG_MAX_TILE;
         i++) {
        ambshare_pack(&t->records, &rec[i]);
        t->count += !t->records.bad;
    }
}

static void
hand_on_locked(struct pool *p, struct pool_tile *t)
{
    t->next = p->tiling.made;
    p->tiling.made = t;
    uv_async_send(&p->async);
}

void
pool_tile_free(struct pool_tile *t)
{
    wire_out_release(&t->records);
    free(t);
}

/* Make it; false: it was stopped, or memory is out. */
static bool
fill_tile(struct renderer *by, struct pool_tile *t)
{
    struct pool_tiling *k = &by->pool->tiling;
    struct rad_refine_sums sums;

    if (!k->plan[t->pass].check)
        return rad_passes_make(k->passes, &by->ctx, t->tile, &k->stop,
                               keep_records, t, t->shows ? &t->colours : NULL);
    if (!rad_refine_make(k->passes, &by->ctx, t->tile, &k->stop, &sums))
        return false;
    sums_pack(&t->records, &sums);
    return true;
}

static void
make_tile(struct renderer *by, struct pool_tile *t)
{
    struct pool *p = by->pool;
    struct pool_tiling *k = &p->tiling;
    struct pool_stint stint = pool_stint_begin(by);
    double cpu;
    bool whole;

    wire_out_init(&t->records, MSG_MAX_TILE);
    whole = fill_tile(by, t);
    cpu = pool_stint_end_and_lock(by, &stint);
    if (whole && !t->records.bad) {
        counted_add(&t->counts, &by->ctx.counts, cpu);
        if (t->tile == 0) { /* the pass's paths count once, wherever that is
                             * made, and again if it is made again */
            msg_counts_add(&t->counts, &k->walked);
            k->told = true;
        }
        hand_on_locked(p, t);
    } else {
        counted_add(&k->dropped, &by->ctx.counts, cpu);
        if (!atomic_load(&k->stop))
            rad_fail(&k->err, RAD_ENOMEM, "out of memory");
        pool_tile_free(t);
        uv_async_send(&p->async);
    }
    if (--k->members == 0)
        uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
}

/* --- from one pass to the next --- */

/* No other thread is at a tile while this one is here. */
static void
begin_pass(struct renderer *by)
{
    struct pool *p = by->pool;
    struct pool_tiling *k = &p->tiling;
    struct pool_stint stint = pool_stint_begin(by);
    struct rad_error err = { 0 };
    double cpu;

    rad_passes_begin(k->passes, &by->ctx, &k->plan[k->open], &err);
    cpu = pool_stint_end_and_lock(by, &stint);
    counted_add(&k->walked, &by->ctx.counts, cpu);
    k->begun = true;
    k->changing = false;
    if (err.code)
        k->err = err;
    uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
}

/* Tiles of passes that are closed are of no use. */
static void
drop_tiles_locked(struct pool_tiling *k)
{
    while (k->todo && k->todo->pass < k->open) {
        struct pool_tile *t = k->todo;

        k->todo = t->next;
        pool_tile_free(t);
    }
    if (!k->todo)
        k->todo_end = &k->todo;
}

/* Put the records of the open pass, which is closed by that, into the cache. */
static void
freeze(struct renderer *by, struct pool_frozen *f)
{
    struct pool *p = by->pool;
    struct pool_tiling *k = &p->tiling;
    struct rad_ambient *amb = p->job->ambient;
    size_t before = rad_ambient_count(amb);
    bool settled;

    rad_ambient_insert_all(amb, f->rec, f->n);
    settled = rad_ambient_settle(amb) &&
              (!rad_pass_is_last(k->plan, k->npasses, k->open) ||
               rad_ambient_smooth(amb));
    uv_mutex_lock(&p->mu);
    if (!settled || rad_ambient_count(amb) != before + f->n)
        rad_fail(&k->err, RAD_ENOMEM,
                 "out of memory, or an ambient record does not fit the scene");
    if (!k->told)
        msg_counts_add(&k->dropped, &k->walked);
    k->walked = (struct msg_counts){ 0 };
    k->told = false;
    k->open++;
    k->begun = false;
    drop_tiles_locked(k);
    atomic_store(&k->stop, k->frozen != NULL || atomic_load(&p->stopping));
    k->changing = false;
    if (k->err.code)
        uv_async_send(&p->async);
    uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
    free(f->rec);
    free(f);
}

/* --- the threads' work --- */

bool
pool_find_tile_locked(struct pool *p, struct pool_tile_work *w)
{
    struct pool_tiling *k = &p->tiling;

    *w = (struct pool_tile_work){ 0 };
    if (k->changing || k->err.code)
        return false;
    if (k->frozen && k->members == 0 && !p->active &&
        !first_is_estimating_locked(p)) {
        w->frozen = k->frozen;
        k->frozen = k->frozen->next;
        if (!k->frozen)
            k->frozen_end = &k->frozen;
        k->changing = true;
    } else if (k->frozen || !k->todo) {
        return false;
    } else if (!k->begun) {
        w->begins = true;
        k->changing = true;
    } else {
        w->tile = k->todo;
        k->todo = k->todo->next;
        if (!k->todo)
            k->todo_end = &k->todo;
        k->members++;
    }
    return true;
}

void
pool_work_on_tile(struct renderer *by, const struct pool_tile_work *w)
{
    if (w->frozen)
        freeze(by, w->frozen);
    else if (w->begins)
        begin_pass(by);
    else
        make_tile(by, w->tile);
}

/* --- calls of the loop --- */

void
pool_set_passes(struct pool *p, struct rad_passes *passes,
                const struct rad_pass *plan, uint32_t n, pool_tile_fn *fn)
{
    struct pool_tiling *k = &p->tiling;

    uv_mutex_lock(&p->mu);
    k->passes = passes;
    k->plan = plan;
    k->npasses = n;
    k->fn = fn;
    uv_mutex_unlock(&p->mu);
}

bool
pool_push_tile(struct pool *p, uint32_t pass, uint32_t tile, bool shows)
{
    struct pool_tiling *k = &p->tiling;
    struct pool_tile *t = calloc(1, sizeof *t);

    if (!t)
        return false;
    t->pass = pass;
    t->tile = tile;
    t->shows = shows;
    uv_mutex_lock(&p->mu);
    *k->todo_end = t;
    k->todo_end = &t->next;
    uv_cond_signal(&p->work);
    uv_mutex_unlock(&p->mu);
    return true;
}

bool
pool_freeze(struct pool *p, struct rad_ambrec *rec, size_t n)
{
    struct pool_tiling *k = &p->tiling;
    struct pool_frozen *f = calloc(1, sizeof *f);

    if (!f)
        return false;
    f->rec = rec;
    f->n = n;
    uv_mutex_lock(&p->mu);
    *k->frozen_end = f;
    k->frozen_end = &f->next;
    atomic_store(&k->stop, true);
    uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
    return true;
}

int
pool_give_tiles(struct pool *p, struct rad_error *err)
{
    struct pool_tiling *k = &p->tiling;
    struct pool_tile *t, *next;
    int rc;

    uv_mutex_lock(&p->mu);
    t = k->made;
    k->made = NULL;
    *err = k->err;
    rc = k->err.code;
    uv_mutex_unlock(&p->mu);
    for (; t; t = next) {
        next = t->next;
        k->fn(p->arg, t);
        pool_tile_free(t);
    }
    return rc;
}

static void
free_tiles(struct pool_tile *t)
{
    while (t) {
        struct pool_tile *next = t->next;

        pool_tile_free(t);
        t = next;
    }
}

void
pool_release_tiles(struct pool *p)
{
    struct pool_tiling *k = &p->tiling;

    free_tiles(k->todo);
    free_tiles(k->made);
    while (k->frozen) {
        struct pool_frozen *f = k->frozen;

        k->frozen = f->next;
        free(f->rec);
        free(f);
    }
}
