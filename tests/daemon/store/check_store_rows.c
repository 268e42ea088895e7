/* check_store_rows.c - what a store finds of the one before it: rows, base
 * lines, passes; and that it was synced before anybody heard of it */
#include "config.h"

#include "lives_fixture.h"

#include "jobs/job.h"
#include "journal/journal_impl.h"
#include "tests/scarce.h"

#include <stdio.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <sysexits.h>
#include <unistd.h>

FIXTURE(scratch_make, remove_kept)

/* The files and folders that were synced, by their numbers. */
static struct {
    ino_t number[64];
    int n;
} synced;

/* In place of the C library's. */
int
fsync(int fd)
{
    struct stat st;

    if (fstat(fd, &st) == 0 && synced.n < N_ELEM(synced.number))
        synced.number[synced.n++] = st.st_ino;
    return (int)syscall(SYS_fsync, fd);
}

int
fdatasync(int fd)
{
    return fsync(fd);
}

/* Was this file or folder of the state folder synced? */
static void
check_synced(const char *name)
{
    char path[200];
    struct stat st;
    int i = 0;

    snprintf(path, sizeof path, "%s/%s", dir, name);
    ck_assert_int_eq(stat(path, &st), 0);
    while (i < synced.n && synced.number[i] != st.st_ino)
        i++;
    ck_assert_msg(i < synced.n, "%s is not synced", name);
}

static uint8_t
line_byte(int i)
{
    return (uint8_t)(7 * i % 64);
}

static void
keep_units(void)
{
    for (uint32_t unit = 0; unit < 2; unit++)
        store_keep_unit(store, kept_job,
                        &(struct saved_unit){ .unit = unit,
                                              .area = { 0, 0, 3 * unit, W, 3 },
                                              .worker = "ws1" });
}

/* Rows of unit 0 come in two pieces, those of unit 1 in one; each unit leaves
 * a base line, with so many densities. */
enum { PIECES = 3 };

static void
put_piece(int i, bool coded, uint32_t densities)
{
    static const uint32_t first[PIECES] = { 0, 1, 3 }, n[PIECES] = { 1, 2, 3 };
    uint8_t bytes[W * H * 12], code[H * RAD_HDR_ROW_BYTES(W)];
    struct action_rows a = { .unit = first[i] / 3,
                             .row = first[i] % 3,
                             .rows = n[i],
                             .y = first[i],
                             .width = W,
                             .channels = coded ? 1 : 3,
                             .pixels = bytes,
                             .last = i > 0,
                             .counts = &(struct msg_counts){ 0 } };

    for (int k = 0; k < N_ELEM(bytes); k++)
        bytes[k] = line_byte(k);
    if (coded) {
        a.pixels = code;
        a.len = code_rows(0, (int)first[i], W, (int)n[i], code);
    }
    if (a.last) {
        a.bottom = bytes;
        a.nbottom = densities;
        a.line = coded ? bytes : NULL;
    }
    memcpy(a.job, kept_job, MSG_JOB);
    store_put_rows(store, &a);
}

static void
put_pieces(bool coded, uint32_t densities)
{
    keep_units();
    for (int i = 0; i < PIECES; i++)
        put_piece(i, coded, densities);
}

static int
note_stored(void *arg, const struct saved_job *s, struct rad_error *err)
{
    uint32_t *stored = arg;

    (void)err;
    ck_assert_uint_eq(s->nunits, 2);
    for (uint32_t i = 0; i < 2; i++)
        stored[i] = s->units[i].stored;
    return 0;
}

/* What is spoilt: a byte in each row, at a row's column, of floats, of RGBE,
 * and of the lines that are kept behind that. */
static const struct {
    bool coded;
    uint32_t densities;
    long at;
    int unit; /* whose rows are none then; 2: both's, -1: nobody's */
} spoilt[] = {
    { false, 1, 0, 0 },
    { false, 1, W * 12 + 1, 0 },
    { false, 1, 2 * W * 12 + 2, 0 },
    { false, 1, 3 * W * 12 + 3, 1 },
    { false, 1, 5 * W * 12 + 5, 1 },
    { true, 1, 0, 0 },
    { true, 1, W * 4 + 1, 0 },
    { true, 1, 3 * W * 4 - 1, 0 },
    { true, 1, 3 * W * 4, 1 },
    { true, 1, 6 * W * 4 - 1, 1 },
    { true, 1, H *W * 4 + 2 * W * 12 - 1, -1 }, /* no line is there */
    { true, 1, H *W * 4 + 2 * W * 12, 0 },
    { true, 1, H *W * 4 + 6 * W * 12 - 1, 1 },
    { true, 1, -1, -1 },
    { true, 0, H *W * 4 + 2 * W * 12, 0 }, /* -ps 1 has none */
    { true, 0, 0, 0 },
    { true, 0, -1, -1 },
    /* nothing was kept of the base line above */
    { false, 0, 3 * W * 12 + 3, 2 },
    { false, 0, 0, 0 },
};

