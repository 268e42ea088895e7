/* shell.c - see shell.h */
#include "config.h"

#include "shell/shell.h"

#include "net/log.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/random.h>

/* While the store's backlog is above STORE_HIGH bytes connections that add to
 * it are not read; they are read again when it is below STORE_LOW. */
#define STORE_HIGH (32u << 20)
#define STORE_LOW  (8u << 20)

struct shell_link {
    struct shell_link *next;
    struct shell *shell;
    uint64_t id;
    struct conn *conn; /* NULL: it has ended */
    bool paused;       /* not read until the store has caught up */
    char why[128];
};

static struct shell_link **
find(const struct shell *s, uint64_t id)
{
    struct shell_link **at =
        (struct shell_link **)&s->links[id % SHELL_BUCKETS];

    while (*at && (*at)->id != id)
        at = &(*at)->next;
    return at;
}

/* Move a link from the table to the list of ended links, of which the machine
 * has yet to be told. */
static void
move_gone(struct shell_link **at, const char *why)
{
    struct shell_link *l = *at;

    *at = l->next;
    l->conn = NULL;
    snprintf(l->why, sizeof l->why, "%s", why);
    l->next = l->shell->gone;
    l->shell->gone = l;
}

static void
on_message(void *arg, struct conn *c, const struct msg *m)
{
    struct shell_link *l = arg;
    struct shell *s = l->shell;
    uint64_t since_ns = uv_hrtime();

    (void)c;
    if (m->type == MSG_PONG)
        return; /* a sign of life: nothing else is in it */
    s->ops->message(s->arg, l->id, m);
    shell_run(s);
    if (s->turns)
        turns_note(s->turns, msg_name(m->type), uv_hrtime() - since_ns);
}

static void
on_closed(void *arg, struct conn *c, const char *why)
{
    struct shell_link *l = arg;
    struct shell *s = l->shell;

    (void)c;
    move_gone(find(s, l->id), why);
    shell_run(s);
}

static void
on_written(void *arg, struct conn *c, size_t n)
{
    struct shell_link *l = arg;
    struct shell *s = l->shell;
    struct msg_ping ping = { 0 };

    if (s->ops->ping) {
        s->ops->ping(s->arg, &ping);
        conn_set_ping(c, &ping);
    }
    s->ops->written(s->arg, l->id, n);
    shell_run(s);
}

void
shell_init(struct shell *s, struct daemon *daemon, const struct shell_ops *ops,
           void *arg)
{
    memset(s, 0, sizeof *s);
    s->daemon = daemon;
    s->ops = ops;
    s->arg = arg;
    s->handler = (struct conn_handler){ .message = on_message,
                                        .closed = on_closed,
                                        .written = on_written,
                                        .errors = &s->errors };
}

uint64_t
shell_new_id(struct shell *s)
{
    return ++s->next_id;
}

bool
shell_add(struct shell *s, uint64_t id, uv_stream_t *stream, struct tls *tls,
          enum msg_session session, const char *peer)
{
    struct shell_link *l = calloc(1, sizeof *l);

    if (!l) {
        tls_free(tls);
        conn_stream_close(stream);
        return false;
    }
    l->shell = s;
    l->id = id;
    l->conn = conn_new(stream, tls, session, peer, &s->handler, l);
    if (!l->conn) {
        free(l);
        return false;
    }
    l->next = s->links[id % SHELL_BUCKETS];
    s->links[id % SHELL_BUCKETS] = l;
    return true;
}

struct conn *
shell_conn(const struct shell *s, uint64_t id)
{
    struct shell_link *l = *find(s, id);

    return l ? l->conn : NULL;
}

void
shell_gone(struct shell *s, uint64_t id, const char *why)
{
    struct shell_link *l = calloc(1, sizeof *l);

    if (!l)
        log_out_of_memory(); /* the machine would wait for ever */
    l->shell = s;
    l->id = id;
    snprintf(l->why, sizeof l->why, "%s", why);
    l->next = s->gone;
    s->gone = l;
    shell_run(s);
}

void
shell_remove(struct shell *s, uint64_t id)
{
    struct shell_link **at = find(s, id), *l = *at;

    if (!l)
        return;
    *at = l->next;
    conn_close(l->conn);
    free(l);
}

void
shell_drop_keys(struct shell *s, shell_key_fn *why, void *arg)
{
    for (int i = 0; i < SHELL_BUCKETS; i++)
        for (struct shell_link **at = &s->links[i]; *at;) {
            struct conn *c = (*at)->conn;
            const char *key = conn_key(c), *text = key ? why(arg, key) : NULL;

            if (text) {
                log_warn("connection closed peer=%s key=%s: %s", conn_peer(c),
                         key, text);
                conn_close(c);
                move_gone(at, text);
            } else {
                at = &(*at)->next;
            }
        }
    shell_run(s);
}

