/* submit_impl.h - what the files of radsubmit's conversation share
 *
 *   submit.c         its course, from the first connection to the last picture
 *   submit_talk.c    messages that come; the job cancelled
 *   submit_ends.c    what the user is told of a job that ends early
 *   submit_results.c pictures, previews and statistics fetched
 *   submit_ask.c     questions about the cluster
 *
 * There is one function for each step, which waits for its answer; all other
 * messages that come meanwhile are handled in submit_talk.c.  After a step that
 * fails with RAD_EUNAVAIL the whole conversation begins again on a new
 * connection: every step may be repeated.
 * Functions return 0 or an error, if nothing else is said. */
#ifndef RADD_CLIENT_SUBMIT_IMPL_H
#define RADD_CLIENT_SUBMIT_IMPL_H

#include "link/roll.h"
#include "link/submit.h"

/* What the coordinator has of the job, as far as we know.  A later connection
 * does not set this back.
 *
 *   OURS --SUBMIT--> ASKED --PROGRESS with its id--> KNOWN --ACCEPT--> ACCEPTED
 *     ^----FAILED----' '------------------ACCEPT-----------------------^ */
enum stage {
    STAGE_OURS,  /* nothing, or only files */
    STAGE_ASKED, /* SUBMIT was sent, so it may have the job */
    STAGE_KNOWN, /* it has the job, which waits for room on the disk */
    STAGE_ACCEPTED
};

/* How the job ends, as far as we know.
 *
 *   NONE --DONE--> DONE --CANCEL is sent--> LATE
 *     |--CANCEL is sent--> CANCEL --DONE--> LATE
 *     |                       '--ANSWER, FAILED--> OVER
 *     |--FAILED--> OVER
 *     '--our own cluster has ended--> DEAD
 *
 * A new connection begins with NONE after DONE, too: DONE comes again. */
enum ending {
    ENDING_NONE,
    ENDING_DONE,   /* DONE came: all pictures are there */
    ENDING_CANCEL, /* CANCEL was sent */
    ENDING_LATE,   /* and DONE came: the job stays */
    ENDING_OVER,   /* the job has failed, or is cancelled */
    ENDING_DEAD    /* our own cluster has ended: do not try again */
};

/* Did a limit that has room again later refuse the last try? */
enum refusal {
    REFUSAL_NONE,
    REFUSAL_GONE,   /* yes, and the connection was closed */
    REFUSAL_IN_LINE /* yes; the connection is kept, and with it our turn */
};

struct submit {
    const struct submit_job *job;
    const struct submit_callbacks *cb;
    struct link_where where;
    struct link *link;
    struct rad_error *err;
    char id[MSG_JOB_HEX]; /* the job's, as people read it */
    uint32_t request;  /* number of our last request */
    uint64_t start_ms; /* when we began; later, when we were first refused */
    uint64_t wait_ms;  /* since when a worker could have come; 0: not yet */
    enum stage stage;
    /* trying again */
    int failures;   /* tries since the last that brought something */
    uint32_t nwanted; /* files that the coordinator last asked for */
    bool connected; /* there was a connection at some time */
    enum refusal refusal;
    bool told_lost, told_refused; /* the user knows */
    /* the job */
    enum ending ending;
    bool met_worker;
    bool fetching;      /* fetch() or ask() handles a FAILED of this request */
    uint32_t delivered; /* frames that were delivered */
    struct msg_progress last; /* without its job id */
    uint64_t preview_due_ms;
    uint64_t reason_due_ms; /* when to ask again why no worker is at the job */
};

/* Did DONE come, on this connection? */
static inline bool
submit_is_done(const struct submit *s)
{
    return s->ending == ENDING_DONE || s->ending == ENDING_LATE;
}

/* --- submit_talk.c --- */

uint64_t submit_now_ms(const struct submit *s);

/* Note that the job has reached a stage, at least.  From STAGE_KNOWN on its id
 * means something to the coordinator, and the caller is told. */
void submit_reach(struct submit *s, enum stage to);

/* Wait for the next message, for half a second at most.  Returns 1 and *m,
 * which was noted; 0; or an error.  An interrupt is an error unless it is the
 * first and the job is known, for then the caller has to cancel. */
int submit_next(struct submit *s, const struct msg **m);

/* Wait for a message of that type. */
int submit_await(struct submit *s, uint16_t type, const struct msg **m);

/* Cancel the job and wait, for a few seconds at most, until the coordinator
 * has, or says that the job is over.  A job that was done before CANCEL came
 * stays.  Returns the error for the user. */
int submit_cancel(struct submit *s);

/* Is the job over, or the cluster that has it going to be? */
bool submit_is_settled(const struct submit *s);

/* No worker can begin the job: it is paused, or held for want of room. */
bool submit_stands_still(const struct submit *s);

/* --- submit_ends.c --- */

/* The error of a conversation that a signal ends: it says where the job is. */
int submit_interrupted(struct submit *s);

/* The error of a CANCEL that may have come too late, or never. */
int submit_not_settled(struct submit *s);

void submit_say_what_it_got(struct submit *s);

/* --- submit_results.c --- */

/* Get the next frame, or the statistics, and hand them to the caller. */
int submit_deliver_frame(struct submit *s);
int submit_deliver_stats(struct submit *s);

/* Get a preview if it is due.  From the first request on the coordinator has
 * workers send colours for it before their rows come. */
int submit_preview(struct submit *s);

/* --- submit_ask.c --- */

/* If no worker is at the job, ask the coordinator for the reason. */
int submit_ask_reason(struct submit *s);

/* Ask for all workers, page by page; r is empty if the job has ended meanwhile.
 */
int submit_ask_workers(struct submit *s, struct roll *r);

#endif
