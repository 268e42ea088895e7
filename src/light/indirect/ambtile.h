/* ambtile.h - the ambient records of one tile of a pass
 *
 * Records that a tile of a pass (passes/passes.h) needs and the frozen cache
 * lacks are made for the tile alone.  The tile sees the frozen cache and its
 * own records, nothing else: so its records are a function of the job,
 * whichever worker makes the tile and however often.
 * Growth: with the tile's records, which are freed when the tile ends.
 * Thread: that of the tile's context. */
#ifndef RAD_LIGHT_AMBTILE_H
#define RAD_LIGHT_AMBTILE_H

#include "light/indirect/ambient.h"
#include "light/record/ambcache.h"

struct rad_ambtile {
    const struct rad_ambview *view; /* state of the frozen cache that the tile
                                     * sees */
    struct rad_ambcache *own;       /* the tile's records; NULL: none yet */
    uint32_t levels;                /* levels of the tile's records, as bits */
    bool failed;                    /* memory was out: records are missing */
    uint32_t made;                  /* count of the tile's records of `level` */
    int level;     /* of the records that the pass is for; records of other
                    * levels serve a little farther than -aa */
    uint64_t most; /* when the context has counted so many ambient_rays, deeper
                    * records are made with fewer rays */
    uint64_t end;  /* when the context has counted so many, no record is made: a
                    * hemisphere under way is given up */
};

/* Begin a tile whose records ctx makes.  seen: the view of the frozen cache
 * that it sees (rad_ambient_view()); NULL: the newest.  most and end are
 * unlimited; the caller may set them.  *tile must live until rad_ambtile_end().
 */
void rad_ambtile_begin(struct rad_ambtile *tile, struct rad_ctx *ctx, int level,
                       const struct rad_ambview *seen);

/* Add a record.  False: memory is out. */
bool rad_ambtile_add(struct rad_ambtile *tile, const struct rad_ambient *amb,
                     const struct rad_ambrec *rec,
                     const struct rad_ambzone *zone);

/* May the tile have records of that level?  (Levels 32 apart share a bit.) */
static inline bool
rad_ambtile_has(const struct rad_ambtile *tile, int level)
{
    return tile->levels >> (level & 31) & 1;
}

/* Copy at most max of the tile's records, in the order of making, from *cursor
 * on (0: the first), and move the cursor; returns their number, 0 at the end.
 */
size_t rad_ambtile_list(const struct rad_ambtile *tile, uint64_t *cursor,
                        struct rad_ambrec *out, size_t max);

/* End the tile and free its records. */
void rad_ambtile_end(struct rad_ambtile *tile, struct rad_ctx *ctx);

#endif
