/* estimate.c - see estimate.h */
#include "config.h"

#include "pool/estimate.h"

#include "light/indirect/ambient.h"
#include "machine/counted.h"

#include "picture/estimate.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

enum { MOST_PASSES = 2 };

struct area {
    uint32_t frame; /* index */
    struct rad_window part;
    /* of each pass, by the thread that took the area; merge() puts all into the
     * first */
    struct rad_sampled *sampled[MOST_PASSES];
    size_t n[MOST_PASSES]; /* length of sampled */
};

struct estimate {
    const struct rad_frame *frames; /* [fixed] */
    uint32_t id, rays, nareas;      /* [fixed] */
    uint32_t passes;                /* [fixed]; costs are those of the last */
    struct area *areas;             /* [fixed]; each belongs to its thread */
    struct msg_cost *costs;         /* likewise */
    _Atomic uint32_t taken;         /* areas, summed over passes */
    struct msg_counts counts;       /* under the pool's lock */
    /* of estimate_facts(): the next area and pixel; the message */
    uint32_t at;
    size_t at_pixel;
    uint8_t *bitmap, *pixels;
    struct msg_facts facts;
};

static int
check_area(const struct rad_frame *frames, uint32_t nframes,
           const struct msg_area *a, struct rad_error *err)
{
    const struct rad_frame *f;

    if (a->frame >= nframes)
        return rad_fail(err, RAD_EPROTO, "estimate of frame %u, of %u",
                        a->frame, nframes);
    f = &frames[a->frame];
    if (a->width < 1 || a->height < 1 || a->width > (uint32_t)f->width ||
        a->height > (uint32_t)f->height ||
        a->x > (uint32_t)f->width - a->width ||
        a->y > (uint32_t)f->height - a->height)
        return rad_fail(err, RAD_EPROTO,
                        "estimate of an area that lies outside the picture");
    return 0;
}

static int
copy_areas(struct estimate *e, const struct msg_estimate *m, uint32_t nframes,
           struct rad_error *err)
{
    for (uint32_t i = 0; i < m->nareas; i++) {
        const struct msg_area *a = &m->areas[i];
        int rc = check_area(e->frames, nframes, a, err);

        if (rc < 0)
            return rc;
        e->areas[i].frame = a->frame;
        e->areas[i].part = (struct rad_window){ (int)a->x, (int)a->y,
                                                (int)a->width, (int)a->height };
    }
    return 0;
}

static bool
makes_records(const struct rad_frame *f)
{
    return f->job->ambient && !rad_ambient_is_frozen(f->job->ambient);
}

struct estimate *
estimate_new(const struct rad_frame *frames, uint32_t nframes,
             const struct msg_estimate *m, struct rad_error *err)
{
    struct estimate *e;

    if (m->rays > ESTIMATE_MOST_RAYS) {
        rad_fail(err, RAD_EPROTO, "estimate by %u rays an area, at most %d",
                 m->rays, ESTIMATE_MOST_RAYS);
        return NULL;
    }
    e = calloc(1, sizeof *e);
    if (e) {
        e->frames = frames;
        e->id = m->id;
        e->rays = m->rays;
        e->nareas = m->nareas;
        e->passes = nframes > 0 && makes_records(&frames[0]) ? 2 : 1;
        e->areas = calloc(m->nareas + 1, sizeof *e->areas);
        e->costs = calloc(m->nareas + 1, sizeof *e->costs);
    }
    if (!e || !e->areas || !e->costs) {
        rad_fail_memory(err);
    } else if (copy_areas(e, m, nframes, err) == 0) {
        return e;
    }
    estimate_free(e);
    return NULL;
}

void
estimate_free(struct estimate *e)
{
    if (!e)
        return;
    for (uint32_t i = 0; e->areas && i < e->nareas; i++)
        for (int k = 0; k < MOST_PASSES; k++)
            free(e->areas[i].sampled[k]);
    free(e->areas);
    free(e->costs);
    free(e->bitmap);
    free(e->pixels);
    free(e);
}

bool
estimate_open(const struct estimate *e)
{
    return atomic_load_explicit(&e->taken, memory_order_relaxed) <
           e->nareas * e->passes;
}

/* Memory for n pixels.  Without it the process ends with a status that says so:
 * the work comes back, and no area is blamed for a crash. */
static struct rad_sampled *
room_for(size_t n)
{
    struct rad_sampled *v = malloc((n + 1) * sizeof *v);

    if (!v)
        _exit(EX_OSERR);
    return v;
}

/* Trace the pixels of a pass in an area: as many in each pass.  In an area of
 * less than 2 n pixels some of the second pass are traced twice, and kept once.
 */
static void
work_on(struct estimate *e, uint32_t i, uint32_t pass, struct rad_ctx *ctx,
        const _Atomic bool *stop)
{
    struct area *a = &e->areas[i];
    const struct rad_frame *f = &e->frames[a->frame];
    uint64_t pixels = (uint64_t)a->part.width * (uint64_t)a->part.height;
    uint32_t n = e->rays < pixels ? e->rays : (uint32_t)pixels;
    uint32_t left =
        (uint64_t)n * (pass + 1) <= pixels ? n : (uint32_t)pixels - n * pass;
    const struct rad_estimate_order again = { a->part, 0, n - left, stop };
    const struct rad_estimate_order own = { a->part, n * pass, left, stop };
    struct rad_estimate cost = { 0 };
    struct rad_sampled *v = room_for(n);

    rad_estimate_trace(f, ctx, &again, &cost, v); /* n - left may be 0 */
    a->n[pass] = rad_estimate_trace(f, ctx, &own, &cost, v);
    a->sampled[pass] = v;
    if (pass == e->passes - 1)
        e->costs[i] = (struct msg_cost){ cost.rays, cost.tests };
}

