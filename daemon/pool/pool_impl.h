/* pool_impl.h - shared by the files of the pool, and private to them
 *
 *   pool.c         set-up and end, calls of the loop
 *   pool_clock.c   time that threads use
 *   pool_thread.c  the next work of a thread
 *   pool_estimate.c  estimates, before the first unit
 *   pool_tiles.c   the ambient cache in passes
 *   pool_unit.c    one unit: its team, its rows
 *   pool_strict.c  the strict units' machine
 * Fields marked [mu] are read and written under the pool's lock, [fixed] are
 * set before threads start, [loop] are the loop thread's.  Functions whose
 * names end in _locked are called under the lock. */
#ifndef DAEMON_POOL_IMPL_H
#define DAEMON_POOL_IMPL_H

#include "pool/pool.h"
#include "pool/pool_tiles.h"
#include "pool/wake.h"
#include "team/team.h"

#include <stdatomic.h>
#include <time.h>

struct queued {
    struct queued *next;
    struct pool_unit unit;
};

/* A window, or a pass of a strict unit, that threads work on. */
struct active {
    struct active *next;      /* [mu] */
    struct pool *pool;        /* [fixed] */
    struct pool_unit unit;    /* [fixed] */
    struct strict_pass *pass; /* [mu] NULL: a window */
    enum strict_rank rank;    /* [fixed] a window has the last */
    int row0;                 /* [fixed] the unit's first row, as the sampler
                               * counts rows */
    struct team *team;        /* [fixed] */
    int members;              /* [mu] threads in the team */
    struct msg_counts counts; /* [mu] of members that left */
    double wall0;             /* [fixed] time when it began */
    /* changed by the member that hands rows on */
    int channels;
    struct pool_rows *piece; /* rows that are not handed on; NULL: none */
    double piece_wall0;      /* time when the piece was begun */
    struct rad_error err;    /* why a piece could not be made */
    bool whole;              /* all rows were handed on, and count */
    uint64_t again;          /* pixels that were traced again (trace_again()) */
    struct msg_doubt doubt;  /* what these tell of the error */
};

/* An estimate, under way or done. */
struct estimating {
    struct estimating *next; /* [mu] */
    struct estimate *estimate;
    pool_estimate_fn *fn;
    int members;   /* [mu] threads at it */
    double wall0;  /* [fixed] time when it came */
    double wall_s; /* [mu] its duration, once done */
};

struct renderer {
    struct pool *pool;
    uv_thread_t thread;
    struct rad_ctx ctx;
    uint64_t seen;   /* [loop] ctx.at at the last call of pool_stuck() */
    double seen_cpu; /* [loop] processor time of the thread when ctx.at became
                      * seen */
};

struct pool {
    const struct rad_job *job;      /* [fixed] */
    const struct rad_frame *frames; /* [fixed] */
    struct strict *strict;          /* [mu] the machine; NULL: none */
    bool coded;                     /* [fixed] */
    int nthreads;                   /* [fixed] after pool_new() */
    struct renderer *renderers;     /* [fixed] */
    pool_rows_fn *rows;             /* [fixed] */
    pool_news_fn *news;             /* [fixed] */
    void *arg;                      /* [fixed] */
    struct wake wake;               /* work for the loop thread */
    uv_mutex_t mu;
    uv_cond_t work;                           /* new work, or stopping */
    uv_cond_t room;                           /* unsent fell, or stopping */
    struct queued *todo;                      /* [mu] windows */
    struct queued **todo_end;                 /* [mu] */
    struct active *active;                    /* [mu] */
    int beginning; /* [mu] threads that took units which are not there yet */
    struct estimating *estimates, *estimated; /* [mu] under way; done */
    struct pool_tiling tiling;
    struct pool_rows *done;      /* [mu] rows for the loop */
    struct pool_rows **done_end; /* [mu] */
    size_t unsent;         /* [mu] bytes of pixels not written to the link */
    double busy_s, wait_s; /* [mu] as in pool_tally */
    int idle;              /* [mu] threads that wait for work */
    bool waits;            /* [mu] did strict units wait for their tops at */
    double waits_at;       /* [mu] this time, of the last look? */
    _Atomic bool stopping; /* written with mu held; read anywhere */
};

/* A thread's clocks at the beginning of a piece of work. */
struct pool_stint {
    double cpu, wall;
};

/* --- pool_clock.c --- */

double pool_seconds(clockid_t clock);
struct pool_stint pool_stint_begin(struct renderer *by);
/* End a piece of work and lock the pool, so that the caller can add its counts.
 * Returns the processor time of the work [s]. */
double pool_stint_end_and_lock(struct renderer *by, const struct pool_stint *s);

/* --- pool_thread.c --- */

/* Body of a render thread; arg is its struct renderer. */
void pool_run_thread(void *arg);

/* --- pool_estimate.c --- */

/* An estimate that has areas left; NULL: none. */
struct estimating *pool_find_estimate_locked(const struct pool *p);
/* Is a thread at an estimate? */
bool pool_is_estimating_locked(const struct pool *p);
/* Work on the estimate's areas until none is left. */
void pool_work_on_estimate(struct renderer *by, struct estimating *e);
/* Hand the estimates that are done to their callbacks, on the loop thread. */
void pool_give_estimates(struct pool *p);
void pool_free_estimates(struct estimating *e);

/* --- pool_unit.c --- */

/* Begin a window (which is freed) or a pass, with the caller as the first
 * member of its team.  NULL: memory is out, and the loop is told. */
struct active *pool_unit_begin(struct pool *p, struct queued *window,
                               struct strict_pass *pass);
/* Work as a member of the unit's team until no line is left to begin; the last
 * member ends the unit. */
void pool_unit_work(struct renderer *by, struct active *u);

/* --- pool_strict.c --- */

/* Count the time up to now in which idle threads waited for tops. */
void pool_settle_waits_locked(struct pool *p);
/* Tell the machine how far each pass is, and its team what that wants. */
void pool_look_locked(struct pool *p);
/* Strict units changed: wake threads, and the loop to send messages. */
void pool_changed_locked(struct pool *p);
/* A team_bottom_fn; arg is a struct active. */
void pool_on_bottom(void *arg);
/* A team_help_fn, likewise. */
void pool_on_help(void *arg);
/* End a pass that all threads have left; sets u->counts if its unit is done. */
void pool_end_pass_locked(struct active *u);

#endif
