/* dearest.c - see dearest.h
 *
 * Each picture has a grid of cells, each with the rays per pixel that the last
 * tile there took.  Tiles of deep records have no place in a picture, and go
 * out by their numbers. */
#include "config.h"

#include "filling/dearest.h"

#include <stdlib.h>

#define CELL_SIDE  32 /* pixels; doubled until there are at most MOST_CELLS */
#define MOST_CELLS (1u << 20)

struct grid {
    int columns;
    float *rays; /* per pixel, row by row of cells */
};

struct dearest {
    const struct rad_pass_size *size;
    int side;          /* of a cell, in pixels */
    struct grid *grid; /* of each picture */
    float *rays;       /* memory of all grids */
};

struct dear {
    double rays;
    uint32_t tile;
};

/* Are the tiles of the pass rectangles of pixels, so that the grids know them?
 */
static bool
is_lattice(const struct rad_pass *pass)
{
    return pass->level == 0 && pass->step > 0 && !pass->check &&
           !pass->scattered;
}

static int
along(int length, int side)
{
    return (length + side - 1) / side;
}

static uint64_t
count_cells(const struct rad_pass_size *size, uint32_t n, int side)
{
    uint64_t cells = 0;

    for (uint32_t i = 0; i < n; i++)
        cells += (uint64_t)along(size[i].width, side) *
                 (uint64_t)along(size[i].height, side);
    return cells;
}

struct dearest *
dearest_new(const struct rad_pass_size *size, uint32_t n)
{
    struct dearest *d = calloc(1, sizeof *d);
    float *to;

    if (!d)
        return NULL;
    d->size = size;
    d->side = CELL_SIDE;
    while (count_cells(size, n, d->side) > MOST_CELLS && d->side < 1 << 20)
        d->side *= 2;
    d->grid = calloc(n, sizeof *d->grid);
    d->rays = to = calloc(count_cells(size, n, d->side), sizeof *to);
    if (!d->grid || !d->rays) {
        dearest_free(d);
        return NULL;
    }
    for (uint32_t i = 0; i < n; i++) {
        d->grid[i] = (struct grid){ along(size[i].width, d->side), to };
        to += d->grid[i].columns * along(size[i].height, d->side);
    }
    return d;
}

void
dearest_free(struct dearest *d)
{
    if (!d)
        return;
    free(d->grid);
    free(d->rays);
    free(d);
}

/* --- rays that tiles took --- */

static void
note_area(const struct dearest *d, const struct grid *g,
          const struct rad_pass_area *a, double rays)
{
    double pixels = (double)(a->x1 - a->x0) * (a->y1 - a->y0);

    for (int y = a->y0 / d->side; y <= (a->y1 - 1) / d->side; y++)
        for (int x = a->x0 / d->side; x <= (a->x1 - 1) / d->side; x++)
            g->rays[y * g->columns + x] = (float)(rays / pixels);
}

void
dearest_note(struct dearest *d, const struct rad_pass *pass, uint32_t tile,
             uint64_t rays)
{
    uint32_t i = pass->frame, n = 0;
    struct rad_pass_area a;

    if (!is_lattice(pass))
        return;
    for (; i < pass->beyond; i += pass->stride, tile -= n) {
        n = rad_pass_tiles(pass, d->size[i].width, d->size[i].height);
        if (tile < n)
            break;
    }
    if (i >= pass->beyond)
        return;
    a = rad_pass_area(pass, d->size[i].width, d->size[i].height, tile);
    note_area(d, &d->grid[i], &a, (double)rays);
}

/* --- the order --- */

/* Rays that a tile of this area will take, by its cells' rays per pixel. */
static double
expect(const struct dearest *d, const struct grid *g,
       const struct rad_pass_area *a)
{
    double sum = 0, n = 0;

    for (int y = a->y0 / d->side; y <= (a->y1 - 1) / d->side; y++)
        for (int x = a->x0 / d->side; x <= (a->x1 - 1) / d->side; x++, n++)
            sum += (double)g->rays[y * g->columns + x];
    return sum / n * (a->x1 - a->x0) * (a->y1 - a->y0);
}

static void
expect_pixels(const struct dearest *d, const struct rad_pass *pass,
              struct dear *to)
{
    for (uint32_t i = pass->frame; i < pass->beyond; i += pass->stride) {
        int width = d->size[i].width, height = d->size[i].height;
        uint32_t n = rad_pass_tiles(pass, width, height);

        for (uint32_t k = 0; k < n; k++, to++) {
            struct rad_pass_area a = rad_pass_area(pass, width, height, k);

            to->rays = expect(d, &d->grid[i], &a);
        }
    }
}

static int
by_rays(const void *a, const void *b)
{
    const struct dear *x = a, *y = b;

    return x->rays != y->rays  ? (x->rays > y->rays ? -1 : 1)
           : x->tile < y->tile ? -1
                               : x->tile > y->tile;
}

bool
dearest_order(const struct dearest *d, const struct rad_pass *pass,
              uint32_t *order)
{
    struct dear *v = calloc(pass->tiles + 1, sizeof *v);

    if (!v)
        return false;
    for (uint32_t i = 0; i < pass->tiles; i++)
        v[i].tile = i;
    if (is_lattice(pass) && pass->tiles > 0) /* open_passes() may set 0 */
        expect_pixels(d, pass, v);
    qsort(v, pass->tiles, sizeof *v, by_rays);
    for (uint32_t i = 0; i < pass->tiles; i++)
        order[i] = v[i].tile;
    free(v);
    return true;
}
