/* conn.c - see conn.h */
#include "config.h"

#include "net/conn.h"

#include "net/log.h"

#include <assert.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#define READ_BYTES  (64u << 10)
#define PLAIN_BYTES (16u << 10) /* what a record of TLS holds */

/* A connection of a user's with more unread answers than the one gets none of
 * its requests looked at, until there are less than the other. */
#define ANSWERS_HIGH (1u << 20)
#define ANSWERS_LOW  (256u << 10)

/* A user with more unread bytes than this gets none of the messages that it can
 * do without. */
#define SPARE_HIGH (8u << 20)

/* Short messages that are sent in one turn of the loop go out together, up to
 * so many bytes: a call of the system costs more than they do. */
#define CORK_BYTES (8u << 10)

/* Of what the socket took at once the owner hears with the next event of the
 * connection's, unless it is more than this, which somebody may wait for. */
#define OWED_BYTES (64u << 10)

#define SILENT_PINGS (CONN_DEAD_MS / CONN_PING_MS)

/* What was read, and is not looked at yet:
 *
 *        --- others are before it ---> GATE_LINE
 *   GATE_OPEN <--- its turn (fair.h) ------'
 *        --- ANSWERS_HIGH unread ----> GATE_UNREAD
 *        <--- ANSWERS_LOW -----------------'          */
enum conn_gate { GATE_OPEN, GATE_LINE, GATE_UNREAD };

/* Messages on their way out; owns its bytes until they are written. */
struct out {
    uv_write_t req;
    struct conn *conn;
    size_t len;   /* of bytes */
    size_t count; /* of the message, for whoever counts */
    uint8_t bytes[];
};

struct conn {
    union conn_stream *stream;
    struct tls *tls; /* NULL: messages go as they are */
    uint8_t *plain;  /* with tls: what was read of it */
    bool primed;     /* tls may have bytes that came with its handshake */
    uv_timer_t timer;
    uv_prepare_t before; /* the loop waits; and after it did: while there is */
    uv_check_t after;
    uint8_t *cork; /* room for CORK_BYTES; NULL: there was no need yet */
    size_t corked; /* bytes there that wait */
    size_t owed;   /* bytes that the owner is to be told were written */
    int handles;   /* still to be closed before c may go */
    const struct conn_handler *handler;
    void *arg;
    struct frame_reader reader;
    struct msg in;
    size_t queued;  /* bytes with libuv, and corked ones */
    size_t awaited; /* conn_expect() */
    uint64_t progress;
    uint64_t opened_ms;
    unsigned silent; /* PINGs that have gone out since the last byte came */
    struct rad_error end; /* why it ends */
    bool live, ping; /* conn_live() */
    bool paused;     /* conn_pause() */
    bool finishing;  /* conn_finish() */
    bool skipped;    /* something that it could do without, and logged */
    enum conn_gate gate;
    const uint8_t *rest; /* of buf, not looked at unless the gate is open */
    size_t nrest;
    struct fair_place place;
    bool closing;
    char peer[ADDRESS_TEXT];
    char buf[READ_BYTES];
};

/* An error for the log of those whose handler does not say that they hear of
 * it from closed(). */
#define tell(c, ...)                                                           \
    do {                                                                       \
        if (!(c)->handler->quiet)                                              \
            log_err(__VA_ARGS__);                                              \
    } while (0)

uv_stream_t *
conn_stream_new(uv_loop_t *loop, bool local)
{
    union conn_stream *s = calloc(1, sizeof *s);

    if (!s)
        return NULL;
    if (local)
        uv_pipe_init(loop, &s->pipe, 0);
    else
        uv_tcp_init(loop, &s->tcp);
    return &s->stream;
}

static void
free_stream(uv_handle_t *h)
{
    free(h);
}

void
conn_stream_close(uv_stream_t *stream)
{
    uv_close((uv_handle_t *)stream, free_stream);
}

