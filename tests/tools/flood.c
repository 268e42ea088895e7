/* flood.c - strangers and spoilers, by the thousand
 *
 *   flood garbage N WHERE          N connections that say no TLS, or begin it
 *                                  and go wrong, a few at a time
 *   flood frames N WHERE KEYFILE   N frames of garbage behind a right key: what
 *                                  ends the connection is followed by another
 *   flood loris N WHERE            N connections that say next to nothing, each
 *                                  made anew when it is closed, until killed;
 *                                  writes "ready" once all have been there
 *
 *   flood queries N WHERE KEYFILE  N connections of a user, each of which asks
 *                                  for 20 lists of jobs, reads none, and is
 *                                  made anew when it is cut
 *   flood submits N WHERE KEYFILE  N jobs of a user whose files never come
 *   flood uploads N WHERE KEYFILE  N files of a user that come by half
 *   flood offers N WHERE KEYFILE   N questions about 16384 files each
 *
 * Those of a user write "ready" when they are through, and go on until standard
 * input ends.
 *
 * Behind each frame goes a PING, whose PONG says that it was read, or the end
 * of the connection does.  WHERE is "127.0.0.1:7420".  What is sent is the same
 * each time.  Exits with 0 when it has done so, 69 when nobody listens. */
#include "config.h"

#include "net/address.h"
#include "proto/frame.h"
#include "net/key/keyfile.h"
#include "proto/message.h"
#include "net/tls.h"

#include <netinet/tcp.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

enum { QUERIES = 20, OFFERED = 16384, MOST_TRIES = 400, PIECE = 8192 };
enum { AT_ONCE = 6, MOST_LORIS = 1000, PATIENCE_MS = 100000, ANSWER_MS = 100 };

static uint32_t
next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

static int
open_socket(const struct address *a)
{
    int fd = socket(a->sa.any.sa_family, SOCK_STREAM | SOCK_CLOEXEC, 0), on = 1;

    setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (fd >= 0 &&
        connect(fd, &a->sa.any,
                a->sa.any.sa_family == AF_INET ? sizeof a->sa.in
                                               : sizeof a->sa.in6) == 0)
        return fd;
    if (fd >= 0)
        close(fd);
    return -1;
}

static bool
send_all(int fd, const void *bytes, size_t n)
{
    const uint8_t *p = bytes;

    while (n > 0) {
        ssize_t put = send(fd, p, n, MSG_NOSIGNAL);

        if (put <= 0)
            return false;
        p += put;
        n -= (size_t)put;
    }
    return true;
}

/* --- garbage --- */

static size_t
make_garbage(uint8_t *p, size_t room, uint32_t *state)
{
    static const struct {
        uint8_t n;
        const char *bytes;
    } heads[] = {
        { 0, "" },
        { 16, "RADD\0\1\0\0\0\0\0\1\0\0\0\5" },
        { 27, "GET / HTTP/1.1\r\nHost: x\r\n\r\n" },
        { 11, "\26\3\1\4\0\1\0\3\374\3\3" },
        { 5, "\26\3\1\377\377" },
        { 5, "\27\3\3\0\20" },
    };
    uint32_t which = next_random(state) % 6;
    size_t head = heads[which].n;
    size_t n = head + next_random(state) % (room - head);

    for (size_t i = 0; i < n; i++)
        p[i] = (uint8_t)next_random(state);
    memcpy(p, heads[which].bytes, head);
    return n;
}

/* Whoever came first must be through before one more comes. */
static void
wait_closed(int fd)
{
    struct pollfd p = { .fd = fd, .events = POLLIN };
    char sink[512];

    shutdown(fd, SHUT_WR);
    while (poll(&p, 1, PATIENCE_MS) > 0 && recv(fd, sink, sizeof sink, 0) > 0)
        ;
    close(fd);
}

static int
garbage(const struct address *a, long n)
{
    uint8_t bytes[600];
    uint32_t state = 1;
    int fds[AT_ONCE];

    for (int i = 0; i < AT_ONCE; i++)
        fds[i] = -1;
    for (long i = 0; i < n; i++) {
        int *fd = &fds[i % AT_ONCE];

        if (*fd >= 0)
            wait_closed(*fd);
        *fd = open_socket(a);
        if (*fd < 0)
            return EX_UNAVAILABLE;
        send_all(*fd, bytes, make_garbage(bytes, sizeof bytes, &state));
    }
    for (int i = 0; i < AT_ONCE; i++)
        if (fds[i] >= 0)
            wait_closed(fds[i]);
    return EX_OK;
}

