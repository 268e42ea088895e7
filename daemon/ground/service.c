/* service.c - see service.h */
#include "config.h"

#include "ground/service.h"

#include "base/output.h"
#include "net/log.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

/* With fewer a daemon might start, and then wait for descriptors for ever. */
#define LEAST_DESCRIPTORS 32

int
service_raise_descriptors(struct rad_error *err)
{
    struct rlimit limit;

    if (getrlimit(RLIMIT_NOFILE, &limit) < 0)
        return 0;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
    if (limit.rlim_max >= LEAST_DESCRIPTORS)
        return 0;
    return rad_fail(err, RAD_ESHORT,
                    "cannot start: %llu descriptors are allowed (ulimit -n), "
                    "and at least %d are needed",
                    (unsigned long long)limit.rlim_max, LEAST_DESCRIPTORS);
}

/* A datagram socket that is connected with the one at path; -1: errno. */
static int
dial(const char *path)
{
    struct sockaddr_un to = { .sun_family = AF_UNIX };
    size_t n = strlen(path);
    int fd, number;

    if (n >= sizeof to.sun_path) {
        errno = ENAMETOOLONG;
        return -1;
    }
    memcpy(to.sun_path, path, n);
    if (to.sun_path[0] == '@') /* the abstract namespace */
        to.sun_path[0] = '\0';
    fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (fd < 0 ||
        connect(fd, (struct sockaddr *)&to,
                (socklen_t)(offsetof(struct sockaddr_un, sun_path) + n)) == 0)
        return fd;
    number = errno;
    close(fd);
    errno = number;
    return -1;
}

int
service_notify_open(void)
{
    const char *path = getenv("NOTIFY_SOCKET");
    int fd;

    if (!path || !path[0])
        return -1;
    fd = dial(path);
    if (fd < 0)
        log_warn("systemd not reached at=%s why=%s", path,
                 uv_strerror(uv_translate_sys_error(errno)));
    return fd;
}

void
service_notify(int fd, const char *state)
{
    if (fd >= 0)
        send(fd, state, strlen(state), MSG_NOSIGNAL);
}

uint64_t
service_watchdog_ms(void)
{
    const char *usec = getenv("WATCHDOG_USEC"), *pid = getenv("WATCHDOG_PID");

    if (!usec || (pid && strtol(pid, NULL, 10) != (long)getpid()))
        return 0;
    return strtoull(usec, NULL, 10) / 1000;
}

bool
service_credential(const char *name, char *path, size_t size)
{
    const char *dir = getenv("CREDENTIALS_DIRECTORY");
    bool any = false;
    FILE *f;
    int c;

    if (!dir || snprintf(path, size, "%s/%s", dir, name) >= (int)size)
        dir = NULL;
    f = dir ? fopen(path, "re") : NULL;
    any = dir && !f && errno != ENOENT; /* the error is its reader's to tell */
    while (f && !any && (c = getc(f)) != EOF)
        any = !isspace(c);
    if (f)
        fclose(f);
    if (!any)
        path[0] = '\0';
    return any;
}

int
service_ports_file(const char *path, const char *const lines[], int n,
                   struct rad_error *err)
{
    struct rad_output out;
    int rc = rad_output_open(&out, path, false, err);

    if (rc < 0)
        return rc;
    for (int i = 0; i < n; i++)
        fprintf(out.file, "%s\n", lines[i]);
    return rad_output_commit(&out, err);
}

int
service_lock_dir(const char *path, struct rad_error *err)
{
    char lock[PATH_MAX];
    struct stat st;
    int fd, number;

    if (snprintf(lock, sizeof lock, "%s/lock", path) >= (int)sizeof lock)
        return rad_fail(err, RAD_ECANTCREAT, "path too long: '%s'", path);
    if (lstat(lock, &st) == 0 && !S_ISREG(st.st_mode))
        return rad_fail(err, RAD_EDATA, "'%s' is no file", lock);
    fd = open(lock, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (fd < 0)
        return rad_fail(err, errno == EACCES ? RAD_EPERM : RAD_ECANTCREAT,
                        "cannot open '%s': %s", lock, strerror(errno));
    if (flock(fd, LOCK_EX | LOCK_NB) == 0)
        return fd;
    number = errno;
    close(fd);
    if (number != EWOULDBLOCK)
        return rad_fail(err, RAD_EIO, "cannot lock '%s': %s", lock,
                        strerror(number));
    return rad_fail(err, RAD_ECANTCREAT, "another process uses folder '%s'",
                    path);
}

static void
lifetime_event(uv_poll_t *poll, int status, int events)
{
    struct service_lifetime *l = poll->data;
    char byte;
    int fd;

    (void)events;
    uv_fileno((uv_handle_t *)poll, &fd);
    /* nobody writes to the pipe: it can be read only at its end */
    if (status < 0 || read(fd, &byte, 1) <= 0) {
        uv_poll_stop(poll);
        l->end(l->arg);
    }
}

int
service_watch_lifetime(struct service_lifetime *l, uv_loop_t *loop, int fd,
                       void (*end)(void *arg), void *arg, struct rad_error *err)
{
    int rc;

    if (fd < 0)
        return 0;
    fcntl(fd, F_SETFD, FD_CLOEXEC);
    l->end = end;
    l->arg = arg;
    l->poll.data = l;
    rc = uv_poll_init(loop, &l->poll, fd);
    if (rc == 0)
        rc = uv_poll_start(&l->poll, UV_READABLE | UV_DISCONNECT,
                           lifetime_event);
    if (rc < 0)
        return rad_fail(err, RAD_EUSAGE, "cannot watch descriptor %d: %s", fd,
                        uv_strerror(rc));
    uv_unref((uv_handle_t *)&l->poll);
    return 0;
}

/* glibc maps a block by itself above a limit, and raises the limit when such a
 * block is freed.  Then large blocks come from the heap, which cannot shrink
 * while a small block lies at its end; so the limit is fixed. */
#define MAPPED_BYTES (128 << 10)

void
service_return_memory(void)
{
#ifdef M_MMAP_THRESHOLD
    mallopt(M_MMAP_THRESHOLD, MAPPED_BYTES);
#endif
}

void
service_trim_memory(void)
{
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}
