/* known.c - see known.h
 *
 * Hashes are evenly spread, so a hash's first bytes choose its slot; if that is
 * taken the hash goes into the next free slot.  A file leaves the table only
 * when the table is made anew without it. */
#include "config.h"

#include "users/known.h"

#include <stdlib.h>
#include <string.h>

#define LEAST_SLOTS 64
#define LONG_MS     (UINT64_C(24) * 3600 * 1000)

struct known_file {
    uint8_t hash[MSG_HASH];
    bool used;
    uint32_t jobs;    /* jobs that have the file */
    uint64_t last_ms; /* when the file was last sent or offered, or left by a
                       * job */
};

void
known_release(struct known *k)
{
    free(k->slots);
    memset(k, 0, sizeof *k);
}

/* The file's slot, or the free slot where it belongs; NULL: the table has no
 * slots. */
static struct known_file *
slot_of(const struct known *k, const uint8_t *hash)
{
    uint64_t at;

    if (k->nslots == 0)
        return NULL;
    memcpy(&at, hash, sizeof at);
    for (;; at++) {
        struct known_file *f = &k->slots[at & (k->nslots - 1)];

        if (!f->used || memcmp(f->hash, hash, MSG_HASH) == 0)
            return f;
    }
}

/* Make the table anew with room for n files, without the files that no job has
 * and whose last_ms is before since_ms.  False: memory is out, and nothing has
 * changed. */
static bool
rebuild(struct known *k, size_t n, uint64_t since_ms)
{
    struct known fresh = { .nslots = LEAST_SLOTS };

    while (fresh.nslots < 2 * n)
        fresh.nslots *= 2;
    fresh.slots = calloc(fresh.nslots, sizeof *fresh.slots);
    if (!fresh.slots)
        return false;
    for (size_t i = 0; i < k->nslots; i++) {
        const struct known_file *f = &k->slots[i];

        if (!f->used || (f->jobs == 0 && f->last_ms < since_ms))
            continue;
        *slot_of(&fresh, f->hash) = *f;
        fresh.n++;
        fresh.nfree += f->jobs == 0;
    }
    free(k->slots);
    *k = fresh;
    return true;
}

/* The file's slot, filled if the file is new; NULL: memory is out. */
static struct known_file *
put(struct known *k, const uint8_t *hash)
{
    struct known_file *f;

    if (2 * (k->n + 1) > k->nslots && !rebuild(k, 2 * (k->n + 1), 0))
        return NULL;
    f = slot_of(k, hash);
    if (f->used)
        return f;
    memcpy(f->hash, hash, MSG_HASH);
    f->used = true;
    k->n++;
    k->nfree++;
    return f;
}

bool
known_has(const struct known *k, const uint8_t hash[MSG_HASH])
{
    const struct known_file *f = slot_of(k, hash);

    return f && f->used;
}

/* Forget files that no job has, the oldest first, until KNOWN_MOST / 2 are left
 * or the rest came just now.  Half, so that this is done seldom. */
static void
drop_oldest(struct known *k, uint64_t now_ms)
{
    for (uint64_t age = LONG_MS; k->nfree > KNOWN_MOST / 2; age /= 2) {
        if (!rebuild(k, k->n, now_ms > age ? now_ms - age + 1 : 1))
            return;
        if (age == 0)
            return; /* all that are left came just now */
    }
}

bool
known_sent(struct known *k, uint64_t now_ms, const uint8_t hash[MSG_HASH])
{
    struct known_file *f = put(k, hash);

    if (!f)
        return false;
    f->last_ms = now_ms;
    if (k->nfree > KNOWN_MOST)
        drop_oldest(k, now_ms);
    return true;
}

bool
known_name(struct known *k, const struct msg_hashes *files)
{
    for (uint32_t i = 0; i < files->n; i++) {
        struct known_file *f = put(k, files->hash + (size_t)i * MSG_HASH);

        if (!f)
            return false;
        k->nfree -= f->jobs == 0;
        f->jobs++;
    }
    return true;
}

void
known_unname(struct known *k, uint64_t now_ms, const struct msg_hashes *files)
{
    for (uint32_t i = 0; i < files->n; i++) {
        struct known_file *f = slot_of(k, files->hash + (size_t)i * MSG_HASH);

        if (!f || !f->used || f->jobs == 0)
            continue; /* memory was out in known_name() */
        f->jobs--;
        f->last_ms = now_ms;
        k->nfree += f->jobs == 0;
    }
    if (k->nfree > KNOWN_MOST)
        drop_oldest(k, now_ms);
}

size_t
known_free(const struct known *k, uint64_t since_ms, uint8_t *hashes)
{
    size_t n = 0;

    for (size_t i = 0; i < k->nslots; i++) {
        const struct known_file *f = &k->slots[i];

        if (f->used && f->jobs == 0 && f->last_ms >= since_ms)
            memcpy(hashes + n++ * MSG_HASH, f->hash, MSG_HASH);
    }
    return n;
}

void
known_expire(struct known *k, uint64_t since_ms)
{
    if (k->nfree > 0)
        rebuild(k, k->n, since_ms);
}
