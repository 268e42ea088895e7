/* journal_impl.h - what the parts of the journal share; for them alone
 *
 *   journal.c       the database: opening, errors, transactions
 *   journal_life.c  lives and dates
 *   journal_put.c   putting
 *   journal_read.c  reading
 *   journal_sql.c   tables and statements in SQL
 * Thread: one at a time. */
#ifndef DAEMON_JOURNAL_IMPL_H
#define DAEMON_JOURNAL_IMPL_H

#include "journal/journal.h"

#include <sqlite3.h>

#define JOURNAL_LAYOUT 1 /* version of the protocol in kept messages */

/* The numbers of the statements in journal_sql. */
enum journal_sql {
    SQL_BEGIN,
    SQL_COMMIT,
    SQL_PUT_LIFE,
    SQL_LAST_LIFE,
    SQL_PUT_DATE,
    SQL_MOVE_JOBS,
    SQL_MOVE_UNITS,
    SQL_PUT_JOB,
    SQL_PUT_STATE,
    SQL_PUT_DRAINED,
    SQL_DROP_DRAINED,
    SQL_DRAINED,
    SQL_PUT_END,
    SQL_PUT_UNIT,
    SQL_PUT_ROWS,
    SQL_PUT_FRAME,
    SQL_DROP_UNITS,
    SQL_DROP_FRAMES,
    SQL_DROP_JOB,
    SQL_PUT_FETCHED,
    SQL_PUT_GONE,
    SQL_GONES,
    SQL_DROP_GONES,
    SQL_MARKS,
    SQL_STATS_MARK,
    SQL_HAS,
    SQL_HAS_GONE,
    SQL_JOBS,
    SQL_LIVES,
    SQL_UNITS,
    SQL_FRAMES,
    NSQL
};
extern const char *const journal_sql[NSQL];

/* SQL that makes the tables. */
extern const char journal_schema[];

struct journal {
    sqlite3 *db;
    sqlite3_stmt *stmt[NSQL]; /* NULL: not prepared yet */
    struct wire_out out;      /* where messages and counts are packed */
    bool had_log;             /* there was a log when the database was opened */
    bool in_transaction;
    int undone;    /* code for which SQLite undid the transaction; 0: it did
                    * not */
    int wal_pages; /* pages in the log at the last commit */
    bool crammed;  /* the next commit empties the log */
};

/* Turn an error code of SQLite into a RAD_E code, with *err; also note whether
 * SQLite has undone the transaction. */
int journal_failed(struct journal *j, int rc, struct rad_error *err);

/* Prepare a statement, so that values can be bound; NULL with *err. */
sqlite3_stmt *journal_statement(struct journal *j, enum journal_sql what,
                                struct rad_error *err);
/* As journal_statement(), for a statement that writes; begins a transaction if
 * none is under way. */
sqlite3_stmt *journal_writer(struct journal *j, enum journal_sql what,
                             struct rad_error *err);
/* Run a statement whose rows are of no interest, and reset it. */
int journal_run(struct journal *j, sqlite3_stmt *s, struct rad_error *err);

#endif
