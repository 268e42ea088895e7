/* partition.h - what the units of a job are, and in which order they go out
 *
 * The scheduler (sched.c) knows units by number only: it takes the next unit
 * for a worker, and says when a unit is done or lost.  Each pixel of each frame
 * belongs to at most one unit, and in the end to exactly one unit.
 * Windows are all laid out at the start.  A strict partition (static, scanbar,
 * auto) shares the lines of a frame (proto/msg_sharing.h): a unit is cut when
 * it goes out, whole lines as wide as the frame, and may shrink later, which
 * makes further units.
 * Costs of a job are in one measure: pixels, or that of an estimate.
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
    uint64_t seed;      /* of MSG_ORDER_RANDOM */
    bool balance;       /* static: an idle worker takes lines of others' runs */
    bool fresh;         /* a frame begins when the one before it is done */
    int psample;        /* -ps, from 1 to 16, where lines are shared */
    uint32_t ncosts;    /* 0: none, or as many as lines of all frames */
    const float *costs; /* not kept */
    uint32_t nframes;
    const struct msg_frame *frames; /* not kept */
};

/* A worker asks for a unit. */
struct partition_ask {
    uint32_t worker;  /* a small number, always the same for this worker */
    uint32_t workers; /* that take part, this worker too */
    double share;     /* this worker's part of the speed of all, 0 to 1 */
    double least;     /* cost that is worth a unit; 0: not known */
    bool idle;        /* the worker has nothing else to do */
};

struct partition;

/* May the job be split like this?  0, or RAD_EUSAGE with a message for the
 * user. */
int partition_check(const struct partition_spec *spec, struct rad_error *err);

/* Make a partition.  NULL: an error of partition_check(), or RAD_ENOMEM. */
struct partition *partition_new(const struct partition_spec *spec,
                                struct rad_error *err);
void partition_free(struct partition *p);

/* Are its units lines of a frame?  False: windows. */
bool partition_is_strict(const struct partition *p);

uint32_t partition_total(const struct partition *p); /* units so far */

/* Units of frames below that number may go out; at first those of all. */
void partition_open(struct partition *p, uint32_t frames);

/* The number of units that wait, and of lines in no unit, that may go out now.
 */
uint32_t partition_waiting(const struct partition *p);

/* --- costs ---
 * An area has a cost of its own.  Areas are the windows, or the lines of all
 * frames, frame after frame. */
uint32_t partition_areas(const struct partition *p);
void partition_nth_area(const struct partition *p, uint32_t n,
                        struct partition_area *area);

/* Estimated costs of all areas, before any unit went out; costs that are too
 * small are raised. */
void partition_set_costs(struct partition *p, double *cost);

/* Static: give workers their runs, by the speeds of those that take part from
 * the start; speed[] is by the worker's number, 0: it does not take part.
 * Before any unit went out.  False: memory is out. */
bool partition_set_speeds(struct partition *p, const double *speed, uint32_t n);

/* Static: the worker is absent, or gets no units; until it is back others may
 * take its run. */
void partition_set_absent(struct partition *p, uint32_t worker, bool absent);

/* --- units --- */

/* Take the unit that the worker should do next out of the queue.  False: there
 * is none for this worker, or memory is out. */
bool partition_next(struct partition *p, const struct partition_ask *ask,
                    uint32_t *unit);

/* A unit that is out came back undone: put it before all that wait. */
void partition_lost(struct partition *p, uint32_t unit);

/* Keep a unit that waits for that worker alone, which gets it before other
 * units; until partition_keep_none() for that worker. */
void partition_keep(struct partition *p, uint32_t unit, uint32_t worker);
void partition_keep_none(struct partition *p, uint32_t worker);

/* Take a certain waiting unit out of the queue. */
void partition_take(struct partition *p, uint32_t unit);

/* A unit that is out is done. */
void partition_done(struct partition *p, uint32_t unit);

/* Cut a unit again that had this number and area in an earlier life, and take
 * it out of the queue; before any unit went out.  Units of lines come by
 * number, from 0.  False: the unit does not fit, or memory is out. */
bool partition_restore(struct partition *p, uint32_t unit,
                       const struct partition_area *area);

/* Shrink a unit to a height [rows] that ends with one of its lines.  The lines
 * below become a new unit, which waits; returns that.  PARTITION_NONE: no line
 * but the last ends there, or memory is out. */
uint32_t partition_give(struct partition *p, uint32_t unit, uint32_t height);

void partition_area(const struct partition *p, uint32_t unit,
                    struct partition_area *area);

/* The estimated cost, above 0, of a unit; of all frames together. */
double partition_cost(const struct partition *p, uint32_t unit);
double partition_cost_total(const struct partition *p);

/* --- lines of a strict partition --- */

uint32_t partition_lines(const struct partition *p, uint32_t frame);

/* The unit that has that line; PARTITION_NONE: no unit has it yet. */
uint32_t partition_line_unit(const struct partition *p, uint32_t frame,
                             uint32_t line);

/* keep: keep back a line that is in no unit, so that it does not go out; else
 * let it go out again. */
void partition_keep_line(struct partition *p, uint32_t frame, uint32_t line,
                         bool keep);

/* Lines [*first, *last) of a unit. */
void partition_unit_lines(const struct partition *p, uint32_t unit,
                          uint32_t *first, uint32_t *last);

/* A text that says why auto chose its kind of units, or that the kind was asked
 * for; the kind. */
const char *partition_choice(const struct partition *p);
enum msg_partition partition_kind(const struct partition *p);

/* "window" and the like. */
const char *partition_kind_name(enum msg_partition kind);

#endif
