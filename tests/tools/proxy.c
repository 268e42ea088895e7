/* proxy.c - stands between two processes and makes their connection a bad one
 *
 * proxy LISTEN TARGET COMMANDS: every connection to LISTEN is carried on to
 * TARGET, both "HOST:PORT" or the path of a Unix socket.  COMMANDS is a FIFO
 * of lines, which hold for all connections, present and later:
 *   delay MS       each byte arrives so much later
 *   rate BYTES     so many bytes a second and direction; 0: any
 *   hold up|down|both   nothing passes towards the target, or from it; it is
 *                  kept, and where there is too much nothing more is read
 *   drop           all connections are closed, in the middle of what they say
 *   cut BYTES      each is closed once so many more bytes have passed
 *   halfopen       the target's side is closed, the other is not told
 *   refuse         drop, and close every new connection at once
 *   speak N        who connects from now on offers version N of the protocol at
 *                  most (0: whatever it does), as if it had not been upgraded
 *   well           an end to all that but speak; what was held goes on
 *   gone           there are no connections any more that halfopen left
 * Ends with SIGTERM. */
#include "config.h"

#include "net/address.h"
#include "net/conn.h"

#include <fcntl.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

#define PUMP_MS 5
#define MOST    (64u << 10) /* bytes of a direction that wait here */

struct chunk {
    struct chunk *next;
    uint64_t due_ms;
    size_t len, sent;
    char bytes[];
};

struct flow {
    struct link *link;
    uv_stream_t *from, *to;
    struct chunk *first, **last;
    size_t waiting, passed; /* bytes; since it began */
    bool up, reading, ended;
    char buf[16384];
};

struct link {
    struct link *next;
    struct flow up, down;
    uv_connect_t connect;
    struct address target; /* for the connection that is being made */
    bool open, half, closing;
    int handles;
    long long left; /* until it is cut; -1: it is not */
};

static struct {
    uv_loop_t loop;
    union conn_stream listener;
    uv_pipe_t commands;
    uv_timer_t pump;
    uv_signal_t term;
    const char *target;
    struct link *links;
    char line[256];
    size_t nline;
    bool hold_up, hold_down, refuse;
    unsigned delay_ms, rate, speak;
} g;

static void
die(const char *what, int rc)
{
    fprintf(stderr, "proxy: %s: %s\n", what, uv_strerror(rc));
    exit(EX_OSERR);
}

/* --- ending --- */

static void
drop_chunks(struct flow *f)
{
    while (f->first) {
        struct chunk *c = f->first;

        f->first = c->next;
        free(c);
    }
}

static void
side_closed(uv_handle_t *h)
{
    struct link *l = h->data;
    struct link **at = &g.links;

    free(h);
    if (--l->handles > 0)
        return;
    while (*at != l)
        at = &(*at)->next;
    *at = l->next;
    drop_chunks(&l->up);
    drop_chunks(&l->down);
    free(l);
}

static void
close_side(struct link *l, uv_stream_t **side)
{
    uv_handle_t *h = (uv_handle_t *)*side;

    if (!uv_is_closing(h)) {
        h->data = l;
        uv_close(h, side_closed);
    }
}

static void
close_link(struct link *l)
{
    if (l->closing)
        return;
    l->closing = true;
    close_side(l, &l->up.from);
    if (!l->half)
        close_side(l, &l->up.to);
}

/* Its other end hears nothing. */
static void
half_open(struct link *l)
{
    if (l->closing || l->half || !l->open)
        return;
    l->half = true;
    close_side(l, &l->up.to);
}

/* --- carrying --- */

static void on_alloc(uv_handle_t *h, size_t wish, uv_buf_t *buf);
static void on_read(uv_stream_t *s, ssize_t n, const uv_buf_t *buf);

static void
read_or_not(struct flow *f)
{
    bool want = f->waiting < MOST && !f->ended;

    if (f->link->closing || f->link->half || want == f->reading)
        return;
    f->reading = want;
    if (want)
        uv_read_start(f->from, on_alloc, on_read);
    else
        uv_read_stop(f->from);
}

static void
on_alloc(uv_handle_t *h, size_t wish, uv_buf_t *buf)
{
    struct flow *f = h->data;

    (void)wish;
    *buf = uv_buf_init(f->buf, sizeof f->buf);
}

/* The highest version that a HELLO offers: two bytes, 18 into the first frame.
 */
