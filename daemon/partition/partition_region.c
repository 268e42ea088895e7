/* partition_region.c - scanbar and auto: units are cut from regions of a frame
 *
 * - scanbar: a unit is one line.  A worker goes on with the line below its last
 *   line, so that the base line between them stays at the worker.  If another
 *   worker has that line, or another region begins there, the worker begins a
 *   new region below all regions under way; the region's size goes by the
 *   worker's speed.  So all workers move down the picture together, and true
 *   base lines are there for the lines below as soon as may be.
 *   In frames of many lines a worker first takes lines left behind above, for
 *   the truth would wait for them.  If no region is left a worker begins with
 *   the topmost free line, if the line above is done, or else in the middle of
 *   the topmost free stretch.
 * - auto: a unit has the worker's share of all that is left, by cost; so units
 *   shrink towards the end, and are whole frames at first if there are many.
 *   In the last frame, if it has many lines, each worker gets some regions, one
 *   after the other, so that workers are at different places.  A unit that is
 *   too large is given away in part later.
 *   Frames of fewer lines go from the top down: units above are a little
 *   further than units below, base lines arrive before they are needed, and
 *   rows are done from the top down.  Their units do not shrink at first. */
#include "config.h"

#include "partition/partition_lines.h"

#include <math.h>
#include <stdio.h>

/* Auto: a frame with so many lines to each worker is cut into regions.  Workers
 * that are close to each other make the same ambient records: 2 % more rays,
 * office at night, 40 lines each.  But with fewer lines the wait of each bar
 * for the bar above counts for more. */
#define REGION 24

/* A worker has about so many regions of a frame, one after the other, each of
 * at least LEAST_REGION lines.  The truth comes down through all workers'
 * regions after each round.  After the last round this costs 5 % of the time
 * with one round, 2 % with three (eight workers, 427 lines).  With more rounds
 * workers are closer to each other, and make the same ambient records: 3.5 % of
 * them are redundant with three rounds, 5 % with six. */
#define ROUNDS       3
#define LEAST_REGION 4

/* Scanbar: in frames of MANY lines to each worker regions get smaller at the
 * end: a region is the worker's share of what is left, divided by LAST_ROUNDS,
 * but at least LEAST_RUN lines.  If one of the last regions costs more than the
 * others the truth waits there, and all lines below wait for the truth; but the
 * smaller regions are the more records are made twice.  Eight workers, 427
 * lines, office at night: the longest wait is 0.6 to 1.6 % of the time, and 4.3
 * to 4.8 % of records are redundant; with LEAST_RUN 3 it is 0.6 to 1.0 %, and
 * 5.2 %; with regions of one size 0.8 to 2.4 %, and 3.4 to 3.9 %.
 * With fewer lines to a worker smaller regions cost speed: simulated, with 28
 * workers and 720 lines, 83 % efficiency in place of 92 %. */
#define LAST_ROUNDS 1.5
#define LEAST_RUN   8
#define MANY        48

/* Auto, without regions: the least size of a unit (least_share()) is at most so
 * many times the worker's share of what is left. */
#define MOST_SHARES 4

void
region_choose(struct partition *p)
{
    const struct partition_lines *s = p->lines;

    if (s->kind != MSG_PART_AUTO)
        snprintf(p->choice, sizeof p->choice, "asked for");
    else if (s->most <= 1)
        snprintf(p->choice, sizeof p->choice,
                 "one worker: whole frames, which its threads render together");
    else if (s->frame[s->nframes - 1].n >= REGION * s->most)
        snprintf(p->choice, sizeof p->choice,
                 "%u workers: %d regions of the picture for each; what is left "
                 "by halves, at last of a bar",
                 s->most, ROUNDS);
    else
        snprintf(p->choice, sizeof p->choice,
                 "%u workers: runs of base lines from the top down, each one's "
                 "part of what is left, so that base lines come early; the "
                 "rest by halves, at last of a bar",
                 s->most);
}

/* The end of the lines from `first` on that together cost at most `cost`: at
 * least one line, and none behind `end`. */
static uint32_t
reach(const struct partition_lines *s, const struct frame *f, uint32_t first,
      uint32_t end, double cost)
{
    uint32_t last = first + 1;

    cost -= line_cost(s, f, first);
    while (last < end && (cost -= line_cost(s, f, last)) >= 0)
        last++;
    return last;
}

/* Auto: is this the last of the frames that may begin, with so many lines to
 * each worker that it is cut into regions? */
static bool
has_regions(const struct partition *p, const struct frame *f,
            const struct partition_ask *ask)
{
    return ask->workers > 1 && f->n >= REGION * ask->workers &&
           lines_left(p) <= f->cost * 1.000001;
}

/* Auto without regions: the least cost of a unit, half of the worker's share of
 * the frame, until that is much of what is left. */
static double
least_share(const struct frame *f, double left, double share)
{
    return fmin(f->cost * share / 2, left * fmin(MOST_SHARES * share, .25));
}