void
estimate_work(struct estimate *e, struct rad_ctx *ctx, const _Atomic bool *stop)
{
    uint32_t i;

    while (!atomic_load_explicit(stop, memory_order_relaxed) &&
           (i = atomic_fetch_add(&e->taken, 1)) < e->nareas * e->passes)
        work_on(e, i % e->nareas, i / e->nareas, ctx, stop);
}

/* Pixels of an estimate count as estimate_rays.  Those that are used as facts
 * count as primary rays in the unit that uses them. */
void
estimate_count(struct estimate *e, const struct rad_counts *c, double cpu_s)
{
    struct msg_counts more = { 0 };

    counted_add(&more, c, cpu_s);
    more.estimate_rays = more.primary_rays;
    more.primary_rays = 0;
    msg_counts_add(&e->counts, &more);
}

/* --- pixels as facts --- */

/* The line that a row belongs to: the first base line at or below it. */
static int
line_of(const struct rad_quincunx *q, int row)
{
    int i = row / q->ystep;

    while (rad_quincunx_base_row(q, i) < row)
        i++;
    return i;
}

static struct rad_quincunx
sampler_of(const struct rad_frame *f)
{
    struct rad_quincunx q = { .width = f->width,
                              .height = f->height,
                              .maxdiff = f->job->params.maxdiff,
                              .depth = f->depth };

    rad_quincunx_steps(f->job->params.psample, &q.xstep, &q.ystep);
    return q;
}

/* How many of the sorted pixels lie in rows up to `row`. */
static size_t
pixels_to(const struct rad_sampled *from, size_t n, int row)
{
    size_t k = 0;

    while (k < n && from[k].y <= row)
        k++;
    return k;
}

/* Memory for a message's bitmap and pixels; that of the last one is freed. */
static bool
make_room(struct estimate *e, size_t bitmap, size_t pixels)
{
    free(e->bitmap);
    free(e->pixels);
    e->bitmap = calloc(bitmap, 1);
    e->pixels = malloc(pixels);
    return e->bitmap && e->pixels;
}

/* Put the pixels of an area's passes into one sorted list. */
static void
merge(struct area *a)
{
    size_t n = a->n[0] + a->n[1];
    struct rad_sampled *v = room_for(n);

    for (int k = 0, at = 0; k < MOST_PASSES; at += (int)a->n[k++])
        if (a->n[k] > 0)
            memcpy(v + at, a->sampled[k], a->n[k] * sizeof *v);
    for (int k = 0; k < MOST_PASSES; k++) {
        free(a->sampled[k]);
        a->sampled[k] = NULL;
        a->n[k] = 0;
    }
    rad_estimate_sort(v, n);
    a->sampled[0] = v;
    a->n[0] = n;
}

/* Make e->facts of those of the first pixels that lie in one line; *used: how
 * many these are.  False: they are dropped, for the message would be too long
 * or memory is out. */
static bool
pack_line(struct estimate *e, uint32_t frame, const struct rad_sampled *from,
          size_t n, size_t *used)
{
    const struct rad_frame *f = &e->frames[frame];
    struct rad_quincunx q = sampler_of(f);
    int line = line_of(&q, from[0].y);
    int top = line > 0 ? rad_quincunx_base_row(&q, line - 1) + 1 : 0;
    size_t stride = ((size_t)f->width + 7) / 8, channels = f->depth ? 4 : 3;
    int last;
    size_t rows;

    *used = pixels_to(from, n, rad_quincunx_base_row(&q, line));
    last = from[*used - 1].y;
    rows = (size_t)(last - from[0].y) + 1;
    if (rows * stride + *used * channels * sizeof(float) > MSG_MAX - 64 ||
        !make_room(e, rows * stride, *used * channels * sizeof(float)))
        return false;
    for (size_t k = 0; k < *used; k++) {
        const struct rad_sampled *s = &from[k];
        float v[4] = { s->pixel.L.r, s->pixel.L.g, s->pixel.L.b, s->pixel.z };
        uint8_t *row = e->bitmap + (size_t)(s->y - from[0].y) * stride;

        row[s->x / 8] |= (uint8_t)(1u << s->x % 8);
        wire_floats_put(e->pixels + k * channels * sizeof(float), v, channels);
    }
    e->facts = (struct msg_facts){ .frame = frame,
                                   .line = (uint32_t)line,
                                   .row = (uint32_t)(from[0].y - top),
                                   .rows = (uint32_t)rows,
                                   .width = (uint32_t)f->width,
                                   .flags = MSG_FACTS_ESTIMATE,
                                   .channels = (uint8_t)channels,
                                   .bitmap = e->bitmap,
                                   .pixels = e->pixels,
                                   .npixels = (uint32_t)*used };
    return true;
}

struct msg_facts *
estimate_facts(struct estimate *e)
{
    while (e->at < e->nareas) {
        struct area *a = &e->areas[e->at];
        const struct rad_sampled *from;
        size_t left, used;
        bool packed;

        if (e->at_pixel == 0)
            merge(a);
        from = a->sampled[0] + e->at_pixel;
        left = a->n[0] - e->at_pixel;
        if (left == 0) {
            e->at++;
            e->at_pixel = 0;
            continue;
        }
        packed = pack_line(e, a->frame, from, left, &used);
        e->at_pixel += used;
        if (packed)
            return &e->facts;
    }
    return NULL;
}

void
estimate_result(const struct estimate *e, struct msg_estimated *m)
{
    *m = (struct msg_estimated){
        .id = e->id, .ncosts = e->nareas, .costs = e->costs, .counts = e->counts
    };
}
