/* link.c - see link.h
 *
 * Bytes that arrive are kept until link_recv() cuts messages from them; above
 * a mark reading stops, so that a coordinator cannot fill our memory.  Only
 * the handles' callbacks touch the struct behind a caller's back, and all that
 * they do is to set `failed`, `done` or the input. */
#include "config.h"

#include "link/link.h"

#include "proto/frame.h"
#include "net/key/keyfile.h"
#include "net/tls.h"

#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <time.h>

enum {
    READ_SIZE = 1 << 16,
    INPUT_MARK = 4 << 20, /* stop reading above */
    QUEUE_MARK = 1 << 20, /* stop sending above */
    PING_MS = 5000,
    SILENT_PINGS = 3 /* so many without a byte: 15 s */
};

struct link {
    struct link_where where;
    char name[sizeof((struct target *)0)->text];
    union {
        uv_stream_t stream;
        uv_pipe_t pipe;
        uv_tcp_t tcp;
    } s;
    bool stream_open;
    struct tls_ctx *tls_ctx;
    struct tls *tls;      /* NULL: a Unix socket */
    bool proven;          /* its handshake is over */
    char *raw;            /* READ_SIZE bytes, of TLS */
    struct rad_error why; /* of TLS, when failed is its code */
    uv_timer_t ping;      /* sends PINGs, notices silence */
    uv_timer_t limit;     /* of one wait */
    uv_connect_t connect;
    struct resolving *resolving;
    int nhandles; /* open ones */
    bool done;    /* what a wait is for */
    int failed;   /* UV_E* or RAD_E*; 0 while the link is sound */
    bool timeout;
    bool welcome;      /* the handshake is over */
    uint64_t until_ms; /* when opening must be over, in the loop's time */
    int silent;        /* PINGs since the last byte */
    struct frame_reader reader;
    struct msg in;
    uint8_t *input; /* bytes not cut up yet: start..end of cap */
    size_t start, end, cap;
    bool reading;
};

/* A name that is looked up.  A resolver cannot be stopped, so it may outlive
 * the link: l is NULL then. */
struct resolving {
    uv_getaddrinfo_t req;
    struct link *l;
};

