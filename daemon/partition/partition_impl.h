/* partition_impl.h - what partition.c shares with the two ways to partition
 *
 * Private to partition*.c.
 * Thread: one. */
#ifndef DAEMON_PARTITION_IMPL_H
#define DAEMON_PARTITION_IMPL_H

#include "partition/partition.h"

/* The states of a unit that matter for the order of hand-out.  OUT stands for
 * all states of enum unit_state (jobs/unit.h) between waiting and done.
 *
 *   WAITING <--> OUT --> DONE */
enum partition_state { PARTITION_WAITING, PARTITION_OUT, PARTITION_DONE };

struct partition_unit {
    struct partition_area area;
    enum partition_state state;
    uint32_t first, last; /* lines [first, last) of a strict partition */
    uint32_t keeper;      /* see partition_keep() */
    double cost;
};

struct partition_window;
struct partition_lines;

struct partition {
    struct partition_unit *unit;
    uint32_t total;
    uint32_t waiting; /* units in state PARTITION_WAITING */
    uint32_t undone;  /* units that are not done */
    uint32_t open;    /* frames below this number may go out */
    uint32_t shut;    /* waiting units of frames that may not go out */
    uint32_t *back;   /* units that came back, a stack */
    uint32_t nback;
    double cost_total;
    enum msg_partition kind;
    char choice[160];
    struct partition_window *window; /* NULL: units are lines */
    struct partition_lines *lines;   /* NULL: units are windows */
};

/* --- partition_table.c --- */

/* Add a unit that waits; PARTITION_NONE: memory is out. */
uint32_t partition_add(struct partition *p, const struct partition_area *area);

/* Does the unit wait, for any worker?  A unit that is kept for a worker is on
 * the stack of units that came back, and goes out from there. */
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

/* Put a waiting unit before all others; false: memory is out. */
bool partition_back(struct partition *p, uint32_t unit);

/* --- partition_window.c --- */

int window_check(const struct partition_spec *spec, struct rad_error *err);
bool window_new(struct partition *p, const struct partition_spec *spec);
void window_free(struct partition_window *w);
/* The costs of units, by the given costs of lines; malloc'd, NULL: memory is
 * out. */
double *window_first_costs(const struct partition *p,
                           const struct partition_spec *spec);
void window_set_costs(struct partition *p, const double *cost);
/* Find the next of the windows that never went out; false: none may go out. */
bool window_next(struct partition *p, uint32_t *unit);

/* --- partition_lines.c --- */

/* The number of lines of all frames. */
uint64_t lines_of(const struct partition_spec *spec);
int lines_check(const struct partition_spec *spec, struct rad_error *err);
bool lines_new(struct partition *p, const struct partition_spec *spec);
void lines_free(struct partition_lines *s);
/* The costs of lines, as given or by their pixels; malloc'd, NULL: memory is
 * out. */
double *lines_first_costs(const struct partition_lines *s,
                          const struct partition_spec *spec);
void lines_set_costs(struct partition *p, const double *cost);
void lines_nth_area(const struct partition *p, uint32_t n,
                    struct partition_area *area);
uint32_t lines_areas(const struct partition *p);
/* The number of lines in no unit, of frames that may begin. */
uint32_t lines_free_count(const struct partition *p);
void lines_done(struct partition *p, uint32_t unit);
/* Cut the unit of that number and area, which must be the next by number. */
bool lines_restore(struct partition *p, uint32_t unit,
                   const struct partition_area *area);

#endif
