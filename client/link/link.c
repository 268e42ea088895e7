/* link.c - see link.h
 *
 * A dialled connection of net/.  Messages that come wait in a list until
 * link_recv() asks for them; above INPUT_MARK the connection is not read, so a
 * coordinator cannot fill our memory.  The connection's callbacks only set
 * `why` and `done` and add messages; the waiting caller acts on these. */
#include "config.h"

#include "link/link.h"

#include "net/conn.h"
#include "net/dial.h"
#include "net/key/keyfile.h"
#include "ground/memory.h"
#include "ground/threads.h"

#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum {
    INPUT_MARK = 4 << 20, /* bytes of waiting messages; above, reading stops */
    LOOP_DESCRIPTORS = 8, /* of a loop, and a connection */
    QUEUE_MARK = 1 << 20  /* bytes to be sent; above, link_send() waits */
};

/* A message that has come, with the bytes that it points into. */
struct letter {
    struct letter *next;
    struct msg m;
    uint8_t *bytes;
    size_t n;
};

/* States of a link:
 *
 *  dialling -> HELLO sent -> WELCOME came: conn is live
 *         \         \         \
 *          `-> why.code is set: conn is NULL, letters may still wait */
struct link {
    struct link_where where;
    char name[sizeof((struct target *)0)->text];
    bool keyless; /* over TCP without a key file */
    struct dialler *dialler;
    struct conn *conn;    /* NULL before and after the connection */
    struct rad_error why; /* code 0, or why the link failed */
    unsigned version;     /* of the protocol, as agreed */
    uv_timer_t limit;     /* of the current wait */
    bool closed;          /* the timer is closed */
    bool done;            /* what wait_for() waits for has happened */
    bool timeout;
    uint64_t until_ms; /* limit for opening the link, in the loop's time */
    struct letter *first, **last; /* messages that wait */
    struct letter *read;          /* the caller's, until its next call */
    size_t waiting;               /* bytes of waiting messages */
};

int
link_code(unsigned status)
{
    static const int codes[] = { RAD_EUSAGE,     RAD_EDATA,     RAD_ENOINPUT,
                                 RAD_EUNAVAIL,   RAD_EINTERNAL, RAD_ENOMEM,
                                 RAD_ECANTCREAT, RAD_EIO,       RAD_ETEMPFAIL,
                                 RAD_EPROTO,     RAD_EPERM,     RAD_ECONFIG };

    for (size_t i = 0; i < sizeof codes / sizeof codes[0]; i++)
        if (rad_exit_status(codes[i]) == (int)status)
            return codes[i];
    return RAD_EINTERNAL;
}

/* libuv's texts do not say that it is a name that was not found. */
static const char *
unreached(int code)
{
    switch (code) {
    case UV_EAI_NONAME:
    case RAD_EUSAGE:
        return "no such host";
    case UV_EAI_AGAIN:
    case UV_EAI_FAIL:
        return "the host's name cannot be looked up";
    default:
        return uv_strerror(code);
    }
}

static int
lost(const struct link *l, struct rad_error *err)
{
    int code = l->why.code;

    switch (code) {
    case UV_EOF:
        return rad_fail(err, RAD_EUNAVAIL,
                        "the coordinator at '%s' closed the connection",
                        l->name);
    case UV_ETIMEDOUT:
        return rad_fail(err, RAD_EUNAVAIL,
                        "the coordinator at '%s' does not answer", l->name);
    case UV_ENOMEM:
    case RAD_ENOMEM:
        return rad_fail_memory(err);
    case RAD_EPROTO:
        if (l->why.where[0]) { /* an error of a message, not of TLS */
            rad_fail(err, code, "%s", l->why.what);
            rad_error_where(err, "%s", l->name);
            return code;
        }
        /* fall through */
    case RAD_EPERM:
        return rad_fail(err, code, "the coordinator at '%s': %s", l->name,
                        l->keyless ? "it asks for a key: use --key or RADD_KEY"
                                   : l->why.what);
    default:
        return rad_fail(err, RAD_EUNAVAIL, "no coordinator at '%s': %s",
                        l->name, unreached(code));
    }
}

