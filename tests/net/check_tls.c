/* check_tls.c - who gets in by a key and who does not, and what OpenSSL would
 * let in unless told otherwise
 *
 * Strangers are made with OpenSSL itself. */
#include "config.h"

#include "net/tls.h"

#include "tests/unit.h"

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/rsa.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <string.h>

static const uint8_t right[TLS_SECRET] = { 1, 2, 3 };
static const uint8_t wrong[TLS_SECRET] = { 3, 2, 1 };

static const char *
find(void *arg, const char *id, uint8_t secret[TLS_SECRET])
{
    (void)arg;
    if (strcmp(id, "user:old:k1") == 0)
        return "retired key";
    if (strcmp(id, "user:ana:k1") != 0)
        return "unknown key";
    memcpy(secret, right, TLS_SECRET);
    return NULL;
}

/* A server and a client of ours, and what went from one to the other. */
struct pair {
    struct tls_ctx *sctx, *cctx;
    struct tls *s, *c;
    struct rad_error serr, cerr;
    int src, crc;
    size_t carried;
};

static void
open_pair(struct pair *pair, const char *id, const uint8_t *secret)
{
    memset(pair, 0, sizeof *pair);
    pair->sctx = tls_server(find, NULL);
    pair->cctx = tls_client();
    ck_assert(pair->sctx && pair->cctx);
    pair->s = tls_accept(pair->sctx);
    pair->c = tls_dial(pair->cctx, id, secret);
    ck_assert(pair->s && pair->c);
}

static void
close_pair(struct pair *pair)
{
    tls_free(pair->s);
    tls_free(pair->c);
    tls_ctx_free(pair->sctx);
    tls_ctx_free(pair->cctx);
}

static size_t
carry(struct tls *from, struct tls *to)
{
    const uint8_t *bytes;
    size_t n = tls_out(from, &bytes);

    if (n > 0)
        ck_assert_int_eq(tls_put(to, bytes, n, NULL), 0);
    tls_sent(from);
    return n;
}

/* To the end of both, whatever it is. */
static void
shake(struct pair *pair)
{
    for (int i = 0; i < 6; i++) {
        if (pair->crc == 0)
            pair->crc = tls_handshake(pair->c, &pair->cerr);
        pair->carried += carry(pair->c, pair->s);
        if (pair->src == 0)
            pair->src = tls_handshake(pair->s, &pair->serr);
        pair->carried += carry(pair->s, pair->c);
    }
}

static struct pair p;

static void
tear_down(void)
{
    close_pair(&p);
    memset(&p, 0, sizeof p);
}

FIXTURE(NULL, tear_down)

TEST(who_has_the_key_gets_in)
{
    char text[10];

    open_pair(&p, "user:ana:k1", right);
    shake(&p);
    ck_assert_msg(p.crc == 1, "%s", p.cerr.what);
    ck_assert_msg(p.src == 1, "%s", p.serr.what);
    ck_assert_str_eq(tls_id(p.s), "user:ana:k1");
    ck_assert_int_eq(tls_write(p.c, "hello", 5, NULL), 0);
    carry(p.c, p.s);
    ck_assert_int_eq(tls_read(p.s, text, sizeof text, NULL), 5);
    ck_assert_int_eq(memcmp(text, "hello", 5), 0);
    ck_assert_int_eq(tls_read(p.s, text, sizeof text, NULL), 0);
    ck_assert(!tls_ended(p.s));
    tls_end(p.c);
    carry(p.c, p.s);
    ck_assert_int_eq(tls_read(p.s, text, sizeof text, NULL), 0);
    ck_assert(tls_ended(p.s));
}

static const char *
find_later(void *arg, const char *id, uint8_t secret[TLS_SECRET])
{
    int *asked = arg;

    ck_assert_str_eq(id, "peer:7");
    memcpy(secret, right, TLS_SECRET);
    return (*asked)++ < 4 ? TLS_LATER : NULL;
}

/* A client whose key is told us later than it comes, and one whose key is not
 * waited for any longer. */
