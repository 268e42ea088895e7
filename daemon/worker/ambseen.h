/* ambseen.h - which ambient records a job's child has had
 *
 * A record usually comes to each worker once.  But a worker that joins, or
 * starts a job again with a new life of the coordinator, is sent the whole
 * cache of another, most of which it may have had, or even made; and while
 * links change some records come by two ways.  Twice in the cache, a record
 * would take memory and slow down look-ups.
 * Of a record a number of 64 bits is kept.  Among a million records two have
 * the same number with a probability of 3e-8; one of them is then made again.
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

/* Add a record (AMBSHARE_BYTES as they travel).  True: it is new, or memory is
 * out. */
bool ambseen_add(struct ambseen *s, const uint8_t *record);

/* Make the set empty. */
void ambseen_release(struct ambseen *s);

#endif
