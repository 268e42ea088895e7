/* check_gate.c - strangers at a listener, over loopback, and a connection whose
 * messages go by TLS */
#include "config.h"

#include "net/conn.h"
#include "net/dial.h"
#include "net/gate.h"
#include "net/listen.h"
#include "net/log.h"

#include "tests/unit.h"

#include <arpa/inet.h>
#include <errno.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <netdb.h>
#include <semaphore.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const uint8_t secret[TLS_SECRET] = { 5 };
static const char *comes = "worker:w:k1";
static int looks;   /* for the key of peer:late */
static int told_at; /* the look that finds it; 0: none does */

static const char *
find(void *arg, const char *id, uint8_t *out)
{
    (void)arg;
    looks += strcmp(id, "peer:late") == 0;
    if (strcmp(id, "peer:late") == 0 && (told_at == 0 || looks < told_at))
        return TLS_LATER;
    if (strcmp(id, "worker:w:k1") != 0 && strcmp(id, "peer:late") != 0)
        return "unknown key";
    memcpy(out, secret, TLS_SECRET);
    return NULL;
}

/* The resolver, which for one name begins, and does not end before the test
 * does; another name has two addresses. */
#define HANGING "hangs.invalid"
#define TWO     "two.invalid"
static sem_t begun, ends;
static const char *first_port, *second_port; /* of TWO, at 127.0.0.1 */

static int
two_addresses(int (*call)(const char *, const char *, const struct addrinfo *,
                          struct addrinfo **),
              const struct addrinfo *hints, struct addrinfo **found)
{
    int rc = call("127.0.0.1", first_port, hints, found);

    return rc ? rc : call("127.0.0.1", second_port, hints, &(*found)->ai_next);
}

int
getaddrinfo(const char *host, const char *port, const struct addrinfo *hints,
            struct addrinfo **found)
{
    void *real = dlsym(RTLD_NEXT, "getaddrinfo");
    int (*call)(const char *, const char *, const struct addrinfo *,
                struct addrinfo **);

    memcpy(&call, &real, sizeof call);
    if (host && strcmp(host, TWO) == 0)
        return two_addresses(call, hints, found);
    if (host && strcmp(host, HANGING) == 0) {
        sem_post(&begun);
        while (sem_wait(&ends) < 0)
            ;
    }
    return call(host, port, hints, found);
}

/* A listener, what came in and what was dialled. */
struct scene {
    uv_loop_t loop;
    struct listener *listener;
    struct dialler *dialler;
    struct conn *in, *out;
    int nin, nrefused;
    int messages_in, messages_out, ended;
    size_t bytes_in;
};
static struct scene s;

static void
on_message(void *arg, struct conn *c, const struct msg *m)
{
    (void)arg;
    if (c == s.in) {
        s.messages_in++;
        if (m->type == MSG_AMBIENT)
            s.bytes_in += m->ambient.len;
    } else {
        s.messages_out++;
    }
}

static void
on_closed(void *arg, struct conn *c, const char *why)
{
    (void)arg;
    (void)why;
    s.ended++;
    if (c == s.in)
        s.in = NULL;
    else
        s.out = NULL;
}

static const struct conn_handler handler = { .message = on_message,
                                             .closed = on_closed };

static void
on_visitor(void *arg, uv_stream_t *stream, struct tls *tls, const char *peer)
{
    (void)arg;
    s.nin++;
    ck_assert_ptr_nonnull(tls);
    ck_assert_str_eq(tls_id(tls), comes);
    conn_close(s.in);
    s.in = conn_new(stream, tls, MSG_AT_PEER, peer, &handler, NULL);
    ck_assert_ptr_nonnull(s.in);
    ck_assert_str_eq(conn_key(s.in), comes);
}

static void
on_dialled(void *arg, uint64_t id, uv_stream_t *stream, struct tls *tls,
           const char *peer, const struct rad_error *why)
{
    (void)arg;
    (void)id;
    if (!stream) {
        ck_assert_ptr_nonnull(why);
        s.nrefused++;
        return;
    }
    ck_assert_ptr_nonnull(tls);
    s.out = conn_new(stream, tls, MSG_AT_PEER, peer, &handler, NULL);
}

