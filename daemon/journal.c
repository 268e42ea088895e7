/* journal.c - see journal.h
 *
 * The specification of a job is kept as its SUBMIT, counts and progress as they
 * travel, so there is one codec for each, and it is fuzzed.  Numbers that have
 * no sign are kept as SQLite's integers of the same bits. */
#include "config.h"

#include "journal.h"

#include "codec.h"
#include "frame.h"
#include "job.h"

#include <errno.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

#define APPLICATION 0x72616464 /* "radd" */
#define SCHEMA      3
#define LAYOUT      2    /* version of the protocol whose bytes are kept */
#define WAL_PAGES   1000 /* in the log before it is carried over */

static const char schema[] =
    "CREATE TABLE life (epoch INTEGER PRIMARY KEY, began_ms INTEGER NOT NULL);"
    "CREATE TABLE job ("
    " n INTEGER PRIMARY KEY, id BLOB NOT NULL UNIQUE, owner TEXT NOT NULL,"
    " spec BLOB NOT NULL, epoch INTEGER NOT NULL, state INTEGER NOT NULL,"
    " status INTEGER NOT NULL, text TEXT NOT NULL, offer_ms INTEGER NOT NULL,"
    " submit_ms INTEGER NOT NULL, open_ms INTEGER NOT NULL,"
    " end_ms INTEGER NOT NULL, sent_bytes INTEGER NOT NULL,"
    " kept_bytes INTEGER NOT NULL, progress BLOB);"
    "CREATE TABLE unit ("
    " job INTEGER NOT NULL, unit INTEGER NOT NULL, frame INTEGER NOT NULL,"
    " x INTEGER NOT NULL, y INTEGER NOT NULL, width INTEGER NOT NULL,"
    " height INTEGER NOT NULL, attempt INTEGER NOT NULL,"
    " tries INTEGER NOT NULL, worker TEXT NOT NULL,"
    " fingerprint INTEGER NOT NULL, stored INTEGER NOT NULL DEFAULT 0,"
    " sum INTEGER NOT NULL DEFAULT 0,"
    " done INTEGER NOT NULL DEFAULT 0, end_ms INTEGER NOT NULL DEFAULT 0,"
    " counts BLOB, bottom BLOB, PRIMARY KEY (job, unit)) WITHOUT ROWID;"
    "CREATE TABLE frame (job INTEGER NOT NULL, frame INTEGER NOT NULL,"
    " PRIMARY KEY (job, frame)) WITHOUT ROWID;";

#define N_OF_JOB "(SELECT n FROM job WHERE id = ?1)"

enum what {
    BEGIN,
    COMMIT,
    PUT_LIFE,
    LAST_LIFE,
    PUT_JOB,
    PUT_STATE,
    PUT_END,
    PUT_UNIT,
    PUT_ROWS,
    PUT_FRAME,
    DROP_UNITS,
    DROP_FRAMES,
    DROP_JOB,
    HAS,
    JOBS,
    LIVES,
    UNITS,
    FRAMES,
    NWHAT
};

