/* render_impl.h - what the parts of a job's child share; for them alone
 *
 *   render.c          the process, its link to radd, what is heard there
 *   render_tell.c     what is said there
 *   render_load.c     scene, frames and what renders them, from the cache
 *   render_units.c    units, facts, base lines and estimates that come
 *   render_records.c  ambient records that come and go
 * Thread: the loop's. */
#ifndef RADD_DAEMON_RENDER_IMPL_H
#define RADD_DAEMON_RENDER_IMPL_H

#include "worker/ambseen.h"
#include "proto/ambshare.h"
#include "net/conn.h"
#include "child/pool.h"

#include <uv.h>

/* Records that are looked at, or sent, at a time. */
#define RENDER_BATCH (65536 / AMBSHARE_BYTES)
/* Someone who gets the whole cache, or facts for the case of a loss, is given
 * more when so little waits. */
#define RENDER_AHEAD (1u << 20)

struct render {
    uv_loop_t loop;
    uv_timer_t drain;  /* of ambient records */
    uv_timer_t teller; /* of what was done so far */
    uv_timer_t ticker; /* of strict units */
    struct conn *link; /* NULL once it is gone */
    const char *files_dir;
    int nthreads;
    unsigned memory_mib; /* most that it may have; 0: any */
    uint8_t id[MSG_JOB];
    bool share, ended;
    bool records;         /* radsubmit wants them */
    bool sandboxed;       /* must be */
    int pixel_s;          /* most processor time of a pixel; 0: any */
    struct msg start;     /* JOB-START, in start_bytes */
    uint8_t *start_bytes; /* its payload */
    uint32_t frame;       /* of the last unit; nframes before the first */
    struct rad_scene *scene;
    struct rad_job *job;
    struct rad_frame *frames;
    uint32_t nframes;
    struct strict *strict; /* NULL: the picture is not shared by lines */
    struct pool *pool;
    struct give *gives;
    struct ambseen seen;  /* records that the cache has */
    uint64_t loaded;      /* where records begin that others may lack */
    double doubled;       /* share of late that was redundant */
    uint64_t first_ms;    /* records were drained; 0: not yet */
    struct msg_seed seed; /* last is 0: none came; job is not kept */
    bool seeding;
    bool twin; /* others were at a unit that is here, too */
    uint64_t sent, received, redundant; /* ambient records */
    struct pool_tally past;             /* of pools that are freed */
    uint64_t told_rays;    /* under way, and of seeding, in the last TALLY */
    uint64_t told_dropped; /* likewise */
    uint64_t told_ms;      /* when that was */
    int status;
};

/* --- render_tell.c --- */

/* Leave with that status when what was said is out. */
void render_end(struct render *r, int status);
/* The job cannot go on here: say why, and leave. */
void render_fail(struct render *r, const struct rad_error *err);
/* The pool's: rows are there; something changed with strict units. */
void render_on_rows(void *arg, const struct pool_rows *p);
void render_on_news(void *arg);
/* Tell what was done so far, now, or from now on whenever it is more. */
void render_send_tally(struct render *r);
void render_begin_tallies(struct render *r);
/* What strict units have to say. */
void render_send_news(struct render *r);
/* The pool is about to be freed, and another will follow: what was done so far
 * counts. */
void render_keep_tally(struct render *r);

/* --- render_load.c --- */

/* No frame has begun then.  What a failure leaves is for render_unload(). */
int render_load(struct render *r, const struct msg_spec *spec,
                struct rad_error *err);
/* Free all that render_load() made. */
void render_unload(struct render *r);

/* --- render_units.c --- */

void render_take_unit(struct render *r, const struct msg_unit *u);
/* What the machine of the strict units is to know. */
void render_take_strict(struct render *r, const struct msg *m);
void render_take_estimate(struct render *r, const struct msg_estimate *m);

/* --- render_records.c --- */

/* The job is loaded: look for records from now on. */
void render_records_begin(struct render *r);
/* It is loaded anew: who was to get all gets all of that. */
void render_records_again(struct render *r);
void render_records_release(struct render *r);
/* Send what the threads have made since the last call. */
void render_drain(struct render *r);
/* The part of a frame's, or all frames', deep records that is made here. */
void render_take_seed(struct render *r, const struct msg_seed *m);
void render_begin_seed(struct render *r, uint32_t frame);
void render_take_ambient(struct render *r, const struct msg_ambient *a);
void render_take_give(struct render *r, const struct msg_give *m);

#endif
