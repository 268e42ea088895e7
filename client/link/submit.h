/* submit.h - radsubmit's conversation with a coordinator
 *
 * Offers a scene's files, sends those that are wanted, submits the job, then
 * gets its pictures as they are ready.  If the connection is lost another is
 * made and the same is sent again: by its id it is the same job.
 * The caller's functions get the results; they run on the loop's thread. */
#ifndef RADD_CLIENT_SUBMIT_H
#define RADD_CLIENT_SUBMIT_H

#include "base/files.h"
#include "compile/cargo.h"
#include "link/link.h"

#include <stdbool.h>

struct submit_callbacks {
    /* Print a line for the user; text has no newline. */
    void (*say)(void *arg, const char *text);
    void (*progress)(void *arg, const struct msg_progress *p);
    /* Frame number `frame` of the spec's list is complete.  picture: its .hdr,
     * without bytes for sensor points; depth: its distances, without bytes if
     * they are not wanted. */
    int (*frame)(void *arg, uint32_t frame,
                 const struct rad_memory_out *picture,
                 const struct rad_memory_out *depth, struct rad_error *err);
    /* The .hdr of a frame so far.  May be NULL: no previews. */
    int (*preview)(void *arg, const uint8_t *picture, size_t len,
                   struct rad_error *err);
    /* Ambient records of a worker.  May be NULL: not wanted. */
    void (*records)(void *arg, const struct msg_records *m);
    /* The job's statistics, in JSON.  May be NULL: not wanted. */
    int (*stats)(void *arg, const uint8_t *json, size_t len,
                 struct rad_error *err);
    /* 0, or an error if the job cannot go on, because processes of our own
     * cluster have ended.  NULL: the cluster is not our own. */
    int (*alive)(void *arg, struct rad_error *err);
    /* The coordinator has the scene and, for the first time, the job, which may
     * wait for room on its disk.  May be NULL. */
    void (*accepted)(void *arg);
    /* The job was accepted.  from: the job whose ambient cache it begins with;
     * NULL: none.  May be NULL. */
    void (*reuse)(void *arg, const uint8_t *from);
    /* Has no worker been at the job for longer than a user can explain?  Then
     * the coordinator is asked, and reason() gets its answer, "" if it has
     * none.  reason may be NULL, and then wonders() is not called. */
    bool (*wonders)(void *arg);
    void (*reason)(void *arg, const char *text);
    /* n workers have come; names lists them ("ws1, ws2", cut if too long).
     * Returns 1: submit the job, whose layout depends on them; 0: wait, for
     * --wait is not over; or an error.  NULL: submit at once. */
    int (*gathered)(void *arg, int n, const char *names, struct rad_error *err);
    void *arg;
};

struct submit_job {
    const struct msg_spec *spec;
    const struct cargo *cargo;
    struct target to;
    double wait_s; /* for a coordinator and a first worker */
    bool detach;   /* return when the job is accepted */
    const char *with; /* what radctl fetch needs besides the job's id, with a
                       * blank before it; NULL: nothing */
};

/* Carry the job out.  interrupts: the loop's `wake`.  The value 1 cancels the
 * job; a higher one returns at once, and a job that was accepted goes on.
 * Errors: the link's; RAD_EUNAVAIL: no coordinator or worker came in time;
 * RAD_ETEMPFAIL: interrupted; those of the callbacks; the error by which the
 * job failed. */
int submit_run(const struct submit_job *job, uv_loop_t *loop,
               const int *interrupts, const struct submit_callbacks *cb,
               struct rad_error *err);

#endif