/* One write; owns its bytes until it is done. */
struct outgoing {
    uv_write_t req;
    uint8_t *bytes;
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

static int
lost(struct link *l, struct rad_error *err)
{
    int code = l->failed;

    if (code == UV_EOF)
        return rad_fail(err, RAD_EUNAVAIL,
                        "the coordinator at '%s' closed the connection",
                        l->name);
    if (code == UV_ETIMEDOUT)
        return rad_fail(err, RAD_EUNAVAIL,
                        "the coordinator at '%s' does not answer", l->name);
    if (l->why.code == code && code != 0)
        return rad_fail(err, code, "the coordinator at '%s': %s", l->name,
                        l->why.what);
    if (code == RAD_ENOMEM)
        return rad_fail(err, code, "out of memory");
    if (code == RAD_EPROTO)
        return rad_fail(err, code, "'%s' breaks the protocol", l->name);
    return rad_fail(err, RAD_EUNAVAIL, "no coordinator at '%s': %s", l->name,
                    code == UV_EAI_NONAME ? "no such host" : uv_strerror(code));
}

static void
fail(struct link *l, int code)
{
    if (l->failed == 0)
        l->failed = code;
}

static void
on_limit(uv_timer_t *t)
{
    ((struct link *)t->data)->timeout = true;
}

/* Run the loop until `done`, a failure, the time (ms < 0: none) or a wake.
 * True when done. */
static bool
wait_for(struct link *l, int ms)
{
    int wake = *l->where.wake;

    l->timeout = false;
    if (ms >= 0)
        uv_timer_start(&l->limit, on_limit, (uint64_t)ms, 0);
    while (!l->done && !l->failed && !l->timeout && *l->where.wake == wake)
        uv_run(l->where.loop, UV_RUN_ONCE);
    uv_timer_stop(&l->limit);
    return l->done && !l->failed;
}

/* --- input --- */

/* Room for READ_SIZE bytes more. */
static bool
make_room(struct link *l)
{
    size_t cap = l->cap ? 2 * l->cap : 4 * READ_SIZE;
    uint8_t *p;

    if (l->start > 0) {
        memmove(l->input, l->input + l->start, l->end - l->start);
        l->end -= l->start;
        l->start = 0;
    }
    if (l->cap - l->end >= READ_SIZE)
        return true;
    p = realloc(l->input, cap);
    if (!p)
        return false;
    l->input = p;
    l->cap = cap;
    return true;
}

static void
on_alloc(uv_handle_t *h, size_t suggested, uv_buf_t *buf)
{
    struct link *l = h->data;

    (void)suggested;
    if (!make_room(l))
        *buf = uv_buf_init(NULL, 0); /* on_read gets UV_ENOBUFS */
    else
        *buf =
            uv_buf_init(l->tls ? l->raw : (char *)l->input + l->end, READ_SIZE);
}

/* All that came by TLS becomes input. */
static void
unseal(struct link *l)
{
    int n = 1;

    while (n > 0 && l->proven) {
        if (!make_room(l)) {
            fail(l, RAD_ENOMEM);
            return;
        }
        n = tls_read(l->tls, l->input + l->end, READ_SIZE, &l->why);
        if (n > 0)
            l->end += (size_t)n;
        else if (n < 0)
            fail(l, n);
        else if (tls_ended(l->tls))
            fail(l, UV_EOF);
    }
}

static void
on_read(uv_stream_t *s, ssize_t n, const uv_buf_t *buf)
{
    struct link *l = s->data;
    int rc;

    if (n < 0) {
        uv_read_stop(s);
        l->reading = false;
        fail(l, n == UV_ENOBUFS ? RAD_ENOMEM : (int)n);
        return;
    }
    if (!l->tls)
        l->end += (size_t)n;
    else if ((rc = tls_put(l->tls, buf->base, (size_t)n, &l->why)) < 0)
        fail(l, rc);
    else
        unseal(l);
    l->silent = 0;
    l->done = true;
    if (l->end - l->start > INPUT_MARK) {
        uv_read_stop(s);
        l->reading = false;
    }
}

static void
keep_reading(struct link *l)
{
    if (l->reading || l->failed || l->end - l->start > INPUT_MARK / 2)
        return;
    if (uv_read_start(&l->s.stream, on_alloc, on_read) == 0)
        l->reading = true;
}

/* --- output --- */

static void
on_written(uv_write_t *req, int status)
{
    struct outgoing *o = (struct outgoing *)req;
    struct link *l = req->data;

    if (status < 0 && status != UV_ECANCELED)
        fail(l, status);
    l->done = true; /* there is room again */
    free(o->bytes);
    free(o);
}

/* Takes the bytes. */
static void
write_out(struct link *l, struct outgoing *o, uint8_t *bytes, size_t n)
{
    uv_buf_t buf = uv_buf_init((char *)bytes, (unsigned)n);
    int rc;

    o->bytes = bytes;
    o->req.data = l;
    rc = uv_write(&o->req, &l->s.stream, &buf, 1, on_written);
    if (rc < 0) {
        fail(l, rc);
        free(o->bytes);
        free(o);
    }
}

/* A message's bytes as they go out; takes them.  NULL when that fails. */
static uint8_t *
seal(struct link *l, uint8_t *bytes, size_t *n)
{
    uint8_t *sealed;
    size_t len = *n;

    if (!l->tls)
        return bytes;
    sealed = tls_seal(l->tls, bytes, len, 0, n, &l->why);
    free(bytes);
    return sealed;
}

static int
queue(struct link *l, const struct msg *m, struct rad_error *err)
{
    struct wire_out out;
    struct outgoing *o = malloc(sizeof *o);
    uint8_t *bytes;
    size_t n;
    int rc;

    if (l->reader.version < msg_since(m->type)) {
        free(o);
        return rad_fail(err, RAD_EPROTO,
                        "the coordinator at '%s' is too old to be asked that: "
                        "it speaks protocol version %u",
                        l->name, l->reader.version);
    }
    wire_out_init(&out, MSG_FRAME_MAX);
    rc = o ? msg_pack_as(l->reader.version, &out, m) : RAD_ENOMEM;
    if (rc < 0) {
        wire_out_release(&out);
        free(o);
        return rad_fail(err, rc,
                        rc == RAD_ENOMEM ? "out of memory"
                                         : "%s: too long to be sent",
                        msg_name(m->type));
    }
    n = out.len;
    bytes = seal(l, out.buf, &n);
    if (!bytes) {
        free(o);
        fail(l, l->why.code);
    } else {
        write_out(l, o, bytes, n);
    }
    return l->failed ? lost(l, err) : 0;
}

int
link_send(struct link *l, const struct msg *m, struct rad_error *err)
{
    int rc = l->failed ? lost(l, err) : queue(l, m, err);
    int wake = *l->where.wake;

    /* an interrupt leaves the message queued and the caller to decide */
    while (rc == 0 && *l->where.wake == wake &&
           uv_stream_get_write_queue_size(&l->s.stream) > QUEUE_MARK) {
        l->done = false;
        wait_for(l, -1);
        if (l->failed)
            rc = lost(l, err);
    }
    return rc;
}

static void
on_ping(uv_timer_t *t)
{
    struct link *l = t->data;
    struct msg ping = { .type = MSG_PING };

    /* counted in PINGs, not in time: a caller that was busy elsewhere gets
     * the bytes that lie ready before the next one */
    if (l->reading && l->silent++ >= SILENT_PINGS)
        fail(l, UV_ETIMEDOUT);
    else if (l->welcome)
        queue(l, &ping, NULL);
}

/* --- messages --- */

/* Cut one message from the input; 1, 0 when more bytes are needed. */
static int
cut(struct link *l, struct rad_error *err)
{
    const uint8_t *p = l->input + l->start;
    size_t n = l->end - l->start;
    int rc = 0;

    if (n > 0) {
        rc = frame_read(&l->reader, &p, &n, &l->in, err);
        l->start = l->end - n;
    }
    if (rc < 0) {
        fail(l, rc);
        rad_error_where(err, "%s", l->name);
    }
    keep_reading(l);
    return rc;
}

/* Messages that belong to the link itself; true if it was one. */
static bool
handle_own(struct link *l)
{
    struct msg pong = { .type = MSG_PONG, .request = l->in.request };

    if (l->in.type == MSG_PONG)
        return true;
    if (l->in.type != MSG_PING)
        return false;
    pong.pong.progress = l->in.ping.progress;
    queue(l, &pong, NULL);
    return true;
}

int
link_recv(struct link *l, int timeout_ms, const struct msg **m,
          struct rad_error *err)
{
    uint64_t until = uv_now(l->where.loop) + (uint64_t)timeout_ms, now;
    int rc;