/* Begin a life of the store. */
static void
live(uint32_t stored[2])
{
    open_kept();
    ck_assert_int_eq(store_recover(store, 1, note_stored, stored, NULL), 0);
}

/* Also in lives to come. */
LOOP_TEST(rows_that_a_disk_has_spoilt_are_none, N_ELEM(spoilt))
{
    bool coded = spoilt[_i].coded;
    int unit = spoilt[_i].unit;
    uint32_t stored[2];
    char path[200];
    FILE *f;

    live(stored);
    open_job_as(coded ? MSG_JOB_CODED : 0);
    put_pieces(coded, spoilt[_i].densities);
    close_kept();
    ck_assert_int_eq(heard.rows, 3);
    if (spoilt[_i].at >= 0) {
        snprintf(path, sizeof path, "%s/jobs/%s/0.rows", dir,
                 "09080700000000000000000000000000");
        f = fopen(path, "r+");
        ck_assert_ptr_nonnull(f);
        ck_assert_int_eq(fseek(f, spoilt[_i].at, SEEK_SET), 0);
        ck_assert_int_eq(fputc(0x55, f), 0x55);
        ck_assert_int_eq(fclose(f), 0);
    }
    for (int life = 0; life < 2; life++) {
        live(stored);
        close_kept();
        ck_assert_uint_eq(stored[0], unit == 0 || unit == 2 ? 0 : 3);
        ck_assert_uint_eq(stored[1], unit == 1 || unit == 2 ? 0 : 3);
    }
}

static int
note_given_up(void *arg, const struct saved_job *s, struct rad_error *err)
{
    (void)err;
    ck_assert_uint_eq(s->units[0].stored, 0);
    ck_assert_uint_eq(s->units[1].stored, 0);
    *(bool *)arg = s->given_up;
    return 0;
}

static int
note_cancelled(void *arg, const struct saved_job *s, struct rad_error *err)
{
    (void)arg;
    (void)err;
    ck_assert_int_eq(s->state, JOB_CANCELLED);
    return 0;
}

/* On a full disk the rows of a job that is cancelled are removed before that is
 * noted, and the coordinator is killed.  Its next lives know, until it is
 * noted. Of a job without rows the room is kept. */
LOOP_TEST(a_job_that_was_given_up_stays_so, 2)
{
    struct rad_error err = { 0 };
    bool given_up;
    uint32_t stored[2];

    live(stored);
    open_job();
    if (_i == 0)
        put_pieces(false, 1);
    else
        keep_units();
    run();
    synced.n = 0;
    folder_give_up(&store->folder, kept_job);
    check_synced(KEPT_DIR); /* "over" lasts before the rows go */
    ck_assert(!is_there(KEPT_DIR "/0.rows"));
    ck_assert(!is_there(KEPT_DIR "/room"));
    close_kept();
    for (int life = 0; life < 2; life++) {
        open_kept();
        given_up = false;
        ck_assert_msg(store_recover(store, 1, note_given_up, &given_up, &err) ==
                          0,
                      "%s: %s", err.where, err.what);
        ck_assert(given_up);
        ck_assert(!is_there(KEPT_DIR "/room"));
        if (life == 1)
            end_job();
        close_kept();
    }
    ck_assert(!is_there(KEPT_DIR "/over"));
    open_kept();
    ck_assert_int_eq(store_recover(store, 1, note_cancelled, NULL, NULL), 0);
}

static void
most_pages(int n)
{
    char text[50];

    snprintf(text, sizeof text, "PRAGMA max_page_count = %d", n);
    ck_assert_int_eq(sqlite3_exec(store->journal->db, text, NULL, NULL, NULL),
                     0);
}

/* The disk gets room again as soon as a job waits for it. */
static void
end_fullness(void *arg, const uint8_t job[MSG_JOB], uint64_t sequence,
             const char *text)
{
    count_waits(arg, job, sequence, text);
    most_pages(100000);
}

