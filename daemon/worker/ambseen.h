/* ambseen.h - which ambient records a job's child has had
 *
 * A record comes to each worker once; but a worker that joins, or that starts
 * anew with a coordinator that did, is given all that another's cache holds, of
 * which it may have had, or even made, the most, and while links change some
 * come by two ways.  Twice in the cache they would take twice the memory, and
 * the time of whoever looks there.
 * Of a record no more is kept than a number of 64 bits, which of a million
 * makes two look like one with a probability of 3e-8; that costs the time to
 * make it.
 * Thread: one. */
#ifndef RADD_DAEMON_AMBSEEN_H
#define RADD_DAEMON_AMBSEEN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* All zero is empty. */
struct ambseen {
    uint64_t *slot; /* 0: free */
    size_t nslots;  /* a power of two; at most half of them are taken */
    size_t n;
};

/* Is the record, AMBSHARE_BYTES as it travels, a new one?  It is there then;
 * where memory is out all are new. */
bool ambseen_add(struct ambseen *s, const uint8_t *record);

/* Make it empty. */
void ambseen_release(struct ambseen *s);

#endif
