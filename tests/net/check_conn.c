/* check_conn.c - messages over a socket pair, good bytes and bad */
#include "config.h"

#include "net/conn_impl.h"
#include "net/log.h"

#include "tests/unit.h"

#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <openssl/ssl.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#ifdef WITH_MALLOC /* a sanitizer has its own */
/* Memory that is out when a test says so. */
static bool no_malloc, no_realloc;

extern void *__libc_malloc(size_t n);
extern void *__libc_realloc(void *p, size_t n);

void *
malloc(size_t n)
{
    return no_malloc ? NULL : __libc_malloc(n);
}

void *
realloc(void *p, size_t n)
{
    return no_realloc ? NULL : __libc_realloc(p, n);
}
#endif

/* One connection of ours, and a bare socket at its other end. */
enum { PING_BYTES = 12 };

struct ends {
    uv_loop_t loop;
    struct conn *conn;
    int fd;
    int nmessages, nclosed;
    uint16_t last_type;
    uint64_t last_progress;
    size_t written;
    char why[100];
    bool close_in_message;
};

static struct ends e;

static void
on_message(void *arg, struct conn *c, const struct msg *m)
{
    (void)arg;
    e.nmessages++;
    e.last_type = m->type;
    if (m->type == MSG_PING)
        e.last_progress = m->ping.progress;
    if (e.close_in_message) {
        conn_close(c);
        e.conn = NULL;
    }
}

static void
on_closed(void *arg, struct conn *c, const char *why)
{
    (void)arg;
    (void)c;
    e.nclosed++;
    e.conn = NULL;
    strncpy(e.why, why, sizeof e.why - 1);
}

static void
on_written(void *arg, struct conn *c, size_t n)
{
    (void)arg;
    (void)c;
    e.written += n;
}

static const struct conn_handler handler = { .message = on_message,
                                             .closed = on_closed,
                                             .written = on_written };

static void
open_ends_of(enum msg_session session, const struct conn_handler *owner)
{
    int fds[2];
    uv_stream_t *s;

    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fds),
                     0);
    s = conn_stream_new(&e.loop, true);
    ck_assert_int_eq(uv_pipe_open((uv_pipe_t *)s, fds[0]), 0);
    e.fd = fds[1];
    e.conn = conn_new(s, NULL, session, "test", owner, NULL);
    ck_assert_ptr_nonnull(e.conn);
}

static void
open_ends(enum msg_session session)
{
    open_ends_of(session, &handler);
}

static void
set_up(void)
{
    e = (struct ends){ .fd = -1 };
    log_set_level(LOG_LEVEL_ERR);
    ck_assert_int_eq(uv_loop_init(&e.loop), 0);
}

static void
tear_down(void)
{
    conn_close(e.conn);
    close(e.fd);
    uv_run(&e.loop, UV_RUN_DEFAULT);
    ck_assert_int_eq(uv_loop_close(&e.loop), 0);
}

FIXTURE(set_up, tear_down)

/* Run the loop until nothing happens any more at once. */
static void
run(void)
{
    while (uv_run(&e.loop, UV_RUN_NOWAIT) && uv_backend_timeout(&e.loop) == 0)
        ;
    for (int i = 0; i < 4; i++)
        uv_run(&e.loop, UV_RUN_NOWAIT);
}

static void
pack_ping(struct wire_out *w, uint64_t progress)
{
    struct msg m = { .type = MSG_PING, .request = 7 };

    m.ping.progress = progress;
    wire_out_init(w, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(w, &m), 0);
}

