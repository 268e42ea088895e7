/* disaster.c - what may befall a process that keeps things on a disk
 *
 * A shared object for LD_PRELOAD, so that what is installed knows nothing of
 * it.  It counts what a process does to files below a folder, what it sends
 * over sockets and what it allocates once it listens, and at one of these
 * something happens:
 *
 *   DISASTER=KIND:N:WHAT   KIND  write, sync, name (rename, create, remove),
 *                                send, alloc
 *                          N     the n-th of that kind, from 1; with WHAT fail
 *                                and full also N+: from the n-th on
 *                          WHAT  before, after: SIGKILL before or after it
 *                                power: SIGKILL before it, and what was not
 *                                synced is not on the disk: pieces of files are
 *                                as they were, names that their folder's sync
 *                                did not cover are gone or back
 *                          bytes the same, but all names are as they were last
 *                                fail: it fails (EIO, ENOMEM)
 *                                full: it fails (ENOSPC)
 *   DISASTER_DIR           the folder, an absolute path
 *   DISASTER_LOG           a file that gets a line when it happens
 *   DISASTER_COUNT         a file that gets the counts at each step
 *   DISASTER_ROOM          a file: as long as it is there, the disk is full
 *   DISASTER_SLEPT         a file: how many seconds the machine has slept
 *   DISASTER_CLOCK         a file: how many seconds the system's clock is ahead
 *   DISASTER_EARLY         any: what the process allocates before it listens
 *                          counts as well
 *
 * Programs that write through stdio are not seen. */
#include "config.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

enum kind { WRITE, SYNC, NAME, SEND, ALLOC, NKIND };
static const char *const kinds[NKIND] = { "write", "sync", "name", "send",
                                          "alloc" };

enum what { NOTHING, BEFORE, AFTER, POWER, BYTES, FAIL, FULL };
static const char *const whats[] = { "nothing", "before", "after", "power",
                                     "bytes",   "fail",   "full" };

extern void *__libc_malloc(size_t n);
extern void *__libc_calloc(size_t n, size_t size);
extern void *__libc_realloc(void *p, size_t n);

static pthread_mutex_t mu = PTHREAD_MUTEX_INITIALIZER;
static bool ready, listening, dead;
static enum kind at_kind;
static unsigned long at, count[NKIND];
static bool onwards;
static enum what what;
static const char *dir, *room, *log_path, *count_path;

/* --- set-up --- */

static void
set_up(void)
{
    const char *text = getenv("DISASTER"), *end;
    char *rest;

    ready = true;
    dir = getenv("DISASTER_DIR");
    room = getenv("DISASTER_ROOM");
    log_path = getenv("DISASTER_LOG");
    count_path = getenv("DISASTER_COUNT");
    end = text ? strchr(text, ':') : NULL;
    if (!end)
        return;
    for (int i = 0; i < NKIND; i++)
        if (strncmp(text, kinds[i], (size_t)(end - text)) == 0)
            at_kind = (enum kind)i;
    at = strtoul(end + 1, &rest, 10);
    onwards = *rest == '+';
    rest += onwards;
    for (int i = 0; i <= FULL && *rest == ':'; i++)
        if (strcmp(rest + 1, whats[i]) == 0)
            what = (enum what)i;
}

/* Not in set_up(), which may first run in an allocation. */
__attribute__((constructor)) static void
begin_early(void)
{
    if (!getenv("DISASTER_EARLY"))
        return;
    set_up();
    listening = true;
}

static void *
real(const char *name)
{
    void *fn = dlsym(RTLD_NEXT, name);

    if (!fn)
        abort();
    return fn;
}

/* A line into a file, without stdio or the functions of this file. */
static void
note(const char *path, int flags, const char *text)
{
    int fd = path ? (int)syscall(SYS_openat, AT_FDCWD, path,
                                 O_WRONLY | O_CREAT | flags, 0644)
                  : -1;

    if (fd < 0)
        return;
    if (syscall(SYS_write, fd, text, strlen(text)) < 0)
        abort();
    close(fd);
}

