/* session.c - see session.h
 *
 *   down -> dialling -> greeting (HELLO said) -> up
 *     ^________|____________|____________________|
 *
 *   any of these --session_close()--> closed */
#include "config.h"

#include "observer/session.h"

#include "base/text.h"
#include "net/conn.h"
#include "net/dial.h"
#include "net/key/keyfile.h"
#include "net/log.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define FIRST_REDIAL_MS 500 /* first wait; doubled at each dial */
#define LAST_REDIAL_MS  30000 /* longest wait */
#define MOST_ASKED      64 /* most requests that wait for an answer */

static const char out_of_memory[] = "out of memory";

struct asked {
    struct asked *next;
    uint32_t request;
    size_t most;
    bool head;
    session_fn *fn;
    void *arg;
    uint8_t *bytes; /* the first `kept` bytes of the file */
    size_t n, kept; /* n bytes of the file have come in CHUNKs, */
    uint64_t total; /* of so many */
};

enum state { DOWN, DIALLING, GREETING, UP, CLOSED };

struct session {
    struct session_conf conf;
    uv_loop_t *loop;
    struct dialler *dialler;
    struct conn *conn;
    enum state state;
    uint64_t dial_ms; /* when the coordinator may be dialled next */
    unsigned wait_ms;
    uint32_t request; /* number of the last request */
    struct asked *asked;
    unsigned nasked;
    char why[300]; /* why the connection is down; browsers see it, so it names
                    * no path */
    bool told;     /* the log says that the connection is down */
};

bool
session_is_up(const struct session *s)
{
    return s->state == UP;
}

const char *
session_why(const struct session *s)
{
    return s->state == UP ? "" : s->why;
}

/* --- requests --- */

static void
free_asked(struct asked *a)
{
    free(a->bytes);
    free(a);
}

static struct asked *
take(struct session *s, uint32_t request)
{
    struct asked **at = &s->asked, *a;

    while (*at && (*at)->request != request)
        at = &(*at)->next;
    a = *at;
    if (a) {
        *at = a->next;
        s->nasked--;
    }
    return a;
}

static struct asked *
find(const struct session *s, uint32_t request)
{
    struct asked *a = s->asked;

    while (a && a->request != request)
        a = a->next;
    return a;
}

static void
answer(struct session *s, uint32_t request, const struct session_answer *what)
{
    struct asked *a = take(s, request);

    if (!a)
        return;
    a->fn(a->arg, what);
    free_asked(a);
}

static void
refuse(struct session *s, uint32_t request, int status, const char *text)
{
    struct session_answer what = { .status = status, .text = text };

    answer(s, request, &what);
}

static void
refuse_all(struct session *s)
{
    while (s->asked)
        refuse(s, s->asked->request, EX_UNAVAILABLE,
               "the coordinator cannot be reached");
}

bool
session_ask(struct session *s, struct msg *m, size_t most, bool head,
            session_fn *fn, void *arg)
{
    struct asked *a;

    if (s->state != UP || s->nasked >= MOST_ASKED)
        return false;
    a = calloc(1, sizeof *a);
    if (!a)
        return false;
    m->request = ++s->request ? s->request : ++s->request;
    *a = (struct asked){ .next = s->asked,
                         .request = m->request,
                         .most = most,
                         .head = head,
                         .fn = fn,
                         .arg = arg };
    s->asked = a;
    s->nasked++;
    if (conn_send(s->conn, m)) {
        conn_flush(s->conn);
        return true;
    }
    if ((a = take(s, m->request)) != NULL)
        free_asked(a);
    return false;
}

/* --- answers --- */

/* Append a CHUNK to its answer; the CHUNKs of an answer come in order. */
static void
on_chunk(struct session *s, const struct msg *m)
{
    const struct msg_chunk *k = &m->chunk;
    struct asked *a = find(s, m->request);
    struct session_answer what = { 0 };

    if (!a)
        return; /* a late CHUNK of an answer that was refused */
    if (k->total > a->most && !a->head) {
        refuse(s, m->request, EX_DATAERR, "it is too large to be shown here");
        return;
    }
    if (!a->bytes) {
        a->total = k->total;
        a->kept = k->total < a->most ? (size_t)k->total : a->most;
        a->bytes = malloc(a->kept + 1);
    }
    if (!a->bytes || k->total != a->total || k->offset != a->n ||
        k->len > a->total - a->n) {
        refuse(s, m->request, EX_PROTOCOL, "pieces of it are missing");
        return;
    }
    if (a->n < a->kept)
        memcpy(a->bytes + a->n, k->data,
               k->len < a->kept - a->n ? k->len : a->kept - a->n);
    a->n += k->len;
    if (a->n < a->total)
        return;
    what.bytes = a->bytes;
    what.n = a->kept;
    answer(s, m->request, &what);
}

static void
on_answer(struct session *s, const struct msg *m)
{
    struct session_answer what = { .bytes = m->answer.text,
                                   .n = m->answer.len };
    const struct asked *a = find(s, m->request);

    if (a && what.n > a->most)
        refuse(s, m->request, EX_DATAERR, "it is too long");
    else
        answer(s, m->request, &what);
}

