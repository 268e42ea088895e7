/* conn_out.c - output of a connection, and its end: see conn_impl.h
 *
 * Messages are corked for a turn of the loop, encrypted if there is TLS, and
 * written at once as far as the socket takes them.  libuv gets the rest. */
#include "config.h"

#include "net/conn_impl.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* A user with more unread bytes than this gets no RECORDS. */
#define SPARE_HIGH (8u << 20)

/* Short messages of one turn of the loop are written together, up to so many
 * bytes: a system call costs more than they do. */
#define CORK_BYTES (8u << 10)

/* The owner hears of bytes that the socket took at once at the end of the
 * loop's turn.  If these are more than this, further bytes go by libuv, so that
 * it hears of them as they leave. */
#define OWED_BYTES (64u << 10)

/* A write request of libuv's, with its bytes. */
struct out {
    uv_write_t req;
    struct conn *conn;
    size_t len;   /* size of bytes[], as they go to the socket */
    size_t count; /* bytes of messages in bytes[], before TLS */
    uint8_t bytes[];
};

void
conn_out_set_state(struct conn *c, enum conn_state to)
{
    static const bool may[][CONN_CLOSED + 1] = {
        [CONN_NEW] = { [CONN_LIVE] = true,
                       [CONN_FINISHING] = true,
                       [CONN_CLOSED] = true },
        [CONN_LIVE] = { [CONN_FINISHING] = true, [CONN_CLOSED] = true },
        [CONN_FINISHING] = { [CONN_CLOSED] = true },
        [CONN_CLOSED] = { false },
    };

    assert(may[c->state][to]);
    (void)may; /* unused with NDEBUG */
    c->state = to;
}

bool
conn_out_is_over(const struct conn *c)
{
    return c->state == CONN_FINISHING || c->state == CONN_CLOSED;
}

/* Count n more bytes as waiting to be written, or n less. */
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
    if (c->queued == 0)
        c->updates = 0;
    fair_paid(&c->place, n);
}

/* A connection that ends stands in no line, and its unread bytes count for no
 * user. */
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
    if (!c || c->state == CONN_CLOSED)
        return;
    conn_out_set_state(c, CONN_CLOSED);
    uncork(c); /* write what the socket takes at once */
    leave_user(c);
    uv_close(&c->stream->handle, handle_closed);
    uv_close((uv_handle_t *)&c->timer, handle_closed);
    uv_close((uv_handle_t *)&c->before, handle_closed);
    uv_close((uv_handle_t *)&c->after, handle_closed);
}

void
conn_out_end_with(struct conn *c, const struct rad_error *err, const char *why)
{
    if (c->state == CONN_CLOSED)
        return;
    c->end = *err;
    if (c->state != CONN_FINISHING)
        c->handler->closed(c->arg, c, why);
    conn_close(c);
}

void
conn_out_end(struct conn *c, int code, const char *why)
{
    struct rad_error err = { 0 };

    rad_fail(&err, code, "%s", why);
    conn_out_end_with(c, &err, why);
}

void
conn_out_end_uv(struct conn *c, int code)
{
    conn_out_end(c, code,
                 code == UV_EOF ? "closed by peer" : uv_strerror(code));
}

void
conn_break(struct conn *c, const char *why)
{
    conn_out_end(c, RAD_EUNAVAIL, why);
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
        c->silent = 0; /* the other side reads: a sign of life */
    free(o);
    if (c->state == CONN_CLOSED)
        return;
    if (status < 0) {
        c->hear_rest(c);
        conn_out_end_uv(c, status);
        return;
    }
    if (c->state == CONN_FINISHING) {
        if (c->queued == 0)
            conn_close(c);
        return;
    }
    if (c->handler->written && n > 0)
        c->handler->written(c->arg, c, n);
    if (c->gate == GATE_UNREAD && c->queued < ANSWERS_LOW)
        c->reopen(c);
}

/* Give o, which is counted, to libuv. */
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

/* Write the messages in o, encrypted if there is TLS. */
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
    if (!sealed) { /* the session may have half of them: useless now */
        conn_tell(c, "messages not sent peer=%s: %s", c->peer, err.what);
        paid(c, o->count);
        free(o);
        return err.code == RAD_ENOMEM ? UV_ENOMEM : UV_EPROTO;
    }
    sealed->len = n;
    sealed->count = o->count;
    free(o);
    return write_out(c, sealed);
}

/* Room for the corked messages once they are encrypted. */
struct wire_form {
    uint8_t bytes[CORK_BYTES + (1u << 10)];
};

