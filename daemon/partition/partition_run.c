/* partition_run.c - static: each worker's own run of a frame
 *
 * All frames are cut alike, in proportion to the workers' speeds, by cost.  A
 * unit is what is free of the worker's run, or of a long one but the last what
 * is free of its last lines, which end in the base line that its neighbour
 * needs; then of ALONG of all that is left, whose bars are made along with its
 * base lines; then of the rest, where base lines come before bars, so that the
 * truth is everywhere before the end.
 * One that is idle takes the run of one that is not there, and where others'
 * are balanced, half of the longest stretch that is free. */
#include "config.h"

#include "partition/partition_lines.h"

#include "team/team.h"

/* A run of so many lines is cut in three.  Bars that are made along with base
 * lines see the same ambient records, and fewer pixels are traced; but the
 * truth comes later, so that what is given away meanwhile leaves more to be
 * traced under it, and those who wait send facts.  Eight workers, office at
 * night: with 107 lines each 3.4 % fewer rays and 2 % faster, nine runs of
 * each; with 53 lines 1 % fewer rays, all of which is lost again. */
#define LONG   80
#define BOTTOM (TEAM_SURE + 1) /* lines: what ends in a good guess */
#define ALONG  (2. / 3)

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
    while (first < last && !line_is_free(s, f, first))
        first++;
    *from = first;
    *to = lines_stretch(s, f, first);
    if (*to > last)
        *to = last;
    return first < last;
}

/* Where a part of the cost of lines [first, last) ends, or a line before. */
static uint32_t
along_until(const struct partition_lines *s, const struct frame *f,
            uint32_t first, uint32_t last)
{
    double left = ALONG * lines_cost(s, f, first, last);

    while (first < last && (left -= line_cost(s, f, first)) >= 0)
        first++;
    return first;
}

/* The next free stretch of a run [first, last); false: none is left.  Nobody
 * waits for the end of a frame: bars above it come along anyway
 * (strict_pass.c). */
static bool
next_part(const struct partition_lines *s, const struct frame *f,
          uint32_t first, uint32_t last, uint32_t *from, uint32_t *to,
          bool *bars)
{
    uint32_t bottom = last - BOTTOM, mid;

    *bars = false;
    if (last < first + LONG || last == f->n)
        return free_in(s, f, first, last, from, to);
    if (free_in(s, f, bottom, last, from, to))
        return true;
    mid = along_until(s, f, first, bottom);
    *bars = free_in(s, f, first, mid, from, to);
    return *bars || free_in(s, f, mid, bottom, from, to);
}

/* The next stretch of a worker's own run; w may be an absent worker, whose run
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
        bool bars;

        if (!lines_may_begin(p, w->own))
            return false;
        own_run(s, f, w, &first, &last);
        if (!next_part(s, f, first, last, &first, &last, &bars))
            continue;
        if (!lines_cut(p, w->own, first, last, taker, unit))
            return false;
        p->unit[*unit].bars = bars;
        return true;
    }
    return false;
}

/* The longest stretch of free lines; empty when no line is free. */
static void
longest(const struct partition_lines *s, const struct frame *f, uint32_t *first,
        uint32_t *last)
{
    *first = *last = 0;
    for (uint32_t i = 0, end; i < f->n; i = end + 1) {
        end = lines_stretch(s, f, i);
        if (end - i > *last - *first) {
            *first = i;
            *last = end;
        }
    }
}

bool
run_next(struct partition *p, struct asker *w, const struct partition_ask *ask,
         uint32_t *unit)
{
    struct partition_lines *s = p->lines;
    uint32_t first, last;

    if (next_own(p, w, w, unit))
        return true;
    if (!ask->idle)
        return false;
    for (uint32_t i = 0; i < s->naskers; i++)
        if (s->askers[i].absent && next_own(p, &s->askers[i], w, unit))
            return true;
    if (!s->balance || !lines_may_begin(p, s->lo))
        return false;
    longest(s, &s->frame[s->lo], &first, &last);
    return lines_cut(p, s->lo, first + (last - first) / 2, last, w, unit);
}

/* Cut every frame in proportion to the workers' speeds. */
bool
partition_set_speeds(struct partition *p, const double *speed, uint32_t n)
{
    double sum = 0, at = 0;

    if (!p->lines || p->kind != MSG_PART_STATIC)
        return true;
    for (uint32_t i = 0; i < n; i++)
        sum += speed[i];
    for (uint32_t i = 0; i < n && sum > 0; i++) {
        struct asker *w = lines_asker(p->lines, i);

        if (!w)
            return false;
        w->from = at / sum;
        at += speed[i];
        w->to = at / sum;
    }
    for (uint32_t i = sum > 0 ? n : 0; i-- > 0;)
        if (speed[i] > 0) {
            p->lines->askers[i].to = 1; /* whatever rounding says */
            break;
        }
    return true;
}
