/* coarse.c - see coarse.h */
#include "config.h"

#include "folder/coarse.h"

#include "image/hdr.h"

#include <stdlib.h>
#include <string.h>

enum {
    FINEST = 8, /* step of the lattice that is kept [pixels] */
    COARSEST = 256
};

enum known {
    UNKNOWN,
    GUESSED, /* from coarser lattices */
    SEEN     /* a tile told the colour */
};

/* Colours times their weights, and the sum of these weights. */
struct mix {
    struct rad_rgb L;
    double weight;
};

struct coarse {
    int width, height; /* of the picture */
    int nx, ny;        /* of the lattice */
    uint8_t (*rgbe)[4];
    uint8_t *known;   /* enum known */
    uint8_t *came;    /* a bit for each pixel of the picture */
    struct mix *line; /* a row of the picture at each column of the lattice;
                       * room to work in */
    bool stale;       /* colours came since the last guess() */
};

static int
points(int side)
{
    return (side - 1) / FINEST + 1;
}

size_t
coarse_bytes(int width, int height)
{
    size_t nx = (size_t)points(width), n = nx * (size_t)points(height);

    return sizeof(struct coarse) + 5 * n + nx * sizeof(struct mix) +
           (size_t)width * (size_t)height / 8 + 1;
}

void
coarse_free(struct coarse *c)
{
    if (!c)
        return;
    free(c->rgbe);
    free(c->known);
    free(c->came);
    free(c->line);
    free(c);
}

struct coarse *
coarse_new(int width, int height)
{
    struct coarse *c = calloc(1, sizeof *c);
    size_t n;

    if (!c)
        return NULL;
    c->width = width;
    c->height = height;
    c->nx = points(width);
    c->ny = points(height);
    n = (size_t)c->nx * (size_t)c->ny;
    c->rgbe = calloc(n, sizeof *c->rgbe);
    c->known = calloc(n, 1);
    c->came = calloc((size_t)width * (size_t)height / 8 + 1, 1);
    c->line = calloc((size_t)c->nx, sizeof *c->line);
    if (c->rgbe && c->known && c->came && c->line)
        return c;
    coarse_free(c);
    return NULL;
}

static size_t
point_at(const struct coarse *c, int i, int j)
{
    return (size_t)j * (size_t)c->nx + (size_t)i;
}

/* Do n pixels, step apart from `at` on, lie on the lattice and along a side of
 * that length? */
static bool
fits(int at, int step, int n, int length)
{
    return at >= 0 && at < length && at % step == 0 && n >= 1 &&
           n <= (length - 1 - at) / step + 1;
}

bool
coarse_put(struct coarse *c, const struct action_colours *k)
{
    const uint8_t *from = k->rgbe;

    if (k->step < FINEST || k->step > COARSEST || k->step % FINEST != 0 ||
        !fits(k->x, k->step, k->columns, c->width) ||
        !fits(k->y, k->step, k->rows, c->height))
        return false;
    for (int j = 0; j < k->rows; j++)
        for (int i = 0; i < k->columns; i++, from += 4) {
            size_t at = point_at(c, (k->x + i * k->step) / FINEST,
                                 (k->y + j * k->step) / FINEST);

            memcpy(c->rgbe[at], from, 4);
            c->known[at] = SEEN;
        }
    c->stale = true;
    return true;
}

/* --- pixels that have come --- */

static size_t
bit_of(const struct coarse *c, int x, int y)
{
    return (size_t)y * (size_t)c->width + (size_t)x;
}

void
coarse_mark(struct coarse *c, int x, int y, int width, int height)
{
    for (int j = y; j < y + height; j++)
        for (int i = x; i < x + width; i++) {
            size_t bit = bit_of(c, i, j);

            c->came[bit / 8] |= (uint8_t)(1 << bit % 8);
        }
}

/* --- guesses --- */

static void
add(const struct coarse *c, int i, int j, double weight, struct mix *to)
{
    size_t at = point_at(c, i, j);

    if (c->known[at] == UNKNOWN)
        return;
    to->L = rad_rgb_add(
        to->L, rad_rgb_scale(rad_rgbe_radiance(c->rgbe[at]), (float)weight));
    to->weight += weight;
}

/* Guess a point as the mean of its neighbours in the lattice of points `apart`,
 * as far as these are known. */
static void
guess_point(struct coarse *c, int i, int j, int apart)
{
    int i0 = i - i % apart, i1 = i % apart ? i0 + apart : i0;
    int j0 = j - j % apart, j1 = j % apart ? j0 + apart : j0;
    size_t at = point_at(c, i, j);
    struct mix m = { 0 };

    for (int l = j0; l <= j1 && l < c->ny; l += apart)
        for (int k = i0; k <= i1 && k < c->nx; k += apart)
            add(c, k, l, 1, &m);
    c->known[at] = m.weight > 0 ? GUESSED : UNKNOWN;
    if (m.weight > 0)
        rad_rgbe(rad_rgb_scale(m.L, (float)(1 / m.weight)), c->rgbe[at]);
}

/* Guess the points of each lattice from the next coarser lattice. */
static void
guess(struct coarse *c)
{
    for (int apart = COARSEST / FINEST; apart > 1; apart /= 2)
        for (int j = 0; j < c->ny; j += apart / 2)
            for (int i = 0; i < c->nx; i += apart / 2)
                if ((i % apart != 0 || j % apart != 0) &&
                    c->known[point_at(c, i, j)] != SEEN)
                    guess_point(c, i, j, apart);
    c->stale = false;
}

/* --- a row --- */

/* Set c->line for row y, from the lattice's rows above and below it. */
static void
mix_line(struct coarse *c, int y)
{
    int j0 = y / FINEST, j1 = j0 + 1 < c->ny ? j0 + 1 : j0;
    double f = (double)(y % FINEST) / FINEST;

    for (int i = 0; i < c->nx; i++) {
        c->line[i] = (struct mix){ 0 };
        add(c, i, j0, 1 - f, &c->line[i]);
        add(c, i, j1, f, &c->line[i]);
    }
}

static void
fill_pixel(const struct coarse *c, int x, uint8_t rgbe[4])
{
    int i0 = x / FINEST, i1 = i0 + 1 < c->nx ? i0 + 1 : i0;
    const struct mix *a = &c->line[i0], *b = &c->line[i1];
    double f = (double)(x % FINEST) / FINEST;
    double weight = (1 - f) * a->weight + f * b->weight;

    if (weight > 0)
        rad_rgbe(rad_rgb_scale(rad_rgb_add(rad_rgb_scale(a->L, (float)(1 - f)),
                                           rad_rgb_scale(b->L, (float)f)),
                               (float)(1 / weight)),
                 rgbe);
}

void
coarse_fill(struct coarse *c, int y, uint8_t *rgbe)
{
    bool mixed = false;

    if (c->stale)
        guess(c);
    for (int x = 0; x < c->width; x++) {
        size_t bit = bit_of(c, x, y);

        if (c->came[bit / 8] & 1 << bit % 8)
            continue;
        if (!mixed)
            mix_line(c, y);
        mixed = true;
        fill_pixel(c, x, rgbe + 4 * (size_t)x);
    }
}