    for (;;) {
        rc = cut(l, err); /* what has come is read even from a closed link */
        if (rc < 0)
            return rc;
        if (rc == 1) {
            if (handle_own(l))
                continue;
            *m = &l->in;
            if (l->in.type != MSG_BYE)
                return 1;
            fail(l, UV_EOF);
        }
        if (l->failed)
            return lost(l, err);
        now = uv_now(l->where.loop);
        l->done = false;
        if (!wait_for(l, now < until ? (int)(until - now) : 0) && !l->failed)
            return 0;
    }
}

/* --- opening and closing --- */

static void
on_connected(uv_connect_t *req, int status)
{
    struct link *l = req->data;

    if (status < 0)
        fail(l, status);
    else
        l->done = true;
}

static void
on_resolved(uv_getaddrinfo_t *req, int status, struct addrinfo *found)
{
    struct resolving *r = (struct resolving *)req;

    (void)found; /* in req->addrinfo */
    if (!r->l) {
        uv_freeaddrinfo(req->addrinfo);
        free(r);
    } else if (status < 0) {
        fail(r->l, status);
    } else {
        r->l->done = true;
    }
}

static void
on_closed(uv_handle_t *h)
{
    ((struct link *)h->data)->nhandles--;
}

static void
close_stream(struct link *l)
{
    if (l->stream_open)
        uv_close((uv_handle_t *)&l->s.stream, on_closed);
    l->stream_open = l->reading = false;
}

/* What is left of the time to open the link. */
static int
left_ms(const struct link *l)
{
    uint64_t now = uv_now(l->where.loop);

    return now < l->until_ms ? (int)(l->until_ms - now) : 0;
}

/* Look the host up; the addresses stay in l->resolving. */
static void
resolve(struct link *l, const struct target *to)
{
    struct addrinfo hints = { .ai_socktype = SOCK_STREAM };
    struct resolving *r = calloc(1, sizeof *r);
    int rc;

    if (!r) {
        fail(l, RAD_ENOMEM);
        return;
    }
    r->l = l;
    rc = uv_getaddrinfo(l->where.loop, &r->req, on_resolved, to->host, to->port,
                        &hints);
    if (rc < 0) {
        fail(l, rc);
        free(r);
    } else if (wait_for(l, left_ms(l)) || l->failed) {
        l->resolving = r; /* it is through */
    } else {
        fail(l, UV_ETIMEDOUT);
        r->l = NULL;
    }
}

static bool
is_loopback(const struct sockaddr *sa)
{
    if (sa->sa_family == AF_INET) {
        const struct sockaddr_in *in = (const struct sockaddr_in *)sa;

        return (ntohl(in->sin_addr.s_addr) >> 24) == 127;
    }
    return sa->sa_family == AF_INET6 &&
           IN6_IS_ADDR_LOOPBACK(&((const struct sockaddr_in6 *)sa)->sin6_addr);
}

static void
no_key(struct link *l)
{
    fail(l, rad_fail(&l->why, RAD_EPERM,
                     "it asks for a key: use --key or RADD_KEY"));
}

/* Without a key another machine is not called at all, and on this one it is
 * only seen whether there is anybody. */
static void
connect_address(struct link *l, const struct sockaddr *sa)
{
    int rc;

    if (!l->tls && !is_loopback(sa)) {
        no_key(l);
        return;
    }
    uv_tcp_init(l->where.loop, &l->s.tcp);
    l->s.tcp.data = l;
    l->stream_open = true;
    l->nhandles++;
    uv_tcp_nodelay(&l->s.tcp, 1);
    rc = uv_tcp_connect(&l->connect, &l->s.tcp, sa, on_connected);
    if (rc < 0)
        fail(l, rc);
    else if (!wait_for(l, left_ms(l)))
        fail(l, UV_ETIMEDOUT);
    else if (!l->tls)
        no_key(l);
}

/* Try one address after the other; the last one's reason remains. */
static void
connect_tcp(struct link *l, const struct target *to)
{
    resolve(l, to);
    if (l->failed)
        return;
    for (struct addrinfo *a = l->resolving->req.addrinfo; a; a = a->ai_next) {
        l->failed = 0;
        l->done = false;
        connect_address(l, a->ai_addr);
        if (l->failed == 0 || l->failed == RAD_EPERM)
            break;
        close_stream(l);
        while (l->nhandles > 2) /* the two timers stay */
            uv_run(l->where.loop, UV_RUN_ONCE);
    }
}

static void
connect_local(struct link *l, const struct target *to)
{
    uv_pipe_init(l->where.loop, &l->s.pipe, 0);
    l->s.pipe.data = l;
    l->stream_open = true;
    l->nhandles++;
    uv_pipe_connect(&l->connect, &l->s.pipe, to->path, on_connected);
    if (!wait_for(l, left_ms(l)))
        fail(l, UV_ETIMEDOUT);
}

/* The session of the key that the user's file has for that role. */
static int
open_tls(struct link *l, const struct target *to, enum msg_role role,
         struct rad_error *err)
{
    struct keyfile f;
    const struct key *k;
    char id[KEY_ID];
    int rc;