static const char *const sql[NWHAT] = {
    [BEGIN] = "BEGIN IMMEDIATE",
    [COMMIT] = "COMMIT",
    [PUT_LIFE] = "INSERT INTO life VALUES (?1, ?2)",
    [LAST_LIFE] = "SELECT ifnull(max(epoch), 0) FROM life",
    [PUT_JOB] =
        "INSERT INTO job (id, owner, spec, epoch, state, status,"
        " text, offer_ms, submit_ms, open_ms, end_ms, sent_bytes, kept_bytes)"
        " VALUES (?1, ?2, ?3, (SELECT ifnull(max(epoch), 0) FROM life),"
        " ?4, 0, '', ?5, ?6, ?7, 0, ?8, 0) ON CONFLICT (id) DO NOTHING",
    [PUT_STATE] = "UPDATE job SET state = ?2 WHERE id = ?1",
    [PUT_END] = "UPDATE job SET state = ?2, status = ?3, text = ?4,"
                " end_ms = ?5, kept_bytes = ?6, progress = ?7 WHERE id = ?1",
    [PUT_UNIT] =
        "INSERT INTO unit (job, unit, frame, x, y, width, height, attempt,"
        " tries, worker, fingerprint) VALUES (" N_OF_JOB ", ?2, ?3, ?4, ?5,"
        " ?6, ?7, ?8, ?9, ?10, ?11)"
        " ON CONFLICT DO UPDATE SET frame = ?3, x = ?4, y = ?5, width = ?6,"
        " height = ?7, tries = ?9, worker = ?10, fingerprint = ?11,"
        " stored = CASE attempt WHEN ?8 THEN stored ELSE 0 END,"
        " sum = CASE attempt WHEN ?8 THEN sum ELSE 0 END,"
        " done = CASE attempt WHEN ?8 THEN done ELSE 0 END, attempt = ?8",
    /* exclusive or of sums is what SQLite has no word for; the first rows of
     * an attempt begin anew */
    [PUT_ROWS] = "UPDATE unit SET attempt = ?3, stored = ?4, done = ?5,"
                 " end_ms = ?6, counts = ?7, bottom = ?8,"
                 " sum = CASE ?4 WHEN ?10 THEN ?9"
                 " ELSE (sum | ?9) - (sum & ?9) END"
                 " WHERE job = " N_OF_JOB " AND unit = ?2",
    [PUT_FRAME] = "INSERT INTO frame VALUES (" N_OF_JOB ", ?2)"
                  " ON CONFLICT DO NOTHING",
    [DROP_UNITS] = "DELETE FROM unit WHERE job = " N_OF_JOB,
    [DROP_FRAMES] = "DELETE FROM frame WHERE job = " N_OF_JOB,
    [DROP_JOB] = "DELETE FROM job WHERE id = ?1",
    [HAS] = "SELECT 1 FROM job WHERE id = ?1",
    [JOBS] = "SELECT n, id, owner, spec, epoch, state, status, text, offer_ms,"
             " submit_ms, open_ms, end_ms, sent_bytes, kept_bytes, progress"
             " FROM job ORDER BY n",
    [LIVES] = "SELECT count(*) FROM life WHERE epoch > ?1",
    [UNITS] = "SELECT unit, frame, x, y, width, height, attempt, tries, worker,"
              " fingerprint, stored, done, end_ms, counts, bottom, sum"
              " FROM unit WHERE job = ?1 ORDER BY unit",
    [FRAMES] = "SELECT frame FROM frame WHERE job = ?1 ORDER BY frame",
};

struct journal {
    sqlite3 *db;
    sqlite3_stmt *stmt[NWHAT];
    struct wire_out out;
    bool in_transaction;
    int wal_pages; /* in the log */
};

/* --- errors --- */

static int
code_of(struct journal *j, int rc)
{
    int number = sqlite3_system_errno(j->db);

    switch (rc & 0xff) {
    case SQLITE_FULL:
        return RAD_EFULL;
    case SQLITE_NOMEM:
        return RAD_ENOMEM;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
        return RAD_ETEMPFAIL;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_SCHEMA:
    case SQLITE_MISMATCH:
    case SQLITE_ERROR: /* a table is not as it was made */
    case SQLITE_CONSTRAINT:
        return RAD_EDATA;
    case SQLITE_IOERR:
        return rc != SQLITE_IOERR_FSYNC && rc != SQLITE_IOERR_DIR_FSYNC &&
                       (number == ENOSPC || number == EDQUOT)
                   ? RAD_EFULL
                   : RAD_EIO;
    default:
        return RAD_EIO;
    }
}

static int
failed(struct journal *j, int rc, struct rad_error *err)
{
    return rad_fail(err, code_of(j, rc), "database: %s", sqlite3_errmsg(j->db));
}

static int
exec(struct journal *j, const char *text, struct rad_error *err)
{
    int rc = sqlite3_exec(j->db, text, NULL, NULL, NULL);

    return rc == SQLITE_OK ? 0 : failed(j, rc, err);
}

