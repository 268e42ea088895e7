/* listen.c - see listen.h
 *
 * This file accepts connections itself.  libuv, when descriptors run out, would
 * either try again at once, over and over, or drop all waiting connections.
 * Here they wait in the kernel's queue until there are descriptors again. */
#include "config.h"

#include "base/output.h"
#include "net/listen.h"

#include "net/conn_stream.h"
#include "net/gate.h"
#include "net/log.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#define BACKLOG  64
#define AT_ONCE  64    /* connections accepted in one turn of the loop */
#define AGAIN_MS 100   /* wait after a shortage */
#define TELL_MS  60000 /* least time between log lines about a shortage */

/* Descriptors that are left free for files, children and the like, if there are
 * many; else a quarter of them is. */
#define SPARE 64

/*   listens <-> waits, for want of descriptors
 *         \      /
 *          closed */
struct listener {
    uv_poll_t poll;
    uv_timer_t again; /* runs while it waits */
    int open_handles; /* handles that are not closed yet */
    int fd;
    bool local;
    bool waits;       /* connections wait since the last one was accepted */
    bool told;        /* a shortage was logged, ever */
    uint64_t told_ms; /* when that was last */
    struct listener_conf conf;
    struct gate *gate; /* for TCP */
    struct address at;
    char text[ADDRESS_TEXT + 8];
};

/* Does a process serve the Unix socket at a?  Returns 0: there is no file; 1:
 * the file is left over; RAD_ECANTCREAT otherwise. */
static int
probe_socket(const struct address *a, struct rad_error *err)
{
    const char *path = a->sa.un.sun_path;
    struct stat st;
    int fd, rc;

    if (lstat(path, &st) < 0)
        return 0;
    if (!S_ISSOCK(st.st_mode))
        return rad_fail(err, RAD_ECANTCREAT, "'%s' is there and no socket",
                        path);
    fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (fd < 0)
        return rad_fail(err, RAD_ECANTCREAT, "no socket: %s", strerror(errno));
    rc = connect(fd, &a->sa.any, sizeof a->sa.un);
    if (rc < 0 && errno == ECONNREFUSED)
        rc = 1;
    else
        rc = rad_fail(err, RAD_ECANTCREAT, "'%s' is in use", path);
    close(fd);
    return rc;
}

/* Make the folder of a socket.  Any user may look for the socket, whatever the
 * umask of the shell that started the daemon. */
static int
make_parent(const char *path, struct rad_error *err)
{
    char dir[sizeof((struct sockaddr_un *)0)->sun_path + 1];
    char *slash;
    mode_t mask;
    int rc;

    snprintf(dir, sizeof dir, "%s", path);
    slash = strrchr(dir, '/');
    if (!slash || slash == dir)
        return 0;
    *slash = '\0';
    mask = umask(022);
    rc = rad_make_dir(dir, 0755, err);
    umask(mask);
    return rc < 0 ? RAD_ECANTCREAT : 0;
}

static int
bind_socket(int fd, const struct address *a, int backlog)
{
    socklen_t n = a->sa.any.sa_family == AF_UNIX    ? sizeof a->sa.un
                  : a->sa.any.sa_family == AF_INET6 ? sizeof a->sa.in6
                                                    : sizeof a->sa.in;
    int on = 1, off = 0;

    if (a->sa.any.sa_family != AF_UNIX)
        setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    if (a->sa.any.sa_family == AF_INET6) /* "*" is for IPv4 as well */
        setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
    if (bind(fd, &a->sa.any, n) < 0)
        return -errno;
    /* open to all users: SO_PEERCRED decides about their rights, not the mode
     */
    if (a->sa.any.sa_family == AF_UNIX && chmod(a->sa.un.sun_path, 0666) < 0)
        return -errno;
    return listen(fd, backlog) < 0 ? -errno : 0;
}

