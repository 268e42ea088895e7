/* passes_impl.h - what is known of a job's passes, for the files of this room
 *
 * A pass is open when those that its tiles read are closed: a few are.
 * passes.c says when a pass is open and closed, tiles.c which worker has which
 * tile of it, records.c which worker has whose records.
 * Thread: the coordinator's loop. */
#ifndef DAEMON_PASSES_IMPL_H
#define DAEMON_PASSES_IMPL_H

#include "desk/desk.h"
#include "filling/dearest.h"
#include "passes/passplan.h"

enum { HOLDERS = 2 };
#define NO_TILE UINT32_MAX

struct tile {
    uint32_t holder[HOLDERS]; /* workers that have it */
    uint8_t nholders;
    bool made;
    uint8_t crashes;       /* of children that had it */
    uint32_t crasher;      /* the first of their workers */
    uint64_t out_ms;       /* when it last went out */
    uint32_t place;        /* in the order in which they go out */
    uint32_t before, then; /* in the list of tiles that are out */
    uint8_t *records;      /* of a check pass: sums */
    uint32_t n;            /* of records */
};

/* The tiles of an open pass. */
struct sheet {
    struct tile *tile; /* NULL: no pass has the sheet */
    uint32_t ntiles;
    uint32_t *order;         /* tiles as they go out */
    uint32_t next;           /* in order: tiles before are out, or made */
    uint32_t oldest, newest; /* of the tiles that workers have, made by others
                              * or not: a list by when they went out */
    uint32_t left;           /* tiles that are not made */
    uint32_t waiting;        /* tiles that are not made and that nobody has */
};

/* The records of a pass that is closed. */
struct closed {
    uint8_t *records;
    uint32_t n;
    uint64_t sum;             /* of their bytes */
    struct msg_counts counts; /* of its tiles that were the first */
};

/* The records of the first pass, if they are a former job's.
 *
 *   DUE --the store has the job--> ASKED --here, or another stage--> NONE  */
enum reuse_state {
    REUSE_NONE, /* none are awaited */
    REUSE_DUE,  /* the store is to be asked for them */
    REUSE_ASKED
};

struct passes {
    struct rad_pass *plan;
    double *weight; /* of each pass, passcost.h */
    uint32_t n;
    uint32_t base;              /* passes of the stages before */
    uint32_t open;              /* the first in the plan; n: all are closed */
    uint32_t opened;            /* beyond the last that is open */
    enum reuse_state reuse;     /* by passes.c alone */
    struct closed *closed;      /* of each pass, once it is closed */
    uint32_t done;              /* frames before are done */
    size_t bytes;               /* of all records that are here */
    struct rad_pass_size *size; /* of the frames */
    struct dearest *dearest;
    struct sheet sheet[MSG_OPEN_PASSES]; /* of open passes, by number */
    double took_ms, took_ms2; /* sums, over all tiles that were made, of the
                               * time from out to made, and of its square */
};

/* The number of the first open pass, through all stages. */
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
