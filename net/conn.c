/* conn.c - see conn.h; this file has the timer and the settings */
#include "config.h"

#include "net/conn_impl.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>

#define SILENT_PINGS (CONN_DEAD_MS / CONN_PING_MS)

static unsigned
limit_ms(const struct conn *c)
{
    return c->handler->limit_ms ? c->handler->limit_ms : CONN_HANDSHAKE_MS;
}

/* How often the timer runs. */
static unsigned
period_ms(const struct conn *c)
{
    return c->state == CONN_NEW && limit_ms(c) < CONN_PING_MS ? limit_ms(c)
                                                              : CONN_PING_MS;
}

/* Is the other side silent because we do not read its requests, though it has
 * read all that we sent? */
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
    struct msg ping = { .type = MSG_PING, .ping = c->says };
    char why[40];

    if (c->primed) {
        c->primed = false;
        uv_timer_start(timer, on_timer, period_ms(c), period_ms(c));
        conn_in_unseal(c);
        return;
    }
    if (c->state == CONN_FINISHING ||
        (c->state == CONN_NEW && now - c->opened_ms >= limit_ms(c))) {
        conn_out_end(c, UV_ETIMEDOUT, "took too long");
        return;
    }
    if (c->state != CONN_LIVE || !c->ping)
        return;
    /* PINGs are counted, not time: if the loop was blocked, bytes that came
     * meanwhile are read before the next PING */
    if (!c->paused && !is_patient(c) && c->silent++ >= SILENT_PINGS) {
        snprintf(why, sizeof why, "silent for %d s", CONN_DEAD_MS / 1000);
        conn_out_end(c, UV_ETIMEDOUT, why);
        return;
    }
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
    /* messages are written whole; Nagle's algorithm would hold a short one back
     * until earlier ones are acknowledged, some 40 ms */
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
    c->hear_rest = conn_in_hear_rest;
    c->reopen = conn_in_reopen;
    conn_in_start(c);
    return c;
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

    if (c->state == CONN_NEW)
        conn_out_set_state(c, CONN_LIVE);
    c->ping = ping;
    if (often && !c->primed)
        uv_timer_start(&c->timer, on_timer, CONN_PING_MS, CONN_PING_MS);
}

void
conn_set_ping(struct conn *c, const struct msg_ping *ping)
{
    c->says = *ping;
}

bool
conn_expect(struct conn *c, size_t n)
{
    if (conn_full(c))
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

bool
conn_full(const struct conn *c)
{
    return fair_full(&c->place);
}

const char *
conn_peer(const struct conn *c)
{
    return c->peer;
}

void
conn_finish(struct conn *c)
{
    if (!c || conn_out_is_over(c))
        return;
    conn_out_set_state(c, CONN_FINISHING);
    if (c->tls) { /* the TLS session's end goes out last */
        conn_out_uncork(c);
        if (c->state != CONN_CLOSED) {
            tls_end(c->tls);
            conn_out_flush(c);
        }
        if (c->state == CONN_CLOSED)
            return;
    }
    uv_read_stop(&c->stream->stream);
    if (c->queued == 0)
        conn_close(c);
    else
        uv_timer_start(&c->timer, on_timer, CONN_HANDSHAKE_MS, 0);
}