/* --- frames --- */

struct spoiler {
    int fd;
    struct tls_ctx *ctx;
    struct tls *tls; /* NULL: not connected */
    long came;       /* bytes */
    long heard;      /* of messages */
    uint16_t version;
    struct key key;
};

static bool
flush(struct spoiler *s)
{
    const uint8_t *p;
    size_t n = tls_out(s->tls, &p);
    bool ok = n == 0 || send_all(s->fd, p, n);

    tls_sent(s->tls);
    return ok;
}

static void
hang_up(struct spoiler *s)
{
    tls_free(s->tls);
    s->tls = NULL;
    if (s->fd >= 0)
        close(s->fd);
    s->fd = -1;
}

/* Bytes that came; false: it is over. */
static bool
hear(struct spoiler *s, int wait_ms)
{
    struct pollfd p = { .fd = s->fd, .events = POLLIN };
    uint8_t buf[4096];
    ssize_t n;
    int rc;

    if (poll(&p, 1, wait_ms) <= 0)
        return true;
    n = recv(s->fd, buf, sizeof buf, 0);
    s->came += n > 0 ? n : 0;
    if (n <= 0 || tls_put(s->tls, buf, (size_t)n, NULL) < 0)
        return false;
    while ((rc = tls_read(s->tls, buf, sizeof buf, NULL)) > 0)
        s->heard += rc;
    return rc == 0 && !tls_ended(s->tls);
}

static bool
say(struct spoiler *s, const void *bytes, size_t n)
{
    const uint8_t *p = bytes;

    while (n > 0) {
        size_t piece = n < PIECE ? n : PIECE;

        if (tls_write(s->tls, p, piece, NULL) != 0 || !flush(s))
            return false;
        p += piece;
        n -= piece;
    }
    return true;
}

static bool
say_message(struct spoiler *s, const struct msg *m)
{
    struct wire_out w;
    bool ok;

    wire_out_init(&w, MSG_FRAME_MAX);
    ok = msg_pack(&w, m) == 0 && say(s, w.buf, w.len);
    wire_out_release(&w);
    return ok;
}

/* Wait for an answer; false: it is over, or nothing comes. */
static bool
answered(struct spoiler *s, int wait_ms)
{
    struct msg m = { .type = MSG_PING };
    long before = s->heard, came;
    bool ok = say_message(s, &m);

    do { /* half a record says nothing yet */
        came = s->came;
        ok = ok && hear(s, wait_ms);
    } while (ok && s->heard == before && s->came > came);
    return ok && s->heard > before;
}

static bool
say_hello(struct spoiler *s)
{
    struct msg m = { .type = MSG_HELLO,
                     .hello = { 1, s->version, (uint8_t)s->key.role,
                                s->key.name, "x", "", 1, 0 } };

    return say_message(s, &m);
}

static bool
come(struct spoiler *s, const struct address *a)
{
    char id[KEY_ID];
    int rc;

    key_id(&s->key, id);
    s->fd = open_socket(a);
    s->tls = s->fd >= 0 ? tls_dial(s->ctx, id, s->key.secret) : NULL;
    if (!s->tls)
        return false;
    while ((rc = tls_handshake(s->tls, NULL)) == 0)
        if (!flush(s) || !hear(s, PATIENCE_MS))
            return false;
    return rc == 1 && flush(s);
}

/* A header that may pass, for any message, and a payload that will not, or a
 * header that does not. */
static size_t
make_frame(uint8_t *p, size_t room, uint32_t *state)
{
    size_t len = next_random(state) % (room - 16), claim = len;
    uint16_t type = (uint16_t)(next_random(state) % 66);

    if (next_random(state) % 8 == 0)
        claim = next_random(state);
    for (size_t i = 0; i < 16 + len; i++)
        p[i] = (uint8_t)next_random(state);
    memcpy(p, "RADD", 4);
    p[4] = 0;
    p[5] = (uint8_t)type;
    p[6] = p[7] = 0;
    for (int i = 0; i < 4; i++)
        p[12 + i] = (uint8_t)(claim >> (24 - 8 * i));
    if (next_random(state) % 16 == 0)
        p[next_random(state) % 8] ^= 0x55;
    return 16 + len;
}

