/* check_journal.c - the database is whole when it has its name, and a commit
 * lasts or fails */
#include "config.h"

#include "lives_fixture.h"

#include "jobs/job.h"
#include "journal/journal_impl.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sysexits.h>
#include <unistd.h>

static struct journal *j;
static char path[160]; /* of the database */

static void
set_up(void)
{
    scratch_make();
    snprintf(path, sizeof path, "%s/radcoord.db", dir);
}

static void
tear_down(void)
{
    journal_close(j);
    j = NULL;
    scratch_remove();
}

FIXTURE(set_up, tear_down)

/* What reads, writes and syncs fail with; 0: they do not. */
static _Atomic int read_fault, write_fault, sync_fault;

/* In place of the C library's. */
int
fsync(int fd)
{
    errno = sync_fault;
    return sync_fault ? -1 : (int)syscall(SYS_fsync, fd);
}

int
fdatasync(int fd)
{
    return fsync(fd);
}

/* In place of the C library's, of which SQLite uses either. */
ssize_t
pread(int fd, void *bytes, size_t n, off_t at)
{
    errno = read_fault;
    return read_fault ? -1 : (ssize_t)syscall(SYS_pread64, fd, bytes, n, at);
}

ssize_t
pread64(int fd, void *bytes, size_t n, off_t at)
{
    return pread(fd, bytes, n, at);
}

ssize_t
pwrite(int fd, const void *bytes, size_t n, off_t at)
{
    errno = write_fault;
    return write_fault ? -1 : (ssize_t)syscall(SYS_pwrite64, fd, bytes, n, at);
}

ssize_t
pwrite64(int fd, const void *bytes, size_t n, off_t at)
{
    return pwrite(fd, bytes, n, at);
}

/* What a loss of power leaves of one that was being made is in nobody's way,
 * and one that has its name is whole, whatever becomes of its log. */
TEST(a_database_gets_its_name_when_it_is_whole)
{
    char made[170], log[170];
    FILE *f;

    snprintf(made, sizeof made, "%s.new", path);
    snprintf(log, sizeof log, "%s-wal", path);
    f = fopen(made, "w");
    ck_assert_ptr_nonnull(f);
    fputs("half a database", f);
    fclose(f);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    journal_close(j);
    ck_assert_int_ne(access(made, F_OK), 0);
    f = fopen(log, "w");
    ck_assert_ptr_nonnull(f);
    fputs("half a log", f);
    fclose(f);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_OPEN, NULL), 0);
}

static const struct {
    int write, sync, code;
} faults[] = {
    { ENOSPC, 0, RAD_EFULL }, { EDQUOT, 0, RAD_EFULL }, { EIO, 0, RAD_EIO },
    { 0, ENOSPC, RAD_EIO }, /* the next sync would prove nothing */
    { 0, EIO, RAD_EIO },
};

LOOP_TEST(a_commit_that_fails_tells_a_full_disk_from_another_fault,
          N_ELEM(faults))
{
    struct saved_job job = { .spec = kept_spec, .owner = "ana" };
    struct rad_error err = { 0 };
    bool has;

    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    ck_assert_int_eq(journal_put_job(j, &job, NULL), 0);
    write_fault = faults[_i].write;
    sync_fault = faults[_i].sync;
    ck_assert_int_eq(journal_commit(j, &err), faults[_i].code);
    write_fault = sync_fault = 0;
    ck_assert(faults[_i].write != EDQUOT || strstr(err.what, "quota"));
    journal_rollback(j);
    ck_assert_int_eq(journal_put_job(j, &job, NULL), 0);
    ck_assert_int_eq(journal_commit(j, NULL), 0);
    ck_assert_int_eq(journal_has(j, kept_job, &has, NULL), 0);
    ck_assert(has);
}

TEST(rows_of_a_unit_that_was_not_noted_are_not)
{
    struct saved_job job = { .spec = kept_spec, .owner = "ana" };
    struct saved_unit unit = { .stored = 1, .worker = "" };

    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    ck_assert_int_eq(journal_put_job(j, &job, NULL), 0);
    ck_assert_int_eq(journal_put_rows(j, kept_job, &unit, NULL), RAD_EDATA);
    ck_assert_int_eq(journal_put_unit(j, kept_job, &unit, NULL), 0);
    ck_assert_int_eq(journal_put_rows(j, kept_job, &unit, NULL), 0);
}

static long
log_bytes(void)
{
    char log[170];
    struct stat st;

    snprintf(log, sizeof log, "%s-wal", path);
    ck_assert_int_eq(stat(log, &st), 0);
    return (long)st.st_size;
}

