/* passes.h - the ambient cache of a job, filled in passes before its pictures
 *
 * A pass is a set of tiles, and a tile asks for records at some places: those
 * that pixels of a lattice show, or, for deep records (of one bounce and more),
 * ends of random paths in one part of space.  A tile sees the cache as it stood
 * when the pass began, and its own records (light/indirect/ambtile.h): whoever
 * makes it, and how often, it has the same ones.  When all tiles of a pass are
 * there their records, in the order of tiles, are added to the cache, and the
 * next pass begins.  So the cache is a function of the job.
 * Which passes there are says passplan.h.
 * Thread: see each function. */
#ifndef RAD_PASSES_PASSES_H
#define RAD_PASSES_PASSES_H

#include "light/indirect/ambient.h"
#include "picture/frame.h"
#include "passes/passplan.h"

struct rad_passes;

/* For frames of one job, whose cache is frozen; they must outlive it.  NULL and
 * *err: RAD_ENOMEM.  Thread: one. */
struct rad_passes *rad_passes_new(const struct rad_frame *frames,
                                  uint32_t nframes, struct rad_error *err);
void rad_passes_free(struct rad_passes *p);

/* The frames, *n of them.  Thread: any. */
const struct rad_frame *rad_passes_frames(const struct rad_passes *p,
                                          uint32_t *n);

/* Get ready for tiles of a pass; only of those that it does not read others may
 * be under way.  RAD_ENOMEM.  Thread: one. */
int rad_passes_begin(struct rad_passes *p, struct rad_ctx *ctx,
                     const struct rad_pass *pass, struct rad_error *err);

/* Where paths go roughly, in 65535ths of the cube of the cache's records: ends
 * of a round are put in order by that.  Each path has as many spots as there
 * are levels of deep records, from the nearest on; the first number of those
 * that it does not get to is RAD_PASS_NO_SPOT. */
#define RAD_PASS_NO_SPOT 65535
struct rad_pass_spot {
    uint16_t at[3];
};

/* Make a tile of a pass that walks, as below; *out becomes the spots of its
 * paths, unless it is NULL. */
bool rad_passes_walk(const struct rad_passes *p, struct rad_ctx *ctx,
                     const struct rad_pass *pass, uint32_t tile,
                     const _Atomic bool *stop, struct rad_pass_spot *out);

/* That pass is closed, and these are the spots of all its paths.  Who is not
 * told has to walk them all.  False: memory is out.  Thread: one, with none at
 * a tile. */
bool rad_passes_place(struct rad_passes *p, const struct rad_pass *pass,
                      const struct rad_pass_spot *spot);

/* What the pixels of a tile's lattice look like so far, row by row, as in a
 * picture file (image/hdr.h). */
struct rad_pass_colours {
    uint32_t n; /* 0: the pass shows none (rad_pass_shows()) */
    uint8_t rgbe[RAD_PASS_MOST_COLOURS][4];
};

/* Make a tile of a pass that was begun: fn gets its records in their order,
 * some at a time.  The records of pass->reads passes are in the cache, and
 * those of `behind` more; it must not be settled meanwhile. Then the tile's
 * colours, unless that is NULL, by the cache and its records: these rays count
 * nowhere, and change nothing. Within a pixel of *stop, if that is set, it
 * ends; so it does when memory is out: false, and fn was not called.  Its rays
 * count as ambient ones where they leave a surface, never as primary.  Thread:
 * any, at any number of tiles. */
typedef void rad_passes_fn(void *arg, const struct rad_ambrec *rec, size_t n);
bool rad_passes_make(const struct rad_passes *p, struct rad_ctx *ctx,
                     const struct rad_pass *pass, uint32_t behind,
                     uint32_t tile, const _Atomic bool *stop, rad_passes_fn *fn,
                     void *arg, struct rad_pass_colours *colours);

#endif