/* --- what is not synced --- */

/* How one thing is undone; the newest first. */
struct undo {
    struct undo *older;
    enum { OLD_BYTES, OLD_SIZE, NO_FILE, NO_DIR, OLD_NAME, OLD_FILE } how;
    dev_t dev; /* of what must be synced: the file, or the folder */
    ino_t ino;
    char path[PATH_MAX], other[PATH_MAX];
    off_t offset;
    size_t n;
    char *bytes;
};
static struct undo *undos;
static unsigned backups;

static struct undo *
add_undo(const char *path)
{
    struct undo *u = __libc_calloc(1, sizeof *u);

    if (!u)
        abort();
    snprintf(u->path, sizeof u->path, "%s", path);
    u->older = undos;
    undos = u;
    return u;
}

/* Is what was not synced lost? */
static bool
loses(void)
{
    return what == POWER || what == BYTES;
}

/* What lay at a path, or below it, lies at another now, for good. */
static void
move_undos(const char *from, const char *to)
{
    size_t n = strlen(from);
    char path[2 * PATH_MAX];

    for (struct undo *u = undos; u; u = u->older)
        if (strncmp(u->path, from, n) == 0 &&
            (u->path[n] == '\0' || u->path[n] == '/')) {
            snprintf(path, sizeof path, "%s%s", to, u->path + n);
            snprintf(u->path, sizeof u->path, "%.*s", PATH_MAX - 1, path);
        }
}

static void
set_folder(struct undo *u, const char *path)
{
    char folder[PATH_MAX];
    struct stat st;

    snprintf(folder, sizeof folder, "%s", path);
    *strrchr(folder, '/') = '\0';
    if (stat(folder, &st) == 0) {
        u->dev = st.st_dev;
        u->ino = st.st_ino;
    }
}

/* The bytes that a write goes over. */
static void
keep_bytes(int fd, const char *path, off_t offset, size_t n)
{
    struct undo *u = add_undo(path);
    struct stat st;
    ssize_t got;

    u->how = OLD_BYTES;
    fstat(fd, &st);
    u->dev = st.st_dev;
    u->ino = st.st_ino;
    u->offset = offset;
    u->bytes = __libc_malloc(n + 1);
    fd = (int)syscall(SYS_openat, AT_FDCWD, path, O_RDONLY, 0);
    got = fd >= 0 && u->bytes
              ? syscall(SYS_pread64, fd, u->bytes, n, (long)offset)
              : 0;
    if (fd >= 0)
        close(fd);
    u->n = got > 0 ? (size_t)got : 0;
    u = add_undo(path);
    u->how = OLD_SIZE;
    u->dev = st.st_dev;
    u->ino = st.st_ino;
    u->offset = st.st_size;
}

static void
forget_undos(int fd)
{
    struct stat st;

    if (fstat(fd, &st) < 0)
        return;
    for (struct undo **at_undo = &undos; *at_undo;) {
        struct undo *u = *at_undo;

        if (u->dev == st.st_dev && u->ino == st.st_ino) {
            if (u->how == OLD_FILE)
                syscall(SYS_unlinkat, AT_FDCWD, u->other, 0);
            *at_undo = u->older;
            free(u->bytes);
            free(u);
        } else {
            at_undo = &u->older;
        }
    }
}

static void
undo(const struct undo *u)
{
    struct stat st;
    int fd;

    switch (u->how) {
    case OLD_BYTES:
    case OLD_SIZE:
        fd = (int)syscall(SYS_openat, AT_FDCWD, u->path, O_WRONLY, 0);
        if (fd < 0)
            return;
        if (fstat(fd, &st) < 0 || st.st_ino != u->ino) { /* another file */
            close(fd);
            return;
        }
        if (u->how == OLD_SIZE ? syscall(SYS_ftruncate, fd, (long)u->offset) < 0
                               : syscall(SYS_pwrite64, fd, u->bytes, u->n,
                                         (long)u->offset) < 0)
            abort();
        close(fd);
        break;
    case NO_FILE:
        syscall(SYS_unlinkat, AT_FDCWD, u->path, 0);
        break;
    case NO_DIR:
        syscall(SYS_unlinkat, AT_FDCWD, u->path, AT_REMOVEDIR);
        break;
    case OLD_NAME:
    case OLD_FILE:
        syscall(SYS_renameat, AT_FDCWD, u->other, AT_FDCWD, u->path);
        break;
    }
}

