/* partition_run.c - static: each worker's own run of a frame
 *
 * All frames are cut alike into runs, in proportion to the workers' speeds, by
 * cost.  A run is one unit.
 * An idle worker takes the run of an absent worker.  If there is none, and runs
 * are balanced, it takes the lower half of the longest free stretch. */
#include "config.h"

#include "partition/partition_lines.h"

/* The line where the first `part` of a frame's cost ends. */
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

/* Find the first free stretch within [first, last); false: there is none. */
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

/* Cut the next unit of w's run for `taker`, which is w or takes the run of the
 * absent worker w. */
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

        if (!lines_may_begin(p, w->own))
            return false;
        own_run(s, f, w, &first, &last);
        if (free_in(s, f, first, last, &first, &last))
            return lines_cut(p, w->own, first, last, taker, unit);
    }
    return false;
}

/* Find the longest stretch of free lines; empty: no line is free. */
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
            p->lines->askers[i].to = 1; /* exactly, in spite of rounding */
            break;
        }
    return true;
}
