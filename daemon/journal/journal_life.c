/* journal_life.c - lives of the coordinator, and what the date is in each
 *
 * Jobs that are over age by the date, and are forgotten with their pictures when
 * they are too old.  In a life the date goes on by itself, but it begins at the
 * system's clock, which may be years wrong: a battery is dead, a wrong year was
 * typed.  So what lies between two lives makes jobs older by PAUSE_MS at most,
 * and never younger: the dates of all jobs and units are moved by the rest, in
 * the transaction that begins the life.  A coordinator that is switched off for
 * a month so keeps pictures that nobody could fetch meanwhile.  Dates of jobs
 * that are forgotten stay: users read them, and nothing ages by them. */
#include "config.h"

#include "journal/journal_impl.h"

#include "ground/daemon.h"

#define PAUSE_MS (UINT64_C(12) * 3600 * 1000)

struct life {
    uint64_t epoch, seen_ms;
};

static int
read_last(struct journal *j, struct life *last, struct rad_error *err)
{
    sqlite3_stmt *s = journal_writer(j, SQL_LAST_LIFE, err);
    int rc;

    if (!s)
        return err->code;
    rc = sqlite3_step(s);
    if (rc == SQLITE_ROW) {
        last->epoch = (uint64_t)sqlite3_column_int64(s, 0);
        last->seen_ms = (uint64_t)sqlite3_column_int64(s, 1);
        rc = 0;
    } else {
        rc = journal_failed(j, rc, err);
    }
    sqlite3_reset(s);
    return rc;
}

/* Run a statement with these two numbers. */
static int
run_with(struct journal *j, enum journal_sql what, uint64_t first,
         uint64_t second, struct rad_error *err)
{
    sqlite3_stmt *s = journal_writer(j, what, err);

    if (!s)
        return err->code;
    sqlite3_bind_int64(s, 1, (sqlite3_int64)first);
    sqlite3_bind_int64(s, 2, (sqlite3_int64)second);
    return journal_run(j, s, err);
}

/* Move the dates of jobs and units, so that those of seen_ms lie no more than
 * PAUSE_MS before date_ms. */
static int
move_dates(struct journal *j, uint64_t seen_ms, uint64_t date_ms,
           struct rad_error *err)
{
    uint64_t pause_ms = date_ms > seen_ms ? date_ms - seen_ms : 0, by_ms;
    int rc;

    if (pause_ms > PAUSE_MS)
        pause_ms = PAUSE_MS;
    by_ms = date_ms - pause_ms - seen_ms; /* may be negative, as an int64_t */
    if (by_ms == 0)
        return 0;
    rc = run_with(j, SQL_MOVE_JOBS, by_ms, date_ms, err);
    return rc == 0 ? run_with(j, SQL_MOVE_UNITS, by_ms, date_ms, err) : rc;
}

int
journal_begin_life(struct journal *j, uint64_t *date_ms, uint64_t *epoch,
                   struct rad_error *err)
{
    struct life last = { 0 };
    int rc = read_last(j, &last, err);

    if (*date_ms < DAEMON_RIGHT_MS && *date_ms < last.seen_ms)
        *date_ms = last.seen_ms;
    *epoch = *date_ms > last.epoch ? *date_ms : last.epoch + 1;
    if (rc == 0)
        rc = move_dates(j, last.seen_ms, *date_ms, err);
    return rc == 0 ? run_with(j, SQL_PUT_LIFE, *epoch, *date_ms, err) : rc;
}

int
journal_put_date(struct journal *j, uint64_t date_ms, struct rad_error *err)
{
    sqlite3_stmt *s = journal_writer(j, SQL_PUT_DATE, err);

    if (!s)
        return err->code;
    sqlite3_bind_int64(s, 1, (sqlite3_int64)date_ms);
    return journal_run(j, s, err);
}
