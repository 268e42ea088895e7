/* gate.h - connections from outside, until they have proven a key
 *
 * Anybody can connect.  Until such a visitor has proven a key (handshake.h) it
 * costs little and cannot keep others out: at most GATE_MOST visitors are there
 * at a time, and GATE_MOST_HOST of one host (for IPv6: of one /64 network),
 * each for a limited time; for one more the oldest is thrown out.
 * Each visitor that does not get in is logged with its address and the reason,
 * up to a limit on such lines.
 * Thread: the loop's. */
#ifndef RADD_NET_GATE_H
#define RADD_NET_GATE_H

#include "net/address.h"
#include "net/handshake.h"

#define GATE_MOST 256
/* A script starts as many programs at once as its host has processors. */
#define GATE_MOST_HOST 32

struct gate;

/* A visitor has proven the key that tls_id() names.  Takes stream and tls. */
typedef void gate_fn(void *arg, uv_stream_t *stream, struct tls *tls,
                     const char *peer);

/* find: as in tls.h.  limit_ms: the time that a visitor has.  NULL: memory is
 * out. */
struct gate *gate_new(tls_find_fn *find, void *find_arg, unsigned limit_ms,
                      gate_fn *fn, void *arg);
/* End the connections of all visitors: none gets in from now on.  NULL is
 * accepted. */
void gate_close(struct gate *g);
/* Also closes it. */
void gate_free(struct gate *g);

/* Take an open stream, which came from that address. */
void gate_take(struct gate *g, uv_stream_t *stream, const struct address *from);

#endif
