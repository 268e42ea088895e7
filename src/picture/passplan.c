/* passplan.c - see passplan.h
 *
 * Few paths tell of the large zones, and each further round of them, four times
 * as many, of smaller ones.
 * To ask at every pixel takes longer than it saves: the picture's sampling
 * leaves most of them out, too. */
#include "config.h"

#include "picture/passplan.h"

#include <assert.h>
#include <string.h>

/* Paths: one for so many pixels, within these bounds. */
#define PIXELS_A_PATH 64
#define LEAST_PATHS   256
#define MOST_PATHS    65536

#define ROUND_GROWTH 4   /* paths of a round over all before it */
#define TILES              128 /* of a round, but */
#define LEAST_PATHS_A_TILE 64
#define COARSEST     32  /* lattice [pixels] */

static uint32_t
count_paths(const struct rad_pass_size *size, uint32_t n)
{
    uint64_t pixels = 0, paths;

    for (uint32_t i = 0; i < n; i++)
        pixels += (uint64_t)size[i].width * (uint64_t)size[i].height;
    paths = pixels / PIXELS_A_PATH;
    return paths < LEAST_PATHS  ? LEAST_PATHS
           : paths > MOST_PATHS ? MOST_PATHS
                                : (uint32_t)paths;
}

static uint32_t
count_tiles(uint32_t paths)
{
    uint32_t n = paths / LEAST_PATHS_A_TILE;

    return n < 1 ? 1 : n > TILES ? TILES : n;
}

/* The rounds for records of that level: the last ends with all paths, and each
 * before it with a part of those. */
static uint32_t
plan_level(int level, uint32_t paths, struct rad_pass *pass)
{
    uint32_t n = 0, first = 0, part = 1;

    while (paths / (part * ROUND_GROWTH) >= LEAST_PATHS)
        part *= ROUND_GROWTH;
    for (; part > 0; part /= ROUND_GROWTH, n++) {
        uint32_t end = paths / part;

        pass[n] = (struct rad_pass){ .level = level,
                                     .first = first,
                                     .end = end,
                                     .tiles = count_tiles(end - first) };
        first = end;
    }
    return n;
}

/* The largest step of a lattice that is no larger than that of base lines. */
static int
finest_step(const struct rad_params *par)
{
    int step = RAD_PASS_FINEST;

    while (step > RAD_PASS_LEAST_STEP && step > par->psample)
        step /= 2;
    return step;
}

/* The lattices of some frames. */
static uint32_t
plan_frames(const struct rad_params *par, const struct rad_pass_size *size,
            uint32_t nsizes, uint32_t frame, uint32_t stride,
            struct rad_pass *pass)
{
    int finest = finest_step(par);
    uint32_t n = 0;

    for (int step = COARSEST, done = 0; step >= finest;
         done = step, step /= 2) {
        uint32_t tiles = 0;

        for (uint32_t i = frame; i < nsizes; i += stride)
            tiles += rad_pass_tiles(size[i].width, size[i].height, step);
        pass[n++] = (struct rad_pass){ .step = step,
                                       .done = done,
                                       .frame = frame,
                                       .stride = stride,
                                       .finest = step == finest,
                                       .tiles = tiles };
    }
    return n;
}

/* First frame 0, then those at odd multiples of ever smaller distances. */
static uint32_t
plan_pixels(const struct rad_params *par, const struct rad_pass_size *size,
            uint32_t nsizes, struct rad_pass *pass)
{
    uint32_t n = plan_frames(par, size, nsizes, 0, nsizes, pass), apart = 1;

    while (apart < nsizes)
        apart *= 2;
    while ((apart /= 2) > 0)
        n += plan_frames(par, size, nsizes, apart, 2 * apart, pass + n);
    return n;
}

static int
lesser(int a, int b)
{
    return a < b ? a : b;
}

struct rad_pass_area
rad_pass_area(int width, int height, int step, uint32_t tile)
{
    int side = rad_pass_side(step) * step;
    int across = (int)rad_pass_along(width, step);
    int x = (int)tile % across * side, y = (int)tile / across * side;

    return (struct rad_pass_area){ x, y, lesser(x + side, width),
                                   lesser(y + side, height) };
}

uint32_t
rad_passes_plan(const struct rad_params *par, const struct rad_pass_size *size,
                uint32_t nsizes, struct rad_pass pass[RAD_MOST_PASSES])
{
    int deepest = par->ambounce - 1;
    uint32_t n = 0, paths = count_paths(size, nsizes);

    if (par->ambounce < 1 || !(par->ambacc > 0) || par->ambdiv < 1)
        return 0;
    if (deepest > RAD_PASS_LEVELS)
        deepest = RAD_PASS_LEVELS;
    for (int level = deepest; level > 0; level--)
        n += plan_level(level, paths, pass + n);
    return n + plan_pixels(par, size, nsizes, pass + n);
}

/* There is room for one more: paths have 5 rounds of 8 levels, and 65536 frames
 * 17 times 5 lattices. */
uint32_t
rad_passes_plan_on(const struct rad_params *par,
                   const struct rad_pass_size *size, uint32_t nsizes,
                   struct rad_pass pass[RAD_MOST_PASSES])
{
    uint32_t n = rad_passes_plan(par, size, nsizes, pass);

    if (n == 0)
        return 0;
    assert(n < RAD_MOST_PASSES);
    memmove(pass + 1, pass, n * sizeof *pass);
    pass[0] = (struct rad_pass){ .tiles = 0 };
    return n + 1;
}