static void
open_scene_with(unsigned limit_ms)
{
    struct listener_conf conf = { .fn = on_visitor,
                                  .find = find,
                                  .limit_ms = limit_ms };

    memset(&s, 0, sizeof s);
    comes = "worker:w:k1";
    looks = told_at = 0;
    signal(SIGPIPE, SIG_IGN);
    log_set_level(LOG_LEVEL_ERR);
    ck_assert_int_eq(uv_loop_init(&s.loop), 0);
    s.listener = listener_open(&s.loop, "127.0.0.1:0", &conf, NULL);
    s.dialler = dialler_new(&s.loop, on_dialled, NULL);
    ck_assert(s.listener && s.dialler);
}

static void
open_scene(void)
{
    open_scene_with(0);
}

/* All handles go, whatever is under way. */
static void
close_scene(void)
{
    listener_close(s.listener);
    dialler_close(s.dialler);
    conn_close(s.in);
    conn_close(s.out);
    uv_run(&s.loop, UV_RUN_DEFAULT);
    ck_assert_int_eq(uv_loop_close(&s.loop), 0);
}

FIXTURE(open_scene, close_scene)

static void
turn(int ms)
{
    uint64_t until = uv_hrtime() + (uint64_t)ms * 1000000;

    do { /* once at least, however late it is */
        uv_run(&s.loop, UV_RUN_NOWAIT);
        usleep(500);
    } while (uv_hrtime() < until);
}

static bool
turn_until(const int *n, int want)
{
    for (int i = 0; i < 20000 && *n < want; i++) {
        uv_run(&s.loop, UV_RUN_NOWAIT);
        usleep(500);
    }
    return *n >= want;
}

static void
dial_with(const char *id)
{
    struct dial_key key = { .expires = 0 };

    snprintf(key.id, sizeof key.id, "%s", id);
    memcpy(key.secret, secret, TLS_SECRET);
    ck_assert(dial(s.dialler, listener_text(s.listener), 1, &key));
}

TEST(a_key_lets_in_and_another_does_not)
{
    dial_with("worker:w:k1");
    ck_assert(turn_until(&s.nin, 1));
    dial_with("worker:x:k1");
    ck_assert(turn_until(&s.nrefused, 1));
    ck_assert(dial(s.dialler, listener_text(s.listener), 1, NULL));
    ck_assert(turn_until(&s.nrefused, 2));
    ck_assert_int_eq(s.nin, 1);
}

/* close_scene() does not, and the others are dialled meanwhile. */
TEST(nobody_waits_for_a_resolver_that_hangs)
{
    struct dial_key key = { .id = "worker:w:k1" };

    memcpy(key.secret, secret, TLS_SECRET);
    sem_init(&begun, 0, 0);
    sem_init(&ends, 0, 0);
    for (int i = 0; i < 8; i++)
        ck_assert(dial(s.dialler, HANGING ":80", 2, &key));
    for (int i = 0; i < 8; i++)
        while (sem_wait(&begun) < 0)
            ;
    dial_with("worker:w:k1");
    ck_assert(turn_until(&s.nin, 1));
    ck_assert_int_eq(s.nrefused, 0);
    close_scene();
    for (int i = 0; i < 8; i++)
        sem_post(&ends);
    open_scene();
}

/* A socket that answers nobody: as many wait there as may. */
static int
deaf_socket(char port[8])
{
    struct sockaddr_in in = { .sin_family = AF_INET,
                              .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    socklen_t n = sizeof in;
    int fd = socket(AF_INET, SOCK_STREAM, 0);

    ck_assert(fd >= 0 && bind(fd, (struct sockaddr *)&in, n) == 0 &&
              listen(fd, 0) == 0 &&
              getsockname(fd, (struct sockaddr *)&in, &n) == 0);
    snprintf(port, 8, "%u", ntohs(in.sin_port));
    for (int i = 0; i < 4; i++)
        connect(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK, 0),
                (struct sockaddr *)&in, n);
    return fd;
}

/* The dialler is closed at some time, too. */
TEST(an_address_that_never_answers_is_left_for_the_next)
{
    struct dial_key key = { .id = "worker:w:k1" };
    char deaf[8];
    int fd = deaf_socket(deaf);

    memcpy(key.secret, secret, TLS_SECRET);
    first_port = deaf;
    second_port = strrchr(listener_text(s.listener), ':') + 1;
    ck_assert(dial(s.dialler, TWO ":1", 2, &key));
    ck_assert(turn_until(&s.nin, 1));
    ck_assert_int_eq(s.nrefused, 0);
    second_port = deaf;
    ck_assert(dial(s.dialler, TWO ":1", 3, &key));
    turn(10);
    close(fd);
}

