/* kept.h - records of passes that an earlier life of the coordinator closed
 *
 * They wait in the job until its first worker is ready (filling/passes.c).
 * Thread: the coordinator's loop. */
#ifndef DAEMON_KEPT_H
#define DAEMON_KEPT_H

#include "machine/saved.h"

/* Closed passes of a job; zeroed: none. */
struct kept_passes {
    uint32_t n;
    struct saved_pass *pass; /* malloc'd, as are the bytes of each pass */
};

/* A job's ambient cache, as other jobs may begin with it once the job is over
 * (registry/reuse.h); and when its passes were closed. */
struct kept_cache {
    uint64_t bytes; /* size on the disk, part of kept_bytes; 0: no cache is kept
                     */
    bool held;      /* the cache may not be deleted: a new job that begins with
                     * it has not got the records yet (bygone.c) */
    struct pass_range range; /* passes in the cache, if the job ended in this
                              * life of the coordinator */
    uint64_t reused;         /* number of another job's records that this job
                              * began with */
    uint64_t *closed_ms;     /* when passes were closed in this life */
    uint32_t nclosed;        /* length of closed_ms */
};

/* Copy the passes that the store kept of a job; false: memory is out. */
bool kept_copy(struct kept_passes *k, const struct saved_job *s);
/* Forget all passes but the first n; forget all. */
void kept_cut(struct kept_passes *k, uint32_t n);
void kept_drop(struct kept_passes *k);

/* Note in closed_ms that a pass was closed; ignored if memory is out. */
void kept_note_time(struct kept_cache *k, uint64_t now_ms);
void kept_forget_times(struct kept_cache *k);

#endif