static int
frames(const struct address *a, long n, const char *path)
{
    struct spoiler s = { .fd = -1, .ctx = tls_client(), .version = 1 };
    struct keyfile f;
    uint8_t bytes[300];
    uint32_t state = 1;

    if (!s.ctx || keyfile_load(&f, path, NULL) < 0 || f.n < 1)
        return EX_NOINPUT;
    s.key = f.v[0];
    for (long i = 0; i < n;) {
        if (!s.tls) {
            if (!come(&s, a))
                return EX_UNAVAILABLE;
            /* one in four says it instead of hello */
            if (next_random(&state) % 4 != 0 && !say_hello(&s)) {
                hang_up(&s);
                continue;
            }
        }
        i++;
        if (!say(&s, bytes, make_frame(bytes, sizeof bytes, &state)) ||
            !answered(&s, ANSWER_MS))
            hang_up(&s);
    }
    hang_up(&s);
    keyfile_release(&f);
    tls_ctx_free(s.ctx);
    return EX_OK;
}

/* --- users who want too much --- */

/* As the user of the key file's first key, welcome. */
static bool
join(struct spoiler *s, const struct address *a, const struct key *key)
{
    s->fd = -1;
    s->version = MSG_VERSION;
    s->key = *key;
    s->heard = 0;
    return come(s, a) && say_hello(s) && hear(s, PATIENCE_MS) && s->heard > 0;
}

static bool
ask_lists(struct spoiler *s)
{
    struct msg m = { .type = MSG_QUERY,
                     .query = { .what = MSG_QUERY_JOBS, .text = "" } };

    for (int i = 0; i < QUERIES; i++)
        if (!say_message(s, &m))
            return false;
    return true;
}

/* Standard input ends it. */
static bool
is_over(void)
{
    struct pollfd p = { .fd = STDIN_FILENO, .events = POLLIN };

    return poll(&p, 1, 0) > 0;
}

static void
say_ready(void)
{
    puts("ready");
    fflush(stdout);
}

/* There are too many connections for the moment. */
static bool
try_later(struct spoiler *s, int *tries)
{
    hang_up(s);
    poll(NULL, 0, 50);
    return --*tries > 0;
}

static bool
is_cut(const struct spoiler *s)
{
    struct pollfd p = { .fd = s->fd, .events = 0 };

    return s->fd < 0 ||
           (poll(&p, 1, 0) > 0 && (p.revents & (POLLHUP | POLLERR)));
}

/* N connections at once, each made anew when it is cut. */
static int
queries(struct spoiler *first, const struct address *a, long n)
{
    struct spoiler *s = calloc((size_t)n, sizeof *s);
    int tries = MOST_TRIES, rc = EX_OK;

    for (long i = 0; s && i < n; i++)
        s[i].fd = -1;
    for (long at = 0; s && rc == EX_OK && !is_over(); at++) {
        long i = at % n;

        s[i].ctx = first->ctx;
        if (at == n)
            say_ready();
        if (at >= n && i == 0)
            poll(NULL, 0, 100);
        if (!is_cut(&s[i]))
            continue;
        hang_up(&s[i]);
        while (rc == EX_OK &&
               (!join(&s[i], a, &first->key) || !ask_lists(&s[i])))
            if (!try_later(&s[i], &tries))
                rc = EX_UNAVAILABLE;
    }
    for (long i = 0; s && i < n; i++)
        hang_up(&s[i]);
    free(s);
    return s ? rc : EX_OSERR;
}

static void
number(uint8_t *to, long i)
{
    for (int k = 0; k < 4; k++)
        to[k] = (uint8_t)(i >> (8 * k));
    to[4] = 0x5a;
}

/* What says one thing, and hears the answer before the next. */
typedef bool say_fn(struct spoiler *s, long i);

static bool
say_submit(struct spoiler *s, long i)
{
    static const struct msg_frame frame = { 0, 8, 8, "" };
    uint8_t job[MSG_JOB] = { 0 }, file[MSG_HASH] = { 0 };
    struct msg m = { .type = MSG_SUBMIT };

    number(job, i);
    number(file, i);
    m.submit = (struct msg_spec){ .job = job,
                                  .manifest = file,
                                  .name = "flood",
                                  .params = "",
                                  .needs = "",
                                  .estimate = "uniform",
                                  .priority = 100,
                                  .files = { 1, file },
                                  .nframes = 1,
                                  .frames = &frame };
    return say_message(s, &m) && answered(s, PATIENCE_MS);
}

