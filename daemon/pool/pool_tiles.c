/* pool_tiles.c - the ambient cache in passes: tiles, and records of closed
 * passes
 *
 * Several passes may be open.  When the first is closed its tiles are stopped,
 * and once they are over the next thread that looks for work puts the records
 * into the cache, beside tiles of other passes, which do not see them.  They
 * are settled in pieces, by all threads that look for work.  What pixels see is
 * changed while no thread is at a tile, and threads go on with tiles until
 * there are none that they may begin.  Threads at units are waited for: between
 * two batches of frames these are units that another worker has finished, which
 * the coordinator takes back.  One thread alone gets a pass ready for its
 * tiles. */
#include "config.h"

#include "pool/pool_impl.h"
#include "light/indirect/ambient.h"
#include "machine/counted.h"
#include "machine/spots.h"
#include "machine/sums.h"
#include "refine/recheck.h"
#include "proto/ambshare.h"

#include <stdlib.h>

/* --- a tile --- */

_Static_assert(MSG_MAX_TILE / AMBSHARE_BYTES >= RAD_PASS_MOST_RECORDS,
               "a tile's records fit a message");

/* Keep records as they are on the wire. */
static void
keep_records(void *arg, const struct rad_ambrec *rec, size_t n)
{
    struct pool_tile *t = arg;

    for (size_t i = 0; i < n; i++) {
        ambshare_pack(&t->records, &rec[i]);
        t->count += !t->records.bad;
    }
}

void
pool_tile_free(struct pool_tile *t)
{
    wire_out_release(&t->records);
    free(t);
}

/* Keep the ends of the tile's paths, not records; false: stopped, or no memory
 */
static bool
keep_walk(struct renderer *by, const struct rad_pass *pass,
          const _Atomic bool *stop, struct pool_tile *t)
{
    uint32_t first, paths = rad_pass_paths(pass, t->tile, &first);
    size_t n = (size_t)paths * (size_t)pass->walks;
    struct rad_pass_spot *spot = malloc(n * sizeof *spot + 1);
    bool whole = spot && rad_passes_walk(by->pool->tiling.passes, &by->ctx,
                                         pass, t->tile, stop, spot);

    t->records.bad |= !spot;
    if (whole)
        t->count = spots_pack(&t->records, spot, n);
    free(spot);
    return whole;
}

/* Make the tile; false: it was stopped, or memory is out. */
static bool
fill_tile(struct renderer *by, struct pool_tile *t)
{
    struct pool_tiling *k = &by->pool->tiling;
    const struct rad_pass *pass = &k->plan[t->pass];
    const _Atomic bool *stop = &k->stop[t->pass % MSG_OPEN_PASSES];
    struct rad_refine_sums sums;

    if (pass->walks)
        return keep_walk(by, pass, stop, t);
    if (!pass->check)
        return rad_passes_make(
            k->passes, &by->ctx,
            &(struct rad_passes_order){
                .pass = pass,
                .seen = rad_ambient_view(by->pool->job->ambient, pass->reads),
                .tile = t->tile,
                .stop = stop,
                .fn = keep_records,
                .arg = t,
                .colours = t->tells_colours ? &t->colours : NULL });
    if (!rad_refine_make(k->passes, &by->ctx, t->tile, stop, &sums))
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
    uint32_t slot = t->pass % MSG_OPEN_PASSES;
    double cpu;
    bool whole;

    wire_out_init(&t->records, MSG_MAX_TILE);
    whole = fill_tile(by, t);
    cpu = pool_stint_end_and_lock(by, &stint);
    if (whole && !t->records.bad) {
        counted_add(&t->counts, &by->ctx.counts, cpu);
        t->next = k->made;
        k->made = t;
    } else {
        counted_add(&k->dropped, &by->ctx.counts, cpu);
        if (!atomic_load(&k->stop[slot]))
            rad_fail_memory(&k->err);
        pool_tile_free(t);
    }
    if (--k->members[slot] == 0)
        uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
    wake_send(&p->wake); /* now, for the loop takes the lock first */
}

/* --- from one pass to the next --- */

/* The cache, or what is made over it, is changed: threads may go on. */
static void
end_change_and_unlock(struct pool *p)
{
    p->tiling.state = POOL_CACHE_READ;
    uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
}

/* Get a pass ready for its tiles, by one thread while no pass changes. */
static void
begin_pass(struct renderer *by, const struct rad_pass *pass)
{
    struct pool *p = by->pool;
    struct pool_tiling *k = &p->tiling;
    struct pool_stint stint = pool_stint_begin(by);
    uint32_t number = (uint32_t)(pass - k->plan);
    struct rad_error err = { 0 };
    double cpu;

    rad_passes_begin(k->passes, &by->ctx, pass, &err);
    cpu = pool_stint_end_and_lock(by, &stint);
    counted_add(&k->dropped, &by->ctx.counts, cpu);
    k->begun[number % MSG_OPEN_PASSES] = number + 1;
    if (err.code)
        k->err = err;
    end_change_and_unlock(p);
}

