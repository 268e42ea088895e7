/* keyorder.c - see keyorder.h
 *
 * A program that changes a key file holds a lock on it, so another one waits.
 * The new file is renamed over the old one, so a reader always finds a whole
 * file. */
#include "config.h"

#include "net/key/keyorder.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* --- changing a file --- */

/* A key file that is being changed. */
struct edit {
    struct keyfile file;
    const char *path; /* outlives the edit */
    char *real;       /* the file to replace, with symbolic links resolved */
    int fd;
};

/* Open and lock the file at path, links followed, and find its real name.
 * Tries again if another file was put there meanwhile. */
static int
open_locked(const char *path, bool make, char **real, struct rad_error *err)
{
    struct stat mine, there;

    for (;;) {
        int fd = open(
            path, O_RDWR | O_CLOEXEC | O_NONBLOCK | (make ? O_CREAT : 0), 0600);

        if (fd < 0)
            return rad_fail(err,
                            errno == EACCES ? RAD_EPERM
                            : make          ? RAD_ECANTCREAT
                                            : RAD_ENOINPUT,
                            "cannot open key file '%s': %s", path,
                            strerror(errno));
        *real = flock(fd, LOCK_EX) == 0 ? realpath(path, NULL) : NULL;
        if (*real && fstat(fd, &mine) == 0 && stat(*real, &there) == 0 &&
            mine.st_ino == there.st_ino && mine.st_dev == there.st_dev)
            return fd;
        free(*real);
        *real = NULL;
        close(fd);
    }
}

static void
edit_end(struct edit *e)
{
    if (e->fd >= 0)
        close(e->fd); /* also unlocks it */
    e->fd = -1;
    free(e->real);
    keyfile_release(&e->file);
}

/* Refuse a file with several names: under the others the old file would stay,
 * with its keys. */
static int
check_names(const struct edit *e, struct rad_error *err)
{
    struct stat st;

    if (fstat(e->fd, &st) == 0 && st.st_nlink == 1)
        return 0;
    return rad_fail(err, RAD_EPERM,
                    "key file '%s' has several names (hard links), and others "
                    "would keep it as it was: leave it one",
                    e->path);
}

static int
edit_begin(struct edit *e, const char *path, bool make, struct rad_error *err)
{
    int rc;

    keyfile_init(&e->file);
    e->path = path;
    e->real = NULL;
    e->fd = open_locked(path, make, &e->real, err);
    if (e->fd < 0)
        return e->fd;
    rc = keyfile_load_fd(&e->file, e->fd, path, err);
    if (rc == 0)
        rc = check_names(e, err);
    if (rc < 0)
        edit_end(e);
    return rc;
}

static bool
write_all(int fd, const char *p, size_t n)
{
    while (n > 0) {
        ssize_t put = write(fd, p, n);

        if (put < 0 && errno != EINTR)
            return false;
        if (put > 0) {
            p += put;
            n -= (size_t)put;
        }
    }
    return true;
}