/* Else small messages wait for each other: 40 ms, as a rule. */
TEST(messages_over_tcp_go_at_once)
{
    uv_stream_t *s;
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0), on = 0;
    socklen_t size = sizeof on;
    struct tls_ctx *ctx = tls_client();
    const uint8_t secret[TLS_SECRET] = { 1 };

    ck_assert_int_ge(fd, 0);
    s = conn_stream_new(&e.loop, false);
    ck_assert_int_eq(uv_tcp_open((uv_tcp_t *)s, fd), 0);
    e.conn = conn_new(s, tls_dial(ctx, "user:a:k1", secret), MSG_AT_COORD_NEW,
                      "test", &handler, NULL);
    ck_assert_int_eq(getsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, &size), 0);
    ck_assert_int_ne(on, 0);
    tls_ctx_free(ctx);
}

static const char *
find_key(void *arg, const char *id, uint8_t secret[TLS_SECRET])
{
    (void)arg;
    (void)id;
    memset(secret, 7, TLS_SECRET);
    return NULL;
}

static int
offer_key(SSL *ssl, const EVP_MD *md, const unsigned char **id, size_t *n,
          SSL_SESSION **session)
{
    static const unsigned char aes128[] = { 0x13, 0x01 };
    unsigned char secret[TLS_SECRET];
    SSL_SESSION *s = SSL_SESSION_new();

    (void)md;
    memset(secret, 7, sizeof secret);
    SSL_SESSION_set1_master_key(s, secret, sizeof secret);
    SSL_SESSION_set_cipher(s, SSL_CIPHER_find(ssl, aes128));
    SSL_SESSION_set_protocol_version(s, TLS1_3_VERSION);
    *id = (const unsigned char *)"user:a:k1";
    *n = 9;
    *session = s;
    return 1;
}

/* A client of OpenSSL's that has proven the key to *ours. */
static SSL *
shake(SSL_CTX *ctx, struct tls *ours)
{
    SSL *ssl = SSL_new(ctx);
    BIO *in = BIO_new(BIO_s_mem()), *out = BIO_new(BIO_s_mem());
    const uint8_t *p;
    char *q;
    size_t n;

    SSL_set_bio(ssl, in, out);
    SSL_set_connect_state(ssl);
    for (int i = 0; i < 4; i++) {
        SSL_do_handshake(ssl);
        n = (size_t)BIO_get_mem_data(out, &q);
        ck_assert_int_eq(tls_put(ours, q, n, NULL), 0);
        (void)BIO_reset(out);
        tls_handshake(ours, NULL);
        n = tls_out(ours, &p);
        BIO_write(in, p, (int)n);
        tls_sent(ours);
    }
    ck_assert(SSL_is_init_finished(ssl));
    return ssl;
}

static const struct {
    enum msg_session session;
    bool ends; /* or is it not read any more? */
} updating[] = {
    { MSG_AT_COORD_USER, false },
    { MSG_AT_COORD_NEW, false }, /* it says no HELLO */
    { MSG_AT_COORD_WORKER, true },
    { MSG_AT_PEER, true },
};

/* Each asks for an answer, but none for a message. */
LOOP_TEST(key_updates_are_not_read_while_their_answers_are_not,
          N_ELEM(updating))
{
    struct tls_ctx *sctx = tls_server(find_key, NULL);
    SSL_CTX *cctx = SSL_CTX_new(TLS_client_method());
    struct tls *ours = tls_accept(sctx);
    uv_stream_t *s;
    SSL *ssl;
    char *p, buf[1 << 16];
    int fds[2];
    long n, left = 0, sent = 0;

    SSL_CTX_set_psk_use_session_callback(cctx, offer_key);
    ssl = shake(cctx, ours);
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fds),
                     0);
    s = conn_stream_new(&e.loop, true);
    ck_assert_int_eq(uv_pipe_open((uv_pipe_t *)s, fds[0]), 0);
    e.fd = fds[1];
    e.conn = conn_new(s, ours, updating[_i].session, "test", &handler, NULL);
    if (updating[_i].session != MSG_AT_COORD_NEW)
        conn_live(e.conn, false);
    for (int still = 0; still < 20 && sent < 3 << 20; run()) {
        for (int i = 0; left == 0 && i < 200; i++) {
            SSL_key_update(ssl, SSL_KEY_UPDATE_REQUESTED);
            ck_assert_int_eq(SSL_do_handshake(ssl), 1);
        }
        left = BIO_get_mem_data(SSL_get_wbio(ssl), &p);
        n = send(e.fd, p, (size_t)left, MSG_NOSIGNAL);
        if (n > 0) {
            BIO_read(SSL_get_wbio(ssl), buf, (int)n);
            left -= n;
            sent += n;
        }
        still = n > 0 ? 0 : still + 1;
    }
    ck_assert_int_lt(sent, 3 << 20);
    /* on a slow machine the others end when their time for HELLO or PING does
     */
    ck_assert_int_eq(!e.conn && strcmp(e.why, CONN_BROKE_PROTOCOL) == 0,
                     updating[_i].ends);
    SSL_free(ssl);
    SSL_CTX_free(cctx);
    tls_ctx_free(sctx);
}

