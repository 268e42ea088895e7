/* tls.h - TLS 1.3 by a shared key, between a socket and the frames
 *
 * Bytes only: what a socket brought is put in, what it is to send is taken
 * out.  Both sides prove that they have the same secret (RFC 8446, external
 * PSK) with a Diffie-Hellman exchange on top, so that a key which is lost later
 * opens nothing that was recorded.  No certificates, no tickets, no early
 * data, no older version; only suites with SHA-256, which is what such a key
 * is for.
 *
 * Nothing is kept beyond TLS_MARK: the owner puts in what one read brought and
 * takes all messages out before the next; while it cannot, it stops reading.
 * Errors: RAD_EPERM for a side that cannot prove itself, RAD_EPROTO for bytes
 * that are no TLS, RAD_ENOMEM.
 * Thread: a context and its sessions belong to one thread. */
#ifndef TLS_H
#define TLS_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

#define TLS_SECRET 32         /* bytes of a key */
#define TLS_ID     97         /* room for a key's id, with its NUL */
#define TLS_MARK   (1u << 18) /* most bytes that wait to be read */
#define TLS_PIECE  (1u << 16) /* most bytes to tls_write() at once */

struct tls_ctx;
struct tls;

/* Why not of a key that may be told us soon: its client waits for it
 * (tls_waiting), and can tell such a name from others by that. */
#define TLS_LATER "key not known yet"

/* The secret of the key that a client names: NULL and *secret, or why not
 * ("unknown key").  The client is then answered as if its secret were wrong,
 * so it cannot tell which names there are. */
typedef const char *tls_find_fn(void *arg, const char *id,
                                uint8_t secret[TLS_SECRET]);

/* For the side that accepts, and for that which dials; NULL when memory is out.
 * A context outlives its sessions' creation, not their use. */
struct tls_ctx *tls_server(tls_find_fn *find, void *arg);
struct tls_ctx *tls_client(void);
void tls_ctx_free(struct tls_ctx *ctx);

/* A session; NULL when memory is out.  id and secret are copied. */
struct tls *tls_accept(struct tls_ctx *ctx);
struct tls *tls_dial(struct tls_ctx *ctx, const char *id,
                     const uint8_t secret[TLS_SECRET]);
/* Wipes its keys.  NULL is accepted. */
void tls_free(struct tls *t);

/* The id of the key that was proven, before that of the key that was named; ""
 * for none.  Printable. */
const char *tls_id(const struct tls *t);

/* Take n bytes that came.  RAD_EPROTO when more than TLS_MARK wait. */
int tls_put(struct tls *t, const void *p, size_t n, struct rad_error *err);

/* Go on with the handshake: 1 when it is over, 0 when bytes must come, or why
 * it failed.  There may be bytes to send in any case. */
int tls_handshake(struct tls *t, struct rad_error *err);

/* A client's key is not known yet: tls_handshake() asks again each time, after
 * tls_decide() for the last time. */
bool tls_waiting(const struct tls *t);
void tls_decide(struct tls *t);

/* Up to n bytes of what the other side wrote: how many; 0 when more must come
 * or it has ended its side (tls_ended). */
int tls_read(struct tls *t, void *p, size_t n, struct rad_error *err);
bool tls_ended(const struct tls *t);

/* Encrypt bytes for the other side, at most TLS_PIECE of them. */
int tls_write(struct tls *t, const void *p, size_t n, struct rad_error *err);
/* Encrypt any number of bytes into a block of their own, behind `head` bytes
 * that are the caller's to fill: *n bytes in all, to be freed.  NULL on
 * failure. */
void *tls_seal(struct tls *t, const void *p, size_t len, size_t head, size_t *n,
               struct rad_error *err);
/* Encrypt into `to`, which has room for tls_room(len) bytes.  Returns how many
 * bytes were written, or a negative code. */
long tls_seal_into(struct tls *t, const void *p, size_t len, uint8_t *to,
                   struct rad_error *err);
/* Tell the other side that nothing more comes. */
void tls_end(struct tls *t);

/* What is to be sent: how many bytes, and where; valid until the next call on
 * t.  tls_sent() once they were copied. */
size_t tls_out(struct tls *t, const uint8_t **p);
void tls_sent(struct tls *t);

/* The most bytes that n bytes are when they are encrypted. */
size_t tls_room(size_t n);

/* The key of two workers in one job, from what the coordinator gave both: its
 * id, which says nothing, and its secret.  False: memory is out. */
bool tls_peer_key(const uint8_t *job, size_t njob, const uint8_t *token,
                  size_t ntoken, char id[TLS_ID], uint8_t secret[TLS_SECRET]);

#endif
