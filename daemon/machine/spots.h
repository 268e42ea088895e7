/* spots.h - where paths go (passes/passes.h), as a tile's records travel
 *
 * Each spot is three numbers of two bytes, big-endian; a tile's spots are
 * filled up with zeros to whole records.  So they are passed on as records are.
 * Thread: any. */
#ifndef DAEMON_SPOTS_H
#define DAEMON_SPOTS_H

#include "passes/passes.h"
#include "proto/wire.h"

/* Append n spots; returns how many records they take. */
uint32_t spots_pack(struct wire_out *w, const struct rad_pass_spot *spot,
                    size_t n);

/* Unpack all spots of the pass, malloc'd, from the bytes of its tiles, one
 * after the other.  NULL: RAD_EPROTO for a wrong length, or RAD_ENOMEM. */
struct rad_pass_spot *spots_unpack(const struct rad_pass *pass,
                                   const uint8_t *bytes, size_t len,
                                   struct rad_error *err);

#endif
