/* transfer.c - see transfer.h */
#include "config.h"

#include "shell/transfer.h"

#include "net/log.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* A connection with more bytes waiting to be sent gets no new piece. */
#define AHEAD (2 * (size_t)MSG_MAX_CHUNK)

struct transfer {
    struct transfer *next;
    struct transfers *all;
    uint64_t id;
    struct conn *conn; /* NULL: the connection is gone */
    uint32_t request;
    struct store_reading source;
    bool reading, ended;
    uint8_t *buf; /* MSG_MAX_CHUNK bytes, while reading */
};

struct transfers {
    struct store *store;
    struct transfer *list;
    transfer_done_fn *done;
    void *arg;
};

struct transfers *
transfers_new(struct store *store, transfer_done_fn *done, void *arg)
{
    struct transfers *t = calloc(1, sizeof *t);

    if (!t)
        return NULL;
    t->store = store;
    t->done = done;
    t->arg = arg;
    return t;
}

/* Free the transfers that ended, unless the store still reads for them. */
static void
sweep(struct transfers *all)
{
    struct transfer **at = &all->list;

    while (*at) {
        struct transfer *t = *at;

        if (t->ended && !t->reading) {
            *at = t->next;
            store_reading_release(&t->source);
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
    assert(!t->list);
    free(t);
}

/* Send a worker an empty file in place of a file that cannot be read.  No
 * worker may get FAILED, and every other answer would be new to it; an empty
 * file has another hash, so the worker reports the job's child as lost, as it
 * does when the coordinator's disk has spoilt the file. */
static void
send_empty(struct transfer *t)
{
    struct msg m = { .type = MSG_CHUNK, .request = t->request };

    m.chunk.hash = t->source.from.hash;
    conn_send(t->conn, &m);
}

static void
send_failed(struct transfer *t, int status, const char *text)
{
    struct msg m = { .type = MSG_FAILED, .request = t->request };

    m.failed.job = t->source.from.job;
    m.failed.status = (uint16_t)status;
    m.failed.text = text;
    conn_send(t->conn, &m);
}

bool
transfers_have_room(const struct conn *c)
{
    return conn_queued(c) <= AHEAD && !conn_full(c);
}

static void on_read(void *arg, ssize_t n, uint64_t size, int status,
                    const char *text);

/* Start the next read for the oldest transfer of a connection, if it is due.
 * False: there is no memory, and the connection ends. */
static bool
go_on(struct transfers *all, uint64_t id)
{
    struct transfer *t = all->list;

    while (t && (t->id != id || t->ended))
        t = t->next;
    if (!t || t->reading || !transfers_have_room(t->conn) ||
        !conn_expect(t->conn, MSG_MAX_CHUNK))
        return true;
    t->buf = malloc(MSG_MAX_CHUNK);
    if (!t->buf) {
        t->ended = true;
        conn_break(t->conn, "out of memory"); /* the other end dials again */
        return false;
    }
    t->reading = true;
    store_read(all->store, &t->source, t->buf, MSG_MAX_CHUNK, on_read, t);
    return true;
}

static void
send_piece(struct transfer *t, size_t n, uint64_t size)
{
    static const uint8_t no_hash[MSG_HASH];
    struct msg m = { .type = MSG_CHUNK, .request = t->request };

    m.chunk.hash = t->source.from.file ? t->source.from.hash : no_hash;
    m.chunk.offset = t->source.offset - n;
    m.chunk.total = size;
    m.chunk.data = t->buf;
    m.chunk.len = n;
    t->ended = t->source.offset >= size;
    conn_send(t->conn, &m);
}

static void
on_read(void *arg, ssize_t n, uint64_t size, int status, const char *text)
{
    struct transfer *t = arg;
    struct transfers *all = t->all;
    uint64_t id = t->id;

    /* while t->reading is set, a connection that breaks now leaves t alone */
    if (t->conn)
        conn_expected(t->conn, MSG_MAX_CHUNK);
    if (t->ended) {
        /* the connection has gone meanwhile */
    } else if (n < 0) {
        log_warn("transfer failed peer=%s: %s", conn_peer(t->conn), text);
        t->ended = true;
        if (t->source.from.file)
            send_empty(t);
        else
            send_failed(t, status, text);
    } else {
        send_piece(t, (size_t)n, size);
    }
    t->reading = false;
    free(t->buf);
    if (t->ended && t->conn && all->done)
        all->done(all->arg, id, n < 0 ? NULL : &t->source.from);
    sweep(all);
    go_on(all, id);
}

/* Is this a scene's file of which no byte is sent yet? */
static bool
is_file_to_come(const struct transfer *t)
{
    return t->source.from.file && t->source.offset == 0 && !t->ended;
}

/* Is all of that file going to be sent over the connection anyway?  If some of
 * it has been sent it is not, for a worker may have given up the beginning. */
static bool
is_to_come(const struct transfers *all, uint64_t id,
           const struct store_source *from)
{
    const struct transfer *t = all->list;

    while (t && (t->id != id || !is_file_to_come(t) ||
                 memcmp(t->source.from.hash, from->hash, MSG_HASH) != 0))
        t = t->next;
    return from->file && t;
}

void
transfers_start(struct transfers *t, uint64_t id, struct conn *c,
                uint32_t request, const struct store_source *from)
{
    struct transfer *x, **at = &t->list;

    if (is_to_come(t, id, from))
        return;
    x = calloc(1, sizeof *x);
    if (!x) {
        conn_break(c, "out of memory"); /* the other end dials again */
        return;
    }
    x->all = t;
    x->id = id;
    x->conn = c;
    x->request = request;
    x->source.from = *from;
    while (*at)
        at = &(*at)->next;
    *at = x;
    go_on(t, id);
}

void
transfers_of_jobs(const struct transfers *t,
                  void (*fn)(void *with, const uint8_t job[MSG_JOB]),
                  void *with)
{
    for (const struct transfer *x = t->list; x; x = x->next)
        if (!x->ended && !x->source.from.file)
            fn(with, x->source.from.job);
}

void
transfers_resume(struct transfers *t, uint64_t id)
{
    go_on(t, id);
}

void
transfers_tick(struct transfers *t)
{
    for (struct transfer *x = t->list; x; x = x->next)
        if (!x->ended && !x->reading && !go_on(t, x->id))
            return; /* the connection broke and x left the list */
}

void
transfers_drop_files(struct transfers *t, uint64_t id)
{
    for (struct transfer *x = t->list; x; x = x->next)
        if (x->id == id && is_file_to_come(x) && !x->reading)
            x->ended = true;
    sweep(t);
}

static void
drop(struct transfer *x)
{
    x->conn = NULL;
    x->ended = true;
}

void
transfers_drop(struct transfers *t, uint64_t id)
{
    for (struct transfer *x = t->list; x; x = x->next)
        if (x->id == id)
            drop(x);
    sweep(t);
}

void
transfers_drop_all(struct transfers *t)
{
    for (struct transfer *x = t->list; x; x = x->next)
        drop(x);
    sweep(t);
}
