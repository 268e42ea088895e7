/* store_impl.h - what the files of the store share
 *
 * Private to store*.c:
 *   store.c          begin and end
 *   store_task.c     requests as tasks of the queue
 *   store_arrive.c   files that connections send
 *   store_files.c    files that are there: are they sound, are they needed
 *   store_jobs.c     jobs: kept, over, forgotten
 *   store_submit.c   frames of jobs that are submitted
 *   store_rows.c     units, rows and pictures
 *   store_passes.c   what a job's passes leave and begin with
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
#include "ground/task.h"

#include <stdatomic.h>

struct arriving;    /* a file that a connection sends */
struct saved_task;  /* a job that is being kept */
struct forget_task; /* a job that is being forgotten */
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
    uint64_t begun_ms;          /* [fixed] the date of store_begin_life() */
    size_t backlog;             /* [loop] */
    struct saved_task *opening; /* [loop] jobs that wait to be kept, or are
                                 * being kept, the oldest first */
    struct saved_task *closing; /* [loop] jobs whose end is not on the disk */
    struct forget_task *forgetting; /* [loop] jobs that are being forgotten */
    struct submit_task *submitting; /* [loop] SUBMITs whose frames are read */
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

/* Is the handler not to hear of the task, which failed because the whole store
 * ends? */
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

/* Make a task of this size, zeroed but for run, done and owner, the store.  If
 * memory is out the daemon ends (store.h). */
void *store_new_task(struct store *s, size_t size, int (*run)(struct task *t),
                     void (*done)(struct task *t));
static inline struct store *
store_of(const struct task *t)
{
    return t->owner;
}

/* done() of tasks that the handler does not hear of: free the task. */
void store_free_task(struct task *t);
/* Push a task that writes and whose effect must last: it is held while the disk
 * is full, and its done() is called when its effect is on the disk. */
void store_push_lasting(struct store *s, struct task *t);
/* The disk lacks room: let the database's log give back what it holds, for the
 * next try.  Returns rc or, if that fails, another code, of *err. */
int store_shorten_log(struct store *s, int rc, struct rad_error *err);

/* --- store.c --- */

/* Set *err to why the state folder cannot be taken up; if it is damaged this
 * names 'radctl check'.  Returns the code of *err. */
int store_refuse(const struct store *s, const struct rad_error *why,
                 struct rad_error *err);

/* --- store_arrive.c --- */

/* Drop all incomplete files.  Called only when the store is idle. */
void store_release_arriving(struct store *s);

/* --- store_jobs.c --- */

/* The disk is full: remove the rows of jobs that end, but whose end cannot be
 * noted now. */
void store_make_room(struct store *s);

/* A task about a job; each kind of task uses some of the fields behind id. */
struct job_task {
    struct task task;
    uint8_t id[MSG_JOB];
    uint64_t sequence; /* of the action that the task is for */
    uint32_t frame;
    int state;
    int32_t priority;
    uint64_t bytes, cache_bytes;
};

/* Make a task about the job. */
struct job_task *store_new_job_task(struct store *s, const uint8_t *id,
                                    int (*run)(struct task *t),
                                    void (*done)(struct task *t));

#endif
