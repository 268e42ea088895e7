/* codec.c - see codec.h */
#include "config.h"

#include "proto/codec.h"

#include <assert.h>
#include <stdlib.h>
#include <sysexits.h>

bool
code_bad(const struct codec *c)
{
    return c->out ? c->out->bad : c->in->bad;
}

void
code_must(struct codec *c, bool cond)
{
    if (!cond)
        *(c->out ? &c->out->bad : &c->in->bad) = true;
}

void
code_read_must(struct codec *c, bool cond)
{
    if (c->in)
        code_must(c, cond);
}

/* --- one field --- */

#define FIELD(name, type)                                                      \
    void code_##name(struct codec *c, type *v)                                 \
    {                                                                          \
        if (c->out)                                                            \
            wire_put_##name(c->out, *v);                                       \
        else                                                                   \
            *v = wire_get_##name(c->in);                                       \
    }

FIELD(u8, uint8_t)
FIELD(u16, uint16_t)
FIELD(u32, uint32_t)
FIELD(u64, uint64_t)
FIELD(i32, int32_t)
FIELD(f64, double)

void
code_amount(struct codec *c, double *v)
{
    code_f64(c, v);
    code_read_must(c, *v >= 0 && *v < 1e100);
}

void
code_failure(struct codec *c, uint16_t *v)
{
    code_u16(c, v);
    code_read_must(c, *v >= EX__BASE && *v <= EX__MAX);
}

void
code_below(struct codec *c, uint8_t *v, uint8_t n)
{
    code_u8(c, v);
    code_must(c, *v < n);
}

void
code_view(struct codec *c, const uint8_t **v, size_t n)
{
    if (c->out)
        wire_put_bytes(c->out, *v, n);
    else
        *v = wire_get_view(c->in, n);
}

void
code_str(struct codec *c, const char **v, size_t max)
{
    if (c->out)
        wire_put_str(c->out, *v, max);
    else
        *v = wire_get_str(c->in, max);
}

void
code_blob(struct codec *c, const uint8_t **v, size_t *n, size_t max)
{
    if (c->out)
        wire_put_blob(c->out, *v, *n, max);
    else
        *v = wire_get_blob(c->in, max, n);
}

void
code_job(struct codec *c, const uint8_t **job)
{
    static const uint8_t none[MSG_JOB];

    if (!*job)
        *job = none;
    code_view(c, job, MSG_JOB);
}

void
code_hash(struct codec *c, const uint8_t **hash)
{
    static const uint8_t none[MSG_HASH];

    if (!*hash)
        *hash = none;
    code_view(c, hash, MSG_HASH);
}

void
code_attempt(struct codec *c, const uint8_t **job, uint32_t *unit,
             uint32_t *attempt)
{
    code_job(c, job);
    code_u32(c, unit);
    code_u32(c, attempt);
}

/* --- lists --- */

void
code_count(struct codec *c, uint32_t *n, size_t least, uint32_t max)
{
    if (!c->out) {
        *n = wire_get_count(c->in, least, max);
        return;
    }
    code_must(c, *n <= max);
    if (c->out->bad)
        *n = 0;
    wire_put_u32(c->out, *n);
}

/* Room for n entries in the message's own list.  NULL if n is 0, or if memory
 * is out, which sets bad.  The caller has checked n against the payload, so a
 * peer cannot make this large. */
static void *
list_room(struct msg *m, struct wire_in *in, size_t n, size_t entry)
{
    if (n == 0)
        return NULL;
    if (m->list_size < n * entry) {
        void *p = realloc(m->list, n * entry);

        if (!p) {
            in->bad = in->nomem = true;
            return NULL;
        }
        m->list = p;
        m->list_size = n * entry;
    }
    return m->list;
}

void *
code_list(struct codec *c, const void *list, uint32_t *n, size_t least,
          uint32_t max, size_t entry)
{
    void *room;

    code_count(c, n, least, max);
    if (c->out)
        return (void *)list;
    room = list_room(c->m, c->in, *n, entry);
    if (!room)
        *n = 0;
    return room;
}

/* --- counts --- */

/* Do the faults' objects rise, and is there none behind a count of 0? */
static bool
faults_fit(const struct msg_fault faults[MSG_FAULTS])
{
    for (int i = 0; i < MSG_FAULTS; i++) {
        const struct msg_fault *f = &faults[i];

        if (f->count == 0
                ? f->object != 0
                : i > 0 && (f[-1].count == 0 || f[-1].object >= f->object))
            return false;
    }
    return true;
}

void
code_faults(struct codec *c, struct msg_fault faults[MSG_FAULTS])
{
    for (int i = 0; i < MSG_FAULTS; i++) {
        code_u32(c, &faults[i].object);
        code_u64(c, &faults[i].count);
    }
    code_read_must(c, faults_fit(faults));
}

static void
code_doubt(struct codec *c, struct msg_doubt *d)
{
    for (int i = 0; i < MSG_DOUBT_SUMS; i++) {
        code_f64(c, &d->v[i]);
        code_read_must(c, d->v[i] > -1e100 && d->v[i] < 1e100);
    }
}

void
code_counts(struct codec *c, struct msg_counts *counts)
{
    assert(c->version >= MSG_VERSION_MIN);
    code_u64(c, &counts->rays);
    code_u64(c, &counts->primary_rays);
    code_u64(c, &counts->speculative_rays);
    code_u64(c, &counts->shadow_rays);
    code_u64(c, &counts->ambient_rays);
    code_u64(c, &counts->paint_rays);
    code_u64(c, &counts->estimate_rays);
    code_u64(c, &counts->intersection_tests);
    code_u64(c, &counts->ambient_values);
    code_u64(c, &counts->nan.pixels);
    code_u32(c, &counts->nan.x);
    code_u32(c, &counts->nan.y);
    code_read_must(c, counts->nan.x <= MSG_MAX_SIDE &&
                          counts->nan.y <= MSG_MAX_SIDE);
    code_faults(c, counts->faults);
    code_amount(c, &counts->cpu_s);
    code_amount(c, &counts->wall_s);
    code_doubt(c, &counts->doubt);
}

void
msg_put_counts(struct wire_out *o, const struct msg_counts *counts)
{
    struct codec c = { .out = o, .version = o->version };
    struct msg_counts copy = *counts;

    code_counts(&c, &copy);
}

void
msg_get_counts(struct wire_in *in, struct msg_counts *counts)
{
    struct codec c = { .in = in, .version = in->version };

    *counts = (struct msg_counts){ 0 };
    code_counts(&c, counts);
}