static bool
say_upload(struct spoiler *s, long i)
{
    static uint8_t data[100000];
    uint8_t file[MSG_HASH] = { 0 };
    struct msg m = { .type = MSG_CHUNK };

    number(file, i);
    m.chunk = (struct msg_chunk){ file, 0, 2 * sizeof data, data, sizeof data };
    return say_message(s, &m) && answered(s, PATIENCE_MS);
}

static bool
say_offer(struct spoiler *s, long i)
{
    static uint8_t files[OFFERED * MSG_HASH];
    struct msg m = { .type = MSG_OFFER, .offer = { OFFERED, files } };

    for (long k = 0; k < OFFERED; k++)
        number(files + k * MSG_HASH, i * OFFERED + k);
    return say_message(s, &m) && answered(s, PATIENCE_MS);
}

/* N of them, and more. */
static int
repeat(struct spoiler *s, const struct address *a, long n, say_fn *fn)
{
    struct key key = s->key;
    int tries = MOST_TRIES;

    for (long at = 0; !is_over(); at++) {
        if (at == n)
            say_ready();
        while (!s->tls && !join(s, a, &key))
            if (!try_later(s, &tries))
                return EX_UNAVAILABLE;
        if (!fn(s, at))
            hang_up(s);
    }
    hang_up(s);
    return EX_OK;
}

static int
user(const char *what, const struct address *a, long n, const char *path)
{
    struct spoiler s = { .fd = -1, .ctx = tls_client() };
    struct keyfile f;
    int status = EX_USAGE;

    if (!s.ctx || keyfile_load(&f, path, NULL) < 0 || f.n < 1)
        return EX_NOINPUT;
    s.key = f.v[0];
    if (strcmp(what, "queries") == 0)
        status = queries(&s, a, n);
    else if (strcmp(what, "submits") == 0)
        status = repeat(&s, a, n, say_submit);
    else if (strcmp(what, "uploads") == 0)
        status = repeat(&s, a, n, say_upload);
    else if (strcmp(what, "offers") == 0)
        status = repeat(&s, a, n, say_offer);
    keyfile_release(&f);
    tls_ctx_free(s.ctx);
    return status;
}

/* --- slow ones --- */

static int
loris(const struct address *a, long n)
{
    static struct pollfd p[MOST_LORIS];
    static const char begin[] = "\26\3\1\0\200";
    bool ready = false;

    if (n > MOST_LORIS)
        return EX_USAGE;
    for (long i = 0; i < n; i++)
        p[i] = (struct pollfd){ .fd = -1, .events = POLLIN };
    for (unsigned round = 0;; round++) {
        char sink[64];

        for (long i = 0; i < n; i++) {
            if (p[i].fd < 0)
                p[i].fd = open_socket(a);
            if (p[i].fd < 0)
                return EX_UNAVAILABLE;
            if (round % 5 == 0) /* a byte at a time */
                send(p[i].fd, begin + round / 5 % 5, 1, MSG_NOSIGNAL);
        }
        if (!ready)
            puts("ready");
        fflush(stdout);
        ready = true;
        poll(NULL, 0, 100);
        if (poll(p, (nfds_t)n, 0) <= 0)
            continue;
        for (long i = 0; i < n; i++)
            if (p[i].revents && recv(p[i].fd, sink, sizeof sink, 0) <= 0) {
                close(p[i].fd);
                p[i].fd = -1;
            }
    }
}

int
main(int argc, char *argv[])
{
    struct address a;
    const char *what = argc > 1 ? argv[1] : "";
    long n = argc > 2 ? atol(argv[2]) : 0;

    if (argc < 4 || address_resolve(argv[3], &a, 1, NULL) < 0)
        return EX_USAGE;
    if (strcmp(what, "garbage") == 0)
        return garbage(&a, n);
    if (strcmp(what, "frames") == 0 && argc > 4)
        return frames(&a, n, argv[4]);
    if (strcmp(what, "loris") == 0)
        return loris(&a, n);
    if (argc > 4)
        return user(what, &a, n, argv[4]);
    return EX_USAGE;
}