/* --- disasters --- */

static _Noreturn void
die(enum kind kind, const char *path)
{
    char text[PATH_MAX + 100];

    dead = true;
    if (loses())
        for (struct undo *u = undos; u; u = u->older)
            undo(u);
    snprintf(text, sizeof text, "%s %lu %s %s\n", kinds[kind], at, whats[what],
             path);
    note(log_path, O_APPEND, text);
    kill(getpid(), SIGKILL);
    for (;;)
        pause();
}

/* Count one; 0, or the errno that it fails with.  The lock is held, and is
 * given back with done(). */
static int
begin(enum kind kind, const char *path)
{
    bool now;
    char text[200];

    pthread_mutex_lock(&mu);
    if (!ready)
        set_up();
    if (kind == ALLOC && !listening)
        return 0;
    count[kind]++;
    if (count_path && kind != ALLOC) {
        snprintf(text, sizeof text,
                 "write %lu\nsync %lu\nname %lu\nsend %lu\n"
                 "alloc %lu\n",
                 count[WRITE], count[SYNC], count[NAME], count[SEND],
                 count[ALLOC]);
        note(count_path, O_TRUNC, text);
    }
    if (room && (kind == WRITE || kind == NAME) && access(room, F_OK) == 0)
        return ENOSPC;
    now = kind == at_kind && what != NOTHING &&
          (count[kind] == at || (onwards && count[kind] >= at));
    if (!now)
        return 0;
    if (what == BEFORE || loses())
        die(kind, path);
    if (what == FAIL || what == FULL) {
        snprintf(text, sizeof text, "%s %lu %s %.100s\n", kinds[kind],
                 count[kind], whats[what], path);
        note(log_path, O_APPEND, text);
        return what == FULL ? ENOSPC : kind == ALLOC ? ENOMEM : EIO;
    }
    return 0;
}

static void
done(enum kind kind, const char *path)
{
    if (what == AFTER && kind == at_kind && count[kind] == at)
        die(kind, path);
    pthread_mutex_unlock(&mu);
}

static int
fail(int number)
{
    pthread_mutex_unlock(&mu);
    errno = number;
    return -1;
}

/* The path of a regular file, or folder, below the folder that counts. */
static bool
is_ours(int fd, char path[PATH_MAX])
{
    char link[64];
    ssize_t n;

    if (!ready)
        set_up();
    if (!dir || dead)
        return false;
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    n = readlink(link, path, PATH_MAX - 1);
    if (n < 0)
        return false;
    path[n] = '\0';
    return strncmp(path, dir, strlen(dir)) == 0;
}

static bool
is_below(const char *path)
{
    if (!ready)
        set_up();
    return dir && !dead && strncmp(path, dir, strlen(dir)) == 0;
}

static bool
is_socket(int fd)
{
    int type;
    socklen_t n = sizeof type;

    return !dead && listening &&
           getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &n) == 0;
}

/* --- writing --- */

ssize_t
pwrite64(int fd, const void *data, size_t n, off64_t offset)
{
    char path[PATH_MAX];
    ssize_t put;
    int number;

    if (!is_ours(fd, path))
        return syscall(SYS_pwrite64, fd, data, n, offset);
    number = begin(WRITE, path);
    if (number)
        return fail(number);
    if (loses())
        keep_bytes(fd, path, offset, n);
    put = syscall(SYS_pwrite64, fd, data, n, offset);
    done(WRITE, path);
    return put;
}

ssize_t
pwrite(int fd, const void *data, size_t n, off_t offset)
{
    return pwrite64(fd, data, n, offset);
}

