/* statedir.h - may a coordinator take this state folder, and what is its own?
 *
 * The rules that keep radcoord from beginning anew over what is left, and from
 * removing what its database does not know: asked when it starts, which acts on
 * the answers, and by `radctl check`, which tells them.
 * Thread: any, one at a time. */
#ifndef DAEMON_STATEDIR_H
#define DAEMON_STATEDIR_H

#include "folder/folder.h"
#include "journal/journal.h"

#define STATEDIR_DATABASE "radcoord.db"

/* Is the folder nobody's to write to but its owner's, and are we that?
 * RAD_EPERM. */
int statedir_check_mode(const char *dir, struct rad_error *err);
int statedir_check_owner(const char *dir, struct rad_error *err);

/* How its database is to be opened: JOURNAL_MAKE where nothing is left of an
 * earlier one, else JOURNAL_OPEN.  RAD_EDATA where it is missing or empty
 * beside what only it can explain. */
int statedir_how(const char *dir, enum journal_how *how, struct rad_error *err);

enum statedir_fate {
    STATEDIR_KNOWN,  /* of a job that the database has */
    STATEDIR_TO_GO,  /* of one that was forgotten, or of which nobody was told
                      * that it is accepted */
    STATEDIR_UNKNOWN /* the database is of before, or another's */
};

/* What is to become of a job's folder; going: it is named as one that is being
 * forgotten. */
int statedir_fate(struct journal *j, const struct folder *f,
                  const uint8_t job[MSG_JOB], bool going,
                  enum statedir_fate *fate, struct rad_error *err);

/* The words for STATEDIR_UNKNOWN; returns RAD_EDATA. */
int statedir_unknown(const uint8_t job[MSG_JOB], struct rad_error *err);

#endif
