/* views.h - a job's frames, read from the file that they come in
 *
 * A job of many frames (MSG_JOB_VIEWS) names a file of its bundle that has the
 * frames and the costs of their lines, so its messages stay small.
 * views_read() reads that file, and may wait for the disk.
 * Thread: any. */
#ifndef RADD_DAEMON_VIEWS_H
#define RADD_DAEMON_VIEWS_H

#include "proto/message.h"

/* The memory in which the frames of a spec lie.  Zeroed, it is empty. */
struct views {
    unsigned char *bytes;
    struct msg list;
};

/* Give a spec its frames from a file in the folder dir (blobs.h), unless it has
 * them; they last as long as *v.  RAD_ENOINPUT: the file is not there, or is
 * none of the job's files; RAD_EDATA: the file is not what the spec says;
 * RAD_EIO, RAD_ENOMEM.  The caller releases *v in any case. */
int views_read(struct views *v, const char *dir, struct msg_spec *spec,
               struct rad_error *err);
void views_release(struct views *v);

#endif
