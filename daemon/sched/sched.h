/* sched.h - who works on what: the part of the coordinator that hands out
 *
 * Private to the coordinator's files, which all change the structs below:
 *   coord.c    events, and messages of workers
 *   coord_conn.c  connections, and who is behind them
 *   coord_job.c  the life of a job
 *   coord_keep.c  how long it is remembered
 *   request.c, report.c  what users and admins ask for
 * and those of the scheduler:
 *   sched.c    who gets what
 *   result.c   rows that come, units that are done
 *   loss.c     workers and children that go
 *   handoff.c  facts and base lines on their way between workers
 *   duplicate.c  rows that come twice
 *   balance.c  giving away and doubling what one has, for one that has nothing
 *   lending.c  columns of a line, likewise
 *   hold.c     who has what
 *   yield.c    who gives back what, for something that comes first
 *   survey.c   estimates, before the first unit
 *   recover.c  jobs of an earlier life
 *   ring.c     who is linked with whom where there are very many
 *   speed.c    how fast workers are, and how long a unit will take
 * Thread: one. */
#ifndef DAEMON_SCHED_H
#define DAEMON_SCHED_H

#include "queue/coord.h"
#include "desk/job.h"
#include "front/known.h"
#include "ground/log.h"
#include "front/uploads.h"

/* A worker that is, or was, connected. */
struct coord_worker {
    struct coord_worker *next;
    char name[MSG_MAX_NAME + 1];
    char program[MSG_MAX_NAME + 1];
    char address[MSG_MAX_ADDRESS + 1]; /* where peers dial it */
    uint64_t conn;                     /* 0: not connected */
    uint32_t threads;
    unsigned version; /* of the protocol that it speaks */
    uint64_t fingerprint;
    uint64_t since_ms;    /* connected, or gone, since */
    uint32_t id;          /* from 0, by the order of their first HELLO */
    uint32_t in_flight;   /* units of all jobs that it works on */
    uint32_t parked;      /* units that wait for a base line */
    uint32_t delivered;   /* units whose rows are on their way to the disk */
    double relative;      /* speed of a thread, by earlier jobs; 1: usual */
    uint64_t free_ms;     /* when it last came to have none of these */
    int64_t priority;     /* the highest of jobs whose units these are, */
    int64_t rank;         /* or could be; INT64_MIN: there are none (yield.c) */
    uint64_t progress;    /* of its last PING */
    uint64_t progress_ms; /* when that was new */
    bool hangs;           /* it has work, and makes no progress */
    const struct job *loading; /* what its next READY is for */
    bool forgotten;            /* gone, and not told of any more */
    bool drained;              /* gets nothing new: an admin's wish */
    bool leaving;              /* gets nothing new: its own wish */
    bool alone;        /* has a unit that crashed once: nothing beside it */
    char no_room[256]; /* why it could not take a job last (job_worker) */
};

/* A request that is answered when what it did is kept. */
struct coord_settling {
    struct coord_settling *next;
    uint32_t request;
    uint64_t since_ms;
};

struct coord_telling;

struct coord_conn {
    struct coord_conn *next;
    struct coord_conn *chain; /* the next of coord.by_id */
    uint64_t id;
    enum msg_session session;
    unsigned version; /* of the protocol, since its HELLO */
    unsigned roles;   /* that it may ask for */
    char address[MSG_MAX_ADDRESS + 1];
    char owner[MSG_MAX_NAME + 1];
    char name[MSG_MAX_NAME + 1]; /* of the worker that it may be; empty: any */
    struct coord_worker *worker; /* with MSG_AT_COORD_WORKER */
    const struct job *watch;     /* job whose progress it gets */
    uint32_t watch_request;      /* request id of its SUBMIT */
    uint64_t offer_ms;           /* first OFFER since the last SUBMIT; or 0 */
    uint64_t sent_bytes;         /* CHUNK bytes since then */
    uint64_t moved_ms;           /* the last OFFER or CHUNK */
    uint32_t answers;            /* that it is to get, and that take a while */
    struct coord_owner *payer;
    struct coord_settling *settling;
    struct coord_telling *telling;
};

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

/* Whom jobs belong to. */
struct coord_owner {
    struct coord_owner *next;
    char name[MSG_MAX_NAME + 1];
    uint32_t threads;   /* of workers at units of theirs */
    struct known files; /* of the store that they may know of */
    struct uploads_sum uploads;
    struct coord_kept kept; /* as coord_forget_old() last counted */
};

