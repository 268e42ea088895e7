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

struct arriving;   /* a file that a connection sends */
struct saved_task; /* a job that is to be kept */
struct submit_task; /* one whose frames are being read */

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
    bool full;                  /* [loop] the disk is, and that was told */
    size_t backlog;             /* [loop] */
    struct saved_task *opening; /* [loop] */
    struct submit_task *submitting; /* [loop] */
    struct cache *cache;        /* [pool]; NULL: nothing goes by itself */
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

/* Not to be told: it failed with the whole store. */
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

/* Room for a task; NULL when memory is out, and then the handler knows that the
 * store does not answer. */
void *store_new_task(struct store *s, size_t size, int (*run)(struct task *t),
                     void (*done)(struct task *t));
/* The done() of a task whose end nobody is told. */
void store_free_task(struct task *t);
/* To be kept: it may be held, and is done when it lasts. */
void store_push_lasting(struct store *s, struct task *t);

/* --- store.c --- */

/* The folder cannot be taken up; the tool is named to whoever has to deal with
 * it.  Returns why->code. */
int store_refuse(const struct store *s, const struct rad_error *why,
                 struct rad_error *err);

/* --- store_arrive.c --- */

/* Forget all that was sent by halves; only when idle. */
void store_release_arriving(struct store *s);

/* --- store_jobs.c --- */

/* A task that is about a job, and needs no more than this. */
struct job_task {
    struct task task;
    struct store *store;
    uint8_t id[MSG_JOB];
    uint64_t sequence; /* as the action's */
    uint32_t frame;
    int state;
    int32_t priority;
    uint64_t bytes, cache_bytes;
};

/* NULL: as store_new_task(). */
struct job_task *store_new_job_task(struct store *s, const uint8_t *id,
                                    int (*run)(struct task *t),
                                    void (*done)(struct task *t));

#endif
