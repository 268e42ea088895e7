/* check_store.c - the store in one life: files that come and go, jobs and their
 * rows */
#include "config.h"

#include "base/output.h"
#include "folder/room.h"
#include "store/store_impl.h"
#include "store_fixture.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sysexits.h>
#include <time.h>

static void
set_up(void)
{
    scratch_make();
    uv_loop_init(&loop);
    store = NULL;
    heard = (struct heard){ 0 };
}

static void
tear_down(void)
{
    if (store)
        store_close(store);
    ck_assert_int_eq(uv_loop_close(&loop), 0);
    scratch_remove();
}

FIXTURE(set_up, tear_down)

static void
open_store(bool durable)
{
    store = store_open(&loop, dir, durable, &handler, &heard, NULL);
    ck_assert_ptr_nonnull(store);
}

static void
digest_of(const char *text, uint8_t digest[MSG_HASH])
{
    char hex[RAD_SHA_HEX + 1];

    hash_of(text, strlen(text), hex);
    rad_sha_from_hex(hex, digest);
}

/* Where the store keeps a file of that text; until the next call. */
static const char *
place_of(const char *text)
{
    static char path[300];
    char hex[RAD_SHA_HEX + 1];

    hash_of(text, strlen(text), hex);
    snprintf(path, sizeof path, "%s/files/%s", dir, hex);
    return path;
}

TEST(store_keeps_files_and_refuses_impostors)
{
    open_store(true);
    put_file("hello", "hello");
    run();
    ck_assert_int_eq(heard.files, 1);
    ck_assert_int_eq(heard.status, 0);
    put_file("olleh", "other");
    run();
    ck_assert_int_eq(heard.files, 2);
    ck_assert_int_eq(heard.status, 76);
}

TEST(a_file_waits_for_descriptors)
{
    struct rlimit was, none;

    open_store(true);
    ck_assert_int_eq(getrlimit(RLIMIT_NOFILE, &was), 0);
    none = (struct rlimit){ 0, was.rlim_max };
    ck_assert_int_eq(setrlimit(RLIMIT_NOFILE, &none), 0);
    put_file("hello", "hello");
    while (store->queue.told_lack == TASK_LACKS_NOTHING)
        uv_run(&loop, UV_RUN_ONCE);
    ck_assert_int_eq(setrlimit(RLIMIT_NOFILE, &was), 0);
    run();
    ck_assert_int_eq(heard.files, 1);
    ck_assert_int_eq(heard.status, 0);
    ck_assert_int_eq(access(place_of("hello"), F_OK), 0);
}

/* Have a store take n pieces of the file "hello". */
static void
take_pieces(const struct msg_chunk *piece, int n)
{
    uint8_t digest[MSG_HASH];

    digest_of("hello", digest);
    open_store(false);
    for (int i = 0; i < n; i++) {
        struct msg_chunk c = piece[i];

        c.hash = digest;
        c.data = (const uint8_t *)"hello";
        store_put_chunk(store, 5, &c);
    }
    run();
}

/* A sender that cannot read a file, or its rest, sends it as an empty one. */
LOOP_TEST(store_tells_of_a_file_that_its_sender_cannot_read, 2)
{
    static const struct msg_chunk half_and_empty[] = {
        { .total = 5, .len = 2 }, { .total = 0, .len = 0 }
    };

    take_pieces(half_and_empty + _i, 2 - _i);
    ck_assert_int_eq(heard.files, 1);
    ck_assert_int_eq(heard.status, EX_PROTOCOL);
    ck_assert_str_eq(heard.text,
                     "file 2cf24dba5fb0 came empty: its sender cannot "
                     "read it");
}

/* Only the first piece of a file is counted for its user. */
TEST(a_file_that_begins_again_with_another_length_is_refused)
{
    static const struct msg_chunk small_and_large[] = {
        { .total = 2, .len = 1 }, { .total = 5, .len = 5 }
    };

    take_pieces(small_and_large, 2);
    ck_assert_int_eq(heard.status, EX_PROTOCOL);
    ck_assert_str_eq(heard.text, "a file that changed its length");
}

