/* msg_passes.h - the messages by which a job's ambient cache is filled in
 * passes
 *
 * src/passes/passes.h says what passes and tiles are.  Records are packed by
 * proto/ambshare.c; the coordinator does not look inside.
 * Thread: a struct belongs to one thread. */
#ifndef MSG_PASSES_H
#define MSG_PASSES_H

#include "proto/msg_work.h"

#define MSG_MOST_PASSES 2400       /* of a job, in all its stages */
#define MSG_MOST_TILES  (1u << 21) /* of a pass */

/* Passes that may be open at a time. */
#define MSG_OPEN_PASSES 4

/* Most bytes of a tile's records. */
#define MSG_MAX_TILE (MSG_MAX - 1024)

/* Most bytes of a tile's colours: 64 pixels. */
#define MSG_MAX_COLOURS 256

/* Make a tile of an open pass.  It reads only passes that are closed. */
struct msg_tile {
    const uint8_t *job;
    uint32_t pass, tile;
    uint8_t colours; /* 1: send colours, for a preview is watched */
};

/* The records of a tile, in the order of making; of more than 9000 those of the
 * lowest levels, level by level (RAD_PASS_MOST_RECORDS). */
struct msg_tile_made {
    const uint8_t *job;
    uint32_t pass, tile;
    struct msg_counts counts; /* no primary rays */
    uint32_t count;           /* records */
    const uint8_t *data;
    size_t len;
    const uint8_t *colours; /* of the lattice's pixels, row by row, in RGBE */
    size_t colours_len;     /* 0: not wanted, or none */
};

/* Some records of a closed pass; in all they are those of its tiles, in the
 * order of tiles.  When the last have come, tiles of this pass that are under
 * way are obsolete. */
struct msg_frozen {
    const uint8_t *job;
    uint32_t pass;
    uint32_t first; /* number of the first of these records in the pass */
    uint8_t last;   /* 1: the pass has no more after these */
    uint32_t count;
    const uint8_t *data;
    size_t len;
};

/* The records of a tile, while its pass is open: from the coordinator to some
 * workers, from each of these to those that it feeds, and so on.  A tile
 * without records sends none. */
struct msg_tile_records {
    const uint8_t *job;
    uint32_t pass, tile;
    uint32_t count;
    const uint8_t *data;
    size_t len;
};

/* A pass is closed.  A worker that lacks some of its records answers by HOLDS;
 * one that has all answers only if asks is 1. */
struct msg_closed {
    const uint8_t *job;
    uint32_t pass;
    uint32_t count; /* records of all its tiles */
    uint64_t sum;   /* checksum of their bytes, in the order of tiles */
    uint8_t asks;   /* 1: HOLDS is due when the worker has all records */
};

/* The answer to CLOSED. */
struct msg_holds {
    const uint8_t *job;
    uint32_t pass;
    uint8_t whole; /* 1: the worker has all records */
};

/* The workers to which TILE_RECORDS are sent on; replaces those of the FEED
 * before. */
#define MSG_MOST_FED 8
struct msg_feed {
    const uint8_t *job;
    uint32_t n;
    const char *name[MSG_MOST_FED];
};

/* The next stage begins: a job with a goal fills its cache in stages, each with
 * its own options and from an empty cache.  `pass`, the stage's first, is open
 * now.  No thread may be at a tile by then. */
struct msg_stage {
    const uint8_t *job;
    uint32_t pass;
    const char *params; /* rad_params_format() */
};

/* SHOW has the same fields: no stage follows; `pass`, the last, is closed.  The
 * pictures are made from this cache with these options, which differ from the
 * stage's in --samples at most (rad_job_show()). */

#endif
