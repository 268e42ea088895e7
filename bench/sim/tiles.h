/* tiles.h - what each tile of a job with passes cost
 *
 * As bench/passes wrote it to a file (--tiles), a line each:
 *
 *      params OPTIONS          the canonical ones (base/params.h)
 *      pass LEVEL STEP N S     its N tiles follow; S: to find its paths [s]
 *      tile S RAYS RECORDS     seconds of a processor
 *      picture W H LIVE S      pixels; seconds of the whole job with a live
 *                              cache, and of the picture after the passes
 *
 * Seconds are of one processor of speed 1. */
#ifndef SIM_TILES_H
#define SIM_TILES_H

#include "base/error.h"
#include "base/params.h"
#include "passes/passplan.h"

struct tile_cost {
    double seconds;
    uint64_t rays;
    uint32_t records;
};

struct tiles {
    char params[RAD_PARAMS_TEXT];
    int width, height;
    double live_s, picture_s, passes_s; /* passes_s: of all tiles */
    uint32_t npasses;
    struct tile_pass {
        double begin_s;
        uint32_t n, reads; /* as in struct rad_pass */
        bool alone;        /* no thread may be at a tile when it goes in */
        struct tile_cost *tile;
    } pass[RAD_MOST_PASSES];
};

/* RAD_ENOINPUT; RAD_EDATA: damaged, or of another plan than
 * rad_passes_plan() makes now. */
int tiles_read(struct tiles *t, const char *file, struct rad_error *err);
/* Scale the seconds of tiles and of the picture, so that they take so many in
 * all, as with more rays to each record and pixel; finding where paths end
 * takes as long as before, for there are as many paths. */
void tiles_scale(struct tiles *t, double seconds);
void tiles_release(struct tiles *t);

#endif