#define COORD_CONNS 1024 /* a power of 2 */

struct coord {
    struct coord_env env;
    struct coord_keep keep;
    bool keep_due;            /* something happened that it asks for */
    uint64_t keep_ms;         /* when it was looked after last */
    struct saved_gone *gones; /* jobs that were forgotten, as they were */
    size_t ngones, cap_gones;
    struct coord_limits limits;
    struct uploads uploads;
    uint64_t uploads_ms; /* when those that wait were looked at last */
    bool full;           /* the disk is: jobs are held */
    char full_text[MSG_MAX_TEXT + 1];
    bool full_told;        /* the log has it that the disk is full now */
    uint64_t full_told_ms; /* when it last said so; 0: never */
    struct action_list actions;
    uint64_t now_ms;
    struct coord_conn *conns;
    struct coord_worker *workers;
    uint32_t nworkers; /* all that ever were */
    struct coord_owner *owners;
    uint32_t serving;  /* counts searches for a unit */
    struct job **jobs; /* by priority, then as they came */
    size_t njobs, cap_jobs;
    uint64_t sequence;
    uint64_t known_ms;    /* when files that owners know of expired last */
    uint64_t progress_ms; /* when PROGRESS was sent last */
    uint64_t tick_ms;     /* when the scheduler looked at the time last */
    uint64_t lease_ms;    /* a unit that is out for less is not late */
    bool stirred;         /* somebody may get something since sched_run() */
    struct coord_conn *by_id[COORD_CONNS]; /* chains of conns */
    struct log_limit breaks; /* of lines about those that are no worker's */
};

/* Give units, and jobs to load, to every worker that has room. */
void sched_run(struct coord *c);

/* Time has passed. */
void sched_tick(struct coord *c);

/* Link a worker that just became ready with those that are; the first of them
 * gives it what its cache holds. */
void introduce_worker(struct coord *c, const struct job *job,
                      const struct coord_worker *w);
/* Tell the other workers of a job to have no more to do with this one. */
void introduce_drop(struct coord *c, const struct job *job,
                    const struct coord_worker *w);
/* Tell two workers of a job of each other; a may be asked to give b what its
 * cache has (MSG_PEER_GIVE).  False: neither can be dialled. */
bool introduce_link(struct coord *c, const struct job *job,
                    const struct coord_worker *a, const struct coord_worker *b,
                    uint32_t give);
/* Tell one to have no more to do with the other. */
void introduce_unlink(struct coord *c, const struct job *job,
                      const struct coord_worker *to,
                      const struct coord_worker *about);

/* Messages of workers. */
void sched_ready(struct coord *c, struct coord_worker *w,
                 const struct msg_ready *m);
void result_rows(struct coord *c, struct coord_worker *w,
                 const struct msg_result *m);
void loss_reported(struct coord *c, struct coord_worker *w,
                   const struct msg_lost *m);
void loss_no_room(struct coord *c, struct coord_worker *w,
                  const struct msg_room *m);
void loss_still(struct coord *c, struct coord_worker *w,
                const struct msg_gave *m);
void sched_tally(struct coord *c, struct coord_worker *w,
                 const struct msg_tally *m);
void handoff_facts(struct coord *c, struct coord_worker *w,
                   const struct msg_facts *m);
void handoff_base_line(struct coord *c, struct coord_worker *w,
                       const struct msg_base_line *m);
void handoff_parked(struct coord *c, struct coord_worker *w,
                    const struct msg_attempt *m);
void lending_loan(struct coord *c, struct coord_worker *w,
                  const struct msg_loan *m);
void lending_paid(struct coord *c, struct coord_worker *w,
                  const struct msg_paid *m);
void balance_gave(struct coord *c, struct coord_worker *w,
                  const struct msg_gave *m);
void survey_estimated(struct coord *c, struct coord_worker *w,
                      const struct msg_estimated *m);

/* A worker went: its units wait again. */
void loss_worker_gone(struct coord *c, struct coord_worker *w);

/* An admin drained a worker, or had enough of that: others may take what was to
 * be its part of a job, or may not. */
void sched_drained(struct coord *c, struct coord_worker *w);

/* Rows are kept. */
void result_stored(struct coord *c, const struct action_rows *key);

/* Take the units of a job back and tell its workers that it is over. */
void sched_job_over(struct coord *c, struct job *job);

/* --- sched.c, for its neighbours --- */

/* The job and the index of w in it, which said something of it; NULL when the
 * job is over or unknown, and then the worker is told so. */
