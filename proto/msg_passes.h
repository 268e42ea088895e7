/* msg_passes.h - the messages by which a job's ambient cache is filled in
 * passes
 *
 * What passes and tiles are says src/passes/passes.h.  Records are packed by
 * proto/ambshare.c; the coordinator never looks inside.
 * Thread: a struct belongs to one thread. */
#ifndef MSG_PASSES_H
#define MSG_PASSES_H

#include "proto/msg_work.h"

#define MSG_MOST_PASSES 2400       /* of a job, in all its stages */
#define MSG_MOST_TILES  (1u << 21) /* of a pass */

/* Passes that may be open at a time. */
#define MSG_OPEN_PASSES 4

/* Most record bytes of a tile; what a tile makes beyond them is not kept. */
#define MSG_MAX_TILE (MSG_MAX - 1024)

/* Most bytes of a tile's colours: 64 pixels. */
#define MSG_MAX_COLOURS 256

/* Make a tile of a pass that is open: no other passes than are closed does it
 * read. */
struct msg_tile {
    const uint8_t *job;
    uint32_t pass, tile;
    uint8_t colours; /* 1: somebody watches, so tell its colours */
};

/* The records of a tile, in the order in which they were made. */
struct msg_tile_made {
    const uint8_t *job;
    uint32_t pass, tile;
    struct msg_counts counts; /* no primary rays */
    uint32_t count;           /* records */
    const uint8_t *data;
    size_t len;
    const uint8_t *colours; /* of the pixels of its lattice, row by row, four
                             * bytes each as in a picture */
    size_t colours_len;     /* 0: they are not wanted, or there are none */
};

/* Some records of a pass that is closed: those of all its tiles, in the order
 * of tiles.  Once the last have come tiles of the pass that still are under way
 * are of no use any more. */
struct msg_frozen {
    const uint8_t *job;
    uint32_t pass;
    uint32_t first; /* the number, in the pass, of the first of these */
    uint8_t last;   /* 1: the pass has no more */
    uint32_t count;
    const uint8_t *data;
    size_t len;
};

/* The records of a tile, while its pass is open: from the coordinator to some
 * workers, from each of these to those that it feeds, and so on.  None are sent
 * of a tile without records. */
struct msg_tile_records {
    const uint8_t *job;
    uint32_t pass, tile;
    uint32_t count;
    const uint8_t *data;
    size_t len;
};

/* A pass is closed.  A worker that lacks some of its records says so; one that
 * has all says so where it is asked. */
struct msg_closed {
    const uint8_t *job;
    uint32_t pass;
    uint32_t count; /* of records of all tiles */
    uint64_t sum;   /* of their bytes in the order of tiles */
    uint8_t asks;   /* 1: it is to say when it has them all */
};

/* The answer to CLOSED. */
struct msg_holds {
    const uint8_t *job;
    uint32_t pass;
    uint8_t whole; /* 1: it has all records */
};

/* Workers to whom TILE_RECORDS are to be sent on; instead of those before. */
#define MSG_MOST_FED 8
struct msg_feed {
    const uint8_t *job;
    uint32_t n;
    const char *name[MSG_MOST_FED];
};

/* A job whose picture is to be of some accuracy, or there by some time, fills
 * its cache in stages, each with its own options and from an empty cache.  The
 * next begins: its first pass, which has that number, is open.  No thread may
 * be at a tile by then. */
struct msg_stage {
    const uint8_t *job;
    uint32_t pass;
    const char *params; /* rad_params_format() */
};

/* SHOW has the same fields: no stage follows, the pass of that number, the last,
 * is closed, and the pictures are made over the cache that is there with these
 * options, which differ from the stage's in --samples at most (rad_job_show()).
 */

#endif
