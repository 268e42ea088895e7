/* handshake.h - the time between a connection and its first message
 *
 * Carries a TLS handshake over an open stream.  Until it is over nothing of
 * ours is read, and nothing is kept but the session itself: a few kilobytes
 * may come, in the time that its owner gives it.
 * Thread: the loop's. */
#ifndef RADD_NET_HANDSHAKE_H
#define RADD_NET_HANDSHAKE_H

#include "net/tls.h"

#include <uv.h>

#define HANDSHAKE_MS    10000 /* that it usually is given */
#define HANDSHAKE_BYTES 16384 /* most that a side may send */
#define HANDSHAKE_LATER 1000  /* ms that a key may come later (tls.h) */

struct handshake;

/* Called once: with the session that is proven, and its stream, both of which
 * the callee owns; or with NULL and why it failed, RAD_EPERM or RAD_EPROTO for
 * what the other side did, or a code of libuv's. */
typedef void handshake_fn(void *arg, uv_stream_t *stream, struct tls *tls,
                          const struct rad_error *why);

/* Takes the stream (a union conn_stream) and the session; it is over limit_ms
 * from now at the latest, whatever comes.  fn is called later, never from
 * inside.  NULL when memory is out; both are closed then. */
struct handshake *handshake_new(uv_stream_t *stream, struct tls *tls,
                                unsigned limit_ms, handshake_fn *fn, void *arg);

/* End it; fn is not called.  Not after fn was. */
void handshake_cancel(struct handshake *h);

#endif
