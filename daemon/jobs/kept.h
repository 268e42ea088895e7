/* kept.h - records of passes that an earlier life of the coordinator closed
 *
 * They wait in the job until its first worker is ready (filling/passes.c).
 * Thread: one. */
#ifndef DAEMON_KEPT_H
#define DAEMON_KEPT_H

#include "machine/saved.h"

/* Zeroed: there are none. */
struct kept_passes {
    uint32_t n;
    struct saved_pass *pass; /* each malloc'd, as the list is */
};

/* Of a job that is over: the cache that is kept of it, for others to begin with
 * (queue/reuse.h); of any the records that it began with itself, and when the
 * passes were closed that were closed in this life. */
struct kept_cache {
    uint64_t bytes; /* of kept_bytes; 0: none is kept */
    bool held; /* until a job that begins with it has its records (coord_keep.c)
                */
    struct pass_range range; /* of one that ended in this life */
    uint64_t reused;         /* records, once they are here */
    uint64_t *closed_ms;
    uint32_t nclosed;
};

/* Copy what the store kept of a job's; false: memory is out. */
bool kept_copy(struct kept_passes *k, const struct saved_job *s);
/* Forget all but the first n. */
void kept_cut(struct kept_passes *k, uint32_t n);
void kept_drop(struct kept_passes *k);

/* A pass is closed; it is left out when memory is out. */
void kept_note_time(struct kept_cache *k, uint64_t now_ms);
void kept_forget_times(struct kept_cache *k);

#endif
