/* session.h - radweb's requests to the coordinator, and their answers
 *
 * One connection, in the role of an observer.  When it ends the coordinator is
 * dialled again, after half a second at first and half a minute at most.  A
 * request is answered once: with bytes, or with the reason why there are none.
 * When the connection has ended the next session_tick() answers all waiting
 * requests with a reason.
 * Thread: the loop's. */
#ifndef RADD_OBSERVER_SESSION_H
#define RADD_OBSERVER_SESSION_H

#include "proto/message.h"

#include <stdbool.h>
#include <uv.h>

struct session;

struct session_conf {
    const char *coordinator; /* an address of net/address.h */
    const char *key;         /* the observer's key file; "": no key */
};

/* status 0: n bytes, valid during the call; else a status of sysexits.h, with
 * the reason in text. */
struct session_answer {
    int status;
    const char *text;
    const uint8_t *bytes;
    size_t n;
};
typedef void session_fn(void *arg, const struct session_answer *a);

/* conf's texts must outlive the session.  NULL: memory is out. */
struct session *session_new(uv_loop_t *loop, const struct session_conf *conf);
/* Answer all waiting requests and close the connection.  Run the loop until its
 * handles are closed, then call session_free(). */
void session_close(struct session *s);
void session_free(struct session *s);

/* Dial when it is time to; call each DAEMON_TICK_MS. */
void session_tick(struct session *s);

/* Is the connection up: has the coordinator welcomed it? */
bool session_is_up(const struct session *s);
/* Why the connection is down, for the reader of a page; "" while it is up. */
const char *session_why(const struct session *s);

/* Send a request; fn is called once, after session_ask() has returned.  An
 * answer of more than `most` bytes is refused with EX_DATAERR; of a file that
 * is fetched fn gets the first `most` bytes if `head`, and no more of it takes
 * memory.  Returns false, and fn is not called, if the connection is down, too
 * many requests wait or memory is out. */
bool session_ask(struct session *s, struct msg *m, size_t most, bool head,
                 session_fn *fn, void *arg);

#endif
