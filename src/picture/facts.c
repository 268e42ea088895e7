/* facts.c - see facts.h
 *
 * Each pixel has a state byte.  A thread that puts a pixel changes EMPTY to
 * BUSY by compare and swap, so one thread alone writes it; its store of KNOWN
 * pairs with the load in rad_facts_get().  BUSY lasts for a copy, not for a
 * trace; a BUSY pixel counts as unknown. */
#include "config.h"

#include "picture/facts.h"
#include "base/error.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* States of a pixel, or'ed with its origin.  USED is KNOWN with a further bit;
 * DOUBLED: a fact made here also came from another worker. */
enum {
    EMPTY = 0,
    KNOWN = 2,
    USED = KNOWN | RAD_FACT_USED,
    BUSY = 16,
    DOUBLED = 32
};

struct rad_facts {
    int width, rows;           /* [fixed] */
    _Atomic(uint8_t) *state;   /* [atomic] */
    struct rad_pixel *pixels;  /* each is written while its state is BUSY */
    _Atomic(size_t) made_here; /* [atomic] relaxed: a hint that facts are new */
    _Atomic(size_t) made_late; /* [atomic] relaxed: see rad_facts_late() */
    uint8_t *given;            /* [exporter] bitmap of facts exported */
    size_t ngiven;             /* [exporter] their number */
};

struct rad_facts *
rad_facts_new(int width, int rows)
{
    struct rad_facts *f = calloc(1, sizeof *f);
    size_t n = (size_t)width * (size_t)rows;

    if (!f)
        return NULL;
    f->width = width;
    f->rows = rows;
    f->state = calloc(n, sizeof *f->state);
    f->pixels = malloc(n * sizeof *f->pixels);
    f->given = calloc((size_t)rows, rad_facts_stride(width));
    if (!f->state || !f->pixels || !f->given) {
        rad_facts_free(f);
        return NULL;
    }
    return f;
}

void
rad_facts_free(struct rad_facts *f)
{
    if (!f)
        return;
    free((void *)f->state);
    free(f->pixels);
    free(f->given);
    free(f);
}

int
rad_facts_rows(const struct rad_facts *f)
{
    return f->rows;
}

static size_t
at(const struct rad_facts *f, int x, int row)
{
    return (size_t)row * (size_t)f->width + (size_t)x;
}

bool
rad_facts_get(const struct rad_facts *f, int x, int row, struct rad_pixel *out)
{
    size_t i = at(f, x, row);

    if (!(atomic_load_explicit(&f->state[i], memory_order_acquire) & KNOWN))
        return false;
    *out = f->pixels[i];
    return true;
}

/* Of a known pixel's state only RAD_FACT_USED changes (and DOUBLED, which only
 * serves a count), so a plain store is enough; an exchange costs ten times as
 * much. */
bool
rad_facts_use(struct rad_facts *f, int x, int row, struct rad_pixel *out)
{
    size_t i = at(f, x, row);
    uint8_t s = atomic_load_explicit(&f->state[i], memory_order_acquire);

    if (!(s & KNOWN))
        return false;
    *out = f->pixels[i];
    /* release, for threads that load this store and not the store of
     * rad_facts_put() */
    atomic_store_explicit(&f->state[i], s | RAD_FACT_USED,
                          memory_order_release);
    return true;
}

bool
rad_facts_put(struct rad_facts *f, int x, int row, const struct rad_pixel *p,
              unsigned origin)
{
    const unsigned elsewhere = RAD_FACT_FOREIGN | RAD_FACT_ESTIMATE;
    size_t i = at(f, x, row);
    uint8_t s = EMPTY;

    if (!atomic_compare_exchange_strong_explicit(&f->state[i], &s, BUSY,
                                                 memory_order_relaxed,
                                                 memory_order_relaxed)) {
        if (!(origin & elsewhere))
            atomic_fetch_add_explicit(&f->made_late, 1, memory_order_relaxed);
        return false;
    }
    f->pixels[i] = *p;
    atomic_store_explicit(&f->state[i], (uint8_t)(KNOWN | origin),
                          memory_order_release);
    if (!(origin & RAD_FACT_FOREIGN))
        atomic_fetch_add_explicit(&f->made_here, 1, memory_order_relaxed);
    return true;
}

static unsigned
state_of(const struct rad_facts *f, size_t i)
{
    return atomic_load_explicit(&f->state[i], memory_order_relaxed);
}

size_t
rad_facts_unused(const struct rad_facts *f)
{
    size_t n = at(f, 0, f->rows), unused = 0;

    for (size_t i = 0; i < n; i++)
        unused += (state_of(f, i) & (USED | RAD_FACT_ESTIMATE)) == KNOWN;
    return unused;
}

size_t
rad_facts_fresh(const struct rad_facts *f)
{
    return atomic_load_explicit(&f->made_here, memory_order_relaxed) -
           f->ngiven;
}

size_t
rad_facts_stride(int width)
{
    return ((size_t)width + 7) / 8;
}

