/* estimate.c - see estimate.h
 *
 * The order is a permutation that is computed, not stored, so it needs no
 * memory even for a part of 2^32 - 1 pixels.  A few rounds permute the numbers
 * of k bits; a number that comes out beyond the part's pixels goes through the
 * rounds again (cycle walking).  k is the least possible, so at most every
 * second number does. */
#include "config.h"

#include "picture/estimate.h"
#include "base/rng.h"

#include <stdatomic.h>
#include <stdlib.h>

/* With this many rounds the step from one pixel to the next looks random;
 * check_estimate still finds a pattern after three. */
#define ROUNDS 4

/* Keeps these keys apart from those of pixels, which have a frame's number in
 * this place. */
#define BRANCH UINT64_C(0x657374696d617465)

/* A permutation of the numbers of `bits` bits: each step can be undone. */
static uint64_t
scramble(uint64_t i, uint64_t key, unsigned bits)
{
    uint64_t mask = (UINT64_C(1) << bits) - 1;

    for (unsigned round = 0; round < ROUNDS; round++) {
        uint64_t k = rad_key_branch(key, round);

        i = i * (k | 1) & mask;
        i ^= i >> (bits + 1) / 2;
        i = (i + (k >> 32)) & mask;
    }
    return i;
}

static unsigned
bits_of(uint64_t most)
{
    unsigned bits = 1;

    while (most >> bits)
        bits++;
    return bits;
}

void
rad_estimate_pixel(uint64_t seed, uint32_t frame, const struct rad_window *part,
                   uint32_t i, int *x, int *y)
{
    uint64_t n = (uint64_t)part->width * (uint64_t)part->height, at = i;
    uint64_t key = rad_key_branch(rad_mix64(seed) ^ BRANCH, frame);
    unsigned bits = bits_of(n - 1);

    key = rad_key_branch(key, (uint64_t)part->y << 32 | (uint32_t)part->x);
    key = rad_key_branch(key, n);
    do
        at = scramble(at, key, bits);
    while (at >= n);
    *x = part->x + (int)(at % (uint64_t)part->width);
    *y = part->y + (int)(at / (uint64_t)part->width);
}

static int
by_place(const void *a, const void *b)
{
    const struct rad_sampled *p = a, *q = b;

    if (p->y != q->y)
        return p->y < q->y ? -1 : 1;
    return p->x < q->x ? -1 : p->x > q->x;
}

void
rad_estimate_sort(struct rad_sampled *v, size_t n)
{
    if (n > 0)
        qsort(v, n, sizeof *v, by_place);
}

size_t
rad_estimate_trace(const struct rad_frame *f, struct rad_ctx *ctx,
                   const struct rad_estimate_order *order,
                   struct rad_estimate *cost, struct rad_sampled *out)
{
    const struct rad_window *part = &order->part;
    uint64_t pixels = (uint64_t)part->width * (uint64_t)part->height;
    uint64_t rays = ctx->counts.rays, tests = ctx->counts.geom.tests;
    uint64_t end = (uint64_t)order->first + order->n;
    size_t shown = 0;

    for (uint64_t i = order->first; i < end && i < pixels; i++) {
        struct rad_sampled *s = &out[shown];
        uint64_t primary = ctx->counts.primary_rays;

        if (order->stop &&
            atomic_load_explicit(order->stop, memory_order_relaxed))
            break;
        rad_estimate_pixel(f->job->params.seed, f->number, part, (uint32_t)i,
                           &s->x, &s->y);
        rad_frame_pixel(f, ctx, s->x, s->y, &s->pixel);
        shown += ctx->counts.primary_rays != primary;
    }
    cost->rays += ctx->counts.rays - rays;
    cost->tests += ctx->counts.geom.tests - tests;
    return shown;
}
