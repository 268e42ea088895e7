/* render_passes.c - the ambient cache of a job's child in passes: tiles that it
 * makes, and records of closed passes
 *
 * Messages about both come from the network, and are checked here. */
#include "config.h"

#include "child/render_impl.h"
#include "child/sandbox.h"
#include "machine/spots.h"
#include "proto/ambshare.h"
#include "refine/refine.h"

#include <stdlib.h>
#include <string.h>

static bool
plan(struct render *r)
{
    struct render_passes *k = &r->passes;
    struct rad_pass_size *size = malloc((r->nframes + 1) * sizeof *size);
    bool on = r->start.job_start.flags & MSG_JOB_REUSE && k->base == 0;
    struct rad_pass *fits;

    k->plan = malloc(RAD_MOST_PASSES * sizeof *k->plan);
    for (uint32_t i = 0; size && i < r->nframes; i++)
        size[i] =
            (struct rad_pass_size){ r->frames[i].width, r->frames[i].height };
    if (size && k->plan)
        k->n = rad_refine_plan(&r->job->params, size, r->nframes, on,
                               msg_has_goal(&r->start.job_start), k->plan);
    free(size);
    fits = k->plan ? realloc(k->plan, (k->n + 1) * sizeof *fits) : NULL;
    k->plan = fits ? fits : k->plan;
    return size && k->plan;
}

int
render_load_passes(struct render *r, struct rad_error *err)
{
    struct render_passes *k = &r->passes;

    k->next = 0;
    k->shown = false;
    if (!(r->start.job_start.flags & MSG_JOB_PASSES) || !r->job->ambient)
        return 0;
    if (!plan(r))
        return rad_fail_memory(err);
    if (k->n == 0)
        return 0;
    k->passes = rad_passes_new(r->frames, r->nframes, err);
    return k->passes ? 0 : err->code;
}

void
render_unload_passes(struct render *r)
{
    rad_passes_free(r->passes.passes);
    free(r->passes.plan);
    free(r->passes.rec);
    free(r->passes.walk);
    r->passes = (struct render_passes){ 0 };
}

static void
on_tile(void *arg, const struct pool_tile *t)
{
    struct render *r = arg;
    struct msg m = { .type = MSG_TILE_MADE,
                     .tile_made = { .job = r->id,
                                    .pass = r->passes.base + t->pass,
                                    .tile = t->tile,
                                    .counts = t->counts,
                                    .count = t->count,
                                    .data = t->records.buf,
                                    .len = t->records.len,
                                    .colours = t->colours.rgbe[0],
                                    .colours_len = 4 * t->colours.n } };

    if (r->link)
        conn_send(r->link, &m);
}

void
render_begin_passes(struct render *r)
{
    if (r->passes.passes)
        pool_set_passes(r->pool, r->passes.passes, r->passes.plan, r->passes.n,
                        on_tile);
}

bool
render_cache_is_whole(const struct render *r)
{
    return r->passes.next == r->passes.n;
}

bool
render_cache_serves(const struct render *r, uint32_t frame)
{
    const struct render_passes *k = &r->passes;

    return k->n == 0 ||
           (k->next > 0 && frame < rad_passes_ready(k->plan, k->next) &&
            frame >= rad_passes_ready(k->plan, k->next - 1));
}

uint32_t
render_first_batch(const struct render *r)
{
    const struct render_passes *k = &r->passes;
    uint32_t i = 0;

    while (i < k->n && k->plan[i].ready == 0)
        i++;
    return i < k->n ? k->plan[i].ready : r->nframes;
}

/* May the child be told to make tiles of that pass of the job? */
static bool
is_to_come(const struct render_passes *k, uint32_t pass)
{
    return k->passes && pass >= k->base + k->next && pass < k->base + k->n;
}

/* Is that pass of the job the next whose records are to come? */
static bool
is_next(const struct render_passes *k, uint32_t pass)
{
    return k->passes && k->next < k->n && pass == k->base + k->next;
}

void
render_take_tile(struct render *r, const struct msg_tile *m)
{
    const struct render_passes *k = &r->passes;
    struct rad_error err = { 0 };

    if (!is_to_come(k, m->pass) || m->tile >= k->plan[m->pass - k->base].tiles)
        rad_fail(&err, RAD_EPROTO, "tile %u of pass %u does not fit the job",
                 m->tile, m->pass);
    else if (!pool_push_tile(r->pool, m->pass - k->base, m->tile, m->colours))
        rad_fail_memory(&err);
    if (err.code)
        render_fail(r, &err);
}

/* --- records --- */

static int
add_records(struct render_passes *k, const struct msg_frozen *m,
            struct rad_error *err)
{
    size_t n = k->nrecs + m->count;
    struct wire_in in;
    struct rad_ambrec *rec = realloc(k->rec, (n + 1) * sizeof *rec);

    if (!rec)
        return rad_fail_memory(err);
    k->rec = rec;
    wire_in_init(&in, m->data, m->len);
    while (k->nrecs < n)
        if (!ambshare_unpack(&in, &k->rec[k->nrecs++]))
            return rad_fail(err, RAD_EPROTO, "no ambient record");
    return 0;
}

/* Keep the ends of a pass of paths as bytes: they are no records. */
static int
add_walk(struct render_passes *k, const struct msg_frozen *m,
         struct rad_error *err)
{
    size_t len = k->nrecs * AMBSHARE_BYTES;
    uint8_t *walk = realloc(k->walk, len + m->len + 1);

    if (!walk)
        return rad_fail_memory(err);
    k->walk = walk;
    if (m->len != (size_t)m->count * AMBSHARE_BYTES)
        return rad_fail(err, RAD_EPROTO, "no spots of paths");
    if (m->len > 0)
        memcpy(walk + len, m->data, m->len);
    k->nrecs += m->count;
    return 0;
}

/* All of the next pass has come: give it to the pool. */
static int
freeze(struct render *r, struct rad_error *err)
{
    struct render_passes *k = &r->passes;
    const struct rad_pass *pass = &k->plan[k->next];
    struct rad_pass_spot *spot = NULL;

    if (pass->walks && k->nrecs > 0 &&
        !(spot = spots_unpack(pass, k->walk, k->nrecs * AMBSHARE_BYTES, err)))
        return err->code;
    if (!pool_freeze(r->pool, k->rec, pass->walks ? 0 : k->nrecs, spot)) {
        free(spot);
        return rad_fail_memory(err);
    }
    free(k->walk);
    k->walk = NULL;
    k->rec = NULL;
    k->nrecs = 0;
    k->next++;
    return 0;
}

static int
take_frozen(struct render *r, const struct msg_frozen *m, struct rad_error *err)
{
    struct render_passes *k = &r->passes;
    int rc;

    if (m->first == 0) /* sent again, if the connection broke meanwhile */
        k->nrecs = 0;
    if (!is_next(k, m->pass) || m->first != k->nrecs)
        return rad_fail(err, RAD_EPROTO,
                        "records of pass %u do not fit the job", m->pass);
    rc = (k->plan[k->next].walks ? add_walk : add_records)(k, m, err);
    if (rc == 0 && m->last)
        rc = freeze(r, err);
    if (rc < 0 || !m->last)
        return rc;
    return msg_has_goal(&r->start.job_start) && render_cache_is_whole(r)
               ? sandbox_seal(r->sandboxed, err)
               : 0;
}

void
render_take_frozen(struct render *r, const struct msg_frozen *m)
{
    struct rad_error err = { 0 };

    if (take_frozen(r, m, &err) < 0)
        render_fail(r, &err);
}
