/* passes_impl.h - a job's passes and tiles, for the files of this room
 *
 * A pass is open when all passes that its tiles read are closed, so several may
 * be open.  passes.c opens and closes passes, tiles.c says which worker has
 * which tile, records.c which worker has the records of which passes.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_PASSES_IMPL_H
#define DAEMON_PASSES_IMPL_H

#include "desk/desk.h"
#include "passes/passplan.h"

enum { HOLDERS = 2 }; /* workers that may have a tile at the same time */
#define NO_TILE UINT32_MAX

struct tile {
    uint32_t holder[HOLDERS]; /* indices of the workers that have the tile */
    uint8_t nholders;
    bool made;
    struct unit_crashes crashes;
    uint64_t out_ms;       /* when the tile last went out */
    uint32_t before, then; /* previous and next tile in the list of tiles that
                            * workers have, by when they went out */
    uint8_t *records;      /* in a check pass sums instead (machine/sums.h) */
    uint32_t n;            /* number of records */
};

/* The tiles of an open pass. */
struct sheet {
    struct tile *tile; /* NULL: the sheet is free */
    uint32_t ntiles;
    uint32_t next;           /* each tile before this one is made or out at a
                              * worker */
    uint32_t oldest, newest; /* ends of the list of tiles that workers have,
                              * including tiles that another worker made */
    uint32_t left;           /* tiles that are not made */
    uint32_t waiting;        /* tiles that are not made and no worker has */
};

/* The records of a closed pass. */
struct closed {
    uint8_t *records;
    uint32_t n;               /* number of records */
    uint64_t sum;             /* hash of their bytes */
    struct msg_counts counts; /* of its tiles, each counted once */
};

/* The first pass of a job that begins with another job's records:
 *
 *   DUE --the store has the job--> ASKED --here, or another stage--> NONE  */
enum reuse_state {
    REUSE_NONE, /* there are no such records, or they are here */
    REUSE_DUE,  /* the store has yet to be asked for the records */
    REUSE_ASKED /* the store has been asked */
};

struct passes {
    struct rad_pass *plan;  /* passes of the present stage */
    double *weight;         /* share of each pass in all work, passcost.h */
    uint32_t n;             /* length of plan, weight and closed */
    uint32_t base;          /* number of the stage's first pass, counted through
                             * all stages */
    uint32_t open;          /* index in plan of the first open pass; n: all are
                             * closed */
    uint32_t opened;        /* index after the last open pass */
    enum reuse_state reuse; /* changed by passes.c alone */
    struct closed *closed;  /* of each pass, once it is closed */
    uint32_t done;          /* frames from the first on whose rows are all
                             * here; counted while passes are open */
    size_t bytes;           /* of the stage's records so far */
    struct rad_pass_size *size;          /* of the frames */
    struct sheet sheet[MSG_OPEN_PASSES]; /* of open passes, see passes_sheet */
    double took_ms, took_ms2; /* sums over all tiles that were made: of the time
                               * from when a tile went out until it was made,
                               * and of the square of that time */
};

/* The number of the first open pass, counted through all stages. */
static inline uint32_t
passes_number(const struct passes *s)
{
    return s->base + s->open;
}

static inline struct sheet *
passes_sheet(struct passes *s, uint32_t pass)
{
    return &s->sheet[pass % MSG_OPEN_PASSES];
}

#endif