/* --- statements --- */

/* The statement, ready to be bound; NULL with *err. */
static sqlite3_stmt *
statement(struct journal *j, enum what what, struct rad_error *err)
{
    int rc;

    if (!j->stmt[what]) {
        rc = sqlite3_prepare_v3(j->db, sql[what], -1, SQLITE_PREPARE_PERSISTENT,
                                &j->stmt[what], NULL);
        if (rc != SQLITE_OK) {
            failed(j, rc, err);
            return NULL;
        }
    }
    sqlite3_reset(j->stmt[what]);
    sqlite3_clear_bindings(j->stmt[what]);
    return j->stmt[what];
}

/* Run it, without rows. */
static int
run(struct journal *j, sqlite3_stmt *s, struct rad_error *err)
{
    int rc = sqlite3_step(s);

    if (rc == SQLITE_DONE || rc == SQLITE_ROW)
        rc = 0;
    else
        rc = failed(j, rc, err);
    sqlite3_reset(s);
    return rc;
}

static int
run_plain(struct journal *j, enum what what, struct rad_error *err)
{
    sqlite3_stmt *s = statement(j, what, err);

    return s ? run(j, s, err) : err->code;
}

/* One that writes, in a transaction; NULL with *err. */
static sqlite3_stmt *
writer(struct journal *j, enum what what, struct rad_error *err)
{
    if (!j->in_transaction) {
        if (run_plain(j, BEGIN, err) < 0)
            return NULL;
        j->in_transaction = true;
    }
    return statement(j, what, err);
}

static sqlite3_stmt *
writer_of(struct journal *j, enum what what, const uint8_t job[MSG_JOB],
          struct rad_error *err)
{
    sqlite3_stmt *s = writer(j, what, err);

    if (s)
        sqlite3_bind_blob(s, 1, job, MSG_JOB, SQLITE_STATIC);
    return s;
}

static void
bind_u64(sqlite3_stmt *s, int i, uint64_t v)
{
    sqlite3_bind_int64(s, i, (sqlite3_int64)v);
}

static void
bind_text(sqlite3_stmt *s, int i, const char *text)
{
    sqlite3_bind_text(s, i, text, -1, SQLITE_STATIC);
}

/* Run it; it must have changed something. */
static int
change(struct journal *j, sqlite3_stmt *s, struct rad_error *err)
{
    int rc = run(j, s, err);

    if (rc == 0 && sqlite3_changes(j->db) == 0)
        rc = rad_fail(err, RAD_EDATA, "database: no such job or unit");
    return rc;
}

/* --- opening --- */

static int
one_number(struct journal *j, const char *text, sqlite3_int64 *n,
           struct rad_error *err)
{
    sqlite3_stmt *s;
    int rc = sqlite3_prepare_v2(j->db, text, -1, &s, NULL);

    if (rc != SQLITE_OK)
        return failed(j, rc, err);
    rc = sqlite3_step(s);
    if (rc == SQLITE_ROW) {
        *n = sqlite3_column_int64(s, 0);
        rc = 0;
    } else {
        rc = failed(j, rc, err);
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
        rc = exec(j, schema, err);
    if (rc == 0)
        rc = exec(j, text, err);
    return rc == 0 ? exec(j, "COMMIT", err) : rc;
}

/* Not damaged, but not to be read either. */
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
    sqlite3_int64 tables, application, version;
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

/* Exclusive: no other process may write, and there is no shared memory file
 * that would not be synced with the rest. */
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
    if (how == JOURNAL_READ) /* the log stays as it is */
        sqlite3_db_config(j->db, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, NULL);
    if (rc == 0)
        rc = exec(j, "PRAGMA temp_store = MEMORY; PRAGMA trusted_schema = OFF",
                  err);
    if (rc == 0)
        sqlite3_wal_hook(j->db, on_wal, j);
    return rc == 0 ? look(j, how, err) : rc;
}

