/* passes.h - the ambient cache of a job, filled in passes before its pictures
 *
 * A pass is a set of tiles.  A tile asks for records at some places: at points
 * that the pixels of a lattice show, or, for deep records (of level 1 and
 * more), at ends of random paths in one part of space.  A tile sees the records
 * of the passes that the plan names, and its own records (light/indirect/
 * ambtile.h), nothing else: so its records are the same, whichever worker makes
 * it and however often.  When all tiles of a pass are made their records, in
 * the order of tiles, are added to the cache, and the next pass begins.  So the
 * cache is a function of the job.
 * passplan.h says which passes there are.
 * Thread: see each function. */
#ifndef RAD_PASSES_PASSES_H
#define RAD_PASSES_PASSES_H

#include "light/indirect/ambient.h"
#include "picture/frame.h"
#include "passes/passplan.h"

struct rad_passes;

/* Make the state of the passes for the frames of one job, whose cache is
 * frozen; the frames must outlive the result.  NULL and *err: RAD_ENOMEM.
 * Thread: one. */
struct rad_passes *rad_passes_new(const struct rad_frame *frames,
                                  uint32_t nframes, struct rad_error *err);
void rad_passes_free(struct rad_passes *p);

/* The frames, *n of them.  Thread: any. */
const struct rad_frame *rad_passes_frames(const struct rad_passes *p,
                                          uint32_t *n);

/* Prepare for tiles of a pass.  Other tiles may be under way only if this pass
 * does not read their passes.  0 or RAD_ENOMEM.  Thread: one. */
int rad_passes_begin(struct rad_passes *p, struct rad_ctx *ctx,
                     const struct rad_pass *pass, struct rad_error *err);

/* A spot: the rough place of a path after some bounces, in 65535ths of the cube
 * of the cache's records.  The ends of a round of paths (passplan.h) are put in
 * order by their spots.  Each path has as many spots as there are levels of
 * deep records, in the order of bounces; at[0] of a spot that the path does not
 * get to is RAD_PASS_NO_SPOT. */
#define RAD_PASS_NO_SPOT 65535
struct rad_pass_spot {
    uint16_t at[3];
};

/* Make a tile of a pass that walks; out[] gets the spots of its paths, unless
 * it is NULL.  stop and the result are those of rad_passes_make(). */
bool rad_passes_walk(const struct rad_passes *p, struct rad_ctx *ctx,
                     const struct rad_pass *pass, uint32_t tile,
                     const _Atomic bool *stop, struct rad_pass_spot *out);

/* Keep the spots of all paths of a pass that walks, which is closed.  Without
 * this call all paths are walked again.  False: memory is out.  Thread: one,
 * while no thread is at a tile. */
bool rad_passes_place(struct rad_passes *p, const struct rad_pass *pass,
                      const struct rad_pass_spot *spot);

/* The colours of a tile's pixels, for a preview; row by row, as in a picture
 * file (image/hdr.h). */
struct rad_pass_colours {
    uint32_t n; /* 0: the pass shows none (rad_pass_shows()) */
    uint8_t rgbe[RAD_PASS_MOST_COLOURS][4];
};

/* Most records of a tile that are kept: so many fit the largest message. */
#define RAD_PASS_MOST_RECORDS 9000

/* Is called with a tile's records in their order, some at a time; if there are
 * more than RAD_PASS_MOST_RECORDS, with that many: all of level 0, then of
 * level 1, and so on. */
typedef void rad_passes_fn(void *arg, const struct rad_ambrec *rec, size_t n);

/* A tile to be made. */
struct rad_passes_order {
    const struct rad_pass *pass; /* was begun */
    uint32_t tile;
    const struct rad_ambview *seen; /* the view of the cache that the tile sees
                                     * (rad_ambient_view()): with the records of
                                     * pass->reads passes; NULL: the newest */
    const _Atomic bool *stop; /* if another thread sets it, the tile ends within
                               * a pixel */
    rad_passes_fn *fn;
    void *arg; /* fn's first */
    struct rad_pass_colours
        *colours; /* NULL, or is set after fn's last call,
                   * by the cache and the tile's records; its
                   * rays are not counted, change nothing */
};

/* Make the tile.  False: stopped, or memory is out; fn was not called.  Rays
 * that leave a surface count as ambient rays, those of pixels do not count as
 * primary.  Thread: any, for any number of tiles at once. */
bool rad_passes_make(const struct rad_passes *p, struct rad_ctx *ctx,
                     const struct rad_passes_order *order);

#endif
