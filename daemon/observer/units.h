/* units.h - a job's statistics, and its units as spans of time by worker
 *
 * The statistics are the coordinator's JSON (radd.stats(5)): of many units it
 * is long, so units are read one by one and the rest is kept as values.
 * Thread: any; a struct belongs to one thread. */
#ifndef RADD_OBSERVER_UNITS_H
#define RADD_OBSERVER_UNITS_H

#include "base/error.h"

#include <jansson.h>
#include <stddef.h>
#include <stdint.h>

/* Most bytes ahead of the units: twice what 1000 workers take. */
#define UNITS_HEAD    (1 << 20)
#define UNITS_WORKERS 200  /* with spans; units of further ones are left out */
#define UNITS_LANES   16   /* most units of a worker side by side */
#define UNITS_SPANS   3000 /* most spans of a chart */

enum units_kind {
    UNITS_DONE,
    UNITS_RUN, /* under way, so the span ends now */
    UNITS_PASS /* a pass of the ambient cache; its worker's name is empty */
};

struct units_span {
    float start, end; /* seconds since the job came */
    uint16_t worker, lane;
    uint32_t units; /* that the span stands for */
    enum units_kind kind;
};

struct units {
    json_t *head;    /* the statistics without units and lines */
    char **workers;  /* names */
    uint16_t *lanes; /* of each worker, at least 1 */
    size_t nworkers;
    struct units_span *spans; /* by worker, lane, start */
    size_t nspans;
    double start_s, end_s; /* of the first and last span */
};

/* Read statistics into u, which is initialised here.  RAD_EDATA: the text is no
 * statistics; RAD_ENOMEM.  On failure u is empty. */
int units_read(struct units *u, const char *text, size_t len,
               struct rad_error *err);
void units_release(struct units *u);

#endif
