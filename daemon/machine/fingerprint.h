/* fingerprint.h - do two machines compute the same bits?
 *
 * A hash over the pixels of a small scene, rendered as every job is, and over
 * results of the few functions of the C library that pictures may need.  Where
 * fingerprints agree pictures do, bit for bit, but for indirect light of
 * --ambient=live; where they differ pictures may differ in last bits.
 * Thread: any. */
#ifndef RADD_DAEMON_FINGERPRINT_H
#define RADD_DAEMON_FINGERPRINT_H

#include "base/error.h"

#include <stdint.h>

/* Takes some milliseconds.  Never 0 when it succeeds. */
int fingerprint(uint64_t *out, struct rad_error *err);

#endif
