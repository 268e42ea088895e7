/* watch.h - jobs that browsers look at: details, statistics, picture
 *
 * The coordinator is asked about a job only while a page of the job is looked
 * at: once a second for its details; for statistics and picture the less often
 * the longer they take, since the coordinator serves others, too.  Statistics
 * are read and pictures decoded off the loop.
 * At most WATCH_MOST jobs are watched.  For another job the job that was looked
 * at the longest ago is dropped; when a dropped job is watched again, its
 * statistics and picture are not asked for sooner than they would have been.
 *
 * Memory: one picture or one job's statistics at a time is on its way.  It
 * takes PICTURE_BYTES twice at most; then once, beside 4 * PICTURE_MOST bytes
 * of the decoded picture and the images that are made of that.
 * Thread: the loop's. */
#ifndef RADD_OBSERVER_WATCH_H
#define RADD_OBSERVER_WATCH_H

#include "observer/blob.h"
#include "observer/picture.h"
#include "observer/session.h"
#include "observer/units.h"

#include <jansson.h>

#define WATCH_MOST    8
#define WATCH_SEEN_MS 10000 /* watched so long after watch_look_at() */
/* Bytes of all blobs (blob.h) above which no picture is asked for. */
#define WATCH_ALIVE ((size_t)160 << 20)
#define WATCH_STATS (24 << 20) /* most bytes of a job's statistics */
#define WATCH_PACES 64         /* dropped jobs whose due times are kept */

/* A request that is repeated: for a job's details, statistics or picture. */
struct watch_query {
    bool out;         /* sent, and not answered yet */
    bool answered;    /* at least once, if only by a refusal */
    uint64_t due_ms;  /* when the request is to be sent again */
    uint64_t from_ms; /* when the request was last sent */
    char of[96];      /* the job's progress at from_ms; "": request failed */
};

struct watch {
    struct watch *next;
    struct watches *all;
    uint8_t id[MSG_JOB];
    char hex[MSG_JOB_HEX];
    uint32_t frame;
    unsigned streams;   /* open pages that get the job's events */
    uint64_t seen_ms;   /* when a page of the job was last asked for */
    uint64_t version;   /* rises with each change that a page shows */
    struct watch_query row, stats, picture;
    json_t *detail;          /* the job's row; NULL: not known (yet) */
    char gone[300];          /* why there is no such job (any more); or "" */
    struct units units;      /* the statistics; head NULL: none */
    struct blob *rgbe, *png; /* as in picture.h; NULL: none */
    uint64_t picture_version;
    int width, height, factor;
    char view[PICTURE_VIEW], scene[PICTURE_VIEW]; /* as in picture.h */
    char note[300];     /* why there is no picture; or "" */
    struct blob *event; /* the event of event_version (events.c) */
    uint64_t event_version;
};

/* When a job that was dropped may be asked for again. */
struct watch_pace {
    uint8_t id[MSG_JOB];
    uint32_t frame;
    uint64_t stats_ms, picture_ms;
};

struct watches {
    struct session *session;
    uv_loop_t *loop;
    struct watch *first;
    unsigned n;
    struct watch_pace paces[WATCH_PACES]; /* a ring */
    unsigned npaces;                      /* entries that were ever written */
    uint64_t rest_ms; /* no picture or statistics are asked for before this */
    void (*changed)(void *arg, struct watch *w);
    void *arg;
};

/* changed is called whenever a watch's version has risen. */
void watch_init(struct watches *all, uv_loop_t *loop, struct session *s,
                void (*changed)(void *arg, struct watch *w), void *arg);
/* Only when the session is closed and no work runs off the loop. */
void watch_release(struct watches *all);

/* Send the requests that are due; call each DAEMON_TICK_MS. */
void watch_tick(struct watches *all);

/* Note that a page asks for a frame of the job, and watch the job's frame if it
 * is not watched yet.  NULL: too many are watched, or memory is out. */
struct watch *watch_look_at(struct watches *all, const char *hex,
                            uint32_t frame);

/* Have the requests for details and statistics been answered, if only by a
 * refusal?  Those for details and the picture? */
bool watch_is_ready(const struct watch *w);
bool watch_has_picture(const struct watch *w);

/* A page with the job's events is opened or closed; the job is watched while
 * one is open. */
void watch_follow(struct watch *w);
void watch_leave(struct watch *w);

#endif
