/* serve.h - the HTTP server: connections, time limits, answers
 *
 * libmicrohttpd parses the requests; its epoll descriptor is watched by libuv's
 * loop, so all is in one thread.  route.c finds the answers, answer.h sends
 * them. Bounds: SERVE_GUESTS connections, SERVE_PER_S new ones a second once
 * SERVE_AT_ONCE have come, and those above wait in the kernel, or are turned
 * away by it, for none of our time; 16 KiB each for what they say; a request is
 * whole within SERVE_ASK_MS, an answer read within SERVE_READ_MS, or the
 * connection ends; only pages that stay open for events are let be. Thread: the
 * loop's. */
#ifndef RADD_WEB_SERVE_H
#define RADD_WEB_SERVE_H

#include "base/error.h"
#include "net/address.h"
#include "observer/blob.h"

#include <microhttpd.h>
#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#define SERVE_GUESTS  400
#define SERVE_STREAMS 250 /* of these, pages that stay open */
#define SERVE_PER_S   250
#define SERVE_AT_ONCE 200
#define SERVE_ASK_MS  10000
#define SERVE_READ_MS 60000

struct serve;

/* A connection of a browser's. */
struct serve_guest {
    struct serve_guest *next;
    struct MHD_Connection *conn;
    uint64_t since_ms; /* it connected, or its last answer was read */
    enum { GUEST_ASKS, GUEST_READS, GUEST_STREAMS } state;
};

/* One request: `path` without its query.  To be answered (answer.h), or put
 * off: then the callee is called again with the same *state (NULL at
 * first) once serve_wake() says so. */
typedef enum MHD_Result serve_fn(void *arg, struct MHD_Connection *c,
                                 const char *method, const char *path,
                                 void **state);

struct serve_conf {
    const char *listen;   /* ADDR:PORT */
    const char *tls_cert; /* PEM files; "": plain HTTP */
    const char *tls_key;
    serve_fn *fn;
    void (*ended)(void *arg, void *state); /* of a request that is over */
    void *arg;
};

/* Listen.  RAD_ECANTCREAT for an address that cannot be bound, RAD_ENOINPUT or
 * RAD_ECONFIG for the certificate. */
struct serve *serve_open(uv_loop_t *loop, const struct serve_conf *conf,
                         struct rad_error *err);
/* No request may be put off any more.  Closes its handles. */
void serve_close(struct serve *s);
void serve_free(struct serve *s);

/* "127.0.0.1:7480" */
const char *serve_address(const struct serve *s);
unsigned serve_guests(const struct serve *s);

/* Let in connections that wait; each DAEMON_TICK_MS. */
void serve_tick(struct serve *s);
/* End connections that take too long; each second or so. */
void serve_sweep(struct serve *s);

/* Put a request off, or go on with it. */
void serve_put_off(struct MHD_Connection *c);
void serve_wake(struct MHD_Connection *c);
/* The answer to this request does not end. */
void serve_is_stream(struct MHD_Connection *c);

#endif
