/* reuse.h - jobs that begin with the ambient cache of a former job (--reuse)
 *
 * When a job with passes is done the store keeps their records, as long as its
 * pictures are kept and the caches of all users together are within a limit
 * (coord_keep.h).  A later job of the same user may have them as its first
 * pass, if both are on the same scene and make records by the same options and
 * seed: all rendering options but those of rad_params_of_records().
 * Thread: the coordinator's loop. */
#ifndef DAEMON_REUSE_H
#define DAEMON_REUSE_H

#include "desk/desk.h"

/* The job of that user whose cache a new one is to begin with: that of
 * spec->reuse, or where this is zeros the one that was done last among those
 * that fit.  NULL with err->code 0: there is none such.  NULL and RAD_ENOINPUT:
 * no such job, or its cache is gone; RAD_EPERM: it is another user's;
 * RAD_ETEMPFAIL: it is not over; RAD_EDATA: it has none, or that does not fit.
 * With a goal the new job begins with the options of the former one's pictures,
 * if all that a goal makes finer is as fine there. */
const struct job *reuse_find(const struct coord *c, const char *owner,
                             const struct msg_spec *spec,
                             struct rad_error *err);

/* The rendering options that a new job with a goal begins with, where
 * reuse_find() found that job for it. */
void reuse_options(const struct job *from, const struct msg_spec *spec,
                   char text[RAD_PARAMS_TEXT]);

/* The job is over, and its passes are there yet: is the store to keep its
 * cache?  Notes that in the job. */
void reuse_keep(const struct coord *c, struct job *job);

#endif