/* The end of a unit that begins at `first`. */
static uint32_t
unit_end(const struct partition *p, const struct frame *f, uint32_t first,
         const struct partition_ask *ask)
{
    const struct partition_lines *s = p->lines;
    uint32_t end = lines_stretch(s, f, first), last = first + 1;
    double left = lines_left(p), most = left * ask->share;

    if (s->kind == MSG_PART_AUTO) {
        if (has_regions(p, f, ask)) {
            if (first < f->next && f->next < end)
                end = f->next;
            most = lines_cost(s, f, first, end);
        } else if (ask->workers > 1)
            most = fmax(most, least_share(f, left, ask->share));
        if (most < ask->least)
            most = ask->least;
        last = reach(s, f, first, end, most * 1.000001);
        if (last < end && lines_cost(s, f, last, end) < ask->least)
            last = end; /* the rest is worth no unit */
    }
    if (first == 0 && last == 1 && end > 1)
        last = 2; /* line 0 is a row without a bar */
    return last;
}

/* Is the line above done, or is there none? */
static bool
has_top(const struct partition *p, const struct frame *f, uint32_t line)
{
    uint32_t above =
        line > 0 ? p->lines->unit[f->first + line - 1] : PARTITION_NONE;

    return line == 0 ||
           (above != PARTITION_NONE && p->unit[above].state == PARTITION_DONE);
}

/* The first free line of a frame that has a free line. */
static uint32_t
first_free(const struct partition_lines *s, const struct frame *f)
{
    uint32_t line = 0;

    while (!line_is_free(s, f, line))
        line++;
    return line;
}

/* Scanbar: has the frame so many lines that regions get smaller at the end? */
static bool
has_many_lines(const struct partition_lines *s, const struct frame *f,
               const struct partition_ask *ask)
{
    return s->kind == MSG_PART_SCANBAR && f->n >= MANY * ask->workers;
}

/* How many lines the next region of the frame has. */
static double
region_lines(const struct partition_lines *s, const struct frame *f,
             const struct partition_ask *ask)
{
    double lines = fmax(ask->share * f->n / ROUNDS, LEAST_REGION);
    double left = ask->share * (f->n - f->next) / LAST_ROUNDS;

    return has_many_lines(s, f, ask) ? fmin(lines, fmax(left, LEAST_RUN))
                                     : lines;
}

/* Begin the next region of the frame, at *line; false: no region is left. */
static bool
begin_region(const struct partition_lines *s, struct frame *f,
             const struct partition_ask *ask, uint32_t *line)
{
    while (f->next < f->n) {
        *line = f->next;
        f->next += (uint32_t)(fmin(region_lines(s, f, ask), f->n) + .5);
        if (line_is_free(s, f, *line))
            return true;
    }
    return false;
}

/* Will one of the workers go on with that line? */
static bool
is_expected(const struct partition_lines *s, const struct frame *f,
            uint32_t line)
{
    for (uint32_t i = 0; i < s->naskers; i++)
        if (s->askers[i].began && !s->askers[i].absent &&
            s->askers[i].line == line && &s->frame[s->askers[i].frame] == f)
            return true;
    return false;
}

/* Find the first free line, in regions that were begun, that no worker reaches
 * by going on: the line was kept back when its worker came there, or its worker
 * is gone.  All lines below wait for this line.  False: there is none. */
static bool
find_left_behind(const struct partition_lines *s, struct frame *f,
                 uint32_t *line)
{
    while (f->taken < f->n && s->unit[f->first + f->taken] != PARTITION_NONE)
        f->taken++;
    for (uint32_t i = f->taken; i < f->next && i < f->n;
         i = lines_stretch(s, f, i) + 1)
        if (line_is_free(s, f, i) && !is_expected(s, f, i)) {
            *line = i;
            return true;
        }
    return false;
}

/* The line with which the worker's next unit of a frame begins; the frame has
 * free lines. */
static uint32_t
unit_start(const struct partition *p, struct frame *f, const struct asker *w,
           const struct partition_ask *ask)
{
    const struct partition_lines *s = p->lines;
    uint32_t first, last, line;

    if (s->kind == MSG_PART_AUTO && !has_regions(p, f, ask))
        return first_free(s, f);
    if (w->began && &s->frame[w->frame] == f && line_is_free(s, f, w->line) &&
        w->line != f->next)
        return w->line; /* at f->next begins the next region */
    if (has_many_lines(s, f, ask) && find_left_behind(s, f, &line))
        return line;
    if (begin_region(s, f, ask, &line))
        return line;
    first = first_free(s, f);
    last = lines_stretch(s, f, first);
    if (has_top(p, f, first))
        return first;
    return first + (last - first) / 2;
}

bool
region_next(struct partition *p, struct asker *w,
            const struct partition_ask *ask, uint32_t *unit)
{
    struct partition_lines *s = p->lines;
    uint32_t frame = s->lo, first;
    struct frame *f;

    while (lines_may_begin(p, frame) &&
           s->frame[frame].nfree == s->frame[frame].nkept)
        frame++;
    if (!lines_may_begin(p, frame))
        return false;
    f = &s->frame[frame];
    first = unit_start(p, f, w, ask);
    return lines_cut(p, frame, first, unit_end(p, f, first, ask), w, unit);
}
