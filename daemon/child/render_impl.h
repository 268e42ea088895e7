/* render_impl.h - shared by the files of a job's child, and private to them
 *
 *   render.c          the process, its link to radd, messages that come
 *   render_tell.c     messages that go to radd
 *   render_load.c     scene, frames and what renders them, from the cache
 *   render_units.c    units, facts, base lines and estimates that come
 *   render_records.c  ambient records that come and go
 *   render_passes.c   the ambient cache in passes
 *   render_stages.c   stages of a job, each with its own options
 * Thread: the loop's. */
#ifndef RADD_DAEMON_RENDER_IMPL_H
#define RADD_DAEMON_RENDER_IMPL_H

#include "worker/ambseen.h"
#include "proto/ambshare.h"
#include "net/conn.h"
#include "child/pool.h"

#include <uv.h>

/* Records that are handled, or sent, at a time. */
#define RENDER_BATCH (65536 / AMBSHARE_BYTES)
/* A peer that gets the whole cache, and facts in case of a loss, are sent on
 * when no more than so many bytes wait in the link. */
#define RENDER_AHEAD (1u << 20)

/* The passes of the cache; n is 0: it has none. */
struct render_passes {
    struct rad_passes *passes;
    struct rad_pass *plan;
    uint32_t n;
    uint32_t base;          /* of the job's passes, the first of this stage */
    uint32_t next;          /* the first whose records have not all come */
    struct rad_ambrec *rec; /* of that pass: records that have come; or */
    uint8_t *walk;          /* in a pass of paths their ends (spots.h) */
    size_t nrecs;
    bool shown;             /* it is known how pictures are made over it */
};

struct render {
    uv_loop_t loop;
    uv_timer_t drain;  /* of ambient records */
    uv_timer_t teller; /* of what was done so far */
    uv_timer_t ticker; /* of strict units */
    struct conn *link; /* NULL once it is gone */
    const char *files_dir;
    int nthreads;
    unsigned memory_mib; /* most memory of the process; 0: any */
    uint8_t id[MSG_JOB];
    bool share, ended;
    bool records;         /* radsubmit wants the records (-af) */
    bool sandboxed;       /* must be */
    int pixel_s;          /* most processor time of a pixel; 0: any */
    struct msg start;     /* JOB-START, in start_bytes */
    uint8_t *start_bytes; /* its payload */
    uint32_t frame;       /* of the last unit; nframes before the first */
    struct rad_scene *scene;
    struct rad_job *job;
    unsigned char *points_bytes; /* of a job of sensor points, else NULL */
    struct rad_points points;
    struct rad_frame *frames;
    uint32_t nframes;
    struct strict *strict; /* NULL: the picture is not shared by lines */
    struct pool *pool;
    struct render_passes passes;
    struct give *gives;
    struct ambseen seen;  /* records that the cache has */
    uint64_t loaded;      /* where records begin that others may lack */
    double doubled;       /* share of late that was redundant */
    uint64_t first_ms;    /* records were drained; 0: not yet */
    bool twin; /* a unit here had a twin at another worker */
    uint64_t sent, received, redundant; /* ambient records */
    struct pool_tally past;             /* of pools that are freed */
    uint64_t told_rays;    /* under way in the last TALLY */
    uint64_t told_dropped; /* dropped rays in the last TALLY */
    uint64_t told_ms;      /* when the last TALLY was sent */
    int status;
};

/* --- render_tell.c --- */

/* Exit with that status when all messages are sent. */
void render_end(struct render *r, int status);
/* The job cannot go on here: say why, and leave. */
void render_fail(struct render *r, const struct rad_error *err);
/* The pool's: rows are there; something changed with strict units. */
void render_on_rows(void *arg, const struct pool_rows *p);
void render_on_news(void *arg);
/* Send a TALLY now; send one from now on whenever its numbers have grown. */
void render_send_tally(struct render *r);
void render_begin_tallies(struct render *r);
/* Send the messages of the strict units. */
void render_send_news(struct render *r);
/* The pool is about to be freed, and another will follow: keep its tally. */
void render_keep_tally(struct render *r);

/* --- render_load.c --- */

/* Load the job; no frame has begun.  After a failure call render_unload(). */
int render_load(struct render *r, const struct msg_spec *spec,
                struct rad_error *err);
/* Free all that render_load() made; or all but the scene, which the next
 * render_load() then has. */
void render_unload(struct render *r);
void render_unload_job(struct render *r);

/* --- render_passes.c --- */

/* The frames are loaded: lay out the passes, if the cache comes in such. */
int render_load_passes(struct render *r, struct rad_error *err);
/* There is a pool: it may get tiles. */
void render_begin_passes(struct render *r);
/* When the pool is gone. */
void render_unload_passes(struct render *r);
/* Did the records of all passes come? */
bool render_cache_is_whole(const struct render *r);
/* Did those come that the frame is made with, and no others? */
bool render_cache_serves(const struct render *r, uint32_t frame);
/* Frames below that number are made with the records of the first batch. */
uint32_t render_first_batch(const struct render *r);
void render_take_tile(struct render *r, const struct msg_tile *m);
void render_take_frozen(struct render *r, const struct msg_frozen *m);
/* Does the job's cache come in stages? */
bool render_has_stages(const struct render *r);

/* --- render_stages.c --- */

void render_take_stage(struct render *r, const struct msg_stage *m);
void render_take_show(struct render *r, const struct msg_stage *m);

/* --- render_units.c --- */

void render_take_unit(struct render *r, const struct msg_unit *u);
/* Hand a message to the machine of the strict units. */
void render_take_strict(struct render *r, const struct msg *m);
void render_take_estimate(struct render *r, const struct msg_estimate *m);

/* --- render_records.c --- */

/* The job is loaded: look for records from now on. */
void render_records_begin(struct render *r);
/* The job is loaded anew, with an empty cache: peers that were being sent the
 * whole cache are sent all of the new one. */
void render_records_again(struct render *r);
void render_records_release(struct render *r);
/* Send the records that the threads have made since the last call. */
void render_drain(struct render *r);
void render_take_ambient(struct render *r, const struct msg_ambient *a);
void render_take_give(struct render *r, const struct msg_give *m);

#endif
