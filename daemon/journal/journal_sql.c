/* journal_sql.c - the tables of the database, and its statements */
#include "config.h"

#include "journal/journal_impl.h"

/* life.began_ms: when the life began, and from then on when it was last seen */
const char journal_schema[] =
    "CREATE TABLE life (epoch INTEGER PRIMARY KEY, began_ms INTEGER NOT NULL);"
    "CREATE TABLE job ("
    " n INTEGER PRIMARY KEY, id BLOB NOT NULL UNIQUE, owner TEXT NOT NULL,"
    " spec BLOB NOT NULL, epoch INTEGER NOT NULL, state INTEGER NOT NULL,"
    " status INTEGER NOT NULL, text TEXT NOT NULL, offer_ms INTEGER NOT NULL,"
    " submit_ms INTEGER NOT NULL, open_ms INTEGER NOT NULL,"
    " end_ms INTEGER NOT NULL, sent_bytes INTEGER NOT NULL,"
    " kept_bytes INTEGER NOT NULL, progress BLOB, stats_size INTEGER,"
    " stats_hash BLOB, priority INTEGER);"
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
    " size INTEGER, hash BLOB, depth_size INTEGER, depth_hash BLOB,"
    " fetched INTEGER NOT NULL DEFAULT 0, PRIMARY KEY (job, frame))"
    " WITHOUT ROWID;"
    "CREATE TABLE drained (worker TEXT PRIMARY KEY) WITHOUT ROWID;"
    "CREATE TABLE gone ("
    " n INTEGER PRIMARY KEY, id BLOB NOT NULL UNIQUE, owner TEXT NOT NULL,"
    " name TEXT NOT NULL, why INTEGER NOT NULL, fetched INTEGER NOT NULL,"
    " end_ms INTEGER NOT NULL, gone_ms INTEGER NOT NULL);";

#define N_OF_JOB "(SELECT n FROM job WHERE id = ?1)"

