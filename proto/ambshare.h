/* ambshare.h - ambient records as they travel between workers
 *
 * AMBSHARE_BYTES each, big-endian, the fields of struct rad_ambrec in order:
 * three doubles (p), then floats n[3] u[3] radius[2] E[3] gpos[2] gdir[2] var
 * and the glint's p[3] and lum, u32 corral, float weight, u16 level.
 * radd and the coordinator never look inside.
 * Thread: any. */
#ifndef AMBSHARE_H
#define AMBSHARE_H

#include "light/indirect/ambient.h"
#include "proto/wire.h"

#define AMBSHARE_BYTES (3 * 8 + 20 * 4 + 4 + 4 + 2)

/* Append a record to out; if it does not fit, out->bad is set. */
void ambshare_pack(struct wire_out *out, const struct rad_ambrec *rec);

/* Read one record.  False, with in->bad set, if bytes are missing or the record
 * is unsound: a value that is not finite, a normal that is not of unit length,
 * a radius that is not positive, negative light, or a known variance below 0.
 */
bool ambshare_unpack(struct wire_in *in, struct rad_ambrec *rec);

/* Does the record meet the rules of ambshare_unpack()? */
bool ambshare_sound(const struct rad_ambrec *rec);

/* Make the next FROZEN of a pass's n records.  At first *m has only the job and
 * the pass; each call continues after the piece in *m.  A pass without records
 * gets one empty FROZEN.  False: there are no more. */
struct msg_frozen;
bool ambshare_piece(struct msg_frozen *m, const uint8_t *records, uint32_t n);

/* Put the records of a file into the cache, like records of other workers.
 * Those that do not fit the scene are left out: rtrace makes some for sensors
 * outside of it.  RAD_EDATA: the file ends in the middle of a record, or none
 * of its records fits. */
int ambshare_load(struct rad_ambient *amb, const void *bytes, size_t len,
                  struct rad_error *err);

#endif