static int
new_socket(const struct address *a)
{
    return socket(a->sa.any.sa_family,
                  SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

/* --- connections --- */

static void
take_one(struct listener *l, int fd)
{
    uv_stream_t *stream = conn_stream_new(l->poll.loop, l->local);
    struct address from;
    char peer[ADDRESS_TEXT];
    int rc;

    if (!stream) {
        log_err("connection refused: out of memory");
        close(fd);
        return;
    }
    rc = l->local ? uv_pipe_open((uv_pipe_t *)stream, fd)
                  : uv_tcp_open((uv_tcp_t *)stream, fd);
    if (rc < 0) {
        close(fd);
        conn_stream_close(stream);
        return;
    }
    conn_stream_peer(stream, peer, &from);
    if (l->local)
        l->conf.fn(l->conf.arg, stream, NULL, peer);
    else
        gate_take(l->gate, stream, &from);
}

static void on_ready(uv_poll_t *poll, int status, int events);

static void
go_on(uv_timer_t *again)
{
    struct listener *l = again->data;

    uv_poll_start(&l->poll, UV_READABLE, on_ready);
}

/* Stop accepting for AGAIN_MS.  Connections wait in the kernel's queue
 * meanwhile. */
static void
wait_for_some(struct listener *l, const char *why)
{
    uint64_t now_ms = uv_now(l->again.loop);

    /* short connections could cause a line at each turn */
    if (!l->waits && (!l->told || now_ms - l->told_ms >= TELL_MS)) {
        log_warn("connections wait on=%s: %s", l->text, why);
        l->told = true;
        l->told_ms = now_ms;
    }
    l->waits = true;
    uv_poll_stop(&l->poll);
    uv_timer_start(&l->again, go_on, AGAIN_MS, 0);
}

bool
listener_has_room(int socket)
{
    struct rlimit limit;
    int fd = dup(socket);
    rlim_t used = (rlim_t)fd, spare;

    if (fd < 0)
        return false;
    close(fd);
    if (getrlimit(RLIMIT_NOFILE, &limit) < 0)
        return true;
    spare = limit.rlim_cur / 4 < SPARE ? limit.rlim_cur / 4 : SPARE;
    return used < limit.rlim_cur - spare;
}

/* Is the error a shortage, so that trying again at once is useless? */
static bool
is_short(int number)
{
    return number == EMFILE || number == ENFILE || number == ENOBUFS ||
           number == ENOMEM;
}

static void
on_ready(uv_poll_t *poll, int status, int events)
{
    struct listener *l = poll->data;

    (void)status; /* accept4() returns the same error */
    (void)events;
    for (int i = 0; i < AT_ONCE && !uv_is_closing((uv_handle_t *)poll); i++) {
        int fd;

        if (!listener_has_room(l->fd)) {
            wait_for_some(l, strerror(EMFILE));
            return;
        }
        fd = accept4(l->fd, NULL, NULL, SOCK_CLOEXEC | SOCK_NONBLOCK);
        if (fd < 0 && is_short(errno)) {
            wait_for_some(l, strerror(errno));
            return;
        }
        if (fd < 0 && (errno == EAGAIN || errno == EWOULDBLOCK))
            return;
        l->waits = false;
        if (fd >= 0) /* else the other side has closed it already */
            take_one(l, fd);
    }
}

/* --- opening and closing --- */

static struct listener *
new_listener(const struct address *a, const struct listener_conf *conf)
{
    struct listener *l = calloc(1, sizeof *l);

    if (!l)
        return NULL;
    l->fd = -1;
    l->at = *a;
    l->local = address_is_local(a);
    l->conf = *conf;
    if (l->local)
        return l;
    l->gate = gate_new(conf->find, conf->arg,
                       conf->limit_ms ? conf->limit_ms : HANDSHAKE_MS, conf->fn,
                       conf->arg);
    if (l->gate)
        return l;
    free(l);
    return NULL;
}

/* A descriptor of standard input if that listens; else -1. */
static int
handed_socket(void)
{
    int listens = 0;
    socklen_t n = sizeof listens;

    if (getsockopt(STDIN_FILENO, SOL_SOCKET, SO_ACCEPTCONN, &listens, &n) < 0 ||
        !listens)
        return -1;
    return fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
}

/* Open and bind the socket.  Returns it, or RAD_ECANTCREAT. */
static int
open_socket(struct listener *l, const char *where, struct rad_error *err)
{
    const char *path = l->at.sa.un.sun_path;
    int rc = l->conf.handed ? handed_socket() : -1;

    if (rc >= 0)
        return rc;
    rc = l->local ? probe_socket(&l->at, err) : 0;
    if (rc < 0 || (l->local && rc == 0 && make_parent(path, err) < 0))
        return RAD_ECANTCREAT;
    if (rc == 1)
        unlink(path);
    rc = listener_socket(&l->at, where, BACKLOG);
    return rc >= 0 ? rc
                   : rad_fail(err, RAD_ECANTCREAT, "cannot listen at '%s': %s",
                              where, uv_strerror(rc));
}

static void
free_listener(struct listener *l)
{
    if (l->fd >= 0)
        close(l->fd);
    gate_free(l->gate);
    free(l);
}

static void
on_closed(uv_handle_t *h)
{
    struct listener *l = h->data;

    if (--l->open_handles == 0)
        free_listener(l);
}

/* Begin to watch the socket.  On failure returns a negative error number and
 * frees l. */
static int
watch(struct listener *l, uv_loop_t *loop)
{
    int rc = uv_poll_init(loop, &l->poll, l->fd);

    if (rc < 0) {
        free_listener(l);
        return rc;
    }
    uv_timer_init(loop, &l->again);
    l->poll.data = l->again.data = l;
    l->open_handles = 2;
    rc = uv_poll_start(&l->poll, UV_READABLE, on_ready);
    if (rc < 0)
        listener_close(l);
    return rc;
}

struct listener *
listener_open(uv_loop_t *loop, const char *where,
              const struct listener_conf *conf, struct rad_error *err)
{
    char text[ADDRESS_TEXT];
    struct address a;
    struct listener *l;
    int rc;

    if (address_resolve_listen(where, &a, err) < 0 ||
        (!conf->anywhere && address_permitted(&a, where, err) < 0))
        return NULL;
    l = new_listener(&a, conf);
    if (!l) {
        rad_fail_memory(err);
        return NULL;
    }
    l->fd = open_socket(l, where, err);
    if (l->fd < 0) {
        free_listener(l);
        return NULL;
    }
    address_format(&l->at, text);
    snprintf(l->text, sizeof l->text, "%s %s", l->local ? "unix" : "tcp", text);
    rc = watch(l, loop);
    if (rc == 0)
        return l;
    rad_fail(err, RAD_EINTERNAL, "cannot watch '%s': %s", where,
             uv_strerror(rc));
    return NULL;
}

const char *
listener_text(const struct listener *l)
{
    return l->text;
}

void
listener_close(struct listener *l)
{
    if (!l || uv_is_closing((uv_handle_t *)&l->poll))
        return;
    if (l->local)
        unlink(l->at.sa.un.sun_path);
    gate_close(l->gate);
    uv_close((uv_handle_t *)&l->poll, on_closed);
    uv_close((uv_handle_t *)&l->again, on_closed);
}

int
listener_socket(struct address *a, const char *where, int backlog)
{
    socklen_t n = sizeof a->sa;
    int fd = new_socket(a), rc;

    if (fd < 0 && errno == EAFNOSUPPORT && where[0] == '*') {
        address_wildcard_v4(a); /* a kernel without IPv6 */
        fd = new_socket(a);
    }
    if (fd < 0)
        return -errno;
    rc = bind_socket(fd, a, backlog);
    if (rc < 0) {
        close(fd);
        return rc;
    }
    if (!address_is_local(a))
        getsockname(fd, &a->sa.any, &n);
    return fd;
}
