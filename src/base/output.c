/* output.c - see output.h */
#include "config.h"

#include "base/output.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <libgen.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void
rad_output_guard(void)
{
    signal(SIGXFSZ, SIG_IGN);
    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
        if (fcntl(fd, F_GETFD) < 0) /* so open() returns this number */
            (void)!open("/dev/null", fd == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

static int
cannot_create(const char *path, const char *why, struct rad_error *err)
{
    return rad_fail(err, RAD_ECANTCREAT, "cannot create '%s': %s", path, why);
}

/* The folder that path's file is made in; the caller frees it. */
static char *
folder_of(const char *path)
{
    char *copy = strdup(path), *folder = NULL;

    if (copy)
        folder = strdup(dirname(copy));
    free(copy);
    return folder;
}

/* The number of the descriptor of ours that path names, or -1.  It may be open
 * on a file, but somebody else has begun to write there. */
static int
own_descriptor(const char *path)
{
    static const char *const folders[] = { "/dev/fd/", "/proc/self/fd/" };

    if (strcmp(path, "/dev/stdout") == 0)
        return STDOUT_FILENO;
    if (strcmp(path, "/dev/stderr") == 0)
        return STDERR_FILENO;
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        size_t n = strlen(folders[i]), digits;

        if (strncmp(path, folders[i], n) != 0)
            continue;
        digits = strspn(path + n, "0123456789");
        if (digits > 0 && digits < 9 && path[n + digits] == '\0')
            return atoi(path + n);
    }
    return -1;
}

/* The target of the link at `name`, relative to where `name` is; NULL: it is no
 * link.  The caller frees it. */
static char *
read_link(const char *name)
{
    char to[PATH_MAX], *folder, *path = NULL;
    ssize_t n = readlink(name, to, sizeof to - 1);

    if (n < 0)
        return NULL;
    to[n] = '\0';
    if (to[0] == '/')
        return strdup(to);
    folder = folder_of(name);
    if (folder && asprintf(&path, "%s/%s", folder, to) < 0)
        path = NULL;
    free(folder);
    return path;
}

/* The name to write or replace: path with all links followed, maybe to a file
 * that does not exist.  The caller frees it. */
static char *
real_name(const char *path)
{
    enum { MOST_LINKS = 40 }; /* the kernel's own limit */
    char *name = strdup(path), *to;

    for (int i = 0; name && i < MOST_LINKS && own_descriptor(name) < 0; i++) {
        to = read_link(name);
        if (!to)
            break;
        free(name);
        name = to;
    }
    return name;
}

/* Is the name, all links followed, something to write to directly: a
 * descriptor, a terminal, a pipe? */
static bool
in_place(const char *real)
{
    struct stat st;

    return own_descriptor(real) >= 0 ||
           (stat(real, &st) == 0 && !S_ISREG(st.st_mode));
}

static int
check_folder(const char *path, struct rad_error *err)
{
    char *folder = folder_of(path);
    struct stat st;
    int rc = 0;

    if (!folder)
        return rad_fail_memory(err);
    if (stat(folder, &st) != 0)
        rc = cannot_create(
            path, errno == ENOENT ? "no such folder" : strerror(errno), err);
    else if (!S_ISDIR(st.st_mode))
        rc = cannot_create(path, "its folder is a file", err);
    else if (access(folder, W_OK | X_OK) != 0)
        rc = cannot_create(path, strerror(errno), err);
    free(folder);
    return rc;
}

int
rad_output_check(const char *path, struct rad_error *err)
{
    struct stat st;
    char *real;
    bool there;
    int rc = 0;

    if (path[0] == '\0' || path[strlen(path) - 1] == '/')
        return cannot_create(path, "not a file's name", err);
    there = stat(path, &st) == 0;
    if (!there && (errno == ELOOP || errno == ENAMETOOLONG))
        return cannot_create(path, strerror(errno), err);
    if (there && S_ISDIR(st.st_mode))
        return cannot_create(path, "is a folder", err);
    if (there && access(path, W_OK) != 0)
        return cannot_create(path, strerror(errno), err);
    real = real_name(path);
    if (!real)
        return rad_fail_memory(err);
    if (!in_place(real))
        rc = check_folder(real, err);
    free(real);
    return rc;
}

/* The absolute name of a file that need not exist; NULL if its folder does not.
 * The caller frees it. */
static char *
full_name(const char *path)
{
    char *real = realpath(path, NULL), *name, *folder, *base;
    const char *slash;

    if (real)
        return real;
    name = real_name(path);
    folder = name ? folder_of(name) : NULL;
    base = folder ? realpath(folder, NULL) : NULL;
    slash = name ? strrchr(name, '/') : NULL;
    if (base && asprintf(&real, "%s/%s", base, slash ? slash + 1 : name) < 0)
        real = NULL;
    free(base);
    free(folder);
    free(name);
    return real;
}

bool
rad_output_in_place(const char *path)
{
    char *real = path ? real_name(path) : NULL;
    bool direct = !path || (real && in_place(real));

    free(real);
    return direct;
}

bool
rad_output_same(const char *a, const char *b)
{
    char *fa, *fb;
    bool same;

    if (rad_output_in_place(a) || rad_output_in_place(b))
        return false;
    fa = full_name(a);
    fb = full_name(b);
    same = fa && fb && strcmp(fa, fb) == 0;
    free(fa);
    free(fb);
    return same;
}

/* Give the new file the owner, group and mode of the file that it replaces.  If
 * the group cannot be kept, the group gets no permissions. */
static void
keep_mode(int fd, const char *real)
{
    mode_t mask = umask(0), mode = 0666 & ~mask;
    struct stat st;

    umask(mask);
    if (stat(real, &st) == 0) {
        mode = st.st_mode & 0777;
        if (fchown(fd, st.st_uid, st.st_gid) != 0 &&
            fchown(fd, (uid_t)-1, st.st_gid) != 0)
            mode &= ~(mode_t)070;
    }
    fchmod(fd, mode);
}

/* The pattern of temporary names beside a file; a name near the limit is cut to
 * make room.  The caller frees it. */
static char *
temp_name(const char *real)
{
    static const char suffix[] = ".XXXXXX";
    const char *slash = strrchr(real, '/'), *base = slash ? slash + 1 : real;
    size_t kept = strnlen(base, NAME_MAX - (sizeof suffix - 1));
    char *temp;
    int n = asprintf(&temp, "%.*s%s", (int)((size_t)(base - real) + kept), real,
                     suffix);

    return n < 0 ? NULL : temp;
}

static int
open_temp(struct rad_output *out, struct rad_error *err)
{
    int fd;

    out->temp = temp_name(out->real);
    if (!out->temp)
        return rad_fail_memory(err);
    fd = mkstemp(out->temp);
    if (fd < 0) {
        free(out->temp);
        out->temp = NULL;
        return cannot_create(out->path, strerror(errno), err);
    }
    keep_mode(fd, out->real);
    out->file = fdopen(fd, "wb");
    if (!out->file) {
        close(fd);
        return rad_fail_memory(err);
    }
    return 0;
}

/* Open without truncating: a descriptor is written on from where it stands. */
static int
open_in_place(struct rad_output *out, struct rad_error *err)
{
    int own = own_descriptor(out->real);
    int fd = own >= 0 ? dup(own) : open(out->real, O_WRONLY | O_CLOEXEC);

    out->file = fd >= 0 ? fdopen(fd, "wb") : NULL;
    if (out->file)
        return 0;
    if (fd >= 0)
        close(fd);
    return cannot_create(out->path, strerror(errno), err);
}

int
rad_output_open(struct rad_output *out, const char *path, bool durable,
                struct rad_error *err)
{
    int rc = 0;

    memset(out, 0, sizeof *out);
    out->durable = durable;
    if (!path) {
        out->file = stdout;
        return 0;
    }
    out->path = strdup(path);
    out->real = real_name(path);
    if (!out->path || !out->real)
        rc = rad_fail_memory(err);
    else if (in_place(out->real))
        rc = open_in_place(out, err);
    else
        rc = open_temp(out, err);
    if (rc < 0)
        rad_output_abort(out);
    return rc;
}

static void
release(struct rad_output *out)
{
    free(out->path);
    free(out->real);
    free(out->temp);
    memset(out, 0, sizeof *out);
}

int
rad_output_commit(struct rad_output *out, struct rad_error *err)
{
    int bad = fflush(out->file) != 0 || ferror(out->file);

    if (out->file != stdout) {
        if (out->durable && out->temp && !bad)
            bad = fsync(fileno(out->file)) != 0;
        bad |= fclose(out->file) != 0;
        out->file = NULL;
    }
    if (!bad && out->temp && rename(out->temp, out->real) != 0)
        bad = 1;
    if (bad) {
        rad_fail(err, RAD_EIO, "cannot write '%s': %s",
                 out->path ? out->path : "standard output", strerror(errno));
        rad_output_abort(out);
        return RAD_EIO;
    }
    release(out);
    return 0;
}

void
rad_output_abort(struct rad_output *out)
{
    if (out->file && out->file != stdout)
        fclose(out->file);
    if (out->temp)
        unlink(out->temp);
    release(out);
}

int
rad_output_write(const char *path, const void *bytes, size_t n, bool durable,
                 struct rad_error *err)
{
    struct rad_output out;
    int rc = rad_output_open(&out, path, durable, err);

    if (rc < 0)
        return rc;
    if (n > 0) /* a failure is reported by the commit */
        (void)!fwrite(bytes, 1, n, out.file);
    return rad_output_commit(&out, err);
}

int
rad_make_dir(const char *path, int mode, struct rad_error *err)
{
    char part[PATH_MAX];
    size_t n = strlen(path);

    if (n == 0 || n >= sizeof part)
        return rad_fail(err, RAD_ECANTCREAT, "bad folder name '%s'", path);
    memcpy(part, path, n + 1);
    for (char *p = part + 1;; p++) {
        char c = *p;
        struct stat st;

        if (c != '/' && c != '\0')
            continue;
        *p = '\0';
        if (mkdir(part, c ? 0755 : (mode_t)mode) < 0 && errno != EEXIST)
            return rad_fail(err, RAD_ECANTCREAT, "cannot make folder '%s': %s",
                            part, strerror(errno));
        if (stat(part, &st) < 0 || !S_ISDIR(st.st_mode))
            return rad_fail(err, RAD_ECANTCREAT, "'%s' is no folder", part);
        if (c == '\0')
            return 0;
        *p = c;
    }
}

static int
remove_entry(const char *path, const struct stat *st, int flag, struct FTW *f)
{
    (void)st;
    (void)flag;
    (void)f;
    remove(path);
    return 0;
}

void
rad_remove_dir(const char *path)
{
    nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}
