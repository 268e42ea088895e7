/* check_credentials.c - every message of every credential to a real coordinator
 *
 * Whoever has no good key is refused before a byte of a message is looked at,
 * whatever it brings along; whoever asks for a role that is not its own, too;
 * and of who has the right key in its own role each message is taken that the
 * role has, and no other.  Each time the log says so once, with the address.
 *
 * A message has a coordinator of its own: the log has a limit on such lines. */
#include "config.h"

#include "proto/frame.h"
#include "net/key/keyfile.h"
#include "net/tls.h"

#include "tests/scratch.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <openssl/bio.h>
#include <openssl/ssl.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#define PATIENCE_MS 60000 /* of a machine that is busy with other things */

static struct keyfile keys;
static struct key eve; /* as she was before she was retired */
static uint16_t port;
static pid_t server;

/* --- the coordinator --- */

static void
make_keys(void)
{
    static const char *const names[] = { "worker:w1", "user:ana", "admin:root",
                                         "observer:page", "user:eve" };
    char path[100];
    int fd;

    keyfile_init(&keys);
    for (int i = 0; i < N_ELEM(names); i++)
        ck_assert_int_eq(keyfile_add(&keys, names[i], 0, NULL), 0);
    ck_assert_int_eq(keyfile_add(&keys, "user:old", 1704067200, NULL), 0);
    eve = *keyfile_find(&keys, "user:eve:k1");
    ck_assert_int_eq(keyfile_retire(&keys, "user:eve", NULL), 1);
    snprintf(path, sizeof path, "%s/keys", dir);
    fd = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ck_assert_int_ge(fd, 0);
    ck_assert_int_eq(write(fd, keys.text, keys.len), (ssize_t)keys.len);
    close(fd);
}

static void
be_radcoord(void)
{
    const char *top = getenv("top_builddir");
    char path[300], key[120], sock[120], state[120], ports[120], log[120];
    int fd;

    snprintf(path, sizeof path, "%s/radcoord", top ? top : ".");
    snprintf(key, sizeof key, "--keys=%s/keys", dir);
    snprintf(sock, sizeof sock, "--socket=%s/sock", dir);
    snprintf(state, sizeof state, "--state=%s/state", dir);
    snprintf(ports, sizeof ports, "--ports-file=%s/ports", dir);
    snprintf(log, sizeof log, "%s/log", dir);
    fd = open(log, O_WRONLY | O_CREAT | O_TRUNC | O_APPEND, 0600);
    dup2(fd, STDERR_FILENO);
    execl(path, "radcoord", "--listen=127.0.0.1:0", key, sock, state, ports,
          "--log-level=warn", (char *)NULL);
    _exit(127);
}

/* A whole file as text; "" while there is none. */
static void
slurp(const char *name, char *text, size_t size)
{
    char path[120];
    FILE *f;

    snprintf(path, sizeof path, "%s/%s", dir, name);
    f = fopen(path, "r");
    text[f ? fread(text, 1, size - 1, f) : 0] = '\0';
    if (f)
        fclose(f);
}

static void
start(void)
{
    char text[400];
    const char *colon = NULL;

    signal(SIGPIPE, SIG_IGN);
    scratch_make();
    make_keys();
    server = fork();
    ck_assert_int_ge(server, 0);
    if (server == 0)
        be_radcoord();
    for (int i = 0; i < PATIENCE_MS / 5 && !colon; i++) {
        usleep(5000);
        slurp("ports", text, sizeof text);
        colon = strstr(text, "tcp 127.0.0.1:");
        ck_assert_msg(waitpid(server, NULL, WNOHANG) == 0, "no radcoord");
    }
    ck_assert_ptr_nonnull(colon);
    port = (uint16_t)atoi(strrchr(colon, ':') + 1);
}

static void
stop(void)
{
    kill(server, SIGKILL);
    waitpid(server, NULL, 0);
    keyfile_release(&keys);
    scratch_remove();
}

FIXTURE(start, stop)

/* --- what its log says --- */

