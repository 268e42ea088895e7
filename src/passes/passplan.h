/* passplan.h - which passes fill a job's ambient cache, and their tiles
 *
 * The deepest records come first, for the others are made of them; then the
 * pictures, from coarse lattices of pixels to fine ones, so that few records
 * are made twice by tiles side by side.
 * The frames of an animation come in batches, each with all these passes, on
 * top of the cache that the batches before it left: the pictures of a batch can
 * be made when its own passes are closed, before the next batch's change the
 * cache.  Frames of a batch show much the same: the first frame of all has all
 * its lattices first, then those in the middle between it and the batch's end,
 * those half way between these, and so on.
 * Where paths go does not depend on the cache: they are walked in a pass of
 * their own, the first, and what it finds is told to all.
 * A lattice is asked at in two passes: its tiles are the fields of a chess
 * board, and those of one colour see the records of those of the other.
 * No tile is dear, for all wait for the last one: it ends after some
 * hemispheres' rays.  What a coarse lattice leaves out by that the next finer
 * one comes to; behind the finest there is a pass that looks everywhere again,
 * with twice its step, and goes on between pixels that made records.  Its tiles
 * have small squares all over the picture, so they are about equal; in a large
 * picture they end so, too, and a pass like it comes behind them.
 * Of a large picture each of these passes comes in parts, of which none reads
 * those that are just before it: so there are tiles of some passes to be made
 * at a time.
 * The plan depends on the options and the sizes of the pictures alone: whoever
 * shares the tiles out needs no scene.
 * Source: Jones & Reinhart 2016, Parallel multiple-bounce irradiance caching
 * (the order).
 * Thread: any. */
#ifndef RAD_PASSES_PASSPLAN_H
#define RAD_PASSES_PASSPLAN_H

#include "base/params.h"

#include <stdbool.h>
#include <stdint.h>

/* A pass may come in so many parts, of which none needs another much. */
#define RAD_PASS_PARTS 4

/* What one pass asks for. */
struct rad_pass {
    uint32_t reads;      /* its tiles see the records of so many passes: of all
                          * before it, or of all but the last few */
    int level;           /* of its records: bounces before them */
    uint32_t first, end; /* level above 0: paths of that number, of those that
                          * begin in the pass's frames, below end, */
    uint32_t paths;      /* of so many in all passes of the batch */
    int walks; /* not 0: no records, but so many spots of each of these paths,
                * which are for the passes behind it (passes.h) */
    int step, done; /* level 0: every step-th pixel along both axes, but those
                     * of every done-th (0: of no) */
    uint32_t frame, stride, beyond; /* of frames frame, frame + stride, ...
                                     * below beyond */
    uint32_t ready; /* when it is closed: frames below that can be made */
    int round; /* level above 0: 0 or 1, other than that of the round before */
    int part;  /* it has the tiles of that part of pictures, from the left, or
                * of tall ones from the top, or of a round of paths; less than
                * 0: all */
    int side;  /* level 0: of a tile, in pixels of the lattice */
    int field; /* level 0: tiles are the fields of a chess board, and the pass
                * has those of this colour, 0 or 1; less than 0: all */
    bool finest;    /* level 0: the last lattice, and what lies between its
                     * pixels where objects end or records are dense */
    bool scattered; /* level 0: what the last lattice left out; a tile has not
                     * one square of pixels but all that are as far apart in
                     * number as there are tiles */
    uint64_t rays;  /* of hemispheres, after which a tile asks for nothing more;
                     * 0: it asks everywhere */
    bool check;     /* no records: how good is what there is (refine.h)? */
    uint32_t tiles;
};
/* See rad_passes_plan_on(). */
#define RAD_MOST_PASSES 2400

/* Records of more bounces than that are made on the way. */
#define RAD_PASS_LEVELS 8

/* Of a tile, in pixels of its lattice, at most. */
#define RAD_PASS_SIDE 8

/* The last lattice has steps of as many pixels as base lines (-ps), within
 * these bounds, and of many frames that come together twice as many; its tiles
 * have at most so many pixels along a side. */
#define RAD_PASS_LEAST_STEP 2
#define RAD_PASS_FINEST     4
#define RAD_PASS_PIXELS     32

struct rad_pass_size {
    int width, height; /* of a picture */
};

/* Bounces before the deepest records that have passes, 0: there are none. */
int rad_pass_deepest(const struct rad_params *par);

/* Frames of a batch, at most, unless there were more than RAD_PASS_BATCHES
 * then; batches are about equal.  Their frames share what is looked at beside
 * their pixels: paths to deep records, and places that a tile left out.  With
 * fewer the ends of passes, at which workers wait, are more often; with more,
 * pictures come later. */
#define RAD_PASS_BATCH   32
#define RAD_PASS_BATCHES 32

/* The passes of a job with pictures of these sizes, 0 if it has no cache.
 * Returns how many there are. */
uint32_t rad_passes_plan(const struct rad_params *par,
                         const struct rad_pass_size *size, uint32_t nsizes,
                         struct rad_pass pass[RAD_MOST_PASSES]);

/* The same of a job that begins with the records of a former job: these are its
 * first pass, which has no tiles. */
uint32_t rad_passes_plan_on(const struct rad_params *par,
                            const struct rad_pass_size *size, uint32_t nsizes,
                            struct rad_pass pass[RAD_MOST_PASSES]);

/* Frames that can be made when so many passes are closed. */
static inline uint32_t
rad_passes_ready(const struct rad_pass *pass, uint32_t closed)
{
    return closed > 0 ? pass[closed - 1].ready : 0;
}

/* Is pass i the last before some pictures, or a check? */
static inline bool
rad_pass_is_last(const struct rad_pass *pass, uint32_t n, uint32_t i)
{
    return !pass[i].check && ((i + 1 < n && pass[i + 1].check) ||
                              pass[i].ready > rad_passes_ready(pass, i));
}

/* Squares of a pass over pixels in a frame of that size: a tile each, unless it
 * is scattered. */
uint32_t rad_pass_tiles(const struct rad_pass *pass, int width, int height);

/* The pixels of one of these squares, x1 and y1 beyond the last. */
struct rad_pass_area {
    int x0, y0, x1, y1;
};
struct rad_pass_area rad_pass_area(const struct rad_pass *pass, int width,
                                   int height, uint32_t tile);

/* All tiles of a round of paths, of which the pass has its own from *first on.
 */
static inline uint32_t
rad_pass_round(const struct rad_pass *pass, uint32_t *first)
{
    *first = pass->part > 0 ? (uint32_t)pass->part * pass->tiles : 0;
    return pass->part < 0 ? pass->tiles : RAD_PASS_PARTS * pass->tiles;
}

/* Paths of a tile of a pass that walks, from *first on. */
uint32_t rad_pass_paths(const struct rad_pass *pass, uint32_t tile,
                        uint32_t *first);

/* Of passes with these lattices and coarser ones tiles can tell the colours of
 * their pixels, for whoever watches the picture come: a 64th of all pixels, and
 * the next lattice takes four times as long. */
#define RAD_PASS_SHOWN        8
#define RAD_PASS_MOST_COLOURS (RAD_PASS_SIDE * RAD_PASS_SIDE)

static inline bool
rad_pass_shows(const struct rad_pass *pass)
{
    return pass->level == 0 && pass->step >= RAD_PASS_SHOWN && !pass->scattered;
}

#endif