TEST(ping_is_answered_however_it_is_cut)
{
    struct wire_out w;
    uint8_t back[64];

    open_ends(MSG_AT_PEER);
    pack_ping(&w, 12345);
    for (size_t i = 0; i < w.len; i++) {
        ck_assert_int_eq(e.nmessages, 0);
        ck_assert_int_eq(write(e.fd, w.buf + i, 1), 1);
        run();
    }
    ck_assert_int_eq(e.nmessages, 1);
    ck_assert_uint_eq(e.last_progress, 12345);
    ck_assert_int_eq(read(e.fd, back, sizeof back),
                     MSG_HEADER + PING_BYTES);
    ck_assert_uint_eq(back[5], MSG_PONG);
    ck_assert_uint_eq(back[11], 7);
    ck_assert_uint_eq(e.written, MSG_HEADER + PING_BYTES);
    wire_out_release(&w);
}

/* An old peer is not told what it has no message for; it stays. */
TEST(what_an_old_peer_cannot_hear_is_not_said)
{
    struct msg key = { .type = MSG_KEY, .key = { MSG_KEY_LIST, "", 0 } };
    struct wire_out w;

    open_ends(MSG_AT_CLIENT);

    conn_set_version(e.conn, msg_since(MSG_KEY) - 1);
    wire_out_init(&w, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&w, &key), 0);
    ck_assert(!conn_send(e.conn, &key));
    ck_assert(!conn_send_frame(e.conn, w.buf, w.len));
    run();
    ck_assert_int_eq(e.nclosed, 0);
    ck_assert_uint_eq(conn_queued(e.conn), 0);
    ck_assert_uint_eq(e.written, 0);
    wire_out_release(&w);
}

TEST(messages_in_one_piece_all_arrive)
{
    struct wire_out w;

    open_ends(MSG_AT_PEER);
    pack_ping(&w, 1);
    for (int i = 0; i < 100; i++)
        ck_assert_int_eq(write(e.fd, w.buf, w.len), (ssize_t)w.len);
    run();
    ck_assert_int_eq(e.nmessages, 100);
    wire_out_release(&w);
}

#ifdef WITH_MALLOC
/* Let the other end ping, and answer while memory is out. */
static void
ping_without_memory(enum msg_session session, bool *out)
{
    struct wire_out frame;

    open_ends(session);
    conn_live(e.conn, false);
    pack_ping(&frame, 1);
    ck_assert_int_eq(write(e.fd, frame.buf, frame.len), (ssize_t)frame.len);
    *out = true;
    run();
    *out = false;
    ck_assert_int_eq(e.nclosed, 1);
    ck_assert_int_eq(e.nmessages, 0);
    wire_out_release(&frame);
}

