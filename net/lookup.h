/* lookup.h - a name's addresses looked up while the loop goes on
 *
 * The resolver may hang for as long as it likes and cannot be stopped.  It runs
 * on a thread of its own, which a cancelled look-up leaves behind: neither the
 * loop nor the end of the program waits for it, as they would for a thread of
 * libuv's pool.
 * Thread: the loop's. */
#ifndef RADD_NET_LOOKUP_H
#define RADD_NET_LOOKUP_H

#include "net/address.h"

#include <uv.h>

#define LOOKUP_MOST 8 /* addresses of a name that are told */

struct lookup;

/* Called once, with n addresses or (n < 0) an error of address_resolve(). */
typedef void lookup_fn(void *arg, const struct address to[], int n,
                       const struct rad_error *why);

/* text is copied; fn is called later, never inside.  NULL: there is no memory
 * or no thread, and fn is not called. */
struct lookup *lookup_start(uv_loop_t *loop, const char *text, lookup_fn *fn,
                            void *arg);

/* fn is not called any more.  Not allowed after fn was called. */
void lookup_cancel(struct lookup *l);

#endif
