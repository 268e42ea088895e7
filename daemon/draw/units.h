/* units.h - a job's statistics, and its units as spans of time by worker
 *
 * The statistics are the coordinator's JSON (radd.stats(5)): of many units it
 * is long, so units are read one by one and the rest is kept as values.
 * Pure; thread: any, a struct belongs to one. */
#ifndef RADD_DRAW_UNITS_H
#define RADD_DRAW_UNITS_H

#include "base/error.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

#define UNITS_HEAD                                                             \
    (1 << 20) /* bytes ahead of the units; of 1000 workers half */
#define UNITS_WORKERS                                                          \
    200                  /* that are told apart; units of others are left out */
#define UNITS_LANES 16   /* of a worker: units side by side */
#define UNITS_SPANS 3000 /* that a chart has */

enum units_kind {
    UNITS_DONE,
    UNITS_RUN, /* till now */
    UNITS_PASS /* of the ambient cache: of no worker, whose name is empty */
};

struct units_span {
    float start, end; /* seconds since the job came */
    uint16_t worker, lane;
    uint32_t units; /* that it stands for */
    enum units_kind kind;
};

struct units {
    json_t *head;    /* the statistics without units and lines */
    char **workers;  /* names */
    uint16_t *lanes; /* of each worker, at least 1 */
    size_t nworkers;
    struct units_span *spans; /* by worker, lane, start */
    size_t nspans;
    uint32_t total;        /* units that are done */
    double start_s, end_s; /* of the first, of the last; now, where one runs */
};

/* Read statistics; u is initialised by this.  RAD_EDATA for what are none, or
 * RAD_ENOMEM; u is empty then. */
int units_read(struct units *u, const char *text, size_t len,
               struct rad_error *err);
void units_release(struct units *u);

#endif