/* Else the other side would wait for ever for what is not sent. */
LOOP_TEST(a_message_that_has_no_memory_ends_it, 3)
{
    struct msg m = { .type = MSG_PONG };
    struct wire_out frame;
    bool sent;

    open_ends(MSG_AT_PARENT);
    conn_live(e.conn, false);
    pack_ping(&frame, 1);
    no_malloc = _i != 1;
    no_realloc = _i == 1;
    sent = _i == 2 ? conn_send_frame(e.conn, frame.buf, frame.len)
                   : conn_send(e.conn, &m);
    no_malloc = no_realloc = false;
    ck_assert(!sent);
    ck_assert_int_eq(e.nclosed, 1);
    ck_assert_ptr_nonnull(strstr(e.why, "memory"));
    wire_out_release(&frame);
}

/* Its owner hears of the end, and nothing after that. */
TEST(a_ping_that_has_no_memory_for_its_answer_is_not_told)
{
    ping_without_memory(MSG_AT_PEER, &no_malloc);
}

/* Which is no fault of the other side's. */
TEST(a_message_that_there_is_no_memory_to_read_ends_it)
{
    ping_without_memory(MSG_AT_PARENT, &no_realloc);
    ck_assert_ptr_nonnull(strstr(e.why, "memory"));
}
#endif

TEST(owner_may_close_while_it_is_called)
{
    struct wire_out w;

    open_ends(MSG_AT_PEER);
    e.close_in_message = true;
    pack_ping(&w, 1);
    for (int i = 0; i < 3; i++)
        ck_assert_int_eq(write(e.fd, w.buf, w.len), (ssize_t)w.len);
    run();
    ck_assert_int_eq(e.nmessages, 1);
    ck_assert_int_eq(e.nclosed, 0);
    wire_out_release(&w);
}

TEST(end_of_stream_is_told_once)
{
    open_ends(MSG_AT_PEER);
    shutdown(e.fd, SHUT_WR);
    run();
    ck_assert_int_eq(e.nclosed, 1);
    ck_assert_str_eq(e.why, "closed by peer");
}

enum { SHORT_MS = 40 };

static const struct conn_handler hasty = { .message = on_message,
                                           .closed = on_closed,
                                           .written = on_written,
                                           .limit_ms = SHORT_MS };

/* Who does not say who it is in time is gone, not sooner; bytes of a message
 * that does not end are no sign of life. */
LOOP_TEST(who_is_slow_to_introduce_itself_is_let_go, 2)
{
    uint64_t start = uv_hrtime();
    ssize_t n = 0;

    open_ends_of(MSG_AT_COORD_NEW, &hasty);
    for (int i = 0; e.nclosed == 0 && i < 20000; i++) {
        if (_i && n < 10)
            n += write(e.fd, &"RADD\0\1\0\0\0\0"[n], 1);
        run();
        usleep(500);
    }
    ck_assert_int_eq(e.nclosed, 1);
    ck_assert_str_eq(e.why, "took too long");
    ck_assert_uint_ge(uv_hrtime() - start, (SHORT_MS - 2) * 1000000u);
}

/* Once it has, it may be silent for longer than that. */
TEST(who_has_introduced_itself_stays)
{
    uint64_t until = uv_hrtime() + 3 * SHORT_MS * 1000000u;

    open_ends_of(MSG_AT_COORD_USER, &hasty);
    conn_live(e.conn, true);
    while (uv_hrtime() < until) {
        run();
        usleep(500);
    }
    ck_assert_int_eq(e.nclosed, 0);
}

/* Let the time between two PINGs pass, n times. */
static void
pass_pings(int n)
{
    for (int i = 0; i < n && e.conn; i++) {
        e.conn->timer.timer_cb(&e.conn->timer);
        run();
    }
}