LOOP_TEST(a_key_may_come_later, 2)
{
    int asked = 0;

    open_pair(&p, "peer:7", right);
    tls_free(p.s);
    tls_ctx_free(p.sctx);
    p.sctx = tls_server(find_later, &asked);
    p.s = tls_accept(p.sctx);
    ck_assert_ptr_nonnull(p.s);
    ck_assert_int_eq(tls_handshake(p.c, NULL), 0);
    carry(p.c, p.s);
    ck_assert(!tls_waiting(p.s));
    ck_assert_int_eq(tls_handshake(p.s, NULL), 0);
    ck_assert(tls_waiting(p.s));
    ck_assert_int_eq(tls_handshake(p.s, NULL), 0);
    ck_assert(tls_waiting(p.s));
    ck_assert_uint_eq(carry(p.s, p.c), 0);
    if (_i == 1)
        tls_decide(p.s);
    shake(&p);
    ck_assert(!tls_waiting(p.s));
    if (_i == 0) {
        ck_assert_msg(p.src == 1 && p.crc == 1, "%s", p.serr.what);
        ck_assert_str_eq(tls_id(p.s), "peer:7");
    } else {
        ck_assert_int_eq(p.src, RAD_ETEMPFAIL);
        ck_assert_str_eq(p.serr.what, TLS_LATER " 'peer:7'");
        ck_assert_int_eq(p.crc, RAD_EPERM);
        ck_assert_str_eq(p.cerr.what, "does not take the key 'peer:7'");
    }
}

static const char *changed_why;
static const uint8_t *changed_secret;

static const char *
find_changed(void *arg, const char *id, uint8_t secret[TLS_SECRET])
{
    (void)arg;
    (void)id;
    memcpy(secret, changed_secret, TLS_SECRET);
    return changed_why;
}

static const struct {
    const char *why;
    const uint8_t *secret;
    int code;
    const char *said;
} changes[] = {
    { "retired key", right, RAD_EPERM, "retired key 'user:ana:k1'" },
    { NULL, wrong, RAD_EPERM, "replaced key 'user:ana:k1'" },
    { TLS_LATER, right, RAD_ETEMPFAIL, "key not known any more 'user:ana:k1'" },
};

LOOP_TEST(a_key_that_changes_before_it_is_proven_is_refused, N_ELEM(changes))
{
    open_pair(&p, "user:ana:k1", right);
    tls_free(p.s);
    tls_ctx_free(p.sctx);
    changed_why = NULL;
    changed_secret = right;
    p.sctx = tls_server(find_changed, NULL);
    p.s = tls_accept(p.sctx);
    ck_assert_ptr_nonnull(p.s);
    ck_assert_int_eq(tls_handshake(p.c, NULL), 0);
    carry(p.c, p.s);
    ck_assert_int_eq(tls_handshake(p.s, NULL), 0);
    carry(p.s, p.c);
    changed_why = changes[_i].why;
    changed_secret = changes[_i].secret;
    shake(&p);
    ck_assert_int_eq(p.src, changes[_i].code);
    ck_assert_str_eq(p.serr.what, changes[_i].said);
}

static const struct {
    const char *id;
    const uint8_t *secret;
    const char *why; /* as the server's log says it */
} strangers[] = {
    { "user:ana:k1", wrong, "wrong secret of key 'user:ana:k1'" },
    { "user:bo:k1", right, "unknown key 'user:bo:k1'" },
    { "user:old:k1", right, "retired key 'user:old:k1'" },
    { "user:\033[2J", right, "unknown key '?'" },
};

/* They cannot tell what is wrong. */
LOOP_TEST(who_has_it_not_learns_nothing, N_ELEM(strangers))
{
    struct pair q;
    const uint8_t *a, *b;
    size_t n;

    open_pair(&p, strangers[_i].id, strangers[_i].secret);
    open_pair(&q, "user:ana:k1", wrong);
    ck_assert_int_eq(tls_handshake(p.c, NULL), 0);
    ck_assert_int_eq(tls_handshake(q.c, NULL), 0);
    carry(p.c, p.s);
    carry(q.c, q.s);
    ck_assert_int_eq(tls_handshake(p.s, &p.serr), RAD_EPERM);
    ck_assert_int_eq(tls_handshake(q.s, NULL), RAD_EPERM);
    ck_assert_str_eq(p.serr.what, strangers[_i].why);
    n = tls_out(p.s, &a);
    ck_assert_uint_gt(n, 0);
    ck_assert_uint_eq(tls_out(q.s, &b), n);
    ck_assert_int_eq(memcmp(a, b, n), 0);
    carry(p.s, p.c);
    ck_assert_int_eq(tls_handshake(p.c, &p.cerr), RAD_EPERM);
    ck_assert_ptr_nonnull(strstr(p.cerr.what, "does not take the key"));
    close_pair(&q);
}