long
conn_stream_uid(uv_stream_t *stream)
{
    struct ucred cred;
    socklen_t n = sizeof cred;
    int fd;

    if (stream->type != UV_NAMED_PIPE ||
        uv_fileno((uv_handle_t *)stream, &fd) < 0 ||
        getsockopt(fd, SOL_SOCKET, SO_PEERCRED, &cred, &n) < 0)
        return -1;
    return (long)cred.uid;
}

void
conn_stream_peer(uv_stream_t *stream, char text[ADDRESS_TEXT],
                 struct address *from)
{
    struct address a;
    int n = sizeof a.sa;

    memset(&a, 0, sizeof a);
    if (stream->type == UV_NAMED_PIPE)
        snprintf(text, ADDRESS_TEXT, "uid:%ld", conn_stream_uid(stream));
    else if (uv_tcp_getpeername((uv_tcp_t *)stream, &a.sa.any, &n) < 0)
        snprintf(text, ADDRESS_TEXT, "?"); /* it is gone already */
    else
        address_format(&a, text);
    if (from)
        *from = a;
}

static void reopen(struct conn *c);
static void hear_rest(struct conn *c);

/* Count bytes that wait to be written, and that do no more. */
static void
owe(struct conn *c, size_t n)
{
    c->queued += n;
    fair_owe(&c->place, n);
}

static void
paid(struct conn *c, size_t n)
{
    c->queued -= n;
    fair_paid(&c->place, n);
}

/* It stands in no line any more, and what it did not read is nobody's. */
static void
leave_user(struct conn *c)
{
    fair_paid(&c->place, c->queued + c->awaited);
    fair_leave(&c->place);
}

static void
handle_closed(uv_handle_t *h)
{
    struct conn *c = h->data;

    if (--c->handles > 0)
        return;
    frame_reader_release(&c->reader);
    msg_release(&c->in);
    tls_free(c->tls);
    free(c->plain);
    free(c->cork);
    free(c->stream);
    free(c);
}

static int uncork(struct conn *c);

void
conn_close(struct conn *c)
{
    if (!c || c->closing)
        return;
    c->closing = true;
    uncork(c); /* as much as the socket takes at once */
    leave_user(c);
    uv_close(&c->stream->handle, handle_closed);
    uv_close((uv_handle_t *)&c->timer, handle_closed);
    uv_close((uv_handle_t *)&c->before, handle_closed);
    uv_close((uv_handle_t *)&c->after, handle_closed);
}

/* The connection ends by itself: err is for the owner, why for its log. */
static void
end_with(struct conn *c, const struct rad_error *err, const char *why)
{
    if (c->closing)
        return;
    c->end = *err;
    if (!c->finishing)
        c->handler->closed(c->arg, c, why);
    conn_close(c);
}

static void
end(struct conn *c, int code, const char *why)
{
    struct rad_error err = { 0 };

    rad_fail(&err, code, "%s", why);
    end_with(c, &err, why);
}

static void
end_uv(struct conn *c, int code)
{
    end(c, code, code == UV_EOF ? "closed by peer" : uv_strerror(code));
}

void
conn_break(struct conn *c, const char *why)
{
    end(c, RAD_EUNAVAIL, why);
}

const struct rad_error *
conn_error(const struct conn *c)
{
    return &c->end;
}

static void
written(uv_write_t *req, int status)
{
    struct out *o = req->data;
    struct conn *c = o->conn;
    size_t n = o->count;

    paid(c, n);
    if (c->gate != GATE_OPEN)
        c->silent = 0; /* it reads: a sign of life */
    free(o);
    if (c->closing)
        return;
    if (status < 0) {
        hear_rest(c);
        end_uv(c, status);
        return;
    }
    if (c->finishing) {
        if (c->queued == 0)
            conn_close(c);
        return;
    }
    if (c->handler->written && n > 0)
        c->handler->written(c->arg, c, n);
    if (c->gate == GATE_UNREAD && c->queued < ANSWERS_LOW)
        reopen(c);
}

