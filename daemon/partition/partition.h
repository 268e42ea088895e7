/* partition.h - what the units of a job are, and in which order they go out
 *
 * The scheduler (sched.c) knows units by number only: it takes the next one
 * for a worker, and says when one is done or lost.  Each pixel of each frame
 * belongs to at most one unit, and in the end to exactly one.
 * Windows are all laid out at the start.  A strict partition (static, scanbar,
 * auto) shares the lines of a frame (proto/msg_sharing.h): a unit is cut when
 * it goes out, whole lines as wide as the frame, and may shrink later; so there
 * come to be more of them.
 * Costs are in any unit, the same for all of a job: pixels, or what an estimate
 * says.
 * Names: radsubmit(1), --partition.
 * Thread: one. */
#ifndef DAEMON_PARTITION_H
#define DAEMON_PARTITION_H

#include "proto/message.h"

#define PARTITION_MAX_LINES 16000000 /* lines of all frames of a job */
#define PARTITION_NONE      UINT32_MAX

struct partition_area {
    uint32_t frame; /* index */
    uint32_t x, y, width, height;
};

struct partition_spec {
    enum msg_partition kind;
    enum msg_order order;
    uint32_t windows;   /* per frame; 0: by the picture's size alone */
    uint64_t seed;      /* of MSG_ORDER_RANDOM, and where costs are not known */
    bool single;        /* one worker in all: auto by windows is one window,
                         * which its threads render together */
    bool strict;        /* auto shares lines; else windows */
    bool balance;       /* static: an idle worker takes of others' runs */
    bool fresh;         /* a frame begins when the one before it is done */
    int psample;        /* -ps, from 1 to 16, where lines are shared */
    uint32_t ncosts;    /* 0: none, or as many as lines of all frames */
    const float *costs; /* not kept */
    uint32_t nframes;
    const struct msg_frame *frames; /* not kept */
};

/* A worker asks for a unit. */
struct partition_ask {
    uint32_t worker;  /* a number that stays with it, small */
    uint32_t workers; /* that take part, it among them */
    double share;     /* its part of the speed of all, 0 to 1 */
    double least;     /* cost that is worth a unit, where known; else 0 */
    bool idle;        /* it has nothing else to do */
};

struct partition;

/* May the job be split like this?  0, or RAD_EUSAGE with a message for the
 * user. */
int partition_check(const struct partition_spec *spec, struct rad_error *err);

/* NULL with *err: what partition_check says, or RAD_ENOMEM. */
struct partition *partition_new(const struct partition_spec *spec,
                                struct rad_error *err);
void partition_free(struct partition *p);

/* Do its units share lines? */
bool partition_is_strict(const struct partition *p);

uint32_t partition_total(const struct partition *p); /* units so far */

/* Units of frames below that number may go out; at first those of all. */
void partition_open(struct partition *p, uint32_t frames);

/* How much may go out now: units that wait, and lines that are in no unit. */
uint32_t partition_waiting(const struct partition *p);

/* --- costs ---
 * Parts are what costs are known of: windows, or lines of all frames, frame
 * after frame. */
uint32_t partition_parts(const struct partition *p);
void partition_part(const struct partition *p, uint32_t part,
                    struct partition_area *area);

/* Estimated costs of all parts, before any unit went out. */
void partition_set_costs(struct partition *p, const double *cost);

/* Static: the speeds of the workers that take part from the start, by number; 0
 * for one that does not.  Before any unit went out.  False: memory is out. */
bool partition_set_speeds(struct partition *p, const double *speed, uint32_t n);

/* Static: the worker is absent, or gets no units; others may take of its run
 * until it is back. */
void partition_set_absent(struct partition *p, uint32_t worker, bool absent);

/* --- units --- */

/* The unit that the worker should do next, out of the queue from now on; false
 * when there is none for it, or memory is out. */
bool partition_next(struct partition *p, const struct partition_ask *ask,
                    uint32_t *unit);

/* A unit that is out came back undone: it waits again, before the others. */
void partition_lost(struct partition *p, uint32_t unit);

/* Keep a unit that waits for that worker alone, which gets it before others;
 * until partition_keep_none() for that worker. */
void partition_keep(struct partition *p, uint32_t unit, uint32_t worker);
void partition_keep_none(struct partition *p, uint32_t worker);

/* Take a certain waiting unit out of the queue. */
void partition_take(struct partition *p, uint32_t unit);

/* A unit that is out is done; `took`: its measured cost, in any measure, or 0.
 */
void partition_done(struct partition *p, uint32_t unit, double took);

/* Before any unit went out: a unit was cut with that number and area in an
 * earlier life, and is out of the queue.  Where lines are shared they come by
 * number, from 0.  False: it does not fit, or memory is out. */
bool partition_restore(struct partition *p, uint32_t unit,
                       const struct partition_area *area);

/* The unit is but so many rows high from now on, which end at a line; what it
 * loses is a new unit, which waits.  PARTITION_NONE: the height fits no line of
 * it, or memory is out. */
uint32_t partition_give(struct partition *p, uint32_t unit, uint32_t height);

void partition_area(const struct partition *p, uint32_t unit,
                    struct partition_area *area);

/* Estimated cost, above 0, of a unit; of all frames together. */
double partition_cost(const struct partition *p, uint32_t unit);
double partition_cost_total(const struct partition *p);

/* --- lines of a strict partition --- */

uint32_t partition_lines(const struct partition *p, uint32_t frame);

/* The unit that has that line; PARTITION_NONE: none yet. */
uint32_t partition_line_unit(const struct partition *p, uint32_t frame,
                             uint32_t line);

/* Keep a line that is in no unit back, or no longer: it does not go out. */
void partition_keep_line(struct partition *p, uint32_t frame, uint32_t line,
                         bool keep);

/* Are its bars to be made along with its base lines, as one thread alone would?
 * Else, and once it was lost, the base lines come first, since the truth goes
 * down by them. */
bool partition_unit_bars(const struct partition *p, uint32_t unit);

/* Lines [*first, *last) of a unit. */
void partition_unit_lines(const struct partition *p, uint32_t unit,
                          uint32_t *first, uint32_t *last);

/* Why auto chose its kind of units, or that the kind was asked for; and the
 * kind. */
const char *partition_choice(const struct partition *p);
enum msg_partition partition_kind(const struct partition *p);

/* "window" and the like. */
const char *partition_kind_name(enum msg_partition kind);

#endif
