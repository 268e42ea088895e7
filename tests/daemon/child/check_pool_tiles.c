/* check_pool_tiles.c - the ambient cache in passes, by the threads of a pool:
 * which tile comes when, and records that go in beside tiles at work */
#include "config.h"

#include "light/indirect/ambient.h"
#include "machine/spots.h"
#include "pool/pool_impl.h"
#include "proto/ambshare.h"

#include "pool_fixture.h"
#include "tests/plan_parts.h"

#include <stdlib.h>
#include <string.h>

/* --- which work comes next --- */

/* A pool without threads whose cache has four passes. */
static struct pool *
tiling_pool(struct rad_pass plan[8])
{
    struct pool *p = calloc(1, sizeof *p);
    struct pool_tiling *k;

    ck_assert_ptr_nonnull(p);
    world_open(&f.w, WORLD_ROOM, "-ab 1");
    rad_ambient_freeze(f.w.job->ambient);
    k = &p->tiling;
    p->job = f.w.job;
    uv_mutex_init(&p->mu);
    uv_cond_init(&p->work);
    for (uint32_t i = 0; i < 8; i++)
        plan[i] = (struct rad_pass){ .reads = i < 3 ? 0 : i - 3, .tiles = 10 };
    plan[7].ready = 1;
    k->plan = plan;
    k->npasses = 8;
    k->todo_end = &k->todo;
    k->frozen_end = &k->frozen;
    k->open = k->closed = 4;
    for (uint32_t i = 4; i < 6; i++)
        k->begun[i % MSG_OPEN_PASSES] = i + 1;
    return p;
}

static void
free_tiling_pool(struct pool *p)
{
    pool_release_tiles(p);
    uv_cond_destroy(&p->work);
    uv_mutex_destroy(&p->mu);
    free(p);
    world_close(&f.w);
}

static void
end_tile(struct pool *p, struct pool_tile *t)
{
    p->tiling.members[t->pass % MSG_OPEN_PASSES]--;
    pool_tile_free(t);
}

/* What was found for the cache is in it. */
static void
end_frozen(struct pool *p, struct pool_frozen *done)
{
    struct pool_tiling *k = &p->tiling;

    ck_assert_int_eq(k->state, POOL_CACHE_CHANGED);
    atomic_store(&k->stop[k->open++ % MSG_OPEN_PASSES], false);
    k->state = POOL_CACHE_READ;
    free(done->spot);
    free(done);
}

/* Do what there is to be done about tiles, as a thread would, but make none;
 * how many there were. */
static int
work_off_tiles(struct pool *p)
{
    struct pool_tiling *k = &p->tiling;
    struct pool_tile_work w;
    int tiles = 0;

    while (pool_find_tile_locked(p, &w)) {
        if (w.frozen) {
            end_frozen(p, w.frozen);
        } else if (w.begins) {
            uint32_t pass = (uint32_t)(w.begins - k->plan);

            k->state = POOL_CACHE_READ;
            k->begun[pass % MSG_OPEN_PASSES] = pass + 1;
        } else {
            ck_assert_uint_ge(w.tile->pass, k->closed);
            ck_assert_uint_lt(k->open - k->plan[w.tile->pass].reads,
                              RAD_AMBIENT_VIEWS);
            tiles++;
            end_tile(p, w.tile);
        }
    }
    return tiles;
}

/* The next work is a tile of that pass. */
static struct pool_tile *
find_tile(struct pool *p, uint32_t pass)
{
    struct pool_tile_work w;

    ck_assert(pool_find_tile_locked(p, &w));
    ck_assert_ptr_nonnull(w.tile);
    ck_assert_uint_eq(w.tile->pass, pass);
    return w.tile;
}

/* The next work is for the cache. */
static struct pool_frozen *
find_frozen(struct pool *p)
{
    struct pool_tile_work w;

    ck_assert(pool_find_tile_locked(p, &w));
    ck_assert_ptr_nonnull(w.frozen);
    return w.frozen;
}