/* Hand o, which is counted, to libuv. */
static int
write_out(struct conn *c, struct out *o)
{
    uv_buf_t buf = uv_buf_init((char *)o->bytes, (unsigned)o->len);
    int rc;

    o->conn = c;
    o->req.data = o;
    rc = uv_write(&o->req, &c->stream->stream, &buf, 1, written);
    if (rc == 0)
        return 0;
    paid(c, o->count); /* no callback will come */
    free(o);
    return rc;
}

/* Messages in o go out; by TLS as its records. */
static int
seal_out(struct conn *c, struct out *o)
{
    struct rad_error err = { 0 };
    struct out *sealed;
    size_t n;

    o->count = o->len;
    if (!c->tls)
        return write_out(c, o);
    sealed = tls_seal(c->tls, o->bytes, o->len, sizeof *o, &n, &err);
    if (!sealed) { /* half of it may be in the session */
        tell(c, "messages not sent peer=%s: %s", c->peer, err.what);
        paid(c, o->count);
        free(o);
        return err.code == RAD_ENOMEM ? UV_ENOMEM : UV_EPROTO;
    }
    sealed->len = n;
    sealed->count = o->count;
    free(o);
    return write_out(c, sealed);
}

/* Room for what is corked as it goes over the wire. */
struct wire_form {
    uint8_t bytes[CORK_BYTES + (1u << 10)];
};

/* Seal what is corked: how many bytes come of it. */
static long
seal_cork(struct conn *c, struct wire_form *to)
{
    struct rad_error err = { 0 };
    long n;

    assert(tls_room(c->corked) <= sizeof to->bytes);
    n = tls_seal_into(c->tls, c->cork, c->corked, to->bytes, &err);
    if (n >= 0)
        return n;
    /* half of it may be in the session */
    tell(c, "messages not sent peer=%s: %s", c->peer, err.what);
    return UV_EPROTO;
}

/* Write what the socket takes now, which nearly always is all: that takes
 * neither memory nor another turn of the loop.  The rest is queued, and so is
 * all where there is an error, of which libuv tells then. */
static int
write_now(struct conn *c, const uint8_t *p, size_t n, size_t count)
{
    uv_buf_t buf = uv_buf_init((char *)p, (unsigned)n);
    int rc = c->owed < OWED_BYTES ? uv_try_write(&c->stream->stream, &buf, 1)
                                  : UV_EAGAIN;
    size_t did = rc > 0 ? (size_t)rc : 0;
    struct out *o = did < n ? malloc(sizeof *o + n - did) : NULL;

    if (o) {
        memcpy(o->bytes, p + did, n - did);
        o->len = n - did;
        o->count = count;
        return write_out(c, o);
    }
    paid(c, count);
    if (did < n)
        return UV_ENOMEM;
    c->owed += count;
    if (c->gate != GATE_OPEN)
        c->silent = 0; /* it reads: a sign of life */
    return 0;
}

static int
uncork(struct conn *c)
{
    size_t count = c->corked;
    struct wire_form sealed;
    long n;

    if (count == 0)
        return 0;
    n = c->tls ? seal_cork(c, &sealed) : (long)count;
    c->corked = 0;
    uv_prepare_stop(&c->before);
    if (n < 0) {
        paid(c, count);
        return (int)n;
    }
    return write_now(c, c->tls ? sealed.bytes : c->cork, (size_t)n, count);
}

static void
uncork_or_break(struct conn *c)
{
    int rc = uncork(c);

    if (rc < 0)
        end_uv(c, rc);
}

/* The turn of the loop is over. */
static void
end_turn(struct conn *c)
{
    uncork_or_break(c);
    if (c->finishing && c->queued == 0)
        conn_close(c);
}

static void
before_waiting(uv_prepare_t *h)
{
    end_turn(h->data);
}

/* Tell the owner of what was written at once. */
static void
settle(struct conn *c)
{
    size_t n = c->owed;

    c->owed = 0;
    if (c->corked == 0)
        uv_check_stop(&c->after);
    if (n == 0 || c->finishing)
        return;
    if (c->handler->written)
        c->handler->written(c->arg, c, n);
    if (!c->closing && c->gate == GATE_UNREAD && c->queued < ANSWERS_LOW)
        reopen(c);
}

