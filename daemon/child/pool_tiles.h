/* pool_tiles.h - what pool_tiles.c shares with the other files of the pool
 *
 * Private to pool*.c; fields are marked as in pool_impl.h. */
#ifndef DAEMON_POOL_TILES_H
#define DAEMON_POOL_TILES_H

#include "child/pool.h"

#include <stdatomic.h>

struct renderer;

/* Records of a pass that is closed; or, when all are, how pictures are made. */
struct pool_frozen {
    struct pool_frozen *next;
    struct rad_job *job; /* the pool's own, for pictures; NULL: it is a pass */
    int samples;         /* of these pictures */
    struct rad_ambrec *rec;
    size_t n;
    struct rad_pass_spot *spot; /* of a pass that walks; NULL: not told */
};

struct pool_tiling {
    struct rad_passes *passes;   /* [mu] NULL: the cache does not come so; */
    const struct rad_pass *plan; /* its tiles are made, and it changes, without
                                  * the lock: see `members' and `changing' */
    uint32_t npasses;            /* [mu] of the plan */
    pool_tile_fn *fn;            /* [loop] */
    uint32_t open;               /* [mu] passes before are in the cache, and */
    uint32_t closed;             /* [mu] those before are closed: what they
                                  * lack is in `frozen' */
    /* by a pass's number, of those that are open: */
    uint32_t begun[MSG_OPEN_PASSES]; /* [mu] beyond the pass whose tiles threads
                                      * may make */
    bool changing; /* [mu] a thread begins a pass, or closes one */
    int members;   /* [mu] threads at tiles */
    _Atomic bool stop[MSG_OPEN_PASSES]; /* tiles under way are of no use; as
                                         * stopping */
    struct pool_tile *todo, **todo_end; /* [mu] */
    struct pool_frozen *frozen, **frozen_end; /* [mu] to be closed */
    struct pool_tile *made;                   /* [mu] */
    struct msg_counts dropped;                /* [mu] in no tile's counts */
    struct rad_error err;                     /* [mu] the job cannot go on */
};

/* What a thread does about tiles: one of these. */
struct pool_tile_work {
    struct pool_frozen *frozen;
    struct pool_tile *tile;
    const struct rad_pass *begins;
};

/* Is something to be done about tiles? */
bool pool_find_tile_locked(struct pool *p, struct pool_tile_work *w);
void pool_work_on_tile(struct renderer *by, const struct pool_tile_work *w);
/* Hand on the tiles that are made; the code of *err, 0: the job can go on. */
int pool_give_tiles(struct pool *p, struct rad_error *err);
void pool_tile_free(struct pool_tile *t);
/* The threads are gone. */
void pool_release_tiles(struct pool *p);

#endif
