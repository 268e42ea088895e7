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

/* Its frames, *n of them.  Thread: any. */
const struct rad_frame *rad_passes_frames(const struct rad_passes *p,
                                          uint32_t *n);

/* Go on to a pass, whose predecessor's records are in the cache.  RAD_ENOMEM.
 * Thread: one, with none at a tile. */
int rad_passes_begin(struct rad_passes *p, struct rad_ctx *ctx,
                     const struct rad_pass *pass, struct rad_error *err);

/* What the pixels of a tile's lattice look like so far, row by row, as in a
 * picture file (image/hdr.h). */
struct rad_pass_colours {
    uint32_t n; /* 0: the pass shows none (rad_pass_shows()) */
    uint8_t rgbe[RAD_PASS_MOST_COLOURS][4];
};

/* Make a tile of the pass: fn gets its records in their order, some at a time.
 * Then the tile's colours, unless that is NULL, by the cache and its records:
 * these rays count nowhere, and change nothing.
 * Within a pixel of *stop, if that is set, it ends; so it does when memory is
 * out: false, and fn was not called.  Its rays count as ambient ones where they
 * leave a surface, never as primary.  Thread: any, at any number of tiles. */
typedef void rad_passes_fn(void *arg, const struct rad_ambrec *rec, size_t n);
bool rad_passes_make(const struct rad_passes *p, struct rad_ctx *ctx,
                     uint32_t tile, const _Atomic bool *stop, rad_passes_fn *fn,
                     void *arg, struct rad_pass_colours *colours);

#endif
