/* journal.c - see journal.h
 *
 * A job's specification is kept as the bytes of its SUBMIT, counts and progress
 * as they travel in messages: so each has a single codec, which is fuzzed.
 * Unsigned numbers are kept as SQLite's integers of the same bits. */
#include "config.h"

#include "journal/journal.h"

#include "journal/journal_impl.h"

#include "ground/disk.h"
#include "proto/frame.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define APPLICATION 0x72616464 /* "radd" */
#define SCHEMA      8          /* version of the tables and what they hold */
#define WAL_PAGES   1000       /* pages in the log before it is carried over */

/* --- errors --- */

/* The system's number of the last failure at the log's file, or else at the
 * database's; 0: none failed since the file was opened. */
static int
file_error(struct journal *j)
{
    sqlite3_file *log = NULL;
    int number = 0;

    sqlite3_file_control(j->db, "main", SQLITE_FCNTL_JOURNAL_POINTER, &log);
    if (log && log->pMethods)
        log->pMethods->xFileControl(log, SQLITE_FCNTL_LAST_ERRNO, &number);
    if (number == 0)
        sqlite3_file_control(j->db, "main", SQLITE_FCNTL_LAST_ERRNO, &number);
    return number;
}

/* The system's number of the last error.  SQLite does not note it when COMMIT
 * fails, but the log's file has it. */
static int
system_error(struct journal *j)
{
    int number = sqlite3_system_errno(j->db);

    return number ? number : file_error(j);
}

/* Why is the database, or its log, open for reading alone?  SQLite opens a file
 * so if it cannot be opened for writing, and forgets why. */
static int
unwritable(struct journal *j)
{
    const char *path = sqlite3_db_filename(j->db, "main");
    bool denied = access(path, W_OK) < 0;

    if (!denied && access(sqlite3_filename_wal(path), W_OK) < 0)
        denied = errno != ENOENT;
    return denied ? disk_code(errno) : RAD_EIO;
}

static int
code_of(struct journal *j, int rc)
{
    if (rc == SQLITE_IOERR_NOMEM)
        return RAD_ENOMEM;
    switch (rc & 0xff) {
    case SQLITE_FULL:
        return RAD_EFULL;
    case SQLITE_PERM:
        return RAD_EPERM;
    case SQLITE_READONLY:
        return unwritable(j);
    case SQLITE_NOMEM:
        return RAD_ENOMEM;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
        return RAD_ETEMPFAIL;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_SCHEMA:
    case SQLITE_MISMATCH:
    case SQLITE_ERROR: /* a table is not as journal_schema makes it */
    case SQLITE_CONSTRAINT:
        return RAD_EDATA;
    case SQLITE_CANTOPEN:
        return disk_code(system_error(j));
    case SQLITE_IOERR:
        return rc == SQLITE_IOERR_FSYNC || rc == SQLITE_IOERR_DIR_FSYNC
                   ? RAD_EIO
                   : disk_code(system_error(j));
    default:
        return RAD_EIO;
    }
}

int
journal_failed(struct journal *j, int rc, struct rad_error *err)
{
    int code = code_of(j, rc), kind = rc & 0xff;
    bool by_system = kind == SQLITE_IOERR || kind == SQLITE_CANTOPEN;
    int number = by_system ? system_error(j) : 0;

    /* for want of room or memory SQLite may undo the whole transaction */
    if (j->in_transaction && sqlite3_get_autocommit(j->db))
        j->undone = code;
    return rad_fail(err, code, "database: %s%s%s", sqlite3_errmsg(j->db),
                    number ? ": " : "", number ? strerror(number) : "");
}

static int
exec(struct journal *j, const char *text, struct rad_error *err)
{
    int rc = sqlite3_exec(j->db, text, NULL, NULL, NULL);

    return rc == SQLITE_OK ? 0 : journal_failed(j, rc, err);
}

/* --- statements --- */

sqlite3_stmt *
journal_statement(struct journal *j, enum journal_sql what,
                  struct rad_error *err)
{
    int rc;

    if (!j->stmt[what]) {
        rc =
            sqlite3_prepare_v3(j->db, journal_sql[what], -1,
                               SQLITE_PREPARE_PERSISTENT, &j->stmt[what], NULL);
        if (rc != SQLITE_OK) {
            journal_failed(j, rc, err);
            return NULL;
        }
    }
    sqlite3_reset(j->stmt[what]);
    sqlite3_clear_bindings(j->stmt[what]);
    return j->stmt[what];
}

int
journal_run(struct journal *j, sqlite3_stmt *s, struct rad_error *err)
{
    int rc = sqlite3_step(s);

    if (rc == SQLITE_DONE || rc == SQLITE_ROW)
        rc = 0;
    else
        rc = journal_failed(j, rc, err);
    sqlite3_reset(s);
    return rc;
}

static int
run_plain(struct journal *j, enum journal_sql what, struct rad_error *err)
{
    sqlite3_stmt *s = journal_statement(j, what, err);

    return s ? journal_run(j, s, err) : err->code;
}

