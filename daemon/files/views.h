/* views.h - a job's frames, read from the file that they come in
 *
 * A job of many frames (MSG_JOB_VIEWS) names a file of its bundle that has them
 * and the costs of their lines, so its messages stay small; whoever needs the
 * frames reads that file, which may wait for the disk.
 * Thread: any. */
#ifndef RADD_DAEMON_VIEWS_H
#define RADD_DAEMON_VIEWS_H

#include "proto/message.h"

/* What the frames of a spec lie in.  Zeroed, it holds nothing. */
struct views {
    unsigned char *bytes;
    struct msg list;
};

/* Complete a spec whose frames are in a file of that folder (blobs.h), for as
 * long as *v lasts; one that has its frames stays as it is.  RAD_ENOINPUT: the
 * file is not there, or is none of the job's; RAD_EDATA: it is not what the
 * spec says; RAD_EIO, RAD_ENOMEM.  *v is to be released in any case. */
int views_read(struct views *v, const char *dir, struct msg_spec *spec,
               struct rad_error *err);
void views_release(struct views *v);

#endif