static void
after_waiting(uv_check_t *h)
{
    struct conn *c = h->data;

    end_turn(c);
    if (!c->closing)
        settle(c);
}

/* Room for len bytes that wait for others of this turn; NULL: there is none. */
static uint8_t *
cork_room(struct conn *c, size_t len)
{
    if (!c->cork && !(c->cork = malloc(CORK_BYTES)))
        return NULL;
    if (c->corked == 0) {
        uv_prepare_start(&c->before, before_waiting);
        uv_check_start(&c->after, after_waiting);
    }
    c->corked += len;
    return c->cork + c->corked - len;
}

/* One that goes by itself. */
static int
queue_alone(struct conn *c, const uint8_t *bytes, size_t len)
{
    struct out *o = malloc(sizeof *o + len);

    if (!o)
        return UV_ENOMEM;
    memcpy(o->bytes, bytes, len);
    o->len = len;
    owe(c, len);
    return seal_out(c, o);
}

static int
queue_corked(struct conn *c, const uint8_t *bytes, size_t len)
{
    uint8_t *to = cork_room(c, len);

    if (!to)
        return UV_ENOMEM;
    memcpy(to, bytes, len);
    owe(c, len);
    return 0;
}

/* Queue bytes that the other side understands.  Where there is no memory for
 * them the connection ends: who waits for what never comes waits for ever, but
 * who has lost a connection calls again. */
static bool
queue(struct conn *c, const uint8_t *bytes, size_t len)
{
    int rc = len > CORK_BYTES - c->corked ? uncork(c) : 0;

    if (rc == 0)
        rc = len > CORK_BYTES ? queue_alone(c, bytes, len)
                              : queue_corked(c, bytes, len);
    if (rc == UV_ENOMEM)
        tell(c, "message not sent peer=%s: out of memory", c->peer);
    if (rc < 0)
        end_uv(c, rc);
    return rc == 0;
}

/* Queue what was packed in w, or say why it was not. */
static bool
queue_packed(struct conn *c, struct wire_out *w, int rc, uint16_t type)
{
    bool ok = rc >= 0 && queue(c, w->buf, w->len);

    if (rc == RAD_ENOMEM)
        end_uv(c, UV_ENOMEM);
    else if (rc < 0)
        tell(c,
             "message not sent peer=%s type=%s: too long, or none of "
             "protocol version %u",
             c->peer, msg_name(type), c->reader.version);
    wire_out_release(w);
    return ok;
}

static bool
to_user(const struct conn *c)
{
    return c->reader.session == MSG_AT_COORD_USER ||
           c->reader.session == MSG_AT_COORD_ADMIN;
}

/* Ambient records come as fast as workers make them, whether or not they are
 * read; they are worth time in a later job, and nothing else. */
static bool
skip(struct conn *c, uint16_t type)
{
    if (type != MSG_RECORDS || !to_user(c) || c->queued <= SPARE_HIGH)
        return false;
    if (!c->skipped)
        log_warn("ambient records dropped peer=%s: it reads too slowly",
                 c->peer);
    c->skipped = true;
    return true;
}

bool
conn_send_frame(struct conn *c, const uint8_t *bytes, size_t len)
{
    struct wire_out w;
    int rc;

    if (c->closing || c->finishing || skip(c, msg_frame_type(bytes, len)))
        return false;
    if (c->reader.version == MSG_VERSION)
        return queue(c, bytes, len);
    wire_out_init(&w, MSG_FRAME_MAX);
    rc = msg_frame_as(c->reader.version, &w, bytes, len);
    if (rc == 0)
        return queue(c, bytes, len);
    return queue_packed(c, &w, rc, msg_frame_type(bytes, len));
}

