/* check_journal.c - the database is whole when it has its name, and a commit
 * lasts or fails */
#include "config.h"

#include "lives_fixture.h"

#include "journal/journal_impl.h"

#include <errno.h>
#include <stdio.h>
#include <sys/syscall.h>
#include <sysexits.h>

/* What writes and syncs fail with; 0: they do not. */
static _Atomic int write_fault, sync_fault;

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

FIXTURE(scratch_make, scratch_remove)

/* What a loss of power leaves of one that was being made is in nobody's way,
 * and one that has its name is whole, whatever becomes of its log. */
TEST(a_database_gets_its_name_when_it_is_whole)
{
    char path[160], made[170], log[170];
    struct journal *j;
    FILE *f;

    snprintf(path, sizeof path, "%s/radcoord.db", dir);
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
    journal_close(j);
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
    char path[160];
    struct journal *j;
    bool has;

    snprintf(path, sizeof path, "%s/radcoord.db", dir);
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
    journal_close(j);
}

/* The log is carried over into the database, for which there is no memory; what
 * is in the log lasts. */
TEST(a_commit_without_memory_for_more_is_one)
{
    static uint8_t bottom[60000];
    struct saved_job job = { .spec = kept_spec, .owner = "ana", .text = "" };
    struct saved_unit u = { .worker = "ws1",
                            .bottom = bottom,
                            .nbottom = sizeof bottom };
    struct rad_error err = { 0 };
    char path[160];
    struct journal *j;

    snprintf(path, sizeof path, "%s/radcoord.db", dir);
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
    journal_close(j);
}

/* A worker keeps rows until they are said to be kept. */
TEST(rows_that_could_not_be_synced_are_not_kept)
{
    struct heard h;
    uv_loop_t loop;
    struct store *s;

    open_kept(&loop, &s, &h);
    open_job(s);
    run(&loop, s);
    ck_assert_int_eq(h.jobs, 1);
    sync_fault = EIO;
    put_unit(s, kept_job, 0, 3, 3);
    run(&loop, s);
    sync_fault = 0;
    ck_assert(h.rows == 0 || h.status != 0);
    ck_assert_int_eq(h.broken, EX_IOERR);
    close_kept(&loop, s);
}
