/* ambpool.h - pools of items of one size, which are never given back
 *
 * The memory of the store of ambient records.  Items are whole lines of memory,
 * are zero until taken, and stay where they are until the pool is released.
 * Thread: any number may take and read items at once, and none waits for
 * another; init and release while no other thread uses the pool.  */
#ifndef RAD_LIGHT_AMBPOOL_H
#define RAD_LIGHT_AMBPOOL_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RAD_AMBPOOL_LINE 64 /* bytes that a processor fetches at once */

struct rad_ambchunk;

struct rad_ambpool {
    size_t size;                           /* [fixed] of an item [bytes] */
    uint32_t chunk;                        /* [fixed] items of a chunk */
    struct rad_ambchunk *oldest;           /* [fixed] */
    _Atomic(struct rad_ambchunk *) newest; /* a hint: the last chunk, or the
                                            * last but one */
};

/* Make a pool whose items have `size` bytes, a multiple of RAD_AMBPOOL_LINE, to
 * which they are aligned; memory is allocated for `chunk` items at a time.
 * False: out of memory; the pool may then be released, but need not. */
bool rad_ambpool_init(struct rad_ambpool *pool, size_t size, uint32_t chunk);
void rad_ambpool_release(struct rad_ambpool *pool);

/* Take an item, which is zero and the caller's alone; NULL: out of memory. */
void *rad_ambpool_take(struct rad_ambpool *pool);

/* The item with this number, counted in the order of taking.  If it was not
 * taken yet: NULL, or an item that is zero.
 *   near  *near is NULL, or a chunk that an earlier call has put there; it is
 *         set so that the next call for a number not far off is quick */
void *rad_ambpool_item(const struct rad_ambpool *pool, uint64_t number,
                       struct rad_ambchunk **near);

#endif
