/* pool_impl.h - what the files of the pool share
 *
 * Private to pool*.c:
 *   pool.c         set-up and end, what the loop asks of it
 *   pool_clock.c   what threads take
 *   pool_thread.c  what a thread does next
 *   pool_first.c   what comes before the first unit: seeding, estimates
 *   pool_unit.c    one unit: its team, its rows
 *   pool_strict.c  the strict units' machine
 * What is marked [mu] is read and written with the pool's lock, [fixed] set
 * before threads see it, [loop] the loop's thread's; functions whose names end
 * in _locked want the lock. */
#ifndef DAEMON_POOL_IMPL_H
#define DAEMON_POOL_IMPL_H

#include "child/pool.h"
#include "picture/doubt.h"
#include "team/team.h"

#include <stdatomic.h>
#include <time.h>

struct queued {
    struct queued *next;
    struct pool_unit unit;
};

/* A unit, or a pass of a strict one, that threads work on. */
struct active {
    struct active *next;      /* [mu] */
    struct pool *pool;        /* [fixed] */
    struct pool_unit unit;    /* [fixed] */
    struct strict_pass *pass; /* [mu] NULL: it is a window */
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
    double piece_wall0;      /* when it was */
    struct rad_error err;    /* of a piece that could not be made */
    bool whole;              /* all rows were handed on, and count */
    struct rad_rough rough;
};

/* An estimate that threads work on, or that is done. */
struct estimating {
    struct estimating *next; /* [mu] */
    struct estimate *estimate;
    pool_estimate_fn *fn;
    int members;       /* [mu] */
    _Atomic bool stop; /* written with mu held; read anywhere */
    double wall_s;     /* [mu] when it came; in the end, how long it took */
};

struct renderer {
    struct pool *pool;
    uv_thread_t thread;
    struct rad_ctx ctx;
    uint64_t seen;   /* [loop] ctx.at when it was last looked at */
    double seen_cpu; /* [loop] and what the thread had used when that was new */
};

struct pool {
    const struct rad_job *job;      /* [fixed] */
    const struct rad_frame *frames; /* [fixed] */
    struct strict *strict;          /* [mu] what it points to; NULL: none */
    bool coded;                     /* [fixed] rows leave as in a picture */
    int nthreads;                   /* [fixed] after pool_new() */
    struct renderer *renderers;     /* [fixed] */
    pool_rows_fn *fn;               /* [fixed] */
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
    struct rad_seed *seed;                    /* [mu] NULL: none is under way */
    struct rad_seed *seeded_one;              /* [mu] that is done */
    pool_seed_fn *seed_fn;                    /* [mu] who is to hear of it */
    int seeding;                              /* [mu] threads at it */
    bool seed_over;                           /* [mu] nothing is left of it */
    _Atomic bool seed_stop; /* nothing more is begun of it; as stopping */
    struct msg_counts seeded;                 /* [mu] what they counted */
    struct pool_rows *done;                   /* [mu] */
    struct pool_rows **done_end;              /* [mu] */
    size_t unsent;         /* [mu] bytes of pixels under way */
    double busy_s, wait_s; /* [mu] of units that are done with */
    int idle;              /* [mu] threads that find nothing to do */
    bool waits;            /* [mu] strict units waited then, */
    double waits_at;       /* [mu] when that was last looked at */
    _Atomic bool stopping; /* written with mu held; read anywhere */
};

/* What a thread's clocks said when it began with something. */
struct pool_stint {
    double cpu, wall;
};

/* --- pool_clock.c --- */

double pool_seconds(clockid_t clock);
struct pool_stint pool_stint_begin(struct renderer *by);
/* Locks the pool, too, for what was counted meanwhile; returns the processor
 * time that it took [s]. */
double pool_stint_end_and_lock(struct renderer *by, const struct pool_stint *s);

/* --- pool_thread.c --- */

/* What a thread of the pool runs; arg is its struct renderer. */
void pool_run_thread(void *arg);

/* --- pool_first.c --- */

/* An estimate that has areas left; NULL: none. */
struct estimating *first_find_estimate_locked(const struct pool *p);
/* Take areas until there are none. */
void first_work_on_estimate(struct renderer *by, struct estimating *e);
/* Have who is at seeding or an estimate leave it. */
void first_stop_locked(struct pool *p);
/* Hand on what is done. */
void first_give_estimates(struct pool *p);
void first_free_estimates(struct estimating *e);
void first_work_on_seed(struct renderer *by, struct rad_seed *s);
/* Tell of what is done. */
void first_end_seed(struct pool *p);

/* --- pool_unit.c --- */

/* Begin a window, which is freed, or a pass; the caller is its first member.
 * NULL: memory is out, and the loop hears of it. */
struct active *pool_unit_begin(struct pool *p, struct queued *window,
                               struct strict_pass *pass);
/* Be a member of the unit's team until there is nothing left to begin. */
void pool_unit_work(struct renderer *by, struct active *u);

/* --- pool_strict.c --- */

/* Time that threads have nothing to do, while units of theirs wait. */
void pool_settle_waits_locked(struct pool *p);
/* Do what the machine wants of a pass, and tell it how far it is. */
void pool_look_locked(struct pool *p);
/* Something changed: there may be work, and something to say. */
void pool_changed_locked(struct pool *p);
/* A team_bottom_fn; arg is a struct active. */
void pool_on_bottom(void *arg);
/* All have left a pass: u->counts are the unit's if that is all of it. */
void pool_end_pass_locked(struct active *u);

#endif
