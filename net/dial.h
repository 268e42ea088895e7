/* dial.h - dialling: connections to other programs' sockets
 *
 * A Unix socket is open as soon as it is connected.  Over TCP the key is proven
 * first (handshake.h).  Connecting and the handshake may take HANDSHAKE_MS
 * each; but of a name's addresses each except the last has a second to answer.
 * Thread: the loop's. */
#ifndef RADD_NET_DIAL_H
#define RADD_NET_DIAL_H

#include "net/tls.h"

#include <stdbool.h>
#include <uv.h>

/* Called once: with an open stream and, over TCP, its TLS session, both of
 * which the callee takes; or with NULL and the reason, whose code is libuv's,
 * one of handshake.h or RAD_EPERM for a missing key.  peer: the address that
 * was dialled. */
typedef void dial_fn(void *arg, uint64_t id, uv_stream_t *stream,
                     struct tls *tls, const char *peer,
                     const struct rad_error *why);

/* The key to dial with.  Its holder wipes it after use. */
struct dial_key {
    char id[TLS_ID];
    uint8_t secret[TLS_SECRET];
    int64_t expires; /* seconds since 1970; 0: never.  A key that is refused
                      * after that date is told with it. */
};

struct dialler;

/* fn is called after dial() has returned, never inside.  NULL: memory is out.
 */
struct dialler *dialler_new(uv_loop_t *loop, dial_fn *fn, void *arg);
/* Stop all dialling; fn is not called any more.  Not allowed inside fn.  NULL
 * is accepted. */
void dialler_close(struct dialler *d);

/* Dial `text`, an address of address.h, which may have "tcp " or "unix " before
 * it.  key is copied.  Without a key (NULL) only a Unix socket can be dialled;
 * at a loopback address the dialler still finds out whether anybody listens.
 * False: memory is out, and fn is not called. */
bool dial(struct dialler *d, const char *text, uint64_t id,
          const struct dial_key *key);

#endif
