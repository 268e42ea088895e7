/* ambtile.c - see ambtile.h */
#include "config.h"

#include "light/indirect/ambtile.h"

bool
rad_ambtile_begin(struct rad_ambtile *tile, struct rad_ctx *ctx, int level)
{
    double org[3], side;

    rad_ambient_cube(ctx->job->ambient, org, &side);
    tile->own = rad_ambcache_new(org, side);
    tile->level = level;
    tile->most = UINT64_MAX;
    tile->failed = false;
    tile->made = 0;
    if (!tile->own)
        return false;
    ctx->tile = tile;
    return true;
}

size_t
rad_ambtile_list(const struct rad_ambtile *tile, uint64_t *cursor,
                 struct rad_ambrec *out, size_t max)
{
    return rad_ambcache_read(tile->own, cursor, false, out, max);
}

void
rad_ambtile_end(struct rad_ambtile *tile, struct rad_ctx *ctx)
{
    ctx->tile = NULL;
    rad_ambcache_free(tile->own);
    tile->own = NULL;
}