static void
end_all_fullness(void *arg, bool full, const char *text)
{
    (void)arg;
    (void)text;
    if (full)
        most_pages(100000);
}

/* A job whose note is what finds no room; SQLite undoes all that was noted and
 * not committed. */
TEST(rows_that_come_when_the_database_is_full_are_noted_once)
{
    static const uint8_t second[MSG_JOB] = { 1 };
    struct msg_frame frames[500];
    struct saved_job job = { .spec = { .manifest = kept_manifest,
                                       .params = "-ab 0",
                                       .frames = frames,
                                       .nframes = N_ELEM(frames) } };
    struct store_handler ends = handler;
    uint32_t stored[2];

    for (int i = 0; i < N_ELEM(frames); i++)
        frames[i] = kept_frame;
    ends.waits = end_fullness;
    ends.fullness = end_all_fullness;
    open_for(&ends);
    ck_assert_int_eq(store_recover(store, 1, note_stored, stored, NULL), 0);
    open_job();
    run();
    keep_units();
    put_piece(0, false, 1);
    run();
    most_pages(1);
    store_open_job(store, second, &job);
    put_piece(1, false, 1);
    put_piece(2, false, 1);
    run();
    ck_assert_int_eq(heard.jobs, 2);
    ck_assert_int_eq(heard.rows, 3);
    forget(second);
    close_kept();
    live(stored);
    close_kept();
    ck_assert_uint_eq(stored[0], 3);
    ck_assert_uint_eq(stored[1], 3);
}

/* Of a small disk: bytes that the database's log may share with rows; how often
 * somebody asked for them. */
static _Atomic long small_disk, asked;

/* In place of the C library's. */
int
statvfs(const char *path, struct statvfs *fs)
{
    char log[200];
    struct stat st;

    (void)path;
    asked++;
    snprintf(log, sizeof log, "%s/radcoord.db-wal", dir);
    memset(fs, 0, sizeof *fs);
    fs->f_frsize = 1;
    fs->f_blocks = 1 << 20;
    fs->f_bavail = small_disk == 0 ? 1 << 20 : (fsblkcnt_t)small_disk;
    if (small_disk > 0 && stat(log, &st) == 0)
        fs->f_bavail -= st.st_size < small_disk ? st.st_size : small_disk;
    return 0;
}

/* Also while notes of others are not committed yet. */
LOOP_TEST(a_job_gets_the_room_that_the_log_held, 2)
{
    static const uint8_t second[MSG_JOB] = { 1 };
    struct saved_job job = { .spec = kept_spec };
    struct store_handler counts = handler;
    uint32_t stored[2];

    counts.waits = count_waits;
    open_for(&counts);
    ck_assert_int_eq(store_recover(store, 1, note_stored, stored, NULL), 0);
    open_job();
    run();
    small_disk = (1 << 20) / 64 + 2 * W * H * 12; /* with some to spare */
    asked = 0;
    if (_i == 1)
        keep_units();
    store_open_job(store, second, &job);
    while (!store_idle(store) && asked < 4)
        uv_run(&loop, UV_RUN_ONCE);
    ck_assert_int_eq(heard.waits, 1);
    ck_assert_int_eq(heard.jobs, 2);
    close_kept();
    small_disk = 0; /* for tests of the same process */
}

/* Its floats, of rows that are RGBE. */
TEST(a_units_base_line_outlives_the_store)
{
    uint8_t line[W * 12];
    uint32_t stored[2];

    live(stored);
    open_job_as(MSG_JOB_CODED);
    put_pieces(true, 1);
    close_kept();
    live(stored);
    for (uint32_t y = 2; y < H; y += 3) {
        ck_assert(store_read_row(store, kept_job, 0, y, line));
        for (int i = 0; i < N_ELEM(line); i++)
            ck_assert_uint_eq(line[i], line_byte(i));
    }
    ck_assert(store_read_row(store, kept_job, 0, 1, line));
    ck_assert_uint_eq(line[1], 0); /* in the middle of a unit */
}

/* What a user or worker is told of a job is on the disk, with the names that
 * lead there. */
