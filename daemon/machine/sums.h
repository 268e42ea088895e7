/* sums.h - the sums of a tile of a check pass (refine/refine.h) as bytes
 *
 * They travel in place of records, as f64 one after the other.
 * Thread: any. */
#ifndef DAEMON_SUMS_H
#define DAEMON_SUMS_H

#include "refine/refine.h"
#include "proto/wire.h"

#define SUMS_BYTES (8 * RAD_REFINE_SUMS)

void sums_pack(struct wire_out *out, const struct rad_refine_sums *sums);

/* False: these bytes are no sums, or a number is not finite. */
bool sums_unpack(const uint8_t *bytes, size_t len,
                 struct rad_refine_sums *sums);

#endif
