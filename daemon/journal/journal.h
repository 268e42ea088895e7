/* journal.h - the database of a coordinator's state folder
 *
 * SQLite, write-ahead log, synchronous=FULL.  What is put stands in one
 * transaction until journal_commit(), and lasts when that returns 0; putting
 * the same twice is the same as once.  One process at a time: the lock is held
 * as long as the database is open.
 * What it holds is checked when it is read: RAD_EDATA for what cannot be.
 * Errors: RAD_EFULL (roll back, and put it all again when there is room),
 * RAD_EIO, RAD_ENOMEM, RAD_EDATA, RAD_ETEMPFAIL (another process has it).
 * Thread: one at a time. */
#ifndef DAEMON_JOURNAL_H
#define DAEMON_JOURNAL_H

#include "machine/saved.h"

struct journal;

enum journal_how {
    JOURNAL_MAKE, /* it may be missing, or empty */
    JOURNAL_OPEN, /* it must be there, and whole */
    JOURNAL_READ  /* likewise; it is left as it is */
};

int journal_open(struct journal **j, const char *path, enum journal_how how,
                 struct rad_error *err);
void journal_close(struct journal *j);

/* Is the file's structure sound? */
int journal_check(struct journal *j, struct rad_error *err);

/* Another life of the coordinator begins: its number, above all before.  It
 * lasts, as what follows, with journal_commit(). */
int journal_begin_life(struct journal *j, uint64_t now_ms, uint64_t *epoch,
                       struct rad_error *err);

/* --- putting --- */

int journal_put_job(struct journal *j, const struct saved_job *s,
                    struct rad_error *err);
int journal_put_state(struct journal *j, const uint8_t job[MSG_JOB], int state,
                      int32_t priority, struct rad_error *err);
/* An admin drained the worker, or had enough of that. */
int journal_put_drained(struct journal *j, const char *worker, bool drained,
                        struct rad_error *err);
/* A job is over: state, status, text, times, last progress and the mark of its
 * statistics; its units are dropped. */
int journal_put_end(struct journal *j, const struct saved_job *s,
                    struct rad_error *err);
/* The unit as it went out.  Of an attempt that is known the rows stay. */
int journal_put_unit(struct journal *j, const uint8_t job[MSG_JOB],
                     const struct saved_unit *u, struct rad_error *err);
/* Rows of a unit that was put: attempt, stored and, with done, the rest; area
 * and worker do not count. */
int journal_put_rows(struct journal *j, const uint8_t job[MSG_JOB],
                     const struct saved_unit *u, struct rad_error *err);
/* The picture of a frame, by index, is there, with these marks. */
int journal_put_frame(struct journal *j, const uint8_t job[MSG_JOB],
                      uint32_t frame, const struct saved_frame *f,
                      struct rad_error *err);
int journal_put_fetched(struct journal *j, const uint8_t job[MSG_JOB],
                        uint32_t frame, struct rad_error *err);
/* The job is forgotten, but that it was: of that the last SAVED_GONES of each
 * owner are known. */
int journal_forget(struct journal *j, const struct saved_gone *g,
                   struct rad_error *err);

int journal_commit(struct journal *j, struct rad_error *err);
void journal_rollback(struct journal *j);

/* --- reading --- */

int journal_has(struct journal *j, const uint8_t job[MSG_JOB], bool *has,
                struct rad_error *err);

/* Was the job forgotten not long ago? */
int journal_has_gone(struct journal *j, const uint8_t job[MSG_JOB], bool *gone,
                     struct rad_error *err);

/* The mark of a finished file of a job; not known where there is none. */
int journal_find_mark(struct journal *j, const uint8_t job[MSG_JOB],
                      uint32_t frame, enum msg_what what, struct mark *m,
                      struct rad_error *err);

/* fn is called for each job that was forgotten, in that order. */
int journal_read_gone(struct journal *j,
                      void (*fn)(void *arg, const struct saved_gone *g),
                      void *arg, struct rad_error *err);

/* fn is called for each job, in the order in which they were put; what it gets
 * is valid during the call.  It ends the reading by returning a negative
 * code. */
typedef int journal_job_fn(void *arg, const struct saved_job *s,
                           struct rad_error *err);
int journal_read(struct journal *j, journal_job_fn *fn, void *arg,
                 struct rad_error *err);
/* fn is called for each worker that is drained; it may end the reading, too. */
typedef int journal_worker_fn(void *arg, const char *worker,
                              struct rad_error *err);
int journal_read_drained(struct journal *j, journal_worker_fn *fn, void *arg,
                         struct rad_error *err);

#endif