/* --- strangers of OpenSSL's --- */

struct stranger {
    SSL_CTX *ctx;
    SSL *ssl;
    BIO *in, *out;
    bool used; /* its key was asked for */
    int tickets;
    bool early;
    const unsigned char *suite;
};

static int
offer_key(SSL *ssl, const EVP_MD *md, const unsigned char **id, size_t *n,
          SSL_SESSION **session)
{
    struct stranger *x = SSL_get_app_data(ssl);
    SSL_SESSION *s = SSL_SESSION_new();
    const SSL_CIPHER *cipher = SSL_CIPHER_find(ssl, x->suite);

    (void)md;
    x->used = true;
    ck_assert_ptr_nonnull(cipher);
    SSL_SESSION_set1_master_key(s, right, TLS_SECRET);
    SSL_SESSION_set_cipher(s, cipher);
    SSL_SESSION_set_protocol_version(s, TLS1_3_VERSION);
    if (x->early)
        SSL_SESSION_set_max_early_data(s, 1000);
    *id = (const unsigned char *)"user:ana:k1";
    *n = 11;
    *session = s;
    return 1;
}

static int
count_ticket(SSL *ssl, SSL_SESSION *s)
{
    struct stranger *x = SSL_get_app_data(ssl);

    (void)s;
    x->tickets++;
    return 0;
}

static void
open_stranger(struct stranger *x, const SSL_METHOD *method)
{
    static const unsigned char aes128[] = { 0x13, 0x01 };

    memset(x, 0, sizeof *x);
    x->suite = aes128;
    x->ctx = SSL_CTX_new(method);
    SSL_CTX_set_session_cache_mode(x->ctx, SSL_SESS_CACHE_BOTH);
    SSL_CTX_sess_set_new_cb(x->ctx, count_ticket);
}

static void
begin_stranger(struct stranger *x, bool server)
{
    x->ssl = SSL_new(x->ctx);
    x->in = BIO_new(BIO_s_mem());
    x->out = BIO_new(BIO_s_mem());
    SSL_set_bio(x->ssl, x->in, x->out);
    SSL_set_app_data(x->ssl, x);
    if (server)
        SSL_set_accept_state(x->ssl);
    else
        SSL_set_connect_state(x->ssl);
}

static void
close_stranger(struct stranger *x)
{
    SSL_free(x->ssl);
    SSL_CTX_free(x->ctx);
    ERR_clear_error();
}

/* Both sides until nothing moves; ours' code. */
static int
shake_stranger(struct stranger *x, struct tls *ours, struct rad_error *err)
{
    char buf[8192];
    int rc = 0, n;

    for (int i = 0; i < 6; i++) {
        const uint8_t *bytes;
        size_t len;

        SSL_do_handshake(x->ssl);
        while ((n = BIO_read(x->out, buf, sizeof buf)) > 0)
            ck_assert_int_eq(tls_put(ours, buf, (size_t)n, NULL), 0);
        if (rc == 0)
            rc = tls_handshake(ours, err);
        len = tls_out(ours, &bytes);
        if (len > 0)
            BIO_write(x->in, bytes, (int)len);
        tls_sent(ours);
    }
    return rc;
}

