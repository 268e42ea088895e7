/* model.h - the cluster as radweb knows it: its lists, and its last hour
 *
 * In a round the coordinator is asked for its status, workers and jobs, one
 * request after the other.  A round begins once in MODEL_BUSY_MS while pages
 * are looked at, else once in MODEL_IDLE_MS.  The rows are the coordinator's,
 * as `radctl --json` shows them.
 *
 * Bounds: MODEL_WORKERS, MODEL_OPEN and MODEL_OVER rows; a page of the
 * coordinator has at most 200 rows and 256 KiB.  MODEL_TEXT bytes of text for
 * each list, which take some ten times as much memory as JSON values, and twice
 * that while the lists of the next round come.
 * Thread: the loop's. */
#ifndef RADD_OBSERVER_MODEL_H
#define RADD_OBSERVER_MODEL_H

#include "observer/history.h"
#include "observer/session.h"

#include <jansson.h>

#define MODEL_WORKERS 1000
#define MODEL_OPEN                                                             \
    1000 /* jobs that are not over: the newest, and all that run */
#define MODEL_OVER    100 /* jobs that are over: the newest */
#define MODEL_TEXT    (2 << 20)
#define MODEL_COUNTED 10000 /* jobs whose counters are kept */
#define MODEL_BUSY_MS 1000
#define MODEL_IDLE_MS 10000
#define MODEL_SEEN_MS 20000 /* a page counts as looked at for so long */

/* Sums since radweb started, for /metrics: they never fall. */
struct model_sums {
    double rays, bytes, redundant;    /* redundant: ambient records */
    uint64_t done, failed, cancelled; /* jobs that ended in such a state */
    uint64_t polls, lost; /* rounds that succeeded, and that failed */
};

struct model {
    struct session *session;
    uv_loop_t *loop;
    uint64_t version;  /* rises with each change that a page shows */
    bool up;           /* the last round succeeded */
    uint64_t asked_ms; /* when the last round ended */
    json_t *status;    /* never NULL, nor are the lists: empty at first */
    json_t *workers;   /* in the order in which the workers first came */
    json_t *open;      /* jobs in the order in which they are served */
    json_t *over;      /* jobs that are over, the newest first */
    double rays_s;     /* of the whole cluster, over the last seconds */
    double at_work;    /* threads of busy workers, as a share of all; 0 to 1 */
    struct history history;
    struct model_sums sums;
    /* private to model.c */
    uint64_t seen_ms, due_ms, rate_ms;
    double rate_rays;
    unsigned round;    /* step of the round that is under way; 0: no round is */
    json_t *coming;    /* rows of the step's list so far */
    size_t text;       /* bytes of text of these rows */
    uint64_t cursor;   /* of the next page of the step's list */
    bool cut, was_cut; /* more jobs are open than are listed: in this round, in
                        * the round before */
    json_t *next_workers, *next_open, *next_over, *next_status;
    json_t *counted; /* for each job its counters that are in the sums */
    void (*changed)(void *arg);
    void *arg;
};

/* Returns false if memory is out.  changed is called whenever version has
 * risen. */
bool model_init(struct model *m, uv_loop_t *loop, struct session *s,
                void (*changed)(void *arg), void *arg);
void model_release(struct model *m);

/* Begin a round if it is due; call each DAEMON_TICK_MS. */
void model_tick(struct model *m);
/* A page was asked for: ask the coordinator often for MODEL_SEEN_MS. */
void model_seen(struct model *m);

#endif
