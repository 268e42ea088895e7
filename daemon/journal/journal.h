/* journal.h - the database of a coordinator's state folder
 *
 * SQLite, write-ahead log, synchronous=FULL.  All that is put belongs to one
 * transaction until journal_commit(), and is on the disk when that returns 0.
 * To put a thing again changes nothing, but for journal_put_rows().  The
 * database is locked while it is open, so one process has it at a time.
 * All that is read is checked: RAD_EDATA if radcoord cannot have written it.
 * Errors: RAD_EFULL (roll back, and put all again when there is room), RAD_EIO,
 * RAD_ENOMEM, RAD_EPERM, RAD_EDATA, RAD_ETEMPFAIL (another process has the
 * database); RAD_EUNSUPPORTED from journal_open(): the database has the tables
 * of another version.
 * Thread: one at a time. */
#ifndef DAEMON_JOURNAL_H
#define DAEMON_JOURNAL_H

#include "machine/saved.h"

struct journal;

enum journal_how {
    JOURNAL_MAKE, /* make the database if it is missing or empty */
    JOURNAL_OPEN, /* the database must be there */
    JOURNAL_READ  /* the database must be there, and is not changed */
};

/* Open the database at path; *j is NULL on failure. */
int journal_open(struct journal **j, const char *path, enum journal_how how,
                 struct rad_error *err);
void journal_close(struct journal *j);

/* Check the structure of the database's file; RAD_EDATA: it is damaged. */
int journal_check(struct journal *j, struct rad_error *err);

/* Begin another life of the coordinator: put it, and set *epoch to its number,
 * which is above those of all lives before.  *date_ms is the system's clock; if
 * that is wrong for sure, the date goes on where it was last put.  Dates of jobs
 * and units are moved: they lie before *date_ms by the time that the coordinator
 * lived, and by half a day at most for the time between two lives. */
int journal_begin_life(struct journal *j, uint64_t *date_ms, uint64_t *epoch,
                       struct rad_error *err);
/* Put the date; called now and then in each life. */
int journal_put_date(struct journal *j, uint64_t date_ms,
                     struct rad_error *err);

/* --- putting --- */

int journal_put_job(struct journal *j, const struct saved_job *s,
                    struct rad_error *err);
int journal_put_state(struct journal *j, const uint8_t job[MSG_JOB], int state,
                      int32_t priority, struct rad_error *err);
/* Put that an admin drained the worker, or let it work again. */
int journal_put_drained(struct journal *j, const char *worker, bool drained,
                        struct rad_error *err);
/* Put the end of a job: state, status, text, end_ms, kept_bytes, last progress
 * and the mark of its statistics.  Its units are dropped. */
int journal_put_end(struct journal *j, const struct saved_job *s,
                    struct rad_error *err);
/* Put a unit as it went out.  If the database has another attempt of the unit
 * its rows are forgotten. */
int journal_put_unit(struct journal *j, const uint8_t job[MSG_JOB],
                     const struct saved_unit *u, struct rad_error *err);
/* Put new rows of a unit that was put: attempt, stored, sum and now and, with
 * done, the fields below it; area, tries and worker are not read.  RAD_EDATA:
 * there is no such unit. */
int journal_put_rows(struct journal *j, const uint8_t job[MSG_JOB],
                     const struct saved_unit *u, struct rad_error *err);
/* Put that the picture of a frame (by index) is there, with these marks. */
int journal_put_frame(struct journal *j, const uint8_t job[MSG_JOB],
                      uint32_t frame, const struct saved_frame *f,
                      struct rad_error *err);
/* Put that the job's owner has fetched the frame. */
int journal_put_fetched(struct journal *j, const uint8_t job[MSG_JOB],
                        uint32_t frame, struct rad_error *err);
/* Remove a job, and put a record of it as forgotten.  Of these records the last
 * SAVED_GONES of each owner stay. */
int journal_forget(struct journal *j, const struct saved_gone *g,
                   struct rad_error *err);

int journal_commit(struct journal *j, struct rad_error *err);
void journal_rollback(struct journal *j);
/* The disk lacks room: empty the log, whose pages the database takes, at once
 * or else when what was put is committed.  If the database lacks room, too, the
 * log stays, and 0 is returned. */
int journal_give_room(struct journal *j, struct rad_error *err);

/* --- reading --- */

/* Has the database the job? */
int journal_has(struct journal *j, const uint8_t job[MSG_JOB], bool *has,
                struct rad_error *err);

/* Has it a record that the job was forgotten? */
int journal_has_gone(struct journal *j, const uint8_t job[MSG_JOB], bool *gone,
                     struct rad_error *err);

/* Set *m to the mark of a finished file of a job; m->known is false if the
 * database has no such mark. */
int journal_find_mark(struct journal *j, const uint8_t job[MSG_JOB],
                      uint32_t frame, enum msg_what what, struct mark *m,
                      struct rad_error *err);

/* Call fn with the record of each forgotten job, in the order in which the jobs
 * were forgotten. */
int journal_read_gone(struct journal *j,
                      void (*fn)(void *arg, const struct saved_gone *g),
                      void *arg, struct rad_error *err);

/* Call fn with each job, in the order in which the jobs were put; *s is valid
 * during the call.  A negative code of fn ends the reading, and is returned. */
typedef int journal_job_fn(void *arg, const struct saved_job *s,
                           struct rad_error *err);
int journal_read(struct journal *j, journal_job_fn *fn, void *arg,
                 struct rad_error *err);
/* Call fn with the name of each worker that is drained; a negative code of fn
 * ends the reading, and is returned. */
typedef int journal_worker_fn(void *arg, const char *worker,
                              struct rad_error *err);
int journal_read_drained(struct journal *j, journal_worker_fn *fn, void *arg,
                         struct rad_error *err);

#endif
