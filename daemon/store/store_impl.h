/* store_impl.h - what the files of the store share
 *
 * Private to store*.c:
 *   store.c          opening, the end
 *   store_task.c     requests as tasks of the queue
 *   store_arrive.c   files that connections send
 *   store_files.c    files that are there, and those that nobody needs
 *   store_jobs.c     jobs: kept, over, forgotten
 *   store_submit.c   frames of jobs that are submitted
 *   store_rows.c     units, rows and pictures
 *   store_read.c     reading files and pictures
 *   store_recover.c  jobs of earlier lives
 * Thread: the loop's, but for what tasks run (task.h). */
#ifndef RADD_DAEMON_STORE_IMPL_H
#define RADD_DAEMON_STORE_IMPL_H

#include "store/store.h"

#include "files/blobs.h"
#include "files/cache.h"
#include "folder/folder.h"
#include "journal/journal.h"
#include "files/sound.h"
#include "journal/statedir.h"
#include "ground/task.h"

#include <stdatomic.h>

struct arriving;   /* a file that a connection sends */
struct saved_task; /* a job that is being kept */
struct submit_task; /* a job whose frames are being read */

struct store {
    struct task_queue queue;
    const struct store_handler *handler;
    void *arg;
    char dir[BLOBS_DIR_MAX];
    int lock;
    struct blobs blobs;
    struct sounds sounds;       /* [loop] */
    bool durable;               /* [fixed] */
    bool ending;                /* [loop] */
    _Atomic unsigned previews;  /* open files of previews */
    bool full;                  /* [loop] the handler was told that the disk is
                                 * full */
    size_t backlog;             /* [loop] */
    struct saved_task *opening; /* [loop] */
    struct submit_task *submitting; /* [loop] */
    struct cache *cache;        /* [pool]; NULL: files are removed by
                                 * store_sweep() alone */
    struct arriving *arriving;  /* [pool] */
    struct folder folder;       /* [pool] */
    struct journal *journal;    /* [pool]; NULL: nothing outlives the process */
};

static inline const char *
failure(const struct task *t)
{
    return t->code < 0 ? t->err.what : "";
}

static inline int
status_of(const struct task *t)
{
    return t->code < 0 ? rad_exit_status(t->code) : 0;
}

/* The handler is not told: the task failed because the whole store ends. */
static inline bool
is_mute(const struct store *s, const struct task *t)
{
    return t->code < 0 && (s->ending || s->queue.told_broken);
}

static inline void
path_of(const struct store *s, const uint8_t *hash, char path[BLOBS_PATH_MAX])
{
    char name[RAD_SHA_HEX + 1];

    rad_sha_to_hex(hash, name);
    blobs_path(&s->blobs, name, path);
}

/* --- store_task.c --- */

/* A new task of that size, zeroed.  NULL: memory is out, and the handler's
 * broken() was called. */
void *store_new_task(struct store *s, size_t size, int (*run)(struct task *t),
                     void (*done)(struct task *t));
/* A done() for tasks that the handler does not hear of. */
void store_free_task(struct task *t);
/* Push a task whose effect must last: it may be held while the disk is full,
 * and is done when it is on the disk. */
void store_push_lasting(struct store *s, struct task *t);

/* --- store.c --- */

/* Report that the folder cannot be taken up; names 'radctl check' to the
 * administrator if it is damaged.  Returns the code of *err. */
int store_refuse(const struct store *s, const struct rad_error *why,
                 struct rad_error *err);

/* --- store_arrive.c --- */

/* Drop all incomplete files.  Only when the store is idle. */
void store_release_arriving(struct store *s);

/* --- store_jobs.c --- */

/* A task about a job that needs no more than these fields. */
struct job_task {
    struct task task;
    struct store *store;
    uint8_t id[MSG_JOB];
    uint64_t sequence; /* the action's */
    uint32_t frame;
    int state;
    int32_t priority;
    uint64_t bytes, cache_bytes;
};

/* NULL: as of store_new_task(). */
struct job_task *store_new_job_task(struct store *s, const uint8_t *id,
                                    int (*run)(struct task *t),
                                    void (*done)(struct task *t));

#endif
