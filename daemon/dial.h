/* dial.h - a connection to somebody's socket
 *
 * Thread: the loop's. */
#ifndef RADD_DAEMON_DIAL_H
#define RADD_DAEMON_DIAL_H

#include "address.h"

#include <uv.h>

/* Called once: with an open stream, which the callee owns, or with NULL and
 * why not.  peer is the address that was dialled. */
typedef void dial_fn(void *arg, uint64_t id, uv_stream_t *stream,
                     const char *peer, const char *why);

/* Dial `text`, an address of address.h, which may have "tcp " or "unix "
 * before it.  fn is called later, never from inside. */
void dial(uv_loop_t *loop, const char *text, uint64_t id, dial_fn *fn,
          void *arg);

#endif