/* Take tile *at off the list of those to be made. */
static void
unlink_locked(struct pool_tiling *k, struct pool_tile **at)
{
    struct pool_tile *t = *at;

    *at = t->next;
    if (!*at)
        k->todo_end = at;
}

/* Free the listed tiles of closed passes. */
static void
drop_tiles_locked(struct pool_tiling *k)
{
    struct pool_tile **at = &k->todo, *t;

    while ((t = *at))
        if (t->pass < k->closed) {
            unlink_locked(k, at);
            pool_tile_free(t);
        } else {
            at = &t->next;
        }
}

static void
free_frozen(struct pool_frozen *f)
{
    free(f->rec);
    free(f->spot);
    free(f);
}

static void
show_pictures(struct pool *p, struct pool_frozen *f)
{
    rad_job_show(f->job, f->samples);
    free_frozen(f);
    uv_mutex_lock(&p->mu);
    end_change_and_unlock(p);
}

/* The records of a pass are settled, or could not be added: end the change. */
static void
end_pass(struct pool *p, struct pool_frozen *f, bool added)
{
    struct pool_tiling *k = &p->tiling;
    struct rad_ambient *amb = p->job->ambient;

    added = added && rad_ambient_settle_end(amb) &&
            (!rad_pass_is_last(k->plan, k->npasses, k->open) ||
             rad_ambient_smooth(amb));
    free_frozen(f);
    uv_mutex_lock(&p->mu);
    if (!added)
        rad_fail(&k->err, RAD_ENOMEM,
                 "out of memory, or an ambient record does not fit the scene");
    if (!atomic_load(&p->stopping))
        atomic_store(&k->stop[k->open % MSG_OPEN_PASSES], false);
    k->open++;
    if (k->err.code)
        wake_send(&p->wake);
    end_change_and_unlock(p);
}

/* Settle a piece; the thread that makes the last one ends the pass. */
static void
settle_piece(struct pool *p, size_t piece)
{
    struct pool_tiling *k = &p->tiling;
    struct pool_frozen *f = NULL;

    rad_ambient_settle_piece(p->job->ambient, piece);
    uv_mutex_lock(&p->mu);
    if (--k->settling == 0 && k->piece == k->pieces) {
        f = k->settled;
        k->settled = NULL;
        k->state = POOL_CACHE_CHANGED;
    }
    uv_mutex_unlock(&p->mu);
    if (f)
        end_pass(p, f, true);
}

/* Put a closed pass into the cache. */
static void
close_pass(struct pool *p, struct pool_frozen *f)
{
    struct pool_tiling *k = &p->tiling;
    struct rad_ambient *amb = p->job->ambient;
    size_t all = rad_ambient_count(amb) + f->n, pieces = 0;
    bool added =
        !f->spot || rad_passes_place(k->passes, &k->plan[k->open], f->spot);

    if (added) {
        rad_ambient_insert_all(amb, f->rec, f->n);
        added = rad_ambient_count(amb) == all;
        pieces = added ? rad_ambient_settle_begin(amb, f->rest) : 0;
    }
    if (pieces == 0) {
        end_pass(p, f, added);
        return;
    }
    uv_mutex_lock(&p->mu);
    k->settled = f;
    k->piece = 0;
    k->pieces = pieces;
    k->state = POOL_CACHE_SHARED;
    uv_cond_broadcast(&p->work);
    uv_mutex_unlock(&p->mu);
}

/* --- the threads' work --- */

/* The next piece; false: all are made, or being made. */
static bool
find_piece_locked(struct pool_tiling *k, struct pool_tile_work *w)
{
    if (k->piece == k->pieces)
        return false;
    w->piece = k->piece++;
    k->settling++;
    return true;
}

/* Are threads at tiles? */
static bool
at_tiles_locked(const struct pool_tiling *k)
{
    int n = 0;

    for (int i = 0; i < MSG_OPEN_PASSES; i++)
        n += k->members[i];
    return n > 0;
}

static bool
has_begun_locked(const struct pool_tiling *k, uint32_t pass)
{
    return k->begun[pass % MSG_OPEN_PASSES] == pass + 1;
}

/* Has the cache all that the tile reads, and is the pass ready for it, or can
 * be got ready now? */
static bool
can_begin_locked(const struct pool_tiling *k, const struct pool_tile *t)
{
    return k->plan[t->pass].reads <= k->open &&
           (k->state == POOL_CACHE_READ || has_begun_locked(k, t->pass));
}

/* The first listed tile that can begin; none if a pass waits for the cache
 * while no thread is at a tile, for the pass comes first. */