int
journal_open(struct journal **out, const char *path, enum journal_how how,
             struct rad_error *err)
{
    static const int flags[] = {
        [JOURNAL_MAKE] = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE,
        [JOURNAL_OPEN] = SQLITE_OPEN_READWRITE,
        [JOURNAL_READ] = SQLITE_OPEN_READWRITE,
    };
    struct journal *j = calloc(1, sizeof *j);
    int rc;

    *out = NULL;
    if (!j)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    wire_out_init(&j->out, MSG_FRAME_MAX);
    j->out.version = LAYOUT;
    rc = sqlite3_open_v2(path, &j->db, flags[how] | SQLITE_OPEN_NOMUTEX, NULL);
    if (rc != SQLITE_OK)
        rc = j->db ? failed(j, rc, err)
                   : rad_fail(err, RAD_ENOMEM, "out of memory");
    else
        rc = set_up(j, how, err);
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
    for (int i = 0; i < NWHAT; i++)
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

    if (rc != SQLITE_OK)
        return failed(j, rc, err);
    rc = sqlite3_step(s);
    text = rc == SQLITE_ROW ? (const char *)sqlite3_column_text(s, 0) : NULL;
    if (rc != SQLITE_ROW)
        rc = failed(j, rc, err);
    else if (!text || strcmp(text, "ok") != 0)
        rc = rad_fail(err, RAD_EDATA, "database: %.200s", text ? text : "?");
    else
        rc = 0;
    sqlite3_finalize(s);
    return rc;
}

int
journal_begin_life(struct journal *j, uint64_t now_ms, uint64_t *epoch,
                   struct rad_error *err)
{
    sqlite3_stmt *s = writer(j, LAST_LIFE, err);
    uint64_t last;
    int rc;

    if (!s)
        return err->code;
    rc = sqlite3_step(s);
    if (rc != SQLITE_ROW) {
        rc = failed(j, rc, err);
        sqlite3_reset(s);
        return rc;
    }
    last = (uint64_t)sqlite3_column_int64(s, 0);
    sqlite3_reset(s);
    *epoch = now_ms > last ? now_ms : last + 1;
    s = writer(j, PUT_LIFE, err);
    if (!s)
        return err->code;
    bind_u64(s, 1, *epoch);
    bind_u64(s, 2, now_ms);
    rc = run(j, s, err);
    return rc == 0 ? journal_commit(j, err) : rc;
}

/* --- putting --- */

/* The payload of a message, in j->out behind the header. */
static int
pack(struct journal *j, const struct msg *m, struct rad_error *err)
{
    j->out.len = 0;
    j->out.bad = false;
    if (msg_pack_as(LAYOUT, &j->out, m) != 0)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    return 0;
}

static void
bind_payload(const struct journal *j, sqlite3_stmt *s, int i)
{
    sqlite3_bind_blob(s, i, j->out.buf + MSG_HEADER,
                      (int)(j->out.len - MSG_HEADER), SQLITE_STATIC);
}

int
journal_put_job(struct journal *j, const struct saved_job *saved,
                struct rad_error *err)
{
    struct msg m = { .type = MSG_SUBMIT, .submit = saved->spec };
    sqlite3_stmt *s = writer_of(j, PUT_JOB, saved->spec.job, err);

    if (!s || pack(j, &m, err) < 0)
        return err->code;
    bind_text(s, 2, saved->owner);
    bind_payload(j, s, 3);
    sqlite3_bind_int(s, 4, saved->state);
    bind_u64(s, 5, saved->offer_ms);
    bind_u64(s, 6, saved->submit_ms);
    bind_u64(s, 7, saved->open_ms);
    bind_u64(s, 8, saved->sent_bytes);
    return run(j, s, err);
}

int
journal_put_state(struct journal *j, const uint8_t job[MSG_JOB], int state,
                  struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, PUT_STATE, job, err);

    if (!s)
        return err->code;
    sqlite3_bind_int(s, 2, state);
    return run(j, s, err);
}

static int
drop(struct journal *j, enum what what, const uint8_t job[MSG_JOB],
     struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, what, job, err);

    return s ? run(j, s, err) : err->code;
}