/* Encrypt the corked messages; returns their size then, or a negative code. */
static long
seal_cork(struct conn *c, struct wire_form *to)
{
    struct rad_error err = { 0 };
    long n;

    assert(tls_room(c->corked) <= sizeof to->bytes);
    n = tls_seal_into(c->tls, c->cork, c->corked, to->bytes, &err);
    if (n >= 0)
        return n;
    /* the session may have half of them, so it is useless now */
    conn_tell(c, "messages not sent peer=%s: %s", c->peer, err.what);
    return UV_EPROTO;
}

/* Write what the socket takes now, nearly always all of it: that needs neither
 * memory nor another turn of the loop.  libuv gets the rest, or everything if
 * there is an error, which it then reports. */
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
        c->silent = 0; /* the other side reads: a sign of life */
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

void
conn_out_uncork(struct conn *c)
{
    int rc = uncork(c);

    if (rc < 0)
        conn_out_end_uv(c, rc);
}

/* At the end of the loop's turn: write the corked messages. */
static void
end_turn(struct conn *c)
{
    conn_out_uncork(c);
    if (c->state == CONN_FINISHING && c->queued == 0)
        conn_close(c);
}

static void
before_waiting(uv_prepare_t *h)
{
    end_turn(h->data);
}

/* Tell the owner what was written at once. */
static void
settle(struct conn *c)
{
    size_t n = c->owed;

    c->owed = 0;
    if (c->corked == 0)
        uv_check_stop(&c->after);
    if (n == 0 || c->state == CONN_FINISHING)
        return;
    if (c->handler->written)
        c->handler->written(c->arg, c, n);
    if (c->state != CONN_CLOSED && c->gate == GATE_UNREAD &&
        c->queued < ANSWERS_LOW)
        c->reopen(c);
}

static void
after_waiting(uv_check_t *h)
{
    struct conn *c = h->data;

    end_turn(c);
    if (c->state != CONN_CLOSED)
        settle(c);
}

/* Room for len bytes of a corked message; NULL: memory is out. */
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

/* Write a long message by itself. */
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

/* Queue a packed message.  If memory is out the connection ends: the other side
 * would wait for ever for a message that is lost, but dials again when the
 * connection is. */
static bool
queue(struct conn *c, const uint8_t *bytes, size_t len)
{
    int rc = len > CORK_BYTES - c->corked ? uncork(c) : 0;

    if (rc == 0)
        rc = len > CORK_BYTES ? queue_alone(c, bytes, len)
                              : queue_corked(c, bytes, len);
    if (rc == UV_ENOMEM)
        conn_tell(c, "message not sent peer=%s: out of memory", c->peer);
    if (rc < 0)
        conn_out_end_uv(c, rc);
    return rc == 0;
}

static void
tell_not_sent(struct conn *c, uint16_t type)
{
    conn_tell(c,
              "message not sent peer=%s type=%s: too long, or none of "
              "protocol version %u",
              c->peer, msg_name(type), c->reader.version);
}

bool
conn_out_to_user(const struct conn *c)
{
    return c->reader.session == MSG_AT_COORD_USER ||
           c->reader.session == MSG_AT_COORD_ADMIN ||
           c->reader.session == MSG_AT_COORD_OBSERVER;
}

/* Skip RECORDS to a user who reads too slowly.  Workers make records as fast as
 * they can; a lost one only costs a later job some time. */
static bool
skip(struct conn *c, uint16_t type)
{
    if (type != MSG_RECORDS || !conn_out_to_user(c) || c->queued <= SPARE_HIGH)
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
    uint16_t type = msg_frame_type(bytes, len);

    if (conn_out_is_over(c) || skip(c, type))
        return false;
    if (c->reader.version >= msg_since(type))
        return queue(c, bytes, len);
    tell_not_sent(c, type);
    return false;
}

bool
conn_send(struct conn *c, const struct msg *m)
{
    struct wire_out w;
    bool ok;
    int rc;

    if (conn_out_is_over(c))
        return false;
    wire_out_init(&w, MSG_FRAME_MAX);
    rc = msg_pack_as(c->reader.version, &w, m);
    ok = rc >= 0 && queue(c, w.buf, w.len);
    if (rc == RAD_ENOMEM)
        conn_out_end_uv(c, UV_ENOMEM);
    else if (rc < 0)
        tell_not_sent(c, m->type);
    wire_out_release(&w);
    return ok;
}

void
conn_out_flush(struct conn *c)
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
    o->count = n;
    owe(c, n);
    c->updates += n;
    rc = write_out(c, o);
    if (rc < 0)
        conn_out_end_uv(c, rc);
}

void
conn_flush(struct conn *c)
{
    if (c->state != CONN_CLOSED)
        conn_out_uncork(c);
}

size_t
conn_queued(const struct conn *c)
{
    return c->queued;
}