struct job *sched_job_of(struct coord *c, const struct coord_worker *w,
                         const uint8_t *id, uint32_t *index);

/* A worker is so late with a unit that another does it: that may well have to
 * do the rest of its work, too.  Or it is heard of again. */
void sched_late(struct job *job, uint32_t index, bool late);

/* Can that worker be told of the job, whose list of frames may be long? */
bool sched_can_tell(const struct job *job, const struct coord_worker *w);

/* Index of the worker in the job; JOB_NOBODY: it has no part in it. */
uint32_t sched_index(const struct job *job, const struct coord_worker *w);

/* May it have more work? */
bool sched_takes_units(const struct coord_worker *w);

/* What happens to a worker's go at a unit, for those who debug. */
void sched_log_unit(struct coord *c, const struct job *job, uint32_t unit,
                    const struct job_go *go, const char *what);

/* Give a worker a unit, as a twin where others have it. */
void sched_hand_out(struct coord *c, struct job *job, uint32_t index,
                    uint32_t unit);

void sched_send_ack(struct coord *c, uint64_t conn, const uint8_t *job,
                    uint32_t unit, uint32_t attempt, uint32_t row,
                    uint32_t rows);
/* REVOKE, TWIN or SPLIT. */
void sched_send_attempt(struct coord *c, const struct job *job, uint16_t type,
                        uint32_t unit, const struct job_go *go);

/* All costs are known: units may go out. */
void sched_begin(struct coord *c, struct job *job);

/* Ask the store to remember the unit as it is now. */
void sched_keep_unit(struct coord *c, const struct job *job, uint32_t unit);

/* The index of a worker in the job, which it may be new to; JOB_NOBODY when
 * memory is out. */
uint32_t sched_add_worker(struct job *job, struct coord_worker *w);

/* One unit for the worker; false: it gets none now. */
bool sched_serve(struct coord *c, struct coord_worker *w);

/* Nothing of this job for any worker now. */
bool sched_idle_job(const struct job *job);

/* Could a worker that has nothing get some of what others have of it? */
bool sched_can_balance(const struct job *job);

/* --- yield.c --- */

/* Have units go back whose job is paused, whose worker is to leave, or works
 * for somebody else now. */
void yield_look(struct coord *c);

/* Does something else come first for that worker of the job? */
bool yield_wanted(const struct job *job, uint32_t index);

/* Bring the priority of what the worker has in hand up to date. */
void yield_rate(const struct coord *c, struct coord_worker *w);

/* The worker had room, and the job nothing for it: it does not give other jobs'
 * units back for that. */
void yield_passed(const struct coord *c, struct job *job, uint32_t index);

/* --- hold.c --- */

/* Begin an attempt at a unit; NULL: there is no room for it. */
struct job_go *hold_add(struct coord *c, struct job *job, uint32_t index,
                        uint32_t unit, uint32_t attempt);
/* The attempt is in another state now. */
void hold_step(struct coord *c, struct job *job, uint32_t unit,
               struct job_go *go, enum go_state to);
/* It has fewer lines of the unit now, or columns of one line. */
void hold_shrunk(struct job *job, uint32_t unit, struct job_go *go);
/* End the attempt and free it, which moves another of the unit's. */
void hold_release(struct coord *c, struct job *job, uint32_t unit,
                  struct job_go *go);

/* The rows that came of a unit do not count any more. */
void hold_forget_rows(struct job *job, uint32_t unit);

/* --- result.c --- */

/* All rows of the frame are kept: its picture is to be written. */
void result_frame_done(struct coord *c, struct job *job, uint32_t frame);

/* --- loss.c --- */

/* A holder will not finish the unit: another does, or it waits again. */
void loss_of(struct coord *c, struct job *job, uint32_t unit,
             struct job_go *go);
/* It is to have the unit no more (REVOKE). */
void loss_taken(struct coord *c, struct job *job, uint32_t unit,
                struct job_go *go);
/* It gave the unit back, with all that it knew of it. */
void loss_given_back(struct coord *c, struct job *job, uint32_t unit,
                     struct job_go *go);

/* What that attempt at the unit lends is its own again. */
void loss_end_loans(struct coord *c, struct job *job, uint32_t unit,
                    uint32_t lender);

/* A worker loses its part in the job, which is in that state then. */
void loss_all(struct coord *c, struct job *job, uint32_t index,
              enum part_state to);

/* Units that a worker lost wait for it that long, while its connection is to be
 * made again. */
