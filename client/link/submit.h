/* submit.h - radsubmit's conversation with a coordinator
 *
 * Offers a scene's files, sends what is wanted, submits the job, then takes
 * its pictures as they are ready.  A lost connection is made again and the
 * same said again: it is the same job, by its id.
 * What comes is handed to the caller's functions, on the loop's thread.  */
#ifndef RADD_CLIENT_SUBMIT_H
#define RADD_CLIENT_SUBMIT_H

#include "compile/cargo.h"
#include "link/link.h"

#include <stdbool.h>

struct submit_callbacks {
    /* A line for people, without its end. */
    void (*say)(void *arg, const char *text);
    void (*progress)(void *arg, const struct msg_progress *p);
    /* Frame number `frame` of the spec's list is complete; the bytes of its
     * .hdr (NULL for sensor points) and, where depths are wanted, of its
     * distances (NULL else). */
    int (*frame)(void *arg, uint32_t frame, const uint8_t *picture,
                 size_t picture_len, const uint8_t *depth, size_t depth_len,
                 struct rad_error *err);
    /* The .hdr of a frame so far; NULL where no preview is wanted. */
    int (*preview)(void *arg, const uint8_t *picture, size_t len,
                   struct rad_error *err);
    /* Ambient records that a worker has made; NULL where not wanted. */
    void (*records)(void *arg, const struct msg_records *m);
    /* The job's statistics, JSON; NULL where not wanted. */
    int (*stats)(void *arg, const uint8_t *json, size_t len,
                 struct rad_error *err);
    /* 0, or why the job cannot go on: an embedded cluster's processes may have
     * ended.  NULL: the coordinator is somebody else's. */
    int (*alive)(void *arg, struct rad_error *err);
    /* The coordinator has the scene and the job, for the first time; the job
     * may wait for room on its disk.  NULL: nobody asks. */
    void (*accepted)(void *arg);
    /* The job was accepted, and begins with the ambient cache of that job, or
     * NULL: with none.  NULL: nobody asks. */
    void (*reuse)(void *arg, const uint8_t *from);
    /* Is nobody at the job for longer than a user can explain?  Then the
     * coordinator is asked, and reason() told what it says, "" for nothing.
     * reason NULL: nobody asks. */
    bool (*wonders)(void *arg);
    void (*reason)(void *arg, const char *text);
    /* So many workers are there, called names ("ws1, ws2", perhaps cut).  1:
     * the job is submitted, since what is laid out is laid out for those; 0:
     * more will be soon, and --wait is not over; or a failure.  NULL: as many
     * as happen to be. */
    int (*gathered)(void *arg, int n, const char *names, struct rad_error *err);
    void *arg;
};

struct submit_job {
    const struct msg_spec *spec;
    const struct cargo *cargo;
    struct target to;
    double wait_s; /* for a coordinator and a first worker */
    bool detach;   /* done when the job is accepted */
};

/* Carry the job out.  *interrupts is the loop's `wake`: 1 cancels the job, more
 * ends at once: what a coordinator has accepted goes on.  Errors: as the
 * link's; RAD_EUNAVAIL for no coordinator or worker in time; RAD_ETEMPFAIL when
 * interrupted; the callbacks' own; what the job failed with. */
int submit_run(const struct submit_job *job, uv_loop_t *loop,
               const int *interrupts, const struct submit_callbacks *cb,
               struct rad_error *err);

#endif