int
journal_put_end(struct journal *j, const struct saved_job *saved,
                struct rad_error *err)
{
    struct msg m = { .type = MSG_PROGRESS, .progress = saved->last };
    sqlite3_stmt *s = writer_of(j, PUT_END, saved->spec.job, err);
    int rc;

    if (!s || pack(j, &m, err) < 0)
        return err->code;
    sqlite3_bind_int(s, 2, saved->state);
    sqlite3_bind_int(s, 3, saved->status);
    bind_text(s, 4, saved->text);
    bind_u64(s, 5, saved->end_ms);
    bind_u64(s, 6, saved->kept_bytes);
    bind_payload(j, s, 7);
    rc = run(j, s, err);
    return rc == 0 ? drop(j, DROP_UNITS, saved->spec.job, err) : rc;
}

int
journal_put_unit(struct journal *j, const uint8_t job[MSG_JOB],
                 const struct saved_unit *u, struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, PUT_UNIT, job, err);

    if (!s)
        return err->code;
    bind_u64(s, 2, u->unit);
    bind_u64(s, 3, u->area.frame);
    bind_u64(s, 4, u->area.x);
    bind_u64(s, 5, u->area.y);
    bind_u64(s, 6, u->area.width);
    bind_u64(s, 7, u->area.height);
    bind_u64(s, 8, u->attempt);
    bind_u64(s, 9, u->tries);
    bind_text(s, 10, u->worker);
    bind_u64(s, 11, u->fingerprint);
    return run(j, s, err);
}

static void
bind_counts(struct journal *j, sqlite3_stmt *s, int i,
            const struct msg_counts *counts)
{
    j->out.len = 0;
    j->out.bad = false;
    msg_put_counts(&j->out, counts);
    if (!j->out.bad)
        sqlite3_bind_blob(s, i, j->out.buf, (int)j->out.len, SQLITE_STATIC);
}

int
journal_put_rows(struct journal *j, const uint8_t job[MSG_JOB],
                 const struct saved_unit *u, struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, PUT_ROWS, job, err);

    if (!s)
        return err->code;
    bind_u64(s, 2, u->unit);
    bind_u64(s, 3, u->attempt);
    bind_u64(s, 4, u->stored);
    sqlite3_bind_int(s, 5, u->done);
    bind_u64(s, 6, u->end_ms);
    if (u->done)
        bind_counts(j, s, 7, &u->counts);
    if (j->out.bad)
        return rad_fail(err, RAD_ENOMEM, "out of memory");
    if (u->nbottom > 0)
        sqlite3_bind_blob(s, 8, u->bottom, (int)u->nbottom, SQLITE_STATIC);
    bind_u64(s, 9, u->sum);
    bind_u64(s, 10, u->now);
    return change(j, s, err);
}

int
journal_put_frame(struct journal *j, const uint8_t job[MSG_JOB], uint32_t frame,
                  struct rad_error *err)
{
    sqlite3_stmt *s = writer_of(j, PUT_FRAME, job, err);

    if (!s)
        return err->code;
    bind_u64(s, 2, frame);
    return run(j, s, err);
}

int
journal_forget(struct journal *j, const uint8_t job[MSG_JOB],
               struct rad_error *err)
{
    int rc = drop(j, DROP_UNITS, job, err);

    if (rc == 0)
        rc = drop(j, DROP_FRAMES, job, err);
    return rc == 0 ? drop(j, DROP_JOB, job, err) : rc;
}

/* Carry what is in the log over into the database.  For want of room it may
 * stay there. */
static int
check_point(struct journal *j, struct rad_error *err)
{
    int rc;

    if (j->wal_pages < WAL_PAGES)
        return 0;
    rc = sqlite3_wal_checkpoint_v2(j->db, NULL, SQLITE_CHECKPOINT_PASSIVE, NULL,
                                   NULL);
    if (rc == SQLITE_OK || rc == SQLITE_BUSY || code_of(j, rc) == RAD_EFULL)
        return 0;
    return failed(j, rc, err);
}

