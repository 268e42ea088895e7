/* dial.c - see dial.h
 *
 * A name may have addresses of IPv6 and IPv4 while the coordinator listens at
 * one kind alone, or the address of a host that is off: if one address does not
 * answer the next one is tried. */
#include "config.h"

#include "net/dial.h"

#include "net/conn_stream.h"
#include "net/handshake.h"
#include "net/key/key.h"
#include "net/lookup.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Time that an address has to answer before the name's next one is tried: some
 * round trips of a slow network, and little of the time that radctl waits. */
#define ADDRESS_MS 1000

struct dialling {
    struct dialling *next;
    struct dialler *dialler;
    struct lookup *lookup; /* NULL: not under way */
    uv_connect_t connect;
    uv_timer_t timer; /* limits connecting */
    bool connecting, closed; /* closed: the timer is */
    uint64_t id;
    bool with_key;
    struct dial_key key;
    struct address to[LOOKUP_MOST];
    int n, nth; /* how many they are (< 0: none, for err), which is tried */
    uv_stream_t *stream;
    struct handshake *shake;
    struct rad_error err; /* of looking up */
    int refused; /* the error of the first address */
    char text[ADDRESS_TEXT];
};

struct dialler {
    uv_loop_t *loop;
    struct tls_ctx *tls; /* NULL: not needed yet, for it takes 2 ms to make */
    dial_fn *fn;
    void *arg;
    struct dialling *first;
};

struct dialler *
dialler_new(uv_loop_t *loop, dial_fn *fn, void *arg)
{
    struct dialler *d = calloc(1, sizeof *d);

    if (!d)
        return NULL;
    *d = (struct dialler){ .loop = loop, .fn = fn, .arg = arg };
    return d;
}

/* Free g once libuv uses nothing of it. */
static void
free_unused(struct dialling *g)
{
    if (!g->closed || g->connecting)
        return;
    explicit_bzero(g, sizeof *g);
    free(g);
}

static void
timer_closed(uv_handle_t *h)
{
    struct dialling *g = h->data; /* h is a part of it */

    g->closed = true;
    free_unused(g);
}

/* Take g out of the list and close its handles; it is freed when they are
 * closed. */
static void
let_go(struct dialling *g)
{
    struct dialler *d = g->dialler;
    struct dialling **link = &d->first;

    while (*link != g)
        link = &(*link)->next;
    *link = g->next;
    g->dialler = NULL;
    uv_timer_stop(&g->timer);
    if (g->lookup)
        lookup_cancel(g->lookup);
    if (g->shake)
        handshake_cancel(g->shake);
    else if (g->stream)
        conn_stream_close(g->stream); /* which cancels the connect request */
    g->lookup = NULL;
    g->shake = NULL;
    g->stream = NULL;
    uv_close((uv_handle_t *)&g->timer, timer_closed);
}

static void
give_up(struct dialling *g, const struct rad_error *why)
{
    struct dialler *d = g->dialler;

    d->fn(d->arg, g->id, NULL, NULL, g->text, why);
    let_go(g);
}

static void
give_up_for(struct dialling *g, int code, const char *why)
{
    struct rad_error err = { 0 };

    rad_fail(&err, code, "%s", why);
    give_up(g, &err);
}

static void
give_up_keyless(struct dialling *g)
{
    give_up_for(g, RAD_EPERM, "there is no key to show there");
}

static void
hand_over(struct dialling *g, uv_stream_t *stream, struct tls *tls)
{
    struct dialler *d = g->dialler;

    g->stream = NULL;
    d->fn(d->arg, g->id, stream, tls, g->text, NULL);
    let_go(g);
}

void
dialler_close(struct dialler *d)
{
    if (!d)
        return;
    while (d->first)
        let_go(d->first);
    tls_ctx_free(d->tls);
    free(d);
}

/* The other side does not say that our key has expired: whom it refuses learns
 * nothing of keys. */
static void
give_up_refused(struct dialling *g, const struct rad_error *why)
{
    int64_t expires = g->key.expires;
    struct rad_error err = { 0 };
    char date[KEY_DATE];

    if (why->code != RAD_EPERM || !key_date_is_past(expires, time(NULL))) {
        give_up(g, why);
        return;
    }
    key_date_format(expires, date);
    rad_fail(&err, why->code, "%s; the key expired on %s", why->what, date);
    give_up(g, &err);
}

static void
shaken(void *arg, uv_stream_t *stream, struct tls *tls,
       const struct rad_error *why)
{
    struct dialling *g = arg;

    g->shake = NULL;
    if (stream)
        hand_over(g, stream, tls);
    else
        give_up_refused(g, why);
}

static void try_address(struct dialling *g);

