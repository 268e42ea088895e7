/* tls.c - see tls.h
 *
 * Against these habits of OpenSSL 3.0 something is done here; check_tls.c tests
 * each:
 * - a suite whose hash differs from the key's makes the key silently unusable:
 * only suites with SHA-256 are allowed;
 * - a client that offers a key goes on with a server that ignores it and shows
 * a certificate: the client verifies against an empty store and insists that
 * the session was resumed, as it is when a key is used;
 * - an unknown name ends in another alert than a wrong secret: an unknown name
 * is answered with a random key;
 * - tickets would be keys of their own that nobody could retire: none are made;
 * - a memory BIO takes any number of bytes: tls_put() has a limit. */
#include "config.h"

#include "net/tls.h"

#include "base/hex.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/rand.h>
#include <openssl/ssl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SUITES "TLS_AES_128_GCM_SHA256:TLS_CHACHA20_POLY1305_SHA256"
#define GROUPS "X25519:P-256"

/* A record holds 16 KiB; header, content type and tag add 22 bytes. */
#define RECORD      16384
#define RECORD_MORE 22
#define OUT_SLACK   512 /* room for an alert or a key update */

struct tls_ctx {
    SSL_CTX *ssl;
    tls_find_fn *find; /* of a server */
    void *arg;
};

/* SILENT -> HELLO -> DONE (the handshake) -> ENDED, by the other side.  Only a
 * server has HELLO: a ClientHello came; before it WAITING, for the key. */
enum tls_state { TLS_SILENT, TLS_HELLO, TLS_WAITING, TLS_DONE, TLS_ENDED };

struct tls {
    SSL *ssl;
    BIO *in, *out; /* ssl's */
    struct tls_ctx *ctx;
    bool server, decide; /* decide: do not wait for the key any longer */
    enum tls_state state;
    const char *fault; /* of a server: why the client's key is refused */
    char id[TLS_ID];
    uint8_t secret[TLS_SECRET]; /* the key's, until the handshake is over */
};

/* --- keys --- */

/* A session that represents an external key (RFC 8446, 4.2.11). */
static SSL_SESSION *
key_session(SSL *ssl, const uint8_t secret[TLS_SECRET])
{
    static const unsigned char suite[] = { 0x13, 0x01 }; /* AES_128_GCM */
    const SSL_CIPHER *cipher = SSL_CIPHER_find(ssl, suite);
    SSL_SESSION *s = SSL_SESSION_new();

    if (s && cipher && SSL_SESSION_set1_master_key(s, secret, TLS_SECRET) &&
        SSL_SESSION_set_cipher(s, cipher) &&
        SSL_SESSION_set_protocol_version(s, TLS1_3_VERSION))
        return s;
    SSL_SESSION_free(s);
    return NULL;
}

/* Take the key's name that a client sent; false: it cannot be one. */
static bool
take_id(struct tls *t, const unsigned char *id, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (n >= TLS_ID || id[i] <= ' ' || id[i] > '~') {
            strcpy(t->id, "?");
            return false;
        }
    memcpy(t->id, id, n);
    t->id[n] = '\0';
    return n > 0;
}

static int
find_key(SSL *ssl, const unsigned char *id, size_t n, SSL_SESSION **session)
{
    struct tls *t = SSL_get_app_data(ssl);
    uint8_t secret[TLS_SECRET], unknown[TLS_SECRET];

    /* always made, so that an unknown name takes as long as a known one */
    if (RAND_bytes(unknown, sizeof unknown) != 1)
        return 0;
    memset(secret, 0, sizeof secret);
    t->fault = take_id(t, id, n) ? t->ctx->find(t->ctx->arg, t->id, secret)
                                 : "unknown key";
    memcpy(t->secret, secret, sizeof secret);
    *session = key_session(ssl, t->fault ? unknown : secret);
    OPENSSL_cleanse(secret, sizeof secret);
    OPENSSL_cleanse(unknown, sizeof unknown);
    return *session != NULL;
}

