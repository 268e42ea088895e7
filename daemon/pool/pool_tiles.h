/* pool_tiles.h - what pool_tiles.c shares with the other files of the pool
 *
 * Private to pool*.c; fields are marked as in pool_impl.h. */
#ifndef DAEMON_POOL_TILES_H
#define DAEMON_POOL_TILES_H

#include "pool/pool.h"

#include <stdatomic.h>

struct renderer;

/* The records of a closed pass; or how pictures are made, once all are closed
 */
struct pool_frozen {
    struct pool_frozen *next;
    struct rad_job *job; /* the pool's own, for pictures; NULL: it is a pass */
    int samples;         /* of these pictures */
    struct rad_ambrec *rec;
    size_t n;
    struct rad_pass_spot *spot; /* ends of a pass of paths; NULL: not known */
    bool rest; /* no thread was at a tile when a thread began to do this */
};

/* Tiles are made, and the cache changes, outside of the lock.
 *
 *   READ --> CHANGED --> READ     a pass is begun, or pictures are shown
 *   READ --> CHANGED --> SHARED --> CHANGED --> READ     a pass is closed: its
 *            records are added, settled in pieces, and taken as settled
 *
 * Meanwhile tiles begin and go on, unless `alone': they do not see what comes.
 * But before a pass goes in, its own tiles and those of passes before it are
 * over: so views of the cache, and trees, are there as long as a tile reads
 * them (rad_ambient_settle_begin()). */
enum pool_cache {
    POOL_CACHE_READ,    /* threads may be at units, too */
    POOL_CACHE_CHANGED, /* by one thread */
    POOL_CACHE_SHARED   /* settled by all threads, a piece each at a time */
};

struct pool_tiling {
    struct rad_passes *passes;   /* [mu] NULL: the cache has no passes */
    const struct rad_pass *plan; /* [mu] */
    uint32_t npasses;            /* [mu] length of plan */
    pool_tile_fn *fn;            /* [loop] */
    uint32_t open;               /* [mu] passes that are in the cache */
    uint32_t closed;             /* [mu] in the cache, or still in `frozen' */
    uint32_t begun[MSG_OPEN_PASSES]; /* [mu] by pass number modulo: 1 + number
                                      * of the pass that was begun last */
    int members[MSG_OPEN_PASSES];    /* [mu] threads at tiles, by pass number
                                      * modulo */
    enum pool_cache state;           /* [mu] */
    bool alone; /* [mu] unless READ: no thread is at a tile, and none begins */
    struct pool_frozen *settled; /* [mu] while SHARED: the pass; */
    size_t piece, pieces;        /* the next of its pieces, and their number; */
    int settling;                /* threads at pieces */
    _Atomic bool stop[MSG_OPEN_PASSES]; /* end tiles of that pass; written with
                                         * mu held, read anywhere */
    struct pool_tile *todo, **todo_end; /* [mu] */
    struct pool_frozen *frozen, **frozen_end; /* [mu] passes for the cache */
    struct pool_tile *made;                   /* [mu] tiles for the loop */
    struct msg_counts dropped;                /* [mu] in no tile's counts */
    struct rad_error err;                     /* [mu] the job cannot go on */
};

/* A thread's work: one of the pointers is set, or none for a piece. */
struct pool_tile_work {
    struct pool_frozen *frozen;    /* close this pass, or show */
    struct pool_tile *tile;        /* make this tile */
    const struct rad_pass *begins; /* get this pass ready for its tiles */
    size_t piece;                  /* settle this piece */
};

/* Find work on the passes; false: there is none now. */
bool pool_find_tile_locked(struct pool *p, struct pool_tile_work *w);
void pool_work_on_tile(struct renderer *by, const struct pool_tile_work *w);
/* Hand the tiles that are made to pool_tiling.fn.  Returns, and sets *err to,
 * why the job cannot go on; 0: it can. */
int pool_give_tiles(struct pool *p, struct rad_error *err);
void pool_tile_free(struct pool_tile *t);
/* Free all; the threads are gone. */
void pool_release_tiles(struct pool *p);

#endif