/* This address does not answer; try_address() goes on. */
static void
leave_address(struct dialling *g, int status)
{
    if (g->nth++ == 0)
        g->refused = status;
    conn_stream_close(g->stream);
    g->stream = NULL;
}

static void
try_next(struct dialling *g, int status)
{
    leave_address(g, status);
    try_address(g);
}

/* A new TLS session; NULL: memory is out. */
static struct tls *
session(struct dialling *g)
{
    struct dialler *d = g->dialler;

    if (!d->tls)
        d->tls = tls_client();
    return d->tls ? tls_dial(d->tls, g->key.id, g->key.secret) : NULL;
}

static void
connected(uv_connect_t *req, int status)
{
    struct dialling *g = req->data;
    uv_stream_t *stream = g->stream;

    g->connecting = false;
    if (!g->dialler) { /* let_go() was called meanwhile */
        free_unused(g);
        return;
    }
    uv_timer_stop(&g->timer);
    if (!stream) { /* on_timer() has left the address */
        try_address(g);
    } else if (status < 0) {
        try_next(g, status);
    } else if (address_is_local(&g->to[g->nth])) {
        hand_over(g, stream, NULL);
    } else if (!g->with_key) {
        give_up_keyless(g);
    } else {
        g->stream = NULL; /* the handshake takes it */
        g->shake =
            handshake_new(stream, session(g), HANDSHAKE_MS, shaken, g);
        if (!g->shake)
            give_up_for(g, UV_ENOMEM, "out of memory");
    }
}

static void
on_timer(uv_timer_t *timer)
{
    /* the closed stream ends g->connect, and connected() tries the next one */
    leave_address(timer->data, UV_ETIMEDOUT);
}

static void
start_connect(struct dialling *g)
{
    const struct address *to = &g->to[g->nth];
    bool local = address_is_local(to), last = g->nth == g->n - 1;
    int rc = 0;

    g->stream = conn_stream_new(g->dialler->loop, local);
    if (!g->stream) {
        give_up_for(g, UV_ENOMEM, "out of memory");
        return;
    }
    g->connect.data = g;
    g->connecting = true;
    if (local)
        uv_pipe_connect(&g->connect, (uv_pipe_t *)g->stream, to->sa.un.sun_path,
                        connected);
    else
        rc = uv_tcp_connect(&g->connect, (uv_tcp_t *)g->stream, &to->sa.any,
                            connected);
    if (rc < 0) {
        g->connecting = false;
        try_next(g, rc);
        return;
    }
    uv_timer_start(&g->timer, on_timer, last ? HANDSHAKE_MS : ADDRESS_MS, 0);
}

/* Try the next of the addresses that were found. */
static void
try_address(struct dialling *g)
{
    if (g->n < 0)
        give_up(g, &g->err);
    else if (g->nth == g->n)
        give_up_for(g, g->refused, uv_strerror(g->refused));
    else if (!g->with_key && !address_is_loopback(&g->to[g->nth]))
        give_up_keyless(g);
    else
        start_connect(g);
}

static void
on_looked_up(void *arg, const struct address to[], int n,
             const struct rad_error *why)
{
    struct dialling *g = arg;

    g->lookup = NULL;
    g->err = *why;
    g->n = n;
    if (n > 0)
        memcpy(g->to, to, (size_t)n * sizeof *to);
    try_address(g);
}

static void
on_known(uv_timer_t *timer)
{
    try_address(timer->data);
}

/* A path needs no resolver; but it is tried later, as a name is. */
static void
find_addresses(struct dialling *g)
{
    if (strchr(g->text, '/')) {
        g->n = address_resolve(g->text, g->to, LOOKUP_MOST, &g->err);
    } else {
        g->lookup = lookup_start(g->dialler->loop, g->text, on_looked_up, g);
        if (g->lookup)
            return;
        g->n = rad_fail(&g->err, UV_ENOMEM, "no thread for the resolver");
    }
    uv_timer_start(&g->timer, on_known, 0, 0);
}

bool
dial(struct dialler *d, const char *text, uint64_t id,
     const struct dial_key *key)
{
    struct dialling *g = calloc(1, sizeof *g);

    if (!g)
        return false;
    if (strncmp(text, "tcp ", 4) == 0)
        text += 4;
    else if (strncmp(text, "unix ", 5) == 0)
        text += 5;
    snprintf(g->text, sizeof g->text, "%s", text);
    g->dialler = d;
    g->id = id;
    g->with_key = key != NULL;
    if (key)
        g->key = *key;
    g->next = d->first;
    d->first = g;
    uv_timer_init(d->loop, &g->timer);
    g->timer.data = g;
    find_addresses(g);
    return true;
}
