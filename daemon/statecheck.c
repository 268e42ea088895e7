/* statecheck.c - see statecheck.h */
#include "config.h"

#include "statecheck.h"

#include "folder.h"
#include "journal.h"
#include "job.h"
#include "recover.h"
#include "rowcheck.h"
#include "service.h"
#include "sound.h"
#include "store.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
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

static void __attribute__((format(printf, 2, 3)))
problem(struct look *l, const char *fmt, ...)
{
    char text[600];
    va_list ap;

    va_start(ap, fmt);
    vsnprintf(text, sizeof text, fmt, ap);
    va_end(ap);
    l->out->problems++;
    l->tell(l->arg, true, text);
}

/* What is wrong with the folder is a problem that is told, and no failure; one
 * that another radcoord made is no damage. */
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
    problem(l, "%s", why->what);
    return 0;
}

static void
check_files(struct look *l, const struct msg_spec *spec, const char *hex)
{
    for (uint32_t i = 0; i < spec->files.n; i++) {
        const uint8_t *hash = spec->files.hash + (size_t)i * MSG_HASH;
        char name[RAD_SHA_HEX + 1], path[DISK_PATH_MAX];
        bool damaged;

        rad_sha_to_hex(hash, name);
        snprintf(path, sizeof path, "%s/files/%s", l->dir, name);
        if (!sounds_check(&l->sounds, hash, path, &damaged))
            problem(l, "job %s: file '%s' is %s", hex, path,
                    damaged ? "damaged: its hash is another" : "missing");
    }
}

static bool
no_file(void *arg, const uint8_t hash[MSG_HASH])
{
    (void)arg;
    (void)hash;
    return false;
}

static void
no_random(void *arg, void *buf, size_t n)
{
    (void)arg;
    memset(buf, 0, n);
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
    struct coord_env env = { .has_file = no_file,
                             .random = no_random,
                             .program = "check" };
    struct coord *c = coord_new(&env);

    s.units = units;
    if (!c || !units)
        rad_fail(err, RAD_ENOMEM, "out of memory");
    else if (rowcheck_job(&l->folder, saved, units, to_be_made, l, err) == 0)
        recover_job(c, 1, &s, read_row, l, err);
    coord_free(c);
    free(units);
}

static int
check_job(void *arg, const struct saved_job *s, struct rad_error *err)
{
    struct look *l = arg;
    struct rad_error why = { 0 };
    bool over = s->state >= JOB_DONE;
    char hex[MSG_JOB_HEX];

    msg_job_format(s->spec.job, hex);
    l->out->jobs++;
    l->out->open += !over;
    if (over && !folder_is_there(&l->folder, s->spec.job))
        return 0; /* it is being forgotten */
    if (!over)
        check_files(l, &s->spec, hex);
    folder_take_up(&l->folder, s, over, &why);
    if (why.code == 0 && !over)
        try_recovery(l, s, &why);
    return judge(l, &why, err);
}

static int
stranger(void *arg, const uint8_t job[MSG_JOB], struct rad_error *err)
{
    struct look *l = arg;
    char hex[MSG_JOB_HEX];

    (void)err;
    msg_job_format(job, hex);
    problem(l, "there is a folder of job %s, but no database", hex);
    return 0;
}

static int
look_at_jobs(struct look *l, const char *path, struct rad_error *err)
{
    struct rad_error why = { 0 };

    if (journal_open(&l->journal, path, JOURNAL_READ, &why) == 0 &&
        journal_check(l->journal, &why) == 0)
        journal_read(l->journal, check_job, l, &why);
    return judge(l, &why, err);
}

static int
look_around(struct look *l, struct rad_error *err)
{
    char path[DISK_PATH_MAX];

    if (snprintf(path, sizeof path, "%s/" STORE_DATABASE, l->dir) >=
            (int)sizeof path ||
        strlen(l->dir) >= sizeof l->folder.dir)
        return rad_fail(err, RAD_ENOINPUT, "path too long: '%s'", l->dir);
    memcpy(l->folder.dir, l->dir, strlen(l->dir) + 1);
    if (access(path, F_OK) == 0)
        return look_at_jobs(l, path, err);
    return folder_each(&l->folder, stranger, l, err);
}

/* Has a coordinator been there? */
static bool
is_state(const char *dir)
{
    static const char *const parts[] = { STORE_DATABASE, "jobs", "files" };
    char path[DISK_PATH_MAX];

    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        snprintf(path, sizeof path, "%s/%s", dir, parts[i]);
        if (access(path, F_OK) == 0)
            return true;
    }
    return false;
}

/* The lock, or an error. */
static int
take(const char *dir, struct rad_error *err)
{
    struct rad_error why = { 0 };
    struct stat st;
    int fd;

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
    fd = service_lock_dir(dir, &why);
    if (fd < 0)
        return rad_fail(err, RAD_ETEMPFAIL,
                        "%s: a running coordinator cannot be checked",
                        why.what);
    return fd;
}

int
statecheck_run(const char *dir, struct statecheck *out,
               void (*tell)(void *arg, bool problem, const char *text),
               void *arg, struct rad_error *err)
{
    struct look l = {
        .out = out, .tell = tell, .arg = arg, .dir = dir, .folder.durable = true
    };
    int lock = take(dir, err), rc;

    *out = (struct statecheck){ 0 };
    if (lock < 0)
        return lock;
    rc = look_around(&l, err);
    journal_close(l.journal);
    folder_release(&l.folder);
    sounds_release(&l.sounds);
    close(lock);
    return rc;
}