/* Note a failure, unless there was one before. */
static void
fail(struct link *l, int code)
{
    if (l->why.code == 0)
        l->why.code = code;
}

/* The timer's turn of the loop would still wait for other events, up to 5 s for
 * the connection's own timer; uv_stop() prevents that. */
static void
on_limit(uv_timer_t *t)
{
    ((struct link *)t->data)->timeout = true;
    uv_stop(t->loop);
}

/* Run the loop until `done`, a failure, the end of the time (ms < 0: none) or a
 * change of wake.  Returns true when done. */
static bool
wait_for(struct link *l, int ms)
{
    int wake = *l->where.wake;

    l->done = l->timeout = false;
    if (ms >= 0)
        uv_timer_start(&l->limit, on_limit, (uint64_t)ms, 0);
    while (!l->done && !l->why.code && !l->timeout && *l->where.wake == wake)
        uv_run(l->where.loop, UV_RUN_ONCE);
    uv_timer_stop(&l->limit);
    return l->done && !l->why.code;
}

/* --- callbacks of the connection --- */

/* From here on messages are of the version that the coordinator has chosen. */
static void
take_welcome(struct link *l, const struct msg *m)
{
    unsigned version = m->welcome.version;

    l->version = version;
    if (msg_common_version(version, version) == 0)
        return;
    conn_set_version(l->conn, version);
    conn_set_session(l->conn, MSG_AT_CLIENT);
    conn_live(l->conn, true);
}

static void
on_message(void *arg, struct conn *c, const struct msg *m)
{
    struct link *l = arg;
    struct letter *letter;

    if (m->type == MSG_PING || m->type == MSG_PONG)
        return;
    letter = calloc(1, sizeof *letter);
    if (!letter) {
        fail(l, RAD_ENOMEM);
        return;
    }
    if (m->type == MSG_WELCOME)
        take_welcome(l, m);
    letter->bytes = conn_keep(c, &letter->m, &letter->n);
    *l->last = letter;
    l->last = &letter->next;
    l->waiting += letter->n;
    l->done = true;
    if (l->waiting > INPUT_MARK)
        conn_pause(c, true);
}

static void
on_conn_closed(void *arg, struct conn *c, const char *why)
{
    struct link *l = arg;

    (void)why;
    if (l->why.code == 0)
        l->why = *conn_error(c);
    l->conn = NULL;
}

static void
on_written(void *arg, struct conn *c, size_t n)
{
    (void)c;
    (void)n;
    ((struct link *)arg)->done = true; /* there may be room in the queue */
}

/* limit_ms: none here, for link_open() limits the wait for WELCOME. */
static const struct conn_handler handler = { .message = on_message,
                                             .closed = on_conn_closed,
                                             .written = on_written,
                                             .limit_ms = UINT_MAX,
                                             .quiet = true };

static void
on_dialled(void *arg, uint64_t id, uv_stream_t *stream, struct tls *tls,
           const char *peer, const struct rad_error *why)
{
    struct link *l = arg;

    (void)id;
    if (!stream) {
        l->why = *why;
        return;
    }
    l->conn = conn_new(stream, tls, MSG_AT_DIALLER, peer, &handler, l);
    if (!l->conn)
        fail(l, RAD_ENOMEM);
    l->done = true;
}

/* --- pauses --- */

static void
on_pause_over(uv_timer_t *t)
{
    *(bool *)t->data = true;
    uv_stop(t->loop); /* or a pause of 0 ms would wait for another event */
}

static void
on_pause_closed(uv_handle_t *h)
{
    h->data = NULL;
}

void
link_pause(const struct link_where *where, uint64_t ms)
{
    uv_timer_t timer;
    bool over = false;
    int wake = *where->wake;

    uv_timer_init(where->loop, &timer);
    timer.data = &over;
    uv_update_time(where->loop);
    uv_timer_start(&timer, on_pause_over, ms, 0);
    while (!over && *where->wake == wake)
        uv_run(where->loop, UV_RUN_ONCE);
    uv_close((uv_handle_t *)&timer, on_pause_closed);
    while (timer.data)
        uv_run(where->loop, UV_RUN_ONCE);
}

