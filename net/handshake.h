/* handshake.h - the TLS handshake between connecting and the first message
 *
 * Runs the handshake on an open stream.  Until it is over no message is read,
 * and no memory is used but that of the session: the other side may send a few
 * kilobytes within a limited time.
 * Thread: the loop's. */
#ifndef RADD_NET_HANDSHAKE_H
#define RADD_NET_HANDSHAKE_H

#include "net/tls.h"

#include <uv.h>

#define HANDSHAKE_MS    10000 /* the usual limit */
#define HANDSHAKE_BYTES 16384 /* most bytes that the other side may send */
#define HANDSHAKE_LATER 1000  /* ms to wait for a key (TLS_LATER, tls.h) */

struct handshake;

/* Called once: with the stream and its session, whose key is proven, both of
 * which the callee takes; or with NULL and the reason, whose code is one of
 * tls.h for what the other side did, or libuv's. */
typedef void handshake_fn(void *arg, uv_stream_t *stream, struct tls *tls,
                          const struct rad_error *why);

/* Take the stream (a union conn_stream) and the session.  The handshake ends
 * within limit_ms, whatever comes.  fn is called later, never inside.  NULL:
 * memory is out; both are closed then. */
struct handshake *handshake_new(uv_stream_t *stream, struct tls *tls,
                                unsigned limit_ms, handshake_fn *fn, void *arg);

/* End the handshake; fn is not called.  Not allowed after fn was called. */
void handshake_cancel(struct handshake *h);

#endif
