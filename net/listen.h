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

/* A connection was accepted.  stream is an open union conn_stream on the heap;
 * tls is its session, whose key is proven, or NULL on a Unix socket.  The
 * callee takes both.  peer names the other side. */
typedef void listener_fn(void *arg, uv_stream_t *stream, struct tls *tls,
                         const char *peer);

struct listener_conf {
    listener_fn *fn;
    tls_find_fn *find; /* looks up keys, over TCP */
    bool anywhere;     /* any address may be used; else only local ones */
    bool handed;       /* if standard input listens it is the socket, whose
                        * file the one who started us has made */
    unsigned limit_ms; /* time to prove a key; 0: HANDSHAKE_MS */
    void *arg;         /* fn's and find's */
};

/* Listen at `where` (address.h); port 0 takes a free one.  A Unix socket's file
 * is replaced if no process serves it.
 * NULL with RAD_EPERM: the address is not permitted; RAD_ECANTCREAT: it is in
 * use, or cannot be bound. */
struct listener *listener_open(uv_loop_t *loop, const char *where,
                               const struct listener_conf *conf,
                               struct rad_error *err);

/* "tcp 127.0.0.1:41234" or "unix /run/radd/radd.sock", as a ports file has it.
 */
const char *listener_text(const struct listener *l);

/* Stop listening, and remove a Unix socket's file: no connection comes from now
 * on.  NULL is accepted. */
void listener_close(struct listener *l);

/* Is there a descriptor for one more connection to that socket, with some to
 * spare for files, children and the like? */
bool listener_has_room(int socket);

/* A socket that listens at a, which address_resolve_listen() made of `where`:
 * the descriptor, or a negative error number.  At "*" it takes IPv4 alone where
 * the kernel has no IPv6.  a is then where it listens, for port 0. */
int listener_socket(struct address *a, const char *where, int backlog);

#endif
