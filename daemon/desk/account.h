/* account.h - what the coordinator keeps of one user
 *
 * Thread: the coordinator's loop. */
#ifndef DAEMON_ACCOUNT_H
#define DAEMON_ACCOUNT_H

#include "proto/message.h"
#include "users/known.h"
#include "users/uploads.h"

struct job;
struct stats_text;

/* Jobs of an owner that are over and still remembered. */
struct coord_kept {
    uint64_t bytes;            /* of all their folders */
    uint32_t fetching;         /* jobs whose pictures are being fetched */
    const struct job *fetched; /* of these, the job fetched from the longest
                                * ago; NULL: there are none */
    /* jobs that may be forgotten */
    uint32_t jobs;
    uint64_t weight;          /* sum of their job_weight() */
    const struct job *oldest; /* NULL: there is none */
};

/* Statistics for a user, on all connections; telling.c changes the sums. */
struct coord_told {
    const struct stats_text *making; /* NULL: none is being made */
    size_t bytes;                    /* of texts that are whole */
    uint64_t turn; /* coord.pieces_told at this user's last piece */
};

/* A user as an owner of jobs. */
struct coord_owner {
    struct coord_owner *next;
    char name[MSG_MAX_NAME + 1];
    uint32_t threads;   /* of workers that are at units of this user's jobs */
    struct known files; /* files of the store that the user may refer to */
    struct uploads_sum uploads;
    struct coord_told told;
    struct coord_kept kept; /* as coord_forget_old() last counted */
};

#endif
