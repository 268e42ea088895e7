/* ambseen.c - see ambseen.h
 *
 * A hash table, at most half full; the numbers are evenly spread already.  A
 * number whose slot is taken goes to the next free one. */
#include "config.h"

#include "worker/ambseen.h"

#include "proto/ambshare.h"

#include <stdlib.h>
#include <string.h>

#define FEWEST 1024
#define MORE   4 /* growth factor: filling a table anew costs more than room */

/* The finalizer of SplitMix64 (Steele, Lea & Flood 2014). */
static uint64_t
mix(uint64_t x)
{
    x ^= x >> 30;
    x *= UINT64_C(0xbf58476d1ce4e5b9);
    x ^= x >> 27;
    x *= UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

/* A hash of the record's place, irradiance and radii, never 0.  Two records
 * that differ only in the direction that they face, as on both sides of a sheet
 * in even light, count as one: the second is made again. */
static uint64_t
number_of(const uint8_t *record)
{
    static const uint8_t from[] = { 0, 8, 16, 56, AMBSHARE_BYTES - 8 };
    uint64_t h = 0, word;

    for (size_t i = 0; i < sizeof from; i++) {
        memcpy(&word, record + from[i], sizeof word);
        h = (h ^ word) * UINT64_C(0x9e3779b97f4a7c15);
        h ^= h >> 32;
    }
    h = mix(h);
    return h ? h : 1;
}

/* The slot that holds the number, or the free one where it belongs. */
static uint64_t *
find(const struct ambseen *s, uint64_t number)
{
    size_t i = (size_t)number & (s->nslots - 1);

    while (s->slot[i] != 0 && s->slot[i] != number)
        i = (i + 1) & (s->nslots - 1);
    return &s->slot[i];
}

static bool
grow(struct ambseen *s)
{
    struct ambseen more = { .nslots = s->nslots ? MORE * s->nslots : FEWEST,
                            .n = s->n };

    more.slot = calloc(more.nslots, sizeof *more.slot);
    if (!more.slot)
        return false;
    for (size_t i = 0; i < s->nslots; i++)
        if (s->slot[i] != 0)
            *find(&more, s->slot[i]) = s->slot[i];
    free(s->slot);
    *s = more;
    return true;
}

bool
ambseen_add(struct ambseen *s, const uint8_t *record)
{
    uint64_t number = number_of(record), *at;

    if (2 * (s->n + 1) > s->nslots && !grow(s))
        return true;
    at = find(s, number);
    if (*at == number)
        return false;
    *at = number;
    s->n++;
    return true;
}

void
ambseen_release(struct ambseen *s)
{
    free(s->slot);
    *s = (struct ambseen){ 0 };
}
