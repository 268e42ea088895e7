/* listen.h - a socket that waits for connections
 *
 * Thread: the loop's. */
#ifndef RADD_NET_LISTEN_H
#define RADD_NET_LISTEN_H

#include "net/address.h"
#include "net/tls.h"

#include <stdbool.h>
#include <uv.h>

struct listener;

/* Somebody is there: stream is a heap-allocated union conn_stream (conn.h),
 * open; tls is its session, whose key is proven, or NULL on a Unix socket.  The
 * callee owns both.  peer names the other side. */
typedef void listener_fn(void *arg, uv_stream_t *stream, struct tls *tls,
                         const char *peer);

struct listener_conf {
    listener_fn *fn;
    tls_find_fn *find; /* keys by which to come over TCP */
    bool anywhere;     /* on any address; else on this machine alone */
    unsigned limit_ms; /* to prove a key in; 0: HANDSHAKE_MS */
    void *arg;         /* fn's and find's */
};

/* Listen at `where` (address.h); port 0 takes a free one.  A Unix socket's
 * file that nobody serves is replaced.
 * RAD_EPERM for an address that is not permitted, RAD_ECANTCREAT when it is in
 * use or cannot be bound; NULL then. */
struct listener *listener_open(uv_loop_t *loop, const char *where,
                               const struct listener_conf *conf,
                               struct rad_error *err);

/* "tcp 127.0.0.1:41234" or "unix /run/radd/radd.sock": as in a ports file. */
const char *listener_text(const struct listener *l);

/* Stop; a Unix socket's file goes too.  NULL is accepted. */
void listener_close(struct listener *l);

#endif