TEST(store_tells_of_every_chunk)
{
    static const char text[] = "in three parts";
    uint8_t digest[MSG_HASH];

    digest_of(text, digest);
    open_store(false);
    for (size_t at = 0, n; at < strlen(text); at += n) {
        struct msg_chunk c = { .hash = digest, .offset = at };

        n = strlen(text) - at < 5 ? strlen(text) - at : 5;
        c.total = strlen(text);
        c.data = (const uint8_t *)text + at;
        c.len = n;
        store_put_chunk(store, 5, &c);
        ck_assert_uint_ge(store_backlog(store), n);
        run();
        ck_assert_uint_eq(store_backlog(store), 0);
        ck_assert_int_eq(heard.chunks + heard.files, (int)(at / 5) + 1);
    }
    ck_assert_int_eq(heard.chunks, 2);
    ck_assert_int_eq(heard.files, 1);
    ck_assert_int_eq(heard.status, 0);
}

/* Give the file of the text "hello" another content of the same length. */
static void
damage(void)
{
    FILE *f = fopen(place_of("hello"), "r+");

    ck_assert_ptr_nonnull(f);
    fputs("HELLO", f);
    fclose(f);
}

TEST(store_notices_damaged_files)
{
    uint8_t digest[MSG_HASH];

    digest_of("hello", digest);
    open_store(false);
    for (int again = 0; again < 2; again++) {
        put_file("hello", "hello");
        run();
        ck_assert(store_check_file(store, digest));
        ck_assert(store_check_file(store, digest)); /* now known */
        damage();
        ck_assert(!store_check_file(store, digest));
        ck_assert(!store_check_file(store, digest));
    }
}

/* Another process finds a file: it is read off the loop, once. */
LOOP_TEST(files_are_read_behind_the_loop, 2)
{
    uint8_t digest[MSG_HASH];
    struct action_look look = { .request = 7,
                                .nlook = 1,
                                .files = { 1, digest } };

    digest_of("hello", digest);
    open_store(false);
    ck_assert(store_look(store, &look)); /* it is missing */
    put_file("hello", "hello");
    run();
    ck_assert(store_look(store, &look)); /* it was written just now */
    store_close(store);
    if (_i)
        damage();
    open_store(false);
    ck_assert(!store_look(store, &look));
    ck_assert_uint_eq(heard.looked, 0);
    run();
    ck_assert_uint_eq(heard.looked, 7);
    ck_assert(store_look(store, &look));
    ck_assert(store_check_file(store, digest) == !_i);
}

TEST(folder_serves_one_store)
{
    struct rad_error err = { 0 };

    open_store(true);
    ck_assert_ptr_null(store_open(&loop, dir, true, &handler, &heard, &err));
    ck_assert_int_eq(err.code, RAD_ECANTCREAT);
}

/* File `name` of a folder below dir, made with it. */
static void
put_in(const char *folder, const char *name)
{
    char path[200];
    FILE *f;

    snprintf(path, sizeof path, "%s/%s", dir, folder);
    ck_assert_int_eq(rad_make_dir(path, 0700, NULL), 0);
    snprintf(path, sizeof path, "%s/%s/%s", dir, folder, name);
    f = fopen(path, "w");
    ck_assert_ptr_nonnull(f);
    fclose(f);
}

#define OLD_JOB "jobs/00112233445566778899aabbccddeeff"
#define OLD_HASH                                                               \
    "2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b"

TEST(without_a_database_jobs_go_and_files_stay)
{
    put_in(OLD_JOB, "0.rows");
    put_in(OLD_JOB, "0.hdr");
    put_in("jobs/of-another-program", "0.rows");
    put_in("files", OLD_HASH);
    open_store(false);
    ck_assert(!is_there(OLD_JOB));
    ck_assert(is_there("jobs/of-another-program/0.rows"));
    ck_assert(is_there("files/" OLD_HASH));
}

static const struct msg_frame one_frame = { 0, W, H, "-vtv -vp 0 0 0" };
static const struct saved_job small = { .spec = { .name = "x",
                                                  .params = "-ab 0",
                                                  .frames = &one_frame,
                                                  .nframes = 1 } };

