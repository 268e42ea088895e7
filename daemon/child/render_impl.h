/* render_impl.h - shared by the files of a job's child, and private to them
 *
 *   render.c          the process, its link to radd, messages that come
 *   render_tell.c     messages that go to radd
 *   render_load.c     scene, frames and pool, from the files of the job
 *   render_units.c    units, facts, base lines and estimates that come
 *   render_records.c  ambient records that come and go
 *   render_passes.c   the ambient cache in passes
 *   render_stages.c   stages of a goal, each with options of its own
 * Thread: the loop. */
#ifndef RADD_DAEMON_RENDER_IMPL_H
#define RADD_DAEMON_RENDER_IMPL_H

#include "proto/ambshare.h"
#include "net/conn.h"
#include "pool/pool.h"

#include <uv.h>

/* Records that are handled, or sent, together. */
#define RENDER_BATCH (65536 / AMBSHARE_BYTES)
/* Messages that are not urgent (facts in case of a loss) wait while more bytes
 * than this wait in the link. */
#define RENDER_AHEAD (1u << 20)

/* The passes of the ambient cache. */
struct render_passes {
    struct rad_passes *passes;
    struct rad_pass *plan;  /* of the present stage */
    uint32_t n;             /* length of plan; 0: the cache has no passes */
    uint32_t base;          /* number of the stage's first pass in the job */
    uint32_t next;          /* passes whose records have all come */
    struct rad_ambrec *rec; /* records of the next pass that have come */
    uint8_t *walk;          /* or, if it is a pass of paths, ends (spots.h) */
    size_t nrecs;           /* length of rec, or of walk in records */
    bool shown;             /* the options of the pictures are known (SHOW) */
};

struct render {
    uv_loop_t loop;
    uv_timer_t drain;  /* sends ambient records */
    uv_timer_t teller; /* sends tallies */
    uv_timer_t ticker; /* strict_tick() */
    struct conn *link; /* to radd; NULL once it is closed */
    const char *files_dir;
    int nthreads;
    unsigned memory_mib; /* most memory of the process; 0: no limit */
    uint8_t id[MSG_JOB];
    bool share; /* live records are shared with peers */
    bool ended;
    bool records;         /* radsubmit wants the records (-af) */
    bool sandboxed;       /* a sandbox is required */
    int pixel_s;          /* most processor seconds of a pixel; 0: no limit */
    struct msg start;     /* JOB_START; its pointers lead into start_bytes */
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
    double doubled;      /* share of redundant records among the last that
                          * came */
    uint64_t first_ms;   /* when records were first sent; 0: never */
    bool borrowed;       /* columns of another worker were traced here */
    uint64_t sent, received, redundant; /* ambient records */
    struct pool_tally past;             /* of pools that are freed */
    uint64_t told_rays;                 /* rays_under_way in the last TALLY */
    uint64_t told_dropped;              /* dropped rays in the last TALLY */
    uint64_t told_ms;                   /* when the last TALLY was sent */
    int status;                         /* exit status, once ended */
};

/* --- render_tell.c --- */

/* Exit with that status when all messages are sent. */
void render_end(struct render *r, int status);
/* The job cannot go on here: send FAILED, and end. */
void render_fail(struct render *r, const struct rad_error *err);
/* Callbacks of the pool: rows are there; strict units changed. */
void render_on_rows(void *arg, const struct pool_rows *p);
void render_on_news(void *arg);
/* Send a TALLY. */
void render_send_tally(struct render *r);
/* From now on send a TALLY whenever its numbers have grown. */
void render_begin_tallies(struct render *r);
/* Send the messages of the strict units' machine. */
void render_send_news(struct render *r);
/* Add the pool's tally to r->past, before the pool is freed. */
void render_keep_tally(struct render *r);

/* --- render_load.c --- */

/* Load the job and start the pool.  After a failure call render_unload(). */
int render_load(struct render *r, const struct msg_spec *spec,
                struct rad_error *err);
/* Free all that render_load() made; or all but the scene, which the next
 * render_load() uses. */
void render_unload(struct render *r);
void render_unload_job(struct render *r);

/* --- render_passes.c --- */

/* The frames are loaded: lay out the passes of the cache, if it has any. */
int render_load_passes(struct render *r, struct rad_error *err);
/* The pool is there: let it make tiles. */
void render_begin_passes(struct render *r);
/* Free the passes; the pool is gone. */
void render_unload_passes(struct render *r);
/* Have the records of all passes come? */
bool render_cache_is_whole(const struct render *r);
/* Have exactly the records come over which the frame is made? */
bool render_cache_serves(const struct render *r, uint32_t frame);
/* Number of frames in the first batch. */
uint32_t render_first_batch(const struct render *r);
/* Handlers of TILE and FROZEN. */
void render_take_tile(struct render *r, const struct msg_tile *m);
void render_take_frozen(struct render *r, const struct msg_frozen *m);

/* --- render_stages.c --- */

/* Handlers of STAGE and SHOW. */
void render_take_stage(struct render *r, const struct msg_stage *m);
void render_take_show(struct render *r, const struct msg_stage *m);

/* --- render_units.c --- */

/* Handler of UNIT. */
void render_take_unit(struct render *r, const struct msg_unit *u);
/* Give a message to the strict units' machine. */
void render_take_strict(struct render *r, const struct msg *m);
/* Handler of ESTIMATE. */
void render_take_estimate(struct render *r, const struct msg_estimate *m);

/* --- render_records.c --- */

/* The job is loaded: send records from now on. */
void render_records_begin(struct render *r);
/* The job was loaded again and its cache is empty: go on with that. */
void render_records_again(struct render *r);
/* Send the records that threads have made since the last call. */
void render_drain(struct render *r);
/* Handler of AMBIENT. */
void render_take_ambient(struct render *r, const struct msg_ambient *a);

#endif