/* Make a rename in the folder of path last. */
static bool
sync_folder(const char *path)
{
    char dir[4096];
    char *slash;
    bool ok;
    int fd;

    snprintf(dir, sizeof dir, "%s", path);
    slash = strrchr(dir, '/');
    if (!slash)
        strcpy(dir, ".");
    else
        slash[slash == dir] = '\0';
    fd = open(dir, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ok = fd >= 0 && fsync(fd) == 0;
    if (fd >= 0)
        close(fd);
    return ok;
}

/* Give the new file the old one's owner and group.  A group that cannot be set
 * does not matter, for the mode 0600 gives it no right. */
static bool
keep_owner(int fd, int before)
{
    struct stat st;

    if (fstat(before, &st) < 0 ||
        (st.st_uid != geteuid() && fchown(fd, st.st_uid, (gid_t)-1) < 0))
        return false;
    if (st.st_gid != getegid() && fchown(fd, (uid_t)-1, st.st_gid) < 0)
        return errno == EPERM;
    return true;
}

/* Replace the file by e->file.text: write a temporary file and rename it.
 * RAD_ECANTCREAT or RAD_EIO. */
static int
edit_write(struct edit *e, struct rad_error *err)
{
    char temp[4096];
    bool ok;
    int fd, n = snprintf(temp, sizeof temp, "%s.XXXXXX", e->real);

    if (n < 0 || (size_t)n >= sizeof temp)
        return rad_fail(err, RAD_ECANTCREAT, "path too long");
    fd = mkstemp(temp); /* with mode 0600 */
    if (fd < 0)
        return rad_fail(err, RAD_ECANTCREAT, "cannot create '%s': %s", temp,
                        strerror(errno));
    ok = write_all(fd, e->file.text, e->file.len) && keep_owner(fd, e->fd);
    ok = ok && fsync(fd) == 0;
    ok = close(fd) == 0 && ok;
    ok = ok && rename(temp, e->real) == 0 && sync_folder(e->real);
    if (ok)
        return 0;
    n = rad_fail(err, RAD_EIO, "cannot write '%s': %s", e->path,
                 strerror(errno));
    unlink(temp);
    return n;
}

/* --- answers --- */

/* The new key as JSON; names and dates need no escapes. */
static char *
added_json(const struct keyfile *f)
{
    char id[KEY_ID], line[KEY_LINE + 1], date[KEY_DATE], *text;
    const struct key *k = &f->v[f->n - 1];
    size_t room = sizeof id + sizeof line + sizeof date + 64;

    key_id(k, id);
    key_format(k, line);
    key_date_format(k->expires, date);
    text = malloc(room);
    if (text)
        snprintf(text, room,
                 "{ \"key\": \"%s\", \"line\": \"%s\", \"expires\": "
                 "\"%s\" }",
                 id, line, date);
    explicit_bzero(line, sizeof line);
    return text;
}

static char *
list_json(const struct keyfile *f, int64_t now)
{
    enum { ROW = KEY_ID + MSG_MAX_NAME + KEY_DATE + 128 };
    size_t room = f->n * ROW + 16, at = 0;
    char *text = malloc(room), id[KEY_ID], date[KEY_DATE];

    if (!text)
        return NULL;
    text[at++] = '[';
    for (size_t i = 0; i < f->n; i++) {
        const struct key *k = &f->v[i];

        key_id(k, id);
        key_date_format(k->expires, date);
        at += (size_t)snprintf(
            text + at, room - at,
            "%s\n { \"key\": \"%s\", \"role\": \"%s\", \"name\": \"%s\", "
            "\"state\": \"%s\", \"expires\": \"%s\" }",
            i ? "," : "", id, key_role_name(k->role), k->name,
            key_state_name(key_state(k, now)), date);
    }
    snprintf(text + at, room - at, "\n]");
    return text;
}

static char *
retired_json(int n)
{
    char *text = malloc(40);

    if (text)
        snprintf(text, 40, "{ \"retired\": %d }", n);
    return text;
}

/* --- orders --- */

static int
change(struct keyfile *f, const struct key_order *o, char **json,
       struct rad_error *err)
{
    int rc = o->what == MSG_KEY_ADD ? keyfile_add(f, o->name, o->expires, err)
                                    : keyfile_retire(f, o->name, err);

    if (rc >= 0)
        *json = o->what == MSG_KEY_ADD ? added_json(f) : retired_json(rc);
    return rc < 0 ? rc : 0;
}

int
key_order_check(const struct key_order *o, int64_t now, struct rad_error *err)
{
    struct key k;

    if (o->what == MSG_KEY_LIST)
        return 0;
    if (o->what == MSG_KEY_RETIRE)
        return key_which_parse(o->name, &k, err);
    if (key_date_is_past(o->expires, now))
        return rad_fail(err, RAD_EUSAGE,
                        "a key that has expired would never be taken: the time "
                        "of --expires is past");
    return key_name_parse(o->name, &k, err);
}

int
key_order_run(const char *path, const struct key_order *o, int64_t now,
              char **json, struct rad_error *err)
{
    struct edit e;
    struct keyfile f;
    int rc;

    *json = NULL;
    if ((rc = key_order_check(o, now, err)) < 0) /* before the file is made */
        return rc;
    if (o->what == MSG_KEY_LIST) {
        if ((rc = keyfile_load(&f, path, err)) < 0)
            return rc;
        *json = list_json(&f, now);
        keyfile_release(&f);
    } else {
        rc = edit_begin(&e, path, o->what == MSG_KEY_ADD && !o->in_use, err);
        if (rc < 0)
            return rc;
        rc = change(&e.file, o, json, err);
        if (rc == 0)
            rc = edit_write(&e, err);
        edit_end(&e);
    }
    if (rc == 0 && !*json)
        rc = rad_fail_memory(err);
    if (rc < 0) {
        free(*json);
        *json = NULL;
    }
    return rc;
}
