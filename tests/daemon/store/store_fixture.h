/* store_fixture.h - a store in a folder of the test's own, and what it answers
 *
 * All is static: each test program has its own. */
#ifndef RADD_TESTS_STORE_FIXTURE_H
#define RADD_TESTS_STORE_FIXTURE_H

#include "rows_fixture.h"
#include "tests/scratch.h"
#include "store/store_read.h"

#include <string.h>
#include <unistd.h>

static inline void
hash_of(const void *data, size_t n, char hex[RAD_SHA_HEX + 1])
{
    ck_assert_int_eq(rad_sha_hex(data, n, hex, NULL), 0);
}

struct heard {
    int files, jobs, rows, pictures, status;
    char text[160]; /* about the last file */
    uint64_t sequence;
    int chunks; /* written, of files not yet whole */
    uint32_t unit;
    ssize_t n;
    int read_status;
    uint64_t size, cache_size;
    int broken, filed, waits;
    uint32_t settled, looked;
    bool full;
};

static uv_loop_t loop;
static struct store *store;
static struct heard heard; /* by the handler below */

static inline void
on_file(void *arg, uint64_t conn, const uint8_t hash[MSG_HASH], int status,
        const char *text)
{
    struct heard *h = arg;

    (void)hash;
    ck_assert_uint_eq(conn, 5);
    h->files++;
    h->status = status;
    snprintf(h->text, sizeof h->text, "%s", text);
}

static inline void
on_job(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence, int status,
       const char *text)
{
    struct heard *h = arg;

    (void)job;
    h->sequence = sequence;
    ck_assert_msg(status == 0, "%s", text);
    h->jobs++;
}

static inline void
on_rows(void *arg, const struct action_rows *key, int status, const char *text)
{
    struct heard *h = arg;

    (void)text;
    h->rows++;
    h->unit = key->unit;
    h->status = status;
}

static inline void
on_picture(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
           uint32_t frame, int status, const char *text)
{
    struct heard *h = arg;

    (void)job;
    ck_assert_uint_eq(sequence, 5);
    (void)frame;
    ck_assert_msg(status == 0, "%s", text);
    h->pictures++;
}

static inline void
on_read(void *arg, ssize_t n, uint64_t size, int status, const char *text)
{
    struct heard *h = arg;

    (void)text;
    h->n = n;
    h->size = size;
    h->read_status = status;
}

/* From its beginning, in one piece. */
static inline void
read_all(const struct store_source *from, void *buf, size_t n)
{
    static struct store_reading r;

    store_reading_release(&r);
    r = (struct store_reading){ .from = *from };
    store_read(store, &r, buf, n, on_read, &heard);
}

static inline void
on_progress(void *arg)
{
    struct heard *h = arg;

    h->chunks++;
}

static inline void
on_broken(void *arg, int status, const char *text)
{
    struct heard *h = arg;

    (void)text;
    h->broken = status;
}

static inline void
on_filed(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
         uint64_t bytes, uint64_t cache_bytes)
{
    struct heard *h = arg;

    (void)job;
    h->sequence = sequence;
    h->filed++;
    h->size = bytes;
    h->cache_size = cache_bytes;
}

static inline void
on_settled(void *arg, uint64_t conn, uint32_t request)
{
    struct heard *h = arg;

    ck_assert_uint_eq(conn, 5);
    h->settled = request;
}

static inline void
on_fullness(void *arg, bool full, const char *text)
{
    struct heard *h = arg;

    (void)text;
    h->full = full;
}

static inline void
on_looked(void *arg, const struct action_look *l)
{
    struct heard *h = arg;

    h->looked = l->request;
    ck_assert_uint_eq(l->files.n, 1);
}

static const struct store_handler handler = { .looked = on_looked,
                                              .file = on_file,
                                              .job = on_job,
                                              .rows = on_rows,
                                              .picture = on_picture,
                                              .progress = on_progress,
                                              .broken = on_broken,
                                              .filed = on_filed,
                                              .settled = on_settled,
                                              .fullness = on_fullness };

static inline void
run(void)
{
    while (!store_idle(store))
        uv_run(&loop, UV_RUN_ONCE);
}

static inline void
put_file(const char *text, const char *name)
{
    uint8_t digest[MSG_HASH];
    char hex[RAD_SHA_HEX + 1];
    struct msg_chunk c = { .hash = digest,
                           .offset = 0,
                           .total = strlen(text),
                           .data = (const uint8_t *)text,
                           .len = strlen(text) };

    hash_of(name, strlen(name), hex);
    rad_sha_from_hex(hex, digest);
    store_put_chunk(store, 5, &c);
}

static inline bool
is_there(const char *name)
{
    char path[200];

    snprintf(path, sizeof path, "%s/%s", dir, name);
    return access(path, F_OK) == 0;
}

static inline void
put_unit(const uint8_t *job, uint32_t unit, uint32_t rows, uint8_t channels)
{
    static uint8_t bytes[W * H * 16];
    float px[W * H * 4];
    struct action_rows a = { .unit = unit,
                             .rows = rows,
                             .y = unit * rows,
                             .width = W,
                             .channels = channels,
                             .pixels = bytes };

    for (size_t i = 0; i < (size_t)W * rows * channels; i++)
        px[i] = 2;
    wire_floats_put(bytes, px, (size_t)W * rows * channels);
    memcpy(a.job, job, MSG_JOB);
    store_keep_unit(store, job,
                    &(struct saved_unit){ .unit = unit,
                                          .area = { 0, 0, a.y, W, rows },
                                          .worker = "ws1" });
    store_put_rows(store, &a);
}

#endif
