/* store_recover.c - take up the jobs of earlier lives
 *
 * This comes before all requests, so it runs on the loop's thread, without
 * tasks.  The journal says which jobs there are.  Files of scenes are compared
 * with their hashes, rows with their noted sums, pictures with their noted
 * sizes.  If a file is lost or damaged the state folder is refused, for radd
 * cannot make the file again; but damaged rows are struck from the journal and
 * rendered again.  No file of a job is removed until all was found to be sound,
 * and then only what statedir.h says is to go. */
#include "config.h"

#include "store/store_impl.h"

#include "base/text.h"
#include "jobs/job.h"
#include "journal/statedir.h"
#include "net/log.h"
#include "folder/rowcheck.h"
#include "files/views.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The store and the caller, for the functions that recover a job. */
struct recovery {
    struct store *s;
    uint64_t now_ms;
    bool full; /* nothing of this is noted: the disk is full */
    journal_job_fn *fn;
    void *arg;
};

/* Are the files of a job's scene there and sound? */
static int
check_files(struct store *s, const struct msg_spec *spec, struct rad_error *err)
{
    int rc = 0;

    for (uint32_t i = 0; i < spec->files.n && rc == 0; i++) {
        const uint8_t *hash = spec->files.hash + (size_t)i * MSG_HASH;
        char path[BLOBS_PATH_MAX];

        path_of(s, hash, path);
        rc = sounds_require(&s->sounds, hash, path, err);
    }
    return rc;
}

/* Strike a unit's damaged rows from the journal; they will be rendered again.
 */
static int
drop_damaged(void *arg, const struct saved_job *saved,
             const struct saved_unit *unit, struct rad_error *err)
{
    struct store *s = arg;
    char hex[MSG_JOB_HEX];

    msg_job_format(saved->spec.job, hex);
    log_warn("rows damaged job=%s frame=%u unit=%u: they are made again", hex,
             unit->area.frame, unit->unit);
    return journal_put_rows(s->journal, saved->spec.job, unit, err);
}

/* Read the job's passes.  If the disk has lost them they are made again.  A
 * shortage of descriptors or memory may pass, so the start fails: what a check
 * pass decided cannot be made again. */
static int
read_passes(struct recovery *r, const uint8_t *job, struct saved_pass *passes,
            uint32_t *n, uint8_t **bytes, struct rad_error *err)
{
    struct rad_error why = { 0 };
    char hex[MSG_JOB_HEX];
    int rc = folder_read_passes(&r->s->folder, job, passes, n, bytes, &why);

    if (rc == RAD_ESHORT || rc == RAD_ENOMEM)
        return rad_fail(err, rc, "%s", why.what);
    msg_job_format(job, hex);
    if (rc < 0)
        log_warn("passes lost job=%s why=%s", hex, why.what);
    return 0;
}

/* Take up a job that is not over, with the rows that are sound. */
static int
recover_open(struct recovery *r, const struct saved_job *saved,
             struct rad_error *err)
{
    struct saved_unit *units = calloc(saved->nunits + 1, sizeof *units);
    struct saved_pass passes[MSG_MOST_PASSES];
    struct saved_job sound = *saved;
    uint8_t *cache = NULL;
    int rc;

    if (!units)
        return rad_fail_memory(err);
    sound.units = units;
    sound.passes = passes;
    sound.given_up = folder_is_given_up(&r->s->folder, saved->spec.job);
    rc = read_passes(r, saved->spec.job, passes, &sound.npasses, &cache, err);
    if (saved->spec.flags & MSG_JOB_REUSE && sound.npasses > 0)
        passes[0].bytes = NULL; /* another job's records: read when the first
                                 * worker is ready */
    if (rc == 0)
        rc = rowcheck_job(&r->s->folder, saved, units, drop_damaged, r->s, err);
    if (rc == 0)
        rc = r->fn(r->arg, &sound, err);
    free(cache);
    free(units);
    return rc;
}

/* Forget a job whose folder was being removed when the last life ended.  The
 * database may not know yet that the job is over: a job's end waits for the
 * commit, or for room on the disk, but the removal of its folder does not. */
static int
forget_now(struct recovery *r, const struct saved_job *saved,
           struct rad_error *err)
{
    struct saved_gone gone = { .why = GONE_BEFORE,
                               .end_ms = saved->end_ms,
                               .gone_ms = r->now_ms };

    memcpy(gone.job, saved->spec.job, MSG_JOB);
    snprintf(gone.owner, sizeof gone.owner, "%s", saved->owner);
    rad_text_print(gone.name, sizeof gone.name, "%s", saved->spec.name);
    return journal_forget(r->s->journal, &gone, err);
}

