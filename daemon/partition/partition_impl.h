/* partition_impl.h - what partition.c shares with the two ways to partition
 *
 * Private to partition*.c.
 * Thread: one. */
#ifndef DAEMON_PARTITION_IMPL_H
#define DAEMON_PARTITION_IMPL_H

#include "partition/partition.h"

/* Where a unit is for the order of hand-out: OUT stands for all that enum
 * unit_state (jobs/unit.h) tells apart between waiting and done.
 *
 *   WAITING <--> OUT --> DONE */
enum partition_state { PARTITION_WAITING, PARTITION_OUT, PARTITION_DONE };

struct partition_unit {
    struct partition_area area;
    enum partition_state state;
    uint32_t first, last; /* lines, where they are shared */
    bool bars;            /* see partition_unit_bars() */
    uint32_t keeper;      /* see partition_keep() */
    double cost;
};

struct partition_window;
struct partition_queue;
struct partition_lines;

struct partition {
    struct partition_unit *unit;
    uint32_t total;
    uint32_t waiting; /* units in state PARTITION_WAITING */
    uint32_t undone;  /* units that are not done */
    uint32_t open;    /* frames that may go out */
    uint32_t shut;    /* waiting units of frames that may not */
    uint32_t *back;   /* units that came back, a stack */
    uint32_t nback;
    double cost_total;
    enum msg_partition kind;
    char choice[160];
    struct partition_window *window; /* NULL: lines are shared */
    struct partition_queue *queue;   /* of windows by what is measured */
    struct partition_lines *lines;   /* NULL: units are windows */
};

/* --- partition_table.c --- */

/* A new unit, waiting; PARTITION_NONE when memory is out. */
uint32_t partition_add(struct partition *p, const struct partition_area *area);

/* Does the unit wait, for any worker?  A unit that is kept for one worker is on
 * the stack of those that came back, and goes out from there. */
static inline bool
partition_is_free(const struct partition *p, uint32_t unit)
{
    return p->unit[unit].state == PARTITION_WAITING &&
           p->unit[unit].keeper == PARTITION_NONE;
}

/* Is the unit of a frame that may not go out? */
static inline bool
partition_is_shut(const struct partition *p, uint32_t unit)
{
    return p->unit[unit].area.frame >= p->open;
}

/* Put a waiting unit before the others; false when memory is out. */
bool partition_back(struct partition *p, uint32_t unit);

/* --- partition_window.c --- */

int window_check(const struct partition_spec *spec, struct rad_error *err);
bool window_new(struct partition *p, const struct partition_spec *spec);
void window_free(struct partition_window *w);
/* What units cost by the lines' costs that are given; as lines_first_costs().
 */
double *window_first_costs(const struct partition *p,
                           const struct partition_spec *spec);
void window_set_costs(struct partition *p, const double *cost);
/* The next window of those that never went out. */
bool window_next(struct partition *p, uint32_t *unit);

/* --- partition_queue.c --- */

/* All units, which are windows, by what those beside them took, and at random
 * where that is not known.  False: memory is out. */
bool queue_new(struct partition *p, uint64_t seed, bool fresh);
void queue_free(struct partition *p);
bool queue_next(struct partition *p, uint32_t *unit);
void queue_measured(struct partition *p, uint32_t unit, double cost);

/* --- partition_lines.c --- */

/* Of all frames. */
uint64_t lines_of(const struct partition_spec *spec);
int lines_check(const struct partition_spec *spec, struct rad_error *err);
bool lines_new(struct partition *p, const struct partition_spec *spec);
void lines_free(struct partition_lines *s);
/* What lines cost, as given or by their pixels; malloc'd, NULL: memory is out.
 */
double *lines_first_costs(const struct partition_lines *s,
                          const struct partition_spec *spec);
void lines_set_costs(struct partition *p, const double *cost);
void lines_part(const struct partition *p, uint32_t part,
                struct partition_area *area);
uint32_t lines_parts(const struct partition *p);
/* Lines that are in no unit, of the frames that may begin. */
uint32_t lines_free_count(const struct partition *p);
void lines_done(struct partition *p, uint32_t unit);
/* Cut the unit of that number and area, which must be the next by number. */
bool lines_restore(struct partition *p, uint32_t unit,
                   const struct partition_area *area);

#endif
