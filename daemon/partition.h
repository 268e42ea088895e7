/* partition.h - what the units of a job are, and in which order they go out
 *
 * The scheduler (sched.c) knows units by number only: it takes the next one
 * for a worker, and says when one is done or lost.  Each pixel of each frame
 * belongs to exactly one unit.
 * Names: radsubmit(1), --partition.
 * Thread: one. */
#ifndef DAEMON_PARTITION_H
#define DAEMON_PARTITION_H

#include "message.h"

#define PARTITION_MAX_UNITS 1000000 /* of a job */

struct partition_area {
    uint32_t frame; /* index */
    uint32_t x, y, width, height;
};

struct partition_spec {
    enum msg_partition kind;
    enum msg_order order;
    uint32_t windows; /* per frame; 0: by the picture's size alone */
    uint64_t seed;    /* of MSG_ORDER_RANDOM */
    bool single;      /* one worker in all: auto is one window, which its
                       * threads render together */
    uint32_t nframes;
    const struct msg_frame *frames; /* not kept */
};

struct partition;

/* May the job be split like this?  0, or RAD_EUSAGE with a message for the
 * user.  Needs kind, order, windows and frames. */
int partition_check(const struct partition_spec *spec, struct rad_error *err);

/* NULL with *err: what partition_check says, or RAD_ENOMEM. */
struct partition *partition_new(const struct partition_spec *spec,
                                struct rad_error *err);
void partition_free(struct partition *p);

uint32_t partition_total(const struct partition *p); /* units */
uint32_t
partition_waiting(const struct partition *p);       /* neither out nor done */
uint32_t partition_left(const struct partition *p); /* not done */

/* The unit that the worker (a number that stays with it) should do next, out
 * of the queue from now on; false when none waits. */
bool partition_next(struct partition *p, uint32_t worker, uint32_t *unit);

/* A unit that is out came back undone: it waits again, before the others. */
void partition_lost(struct partition *p, uint32_t unit);

/* Take a certain waiting unit out of the queue. */
void partition_take(struct partition *p, uint32_t unit);

/* A unit that is out is done. */
void partition_done(struct partition *p, uint32_t unit);

void partition_area(const struct partition *p, uint32_t unit,
                    struct partition_area *area);

/* Estimated cost, in an unit of its own, above 0. */
double partition_cost(const struct partition *p, uint32_t unit);

/* Why auto chose what it chose, or what was asked for; and the kind that it
 * is. */
const char *partition_choice(const struct partition *p);
enum msg_partition partition_kind(const struct partition *p);

/* "window" and the like. */
const char *partition_kind_name(enum msg_partition kind);

#endif