sqlite3_stmt *
journal_writer(struct journal *j, enum journal_sql what, struct rad_error *err)
{
    if (!j->in_transaction) {
        if (run_plain(j, SQL_BEGIN, err) < 0)
            return NULL;
        j->in_transaction = true;
    }
    return journal_statement(j, what, err);
}

/* --- opening --- */

static int
one_number(struct journal *j, const char *text, sqlite3_int64 *n,
           struct rad_error *err)
{
    sqlite3_stmt *s;
    int rc = sqlite3_prepare_v2(j->db, text, -1, &s, NULL);

    if (rc != SQLITE_OK)
        return journal_failed(j, rc, err);
    rc = sqlite3_step(s);
    if (rc == SQLITE_ROW) {
        *n = sqlite3_column_int64(s, 0);
        rc = 0;
    } else {
        rc = journal_failed(j, rc, err);
    }
    sqlite3_finalize(s);
    return rc;
}

static int
make(struct journal *j, struct rad_error *err)
{
    char text[80];
    int rc = exec(j, "BEGIN IMMEDIATE", err);

    sqlite3_snprintf(sizeof text, text,
                     "PRAGMA application_id = %d; PRAGMA user_version = %d",
                     APPLICATION, SCHEMA);
    if (rc == 0)
        rc = exec(j, journal_schema, err);
    if (rc == 0)
        rc = exec(j, text, err);
    return rc == 0 ? exec(j, "COMMIT", err) : rc;
}

/* Refuse tables of another version: they are not damaged, but we do not know
 * how to read them. */
static int
check_version(sqlite3_int64 version, struct rad_error *err)
{
    if (version == SCHEMA)
        return 0;
    return rad_fail(err, RAD_EUNSUPPORTED,
                    "database: of version %lld, made by %s radcoord, where "
                    "this one's is %d: let that one finish its jobs, then "
                    "move the folder away",
                    (long long)version,
                    version < SCHEMA ? "an older" : "a newer", SCHEMA);
}

static int
look(struct journal *j, enum journal_how how, struct rad_error *err)
{
    sqlite3_int64 tables = 0, application = 0, version = 0;
    int rc = one_number(j, "SELECT count(*) FROM sqlite_master", &tables, err);

    if (rc == 0 && tables == 0 && how == JOURNAL_MAKE)
        return make(j, err);
    if (rc == 0)
        rc = one_number(j, "PRAGMA application_id", &application, err);
    if (rc == 0)
        rc = one_number(j, "PRAGMA user_version", &version, err);
    if (rc == 0 && (tables == 0 || application != APPLICATION))
        rc = rad_fail(err, RAD_EDATA, "database: not one of radcoord");
    return rc == 0 ? check_version(version, err) : rc;
}

static int
on_wal(void *arg, sqlite3 *db, const char *name, int pages)
{
    struct journal *j = arg;

    (void)db;
    (void)name;
    j->wal_pages = pages;
    return SQLITE_OK;
}

/* Set the database's modes and look what it is.  The lock is exclusive, so no
 * other process may write, and SQLite needs no file of shared memory, which
 * would not be synced with the rest. */
static int
set_up(struct journal *j, enum journal_how how, struct rad_error *err)
{
    int rc = exec(j, "PRAGMA locking_mode = EXCLUSIVE", err);

    if (rc == 0 && how != JOURNAL_READ)
        rc = exec(j,
                  "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;"
                  "PRAGMA wal_autocheckpoint = 0;"
                  "PRAGMA journal_size_limit = 4194304",
                  err);
    if (j->had_log) /* the log stays as it is until something is committed */
        sqlite3_db_config(j->db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
    if (rc == 0)
        rc = exec(j, "PRAGMA temp_store = MEMORY; PRAGMA trusted_schema = OFF",
                  err);
    if (rc == 0)
        sqlite3_wal_hook(j->db, on_wal, j);
    return rc == 0 ? look(j, how, err) : rc;
}

static bool
has_log(const char *path)
{
    char log[DISK_PATH_MAX + 8];

    snprintf(log, sizeof log, "%s-wal", path);
    return access(log, F_OK) == 0;
}

/* Make an empty file that only its owner may read: SQLite would let all users
 * read it. */
static int
make_private(const char *path, struct rad_error *err)
{
    int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);

    if (fd < 0)
        return disk_fail(err, errno, "create", path);
    close(fd);
    return 0;
}

/* Make a database without jobs at path, whole and synced.  No log is needed
 * meanwhile: the file has a name of its own until it is whole. */
static int
make_at(const char *path, struct rad_error *err)
{
    struct journal j = { 0 };
    int rc = make_private(path, err);

    if (rc < 0)
        return rc;
    if (sqlite3_open_v2(path, &j.db, SQLITE_OPEN_READWRITE, NULL) != SQLITE_OK)
        rc = j.db ? journal_failed(&j, sqlite3_errcode(j.db), err)
                  : rad_fail_memory(err);
    if (rc == 0)
        rc = exec(&j, "PRAGMA journal_mode = OFF", err);
    if (rc == 0)
        rc = make(&j, err);
    sqlite3_close(j.db);
    return rc == 0 ? disk_sync_path(path, err) : rc;
}