/* --- messages --- */

static int
queue(struct link *l, const struct msg *m, struct rad_error *err)
{
    if (l->why.code)
        return lost(l, err);
    if (l->version < msg_since(m->type))
        return rad_fail(err, RAD_EPROTO,
                        "the coordinator at '%s' is too old to be asked that: "
                        "it speaks protocol version %u",
                        l->name, l->version);
    if (conn_send(l->conn, m)) {
        conn_flush(l->conn);
        return l->why.code ? lost(l, err) : 0;
    }
    return l->why.code ? lost(l, err)
                       : rad_fail(err, RAD_EPROTO, "%s: too long to be sent",
                                  msg_name(m->type));
}

int
link_send(struct link *l, const struct msg *m, struct rad_error *err)
{
    int rc = queue(l, m, err), wake = *l->where.wake;

    /* when woken, return: the message stays queued, and the caller decides */
    while (rc == 0 && *l->where.wake == wake &&
           conn_queued(l->conn) > QUEUE_MARK) {
        wait_for(l, -1);
        if (l->why.code)
            rc = lost(l, err);
    }
    return rc;
}

static void
free_letter(struct letter *letter)
{
    if (!letter)
        return;
    msg_release(&letter->m);
    free(letter->bytes);
    free(letter);
}

/* Make the oldest waiting message the caller's. */
static bool
open_letter(struct link *l)
{
    free_letter(l->read);
    l->read = l->first;
    if (!l->read)
        return false;
    l->first = l->read->next;
    if (!l->first)
        l->last = &l->first;
    l->waiting -= l->read->n;
    if (l->conn && l->waiting <= INPUT_MARK / 2)
        conn_pause(l->conn, false);
    return true;
}

int
link_recv(struct link *l, int timeout_ms, const struct msg **m,
          struct rad_error *err)
{
    uint64_t until = uv_now(l->where.loop) + (uint64_t)timeout_ms, now;

    for (;;) {
        if (open_letter(l)) { /* also those of a link that has failed since */
            *m = &l->read->m;
            if (l->read->m.type != MSG_BYE)
                return 1;
            fail(l, UV_EOF);
        }
        if (l->why.code)
            return lost(l, err);
        now = uv_now(l->where.loop);
        if (!wait_for(l, now < until ? (int)(until - now) : 0) && !l->why.code)
            return 0;
    }
}

/* --- opening and closing --- */

/* Are so many descriptors to be had? */
static bool
can_open(int n)
{
    int fd = fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0);
    bool more = fd >= 0 && (n == 1 || can_open(n - 1));

    if (fd >= 0)
        close(fd);
    return more;
}

int
link_loop_init(uv_loop_t *loop, uv_work_t *first, struct rad_error *err)
{
    memory_catch();
    if (!can_open(LOOP_DESCRIPTORS))
        return rad_fail(err, RAD_ENOMEM,
                        "too few descriptors for an event loop: see ulimit -n");
    if (uv_loop_init(loop) != 0)
        return rad_fail_memory(err);
    if (first)
        threads_start(loop, first, true);
    return 0;
}

/* Time left for opening the link [ms]. */
static int
left_ms(const struct link *l)
{
    uint64_t now = uv_now(l->where.loop);

    return now < l->until_ms ? (int)(l->until_ms - now) : 0;
}

enum msg_role
link_role(const struct target *to)
{
    static const enum msg_role by_rank[] = { MSG_ROLE_ADMIN, MSG_ROLE_USER,
                                             MSG_ROLE_OBSERVER };
    enum msg_role role = MSG_ROLE_USER;
    struct keyfile f;

    if (to->local)
        return MSG_ROLE_ADMIN;
    if (keyfile_load(&f, to->key, NULL) < 0)
        return role;
    for (size_t i = 0; i < sizeof by_rank / sizeof by_rank[0]; i++)
        if (keyfile_best(&f, by_rank[i], (int64_t)time(NULL))) {
            role = by_rank[i];
            break;
        }
    keyfile_release(&f);
    return role;
}