static void
self_sign(SSL_CTX *ctx)
{
    EVP_PKEY *key = EVP_RSA_gen(2048);
    X509 *cert = X509_new();

    ASN1_INTEGER_set(X509_get_serialNumber(cert), 1);
    X509_gmtime_adj(X509_getm_notBefore(cert), -60);
    X509_gmtime_adj(X509_getm_notAfter(cert), 3600);
    X509_set_pubkey(cert, key);
    X509_NAME_add_entry_by_txt(X509_get_subject_name(cert), "CN", MBSTRING_ASC,
                               (const unsigned char *)"radcoord", -1, -1, 0);
    X509_set_issuer_name(cert, X509_get_subject_name(cert));
    ck_assert_int_gt(X509_sign(cert, key, EVP_sha256()), 0);
    ck_assert_int_eq(SSL_CTX_use_certificate(ctx, cert), 1);
    ck_assert_int_eq(SSL_CTX_use_PrivateKey(ctx, key), 1);
    X509_free(cert);
    EVP_PKEY_free(key);
}

static const struct {
    int version;
    const char *what;
} servers[] = { { TLS1_3_VERSION,
                  "does not have the key 'user:ana:k1' but a certificate" },
                { TLS1_2_VERSION, "speaks an older version of TLS" } };

LOOP_TEST(a_server_with_a_certificate_is_not_ours, N_ELEM(servers))
{
    struct tls_ctx *ctx = tls_client();
    struct tls *ours = tls_dial(ctx, "user:ana:k1", right);
    struct rad_error err = { 0 };
    struct stranger x;

    open_stranger(&x, TLS_server_method());
    self_sign(x.ctx);
    SSL_CTX_set_max_proto_version(x.ctx, servers[_i].version);
    begin_stranger(&x, true);
    ck_assert_int_eq(shake_stranger(&x, ours, &err), RAD_EPERM);
    ck_assert_str_eq(err.what, servers[_i].what);
    ck_assert(!SSL_is_init_finished(x.ssl)); /* nor does it think so */
    close_stranger(&x);
    tls_free(ours);
    tls_ctx_free(ctx);
}

TEST(a_server_without_tls_is_told)
{
    static const uint8_t answer[] = "HTTP/1.1 400 Bad Request\r\n\r\n";
    struct tls_ctx *ctx = tls_client();
    struct tls *ours = tls_dial(ctx, "user:ana:k1", right);
    struct rad_error err = { 0 };

    ck_assert_int_eq(tls_handshake(ours, NULL), 0);
    ck_assert_int_eq(tls_put(ours, answer, sizeof answer - 1, NULL), 0);
    ck_assert_int_eq(tls_handshake(ours, &err), RAD_EPROTO);
    ck_assert_msg(strncmp(err.what, "no TLS: ", 8) == 0, "%s", err.what);
    tls_free(ours);
    tls_ctx_free(ctx);
}

static void
use_tls12(struct stranger *x)
{
    SSL_CTX_set_max_proto_version(x->ctx, TLS1_2_VERSION);
}

static void
offer_none(struct stranger *x)
{
    (void)x;
}

static void
offer_sha384(struct stranger *x)
{
    static const unsigned char aes256[] = { 0x13, 0x02 };

    x->suite = aes256;
    SSL_CTX_set_ciphersuites(x->ctx, "TLS_AES_256_GCM_SHA384");
    SSL_CTX_set_psk_use_session_callback(x->ctx, offer_key);
}

static unsigned
old_psk(SSL *ssl, const char *hint, char *id, unsigned nid, unsigned char *psk,
        unsigned npsk)
{
    (void)ssl;
    (void)hint;
    (void)npsk;
    snprintf(id, nid, "user:ana:k1");
    memcpy(psk, right, TLS_SECRET);
    return TLS_SECRET;
}

/* The right key, by TLS 1.2's ways. */
static void
offer_old(struct stranger *x)
{
    SSL_CTX_set_max_proto_version(x->ctx, TLS1_2_VERSION);
    SSL_CTX_set_cipher_list(x->ctx, "PSK");
    SSL_CTX_set_psk_client_callback(x->ctx, old_psk);
}

static const struct {
    void (*prepare)(struct stranger *x);
    const char *why;
} clients[] = {
    { use_tls12, "an older version of TLS" },
    { offer_old, "an older version of TLS" },
    { offer_none, "no key was offered" },
    { offer_sha384, "no key was offered" },
};

