/* serve.c - see serve.h */
#include "config.h"

#include "web/serve.h"

#include "base/files.h"
#include "net/listen.h"
#include "net/log.h"

#include <errno.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MEMORY   16384 /* libmicrohttpd's buffer of a connection [bytes] */
#define MOST_PEM (1u << 20)
#define BACKLOG  511
#define A_TURN   10 /* connections accepted in one turn of the loop */

/*  CLOSED <--> OPEN --> RUNS --> (a callback needs another run) --> AGAIN
 *                ^       |                                            |
 *                '-------'--------------------------------------------'  */
enum serve_state {
    SERVE_CLOSED, /* no handle of libuv is open */
    SERVE_OPEN,
    SERVE_RUNS, /* MHD_run() is under way */
    SERVE_AGAIN /* the same, and is to be called again */
};

struct serve {
    uv_loop_t *loop;
    struct serve_conf conf;
    struct MHD_Daemon *mhd;
    uv_poll_t poll;
    uv_poll_t door; /* the listening socket */
    int door_fd;
    double may; /* connections that may be accepted now; grows by SERVE_PER_S a
                 * second */
    uint64_t may_ms;
    uv_timer_t timer;
    enum serve_state state;
    struct serve_guest *guests;
    unsigned nguests;
    char address[ADDRESS_TEXT];
    char *cert, *key;
};

const char *
serve_address(const struct serve *s)
{
    return s->address;
}

unsigned
serve_guests(const struct serve *s)
{
    return s->nguests;
}

/* --- guests --- */

static struct serve_guest *
guest_of(struct MHD_Connection *c)
{
    const union MHD_ConnectionInfo *i =
        MHD_get_connection_info(c, MHD_CONNECTION_INFO_SOCKET_CONTEXT);

    return i ? i->socket_context : NULL;
}

static void
on_connection(void *arg, struct MHD_Connection *c, void **context,
              enum MHD_ConnectionNotificationCode what)
{
    struct serve *s = arg;
    struct serve_guest *g = *context, **at = &s->guests;

    if (what == MHD_CONNECTION_NOTIFY_STARTED) {
        g = calloc(1, sizeof *g);
        if (!g)
            return; /* out of memory: the connection has no time limit */
        *g = (struct serve_guest){ .next = s->guests,
                                   .conn = c,
                                   .since_ms = uv_now(s->loop) };
        s->guests = g;
        s->nguests++;
        *context = g;
        return;
    }
    while (*at && *at != g)
        at = &(*at)->next;
    if (!*at)
        return;
    *at = g->next;
    s->nguests--;
    free(g);
}

static void
set_state(struct serve *s, struct MHD_Connection *c, int state)
{
    struct serve_guest *g = guest_of(c);

    if (!g)
        return;
    g->state = state;
    g->since_ms = uv_now(s->loop);
}

void
serve_is_stream(struct MHD_Connection *c)
{
    struct serve_guest *g = guest_of(c);

    if (g)
        g->state = GUEST_STREAMS;
}

/* Shut the socket down; the library then closes the connection. */
static void
end_guest(const struct serve_guest *g)
{
    const union MHD_ConnectionInfo *i =
        MHD_get_connection_info(g->conn, MHD_CONNECTION_INFO_CONNECTION_FD);

    if (i)
        shutdown(i->connect_fd, SHUT_RDWR);
}

void
serve_sweep(struct serve *s)
{
    uint64_t now = uv_now(s->loop);

    for (struct serve_guest *g = s->guests; g; g = g->next)
        if ((g->state == GUEST_ASKS && now - g->since_ms > SERVE_ASK_MS) ||
            (g->state == GUEST_READS && now - g->since_ms > SERVE_READ_MS))
            end_guest(g);
}

/* --- requests --- */

/* A request whose header has come.  One that could have a body is answered
 * ahead of it, and the connection closed; a body that comes with any other is
 * not read. */
struct request {
    void *state; /* for serve_fn */
};

static enum MHD_Result
on_request(void *arg, struct MHD_Connection *c, const char *url,
           const char *method, const char *version, const char *upload,
           size_t *nupload, void **context)
{
    struct serve *s = arg;
    struct request *r = *context;

    (void)version;
    (void)upload;
    if (!r) {
        r = *context = calloc(1, sizeof *r);
        set_state(s, c, GUEST_READS);
        if (!r || strcmp(method, "GET") == 0 || strcmp(method, "HEAD") == 0)
            return r ? MHD_YES : MHD_NO;
    }
    if (*nupload > 0)
        return MHD_NO;
    return s->conf.fn(s->conf.arg, c, method, url, &r->state);
}