static size_t log_before; /* bytes that were there when the visitor came */

/* Lines of that peer that have that in them, since it came: one before it may
 * have had the same port, for the kernel begins elsewhere every 10 s. */
static int
lines(const char *peer, const char *what)
{
    static char text[1 << 16];
    int n = 0;

    slurp("log", text, sizeof text);
    for (char *line = strtok(text + log_before, "\n"); line;
         line = strtok(NULL, "\n"))
        n += strstr(line, peer) && strstr(line, what);
    return n;
}

/* It said why, and that alone, once. */
static void
refused_once(const char *peer, const char *why)
{
    int n = 0;

    for (int i = 0; i < PATIENCE_MS / 2 && lines(peer, why) == 0; i++)
        usleep(2000);
    ck_assert_msg(lines(peer, why) == 1, "%s: '%s' %d times", peer, why,
                  lines(peer, why));
    n = lines(peer, "connection refused ") + lines(peer, "protocol error ") +
        lines(peer, "connection closed ");
    ck_assert_msg(n == 1, "%s: %d lines beside '%s'", peer, n, why);
}

/* --- somebody who comes --- */

struct visitor {
    int fd;
    char peer[40]; /* as the log names it */
    struct tls_ctx *ctx;
    struct tls *tls;
    uint8_t heard[400]; /* of messages */
    size_t nheard;
};