static bool
find_todo_locked(struct pool_tiling *k, struct pool_tile_work *w)
{
    struct pool_tile **at = &k->todo, *t;

    while ((t = *at) && !can_begin_locked(k, t))
        at = &t->next;
    if (!t || (k->state == POOL_CACHE_READ && k->frozen && !at_tiles_locked(k)))
        return false;
    if (!has_begun_locked(k, t->pass)) {
        w->begins = &k->plan[t->pass];
        k->state = POOL_CACHE_CHANGED;
        k->alone = false;
        return true;
    }
    w->tile = t;
    unlink_locked(k, at);
    k->members[t->pass % MSG_OPEN_PASSES]++;
    return true;
}

/* Must threads be at no tile while that is done?  Yes, if pixels see something
 * else then, or tiles would miss what is replaced. */
static bool
needs_rest_locked(const struct pool *p, const struct pool_frozen *f)
{
    const struct pool_tiling *k = &p->tiling;

    return f->job || f->spot || rad_ambient_is_smooth(p->job->ambient) ||
           rad_pass_is_last(k->plan, k->npasses, k->open);
}

/* The first pass that waits for the cache, or a change of options, if that can
 * be done now; and note with what else it can be. */
static bool
find_frozen_locked(struct pool *p, struct pool_tile_work *w)
{
    struct pool_tiling *k = &p->tiling;
    struct pool_frozen *f = k->frozen;

    if (!f || p->active || p->beginning > 0 || pool_is_estimating_locked(p))
        return false;
    f->rest = !at_tiles_locked(k);
    k->alone = needs_rest_locked(p, f);
    if (k->alone ? !f->rest : k->members[k->open % MSG_OPEN_PASSES] > 0)
        return false;
    w->frozen = f;
    k->frozen = f->next;
    f->next = NULL;
    if (!k->frozen)
        k->frozen_end = &k->frozen;
    k->state = POOL_CACHE_CHANGED;
    return true;
}

bool
pool_find_tile_locked(struct pool *p, struct pool_tile_work *w)
{
    struct pool_tiling *k = &p->tiling;

    *w = (struct pool_tile_work){ 0 };
    if (k->err.code)
        return false;
    if ((k->state == POOL_CACHE_SHARED && find_piece_locked(k, w)) ||
        (k->state == POOL_CACHE_READ && find_frozen_locked(p, w)))
        return true;
    return (k->state == POOL_CACHE_READ || !k->alone) && find_todo_locked(k, w);
}

void
pool_work_on_tile(struct renderer *by, const struct pool_tile_work *w)
{
    if (w->frozen && w->frozen->job)
        show_pictures(by->pool, w->frozen);
    else if (w->frozen)
        close_pass(by->pool, w->frozen);
    else if (w->begins)
        begin_pass(by, w->begins);
    else if (w->tile)
        make_tile(by, w->tile);
    else
        settle_piece(by->pool, w->piece);
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
pool_push_tile(struct pool *p, uint32_t pass, uint32_t tile, bool tells_colours)
{
    struct pool_tiling *k = &p->tiling;
    struct pool_tile *t = calloc(1, sizeof *t);

    if (!t)
        return false;
    t->pass = pass;
    t->tile = tile;
    t->tells_colours = tells_colours;
    uv_mutex_lock(&p->mu);
    *k->todo_end = t;
    k->todo_end = &t->next;
    uv_cond_signal(&p->work);
    uv_mutex_unlock(&p->mu);
    return true;
}

/* List a copy of *as, a pass for the cache or a change of options: a thread
 * does it when it can be done.  False: out of memory, and nothing is locked.
 */
static bool
push_frozen_and_lock(struct pool *p, const struct pool_frozen *as)
{
    struct pool_frozen *f = malloc(sizeof *f);

    if (!f)
        return false;
    *f = *as;
    uv_mutex_lock(&p->mu);
    *p->tiling.frozen_end = f;
    p->tiling.frozen_end = &f->next;
    uv_cond_broadcast(&p->work);
    return true;
}

bool
pool_freeze(struct pool *p, struct rad_ambrec *rec, size_t n,
            struct rad_pass_spot *spot)
{
    struct pool_frozen f = { .rec = rec, .n = n, .spot = spot };
    struct pool_tiling *k = &p->tiling;

    if (!push_frozen_and_lock(p, &f))
        return false;
    atomic_store(&k->stop[k->closed % MSG_OPEN_PASSES], true);
    k->closed++;
    drop_tiles_locked(k);
    uv_mutex_unlock(&p->mu);
    return true;
}

bool
pool_show(struct pool *p, struct rad_job *job, int samples)
{
    struct pool_frozen f = { .job = job, .samples = samples };
    bool ok = push_frozen_and_lock(p, &f);

    if (ok)
        uv_mutex_unlock(&p->mu);
    return ok;
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

void
pool_release_tiles(struct pool *p)
{
    struct pool_tiling *k = &p->tiling;
    struct pool_tile *t;
    struct pool_frozen *f;

    *k->todo_end = k->made;
    while ((t = k->todo)) {
        k->todo = t->next;
        pool_tile_free(t);
    }
    *k->frozen_end = k->settled;
    while ((f = k->frozen)) {
        k->frozen = f->next;
        free_frozen(f);
    }
}