static int
use_key(SSL *ssl, const EVP_MD *md, const unsigned char **id, size_t *n,
        SSL_SESSION **session)
{
    struct tls *t = SSL_get_app_data(ssl);

    (void)md; /* SHA-256, the hash of all suites */
    *session = key_session(ssl, t->secret);
    *id = (const unsigned char *)t->id;
    *n = strlen(t->id);
    return *session != NULL;
}

static bool
is_later(const char *fault)
{
    return strcmp(fault, TLS_LATER) == 0;
}

/* The first name in a ClientHello's list of keys (RFC 8446, 4.2.11): it follows
 * the list's length and its own. */
static bool
first_name(SSL *ssl, const unsigned char **id, size_t *n)
{
    const unsigned char *p;
    size_t len;

    if (!SSL_client_hello_get0_ext(ssl, TLSEXT_TYPE_psk, &p, &len) || len < 4)
        return false;
    *n = (size_t)p[2] << 8 | p[3];
    *id = p + 4;
    return *n <= len - 4;
}

/* Called for a ClientHello.  Only here, before the key is looked up, can a
 * handshake be held to wait for a key. */
static int
see_hello(SSL *ssl, int *alert, void *arg)
{
    struct tls *t = SSL_get_app_data(ssl);
    uint8_t secret[TLS_SECRET];
    const unsigned char *id;
    const char *why;
    size_t n;

    (void)alert;
    (void)arg;
    t->state = TLS_HELLO;
    if (t->decide || !first_name(ssl, &id, &n) || !take_id(t, id, n))
        return SSL_CLIENT_HELLO_SUCCESS;
    why = t->ctx->find(t->ctx->arg, t->id, secret);
    OPENSSL_cleanse(secret, sizeof secret);
    t->state = why && is_later(why) ? TLS_WAITING : TLS_HELLO;
    if (t->state == TLS_WAITING)
        return SSL_CLIENT_HELLO_RETRY;
    t->id[0] = '\0'; /* the client may prove no key at all */
    return SSL_CLIENT_HELLO_SUCCESS;
}

/* --- contexts --- */

static bool
configure(SSL_CTX *c)
{
    SSL_CTX_set_options(c, SSL_OP_NO_TICKET | SSL_OP_NO_RENEGOTIATION |
                               SSL_OP_NO_COMPRESSION |
                               SSL_OP_CIPHER_SERVER_PREFERENCE);
    SSL_CTX_clear_options(c, SSL_OP_ENABLE_MIDDLEBOX_COMPAT);
    SSL_CTX_set_mode(c, SSL_MODE_AUTO_RETRY | SSL_MODE_RELEASE_BUFFERS);
    SSL_CTX_set_session_cache_mode(c, SSL_SESS_CACHE_OFF);
    SSL_CTX_set_max_early_data(c, 0);
    SSL_CTX_set_recv_max_early_data(c, 0);
    return SSL_CTX_set_min_proto_version(c, TLS1_3_VERSION) &&
           SSL_CTX_set_max_proto_version(c, TLS1_3_VERSION) &&
           SSL_CTX_set_ciphersuites(c, SUITES) &&
           SSL_CTX_set1_groups_list(c, GROUPS) && SSL_CTX_set_num_tickets(c, 0);
}

static struct tls_ctx *
new_ctx(const SSL_METHOD *method)
{
    struct tls_ctx *ctx = calloc(1, sizeof *ctx);

    if (!ctx)
        return NULL;
    ctx->ssl = SSL_CTX_new(method);
    if (ctx->ssl && configure(ctx->ssl))
        return ctx;
    tls_ctx_free(ctx);
    return NULL;
}

struct tls_ctx *
tls_server(tls_find_fn *find, void *arg)
{
    struct tls_ctx *ctx = new_ctx(TLS_server_method());

    if (!ctx)
        return NULL;
    ctx->find = find;
    ctx->arg = arg;
    SSL_CTX_set_psk_find_session_callback(ctx->ssl, find_key);
    SSL_CTX_set_client_hello_cb(ctx->ssl, see_hello, NULL);
    return ctx;
}

