/* conn.h - one connection: messages in and out of a stream
 *
 * Cuts the bytes that come into messages (proto/frame.h), gives each to the
 * owner, and sends the owner's messages.  Bytes that break the protocol end the
 * connection, with a line in the log that names the peer; no byte from a peer
 * can do more harm.
 *
 * Liveness: once the owner has called conn_live(), a PING goes out each 5 s,
 * each PING is answered by a PONG, and the connection ends after 15 s without a
 * byte.  Before conn_live() it ends after CONN_HANDSHAKE_MS, or the handler's
 * limit_ms.
 *
 * Over TCP messages go through a TLS session, whose handshake is over
 * (handshake.h); a TCP stream without one is our bug.  Byte counts are those of
 * messages, before encryption.
 *
 * Back-pressure: conn_queued() tells how many bytes wait to be sent, and the
 * owner hears what was written.  Above CONN_HIGH the owner should stop
 * producing for this peer.  Users' requests are not read while too many bytes
 * of answers wait, on the connection or on all connections of the user
 * (fair.h).
 *
 * Lifetime: a struct conn is freed when its handles are closed, some time after
 * conn_close() or closed(); from either on the owner must not use it.
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

#define CONN_HIGH         (8u << 20) /* bytes that may wait to be sent */
#define CONN_PING_MS      5000  /* between two PINGs */
#define CONN_DEAD_MS      15000 /* without a byte: the peer is given up */
#define CONN_HANDSHAKE_MS 10000

/* The reason that closed() gets if the peer broke the protocol. */
#define CONN_BROKE_PROTOCOL "protocol error"

struct conn;

struct conn_handler {
    /* A message came; also each PING, after it was answered, and PONG. */
    void (*message)(void *arg, struct conn *c, const struct msg *m);
    /* The connection has ended, not by the owner; why is for the log. */
    void (*closed)(void *arg, struct conn *c, const char *why);
    /* n bytes have been written; may be NULL. */
    void (*written)(void *arg, struct conn *c, size_t n);
    struct log_limit *errors; /* of log lines about bad bytes; NULL: none */
    unsigned limit_ms;        /* time until conn_live(); 0: CONN_HANDSHAKE_MS */
    bool quiet; /* log nothing: closed() calls conn_error() instead */
};

/* Make a connection of an open stream and its TLS session (NULL for a Unix
 * socket), both taken, and begin to read.  handler must outlive the connection;
 * it is not called before conn_new() returns.  NULL: memory is out; stream and
 * session are closed then. */
struct conn *conn_new(uv_stream_t *stream, struct tls *tls,
                      enum msg_session session, const char *peer,
                      const struct conn_handler *handler, void *arg);

/* In closed(): why the connection ended, with a code of ours or libuv's; for a
 * malformed message `where` names the peer. */
const struct rad_error *conn_error(const struct conn *c);

/* In message(): move the message, which points into a payload of n bytes, out
 * of the connection.  Free the returned payload after msg_release(). */
uint8_t *conn_keep(struct conn *c, struct msg *m, size_t *n);

/* The id of the key that the other side has proven; NULL: no TLS. */
const char *conn_key(const struct conn *c);

/* Set the protocol version that the other side speaks; before, the current one
 * is assumed.  Messages are packed and read in that version. */
void conn_set_version(struct conn *c, unsigned version);

/* Make the connection that user's: as a user's or an administrator's, its
 * requests take turns with those of others.  False: memory is out. */
bool conn_set_user(struct conn *c, struct fair *fair, const char *name);

/* Set which messages may come from now on. */
void conn_set_session(struct conn *c, enum msg_session session);

/* The handshake is over.  ping: send PINGs, and end the connection when it is
 * silent; else it may be silent for ever, like a child that loads. */
void conn_live(struct conn *c, bool ping);

/* Set the numbers that PINGs carry. */
void conn_set_ping(struct conn *c, const struct msg_ping *ping);

/* Queue a copy of a message.  False if it cannot be packed or does not exist in
 * the other side's version, which is logged; or if memory is out, which ends
 * the connection (conn_break). */
bool conn_send(struct conn *c, const struct msg *m);
/* The same for a message that is packed: a whole frame.  Also false for RECORDS
 * to a user with more than 8 MiB unread, which is logged once. */
bool conn_send_frame(struct conn *c, const uint8_t *bytes, size_t len);

/* Count n bytes, which are being read from the disk for this connection, as
 * unread by its user, or stop counting them.  False: the user has left too much
 * unread; try again later. */
bool conn_expect(struct conn *c, size_t n);
void conn_expected(struct conn *c, size_t n);
/* Has its user left too much unread? */
bool conn_full(const struct conn *c);

/* Write short messages now, which otherwise are gathered until the end of the
 * loop's turn. */
void conn_flush(struct conn *c);

size_t conn_queued(const struct conn *c);
const char *conn_peer(const struct conn *c);

/* Stop or start reading: back-pressure on a peer that feeds a slow reader. */
void conn_pause(struct conn *c, bool pause);

/* End the connection now, as if it had ended by itself: closed() is called. */
void conn_break(struct conn *c, const char *why);

/* End it now; closed() is not called.  NULL is accepted. */
void conn_close(struct conn *c);
/* End it when all that is queued has been sent, or after CONN_HANDSHAKE_MS.
 * Nothing more is read, and closed() is not called. */
void conn_finish(struct conn *c);

#endif
