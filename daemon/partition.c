/* partition.c - see partition.h
 *
 * All units are laid out at the start, frame after frame; a ring of numbers is
 * the queue.  Windows of one frame are a grid: rows of near-equal height, each
 * cut into its share of the N windows, so that cells are close to square and
 * there are exactly N of them for any N. */
#include "config.h"

#include "partition.h"

#include "base/rng.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A window of about 64 x 64 pixels takes long enough that handing it out costs
 * nothing, and is small enough that several workers end together; a small
 * picture is still cut so that a few workers have something to do. */
#define PIXELS_PER_WINDOW 4096
#define LEAST_WINDOWS     16
#define MOST_WINDOWS      4096

/* A row of pixels must fit a RESULT. */
#define WIDEST (MSG_MAX_PIXELS / 16)

enum state { WAITING, OUT, DONE };

struct partition {
    struct partition_area *area; /* by unit */
    uint8_t *state;              /* enum state, by unit */
    uint32_t total, waiting, left;
    uint32_t *order; /* units in the order in which they go out */
    uint32_t next;   /* into order: those before it have gone out once */
    uint32_t *back;  /* units that came back, a stack */
    uint32_t nback;
    enum msg_partition kind;
    const char *choice;
};

static uint32_t
default_windows(const struct msg_frame *f)
{
    uint64_t n = (uint64_t)f->width * f->height / PIXELS_PER_WINDOW;

    if (n < LEAST_WINDOWS)
        n = LEAST_WINDOWS;
    return n > MOST_WINDOWS ? MOST_WINDOWS : (uint32_t)n;
}

/* Windows of one frame: what was asked for, as far as there are pixels, and
 * none wider than a message can carry. */
static uint32_t
windows_of(const struct partition_spec *spec, const struct msg_frame *f)
{
    uint64_t pixels = (uint64_t)f->width * f->height;
    uint32_t n = spec->windows ? spec->windows : default_windows(f);

    if (spec->single && spec->kind == MSG_PART_AUTO)
        n = 1;
    if (n > pixels)
        n = (uint32_t)pixels;
    return n;
}

/* Rows of the grid of n windows: cells near square, no more than n or the
 * picture's rows, and enough columns in each for the picture's width. */
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

/* First pixel of part i of `parts` when `before` of n cells lie before it: one
 * pixel to each part, the others in proportion to the cells. */
static uint32_t
cut(uint32_t length, uint32_t before, uint32_t n, uint32_t i, uint32_t parts)
{
    return i + (uint32_t)((uint64_t)(length - parts) * before / n);
}

static void
add_row(struct partition *p, uint32_t frame, uint32_t width, uint32_t y0,
        uint32_t y1, uint32_t columns)
{
    for (uint32_t j = 0; j < columns; j++) {
        uint32_t x0 = cut(width, j, columns, j, columns);
        uint32_t x1 = cut(width, j + 1, columns, j + 1, columns);

        p->area[p->total++] =
            (struct partition_area){ frame, x0, y0, x1 - x0, y1 - y0 };
    }
}

/* Columns of row i when n windows lie in `rows` rows. */
static uint32_t
columns_of(uint32_t n, uint32_t rows, uint32_t i, uint32_t *before)
{
    *before = (uint32_t)((uint64_t)n * i / rows);
    return (uint32_t)((uint64_t)n * (i + 1) / rows) - *before;
}

static void
add_frame(struct partition *p, uint32_t frame, const struct msg_frame *f,
          uint32_t n)
{
    uint32_t rows = grid_rows(f, n);

    for (uint32_t i = 0; i < rows; i++) {
        uint32_t before, columns = columns_of(n, rows, i, &before);

        add_row(p, frame, f->width, cut(f->height, before, n, i, rows),
                cut(f->height, before + columns, n, i + 1, rows), columns);
    }
}