static void
find_none(struct pool *p)
{
    struct pool_tile_work w;

    ck_assert(!pool_find_tile_locked(p, &w));
}

/* A tile that was given again stands behind those of the pass that follows. */
TEST(no_tile_of_a_closed_pass_is_made)
{
    struct rad_pass plan[8];
    struct pool *p = tiling_pool(plan);

    ck_assert(pool_push_tile(p, 5, 0, false));
    ck_assert(pool_push_tile(p, 4, 7, false));
    ck_assert(pool_push_tile(p, 5, 1, false));
    ck_assert(pool_push_tile(p, 4, 8, false));
    ck_assert(pool_freeze(p, NULL, 0, NULL));
    ck_assert(pool_push_tile(p, 6, 0, false));
    ck_assert_int_eq(work_off_tiles(p), 3);
    free_tiling_pool(p);
}

/* Pieces are given to one thread each, and come before tiles; beside the last
 * of them tiles begin, unless no thread may be at one. */
LOOP_TEST(threads_share_the_settling_of_a_pass, 2)
{
    struct rad_pass plan[8];
    struct pool *p = tiling_pool(plan);
    struct pool_tiling *k = &p->tiling;
    struct pool_tile_work w;

    ck_assert(pool_push_tile(p, 5, 0, false));
    k->state = POOL_CACHE_SHARED;
    k->alone = _i == 1;
    k->pieces = 3;
    for (size_t i = 0; i < 3; i++) {
        ck_assert(pool_find_tile_locked(p, &w));
        ck_assert(!w.tile && !w.begins && !w.frozen);
        ck_assert_uint_eq(w.piece, i);
    }
    ck_assert_int_eq(k->settling, 3);
    ck_assert_int_eq(work_off_tiles(p), _i == 1 ? 0 : 1);
    k->settling = 0;
    k->state = POOL_CACHE_READ;
    ck_assert_int_eq(work_off_tiles(p), _i == 1 ? 1 : 0);
    free_tiling_pool(p);
}

/* The twin of a tile that is late comes behind one that waits for records. */
TEST(a_tile_that_lacks_records_holds_up_no_other)
{
    struct rad_pass plan[8];
    struct pool *p = tiling_pool(plan);

    plan[7].reads = 5;
    ck_assert(pool_push_tile(p, 7, 0, false));
    ck_assert(pool_push_tile(p, 4, 3, false));
    ck_assert(pool_push_tile(p, 7, 1, false));
    ck_assert(pool_push_tile(p, 5, 0, false));
    ck_assert_int_eq(work_off_tiles(p), 2);
    ck_assert(pool_push_tile(p, 5, 1, false));
    ck_assert_int_eq(work_off_tiles(p), 1);
    ck_assert(pool_freeze(p, NULL, 0, NULL));
    ck_assert_int_eq(work_off_tiles(p), 2);
    free_tiling_pool(p);
}

/* A closed pass waits for its own tiles, not for those of other passes; beside
 * it tiles begin of passes that are ready. */
TEST(a_pass_goes_in_beside_tiles_of_others)
{
    struct rad_pass plan[8];
    struct pool *p = tiling_pool(plan);
    struct pool_tile *own, *other, *third;
    struct pool_frozen *closed;

    ck_assert(pool_push_tile(p, 4, 0, false));
    ck_assert(pool_push_tile(p, 5, 0, false));
    ck_assert(pool_push_tile(p, 6, 0, false));
    ck_assert(pool_push_tile(p, 5, 1, false));
    own = find_tile(p, 4);
    ck_assert(pool_freeze(p, NULL, 0, NULL));
    other = find_tile(p, 5);
    end_tile(p, own);
    closed = find_frozen(p);
    ck_assert(!closed->rest);
    third = find_tile(p, 5);
    find_none(p); /* pass 6 is not ready */
    end_frozen(p, closed);
    ck_assert_int_eq(work_off_tiles(p), 1);
    end_tile(p, other);
    end_tile(p, third);
    free_tiling_pool(p);
}

