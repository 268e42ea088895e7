/* partition_lines.c - the lines of each frame, and runs of them as units
 *
 * A unit is cut when it goes out.
 * - scanbar: one line.  A worker goes on with the line below its last one, so
 *   that the base line between them stays at home.  Where that is another's it
 *   begins a region of some lines, below those that others are at, by its
 *   speed: so all move down the picture together, and the true base lines are
 *   there for what is below as soon as may be.  Where there are many lines what
 *   was left behind above comes before that, or lags: the truth would wait.
 *   When no region is left it helps where the topmost line is free, from the
 *   middle of that stretch.
 * - static: the worker's own run of the frame.
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
 *   rows are done from the top down.  These do not shrink at first.
 *
 * Frames go out in order: one begins when the one before it has no free line
 * left, or, where nothing may be kept between frames, when that is done. */
#include "config.h"

#include "partition_impl.h"

#include "picture/quincunx.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

struct frame {
    uint32_t width, height;
    uint32_t first;    /* of its lines among all */
    uint32_t n;        /* lines */
    uint32_t nfree;    /* of them in no unit */
    uint32_t nkept;    /* of those, kept back */
    uint32_t undone;   /* lines that are not done */
    uint32_t next;     /* where the next region begins */
    uint32_t taken;    /* lines from the top that are in units, or more */
    double cost, left; /* of all its lines, and of those that are free */
};

/* One that asked for a unit. */
struct asker {
    bool began, absent;
    uint32_t frame, line; /* the one below its last */
    uint32_t own;         /* static: it has no free line of its own before */
    double from, to;      /* static: its part of each frame's cost */
};

struct partition_lines {
    enum msg_partition kind;
    bool balance, fresh;
    int ystep;
    uint32_t nframes, nlines;
    struct frame *frame;
    uint32_t *unit;        /* by line of all frames: PARTITION_NONE, free */
    float *cost;           /* likewise */
    bool *kept;            /* likewise */
    double left;           /* cost of all free lines */
    uint32_t lo;           /* frames before have no free line */
    uint32_t nfree, nkept; /* of all frames */
    struct asker *who;
    uint32_t nwho, cap_who;
    uint32_t most; /* workers that took part at a time */
};

/* --- lines --- */

static struct rad_quincunx
sampler(const struct partition_lines *s, const struct frame *f)
{
    return (struct rad_quincunx){ .width = (int)f->width,
                                  .height = (int)f->height,
                                  .xstep = 1,
                                  .ystep = s->ystep };
}

/* The row of base line i. */
static uint32_t
base_row(const struct partition_lines *s, const struct frame *f, uint32_t i)
{
    struct rad_quincunx q = sampler(s, f);

    return (uint32_t)rad_quincunx_base_row(&q, (int)i);
}

/* First row of line i. */
static uint32_t
top_row(const struct partition_lines *s, const struct frame *f, uint32_t i)
{
    return i > 0 ? base_row(s, f, i - 1) + 1 : 0;
}

static bool
is_free(const struct partition_lines *s, const struct frame *f, uint32_t line)
{
    return line < f->n && s->unit[f->first + line] == PARTITION_NONE &&
           !s->kept[f->first + line];
}

static double
line_cost(const struct partition_lines *s, const struct frame *f, uint32_t line)
{
    return s->cost[f->first + line];
}

static double
cost_of(const struct partition_lines *s, const struct frame *f, uint32_t first,
        uint32_t last)
{
    double sum = 0;

    for (uint32_t i = first; i < last; i++)
        sum += line_cost(s, f, i);
    return sum;
}

/* Where the stretch of free lines that begins at line ends. */
static uint32_t
stretch(const struct partition_lines *s, const struct frame *f, uint32_t line)
{
    while (is_free(s, f, line))
        line++;
    return line;
}

/* The longest stretch; empty when none is free. */
static void
longest(const struct partition_lines *s, const struct frame *f, uint32_t *first,
        uint32_t *last)
{
    *first = *last = 0;
    for (uint32_t i = 0, end; i < f->n; i = end + 1) {
        end = stretch(s, f, i);
        if (end - i > *last - *first) {
            *first = i;
            *last = end;
        }
    }
}

