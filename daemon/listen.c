/* listen.c - see listen.h */
#include "config.h"

#include "listen.h"

#include "conn.h"
#include "gate.h"
#include "log.h"
#include "service.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define BACKLOG 64

struct listener {
    union conn_stream server;
    bool local;
    struct listener_conf conf;
    struct gate *gate; /* of TCP */
    char text[ADDRESS_TEXT + 8];
};

/* Is somebody serving the socket at a?  0: no file; 1: a dead one; otherwise
 * RAD_ECANTCREAT. */
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

static int
make_parent(const char *path, struct rad_error *err)
{
    char dir[sizeof((struct sockaddr_un *)0)->sun_path + 1];
    char *slash;

    snprintf(dir, sizeof dir, "%s", path);
    slash = strrchr(dir, '/');
    if (!slash || slash == dir)
        return 0;
    *slash = '\0';
    return service_make_dir(dir, 0755, err) < 0 ? RAD_ECANTCREAT : 0;
}

static int
bind_local(struct listener *l, uv_loop_t *loop, const struct address *a,
           struct rad_error *err)
{
    int rc = probe_socket(a, err);

    if (rc < 0 || (rc == 0 && make_parent(a->sa.un.sun_path, err) < 0))
        return RAD_ECANTCREAT;
    if (rc == 1)
        unlink(a->sa.un.sun_path);
    uv_pipe_init(loop, &l->server.pipe, 0);
    rc = uv_pipe_bind(&l->server.pipe, a->sa.un.sun_path);
    if (rc == 0) /* who may do what is decided by SO_PEERCRED, not by mode */
        rc = uv_pipe_chmod(&l->server.pipe, UV_READABLE | UV_WRITABLE);
    return rc;
}

static int
bind_tcp(struct listener *l, uv_loop_t *loop, const struct address *a)
{
    uv_tcp_init(loop, &l->server.tcp);
    return uv_tcp_bind(&l->server.tcp, &a->sa.any, 0);
}

static void
free_listener(uv_handle_t *h)
{
    struct listener *l = h->data;

    gate_free(l->gate);
    free(l);
}

/* The address that the kernel gave (port 0 in the wish). */
static void
note_address(struct listener *l, const struct address *wished)
{
    struct address a = *wished;
    char text[ADDRESS_TEXT];
    int n = sizeof a.sa;

    if (!l->local)
        uv_tcp_getsockname(&l->server.tcp, &a.sa.any, &n);
    address_format(&a, text);
    snprintf(l->text, sizeof l->text, "%s %s", l->local ? "unix" : "tcp", text);
}

static void
on_connection(uv_stream_t *server, int status)
{
    struct listener *l = server->data;
    uv_stream_t *stream;
    struct address from;
    char peer[ADDRESS_TEXT];

    if (status < 0)
        return;
    stream = conn_stream_new(server->loop, l->local);
    if (!stream) /* what is not taken stands in the way of all after it */
        service_out_of_memory();
    if (uv_accept(server, stream) < 0) {
        conn_stream_close(stream);
        return;
    }
    conn_stream_peer(stream, peer, &from);
    if (l->local)
        l->conf.fn(l->conf.arg, stream, NULL, peer);
    else
        gate_take(l->gate, stream, &from);
}

static struct listener *
new_listener(const struct address *a, const struct listener_conf *conf)
{
    struct listener *l = calloc(1, sizeof *l);

    if (!l)
        return NULL;
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

struct listener *
listener_open(uv_loop_t *loop, const char *where,
              const struct listener_conf *conf, struct rad_error *err)
{
    struct address a;
    struct listener *l;
    int rc;

    if (address_resolve(where, &a, err) < 0 ||
        (!conf->anywhere && address_permitted(&a, where, err) < 0))
        return NULL;
    l = new_listener(&a, conf);
    if (!l) {
        rad_fail(err, RAD_ENOMEM, "out of memory");
        return NULL;
    }
    rc = l->local ? bind_local(l, loop, &a, err) : bind_tcp(l, loop, &a);
    if (rc == RAD_ECANTCREAT) { /* no handle yet */
        gate_free(l->gate);
        free(l);
        return NULL;
    }
    l->server.stream.data = l;
    if (rc == 0)
        rc = uv_listen(&l->server.stream, BACKLOG, on_connection);
    if (rc < 0) {
        rad_fail(err, RAD_ECANTCREAT, "cannot listen at '%s': %s", where,
                 uv_strerror(rc));
        uv_close(&l->server.handle, free_listener);
        return NULL;
    }
    note_address(l, &a);
    return l;
}

const char *
listener_text(const struct listener *l)
{
    return l->text;
}

const char *
listener_address(const struct listener *l)
{
    return strchr(l->text, ' ') + 1;
}

void
listener_close(struct listener *l)
{
    if (l && !uv_is_closing(&l->server.handle))
        uv_close(&l->server.handle, free_listener);
}