/* An alert or a key update of the session's own; counted or not. */
static void
flush(struct conn *c, bool counted)
{
    const uint8_t *p;
    size_t n = tls_out(c->tls, &p);
    struct out *o = n > 0 ? malloc(sizeof *o + n) : NULL;
    int rc;

    if (!o)
        return;
    memcpy(o->bytes, p, n);
    tls_sent(c->tls);
    o->len = n;
    o->count = counted ? n : 0;
    owe(c, o->count);
    rc = write_out(c, o);
    if (rc < 0)
        end_uv(c, rc);
}

bool
conn_send(struct conn *c, const struct msg *m)
{
    struct wire_out w;
    int rc;

    if (c->closing || c->finishing)
        return false;
    wire_out_init(&w, MSG_FRAME_MAX);
    rc = msg_pack_as(c->reader.version, &w, m);
    return queue_packed(c, &w, rc, m->type);
}

static void
answer_ping(struct conn *c, const struct msg *ping)
{
    struct msg pong = { .type = MSG_PONG, .request = ping->request };

    pong.pong.progress = ping->ping.progress;
    conn_send(c, &pong);
}

/* What came cannot be read. */
static void
garbage(struct conn *c, const struct rad_error *err)
{
    struct log_limit *limit = c->handler->errors;
    unsigned dropped = 0;

    if (err->code == RAD_ENOMEM) { /* for no fault of the other side's */
        tell(c, "message not read peer=%s: out of memory", c->peer);
        end_uv(c, UV_ENOMEM);
        return;
    }
    if (!c->handler->quiet &&
        (!limit || log_allowed(limit, uv_now(c->timer.loop), &dropped))) {
        if (dropped > 0)
            log_warn("protocol errors not logged n=%u", dropped);
        log_warn("protocol error peer=%s: %s", c->peer, err->what);
    }
    end_with(c, err, CONN_BROKE_PROTOCOL);
}

/* Has it asked for more than it reads?  Workers and peers are not asked: what
 * goes to them is bounded by other means. */
static bool
overfull(const struct conn *c)
{
    return to_user(c) && c->queued > ANSWERS_HIGH;
}

/* Look at no more of what came until the gate opens. */
static void
hold(struct conn *c, enum conn_gate gate, const uint8_t *p, size_t left)
{
    c->gate = gate;
    c->rest = p;
    c->nrest = left;
    uv_read_stop(&c->stream->stream);
}

/* The next message, if it is there whole, goes to the handler.  False: there is
 * none, or no connection any more. */
static bool
take_one(struct conn *c, const uint8_t **p, size_t *left)
{
    struct rad_error err = { 0 };
    int rc = frame_read(&c->reader, p, left, &c->in, &err);

    if (rc < 0) {
        rad_error_where(&err, "%s", c->peer);
        garbage(c, &err);
    }
    if (rc <= 0)
        return false;
    if (c->in.type == MSG_PING)
        answer_ping(c, &c->in);
    if (!c->closing) /* that may break it, and then its owner knows */
        c->handler->message(c->arg, c, &c->in);
    return !c->closing;
}

/* Bytes that were read: whole messages go to the handler. */
static void
take(struct conn *c, const uint8_t *p, size_t left)
{
    bool more = true;

    while (more && left > 0 && !c->closing && !c->finishing) {
        bool in_turn = to_user(c);

        if (in_turn && !fair_begin(&c->place)) {
            hold(c, GATE_LINE, p, left);
            return;
        }
        more = take_one(c, &p, &left);
        if (in_turn)
            fair_done(&c->place);
        if (more && overfull(c) && !c->finishing) {
            hold(c, GATE_UNREAD, p, left);
            return;
        }
    }
}

/* What came by TLS, as far as it may be looked at. */
static void
unseal(struct conn *c)
{
    struct rad_error err = { 0 };
    int n = 1;

    while (n > 0 && !c->closing && !c->finishing && c->gate == GATE_OPEN) {
        n = tls_read(c->tls, c->plain, PLAIN_BYTES, &err);
        if (n > 0)
            take(c, c->plain, (size_t)n);
    }
    if (c->closing || c->finishing)
        return;
    flush(c, false);
    if (n < 0)
        garbage(c, &err);
    else if (tls_ended(c->tls))
        end_uv(c, UV_EOF);
}