/* May its lines go out? */
static bool
may_begin(const struct partition_lines *s, uint32_t frame)
{
    return frame < s->nframes &&
           (!s->fresh || frame == 0 || s->frame[frame - 1].undone == 0);
}

/* --- set-up --- */

uint64_t
lines_of(const struct partition_spec *spec)
{
    struct rad_quincunx q = { 0 };
    uint64_t n = 0;

    rad_quincunx_steps(spec->psample, &q.xstep, &q.ystep);
    for (uint32_t i = 0; i < spec->nframes; i++) {
        q.width = (int)spec->frames[i].width;
        q.height = (int)spec->frames[i].height;
        n += (uint64_t)rad_quincunx_nbases(&q);
    }
    return n;
}

int
lines_check(const struct partition_spec *spec, struct rad_error *err)
{
    if (lines_of(spec) > PARTITION_MAX_LINES)
        return rad_fail(err, RAD_EUSAGE,
                        "too many base lines in all frames: at most %d",
                        PARTITION_MAX_LINES);
    return 0;
}

static void
set_cost(struct partition_lines *s, const double *cost)
{
    s->left = 0;
    for (uint32_t i = 0; i < s->nframes; i++) {
        struct frame *f = &s->frame[i];

        f->cost = 0;
        for (uint32_t k = 0; k < f->n; k++) {
            s->cost[f->first + k] = (float)cost[f->first + k];
            f->cost += s->cost[f->first + k];
        }
        f->left = f->cost;
        s->left += f->cost;
    }
}

void
lines_set_costs(struct partition *p, const double *cost)
{
    set_cost(p->lines, cost);
}

/* Costs as given, else a line's pixels. */
static bool
first_costs(struct partition *p, const struct partition_spec *spec)
{
    struct partition_lines *s = p->lines;
    double *cost = malloc(s->nlines * sizeof *cost);

    if (!cost)
        return false;
    for (uint32_t i = 0; i < s->nframes; i++) {
        const struct frame *f = &s->frame[i];

        for (uint32_t k = 0; k < f->n; k++) {
            uint32_t rows = base_row(s, f, k) + 1 - top_row(s, f, k);

            cost[f->first + k] = spec->ncosts > 0
                                     ? (double)spec->costs[f->first + k]
                                     : (double)rows * f->width;
        }
    }
    partition_set_costs(p, cost);
    free(cost);
    return true;
}

static void
choose(struct partition *p)
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

bool
lines_new(struct partition *p, const struct partition_spec *spec)
{
    struct partition_lines *s = calloc(1, sizeof *s);
    uint32_t n = (uint32_t)lines_of(spec);
    int xstep;

    p->lines = s;
    p->kind = spec->kind;
    if (!s)
        return false;
    s->kind = spec->kind;
    s->balance = spec->balance;
    s->fresh = spec->fresh;
    s->nframes = spec->nframes;
    rad_quincunx_steps(spec->psample, &xstep, &s->ystep);
    s->frame = calloc(s->nframes, sizeof *s->frame);
    s->unit = malloc(n * sizeof *s->unit);
    s->cost = malloc(n * sizeof *s->cost);
    s->kept = calloc(n, sizeof *s->kept);
    if (!s->frame || !s->unit || !s->cost || !s->kept)
        return false;
    for (uint32_t i = 0; i < s->nframes; i++) {
        struct frame *f = &s->frame[i];
        struct rad_quincunx q;

        f->width = spec->frames[i].width;
        f->height = spec->frames[i].height;
        f->first = s->nlines;
        q = sampler(s, f);
        f->n = f->nfree = f->undone = (uint32_t)rad_quincunx_nbases(&q);
        s->nlines += f->n;
    }
    s->nfree = s->nlines;
    memset(s->unit, 0xff, n * sizeof *s->unit); /* PARTITION_NONE */
    choose(p);
    return first_costs(p, spec);
}

void
lines_free(struct partition_lines *s)
{
    if (!s)
        return;
    free(s->frame);
    free(s->unit);
    free(s->cost);
    free(s->kept);
    free(s->who);
    free(s);
}

uint32_t
lines_parts(const struct partition *p)
{
    return p->lines->nlines;
}

