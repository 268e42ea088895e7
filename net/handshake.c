/* handshake.c - see handshake.h */
#include "config.h"

#include "net/handshake.h"

#include "net/conn_stream.h"

#include <stdlib.h>
#include <string.h>

/* Least time until a key that is not known yet is looked for again. */
#define ASK_MS 10

struct handshake {
    uv_stream_t *stream; /* NULL: handed over */
    uv_timer_t timer;
    struct tls *tls;
    handshake_fn *fn;
    void *arg;
    unsigned limit_ms;
    uint64_t begin_ms, waits_ms; /* it waits for a key since; 0: no */
    size_t bytes_in;
    bool begun, over;
    char buf[2048];
};

/* Bytes that are being written; may outlive the handshake. */
struct flight {
    uv_write_t req;
    uint8_t bytes[];
};

static void
free_handshake(uv_handle_t *timer)
{
    free(timer->data);
}

static void
release(struct handshake *h)
{
    h->over = true;
    if (h->stream) {
        conn_stream_close(h->stream);
        tls_free(h->tls);
    }
    uv_close((uv_handle_t *)&h->timer, free_handshake);
}

void
handshake_cancel(struct handshake *h)
{
    release(h);
}

static void
fail(struct handshake *h, const struct rad_error *why)
{
    if (h->over)
        return;
    h->over = true;
    h->fn(h->arg, NULL, NULL, why);
    release(h);
}

static void
fail_uv(struct handshake *h, int code)
{
    struct rad_error err = { 0 };

    rad_fail(&err, code, "%s",
             code == UV_EOF ? "closed by peer" : uv_strerror(code));
    fail(h, &err);
}

static void on_timer(uv_timer_t *timer);

static void
flown(uv_write_t *req, int status)
{
    (void)status; /* reading notices errors */
    free(req->data);
}

/* Send what the TLS session has to say. */
static int
send_out(struct handshake *h)
{
    const uint8_t *p;
    size_t n = tls_out(h->tls, &p);
    struct flight *f;
    uv_buf_t buf;
    int rc;

    if (n == 0)
        return 0;
    f = malloc(sizeof *f + n);
    if (!f)
        return UV_ENOMEM;
    memcpy(f->bytes, p, n);
    tls_sent(h->tls);
    f->req.data = f;
    buf = uv_buf_init((char *)f->bytes, (unsigned)n);
    rc = uv_write(&f->req, h->stream, &buf, 1, flown);
    if (rc < 0)
        free(f);
    return rc;
}

/* How long to wait for a key before the next look for it: as long as it was
 * waited for so far, so that a name that a stranger invents causes few looks.
 */
static uint64_t
until_look(uint64_t waited_ms)
{
    uint64_t ms = waited_ms > ASK_MS ? waited_ms : ASK_MS;

    if (waited_ms >= HANDSHAKE_LATER)
        return 0;
    return ms < HANDSHAKE_LATER - waited_ms ? ms : HANDSHAKE_LATER - waited_ms;
}

/* Set the timer to the end of the handshake's time or, while it waits for a
 * key, to the next look for that. */
static void
set_timer(struct handshake *h)
{
    uint64_t now = uv_now(h->timer.loop), left, look;

    left = h->begin_ms + h->limit_ms;
    left = left > now ? left - now : 0;
    if (!tls_waiting(h->tls))
        h->waits_ms = 0;
    else if (h->waits_ms == 0)
        h->waits_ms = now;
    if (h->waits_ms != 0) {
        look = until_look(now - h->waits_ms);
        left = look < left ? look : left;
    }
    uv_timer_start(&h->timer, on_timer, left, 0);
}

static void
go_on(struct handshake *h)
{
    struct rad_error err = { 0 };
    int rc = tls_handshake(h->tls, &err), sent = send_out(h);
    uv_stream_t *stream = h->stream;

    if (rc < 0) {
        fail(h, &err);
    } else if (sent < 0) {
        fail_uv(h, sent);
    } else if (rc == 1) {
        uv_read_stop(stream);
        h->stream = NULL;
        h->over = true;
        h->fn(h->arg, stream, h->tls, NULL);
        release(h);
    } else {
        set_timer(h);
    }
}

static void
on_alloc(uv_handle_t *handle, size_t wish, uv_buf_t *buf)
{
    struct handshake *h = handle->data;

    (void)wish;
    *buf = uv_buf_init(h->buf, sizeof h->buf);
}

static void
on_read(uv_stream_t *stream, ssize_t n, const uv_buf_t *buf)
{
    struct handshake *h = stream->data;
    struct rad_error err = { 0 };

    if (n < 0) {
        fail_uv(h, (int)n);
        return;
    }
    h->bytes_in += (size_t)n;
    if (h->bytes_in > HANDSHAKE_BYTES)
        rad_fail(&err, RAD_EPROTO, "too long a handshake");
    if (err.code || tls_put(h->tls, buf->base, (size_t)n, &err) < 0)
        fail(h, &err);
    else if (n > 0 && h->waits_ms == 0) /* else the timer goes on */
        go_on(h);
}

static void
on_timer(uv_timer_t *timer)
{
    struct handshake *h = timer->data;
    struct rad_error err = { 0 };

    uint64_t now = uv_now(timer->loop);

    if (!h->begun) {
        h->begun = true;
        h->begin_ms = now;
        uv_read_start(h->stream, on_alloc, on_read);
        go_on(h);
    } else if (now - h->begin_ms >= h->limit_ms) {
        rad_fail(&err, UV_ETIMEDOUT, "took too long");
        fail(h, &err);
    } else {
        if (h->waits_ms != 0 && now - h->waits_ms >= HANDSHAKE_LATER)
            tls_decide(h->tls);
        go_on(h);
    }
}

struct handshake *
handshake_new(uv_stream_t *stream, struct tls *tls, unsigned limit_ms,
              handshake_fn *fn, void *arg)
{
    struct handshake *h = tls ? calloc(1, sizeof *h) : NULL;

    if (!h) {
        conn_stream_close(stream);
        tls_free(tls);
        return NULL;
    }
    h->stream = stream;
    h->tls = tls;
    h->limit_ms = limit_ms;
    h->fn = fn;
    h->arg = arg;
    stream->data = h;
    if (stream->type == UV_TCP)
        uv_tcp_nodelay((uv_tcp_t *)stream, 1);
    uv_timer_init(stream->loop, &h->timer);
    h->timer.data = h;
    uv_timer_start(&h->timer, on_timer, 0, 0);
    return h;
}