void loss_keep(const struct coord *c, struct job *job, uint32_t index,
               uint64_t ms);
/* They do not any more, where the time is over. */
void loss_tick(struct coord *c, struct job *job);

/* A worker that had part in the job before says that it is ready.  Of its units
 * it is at those that it said so of (STILL).  All that comes of another is what
 * came since it was gone, before the job's start reached it. */
void loss_at_ready(struct coord *c, struct job *job, uint32_t index);

/* Is there another worker than that one that may do the job?  late: also if it
 * is late. */
bool loss_others_may(const struct coord *c, const struct job *job,
                     const struct coord_worker *w, bool late);

/* The worker that lost the unit turns out to be at it, or to have rows of it,
 * and nobody else began it.  False: memory is out. */
bool result_revive(struct coord *c, struct job *job, uint32_t index,
                   uint32_t unit);

/* --- duplicate.c --- */

/* Rows of a unit of that height that count. */
void duplicate_keep(struct job *job, uint32_t index, const struct msg_result *m,
                    uint32_t height);
/* Rows that do not, but lie in their unit: are they those that did? */
void duplicate_check(struct coord *c, struct job *job, uint32_t index,
                     const struct msg_result *m);
/* What counted does not any more. */
void duplicate_forget(struct job_unit *u);

/* --- handoff.c --- */

/* Flags of the UNIT for that holder, which it goes to now. */
uint8_t handoff_flags(struct job *job, uint32_t unit, struct job_go *go);
/* The holder has made the base line above its unit, if it was to, or will not.
 */
void handoff_top_made(struct coord *c, struct job *job, uint32_t unit,
                      struct job_go *go);
/* The unit went out to it. */
void handoff_out(struct coord *c, struct job *job, uint32_t unit,
                 struct job_go *go);
/* A worker that came back has units that go on: with it and their neighbours
 * all is as if they had just gone out. */
void handoff_back(struct coord *c, struct job *job, uint32_t index);
/* Since when the base line above a unit is here whole; 0: it is not. */
uint64_t handoff_top_ms(const struct job *job, uint32_t unit);
/* Is its bottom with us, if anybody needs it? */
bool handoff_complete(const struct job *job, uint32_t unit);
/* A unit is done. */
void handoff_done(struct job *job, uint32_t unit);
/* Send what parked units wait for, where it has not come otherwise. */
void handoff_tick(struct coord *c, struct job *job);

/* --- balance.c --- */

/* Find something for workers that have nothing to do. */
void balance_run(struct coord *c);
/* See which workers hang, and which units are late. */
void balance_look(struct coord *c);
/* A late unit for a worker, as a twin; false: there is none. */
bool balance_give_twin(struct coord *c, struct job *job, uint32_t index);

/* A go at a unit has but so many rows of it: the rest is a new unit.  False: it
 * ends at no line. */
bool balance_shrink(struct coord *c, struct job *job, uint32_t unit,
                    struct job_go *go, uint32_t height);

/* May its units give lines away? */
bool balance_splits(const struct job *job);
/* Has the worker nothing to do, for this job or another that comes before it?
 */
bool balance_is_idle(const struct job *job, uint32_t index);

/* --- lending.c --- */

/* Ask for columns until as many are on their way as workers are idle. */
void lending_ask(struct coord *c, struct job *job, uint32_t idle);
/* A worker has done all that it was lent, or will not: its lender has it back.
 */
void lending_ended(struct coord *c, struct job *job, uint32_t unit,
                   const struct job_go *loan);
/* An attempt has nothing left to do.  True: but to wait for what it lends. */
bool lending_parked(const struct coord *c, struct job_go *go);
/* Take back what is lent for too long. */
void lending_tick(struct coord *c, struct job *job);

/* --- survey.c --- */

/* Estimate costs first, if the job wants it; 0 or RAD_ENOMEM. */
int survey_begin(struct job *job, uint32_t workers, struct rad_error *err);
/* Areas for a worker that is ready, or units if the estimate was given up;
 * false: there is nothing for it. */
bool survey_give(struct coord *c, struct job *job, uint32_t index);
/* Has the estimate anything for the worker, or is it at some of that? */
bool survey_has(const struct coord *c, const struct job *job, uint32_t index);
/* The worker is told to answer at once, with what it has; called before rest_ms
 * is set. */