/* n bytes of c->buf have come. */
static void
hear(struct conn *c, size_t n)
{
    struct rad_error err = { 0 };

    c->silent = 0;
    if (!c->tls) {
        take(c, (const uint8_t *)c->buf, n);
    } else if (tls_put(c->tls, c->buf, n, &err) < 0) {
        garbage(c, &err);
    } else {
        unseal(c);
    }
}

static void
on_read(uv_stream_t *stream, ssize_t n, const uv_buf_t *buf)
{
    (void)buf; /* c->buf */
    if (n < 0)
        end_uv(stream->data, (int)n);
    else
        hear(stream->data, (size_t)n);
}

/* The other side has closed the connection while we write: what it said before,
 * as why it did, still lies ready. */
static void
hear_rest(struct conn *c)
{
    ssize_t n = 1;
    int fd;

    if (uv_fileno(&c->stream->handle, &fd) < 0)
        return;
    while (n > 0 && !c->closing && !c->finishing && !c->paused &&
           c->gate == GATE_OPEN) {
        n = read(fd, c->buf, sizeof c->buf);
        if (n > 0)
            hear(c, (size_t)n);
    }
}

static void
on_alloc(uv_handle_t *h, size_t wish, uv_buf_t *buf)
{
    struct conn *c = h->data;

    (void)wish;
    *buf = uv_buf_init(c->buf, sizeof c->buf);
}

/* It is its turn, or its answers have been read: go on with its requests. */
static void
reopen(struct conn *c)
{
    c->gate = GATE_OPEN;
    c->silent = 0;
    take(c, c->rest, c->nrest);
    if (c->tls && c->gate == GATE_OPEN)
        unseal(c);
    if (c->gate == GATE_OPEN && !c->paused && !c->closing && !c->finishing)
        uv_read_start(&c->stream->stream, on_alloc, on_read);
}

static void
on_turn(struct fair_place *place)
{
    struct conn *c =
        (struct conn *)((char *)place - offsetof(struct conn, place));

    if (c->gate == GATE_LINE && !c->closing && !c->finishing)
        reopen(c);
}

bool
conn_set_user(struct conn *c, struct fair *fair, const char *name)
{
    c->place.user = fair_join(fair, name);
    c->place.go = on_turn;
    fair_owe(&c->place, c->queued);
    return c->place.user != NULL;
}

static unsigned
limit_ms(const struct conn *c)
{
    return c->handler->limit_ms ? c->handler->limit_ms : CONN_HANDSHAKE_MS;
}

/* How often to look at the time. */
static unsigned
period_ms(const struct conn *c)
{
    return !c->live && limit_ms(c) < CONN_PING_MS ? limit_ms(c) : CONN_PING_MS;
}

/* It is silent because we do not look at what it says, and it has read all that
 * we said. */
static bool
is_patient(const struct conn *c)
{
    return c->gate == GATE_LINE && c->queued == 0;
}

static void
on_timer(uv_timer_t *timer)
{
    struct conn *c = timer->data;
    uint64_t now = uv_now(timer->loop);
    struct msg ping = { .type = MSG_PING };

    if (c->primed) {
        c->primed = false;
        uv_timer_start(timer, on_timer, period_ms(c), period_ms(c));
        unseal(c);
        return;
    }
    if (c->finishing || (!c->live && now - c->opened_ms >= limit_ms(c))) {
        end(c, UV_ETIMEDOUT, "took too long");
        return;
    }
    if (!c->live || !c->ping)
        return;
    /* counted in PINGs, not in time: whoever was busy outside the loop gets
     * the bytes that lie ready before the next PING */
    if (!c->paused && !is_patient(c) && c->silent++ >= SILENT_PINGS) {
        end(c, UV_ETIMEDOUT, "silent for 15 s");
        return;
    }
    ping.ping.progress = c->progress;
    conn_send(c, &ping);
}