LOOP_TEST(other_ways_of_tls_are_refused, N_ELEM(clients))
{
    struct tls_ctx *ctx = tls_server(find, NULL);
    struct tls *ours = tls_accept(ctx);
    struct rad_error err = { 0 };
    struct stranger x;

    open_stranger(&x, TLS_client_method());
    clients[_i].prepare(&x);
    begin_stranger(&x, false);
    ck_assert_int_eq(shake_stranger(&x, ours, &err), RAD_EPERM);
    ck_assert_str_eq(err.what, clients[_i].why);
    close_stranger(&x);
    tls_free(ours);
    tls_ctx_free(ctx);
}

/* One that offers everything gets the suite that the key is for, a fresh
 * exchange, and no ticket. */
TEST(suite_exchange_and_tickets_are_as_told)
{
    struct tls_ctx *ctx = tls_server(find, NULL);
    struct tls *ours = tls_accept(ctx);
    struct rad_error err = { 0 };
    struct stranger x;
    char buf[100];

    open_stranger(&x, TLS_client_method());
    SSL_CTX_set_psk_use_session_callback(x.ctx, offer_key);
    begin_stranger(&x, false);
    ck_assert_msg(shake_stranger(&x, ours, &err) == 1, "%s", err.what);
    ck_assert(x.used);
    ck_assert_str_eq(SSL_get_cipher(x.ssl), "TLS_AES_128_GCM_SHA256");
    ck_assert_int_eq(SSL_version(x.ssl), TLS1_3_VERSION);
    ck_assert_int_ne(SSL_get_negotiated_group(x.ssl), 0);
    ck_assert_int_le(SSL_read(x.ssl, buf, sizeof buf), 0);
    ck_assert_int_eq(x.tickets, 0);
    close_stranger(&x);
    tls_free(ours);
    tls_ctx_free(ctx);
}

TEST(early_data_is_not_read)
{
    struct tls_ctx *ctx = tls_server(find, NULL);
    struct tls *ours = tls_accept(ctx);
    struct rad_error err = { 0 };
    struct stranger x;
    char buf[8192];
    size_t n;
    int len;

    open_stranger(&x, TLS_client_method());
    x.early = true;
    SSL_CTX_set_psk_use_session_callback(x.ctx, offer_key);
    begin_stranger(&x, false);
    ck_assert_int_eq(SSL_write_early_data(x.ssl, "early", 5, &n), 1);
    while ((len = BIO_read(x.out, buf, sizeof buf)) > 0)
        ck_assert_int_eq(tls_put(ours, buf, (size_t)len, NULL), 0);
    ck_assert_int_eq(tls_handshake(ours, &err), RAD_EPERM);
    ck_assert_str_eq(err.what, "key 'user:ana:k1': too much early data");
    ck_assert_int_eq(tls_read(ours, buf, sizeof buf, NULL), 0);
    close_stranger(&x);
    tls_free(ours);
    tls_ctx_free(ctx);
}

/* --- bytes --- */

TEST(what_waits_is_bounded)
{
    static uint8_t bytes[TLS_MARK];

    open_pair(&p, "user:ana:k1", right);
    shake(&p);
    for (int i = 0; i < 4; i++)
        ck_assert_int_eq(tls_put(p.s, bytes, TLS_MARK / 4, NULL), 0);
    ck_assert_int_eq(tls_put(p.s, bytes, 1, NULL), RAD_EPROTO);
}

LOOP_TEST(much_arrives_as_it_went_however_it_is_cut, 2)
{
    enum { TOTAL = 1 << 20 };
    static uint8_t sent[TOTAL], got[TOTAL];
    size_t step = _i == 0 ? 1000 : TLS_PIECE, have = 0;

    for (size_t i = 0; i < TOTAL; i++)
        sent[i] = (uint8_t)(i * 7 + i / 251);
    open_pair(&p, "user:ana:k1", right);
    shake(&p);
    for (size_t at = 0; at < TOTAL; at += step) {
        size_t n = TOTAL - at < step ? TOTAL - at : step, wire;
        int rc;

        ck_assert_int_eq(tls_write(p.c, sent + at, n, NULL), 0);
        wire = carry(p.c, p.s);
        ck_assert_uint_le(wire, tls_room(n));
        while ((rc = tls_read(p.s, got + have, TOTAL - have, NULL)) > 0)
            have += (size_t)rc;
        ck_assert_int_eq(rc, 0);
    }
    ck_assert_uint_eq(have, TOTAL);
    ck_assert_int_eq(memcmp(sent, got, TOTAL), 0);
}