/* --- the connection --- */

/* Note that the connection is down.  The text why is for the log, the text
 * shown for browsers.  Waiting requests are refused at the next tick and not
 * here, for this may run inside session_ask(). */
static void
note_down(struct session *s, const char *why, const char *shown)
{
    s->state = DOWN;
    s->conn = NULL;
    rad_text_print(s->why, sizeof s->why, "%s", shown);
    s->dial_ms = uv_now(s->loop) + s->wait_ms;
    s->wait_ms =
        s->wait_ms < LAST_REDIAL_MS / 2 ? 2 * s->wait_ms : LAST_REDIAL_MS;
    if (!s->told)
        log_warn("no coordinator at=%s why=%s", s->conf.coordinator, why);
    s->told = true;
}

static void
on_welcome(struct session *s, const struct msg *m)
{
    unsigned version = m->welcome.version;

    if (msg_common_version(version, version) == 0) {
        conn_break(s->conn, "it speaks another version of the protocol");
        return;
    }
    conn_set_version(s->conn, version);
    conn_set_session(s->conn, MSG_AT_CLIENT);
    conn_live(s->conn, true);
    s->state = UP;
    s->wait_ms = FIRST_REDIAL_MS;
    s->told = false;
    log_info("connected coordinator=%s program=%s", s->conf.coordinator,
             m->welcome.program);
}

static void
on_message(void *arg, struct conn *c, const struct msg *m)
{
    struct session *s = arg;

    switch (m->type) {
    case MSG_WELCOME:
        on_welcome(s, m);
        break;
    case MSG_REFUSE:
        conn_break(c, m->refuse.text);
        break;
    case MSG_BYE:
        conn_break(c, m->bye.text);
        break;
    case MSG_ANSWER:
        on_answer(s, m);
        break;
    case MSG_CHUNK:
        on_chunk(s, m);
        break;
    case MSG_FAILED:
        refuse(s, m->request, m->failed.status ? m->failed.status : EX_SOFTWARE,
               m->failed.text);
        break;
    default:
        break;
    }
}

static void
on_closed(void *arg, struct conn *c, const char *why)
{
    (void)c;
    note_down(arg, why, why);
}

static const struct conn_handler handler = { .message = on_message,
                                             .closed = on_closed,
                                             .quiet = true };

static void
say_hello(struct session *s)
{
    struct msg hello = { .type = MSG_HELLO,
                         .hello = { .min = MSG_VERSION_MIN,
                                    .max = MSG_VERSION,
                                    .role = MSG_ROLE_OBSERVER,
                                    .name = "",
                                    .program = "radweb " PACKAGE_VERSION,
                                    .address = "" } };

    s->state = GREETING;
    if (conn_send(s->conn, &hello))
        conn_flush(s->conn);
}

static void
on_dialled(void *arg, uint64_t id, uv_stream_t *stream, struct tls *tls,
           const char *peer, const struct rad_error *why)
{
    struct session *s = arg;

    (void)id;
    if (!stream) {
        const char *what = why->what[0] ? why->what : uv_strerror(why->code);

        note_down(s, what, what);
        return;
    }
    s->conn = conn_new(stream, tls, MSG_AT_DIALLER, peer, &handler, s);
    if (s->conn)
        say_hello(s);
    else
        note_down(s, out_of_memory, out_of_memory);
}

static void
begin_dial(struct session *s)
{
    struct dial_key key;
    struct rad_error err = { 0 };
    char text[600];
    bool has = s->conf.key[0] != '\0';

    s->state = DIALLING;
    /* the key file is read at each dial, so a new key needs no restart */
    if (has && keyfile_choose(s->conf.key, MSG_ROLE_OBSERVER, key.id,
                              key.secret, &key.expires, &err) < 0) {
        rad_error_format(&err, text, sizeof text);
        note_down(s, text, "radweb has no key for it, its log says why");
        return;
    }
    if (!dial(s->dialler, s->conf.coordinator, 0, has ? &key : NULL))
        note_down(s, out_of_memory, out_of_memory);
    explicit_bzero(&key, sizeof key);
}

void
session_tick(struct session *s)
{
    if (s->state != DOWN)
        return;
    refuse_all(s);
    if (uv_now(s->loop) >= s->dial_ms)
        begin_dial(s);
}

struct session *
session_new(uv_loop_t *loop, const struct session_conf *conf)
{
    struct session *s = calloc(1, sizeof *s);

    if (!s)
        return NULL;
    s->conf = *conf;
    s->loop = loop;
    s->wait_ms = FIRST_REDIAL_MS;
    snprintf(s->why, sizeof s->why, "not connected yet");
    s->dialler = dialler_new(loop, on_dialled, s);
    if (s->dialler)
        return s;
    free(s);
    return NULL;
}

void
session_close(struct session *s)
{
    if (!s)
        return;
    dialler_close(s->dialler);
    conn_close(s->conn);
    s->conn = NULL;
    s->state = CLOSED;
    refuse_all(s);
}

void
session_free(struct session *s)
{
    free(s);
}