/* Sort one frame's stretch of the queue. */
static void
order_frame(uint32_t *v, uint32_t n, const struct partition_spec *spec,
            uint32_t frame)
{
    uint64_t key = rad_key_branch(rad_mix64(spec->seed), frame);

    for (uint32_t i = 0; i + 1 < n; i++) {
        uint32_t j = i;

        if (spec->order == MSG_ORDER_BACKWARD)
            j = n - 1 - i;
        else if (spec->order == MSG_ORDER_RANDOM)
            j = i + (uint32_t)(rad_rand(key, i) * (n - i));
        if (j > i) {
            uint32_t t = v[i];

            v[i] = v[j];
            v[j] = t;
        }
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
partition_check(const struct partition_spec *spec, struct rad_error *err)
{
    if (spec->kind == MSG_PART_STATIC || spec->kind == MSG_PART_SCANBAR)
        return rad_fail(err, RAD_EUSAGE,
                        "--partition=%s is not supported yet; use window",
                        partition_kind_name(spec->kind));
    if (spec->order == MSG_ORDER_COST)
        return rad_fail(err, RAD_EUSAGE,
                        "--order=cost is not supported yet; use forward, "
                        "backward or random");
    for (uint32_t i = 0; i < spec->nframes; i++)
        if (spec->frames[i].width > WIDEST)
            return rad_fail(err, RAD_EUSAGE,
                            "picture of %u columns: at most %u are supported",
                            spec->frames[i].width, WIDEST);
    if (count_units(spec) > PARTITION_MAX_UNITS)
        return rad_fail(err, RAD_EUSAGE, "too many windows: at most %d",
                        PARTITION_MAX_UNITS);
    return 0;
}

static const char *
why(const struct partition_spec *spec)
{
    if (spec->kind == MSG_PART_WINDOW)
        return "asked for";
    if (spec->single)
        return "one worker: one window has the fewest samples";
    return "several workers: windows by the picture's size";
}

static bool
allocate(struct partition *p, size_t n)
{
    p->area = malloc(n * sizeof *p->area);
    p->state = calloc(n, sizeof *p->state);
    p->order = malloc(n * sizeof *p->order);
    p->back = malloc(n * sizeof *p->back);
    return p->area && p->state && p->order && p->back;
}

struct partition *
partition_new(const struct partition_spec *spec, struct rad_error *err)
{
    struct partition *p;

    if (partition_check(spec, err) != 0)
        return NULL;
    p = calloc(1, sizeof *p);
    if (!p || !allocate(p, count_units(spec))) {
        partition_free(p);
        rad_fail(err, RAD_ENOMEM, "out of memory");
        return NULL;
    }
    for (uint32_t i = 0; i < spec->nframes; i++) {
        uint32_t first = p->total;

        add_frame(p, i, &spec->frames[i], windows_of(spec, &spec->frames[i]));
        for (uint32_t u = first; u < p->total; u++)
            p->order[u] = u;
        order_frame(p->order + first, p->total - first, spec, i);
    }
    p->waiting = p->left = p->total;
    p->kind = MSG_PART_WINDOW;
    p->choice = why(spec);
    return p;
}

void
partition_free(struct partition *p)
{
    if (!p)
        return;
    free(p->area);
    free(p->state);
    free(p->order);
    free(p->back);
    free(p);
}

uint32_t
partition_total(const struct partition *p)
{
    return p->total;
}

uint32_t
partition_waiting(const struct partition *p)
{
    return p->waiting;
}

uint32_t
partition_left(const struct partition *p)
{
    return p->left;
}

/* Units that were taken out of turn are skipped where they lie. */
bool
partition_next(struct partition *p, uint32_t worker, uint32_t *unit)
{
    (void)worker; /* one window is as good as another to any worker */
    while (p->nback > 0) {
        *unit = p->back[--p->nback];
        if (p->state[*unit] == WAITING)
            goto take;
    }
    while (p->next < p->total) {
        *unit = p->order[p->next++];
        if (p->state[*unit] == WAITING)
            goto take;
    }
    return false;
take:
    p->state[*unit] = OUT;
    p->waiting--;
    return true;
}

void
partition_lost(struct partition *p, uint32_t unit)
{
    if (p->state[unit] != OUT)
        return;
    p->state[unit] = WAITING;
    p->waiting++;
    p->back[p->nback++] = unit;
}

void
partition_take(struct partition *p, uint32_t unit)
{
    if (p->state[unit] != WAITING)
        return;
    p->state[unit] = OUT;
    p->waiting--;
    for (uint32_t i = 0; i < p->nback; i++)
        if (p->back[i] == unit) {
            memmove(p->back + i, p->back + i + 1,
                    (p->nback - i - 1) * sizeof *p->back);
            p->nback--;
            break;
        }
}

void
partition_done(struct partition *p, uint32_t unit)
{
    if (p->state[unit] != OUT)
        return;
    p->state[unit] = DONE;
    p->left--;
}

void
partition_area(const struct partition *p, uint32_t unit,
               struct partition_area *area)
{
    *area = p->area[unit];
}

double
partition_cost(const struct partition *p, uint32_t unit)
{
    return (double)p->area[unit].width * p->area[unit].height;
}

const char *
partition_choice(const struct partition *p)
{
    return p->choice;
}

enum msg_partition
partition_kind(const struct partition *p)
{
    return p->kind;
}

const char *
partition_kind_name(enum msg_partition kind)
{
    static const char *const name[] = { "auto", "static", "scanbar", "window" };

    return kind < MSG_NPART ? name[kind] : "?";
}
