/* fingerprint.h - do two machines compute the same bits?
 *
 * A hash over a fixed set of results of the C library's mathematical functions
 * and of a small scene, rendered as every job is.  Where fingerprints agree,
 * so do pictures (without indirect light) bit for bit; where they differ they
 * may differ in last bits.
 * Thread: any. */
#ifndef RADD_DAEMON_FINGERPRINT_H
#define RADD_DAEMON_FINGERPRINT_H

#include "base/error.h"

#include <stdint.h>

/* Takes some milliseconds.  Never 0 when it succeeds. */
int fingerprint(uint64_t *out, struct rad_error *err);

#endif
