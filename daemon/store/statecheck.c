/* statecheck.c - see statecheck.h */
#include "config.h"

#include "store/statecheck.h"

#include "folder/folder.h"
#include "journal/journal.h"
#include "jobs/job.h"
#include "front/coord.h"
#include "registry/recover.h"
#include "folder/rowcheck.h"
#include "ground/service.h"
#include "files/sound.h"
#include "journal/statedir.h"
#include "files/views.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

struct look {
    struct statecheck *out;
    void (*tell)(void *arg, bool problem, const char *text);
    void *arg;
    const char *dir;
    struct folder folder;
    struct sounds sounds;
    struct journal *journal;
};

/* What is wrong with the folder is told, and no failure; one that another
 * radcoord made is no damage. */
static int
judge(struct look *l, const struct rad_error *why, struct rad_error *err)
{
    if (why->code == 0)
        return 0;
    if (why->code == RAD_ENOMEM || why->code == RAD_ETEMPFAIL ||
        why->code == RAD_EUNSUPPORTED) {
        *err = *why;
        return why->code;
    }
    if (why->code == RAD_EPERM)
        l->out->denied++;
    else
        l->out->problems++;
    l->tell(l->arg, true, why->what);
    return 0;
}

static int
check_files(struct look *l, const struct msg_spec *spec, struct rad_error *err)
{
    int rc = 0;

    for (uint32_t i = 0; i < spec->files.n && rc == 0; i++) {
        const uint8_t *hash = spec->files.hash + (size_t)i * MSG_HASH;
        char name[RAD_SHA_HEX + 1], path[DISK_PATH_MAX];
        struct rad_error why = { 0 };

        rad_sha_to_hex(hash, name);
        snprintf(path, sizeof path, "%s/files/%s", l->dir, name);
        sounds_require(&l->sounds, hash, path, &why);
        rc = judge(l, &why, err);
    }
    return rc;
}

static bool
read_row(void *arg, const uint8_t job[MSG_JOB], uint32_t frame, uint32_t y,
         uint8_t *pixels)
{
    struct look *l = arg;

    return folder_read_row(&l->folder, job, frame, y, pixels, NULL) == 0;
}

/* No problem, since they can be made again; but a disk that spoils what is on
 * it is one to know of. */
static int
to_be_made(void *arg, const struct saved_job *s, const struct saved_unit *u,
           struct rad_error *err)
{
    struct look *l = arg;
    char hex[MSG_JOB_HEX], text[200];

    (void)err;
    msg_job_format(s->spec.job, hex);
    snprintf(text, sizeof text,
             "job %s: rows of frame %u, unit %u, are not what they were", hex,
             u->area.frame, u->unit);
    l->out->redo++;
    l->tell(l->arg, false, text);
    return 0;
}

/* Would a coordinator take it up? */
static void
try_recovery(struct look *l, const struct saved_job *saved,
             struct rad_error *err)
{
    struct saved_unit *units = calloc(saved->nunits + 1, sizeof *units);
    struct saved_job s = *saved;
    struct coord_env env = { .program = "check" };
    struct coord *c = coord_new(&env);

    s.units = units;
    if (!c || !units)
        rad_fail_memory(err);
    else if (rowcheck_job(&l->folder, saved, units, to_be_made, l, err) == 0)
        recover_job(c, 1, &s, read_row, l, err);
    coord_free(c);
    free(units);
}

static void
is_another(void *arg, const struct rad_error *why)
{
    struct rad_error ignored = { 0 }; /* no failure comes here */

    judge(arg, why, &ignored);
}

static int
check_job(void *arg, const struct saved_job *s, struct rad_error *err)
{
    struct look *l = arg;
    struct rad_error why = { 0 };
    struct saved_job whole = *s;
    struct views views = { 0 };
    bool over = s->state >= JOB_DONE;
    char files[DISK_PATH_MAX];
    int rc = 0;

    if (folder_is_going(&l->folder, s->spec.job))
        return 0; /* radcoord will forget it */
    l->out->jobs++;
    l->out->open += !over && !folder_is_given_up(&l->folder, s->spec.job);
    if (!over)
        rc = check_files(l, &s->spec, err);
    if (rc < 0)
        return rc;
    snprintf(files, sizeof files, "%s/files", l->dir);
    if (views_read(&views, files, &whole.spec, &why) == 0)
        folder_take_up(&l->folder, &whole, over, &why);
    /* of a folder that is no more its absence is the one problem */
    if (why.code != RAD_EPERM && folder_is_there(&l->folder, s->spec.job))
        rc = folder_compare(&l->folder, &whole, over, is_another, l, err);
    if (why.code == 0 && !over)
        try_recovery(l, &whole, &why);
    views_release(&views);
    return rc < 0 ? rc : judge(l, &why, err);
}