    if (!to->key[0]) /* see connect_address() */
        return 0;
    if ((rc = keyfile_load(&f, to->key, err)) < 0)
        return rc;
    k = keyfile_choice(&f, role, (int64_t)time(NULL));
    if (k) {
        key_id(k, id);
        l->tls_ctx = tls_client();
        l->tls = l->tls_ctx ? tls_dial(l->tls_ctx, id, k->secret) : NULL;
        l->raw = malloc(READ_SIZE);
    }
    keyfile_release(&f);
    if (!k)
        return rad_fail(err, RAD_EPERM, "there is no key in '%s'", to->key);
    return l->tls && l->raw ? 0 : rad_fail(err, RAD_ENOMEM, "out of memory");
}

bool
link_may_be_admin(const struct target *to)
{
    struct keyfile f;
    bool may;

    if (to->local || keyfile_load(&f, to->key, NULL) < 0)
        return to->local;
    may = keyfile_best(&f, MSG_ROLE_ADMIN, (int64_t)time(NULL)) != NULL;
    keyfile_release(&f);
    return may;
}

/* What the session has to say for itself. */
static void
flush_tls(struct link *l)
{
    const uint8_t *p;
    size_t n = tls_out(l->tls, &p);
    struct outgoing *o = n > 0 ? malloc(sizeof *o) : NULL;
    uint8_t *bytes = o ? malloc(n) : NULL;

    if (n == 0)
        return;
    if (!bytes) {
        free(o);
        fail(l, RAD_ENOMEM);
        return;
    }
    memcpy(bytes, p, n);
    tls_sent(l->tls);
    write_out(l, o, bytes, n);
}

/* Both sides prove that they have the key. */
static void
prove(struct link *l)
{
    int rc = 0;

    keep_reading(l);
    while (!l->failed) {
        rc = tls_handshake(l->tls, &l->why);
        flush_tls(l);
        if (rc < 0)
            fail(l, rc);
        if (rc != 0)
            break;
        l->done = false;
        if (!wait_for(l, left_ms(l)))
            fail(l, UV_ETIMEDOUT);
    }
    l->proven = rc == 1;
    unseal(l);
}

static int
handshake(struct link *l, enum msg_role role, struct rad_error *err)
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
    keep_reading(l);
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
    if (msg_common_version(m->welcome.version, m->welcome.version) == 0)
        return rad_fail(err, RAD_EPROTO,
                        "the coordinator at '%s' speaks protocol version %u, "
                        "not %u to %u",
                        l->name, m->welcome.version, MSG_VERSION_MIN,
                        MSG_VERSION);
    l->reader.version = m->welcome.version;
    l->reader.session = MSG_AT_CLIENT;
    l->welcome = true;
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
    frame_reader_init(&l->reader, MSG_AT_DIALLER);
    uv_timer_init(where->loop, &l->ping);
    uv_timer_init(where->loop, &l->limit);
    l->ping.data = l->limit.data = l->connect.data = l;
    l->nhandles = 2;
    uv_update_time(where->loop);
    return l;
}

