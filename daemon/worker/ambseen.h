/* ambseen.h - which ambient records a job's child has had
 *
 * A record usually comes to each worker once.  But a worker that joins, or
 * starts a job again with a new life of the coordinator, gets the whole cache
 * of another worker, most of which it may have had or made itself; and while
 * links change some records come by two ways.  A record that is in the cache
 * twice takes memory and slows look-ups down.
 * The set keeps a 64 bit hash of each record.  The probability that two of a
 * million records have the same hash is 3e-8; the second of them is not used.
 * Thread: the child's loop. */
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

/* Add a record, as AMBSHARE_BYTES on the wire.  True: it is new, or memory is
 * out. */
bool ambseen_add(struct ambseen *s, const uint8_t *record);

/* Make the set empty. */
void ambseen_release(struct ambseen *s);

#endif