/* Put a unit, which is not committed yet. */
static void
put_one(uint32_t unit)
{
    struct saved_unit u = { .unit = unit, .worker = "ws1" };

    ck_assert_int_eq(journal_put_unit(j, kept_job, &u, NULL), 0);
}

/* Nothing is lost: what is not committed yet comes when it is, and what finds
 * no room in the database stays in the log. */
TEST(the_log_gives_its_room_to_those_that_lack_it)
{
    struct saved_job job = { .spec = kept_spec, .owner = "ana" };
    struct saved_unit unit = { .stored = 1 };

    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    ck_assert_int_eq(journal_put_job(j, &job, NULL), 0);
    ck_assert_int_eq(journal_commit(j, NULL), 0);
    ck_assert_int_gt(log_bytes(), 0);
    write_fault = ENOSPC;
    ck_assert_int_eq(journal_give_room(j, NULL), 0);
    write_fault = 0;
    ck_assert_int_gt(log_bytes(), 0);
    sync_fault = EIO;
    ck_assert_int_eq(journal_give_room(j, NULL), RAD_EIO);
    sync_fault = 0;
    ck_assert_int_gt(log_bytes(), 0);
    ck_assert_int_eq(journal_give_room(j, NULL), 0);
    ck_assert_int_eq(log_bytes(), 0);
    put_one(0);
    ck_assert_int_eq(journal_commit(j, NULL), 0);
    put_one(1);
    ck_assert_int_eq(journal_give_room(j, NULL), 0);
    ck_assert_int_gt(log_bytes(), 0);
    put_one(2);
    ck_assert_int_eq(journal_commit(j, NULL), 0);
    ck_assert_int_eq(log_bytes(), 0);
    put_one(3);
    ck_assert_int_eq(journal_commit(j, NULL), 0);
    ck_assert_int_gt(log_bytes(), 0); /* the log is of use again */
    journal_close(j);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_OPEN, NULL), 0);
    for (; unit.unit < 4; unit.unit++)
        ck_assert_int_eq(journal_put_rows(j, kept_job, &unit, NULL), 0);
}

/* Its life ends before there is room. */
TEST(rows_stay_until_their_picture_is_written)
{
    open_kept();
    open_job();
    put_unit(kept_job, 0, H, 3);
    run();
    write_fault = ENOSPC;
    store_write_picture(store, kept_job, 5, 0);
    while (!heard.full)
        uv_run(&loop, UV_RUN_ONCE);
    store_end(store);
    run();
    write_fault = 0;
    ck_assert(is_there(KEPT_DIR "/0.rows"));
    close_kept();
}

/* The log is carried over into the database, for which there is no memory; what
 * is in the log lasts. */
TEST(a_database_that_cannot_be_looked_at_is_not_replaced)
{
    struct stat st;
    struct rad_error err = { 0 };

    snprintf(path, sizeof path, "%s/loop.db", dir);
    ck_assert_int_eq(symlink("loop.db", path), 0); /* ELOOP */
    ck_assert_int_lt(journal_open(&j, path, JOURNAL_MAKE, &err), 0);
    ck_assert_ptr_nonnull(strstr(err.what, "look at"));
    ck_assert_int_eq(lstat(path, &st), 0);
    ck_assert(S_ISLNK(st.st_mode));
}

/* Else systemd would not start radcoord again when the disk is back. */
TEST(a_database_that_cannot_be_read_is_not_damaged)
{
    struct rad_error err = { 0 };

    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    read_fault = EIO;
    ck_assert_int_eq(journal_check(j, &err), RAD_EIO);
    read_fault = 0;
    ck_assert_ptr_nonnull(strstr(err.what, strerror(EIO)));
    journal_close(j);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_OPEN, NULL), 0);
    ck_assert_int_eq(journal_check(j, NULL), 0);
}

/* An open() for SQLite alone, with a disk that lets the log be read only. */
static int
open_but_log(const char *name, int flags, int mode)
{
    if ((flags & O_RDWR) && strstr(name, "-wal")) {
        errno = EIO;
        return -1;
    }
    return open(name, flags, mode);
}

TEST(a_log_that_the_disk_does_not_open_is_not_forbidden)
{
    sqlite3_vfs *vfs = sqlite3_vfs_find(NULL);
    sqlite3_syscall_ptr usual = vfs->xGetSystemCall(vfs, "open");
    uint64_t date = 1, epoch;
    struct rad_error err = { 0 };
    char log[170];
    FILE *f;

    snprintf(log, sizeof log, "%s-wal", path);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    journal_close(j);
    f = fopen(log, "w");
    ck_assert_ptr_nonnull(f);
    fclose(f);
    vfs->xSetSystemCall(vfs, "open", (sqlite3_syscall_ptr)open_but_log);
    ck_assert_int_eq(journal_open(&j, path, JOURNAL_OPEN, NULL), 0);
    ck_assert_int_eq(journal_begin_life(j, &date, &epoch, &err), RAD_EIO);
    journal_close(j);
    j = NULL;
    vfs->xSetSystemCall(vfs, "open", usual);
}

