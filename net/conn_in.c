/* conn_in.c - input of a connection: see conn_impl.h
 *
 * Bytes become messages, and each goes to the owner, as long as the gate is
 * open. */
#include "config.h"

#include "net/conn_impl.h"

#include <stddef.h>
#include <unistd.h>

static void
answer_ping(struct conn *c, const struct msg *ping)
{
    struct msg pong = { .type = MSG_PONG,
                        .request = ping->request,
                        .pong = ping->ping };

    conn_send(c, &pong);
}

/* End the connection, for a message cannot be read. */
static void
garbage(struct conn *c, const struct rad_error *err)
{
    struct log_limit *limit = c->handler->errors;
    unsigned dropped = 0;

    if (err->code == RAD_ENOMEM) { /* not the other side's fault */
        conn_tell(c, "message not read peer=%s: out of memory", c->peer);
        conn_out_end_uv(c, UV_ENOMEM);
        return;
    }
    if (!c->handler->quiet &&
        (!limit || log_allowed(limit, uv_now(c->timer.loop), &dropped))) {
        if (dropped > 0)
            log_warn("protocol errors not logged n=%u", dropped);
        log_warn("protocol error peer=%s: %s", c->peer, err->what);
    }
    conn_out_end_with(c, err, CONN_BROKE_PROTOCOL);
}

/* Has a user, or a caller that has not said who it is, asked for more than it
 * reads?  For workers and peers other limits hold. */
static bool
overfull(const struct conn *c)
{
    return (conn_out_to_user(c) || c->state == CONN_NEW) &&
           c->queued > ANSWERS_HIGH;
}

/* Keep the bytes that were read, and read no more, until the gate opens. */
static void
hold(struct conn *c, enum conn_gate gate, const uint8_t *p, size_t left)
{
    c->gate = gate;
    c->rest = p;
    c->nrest = left;
    uv_read_stop(&c->stream->stream);
}

/* Give the next message to the handler, if it is whole.  False: it is not, or
 * the connection has ended. */
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
    if (c->state != CONN_CLOSED) /* else it has ended, and the owner knows */
        c->handler->message(c->arg, c, &c->in);
    return c->state != CONN_CLOSED;
}

/* Handle bytes that were read, message by message. */
static void
take(struct conn *c, const uint8_t *p, size_t left)
{
    bool more = true;

    while (more && left > 0 && !conn_out_is_over(c)) {
        bool in_turn = conn_out_to_user(c);

        if (in_turn && !fair_begin(&c->place)) {
            hold(c, GATE_LINE, p, left);
            return;
        }
        more = take_one(c, &p, &left);
        if (in_turn)
            fair_done(&c->place);
        if (more && overfull(c) && c->state != CONN_FINISHING) {
            hold(c, GATE_UNREAD, p, left);
            return;
        }
    }
}

void
conn_in_unseal(struct conn *c)
{
    struct rad_error err = { 0 };
    int n = 1;

    while (n > 0 && !conn_out_is_over(c) && c->gate == GATE_OPEN) {
        n = tls_read(c->tls, c->plain, PLAIN_BYTES, &err);
        if (n > 0)
            take(c, c->plain, (size_t)n);
    }
    if (conn_out_is_over(c))
        return;
    conn_out_flush(c);
    if (conn_out_is_over(c))
        return;
    /* a worker's or peer's queue may be long, but not of such answers */
    if (n >= 0 && c->updates > ANSWERS_HIGH && !overfull(c))
        n = rad_fail(&err, RAD_EPROTO, "too many key updates");
    if (n < 0)
        garbage(c, &err);
    else if (tls_ended(c->tls))
        conn_out_end_uv(c, UV_EOF);
    else if (c->gate == GATE_OPEN && overfull(c)) /* by the session's own
                                                   * answers, to key updates */
        hold(c, GATE_UNREAD, NULL, 0);
}

/* Handle n bytes that were read into c->buf. */
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
        conn_in_unseal(c);
    }
}

static void
on_read(uv_stream_t *stream, ssize_t n, const uv_buf_t *buf)
{
    (void)buf; /* is c->buf */
    if (n < 0)
        conn_out_end_uv(stream->data, (int)n);
    else
        hear(stream->data, (size_t)n);
}

void
conn_in_hear_rest(struct conn *c)
{
    ssize_t n = 1;
    int fd;

    if (uv_fileno(&c->stream->handle, &fd) < 0)
        return;
    while (n > 0 && !conn_out_is_over(c) && !c->paused &&
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

void
conn_in_start(struct conn *c)
{
    uv_read_start(&c->stream->stream, on_alloc, on_read);
}

void
conn_in_reopen(struct conn *c)
{
    c->gate = GATE_OPEN;
    c->silent = 0;
    take(c, c->rest, c->nrest);
    if (c->tls && c->gate == GATE_OPEN)
        conn_in_unseal(c);
    if (c->gate == GATE_OPEN && !c->paused && !conn_out_is_over(c))
        conn_in_start(c);
}

static void
on_turn(struct fair_place *place)
{
    struct conn *c =
        (struct conn *)((char *)place - offsetof(struct conn, place));

    if (c->gate == GATE_LINE && !conn_out_is_over(c))
        conn_in_reopen(c);
}

bool
conn_set_user(struct conn *c, struct fair *fair, const char *name)
{
    c->place.user = fair_join(fair, name);
    c->place.go = on_turn;
    fair_owe(&c->place, c->queued);
    return c->place.user != NULL;
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
conn_pause(struct conn *c, bool pause)
{
    if (conn_out_is_over(c) || c->paused == pause)
        return;
    c->paused = pause;
    c->silent = 0; /* a silence that we caused does not count */
    if (pause)
        uv_read_stop(&c->stream->stream);
    else if (c->gate == GATE_OPEN)
        conn_in_start(c);
}
