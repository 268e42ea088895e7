/* partition_window.c - a grid of windows on each frame
 *
 * All units are laid out at the start, frame after frame; their order is an
 * array of their numbers.  Windows of a frame are a grid: rows of near-equal
 * height, each cut into its share of the N windows, so that cells are close to
 * square and there are exactly N of them for any N. */
#include "config.h"

#include "partition/partition_impl.h"

#include "base/rng.h"
#include "picture/quincunx.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A window of about 64 x 64 pixels takes long enough that handing it out costs
 * nothing, and is small enough that several workers end together; a small
 * picture is still cut so that a few workers have something to do. */
#define PIXELS_PER_WINDOW 4096
#define LEAST_WINDOWS     16
#define MOST_WINDOWS      4096

struct partition_window {
    enum msg_order kind;
    uint64_t seed;
    bool fresh;      /* a frame begins when those before it are done */
    uint32_t *order; /* units in the order in which they go out */
    uint32_t next;   /* into order: units before have gone out once */
};

static uint32_t
default_windows(const struct msg_frame *f)
{
    uint64_t n = (uint64_t)f->width * f->height / PIXELS_PER_WINDOW;

    if (n < LEAST_WINDOWS)
        n = LEAST_WINDOWS;
    return n > MOST_WINDOWS ? MOST_WINDOWS : (uint32_t)n;
}

/* The number of windows of a frame: as asked for or by its size, but no more
 * than pixels. */
static uint32_t
windows_of(const struct partition_spec *spec, const struct msg_frame *f)
{
    uint64_t pixels = (uint64_t)f->width * f->height;
    uint32_t n = spec->windows ? spec->windows : default_windows(f);

    return n > pixels ? (uint32_t)pixels : n;
}

/* Rows of the grid of n windows: so many that cells are near square, no more
 * than n or the picture's rows, and enough that a row has no more cells than
 * the picture has columns. */
static uint32_t
grid_rows(const struct msg_frame *f, uint32_t n)
{
    double r = sqrt((double)n * f->height / f->width);
    uint32_t rows = r < 1 ? 1 : (uint32_t)(r + .5);
    uint32_t least = (n + f->width - 1) / f->width; /* n/rows <= width */

    if (rows < least)
        rows = least;
    if (rows > n)
        rows = n;
    return rows > f->height ? f->height : rows;
}

/* The first pixel of part i of `parts` when `before` of n cells lie before that
 * part: each part has one pixel, and more in proportion to its cells. */
static uint32_t
cut(uint32_t length, uint32_t before, uint32_t n, uint32_t i, uint32_t parts)
{
    return i + (uint32_t)((uint64_t)(length - parts) * before / n);
}

static bool
add_row(struct partition *p, uint32_t frame, uint32_t width, uint32_t y0,
        uint32_t y1, uint32_t columns)
{
    for (uint32_t j = 0; j < columns; j++) {
        uint32_t x0 = cut(width, j, columns, j, columns);
        uint32_t x1 = cut(width, j + 1, columns, j + 1, columns);
        struct partition_area a = { frame, x0, y0, x1 - x0, y1 - y0 };
        uint32_t unit = partition_add(p, &a);

        if (unit == PARTITION_NONE)
            return false;
        p->unit[unit].cost = (double)a.width * a.height;
        p->cost_total += p->unit[unit].cost;
    }
    return true;
}

/* Columns of row i when n windows lie in `rows` rows; *before gets the windows
 * in rows above. */
static uint32_t
columns_of(uint32_t n, uint32_t rows, uint32_t i, uint32_t *before)
{
    *before = (uint32_t)((uint64_t)n * i / rows);
    return (uint32_t)((uint64_t)n * (i + 1) / rows) - *before;
}

static bool
add_frame(struct partition *p, uint32_t frame, const struct msg_frame *f,
          uint32_t n)
{
    uint32_t rows = grid_rows(f, n);

    for (uint32_t i = 0; i < rows; i++) {
        uint32_t before, columns = columns_of(n, rows, i, &before);

        if (!add_row(p, frame, f->width, cut(f->height, before, n, i, rows),
                     cut(f->height, before + columns, n, i + 1, rows), columns))
            return false;
    }
    return true;
}

/* Sort windows: the dearest first, those of one cost as they lie. */
static void
sort_by_cost(const struct partition *p, uint32_t *v, uint32_t n)
{
    for (uint32_t gap = n / 2; gap > 0; gap /= 2)
        for (uint32_t i = gap; i < n; i++)
            for (uint32_t j = i; j >= gap; j -= gap) {
                uint32_t a = v[j - gap], b = v[j];

                if (p->unit[a].cost > p->unit[b].cost ||
                    (p->unit[a].cost == p->unit[b].cost && a < b))
                    break;
                v[j - gap] = b;
                v[j] = a;
            }
}

