/* gate.h - who comes from outside, until the key is proven
 *
 * Anybody can connect.  Until a visitor has proven a key (handshake.h) it costs
 * little, and cannot keep others out: GATE_MOST are there at once, and
 * GATE_MOST_HOST of one host (of IPv6 one /64 network), for as long as the
 * listener gives them; when one more comes the oldest goes.
 * Each one that does not get in is a line in the log with its address and the
 * reason, as far as the limit on such lines allows.
 * Thread: the loop's. */
#ifndef RADD_NET_GATE_H
#define RADD_NET_GATE_H

#include "net/address.h"
#include "net/handshake.h"

#define GATE_MOST      64
#define GATE_MOST_HOST 8

struct gate;

/* A visitor has proven its key, which tls_id() names: stream and tls are the
 * callee's now. */
typedef void gate_fn(void *arg, uv_stream_t *stream, struct tls *tls,
                     const char *peer);

/* find as in tls.h; each visitor has limit_ms.  NULL when memory is out. */
struct gate *gate_new(tls_find_fn *find, void *find_arg, unsigned limit_ms,
                      gate_fn *fn, void *arg);
/* Ends the connections of visitors that have not proven a key. */
void gate_free(struct gate *g);

/* Takes an open stream that came from that address. */
void gate_take(struct gate *g, uv_stream_t *stream, const struct address *from);

#endif