TEST(a_commit_without_memory_for_more_is_one)
{
    static uint8_t bottom[60000];
    struct saved_job job = { .spec = kept_spec, .owner = "ana", .text = "" };
    struct saved_unit u = { .worker = "ws1",
                            .bottom = bottom,
                            .nbottom = sizeof bottom };
    struct rad_error err = { 0 };

    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    ck_assert_int_eq(journal_put_job(j, &job, &err), 0);
    ck_assert_int_eq(journal_commit(j, &err), 0);
    for (u.unit = 0; u.unit < 100; u.unit++) {
        ck_assert_int_eq(journal_put_unit(j, kept_job, &u, &err), 0);
        ck_assert_int_eq(journal_put_rows(j, kept_job, &u, &err), 0);
    }
    sqlite3_hard_heap_limit64(sqlite3_memory_used() + 4096);
    ck_assert_msg(journal_commit(j, &err) == 0, "%s", err.what);
    sqlite3_hard_heap_limit64(0);
}

/* A worker keeps rows until they are said to be kept. */
TEST(rows_that_could_not_be_synced_are_not_kept)
{
    open_kept();
    open_job();
    run();
    ck_assert_int_eq(heard.jobs, 1);
    sync_fault = EIO;
    put_unit(kept_job, 0, 3, 3);
    run();
    sync_fault = 0;
    ck_assert(heard.rows == 0 || heard.status != 0);
    ck_assert_int_eq(heard.broken, EX_IOERR);
    close_kept();
}

/* What somebody may do to a database that SQLite finds nothing wrong with. */
static const struct {
    const char *sql, *what;
} wrong[] = {
    { "UPDATE unit SET done = 1, counts = NULL", "a unit" },
    { "UPDATE unit SET done = 1, counts = x''", "a unit" },
    { "UPDATE unit SET done = 1, counts = 'none'", "a unit" },
    { "UPDATE unit SET done = 2", "a unit" },
    { "UPDATE job SET spec = x''", "the specification" },
    { "UPDATE job SET id = x''", "the id" },
    { "UPDATE job SET state = 3, progress = NULL", "the end" },
};

static int
take_no_job(void *arg, const struct saved_job *s, struct rad_error *err)
{
    (void)arg;
    (void)s;
    (void)err;
    return 0;
}

LOOP_TEST(a_job_that_makes_no_sense_is_refused, N_ELEM(wrong))
{
    struct rad_error err = { 0 };

    open_kept();
    open_job();
    put_unit(kept_job, 0, 3, 3);
    run();
    ck_assert_int_eq(
        sqlite3_exec(store->journal->db, wrong[_i].sql, NULL, NULL, NULL), 0);
    close_kept();
    open_kept();
    ck_assert_int_eq(store_recover(store, 1, take_no_job, NULL, &err),
                     RAD_EDATA);
    ck_assert_msg(strstr(err.what, wrong[_i].what) != NULL, "%s", err.what);
    close_kept();
}

#define HOUR  (UINT64_C(3600) * 1000)
#define DAY   (24 * HOUR)
#define NOV26 UINT64_C(1795000000000) /* 2026-11-18 [ms] */

/* A job is over for five days when a life ends that was last seen in NOV26; by
 * the clock of the next life it is then `clock`, and the life says when the job
 * was over. */
static const struct {
    uint64_t clock, date, age;
} pauses[] = {
    { NOV26, NOV26, 5 * DAY },
    { NOV26 + 3 * HOUR, NOV26 + 3 * HOUR, 5 * DAY + 3 * HOUR },
    /* switched off on purpose, or a clock that is years ahead */
    { NOV26 + 31 * DAY, NOV26 + 31 * DAY, 5 * DAY + 12 * HOUR },
    { NOV26 + 9999 * DAY, NOV26 + 9999 * DAY, 5 * DAY + 12 * HOUR },
    /* the last life's clock was ahead */
    { NOV26 - 1, NOV26 - 1, 5 * DAY },
    { NOV26 - 100 * DAY, NOV26 - 100 * DAY, 5 * DAY },
    { 5 * HOUR, NOV26, 5 * DAY }, /* a dead battery: 1970 */
};

static int
note_end(void *arg, const struct saved_job *s, struct rad_error *err)
{
    uint64_t *end_ms = arg;

    (void)err;
    *end_ms = s->end_ms;
    return 0;
}