struct tls_ctx *
tls_client(void)
{
    struct tls_ctx *ctx = new_ctx(TLS_client_method());

    if (!ctx)
        return NULL;
    SSL_CTX_set_psk_use_session_callback(ctx->ssl, use_key);
    /* so no certificate is accepted: the store of trusted ones is empty */
    SSL_CTX_set_verify(ctx->ssl, SSL_VERIFY_PEER, NULL);
    return ctx;
}

void
tls_ctx_free(struct tls_ctx *ctx)
{
    if (!ctx)
        return;
    SSL_CTX_free(ctx->ssl);
    free(ctx);
}

/* --- sessions --- */

static struct tls *
new_session(struct tls_ctx *ctx)
{
    struct tls *t = calloc(1, sizeof *t);

    if (!t)
        return NULL;
    t->ctx = ctx;
    t->ssl = SSL_new(ctx->ssl);
    t->in = BIO_new(BIO_s_mem());
    t->out = BIO_new(BIO_s_mem());
    if (!t->ssl || !t->in || !t->out) {
        SSL_free(t->ssl);
        BIO_free(t->in);
        BIO_free(t->out);
        free(t);
        return NULL;
    }
    SSL_set_bio(t->ssl, t->in, t->out);
    SSL_set_app_data(t->ssl, t);
    return t;
}

struct tls *
tls_accept(struct tls_ctx *ctx)
{
    struct tls *t = new_session(ctx);

    if (t) {
        t->server = true;
        SSL_set_accept_state(t->ssl);
    }
    return t;
}

struct tls *
tls_dial(struct tls_ctx *ctx, const char *id, const uint8_t secret[TLS_SECRET])
{
    struct tls *t = new_session(ctx);

    if (t) {
        snprintf(t->id, sizeof t->id, "%s", id);
        memcpy(t->secret, secret, TLS_SECRET);
        SSL_set_connect_state(t->ssl);
    }
    return t;
}

void
tls_free(struct tls *t)
{
    if (!t)
        return;
    SSL_free(t->ssl); /* also frees its BIOs */
    OPENSSL_cleanse(t, sizeof *t);
    free(t);
}

const char *
tls_id(const struct tls *t)
{
    return t->id;
}

int
tls_put(struct tls *t, const void *p, size_t n, struct rad_error *err)
{
    if (n > TLS_MARK || BIO_ctrl_pending(t->in) > TLS_MARK - n)
        return rad_fail(err, RAD_EPROTO, "too many bytes wait to be read");
    if (n > 0 && BIO_write(t->in, p, (int)n) != (int)n)
        return rad_fail_memory(err);
    return 0;
}

/* --- the handshake --- */

static bool
is_version_error(unsigned long e)
{
    int r = ERR_GET_REASON(e);

    return ERR_GET_LIB(e) == ERR_LIB_SSL &&
           (r == SSL_R_UNSUPPORTED_PROTOCOL || r == SSL_R_VERSION_TOO_LOW ||
            r == SSL_R_TLSV1_ALERT_PROTOCOL_VERSION);
}

/* Say why a client was refused. */
static int
server_failed(struct tls *t, unsigned long e, struct rad_error *err)
{
    const char *reason = ERR_reason_error_string(e);

    if (t->fault)
        return rad_fail(err, is_later(t->fault) ? RAD_ETEMPFAIL : RAD_EPERM,
                        "%s '%s'", t->fault, t->id);
    if (t->id[0] && ERR_GET_REASON(e) == SSL_R_BINDER_DOES_NOT_VERIFY)
        return rad_fail(err, RAD_EPERM, "wrong secret of key '%s'", t->id);
    if (t->id[0])
        return rad_fail(err, RAD_EPERM, "key '%s': %s", t->id,
                        reason ? reason : "?");
    if (is_version_error(e))
        return rad_fail(err, RAD_EPERM, "an older version of TLS");
    if (t->state != TLS_SILENT)
        return rad_fail(err, RAD_EPERM, "no key was offered");
    return rad_fail(err, RAD_EPROTO, "no TLS: %s", reason ? reason : "?");
}

/* Say why a server refused us.  If it does not have our key it sends an alert,
 * or a certificate. */
