/* ambpool.c - see ambpool.h
 *
 * A pool is a list of chunks.  A thread takes the next place of the last chunk
 * by adding to its counter.  If the chunk is full the thread makes a new chunk
 * and appends it by compare-and-swap; if another thread was quicker it frees
 * its own chunk and uses the other's.  */
#include "config.h"

#include "light/record/ambpool.h"

#include <stdalign.h>
#include <stdlib.h>
#include <string.h>

struct rad_ambchunk {
    _Atomic(struct rad_ambchunk *) newer;
    _Atomic uint32_t taken; /* places given out; may pass pool->chunk */
    uint64_t first;         /* [fixed] number of its first item */
    /* pool->chunk items, zero until taken */
    alignas(RAD_AMBPOOL_LINE) unsigned char item[];
};

static void *
item_at(const struct rad_ambpool *pool, struct rad_ambchunk *k, uint32_t i)
{
    return k->item + i * pool->size;
}

static struct rad_ambchunk *
new_chunk(const struct rad_ambpool *pool, uint64_t first)
{
    size_t size = sizeof(struct rad_ambchunk) + pool->chunk * pool->size;
    struct rad_ambchunk *k = aligned_alloc(RAD_AMBPOOL_LINE, size);

    if (!k)
        return NULL;
    memset(k, 0, size);
    k->first = first;
    return k;
}

bool
rad_ambpool_init(struct rad_ambpool *pool, size_t size, uint32_t chunk)
{
    pool->size = size;
    pool->chunk = chunk;
    pool->oldest = new_chunk(pool, 0);
    atomic_init(&pool->newest, pool->oldest);
    return pool->oldest != NULL;
}

void
rad_ambpool_release(struct rad_ambpool *pool)
{
    struct rad_ambchunk *k, *newer;

    for (k = pool->oldest; k; k = newer) {
        newer = atomic_load_explicit(&k->newer, memory_order_relaxed);
        free(k);
    }
}

/* The chunk behind k, made if there is none yet; NULL: out of memory. */
static struct rad_ambchunk *
chunk_after(const struct rad_ambpool *pool, struct rad_ambchunk *k)
{
    struct rad_ambchunk *newer =
        atomic_load_explicit(&k->newer, memory_order_acquire);
    struct rad_ambchunk *mine;

    if (newer)
        return newer;
    mine = new_chunk(pool, k->first + pool->chunk);
    if (!mine)
        return NULL;
    /* release: pairs with the acquires of k->newer here and in
     * rad_ambpool_item, which then see an empty chunk */
    if (atomic_compare_exchange_strong_explicit(&k->newer, &newer, mine,
                                                memory_order_acq_rel,
                                                memory_order_acquire))
        return mine;
    free(mine);
    return newer;
}

void *
rad_ambpool_take(struct rad_ambpool *pool)
{
    /* acquire: pairs with the release below */
    struct rad_ambchunk *k =
        atomic_load_explicit(&pool->newest, memory_order_acquire);

    for (;;) {
        uint32_t i = atomic_load_explicit(&k->taken, memory_order_relaxed);

        /* read before it is added to, so that the counter cannot wrap round */
        if (i < pool->chunk)
            i = atomic_fetch_add_explicit(&k->taken, 1, memory_order_relaxed);
        if (i < pool->chunk)
            return item_at(pool, k, i);
        struct rad_ambchunk *newer = chunk_after(pool, k), *old = k;

        if (!newer)
            return NULL;
        /* if this fails another thread has moved `newest` on already */
        atomic_compare_exchange_strong_explicit(&pool->newest, &old, newer,
                                                memory_order_release,
                                                memory_order_relaxed);
        k = newer;
    }
}

void *
rad_ambpool_item(const struct rad_ambpool *pool, uint64_t number,
                 struct rad_ambchunk **near)
{
    struct rad_ambchunk *k = *near;

    if (!k || k->first > number)
        k = pool->oldest;
    *near = k;
    while (k && k->first + pool->chunk <= number) {
        k = atomic_load_explicit(&k->newer, memory_order_acquire);
        *near = k ? k : *near;
    }
    return k ? item_at(pool, k, (uint32_t)(number - k->first)) : NULL;
}
