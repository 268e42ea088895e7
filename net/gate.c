/* gate.c - see gate.h */
#include "config.h"

#include "net/gate.h"

#include "net/conn_stream.h"
#include "net/log.h"

#include <stdlib.h>
#include <string.h>

#define HOST 17 /* bytes that identify a host: family, address */

struct visitor {
    struct visitor *next; /* the next newer one */
    struct gate *gate;
    struct handshake *shake;
    uint8_t host[HOST];
    char peer[ADDRESS_TEXT];
};

struct gate {
    struct tls_ctx *tls;
    unsigned limit_ms;
    gate_fn *fn;
    void *arg;
    struct visitor *first; /* the oldest */
    struct log_limit limit;
    uint64_t now_ms;
};

struct gate *
gate_new(tls_find_fn *find, void *find_arg, unsigned limit_ms, gate_fn *fn,
         void *arg)
{
    struct gate *g = calloc(1, sizeof *g);

    if (!g)
        return NULL;
    g->tls = tls_server(find, find_arg);
    g->limit_ms = limit_ms;
    g->fn = fn;
    g->arg = arg;
    if (g->tls)
        return g;
    free(g);
    return NULL;
}

static void
drop(struct visitor *v)
{
    struct visitor **link = &v->gate->first;

    while (*link != v)
        link = &(*link)->next;
    *link = v->next;
    free(v);
}

void
gate_close(struct gate *g)
{
    while (g && g->first) {
        handshake_cancel(g->first->shake);
        drop(g->first);
    }
}

void
gate_free(struct gate *g)
{
    if (!g)
        return;
    gate_close(g);
    tls_ctx_free(g->tls);
    free(g);
}

/* Log that a visitor was refused.  It is no warning if its key was not there
 * (TLS_LATER): a job that ends takes the keys of its workers' links along. */
static void
log_refused(struct gate *g, const char *peer, const struct rad_error *why)
{
    unsigned dropped;

    if (!log_allowed(&g->limit, g->now_ms, &dropped))
        return;
    if (dropped > 0)
        log_warn("connections refused and not logged n=%u", dropped);
    log_at(why->code == RAD_ETEMPFAIL ? LOG_LEVEL_INFO : LOG_LEVEL_WARN,
           "connection refused peer=%s: %s", peer, why->what);
}

static void
shaken(void *arg, uv_stream_t *stream, struct tls *tls,
       const struct rad_error *why)
{
    struct visitor *v = arg;
    struct gate *g = v->gate;
    char peer[ADDRESS_TEXT];

    memcpy(peer, v->peer, sizeof peer);
    drop(v);
    if (stream)
        g->fn(g->arg, stream, tls, peer);
    else
        log_refused(g, peer, why);
}

/* What counts as one host.  One host can have a whole /64 network of IPv6
 * addresses. */
static void
host_of(const struct address *a, uint8_t host[HOST])
{
    const uint8_t *six = a->sa.in6.sin6_addr.s6_addr;

    memset(host, 0, HOST);
    if (a->sa.any.sa_family == AF_INET) {
        host[0] = 4;
        memcpy(host + 1, &a->sa.in.sin_addr, 4);
    } else if (IN6_IS_ADDR_V4MAPPED(&a->sa.in6.sin6_addr)) {
        host[0] = 4;
        memcpy(host + 1, six + 12, 4);
    } else {
        host[0] = 6;
        memcpy(host + 1, six, 8);
    }
}

/* The number of visitors, of one host or (host NULL) of all, and the oldest of
 * them. */
static unsigned
count(const struct gate *g, const uint8_t *host, struct visitor **oldest)
{
    unsigned n = 0;

    *oldest = NULL;
    for (struct visitor *v = g->first; v; v = v->next)
        if (!host || memcmp(v->host, host, HOST) == 0) {
            if (n++ == 0)
                *oldest = v;
        }
    return n;
}

static void
push_out(struct gate *g, struct visitor *v, const char *why)
{
    struct rad_error err = { 0 };

    rad_fail(&err, RAD_EPERM, "%s", why);
    log_refused(g, v->peer, &err);
    handshake_cancel(v->shake);
    drop(v);
}

static void
make_room(struct gate *g, const uint8_t *host)
{
    struct visitor *oldest;

    if (count(g, host, &oldest) >= GATE_MOST_HOST)
        push_out(g, oldest, "too many from there without a key");
    else if (count(g, NULL, &oldest) >= GATE_MOST)
        push_out(g, oldest, "too many without a key");
}

void
gate_take(struct gate *g, uv_stream_t *stream, const struct address *from)
{
    struct visitor *v = calloc(1, sizeof *v), **link = &g->first;

    g->now_ms = uv_now(stream->loop);
    if (!v) {
        log_err("connection refused: out of memory");
        conn_stream_close(stream);
        return;
    }
    v->gate = g;
    host_of(from, v->host);
    address_format(from, v->peer);
    make_room(g, v->host);
    v->shake =
        handshake_new(stream, tls_accept(g->tls), g->limit_ms, shaken, v);
    if (!v->shake) {
        log_err("connection refused peer=%s: out of memory", v->peer);
        free(v);
        return;
    }
    while (*link)
        link = &(*link)->next;
    *link = v;
}