static void
cap_hello(struct flow *f, struct chunk *c)
{
    const char most[2] = { (char)(g.speak >> 8), (char)g.speak };

    for (size_t i = 0; g.speak && f == &f->link->up && i < c->len; i++)
        if (f->passed + i >= 18 && f->passed + i < 20)
            c->bytes[i] = most[f->passed + i - 18];
    f->passed += c->len;
}

static void
on_read(uv_stream_t *s, ssize_t n, const uv_buf_t *buf)
{
    struct flow *f = s->data;
    struct chunk *c;

    if (n < 0) {
        f->ended = true;
        uv_read_stop(s);
        return;
    }
    if (n == 0)
        return;
    c = malloc(sizeof *c + (size_t)n);
    if (!c)
        abort();
    *c = (struct chunk){ .due_ms = uv_now(&g.loop) + g.delay_ms,
                         .len = (size_t)n };
    memcpy(c->bytes, buf->base, (size_t)n);
    cap_hello(f, c);
    *f->last = c;
    f->last = &c->next;
    f->waiting += (size_t)n;
    read_or_not(f);
}

/* Pass on at most `most` bytes; how many went. */
static size_t
pass(struct flow *f, size_t most)
{
    struct chunk *c = f->first;
    size_t n = c->len - c->sent;
    uv_buf_t buf;
    int rc;

    buf = uv_buf_init(c->bytes + c->sent, (unsigned)(n < most ? n : most));
    rc = uv_try_write(f->to, &buf, 1);
    if (rc == UV_EAGAIN)
        return 0;
    if (rc < 0) {
        close_link(f->link);
        return 0;
    }
    c->sent += (size_t)rc;
    f->waiting -= (size_t)rc;
    if (c->sent == c->len) {
        f->first = c->next;
        if (!f->first)
            f->last = &f->first;
        free(c);
    }
    return (size_t)rc;
}

static void
pump(struct flow *f, bool held)
{
    struct link *l = f->link;
    size_t budget = g.rate ? g.rate * PUMP_MS / 1000 + 1 : SIZE_MAX, n;

    while (!held && !l->closing && !l->half && l->open && budget > 0 &&
           f->first && f->first->due_ms <= uv_now(&g.loop)) {
        size_t most = budget;

        if (l->left >= 0 && (size_t)l->left < most)
            most = (size_t)l->left;
        n = most ? pass(f, most) : 0;
        if (l->left >= 0 && (l->left -= (long long)n) <= 0)
            close_link(l);
        if (n == 0)
            break;
        budget -= n;
    }
    read_or_not(f);
    if (f->ended && !f->first && !held)
        close_link(l);
}

static void
on_pump(uv_timer_t *timer)
{
    (void)timer;
    for (struct link *l = g.links; l; l = l->next) {
        pump(&l->up, g.hold_up);
        pump(&l->down, g.hold_down);
    }
}

/* --- connections --- */

static void
connected(uv_connect_t *req, int status)
{
    struct link *l = req->data;

    if (status < 0)
        close_link(l);
    if (l->closing)
        return;
    l->open = true;
    l->up.from->data = &l->up;
    l->up.to->data = &l->down;
    read_or_not(&l->up);
    read_or_not(&l->down);
}

static void
dial(struct link *l)
{
    int rc;

    l->connect.data = l;
    if (address_is_local(&l->target)) {
        uv_pipe_connect(&l->connect, (uv_pipe_t *)l->up.to,
                        l->target.sa.un.sun_path, connected);
        return;
    }
    rc = uv_tcp_connect(&l->connect, (uv_tcp_t *)l->up.to, &l->target.sa.any,
                        connected);
    if (rc < 0)
        close_link(l);
}

static void
on_connection(uv_stream_t *server, int status)
{
    bool local = server->type == UV_NAMED_PIPE;
    struct link *l = calloc(1, sizeof *l);

    if (!l || status < 0 || address_resolve(g.target, &l->target, 1, NULL) < 0)
        die(g.target, UV_EINVAL);
    l->up.from = l->down.to = conn_stream_new(&g.loop, local);
    l->up.to = l->down.from =
        conn_stream_new(&g.loop, address_is_local(&l->target));
    l->up.link = l->down.link = l;
    l->up.last = &l->up.first;
    l->down.last = &l->down.first;
    l->handles = 2;
    l->left = -1;
    l->next = g.links;
    g.links = l;
    if (uv_accept(server, l->up.from) < 0 || g.refuse)
        close_link(l);
    else
        dial(l);
}

