/* seed.h - the deep ambient records of a job, made before its first pixel
 *
 * Rays of hemispheres go everywhere in a room, whatever part of its picture
 * they are for.  So workers that begin together ask for the same deep records
 * (of one bounce and more) at the same time, and would each make them.  Instead
 * each makes those of a part of space before it renders, and the others get
 * them.
 * All walk the same random paths from the same pixels, by intersection alone,
 * cut what these meet into compact parts (picture/parts.h), and each shades the
 * rays that end in its own, where the cache does not serve yet.  The deepest
 * come first, for the others are made of them.
 * It changes no pixel but as records do that come from elsewhere.
 * Thread: see each function. */
#ifndef RAD_PICTURE_SEED_H
#define RAD_PICTURE_SEED_H

#include "picture/frame.h"

struct rad_seed;

/* Have these frames of one job deep records, and so many pixels that it is worth
 * it?  One at least. */
bool rad_seed_wanted(const struct rad_frame *frames, uint32_t nframes);

/* For frames that outlive it, one at least, all of one job that wants it.  The
 * part is from `first` up to below `last`, of 1 for all.  NULL: RAD_ENOMEM. */
struct rad_seed *rad_seed_new(const struct rad_frame *frames, uint32_t nframes,
                              double first, double last, struct rad_error *err);
void rad_seed_free(struct rad_seed *s);

/* Is there a piece to begin?  Thread: any, as the next. */
bool rad_seed_open(const struct rad_seed *s);

/* Do a piece of it, if there is one; less if *stop.  Its rays count as ambient
 * ones where they leave a surface, never as primary. */
void rad_seed_work(struct rad_seed *s, struct rad_ctx *ctx,
                   const _Atomic bool *stop);

/* All pieces are done: go on to what needs that.  False: nothing does,
 * or memory is out; it is over.  Thread: one, with none at work. */
bool rad_seed_next(struct rad_seed *s);

#endif
