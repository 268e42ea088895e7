/* store_arrive.c - files that connections send to the store
 *
 * An incomplete file is identified by its connection and its hash.  Two
 * connections may send the same file at a time without harm, for a file gets
 * its name only when it is complete and has the right hash (blobs.h).
 * The list of arriving files belongs to the pool thread; the loop only pushes
 * tasks.  So the end of a connection is a task, too, behind the tasks of the
 * chunks that came before it.
 *
 * On a coordinator's full disk a small file waits, and with it all tasks that
 * write.  A file that is larger than the room that the disk keeps for others is
 * refused instead: at its first piece or, if other files took the room, at a
 * later piece.  Its sender can try again, and no task waits for the file. */
#include "config.h"

#include "store/store_impl.h"

#include "folder/room.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* Files that one connection may send at a time: radsubmit sends one. */
#define MOST_ARRIVING 64

/* A file that a connection sends. */
struct arriving {
    struct arriving *next;
    uint64_t conn;
    uint8_t hash[MSG_HASH];
    struct blob_part part;
};

/* Bytes that have not come yet of files that are arriving. */
static uint64_t
bytes_to_come(const struct store *s)
{
    uint64_t n = 0;

    for (const struct arriving *a = s->arriving; a; a = a->next)
        n += a->part.total - a->part.got;
    return n;
}

struct chunk_task {
    struct task task;
    uint64_t conn, offset, total;
    uint8_t hash[MSG_HASH];
    bool whole; /* the file has its name */
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

static int
count_arriving(const struct store *s, uint64_t conn)
{
    int n = 0;

    for (const struct arriving *a = s->arriving; a; a = a->next)
        n += a->conn == conn;
    return n;
}

static void
end_arriving(struct store *s, struct arriving **at, bool whole)
{
    struct arriving *a = *at;

    *at = a->next;
    if (s->cache && whole)
        cache_arrived(s->cache, a->hash, a->part.total);
    else if (s->cache)
        cache_given_up(s->cache, a->part.total);
    blobs_part_abort(&a->part);
    free(a);
}

static int
refuse_file(uint64_t total, const char *why, struct rad_error *err)
{
    return rad_fail(err, RAD_ETEMPFAIL,
                    "no room on the coordinator's disk for a file of %" PRIu64
                    " KiB of the scene: %.120s; try again when there is more",
                    total >> 10, why);
}

/* At a coordinator: is there room for all of a file that begins to arrive, and
 * for the rest of the files that are arriving?  A small file may be tried
 * without that. */
static int
check_room(const struct store *s, uint64_t total, struct rad_error *err)
{
    static const char what[] = "the scene's files";
    const char *dir = s->blobs.dir;
    uint64_t others = bytes_to_come(s);
    struct rad_error why = { 0 };

    if (!s->journal || room_is_small(dir, total))
        return 0;
    if (room_check(dir, total, what, &why) == RAD_EDATA)
        return rad_fail(err, RAD_EDATA, "%s", why.what);
    if (why.code == 0 && total <= UINT64_MAX - others)
        room_check(dir, total + others, what, &why);
    return why.code < 0 ? refuse_file(total, why.what, err) : 0;
}

static int
begin_arriving(struct store *s, const struct chunk_task *c,
               struct rad_error *err)
{
    struct arriving *a;
    char name[RAD_SHA_HEX + 1];
    int rc;

    if (count_arriving(s, c->conn) >= MOST_ARRIVING)
        return rad_fail(err, RAD_ETEMPFAIL, "more than %d files at a time",
                        MOST_ARRIVING);
    rc = check_room(s, c->total, err);
    if (rc < 0)
        return rc;
    a = calloc(1, sizeof *a);
    if (!a)
        return rad_fail_memory(err);
    rad_sha_to_hex(c->hash, name);
    rc = blobs_part_open(&a->part, &s->blobs, name, c->total, err);
    if (rc == 0 && s->cache)
        rc = cache_expect(s->cache, c->total, err);
    if (rc < 0) {
        blobs_part_abort(&a->part);
        free(a);
        return rc;
    }
    a->conn = c->conn;
    memcpy(a->hash, c->hash, MSG_HASH);
    a->next = s->arriving;
    s->arriving = a;
    return 0;
}

/* Will the task run again after this failure?  A coordinator's task does while
 * the disk is full.  A worker gives the file up, for it takes no job without
 * having room for its files. */
static bool
is_tried_again(const struct store *s, int rc)
{
    return rc == RAD_ESHORT || (rc == RAD_EFULL && s->journal);
}

/* When a large file finds no room any more, refuse it, so that its bytes are
 * freed. */
static int
fail_if_large(const struct store *s, const struct arriving *a, int rc,
              struct rad_error *err)
{
    struct rad_error why = *err;

    if (rc != RAD_EFULL || !s->journal ||
        room_is_small(s->blobs.dir, a->part.total))
        return rc;
    memset(err, 0, sizeof *err);
    return refuse_file(a->part.total, why.what, err);
}

/* The file is whole.  Let a coordinator's last: it is synced with all else that
 * the disk gets now, before the sender hears of it. */
static int
keep_file(struct chunk_task *c)
{
    struct store *s = store_of(&c->task);
    char path[BLOBS_PATH_MAX];
    int rc;

    if (!s->journal)
        return 1;
    c->whole = c->task.lasts = c->task.awaited = true;
    path_of(s, c->hash, path);
    rc = syncs_add(&s->folder.opened.closed, path, true, &c->task.err);
    return rc < 0 ? rc : 1;
}

static int
chunk_run(struct task *t)
{
    struct chunk_task *c = (struct chunk_task *)t;
    struct store *s = store_of(t);
    struct arriving **at = find_arriving(s, c->conn, c->hash);
    int rc;

    if (c->whole) /* the task runs again: it could not be settled */
        return keep_file(c);
    /* a sender that cannot read the file to its end sends an empty one */
    if (c->offset == 0 && c->total == 0 && *at && (*at)->part.total > 0)
        end_arriving(s, at, false);
    if (c->offset == 0 && !*find_arriving(s, c->conn, c->hash)) {
        rc = begin_arriving(s, c, &t->err);
        if (rc < 0)
            return rc;
    }
    at = find_arriving(s, c->conn, c->hash);
    if (!*at)
        return rad_fail(&t->err, RAD_EPROTO, "a file that did not begin at 0");
    if ((*at)->part.total != c->total)
        rc = rad_fail(&t->err, RAD_EPROTO, "a file that changed its length");
    else
        rc = fail_if_large(
            s, *at,
            blobs_part_write(&(*at)->part, c->offset, c->data, c->len, &t->err),
            &t->err);
    if (rc != 0 && !is_tried_again(s, rc))
        end_arriving(s, at, rc > 0);
    return rc > 0 ? keep_file(c) : rc;
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
    struct store *s = store_of(t);

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

    c->task.writes = true;
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
        end_arriving(s, &s->arriving, false);
}

struct drop_task {
    struct task task;
    uint64_t conn;
};

static int
drop_run(struct task *t)
{
    struct drop_task *d = (struct drop_task *)t;
    struct store *s = store_of(t);
    struct arriving **at;

    while (*(at = find_arriving(s, d->conn, NULL)))
        end_arriving(s, at, false);
    return 0;
}

void
store_drop_conn(struct store *s, uint64_t conn)
{
    struct drop_task *d =
        store_new_task(s, sizeof *d, drop_run, store_free_task);

    d->task.writes = true; /* so that it runs after the connection's chunks,
                            * which may be held */
    d->conn = conn;
    task_push(&s->queue, &d->task);
}
