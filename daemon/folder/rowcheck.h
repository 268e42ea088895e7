/* rowcheck.h - are the rows of a job on the disk those that were kept?
 *
 * The journal notes a sum with the rows of a unit.  Rows that were damaged
 * since show when a coordinator takes the job up again: they are made once
 * more, as if they had never come.  So are rows that a unit's next attempt had
 * begun to overwrite when the coordinator died, before the journal knew of that
 * attempt.
 * Thread: the folder's. */
#ifndef DAEMON_ROWCHECK_H
#define DAEMON_ROWCHECK_H

#include "folder/folder.h"

typedef int rowcheck_fn(void *arg, const struct saved_job *saved,
                        const struct saved_unit *unit, struct rad_error *err);

/* Compare the rows of all units of a job that was taken up with the journal's
 * sums.  Sets units[], of saved->nunits: a unit whose rows differ has no rows
 * and no worker.  So has the unit above it if no base line of that was kept,
 * for the damaged unit begins there.  damaged() is called for each such unit,
 * until it fails.  Rows of a job that was given up are none, and no damage.
 * RAD_EIO, RAD_ENOMEM. */
int rowcheck_job(struct folder *f, const struct saved_job *saved,
                 struct saved_unit *units, rowcheck_fn *damaged, void *arg,
                 struct rad_error *err);

#endif
