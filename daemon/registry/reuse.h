/* reuse.h - jobs that begin with the ambient cache of another job (--reuse)
 *
 * When a job with passes is done the store keeps the records of its passes with
 * its pictures, if the caches of all users together are within a limit
 * (coord_keep.cache_bytes).  A later job of the same user may begin with these
 * records as its first pass, if scene, seed and all options that records depend
 * on are equal (rad_params_of_records()).
 * Thread: the coordinator's loop. */
#ifndef DAEMON_REUSE_H
#define DAEMON_REUSE_H

#include "base/params.h"
#include "desk/desk.h"

/* The user's job with whose cache a new job is to begin: spec->reuse or, if
 * that is zeros, of the jobs that fit the job that was done last.  NULL with
 * err->code 0: no job fits.  NULL and RAD_ENOINPUT: there is no such job, or
 * its cache is gone; RAD_EPERM: it is another user's; RAD_ETEMPFAIL: it is not
 * over; RAD_EDATA: it has no cache, or its cache does not fit.
 * A new job with a goal begins with the options of the other job's pictures, if
 * these are as fine as its own in all that a goal makes finer. */
const struct job *reuse_find(const struct coord *c, const char *owner,
                             const struct msg_spec *spec,
                             struct rad_error *err);

/* The rendering options that a new job with a goal begins with, if reuse_find()
 * has found job `from' for it. */
void reuse_options(const struct job *from, const struct msg_spec *spec,
                   char text[RAD_PARAMS_TEXT]);

/* The job is over, and its passes are still in memory: note in job->cache which
 * passes the store is to keep, if any. */
void reuse_keep(const struct coord *c, struct job *job);

#endif
