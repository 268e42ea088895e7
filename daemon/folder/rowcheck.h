/* rowcheck.h - are the rows of a job on the disk those that were kept?
 *
 * With the rows of a unit the journal notes their sum.  What a disk has spoilt,
 * or somebody has, shows when a coordinator takes the job up again: such rows
 * are made once more, as if they had never come.  So are those that a unit's
 * next attempt had begun to overwrite when the coordinator died, which the
 * journal had not heard of.
 * Thread: whose the folder is. */
#ifndef DAEMON_ROWCHECK_H
#define DAEMON_ROWCHECK_H

#include "folder/folder.h"

typedef int rowcheck_fn(void *arg, const struct saved_job *saved,
                        const struct saved_unit *unit, struct rad_error *err);

/* Look at the rows of all units of a job whose files were taken up.  units, of
 * saved->nunits, gets what is to be made of them: those whose rows are other
 * than they were have none, and nobody's, and so have those above that no base
 * line was kept of, for such a unit begins there.  damaged is called for each.
 * RAD_EIO, RAD_ENOMEM. */
int rowcheck_job(struct folder *f, const struct saved_job *saved,
                 struct saved_unit *units, rowcheck_fn *damaged, void *arg,
                 struct rad_error *err);

#endif
