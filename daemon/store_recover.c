/* store_recover.c - jobs of earlier lives are taken up
 *
 * Before anything else, so on the loop's thread and without tasks.  The journal
 * says what there is; each job's scene and rows are held against what is noted
 * of them.  A scene that is gone or damaged is an error, for the job cannot go
 * on; rows that are damaged are struck, and made again.  Folders that the
 * journal does not know are of jobs that nobody was told are accepted: they go.
 */
#include "config.h"

#include "store_impl.h"

#include "job.h"
#include "log.h"
#include "rowcheck.h"

#include <stdlib.h>

/* All that is needed of the store while it recovers. */
struct recovery {
    struct store *s;
    journal_job_fn *fn;
    void *arg;
};

/* Its scene is there, and is what it was. */
static int
check_files(struct store *s, const struct msg_spec *spec, struct rad_error *err)
{
    for (uint32_t i = 0; i < spec->files.n; i++) {
        const uint8_t *hash = spec->files.hash + (size_t)i * MSG_HASH;
        char path[BLOBS_PATH_MAX];
        bool damaged;

        path_of(s, hash, path);
        if (!sounds_check(&s->sounds, hash, path, &damaged))
            return rad_fail(err, RAD_EDATA, "file '%s' is %s", path,
                            damaged ? "damaged" : "missing");
    }
    return 0;
}

/* Rows that are not what they were are made again. */
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

/* One that goes on, as far as its rows are sound. */
static int
recover_open(struct recovery *r, const struct saved_job *saved,
             struct rad_error *err)
{
    struct saved_unit *units = calloc(saved->nunits + 1, sizeof *units);
    struct saved_job sound = *saved;
    int rc;

    if (!units)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    sound.units = units;
    rc = rowcheck_job(&r->s->folder, saved, units, drop_damaged, r->s, err);
    if (rc == 0)
        rc = r->fn(r->arg, &sound, err);
    free(units);
    return rc;
}

static int
recover_one(void *arg, const struct saved_job *saved, struct rad_error *err)
{
    struct recovery *r = arg;
    bool over = saved->state >= JOB_DONE;
    int rc = 0;

    if (over && !folder_is_there(&r->s->folder, saved->spec.job)) {
        /* it was being forgotten */
        return journal_forget(r->s->journal, saved->spec.job, err);
    }
    if (!over)
        rc = check_files(r->s, &saved->spec, err);
    if (rc == 0)
        rc = folder_take_up(&r->s->folder, saved, over, err);
    if (rc == 0 && over)
        folder_rest(&r->s->folder, saved->spec.job);
    if (rc == 0 && !over)
        return recover_open(r, saved, err);
    return rc == 0 ? r->fn(r->arg, saved, err) : rc;
}

/* One that nobody was told is accepted. */
static int
drop_unknown(void *arg, const uint8_t job[MSG_JOB], struct rad_error *err)
{
    struct store *s = arg;
    bool has;
    int rc = journal_has(s->journal, job, &has, err);

    if (rc == 0 && !has)
        folder_forget(&s->folder, job);
    return rc;
}

int
store_recover(struct store *s, uint64_t now_ms, uint64_t *epoch,
              store_job_fn *fn, void *arg, struct rad_error *err)
{
    struct recovery r = { s, fn, arg };
    struct rad_error why = { 0 };
    int rc;

    *epoch = now_ms;
    if (!s->journal)
        return 0;
    rc = journal_begin_life(s->journal, now_ms, epoch, &why);
    if (rc == 0)
        rc = journal_read(s->journal, recover_one, &r, &why);
    if (rc == 0)
        rc = journal_take_over(s->journal, &why);
    if (rc == 0)
        rc = journal_commit(s->journal, &why);
    if (rc == 0)
        rc = folder_each(&s->folder, drop_unknown, s, &why);
    return rc == 0 ? 0 : store_refuse(s, &why, err);
}

bool
store_read_row(struct store *s, const uint8_t job[MSG_JOB], uint32_t frame,
               uint32_t y, uint8_t *pixels)
{
    return folder_read_row(&s->folder, job, frame, y, pixels, NULL) == 0;
}