static ssize_t
send_some(int fd, const struct iovec *v, int nv)
{
    int number = begin(SEND, "socket");
    ssize_t put;

    if (number)
        return fail(number);
    put = syscall(SYS_writev, fd, v, nv);
    done(SEND, "socket");
    return put;
}

ssize_t
write(int fd, const void *data, size_t n)
{
    char path[PATH_MAX];
    struct iovec v = { (void *)(uintptr_t)data, n };

    if (is_ours(fd, path))
        return pwrite64(fd, data, n, lseek(fd, (off_t)n, SEEK_CUR) - (off_t)n);
    return is_socket(fd) ? send_some(fd, &v, 1)
                         : syscall(SYS_write, fd, data, n);
}

ssize_t
writev(int fd, const struct iovec *v, int n)
{
    return is_socket(fd) ? send_some(fd, v, n) : syscall(SYS_writev, fd, v, n);
}

static int
resize(int fd, off_t size, bool grow)
{
    char path[PATH_MAX];
    struct undo *u;
    struct stat st;
    int number;
    long rc;

    if (!is_ours(fd, path))
        return grow ? (int)syscall(SYS_fallocate, fd, 0, 0L, (long)size)
                    : (int)syscall(SYS_ftruncate, fd, (long)size);
    number = begin(WRITE, path);
    if (number)
        return fail(number);
    if (loses() && fstat(fd, &st) == 0) {
        u = add_undo(path);
        u->how = OLD_SIZE;
        u->dev = st.st_dev;
        u->ino = st.st_ino;
        u->offset = st.st_size;
    }
    rc = grow ? syscall(SYS_fallocate, fd, 0, 0L, (long)size)
              : syscall(SYS_ftruncate, fd, (long)size);
    done(WRITE, path);
    return (int)rc;
}

int
ftruncate64(int fd, off64_t size)
{
    return resize(fd, size, false);
}

int
ftruncate(int fd, off_t size)
{
    return resize(fd, size, false);
}

int
posix_fallocate64(int fd, off64_t offset, off64_t n)
{
    return resize(fd, offset + n, true) < 0 ? errno : 0;
}

int
posix_fallocate(int fd, off_t offset, off_t n)
{
    return posix_fallocate64(fd, offset, n);
}

int
fallocate(int fd, int mode, off_t offset, off_t n)
{
    return mode == 0 ? resize(fd, offset + n, true)
                     : (int)syscall(SYS_fallocate, fd, mode, offset, n);
}

/* --- syncing --- */

static int
sync_with(int fd, long number_of_call)
{
    char path[PATH_MAX];
    int number;
    long rc;

    if (!is_ours(fd, path))
        return (int)syscall(number_of_call, fd);
    number = begin(SYNC, path);
    if (number)
        return fail(number);
    rc = 0; /* no power is lost here: the system need not wait */
    if (loses())
        forget_undos(fd);
    done(SYNC, path);
    return (int)rc;
}

int
fsync(int fd)
{
    return sync_with(fd, SYS_fsync);
}

int
fdatasync(int fd)
{
    return sync_with(fd, SYS_fdatasync);
}

/* --- names --- */

/* Change a name by a call of four arguments.  How it is undone without power,
 * at that path; `to` is the name that is new. */
static int
change_name(int how, const char *path, const char *to, long call,
            const long arg[4])
{
    int number = begin(NAME, to);
    struct undo *u;
    long rc;

    if (number)
        return fail(number);
    rc = syscall(call, arg[0], arg[1], arg[2], arg[3]);
    if (what == POWER && rc >= 0) {
        u = add_undo(path);
        u->how = how;
        snprintf(u->other, sizeof u->other, "%s", to);
        set_folder(u, to);
    }
    if (what == BYTES && rc >= 0 && how == OLD_NAME)
        move_undos(path, to);
    done(NAME, to);
    return (int)rc;
}