/* Dial the coordinator; over TCP with the key, if there is one. */
static int
connect_to(struct link *l, const struct target *to, enum msg_role role,
           struct rad_error *err)
{
    struct dial_key key;
    char address[sizeof to->host + sizeof to->port + 4];
    bool six = strchr(to->host, ':') != NULL, dialled;
    int rc;

    l->keyless = !to->local && !to->key[0];
    if (!to->local && to->key[0] &&
        (rc = keyfile_choose(to->key, role, key.id, key.secret, &key.expires,
                             err)) < 0)
        return rc;
    snprintf(address, sizeof address, six ? "[%s]:%s" : "%s:%s", to->host,
             to->port);
    dialled = dial(l->dialler, to->local ? to->path : address, 0,
                   to->local || l->keyless ? NULL : &key);
    explicit_bzero(&key, sizeof key);
    if (!dialled)
        fail(l, RAD_ENOMEM);
    else if (!wait_for(l, left_ms(l)))
        fail(l, UV_ETIMEDOUT);
    return l->why.code ? lost(l, err) : 0;
}

static int
introduce(struct link *l, enum msg_role role, struct rad_error *err)
{
    struct msg hello = { .type = MSG_HELLO };
    const struct msg *m;
    int rc;

    hello.hello.min = MSG_VERSION_MIN;
    hello.hello.max = MSG_VERSION;
    hello.hello.role = (uint8_t)role;
    hello.hello.name = hello.hello.address = "";
    hello.hello.program = PACKAGE_STRING;
    if ((rc = link_send(l, &hello, err)) < 0)
        return rc;
    rc = link_recv(l, left_ms(l), &m, err);
    if (rc < 0)
        return rc;
    if (rc == 0) {
        fail(l, UV_ETIMEDOUT);
        return lost(l, err);
    }
    if (m->type == MSG_REFUSE)
        return rad_fail(err, link_code(m->refuse.status),
                        "the coordinator at '%s' refuses: %s", l->name,
                        m->refuse.text);
    if (msg_common_version(l->version, l->version) == 0)
        return rad_fail(err, RAD_EPROTO,
                        "the coordinator at '%s' speaks protocol version %u, "
                        "not %u to %u",
                        l->name, l->version, MSG_VERSION_MIN, MSG_VERSION);
    return 0;
}

static struct link *
link_new(const struct link_where *where, const struct target *to)
{
    struct link *l = calloc(1, sizeof *l);

    if (!l)
        return NULL;
    l->where = *where;
    strcpy(l->name, to->text);
    l->version = MSG_VERSION;
    l->last = &l->first;
    l->dialler = dialler_new(where->loop, on_dialled, l);
    if (!l->dialler) {
        free(l);
        return NULL;
    }
    uv_timer_init(where->loop, &l->limit);
    l->limit.data = l;
    uv_update_time(where->loop);
    return l;
}

int
link_open(struct link **out, const struct link_where *where,
          const struct target *to, enum msg_role role, int timeout_ms,
          struct rad_error *err)
{
    struct link *l = link_new(where, to);
    int rc;

    *out = NULL;
    if (!l)
        return rad_fail_memory(err);
    l->until_ms = uv_now(where->loop) + (uint64_t)timeout_ms;
    rc = connect_to(l, to, role, err);
    if (rc == 0)
        rc = introduce(l, role, err);
    if (rc < 0) {
        link_close(l);
        return rc;
    }
    *out = l;
    return 0;
}

static void
on_closed(uv_handle_t *timer)
{
    ((struct link *)timer->data)->closed = true;
}

void
link_close(struct link *l)
{
    if (!l)
        return;
    conn_close(l->conn);
    l->conn = NULL;
    dialler_close(l->dialler);
    uv_close((uv_handle_t *)&l->limit, on_closed);
    while (!l->closed) /* other handles are closed in the same turn */
        uv_run(l->where.loop, UV_RUN_ONCE);
    while (open_letter(l))
        ;
    free(l);
}
