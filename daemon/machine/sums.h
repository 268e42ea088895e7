/* sums.h - how far off pixels were that were made again (picture/doubt.h), as
 * messages tell it
 *
 * The sums of a tile of a check pass (refine/refine.h) travel in place of
 * records, as f64 one after the other.
 * Thread: any. */
#ifndef DAEMON_SUMS_H
#define DAEMON_SUMS_H

#include "refine/refine.h"
#include "proto/message.h"

#define SUMS_BYTES (8 * (RAD_DOUBT_SUMS + 5))

void sums_pack(struct wire_out *out, const struct rad_refine_sums *sums);

/* False: these bytes are no sums, or a number is not finite. */
bool sums_unpack(const uint8_t *bytes, size_t len,
                 struct rad_refine_sums *sums);

/* Add a doubt to a message's; make a struct rad_doubt of a message's. */
void sums_count(struct msg_doubt *to, const struct rad_doubt *more);
struct rad_doubt sums_counted(const struct msg_doubt *from);

#endif