static const struct frame *
frame_of(const struct partition_lines *s, uint32_t part)
{
    uint32_t lo = 0, hi = s->nframes;

    while (hi - lo > 1) {
        uint32_t mid = (lo + hi) / 2;

        if (s->frame[mid].first <= part)
            lo = mid;
        else
            hi = mid;
    }
    return &s->frame[lo];
}

void
lines_part(const struct partition *p, uint32_t part,
           struct partition_area *area)
{
    const struct partition_lines *s = p->lines;
    const struct frame *f = frame_of(s, part);
    uint32_t line = part - f->first, y = top_row(s, f, line);

    *area = (struct partition_area){ (uint32_t)(f - s->frame), 0, y, f->width,
                                     base_row(s, f, line) + 1 - y };
}

uint32_t
lines_free_count(const struct partition *p)
{
    const struct partition_lines *s = p->lines;

    if (!s->fresh)
        return s->nfree - s->nkept;
    return may_begin(s, s->lo) ? s->frame[s->lo].nfree - s->frame[s->lo].nkept
                               : 0;
}

/* --- cutting --- */

/* NULL when memory is out. */
static struct asker *
asker(struct partition_lines *s, uint32_t worker)
{
    if (worker >= s->cap_who) {
        uint32_t cap = worker < 8 ? 16 : 2 * worker;
        struct asker *v = realloc(s->who, cap * sizeof *v);

        if (!v)
            return NULL;
        s->who = v;
        s->cap_who = cap;
    }
    while (s->nwho <= worker)
        s->who[s->nwho++] = (struct asker){ .from = 0 };
    return &s->who[worker];
}

static void
take_lines(struct partition_lines *s, struct frame *f, uint32_t first,
           uint32_t last, uint32_t unit)
{
    double cost = cost_of(s, f, first, last);

    for (uint32_t i = first; i < last; i++)
        s->unit[f->first + i] = unit;
    f->nfree -= last - first;
    s->nfree -= last - first;
    f->left -= cost;
    s->left -= cost;
    while (s->lo < s->nframes && s->frame[s->lo].nfree == 0)
        s->lo++;
}

static uint32_t
add_unit(struct partition *p, struct frame *f, uint32_t first, uint32_t last)
{
    struct partition_lines *s = p->lines;
    uint32_t y = top_row(s, f, first);
    struct partition_area a = { (uint32_t)(f - s->frame), 0, y, f->width,
                                base_row(s, f, last - 1) + 1 - y };
    uint32_t unit = partition_add(p, &a);

    if (unit == PARTITION_NONE)
        return unit;
    p->unit[unit].first = first;
    p->unit[unit].last = last;
    p->unit[unit].cost = cost_of(s, f, first, last);
    return unit;
}

static bool
cut(struct partition *p, uint32_t frame, uint32_t first, uint32_t last,
    struct asker *w, uint32_t *unit)
{
    struct frame *f = &p->lines->frame[frame];

    *unit = add_unit(p, f, first, last);
    if (*unit == PARTITION_NONE)
        return false;
    take_lines(p->lines, f, first, last, *unit);
    w->began = true;
    w->frame = frame;
    w->line = last;
    return true;
}

/* --- scanbar, auto --- */

/* As many lines from `first` on as cost no more, but one, and no more than to
 * `end`. */
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

/* Auto: has each worker so many lines of the frame that it should have a
 * region of it? */