/* Any byte is a sign of life. */
TEST(who_answers_no_ping_is_let_go)
{
    enum { PINGS = CONN_DEAD_MS / CONN_PING_MS };
    static uint8_t pings[2 * PINGS * (MSG_HEADER + PING_BYTES) + 1];

    open_ends(MSG_AT_PEER);
    conn_live(e.conn, true);
    pass_pings(PINGS);
    ck_assert_int_eq(write(e.fd, "R", 1), 1);
    run();
    pass_pings(PINGS);
    ck_assert_int_eq(e.nclosed, 0);
    ck_assert_int_eq(read(e.fd, pings, sizeof pings), sizeof pings - 1);
    pass_pings(1);
    ck_assert_int_eq(e.nclosed, 1);
    ck_assert_str_eq(e.why, "silent for 15 s");
}

TEST(who_gets_no_ping_may_be_silent)
{
    uint8_t byte;

    open_ends(MSG_AT_PEER);
    conn_live(e.conn, false);
    pass_pings(100);
    ck_assert_int_eq(e.nclosed, 0);
    ck_assert_int_eq(read(e.fd, &byte, 1), -1);
}

TEST(message_that_may_not_come_here_ends_it)
{
    struct wire_out w;

    open_ends(MSG_AT_COORD_NEW);
    pack_ping(&w, 1);
    ck_assert_int_eq(write(e.fd, w.buf, w.len), (ssize_t)w.len);
    run();
    ck_assert_int_eq(e.nmessages, 0);
    ck_assert_int_eq(e.nclosed, 1);
    ck_assert_str_eq(e.why, "protocol error");
    wire_out_release(&w);
}

/* A simple generator: what matters is that it is the same each time. */
static uint32_t
next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 16;
}

LOOP_TEST(random_bytes_only_end_it, 256)
{
    uint8_t bytes[4096];
    uint32_t state = (uint32_t)_i;

    open_ends((enum msg_session)(_i % MSG_NSESSION));
    for (size_t i = 0; i < sizeof bytes; i++)
        bytes[i] = (uint8_t)next_random(&state);
    if (_i & 64) /* the right magic, random behind it */
        memcpy(bytes, "RADD", 4);
    if (_i & 128)
        bytes[4] = bytes[6] = bytes[7] = bytes[12] = bytes[13] = 0;
    ck_assert_int_gt(write(e.fd, bytes, sizeof bytes), 0);
    run();
    if (e.nclosed == 0) { /* a header by chance: the rest never comes */
        shutdown(e.fd, SHUT_WR);
        run();
    }
    ck_assert_int_eq(e.nclosed, 1);
}

TEST(what_waits_is_counted_and_goes_out)
{
    static uint8_t payload[100000];
    struct msg m = { .type = MSG_AMBIENT };
    struct wire_out w;
    uint8_t sink[65536];
    size_t got = 0, sent;

    open_ends(MSG_AT_PEER);
    m.ambient.count = 1;
    m.ambient.data = payload;
    m.ambient.len = sizeof payload;
    wire_out_init(&w, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&w, &m), 0);
    sent = 50 * w.len;
    wire_out_release(&w);
    for (int i = 0; i < 50; i++)
        ck_assert(conn_send(e.conn, &m));
    ck_assert_uint_gt(conn_queued(e.conn), 0); /* the socket's room is less */
    while (got < sent) {
        ssize_t n = read(e.fd, sink, sizeof sink);

        if (n > 0)
            got += (size_t)n;
        else
            ck_assert(n < 0 && errno == EAGAIN);
        run();
    }
    ck_assert_uint_eq(conn_queued(e.conn), 0);
    ck_assert_uint_eq(e.written, sent);
}

/* So many as the socket takes are written at once, the others when it has room,
 * and all in their order. */
