/* pool.h - the threads that render
 *
 * T threads, each with a rad_ctx of its own, take units from one queue and
 * leave rows in another, which the loop empties.  A thread that finds no unit
 * joins the team of another thread's unit (team.h), which changes no pixel.
 * The queues are locked once per unit and per piece of rows, never per ray; the
 * only call into the loop from a render thread is uv_async_send().
 * Strict units (strict.h) are rendered in passes, each the work of one team; a
 * thread without work asks the strict units' machine for the next pass.  The
 * machine is called under the pool's lock, once a pass.
 * Thread: all calls on the loop's. */
#ifndef RADD_DAEMON_POOL_H
#define RADD_DAEMON_POOL_H

#include "child/estimate.h"
#include "passes/passes.h"
#include "strict/strict.h"

#include <uv.h>

struct pool_unit {
    uint32_t unit, attempt;
    uint32_t frame; /* index */
    struct rad_window window;
};

/* A piece of a unit's rows, each following the last; or a failure.  The height
 * of a strict unit is the height that it had when its rows were begun. */
struct pool_rows {
    struct pool_rows *next;
    struct pool_unit unit;
    uint32_t row, rows; /* from the top of the unit */
    int channels;       /* 3, or 4 with the distance; 1: coded */
    bool last;          /* counts are the unit's */
    struct msg_counts counts;
    struct rad_error err; /* code is not 0: the unit failed, no rows */
    size_t bytes;         /* of pixels: floats, or coded (rad_hdr_encode_row) */
    uint32_t pixels[];
};

struct pool;

/* rows is borrowed for the call. */
typedef void pool_rows_fn(void *arg, const struct pool_rows *rows);

/* Something changed with strict units: pool_tick() is due, and there may be
 * messages to send.  Also called just before rows are handed on, because
 * messages about their unit must be sent before these rows. */
typedef void pool_news_fn(void *arg);

/* What a pool renders; all that it points at must outlive the pool. */
struct pool_spec {
    const struct rad_job *job;
    const struct rad_frame *frames;
    struct strict *strict; /* NULL: there will be no strict units */
    int nthreads;
    bool coded; /* rows leave as in a picture file */
    pool_rows_fn *rows;
    pool_news_fn *news; /* with strict */
    void *arg;
};

/* Start the threads; NULL and *err on failure. */
struct pool *pool_new(uv_loop_t *loop, const struct pool_spec *spec,
                      struct rad_error *err);

/* Queue a window, which must lie in its frame. */
bool pool_push(struct pool *p, const struct pool_unit *u);

/* Lock the pool and return the machine of the strict units, to be told
 * something.  The threads wait until the pool is unlocked, then do what the
 * machine decides; pool_message() returns the messages that it has to send. */
struct strict *pool_lock_strict(struct pool *p);
void pool_unlock_strict(struct pool *p);

/* strict_tick() and strict_message() of the pool's machine, if it has one. */
uint64_t pool_tick(struct pool *p, uint64_t now_ms);
const struct msg *pool_message(struct pool *p, bool room);

/* strict_error(); 0 without that machine. */
int pool_error(struct pool *p);

/* Forget a unit: it leaves the queue, or stops within a few pixels.  Rows of it
 * may still come. */
void pool_revoke(struct pool *p, uint32_t unit, uint32_t attempt);

/* Have the threads make an estimate before they begin another unit.  The
 * estimate is the pool's until it is done; then fn gets it, with the pool's
 * arg, and frees it. */
typedef void pool_estimate_fn(void *arg, struct estimate *e, double wall_s);
bool pool_estimate(struct pool *p, struct estimate *e, pool_estimate_fn *fn);

/* --- the ambient cache in passes --- */

/* A tile that is made. */
struct pool_tile {
    struct pool_tile *next;
    uint32_t pass, tile;
    bool shows;      /* its colours are wanted */
    uint32_t behind; /* the cache has the records of so many passes more than
                      * it sees */
    struct msg_counts counts;
    uint32_t count;          /* records */
    struct wire_out records; /* as they are sent (proto/ambshare.h) */
    struct rad_pass_colours colours;
};

/* t is borrowed for the call. */
typedef void pool_tile_fn(void *arg, const struct pool_tile *t);

/* The cache comes in these passes, which outlive the pool; to be called before
 * any other of the calls below.  fn, with the pool's arg, gets the tiles. */
void pool_set_passes(struct pool *p, struct rad_passes *passes,
                     const struct rad_pass *plan, uint32_t n, pool_tile_fn *fn);

/* Make a tile of a pass that is not closed, and for which all passes that it
 * reads are, and its colours if it shows.  Tiles come before all other work,
 * and those of a pass before those of the next.  False: memory is out. */
bool pool_push_tile(struct pool *p, uint32_t pass, uint32_t tile, bool shows);

/* The next pass is closed, and these are its records, or the spots of all its
 * paths, NULL if they are not known; the malloc'd arrays are taken.  No more of
 * its tiles are made.  False: memory is out, and the arrays are the caller's.
 */
bool pool_freeze(struct pool *p, struct rad_ambrec *rec, size_t n,
                 struct rad_pass_spot *spot);

/* All passes are closed: units that begin from now on are of pictures with so
 * many rays of a pixel (rad_job_show()) of the pool's own job.  False: memory is
 * out. */
bool pool_show(struct pool *p, struct rad_job *job, int samples);

/* End estimates that are under way (REST), within a pixel of each thread; their
 * callbacks are called. */
void pool_rest(struct pool *p);

/* n bytes of pixels have left for good.  While more than POOL_UNSENT wait the
 * threads do. */
#define POOL_UNSENT (8u << 20)
void pool_sent(struct pool *p, size_t n);

/* The work of all threads so far, summed. */
struct pool_tally {
    double busy_s;             /* on units that are left */
    double wait_base_line_s;   /* asleep until the line above was ready, in
                                * units left and present; or without work while
                                * strict units waited for their tops */
    uint64_t rays_under_way;   /* of units that are not done */
    uint64_t pixels_under_way; /* of these units: strict_pixels() */
    struct msg_counts dropped; /* as strict_dropped() says */
};
struct pool_tally pool_tally(struct pool *p);

/* Has a thread used more than limit_s of processor time (0: any) for one pixel,
 * *x, *y?  To be called now and then: the time counts from the first call that
 * found the thread at this pixel. */
bool pool_stuck(struct pool *p, double limit_s, int *x, int *y);

/* Stop at the next bars, wait for the threads, free.  The loop must run once
 * more for the last handle. */
void pool_free(struct pool *p);

#endif