/* If there is no database at path, make one beside it and rename that.  Made in
 * its place it could be there in part after a loss of power, and would be taken
 * for damaged.  One that cannot be looked at may be there. */
static int
make_whole(const char *path, struct rad_error *err)
{
    char made[DISK_PATH_MAX + 8];
    struct stat st;
    bool there = stat(path, &st) == 0;
    int rc;

    if (!there && errno != ENOENT)
        return disk_fail(err, errno, "look at", path);
    if (there && st.st_size > 0)
        return 0;
    snprintf(made, sizeof made, "%s.new", path);
    if (unlink(made) < 0 && errno != ENOENT)
        return disk_fail(err, errno, "remove", made);
    rc = make_at(made, err);
    if (rc == 0 && rename(made, path) < 0)
        rc = disk_fail(err, errno, "rename", made);
    if (rc < 0)
        unlink(made);
    return rc == 0 ? disk_sync_dir_of(path, err) : rc;
}

int
journal_open(struct journal **out, const char *path, enum journal_how how,
             struct rad_error *err)
{
    struct journal *j = calloc(1, sizeof *j);
    int rc;

    *out = NULL;
    if (!j)
        return rad_fail_memory(err);
    wire_out_init(&j->out, MSG_FRAME_MAX);
    j->out.version = JOURNAL_LAYOUT;
    j->had_log = has_log(path);
    if (how == JOURNAL_MAKE && make_whole(path, err) < 0) {
        journal_close(j);
        return err->code;
    }
    rc = sqlite3_open_v2(path, &j->db,
                         SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, NULL);
    if (rc != SQLITE_OK) {
        rc = j->db ? journal_failed(j, rc, err) : rad_fail_memory(err);
    } else {
        sqlite3_extended_result_codes(j->db, 1); /* for code_of() */
        rc = set_up(j, how, err);
    }
    if (rc == RAD_EUNSUPPORTED)
        rad_error_where(err, "%.200s", path);
    if (rc < 0) {
        journal_close(j);
        return rc;
    }
    *out = j;
    return 0;
}

void
journal_close(struct journal *j)
{
    if (!j)
        return;
    for (int i = 0; i < NSQL; i++)
        sqlite3_finalize(j->stmt[i]);
    sqlite3_close(j->db);
    wire_out_release(&j->out);
    free(j);
}

int
journal_check(struct journal *j, struct rad_error *err)
{
    sqlite3_stmt *s;
    int rc =
        sqlite3_prepare_v2(j->db, "PRAGMA integrity_check(1)", -1, &s, NULL);
    const char *text;
    int number;

    if (rc != SQLITE_OK)
        return journal_failed(j, rc, err);
    rc = sqlite3_step(s);
    number = file_error(j); /* a page that cannot be read is no damaged one */
    text = rc == SQLITE_ROW ? (const char *)sqlite3_column_text(s, 0) : NULL;
    if (rc != SQLITE_ROW)
        rc = journal_failed(j, rc, err);
    else if (number != 0)
        rc = rad_fail(err, disk_code(number), "database: cannot read: %s",
                      strerror(number));
    else if (!text || strcmp(text, "ok") != 0)
        rc = rad_fail(err, RAD_EDATA, "database: %.200s", text ? text : "?");
    else
        rc = 0;
    sqlite3_finalize(s);
    return rc;
}

/* --- transactions --- */

/* May the failure pass: does the disk lack room, or are memory or descriptors
 * short? */
static bool
may_pass(int code)
{
    return code == RAD_EFULL || code == RAD_ENOMEM || code == RAD_ESHORT;
}

/* Carry the log's pages over into the database.  For such a lack they may stay
 * in the log: what is committed lasts there, too. */
static int
check_point(struct journal *j, int mode, struct rad_error *err)
{
    int rc = sqlite3_wal_checkpoint_v2(j->db, NULL, mode, NULL, NULL);

    if (rc == SQLITE_OK || (rc & 0xff) == SQLITE_BUSY ||
        may_pass(code_of(j, rc)))
        return 0;
    return journal_failed(j, rc, err);
}

int
journal_commit(struct journal *j, struct rad_error *err)
{
    int rc;

    if (j->undone)
        return rad_fail(err, j->undone, "database: what was noted is undone");
    if (!j->in_transaction)
        return 0;
    rc = run_plain(j, SQL_COMMIT, err);
    if (rc < 0)
        return rc;
    j->in_transaction = false;
    sqlite3_db_config(j->db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 0, NULL);
    if (j->crammed)
        return journal_give_room(j, err);
    return j->wal_pages < WAL_PAGES
               ? 0
               : check_point(j, SQLITE_CHECKPOINT_PASSIVE, err);
}

/* A transaction of its own connection would keep SQLite from it. */
int
journal_give_room(struct journal *j, struct rad_error *err)
{
    j->crammed = j->in_transaction;
    return j->crammed ? 0 : check_point(j, SQLITE_CHECKPOINT_TRUNCATE, err);
}

void
journal_rollback(struct journal *j)
{
    if (j->in_transaction)
        sqlite3_exec(j->db, "ROLLBACK", NULL, NULL, NULL);
    j->in_transaction = false;
    j->undone = 0;
}
