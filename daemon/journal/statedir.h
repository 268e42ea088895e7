/* statedir.h - may a coordinator take a state folder, and what is to be removed
 *
 * radcoord must not begin anew where files of earlier jobs are left, nor remove
 * files that its database does not know.  It asks these functions when it
 * starts, and acts on the answers; `radctl check` asks them, and only tells.
 * Thread: any, one at a time. */
#ifndef DAEMON_STATEDIR_H
#define DAEMON_STATEDIR_H

#include "folder/folder.h"
#include "journal/journal.h"

#define STATEDIR_DATABASE "radcoord.db"

/* Check that only its owner may write to the folder; also that we are the
 * owner.  RAD_EPERM. */
int statedir_check_mode(const char *dir, struct rad_error *err);
int statedir_check_owner(const char *dir, struct rad_error *err);

/* Set *how to how the folder's database is to be opened: JOURNAL_MAKE if the
 * folder has no files of jobs and no log of a database, else JOURNAL_OPEN.
 * RAD_EDATA: it has such files, but the database is missing or empty. */
int statedir_how(const char *dir, enum journal_how *how, struct rad_error *err);

/* What is to become of a job's folder. */
enum statedir_fate {
    STATEDIR_KNOWN,  /* it stays: the database has the job */
    STATEDIR_TO_GO,  /* it is removed: the job was or is being forgotten, or
                      * nobody was told that the job is accepted */
    STATEDIR_UNKNOWN /* it stays, and radcoord does not start: the database is
                      * older than the job, or of another coordinator */
};

/* Find the fate of a job's folder; going: its name is ID.gone (folder.h). */
int statedir_fate(struct journal *j, const struct folder *f,
                  const uint8_t job[MSG_JOB], bool going,
                  enum statedir_fate *fate, struct rad_error *err);

/* Say in *err that the fate of the job's folder is STATEDIR_UNKNOWN; returns
 * RAD_EDATA. */
int statedir_unknown(const uint8_t job[MSG_JOB], struct rad_error *err);

#endif