int
link_open(struct link **out, const struct link_where *where,
          const struct target *to, enum msg_role role, int timeout_ms,
          struct rad_error *err)
{
    struct link *l = link_new(where, to);
    int rc = 0;

    *out = NULL;
    if (!l)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    l->until_ms = uv_now(where->loop) + (uint64_t)timeout_ms;
    if (to->local)
        connect_local(l, to);
    else if ((rc = open_tls(l, to, role, err)) == 0)
        connect_tcp(l, to);
    if (rc == 0 && l->tls && !l->failed)
        prove(l);
    if (rc == 0 && l->failed)
        rc = lost(l, err);
    if (rc == 0) {
        uv_timer_start(&l->ping, on_ping, PING_MS, PING_MS);
        rc = handshake(l, role, err);
    }
    if (rc < 0) {
        link_close(l);
        return rc;
    }
    *out = l;
    return 0;
}

void
link_close(struct link *l)
{
    if (!l)
        return;
    close_stream(l);
    uv_close((uv_handle_t *)&l->ping, on_closed);
    uv_close((uv_handle_t *)&l->limit, on_closed);
    while (l->nhandles > 0)
        uv_run(l->where.loop, UV_RUN_ONCE);
    if (l->resolving) {
        uv_freeaddrinfo(l->resolving->req.addrinfo);
        free(l->resolving);
    }
    frame_reader_release(&l->reader);
    msg_release(&l->in);
    tls_free(l->tls);
    tls_ctx_free(l->tls_ctx);
    free(l->raw);
    free(l->input);
    free(l);
}

unsigned
link_version(const struct link *l)
{
    return l->reader.version;
}