static int
client_failed(struct tls *t, unsigned long e, struct rad_error *err)
{
    const char *reason = ERR_reason_error_string(e);
    int r = ERR_GET_REASON(e);

    if (ERR_GET_LIB(e) == ERR_LIB_SSL && r == SSL_R_CERTIFICATE_VERIFY_FAILED)
        return rad_fail(err, RAD_EPERM,
                        "does not have the key '%s' but a certificate", t->id);
    if (is_version_error(e)) /* which may be an alert, too */
        return rad_fail(err, RAD_EPERM, "speaks an older version of TLS");
    if (ERR_GET_LIB(e) == ERR_LIB_SSL && r >= SSL_AD_REASON_OFFSET)
        return rad_fail(err, RAD_EPERM, "does not take the key '%s'", t->id);
    return rad_fail(err, RAD_EPROTO, "no TLS: %s", reason ? reason : "?");
}

/* A client has proven the key that it named.  Is that key still valid, and the
 * same?  It may have been retired or replaced since it was looked up. */
static int
check_key_again(struct tls *t, struct rad_error *err)
{
    uint8_t secret[TLS_SECRET] = { 0 };
    const char *why = t->ctx->find(t->ctx->arg, t->id, secret);

    if (!why && CRYPTO_memcmp(secret, t->secret, TLS_SECRET) != 0)
        why = "replaced key";
    OPENSSL_cleanse(secret, sizeof secret);
    if (why && is_later(why)) /* it was known at the first look */
        return rad_fail(err, RAD_ETEMPFAIL, "key not known any more '%s'",
                        t->id);
    return why ? rad_fail(err, RAD_EPERM, "%s '%s'", why, t->id) : 0;
}

int
tls_handshake(struct tls *t, struct rad_error *err)
{
    unsigned long e;
    int rc;

    if (t->state >= TLS_DONE)
        return 1;
    ERR_clear_error();
    rc = SSL_do_handshake(t->ssl);
    if (rc == 1) {
        if (!SSL_session_reused(t->ssl))
            return rad_fail(err, RAD_EPERM, "the key '%s' was not used", t->id);
        if (t->server && (rc = check_key_again(t, err)) < 0)
            return rc;
        t->state = TLS_DONE;
        /* a proven peer may keep its 33 KiB of buffers: to allocate them for
         * each record takes as long as to encrypt a short one */
        SSL_clear_mode(t->ssl, SSL_MODE_RELEASE_BUFFERS);
        OPENSSL_cleanse(t->secret, sizeof t->secret);
        return 1;
    }
    rc = SSL_get_error(t->ssl, rc);
    if (rc == SSL_ERROR_WANT_READ || rc == SSL_ERROR_WANT_WRITE ||
        rc == SSL_ERROR_WANT_CLIENT_HELLO_CB)
        return 0;
    e = ERR_peek_error();
    rc = t->server ? server_failed(t, e, err) : client_failed(t, e, err);
    ERR_clear_error();
    return rc;
}

bool
tls_waiting(const struct tls *t)
{
    return t->state == TLS_WAITING;
}

void
tls_decide(struct tls *t)
{
    t->decide = true;
}

/* --- bytes --- */

static int
broken(struct rad_error *err)
{
    const char *reason = ERR_reason_error_string(ERR_peek_error());

    rad_fail(err, RAD_EPROTO, "TLS is broken: %s", reason ? reason : "?");
    ERR_clear_error();
    return RAD_EPROTO;
}

int
tls_read(struct tls *t, void *p, size_t n, struct rad_error *err)
{
    int rc, why;

    if (t->state != TLS_DONE)
        return 0;
    /* faster than SSL_read(), which would take as long as a short message */
    if (SSL_pending(t->ssl) == 0 && BIO_ctrl_pending(t->in) == 0)
        return 0;
    ERR_clear_error();
    rc = SSL_read(t->ssl, p, n > INT32_MAX ? INT32_MAX : (int)n);
    if (rc > 0)
        return rc;
    why = SSL_get_error(t->ssl, rc);
    if (why == SSL_ERROR_WANT_READ)
        return 0;
    if (why != SSL_ERROR_ZERO_RETURN)
        return broken(err);
    t->state = TLS_ENDED;
    return 0;
}

