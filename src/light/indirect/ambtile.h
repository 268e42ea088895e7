/* ambtile.h - the ambient records of one tile of a pass
 *
 * What a tile of a pass (passes/passes.h) lacks of the frozen cache is made for
 * it alone: it sees that cache and its own records, nothing else, so they are a
 * function of the job, whoever makes it and how often.
 * Growth: as the tile's records; all is free again when the next tile begins.
 * Thread: one context's. */
#ifndef RAD_LIGHT_AMBTILE_H
#define RAD_LIGHT_AMBTILE_H

#include "light/indirect/ambcache.h"

struct rad_ambtile {
    const struct rad_ambview *view; /* what it reads of the frozen cache */
    struct rad_ambcache *own;       /* NULL: it has no records yet */
    uint32_t levels;                /* of these, as rad_ambtile_has() */
    bool failed;                    /* memory was out: records are missing */
    uint32_t made;                  /* records of that level so far */
    int level;     /* of the records that the pass is for; others serve a little
                    * farther than -aa */
    uint64_t most; /* rays of hemispheres, as the context counts them, from
                    * which on deeper records are coarse, and */
    uint64_t end;  /* from which on no record is made: what is under way then
                    * is given up */
};

/* Begin a tile, and have ctx make its records.  It sees the frozen cache as it
 * was before the last `behind` times that it was settled, and has no bounds of
 * rays yet.  *tile must live until rad_ambtile_end(). */
void rad_ambtile_begin(struct rad_ambtile *tile, struct rad_ctx *ctx, int level,
                       uint32_t behind);

/* Add a record, in the cache's cube.  False: memory is out. */
bool rad_ambtile_add(struct rad_ambtile *tile, const struct rad_ambient *amb,
                     const struct rad_ambrec *rec,
                     const struct rad_ambzone *zone);

/* Has the tile records of that level?  (Of some beyond 31 it may seem so.) */
static inline bool
rad_ambtile_has(const struct rad_ambtile *tile, int level)
{
    return tile->levels >> (level & 31) & 1;
}

/* The records that were made since, in their order, from *cursor on, 0 at
 * first; 0 at the end. */
size_t rad_ambtile_list(const struct rad_ambtile *tile, uint64_t *cursor,
                        struct rad_ambrec *out, size_t max);

/* The tile is over, and its records are gone. */
void rad_ambtile_end(struct rad_ambtile *tile, struct rad_ctx *ctx);

#endif