LOOP_TEST(job_becomes_a_picture, 2)
{
    static const uint8_t job[MSG_JOB] = { 1, 2, 3 };
    struct store_source from = { .what = MSG_WHAT_PREVIEW };
    struct rad_picture pic;
    char buf[4096];

    memcpy(from.job, job, MSG_JOB);
    open_store(_i);
    store_open_job(store, job, &small);
    put_unit(job, 0, 3, 3);
    run();
    ck_assert_int_eq(heard.jobs, 1);
    ck_assert_int_eq(heard.rows, 1);
    read_all(&from, buf, sizeof buf);
    run();
    ck_assert_int_gt(heard.n, 0);
    ck_assert_int_eq(
        rad_hdr_read((uint8_t *)buf, (size_t)heard.n, 1000, &pic, NULL), 0);
    ck_assert_float_gt(pic.L[0].r, 1.9f);
    ck_assert_float_eq(pic.L[3 * W].r, 0); /* has not come */
    rad_picture_release(&pic);

    put_unit(job, 1, 3, 4); /* a distance that the job has not */
    run();
    ck_assert_int_eq(heard.status, 76);
    put_unit(job, 1, 3, 3);
    store_write_picture(store, job, 5, 0);
    from.what = MSG_WHAT_PICTURE;
    read_all(&from, buf, sizeof buf);
    run();
    ck_assert_int_eq(heard.status, 0);
    ck_assert_int_eq(heard.pictures, 1);
    ck_assert_uint_eq((uint64_t)heard.n, heard.size);
    ck_assert_int_eq(
        rad_hdr_read((uint8_t *)buf, (size_t)heard.n, 1000, &pic, NULL), 0);
    ck_assert_float_gt(pic.L[W * H - 1].r, 1.9f);
    rad_picture_release(&pic);

    store_forget_job(store, &(struct saved_gone){ .job = { 1, 2, 3 } });
    read_all(&from, buf, sizeof buf);
    run();
    ck_assert_int_lt(heard.n, 0);
}

TEST(pieces_of_a_preview_are_of_one_file)
{
    static const uint8_t job[MSG_JOB] = { 1, 2, 3 };
    struct store_source from = { .job = { 1, 2, 3 }, .what = MSG_WHAT_PREVIEW };
    struct store_reading slow = { .from = from }, other = { .from = from };
    struct rad_picture pic;
    char buf[4096], more[4096];

    open_store(false);
    store_open_job(store, job, &small);
    put_unit(job, 0, 3, 3);
    store_read(store, &slow, buf, 100, on_read, &heard);
    run();
    ck_assert_int_eq(heard.n, 100);
    ck_assert_uint_gt(heard.size, 100);

    put_unit(job, 1, 3, 3);
    store_read(store, &other, more, sizeof more, on_read, &heard);
    run();
    ck_assert_uint_eq((uint64_t)heard.n, heard.size);
    store_reading_release(&other);
    store_write_picture(store, job, 5, 0);
    store_end_job(store, &small, strdup("{}"), 2);
    run();
    store_read(store, &slow, buf + 100, sizeof buf - 100, on_read, &heard);
    run();
    ck_assert_uint_eq((uint64_t)heard.n + 100, heard.size);
    ck_assert_int_eq(rad_hdr_read((uint8_t *)buf, heard.size, 1000, &pic, NULL),
                     0);
    ck_assert_float_gt(pic.L[0].r, 1.9f);
    ck_assert_float_eq(pic.L[3 * W].r, 0); /* had not come */
    rad_picture_release(&pic);
    store_reading_release(&slow);
}

TEST(few_previews_are_read_at_a_time)
{
    enum { MOST = 8 };
    struct store_reading r[MOST + 1];
    char buf[1];

    open_store(false);
    store_open_job(store, (const uint8_t[MSG_JOB]){ 1 }, &small);
    put_unit((const uint8_t[MSG_JOB]){ 1 }, 0, 3, 3);
    for (int i = 0; i <= MOST; i++) {
        r[i] = (struct store_reading){ .from = { .job = { 1 },
                                                 .what = MSG_WHAT_PREVIEW } };
        store_read(store, &r[i], buf, 1, on_read, &heard);
        run();
        ck_assert_int_eq(heard.n, i < MOST ? 1 : -1);
    }
    ck_assert_int_eq(heard.read_status, EX_TEMPFAIL);
    store_reading_release(&r[0]);
    store_read(store, &r[MOST], buf, 1, on_read, &heard);
    run();
    ck_assert_int_eq(heard.n, 1);
    for (int i = 0; i <= MOST; i++)
        store_reading_release(&r[i]);
}

