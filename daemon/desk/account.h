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
    struct job *fetched;       /* of these jobs, the job that was fetched from
                                * the longest ago; NULL: none is fetched */
    uint32_t jobs;             /* jobs that may be forgotten */
    uint64_t weight;           /* sum of the job_weight() of these */
    const struct job *oldest;  /* the oldest of these; NULL: there are none */
};

/* Statistics for a user, on all of the user's connections.  telling.c changes
 * making and bytes. */
struct coord_told {
    const struct stats_text *making; /* NULL: no text is being made */
    size_t bytes;                    /* of texts that are whole */
    uint64_t turn; /* coord.pieces_told at this user's last piece */
};

/* A user as an owner of jobs. */
struct coord_owner {
    struct coord_owner *next;
    char name[MSG_MAX_NAME + 1];
    uint32_t threads;   /* of workers that are at units of this user's jobs */
    uint32_t served;    /* coord.serving of the last search of such a worker */
    struct known files; /* files of the store that the user may refer to */
    struct uploads_sum uploads;
    struct coord_told told;
    struct coord_kept kept; /* as bygone_forget_old() last counted */
};

#endif