/* A unit that a thread has taken reads the cache as soon as it begins. */
TEST(a_pass_waits_for_a_unit_that_begins)
{
    struct rad_pass plan[8];
    struct pool *p = tiling_pool(plan);

    p->beginning = 1;
    ck_assert(pool_freeze(p, NULL, 0, NULL));
    find_none(p);
    p->beginning = 0;
    end_frozen(p, find_frozen(p));
    free_tiling_pool(p);
}

/* Ends of paths, and what pixels see, are changed while no thread is at a tile.
 */
LOOP_TEST(some_passes_wait_for_all_tiles, 2)
{
    struct rad_pass plan[8];
    struct pool *p = tiling_pool(plan);
    struct pool_tile *other;
    struct pool_frozen *closed;

    plan[4].ready = _i == 1; /* pictures come next */
    ck_assert(pool_push_tile(p, 5, 0, false));
    ck_assert(pool_push_tile(p, 5, 1, false));
    other = find_tile(p, 5);
    ck_assert(pool_freeze(p, NULL, 0, _i == 0 ? malloc(1) : NULL));
    end_tile(p, find_tile(p, 5));
    ck_assert(pool_push_tile(p, 5, 2, false));
    end_tile(p, other);
    closed = find_frozen(p);
    ck_assert(closed->rest);
    find_none(p);
    end_frozen(p, closed);
    ck_assert_int_eq(work_off_tiles(p), 1);
    free_tiling_pool(p);
}

/* --- threads that make tiles --- */

enum { SIDE = 48, MOST_TILES = 4000 };

#define OPTIONS                                                                \
    "-x 48 -y 48 -ar 16 -aa .25 -ad 16 -as 0 -lw 0 -lr 4 -ps 1 -ab 2"

/* What the tiles of each pass gave, as bytes, and how many are to come. */
static struct {
    struct rad_pass plan[RAD_MOST_PASSES];
    struct rad_passes *passes;
    uint32_t n, closed, left[RAD_MOST_PASSES], made;
    struct wire_out of[RAD_MOST_PASSES][64];
} cache;

static void
on_tile(void *arg, const struct pool_tile *t)
{
    struct wire_out *to = &cache.of[t->pass][t->tile];

    (void)arg;
    wire_out_init(to, MSG_MAX_TILE);
    wire_put_bytes(to, t->records.buf, t->records.len);
    cache.left[t->pass]--;
    cache.made++;
}

static void
on_rows(void *arg, const struct pool_rows *rows)
{
    (void)arg;
    ck_abort_msg("%s", rows->err.what);
}

/* A pool whose passes come in parts, with all of their tiles. */
static void
open_cache(int threads)
{
    memset(&cache, 0, sizeof cache);
    pool_open(WORLD_ROOM, OPTIONS, "-vp 0 -4.9 2.5 -vd 0 1 0 -vh 80 -vv 80",
              false, threads, on_rows);
    rad_ambient_freeze(f.w.job->ambient);
    cache.passes = rad_passes_new(&f.frame, 1, NULL);
    ck_assert_ptr_nonnull(cache.passes);
    cache.n = plan_parts(&f.w.params, SIDE, cache.plan);
    pool_set_passes(f.pool, cache.passes, cache.plan, cache.n, on_tile);
    for (uint32_t i = 0; i < cache.n; i++) {
        cache.left[i] = cache.plan[i].tiles;
        ck_assert_uint_le(cache.left[i], N_ELEM(cache.of[i]));
        for (uint32_t k = 0; k < cache.left[i]; k++)
            ck_assert(pool_push_tile(f.pool, i, k, false));
    }
}