int
journal_commit(struct journal *j, struct rad_error *err)
{
    int rc;

    if (!j->in_transaction)
        return 0;
    rc = run_plain(j, COMMIT, err);
    if (rc < 0)
        return rc;
    j->in_transaction = false;
    return check_point(j, err);
}

void
journal_rollback(struct journal *j)
{
    if (j->in_transaction)
        sqlite3_exec(j->db, "ROLLBACK", NULL, NULL, NULL);
    j->in_transaction = false;
}

/* --- reading --- */

int
journal_has(struct journal *j, const uint8_t job[MSG_JOB], bool *has,
            struct rad_error *err)
{
    sqlite3_stmt *s = statement(j, HAS, err);
    int rc;

    if (!s)
        return err->code;
    sqlite3_bind_blob(s, 1, job, MSG_JOB, SQLITE_STATIC);
    rc = sqlite3_step(s);
    *has = rc == SQLITE_ROW;
    sqlite3_reset(s);
    return rc == SQLITE_ROW || rc == SQLITE_DONE ? 0 : failed(j, rc, err);
}

/* What is wrong with a row, as an error. */
static int
bad(struct rad_error *err, const char *what, sqlite3_int64 n)
{
    return rad_fail(err, RAD_EDATA, "database: %s of job %lld cannot be", what,
                    (long long)n);
}

static bool
get_u32(sqlite3_stmt *s, int i, uint32_t *v)
{
    sqlite3_int64 n = sqlite3_column_int64(s, i);

    *v = (uint32_t)n;
    return sqlite3_column_type(s, i) == SQLITE_INTEGER && n >= 0 &&
           n <= UINT32_MAX;
}

static bool
get_u64(sqlite3_stmt *s, int i, uint64_t *v)
{
    *v = (uint64_t)sqlite3_column_int64(s, i);
    return sqlite3_column_type(s, i) == SQLITE_INTEGER;
}

/* A text of so many bytes at most, without a NUL in it; valid until the next
 * row. */
static bool
get_text(sqlite3_stmt *s, int i, size_t max, const char **text)
{
    *text = sqlite3_column_type(s, i) == SQLITE_TEXT
                ? (const char *)sqlite3_column_text(s, i)
                : NULL;
    return *text && (size_t)sqlite3_column_bytes(s, i) <= max &&
           strlen(*text) == (size_t)sqlite3_column_bytes(s, i);
}

/* NULL and 0 for none. */
static bool
get_blob(sqlite3_stmt *s, int i, const uint8_t **v, size_t *n)
{
    int type = sqlite3_column_type(s, i);

    *v = sqlite3_column_blob(s, i);
    *n = (size_t)sqlite3_column_bytes(s, i);
    return type == SQLITE_BLOB || type == SQLITE_NULL;
}

/* One job as it is read. */
struct reading {
    struct journal *j;
    sqlite3_int64 n; /* its number */
    struct saved_job saved;
    struct msg spec, progress;
    bool *written;
    struct saved_unit *units;
    uint32_t cap;
    struct rad_arena mem; /* texts and blobs of units */
    struct rad_error *err;
};

static bool
get_counts(struct msg_counts *c, const uint8_t *v, size_t n)
{
    struct wire_in in;

    wire_in_init(&in, v, n);
    in.version = LAYOUT;
    msg_get_counts(&in, c);
    return !in.bad && wire_left(&in) == 0;
}

static bool
is_unit(const struct reading *r, const struct saved_unit *u)
{
    const struct msg_spec *spec = &r->saved.spec;
    uint32_t before = r->saved.nunits;

    return u->area.frame < spec->nframes && u->area.width > 0 &&
           u->area.height > 0 && u->unit < PARTITION_MAX_LINES &&
           (before == 0 || u->unit > r->units[before - 1].unit) &&
           u->area.width <= MSG_MAX_SIDE && u->area.height <= MSG_MAX_SIDE;
}