static int
check_fate(void *arg, const uint8_t job[MSG_JOB], bool going,
           struct rad_error *err)
{
    struct look *l = arg;
    struct rad_error why = { 0 };
    enum statedir_fate fate;
    int rc = statedir_fate(l->journal, &l->folder, job, going, &fate, &why);

    if (rc == 0 && fate == STATEDIR_UNKNOWN)
        statedir_unknown(job, &why);
    return judge(l, &why, err);
}

static int
look_at_jobs(struct look *l, enum journal_how how, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    struct rad_error why = { 0 };
    struct stat st;
    int rc = 0;

    snprintf(path, sizeof path, "%s/" STATEDIR_DATABASE, l->dir);
    if (how == JOURNAL_MAKE && (stat(path, &st) < 0 || st.st_size == 0))
        return 0; /* there is nothing at all */
    if (journal_open(&l->journal, path, JOURNAL_READ, &why) == 0 &&
        journal_check(l->journal, &why) == 0 &&
        journal_read(l->journal, check_job, l, &why) == 0)
        rc = folder_each(&l->folder, check_fate, l, &why);
    return rc < 0 && why.code == 0 ? rc : judge(l, &why, err);
}

static int
look_around(struct look *l, struct rad_error *err)
{
    enum journal_how how;
    struct rad_error why = { 0 };

    if (strlen(l->dir) >= sizeof l->folder.dir)
        return rad_fail(err, RAD_ENOINPUT, "path too long: '%s'", l->dir);
    memcpy(l->folder.dir, l->dir, strlen(l->dir) + 1);
    if (statedir_how(l->dir, &how, &why) < 0)
        return judge(l, &why, err);
    return look_at_jobs(l, how, err);
}

/* Has a coordinator been there? */
static bool
is_state(const char *dir)
{
    static const char *const parts[] = { STATEDIR_DATABASE, "jobs", "files" };
    char path[DISK_PATH_MAX];

    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        snprintf(path, sizeof path, "%s/%s", dir, parts[i]);
        if (access(path, F_OK) == 0)
            return true;
    }
    return false;
}

/* Hold the lock as long as *lock is open; -1: there is none, so no coordinator
 * runs. */
static int
take_lock(const char *dir, int *lock, struct rad_error *err)
{
    char path[DISK_PATH_MAX];
    struct rad_error why = { 0 };

    *lock = -1;
    snprintf(path, sizeof path, "%s/lock", dir);
    if (access(path, F_OK) < 0 && errno == ENOENT)
        return 0;
    *lock = service_lock_dir(dir, &why);
    if (*lock >= 0)
        return 0;
    if (why.code != RAD_ECANTCREAT)
        return rad_fail(err, why.code, "%s", why.what);
    return rad_fail(err, RAD_ETEMPFAIL,
                    "%s: a running coordinator cannot be checked", why.what);
}

static int
take(const char *dir, int *lock, struct rad_error *err)
{
    struct statvfs disk;
    struct stat st;

    if (stat(dir, &st) < 0 || !S_ISDIR(st.st_mode))
        return rad_fail(err, RAD_ENOINPUT, "'%s' is no folder", dir);
    if (access(dir, R_OK | X_OK) < 0)
        return rad_fail(err, RAD_EPERM,
                        "cannot look into '%s': %s: ask as root or as the user "
                        "that radcoord runs as",
                        dir, strerror(errno));
    if (!is_state(dir))
        return rad_fail(err, RAD_ENOINPUT,
                        "'%s' is no state folder: a coordinator would begin "
                        "an empty one there",
                        dir);
    if (statvfs(dir, &disk) == 0 && (disk.f_flag & ST_RDONLY))
        return rad_fail(err, RAD_EIO,
                        "'%s' is on a read-only file system, where SQLite does "
                        "not read the log of a database: check a copy of it",
                        dir);
    return take_lock(dir, lock, err);
}

int
statecheck_run(const char *dir, struct statecheck *out,
               void (*tell)(void *arg, bool problem, const char *text),
               void *arg, struct rad_error *err)
{
    struct look l = { .out = out,
                      .tell = tell,
                      .arg = arg,
                      .dir = dir,
                      .folder = { .durable = true, .looks = true } };
    struct rad_error why = { 0 };
    int lock = -1, rc = take(dir, &lock, err);

    *out = (struct statecheck){ 0 };
    if (rc < 0)
        return rc;
    statedir_check_mode(dir, &why);
    rc = judge(&l, &why, err);
    if (rc == 0)
        rc = look_around(&l, err);
    journal_close(l.journal);
    folder_release(&l.folder);
    sounds_release(&l.sounds);
    if (lock >= 0)
        close(lock);
    return rc;
}