TEST(what_is_acknowledged_is_synced)
{
    uint32_t stored[2];
    char file[sizeof "files/" + RAD_SHA_HEX] = "files/";

    live(stored);
    synced.n = 0;
    put_file("room", "room");
    run();
    hash_of("room", 4, file + strlen(file));
    check_synced(file);
    check_synced("files");
    synced.n = 0;
    open_job_as(MSG_JOB_CODED);
    run();
    check_synced(KEPT_DIR "/room");
    check_synced(KEPT_DIR);
    check_synced("jobs");
    check_synced("radcoord.db-wal");
    synced.n = 0;
    put_pieces(true, 1);
    run();
    ck_assert_int_eq(heard.rows, PIECES);
    check_synced(KEPT_DIR "/0.rows");
    check_synced(KEPT_DIR);
    check_synced("radcoord.db-wal");
    ck_assert(!is_there(KEPT_DIR "/room")); /* the rows have it */
    synced.n = 0;
    store_write_picture(store, kept_job, 5, 0);
    run();
    check_synced(KEPT_DIR "/0.hdr");
    check_synced(KEPT_DIR);
    synced.n = 0;
    end_job();
    run();
    check_synced(KEPT_DIR "/stats");
    check_synced(KEPT_DIR);
    check_synced("radcoord.db-wal");
}

/* Rows are made by what such a pass decides. */
TEST(a_firm_pass_is_synced_and_follows_the_one_before)
{
    struct saved_pass pass[MSG_MOST_PASSES],
        first = { (const uint8_t *)"one", 3, { 0 }, true };
    struct saved_pass later = { (const uint8_t *)"two", 3, { 0 }, false };
    uint32_t stored[2], n;
    uint8_t *bytes;

    live(stored);
    open_job();
    run();
    synced.n = 0;
    store_put_pass(store, kept_job, 1, &later); /* the first is missing */
    store_put_pass(store, kept_job, 0, &first);
    run();
    check_synced(KEPT_DIR "/cache");
    check_synced(KEPT_DIR);
    synced.n = 0;
    ck_assert_int_eq(
        folder_read_passes(&store->folder, kept_job, pass, &n, &bytes, NULL),
        0);
    check_synced(KEPT_DIR "/cache"); /* a killed life may have left it */
    ck_assert_uint_eq(n, 1);
    ck_assert_mem_eq(pass[0].bytes, "one", 3);
    free(bytes);
}

TEST(names_in_two_folders_are_synced_in_both)
{
    static const char *const name[] = { "one/a", "one/b", "two/a" };
    struct syncs all = { 0 };
    char path[200];

    for (int i = 0; i < N_ELEM(name); i++) {
        snprintf(path, sizeof path, "%s/%.*s", dir,
                 (int)(strchr(name[i], '/') - name[i]), name[i]);
        ck_assert_int_eq(disk_make_dir(path, NULL), 0);
        ck_assert_int_eq(syncs_add(&all, scratch_file(name[i], ""), true, NULL),
                         0);
    }
    synced.n = 0;
    ck_assert_int_eq(syncs_settle(&all, NULL), 0);
    check_synced("one");
    check_synced("two");
}

static int
note_new(void *arg, const struct saved_job *s, struct rad_error *err)
{
    bool *is_new = arg;

    (void)err;
    *is_new = s->nunits == 0 && !s->frames[0].written;
    return 0;
}

/* The database may give its number again. */
TEST(nothing_of_a_forgotten_job_counts_for_the_next)
{
    uint32_t stored[2];
    struct rad_error err = { 0 };
    bool is_new = false;

    live(stored);
    open_job();
    put_pieces(false, 1);
    store_write_picture(store, kept_job, 5, 0);
    run();
    forget_job();
    run();
    open_job();
    close_kept();
    open_kept();
    ck_assert_msg(store_recover(store, 1, note_new, &is_new, &err) == 0, "%s",
                  err.what);
    ck_assert(is_new);
}

/* A life that noted unit 1 without unit 0 would leave a folder that the next
 * one refuses. */
TEST(a_unit_that_cannot_be_noted_ends_the_life)
{
    uint32_t stored[2];
    int status;
    pid_t pid;

    if (RAD_SANITIZED)
        return;
    live(stored);
    open_job_as(0);
    run();
    pid = fork();
    if (pid == 0) {
        scarce_at = 1;
        keep_units();
        _exit(EX_OK);
    }
    ck_assert_int_eq(waitpid(pid, &status, 0), pid);
    ck_assert(WIFEXITED(status));
    ck_assert_int_eq(WEXITSTATUS(status), EX_OSERR);
}