LOOP_TEST(a_changed_byte_is_noticed, 20)
{
    const uint8_t *bytes;
    uint8_t copy[200];
    char text[100];
    size_t n;

    open_pair(&p, "user:ana:k1", right);
    shake(&p);
    ck_assert_int_eq(tls_write(p.c, "hello", 5, NULL), 0);
    n = tls_out(p.c, &bytes);
    ck_assert_uint_le(n, sizeof copy);
    memcpy(copy, bytes, n);
    copy[n - 1 - (size_t)_i] ^= 1;
    ck_assert_int_eq(tls_put(p.s, copy, n, NULL), 0);
    ck_assert_int_eq(tls_read(p.s, text, sizeof text, NULL), RAD_EPROTO);
}

static uint32_t
next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 16;
}

LOOP_TEST(garbage_ends_a_handshake, 64)
{
    uint8_t bytes[2000];
    uint32_t state = (uint32_t)_i;
    int rc;

    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (uint8_t)next_random(&state);
    if (_i % 4 == 1)
        memcpy(bytes, "RADD\0\1\0\0", 8);
    if (_i % 4 == 2) /* a record of the handshake, and a ClientHello */
        memcpy(bytes, "\26\3\1\4\0\1\0\3\374\3\3", 11);
    if (_i % 4 == 3)
        memcpy(bytes, "GET / HTTP/1.1\r\n", 16);
    open_pair(&p, "user:ana:k1", right);
    ck_assert_int_eq(tls_put(p.s, bytes, sizeof bytes, NULL), 0);
    rc = tls_handshake(p.s, NULL);
    ck_assert(rc < 0);
    ck_assert_int_eq(tls_read(p.s, bytes, sizeof bytes, NULL), 0);
    ck_assert_int_lt(tls_write(p.s, bytes, 5, NULL), 0);
}

/* A client whose bytes are changed on the way never gets in. */
LOOP_TEST(a_changed_handshake_fails, 64)
{
    const uint8_t *bytes;
    uint8_t copy[1000];
    size_t n;
    int rc;

    open_pair(&p, "user:ana:k1", right);
    ck_assert_int_eq(tls_handshake(p.c, NULL), 0);
    n = tls_out(p.c, &bytes);
    ck_assert_uint_le(n, sizeof copy);
    memcpy(copy, bytes, n);
    tls_sent(p.c);
    copy[(size_t)_i * n / 64] ^= 0x20;
    ck_assert_int_eq(tls_put(p.s, copy, n, NULL), 0);
    rc = tls_handshake(p.s, NULL);
    if (rc == 0) { /* it waits for more, or has not noticed yet */
        carry(p.s, p.c);
        rc = tls_handshake(p.c, NULL);
        carry(p.c, p.s);
        ck_assert_int_ne(tls_handshake(p.s, NULL), 1);
    }
    ck_assert_int_ne(rc, 1);
}

TEST(peers_of_one_job_have_a_key_of_their_own)
{
    uint8_t job[16] = { 1 }, token[16] = { 2 }, a[TLS_SECRET], b[TLS_SECRET];
    char ida[TLS_ID], idb[TLS_ID];

    ck_assert(tls_peer_key(job, 16, token, 16, ida, a));
    ck_assert(tls_peer_key(job, 16, token, 16, idb, b));
    ck_assert_str_eq(ida, idb);
    ck_assert_int_eq(memcmp(a, b, TLS_SECRET), 0);
    ck_assert_uint_eq(strlen(ida), 5 + 32);
    job[15] = 1;
    ck_assert(tls_peer_key(job, 16, token, 16, idb, b));
    ck_assert_str_ne(ida, idb);
    ck_assert_int_ne(memcmp(a, b, TLS_SECRET), 0);
    job[15] = 0;
    token[15] = 1;
    ck_assert(tls_peer_key(job, 16, token, 16, idb, b));
    ck_assert_str_ne(ida, idb);
    ck_assert_int_ne(memcmp(a, b, TLS_SECRET), 0);
}