static int
recover_one(void *arg, const struct saved_job *saved, struct rad_error *err)
{
    struct recovery *r = arg;
    struct folder *folder = &r->s->folder;
    bool over = saved->state >= JOB_DONE;
    struct saved_job whole = *saved;
    struct views views = { 0 };
    int rc = 0;

    if (folder_is_going(folder, saved->spec.job))
        return forget_now(r, saved, err);
    if (!over)
        rc = check_files(r->s, &saved->spec, err);
    if (rc == 0)
        rc = views_read(&views, r->s->blobs.dir, &whole.spec, err);
    if (rc == 0)
        rc = folder_take_up(folder, &whole, over, err);
    if (over && whole.spec.flags & MSG_JOB_SCENE) {
        whole.cache_bytes = folder_cache_bytes(folder, whole.spec.job);
        whole.kept_bytes = folder_bytes(folder, whole.spec.job);
    }
    if (rc == 0)
        rc = over ? r->fn(r->arg, &whole, err) : recover_open(r, &whole, err);
    views_release(&views);
    return rc;
}

/* Check that the journal knows the folder's job, or that the folder is to go.
 */
static int
check_fate(void *arg, const uint8_t job[MSG_JOB], bool going,
           struct rad_error *err)
{
    struct store *s = arg;
    enum statedir_fate fate;
    int rc = statedir_fate(s->journal, &s->folder, job, going, &fate, err);

    return rc == 0 && fate == STATEDIR_UNKNOWN ? statedir_unknown(job, err)
                                               : rc;
}

/* After the commit: remove the folder, or the rest of its rows, if it is to go.
 * The name of one that goes stays while the database has the job. */
static int
tidy(void *arg, const uint8_t job[MSG_JOB], bool going, struct rad_error *err)
{
    const struct recovery *r = arg;
    struct store *s = r->s;
    enum statedir_fate fate;
    int rc = statedir_fate(s->journal, &s->folder, job, going, &fate, err);

    if (rc < 0 || (going && r->full))
        return rc;
    if (fate == STATEDIR_TO_GO) {
        while (!going && folder_forget(&s->folder, job))
            ;
        folder_forgotten(&s->folder, job);
    } else {
        folder_noted(&s->folder, job);
        if (!folder_is_open(&s->folder, job))
            folder_rest(&s->folder, job);
    }
    return 0;
}

int
store_begin_life(struct store *s, uint64_t *date_ms, uint64_t *epoch,
                 struct rad_error *err)
{
    struct rad_error why = { 0 };

    *epoch = *date_ms;
    if (s->journal && journal_begin_life(s->journal, date_ms, epoch, &why) < 0)
        return store_refuse(s, &why, err);
    s->begun_ms = *date_ms;
    return 0;
}

static int
life_run(struct task *t)
{
    struct store *s = store_of(t);
    uint64_t date_ms = s->begun_ms, epoch;

    return journal_begin_life(s->journal, &date_ms, &epoch, &t->err);
}

/* Commit what the recovery noted.  On a full disk this is undone, and the life
 * is noted as soon as there is room, before all else.  The rest the next life
 * finds again: which rows are damaged, which folders are to go. */
static int
commit(struct recovery *r, struct rad_error *err)
{
    struct rad_error why = { 0 };
    int rc = journal_commit(r->s->journal, &why);

    r->full = rc == RAD_EFULL;
    if (!r->full)
        return rc < 0 ? rad_fail(err, rc, "%s", why.what) : 0;
    log_warn("disk full, what was found is not noted why=%s", why.what);
    journal_rollback(r->s->journal);
    return 0;
}

/* From now on the journal is the pool thread's. */
static void
note_life(struct recovery *r)
{
    if (r->full)
        store_push_lasting(r->s, store_new_task(r->s, sizeof(struct task),
                                                life_run, store_free_task));
}

int
store_recover(struct store *s, uint64_t now_ms, store_job_fn *fn, void *arg,
              struct rad_error *err)
{
    struct recovery r = { .s = s, .now_ms = now_ms, .fn = fn, .arg = arg };
    struct rad_error why = { 0 };
    int rc = 0;

    if (!s->journal)
        return 0;
    if (s->handler->gone)
        rc = journal_read_gone(s->journal, s->handler->gone, s->arg, &why);
    if (rc == 0)
        rc = journal_read(s->journal, recover_one, &r, &why);
    if (rc == 0)
        rc = folder_each(&s->folder, check_fate, s, &why);
    if (rc == 0)
        rc = commit(&r, &why);
    if (rc == 0)
        rc = folder_each(&s->folder, tidy, &r, &why);
    if (rc < 0)
        return store_refuse(s, &why, err);
    note_life(&r);
    return 0;
}

int
store_read_drained(struct store *s, store_worker_fn *fn, void *arg,
                   struct rad_error *err)
{
    struct rad_error why = { 0 };

    if (!s->journal || journal_read_drained(s->journal, fn, arg, &why) == 0)
        return 0;
    return store_refuse(s, &why, err);
}

bool
store_read_row(struct store *s, const uint8_t job[MSG_JOB], uint32_t frame,
               uint32_t y, uint8_t *pixels)
{
    return folder_read_row(&s->folder, job, frame, y, pixels, NULL) == 0;
}
