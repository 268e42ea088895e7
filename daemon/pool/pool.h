/* pool.h - the threads of a job's child that render
 *
 * T threads, each with a rad_ctx of its own, take units from one queue and put
 * rows into another, which the loop empties.  A thread that finds no unit joins
 * the team of another thread's unit (team.h), which changes no pixel.  The
 * queues are locked once a unit and once a piece of rows, never per ray; the
 * only call for the loop from a render thread is wake_send().
 * Strict units (strict.h) are rendered in passes, each by one team.  A thread
 * without work asks the strict units' machine for the next pass, under the
 * pool's lock.
 * Thread: all functions are called by the loop thread. */
#ifndef RADD_DAEMON_POOL_H
#define RADD_DAEMON_POOL_H

#include "pool/estimate.h"
#include "passes/passes.h"
#include "strict/strict.h"

#include <uv.h>

struct pool_unit {
    uint32_t unit, attempt;
    uint32_t frame; /* index in pool_spec.frames */
    struct rad_window window;
};

/* A piece of a unit's rows, which follows the piece before; or a failure.  The
 * window of a strict unit has the height that it had when its rows were begun.
 */
struct pool_rows {
    struct pool_rows *next;
    struct pool_unit unit;
    uint32_t row, rows; /* from the top of the unit */
    int channels;       /* 3, or 4 with the distance; 1: coded */
    bool last;          /* the unit's last piece: counts are the whole unit's */
    struct msg_counts counts;
    struct rad_error err; /* code is not 0: the unit failed, there are no rows
                           */
    size_t bytes;         /* of pixels: floats, or coded (rad_hdr_encode_row) */
    uint32_t pixels[];
};

struct pool;

/* Called by the loop thread with a piece; rows is borrowed for the call. */
typedef void pool_rows_fn(void *arg, const struct pool_rows *rows);

/* Called by the loop thread when strict units changed: pool_tick() is due, and
 * pool_message() may have messages.  Also called just before rows are handed
 * on, because messages about their unit must be sent first. */
typedef void pool_news_fn(void *arg);

/* What a pool renders; all that it points at outlives the pool. */
struct pool_spec {
    const struct rad_job *job;
    const struct rad_frame *frames;
    struct strict *strict; /* NULL: there will be no strict units */
    int nthreads;
    bool coded; /* rows are coded as in a picture file, else floats */
    pool_rows_fn *rows;
    pool_news_fn *news; /* only with strict */
    void *arg;          /* for all callbacks */
};

/* Start the threads; NULL and *err on failure. */
struct pool *pool_new(uv_loop_t *loop, const struct pool_spec *spec,
                      struct rad_error *err);

/* Queue a window, which must lie in its frame; false: memory is out. */
bool pool_push(struct pool *p, const struct pool_unit *u);

/* Lock the pool and return the strict units' machine, to give it an event.
 * Threads wait until the pool is unlocked, and then do what the machine
 * decides; pool_message() has the messages that it sends. */
struct strict *pool_lock_strict(struct pool *p);
void pool_unlock_strict(struct pool *p);

/* strict_tick() and strict_message() of the pool's machine, if it has one. */
uint64_t pool_tick(struct pool *p, uint64_t now_ms);
const struct msg *pool_message(struct pool *p, bool room);

/* strict_error() of the pool's machine; 0: it has none. */
int pool_error(struct pool *p);

/* Take a unit back: it leaves the queue, or ends within a few pixels.  Rows of
 * it may still come. */
void pool_revoke(struct pool *p, uint32_t unit, uint32_t attempt);

/* Have the threads make an estimate before they begin another unit.  The pool
 * owns it until it is done; then fn, called with the pool's arg, owns it.
 * False: memory is out. */
typedef void pool_estimate_fn(void *arg, struct estimate *e, double wall_s);
bool pool_estimate(struct pool *p, struct estimate *e, pool_estimate_fn *fn);

/* --- the ambient cache in passes --- */

/* A tile to make, or made. */
struct pool_tile {
    struct pool_tile *next;
    uint32_t pass, tile;
    bool tells_colours; /* its colours are wanted */
    struct msg_counts counts;
    uint32_t count;          /* number of records */
    struct wire_out records; /* as on the wire (proto/ambshare.h) */
    struct rad_pass_colours colours;
};

/* Called by the loop thread with a tile that is made, borrowed for the call. */
typedef void pool_tile_fn(void *arg, const struct pool_tile *t);

/* Make the ambient cache in these passes, which outlive the pool.  Called once,
 * before any of the functions below.  fn gets the tiles that are made. */
void pool_set_passes(struct pool *p, struct rad_passes *passes,
                     const struct rad_pass *plan, uint32_t n, pool_tile_fn *fn);

/* Make a tile of a pass that is not closed, when all passes that it reads are
 * in the cache; and its colours, if wanted.  Tiles come before all
 * other work, in the order in which they are pushed.  False: memory is out. */
bool pool_push_tile(struct pool *p, uint32_t pass, uint32_t tile,
                    bool tells_colours);

/* The next pass is closed: put its records into the cache, or, of a pass of
 * paths, take their ends (spot; NULL: not known).  Both arrays are malloc'd and
 * taken.  Further tiles of the pass are not made.  False: memory is out, and
 * the caller keeps the arrays. */
bool pool_freeze(struct pool *p, struct rad_ambrec *rec, size_t n,
                 struct rad_pass_spot *spot);

/* All passes are closed: units that begin from now on are of pictures with so
 * many rays of a pixel (rad_job_show()) of the pool's own job.  False: memory
 * is out. */
bool pool_show(struct pool *p, struct rad_job *job, int samples);

/* Note that n bytes have been written to the link.  Threads that hand
 * on rows wait while more than POOL_UNSENT bytes are not written. */
#define POOL_UNSENT (8u << 20)
void pool_sent(struct pool *p, size_t n);

/* Bring up to date what pool_tally() tells of strict units: the time that
 * threads have waited for their tops, and how far each is. */
void pool_settle(struct pool *p);

/* What all threads have done so far. */
struct pool_tally {
    double busy_s;             /* on pieces of work that are finished */
    double wait_base_line_s;   /* asleep until the line above was ready; or
                                * without work while strict units waited for
                                * their tops */
    uint64_t rays_under_way;   /* of units that are not done */
    uint64_t pixels_under_way; /* of these units: strict_pixels() */
    struct msg_counts dropped; /* strict_dropped(), and dropped tiles */
};
struct pool_tally pool_tally(struct pool *p);

/* Has a thread spent more than limit_s of processor time (0: no limit) on one
 * pixel, *x, *y?  Call it now and then: a pixel's time counts from the first
 * call that finds a thread at it. */
bool pool_stuck(struct pool *p, double limit_s, int *x, int *y);

/* Stop the threads at their next bars, wait for them, and free.  The loop must
 * run once more to close the last handle. */
void pool_free(struct pool *p);

#endif
