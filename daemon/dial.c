/* dial.c - see dial.h
 *
 * Names are looked up on libuv's pool: a resolver may take its time. */
#include "config.h"

#include "dial.h"

#include "conn.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct dialling {
    uv_work_t lookup;
    uv_connect_t connect;
    uv_loop_t *loop;
    uint64_t id;
    dial_fn *fn;
    void *arg;
    struct address to;
    uv_stream_t *stream;
    struct rad_error err;
    char text[ADDRESS_TEXT];
};

static void
give_up(struct dialling *d, const char *why)
{
    if (d->stream)
        conn_stream_close(d->stream);
    d->fn(d->arg, d->id, NULL, d->text, why);
    free(d);
}

static void
connected(uv_connect_t *req, int status)
{
    struct dialling *d = req->data;

    if (status < 0) {
        give_up(d, uv_strerror(status));
        return;
    }
    d->fn(d->arg, d->id, d->stream, d->text, NULL);
    free(d);
}

static void
look_up(uv_work_t *work)
{
    struct dialling *d = work->data;

    if (address_resolve(d->text, &d->to, &d->err) == 0)
        address_permitted(&d->to, d->text, &d->err);
}

static void
looked_up(uv_work_t *work, int status)
{
    struct dialling *d = work->data;
    bool local = address_is_local(&d->to);
    int rc;

    (void)status; /* never cancelled */
    if (d->err.code) {
        give_up(d, d->err.what);
        return;
    }
    d->stream = conn_stream_new(d->loop, local);
    if (!d->stream) {
        give_up(d, "out of memory");
        return;
    }
    d->connect.data = d;
    if (local) {
        uv_pipe_connect(&d->connect, (uv_pipe_t *)d->stream,
                        d->to.sa.un.sun_path, connected);
        return;
    }
    rc = uv_tcp_connect(&d->connect, (uv_tcp_t *)d->stream, &d->to.sa.any,
                        connected);
    if (rc < 0)
        give_up(d, uv_strerror(rc));
}

void
dial(uv_loop_t *loop, const char *text, uint64_t id, dial_fn *fn, void *arg)
{
    struct dialling *d = calloc(1, sizeof *d);

    if (!d)
        abort(); /* whoever asked would wait for ever */
    if (strncmp(text, "tcp ", 4) == 0)
        text += 4;
    else if (strncmp(text, "unix ", 5) == 0)
        text += 5;
    snprintf(d->text, sizeof d->text, "%s", text);
    d->loop = loop;
    d->id = id;
    d->fn = fn;
    d->arg = arg;
    d->lookup.data = d;
    uv_queue_work(loop, &d->lookup, look_up, looked_up);
}