static void
come(struct visitor *v)
{
    struct sockaddr_in to = { .sin_family = AF_INET,
                              .sin_port = htons(port),
                              .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    struct sockaddr_in own;
    socklen_t n = sizeof own;
    char text[1 << 16];
    int on = 1;

    slurp("log", text, sizeof text);
    log_before = strlen(text);
    memset(v, 0, sizeof *v);
    v->fd = socket(AF_INET, SOCK_STREAM, 0);
    ck_assert_int_eq(
        setsockopt(v->fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on), 0);
    ck_assert_int_eq(connect(v->fd, (struct sockaddr *)&to, sizeof to), 0);
    ck_assert_int_eq(getsockname(v->fd, (struct sockaddr *)&own, &n), 0);
    snprintf(v->peer, sizeof v->peer, "peer=127.0.0.1:%u", ntohs(own.sin_port));
}

static void
leave(struct visitor *v)
{
    tls_free(v->tls);
    tls_ctx_free(v->ctx);
    close(v->fd);
}

/* It may have been hung up on already. */
static void
put(struct visitor *v, const void *bytes, size_t n)
{
    ssize_t ignored = send(v->fd, bytes, n, MSG_NOSIGNAL);

    (void)ignored;
}

static void
flush(struct visitor *v)
{
    const uint8_t *p;
    size_t n = tls_out(v->tls, &p);

    if (n > 0)
        put(v, p, n);
    tls_sent(v->tls);
}

/* Some bytes more, and what they are; false: it is over. */
static bool
hear(struct visitor *v)
{
    struct pollfd p = { .fd = v->fd, .events = POLLIN };
    uint8_t buf[4096];
    ssize_t n;
    int rc;

    ck_assert_msg(poll(&p, 1, PATIENCE_MS) == 1, "%s: no answer", v->peer);
    n = recv(v->fd, buf, sizeof buf, 0);
    if (n <= 0)
        return false;
    if (!v->tls)
        return true;
    if (tls_put(v->tls, buf, (size_t)n, NULL) < 0)
        return false;
    while ((rc = tls_read(v->tls, v->heard + v->nheard,
                          sizeof v->heard - v->nheard, NULL)) > 0)
        v->nheard += (size_t)rc;
    return rc == 0;
}

static void
hear_to_the_end(struct visitor *v)
{
    while (hear(v))
        ;
}

/* Begin with a key; more, if any, goes right behind the first flight. */
static bool
show(struct visitor *v, const char *id, const uint8_t *secret,
     const uint8_t *more, size_t n)
{
    int rc;

    v->ctx = tls_client();
    v->tls = tls_dial(v->ctx, id, secret);
    ck_assert_ptr_nonnull(v->tls);
    rc = tls_handshake(v->tls, NULL);
    flush(v);
    put(v, more, n);
    while (rc == 0 && hear(v)) {
        rc = tls_handshake(v->tls, NULL);
        flush(v);
    }
    return rc == 1;
}

/* --- messages --- */

/* The header of a message, without its body. */
static void
head_of(uint16_t type, uint8_t head[MSG_HEADER])
{
    const uint8_t bytes[MSG_HEADER] = {
        'R', 'A', 'D', 'D', (uint8_t)(type >> 8), (uint8_t)type
    };

    memcpy(head, bytes, MSG_HEADER);
}

static void
say_hello(struct visitor *v, enum msg_role role, const char *name,
          const uint8_t *more, size_t n)
{
    struct msg m = { .type = MSG_HELLO,
                     .hello = { MSG_VERSION_MIN, MSG_VERSION, (uint8_t)role,
                                name, "test", "", 1, 0 } };
    struct wire_out out;

    wire_out_init(&out, MSG_FRAME_MAX);
    ck_assert_int_eq(msg_pack(&out, &m), 0);
    wire_put_bytes(&out, more, n);
    ck_assert_int_eq(tls_write(v->tls, out.buf, out.len, NULL), 0);
    wire_out_release(&out);
    flush(v);
}

/* --- who has no good key --- */

static const struct {
    const char *id;
    bool wrong; /* its secret */
    const char *why;
} strangers[] = {
    { "user:ana:k1", true, "wrong secret of key 'user:ana:k1'" },
    { "user:bob:k1", false, "unknown key 'user:bob:k1'" },
    { "user:eve:k1", false, "retired key 'user:eve:k1'" },
    { "user:old:k1", false, "expired key 'user:old:k1'" },
};

static void
come_with_a_bad_key(int i, const uint8_t head[MSG_HEADER])
{
    const struct key *k = keyfile_find(&keys, strangers[i].id);
    uint8_t secret[TLS_SECRET] = { 7 };
    struct visitor v;

    if (k)
        memcpy(secret, k->retired ? eve.secret : k->secret, sizeof secret);
    if (strangers[i].wrong)
        secret[TLS_SECRET - 1] ^= 1;
    come(&v);
    ck_assert(!show(&v, strangers[i].id, secret, head, MSG_HEADER));
    ck_assert_uint_eq(v.nheard, 0);
    refused_once(v.peer, strangers[i].why);
    leave(&v);
}

static void
come_without_a_key(const uint8_t head[MSG_HEADER])
{
    struct visitor v;

    come(&v);
    put(&v, head, MSG_HEADER);
    hear_to_the_end(&v);
    refused_once(v.peer, "connection refused ");
    leave(&v);
}

static void
come_by_tls_12(const uint8_t head[MSG_HEADER])
{
    SSL_CTX *ctx = SSL_CTX_new(TLS_client_method());
    BIO *in = BIO_new(BIO_s_mem()), *out = BIO_new(BIO_s_mem());
    uint8_t bytes[2000];
    struct visitor v;
    SSL *ssl;
    int n;

    SSL_CTX_set_max_proto_version(ctx, TLS1_2_VERSION);
    ssl = SSL_new(ctx);
    SSL_set_bio(ssl, in, out);
    SSL_set_connect_state(ssl);
    SSL_do_handshake(ssl);
    n = BIO_read(out, bytes, (int)sizeof bytes - MSG_HEADER);
    ck_assert_int_gt(n, 0);
    memcpy(bytes + n, head, MSG_HEADER);
    come(&v);
    put(&v, bytes, (size_t)n + MSG_HEADER);
    hear_to_the_end(&v);
    refused_once(v.peer, "an older version of TLS");
    leave(&v);
    SSL_free(ssl);
    SSL_CTX_free(ctx);
}

static void
without_a_good_key_nothing_is_heard(uint16_t type)
{
    uint8_t head[MSG_HEADER];

    head_of(type, head);
    for (int i = 0; i < N_ELEM(strangers); i++)
        come_with_a_bad_key(i, head);
    come_without_a_key(head);
    come_by_tls_12(head);
}

/* --- who has one --- */

static void
come_in(struct visitor *v, const char *id)
{
    const struct key *k = keyfile_find(&keys, id);

    ck_assert_ptr_nonnull(k);
    come(v);
    ck_assert(show(v, id, k->secret, NULL, 0));
}

static const struct {
    const char *id, *name;
    enum msg_role role;
} impostors[] = {
    { "user:ana:k1", "w1", MSG_ROLE_WORKER },
    { "user:ana:k1", "", MSG_ROLE_ADMIN },
    { "user:ana:k1", "", MSG_ROLE_OBSERVER },
    { "observer:page:k1", "w1", MSG_ROLE_WORKER },
    { "observer:page:k1", "", MSG_ROLE_USER },
    { "observer:page:k1", "", MSG_ROLE_ADMIN },
    { "worker:w1:k1", "", MSG_ROLE_USER },
    { "worker:w1:k1", "", MSG_ROLE_ADMIN },
    { "admin:root:k1", "w1", MSG_ROLE_WORKER },
};

/* Its message comes with its HELLO, and is not looked at. */
static void
in_a_role_of_others_nothing_is_heard(uint16_t type)
{
    uint8_t head[MSG_HEADER];

    head_of(type, head);
    for (int i = 0; i < N_ELEM(impostors); i++) {
        struct visitor v;

        come_in(&v, impostors[i].id);
        say_hello(&v, impostors[i].role, impostors[i].name, head, MSG_HEADER);
        hear_to_the_end(&v);
        ck_assert_uint_gt(v.nheard, MSG_HEADER);
        ck_assert_uint_eq(msg_frame_type(v.heard, v.nheard), MSG_REFUSE);
        refused_once(v.peer, "this role is not allowed from there");
        leave(&v);
    }
}

static const struct {
    const char *id, *name;
    enum msg_role role; /* 0: no HELLO yet */
    enum msg_session session;
} guests[] = {
    { "user:ana:k1", "", 0, MSG_AT_COORD_NEW },
    { "worker:w1:k1", "w1", MSG_ROLE_WORKER, MSG_AT_COORD_WORKER },
    { "user:ana:k1", "", MSG_ROLE_USER, MSG_AT_COORD_USER },
    { "admin:root:k1", "", MSG_ROLE_ADMIN, MSG_AT_COORD_ADMIN },
    { "observer:page:k1", "", MSG_ROLE_OBSERVER, MSG_AT_COORD_OBSERVER },
};

/* One that it may say is read, and lacks its body; another is not. */
static void
in_its_own_role_each_says_what_it_may(uint16_t type)
{
    uint8_t head[MSG_HEADER];
    char why[80];

    head_of(type, head);
    for (int i = 0; i < N_ELEM(guests); i++) {
        bool may = msg_allowed(guests[i].session, type);
        struct visitor v;

        come_in(&v, guests[i].id);
        if (guests[i].role) {
            say_hello(&v, guests[i].role, guests[i].name, NULL, 0);
            while (v.nheard == 0)
                ck_assert(hear(&v));
            ck_assert_uint_eq(msg_frame_type(v.heard, v.nheard), MSG_WELCOME);
        }
        ck_assert_int_eq(tls_write(v.tls, head, sizeof head, NULL), 0);
        flush(&v);
        hear_to_the_end(&v);
        snprintf(why, sizeof why, may ? "malformed %s of 0" : "unexpected %s",
                 msg_name(type));
        refused_once(v.peer, why);
        leave(&v);
    }
}

static int
count_messages(void)
{
    int n = 0;

    while (msg_nth((size_t)n) != 0)
        n++;
    return n;
}

LOOP_TEST(each_message_of_every_credential, count_messages())
{
    uint16_t type = msg_nth((size_t)_i);

    without_a_good_key_nothing_is_heard(type);
    in_a_role_of_others_nothing_is_heard(type);
    in_its_own_role_each_says_what_it_may(type);
}
