/* kept.h - records of passes that an earlier life of the coordinator closed
 *
 * They wait in the job until its first worker is ready (filling/passes.c).
 * Thread: the coordinator's loop. */
#ifndef DAEMON_KEPT_H
#define DAEMON_KEPT_H

#include "machine/saved.h"

/* Zeroed: there are none. */
struct kept_passes {
    uint32_t n;
    struct saved_pass *pass; /* malloc'd, and so are each one's bytes */
};

/* The ambient cache of a job that is over, which other jobs may begin with
 * (queue/reuse.h); and facts of any job's own cache. */
struct kept_cache {
    uint64_t bytes; /* size on the disk, part of kept_bytes; 0: none is kept */
    bool held;      /* it may not be deleted: a new job that begins with it has
                     * not got the records yet (coord_keep.c) */
    struct pass_range range; /* its passes, if the job ended in this life of the
                              * coordinator */
    uint64_t reused;         /* records of another job that this job began with
                              */
    uint64_t *closed_ms;     /* when passes were closed in this life */
    uint32_t nclosed;        /* length of closed_ms */
};

/* Copy the passes that the store kept of a job; false: memory is out. */
bool kept_copy(struct kept_passes *k, const struct saved_job *s);
/* Forget all but the first n. */
void kept_cut(struct kept_passes *k, uint32_t n);
void kept_drop(struct kept_passes *k);

/* Note in closed_ms that a pass was closed, unless memory is out. */
void kept_note_time(struct kept_cache *k, uint64_t now_ms);
void kept_forget_times(struct kept_cache *k);

#endif
