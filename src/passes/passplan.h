/* passplan.h - which passes fill a job's ambient cache, and their tiles
 *
 * The deepest records come first, since all others are made of them.  Then come
 * the pixels of the pictures, from coarse lattices to fine ones, so that tiles
 * side by side make few records twice.
 * The frames of an animation come in batches.  Each batch has all these passes,
 * which add to the cache of the batches before.  The pictures of a batch are
 * made when its own passes are closed, before passes of the next batch change
 * the cache.  So that these change little of what is in sight, and light does
 * not jump from one batch's last picture to the next one's first, a batch looks
 * at every fourth frame or so of the next, too, which then looks only between
 * them.  The frames of a batch show much the same: the job's first frame
 * has all its lattices first, then the frame in the middle between it and the
 * batch's end, then the frames half way between these, and so on.
 * Random paths do not depend on the cache: they are walked once, in a first
 * pass of their own, and all workers get the rough places of their ends.
 * Each lattice comes in two passes: its tiles are the fields of a chess board,
 * and tiles of the second colour see the records of the first.
 * No tile takes long, since all workers wait for the last tile of a pass: a
 * tile ends when it has traced the rays of some hemispheres.  The next finer
 * lattice looks at the places that tiles of a coarse lattice so leave out.
 * After the finest lattice a scattered pass looks everywhere again, with twice
 * its step, and goes on between pixels that made records.  Its tiles have small
 * squares all over the picture, so all tiles take about as long; in a large
 * picture they end early, too, and another scattered pass follows.  In a small
 * picture much can be missing, and each tile would make the same deep records:
 * there, for the first frame, the pass comes in rounds, each over as many
 * squares as all rounds before it, the last over up to twice as many.
 * In a large picture each of these passes comes in parts.  A part does not read
 * the parts just before it, so tiles of several passes can be made at a time.
 * The plan depends on the options and the sizes of the pictures alone: the
 * coordinator, which hands out tiles, needs no scene.
 * Source: Jones & Reinhart 2016, Parallel multiple-bounce irradiance caching
 * (the order).
 * Thread: any. */
#ifndef RAD_PASSES_PASSPLAN_H
#define RAD_PASSES_PASSPLAN_H

#include "base/params.h"

#include <stdbool.h>
#include <stdint.h>

/* A pass may come in so many parts, which need few of each other's records. */
#define RAD_PASS_PARTS 4

/* A pass: a lattice of pixels (level 0), a round of paths (level above 0), or a
 * pass that walks or checks. */
struct rad_pass {
    uint32_t reads;      /* its tiles see the records of passes 0 .. reads - 1:
                          * of all before it, or of all but the last few */
    int level;           /* of its records: diffuse bounces before them */
    uint32_t first, end; /* level above 0, or walks: paths first .. end - 1 of
                          * the batch; scattered: places first .. end - 1 in the
                          * order of squares that leap gives */
    uint32_t paths;      /* the number of paths of the batch */
    int walks; /* not 0: tiles make no records, but so many spots of each path,
                * for later passes (passes.h) */
    int step, done; /* level 0: every step-th pixel along both axes, without
                     * every done-th (0: all of them) */
    uint32_t frame, stride, beyond; /* of frames frame, frame + stride, ...
                                     * below beyond */
    uint32_t ready; /* frames below this can be made when the pass is closed */
    int round;      /* level above 0: 0 and 1 in turn, from round to round */
    int part;    /* the pass has the tiles of this part, from the left of wide
                  * pictures, from the top of tall pictures, or of a round of
                  * paths; less than 0: all tiles */
    int side;    /* level 0: side of a tile, in pixels of the lattice */
    int field;   /* level 0: tiles are the fields of a chess board, and the pass
                  * has those of this colour, 0 or 1; less than 0: all */
    bool finest; /* level 0: the last lattice; its tiles ask, too, between
                  * its pixels where records were made */
    bool scattered; /* level 0: looks again where the last lattice left places
                     * out; a tile has several squares, far from each other */
    uint32_t squares, leap; /* scattered: number of squares of all its frames,
                             * or of the pass's part of them; the square at
                             * place i is i * leap modulo squares */
    uint64_t rays;  /* when a tile has traced so many rays of hemispheres it
                     * asks for no more records; 0: there is no limit */
    bool check;     /* tiles make no records, but measure the cache's error
                     * (refine.h) */
    uint32_t tiles; /* number of its tiles */
};
/* The most passes of a job; rad_passes_plan_on() in passplan.c says why. */
#define RAD_MOST_PASSES 2400