TEST(what_is_larger_than_the_disk_waits_for_no_room)
{
    struct statvfs fs;
    uint64_t all;

    ck_assert_int_eq(statvfs(dir, &fs), 0);
    all = (uint64_t)fs.f_blocks * fs.f_frsize;
    ck_assert_int_eq(room_check(dir, all, "rows", NULL), RAD_EFULL);
    ck_assert_int_eq(room_check(dir, all + 1, "rows", NULL), RAD_EDATA);
}

/* One that waited for room would keep what is asked for behind it, as pictures
 * whose jobs could go then. */
TEST(a_preview_waits_for_no_room_on_the_disk)
{
    static const uint8_t job[MSG_JOB] = { 1, 2, 3 };
    struct store_source from = { .job = { 1, 2, 3 }, .what = MSG_WHAT_PREVIEW };
    char buf[4096], path[300], hex[MSG_JOB_HEX];

    open_store(true);
    store_open_job(store, job, &small);
    put_unit(job, 0, 3, 3);
    run();
    msg_job_format(job, hex);
    snprintf(path, sizeof path, "%s/jobs/%s/0.preview.tmp", dir, hex);
    ck_assert_int_eq(symlink("/dev/full", path), 0);
    read_all(&from, buf, sizeof buf);
    run();
    ck_assert_int_eq(heard.n, -1);
    ck_assert_int_eq(heard.read_status, EX_TEMPFAIL);
    ck_assert(!heard.full); /* no job is held */
    read_all(&from, buf, sizeof buf);
    run();
    ck_assert_int_gt(heard.n, 0);
}

/* --- files that go --- */

/* As if nobody had asked for it for so long. */
static void
make_old(const char *text, long for_s)
{
    struct timespec times[2] = { { .tv_sec = time(NULL) - for_s }, { 0 } };

    times[1] = times[0];
    ck_assert_int_eq(utimensat(AT_FDCWD, place_of(text), times, 0), 0);
}

static bool
has_text(const char *text)
{
    return access(place_of(text), F_OK) == 0;
}

static void
sweep(const char *needed)
{
    uint8_t *keep = malloc(MSG_HASH);

    ck_assert_ptr_nonnull(keep);
    digest_of(needed, keep);
    store_sweep(store, keep, 1, 3600);
    run();
}

TEST(files_that_no_job_needs_go_after_a_day)
{
    static const char *const texts[] = { "needed", "asked for", "new",
                                         "forgotten", "old" };
    uint8_t asked[MSG_HASH];

    open_store(true);
    for (int i = 0; i < N_ELEM(texts); i++)
        put_file(texts[i], texts[i]);
    run();
    for (int i = 0; i < N_ELEM(texts); i++)
        if (strcmp(texts[i], "new") != 0)
            make_old(texts[i], 3600 + 60);
    scratch_file("files/a note of somebody's", "");
    digest_of("asked for", asked);
    ck_assert(store_check_file(store, asked));
    sweep("needed");
    ck_assert(has_text("needed") && has_text("asked for") && has_text("new"));
    ck_assert(!has_text("forgotten") && !has_text("old"));
    ck_assert(is_there("files/a note of somebody's"));
}

/* A clock that was years ahead would keep the file for as long. */
TEST(a_file_of_the_future_is_new)
{
    struct stat st;

    open_store(true);
    put_file("ahead", "ahead");
    run();
    make_old("ahead", -1000000);
    sweep("needed");
    ck_assert_int_eq(stat(place_of("ahead"), &st), 0);
    ck_assert_int_le(st.st_mtime, time(NULL));
    make_old("ahead", 3660);
    sweep("needed");
    ck_assert(!has_text("ahead"));
}