int
open(const char *path, int flags, ...)
{
    va_list ap;
    mode_t mode = 0;

    va_start(ap, flags);
    if (flags & O_CREAT)
        mode = va_arg(ap, mode_t);
    va_end(ap);
    if (!(flags & O_CREAT) || !is_below(path) || access(path, F_OK) == 0)
        return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);
    return change_name(NO_FILE, path, path, SYS_openat,
                       (long[]){ AT_FDCWD, (long)path, flags, mode });
}

int open64(const char *path, int flags, ...) __attribute__((alias("open")));

int
mkdir(const char *path, mode_t mode)
{
    if (!is_below(path) || access(path, F_OK) == 0)
        return (int)syscall(SYS_mkdirat, AT_FDCWD, path, mode);
    return change_name(NO_DIR, path, path, SYS_mkdirat,
                       (long[4]){ AT_FDCWD, (long)path, mode });
}

int
rename(const char *from, const char *to)
{
    if (!is_below(to))
        return (int)syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to);
    return change_name(OLD_NAME, from, to, SYS_renameat,
                       (long[]){ AT_FDCWD, (long)from, AT_FDCWD, (long)to });
}

/* A name goes; without power it may come back. */
static int
remove_name(int at_dir, const char *name, int flags)
{
    char path[PATH_MAX];
    struct undo *u;
    int number;
    long rc;

    if (at_dir == AT_FDCWD)
        snprintf(path, sizeof path, "%s", name);
    else if (!is_ours(at_dir, path))
        path[0] = '\0';
    else
        snprintf(path + strlen(path), sizeof path - strlen(path), "/%s", name);
    if (!is_below(path) || access(path, F_OK) != 0)
        return (int)syscall(SYS_unlinkat, at_dir, name, flags);
    number = begin(NAME, path);
    if (number)
        return fail(number);
    if (what == POWER && !(flags & AT_REMOVEDIR)) {
        u = add_undo(path);
        u->how = OLD_FILE;
        set_folder(u, path);
        snprintf(u->other, sizeof u->other, "%s/../backup.%d.%u", dir,
                 (int)getpid(), backups++);
        syscall(SYS_linkat, AT_FDCWD, path, AT_FDCWD, u->other, 0);
    }
    rc = syscall(SYS_unlinkat, at_dir, name, flags);
    done(NAME, path);
    return (int)rc;
}

int
unlink(const char *path)
{
    return remove_name(AT_FDCWD, path, 0);
}

int
unlinkat(int fd, const char *name, int flags)
{
    return remove_name(fd, name, flags);
}

int
rmdir(const char *path)
{
    return remove_name(AT_FDCWD, path, AT_REMOVEDIR);
}

/* --- memory --- */

int
clock_gettime(clockid_t id, struct timespec *t)
{
    const char *path = id == CLOCK_BOOTTIME   ? getenv("DISASTER_SLEPT")
                       : id == CLOCK_REALTIME ? getenv("DISASTER_CLOCK")
                                              : NULL;
    int rc = (int)syscall(SYS_clock_gettime, id, t);
    char text[32] = "";
    int fd = path ? (int)syscall(SYS_openat, AT_FDCWD, path, O_RDONLY) : -1;

    if (fd >= 0) {
        if (syscall(SYS_read, fd, text, sizeof text - 1) > 0)
            t->tv_sec += atol(text);
        syscall(SYS_close, fd);
    }
    return rc;
}

int
listen(int fd, int backlog)
{
    int (*next)(int, int);

    *(void **)&next = real("listen");
    listening = true;
    return next(fd, backlog);
}

static bool
no_memory(void)
{
    int number;

    if (!listening || at_kind != ALLOC || dead)
        return false;
    number = begin(ALLOC, "memory");
    if (number) {
        fail(number);
        return true;
    }
    done(ALLOC, "memory");
    return false;
}

void *
malloc(size_t n)
{
    return no_memory() ? NULL : __libc_malloc(n);
}

void *
calloc(size_t n, size_t size)
{
    return no_memory() ? NULL : __libc_calloc(n, size);
}

void *
realloc(void *p, size_t n)
{
    return no_memory() ? NULL : __libc_realloc(p, n);
}