/* A row of UNITS; false: it cannot be. */
static bool
get_unit(const struct reading *r, sqlite3_stmt *s, struct saved_unit *u)
{
    const uint8_t *counts, *bottom;
    size_t ncounts, nbottom;
    uint32_t done;
    bool ok = get_u32(s, 0, &u->unit) && get_u32(s, 1, &u->area.frame) &&
              get_u32(s, 2, &u->area.x) && get_u32(s, 3, &u->area.y) &&
              get_u32(s, 4, &u->area.width) && get_u32(s, 5, &u->area.height) &&
              get_u32(s, 6, &u->attempt) && get_u32(s, 7, &u->tries) &&
              get_text(s, 8, MSG_MAX_NAME, &u->worker) &&
              get_u64(s, 9, &u->fingerprint) && get_u32(s, 10, &u->stored) &&
              get_u32(s, 11, &done) && get_u64(s, 12, &u->end_ms) &&
              get_blob(s, 13, &counts, &ncounts) &&
              get_blob(s, 14, &bottom, &nbottom) && get_u64(s, 15, &u->sum);

    if (!ok || done > 1 || nbottom > MSG_MAX_SIDE || !is_unit(r, u))
        return false;
    u->done = done;
    u->nbottom = (uint32_t)nbottom;
    u->bottom = bottom;
    return !done || get_counts(&u->counts, counts, ncounts);
}

static int
no_memory(struct rad_error *err)
{
    return rad_fail(err, RAD_ENOMEM, "out of memory");
}

/* Own what the row lent. */
static int
copy_unit(struct reading *r, struct saved_unit *u)
{
    u->worker = rad_arena_strndup(&r->mem, u->worker, strlen(u->worker));
    if (u->nbottom > 0)
        u->bottom = rad_arena_dup(&r->mem, u->bottom, u->nbottom);
    return u->worker && (u->bottom || u->nbottom == 0) ? 0 : no_memory(r->err);
}

static int
add_unit(struct reading *r, sqlite3_stmt *s)
{
    struct saved_unit *u;

    if (r->saved.nunits == r->cap) {
        uint32_t cap = r->cap ? 2 * r->cap : 64;

        u = realloc(r->units, cap * sizeof *u);
        if (!u)
            return no_memory(r->err);
        r->units = u;
        r->cap = cap;
    }
    u = &r->units[r->saved.nunits];
    memset(u, 0, sizeof *u);
    if (!get_unit(r, s, u))
        return bad(r->err, "a unit", r->n);
    r->saved.nunits++;
    return copy_unit(r, u);
}

static int
add_frame(struct reading *r, sqlite3_stmt *s)
{
    uint32_t frame;

    if (!get_u32(s, 0, &frame) || frame >= r->saved.spec.nframes)
        return bad(r->err, "a frame", r->n);
    r->written[frame] = true;
    return 0;
}

/* All rows of a statement about the job. */
static int
each(struct reading *r, enum what what,
     int (*add)(struct reading *r, sqlite3_stmt *s))
{
    sqlite3_stmt *s = statement(r->j, what, r->err);
    int rc = 0, step;

    if (!s)
        return r->err->code;
    sqlite3_bind_int64(s, 1, r->n);
    while (rc == 0 && (step = sqlite3_step(s)) != SQLITE_DONE)
        rc = step == SQLITE_ROW ? add(r, s) : failed(r->j, step, r->err);
    sqlite3_reset(s);
    return rc;
}

static int
add_lives(struct reading *r, sqlite3_stmt *s)
{
    return get_u32(s, 0, &r->saved.lives) ? 0 : bad(r->err, "the life", r->n);
}

static int
get_lives(struct reading *r, sqlite3_int64 epoch)
{
    sqlite3_int64 n = r->n;
    int rc;

    r->n = epoch;
    rc = each(r, LIVES, add_lives);
    r->n = n;
    return rc;
}

