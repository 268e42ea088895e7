/* watch.h - jobs that somebody looks at: details, statistics, picture
 *
 * A job is asked about while it is looked at, and only then: its details once a
 * second, its statistics and its picture at longer intervals the longer they
 * take, since the coordinator serves others, too.  What takes long here
 * (reading statistics, decoding a picture) is done off the loop.
 * WATCH_MOST at once; one that nobody has looked at for longest gives way, and
 * is not asked for sooner when it comes back.
 * Memory: of all jobs one picture or one statistics at a time is on its way:
 * PICTURE_BYTES twice at most, then once beside 4 * PICTURE_MOST bytes decoded
 * and what is made of them.
 * Thread: the loop's. */
#ifndef RADD_OBSERVER_WATCH_H
#define RADD_OBSERVER_WATCH_H

#include "observer/blob.h"
#include "draw/picture.h"
#include "observer/session.h"
#include "draw/units.h"

#include <jansson.h>

#define WATCH_MOST    8
#define WATCH_SEEN_MS 10000 /* looked at: asked about for so long */
/* Bytes of answers (blob.h); above, pictures wait. */
#define WATCH_ALIVE ((size_t)160 << 20)
#define WATCH_STATS (24 << 20) /* most bytes of a job's statistics */
#define WATCH_PACES 64         /* of jobs that gave way */

/* Something that the coordinator is asked for, again and again. */
struct watch_query {
    bool out;         /* asked for, and not answered yet */
    bool answered;    /* once at least, be it by a refusal */
    uint64_t due_ms;  /* when to ask again */
    uint64_t from_ms; /* when it was asked for */
    char of[96];      /* the job's state when asked; "": that failed */
};

struct watch {
    struct watch *next;
    struct watches *all;
    uint8_t id[MSG_JOB];
    char hex[MSG_JOB_HEX];
    uint32_t frame;
    unsigned streams;   /* pages with events that follow the job */
    uint64_t seen_ms;   /* somebody looked */
    uint64_t version;   /* rises with each change */
    struct watch_query row, stats, picture;
    json_t *detail;          /* the job's row; NULL: not known (yet) */
    struct units units;      /* head NULL: none */
    struct blob *rgbe, *png; /* as picture.h has them; NULL: none */
    uint64_t picture_version;
    int width, height, factor;
    char view[PICTURE_VIEW], scene[PICTURE_VIEW]; /* as in picture.h */
    char note[300];     /* why there is no picture; "" */
    struct blob *event; /* of that version, as it is sent (events.c) */
    uint64_t event_version;
};

/* When a job that gave way may be asked for again. */
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
    unsigned npaces;                      /* that were ever put into it */
    uint64_t rest_ms; /* no picture and no statistics are asked for before */
    void (*changed)(void *arg, struct watch *w);
    void *arg;
};

/* changed is called when a version has risen. */
void watch_init(struct watches *all, uv_loop_t *loop, struct session *s,
                void (*changed)(void *arg, struct watch *w), void *arg);
/* When the session is closed and no work runs. */
void watch_release(struct watches *all);

/* Ask what is due; each DAEMON_TICK_MS. */
void watch_tick(struct watches *all);

/* Somebody looks at that frame of the job.  NULL: too many are looked at, or
 * memory is out. */
struct watch *watch_find(struct watches *all, const char *hex, uint32_t frame);

/* Is all there that a page shows, or known not to be; and the picture? */
bool watch_is_ready(const struct watch *w);
bool watch_has_picture(const struct watch *w);

/* A page with events of the job begins or ends: while there are any, the job is
 * watched. */
void watch_follow(struct watch *w);
void watch_leave(struct watch *w);

#endif