bool
tls_ended(const struct tls *t)
{
    return t->state == TLS_ENDED;
}

int
tls_write(struct tls *t, const void *p, size_t n, struct rad_error *err)
{
    if (t->state < TLS_DONE || n > TLS_PIECE)
        return rad_fail(err, RAD_EINTERNAL, "not now, or too much");
    if (n > 0 && SSL_write(t->ssl, p, (int)n) != (int)n)
        return broken(err);
    return 0;
}

/* Append to `to` what the session has to send, if there is room. */
static bool
append_out(struct tls *t, uint8_t *to, size_t *at, size_t room)
{
    size_t n = BIO_ctrl_pending(t->out);

    if (n > room - *at)
        return false;
    /* BIO_reset() would clear the whole buffer, which takes longer */
    if (n > 0 && BIO_read(t->out, to + *at, (int)n) != (int)n)
        return false;
    *at += n;
    return true;
}

long
tls_seal_into(struct tls *t, const void *p, size_t len, uint8_t *to,
              struct rad_error *err)
{
    size_t room = tls_room(len), at = 0;
    const uint8_t *from = p;

    for (size_t piece; len > 0; from += piece, len -= piece) {
        piece = len < TLS_PIECE ? len : TLS_PIECE;
        if (tls_write(t, from, piece, err) != 0)
            return RAD_EPROTO;
        if (!append_out(t, to, &at, room))
            return rad_fail(err, RAD_EINTERNAL,
                            "more comes of it than there is room");
    }
    return (long)at;
}

void *
tls_seal(struct tls *t, const void *p, size_t len, size_t head, size_t *n,
         struct rad_error *err)
{
    uint8_t *block = malloc(head + tls_room(len));
    long rc;

    *n = 0;
    if (!block) {
        rad_fail_memory(err);
        return NULL;
    }
    rc = tls_seal_into(t, p, len, block + head, err);
    if (rc < 0) {
        free(block);
        return NULL;
    }
    *n = (size_t)rc;
    return block;
}

void
tls_end(struct tls *t)
{
    if (t->state >= TLS_DONE)
        SSL_shutdown(t->ssl);
    ERR_clear_error();
}

size_t
tls_out(struct tls *t, const uint8_t **p)
{
    char *data = NULL;
    long n = BIO_get_mem_data(t->out, &data);

    *p = (const uint8_t *)data;
    return n > 0 ? (size_t)n : 0;
}

void
tls_sent(struct tls *t)
{
    (void)BIO_reset(t->out);
}

size_t
tls_room(size_t n)
{
    return n + (n / RECORD + n / TLS_PIECE + 2) * RECORD_MORE + OUT_SLACK;
}

/* --- keys of peers --- */

static bool
hash(const char *what, const uint8_t *job, size_t njob, const uint8_t *token,
     size_t ntoken, uint8_t digest[TLS_SECRET])
{
    EVP_MD_CTX *c = EVP_MD_CTX_new();
    bool ok = c && EVP_DigestInit_ex(c, EVP_sha256(), NULL) &&
              EVP_DigestUpdate(c, what, strlen(what) + 1) &&
              EVP_DigestUpdate(c, job, njob) &&
              EVP_DigestUpdate(c, token, ntoken) &&
              EVP_DigestFinal_ex(c, digest, NULL);

    EVP_MD_CTX_free(c);
    return ok;
}

bool
tls_peer_key(const uint8_t *job, size_t njob, const uint8_t *token,
             size_t ntoken, char id[TLS_ID], uint8_t secret[TLS_SECRET])
{
    uint8_t name[TLS_SECRET];

    if (!hash("radd peer name", job, njob, token, ntoken, name) ||
        !hash("radd peer key", job, njob, token, ntoken, secret))
        return false;
    strcpy(id, "peer:");
    rad_hex_write(name, 16, id + strlen(id));
    return true;
}