static void
pause_for_store(struct shell *s, uint64_t id)
{
    struct shell_link *l = *find(s, id);

    if (!l || !s->store || store_backlog(s->store) < STORE_HIGH)
        return;
    l->paused = true;
    conn_pause(l->conn, true);
}

void
shell_store_progress(struct shell *s)
{
    if (!s->store || store_backlog(s->store) > STORE_LOW)
        return;
    for (int i = 0; i < SHELL_BUCKETS; i++)
        for (struct shell_link *l = s->links[i]; l; l = l->next)
            if (l->paused) {
                l->paused = false;
                conn_pause(l->conn, false);
            }
}

/* Set a connection's session.  It decides whether the other end is asked for
 * signs of life: a child is not, for it may be busy loading. */
static void
set_session(struct conn *c, enum msg_session session, unsigned version)
{
    conn_set_session(c, session);
    conn_set_version(c, version);
    switch (session) {
    case MSG_AT_COORD_WORKER:
    case MSG_AT_COORD_USER:
    case MSG_AT_COORD_ADMIN:
    case MSG_AT_COORD_OBSERVER:
    case MSG_AT_WORKER:
    case MSG_AT_PEER:
        conn_live(c, true);
        break;
    case MSG_AT_PARENT_NEW:
    case MSG_AT_PARENT:
        conn_live(c, false);
        break;
    default:
        break;
    }
}

static void
log_action(const struct action *a)
{
    static const enum log_level level[] = { [ACT_ERR] = LOG_LEVEL_ERR,
                                            [ACT_WARN] = LOG_LEVEL_WARN,
                                            [ACT_INFO] = LOG_LEVEL_INFO,
                                            [ACT_DEBUG] = LOG_LEVEL_DEBUG };

    log_at(level[a->level], "%s", a->text);
}

static void
carry_out(struct shell *s, const struct action *a)
{
    struct shell_link **at = find(s, a->conn), *l = *at;

    switch (a->type) {
    case ACT_SEND:
        if (l)
            conn_send_frame(l->conn, a->bytes, a->len);
        break;
    case ACT_SESSION:
        if (l)
            set_session(l->conn, a->session, a->version);
        break;
    case ACT_CLOSE:
        if (l) {
            conn_finish(l->conn);
            move_gone(at, "closed");
        }
        break;
    case ACT_LOG:
        log_action(a);
        break;
    case ACT_PUT_CHUNK:
        store_put_chunk(s->store, a->conn, &a->chunk);
        pause_for_store(s, a->conn);
        break;
    case ACT_PUT_ROWS:
        store_put_rows(s->store, &a->rows);
        pause_for_store(s, a->conn);
        break;
    default:
        s->ops->action(s->arg, a);
        break;
    }
}

/* Tell the machine of the first ended connection. */
static void
tell_gone(struct shell *s)
{
    struct shell_link *l = s->gone;

    s->gone = l->next;
    if (s->store)
        store_drop_conn(s->store, l->id);
    s->ops->closed(s->arg, l->id, l->why);
    free(l);
}

void
shell_run(struct shell *s)
{
    struct action_list *list = s->actions;

    if (s->running)
        return;
    s->running = true;
    for (;;) {
        for (size_t i = 0; i < list->n && !list->failed; i++) {
            const struct action a = list->v[i]; /* a copy: the list may grow */

            carry_out(s, &a);
        }
        if (list->failed) /* an action is missing, and others stand on it */
            log_out_of_memory();
        actions_clear(list);
        if (!s->gone)
            break;
        tell_gone(s);
    }
    s->running = false;
}

void
shell_close(struct shell *s)
{
    struct shell_link *l;

    for (int i = 0; i < SHELL_BUCKETS; i++)
        while ((l = s->links[i]) != NULL) {
            s->links[i] = l->next;
            conn_close(l->conn);
            free(l);
        }
    while ((l = s->gone) != NULL) {
        s->gone = l->next;
        free(l);
    }
}

void
shell_random(void *arg, void *buf, size_t n)
{
    char *p = buf;

    (void)arg;
    while (n > 0) {
        ssize_t got = getrandom(p, n, 0);

        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            abort(); /* the kernel has no random bytes: nothing is safe */
        p += got;
        n -= (size_t)got;
    }
}
