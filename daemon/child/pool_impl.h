/* pool_impl.h - what the files of the pool share
 *
 * Private to pool*.c:
 *   pool.c         set-up and end, calls of the loop
 *   pool_clock.c   the time that threads use
 *   pool_thread.c  the next work of a thread
 *   pool_estimate.c  work before the first unit
 *   pool_tiles.c   the ambient cache in passes
 *   pool_unit.c    one unit: its team, its rows
 *   pool_strict.c  the strict units' machine
 * Fields marked [mu] are read and written under the pool's lock, [fixed] are
 * set before threads start, [loop] are the loop thread's.  Functions whose
 * names end in _locked are called under the lock. */
#ifndef DAEMON_POOL_IMPL_H
#define DAEMON_POOL_IMPL_H

#include "child/pool.h"
#include "child/pool_tiles.h"
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
    enum strict_rank rank;    /* [fixed] a window's is the last */
    enum team_mode mode;      /* [fixed] */
    int row0;                 /* [fixed] the unit's first in the sampler's */
    struct team *team;        /* [fixed] */
    int members;              /* [mu] */
    struct msg_counts counts; /* [mu] of members that left */
    double wall0;             /* [fixed] */
    /* the member that hands rows on */
    int channels;
    struct pool_rows *piece; /* NULL: none begun */
    double piece_wall0;      /* time when the piece was begun */
    struct rad_error err;    /* of a piece that could not be made */
    bool whole;              /* all rows were handed on, and count */
    uint64_t again; /* pixels that were made again */
    struct msg_doubt doubt;
};

/* An estimate, under way or done. */
struct estimating {
    struct estimating *next; /* [mu] */
    struct estimate *estimate;
    pool_estimate_fn *fn;
    int members;       /* [mu] */
    _Atomic bool stop; /* written with mu held; read anywhere */
    double wall_s;     /* [mu] when it came; at its end, the time it took */
};

struct renderer {
    struct pool *pool;
    uv_thread_t thread;
    struct rad_ctx ctx;
    uint64_t seen;   /* [loop] ctx.at at pool_stuck()'s last look */
    double seen_cpu; /* [loop] the thread's processor time when seen was new */
};

struct pool {
    const struct rad_job *job;      /* [fixed] */
    const struct rad_frame *frames; /* [fixed] */
    struct strict *strict;          /* [mu] the machine itself; NULL: none */
    bool coded;                     /* [fixed] rows leave as in a picture */
    int nthreads;                   /* [fixed] after pool_new() */
    struct renderer *renderers;     /* [fixed] */
    pool_rows_fn *rows;             /* [fixed] */
    pool_news_fn *news;             /* [fixed] */
    void *arg;                      /* [fixed] */
    uv_async_t async;
    uv_mutex_t mu;
    uv_cond_t work;                           /* with todo and stopping */
    uv_cond_t room;                           /* with unsent and stopping */
    struct queued *todo;                      /* [mu] */
    struct queued **todo_end;                 /* [mu] */
    struct active *active;                    /* [mu] */
    struct estimating *estimates, *estimated; /* [mu] under way; done */
    struct pool_tiling tiling;
    struct pool_rows *done;                   /* [mu] */
    struct pool_rows **done_end;              /* [mu] */
    size_t unsent;         /* [mu] bytes of pixels under way */
    double busy_s, wait_s; /* [mu] of units that threads have left */
    int idle;              /* [mu] threads that find nothing to do */
    bool waits;            /* [mu] strict units waited then, */
    double waits_at;       /* [mu] time of the last look at waits */
    _Atomic bool stopping; /* written with mu held; read anywhere */
};

/* A thread's clocks when it began a piece of work. */
struct pool_stint {
    double cpu, wall;
};

/* --- pool_clock.c --- */

double pool_seconds(clockid_t clock);
struct pool_stint pool_stint_begin(struct renderer *by);
/* End a piece of work and lock the pool, for the counts that the caller adds;
 * returns the processor time of that work [s]. */
double pool_stint_end_and_lock(struct renderer *by, const struct pool_stint *s);

/* --- pool_thread.c --- */

/* The body of a thread of the pool; arg is its struct renderer. */
void pool_run_thread(void *arg);

/* --- pool_estimate.c --- */

/* An estimate that has areas left; NULL: none. */
struct estimating *pool_find_estimate_locked(const struct pool *p);
/* Is a thread at an estimate? */
bool pool_is_estimating_locked(const struct pool *p);
/* Take areas until there are none. */
void pool_work_on_estimate(struct renderer *by, struct estimating *e);
/* Have threads leave estimates. */
void pool_stop_estimates_locked(struct pool *p);
/* Hand on the estimates that are done. */
void pool_give_estimates(struct pool *p);
void pool_free_estimates(struct estimating *e);

/* --- pool_unit.c --- */

/* Begin a window (which is freed) or a pass; the caller is the first member of
 * its team.  NULL: memory is out, and the loop is told. */
struct active *pool_unit_begin(struct pool *p, struct queued *window,
                               struct strict_pass *pass);
/* Be a member of the unit's team until there is nothing left to begin. */
void pool_unit_work(struct renderer *by, struct active *u);

/* --- pool_strict.c --- */

/* Time that threads have nothing to do, while units of theirs wait. */
void pool_settle_waits_locked(struct pool *p);
/* For each pass carry out what the machine asks, and report the progress. */
void pool_look_locked(struct pool *p);
/* Strict units changed: there may be work, and messages to send. */
void pool_changed_locked(struct pool *p);
/* A team_bottom_fn; arg is a struct active. */
void pool_on_bottom(void *arg);
/* All threads have left a pass; u->counts are the unit's if it is done. */
void pool_end_pass_locked(struct active *u);

#endif