/* However far its handshake is, turn by turn of the loop. */
LOOP_TEST(nobody_gets_in_once_the_listener_is_closed, 40)
{
    int in;

    dial_with("worker:w:k1");
    for (int i = 0; i < _i; i++) {
        uv_run(&s.loop, UV_RUN_NOWAIT);
        usleep(300);
    }
    in = s.nin;
    listener_close(s.listener);
    turn(20);
    ck_assert_int_eq(s.nin, in);
    s.listener = NULL;
}

/* One that dials before we are told its key gets in once we are, and not
 * before; one that we are never told of is refused. */
LOOP_TEST(a_key_that_comes_later_is_waited_for, 2)
{
    comes = "peer:late";
    told_at = _i == 0 ? 3 : 0;
    dial_with("peer:late");
    ck_assert(turn_until(_i == 0 ? &s.nin : &s.nrefused, 1));
    ck_assert_int_eq(s.nin + s.nrefused, 1);
    ck_assert_int_ge(looks, 3);
    ck_assert_int_lt(looks, 15);
}

/* Much in both directions, in messages of all sizes. */
TEST(messages_go_by_tls_as_they_are)
{
    static uint8_t payload[MSG_MAX_AMBIENT];
    struct msg m = { .type = MSG_AMBIENT };
    size_t total = 0;

    dial_with("worker:w:k1");
    ck_assert(turn_until(&s.nin, 1));
    for (int i = 0; i < 4000 && !s.out; i++)
        turn(1);
    ck_assert_ptr_nonnull(s.out);
    m.ambient.count = 1;
    m.ambient.data = payload;
    for (int i = 0; i < 60; i++) {
        m.ambient.len = 1 + (size_t)i * 2000;
        total += m.ambient.len;
        ck_assert(conn_send(s.out, &m));
        m.ambient.len = 9;
        ck_assert(conn_send(s.in, &m));
    }
    ck_assert(turn_until(&s.messages_in, 60));
    ck_assert(turn_until(&s.messages_out, 60));
    ck_assert_uint_eq(s.bytes_in, total);
    ck_assert_uint_eq(conn_queued(s.out), 0);
    conn_finish(s.out); /* its last word is heard */
    s.out = NULL;
    ck_assert(turn_until(&s.ended, 1));
    ck_assert_ptr_null(s.in);
}

/* --- strangers --- */

/* A silent connection from 127.0.0.host. */
static int
stranger(int host)
{
    struct sockaddr_in to = { .sin_family = AF_INET }, from = to;
    int fd = socket(AF_INET, SOCK_STREAM, 0);
    unsigned a, b, c, d, port;

    ck_assert_int_eq(sscanf(listener_text(s.listener), "tcp %u.%u.%u.%u:%u", &a,
                            &b, &c, &d, &port),
                     5);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    to.sin_port = htons((uint16_t)port);
    from.sin_addr.s_addr = htonl(0x7f000000u | (unsigned)host);
    ck_assert_int_eq(bind(fd, (struct sockaddr *)&from, sizeof from), 0);
    ck_assert_int_eq(connect(fd, (struct sockaddr *)&to, sizeof to), 0);
    fcntl(fd, F_SETFL, O_NONBLOCK);
    turn(2);
    return fd;
}

static bool
hung_up(int fd)
{
    char byte;

    return recv(fd, &byte, 1, 0) == 0 || (errno != EAGAIN && errno != EINTR);
}

/* Wait for that. */
static bool
hangs_up(int fd)
{
    for (int i = 0; i < 20000 && !hung_up(fd); i++)
        turn(1);
    return hung_up(fd);
}

/* Strangers who have time for all that follows. */
static void
open_patient_scene(void)
{
    close_scene();
    open_scene_with(600000);
}

TEST(a_host_holds_some_and_the_oldest_goes)
{
    enum { N = GATE_MOST_HOST + 4 };
    int fds[N];

    open_patient_scene();
    for (int i = 0; i < N; i++)
        fds[i] = stranger(7);
    ck_assert(hangs_up(fds[N - GATE_MOST_HOST - 1]));
    for (int i = 0; i < N; i++)
        ck_assert_msg(hung_up(fds[i]) == (i < N - GATE_MOST_HOST), "%d", i);
    dial_with("worker:w:k1"); /* of another host, and it comes through */
    ck_assert(turn_until(&s.nin, 1));
    for (int i = 0; i < N; i++)
        close(fds[i]);
}