/* The deepest level that has passes; deeper records are made by tiles that need
 * them. */
#define RAD_PASS_LEVELS 8

/* Side of a tile, in pixels of its lattice, at most. */
#define RAD_PASS_SIDE 8

/* The last lattice has the step of base lines (-ps), within these bounds; twice
 * that for many frames together.  Its tiles have sides of at most so many
 * pixels. */
#define RAD_PASS_LEAST_STEP 2
#define RAD_PASS_FINEST     4
#define RAD_PASS_PIXELS     32

struct rad_pass_size {
    int width, height; /* of a picture */
};

/* The level of the deepest records that have passes; 0: no deep records do. */
int rad_pass_deepest(const struct rad_params *par);

/* A batch has at most so many frames, unless that would make more than
 * RAD_PASS_BATCHES; batches are about equal.  The frames of a batch share the
 * passes of paths, and those over places that tiles left out.  With smaller
 * batches passes end more often, and workers wait at their ends; with larger
 * batches pictures come later. */
#define RAD_PASS_BATCH   32
#define RAD_PASS_BATCHES 32

/* Plan the passes of a job with pictures of these sizes.  Returns their number,
 * 0 if the job has no cache. */
uint32_t rad_passes_plan(const struct rad_params *par,
                         const struct rad_pass_size *size, uint32_t nsizes,
                         struct rad_pass pass[RAD_MOST_PASSES]);

/* Plan the passes, as rad_passes_plan() does, of a job that begins with the
 * records of a former job: these records are its first pass, which has no
 * tiles. */
uint32_t rad_passes_plan_on(const struct rad_params *par,
                            const struct rad_pass_size *size, uint32_t nsizes,
                            struct rad_pass pass[RAD_MOST_PASSES]);

/* How many frames can be made when so many passes are closed. */
static inline uint32_t
rad_passes_ready(const struct rad_pass *pass, uint32_t closed)
{
    return closed > 0 ? pass[closed - 1].ready : 0;
}

/* Is pass i the last before some frames can be made, or before a check? */
static inline bool
rad_pass_is_last(const struct rad_pass *pass, uint32_t n, uint32_t i)
{
    return !pass[i].check && ((i + 1 < n && pass[i + 1].check) ||
                              pass[i].ready > rad_passes_ready(pass, i));
}

/* The number of squares of a pass over pixels, in a frame of that size; of all
 * rounds, if it is scattered. */
uint32_t rad_pass_tiles(const struct rad_pass *pass, int width, int height);

/* The number of squares of a tile, and the i-th of them, counted on from frame
 * to frame. */
uint32_t rad_pass_squares(const struct rad_pass *pass, uint32_t tile);
uint32_t rad_pass_square(const struct rad_pass *pass, uint32_t tile,
                         uint32_t i);

/* The pixels of a square of a frame; x1 and y1 are beyond the last. */
struct rad_pass_area {
    int x0, y0, x1, y1;
};
struct rad_pass_area rad_pass_area(const struct rad_pass *pass, int width,
                                   int height, uint32_t square);

/* The number of tiles of a round of paths, in all its parts; the pass's own
 * tiles begin with *first. */
static inline uint32_t
rad_pass_round(const struct rad_pass *pass, uint32_t *first)
{
    *first = pass->part > 0 ? (uint32_t)pass->part * pass->tiles : 0;
    return pass->part < 0 ? pass->tiles : RAD_PASS_PARTS * pass->tiles;
}

/* The number of paths of a tile of a pass that walks; they begin with
 * *first. */
uint32_t rad_pass_paths(const struct rad_pass *pass, uint32_t tile,
                        uint32_t *first);

/* Tiles of lattices with this step or a larger step can give the colours of
 * their pixels, for previews: of a 64th of all pixels.  The next finer lattice
 * would take four times as long. */
#define RAD_PASS_SHOWN        8
#define RAD_PASS_MOST_COLOURS (RAD_PASS_SIDE * RAD_PASS_SIDE)

/* Can tiles of the pass give the colours of their pixels? */
static inline bool
rad_pass_shows(const struct rad_pass *pass)
{
    return pass->level == 0 && pass->step >= RAD_PASS_SHOWN && !pass->scattered;
}

#endif