/* Its id, and the SUBMIT that it came with. */
static int
get_spec(struct reading *r, sqlite3_stmt *s)
{
    const uint8_t *id, *spec;
    size_t nid, nspec;
    struct rad_error why = { 0 };

    if (!get_blob(s, 1, &id, &nid) || nid != MSG_JOB ||
        !get_blob(s, 3, &spec, &nspec))
        return bad(r->err, "the id", r->n);
    spec = rad_arena_dup(&r->mem, spec, nspec);
    if (nspec > 0 && !spec)
        return no_memory(r->err);
    if (msg_unpack_as(LAYOUT, &r->spec, MSG_SUBMIT, 0, spec, nspec, &why) < 0)
        return why.code == RAD_ENOMEM ? no_memory(r->err)
                                      : bad(r->err, "the specification", r->n);
    r->saved.spec = r->spec.submit;
    if (memcmp(r->saved.spec.job, id, MSG_JOB) != 0)
        return bad(r->err, "the id", r->n);
    r->written = calloc(r->saved.spec.nframes, sizeof *r->written);
    return r->written ? 0 : no_memory(r->err);
}

/* How it ended, if it did. */
static int
get_progress(struct reading *r, sqlite3_stmt *s)
{
    const uint8_t *v;
    size_t n;

    if (r->saved.state < JOB_DONE)
        return 0;
    if (!get_blob(s, 14, &v, &n))
        return bad(r->err, "the end", r->n);
    v = rad_arena_dup(&r->mem, v, n);
    if (n > 0 && !v)
        return no_memory(r->err);
    if (msg_unpack_as(LAYOUT, &r->progress, MSG_PROGRESS, 0, v, n, NULL) < 0)
        return bad(r->err, "the end", r->n);
    r->saved.last = r->progress.progress;
    return 0;
}

static int
get_job(struct reading *r, sqlite3_stmt *s)
{
    struct saved_job *o = &r->saved;
    uint32_t state, status;
    uint64_t epoch;
    int rc;

    if (!get_text(s, 2, MSG_MAX_NAME, &o->owner) || !get_u64(s, 4, &epoch) ||
        !get_u32(s, 5, &state) || state > JOB_CANCELLED ||
        !get_u32(s, 6, &status) || !get_text(s, 7, MSG_MAX_TEXT, &o->text) ||
        !get_u64(s, 8, &o->offer_ms) || !get_u64(s, 9, &o->submit_ms) ||
        !get_u64(s, 10, &o->open_ms) || !get_u64(s, 11, &o->end_ms) ||
        !get_u64(s, 12, &o->sent_bytes) || !get_u64(s, 13, &o->kept_bytes))
        return bad(r->err, "the state", r->n);
    o->state = (uint8_t)state;
    o->status = (int)status;
    rc = get_spec(r, s);
    if (rc == 0)
        rc = get_progress(r, s);
    if (rc == 0)
        rc = get_lives(r, (sqlite3_int64)epoch);
    if (rc == 0)
        rc = each(r, FRAMES, add_frame);
    if (rc == 0)
        rc = each(r, UNITS, add_unit);
    o->written = r->written;
    o->units = r->units;
    return rc;
}

static int
read_job(struct journal *j, sqlite3_stmt *s, journal_job_fn *fn, void *arg,
         struct rad_error *err)
{
    struct reading r = { .j = j, .err = err };
    int rc;

    r.n = sqlite3_column_int64(s, 0);
    rad_arena_init(&r.mem);
    rc = get_job(&r, s);
    if (rc == 0)
        rc = fn(arg, &r.saved, err);
    msg_release(&r.spec);
    msg_release(&r.progress);
    rad_arena_release(&r.mem);
    free(r.written);
    free(r.units);
    return rc;
}

int
journal_read(struct journal *j, journal_job_fn *fn, void *arg,
             struct rad_error *err)
{
    sqlite3_stmt *s = statement(j, JOBS, err);
    int rc = 0, step;

    if (!s)
        return err->code;
    while (rc == 0 && (step = sqlite3_step(s)) != SQLITE_DONE)
        rc = step == SQLITE_ROW ? read_job(j, s, fn, arg, err)
                                : failed(j, step, err);
    sqlite3_reset(s);
    return rc;
}