TEST(short_messages_go_out_in_order_and_are_counted)
{
    enum { MANY = 40000, SIZE = MSG_HEADER + PING_BYTES };
    static uint8_t got[MANY * SIZE];
    struct msg m = { .type = MSG_PING };
    size_t n = 0;

    open_ends(MSG_AT_PEER);
    for (uint32_t i = 0; i < MANY; i++) {
        m.request = i;
        ck_assert(conn_send(e.conn, &m));
        if (i % 97 == 0)
            run();
    }
    ck_assert_uint_gt(conn_queued(e.conn), 0);
    ck_assert_uint_lt(e.written, sizeof got);
    while (n < sizeof got) {
        ssize_t more = read(e.fd, got + n, sizeof got - n);

        n += more > 0 ? (size_t)more : 0;
        run();
    }
    for (uint32_t i = 0; i < MANY; i++) {
        const uint8_t *r = got + i * SIZE + 8;

        ck_assert_uint_eq(r[1] << 16 | r[2] << 8 | r[3], i);
    }
    ck_assert_uint_eq(conn_queued(e.conn), 0);
    ck_assert_uint_eq(e.written, sizeof got);
}

/* Though nothing else happens that could wake the loop. */
TEST(what_is_left_at_the_end_goes_out_at_once)
{
    struct msg m = { .type = MSG_PING };
    uint8_t got[64];

    open_ends(MSG_AT_PEER);
    ck_assert(conn_send(e.conn, &m));
    conn_finish(e.conn);
    e.conn = NULL;
    uv_run(&e.loop, UV_RUN_NOWAIT);
    ck_assert_int_eq(read(e.fd, got, sizeof got), MSG_HEADER + PING_BYTES);
    ck_assert_int_eq(read(e.fd, got, sizeof got), 0);
    ck_assert_int_eq(uv_loop_alive(&e.loop), 0);
}

/* Read what waits. */
static void
drain(void)
{
    static uint8_t sink[1 << 18];

    while (conn_queued(e.conn) > 0) {
        if (read(e.fd, sink, sizeof sink) < 0)
            ck_assert_int_eq(errno, EAGAIN);
        run();
    }
}

static const enum msg_session users[] = { MSG_AT_COORD_USER,
                                          MSG_AT_COORD_ADMIN };

LOOP_TEST(a_user_that_does_not_read_gets_no_more_records, N_ELEM(users))
{
    static uint8_t job[MSG_JOB], data[50000];
    struct msg records = { .type = MSG_RECORDS,
                           .records = { job, 1, data, sizeof data } };
    struct msg ping = { .type = MSG_PING };
    struct wire_out w;
    int sent = 0;

    open_ends(users[_i]);
    wire_out_init(&w, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&w, &records), 0);
    while (sent < 1000 && conn_send_frame(e.conn, w.buf, w.len))
        sent++;
    ck_assert_uint_gt(conn_queued(e.conn), 8u << 20);
    ck_assert_uint_le(conn_queued(e.conn), (8u << 20) + w.len);
    ck_assert(!conn_send_frame(e.conn, w.buf, w.len));
    ck_assert(conn_send(e.conn, &ping)); /* all else it gets */
    drain();
    ck_assert(conn_send_frame(e.conn, w.buf, w.len));
    ck_assert_int_eq(e.nclosed, 0);
    wire_out_release(&w);
}

TEST(finish_sends_what_waits_and_says_nothing)
{
    struct msg m = { .type = MSG_REFUSE };
    uint8_t back[200];
    ssize_t n;

    open_ends(MSG_AT_COORD_NEW);
    m.refuse.status = 76;
    m.refuse.text = "no";
    ck_assert(conn_send(e.conn, &m));
    conn_finish(e.conn);
    e.conn = NULL;
    run();
    n = read(e.fd, back, sizeof back);
    ck_assert_int_gt(n, MSG_HEADER);
    ck_assert_int_eq(read(e.fd, back, sizeof back), 0);
    ck_assert_int_eq(e.nclosed, 0);
}

