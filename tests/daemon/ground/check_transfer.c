/* check_transfer.c - files of a store over a connection whose other end reads
 * when the test says so */
#include "config.h"

#include "shell/transfer.h"

#include "net/log.h"
#include "tests/scratch.h"

#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum {
    ID = 5,       /* of the connection */
    FILES = 8,    /* files of one piece each, more than are sent unread */
    LONG = FILES, /* a file of as many pieces as there are files */
    MISSING       /* no file */
};

static struct {
    uv_loop_t loop;
    struct store *store;
    struct transfers *transfers;
    struct conn *conn;
    int fd; /* its other end */
    struct frame_reader reader;
    int first[MISSING + 1], last[MISSING + 1]; /* pieces that came, by file */
    int empty[MISSING + 1];
} f;

static void
on_message(void *arg, struct conn *c, const struct msg *m)
{
    (void)arg;
    (void)c;
    (void)m;
}

static void
on_closed(void *arg, struct conn *c, const char *why)
{
    (void)arg;
    (void)c;
    ck_abort_msg("closed: %s", why);
}

static void
on_written(void *arg, struct conn *c, size_t n)
{
    (void)arg;
    (void)c;
    (void)n;
    transfers_resume(f.transfers, ID);
}

static const struct conn_handler conn_handler = { .message = on_message,
                                                  .closed = on_closed,
                                                  .written = on_written };
static const struct store_handler store_handler = { 0 };

/* Make an empty file; returns its path. */
static const char *
make_empty(uint8_t number)
{
    uint8_t hash[MSG_HASH] = { number };
    char name[6 + RAD_SHA_HEX + 1] = "files/";

    rad_sha_to_hex(hash, name + 6);
    return scratch_file(name, "");
}

static void
make_file(uint8_t number, size_t pieces)
{
    const char *path = make_empty(number);

    ck_assert_int_eq(truncate(path, (off_t)(pieces * MSG_MAX_CHUNK)), 0);
}

static void
set_up(void)
{
    uv_stream_t *stream;
    int fds[2];

    scratch_make();
    memset(&f, 0, sizeof f);
    log_set_level(LOG_LEVEL_ERR);
    uv_loop_init(&f.loop);
    f.store = store_open(&f.loop, dir, false, &store_handler, NULL, NULL);
    f.transfers = transfers_new(f.store, NULL, NULL);
    for (uint8_t i = 0; i < FILES; i++)
        make_file(i, 1);
    make_file(LONG, FILES);
    ck_assert_int_eq(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, fds),
                     0);
    stream = conn_stream_new(&f.loop, true);
    ck_assert_int_eq(uv_pipe_open((uv_pipe_t *)stream, fds[0]), 0);
    f.fd = fds[1];
    f.conn = conn_new(stream, NULL, MSG_AT_COORD_WORKER, "test", &conn_handler,
                      NULL);
    ck_assert_ptr_nonnull(f.conn);
    frame_reader_init(&f.reader, MSG_AT_WORKER);
}

static void
tear_down(void)
{
    transfers_drop(f.transfers, ID);
    conn_close(f.conn);
    close(f.fd);
    while (!store_idle(f.store))
        uv_run(&f.loop, UV_RUN_ONCE);
    transfers_free(f.transfers);
    store_close(f.store);
    uv_run(&f.loop, UV_RUN_DEFAULT);
    ck_assert_int_eq(uv_loop_close(&f.loop), 0);
    frame_reader_release(&f.reader);
    scratch_remove();
}

FIXTURE(set_up, tear_down)

static void
start(uint8_t file)
{
    const struct store_source from = { .file = true, .hash = { file } };

    transfers_start(f.transfers, ID, f.conn, 0, &from);
}

static void
start_all(void)
{
    for (uint8_t i = 0; i < FILES; i++)
        start(i);
}

static void
note(const struct msg *m)
{
    const struct msg_chunk *c = &m->chunk;

    ck_assert_int_eq(m->type, MSG_CHUNK);
    f.first[c->hash[0]] += c->offset == 0;
    f.empty[c->hash[0]] += c->total == 0;
    f.last[c->hash[0]] += c->offset + c->len == c->total;
}

/* Read what has come; false: nothing has. */
static bool
read_some(void)
{
    static uint8_t buf[1 << 16];
    ssize_t got = read(f.fd, buf, sizeof buf);
    const uint8_t *at = buf;
    size_t n = got > 0 ? (size_t)got : 0;
    struct msg m = { 0 };

    while (n > 0) {
        int rc = frame_read(&f.reader, &at, &n, &m, NULL);

        ck_assert_int_ge(rc, 0);
        if (rc == 1) {
            note(&m);
            msg_release(&m);
        }
    }
    return got > 0;
}