TEST(all_hosts_hold_some_and_the_oldest_goes)
{
    enum { N = GATE_MOST + 10 };
    int fds[N];

    open_patient_scene();
    for (int i = 0; i < N; i++)
        fds[i] = stranger(10 + i / GATE_MOST_HOST);
    ck_assert(hangs_up(fds[N - GATE_MOST - 1]));
    for (int i = 0; i < N; i++)
        ck_assert_msg(hung_up(fds[i]) == (i < N - GATE_MOST), "%d", i);
    for (int i = 0; i < 20; i++) { /* one after the other, and all through */
        dial_with("worker:w:k1");
        ck_assert(turn_until(&s.nin, i + 1));
        conn_close(s.out);
        s.out = NULL;
    }
    for (int i = 0; i < N; i++)
        close(fds[i]);
}

/* Not more is taken from one who has no key than a handshake needs. */
TEST(a_stranger_who_talks_is_let_go)
{
    static const uint8_t head[] = { 22, 3, 1, 64, 0, 1, 0, 63, 252, 3, 3 };
    static uint8_t noise[1000];
    int fd = stranger(8), sent = 0;

    ck_assert_int_eq(send(fd, head, sizeof head, MSG_NOSIGNAL), sizeof head);
    while (sent < 400000 && !hung_up(fd)) {
        if (send(fd, noise, sizeof noise, MSG_NOSIGNAL) > 0)
            sent += (int)sizeof noise;
        turn(1);
    }
    ck_assert_int_lt(sent, 2 * HANDSHAKE_BYTES);
    close(fd);
}

enum { SHORT_MS = 60 };

static const uint8_t hello[] = { 22, 3, 1, 0, 200, 1, 0, 0, 196, 3, 3 };

/* Who has not proven a key in time is let go, not sooner: one that is silent,
 * and one that says a byte now and then. */
LOOP_TEST(a_stranger_has_its_time_and_no_more, 2)
{
    uint64_t start;
    size_t said = 0;
    int fd;

    close_scene();
    open_scene_with(SHORT_MS);
    start = uv_hrtime();
    fd = stranger(12);
    for (int i = 0; i < 20000 && !hung_up(fd); i++) {
        if (_i && said < sizeof hello)
            said += send(fd, hello + said, 1, MSG_NOSIGNAL) == 1;
        turn(1);
    }
    ck_assert(hung_up(fd));
    ck_assert_uint_ge(uv_hrtime() - start, (SHORT_MS - 2) * 1000000u);
    ck_assert_int_eq(s.nin, 0);
    close(fd);
    /* nobody counts whom the next one would have to push out */
    for (int i = 0; i < GATE_MOST_HOST; i++) {
        fd = stranger(12);
        ck_assert(hangs_up(fd));
        close(fd);
    }
}

/* A stranger whose key is waited for has it looked for no more often by sending
 * more. */
TEST(a_stranger_who_goes_on_talking_causes_few_looks)
{
    struct tls_ctx *ctx = tls_client();
    struct tls *t = tls_dial(ctx, "peer:late", secret);
    struct rad_error err = { 0 };
    int fd = stranger(14);
    const uint8_t *p;
    size_t n;

    ck_assert_int_eq(tls_handshake(t, &err), 0);
    n = tls_out(t, &p);
    ck_assert_int_eq(send(fd, p, n, MSG_NOSIGNAL), (ssize_t)n);
    ck_assert(turn_until(&looks, 1));
    for (int i = 0; i < 20000 && !hung_up(fd); i++) {
        send(fd, p, 1, MSG_NOSIGNAL);
        turn(1);
    }
    ck_assert_int_lt(looks, 15);
    close(fd);
    tls_free(t);
    tls_ctx_free(ctx);
}

/* Unless told otherwise it is ten seconds: nobody goes at once. */
TEST(a_stranger_has_some_time)
{
    int fd = stranger(13);

    ck_assert_int_eq(HANDSHAKE_MS, 10000);
    turn(3 * SHORT_MS);
    ck_assert(!hung_up(fd));
    close(fd);
}

TEST(what_is_under_way_ends_with_the_listener)
{
    int fd = stranger(9);

    for (int i = 0; i < 5; i++)
        dial_with("worker:w:k1");
    uv_run(&s.loop, UV_RUN_NOWAIT);
    turn(1);
    close_scene();
    open_scene();
    ck_assert(hangs_up(fd));
    close(fd);
}
