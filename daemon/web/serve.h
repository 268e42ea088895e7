/* serve.h - the HTTP server: connections, time limits, answers
 *
 * libmicrohttpd parses requests; libuv's loop watches its epoll descriptor, so
 * all runs in one thread.  route.c finds the answers, answer.h sends them.
 *
 * Bounds: SERVE_GUESTS connections, fewer where descriptors are few.  After the
 * first SERVE_AT_ONCE, SERVE_PER_S connections a second are accepted; others
 * wait in the kernel's queue, and are turned away when that is full.  Each
 * connection has a buffer of 16 KiB for its request.  A connection ends if a
 * request is not whole within SERVE_ASK_MS, or its answer not read within
 * SERVE_READ_MS; event streams have no such limit. Thread: the loop's. */
#ifndef RADD_WEB_SERVE_H
#define RADD_WEB_SERVE_H

#include "base/error.h"

#include <microhttpd.h>
#include <stdint.h>
#include <uv.h>

#define SERVE_GUESTS  400
#define SERVE_STREAMS 250 /* of these, event streams */
#define SERVE_PER_S   250
#define SERVE_AT_ONCE 200
#define SERVE_ASK_MS  10000
#define SERVE_READ_MS 60000

struct serve;

/* A browser's connection. */
struct serve_guest {
    struct serve_guest *next;
    struct MHD_Connection *conn;
    uint64_t since_ms; /* when it connected, or its last answer was read */
    enum { GUEST_ASKS, GUEST_READS, GUEST_STREAMS } state;
};

/* Handle a request, whose path comes without the query.  Send an answer
 * (answer.h), or put the request off (serve_put_off()): then serve_fn is called
 * again after serve_wake(), with *state as it was left.  *state is NULL at
 * first. */
typedef enum MHD_Result serve_fn(void *arg, struct MHD_Connection *c,
                                 const char *method, const char *path,
                                 void **state);

struct serve_conf {
    const char *listen;   /* ADDR:PORT */
    const char *tls_cert; /* PEM files; "": plain HTTP */
    const char *tls_key;
    serve_fn *fn;
    void (*ended)(void *arg, void *state); /* a request is over */
    void *arg;
};

/* Listen; NULL with *err.  RAD_ECANTCREAT: the address cannot be bound;
 * RAD_ENOINPUT, RAD_ECONFIG: the certificate cannot be read or used. */
struct serve *serve_open(uv_loop_t *loop, const struct serve_conf *conf,
                         struct rad_error *err);
/* Close all connections and the handles; no request may be waiting
 * (serve_put_off()).  Run the loop until the handles are closed, then call
 * serve_free(). */
void serve_close(struct serve *s);
void serve_free(struct serve *s);

/* The address that is listened at, such as "127.0.0.1:7480". */
const char *serve_address(const struct serve *s);
/* The number of connections. */
unsigned serve_guests(const struct serve *s);

/* Accept connections that wait; call each DAEMON_TICK_MS. */
void serve_tick(struct serve *s);
/* End connections that take too long; call about once a second. */
void serve_sweep(struct serve *s);

/* Put a request off; go on with a request that was put off. */
void serve_put_off(struct MHD_Connection *c);
void serve_wake(struct MHD_Connection *c);
/* The answer to this request is an event stream: no time limit. */
void serve_is_stream(struct MHD_Connection *c);

#endif
