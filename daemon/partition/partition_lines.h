/* partition_lines.h - what partition_lines.c shares with the ways to hand lines
 * out
 *
 * Private to partition_lines.c, partition_region.c (scanbar, auto) and
 * partition_run.c (static). */
#ifndef DAEMON_PARTITION_LINES_H
#define DAEMON_PARTITION_LINES_H

#include "partition/partition_impl.h"

struct frame {
    uint32_t width, height;
    uint32_t first;    /* number of its first line among the lines of all */
    uint32_t n;        /* lines */
    uint32_t nfree;    /* lines in no unit */
    uint32_t nkept;    /* lines in no unit that are kept back */
    uint32_t undone;   /* lines that are not done */
    uint32_t next;     /* the line with which the next region begins */
    uint32_t taken;    /* so many lines from the top, or more, are in units */
    double cost, left; /* of all its lines; of its lines in no unit */
};

/* A worker that asked for a unit. */
struct asker {
    bool began, absent;
    uint32_t frame, line; /* the line below its last unit */
    uint32_t own;         /* static: its run is taken in all frames before */
    double from, to;      /* static: its run, as a part of each frame's cost */
};

struct partition_lines {
    enum msg_partition kind;
    bool balance, fresh;
    int ystep;
    uint32_t nframes, nlines;
    struct frame *frame;
    uint32_t *unit;        /* by line of all frames; PARTITION_NONE: no unit */
    float *cost;           /* by line of all frames */
    bool *kept; /* by line of all frames, see partition_keep_line() */
    double left;           /* cost of all lines in no unit */
    uint32_t lo;           /* all lines of frames before are in units */
    uint32_t nfree, nkept; /* of all frames */
    struct asker *askers;
    uint32_t naskers;
    uint32_t most; /* most workers that took part at a time */
};

static inline bool
line_is_free(const struct partition_lines *s, const struct frame *f,
             uint32_t line)
{
    return line < f->n && s->unit[f->first + line] == PARTITION_NONE &&
           !s->kept[f->first + line];
}

static inline double
line_cost(const struct partition_lines *s, const struct frame *f, uint32_t line)
{
    return s->cost[f->first + line];
}

/* --- partition_lines.c --- */

/* The cost of lines [first, last). */
double lines_cost(const struct partition_lines *s, const struct frame *f,
                  uint32_t first, uint32_t last);
/* The end of the stretch of free lines that begins at `line`. */
uint32_t lines_stretch(const struct partition_lines *s, const struct frame *f,
                       uint32_t line);
/* May the lines of that frame go out? */
bool lines_may_begin(const struct partition *p, uint32_t frame);
/* The cost of free lines that may go out. */
double lines_left(const struct partition *p);
/* Find the worker's struct, or make it.  NULL: memory is out. */
struct asker *lines_asker(struct partition_lines *s, uint32_t worker);
/* Make a unit of lines [first, last), which are free, for w.  False: memory is
 * out. */
bool lines_cut(struct partition *p, uint32_t frame, uint32_t first,
               uint32_t last, struct asker *w, uint32_t *unit);

/* --- partition_region.c --- */

/* Write the text that says what auto chose, and why. */
void region_choose(struct partition *p);
/* Cut the next unit for a worker, of scanbar or auto.  False: there is none for
 * this worker, or memory is out. */
bool region_next(struct partition *p, struct asker *w,
                 const struct partition_ask *ask, uint32_t *unit);

/* --- partition_run.c --- */

/* Cut the next unit for a worker, of static.  False: there is none for this
 * worker, or memory is out. */
bool run_next(struct partition *p, struct asker *w,
              const struct partition_ask *ask, uint32_t *unit);

#endif