/* Is there a fact of this origin that was not exported? */
static bool
is_new(const struct rad_facts *f, int x, int row, unsigned origin)
{
    uint8_t s =
        atomic_load_explicit(&f->state[at(f, x, row)], memory_order_acquire);
    size_t byte = (size_t)row * rad_facts_stride(f->width) + (size_t)x / 8;

    return (s & KNOWN) && !(s & RAD_FACT_FOREIGN) &&
           (s & RAD_FACT_ESTIMATE) == origin && !(f->given[byte] >> x % 8 & 1);
}

size_t
rad_facts_late(const struct rad_facts *f)
{
    return atomic_load_explicit(&f->made_late, memory_order_relaxed);
}

size_t
rad_facts_doubled(const struct rad_facts *f)
{
    size_t n = rad_facts_late(f);

    for (int row = 0; row < f->rows; row++)
        for (int x = 0; x < f->width; x++)
            n += state_of(f, at(f, x, row)) & DOUBLED && is_new(f, x, row, 0);
    return n;
}

static void
give(float *to, const struct rad_pixel *p, int channels)
{
    to[0] = p->L.r;
    to[1] = p->L.g;
    to[2] = p->L.b;
    if (channels == 4)
        to[3] = p->z;
}

size_t
rad_facts_export(struct rad_facts *f, const struct rad_fact_rows *of,
                 uint8_t *bitmap, float *pixels)
{
    size_t stride = rad_facts_stride(f->width), count = 0;

    memset(bitmap, 0, (size_t)of->n * stride);
    for (int k = 0; k < of->n; k++)
        for (int x = 0; x < f->width; x++) {
            uint8_t bit = (uint8_t)(1u << x % 8);

            if (!is_new(f, x, of->row + k, of->origin))
                continue;
            bitmap[(size_t)k * stride + (size_t)x / 8] |= bit;
            f->given[(size_t)(of->row + k) * stride + (size_t)x / 8] |= bit;
            give(pixels + count++ * (size_t)of->channels,
                 &f->pixels[at(f, x, of->row + k)], of->channels);
        }
    f->ngiven += count;
    return count;
}

void
rad_facts_settle(struct rad_facts *f)
{
    size_t stride = rad_facts_stride(f->width);

    atomic_store_explicit(&f->made_late, 0, memory_order_relaxed);
    for (int row = 0; row < f->rows; row++)
        for (int x = 0; x < f->width; x++)
            if (is_new(f, x, row, 0) || is_new(f, x, row, RAD_FACT_ESTIMATE)) {
                f->given[(size_t)row * stride + (size_t)x / 8] |=
                    (uint8_t)(1u << x % 8);
                f->ngiven++;
            }
}

static bool
bit_of(const uint8_t *bitmap, size_t stride, int row, int x)
{
    return bitmap[(size_t)row * stride + (size_t)x / 8] >> x % 8 & 1;
}

/* The number of bits set in len bytes, with those beyond the width. */
static size_t
count_bits(const uint8_t *bitmap, size_t len)
{
    size_t count = 0;

    for (size_t i = 0; i < len; i++)
        for (unsigned b = bitmap[i]; b; b &= b - 1)
            count++;
    return count;
}

static bool
bits_beyond(const struct rad_facts *f, int n, const uint8_t *bitmap)
{
    size_t stride = rad_facts_stride(f->width);

    for (int k = 0; k < n && f->width % 8 != 0; k++)
        if (bitmap[(size_t)(k + 1) * stride - 1] >> f->width % 8)
            return true;
    return false;
}

/* Read a pixel that another worker sent; false: its values are not sound. */
static bool
take(const float *from, int channels, struct rad_pixel *p)
{
    p->L = rad_rgb(from[0], from[1], from[2]);
    p->z = channels == 4 ? from[3] : 0;
    return rad_rgb_sound(p->L) && !isnan(p->z);
}

/* Put another worker's pixel, or mark the fact DOUBLED if it was made here.
 * rad_facts_use() in another thread may overwrite the mark; a count that is too
 * low by one is no harm. */
static void
put_foreign(struct rad_facts *f, int x, int row, const struct rad_pixel *p,
            unsigned origin)
{
    const unsigned mask = KNOWN | RAD_FACT_FOREIGN | RAD_FACT_ESTIMATE;
    size_t i = at(f, x, row);

    if (rad_facts_put(f, x, row, p, origin) || origin & RAD_FACT_ESTIMATE)
        return;
    if ((state_of(f, i) & mask) == KNOWN)
        atomic_fetch_or_explicit(&f->state[i], DOUBLED, memory_order_relaxed);
}

int
rad_facts_import(struct rad_facts *f, const struct rad_fact_rows *of,
                 const uint8_t *bitmap, const float *pixels, size_t npixels)
{
    size_t stride = rad_facts_stride(f->width), count = 0;
    int row = of->row, n = of->n, channels = of->channels;
    struct rad_pixel p;

    if (row < 0 || n < 0 || row > f->rows || n > f->rows - row ||
        (channels != 3 && channels != 4) || bits_beyond(f, n, bitmap) ||
        count_bits(bitmap, (size_t)n * stride) != npixels)
        return RAD_EPROTO;
    for (int k = 0; k < n; k++)
        for (int x = 0; x < f->width; x++)
            if (bit_of(bitmap, stride, k, x) &&
                take(pixels + count++ * (size_t)channels, channels, &p))
                put_foreign(f, x, row + k, &p, of->origin);
    return 0;
}