/* Begin a life by that clock; returns its date, and the age of the job. */
static uint64_t
live(uint64_t clock, uint64_t *age)
{
    struct rad_error err = { 0 };
    uint64_t epoch, end_ms = 0;

    ck_assert_msg(journal_begin_life(j, &clock, &epoch, &err) == 0, "%s",
                  err.what);
    ck_assert_int_eq(journal_read(j, note_end, &end_ms, &err), 0);
    ck_assert_int_eq(journal_commit(j, &err), 0);
    *age = clock - end_ms;
    return clock;
}

/* Open a database with a job that was over five days before NOV26, in a life
 * that began by that clock. */
static void
live_first(uint64_t clock)
{
    struct saved_job job = { .spec = kept_spec, .owner = "ana", .text = "" };
    uint64_t age;

    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    ck_assert_uint_eq(live(clock, &age), clock);
    ck_assert_int_eq(journal_put_job(j, &job, NULL), 0);
    job.state = job.last.state = JOB_CANCELLED;
    job.end_ms = NOV26 - 5 * DAY;
    ck_assert_int_eq(journal_put_end(j, &job, NULL), 0);
}

LOOP_TEST(a_wrong_clock_makes_no_job_old, N_ELEM(pauses))
{
    uint64_t date, age;

    live_first(NOV26 - 6 * DAY);
    ck_assert_int_eq(journal_put_date(j, NOV26, NULL), 0);
    date = live(pauses[_i].clock, &age);
    ck_assert_uint_eq(date, pauses[_i].date);
    ck_assert_uint_eq(age, pauses[_i].age);
    /* the clock is put right while that life goes on for a day */
    ck_assert_int_eq(journal_put_date(j, date + DAY, NULL), 0);
    live(NOV26 + DAY, &age);
    ck_assert_uint_ge(age, pauses[_i].age + DAY);
    ck_assert_uint_le(age, pauses[_i].age + DAY + 12 * HOUR);
}

/* A life of which the database has no date but that of its beginning, as all
 * had before dates were put: its last jobs are new to the next life. */
TEST(no_date_is_moved_into_the_future)
{
    uint64_t age;

    live_first(NOV26 - 20 * DAY);
    live(NOV26, &age);
    ck_assert_uint_eq(age, 0);
    live(NOV26 + HOUR, &age);
    ck_assert_uint_eq(age, HOUR);
}

/* Times of a job that goes on: offered, submitted, opened, a unit's end. */
static int
note_times(void *arg, const struct saved_job *s, struct rad_error *err)
{
    uint64_t *ms = arg;

    (void)err;
    ck_assert_uint_eq(s->nunits, 1);
    ms[0] = s->offer_ms;
    ms[1] = s->submit_ms;
    ms[2] = s->open_ms;
    ms[3] = s->units[0].end_ms;
    return 0;
}

/* Else its statistics would have it take decades. */
TEST(the_dates_of_a_job_are_moved_alike)
{
    struct saved_job job = { .spec = kept_spec,
                             .owner = "ana",
                             .text = "",
                             .offer_ms = NOV26 - 5 * HOUR,
                             .submit_ms = NOV26 - 4 * HOUR,
                             .open_ms = NOV26 - 3 * HOUR };
    struct saved_unit u = { .area = { .width = W, .height = 3 },
                            .attempt = 1,
                            .tries = 1,
                            .worker = "ws1",
                            .stored = 3,
                            .now = 3,
                            .done = true,
                            .end_ms = NOV26 - 2 * HOUR };
    uint64_t date = NOV26 - DAY, epoch, ms[4];
    struct rad_error err = { 0 };

    ck_assert_int_eq(journal_open(&j, path, JOURNAL_MAKE, NULL), 0);
    ck_assert_int_eq(journal_begin_life(j, &date, &epoch, NULL), 0);
    ck_assert_int_eq(journal_put_job(j, &job, NULL), 0);
    ck_assert_int_eq(journal_put_unit(j, kept_job, &u, NULL), 0);
    ck_assert_int_eq(journal_put_rows(j, kept_job, &u, NULL), 0);
    ck_assert_int_eq(journal_put_date(j, NOV26, NULL), 0);
    date = NOV26 + 9999 * DAY;
    ck_assert_int_eq(journal_begin_life(j, &date, &epoch, NULL), 0);
    ck_assert_msg(journal_read(j, note_times, ms, &err) == 0, "%s", err.what);
    for (unsigned i = 0; i < 4; i++)
        ck_assert_uint_eq(ms[i], date - (17 - i) * HOUR);
}
