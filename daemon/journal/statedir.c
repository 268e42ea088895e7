/* statedir.c - see statedir.h */
#include "config.h"

#include "journal/statedir.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

int
statedir_check_mode(const char *dir, struct rad_error *err)
{
    struct stat st;

    if (stat(dir, &st) < 0)
        return disk_fail(err, errno, "look at", dir);
    if (!(st.st_mode & (S_IWGRP | S_IWOTH)))
        return 0;
    return rad_fail(err, RAD_EPERM,
                    "others may write to state folder '%s', of mode %04o: "
                    "chmod go-w",
                    dir, (unsigned)st.st_mode & 07777);
}

int
statedir_check_owner(const char *dir, struct rad_error *err)
{
    struct stat st;

    if (stat(dir, &st) < 0)
        return disk_fail(err, errno, "look at", dir);
    if (st.st_uid == geteuid())
        return statedir_check_mode(dir, err);
    return rad_fail(err, RAD_EPERM,
                    "state folder '%s' belongs to user %lu, and this is user "
                    "%lu: run radcoord as its owner",
                    dir, (unsigned long)st.st_uid, (unsigned long)geteuid());
}

/* --- is there a database, or was there? --- */

static int
note_job(void *arg, const uint8_t job[MSG_JOB], bool going,
         struct rad_error *err)
{
    char *what = arg;
    char hex[MSG_JOB_HEX];

    (void)going;
    (void)err;
    msg_job_format(job, hex);
    snprintf(what, 80, "a job %s", hex);
    return 1; /* a single job is enough: stop */
}

/* Set what to the name of something in the folder that must have had a
 * database: a job, a file of a scene or a log; "" if there is nothing. */
static int
find_remains(const char *dir, char what[80], struct rad_error *err)
{
    struct folder f = { .durable = true };
    char path[DISK_PATH_MAX];
    struct stat st;
    int rc;

    what[0] = '\0';
    snprintf(f.dir, sizeof f.dir, "%s", dir);
    rc = folder_each(&f, note_job, what, err);
    if (rc != 0)
        return rc < 0 ? rc : 0;
    snprintf(path, sizeof path, "%s/files", dir);
    if (blobs_any(path))
        strcpy(what, "a file of a scene");
    snprintf(path, sizeof path, "%s/" STATEDIR_DATABASE "-wal", dir);
    if (stat(path, &st) == 0 && st.st_size > 0)
        strcpy(what, "a database's log");
    return 0;
}

int
statedir_how(const char *dir, enum journal_how *how, struct rad_error *err)
{
    char path[DISK_PATH_MAX], what[80];
    struct stat st;
    bool there;
    int rc;

    *how = JOURNAL_OPEN;
    if (strlen(dir) >= BLOBS_DIR_MAX)
        return rad_fail(err, RAD_ENOINPUT, "path too long: '%s'", dir);
    snprintf(path, sizeof path, "%s/" STATEDIR_DATABASE, dir);
    there = stat(path, &st) == 0;
    if (!there && errno != ENOENT)
        return disk_fail(err, errno, "look at", path);
    if (there && st.st_size > 0 && !S_ISREG(st.st_mode))
        return rad_fail(err, RAD_EDATA, "'%s' is no file", path);
    if (there && access(path, R_OK) < 0)
        return disk_fail(err, errno, "open", path);
    rc = find_remains(dir, what, err);
    if (rc < 0)
        return rc;
    if (what[0] && !there)
        return rad_fail(err, RAD_EDATA, "there is %s, but no database", what);
    if (what[0] && st.st_size == 0)
        return rad_fail(err, RAD_EDATA,
                        "there is %s, but the database is empty", what);
    if (!what[0])
        *how = JOURNAL_MAKE;
    return 0;
}

/* --- folders of jobs --- */

int
statedir_fate(struct journal *j, const struct folder *f,
              const uint8_t job[MSG_JOB], bool going, enum statedir_fate *fate,
              struct rad_error *err)
{
    bool has = false, gone = false;
    int rc = journal_has(j, job, &has, err);

    if (rc == 0)
        rc = journal_has_gone(j, job, &gone, err);
    if (rc < 0)
        return rc;
    /* only forgetting a job makes ID.gone, maybe before the job is committed */
    if (going || (!has && (gone || folder_is_new(f, job))))
        *fate = STATEDIR_TO_GO;
    else if (has)
        *fate = STATEDIR_KNOWN;
    else
        *fate = STATEDIR_UNKNOWN;
    return 0;
}

int
statedir_unknown(const uint8_t job[MSG_JOB], struct rad_error *err)
{
    char hex[MSG_JOB_HEX];

    msg_job_format(job, hex);
    return rad_fail(err, RAD_EDATA,
                    "there is a job %s, but the database does not know it: "
                    "that is of before, or another's",
                    hex);
}
