/* partition_region.c - scanbar and auto: regions of a frame, from those that
 * are left
 *
 * - scanbar: one line.  A worker goes on with the line below its last one, so
 *   that the base line between them stays at home.  Where that is another's it
 *   begins a region of some lines, below those that others are at, by its
 *   speed: so all move down the picture together, and the true base lines are
 *   there for what is below as soon as may be.  Where there are many lines what
 *   was left behind above comes before that: the truth would wait.
 *   When no region is left it helps where the topmost line is free, from the
 *   middle of that stretch.
 * - auto: as many lines as are the worker's share of all that is left; so units
 *   shrink towards the end, and whole frames go out as long as that share is as
 *   much.  Where there are many lines each worker has some regions of the
 *   frame, one after the other, so that they are not at the same place at the
 *   same time.  As long as there are more to come the bars of one are made
 *   along with its base lines: the pixels of both are looked up among the same
 *   ambient records then, are more alike, and fewer are traced (by 2 to 4 %;
 *   office at night).
 *   In the last one, and where there are fewer lines, base lines come before
 *   bars, so that the truth is everywhere soon; what was too much is given away
 *   later.  Fewer lines go from the top down: the units above are a little
 *   further than those below, base lines arrive before they are needed, and
 *   rows are done from the top down.  These do not shrink at first. */
#include "config.h"

#include "partition/partition_lines.h"

#include <math.h>
#include <stdio.h>

/* Auto: so many lines of a frame for each worker are regions of its own. Close
 * to each other they make the same ambient records: by 2 % more rays, office at
 * night, 40 lines each; but with few lines each bar's wait for the one above it
 * counts for more. */
#define REGION 24

/* A worker has about so many regions of a frame, one after the other, none of
 * fewer lines than LEAST_REGION.  The truth comes down through all
 * workers' regions after each round; what of that comes after the last one
 * costs 5 % of the time where there is but one, 2 % with three (eight workers,
 * 427 lines).  The more there are the closer workers are to each other, and
 * make the same ambient records: 3.5 % redundant with three, 5 % with six. */
#define ROUNDS       3
#define LEAST_REGION 4

/* Scanbar's get smaller at the end, but no smaller than LEAST_RUN: each is the
 * worker's share of what is left, divided by LAST_ROUNDS.  Where one of the
 * last ones costs more than the others the truth waits there, and all below it
 * for the truth; but the smaller they are the more records are made twice.
 * Eight workers, 427 lines, office at night: the longest wait of one is 0.6 to
 * 1.6 % of the time and 4.3 to 4.8 % are redundant; with runs of 3 it is 0.6 to
 * 1.0 % and 5.2 %, and where all are of one size 0.8 to 2.4 % and 3.4 to 3.9 %.
 * With less than MANY lines to a worker it takes speed: simulated, 28 of them
 * and 720 lines, 83 % efficient for 92. */
#define LAST_ROUNDS 1.5
#define LEAST_RUN   8
#define MANY        48

/* Auto, without regions: a unit that is large for its time is no more than so
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

/* The end of the lines from `first` on that cost no more than that: at least
 * one line, and none behind `end`. */
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

/* Auto: are there so many lines of the frame to each worker that they are cut
 * into regions? */
static bool
has_regions(const struct partition *p, const struct frame *f,
            const struct partition_ask *ask)
{
    return ask->workers > 1 && f->n >= REGION * ask->workers &&
           lines_left(p) <= f->cost * 1.000001;
}

/* Auto without regions: units get no smaller than half of the worker's part of
 * the frame, until that is much of what is left. */
static double
least_share(const struct frame *f, double left, double share)
{
    return fmin(f->cost * share / 2, left * fmin(MOST_SHARES * share, .25));
}

/* Where a unit that begins at `first` ends. */
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

/* Is all true above that line? */
static bool
has_top(const struct partition *p, const struct frame *f, uint32_t line)
{
    uint32_t above =
        line > 0 ? p->lines->unit[f->first + line - 1] : PARTITION_NONE;

    return line == 0 ||
           (above != PARTITION_NONE && p->unit[above].state == PARTITION_DONE);
}

/* The first line that is free, of a frame that has one. */
static uint32_t
first_free(const struct partition_lines *s, const struct frame *f)
{
    uint32_t line = 0;

    while (!line_is_free(s, f, line))
        line++;
    return line;
}

/* Scanbar: has the frame so many lines that regions can get smaller? */
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

/* Begin the next region of the frame; false: there is none left. */
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

/* The first free line, in regions that were begun, that no worker comes to by
 * going on: it was kept back when its worker came to it, or its worker is gone.
 * All lines below wait for it.  False: there is none. */
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

/* Where the worker's next unit of a frame that has free lines begins. */
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
        return w->line; /* at f->next it is the next region that follows */
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

/* Does another region come for each worker after this one?  Then the truth can
 * come down meanwhile. */
static bool
has_time(const struct partition *p, const struct frame *f,
         const struct partition_ask *ask)
{
    const struct partition_lines *s = p->lines;
    double lines = (double)f->n / ROUNDS, left = (double)f->n - f->next;

    return s->kind == MSG_PART_AUTO && has_regions(p, f, ask) &&
           left + ask->share * lines / 2 >= lines;
}

bool
region_next(struct partition *p, struct asker *w,
            const struct partition_ask *ask, uint32_t *unit)
{
    struct partition_lines *s = p->lines;
    uint32_t frame = s->lo, first;
    struct frame *f;
    bool bars;

    while (lines_may_begin(p, frame) &&
           s->frame[frame].nfree == s->frame[frame].nkept)
        frame++;
    if (!lines_may_begin(p, frame))
        return false;
    f = &s->frame[frame];
    first = unit_start(p, f, w, ask);
    bars = has_time(p, f, ask);
    if (!lines_cut(p, frame, first, unit_end(p, f, first, ask), w, unit))
        return false;
    p->unit[*unit].bars = bars;
    return true;
}