void survey_rest(struct job *job, uint32_t index);
/* Has the worker, which leaves, yet to tell what it has traced? */
bool survey_tells(const struct coord *c, const struct coord_worker *w);
/* The worker will not answer. */
void survey_lost(struct job *job, uint32_t index);
/* A child died of that chunk of areas: the second time the estimate is given
 * up, and units go out as without one. */
void survey_crashed(struct coord *c, struct job *job, uint32_t chunk);

/* --- speed.c --- */

/* Bring a worker's times up to date; before its units change. */
void speed_touch(const struct coord *c, struct job_worker *jw);
/* The worker of an attempt has worked off the cost of its unit; counts once. */
void speed_finished(struct job *job, uint32_t unit, struct job_go *go);
/* Speeds of all workers of a job, and its pace. */
void speed_measure(const struct coord *c, struct job *job);
/* Remember them after the job. */
void speed_keep(const struct coord *c, struct job *job);
/* What a worker does of the job in that time. */
double speed_cost(const struct job *job, uint32_t index, double ms);
/* How long a holder will need yet [ms]. */
double speed_left_ms(const struct coord *c, const struct job *job,
                     uint32_t unit, const struct job_go *go);

/* --- coord_conn.c --- */

/* The connection of that id, or NULL. */
struct coord_conn *coord_find_conn(const struct coord *c, uint64_t id);

/* It says who it is: welcome or not. */
void coord_hello(struct coord *c, struct coord_conn *conn, const struct msg *m);

/* Close a connection that broke the rules, or that is not needed. */
void coord_break(struct coord *c, uint64_t conn, const char *why);

/* Close a connection of which both sides know that it ends. */
void coord_part(struct coord *c, uint64_t conn, const char *why);

void coord_reply_failed(struct coord *c, const struct coord_conn *conn,
                        uint32_t request, const uint8_t *job, int status,
                        const char *text);

/* The record of the worker of that name, a new one if it never was here; NULL
 * when memory is out. */
struct coord_worker *coord_worker_of(struct coord *c, const char *name);
/* Free the workers that were forgotten and that no job names any more. */
void coord_drop_forgotten(struct coord *c);

/* --- coord_job.c --- */

/* The job of that id, or NULL. */
struct job *coord_find_job(const struct coord *c, const uint8_t id[MSG_JOB]);

/* To one who watches the job: how far it is, and the last words. */
void coord_send_progress(struct coord *c, const struct coord_conn *conn,
                         const struct job *job);
void coord_send_accept(struct coord *c, const struct coord_conn *conn,
                       const struct job *job, bool again);
void coord_send_end(struct coord *c, const struct coord_conn *conn,
                    const struct job *job);

/* Whom jobs of that name belong to, who may be new; NULL: memory is out. */
struct coord_owner *coord_owner_of(struct coord *c, const char *name);

/* Put a job into the queue; false when memory is out. */
bool coord_add_job(struct coord *c, struct job *job);
/* Higher goes first; jobs that work now give way within a tick. */
void coord_set_priority(struct coord *c, struct job *job, int32_t priority);
/* Once its files are all there, ask for room for its rows. */
void coord_try_open(struct coord *c, struct job *job);
/* That file of theirs came: open who waits for it. */
void coord_file_came(struct coord *c, const struct coord_owner *owner,
                     const uint8_t hash[MSG_HASH]);
/* Go on with opening, and end those whose files do not come. */
void coord_jobs_tick(struct coord *c);
/* The job is as it is now after a restart too. */
void coord_keep_state(struct coord *c, const struct job *job);
/* End a job; text may be NULL. */
void coord_job_ends(struct coord *c, struct job *job, enum job_state state,
                    int status, const char *text);
/* Free that one, which nothing leads to any more. */
void coord_drop_job(struct coord *c, const struct job *job);

/* --- coord_keep.c --- */

/* Forget what need not be kept of jobs that are over. */
void coord_forget_old(struct coord *c);
/* Forget that one, which is over, with its pictures. */
void coord_forget_job(struct coord *c, const struct job *job,
                      enum gone_why why);
/* Is it over, and kept for its owner, who has not fetched all of it? */
bool coord_unfetched(const struct coord *c, const struct job *job);
/* The last that was forgotten whose id begins with these digits; NULL. */
const struct saved_gone *coord_find_gone(const struct coord *c,
                                         const char *hex);
/* When and why. */
void coord_gone_text(const struct saved_gone *g, char text[MSG_MAX_TEXT + 1]);
/* "2026-11-22 23:41 UTC" */
#define COORD_TIME 32
void coord_time_text(uint64_t ms, char text[COORD_TIME]);

#endif
