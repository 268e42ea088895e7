/* conn.h - one connection: messages in and out of a stream
 *
 * Cuts what comes into messages (proto/frame.h), hands each to its owner, and
 * sends the owner's.  What is against the protocol ends the connection with
 * one line in the log that names the peer; no byte that a peer sends can do
 * more.
 *
 * Liveness, once the owner says that the connection is live: a PING each 5 s,
 * a PONG for each PING, and the end after 15 s without a byte.  Before that:
 * the end after CONN_HANDSHAKE_MS, or what the handler says.
 *
 * Over TCP there is a TLS session between the stream and the messages, whose
 * handshake is over (handshake.h); a TCP stream without one is our bug.  Counts
 * of bytes are those of messages.
 *
 * Back-pressure: what waits to be sent is counted, and the owner is told what
 * has been written.  Above CONN_HIGH it should stop producing for this peer.
 * Requests of users wait where their answers are not read, of one connection or
 * of all that a user has (fair.h).
 *
 * Lifetime: a struct conn lives until its handles are closed, which is some
 * time after conn_close() or the closed() call; from either on the owner may
 * not use it any more.
 * Thread: the loop's. */
#ifndef RADD_NET_CONN_H
#define RADD_NET_CONN_H

#include "net/conn_stream.h"
#include "net/fair.h"
#include "proto/frame.h"
#include "net/log.h"
#include "net/tls.h"

#include <stdbool.h>
#include <uv.h>

#define CONN_HIGH         (8u << 20) /* bytes that may wait for a peer */
#define CONN_PING_MS      5000
#define CONN_DEAD_MS      15000
#define CONN_HANDSHAKE_MS 10000

/* closed()'s reason for a peer that did not speak the protocol. */
#define CONN_BROKE_PROTOCOL "protocol error"

struct conn;

struct conn_handler {
    /* PING and PONG come here too, PING after it was answered. */
    void (*message)(void *arg, struct conn *c, const struct msg *m);
    /* The connection ended by itself; why is for the log. */
    void (*closed)(void *arg, struct conn *c, const char *why);
    /* n bytes have been written; may be NULL. */
    void (*written)(void *arg, struct conn *c, size_t n);
    struct log_limit *errors; /* on lines about bad bytes; NULL: none */
    unsigned limit_ms;        /* to be live in; 0: CONN_HANDSHAKE_MS */
    bool quiet; /* nothing for the log: closed() asks conn_error() */
};

/* Take an open stream, and its session (NULL: a Unix socket), and read from
 * it.  handler must outlive the connection and is called later, never from
 * inside.  NULL when memory is out; both are then closed. */
struct conn *conn_new(uv_stream_t *stream, struct tls *tls,
                      enum msg_session session, const char *peer,
                      const struct conn_handler *handler, void *arg);

/* In closed(): why the connection ended, with a code of ours or libuv's; its
 * `where` is the peer for a message that is malformed. */
const struct rad_error *conn_error(const struct conn *c);

/* In message(): take the message over; its n bytes, which are returned, are to
 * be freed after msg_release(). */
uint8_t *conn_keep(struct conn *c, struct msg *m, size_t *n);

/* The id of the key that the other side has proven; NULL: none. */
const char *conn_key(const struct conn *c);

/* The version of the protocol that the other side speaks; the current one until
 * it is told.  Messages are translated on their way. */
void conn_set_version(struct conn *c, unsigned version);

/* The connection is that user's: once its session is a user's or an admin's,
 * its requests are looked at in turn with those of others.  False: memory is
 * out. */
bool conn_set_user(struct conn *c, struct fair *fair, const char *name);

/* Which messages may come from now on. */
void conn_set_session(struct conn *c, enum msg_session session);

/* The handshake is over.  ping: keep it alive with PINGs and end it when it
 * is silent; else it may be silent for ever (a child that loads). */
void conn_live(struct conn *c, bool ping);

/* What goes out with PINGs. */
void conn_set_ping(struct conn *c, const struct msg_ping *ping);

/* Queue a message; its bytes are copied.  False if it cannot be packed or is
 * none in the other side's version, which is logged, and if memory is out: then
 * the connection ends (conn_break). */
bool conn_send(struct conn *c, const struct msg *m);
/* The same for a message that is packed already: a whole frame.  False, too,
 * for RECORDS to a user that has not read 8 MiB yet, which is logged once. */
bool conn_send_frame(struct conn *c, const uint8_t *bytes, size_t len);

/* n bytes for it are being read from the disk, and count as unread by its user;
 * false: they must wait, for that has left too much unread.  And they do no
 * more. */
bool conn_expect(struct conn *c, size_t n);
void conn_expected(struct conn *c, size_t n);

/* Short messages wait for others until the loop has nothing to do; now they
 * need not. */
void conn_flush(struct conn *c);

size_t conn_queued(const struct conn *c);
const char *conn_peer(const struct conn *c);

/* Stop and start reading: the back-pressure on what feeds a slow one. */
void conn_pause(struct conn *c, bool pause);

/* End it now, as if it had ended by itself: closed() is called. */
void conn_break(struct conn *c, const char *why);

/* End it now; closed() is not called.  NULL is accepted. */
void conn_close(struct conn *c);
/* End it when what waits has been sent, at most CONN_HANDSHAKE_MS from now;
 * nothing more is read, closed() is not called. */
void conn_finish(struct conn *c);

#endif
