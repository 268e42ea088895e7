/* spots.h - where paths go (passes/passes.h), as a tile's records travel
 *
 * Three numbers of two bytes each spot, big-endian, filled up with zeros to a
 * number of records: whoever passes records on need not know what they are.
 * Thread: any. */
#ifndef DAEMON_SPOTS_H
#define DAEMON_SPOTS_H

#include "passes/passes.h"
#include "proto/wire.h"

/* Append n spots; returns how many records they take. */
uint32_t spots_pack(struct wire_out *w, const struct rad_pass_spot *spot,
                    size_t n);

/* All spots of the pass, malloc'd, from what its tiles have one after the
 * other; NULL and the code: that is not what they have, or memory is out. */
struct rad_pass_spot *spots_unpack(const struct rad_pass *pass,
                                   const uint8_t *bytes, size_t len,
                                   struct rad_error *err);

#endif
