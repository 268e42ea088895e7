/* codec.c - see codec.h */
#include "config.h"

#include "codec.h"

#include <assert.h>
#include <stdlib.h>

void
msg_put_job(struct wire_out *o, const uint8_t *job)
{
    static const uint8_t none[MSG_JOB];

    wire_put_bytes(o, job ? job : none, MSG_JOB);
}

void
msg_put_hash(struct wire_out *o, const uint8_t *hash)
{
    static const uint8_t none[MSG_HASH];

    wire_put_bytes(o, hash ? hash : none, MSG_HASH);
}

void
msg_put_must(struct wire_out *o, bool cond)
{
    if (!cond)
        o->bad = true;
}

void
msg_must(struct wire_in *in, bool cond)
{
    if (!cond)
        in->bad = true;
}

uint8_t
msg_get_below(struct wire_in *in, uint8_t n)
{
    uint8_t v = wire_get_u8(in);

    msg_must(in, v < n);
    return v;
}

void
msg_put_faults(struct wire_out *o, const struct msg_fault faults[MSG_FAULTS])
{
    for (int i = 0; i < MSG_FAULTS; i++) {
        wire_put_u32(o, faults[i].object);
        wire_put_u64(o, faults[i].count);
    }
}

/* Rising, and none behind the end. */
void
msg_get_faults(struct wire_in *in, struct msg_fault faults[MSG_FAULTS])
{
    for (int i = 0; i < MSG_FAULTS; i++) {
        struct msg_fault *f = &faults[i];

        f->object = wire_get_u32(in);
        f->count = wire_get_u64(in);
        if (f->count == 0)
            msg_must(in, f->object == 0);
        else if (i > 0)
            msg_must(in, f[-1].count > 0 && f[-1].object < f->object);
    }
}

static void
put_doubt(struct wire_out *o, const struct msg_doubt *d)
{
    wire_put_f64(o, d->pixels);
    wire_put_f64(o, d->variance);
    wire_put_f64(o, d->known);
    wire_put_f64(o, d->all);
    wire_put_f64(o, d->rough);
    wire_put_f64(o, d->nrough);
}

void
msg_put_counts(struct wire_out *o, const struct msg_counts *c)
{
    assert(o->version >= MSG_VERSION_MIN);
    wire_put_u64(o, c->rays);
    wire_put_u64(o, c->primary_rays);
    wire_put_u64(o, c->speculative_rays);
    wire_put_u64(o, c->shadow_rays);
    wire_put_u64(o, c->ambient_rays);
    wire_put_u64(o, c->paint_rays);
    wire_put_u64(o, c->estimate_rays);
    wire_put_u64(o, c->intersection_tests);
    wire_put_u64(o, c->ambient_values);
    wire_put_u64(o, c->nan.pixels);
    wire_put_u32(o, c->nan.x);
    wire_put_u32(o, c->nan.y);
    msg_put_faults(o, c->faults);
    wire_put_f64(o, c->cpu_s);
    wire_put_f64(o, c->wall_s);
    if (o->version >= 2)
        put_doubt(o, &c->doubt);
}

/* A sum of squares: nothing that a sum of others would not survive. */
static double
get_sum(struct wire_in *in)
{
    double v = wire_get_f64(in);

    if (!(v >= 0 && v < 1e100))
        in->bad = true;
    return v;
}

static void
get_doubt(struct wire_in *in, struct msg_doubt *d)
{
    d->pixels = get_sum(in);
    d->variance = get_sum(in);
    d->known = get_sum(in);
    d->all = get_sum(in);
    d->rough = get_sum(in);
    d->nrough = get_sum(in);
}

void
msg_get_counts(struct wire_in *in, struct msg_counts *c)
{
    assert(in->version >= MSG_VERSION_MIN);
    c->rays = wire_get_u64(in);
    c->primary_rays = wire_get_u64(in);
    c->speculative_rays = wire_get_u64(in);
    c->shadow_rays = wire_get_u64(in);
    c->ambient_rays = wire_get_u64(in);
    c->paint_rays = wire_get_u64(in);
    c->estimate_rays = wire_get_u64(in);
    c->intersection_tests = wire_get_u64(in);
    c->ambient_values = wire_get_u64(in);
    c->nan.pixels = wire_get_u64(in);
    c->nan.frame = 0;
    c->nan.x = wire_get_u32(in);
    c->nan.y = wire_get_u32(in);
    msg_get_faults(in, c->faults);
    c->cpu_s = wire_get_f64(in);
    c->wall_s = wire_get_f64(in);
    c->doubt = (struct msg_doubt){ 0 };
    if (in->version >= 2)
        get_doubt(in, &c->doubt);
    msg_must(in, c->cpu_s >= 0 && c->wall_s >= 0);
}

void *
msg_list_room(struct msg *m, struct wire_in *in, size_t n, size_t entry)
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