/* Go on until nothing happens any more. */
static void
settle(bool reading)
{
    for (int still = 0; still < 10; still++) {
        while (!store_idle(f.store))
            uv_run(&f.loop, UV_RUN_ONCE);
        uv_run(&f.loop, UV_RUN_NOWAIT);
        if ((reading && read_some()) || !store_idle(f.store))
            still = 0;
    }
}

/* As the files of a job that ended and of a job after it on the same scene. */
TEST(a_file_that_waits_is_sent_once_however_often_it_is_asked_for)
{
    start_all();
    settle(false);
    start_all();
    settle(true);
    ck_assert_int_eq(f.first[FILES - 1], 1);
    for (int i = 0; i < FILES; i++)
        ck_assert_int_ge(f.first[i], 1);
}

/* Its receiver may have given up the beginning, for want of room. */
TEST(a_file_that_has_begun_is_sent_again_from_its_beginning)
{
    start(LONG);
    settle(false);
    start(LONG);
    settle(true);
    ck_assert_int_eq(f.first[LONG], 2);
}

TEST(files_that_have_not_begun_are_dropped)
{
    start_all();
    settle(false);
    transfers_drop_files(f.transfers, ID);
    settle(true);
    ck_assert_int_eq(f.first[0], 1);
    ck_assert_int_eq(f.first[FILES - 1], 0);
    start(FILES - 1);
    settle(true);
    ck_assert_int_eq(f.first[FILES - 1], 1);
}

TEST(files_of_another_connection_are_not_dropped)
{
    start_all();
    settle(false);
    transfers_drop_files(f.transfers, ID + 1);
    settle(true);
    ck_assert_int_eq(f.first[FILES - 1], 1);
}

TEST(a_file_that_has_begun_is_sent_to_its_end)
{
    start(LONG);
    settle(false);
    transfers_drop_files(f.transfers, ID);
    settle(true);
    ck_assert_int_eq(f.first[LONG], 1);
    ck_assert_int_eq(f.last[LONG], 1);
}

/* No worker may get FAILED; it finds that an empty file has another hash. */
TEST(a_file_that_is_missing_comes_as_an_empty_one)
{
    start(MISSING);
    start(0);
    settle(true);
    ck_assert_int_eq(f.empty[MISSING], 1);
    ck_assert_int_eq(f.last[0], 1);
    ck_assert_int_eq(f.empty[0], 0);
}

TEST(a_file_that_is_removed_meanwhile_is_empty_at_last)
{
    start(LONG);
    settle(false);
    ck_assert_int_eq(unlink(make_empty(LONG)), 0);
    start(0);
    settle(true);
    ck_assert_int_eq(f.empty[LONG], 1);
    ck_assert_int_eq(f.first[LONG], 2);
    ck_assert_int_eq(f.last[0], 1);
}

/* The store reads on when its daemon or, in the second row, a connection ends.
 */
LOOP_TEST(a_file_that_is_read_when_all_ends_is_sent_to_nobody, 2)
{
    start(LONG);
    start(0);
    if (_i == 0)
        transfers_drop_all(f.transfers);
    else
        transfers_drop(f.transfers, ID);
    conn_close(f.conn);
    f.conn = NULL;
    settle(true);
    ck_assert_int_eq(f.first[LONG] + f.first[0], 0);
}

/* The sizes leave none, some and all of the bytes that were sent. */
LOOP_TEST(a_file_that_shrinks_meanwhile_is_empty_at_last, 4)
{
    static const off_t to[] = { 0, MSG_MAX_CHUNK, 2 * MSG_MAX_CHUNK,
                                3 * MSG_MAX_CHUNK };
    char path[sizeof dir + 6 + RAD_SHA_HEX + 2];
    uint8_t hash[MSG_HASH] = { LONG };

    snprintf(path, sizeof path, "%s/files/", dir);
    rad_sha_to_hex(hash, path + strlen(path));
    start(LONG);
    settle(false);
    ck_assert_int_eq(truncate(path, to[_i]), 0);
    settle(true);
    ck_assert_int_eq(f.empty[LONG], 1);
    start(0);
    settle(true);
    ck_assert_int_eq(f.last[0], 1);
}
