/* passplan.c - see passplan.h
 *
 * Few paths tell of the large zones, and each further round of them, four times
 * as many, of smaller ones.
 * The last lattice is every second pixel: between them records serve that are a
 * little too far, for what is asked of every pixel takes longer than it
 * saves. */
#include "config.h"

#include "picture/passplan.h"

/* Paths: one for so many pixels, within these bounds. */
#define PIXELS_A_PATH 64
#define LEAST_PATHS   256
#define MOST_PATHS    65536

#define ROUND_GROWTH 4   /* paths of a round over all before it */
#define TILE_PATHS   512 /* at most, of a tile */
#define COARSEST     32  /* lattice [pixels] */
#define FINEST       2

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

/* The rounds for records of that level. */
static uint32_t
plan_level(int level, uint32_t paths, struct rad_pass *pass)
{
    uint32_t n = 0, first = 0, end = paths;

    while (end / ROUND_GROWTH >= LEAST_PATHS)
        end /= ROUND_GROWTH;
    for (; first < paths; n++) {
        uint32_t count = end - first;

        pass[n] =
            (struct rad_pass){ .level = level,
                               .first = first,
                               .end = end,
                               .tiles = (count + TILE_PATHS - 1) / TILE_PATHS };
        first = end;
        end = end > paths / ROUND_GROWTH ? paths : ROUND_GROWTH * end;
    }
    return n;
}

static uint32_t
plan_pixels(const struct rad_pass_size *size, uint32_t nsizes,
            struct rad_pass *pass)
{
    uint32_t n = 0;

    for (int step = COARSEST, done = 0; step >= FINEST;
         done = step, step /= 2) {
        uint32_t tiles = 0;

        for (uint32_t i = 0; i < nsizes; i++)
            tiles += rad_pass_tiles(size[i].width, size[i].height, step);
        pass[n++] =
            (struct rad_pass){ .step = step, .done = done, .tiles = tiles };
    }
    return n;
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
    return n + plan_pixels(size, nsizes, pass + n);
}
