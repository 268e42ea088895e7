/* store_arrive.c - files that connections send to the store
 *
 * A file that is not yet whole is found by its connection and its hash: two
 * connections may send the same one at a time, and neither has to know of the
 * other, for a file gets its name only when it is whole and right (blobs.h).
 * The list is the pool thread's.  The loop only pushes tasks, and so the end
 * of a connection is one too, behind the chunks that came before it. */
#include "config.h"

#include "store_impl.h"

#include <stdlib.h>
#include <string.h>

/* A file that a connection sends. */
struct arriving {
    struct arriving *next;
    uint64_t conn;
    uint8_t hash[MSG_HASH];
    struct blob_part part;
};

struct chunk_task {
    struct task task;
    struct store *store;
    uint64_t conn, offset, total;
    uint8_t hash[MSG_HASH];
    size_t len;
    uint8_t data[];
};

static struct arriving **
find_arriving(struct store *s, uint64_t conn, const uint8_t *hash)
{
    struct arriving **at = &s->arriving;

    while (*at && ((*at)->conn != conn ||
                   (hash && memcmp((*at)->hash, hash, MSG_HASH) != 0)))
        at = &(*at)->next;
    return at;
}

static void
end_arriving(struct arriving **at)
{
    struct arriving *a = *at;

    *at = a->next;
    blob_part_abort(&a->part);
    free(a);
}

static int
begin_arriving(struct store *s, const struct chunk_task *c,
               struct rad_error *err)
{
    struct arriving *a = calloc(1, sizeof *a);
    char name[RAD_SHA_HEX + 1];
    int rc;

    if (!a)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    rad_sha_to_hex(c->hash, name);
    rc = blob_part_open(&a->part, &s->blobs, name, c->total, err);
    if (rc < 0) {
        free(a);
        return rc;
    }
    a->conn = c->conn;
    memcpy(a->hash, c->hash, MSG_HASH);
    a->next = s->arriving;
    s->arriving = a;
    return 0;
}

static int
chunk_run(struct task *t)
{
    struct chunk_task *c = (struct chunk_task *)t;
    struct arriving **at;
    int rc;

    if (c->offset == 0 && !*find_arriving(c->store, c->conn, c->hash)) {
        rc = begin_arriving(c->store, c, &t->err);
        if (rc < 0)
            return rc;
    }
    at = find_arriving(c->store, c->conn, c->hash);
    if (!*at)
        return rad_fail(&t->err, RAD_EPROTO, "a file that did not begin at 0");
    if ((*at)->part.total != c->total)
        rc = rad_fail(&t->err, RAD_EPROTO, "a file that changed its length");
    else
        rc = blob_part_write(&(*at)->part, c->offset, c->data, c->len, &t->err);
    if (rc != 0 && rc != RAD_EFULL)
        end_arriving(at);
    return rc;
}

static void
note_file(struct store *s, const uint8_t *hash)
{
    char path[BLOBS_PATH_MAX];

    path_of(s, hash, path);
    sounds_note(&s->sounds, hash, path);
}

static void
chunk_done(struct task *t)
{
    struct chunk_task *c = (struct chunk_task *)t;
    struct store *s = c->store;

    s->backlog -= c->len;
    if (t->code > 0)
        note_file(s, c->hash);
    if (t->code != 0 && !is_mute(s, t))
        s->handler->file(s->arg, c->conn, c->hash, status_of(t), failure(t));
    else if (t->code == 0 && s->handler->progress)
        s->handler->progress(s->arg);
    free(c);
}

void
store_put_chunk(struct store *s, uint64_t conn, const struct msg_chunk *chunk)
{
    struct chunk_task *c =
        store_new_task(s, sizeof *c + chunk->len, chunk_run, chunk_done);

    if (!c)
        return;
    c->task.writes = true;
    c->store = s;
    c->conn = conn;
    c->offset = chunk->offset;
    c->total = chunk->total;
    memcpy(c->hash, chunk->hash, MSG_HASH);
    c->len = chunk->len;
    if (chunk->len)
        memcpy(c->data, chunk->data, chunk->len);
    s->backlog += c->len;
    task_push(&s->queue, &c->task);
}

void
store_release_arriving(struct store *s)
{
    while (s->arriving)
        end_arriving(&s->arriving);
}

struct drop_task {
    struct task task;
    struct store *store;
    uint64_t conn;
};

static int
drop_run(struct task *t)
{
    struct drop_task *d = (struct drop_task *)t;
    struct arriving **at;

    while (*(at = find_arriving(d->store, d->conn, NULL)))
        end_arriving(at);
    return 0;
}

void
store_drop_conn(struct store *s, uint64_t conn)
{
    struct drop_task *d =
        store_new_task(s, sizeof *d, drop_run, store_free_task);

    if (!d)
        return;
    d->task.writes = true; /* after its chunks, which may be held */
    d->store = s;
    d->conn = conn;
    task_push(&s->queue, &d->task);
}
