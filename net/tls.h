/* tls.h - TLS 1.3 by a shared key, between a socket and the frames
 *
 * Handles bytes only: the owner puts in what the socket received and takes out
 * what is to be sent.  Each side proves that it has the shared secret (RFC
 * 8446, external PSK).  A Diffie-Hellman exchange is added, so a key that leaks
 * later does not open recorded traffic.  There are no certificates, tickets,
 * early data or older versions, and only suites with SHA-256, the hash that
 * such a key is made for.
 *
 * At most TLS_MARK bytes are kept: the owner puts in the bytes of one read and
 * takes all messages out before the next, and stops reading while it cannot.
 * Errors: RAD_EPERM if the other side cannot prove itself, RAD_ETEMPFAIL if its
 * key is one that comes and goes (TLS_LATER) and is not there, RAD_EPROTO for
 * bytes that are not TLS, RAD_ENOMEM.
 * Thread: a context and its sessions belong to one thread. */
#ifndef TLS_H
#define TLS_H

#include "base/error.h"

#include <stdbool.h>
#include <stdint.h>

#define TLS_SECRET 32         /* bytes of a key */
#define TLS_ID     97         /* room for a key's id, with its NUL */
#define TLS_MARK   (1u << 18) /* most bytes that wait to be read */
#define TLS_PIECE  (1u << 16) /* most bytes of one tls_write() */

struct tls_ctx;
struct tls;

/* A tls_find_fn returns this for a key that may become known soon.  The client
 * has to wait (tls_waiting), so it can tell such a name from others. */
#define TLS_LATER "key not known yet"

/* Look up the key that a client names.  Returns NULL and its secret, or the
 * reason why there is none ("unknown key").  The client is answered as if its
 * secret were wrong, so it cannot find out which names exist.  Called again
 * when the client has proven the key, which must then still be the same. */
typedef const char *tls_find_fn(void *arg, const char *id,
                                uint8_t secret[TLS_SECRET]);

/* Contexts for the side that accepts and for the side that dials; NULL: memory
 * is out.  A context must outlive all its sessions. */
struct tls_ctx *tls_server(tls_find_fn *find, void *arg);
struct tls_ctx *tls_client(void);
void tls_ctx_free(struct tls_ctx *ctx);

/* A session; NULL: memory is out.  id and secret are copied. */
struct tls *tls_accept(struct tls_ctx *ctx);
struct tls *tls_dial(struct tls_ctx *ctx, const char *id,
                     const uint8_t secret[TLS_SECRET]);
/* Also wipes its keys.  NULL is accepted. */
void tls_free(struct tls *t);

/* The id of the key that was proven; before that, of the key that was named;
 * "": no key.  Printable. */
const char *tls_id(const struct tls *t);

/* Put in n bytes that were received.  RAD_EPROTO: more than TLS_MARK wait. */
int tls_put(struct tls *t, const void *p, size_t n, struct rad_error *err);

/* Go on with the handshake.  Returns 1 when it is over, 0 if bytes must come
 * first, or an error.  There may be bytes to send in any case. */
int tls_handshake(struct tls *t, struct rad_error *err);

/* Is the client's key not known yet?  Then each tls_handshake() looks for it
 * again, and after tls_decide() once more. */
bool tls_waiting(const struct tls *t);
void tls_decide(struct tls *t);

/* Read up to n decrypted bytes; returns how many.  0: more must come, or the
 * other side has ended its half (tls_ended). */
int tls_read(struct tls *t, void *p, size_t n, struct rad_error *err);
bool tls_ended(const struct tls *t);

/* Encrypt at most TLS_PIECE bytes for the other side. */
int tls_write(struct tls *t, const void *p, size_t n, struct rad_error *err);
/* Encrypt any number of bytes into a new block, *n bytes in all, which begins
 * with `head` bytes for the caller to fill.  To be freed; NULL on failure. */
void *tls_seal(struct tls *t, const void *p, size_t len, size_t head, size_t *n,
               struct rad_error *err);
/* Encrypt into `to`, which has room for tls_room(len) bytes.  Returns how many
 * bytes were written, or a negative code. */
long tls_seal_into(struct tls *t, const void *p, size_t len, uint8_t *to,
                   struct rad_error *err);
/* Tell the other side that nothing more comes. */
void tls_end(struct tls *t);

/* The bytes that are to be sent: returns their number and sets *p, valid until
 * the next call on t.  Call tls_sent() when they are copied. */
size_t tls_out(struct tls *t, const uint8_t **p);
void tls_sent(struct tls *t);

/* The most bytes that n bytes take when they are encrypted. */
size_t tls_room(size_t n);

/* The key for two workers in one job, from what the coordinator gave both: its
 * id, which reveals nothing, and its secret.  False: memory is out. */
bool tls_peer_key(const uint8_t *job, size_t njob, const uint8_t *token,
                  size_t ntoken, char id[TLS_ID], uint8_t secret[TLS_SECRET]);

#endif
