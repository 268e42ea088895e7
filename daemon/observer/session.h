/* session.h - what radweb asks the coordinator for, and what it answers
 *
 * One connection, dialled in the role of an observer and dialled again when it
 * ends, after half a second at first and half a minute at last.  A request is
 * answered once: with bytes, or with why there are none; when the connection
 * has ended, all that wait are told so with the next session_tick().
 * Thread: the loop's. */
#ifndef RADD_OBSERVER_SESSION_H
#define RADD_OBSERVER_SESSION_H

#include "proto/message.h"

#include <stdbool.h>
#include <uv.h>

struct session;

struct session_conf {
    const char *coordinator; /* an address of net/address.h */
    const char *key;         /* the observer's key file; "": none */
};

/* status 0: n bytes, valid during the call; else one of sysexits.h, and text
 * says why. */
struct session_answer {
    int status;
    const char *text;
    const uint8_t *bytes;
    size_t n;
};
typedef void session_fn(void *arg, const struct session_answer *a);

/* conf, whose texts must outlive it.  NULL when memory is out. */
struct session *session_new(uv_loop_t *loop, const struct session_conf *conf);
/* All that wait are told; the loop must run on until its handles are closed,
 * then session_free(). */
void session_close(struct session *s);
void session_free(struct session *s);

/* Dial when it is time to; each DAEMON_TICK_MS. */
void session_tick(struct session *s);

bool session_is_up(const struct session *s);
/* Why it is not up, for whoever looks at a page; "" while it is, or nothing is
 * known. */
const char *session_why(const struct session *s);

/* Ask; fn is called later, once, never from inside.  An answer of more than
 * `most` bytes is refused with EX_DATAERR.  False: it is not up, too much waits
 * or memory is out; fn is not called then. */
bool session_ask(struct session *s, struct msg *m, size_t most, session_fn *fn,
                 void *arg);

#endif