static void
on_completed(void *arg, struct MHD_Connection *c, void **context,
             enum MHD_RequestTerminationCode why)
{
    struct serve *s = arg;
    struct request *r = *context;

    (void)why;
    if (r) {
        s->conf.ended(s->conf.arg, r->state);
        free(r);
    }
    *context = NULL;
    set_state(s, c, GUEST_ASKS);
}

void
serve_put_off(struct MHD_Connection *c)
{
    MHD_suspend_connection(c);
}

void
serve_wake(struct MHD_Connection *c)
{
    MHD_resume_connection(c);
}

static void
on_log(void *arg, const char *fmt, va_list ap)
{
    char text[300];

    (void)arg;
    vsnprintf(text, sizeof text, fmt, ap);
    text[strcspn(text, "\n")] = '\0';
    log_debug("http %s", text);
}

/* --- the loop --- */

static void serve_run(struct serve *s);

static void
on_timer(uv_timer_t *t)
{
    serve_run(t->data);
}

static void
on_ready(uv_poll_t *p, int status, int events)
{
    (void)status;
    (void)events;
    serve_run(p->data);
}

/* Run the library, and set the timer to when it wants to run again. */
static void
serve_run(struct serve *s)
{
    MHD_UNSIGNED_LONG_LONG wait;

    if (s->state == SERVE_RUNS) /* called by a callback of MHD_run() */
        s->state = SERVE_AGAIN;
    if (s->state != SERVE_OPEN)
        return;
    s->state = SERVE_RUNS;
    MHD_run(s->mhd);
    if (s->state == SERVE_AGAIN)
        wait = 0;
    else if (MHD_get_timeout(s->mhd, &wait) != MHD_YES)
        wait = 1000;
    s->state = SERVE_OPEN;
    uv_timer_start(&s->timer, on_timer, wait < 1000 ? wait : 1000, 0);
}

/* --- accepting connections --- */

static bool
may_come(struct serve *s)
{
    uint64_t now = uv_now(s->loop);

    s->may += (double)(now - s->may_ms) * SERVE_PER_S / 1000;
    s->may = s->may < SERVE_AT_ONCE ? s->may : SERVE_AT_ONCE;
    s->may_ms = now;
    return s->may >= 1 && s->nguests < SERVE_GUESTS &&
           listener_has_room(s->door_fd);
}

/* Accept a waiting connection.  False: none waits, or none may be accepted now.
 */
