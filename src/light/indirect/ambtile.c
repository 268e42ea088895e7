/* ambtile.c - see ambtile.h */
#include "config.h"

#include "light/indirect/ambient_impl.h"

void
rad_ambtile_begin(struct rad_ambtile *tile, struct rad_ctx *ctx, int level,
                  const struct rad_ambview *seen)
{
    *tile =
        (struct rad_ambtile){ .view = seen ? seen : ctx->job->ambient->newest,
                              .level = level,
                              .most = UINT64_MAX,
                              .end = UINT64_MAX };
    ctx->tile = tile;
}

/* Make the tile's cache with its first record: most tiles have none.  False:
 * out of memory. */
static bool
has_room(struct rad_ambtile *tile, const struct rad_ambient *amb)
{
    double org[3], side;

    if (!tile->own) {
        rad_ambient_cube(amb, org, &side);
        tile->own = rad_ambcache_new(org, side, true);
    }
    return tile->own != NULL;
}

bool
rad_ambtile_add(struct rad_ambtile *tile, const struct rad_ambient *amb,
                const struct rad_ambrec *rec, const struct rad_ambzone *zone)
{
    if (!has_room(tile, amb) ||
        !rad_ambcache_insert(tile->own, rec, zone, true)) {
        tile->failed = true;
        return false;
    }
    tile->levels |= UINT32_C(1) << (rec->level & 31);
    tile->made += rec->level == tile->level;
    return true;
}

size_t
rad_ambtile_list(const struct rad_ambtile *tile, uint64_t *cursor,
                 struct rad_ambrec *out, size_t max)
{
    return tile->own ? rad_ambcache_read(tile->own, cursor, false, out, max)
                     : 0;
}

void
rad_ambtile_end(struct rad_ambtile *tile, struct rad_ctx *ctx)
{
    ctx->tile = NULL;
    rad_ambcache_free(tile->own);
    tile->own = NULL;
}
