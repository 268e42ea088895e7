/* partition_lines.c - the lines of each frame, and runs of them as units
 *
 * A unit is cut when it goes out: from regions that all workers share (scanbar,
 * auto; partition_region.c), or from each worker's own run (static;
 * partition_run.c).
 * Frames go out in order: a frame begins when the frame before it has no free
 * line left, or, with partition_spec.fresh, when that frame is done. */
#include "config.h"

#include "partition/partition_lines.h"

#include "base/list.h"
#include "picture/quincunx.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

/* The first row of line i. */
static uint32_t
top_row(const struct partition_lines *s, const struct frame *f, uint32_t i)
{
    return i > 0 ? base_row(s, f, i - 1) + 1 : 0;
}

double
lines_cost(const struct partition_lines *s, const struct frame *f,
           uint32_t first, uint32_t last)
{
    double sum = 0;

    for (uint32_t i = first; i < last; i++)
        sum += line_cost(s, f, i);
    return sum;
}

uint32_t
lines_stretch(const struct partition_lines *s, const struct frame *f,
              uint32_t line)
{
    while (line_is_free(s, f, line))
        line++;
    return line;
}

bool
lines_may_begin(const struct partition *p, uint32_t frame)
{
    const struct partition_lines *s = p->lines;

    return frame < p->open &&
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

double *
lines_first_costs(const struct partition_lines *s,
                  const struct partition_spec *spec)
{
    double *cost = malloc(s->nlines * sizeof *cost);

    for (uint32_t i = 0; cost && i < s->nframes; i++) {
        const struct frame *f = &s->frame[i];

        for (uint32_t k = 0; k < f->n; k++) {
            uint32_t rows = base_row(s, f, k) + 1 - top_row(s, f, k);

            cost[f->first + k] = spec->ncosts > 0
                                     ? (double)spec->costs[f->first + k]
                                     : (double)rows * f->width;
        }
    }
    return cost;
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
    return true;
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
    free(s->askers);
    free(s);
}

uint32_t
lines_areas(const struct partition *p)
{
    return p->lines->nlines;
}

static const struct frame *
frame_of(const struct partition_lines *s, uint32_t area)
{
    uint32_t lo = 0, hi = s->nframes;

    while (hi - lo > 1) {
        uint32_t mid = (lo + hi) / 2;

        if (s->frame[mid].first <= area)
            lo = mid;
        else
            hi = mid;
    }
    return &s->frame[lo];
}

void
lines_nth_area(const struct partition *p, uint32_t n,
               struct partition_area *area)
{
    const struct partition_lines *s = p->lines;
    const struct frame *f = frame_of(s, n);
    uint32_t line = n - f->first, y = top_row(s, f, line);

    *area = (struct partition_area){ (uint32_t)(f - s->frame), 0, y, f->width,
                                     base_row(s, f, line) + 1 - y };
}

/* The end of the frames that may begin; the first of them is s->lo. */
static uint32_t
lines_end(const struct partition *p)
{
    uint32_t lo = p->lines->lo;

    return !p->lines->fresh ? p->open : lo + lines_may_begin(p, lo);
}

uint32_t
lines_free_count(const struct partition *p)
{
    const struct partition_lines *s = p->lines;

    uint32_t n = 0;

    if (!s->fresh && p->open == s->nframes)
        return s->nfree - s->nkept;
    for (uint32_t i = s->lo; i < lines_end(p); i++)
        n += s->frame[i].nfree - s->frame[i].nkept;
    return n;
}

double
lines_left(const struct partition *p)
{
    const struct partition_lines *s = p->lines;
    double left = 0;

    if (!s->fresh && p->open == s->nframes)
        return s->left;
    for (uint32_t i = s->lo; i < lines_end(p); i++)
        left += s->frame[i].left;
    return left;
}

/* --- cutting --- */

struct asker *
lines_asker(struct partition_lines *s, uint32_t worker)
{
    while (s->naskers <= worker) {
        if (!rad_list_grow(&s->askers, s->naskers, sizeof *s->askers))
            return NULL;
        s->askers[s->naskers++] = (struct asker){ .from = 0 };
    }
    return &s->askers[worker];
}

static void
take_lines(struct partition_lines *s, struct frame *f, uint32_t first,
           uint32_t last, uint32_t unit)
{
    double cost = lines_cost(s, f, first, last);

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
    p->unit[unit].cost = lines_cost(s, f, first, last);
    return unit;
}

bool
lines_cut(struct partition *p, uint32_t frame, uint32_t first, uint32_t last,
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

void
partition_set_absent(struct partition *p, uint32_t worker, bool absent)
{
    struct asker *w = p->lines ? lines_asker(p->lines, worker) : NULL;

    if (w)
        w->absent = absent;
}

/* --- units --- */

void
lines_done(struct partition *p, uint32_t unit)
{
    const struct partition_unit *u = &p->unit[unit];

    p->lines->frame[u->area.frame].undone -= u->last - u->first;
}

/* The line whose first row that is; f->n: there is none. */
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
    while (line_is_free(s, f, last) &&
           base_row(s, f, last) + 1 - area->y < area->height)
        last++;
    if (area->width != f->width || !line_is_free(s, f, last) ||
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

    if (!s || unit >= p->total || p->unit[unit].state == PARTITION_DONE)
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
    if (!partition_back(p, given)) { /* undo add_unit() */
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

void
partition_unit_lines(const struct partition *p, uint32_t unit, uint32_t *first,
                     uint32_t *last)
{
    *first = p->unit[unit].first;
    *last = p->unit[unit].last;
}
