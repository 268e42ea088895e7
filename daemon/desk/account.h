/* account.h - what a user has at the coordinator
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_ACCOUNT_H
#define DAEMON_ACCOUNT_H

#include "proto/message.h"
#include "users/known.h"
#include "users/uploads.h"

struct job;

/* What is kept of an owner's jobs that are over. */
struct coord_kept {
    uint64_t bytes;            /* of all */
    uint32_t fetching;         /* that are being fetched */
    const struct job *fetched; /* the longest ago of these; NULL: there are
                                * none */
    /* of those that may be forgotten */
    uint32_t jobs;
    uint64_t weight;          /* of these, see job_weight() */
    const struct job *oldest; /* NULL: there is none */
};

/* A user, as far as jobs are concerned. */
struct coord_owner {
    struct coord_owner *next;
    char name[MSG_MAX_NAME + 1];
    uint32_t threads;   /* of workers at units of theirs */
    struct known files; /* of the store that they may know of */
    struct uploads_sum uploads;
    struct coord_kept kept; /* as coord_forget_old() last counted */
};

#endif
