/* dial.h - connections to others' sockets
 *
 * A Unix socket is there as soon as it is connected; over TCP a key is proven
 * first (handshake.h).  Each of the two may take HANDSHAKE_MS.
 * Thread: the loop's. */
#ifndef RADD_NET_DIAL_H
#define RADD_NET_DIAL_H

#include "net/address.h"
#include "net/tls.h"

#include <stdbool.h>
#include <uv.h>

/* Called once: with an open stream and, over TCP, its session, which the
 * callee owns; or with NULL and why not: a code of libuv's, of handshake.h or
 * RAD_EPERM without a key.  peer is the address that was dialled. */
typedef void dial_fn(void *arg, uint64_t id, uv_stream_t *stream,
                     struct tls *tls, const char *peer,
                     const struct rad_error *why);

/* By which key; wiped by whoever has it. */
struct dial_key {
    char id[TLS_ID];
    uint8_t secret[TLS_SECRET];
};

struct dialler;

/* fn is called later, never from inside dial().  NULL when memory is out. */
struct dialler *dialler_new(uv_loop_t *loop, dial_fn *fn, void *arg);
/* End what is under way; fn is not called any more.  The loop frees the dialler
 * with its last look-up of a name, which cannot be stopped.  NULL is accepted.
 */
void dialler_close(struct dialler *d);

/* Dial `text`, an address of address.h, which may have "tcp " or "unix "
 * before it.  key, copied, may be NULL: then only a Unix socket is dialled,
 * and at a loopback address it is seen whether anybody listens.
 * False when memory is out: fn is not called then. */
bool dial(struct dialler *d, const char *text, uint64_t id,
          const struct dial_key *key);

#endif
