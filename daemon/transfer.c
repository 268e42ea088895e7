/* transfer.c - see transfer.h */
#include "config.h"

#include "transfer.h"

#include "log.h"

#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

/* a connection with more than this waiting gets no new piece */
#define AHEAD (2 * (size_t)MSG_MAX_CHUNK)

struct transfer {
    struct transfer *next;
    struct transfers *all;
    uint64_t id;
    struct conn *conn; /* NULL: it is gone */
    uint32_t request;
    struct store_source from;
    uint64_t offset;
    bool reading, ended;
    uint8_t *buf; /* MSG_MAX_CHUNK bytes, once it is its turn */
};

struct transfers {
    struct store *store;
    struct transfer *list;
};

struct transfers *
transfers_new(struct store *store)
{
    struct transfers *t = calloc(1, sizeof *t);

    if (t)
        t->store = store;
    return t;
}

/* Drop those that ended and that the pool does not write into. */
static void
sweep(struct transfers *all)
{
    struct transfer **at = &all->list;

    while (*at) {
        struct transfer *t = *at;

        if (t->ended && !t->reading) {
            *at = t->next;
            free(t->buf);
            free(t);
        } else {
            at = &t->next;
        }
    }
}

void
transfers_free(struct transfers *t)
{
    if (!t)
        return;
    for (struct transfer *x = t->list; x; x = x->next)
        x->ended = true;
    sweep(t);
    free(t);
}

static void
send_failed(struct transfer *t, const char *text)
{
    static const uint8_t no_job[MSG_JOB];
    struct msg m = { .type = MSG_FAILED, .request = t->request };

    m.failed.job = t->from.file ? no_job : t->from.job;
    m.failed.status = EX_NOINPUT;
    m.failed.text = text;
    conn_send(t->conn, &m);
}

static void on_read(void *arg, ssize_t n, uint64_t size, const char *text);

/* Start the next read of the oldest transfer of a connection, if it is due. */
static void
go_on(struct transfers *all, uint64_t id)
{
    struct transfer *t = all->list;

    while (t && (t->id != id || t->ended))
        t = t->next;
    if (!t || t->reading || conn_queued(t->conn) > AHEAD)
        return;
    if (!t->buf)
        t->buf = malloc(MSG_MAX_CHUNK);
    if (!t->buf) {
        t->ended = true;
        conn_break(t->conn, "out of memory"); /* who waits for it calls again */
        return;
    }
    t->reading = true;
    store_read(all->store, &t->from, t->offset, t->buf, MSG_MAX_CHUNK, on_read,
               t);
}

static void
send_piece(struct transfer *t, size_t n, uint64_t size)
{
    static const uint8_t no_hash[MSG_HASH];
    struct msg m = { .type = MSG_CHUNK, .request = t->request };

    m.chunk.hash = t->from.file ? t->from.hash : no_hash;
    m.chunk.offset = t->offset;
    m.chunk.total = size;
    m.chunk.data = t->buf;
    m.chunk.len = n;
    t->offset += n;
    t->ended = t->offset >= size;
    conn_send(t->conn, &m);
}

static void
on_read(void *arg, ssize_t n, uint64_t size, const char *text)
{
    struct transfer *t = arg;
    struct transfers *all = t->all;
    uint64_t id = t->id;

    /* while t->reading is set, a connection that breaks now leaves t alone */
    if (t->ended) {
        /* the connection went meanwhile */
    } else if (n < 0 || (n == 0 && t->offset < size)) {
        log_warn("transfer failed peer=%s: %s", conn_peer(t->conn),
                 n < 0 ? text : "the file became shorter");
        t->ended = true;
        send_failed(t, n < 0 ? text : "the file became shorter");
    } else {
        send_piece(t, (size_t)n, size);
    }
    t->reading = false;
    sweep(all);
    go_on(all, id);
}

void
transfers_start(struct transfers *t, uint64_t id, struct conn *c,
                uint32_t request, const struct store_source *from)
{
    struct transfer *x = calloc(1, sizeof *x), **at = &t->list;

    if (!x) {
        conn_break(c, "out of memory"); /* who waits for it calls again */
        return;
    }
    x->all = t;
    x->id = id;
    x->conn = c;
    x->request = request;
    x->from = *from;
    while (*at)
        at = &(*at)->next;
    *at = x;
    go_on(t, id);
}

void
transfers_resume(struct transfers *t, uint64_t id)
{
    go_on(t, id);
}

void
transfers_drop(struct transfers *t, uint64_t id)
{
    for (struct transfer *x = t->list; x; x = x->next)
        if (x->id == id) {
            x->conn = NULL;
            x->ended = true;
        }
    sweep(t);
}