/* Give the pool the next pass, of which all tiles are made. */
static void
close_next(void)
{
    const struct rad_pass *pass = &cache.plan[cache.closed];
    struct wire_out all;
    struct wire_in in;
    struct rad_ambrec *rec;
    struct rad_pass_spot *spot = NULL;
    size_t n;

    wire_out_init(&all, MSG_MAX_TILE * N_ELEM(cache.of[0]));
    for (uint32_t i = 0; i < pass->tiles; i++) {
        struct wire_out *tile = &cache.of[cache.closed][i];

        wire_put_bytes(&all, tile->buf, tile->len);
        wire_out_release(tile);
    }
    n = pass->walks ? 0 : all.len / AMBSHARE_BYTES;
    rec = malloc((n + 1) * sizeof *rec);
    ck_assert(rec && !all.bad);
    wire_in_init(&in, all.buf, all.len);
    for (size_t i = 0; i < n; i++)
        ck_assert(ambshare_unpack(&in, &rec[i]));
    if (pass->walks)
        spot = spots_unpack(pass, all.buf, all.len, NULL);
    ck_assert(!pass->walks || spot);
    ck_assert(pool_freeze(f.pool, rec, n, spot));
    wire_out_release(&all);
    cache.closed++;
}

/* Let the loop do what it has to, and leave the threads a processor. */
static void
turn(void)
{
    uv_run(&f.loop, UV_RUN_NOWAIT);
    if (f.pool->nthreads > 0)
        uv_sleep(1);
    while (cache.closed < cache.n && cache.left[cache.closed] == 0)
        close_next();
}

static void
close_cache(void)
{
    for (uint32_t i = 0; i < cache.n; i++)
        for (uint32_t k = 0; k < cache.plan[i].tiles; k++)
            wire_out_release(&cache.of[i][k]);
    pool_close();
    rad_passes_free(cache.passes);
    cache.passes = NULL;
}

/* Are all passes in the cache? */
static bool
is_whole(void)
{
    bool whole;

    uv_mutex_lock(&f.pool->mu);
    whole = f.pool->tiling.open == cache.n;
    uv_mutex_unlock(&f.pool->mu);
    return whole;
}

enum { MOST_RECORDS = 20000 };

/* Fill the cache; returns the number of its records. */
static size_t
fill(int threads, struct rad_ambrec rec[MOST_RECORDS])
{
    uint64_t cursor = 0;
    size_t n;

    open_cache(threads);
    while (!is_whole())
        turn();
    n = rad_ambient_list(f.w.job->ambient, &cursor, rec, MOST_RECORDS);
    close_cache();
    return n;
}

LOOP_TEST(threads_make_the_records_of_one, 2)
{
    static const int threads[] = { 2, 5 };
    static struct rad_ambrec one[MOST_RECORDS], many[MOST_RECORDS];
    size_t n = fill(1, one);

    ck_assert_uint_gt(n, 100);
    ck_assert_uint_lt(n, MOST_RECORDS);
    ck_assert_uint_eq(fill(threads[_i], many), n);
    ck_assert_mem_eq(one, many, n * sizeof *one);
}

/* Wherever the threads are when so many tiles are made. */
LOOP_TEST(a_pool_ends_in_the_middle_of_its_passes, 4)
{
    open_cache(3);
    while (cache.made < 1 + 40 * (uint32_t)_i && !is_whole())
        turn();
    close_cache();
}

/* In the middle of a settling: so many pieces are made, or all but one. */
LOOP_TEST(a_pool_ends_while_records_go_in, 3)
{
    struct renderer by = { 0 };
    const struct pool_tiling *k;
    struct pool_tile_work w;
    size_t pieces;

    open_cache(0);
    k = &f.pool->tiling;
    by.pool = f.pool;
    ck_assert_int_eq(rad_ctx_init(&by.ctx, f.w.job, NULL), 0);
    do {
        turn();
        ck_assert(pool_find_tile_locked(f.pool, &w));
        pool_work_on_tile(&by, &w);
        pieces = _i < 2 ? (size_t)_i : k->pieces - 1;
    } while (k->state != POOL_CACHE_SHARED || k->open < 6 ||
             k->piece != pieces);
    rad_ctx_release(&by.ctx);
    close_cache();
}
