/* model.h - what radweb knows of the cluster: its lists, and its last hour
 *
 * Asks the coordinator for its status, its workers and its jobs, once a second
 * while somebody looks and once in MODEL_IDLE_MS else, one request after the
 * other.  The rows are the coordinator's, as `radctl --json` shows them.
 * Bounds: MODEL_WORKERS, MODEL_OPEN and MODEL_OVER rows, of which a page of the
 * coordinator has 256 KiB for each 200; MODEL_TEXT of each list, about ten
 * times as much as values, and twice that while the next lists come. Thread:
 * the loop's. */
#ifndef RADD_OBSERVER_MODEL_H
#define RADD_OBSERVER_MODEL_H

#include "draw/history.h"
#include "observer/session.h"

#include <jansson.h>

#define MODEL_WORKERS 1000
#define MODEL_OPEN                                                             \
    1000 /* jobs that are not over: the newest and those that run */
#define MODEL_OVER    100 /* jobs that are, the newest */
#define MODEL_TEXT    (2 << 20)
#define MODEL_COUNTED 10000 /* jobs of which is known what was counted */
#define MODEL_BUSY_MS 1000
#define MODEL_IDLE_MS 10000
#define MODEL_SEEN_MS 20000 /* somebody looked: asked often for so long */

/* Sums since radweb started, for /metrics: they never fall. */
struct model_sums {
    double rays, bytes, redundant;    /* redundant: ambient values */
    uint64_t done, failed, cancelled; /* jobs that ended so */
    uint64_t polls, lost; /* times that all was asked, and that it failed */
};

struct model {
    struct session *session;
    uv_loop_t *loop;
    uint64_t version;  /* rises with each change that a page shows */
    bool up;           /* the lists are of a coordinator that answers */
    uint64_t asked_ms; /* of the last answer to all */
    json_t *status;    /* never NULL, as the lists: empty at first */
    json_t *workers;   /* in the order in which they came */
    json_t *open;      /* jobs in the order in which they are served */
    json_t *over;      /* the newest first */
    double rays_s;     /* of the whole cluster, over the last seconds */
    double at_work;    /* threads whose worker is at work, of all; 0 to 1 */
    struct history history;
    struct model_sums sums;
    /* its own */
    uint64_t seen_ms, due_ms, rate_ms;
    double rate_rays;
    unsigned round; /* a number of the request that is out; 0: none is */
    json_t *coming; /* rows that were got so far */
    size_t text;    /* bytes that they were */
    uint64_t cursor;
    bool cut, was_cut; /* more jobs are open than are listed: in this round, in
                        * the one before */
    json_t *next_workers, *next_open, *next_over, *next_status;
    json_t *counted; /* by job: what the sums have of it */
    void (*changed)(void *arg);
    void *arg;
};

/* False: memory is out.  changed is called whenever version has risen. */
bool model_init(struct model *m, uv_loop_t *loop, struct session *s,
                void (*changed)(void *arg), void *arg);
void model_release(struct model *m);

/* Ask if it is time; each DAEMON_TICK_MS. */
void model_tick(struct model *m);
/* Somebody looks. */
void model_seen(struct model *m);

#endif