const char *const journal_sql[NSQL] = {
    [SQL_BEGIN] = "BEGIN IMMEDIATE",
    [SQL_COMMIT] = "COMMIT",
    [SQL_PUT_LIFE] = "INSERT INTO life VALUES (?1, ?2)",
    /* began_ms is of the row that has the maximum */
    [SQL_LAST_LIFE] = "SELECT max(epoch), began_ms FROM life",
    [SQL_PUT_DATE] = "UPDATE life SET began_ms = ?1"
                     " WHERE epoch = (SELECT max(epoch) FROM life)",
    [SQL_MOVE_JOBS] = "UPDATE job SET offer_ms = min(offer_ms + ?1, ?2),"
                      " submit_ms = min(submit_ms + ?1, ?2),"
                      " open_ms = min(open_ms + ?1, ?2),"
                      " end_ms = min(end_ms + ?1, ?2)",
    [SQL_MOVE_UNITS] = "UPDATE unit SET end_ms = min(end_ms + ?1, ?2)",
    [SQL_PUT_JOB] =
        "INSERT INTO job (id, owner, spec, epoch, state, status,"
        " text, offer_ms, submit_ms, open_ms, end_ms, sent_bytes, kept_bytes)"
        " VALUES (?1, ?2, ?3, (SELECT ifnull(max(epoch), 0) FROM life),"
        " ?4, 0, '', ?5, ?6, ?7, 0, ?8, 0) ON CONFLICT (id) DO NOTHING",
    [SQL_PUT_STATE] = "UPDATE job SET state = ?2, priority = ?3"
                      " WHERE id = ?1",
    [SQL_PUT_DRAINED] = "INSERT INTO drained VALUES (?1) ON CONFLICT DO"
                        " NOTHING",
    [SQL_DROP_DRAINED] = "DELETE FROM drained WHERE worker = ?1",
    [SQL_DRAINED] = "SELECT worker FROM drained ORDER BY worker",
    [SQL_PUT_END] =
        "UPDATE job SET state = ?2, status = ?3, text = ?4,"
        " end_ms = ?5, kept_bytes = ?6, progress = ?7, stats_size = ?8,"
        " stats_hash = ?9 WHERE id = ?1",
    [SQL_PUT_UNIT] =
        "INSERT INTO unit (job, unit, frame, x, y, width, height, attempt,"
        " tries, worker, fingerprint) VALUES (" N_OF_JOB ", ?2, ?3, ?4, ?5,"
        " ?6, ?7, ?8, ?9, ?10, ?11)"
        " ON CONFLICT DO UPDATE SET frame = ?3, x = ?4, y = ?5, width = ?6,"
        " height = ?7, tries = ?9, worker = ?10, fingerprint = ?11,"
        " stored = CASE attempt WHEN ?8 THEN stored ELSE 0 END,"
        " sum = CASE attempt WHEN ?8 THEN sum ELSE 0 END,"
        " done = CASE attempt WHEN ?8 THEN done ELSE 0 END, attempt = ?8",
    /* the sums are combined by exclusive or, for which SQLite has no operator;
     * if the new rows are all that is stored (?4 = ?10) the sum begins anew */
    [SQL_PUT_ROWS] = "UPDATE unit SET attempt = ?3, stored = ?4, done = ?5,"
                     " end_ms = ?6, counts = ?7, bottom = ?8,"
                     " sum = CASE ?4 WHEN ?10 THEN ?9"
                     " ELSE (sum | ?9) - (sum & ?9) END"
                     " WHERE job = " N_OF_JOB " AND unit = ?2",
    [SQL_PUT_FRAME] =
        "INSERT INTO frame (job, frame, size, hash, depth_size, depth_hash)"
        " VALUES (" N_OF_JOB ", ?2, ?3, ?4, ?5, ?6) ON CONFLICT DO UPDATE"
        " SET size = ?3, hash = ?4, depth_size = ?5, depth_hash = ?6",
    [SQL_DROP_UNITS] = "DELETE FROM unit WHERE job = " N_OF_JOB,
    [SQL_DROP_FRAMES] = "DELETE FROM frame WHERE job = " N_OF_JOB,
    [SQL_DROP_JOB] = "DELETE FROM job WHERE id = ?1",
    [SQL_PUT_FETCHED] = "UPDATE frame SET fetched = 1"
                        " WHERE job = " N_OF_JOB " AND frame = ?2",
    [SQL_GONES] = "SELECT id, owner, name, why, fetched, end_ms, gone_ms"
                  " FROM gone ORDER BY n",
    /* in place of the record of an earlier job of that id */
    [SQL_PUT_GONE] = "INSERT OR REPLACE INTO gone (id, owner, name, why,"
                     " fetched, end_ms, gone_ms)"
                     " VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)",
    [SQL_DROP_GONES] =
        "DELETE FROM gone WHERE owner = ?1 AND n <= (SELECT n FROM gone"
        " WHERE owner = ?1 ORDER BY n DESC LIMIT 1 OFFSET ?2)",
    [SQL_MARKS] = "SELECT size, hash, depth_size, depth_hash FROM frame"
                  " WHERE job = " N_OF_JOB " AND frame = ?2",
    [SQL_STATS_MARK] = "SELECT stats_size, stats_hash FROM job WHERE id = ?1",
    [SQL_HAS] = "SELECT 1 FROM job WHERE id = ?1",
    [SQL_HAS_GONE] = "SELECT 1 FROM gone WHERE id = ?1",
    [SQL_JOBS] =
        "SELECT n, id, owner, spec, epoch, state, status, text, offer_ms,"
        " submit_ms, open_ms, end_ms, sent_bytes, kept_bytes, progress,"
        " stats_size, stats_hash, priority FROM job ORDER BY n",
    [SQL_LIVES] = "SELECT count(*) FROM life WHERE epoch > ?1",
    [SQL_UNITS] =
        "SELECT unit, frame, x, y, width, height, attempt, tries, worker,"
        " fingerprint, stored, done, end_ms, counts, bottom, sum"
        " FROM unit WHERE job = ?1 ORDER BY unit",
    [SQL_FRAMES] = "SELECT frame, size, hash, depth_size, depth_hash, fetched"
                   " FROM frame WHERE job = ?1 ORDER BY frame",
};