static bool
let_in(struct serve *s)
{
    /* a browser that has vanished, as in sleep, keeps no stream from others */
    static const unsigned gone_ms = SERVE_READ_MS;
    struct address a;
    socklen_t n = sizeof a.sa;
    int fd;

    if (!may_come(s))
        return false;
    fd = accept4(s->door_fd, &a.sa.any, &n, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (fd < 0) {
        if (errno != EAGAIN && errno != ECONNABORTED)
            s->may = 0; /* a shortage: try again at the next tick */
        return errno == ECONNABORTED;
    }
    s->may--;
    setsockopt(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, &gone_ms, sizeof gone_ms);
    MHD_add_connection(s->mhd, fd, &a.sa.any, n); /* closes fd if it fails */
    return true;
}

static void
on_door(uv_poll_t *p, int status, int events)
{
    struct serve *s = p->data;
    int i = 0;

    (void)status;
    (void)events;
    while (i < A_TURN && let_in(s))
        i++;
    if (!may_come(s))
        uv_poll_stop(p); /* serve_tick() starts it again */
    if (i > 0)
        serve_run(s);
}

void
serve_tick(struct serve *s)
{
    serve_run(s);
    if (s->state == SERVE_OPEN && !uv_is_active((uv_handle_t *)&s->door) &&
        may_come(s))
        uv_poll_start(&s->door, UV_READABLE, on_door);
}

/* --- open and close --- */

static int
read_pem(const char *path, char **text, struct rad_error *err)
{
    size_t n;

    *text = (char *)rad_file_read(path, MOST_PEM, &n, err);
    return *text ? 0 : err->code;
}

/* Open the listening socket; negative with *err set. */
static int
open_socket(struct serve *s, struct rad_error *err)
{
    struct address a;
    int fd, rc = address_resolve_listen(s->conf.listen, &a, err);

    if (rc < 0)
        return rc;
    fd = listener_socket(&a, s->conf.listen, BACKLOG);
    if (fd < 0)
        return rad_fail(err, RAD_ECANTCREAT, "cannot listen at '%s': %s",
                        s->conf.listen, uv_strerror(fd));
    address_format(&a, s->address);
    return fd;
}

static int
start_library(struct serve *s, struct rad_error *err)
{
    unsigned flags = MHD_USE_EPOLL | MHD_ALLOW_SUSPEND_RESUME |
                     MHD_USE_NO_LISTEN_SOCKET | MHD_USE_ERROR_LOG |
                     (s->cert ? MHD_USE_TLS : 0u);
    const struct MHD_OptionItem plain[] = { { MHD_OPTION_END, 0, NULL } };
    const struct MHD_OptionItem tls[] = {
        { MHD_OPTION_HTTPS_MEM_KEY, 0, s->key },
        { MHD_OPTION_HTTPS_MEM_CERT, 0, s->cert },
        { MHD_OPTION_END, 0, NULL },
    };

    s->mhd = MHD_start_daemon(
        flags, 0, NULL, NULL, on_request, s, MHD_OPTION_EXTERNAL_LOGGER, on_log,
        s, MHD_OPTION_CONNECTION_LIMIT, (unsigned)SERVE_GUESTS,
        MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)MEMORY,
        MHD_OPTION_CONNECTION_TIMEOUT, 30u, MHD_OPTION_NOTIFY_COMPLETED,
        on_completed, s, MHD_OPTION_NOTIFY_CONNECTION, on_connection, s,
        MHD_OPTION_ARRAY, s->cert ? tls : plain, MHD_OPTION_END);
    if (s->mhd)
        return 0;
    return s->cert ? rad_fail(err, RAD_ECONFIG,
                              "the certificate and its key cannot be used")
                   : rad_fail(err, RAD_EINTERNAL, "HTTP cannot be served");
}

static int
start(struct serve *s, struct rad_error *err)
{
    const union MHD_DaemonInfo *i;
    int rc;

    if (s->conf.tls_cert[0] && (read_pem(s->conf.tls_cert, &s->cert, err) < 0 ||
                                read_pem(s->conf.tls_key, &s->key, err) < 0))
        return err->code;
    if ((s->door_fd = open_socket(s, err)) < 0 || start_library(s, err) < 0)
        return err->code;
    i = MHD_get_daemon_info(s->mhd, MHD_DAEMON_INFO_EPOLL_FD);
    rc = i ? uv_poll_init(s->loop, &s->poll, i->epoll_fd) : UV_ENOSYS;
    if (rc < 0) {
        MHD_stop_daemon(s->mhd);
        return rad_fail(err, RAD_EINTERNAL, "HTTP cannot be served: %s",
                        uv_strerror(rc));
    }
    uv_poll_init(s->loop, &s->door, s->door_fd);
    s->poll.data = s->door.data = s->timer.data = s;
    uv_timer_init(s->loop, &s->timer);
    uv_poll_start(&s->poll, UV_READABLE, on_ready);
    s->state = SERVE_OPEN;
    s->may = SERVE_AT_ONCE;
    s->may_ms = uv_now(s->loop);
    serve_tick(s);
    return 0;
}

struct serve *
serve_open(uv_loop_t *loop, const struct serve_conf *conf,
           struct rad_error *err)
{
    struct serve *s = calloc(1, sizeof *s);

    if (!s) {
        rad_fail_memory(err);
        return NULL;
    }
    s->loop = loop;
    s->conf = *conf;
    s->door_fd = -1;
    if (start(s, err) == 0)
        return s;
    serve_free(s);
    return NULL;
}

void
serve_close(struct serve *s)
{
    if (!s || s->state == SERVE_CLOSED)
        return;
    s->state = SERVE_CLOSED;
    MHD_run(s->mhd); /* ends requests that serve_wake() has woken */
    uv_close((uv_handle_t *)&s->door, NULL);
    uv_close((uv_handle_t *)&s->poll, NULL);
    uv_close((uv_handle_t *)&s->timer, NULL);
    MHD_stop_daemon(s->mhd);
}

void
serve_free(struct serve *s)
{
    if (!s)
        return;
    if (s->key)
        explicit_bzero(s->key, strlen(s->key));
    if (s->door_fd >= 0)
        close(s->door_fd);
    free(s->key);
    free(s->cert);
    free(s);
}