static bool
has_regions(const struct partition_lines *s, const struct frame *f,
            const struct partition_who *who)
{
    return who->workers > 1 && f->n >= REGION * who->workers &&
           (s->fresh ? f->left : s->left) <= f->cost * 1.000001;
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
unit_end(const struct partition_lines *s, const struct frame *f, uint32_t first,
         const struct partition_who *who)
{
    uint32_t end = stretch(s, f, first), last = first + 1;
    double left = s->fresh ? f->left : s->left, most = left * who->share;

    if (s->kind == MSG_PART_AUTO) {
        if (has_regions(s, f, who)) {
            if (first < f->next && f->next < end)
                end = f->next;
            most = cost_of(s, f, first, end);
        } else if (who->workers > 1)
            most = fmax(most, least_share(f, left, who->share));
        if (most < who->least)
            most = who->least;
        last = reach(s, f, first, end, most * 1.000001);
        if (last < end && cost_of(s, f, last, end) < who->least)
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
           (above != PARTITION_NONE && p->unit[above].state == PART_DONE);
}

/* The first line that is free, of a frame that has one. */
static uint32_t
first_free(const struct partition_lines *s, const struct frame *f)
{
    uint32_t line = 0;

    while (!is_free(s, f, line))
        line++;
    return line;
}

/* Scanbar: has the frame so many lines that regions can get smaller? */
static bool
has_many_lines(const struct partition_lines *s, const struct frame *f,
               const struct partition_who *who)
{
    return s->kind == MSG_PART_SCANBAR && f->n >= MANY * who->workers;
}

/* How many lines the next region of the frame has. */
static double
region_lines(const struct partition_lines *s, const struct frame *f,
             const struct partition_who *who)
{
    double lines = fmax(who->share * f->n / ROUNDS, LEAST_REGION);
    double left = who->share * (f->n - f->next) / LAST_ROUNDS;

    return has_many_lines(s, f, who) ? fmin(lines, fmax(left, LEAST_RUN))
                                     : lines;
}

/* Begin the next region of the frame; false: there is none left. */
static bool
begin_region(const struct partition_lines *s, struct frame *f,
             const struct partition_who *who, uint32_t *line)
{
    while (f->next < f->n) {
        *line = f->next;
        f->next += (uint32_t)(fmin(region_lines(s, f, who), f->n) + .5);
        if (is_free(s, f, *line))
            return true;
    }
    return false;
}

/* Will one of the workers go on with that line? */
static bool
is_expected(const struct partition_lines *s, const struct frame *f,
            uint32_t line)
{
    for (uint32_t i = 0; i < s->nwho; i++)
        if (s->who[i].began && !s->who[i].absent && s->who[i].line == line &&
            &s->frame[s->who[i].frame] == f)
            return true;
    return false;
}

/* The first line of the regions that were begun to which nobody comes by
 * itself: it was kept back when somebody did, or its worker is gone.  All below
 * wait for it.  False: there is none. */
static bool
left_behind(const struct partition_lines *s, struct frame *f, uint32_t *line)
{
    while (f->taken < f->n && s->unit[f->first + f->taken] != PARTITION_NONE)
        f->taken++;
    for (uint32_t i = f->taken; i < f->next && i < f->n;
         i = stretch(s, f, i) + 1)
        if (is_free(s, f, i) && !is_expected(s, f, i)) {
            *line = i;
            return true;
        }
    return false;
}

/* The middle of the topmost stretch of lines that others will come to, if it is
 * longer than the next region would be: there the truth would wait. */
static bool
lags_behind(const struct partition_lines *s, const struct frame *f,
            const struct partition_who *who, uint32_t *line)
{
    uint32_t first = f->taken, last;

    while (first < f->next && first < f->n && !is_free(s, f, first))
        first++;
    last = stretch(s, f, first);
    last = last < f->next ? last : f->next;
    if (first >= last || last - first <= region_lines(s, f, who))
        return false;
    *line = first + (last - first) / 2;
    return true;
}

/* Where the worker's next unit of a frame that has free lines begins. */
static uint32_t
unit_start(const struct partition *p, struct frame *f, const struct asker *w,
           const struct partition_who *who)
{
    const struct partition_lines *s = p->lines;
    uint32_t first, last, line;

    if (s->kind == MSG_PART_AUTO && !has_regions(s, f, who))
        return first_free(s, f);
    if (w->began && &s->frame[w->frame] == f && is_free(s, f, w->line) &&
        w->line != f->next)
        return w->line; /* at f->next it is the next region that follows */
    if (has_many_lines(s, f, who) &&
        (left_behind(s, f, &line) || lags_behind(s, f, who, &line)))
        return line;
    if (begin_region(s, f, who, &line))
        return line;
    first = first_free(s, f);
    last = stretch(s, f, first);
    if (has_top(p, f, first))
        return first;
    return first + (last - first) / 2;
}

/* Does another region come for each worker after this one?  Then the truth can
 * come down meanwhile. */
static bool
has_time(const struct partition_lines *s, const struct frame *f,
         const struct partition_who *who)
{
    double lines = (double)f->n / ROUNDS, left = (double)f->n - f->next;

    return s->kind == MSG_PART_AUTO && has_regions(s, f, who) &&
           left + who->share * lines / 2 >= lines;
}

static bool
next_cut(struct partition *p, struct asker *w, const struct partition_who *who,
         uint32_t *unit)
{
    struct partition_lines *s = p->lines;
    uint32_t frame = s->lo, first;
    struct frame *f;
    bool bars;

    while (may_begin(s, frame) &&
           s->frame[frame].nfree == s->frame[frame].nkept)
        frame++;
    if (!may_begin(s, frame))
        return false;
    f = &s->frame[frame];
    first = unit_start(p, f, w, who);
    bars = has_time(s, f, who);
    if (!cut(p, frame, first, unit_end(s, f, first, who), w, unit))
        return false;
    p->unit[*unit].bars = bars;
    return true;
}

/* --- static --- */

/* The line where a part of a frame's cost ends. */
static uint32_t
part_line(const struct partition_lines *s, const struct frame *f, double part)
{
    double want = part * f->cost, sum = 0;
    uint32_t i = 0;

    while (i < f->n) {
        double next = sum + line_cost(s, f, i);

        if (next - want > want - sum)
            break;
        sum = next;
        i++;
    }
    return i;
}

/* The worker's run of a frame, [*first, *last). */
static void
own_run(const struct partition_lines *s, const struct frame *f,
        const struct asker *w, uint32_t *first, uint32_t *last)
{
    *first = part_line(s, f, w->from);
    *last = w->to >= 1 ? f->n : part_line(s, f, w->to);
}

/* The first free stretch within [first, last); false: none. */
static bool
free_in(const struct partition_lines *s, const struct frame *f, uint32_t first,
        uint32_t last, uint32_t *from, uint32_t *to)
{
    while (first < last && !is_free(s, f, first))
        first++;
    *from = first;
    *to = stretch(s, f, first);
    if (*to > last)
        *to = last;
    return first < last;
}

/* The next stretch of a worker's own; w may be one that is absent, of whom
 * another takes. */
static bool
next_own(struct partition *p, struct asker *w, struct asker *taker,
         uint32_t *unit)
{
    struct partition_lines *s = p->lines;

    if (w->to <= w->from)
        return false;
    for (; w->own < s->nframes; w->own++) {
        struct frame *f = &s->frame[w->own];
        uint32_t first, last;

        if (!may_begin(s, w->own))
            return false;
        own_run(s, f, w, &first, &last);
        if (free_in(s, f, first, last, &first, &last))
            return cut(p, w->own, first, last, taker, unit);
    }
    return false;
}

static bool
next_static(struct partition *p, struct asker *w,
            const struct partition_who *who, uint32_t *unit)
{
    struct partition_lines *s = p->lines;
    uint32_t first, last;

    if (next_own(p, w, w, unit))
        return true;
    if (!who->idle)
        return false;
    for (uint32_t i = 0; i < s->nwho; i++)
        if (s->who[i].absent && next_own(p, &s->who[i], w, unit))
            return true;
    if (!s->balance || !may_begin(s, s->lo))
        return false;
    longest(s, &s->frame[s->lo], &first, &last);
    return cut(p, s->lo, first + (last - first) / 2, last, w, unit);
}

/* Every frame in proportion to their speeds. */
bool
partition_set_speeds(struct partition *p, const double *speed, uint32_t n)
{
    double sum = 0, at = 0;

    if (!p->lines || p->kind != MSG_PART_STATIC)
        return true;
    for (uint32_t i = 0; i < n; i++)
        sum += speed[i];
    for (uint32_t i = 0; i < n && sum > 0; i++) {
        struct asker *w = asker(p->lines, i);

        if (!w)
            return false;
        w->from = at / sum;
        at += speed[i];
        w->to = at / sum;
    }
    for (uint32_t i = sum > 0 ? n : 0; i-- > 0;)
        if (speed[i] > 0) {
            p->lines->who[i].to = 1; /* whatever rounding says */
            break;
        }
    return true;
}

void
partition_set_absent(struct partition *p, uint32_t worker, bool absent)
{
    struct asker *w = p->lines ? asker(p->lines, worker) : NULL;

    if (w)
        w->absent = absent;
}

/* --- units --- */

bool
lines_next(struct partition *p, const struct partition_who *who, uint32_t *unit)
{
    struct partition_lines *s = p->lines;
    struct asker *w = asker(s, who->worker);

    if (!w || s->nfree == 0)
        return false;
    if (who->workers > s->most) {
        s->most = who->workers;
        choose(p);
    }
    return s->kind == MSG_PART_STATIC ? next_static(p, w, who, unit)
                                      : next_cut(p, w, who, unit);
}

void
lines_done(struct partition *p, uint32_t unit)
{
    const struct partition_unit *u = &p->unit[unit];

    p->lines->frame[u->area.frame].undone -= u->last - u->first;
}

/* The line that begins at that row; f->n: none. */
static uint32_t
line_at(const struct partition_lines *s, const struct frame *f, uint32_t row)
{
    uint32_t line = 0;

    while (line < f->n && top_row(s, f, line) < row)
        line++;
    return line < f->n && top_row(s, f, line) == row ? line : f->n;
}

bool
lines_restore(struct partition *p, uint32_t unit,
              const struct partition_area *area)
{
    struct partition_lines *s = p->lines;
    uint32_t first, last;
    struct frame *f;

    if (unit != p->total || area->frame >= s->nframes || area->x != 0)
        return false;
    f = &s->frame[area->frame];
    first = line_at(s, f, area->y);
    last = first;
    while (is_free(s, f, last) &&
           base_row(s, f, last) + 1 - area->y < area->height)
        last++;
    if (area->width != f->width || !is_free(s, f, last) ||
        base_row(s, f, last) + 1 - area->y != area->height ||
        add_unit(p, f, first, last + 1) == PARTITION_NONE)
        return false;
    take_lines(s, f, first, last + 1, unit);
    return true;
}

uint32_t
partition_give(struct partition *p, uint32_t unit, uint32_t height)
{
    struct partition_lines *s = p->lines;
    struct partition_unit *u;
    struct frame *f;
    uint32_t line, last, given;

    if (!s || unit >= p->total || p->unit[unit].state == PART_DONE)
        return PARTITION_NONE;
    u = &p->unit[unit];
    f = &s->frame[u->area.frame];
    last = u->last;
    for (line = u->first; line < last; line++)
        if (base_row(s, f, line) + 1 == u->area.y + height)
            break;
    if (++line >= last)
        return PARTITION_NONE;
    given = add_unit(p, f, line, last);
    if (given == PARTITION_NONE)
        return given;
    if (!partition_back(p, given)) { /* it was never there */
        p->total--;
        p->waiting--;
        p->undone--;
        return PARTITION_NONE;
    }
    for (uint32_t i = line; i < last; i++)
        s->unit[f->first + i] = given;
    u = &p->unit[unit];
    u->area.height = height;
    u->last = line;
    u->cost -= p->unit[given].cost;
    return given;
}

void
partition_keep_line(struct partition *p, uint32_t frame, uint32_t line,
                    bool keep)
{
    struct partition_lines *s = p->lines;
    struct frame *f = &s->frame[frame];
    bool *kept = &s->kept[f->first + line];

    if (*kept == keep || s->unit[f->first + line] != PARTITION_NONE)
        return;
    *kept = keep;
    f->nkept += keep ? 1 : -1u;
    s->nkept += keep ? 1 : -1u;
}

uint32_t
partition_lines(const struct partition *p, uint32_t frame)
{
    return p->lines && frame < p->lines->nframes ? p->lines->frame[frame].n : 0;
}

uint32_t
partition_line_unit(const struct partition *p, uint32_t frame, uint32_t line)
{
    return p->lines->unit[p->lines->frame[frame].first + line];
}

bool
partition_unit_bars(const struct partition *p, uint32_t unit)
{
    return p->unit[unit].bars;
}

void
partition_unit_lines(const struct partition *p, uint32_t unit, uint32_t *first,
                     uint32_t *last)
{
    *first = p->unit[unit].first;
    *last = p->unit[unit].last;
}
