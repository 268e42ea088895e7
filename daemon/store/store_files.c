/* store_files.c - the store's files by hash: are they sound, are they needed
 *
 * The loop knows which files it has found to be sound (sound.h).  To read a
 * file may take long, so a task does it: store_look() pushes one for the files
 * that are not known.  When the task is done, damaged files are removed on the
 * loop; a user or the coordinator will send them again.
 * At a coordinator a file is removed when no job needs it and its time tells
 * that it was neither sent nor looked for lately. */
#include "config.h"

#include "store/store_impl.h"

#include "ground/memory.h"
#include "net/log.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

struct look_task {
    struct task task;
    struct action_look look;
    int8_t *found; /* for each file the result of sounds_read(); 2: the loop
                    * knew before that it is sound */
    uint8_t hash[];
};

/* Note that l->job uses its files, if there is room for them.  A worker without
 * room may have room later, so the task does not fail: l->status tells. */
static void
use_files(struct look_task *l)
{
    struct rad_error err = { 0 };
    int rc = cache_use(store_of(&l->task)->cache, l->look.job, &l->look.files,
                       l->look.bytes, &err);

    l->look.status = rc < 0 ? rad_exit_status(rc) : 0;
    snprintf(l->look.why, sizeof l->look.why, "%s", err.what);
}

static int
look_run(struct task *t)
{
    struct look_task *l = (struct look_task *)t;
    struct store *s = store_of(t);
    char path[BLOBS_PATH_MAX];

    if (s->cache)
        use_files(l);

    for (uint32_t i = 0; i < l->look.nlook; i++)
        if (l->found[i] != 2) {
            path_of(s, l->hash + (size_t)i * MSG_HASH, path);
            l->found[i] =
                (int8_t)sounds_read(l->hash + (size_t)i * MSG_HASH, path);
        }
    return 0;
}

static void
remove_damaged(const char *path)
{
    unlink(path);
    log_warn("file removed path=%s: it is damaged", path);
}

static void
look_done(struct task *t)
{
    struct look_task *l = (struct look_task *)t;
    struct store *s = store_of(t);
    char path[BLOBS_PATH_MAX];

    for (uint32_t i = 0; i < l->look.nlook; i++) {
        const uint8_t *hash = l->hash + (size_t)i * MSG_HASH;

        path_of(s, hash, path);
        if (l->found[i] == 1)
            sounds_note(&s->sounds, hash, path);
        else if (l->found[i] == 0)
            remove_damaged(path);
    }
    s->handler->looked(s->arg, &l->look);
    free(l->found);
    free(l);
}

static struct look_task *
new_look(struct store *s, const struct action_look *from)
{
    size_t n = from->files.n, bytes = n * MSG_HASH;
    struct look_task *l =
        store_new_task(s, sizeof *l + bytes, look_run, look_done);

    l->found = memory_need(n + 1);
    memset(l->found, 0, n + 1);
    l->look = *from;
    if (n > 0)
        memcpy(l->hash, from->files.hash, bytes);
    l->look.files.hash = l->hash;
    return l;
}

bool
store_look(struct store *s, const struct action_look *from)
{
    struct look_task *l = new_look(s, from);
    char path[BLOBS_PATH_MAX];
    bool known = !s->cache;

    for (uint32_t i = 0; i < from->nlook; i++) {
        const uint8_t *hash = l->hash + (size_t)i * MSG_HASH;

        path_of(s, hash, path);
        if (sounds_known(&s->sounds, hash, path))
            l->found[i] = 2;
        else
            known = false;
    }
    if (!known) {
        task_push(&s->queue, &l->task);
        return false;
    }
    free(l->found);
    free(l);
    return true;
}

/* --- files of a worker's jobs --- */

struct cache_task {
    struct task task;
    uint64_t limit;
    uint8_t job[MSG_JOB];
};

static int
limit_run(struct task *t)
{
    struct cache_task *w = (struct cache_task *)t;

    cache_set_limit(store_of(t)->cache, w->limit);
    return 0;
}

int
store_limit(struct store *s, uint64_t bytes, struct rad_error *err)
{
    struct cache_task *w;

    if (!s->cache) {
        s->cache = cache_new(&s->blobs, bytes, err);
        return s->cache ? 0 : RAD_ENOMEM;
    }
    w = store_new_task(s, sizeof *w, limit_run, store_free_task);
    w->limit = bytes;
    task_push(&s->queue, &w->task);
    return 0;
}

static int
leave_run(struct task *t)
{
    struct cache_task *w = (struct cache_task *)t;

    cache_leave(store_of(t)->cache, w->job);
    return 0;
}

void
store_leave(struct store *s, const uint8_t job[MSG_JOB])
{
    struct cache_task *w =
        s->cache ? store_new_task(s, sizeof *w, leave_run, store_free_task)
                 : NULL;

    if (!w)
        return;
    memcpy(w->job, job, MSG_JOB);
    task_push(&s->queue, &w->task);
}

/* --- removing files that no job needs --- */

struct sweep_task {
    struct task task;
    uint8_t *hashes;
    size_t n;
    long age_s;
    unsigned removed;
};

static int
sweep_run(struct task *t)
{
    struct sweep_task *w = (struct sweep_task *)t;

    w->n = rad_sha_unique(w->hashes, w->n);
    w->removed = blobs_sweep(&store_of(t)->blobs, w->hashes, w->n, w->age_s);
    return 0;
}

static void
sweep_done(struct task *t)
{
    struct sweep_task *w = (struct sweep_task *)t;

    if (w->removed > 0)
        log_info("files removed n=%u: no job needs them", w->removed);
    free(w->hashes);
    free(w);
}

void
store_sweep(struct store *s, uint8_t *hashes, size_t n, long age_s)
{
    struct sweep_task *w = store_new_task(s, sizeof *w, sweep_run, sweep_done);

    w->hashes = hashes;
    w->n = n;
    w->age_s = age_s;
    task_push(&s->queue, &w->task);
}

const char *
store_files_dir(const struct store *s)
{
    return s->blobs.dir;
}

bool
store_check_file(struct store *s, const uint8_t hash[MSG_HASH])
{
    char name[RAD_SHA_HEX + 1], path[BLOBS_PATH_MAX];
    bool damaged, there;

    rad_sha_to_hex(hash, name);
    blobs_path(&s->blobs, name, path);
    there = sounds_check(&s->sounds, hash, path, &damaged);
    if (damaged)
        remove_damaged(path);
    if (there && s->handler->job) /* a coordinator's store, which sweeps by
                                   * these times */
        blobs_touch(&s->blobs, name);
    return there;
}
