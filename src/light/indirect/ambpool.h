/* ambpool.h - things of one size that are taken, and never given back
 *
 * What the store of ambient records is made of: items of whole lines of memory,
 * zero until taken, that stay where they are until all are freed.
 * Thread: any number may take and read at once, and none waits for another;
 * init and release while nobody does.  */
#ifndef RAD_LIGHT_AMBPOOL_H
#define RAD_LIGHT_AMBPOOL_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define RAD_AMBPOOL_LINE 64 /* bytes that a processor fetches at once */

struct rad_ambchunk;

struct rad_ambpool {
    size_t size;                           /* [fixed] of an item, whole lines */
    uint32_t chunk;                        /* [fixed] items that come at once */
    struct rad_ambchunk *oldest;           /* [fixed] */
    _Atomic(struct rad_ambchunk *) newest; /* a hint: maybe one behind */
};

/* size: a multiple of RAD_AMBPOOL_LINE, to which items are aligned; memory
 * comes for `chunk` of them at a time.  False: out of memory; then there is
 * nothing to release, but it may be. */
bool rad_ambpool_init(struct rad_ambpool *pool, size_t size, uint32_t chunk);
void rad_ambpool_release(struct rad_ambpool *pool);

/* A zeroed item of the caller's own; NULL: out of memory. */
void *rad_ambpool_take(struct rad_ambpool *pool);

/* The item of that number, in order of their taking, if it was taken: else
 * NULL, or one that is still zero.  *near is any chunk that this has left
 * there, or NULL, and makes the next one quick. */
void *rad_ambpool_item(const struct rad_ambpool *pool, uint64_t number,
                       struct rad_ambchunk **near);

#endif