struct conn *
conn_new(uv_stream_t *stream, struct tls *tls, enum msg_session session,
         const char *peer, const struct conn_handler *handler, void *arg)
{
    struct conn *c = calloc(1, sizeof *c);
    uint8_t *plain = tls ? malloc(PLAIN_BYTES) : NULL;

    assert(tls || stream->type != UV_TCP);
    if (!c || (tls && !plain)) {
        free(c);
        free(plain);
        tls_free(tls);
        conn_stream_close(stream);
        return NULL;
    }
    c->stream = (union conn_stream *)stream;
    c->stream->handle.data = c;
    c->tls = tls;
    c->plain = plain;
    c->handler = handler;
    c->arg = arg;
    c->handles = 4;
    snprintf(c->peer, sizeof c->peer, "%s", peer);
    /* messages are written whole; one that waited until those before it are
     * acknowledged would wait for 40 ms */
    if (stream->type == UV_TCP)
        uv_tcp_nodelay((uv_tcp_t *)stream, 1);
    frame_reader_init(&c->reader, session);
    uv_timer_init(stream->loop, &c->timer);
    uv_prepare_init(stream->loop, &c->before);
    uv_check_init(stream->loop, &c->after);
    c->timer.data = c->before.data = c->after.data = c;
    c->opened_ms = uv_now(stream->loop);
    c->primed = tls != NULL;
    uv_timer_start(&c->timer, on_timer, c->primed ? 0 : period_ms(c),
                   period_ms(c));
    uv_read_start(stream, on_alloc, on_read);
    return c;
}

uint8_t *
conn_keep(struct conn *c, struct msg *m, size_t *n)
{
    *n = c->reader.head.length;
    *m = c->in;
    c->in = (struct msg){ 0 };
    return frame_reader_take(&c->reader);
}

void
conn_flush(struct conn *c)
{
    if (!c->closing)
        uncork_or_break(c);
}

const char *
conn_key(const struct conn *c)
{
    return c->tls ? tls_id(c->tls) : NULL;
}

void
conn_set_version(struct conn *c, unsigned version)
{
    c->reader.version = version;
}

void
conn_set_session(struct conn *c, enum msg_session session)
{
    c->reader.session = session;
}

void
conn_live(struct conn *c, bool ping)
{
    bool often = period_ms(c) < CONN_PING_MS;

    c->live = true;
    c->ping = ping;
    if (often && !c->primed)
        uv_timer_start(&c->timer, on_timer, CONN_PING_MS, CONN_PING_MS);
}

void
conn_set_progress(struct conn *c, uint64_t progress)
{
    c->progress = progress;
}

bool
conn_expect(struct conn *c, size_t n)
{
    if (fair_full(&c->place))
        return false;
    c->awaited += n;
    fair_owe(&c->place, n);
    return true;
}

void
conn_expected(struct conn *c, size_t n)
{
    c->awaited -= n;
    fair_paid(&c->place, n);
}

size_t
conn_queued(const struct conn *c)
{
    return c->queued;
}

const char *
conn_peer(const struct conn *c)
{
    return c->peer;
}

void
conn_pause(struct conn *c, bool pause)
{
    if (c->closing || c->finishing || c->paused == pause)
        return;
    c->paused = pause;
    c->silent = 0; /* a silence of our own making does not count */
    if (pause)
        uv_read_stop(&c->stream->stream);
    else if (c->gate == GATE_OPEN)
        uv_read_start(&c->stream->stream, on_alloc, on_read);
}

void
conn_finish(struct conn *c)
{
    if (!c || c->closing)
        return;
    c->finishing = true;
    if (c->tls) { /* the session's last word comes last */
        uncork_or_break(c);
        if (!c->closing) {
            tls_end(c->tls);
            flush(c, true);
        }
        if (c->closing)
            return;
    }
    uv_read_stop(&c->stream->stream);
    if (c->queued == 0)
        conn_close(c);
    else
        uv_timer_start(&c->timer, on_timer, CONN_HANDSHAKE_MS, 0);
}