/* Order the part v of the order that has a frame's n windows, as they lie. */
static void
order_frame(const struct partition *p, uint32_t *v, uint32_t n, uint32_t frame)
{
    enum msg_order kind = p->window->kind;
    uint64_t key = rad_key_branch(rad_mix64(p->window->seed), frame);

    if (kind == MSG_ORDER_COST)
        sort_by_cost(p, v, n);
    for (uint32_t i = 0; i + 1 < n; i++) {
        uint32_t j = i;

        if (kind == MSG_ORDER_BACKWARD)
            j = n - 1 - i;
        else if (kind == MSG_ORDER_RANDOM)
            j = i + (uint32_t)(rad_rand(key, i) * (n - i));
        if (j > i) {
            uint32_t t = v[i];

            v[i] = v[j];
            v[j] = t;
        }
    }
}

static void
order_all(struct partition *p)
{
    uint32_t *v = p->window->order;

    for (uint32_t u = 0; u < p->total; u++)
        v[u] = u;
    for (uint32_t first = 0, end; first < p->total; first = end) {
        uint32_t frame = p->unit[first].area.frame;

        for (end = first; end < p->total; end++)
            if (p->unit[end].area.frame != frame)
                break;
        order_frame(p, v + first, end - first, frame);
    }
}

static uint64_t
count_units(const struct partition_spec *spec)
{
    uint64_t n = 0;

    for (uint32_t i = 0; i < spec->nframes; i++)
        n += windows_of(spec, &spec->frames[i]);
    return n;
}

int
window_check(const struct partition_spec *spec, struct rad_error *err)
{
    if (count_units(spec) > MSG_MAX_WINDOWS)
        return rad_fail(err, RAD_EUSAGE, "too many windows: at most %d",
                        MSG_MAX_WINDOWS); /* so many take 60 MB */
    return 0;
}

/* The cost of a window from the given costs of lines: its part of the cost of
 * each line that it touches. */
static double
cost_of(const struct rad_quincunx *q, const float *line,
        const struct partition_area *a)
{
    int top = (int)a->y, end = top + (int)a->height;
    double sum = 0;

    for (int i = (top + q->ystep - 1) / q->ystep; top < end; i++) {
        int y0 = i > 0 ? rad_quincunx_base_row(q, i - 1) + 1 : 0;
        int y1 = rad_quincunx_base_row(q, i) + 1;
        int to = y1 < end ? y1 : end;

        sum += (double)line[i] * (to - top) / (y1 - y0) * a->width / q->width;
        top = to;
    }
    return sum;
}

double *
window_first_costs(const struct partition *p, const struct partition_spec *spec)
{
    struct rad_quincunx q = { 0 };
    double *cost = malloc(p->total * sizeof *cost);
    const float *line = spec->costs;
    uint32_t u = 0;

    rad_quincunx_steps(spec->psample, &q.xstep, &q.ystep);
    for (uint32_t f = 0; cost && f < spec->nframes; f++) {
        q.width = (int)spec->frames[f].width;
        q.height = (int)spec->frames[f].height;
        for (; u < p->total && p->unit[u].area.frame == f; u++)
            cost[u] = cost_of(&q, line, &p->unit[u].area);
        line += rad_quincunx_nbases(&q);
    }
    return cost;
}

bool
window_new(struct partition *p, const struct partition_spec *spec)
{
    struct partition_window *w = calloc(1, sizeof *w);

    p->window = w;
    if (!w)
        return false;
    w->kind = spec->order;
    w->seed = spec->seed;
    w->fresh = spec->fresh;
    for (uint32_t i = 0; i < spec->nframes; i++)
        if (!add_frame(p, i, &spec->frames[i],
                       windows_of(spec, &spec->frames[i])))
            return false;
    w->order = malloc(p->total * sizeof *w->order);
    if (!w->order)
        return false;
    order_all(p);
    p->kind = MSG_PART_WINDOW;
    snprintf(p->choice, sizeof p->choice, "asked for");
    return true;
}

void
window_free(struct partition_window *w)
{
    if (!w)
        return;
    free(w->order);
    free(w);
}

void
window_set_costs(struct partition *p, const double *cost)
{
    for (uint32_t u = 0; u < p->total; u++)
        p->unit[u].cost = cost[u];
    order_all(p);
}

/* May the next unit's frame not go out yet, or is it the first of its frame,
 * while units before it are not done? */
static bool
must_wait(const struct partition *p)
{
    const struct partition_window *w = p->window;
    uint32_t i = w->next;

    return partition_is_shut(p, w->order[i]) ||
           (w->fresh && i > 0 &&
            p->unit[w->order[i]].area.frame !=
                p->unit[w->order[i - 1]].area.frame &&
            p->undone > p->total - i);
}

bool
window_next(struct partition *p, uint32_t *unit)
{
    struct partition_window *w = p->window;

    while (w->next < p->total && !must_wait(p)) {
        *unit = w->order[w->next++];
        if (partition_is_free(p, *unit))
            return true;
    }
    return false;
}