/* Its owner may be gone: nothing is said of one that does not read the rest. */
TEST(finish_ends_in_silence_though_nobody_reads)
{
    static uint8_t payload[100000];
    struct msg m = { .type = MSG_AMBIENT };
    struct conn *c;

    open_ends(MSG_AT_PEER);
    m.ambient.count = 1;
    m.ambient.data = payload;
    m.ambient.len = sizeof payload;
    for (int i = 0; i < 50; i++)
        ck_assert(conn_send(e.conn, &m));
    c = e.conn;
    e.conn = NULL;
    conn_finish(c);
    run();
    ck_assert_int_eq(c->state, CONN_FINISHING);
    c->timer.timer_cb(&c->timer);
    ck_assert_int_eq(c->state, CONN_CLOSED);
    ck_assert_int_eq(e.nclosed, 0);
}

TEST(peer_that_goes_while_we_send_is_no_crash)
{
    static uint8_t payload[100000];
    struct msg m = { .type = MSG_AMBIENT };

    signal(SIGPIPE, SIG_IGN);
    open_ends(MSG_AT_PEER);
    m.ambient.count = 1;
    m.ambient.data = payload;
    m.ambient.len = sizeof payload;
    for (int i = 0; i < 20; i++)
        conn_send(e.conn, &m);
    close(e.fd);
    run();
    ck_assert_int_eq(e.nclosed, 1);
    e.fd = dup(0);
}

/* A refusal that was said before the connection was closed is heard, although
 * that it is closed is found out by writing; a message that is kept outlives
 * the connection. */
static struct msg kept;
static uint8_t *kept_bytes;
static int kept_code;

static void
keep_message(void *arg, struct conn *c, const struct msg *m)
{
    size_t n;

    on_message(arg, c, m);
    kept_bytes = conn_keep(c, &kept, &n);
    ck_assert_uint_gt(n, 0);
}

static void
keep_code(void *arg, struct conn *c, const char *why)
{
    kept_code = conn_error(c)->code;
    on_closed(arg, c, why);
}

static const struct conn_handler keeper = { .message = keep_message,
                                            .closed = keep_code,
                                            .quiet = true };

LOOP_TEST(what_was_said_before_the_end_is_heard_by_who_writes, 2)
{
    static uint8_t payload[100000];
    struct msg m = { .type = MSG_AMBIENT };
    struct msg refuse = { .type = MSG_REFUSE };
    struct wire_out w;

    signal(SIGPIPE, SIG_IGN);
    open_ends_of(MSG_AT_DIALLER, &keeper);
    m.ambient.count = 1;
    m.ambient.data = payload;
    m.ambient.len = sizeof payload;
    refuse.refuse.status = 69;
    refuse.refuse.text = "enough";
    wire_out_init(&w, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&w, &refuse), 0);
    ck_assert_int_eq(write(e.fd, w.buf, w.len), (ssize_t)w.len);
    wire_out_release(&w);
    conn_pause(e.conn, _i == 1); /* whoever reads nothing hears nothing */
    close(e.fd);
    ck_assert(conn_send(e.conn, &m));
    run();
    ck_assert_int_eq(e.nclosed, 1);
    ck_assert_int_eq(kept_code, UV_EPIPE);
    ck_assert_int_eq(e.nmessages, _i == 0 ? 1 : 0);
    if (_i == 0) {
        ck_assert_int_eq(kept.type, MSG_REFUSE);
        ck_assert_str_eq(kept.refuse.text, "enough");
    }
    msg_release(&kept);
    free(kept_bytes);
    kept_bytes = NULL;
    e.fd = dup(0);
}

/* Why it ended is told by code, and for a message that is malformed with the
 * peer's name. */
LOOP_TEST(why_it_ended_has_a_code, 2)
{
    open_ends_of(MSG_AT_PEER, &keeper);
    if (_i == 0)
        ck_assert_int_eq(write(e.fd, "this is not the protocol", 24), 24);
    else
        shutdown(e.fd, SHUT_WR);
    run();
    ck_assert_int_eq(e.nclosed, 1);
    ck_assert_int_eq(kept_code, _i == 0 ? RAD_EPROTO : UV_EOF);
}