/* --- commands --- */

static void
all_links(void (*act)(struct link *l))
{
    for (struct link *l = g.links; l; l = l->next)
        act(l);
}

static void
close_half(struct link *l)
{
    if (l->half)
        close_link(l);
}

static void
well(void)
{
    g.hold_up = g.hold_down = g.refuse = false;
    g.delay_ms = g.rate = 0;
    for (struct link *l = g.links; l; l = l->next)
        l->left = -1;
}

static void
obey(const char *line)
{
    char where[16];
    unsigned n;

    if (sscanf(line, "delay %u", &n) == 1) {
        g.delay_ms = n;
    } else if (sscanf(line, "rate %u", &n) == 1) {
        g.rate = n;
    } else if (sscanf(line, "hold %15s", where) == 1) {
        g.hold_up = strcmp(where, "down") != 0;
        g.hold_down = strcmp(where, "up") != 0;
    } else if (sscanf(line, "cut %u", &n) == 1) {
        for (struct link *l = g.links; l; l = l->next)
            l->left = n;
    } else if (sscanf(line, "speak %u", &n) == 1) {
        g.speak = n;
    } else if (strcmp(line, "drop") == 0) {
        all_links(close_link);
    } else if (strcmp(line, "halfopen") == 0) {
        all_links(half_open);
    } else if (strcmp(line, "gone") == 0) {
        all_links(close_half);
    } else if (strcmp(line, "refuse") == 0) {
        g.refuse = true;
        all_links(close_link);
    } else if (strcmp(line, "well") == 0) {
        well();
    } else {
        fprintf(stderr, "proxy: no command: '%s'\n", line);
        exit(EX_USAGE);
    }
}

static void
on_commands(uv_stream_t *s, ssize_t n, const uv_buf_t *buf)
{
    (void)s;
    for (ssize_t i = 0; i < n; i++) {
        char c = buf->base[i];

        if (c != '\n' && g.nline < sizeof g.line - 1) {
            g.line[g.nline++] = c;
            continue;
        }
        g.line[g.nline] = '\0';
        g.nline = 0;
        obey(g.line);
    }
}

static void
command_room(uv_handle_t *h, size_t wish, uv_buf_t *buf)
{
    static char bytes[1024];

    (void)h;
    (void)wish;
    *buf = uv_buf_init(bytes, sizeof bytes);
}

static void
open_commands(const char *path)
{
    int fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC), rc;

    if (fd < 0)
        die(path, UV_ENOENT);
    uv_pipe_init(&g.loop, &g.commands, 0);
    rc = uv_pipe_open(&g.commands, fd);
    if (rc == 0)
        rc = uv_read_start((uv_stream_t *)&g.commands, command_room,
                           on_commands);
    if (rc < 0)
        die(path, rc);
}

/* --- start and end --- */

static void
on_term(uv_signal_t *sig, int signum)
{
    (void)sig;
    (void)signum;
    uv_stop(&g.loop); /* the end of the process closes the rest */
}

static void
serve(const char *text)
{
    struct address a;
    int rc;

    if (address_resolve(text, &a, 1, NULL) < 0)
        die(text, UV_EINVAL);
    if (address_is_local(&a)) {
        unlink(a.sa.un.sun_path);
        uv_pipe_init(&g.loop, &g.listener.pipe, 0);
        rc = uv_pipe_bind(&g.listener.pipe, a.sa.un.sun_path);
    } else {
        uv_tcp_init(&g.loop, &g.listener.tcp);
        rc = uv_tcp_bind(&g.listener.tcp, &a.sa.any, 0);
    }
    if (rc == 0)
        rc = uv_listen(&g.listener.stream, 64, on_connection);
    if (rc < 0)
        die(text, rc);
}

int
main(int argc, char *argv[])
{
    if (argc != 4) {
        fprintf(stderr, "usage: proxy LISTEN TARGET COMMANDS\n");
        return EX_USAGE;
    }
    signal(SIGPIPE, SIG_IGN);
    uv_loop_init(&g.loop);
    g.target = argv[2];
    open_commands(argv[3]);
    serve(argv[1]);
    uv_signal_init(&g.loop, &g.term);
    uv_signal_start(&g.term, on_term, SIGTERM);
    uv_timer_init(&g.loop, &g.pump);
    uv_timer_start(&g.pump, on_pump, PUMP_MS, PUMP_MS);
    uv_run(&g.loop, UV_RUN_DEFAULT);
    return EX_OK;
}
